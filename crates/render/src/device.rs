//! What every device can do.

use crate::sums::{BLOCK_SAMPLES, sum_of_parts};
use crate::{CompiledScene, CropWindow, Film, FilmSums, Filter, Renderer, Sampler, View};
use bytemuck::Zeroable;
use kernels::records::kernel::{FilmPixel, LaunchSettings, LayerPixel};
use std::sync::Arc;

/// What to compute.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Samples per pixel.
    pub samples: u32,
    /// Number of surfaces that a path may touch; 1 is direct light only (GroIMP's recursion depth).
    pub depth: u32,
    /// The unit square of the filter is divided into `grid` x `grid` strata, at least 1; the Sobol sampler needs none
    /// and takes no notice.
    pub grid: u32,
    /// Another seed gives an independent picture.
    pub seed: u32,
    /// How light is computed.
    pub renderer: Renderer,
    /// Shadow rays of the ray tracer to every area light and sky, at least 1.
    pub shadow_samples: u32,
    /// Radiance in W/(m² sr) where nothing is hit and there is no sky. It is seen and lights nothing.
    pub background: [f32; 3],
    /// Where random numbers come from.
    pub sampler: Sampler,
    /// How light around a pixel is weighted.
    pub filter: Filter,
    /// The part of the picture to render; `None` for all of it. The pixels are those of the whole picture.
    pub crop: Option<CropWindow>,
    /// Edge in pixels of the squares that the picture is rendered in; `None` for what suits the device. It never
    /// changes the picture.
    pub tile: Option<u32>,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl RenderSettings {
    /// What users get who ask for nothing else.
    pub const DEFAULT: Self = RenderSettings {
        width: 640,
        height: 480,
        samples: 64,
        depth: 5,
        grid: 3,
        seed: 0,
        renderer: Renderer::PathTracer,
        shadow_samples: 16,
        background: [0.0; 3],
        sampler: Sampler::Sobol,
        filter: Filter::Box,
        crop: None,
        tile: None,
    };

    /// Work to be done, in samples.
    pub fn total_samples(&self) -> u64 {
        let window = self.window();
        u64::from(window.width) * u64::from(window.height) * u64::from(self.samples)
    }

    /// The settings as the kernels take them, for all that is rendered and all samples at once.
    pub(crate) fn launch(&self) -> LaunchSettings {
        let window = self.window();
        LaunchSettings {
            width: self.width,
            height: self.height,
            tile_x: window.x,
            tile_y: window.y,
            tile_width: window.width,
            tile_height: window.height,
            first_sample: 0,
            samples: self.samples,
            seed: self.seed,
            grid: self.grid.max(1),
            depth: self.depth,
            renderer: self.renderer.number(),
            background: wgsl_rs::std::vec3f(self.background[0], self.background[1], self.background[2]),
            shadow_samples: self.shadow_samples.max(1),
            sampler: self.sampler.code(),
            sequence_bits: self.sequence_bits(),
            reconstruction: self.filter.code(),
            counted: 0,
        }
    }
}

/// Whether the rendering shall go on; the answer to a progress report.
pub use std::ops::ControlFlow;

/// Called now and then with the number of samples done so far (of [`RenderSettings::total_samples`]), from any
/// thread. `Break` ends the rendering with [`DeviceError::Cancelled`].
pub type Progress<'a> = dyn Fn(u64) -> ControlFlow<()> + Sync + 'a;

/// Something that can render.
pub trait Device: Send + Sync {
    /// What users know it by, for example `CPU (8 threads)` or `NVIDIA GeForce RTX 3060 (Vulkan)`.
    fn name(&self) -> String;

    /// What decides the last digits of its results, for example `CPU` or `NVIDIA GeForce RTX 3060 (Vulkan)`: devices
    /// of the same kind make the same picture bit for bit.
    fn kind(&self) -> String {
        self.name()
    }

    /// Brings a scene to the device.
    ///
    /// # Errors
    /// If the device cannot hold the scene or is lost.
    fn load(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError>;
}

/// A piece of work: samples of some rows of a picture, or of the window of it that is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Batch {
    /// The uppermost row, from the top of the window.
    pub first_row: u32,
    /// Number of rows.
    pub rows: u32,
    /// Number of the first sample in every pixel. Samples are told apart by their numbers: whoever adds samples to
    /// pixels goes on counting.
    pub first_sample: u32,
    /// Number of samples for every pixel; in a counted batch the most that a pixel takes.
    pub samples: u32,
    /// Whether every pixel has its own number of samples: that which its field `samples` says beforehand is what it
    /// has in the end.
    pub counted: bool,
}

impl Batch {
    /// All samples of all that is rendered.
    pub fn whole(settings: &RenderSettings) -> Self {
        Batch {
            first_row: 0,
            rows: settings.window().height,
            first_sample: 0,
            samples: settings.samples,
            counted: false,
        }
    }

    /// Number of pixels.
    pub(crate) fn pixels(&self, settings: &RenderSettings) -> usize {
        settings.window().width as usize * self.rows as usize
    }

    pub(crate) fn launch(&self, settings: &RenderSettings) -> LaunchSettings {
        LaunchSettings {
            tile_y: settings.window().y + self.first_row,
            tile_height: self.rows,
            first_sample: self.first_sample,
            samples: self.samples,
            counted: u32::from(self.counted),
            ..settings.launch()
        }
    }
}

/// A scene on a device, ready to be rendered any number of times.
pub trait LoadedScene: Send + Sync {
    /// Looks at the scene through another camera from now on; the rest of the scene stays where it is.
    ///
    /// # Errors
    /// If the device fails.
    fn set_view(&mut self, view: &View) -> Result<(), DeviceError>;

    /// Does ahead what the first picture of a renderer needs besides: graphics cards compile their program.
    ///
    /// # Errors
    /// If the device fails.
    fn prepare(&self, _renderer: Renderer) -> Result<(), DeviceError> {
        Ok(())
    }

    /// Adds samples to rows of a picture; `pixels` are those of the rows, `progress` hears of the samples of this
    /// batch. The result depends on the scene, the settings and the kind of device alone: not on tiles, threads,
    /// time, nor on how the samples are divided into batches.
    ///
    /// # Errors
    /// If the device fails or `progress` asks to stop.
    ///
    /// # Panics
    /// If the number of pixels is not that of the batch.
    fn add_samples(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError>;

    /// Adds what the rays of a batch, which is not counted, meet first.
    ///
    /// # Errors
    /// As [`LoadedScene::add_samples`].
    ///
    /// # Panics
    /// If the number of pixels is not that of the batch.
    fn add_layers(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [LayerPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError>;

    /// Overwrites `pixels` with the sums of a batch, which is not counted and a node of the tree of
    /// [`FilmSums`]: whatever the device, the sums are those of its blocks. After an error the pixels may be anything.
    ///
    /// # Errors
    /// As [`LoadedScene::add_samples`].
    ///
    /// # Panics
    /// If the number of pixels is not that of the batch.
    fn sum_node(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        sum_of_parts(batch, BLOCK_SAMPLES, pixels, progress, |block, pixels, progress| {
            pixels.fill(FilmPixel::zeroed());
            self.add_samples(settings, block, pixels, progress)
        })
    }

    /// Seconds that the device has spent on samples of this scene so far by its own clock, with none of what travels
    /// to it and back; `None` if it has no clock.
    fn device_seconds(&self) -> Option<f64> {
        None
    }

    /// What went wrong since the last question although the work was done: devices that are left out.
    fn failures(&self) -> Vec<String> {
        Vec::new()
    }

    /// Renders all in memory: the sums are formed as [`FilmSums`] says.
    ///
    /// # Errors
    /// As [`LoadedScene::add_samples`].
    fn render(&self, settings: &RenderSettings, progress: &Progress<'_>) -> Result<Film, DeviceError> {
        let window = settings.window();
        let whole = Batch::whole(settings);
        let mut sums = FilmSums::new(whole.pixels(settings), 0);
        sums.add_all(self, settings, &whole, progress)?;
        Ok(Film { width: window.width, height: window.height, pixels: sums.into_total() })
    }
}

fn no_such_gpu(wanted: usize, found: &str) -> String {
    match found {
        "none" => "no graphics card with a driver for Vulkan, Metal or Direct3D 12 was found; `--device cpu` always works"
            .to_owned(),
        _ => format!(
            "there is no GPU number {wanted}; found: {found}. `sunshine devices` lists them, `--device cpu` always works"
        ),
    }
}

/// Why a device could not do its work.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    /// The user asked for a graphics card that is not there.
    #[error("{}", no_such_gpu(*wanted, found))]
    NoSuchGpu {
        /// What was asked for.
        wanted: usize,
        /// What is there, as text.
        found: String,
    },
    /// The graphics card refused to work.
    #[error(
        "the GPU {device} failed while {doing}: {}. `--device cpu` renders without it",
        .reason.trim_end_matches('.')
    )]
    Gpu {
        /// Which one.
        device: String,
        /// What it was doing.
        doing: &'static str,
        /// What the driver said.
        reason: String,
    },
    /// A table of the scene is larger than the device can bind at once.
    #[error(
        "the scene's {table} need {needed} bytes, but the GPU {device} takes at most {limit} in one piece; \
         `--device cpu` has no such limit"
    )]
    TooLarge {
        /// Which one.
        device: String,
        /// Which table.
        table: &'static str,
        /// Size of the table in bytes.
        needed: u64,
        /// What the device takes.
        limit: u64,
    },
    /// The graphics card has too little memory.
    #[error(
        "the GPU {device} has no memory left for {what}, {:.1} MB; other programs may be using it. `--device cpu` \
         renders without it",
        *.needed as f64 / 1e6
    )]
    OutOfMemory {
        /// Which one.
        device: String,
        /// What it should have held.
        what: &'static str,
        /// Size of that in bytes.
        needed: u64,
    },
    /// Threads could not be started.
    #[error("the CPU threads could not be started: {reason}")]
    Threads {
        /// What the system said.
        reason: String,
    },
    /// The progress report was answered with `Break`.
    #[error("the rendering was cancelled")]
    Cancelled,
}
