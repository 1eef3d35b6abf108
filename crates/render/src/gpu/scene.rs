//! A scene in the memory of a graphics card.

use super::tile::{MOST_SAMPLES, TileRenderer};
use super::tile_memory::KeptTile;
use super::{Gpu, Program};
use crate::sums::sum_of_parts;
use crate::{Batch, CompiledScene, DeviceError, LoadedScene, Progress, RenderSettings, Renderer, View};
use kernels::records::kernel::{FilmPixel, LayerPixel, launched_samples};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Bytes of a table that are on their way to the card at a time.
const PIECE: u64 = 64 << 20;

/// The scene's tables on the graphics card.
pub(super) struct GpuScene {
    gpu: Arc<Gpu>,
    tables: Vec<wgpu::Buffer>,
    /// What the tables contain.
    features: u32,
    /// From one batch to the next.
    tile: KeptTile,
    /// What the card's clock said of samples so far.
    nanoseconds: AtomicU64,
}

impl GpuScene {
    pub(super) fn upload(gpu: Arc<Gpu>, scene: &CompiledScene) -> Result<Self, DeviceError> {
        fn bytes<T: bytemuck::Pod>(records: &[T]) -> (&[u8], usize) {
            (bytemuck::cast_slice(records), size_of::<T>())
        }
        let tables = [
            ("nodes", bytes(&scene.nodes)),
            ("objects", bytes(&scene.objects)),
            ("materials", bytes(&scene.materials)),
            ("channels", bytes(&scene.channels)),
            ("images", bytes(&scene.texels)),
            ("lights", bytes(&scene.lights)),
            ("mesh attributes", bytes(&scene.attributes)),
        ];
        let limits = gpu.device.limits();
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        // Before anything travels.
        for (table, (contents, _)) in tables {
            let needed = contents.len() as u64;
            if needed > limit {
                return Err(DeviceError::TooLarge { device: gpu.name.clone(), table, needed, limit });
            }
        }
        let needed = tables.iter().map(|(_, (contents, _))| contents.len() as u64).sum();
        use wgpu::BufferUsages as Usage;
        let buffer = |label, size, usage| {
            let usage = usage | Usage::COPY_DST;
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let buffers = gpu.allocated("the scene", needed, || {
            let header = buffer("scene header", size_of_val(&scene.header) as u64, Usage::UNIFORM);
            // A binding cannot be empty; the kernels never read the record that stands in.
            let sized = tables.iter().map(|(table, (contents, record))| {
                buffer(*table, contents.len().max(*record) as u64, Usage::STORAGE)
            });
            [header].into_iter().chain(sized).collect::<Vec<_>>()
        })?;
        gpu.queue.write_buffer(&buffers[0], 0, bytemuck::bytes_of(&scene.header));
        for (buffer, (_, (contents, _))) in buffers[1..].iter().zip(tables) {
            for (piece, start) in contents.chunks(PIECE as usize).zip((0..).step_by(PIECE as usize)) {
                gpu.queue.write_buffer(buffer, start, piece);
                // So that there are no copies of all of a large table.
                if piece.len() as u64 == PIECE {
                    gpu.queue.submit([]);
                    wait(&gpu, RECEIVING)?;
                }
            }
        }
        // Wait until the tables have arrived, so that a lack of memory shows here.
        gpu.queue.submit([]);
        wait(&gpu, RECEIVING)?;
        let (tile, nanoseconds) = (KeptTile::default(), AtomicU64::new(0));
        Ok(GpuScene { gpu, tables: buffers, features: scene.features, tile, nanoseconds })
    }

    fn samples_of(&self, settings: &RenderSettings) -> Result<wgpu::ComputePipeline, DeviceError> {
        self.gpu.pipeline(Program::samples(settings.renderer, self.features))
    }

    fn tiles<'a>(
        &'a self,
        pipeline: &'a wgpu::ComputePipeline,
        settings: &'a RenderSettings,
        kept: &'a KeptTile,
    ) -> TileRenderer<'a> {
        TileRenderer { gpu: &self.gpu, pipeline, tables: &self.tables, settings, kept }
    }

    fn count(&self, time: Duration) {
        // 500 years.
        let nanoseconds = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        self.nanoseconds.fetch_add(nanoseconds, Ordering::Relaxed);
    }
}

const RECEIVING: &str = "receiving the scene";

impl LoadedScene for GpuScene {
    fn set_view(&mut self, view: &View) -> Result<(), DeviceError> {
        self.gpu.queue.write_buffer(&self.tables[0], 0, bytemuck::bytes_of(&view.header));
        self.gpu.check("changing the camera")
    }

    fn prepare(&self, renderer: Renderer) -> Result<(), DeviceError> {
        self.gpu.joiner()?;
        self.gpu.pipeline(Program::samples(renderer, self.features)).map(|_| ())
    }

    fn add_samples(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        // Of a counted batch a tile takes as many samples as its most demanding pixel.
        let most = |tile: &[FilmPixel]| {
            let launch = batch.launch(settings);
            tile.iter().map(|pixel| launched_samples(launch, pixel.samples)).max().unwrap_or(0)
        };
        let pipeline = self.samples_of(settings)?;
        let time = self.tiles(&pipeline, settings, &self.tile).add(batch, pixels, progress, &most)?;
        self.count(time);
        Ok(())
    }

    fn sum_node(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        let pipeline = self.samples_of(settings)?;
        let renderer = self.tiles(&pipeline, settings, &self.tile);
        sum_of_parts(batch, MOST_SAMPLES, pixels, progress, |part, pixels, progress| {
            self.count(renderer.sum(part, pixels, progress)?);
            Ok(())
        })
    }

    fn add_layers(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [LayerPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        let pipeline = self.gpu.pipeline(Program::layers(self.features))?;
        // Layers are one batch: nothing is kept for the next.
        let tile = KeptTile::default();
        self.tiles(&pipeline, settings, &tile).add(batch, pixels, progress, &|_| batch.samples)?;
        Ok(())
    }

    fn device_seconds(&self) -> Option<f64> {
        let has_clock = self.gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        has_clock.then(|| self.nanoseconds.load(Ordering::Relaxed) as f64 * 1e-9)
    }
}

/// Waits until the card has done all its work.
pub(super) fn wait(gpu: &Gpu, doing: &'static str) -> Result<(), DeviceError> {
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|error| gpu.failed(doing, error.to_string()))?;
    gpu.check(doing)
}
