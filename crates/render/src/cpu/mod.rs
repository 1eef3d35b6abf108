//! The CPU device: the kernels over slices, tiles spread over threads.

#[cfg(target_arch = "x86_64")]
mod lanes;
mod reached;
mod search;
mod slices;

pub use search::{RaySearch, ShadowRay};
pub(crate) use slices::Slices;

use crate::{
    Batch, CompiledScene, ControlFlow, Device, DeviceError, LoadedScene, Progress, RenderSettings, View,
};
use kernels::layers::kernel::layers_of_pixel;
use kernels::pixel::kernel::render_pixel;
use kernels::records::kernel::{ALL_FEATURES, FilmPixel, LayerPixel, SceneHeader, launched_samples};
use rayon::prelude::*;
use slices::PLAIN_FEATURES;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// How many rays a thread follows at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lanes {
    /// The kernels as they are, on any processor.
    One,
    /// Processors with AVX2.
    Eight,
    /// Processors with AVX-512.
    Sixteen,
}

/// The processor of this machine.
pub struct Cpu {
    pub(crate) threads: Arc<rayon::ThreadPool>,
    lanes: Lanes,
}

impl Cpu {
    /// All processors make the same picture.
    pub(crate) const KIND: &str = "CPU";

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
        Ok(Cpu { threads: Arc::new(threads), lanes: Lanes::Sixteen })
    }

    /// Follows at most so many rays at once. Pictures are the same, bit for bit.
    #[must_use]
    pub fn with_lanes(self, lanes: Lanes) -> Self {
        Cpu { lanes, ..self }
    }
}

impl Device for Cpu {
    fn name(&self) -> String {
        match self.threads.current_num_threads() {
            1 => "CPU (1 thread)".to_owned(),
            n => format!("CPU ({n} threads)"),
        }
    }

    fn kind(&self) -> String {
        Self::KIND.to_owned()
    }

    fn load(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError> {
        Ok(Box::new(CpuScene::new(self, scene)))
    }
}

struct CpuScene {
    threads: Arc<rayon::ThreadPool>,
    scene: Arc<CompiledScene>,
    /// That of the scene, or one with another camera.
    header: SceneHeader,
    /// Its nodes, if rays take turns in it.
    #[cfg(target_arch = "x86_64")]
    lane_nodes: Vec<lanes::LaneNode>,
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    lanes: Lanes,
}

/// Height of the tiles that nobody has chosen a size for; they are as wide as the picture.
const TILE_ROWS: usize = 4;

/// Edge of the squares of pixels that stand side by side in lanes.
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
const SQUARE_EDGE: usize = 4;

impl LoadedScene for CpuScene {
    fn set_view(&mut self, view: &View) -> Result<(), DeviceError> {
        self.header = view.header;
        Ok(())
    }

    fn add_samples(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        let launch = batch.launch(settings);
        let is_plain = self.is_plain();
        #[cfg(target_arch = "x86_64")]
        if let Some(scene) = lanes::LaneScene::new(self, launch, settings.renderer, self.lanes) {
            return self.for_squares(settings, batch, pixels, progress, |places, pixels| {
                let taken = |pixel: &FilmPixel| u64::from(launched_samples(launch, pixel.samples));
                let taken = pixels.iter().map(taken).sum();
                scene.render_pixels(places, pixels);
                taken
            });
        }
        self.for_pixels(settings, batch, pixels, progress, |x, y, pixel| {
            let taken = launched_samples(launch, pixel.samples);
            *pixel = if is_plain {
                render_pixel(self.slices::<PLAIN_FEATURES>(), launch, x, y, *pixel)
            } else {
                render_pixel(self.slices::<ALL_FEATURES>(), launch, x, y, *pixel)
            };
            taken
        })
    }

    fn add_layers(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [LayerPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        let slices = self.slices::<ALL_FEATURES>();
        let launch = batch.launch(settings);
        self.for_pixels(settings, batch, pixels, progress, |x, y, pixel| {
            *pixel = layers_of_pixel(slices, launch, x, y, *pixel);
            launch.samples
        })
    }
}

impl CpuScene {
    fn new(cpu: &Cpu, scene: Arc<CompiledScene>) -> Self {
        #[cfg(target_arch = "x86_64")]
        let lane_nodes = cpu.threads.install(|| lanes::lane_nodes(&scene, cpu.lanes));
        CpuScene {
            threads: Arc::clone(&cpu.threads),
            header: scene.header,
            scene,
            #[cfg(target_arch = "x86_64")]
            lane_nodes,
            lanes: cpu.lanes,
        }
    }

    /// Whether the path tracer for plain scenes suffices.
    fn is_plain(&self) -> bool {
        is_plain(&self.scene)
    }

    fn slices<const FEATURES: u32>(&self) -> Slices<'_, FEATURES> {
        Slices::new(&self.scene, &self.header)
    }

    /// Calls `work` for every pixel, tiles spread over the threads; it returns the number of samples that it took.
    fn for_pixels<P: Send>(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [P],
        progress: &Progress<'_>,
        work: impl Fn(u32, u32, &mut P) -> u32 + Sync,
    ) -> Result<(), DeviceError> {
        self.for_tiles(settings, batch, pixels, progress, |x, y, rows| {
            let mut taken = 0;
            for (y, line) in (y..).zip(rows) {
                for (x, pixel) in (x..).zip(line) {
                    taken += u64::from(work(x, y, pixel));
                }
            }
            taken
        })
    }

    /// Calls `work` for the pixels of every tile, given where they are, squares of pixels one after another; it returns the
    /// number of samples that it took.
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    fn for_squares<P: Copy + Send>(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [P],
        progress: &Progress<'_>,
        work: impl Fn(&[(u32, u32)], &mut [P]) -> u64 + Sync,
    ) -> Result<(), DeviceError> {
        self.for_tiles(settings, batch, pixels, progress, |x, y, mut rows| {
            let width = rows.first().map_or(0, |row| row.len());
            let mut order = Vec::with_capacity(width * rows.len());
            for band in (0..rows.len()).step_by(SQUARE_EDGE) {
                for start in (0..width).step_by(SQUARE_EDGE) {
                    for row in band..rows.len().min(band + SQUARE_EDGE) {
                        order.extend((start..width.min(start + SQUARE_EDGE)).map(|column| (column, row)));
                    }
                }
            }
            let places: Vec<(u32, u32)> =
                order.iter().map(|&(column, row)| (x + column as u32, y + row as u32)).collect();
            let mut pixels: Vec<P> = order.iter().map(|&(column, row)| rows[row][column]).collect();
            let taken = work(&places, &mut pixels);
            for (&(column, row), pixel) in order.iter().zip(pixels) {
                rows[row][column] = pixel;
            }
            taken
        })
    }

    /// Calls `work` for every tile, given the place of its first pixel, tiles spread over the threads; it returns the
    /// number of samples that it took.
    fn for_tiles<P: Send>(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [P],
        progress: &Progress<'_>,
        work: impl Fn(u32, u32, Vec<&mut [P]>) -> u64 + Sync,
    ) -> Result<(), DeviceError> {
        assert_eq!(pixels.len(), batch.pixels(settings), "pixels of a batch");
        if pixels.is_empty() {
            return Ok(());
        }
        let launch = batch.launch(settings);
        let width = launch.tile_width as usize;
        let edge = settings.tile.map(|edge| edge.max(1) as usize);
        let (tile_width, tile_height) = (edge.unwrap_or(width), edge.unwrap_or(TILE_ROWS));
        let done = AtomicU64::new(0);
        let cancelled = AtomicBool::new(false);
        let tile = |x: usize, y: usize, rows: Vec<&mut [P]>| {
            if cancelled.load(Ordering::Relaxed) {
                return;
            }
            let taken = work(launch.tile_x + x as u32, launch.tile_y + y as u32, rows);
            let sum = done.fetch_add(taken, Ordering::Relaxed) + taken;
            if let ControlFlow::Break(()) = progress(sum) {
                cancelled.store(true, Ordering::Relaxed);
            }
        };
        self.threads.install(|| {
            pixels.par_chunks_mut(tile_height * width).enumerate().for_each(|(number, band)| {
                tiles_of(band, width, tile_width).into_par_iter().enumerate().for_each(|(column, rows)| {
                    tile(column * tile_width, number * tile_height, rows);
                });
            });
        });
        if cancelled.into_inner() { Err(DeviceError::Cancelled) } else { Ok(()) }
    }
}

/// Whether the path tracer for plain scenes suffices.
fn is_plain(scene: &CompiledScene) -> bool {
    scene.features & !PLAIN_FEATURES == 0
}

/// The tiles side by side in some rows of a picture, each as the pieces of its rows.
fn tiles_of<P>(band: &mut [P], width: usize, tile_width: usize) -> Vec<Vec<&mut [P]>> {
    let mut tiles: Vec<Vec<&mut [P]>> = Vec::new();
    tiles.resize_with(width.div_ceil(tile_width), Vec::new);
    for row in band.chunks_mut(width) {
        for (tile, piece) in tiles.iter_mut().zip(row.chunks_mut(tile_width)) {
            tile.push(piece);
        }
    }
    tiles
}
