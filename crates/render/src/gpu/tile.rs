//! A picture on a graphics card, tile by tile, so that the memory taken there does not grow with the picture.

use super::launches::Launches;
use super::tile_memory::{KeptTile, MOST_BYTES, TileMemory};
use super::{Gpu, encoder, read};
use crate::{BLOCK_SAMPLES, Batch, DeviceError, Progress, RenderSettings};
use bytemuck::Pod;
use kernels::records::kernel::{FilmPixel, LaunchSettings};
use rayon::prelude::*;
use std::time::Duration;

/// Edge of a tile in pixels on a graphics card, and on a rasteriser in software.
const TILE: u32 = 1024;
const SOFTWARE_TILE: u32 = 128;
/// When memory is short, tiles become smaller down to this edge.
const SMALLEST_TILE: u32 = 64;
/// Most bytes of a film of a tile: what WebGPU guarantees for one binding.
const FILM_BYTES: u64 = 128 << 20;
/// Most samples that are summed on the card: seven films of the largest tile, and the one on the way back.
pub(super) const MOST_SAMPLES: u32 = 64 * BLOCK_SAMPLES;
/// Edge of the workgroup in the kernels.
const WORKGROUP: u32 = 8;

/// What is the same for all tiles of a picture.
pub(super) struct TileRenderer<'a> {
    pub gpu: &'a Gpu,
    pub pipeline: &'a wgpu::ComputePipeline,
    /// The scene: its header, then its tables.
    pub tables: &'a [wgpu::Buffer],
    pub settings: &'a RenderSettings,
    pub kept: &'a KeptTile,
}

/// What is done with the pixels of a tile.
enum Work<'a, P> {
    /// Samples are added to those that there are; how many launches of samples a tile needs.
    Add(&'a dyn Fn(&[P]) -> u32),
    /// They are overwritten by the sum of a node of the tree of [`crate::FilmSums`].
    Sum,
}

impl TileRenderer<'_> {
    /// Adds the samples of a batch to `pixels`; `most` tells how many launches of samples a tile needs. Returns what the
    /// card's clock says.
    pub(super) fn add<P: Pod>(
        &self,
        batch: &Batch,
        pixels: &mut [P],
        progress: &Progress<'_>,
        most: &dyn Fn(&[P]) -> u32,
    ) -> Result<Duration, DeviceError> {
        self.render(batch, 1, pixels, progress, &Work::Add(most))
    }

    /// Overwrites `pixels` with the sums of a node of at most [`MOST_SAMPLES`].
    pub(super) fn sum(
        &self,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<Duration, DeviceError> {
        let blocks = batch.samples.div_ceil(BLOCK_SAMPLES).max(1);
        // A left half waits at every level but the last, where the block is that is rendered.
        let films = blocks.next_power_of_two().ilog2() as usize + 1;
        self.render(batch, films, pixels, progress, &Work::Sum)
    }

    /// Width and height of the tiles with an edge; at the right and lower edge of the picture they may be smaller.
    fn tile_size(&self, edge: u32, batch: &Batch, films: usize, pixel_bytes: u64) -> (u32, u32) {
        let limits = self.gpu.device.limits();
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let limit = binding.min(FILM_BYTES).min(MOST_BYTES / (films as u64 + 1));
        let most = u32::try_from(limit / pixel_bytes).unwrap_or(u32::MAX).max(1);
        let width = edge.min(self.settings.window().width).min(most);
        (width, edge.min(batch.rows).min(most / width).max(1))
    }

    /// The size of the tiles, and memory for one. If there is too little, tiles become smaller.
    fn memory(
        &self,
        batch: &Batch,
        films: usize,
        pixel_bytes: u64,
    ) -> Result<((u32, u32), TileMemory), DeviceError> {
        let default = if self.gpu.is_software { SOFTWARE_TILE } else { TILE };
        let mut edge = self.settings.tile.unwrap_or(default).max(1);
        loop {
            let (width, height) = self.tile_size(edge, batch, films, pixel_bytes);
            let bytes = u64::from(width) * u64::from(height) * pixel_bytes;
            match self.kept.take(self.gpu, self.tables, films, bytes) {
                Err(DeviceError::OutOfMemory { .. }) if width.max(height) > SMALLEST_TILE => {
                    edge = width.max(height).div_ceil(2).max(SMALLEST_TILE);
                    tracing::debug!("{}: tiles of {edge} pixels, because memory is short", self.gpu.name);
                }
                result => return result.map(|memory| ((width, height), memory)),
            }
        }
    }

    fn render<P: Pod>(
        &self,
        batch: &Batch,
        films: usize,
        pixels: &mut [P],
        progress: &Progress<'_>,
        work: &Work<'_, P>,
    ) -> Result<Duration, DeviceError> {
        assert_eq!(pixels.len(), batch.pixels(self.settings), "pixels of a batch");
        if pixels.is_empty() {
            return Ok(Duration::ZERO);
        }
        let (size, mut memory) = self.memory(batch, films, size_of::<P>() as u64)?;
        let result = self.render_tiles(&mut memory, size, batch, pixels, progress, work);
        // What is still on its way is done before what comes next.
        if matches!(result, Ok(_) | Err(DeviceError::Cancelled)) {
            self.kept.bring_back(memory);
        }
        result
    }

    fn render_tiles<P: Pod>(
        &self,
        memory: &mut TileMemory,
        (tile_width, tile_height): (u32, u32),
        batch: &Batch,
        pixels: &mut [P],
        progress: &Progress<'_>,
        work: &Work<'_, P>,
    ) -> Result<Duration, DeviceError> {
        let width = self.settings.window().width;
        let mut done = 0u64;
        let mut report = |samples| {
            done += samples;
            progress(done)
        };
        let mut launches = Launches::new(self.gpu, &mut report);
        let mut time = Duration::ZERO;
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
                match work {
                    Work::Add(most) => {
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
                        let launch = LaunchSettings { samples: most(tile), ..launch };
                        self.send(memory, tile);
                        time += self.add_samples(memory, launch, None, &mut launches)?;
                    }
                    Work::Sum => time += self.sum_blocks(memory, launch, &mut launches)?,
                }
                launches.finish()?;
                let bytes = launch.tile_height as usize * line * size_of::<P>();
                self.read_back(memory, bytes as u64, |rendered| {
                    // As bytes, because mapped memory need not be aligned for the record.
                    if line == width as usize {
                        let first = y as usize * line;
                        let rows = &mut pixels[first..first + launch.tile_height as usize * line];
                        copy(bytemuck::cast_slice_mut(rows), rendered);
                        return;
                    }
                    for (start, row) in starts.clone().zip(rendered.chunks(line * size_of::<P>())) {
                        bytemuck::cast_slice_mut(&mut pixels[start..start + line]).copy_from_slice(row);
                    }
                })?;
            }
        }
        match &mut memory.clock {
            Some(clock) => Ok(time + clock.fetch(self.gpu)?),
            None => Ok(time),
        }
    }

    /// Brings the film of a tile to the card.
    fn send<P: Pod>(&self, memory: &TileMemory, tile: &[P]) {
        /// Bytes that are looked at at a time.
        const PIECE: usize = 1 << 14;
        let film = &memory.films[0].buffer;
        let bytes: &[u8] = bytemuck::cast_slice(tile);
        let is_empty = |piece: &[u8]| piece.iter().fold(0, |all, byte| all | byte) == 0;
        if !bytes.chunks(PIECE).all(is_empty) {
            self.gpu.queue.write_buffer(film, 0, bytes);
            return;
        }
        // Most films are empty at first; then nothing need travel.
        let mut encoder = encoder(self.gpu, "empty film");
        encoder.clear_buffer(film, 0, None);
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// Sums a node of the tree in the first film of a tile.
    fn sum_blocks(
        &self,
        memory: &mut TileMemory,
        tile: LaunchSettings,
        launches: &mut Launches<'_>,
    ) -> Result<Duration, DeviceError> {
        let mut time = Duration::ZERO;
        let mut waiting = 0;
        for number in 0..tile.samples.div_ceil(BLOCK_SAMPLES) {
            let before = number * BLOCK_SAMPLES;
            let block = LaunchSettings {
                first_sample: tile.first_sample + before,
                samples: BLOCK_SAMPLES.min(tile.samples - before),
                ..tile
            };
            // It is the right half of as many nodes as the next number is even times.
            let joins = (number + 1).trailing_zeros() as usize;
            time += self.add_samples(memory, block, Some(Place { film: waiting, joins }), launches)?;
            waiting = waiting + 1 - joins;
        }
        Ok(time)
    }

    /// Adds samples to a tile, a few per launch: to its first film, or as a block, in a new one.
    fn add_samples(
        &self,
        memory: &mut TileMemory,
        tile: LaunchSettings,
        block: Option<Place>,
        launches: &mut Launches<'_>,
    ) -> Result<Duration, DeviceError> {
        let gpu = self.gpu;
        let pixels = tile.tile_width * tile.tile_height;
        let mut time = Duration::ZERO;
        let mut done = 0;
        while done < tile.samples {
            if let Some(clock) = memory.clock.as_mut().filter(|clock| clock.is_full()) {
                launches.finish()?;
                time += clock.fetch(gpu)?;
            }
            let samples = launches.samples().min(tile.samples - done);
            let launch = LaunchSettings { first_sample: tile.first_sample + done, samples, ..tile };
            // Comes to the card between the last launch and this one.
            gpu.queue.write_buffer(&memory.settings, 0, bytemuck::bytes_of(&launch));
            let mut encoder = encoder(gpu, "render tile");
            let film = &memory.films[block.map_or(0, |block| block.film)];
            if block.is_some() && done == 0 {
                encoder.clear_buffer(&film.buffer, 0, None);
            }
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some("render tile"),
                    timestamp_writes: memory.clock.as_mut().map(|clock| clock.next()),
                });
                pass.set_pipeline(self.pipeline);
                pass.set_bind_group(0, &film.bindings, &[]);
                pass.dispatch_workgroups(
                    tile.tile_width.div_ceil(WORKGROUP),
                    tile.tile_height.div_ceil(WORKGROUP),
                    1,
                );
            }
            done += samples;
            if let Some(block) = block.filter(|block| block.joins > 0 && done == tile.samples) {
                let joiner = gpu.joiner()?;
                let joined = memory.films[..=block.film].iter().rev().take(block.joins);
                for films in joined.filter_map(|film| film.joining.as_ref()) {
                    joiner.join(&mut encoder, films, pixels);
                }
            }
            launches.submit(encoder, samples, u64::from(pixels))?;
        }
        Ok(time)
    }

    /// Lets `use_film` see the bytes of the first film of a tile.
    fn read_back(
        &self,
        memory: &TileMemory,
        size: u64,
        use_film: impl FnOnce(&[u8]),
    ) -> Result<(), DeviceError> {
        const DOING: &str = "reading the picture back";
        let gpu = self.gpu;
        let mut encoder = encoder(gpu, "read film back");
        encoder.copy_buffer_to_buffer(&memory.films[0].buffer, 0, &memory.readback, 0, size);
        gpu.queue.submit([encoder.finish()]);
        read(gpu, &memory.readback, size, DOING, use_film)
    }
}

/// A block among the films of a tile.
#[derive(Clone, Copy)]
struct Place {
    /// Number of the film that it is rendered in.
    film: usize,
    /// How often it is then added to the film before it, which takes its place.
    joins: usize,
}

/// Copies bytes on all threads: memory that a card has written comes slowly through one.
fn copy(target: &mut [u8], source: &[u8]) {
    /// Bytes that one thread takes at a time.
    const PIECE: usize = 1 << 20;
    target.par_chunks_mut(PIECE).zip(source.par_chunks(PIECE)).for_each(|(target, source)| {
        target.copy_from_slice(source);
    });
}
