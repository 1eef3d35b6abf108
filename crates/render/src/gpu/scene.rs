//! A scene in the memory of a graphics card, rendered tile by tile.

use super::Gpu;
use crate::{CompiledScene, ControlFlow, DeviceError, Film, LoadedScene, Progress, RenderSettings};
use kernels::records::kernel::{FilmPixel, LaunchSettings};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// The scene's tables on the graphics card.
pub(super) struct GpuScene {
    gpu: Arc<Gpu>,
    tables: Vec<wgpu::Buffer>,
}

/// A launch should take about this long: long enough to keep the card busy, short enough for a desktop that
/// shares it, far below the two seconds after which systems reset it.
const LAUNCH_TIME: Duration = Duration::from_millis(80);
/// Edge of a tile in pixels on a graphics card, and on a rasteriser in software.
const TILE: u32 = 1024;
const SOFTWARE_TILE: u32 = 128;
/// Edge of the workgroup in the kernel.
const WORKGROUP: u32 = 8;

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
            usage: wgpu::BufferUsages::UNIFORM,
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
        Ok(GpuScene { gpu, tables })
    }
}

impl LoadedScene for GpuScene {
    fn render(&self, settings: &RenderSettings, progress: &Progress<'_>) -> Result<Film, DeviceError> {
        let window = settings.window();
        let mut film = Film::new(window.width, window.height);
        let edge = if self.gpu.is_software { SOFTWARE_TILE } else { TILE };
        let pipeline = self.gpu.pipeline(settings.renderer)?;
        let (width, height) = (edge.min(window.width), edge.min(window.height));
        let tile = TileBuffers::new(&self.gpu, pipeline, &self.tables, width, height);
        let mut pace = Pace { samples: 1 };
        let mut done = 0u64;
        for tile_y in (0..window.height).step_by(edge as usize) {
            for tile_x in (0..window.width).step_by(edge as usize) {
                let launch = LaunchSettings {
                    tile_x: window.x + tile_x,
                    tile_y: window.y + tile_y,
                    tile_width: edge.min(window.width - tile_x),
                    tile_height: edge.min(window.height - tile_y),
                    ..settings.launch()
                };
                let pixels = tile.render(&self.gpu, launch, &mut pace, &mut |samples| {
                    done += samples;
                    progress(done)
                })?;
                for (row, line) in pixels.chunks(launch.tile_width as usize).enumerate() {
                    let start = (tile_y as usize + row) * window.width as usize + tile_x as usize;
                    film.pixels[start..start + line.len()].copy_from_slice(line);
                }
            }
        }
        Ok(film)
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
    pipeline: wgpu::ComputePipeline,
    settings: wgpu::Buffer,
    film: wgpu::Buffer,
    /// Through which the film comes back.
    readback: wgpu::Buffer,
    bindings: wgpu::BindGroup,
}

impl TileBuffers {
    fn new(
        gpu: &Gpu,
        pipeline: &wgpu::ComputePipeline,
        tables: &[wgpu::Buffer],
        width: u32,
        height: u32,
    ) -> Self {
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        let size = u64::from(width) * u64::from(height) * size_of::<FilmPixel>() as u64;
        let settings =
            buffer("launch settings", size_of::<LaunchSettings>() as u64, Usage::UNIFORM | Usage::COPY_DST);
        let film = buffer("film", size, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST);
        let readback = buffer("film readback", size, Usage::MAP_READ | Usage::COPY_DST);
        // Binding 0 is the header, 1 the settings, then the tables, last the film.
        let ordered = [&tables[0], &settings].into_iter().chain(&tables[1..]).chain([&film]);
        let entries: Vec<_> = (0..)
            .zip(ordered)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene and tile"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        TileBuffers { pipeline: pipeline.clone(), settings, film, readback, bindings }
    }

    /// Renders all samples of a tile, a few per launch; `report` hears of the samples done.
    fn render(
        &self,
        gpu: &Gpu,
        tile: LaunchSettings,
        pace: &mut Pace,
        report: &mut dyn FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Vec<FilmPixel>, DeviceError> {
        let pixels = u64::from(tile.tile_width) * u64::from(tile.tile_height);
        let size = pixels * size_of::<FilmPixel>() as u64;
        let mut encoder = encoder(gpu, "clear film");
        encoder.clear_buffer(&self.film, 0, None);
        gpu.queue.submit([encoder.finish()]);

        let mut first_sample = 0;
        while first_sample < tile.samples {
            let samples = pace.samples.min(tile.samples - first_sample);
            let launch = LaunchSettings { first_sample, samples, ..tile };
            gpu.queue.write_buffer(&self.settings, 0, bytemuck::bytes_of(&launch));
            let mut encoder = self::encoder(gpu, "render tile");
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some("render tile"),
                    timestamp_writes: None,
                });
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &self.bindings, &[]);
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
            first_sample += samples;
            if let ControlFlow::Break(()) = report(pixels * u64::from(samples)) {
                return Err(DeviceError::Cancelled);
            }
        }
        self.read_back(gpu, size)
    }

    fn read_back(&self, gpu: &Gpu, size: u64) -> Result<Vec<FilmPixel>, DeviceError> {
        const DOING: &str = "reading the picture back";
        let mut encoder = encoder(gpu, "read film back");
        encoder.copy_buffer_to_buffer(&self.film, 0, &self.readback, 0, size);
        gpu.queue.submit([encoder.finish()]);
        let (sender, receiver) = mpsc::channel();
        self.readback.map_async(wgpu::MapMode::Read, 0..size, move |result| {
            // The receiver is gone only if the wait below failed, which is reported there.
            let _ = sender.send(result);
        });
        wait(gpu, DOING)?;
        match receiver.recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(gpu.failed(DOING, error.to_string())),
            Err(error) => return Err(gpu.failed(DOING, error.to_string())),
        }
        let view =
            self.readback.get_mapped_range(0..size).map_err(|error| gpu.failed(DOING, error.to_string()))?;
        // A copy, because mapped memory need not be aligned for the record.
        let pixels = bytemuck::pod_collect_to_vec(&view[..]);
        drop(view);
        self.readback.unmap();
        Ok(pixels)
    }
}

fn encoder(gpu: &Gpu, label: &'static str) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
}

/// Waits until the card has done all its work.
fn wait(gpu: &Gpu, doing: &'static str) -> Result<(), DeviceError> {
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|error| gpu.failed(doing, error.to_string()))?;
    gpu.check(doing)
}
