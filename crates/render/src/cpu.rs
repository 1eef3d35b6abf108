//! The CPU device: the kernels over slices, tiles spread over threads.

use crate::{CompiledScene, ControlFlow, Device, DeviceError, Film, LoadedScene, Progress, RenderSettings};
use kernels::path::kernel::render_pixel;
use kernels::records::kernel::*;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The processor of this machine.
pub struct Cpu {
    threads: Arc<rayon::ThreadPool>,
}

impl Cpu {
    /// Uses the given number of threads, or one per processor.
    ///
    /// # Errors
    /// If the system refuses to start the threads.
    pub fn new(threads: Option<usize>) -> Result<Self, DeviceError> {
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.unwrap_or(0))
            .thread_name(|index| format!("render-{index}"))
            .build()
            .map_err(|error| DeviceError::Threads { reason: error.to_string() })?;
        Ok(Cpu { threads: Arc::new(threads) })
    }
}

impl Device for Cpu {
    fn name(&self) -> String {
        match self.threads.current_num_threads() {
            1 => "CPU (1 thread)".to_owned(),
            n => format!("CPU ({n} threads)"),
        }
    }

    fn load(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError> {
        Ok(Box::new(CpuScene { threads: Arc::clone(&self.threads), scene }))
    }
}

struct CpuScene {
    threads: Arc<rayon::ThreadPool>,
    scene: Arc<CompiledScene>,
}

/// Rows of a band that a thread renders between two looks at the progress.
const BAND_ROWS: usize = 4;

impl LoadedScene for CpuScene {
    fn render(&self, settings: &RenderSettings, progress: &Progress<'_>) -> Result<Film, DeviceError> {
        let launch = settings.launch();
        let mut film = Film::new(launch.tile_width, launch.tile_height);
        let done = AtomicU64::new(0);
        let cancelled = AtomicBool::new(false);
        let slices = Slices { scene: &self.scene };
        let width = launch.tile_width as usize;
        self.threads.install(|| {
            film.pixels.par_chunks_mut(BAND_ROWS * width).enumerate().for_each(|(band, pixels)| {
                if cancelled.load(Ordering::Relaxed) {
                    return;
                }
                for (offset, pixel) in pixels.iter_mut().enumerate() {
                    let x = launch.tile_x + (offset % width) as u32;
                    let y = launch.tile_y + (band * BAND_ROWS + offset / width) as u32;
                    *pixel = render_pixel(slices, launch, x, y, *pixel);
                }
                let samples = pixels.len() as u64 * u64::from(settings.samples);
                let sum = done.fetch_add(samples, Ordering::Relaxed) + samples;
                if let ControlFlow::Break(()) = progress(sum) {
                    cancelled.store(true, Ordering::Relaxed);
                }
            });
        });
        if cancelled.into_inner() { Err(DeviceError::Cancelled) } else { Ok(film) }
    }
}

/// The kernels' view of a scene in main memory.
#[derive(Clone, Copy)]
pub(crate) struct Slices<'a> {
    pub scene: &'a CompiledScene,
}

impl SceneAccess for Slices<'_> {
    fn header(scene: Self) -> SceneHeader {
        scene.scene.header
    }
    fn node(scene: Self, index: u32) -> BvhNode {
        scene.scene.nodes[index as usize]
    }
    fn shape(scene: Self, index: u32) -> ShapeRecord {
        scene.scene.objects[index as usize].shape
    }
    fn surface(scene: Self, index: u32) -> SurfaceRecord {
        scene.scene.objects[index as usize].surface
    }
    fn material(scene: Self, index: u32) -> MaterialRecord {
        scene.scene.materials[index as usize]
    }
    fn channel(scene: Self, index: u32) -> ChannelRecord {
        scene.scene.channels[index as usize]
    }
    fn texel(scene: Self, index: u32) -> u32 {
        scene.scene.texels[index as usize]
    }
    fn light(scene: Self, index: u32) -> LightRecord {
        scene.scene.lights[index as usize]
    }
    fn attribute(scene: Self, index: u32) -> wgsl_rs::std::Vec4f {
        let [x, y, z, w] = scene.scene.attributes[index as usize];
        wgsl_rs::std::vec4f(x, y, z, w)
    }
}
