//! What one or several pictures of `sunshine render` go through, from the project to the files.

use crate::arguments::RenderArguments;
use crate::camera_arguments::CameraArguments;
use crate::denoising::Denoiser;
use crate::failure::Failure;
use crate::interruption::Interruption;
use crate::progress::Messages;
use crate::render_command::{check_crop, scene_name, write_kernels};
use crate::rendering::{Follower, Plan, Rendered, render_film};
use crate::statistics::{Seconds, duration_text, timed};
use groimp::Project;
use render::{
    BAND_BYTES, Band, BandStatistics, CompiledScene, Device, DeviceError, Ending, Layers, LoadedScene,
    NoisyPicture, Origins, PictureFormat, PictureTarget, Provenance, ReadyDevice, RenderError,
    RenderSettings, Samples, Sampling, ToneCurve,
};
use scene::Scene;
use std::cell::Cell;
use std::path::Path;
use std::sync::Arc;

/// What is the same for all pictures of a command.
pub struct Job<'a> {
    arguments: &'a RenderArguments,
    /// Where messages go.
    pub messages: Messages,
    /// How the pictures are rendered.
    pub plan: Plan,
    /// Of the pictures, if there shall be any.
    pub format: Option<PictureFormat>,
    layers: Layers,
    /// What removes the noise.
    pub denoiser: Option<Denoiser>,
    threads: Option<usize>,
    /// What the steps took; of rendering and writing, those of the last picture.
    pub seconds: Seconds,
    /// Listened for once there is something to keep.
    interruption: Option<Interruption>,
}

/// A picture that was made.
pub struct Made {
    /// What it took.
    pub rendered: BandStatistics,
    /// Exposure in stops, if a file was written.
    pub stops: Option<f32>,
    /// Whether it is complete.
    pub ending: Ending,
    /// Samples per pixel.
    pub samples: u32,
    /// Samples of all pixels that were there before.
    pub continued: u64,
}

impl<'a> Job<'a> {
    /// Finds out, before hours of work rather than after, whether what is wanted is possible; `output` is one of the
    /// pictures.
    pub fn new(arguments: &'a RenderArguments, output: Option<&Path>) -> Result<Self, Failure> {
        check_crop(&arguments.settings())?;
        let plan = Plan::new(arguments)?;
        let format = output.map(PictureFormat::from_path).transpose()?;
        let layers = arguments.layers.clone().unwrap_or_default();
        if !layers.is_empty() && format != Some(PictureFormat::Exr) {
            return Err(Failure::Usage(
                "--layers needs an .exr; no other file has a place for them".to_owned(),
            ));
        }
        Ok(Job {
            arguments,
            messages: Messages { quiet: arguments.quiet },
            plan,
            format,
            layers,
            denoiser: None,
            threads: arguments.threads.map(|threads| threads as usize),
            seconds: Seconds::default(),
            interruption: None,
        })
    }

    /// Writes the kernels and finds the denoiser, if they are wanted; that there is none, or too little memory, is told
    /// before hours of work, too.
    pub fn prepare(&mut self) -> Result<(), Failure> {
        if let Some(directory) = &self.arguments.dump_wgsl {
            write_kernels(directory, self.messages)?;
        }
        if self.arguments.denoise {
            let denoiser = self.denoiser.insert(Denoiser::open(self.threads)?);
            render::check_denoised_size(&self.plan.settings)?;
            self.layers = std::mem::take(&mut self.layers).denoised_by(denoiser.to_string());
        }
        Ok(())
    }

    /// Opens the device; one that is not there is told before a large scene is read.
    pub fn open(&mut self) -> Result<Box<dyn Device>, Failure> {
        let (choice, threads) = (self.arguments.device, self.threads);
        let device = timed(&mut self.seconds.open, || render::open_device(choice, threads))?;
        tracing::info!("opened {}", device.name());
        Ok(device)
    }

    /// Reads a project and changes it as the command line says.
    pub fn read(&mut self, path: &Path) -> Result<Project, Failure> {
        let options = self.arguments.read_options();
        let mut project = timed(&mut self.seconds.read, || groimp::read_with(path, &options))
            .map_err(Failure::reading(path))?;
        self.messages.report(&project.report);
        self.arguments.camera.apply(&mut project.scene)?;
        self.arguments.daylight.apply(&mut project.scene.sky)?;
        Ok(project)
    }

    /// Compiles a scene.
    pub fn compile(&mut self, scene: &Scene) -> Result<Arc<CompiledScene>, Failure> {
        let acceleration = self.arguments.accel;
        let compiled = timed(&mut self.seconds.compile, || render::compile_with(scene, acceleration))?;
        tracing::info!(
            objects = scene.drawn_objects(),
            triangles = compiled.triangles(),
            "read the scene in {}, compiled it in {}",
            duration_text(self.seconds.read),
            duration_text(self.seconds.compile)
        );
        Ok(Arc::new(compiled))
    }

    /// Brings a scene to the device.
    pub fn load(
        &mut self,
        device: Box<dyn Device>,
        scene: &Arc<CompiledScene>,
    ) -> Result<ReadyDevice, Failure> {
        let (choice, renderer) = (self.arguments.device, self.plan.settings.renderer);
        let load = || render::load_for(device, choice, self.threads, scene, renderer);
        let ready = timed(&mut self.seconds.upload, load)?;
        tracing::info!("{} is ready after {}", ready.device.name(), duration_text(self.seconds.upload));
        Ok(ready)
    }

    /// What was asked for, to be told in files; `camera` is what changes the saved view of the project in `path`.
    pub fn provenance(
        &self,
        path: &Path,
        camera: &CameraArguments,
        scene_hash: String,
        device: String,
    ) -> Provenance {
        tracing::debug!("scene hash {scene_hash}");
        let settings = picture_options(self.arguments, &self.plan.settings, camera);
        Provenance { scene_hash, device, settings, ..provenance_of(path) }
    }

    /// Renders a picture, and writes it and its film where they shall be.
    pub fn make(
        &mut self,
        loaded: &dyn LoadedScene,
        scene: &CompiledScene,
        mut provenance: Provenance,
        output: Option<&Path>,
        exposure: Option<f32>,
    ) -> Result<Made, Failure> {
        let interruption = match &self.interruption {
            Some(heard) => heard.clone(),
            None => self.interruption.insert(Interruption::listen().map_err(Failure::Signals)?).clone(),
        };
        let Job { arguments, messages, plan, layers, denoiser, seconds, .. } = self;
        let follower = Follower::new(plan, interruption.clone(), *messages);
        let given_up = |failure: Failure| match failure {
            Failure::Device(DeviceError::Cancelled)
            | Failure::Render(RenderError::Device(DeviceError::Cancelled)) => {
                Failure::Interrupted { exit_code: interruption.exit_code() }
            }
            other => other,
        };
        let kept = match plan.kept {
            Some(kept) => {
                Some(render_film(arguments, plan, kept, loaded, &provenance, &follower).map_err(given_up)?)
            }
            None => None,
        };
        let ending = kept.as_ref().map_or(Ending::Complete, |rendered| rendered.ending);
        seconds.render = kept.as_ref().map_or(0.0, |rendered| rendered.seconds);
        provenance.samples = kept.as_ref().map_or(plan.settings.samples, |rendered| rendered.samples);

        let mut rendered = BandStatistics::default();
        let mut stops = None;
        if let Some(output) = output {
            let picture = Picture {
                sampling: arguments.sampling(),
                settings: &plan.settings,
                output,
                exposure,
                tone_curve: arguments.tone_curve,
                layers,
                origins: &Origins::of(scene),
                provenance: &provenance,
                denoiser: denoiser.as_ref(),
            };
            let update = |done| follower.update(done);
            let written = picture.write(loaded, kept.as_ref(), &update, &mut rendered, seconds);
            loaded.failures().iter().for_each(|failure| messages.line(&format!("warning: {failure}")));
            stops = Some(written.map_err(given_up)?);
            if rendered.black && ending == Ending::Complete {
                messages.line(
                    "warning: the picture is black: nothing that the camera sees is lit. `sunshine info` shows where \
                     the camera and the objects are",
                );
            }
        } else if let Some(Rendered { film, .. }) = &kept {
            rendered.samples = film.samples();
            rendered.rays = film.rays();
        }
        follower.finish(ending);
        let continued = kept.as_ref().map_or(0, |rendered| rendered.continued);
        Ok(Made { rendered, stops, ending, samples: provenance.samples, continued })
    }

    /// Whether somebody has asked to stop.
    pub fn is_interrupted(&self) -> bool {
        self.interruption.as_ref().is_some_and(Interruption::is_asked)
    }

    /// That of the program after its last picture.
    pub fn exit_code(&self, ending: Ending) -> u8 {
        match (ending, &self.interruption) {
            (Ending::Stopped, Some(interruption)) => interruption.exit_code(),
            _ => 0,
        }
    }
}

/// The options that give a picture, to be told in its file; `camera` is what changes the saved view.
pub fn picture_options(
    arguments: &RenderArguments,
    settings: &RenderSettings,
    camera: &CameraArguments,
) -> Vec<(String, String)> {
    let mut options = settings.options();
    if arguments.adaptive {
        options.push(("adaptive".to_owned(), String::new()));
    }
    options.extend(arguments.scene_options(camera));
    options
}

/// Of a picture of the project in `path`, without what is known only later.
pub fn provenance_of(path: &Path) -> Provenance {
    Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene_name(path).unwrap_or_default().to_string_lossy().into_owned(),
        ..Provenance::default()
    }
}

/// What is needed to write a picture.
struct Picture<'a> {
    sampling: Sampling,
    settings: &'a RenderSettings,
    output: &'a Path,
    exposure: Option<f32>,
    tone_curve: ToneCurve,
    layers: &'a Layers,
    origins: &'a Origins,
    provenance: &'a Provenance,
    denoiser: Option<&'a Denoiser>,
}

impl Picture<'_> {
    /// Writes the film, or what is rendered meanwhile; returns the exposure in stops.
    fn write(
        &self,
        loaded: &dyn LoadedScene,
        kept: Option<&Rendered>,
        progress: &render::Progress<'_>,
        rendered: &mut BandStatistics,
        seconds: &mut Seconds,
    ) -> Result<f32, Failure> {
        let target = PictureTarget {
            path: self.output,
            width: self.settings.window().width,
            height: self.settings.window().height,
            exposure: self.exposure,
            tone_curve: self.tone_curve,
            layers: self.layers,
            origins: self.origins,
            provenance: Some(self.provenance),
        };
        let samples = match kept {
            Some(rendered) => Samples::Taken(&rendered.film),
            None => self.sampling.into(),
        };
        // Of a film that is complete nothing more is to be told than that.
        let update = |done| if kept.is_some() { render::ControlFlow::Continue(()) } else { progress(done) };
        let (mut total, mut tracing) = (0.0, 0.0);
        let stops = timed(&mut total, || {
            render::stream_picture(&target, |sink| {
                // Rows are written while others are still to be rendered.
                let (mut producing, mut writing) = (0.0, 0.0);
                let denoising = Cell::new(0.0);
                *rendered = timed(&mut producing, || {
                    let mut write = |band: &Band<'_>| {
                        let mut step = 0.0;
                        let result = timed(&mut step, || sink(band));
                        writing += step;
                        result
                    };
                    let Some(denoiser) = self.denoiser else {
                        let traced = self.layers.are_traced();
                        return render::render_bands(
                            loaded,
                            self.settings,
                            samples,
                            traced,
                            BAND_BYTES,
                            &update,
                            &mut write,
                        );
                    };
                    let denoise = |picture: &NoisyPicture| {
                        let mut step = 0.0;
                        let result = timed(&mut step, || denoiser.denoise(picture));
                        denoising.set(step);
                        result
                    };
                    render::render_denoised(loaded, self.settings, samples, &denoise, &update, &mut write)
                })?;
                seconds.denoise = denoising.get();
                tracing = producing - writing - seconds.denoise;
                Ok(())
            })
        })?;
        seconds.render += tracing;
        seconds.write = total - tracing - seconds.denoise;
        Ok(stops)
    }
}
