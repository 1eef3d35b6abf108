//! A scene in the memory of a graphics card.

use super::tile::{KeptTile, TileRenderer};
use super::{Gpu, Program};
use crate::{Batch, CompiledScene, DeviceError, LoadedScene, Progress, RenderSettings, Renderer, View};
use kernels::records::kernel::{FilmPixel, LayerPixel, launched_samples};
use std::sync::Arc;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// The scene's tables on the graphics card.
pub(super) struct GpuScene {
    gpu: Arc<Gpu>,
    tables: Vec<wgpu::Buffer>,
    /// What the tables contain.
    features: u32,
    /// From one batch to the next.
    tile: KeptTile,
}

impl GpuScene {
    pub(super) fn upload(gpu: Arc<Gpu>, scene: &CompiledScene) -> Result<Self, DeviceError> {
        let limit = gpu.device.limits().max_storage_buffer_binding_size;
        let storage = |table: &'static str, bytes: &[u8], record: usize| {
            if bytes.len() as u64 > limit {
                return Err(DeviceError::TooLarge {
                    device: gpu.name.clone(),
                    table,
                    needed: bytes.len() as u64,
                    limit,
                });
            }
            // A binding cannot be empty; the kernels never read the record that stands in.
            let stand_in = vec![0u8; record];
            let contents = if bytes.is_empty() { &stand_in } else { bytes };
            Ok(gpu.device.create_buffer_init(&BufferInitDescriptor {
                label: Some(table),
                contents,
                usage: wgpu::BufferUsages::STORAGE,
            }))
        };
        let header = gpu.device.create_buffer_init(&BufferInitDescriptor {
            label: Some("scene header"),
            contents: bytemuck::bytes_of(&scene.header),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        });
        fn bytes<T: bytemuck::Pod>(records: &[T]) -> (&[u8], usize) {
            (bytemuck::cast_slice(records), size_of::<T>())
        }
        let mut tables = vec![header];
        for (name, (contents, record)) in [
            ("nodes", bytes(&scene.nodes)),
            ("objects", bytes(&scene.objects)),
            ("materials", bytes(&scene.materials)),
            ("channels", bytes(&scene.channels)),
            ("images", bytes(&scene.texels)),
            ("lights", bytes(&scene.lights)),
            ("mesh attributes", bytes(&scene.attributes)),
        ] {
            tables.push(storage(name, contents, record)?);
        }
        // Wait until the tables have arrived, so that a lack of memory shows here.
        gpu.queue.submit([]);
        wait(&gpu, "receiving the scene")?;
        Ok(GpuScene { gpu, tables, features: scene.features, tile: KeptTile::default() })
    }
}

impl LoadedScene for GpuScene {
    fn set_view(&mut self, view: &View) -> Result<(), DeviceError> {
        self.gpu.queue.write_buffer(&self.tables[0], 0, bytemuck::bytes_of(&view.header));
        self.gpu.check("changing the camera")
    }

    fn prepare(&self, renderer: Renderer) -> Result<(), DeviceError> {
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
        let pipeline = self.gpu.pipeline(Program::samples(settings.renderer, self.features))?;
        TileRenderer::new(&self.gpu, &pipeline, &self.tables, settings, &self.tile)
            .render(batch, pixels, progress, &most)
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
        TileRenderer::new(&self.gpu, &pipeline, &self.tables, settings, &tile).render(
            batch,
            pixels,
            progress,
            &|_| batch.samples,
        )
    }
}

/// Waits until the card has done all its work.
pub(super) fn wait(gpu: &Gpu, doing: &'static str) -> Result<(), DeviceError> {
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|error| gpu.failed(doing, error.to_string()))?;
    gpu.check(doing)
}
