//! `sunshine render` for several pictures: a camera that goes round a plant, or the steps of a growth.

use crate::Answer;
use crate::arguments::RenderArguments;
use crate::camera_arguments::CameraArguments;
use crate::failure::Failure;
use crate::render_command::default_output;
use crate::render_job::{Job, Made};
use render::{Ending, PictureFormat, Provenance, ReadyDevice};
use scene::{Camera, DAffine3, DVec3};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Whether the command line asks for several pictures.
pub fn is_wanted(arguments: &RenderArguments) -> bool {
    arguments.turntable.is_some() || !arguments.more_scenes.is_empty()
}

/// Renders and writes them; returns the summary to print.
pub fn run(arguments: &RenderArguments) -> Result<Answer, Failure> {
    check(arguments)?;
    let output = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.scene));
    let count = arguments.turntable.map_or(1 + arguments.more_scenes.len(), |count| count as usize);
    let first = numbered(&output, 1, count);
    let mut job = Job::new(arguments, Some(&first))?;
    render::check_writable(&first).map_err(|source| Failure::NotWritable { path: first.clone(), source })?;
    job.prepare()?;
    let mut series = Series { output: &output, count, written: 0, exposure: arguments.exposure, last: None };
    match arguments.turntable {
        Some(_) => turntable(arguments, &mut job, &mut series)?,
        None => growth(arguments, &mut job, &mut series)?,
    };
    let ending = match series.last {
        Some((Ending::Stopped, _)) => Ending::Stopped,
        _ if series.written < count => Ending::Stopped,
        _ => Ending::Complete,
    };
    let is_exposed = job.format.is_some_and(PictureFormat::is_exposed);
    let text = if arguments.quiet { String::new() } else { series.summary(is_exposed) };
    Ok(Answer { text, exit_code: job.exit_code(ending) })
}

/// Refuses what is meant for a single picture.
fn check(arguments: &RenderArguments) -> Result<(), Failure> {
    let several = arguments.turntable.is_some() && !arguments.more_scenes.is_empty();
    let wrong = match arguments {
        _ if several => "--turntable goes round one project; give one, or leave --turntable out",
        RenderArguments { stats: Some(_), .. } => "--stats tells of one picture, not of several",
        RenderArguments { pixel: Some(_), .. } => "--pixel tells of one picture, not of several",
        RenderArguments { sample_range: Some(_), .. } => {
            "--sample-range renders a share of one picture, not of several; to share a series among machines, give each \
             of them some of the projects"
        }
        RenderArguments { checkpoint: Some(_), .. } | RenderArguments { resume: Some(_), .. } => {
            "--checkpoint and --resume keep one picture, not several; those of a series are written as they are finished"
        }
        _ => return Ok(()),
    };
    Err(Failure::Usage(wrong.to_owned()))
}

/// How far several pictures have come.
struct Series<'a> {
    /// File name without number.
    output: &'a Path,
    /// Pictures in the end.
    count: usize,
    /// Pictures that are there.
    written: usize,
    /// Of all pictures in stops: pictures that are each exposed for themselves flicker.
    exposure: Option<f32>,
    /// Of the last picture, whether it is complete, and its samples per pixel.
    last: Option<(Ending, u32)>,
}

impl Series<'_> {
    /// Renders and writes the next picture; `false` if it is to be the last because somebody asked to stop.
    fn make(
        &mut self,
        job: &mut Job<'_>,
        render: impl FnOnce(&mut Job<'_>, &Path, Option<f32>) -> Result<Made, Failure>,
    ) -> Result<bool, Failure> {
        let number = self.written + 1;
        let path = numbered(self.output, number, self.count);
        job.messages.line(&format!("picture {number} of {}: {}", self.count, path.display()));
        let made = match render(job, &path, self.exposure) {
            // Those before it are there.
            Err(Failure::Interrupted { .. }) if self.written > 0 => return Ok(false),
            made => made?,
        };
        self.written = number;
        self.exposure = self.exposure.or(made.stops);
        self.last = Some((made.ending, made.samples));
        Ok(made.ending == Ending::Complete && !job.is_interrupted())
    }

    fn summary(&self, is_exposed: bool) -> String {
        let Series { output, count, written, exposure, last } = self;
        let exposure = match exposure {
            Some(stops) if is_exposed => format!("exposure {stops:+.2} EV\n"),
            _ => String::new(),
        };
        let stopped = match last {
            Some((Ending::Stopped, samples)) => {
                format!("stopped; the last picture has only {samples} samples per pixel\n")
            }
            _ if written < count => format!("stopped before picture {} of {count}\n", written + 1),
            _ => String::new(),
        };
        let (first, last) = (numbered(output, 1, *count), numbered(output, *written, *count));
        let wrote = match written {
            1 => first.display().to_string(),
            _ => format!("{written} pictures, {} to {}", first.display(), last.display()),
        };
        format!("{exposure}{stopped}wrote {wrote}\n")
    }
}

/// The camera goes round.
fn turntable(arguments: &RenderArguments, job: &mut Job<'_>, series: &mut Series<'_>) -> Result<(), Failure> {
    let device = job.open()?;
    let project = job.read(&arguments.scene)?;
    let own = &project.scene.camera;
    let (_, middle) = arguments.camera.line_of_sight(&project.scene);
    let scene = job.compile(&project.scene)?;
    let ReadyDevice { scene: mut loaded, device } = job.load(device, &scene)?;
    for number in 0..series.count {
        let camera = turned(own, middle, TAU * number as f64 / series.count as f64);
        let view = scene.view(&camera)?;
        loaded.set_view(&view)?;
        let placed = placed(&arguments.camera, own, &camera, middle);
        let provenance = |job: &Job<'_>| -> Provenance {
            job.provenance(&arguments.scene, &placed, scene.hash_through(&view), device.kind())
        };
        let goes_on = series.make(job, |job, path, exposure| {
            job.make(loaded.as_ref(), &scene, provenance(job), Some(path), exposure)
        })?;
        if !goes_on {
            break;
        }
    }
    Ok(())
}

/// One project after the other.
fn growth(arguments: &RenderArguments, job: &mut Job<'_>, series: &mut Series<'_>) -> Result<(), Failure> {
    let mut device = job.open()?;
    let mut first: Option<(Camera, DVec3)> = None;
    for path in std::iter::once(&arguments.scene).chain(&arguments.more_scenes) {
        let mut project = job.read(path)?;
        let own = project.scene.camera.clone();
        let (camera, middle) = first
            .get_or_insert_with(|| (own.clone(), arguments.camera.line_of_sight(&project.scene).1))
            .clone();
        let placed = placed(&arguments.camera, &own, &camera, middle);
        project.scene.camera = camera;
        let scene = job.compile(&project.scene)?;
        let ready = job.load(device, &scene)?;
        let provenance = job.provenance(path, &placed, scene.hash(), ready.device.kind());
        let goes_on = series.make(job, |job, path, exposure| {
            job.make(ready.scene.as_ref(), &scene, provenance, Some(path), exposure)
        })?;
        if !goes_on {
            break;
        }
        // The programs that it has compiled serve the next scene, too.
        device = ready.device;
    }
    Ok(())
}

/// The options that give a picture its camera: those of the command line if they do without the series.
fn placed(given: &CameraArguments, own: &Camera, camera: &Camera, middle: DVec3) -> CameraArguments {
    if own == camera { given.clone() } else { CameraArguments::placing(camera, middle) }
}

/// The camera after a turn by an angle in radians round the vertical line through a point, anticlockwise seen from
/// above.
fn turned(camera: &Camera, middle: DVec3, angle: f64) -> Camera {
    if angle == 0.0 {
        // To the last bit.
        return camera.clone();
    }
    let back = DAffine3::from_translation(middle)
        * DAffine3::from_rotation_z(-angle)
        * DAffine3::from_translation(-middle);
    Camera { view_from_world: camera.view_from_world * back, ..camera.clone() }
}

/// A file name with the number of a picture, counted from 1, in at least four digits.
fn numbered(output: &Path, number: usize, count: usize) -> PathBuf {
    let digits = count.to_string().len().max(4);
    let mut name = output.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{number:0digits$}"));
    if let Some(extension) = output.extension() {
        name.push(".");
        name.push(extension);
    }
    output.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_get_numbers() {
        assert_eq!(numbered(Path::new("a/oak.v1.png"), 7, 120), Path::new("a/oak.v1-0007.png"));
        assert_eq!(numbered(Path::new("oak.exr"), 12, 99_999), Path::new("oak-00012.exr"));
    }

    #[test]
    fn the_camera_goes_round_the_middle_and_comes_back() {
        let middle = DVec3::new(1.0, 2.0, 3.0);
        let eye = middle + DVec3::new(0.0, -5.0, 1.0);
        let camera = Camera::look_at(eye, middle, DVec3::Z, 1.0);
        let at = |angle: f64| turned(&camera, middle, angle).view_from_world.inverse().translation;
        assert!((at(0.0) - eye).length() < 1e-12 && (at(TAU) - eye).length() < 1e-12);
        assert!((at(TAU / 4.0) - (middle + DVec3::new(5.0, 0.0, 1.0))).length() < 1e-12);
        let seen = turned(&camera, middle, 1.0).view_from_world.transform_point3(middle);
        assert!((seen - camera.view_from_world.transform_point3(middle)).length() < 1e-12);
    }
}
