//! What a tile needs on a graphics card besides the scene.

use super::clock::Clock;
use super::{Gpu, Joiner};
use crate::DeviceError;
use kernels::records::kernel::LaunchSettings;
use std::sync::Mutex;

/// Most bytes of all films of a tile, that on the way back included.
pub(super) const MOST_BYTES: u64 = 256 << 20;

/// A tile's memory on the card, from one batch of samples to the next: making memory that both sides see takes longer
/// than many samples. Whoever renders takes it and brings it back. How many samples a launch takes is learnt anew: the
/// next picture may be larger, deeper or closer.
#[derive(Default)]
pub(super) struct KeptTile(Mutex<Option<TileMemory>>);

impl KeptTile {
    /// Takes the memory if it suffices, else makes some: for so many films of so many bytes. The first one comes back.
    pub(super) fn take(
        &self,
        gpu: &Gpu,
        tables: &[wgpu::Buffer],
        films: usize,
        bytes: u64,
    ) -> Result<TileMemory, DeviceError> {
        let suffices =
            |kept: &TileMemory| kept.bytes >= bytes && (films as u64 + 1) * kept.bytes <= MOST_BYTES;
        let kept = self.0.lock().ok().and_then(|mut kept| kept.take()).filter(suffices);
        let mut memory = match kept {
            Some(memory) => memory,
            None => gpu.allocated(WHAT, 2 * bytes, || TileMemory::new(gpu, bytes))?,
        };
        if memory.films.len() < films {
            let more = (films - memory.films.len()) as u64 * memory.bytes;
            let joiner = if films > 1 { Some(gpu.joiner()?) } else { None };
            gpu.allocated(WHAT, more, || memory.grow(gpu, tables, films, joiner))?;
        }
        Ok(memory)
    }

    pub(super) fn bring_back(&self, mut memory: TileMemory) {
        if let Some(clock) = &mut memory.clock {
            clock.forget();
        }
        if let Ok(mut kept) = self.0.lock() {
            *kept = Some(memory);
        }
    }
}

/// In messages.
const WHAT: &str = "a tile of the picture";

/// Films of a tile and what the kernels are bound to.
pub(super) struct TileMemory {
    pub settings: wgpu::Buffer,
    /// The sums of the tile; behind them those of blocks that wait to be added.
    pub films: Vec<Film>,
    /// Through which the first film comes back.
    pub readback: wgpu::Buffer,
    pub clock: Option<Clock>,
    /// Size of each film.
    bytes: u64,
}

/// A film of a tile.
pub(super) struct Film {
    pub buffer: wgpu::Buffer,
    /// To the kernels that render.
    pub bindings: wgpu::BindGroup,
    /// To the kernel that adds it to the film before it; the first one has none.
    pub joining: Option<wgpu::BindGroup>,
}

use wgpu::BufferUsages as Usage;

fn buffer(gpu: &Gpu, label: &'static str, size: u64, usage: Usage) -> wgpu::Buffer {
    let label = Some(label);
    gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
}

impl TileMemory {
    fn new(gpu: &Gpu, bytes: u64) -> Self {
        let settings_bytes = size_of::<LaunchSettings>() as u64;
        TileMemory {
            settings: buffer(gpu, "launch settings", settings_bytes, Usage::UNIFORM | Usage::COPY_DST),
            films: Vec::new(),
            readback: buffer(gpu, "film readback", bytes, Usage::MAP_READ | Usage::COPY_DST),
            clock: Clock::new(gpu),
            bytes,
        }
    }

    fn grow(&mut self, gpu: &Gpu, tables: &[wgpu::Buffer], films: usize, joiner: Option<&Joiner>) {
        while self.films.len() < films {
            let film = buffer(gpu, "film", self.bytes, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST);
            // Binding 0 is the header, 1 the settings, then the tables, last the film.
            let ordered = [&tables[0], &self.settings].into_iter().chain(&tables[1..]).chain([&film]);
            let entries: Vec<_> = (0..)
                .zip(ordered)
                .map(|(binding, buffer)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("scene and tile"),
                layout: &gpu.layout,
                entries: &entries,
            });
            let joining = self
                .films
                .last()
                .zip(joiner)
                .map(|(before, joiner)| joiner.bind(gpu, &self.settings, &before.buffer, &film));
            self.films.push(Film { buffer: film, bindings, joining });
        }
    }
}
