//! `sunshine render`: from a scene file to a picture file.

use crate::arguments::RenderArguments;
use crate::failure::Failure;
use crate::progress::Messages;
use crate::statistics::{Seconds, Statistics, count_text, duration_text, timed};
use render::{Film, PictureFormat, RenderSettings};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Renders and writes the picture; returns the summary to print.
pub fn run(arguments: &RenderArguments) -> Result<String, Failure> {
    let messages = Messages { quiet: arguments.quiet };
    let settings = arguments.settings();
    check_crop(&settings)?;
    let output = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.scene));
    // Before hours of work rather than after.
    let format = PictureFormat::from_path(&output)?;
    check_outputs(&output, arguments.stats.as_deref())?;

    let mut seconds = Seconds::default();
    let threads = arguments.threads.map(|threads| threads as usize);
    // A device that is not there is told before a large scene is read.
    let device =
        timed(&mut seconds.open, || render::open_device_for(arguments.device, threads, settings.renderer))?;
    let mut project =
        timed(&mut seconds.read, || groimp::read_with(&arguments.scene, &arguments.read_options()))
            .map_err(Failure::reading(&arguments.scene))?;
    messages.report(&project.report);
    arguments.camera.apply(&mut project.scene)?;
    let scene =
        Arc::new(timed(&mut seconds.compile, || render::compile_with(&project.scene, arguments.accel))?);
    let loaded = timed(&mut seconds.upload, || device.load(Arc::clone(&scene)))?;

    let progress = messages.follow(settings.total_samples());
    let film = timed(&mut seconds.render, || loaded.render(&settings, &|done| progress.update(done)))?;
    progress.finish();

    if film.is_black() {
        messages.line(
            "warning: the picture is black: nothing that the camera sees is lit. `sunshine info` shows where the camera and \
             the objects are",
        );
    }
    let exposure = Exposure::choose(format, arguments.exposure, &film);
    timed(&mut seconds.write, || render::write_picture(&film, &output, exposure.stops()))?;

    let mut statistics = Statistics::new(&settings, &film);
    statistics.device = device.name();
    statistics.objects = project.scene.drawn_objects();
    statistics.triangles = scene.triangles();
    statistics.exposure = format.is_exposed().then_some(exposure.stops());
    statistics.seconds = seconds;
    if let Some(path) = &arguments.stats {
        statistics.write(path)?;
    }
    Ok(if arguments.quiet { String::new() } else { summary(&statistics, exposure, &output) })
}

/// How the brightness of the picture came about.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Exposure {
    /// The format keeps the radiance.
    Unscaled,
    Automatic(f32),
    Given(f32),
}

impl Exposure {
    fn choose(format: PictureFormat, given: Option<f32>, film: &Film) -> Self {
        match given {
            _ if !format.is_exposed() => Exposure::Unscaled,
            Some(stops) => Exposure::Given(stops),
            None => Exposure::Automatic(render::automatic_exposure(film)),
        }
    }

    fn stops(self) -> f32 {
        match self {
            Exposure::Unscaled => 0.0,
            Exposure::Automatic(stops) | Exposure::Given(stops) => stops,
        }
    }
}

impl std::fmt::Display for Exposure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Exposure::Unscaled => {
                f.write_str("exposure not applied (an .exr keeps the radiance in W/(m² sr))")
            }
            Exposure::Automatic(stops) => {
                write!(f, "exposure {stops:+.2} EV (chosen automatically; --exposure fixes it)")
            }
            Exposure::Given(stops) => write!(f, "exposure {stops:+.2} EV"),
        }
    }
}

fn summary(statistics: &Statistics, exposure: Exposure, output: &Path) -> String {
    let seconds = statistics.seconds.render;
    // A clock that did not move between two looks must not give infinity.
    let rate = statistics.samples as f64 / seconds.max(1e-9);
    format!(
        "{exposure}\nrendered in {} on {}, {} samples/s\nwrote {}\n",
        duration_text(seconds),
        statistics.device,
        count_text(rate),
        output.display()
    )
}

fn check_crop(settings: &RenderSettings) -> Result<(), Failure> {
    match settings.crop {
        Some(crop) if !crop.lies_in(settings.width, settings.height) => Err(Failure::Usage(format!(
            "--crop {},{},{},{} does not lie in the picture, which has {} x {} pixels",
            crop.x, crop.y, crop.width, crop.height, settings.width, settings.height
        ))),
        _ => Ok(()),
    }
}

fn check_outputs(picture: &Path, statistics: Option<&Path>) -> Result<(), Failure> {
    if statistics == Some(picture) {
        return Err(Failure::Usage(format!(
            "--output and --stats are the same file, {}; give them different names",
            picture.display()
        )));
    }
    for path in [Some(picture), statistics].into_iter().flatten() {
        render::check_writable(path)
            .map_err(|source| Failure::NotWritable { path: path.to_owned(), source })?;
    }
    Ok(())
}

/// The scene's name with .png, in the current directory.
fn default_output(scene: &Path) -> PathBuf {
    let mut name = scene_name(scene).unwrap_or_else(|| "picture".into());
    // Not `set_extension`: the name of a directory may have a dot in it.
    name.push(".png");
    name.into()
}

fn scene_name(scene: &Path) -> Option<std::ffi::OsString> {
    if scene.is_dir() {
        // `.` and `..` have a name only when they are looked up.
        return Some(scene.canonicalize().ok()?.file_name()?.to_owned());
    }
    // These are called the same in every unpacked project; the directory tells which one it is.
    let is_part = ["project.gs", "graph.xml"].iter().any(|part| scene.ends_with(part));
    let directory = scene.canonicalize().ok();
    let directory = directory.as_deref().and_then(Path::parent).and_then(Path::file_name);
    match directory {
        Some(directory) if is_part => Some(directory.to_owned()),
        _ => scene.file_stem().map(ToOwned::to_owned),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_called_like_their_scenes() {
        assert_eq!(default_output(Path::new("/data/birch.v2.gsz")), Path::new("birch.v2.png"));
        assert_eq!(default_output(Path::new("missing/project.gs")), Path::new("project.png"));
        assert_eq!(default_output(Path::new("")), Path::new("picture.png"));
        let directory = tempfile::tempdir().unwrap();
        let project = directory.path().join("oak.v1");
        std::fs::create_dir(&project).unwrap();
        std::fs::write(project.join("project.gs"), "").unwrap();
        assert_eq!(default_output(&project), Path::new("oak.v1.png"));
        assert_eq!(default_output(&project.join(".")), Path::new("oak.v1.png"));
        assert_eq!(default_output(&project.join("project.gs")), Path::new("oak.v1.png"));
    }

    #[test]
    fn one_file_cannot_be_both_outputs() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        assert!(matches!(check_outputs(&path, Some(&path)), Err(Failure::Usage(_))));
        assert!(check_outputs(&path, None).is_ok());
    }

    #[test]
    fn only_a_png_is_exposed() {
        let mut film = Film::new(1, 1);
        film.pixels[0].radiance = [0.1; 3].into();
        film.pixels[0].samples = 1;
        assert_eq!(Exposure::choose(PictureFormat::Exr, None, &film), Exposure::Unscaled);
        assert_eq!(Exposure::choose(PictureFormat::Exr, Some(2.0), &film), Exposure::Unscaled);
        assert_eq!(Exposure::choose(PictureFormat::Png, Some(2.0), &film), Exposure::Given(2.0));
        let automatic = Exposure::choose(PictureFormat::Png, None, &film);
        assert!((automatic.stops() - 3.0).abs() < 1e-5);
        assert_eq!(automatic.to_string(), "exposure +3.00 EV (chosen automatically; --exposure fixes it)");
        assert_eq!(Exposure::Given(-0.5).to_string(), "exposure -0.50 EV");
    }
}
