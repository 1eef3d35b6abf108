//! A picture on a graphics card, tile by tile, so that the memory taken there does not grow with the picture.

use super::Gpu;
use super::scene::wait;
use crate::{Batch, ControlFlow, DeviceError, Progress, RenderSettings};
use bytemuck::Pod;
use kernels::records::kernel::LaunchSettings;
use std::sync::{Mutex, mpsc};
use std::time::{Duration, Instant};

/// A launch should take about this long: long enough to keep the card busy, short enough for a desktop that
/// shares it, far below the two seconds after which systems reset it.
const LAUNCH_TIME: Duration = Duration::from_millis(80);
/// Edge of a tile in pixels on a graphics card, and on a rasteriser in software.
const TILE: u32 = 1024;
const SOFTWARE_TILE: u32 = 128;
/// Most bytes of a tile's film, of which the card holds two copies; what WebGPU guarantees for one binding.
const TILE_BYTES: u64 = 128 << 20;
/// Edge of the workgroup in the kernels.
const WORKGROUP: u32 = 8;

/// What is the same for all tiles of a picture.
pub(super) struct TileRenderer<'a> {
    gpu: &'a Gpu,
    pipeline: &'a wgpu::ComputePipeline,
    /// The scene: its header, then its tables.
    tables: &'a [wgpu::Buffer],
    settings: &'a RenderSettings,
    kept: &'a KeptTile,
}

/// A tile's memory on the card, from one batch of samples to the next: making memory that both sides see takes longer
/// than many samples. Whoever renders takes it and brings it back. How many samples a launch takes is learnt anew: the
/// next picture may be larger, deeper or closer.
#[derive(Default)]
pub(super) struct KeptTile(Mutex<Option<TileBuffers>>);

impl KeptTile {
    fn take(&self) -> Option<TileBuffers> {
        self.0.lock().ok()?.take()
    }

    fn bring_back(&self, tile: TileBuffers) {
        if let Ok(mut kept) = self.0.lock() {
            *kept = Some(tile);
        }
    }
}

impl<'a> TileRenderer<'a> {
    pub(super) fn new(
        gpu: &'a Gpu,
        pipeline: &'a wgpu::ComputePipeline,
        tables: &'a [wgpu::Buffer],
        settings: &'a RenderSettings,
        kept: &'a KeptTile,
    ) -> Self {
        TileRenderer { gpu, pipeline, tables, settings, kept }
    }

    /// Width and height of the tiles; at the right and lower edge they may be smaller.
    fn tile_size(&self, batch: &Batch, pixel_bytes: u64) -> (u32, u32) {
        let default = if self.gpu.is_software { SOFTWARE_TILE } else { TILE };
        let edge = self.settings.tile.unwrap_or(default).max(1);
        let limit = self.gpu.device.limits().max_storage_buffer_binding_size.min(TILE_BYTES);
        let most = u32::try_from(limit / pixel_bytes).unwrap_or(u32::MAX).max(1);
        let width = edge.min(self.settings.window().width).min(most);
        (width, edge.min(batch.rows).min(most / width).max(1))
    }

    /// Adds the samples of a batch to `pixels`; `most` tells how many launches of samples a tile needs.
    pub(super) fn render<P: Pod>(
        &self,
        batch: &Batch,
        pixels: &mut [P],
        progress: &Progress<'_>,
        most: &dyn Fn(&[P]) -> u32,
    ) -> Result<(), DeviceError> {
        let width = self.settings.window().width;
        assert_eq!(pixels.len(), batch.pixels(self.settings), "pixels of a batch");
        if pixels.is_empty() {
            return Ok(());
        }
        let (tile_width, tile_height) = self.tile_size(batch, size_of::<P>() as u64);
        let size = u64::from(tile_width) * u64::from(tile_height) * size_of::<P>() as u64;
        let kept = self.kept.take().filter(|buffers| buffers.film.size() >= size);
        let buffers = kept.unwrap_or_else(|| TileBuffers::new(self, size));
        let mut pace = Pace { samples: 1 };
        let mut done = 0u64;
        let mut gathered: Vec<P> = Vec::new();
        for y in (0..batch.rows).step_by(tile_height as usize) {
            for x in (0..width).step_by(tile_width as usize) {
                let whole = batch.launch(self.settings);
                let launch = LaunchSettings {
                    tile_x: whole.tile_x + x,
                    tile_y: whole.tile_y + y,
                    tile_width: tile_width.min(width - x),
                    tile_height: tile_height.min(batch.rows - y),
                    ..whole
                };
                let line = launch.tile_width as usize;
                let starts =
                    (y..y + launch.tile_height).map(|row| row as usize * width as usize + x as usize);
                // Tiles as wide as the picture lie in one piece: copies would be new memory for every batch.
                let tile: &[P] = if line == width as usize {
                    let first = y as usize * line;
                    &pixels[first..first + launch.tile_height as usize * line]
                } else {
                    gathered.clear();
                    for start in starts.clone() {
                        gathered.extend_from_slice(&pixels[start..start + line]);
                    }
                    &gathered
                };
                let bytes = size_of_val(tile) as u64;
                let launch = LaunchSettings { samples: most(tile), ..launch };
                self.send(&buffers, tile);
                self.render_tile(&buffers, launch, &mut pace, &mut |samples| {
                    done += samples;
                    progress(done)
                })?;
                self.read_back(&buffers, bytes, &mut |rendered| {
                    let row_bytes = line * size_of::<P>();
                    for (start, row) in starts.clone().zip(rendered.chunks(row_bytes)) {
                        // As bytes, because mapped memory need not be aligned for the record.
                        bytemuck::cast_slice_mut(&mut pixels[start..start + line]).copy_from_slice(row);
                    }
                })?;
            }
        }
        self.kept.bring_back(buffers);
        Ok(())
    }

    /// Brings the film of a tile to the card.
    fn send<P: Pod>(&self, buffers: &TileBuffers, tile: &[P]) {
        let bytes: &[u8] = bytemuck::cast_slice(tile);
        if bytes.iter().fold(0, |all, byte| all | byte) != 0 {
            self.gpu.queue.write_buffer(&buffers.film, 0, bytes);
            return;
        }
        // Most films are empty at first; then nothing need travel.
        let mut encoder = encoder(self.gpu, "empty film");
        encoder.clear_buffer(&buffers.film, 0, None);
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// Renders all samples of a tile, a few per launch; `report` hears of the samples done.
    fn render_tile(
        &self,
        buffers: &TileBuffers,
        tile: LaunchSettings,
        pace: &mut Pace,
        report: &mut dyn FnMut(u64) -> ControlFlow<()>,
    ) -> Result<(), DeviceError> {
        let gpu = self.gpu;
        let pixels = u64::from(tile.tile_width) * u64::from(tile.tile_height);
        let mut done = 0;
        while done < tile.samples {
            let samples = pace.samples.min(tile.samples - done);
            let launch = LaunchSettings { first_sample: tile.first_sample + done, samples, ..tile };
            gpu.queue.write_buffer(&buffers.settings, 0, bytemuck::bytes_of(&launch));
            let mut encoder = encoder(gpu, "render tile");
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some("render tile"),
                    timestamp_writes: None,
                });
                pass.set_pipeline(self.pipeline);
                pass.set_bind_group(0, &buffers.bindings, &[]);
                pass.dispatch_workgroups(
                    tile.tile_width.div_ceil(WORKGROUP),
                    tile.tile_height.div_ceil(WORKGROUP),
                    1,
                );
            }
            let start = Instant::now();
            gpu.queue.submit([encoder.finish()]);
            wait(gpu, "rendering")?;
            pace.learn(samples, start.elapsed());
            done += samples;
            if let ControlFlow::Break(()) = report(pixels * u64::from(samples)) {
                return Err(DeviceError::Cancelled);
            }
        }
        Ok(())
    }

    /// Lets `use_film` see the bytes of the film of a tile.
    fn read_back(
        &self,
        buffers: &TileBuffers,
        size: u64,
        use_film: &mut dyn FnMut(&[u8]),
    ) -> Result<(), DeviceError> {
        const DOING: &str = "reading the picture back";
        let gpu = self.gpu;
        let mut encoder = encoder(gpu, "read film back");
        encoder.copy_buffer_to_buffer(&buffers.film, 0, &buffers.readback, 0, size);
        gpu.queue.submit([encoder.finish()]);
        let (sender, receiver) = mpsc::channel();
        buffers.readback.map_async(wgpu::MapMode::Read, 0..size, move |result| {
            // The receiver is gone only if the wait below failed, which is reported there.
            let _ = sender.send(result);
        });
        wait(gpu, DOING)?;
        match receiver.recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(gpu.failed(DOING, error.to_string())),
            Err(error) => return Err(gpu.failed(DOING, error.to_string())),
        }
        let view = buffers
            .readback
            .get_mapped_range(0..size)
            .map_err(|error| gpu.failed(DOING, error.to_string()))?;
        use_film(&view);
        drop(view);
        buffers.readback.unmap();
        Ok(())
    }
}

/// How many samples fit into a launch, learnt from the launches before.
struct Pace {
    samples: u32,
}

impl Pace {
    fn learn(&mut self, samples: u32, elapsed: Duration) {
        let ratio = LAUNCH_TIME.as_secs_f64() / elapsed.as_secs_f64().max(1e-4);
        // Careful upwards: the next tile may be harder.
        let next = (f64::from(samples) * ratio.min(4.0)).floor();
        self.samples = (next as u32).max(1);
    }
}

/// What a tile needs on the card besides the scene.
struct TileBuffers {
    settings: wgpu::Buffer,
    film: wgpu::Buffer,
    /// Through which the film comes back.
    readback: wgpu::Buffer,
    bindings: wgpu::BindGroup,
}

impl TileBuffers {
    fn new(renderer: &TileRenderer<'_>, size: u64) -> Self {
        let buffer = |label, size, usage| {
            renderer.gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        let settings =
            buffer("launch settings", size_of::<LaunchSettings>() as u64, Usage::UNIFORM | Usage::COPY_DST);
        let film = buffer("film", size, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST);
        let readback = buffer("film readback", size, Usage::MAP_READ | Usage::COPY_DST);
        // Binding 0 is the header, 1 the settings, then the tables, last the film.
        let ordered =
            [&renderer.tables[0], &settings].into_iter().chain(&renderer.tables[1..]).chain([&film]);
        let entries: Vec<_> = (0..)
            .zip(ordered)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let bindings = renderer.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene and tile"),
            layout: &renderer.gpu.layout,
            entries: &entries,
        });
        TileBuffers { settings, film, readback, bindings }
    }
}

fn encoder(gpu: &Gpu, label: &'static str) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
}
