//! `sunshine render`: from a scene file to a picture file.

use crate::Answer;
use crate::arguments::RenderArguments;
use crate::checkpoints;
use crate::failure::Failure;
use crate::option_values::{Pixel, Size};
use crate::progress::Messages;
use crate::render_job::Job;
use crate::rendering::{Kept, Plan};
use crate::sequence_command;
use crate::statistics::{Statistics, count_text, duration_text};
use render::{Ending, Goal, PictureFormat, ReadyDevice, RenderSettings, Renderer};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Renders and writes the picture, or several; returns the summary to print.
pub fn run(arguments: &RenderArguments) -> Result<Answer, Failure> {
    if sequence_command::is_wanted(arguments) {
        return sequence_command::run(arguments);
    }
    let output = output(arguments);
    let output = output.as_deref();
    let mut job = Job::new(arguments, output)?;
    check_outputs(&[output, arguments.stats.as_deref(), checkpoints::path(arguments)])?;
    checkpoints::check_path(arguments)?;
    job.prepare()?;
    if let Some(pixel) = arguments.pixel {
        return Ok(pixel_events(arguments, pixel, job.messages)?.into());
    }
    let device = job.open()?;
    let project = job.read(&arguments.scene)?;
    let scene = job.compile(&project.scene)?;
    let ReadyDevice { device, scene: loaded } = job.load(device, &scene)?;
    let provenance = job.provenance(&arguments.scene, &arguments.camera, scene.hash(), device.kind());
    let made = job.make(loaded.as_ref(), &scene, provenance, output, arguments.exposure)?;

    let mut statistics = Statistics::new(&job.plan.settings, &made.rendered);
    statistics.denoiser = job.denoiser.as_ref().map(ToString::to_string);
    statistics.device = device.name();
    statistics.objects = project.scene.drawn_objects();
    statistics.triangles = scene.triangles();
    statistics.exposure = made.stops.filter(|_| job.format.is_some_and(PictureFormat::is_exposed));
    statistics.seconds = job.seconds;
    statistics.device_seconds = loaded.device_seconds();
    if let Some(path) = &arguments.stats {
        statistics.write(path)?;
    }
    let mut text = String::new();
    if !arguments.quiet {
        if let (Some(format), Some(stops)) = (job.format, made.stops) {
            text = format!("{}\n", Exposure::of(format, arguments.exposure, stops));
        }
        text += &summary(&statistics, made.continued);
        if made.ending == Ending::Stopped {
            text += &stopped(arguments, &job.plan, made.samples);
        }
        for path in [checkpoints::path(arguments), output].into_iter().flatten() {
            text += &format!("wrote {}\n", path.display());
        }
    }
    Ok(Answer { text, exit_code: job.exit_code(made.ending) })
}

/// How far it came, and how to go on.
fn stopped(arguments: &RenderArguments, plan: &Plan, samples: u32) -> String {
    let planned = match plan.kept {
        Some(Kept::Even(Goal::Samples(_)) | Kept::Adaptive) => {
            format!(" of {}", plan.wanted.end - plan.wanted.start)
        }
        _ => String::new(),
    };
    let next = match checkpoints::path(arguments) {
        Some(path) => format!("the same command with --resume {} goes on", path.display()),
        None => "with --checkpoint FILE it could be continued".to_owned(),
    };
    format!("stopped after {samples}{planned} samples per pixel; {next}\n")
}

/// Tells what happens on the paths of a pixel.
fn pixel_events(arguments: &RenderArguments, pixel: Pixel, messages: Messages) -> Result<String, Failure> {
    let settings = arguments.settings();
    if settings.renderer != Renderer::PathTracer {
        return Err(Failure::Usage("--pixel tells of the paths of the path tracer only".to_owned()));
    }
    if pixel.x >= settings.width || pixel.y >= settings.height {
        return Err(Failure::Usage(format!(
            "--pixel {},{} is outside of the picture, whose size is {}",
            pixel.x,
            pixel.y,
            Size::of(&settings)
        )));
    }
    let mut project = groimp::read_with(&arguments.scene, &arguments.read_options())
        .map_err(Failure::reading(&arguments.scene))?;
    messages.report(&project.report);
    arguments.camera.apply(&mut project.scene)?;
    arguments.daylight.apply(&mut project.scene.sky)?;
    let scene = render::compile_with(&project.scene, arguments.accel)?;
    Ok(render::pixel_events(&scene, &settings, (pixel.x, pixel.y), pixel.samples))
}

/// Writes what graphics cards run.
pub fn write_kernels(directory: &Path, messages: Messages) -> Result<(), Failure> {
    let not_writable = |path: &Path| {
        let path = path.to_owned();
        move |source| Failure::NotWritable { path, source }
    };
    std::fs::create_dir_all(directory).map_err(not_writable(directory))?;
    let sources = render::gpu::kernel_sources().map_err(io::Error::other).map_err(not_writable(directory))?;
    for (name, text) in sources {
        let path = directory.join(name);
        render::write_whole_file(&path, |file| file.write_all(text.as_bytes()))
            .map_err(not_writable(&path))?;
        messages.line(&format!("wrote {}", path.display()));
    }
    Ok(())
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
    fn of(format: PictureFormat, given: Option<f32>, stops: f32) -> Self {
        match given {
            _ if !format.is_exposed() => Exposure::Unscaled,
            Some(stops) => Exposure::Given(stops),
            None => Exposure::Automatic(stops),
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

/// What was done; `continued` samples were there before.
fn summary(statistics: &Statistics, continued: u64) -> String {
    let seconds = statistics.seconds.render;
    // A clock that did not move between two looks must not give infinity.
    let rate = statistics.samples.saturating_sub(continued) as f64 / seconds.max(1e-9);
    let noise = statistics.noise.filter(|noise| noise.is_finite());
    let noise =
        noise.map_or(String::new(), |noise| format!(", estimated relative error {:.1} %", noise * 100.0));
    let denoised = statistics.denoiser.as_ref().map_or(String::new(), |denoiser| {
        let seconds = duration_text(statistics.seconds.denoise);
        format!("denoised by {denoiser} in {seconds}: good to look at, but biased; do not measure in it\n")
    });
    format!(
        "rendered in {} on {}, {} samples/s\n{} samples per pixel{noise}\n{denoised}",
        duration_text(seconds),
        statistics.device,
        count_text(rate),
        (statistics.samples_per_pixel * 100.0).round() / 100.0,
    )
}

/// Refuses a part that is not in the picture.
pub fn check_crop(settings: &RenderSettings) -> Result<(), Failure> {
    match settings.crop {
        Some(crop) if !crop.lies_in(settings.width, settings.height) => Err(Failure::Usage(format!(
            "--crop {},{},{},{} does not lie in the picture, which has {} x {} pixels",
            crop.x, crop.y, crop.width, crop.height, settings.width, settings.height
        ))),
        _ => Ok(()),
    }
}

/// Two files must not have the same name, and all must be writable.
fn check_outputs(paths: &[Option<&Path>; 3]) -> Result<(), Failure> {
    let paths: Vec<&Path> = paths.iter().flatten().copied().collect();
    for (number, path) in paths.iter().enumerate() {
        if paths[..number].contains(path) {
            return Err(Failure::Usage(format!(
                "two of --output, --stats and --checkpoint are the same file, {}; give them different names",
                path.display()
            )));
        }
    }
    for path in paths {
        render::check_writable(path)
            .map_err(|source| Failure::NotWritable { path: path.to_owned(), source })?;
    }
    Ok(())
}

/// Where the picture goes; shares make none unless it is asked for.
fn output(arguments: &RenderArguments) -> Option<PathBuf> {
    let by_itself = || arguments.sample_range.is_none().then(|| default_output(&arguments.scene));
    arguments.output.clone().or_else(by_itself)
}

/// The scene's name with .png, in the current directory.
pub fn default_output(scene: &Path) -> PathBuf {
    let mut name = scene_name(scene).unwrap_or_else(|| "picture".into());
    // Not `set_extension`: the name of a directory may have a dot in it.
    name.push(".png");
    name.into()
}

/// What a scene is called, from the name of its file or folder.
pub fn scene_name(scene: &Path) -> Option<std::ffi::OsString> {
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
        assert!(matches!(check_outputs(&[Some(&path), Some(&path), None]), Err(Failure::Usage(_))));
        assert!(matches!(check_outputs(&[Some(&path), None, Some(&path)]), Err(Failure::Usage(_))));
        assert!(check_outputs(&[Some(&path), None, None]).is_ok());
    }

    #[test]
    fn only_a_png_is_exposed() {
        assert_eq!(Exposure::of(PictureFormat::Exr, None, 0.0), Exposure::Unscaled);
        assert_eq!(Exposure::of(PictureFormat::Exr, Some(2.0), 0.0), Exposure::Unscaled);
        assert_eq!(Exposure::of(PictureFormat::Png, Some(2.0), 2.0), Exposure::Given(2.0));
        let automatic = Exposure::of(PictureFormat::Png, None, 3.0);
        assert_eq!(automatic.to_string(), "exposure +3.00 EV (chosen automatically; --exposure fixes it)");
        assert_eq!(Exposure::Given(-0.5).to_string(), "exposure -0.50 EV");
    }
}
