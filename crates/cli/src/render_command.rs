//! `sunshine render`: from a scene file to a picture file.

use crate::arguments::RenderArguments;
use crate::denoising::Denoiser;
use crate::failure::Failure;
use crate::option_values::Pixel;
use crate::progress::{Messages, RenderProgress};
use crate::statistics::{Seconds, Statistics, count_text, duration_text, timed};
use render::{
    BAND_BYTES, Band, BandStatistics, NoisyPicture, Origins, PictureFormat, PictureTarget, RenderSettings,
    Renderer, Sampling, StopRule,
};
use std::cell::Cell;
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Renders and writes the picture; returns the summary to print.
pub fn run(arguments: &RenderArguments) -> Result<String, Failure> {
    let messages = Messages { quiet: arguments.quiet };
    let settings = arguments.settings();
    check_crop(&settings)?;
    let output = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.scene));
    // Before hours of work rather than after.
    let format = PictureFormat::from_path(&output)?;
    check_outputs(&output, arguments.stats.as_deref())?;

    let mut layers = arguments.layers.clone().unwrap_or_default();
    if !layers.is_empty() && format != PictureFormat::Exr {
        return Err(Failure::Usage(format!(
            "--layers needs an .exr; {} has no place for them",
            output.display()
        )));
    }
    if let Some(directory) = &arguments.dump_wgsl {
        write_kernels(directory, messages)?;
    }

    let mut seconds = Seconds::default();
    let threads = arguments.threads.map(|threads| threads as usize);
    if let Some(pixel) = arguments.pixel {
        return pixel_events(arguments, pixel, messages);
    }
    let denoiser = open_denoiser(arguments, &settings, threads)?;
    if let Some(denoiser) = &denoiser {
        layers = layers.denoised_by(denoiser.to_string());
    }
    // A device that is not there is told before a large scene is read.
    let device = timed(&mut seconds.open, || render::open_device(arguments.device, threads))?;
    let mut project =
        timed(&mut seconds.read, || groimp::read_with(&arguments.scene, &arguments.read_options()))
            .map_err(Failure::reading(&arguments.scene))?;
    messages.report(&project.report);
    arguments.camera.apply(&mut project.scene)?;
    let scene =
        Arc::new(timed(&mut seconds.compile, || render::compile_with(&project.scene, arguments.accel))?);
    let render::ReadyDevice { device, scene: loaded } = timed(&mut seconds.upload, || {
        render::load_for(device, arguments.device, threads, &scene, settings.renderer)
    })?;

    let progress = Follower::new(arguments, &settings, messages);
    let origins = Origins::of(&scene);
    let target = PictureTarget {
        path: &output,
        width: settings.window().width,
        height: settings.window().height,
        exposure: arguments.exposure,
        layers: &layers,
        origins: &origins,
    };
    let mut rendered = BandStatistics::default();
    let mut total = 0.0;
    let stops = timed(&mut total, || {
        render::stream_picture(&target, |sink| {
            // Rows are written while others are still to be rendered.
            let (mut producing, mut writing) = (0.0, 0.0);
            let denoising = Cell::new(0.0);
            rendered = timed(&mut producing, || {
                let (scene, sampling) = (loaded.as_ref(), arguments.sampling());
                let update = |done| progress.update(done);
                let mut write = |band: &Band<'_>| {
                    let mut step = 0.0;
                    let result = timed(&mut step, || sink(band));
                    writing += step;
                    result
                };
                let Some(denoiser) = &denoiser else {
                    let traced = layers.are_traced();
                    return render::render_bands(
                        scene, &settings, sampling, traced, BAND_BYTES, &update, &mut write,
                    );
                };
                let denoise = |picture: &NoisyPicture| {
                    let mut step = 0.0;
                    let result = timed(&mut step, || denoiser.denoise(picture));
                    denoising.set(step);
                    result
                };
                render::render_denoised(scene, &settings, sampling, &denoise, &update, &mut write)
            })?;
            seconds.denoise = denoising.get();
            seconds.render = producing - writing - seconds.denoise;
            Ok(())
        })
    })?;
    seconds.write = total - seconds.render - seconds.denoise;
    progress.finish();

    if rendered.black {
        messages.line(
            "warning: the picture is black: nothing that the camera sees is lit. `sunshine info` shows where the camera and \
             the objects are",
        );
    }
    let exposure = Exposure::of(format, arguments.exposure, stops);
    let mut statistics = Statistics::new(&settings, &rendered);
    statistics.denoiser = denoiser.map(|denoiser| denoiser.to_string());
    statistics.device = device.name();
    statistics.objects = project.scene.drawn_objects();
    statistics.triangles = scene.triangles();
    statistics.exposure = format.is_exposed().then_some(stops);
    statistics.seconds = seconds;
    if let Some(path) = &arguments.stats {
        statistics.write(path)?;
    }
    Ok(if arguments.quiet { String::new() } else { summary(&statistics, exposure, &output) })
}

/// The denoiser, if one is wanted; that there is none, or too little memory, is told before hours of work.
fn open_denoiser(
    arguments: &RenderArguments,
    settings: &RenderSettings,
    threads: Option<usize>,
) -> Result<Option<Denoiser>, Failure> {
    if !arguments.denoise {
        return Ok(None);
    }
    let denoiser = Denoiser::open(threads)?;
    render::check_denoised_size(settings)?;
    Ok(Some(denoiser))
}

/// Progress as a share of the samples or of the time, whichever is known beforehand.
struct Follower {
    progress: RenderProgress,
    total: u64,
    start: Instant,
    by_time: bool,
}

impl Follower {
    fn new(arguments: &RenderArguments, settings: &RenderSettings, messages: Messages) -> Self {
        let total = match arguments.sampling() {
            Sampling::Until(StopRule { time: Some(time), .. }) => {
                time.as_millis().try_into().unwrap_or(u64::MAX)
            }
            Sampling::Until(StopRule { most_samples: samples, .. }) => {
                RenderSettings { samples, ..settings.clone() }.total_samples()
            }
            Sampling::Uniform | Sampling::Adaptive => settings.total_samples(),
        };
        let by_time = arguments.time.is_some();
        Follower { progress: messages.follow(total), total, start: Instant::now(), by_time }
    }

    fn update(&self, samples: u64) -> ControlFlow<()> {
        let milliseconds = || self.start.elapsed().as_millis().try_into().unwrap_or(u64::MAX);
        self.progress.update(if self.by_time { milliseconds() } else { samples })
    }

    fn finish(&self) {
        // A time or a noise may be reached a little before what was expected.
        let _ = self.progress.update(self.total);
        self.progress.finish();
    }
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
            pixel.x, pixel.y, arguments.size
        )));
    }
    let mut project = groimp::read_with(&arguments.scene, &arguments.read_options())
        .map_err(Failure::reading(&arguments.scene))?;
    messages.report(&project.report);
    arguments.camera.apply(&mut project.scene)?;
    let scene = render::compile_with(&project.scene, arguments.accel)?;
    Ok(render::pixel_events(&scene, &settings, (pixel.x, pixel.y), pixel.samples))
}

/// Writes what graphics cards run.
fn write_kernels(directory: &Path, messages: Messages) -> Result<(), Failure> {
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

fn summary(statistics: &Statistics, exposure: Exposure, output: &Path) -> String {
    let seconds = statistics.seconds.render;
    // A clock that did not move between two looks must not give infinity.
    let rate = statistics.samples as f64 / seconds.max(1e-9);
    let noise = statistics.noise.filter(|noise| noise.is_finite());
    let noise =
        noise.map_or(String::new(), |noise| format!(", estimated relative error {:.1} %", noise * 100.0));
    let denoised = statistics.denoiser.as_ref().map_or(String::new(), |denoiser| {
        let seconds = duration_text(statistics.seconds.denoise);
        format!("denoised by {denoiser} in {seconds}: good to look at, but biased; do not measure in it\n")
    });
    format!(
        "{exposure}\nrendered in {} on {}, {} samples/s\n{} samples per pixel{noise}\n{denoised}wrote {}\n",
        duration_text(seconds),
        statistics.device,
        count_text(rate),
        (statistics.samples_per_pixel * 100.0).round() / 100.0,
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
        assert!(matches!(check_outputs(&path, Some(&path)), Err(Failure::Usage(_))));
        assert!(check_outputs(&path, None).is_ok());
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
