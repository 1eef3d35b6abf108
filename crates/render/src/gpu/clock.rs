//! What the graphics card's own clock says of launches.

use super::{Gpu, encoder, read};
use crate::DeviceError;
use std::time::Duration;

/// Launches that are timed before the times are fetched.
const LAUNCHES: u32 = 512;
/// Bytes of a time.
const TIME_BYTES: u64 = wgpu::QUERY_SIZE as u64;

/// Times of launches, begin and end of each.
pub(super) struct Clock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readback: wgpu::Buffer,
    /// Launches whose times are to be fetched.
    launches: u32,
}

impl Clock {
    /// `None` if the card has no clock.
    pub(super) fn new(gpu: &Gpu) -> Option<Self> {
        gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY).then(|| {
            let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("launch times"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * LAUNCHES,
            });
            use wgpu::BufferUsages as Usage;
            let size = TIME_BYTES * u64::from(2 * LAUNCHES);
            let buffer = |label, usage| {
                gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(label),
                    size,
                    usage,
                    mapped_at_creation: false,
                })
            };
            let resolved = buffer("launch times", Usage::QUERY_RESOLVE | Usage::COPY_SRC);
            let readback = buffer("launch times readback", Usage::MAP_READ | Usage::COPY_DST);
            Clock { queries, resolved, readback, launches: 0 }
        })
    }

    /// Whether times must be fetched before another launch.
    pub(super) fn is_full(&self) -> bool {
        self.launches == LAUNCHES
    }

    /// Times the next launch; must not be full.
    pub(super) fn next(&mut self) -> wgpu::ComputePassTimestampWrites<'_> {
        let begin = 2 * self.launches;
        self.launches += 1;
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(begin + 1),
        }
    }

    /// Forgets what was not fetched.
    pub(super) fn forget(&mut self) {
        self.launches = 0;
    }

    /// Time of all launches since the last call; waits until they are done.
    pub(super) fn fetch(&mut self, gpu: &Gpu) -> Result<Duration, DeviceError> {
        const DOING: &str = "reading its clock";
        if self.launches == 0 {
            return Ok(Duration::ZERO);
        }
        let count = 2 * std::mem::take(&mut self.launches);
        let bytes = TIME_BYTES * u64::from(count);
        let mut encoder = encoder(gpu, "read the clock");
        encoder.resolve_query_set(&self.queries, 0..count, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readback, 0, bytes);
        gpu.queue.submit([encoder.finish()]);
        let times = read(gpu, &self.readback, bytes, DOING, |view| {
            let times = view.as_chunks::<{ TIME_BYTES as usize }>().0.iter();
            times.map(|time| u64::from_le_bytes(*time)).collect::<Vec<u64>>()
        })?;
        let nanoseconds = ticks(&times) as f64 * f64::from(gpu.queue.get_timestamp_period());
        // Clocks that were set back make nonsense of a difference.
        Ok(Duration::try_from_secs_f64(nanoseconds * 1e-9).unwrap_or_default())
    }
}

/// Ticks in which there was something to do, given the begin and the end of every launch in their order. What overlaps
/// counts once: the next launch may be begun while the last one ends.
fn ticks(times: &[u64]) -> u64 {
    let mut last_end = 0;
    let mut sum: u64 = 0;
    for &[begin, end] in times.as_chunks::<2>().0 {
        sum = sum.saturating_add(end.saturating_sub(begin.max(last_end)));
        last_end = end.max(last_end);
    }
    sum
}

#[cfg(test)]
mod tests {
    #[test]
    fn pauses_do_not_count_and_overlaps_count_once() {
        assert_eq!(super::ticks(&[]), 0);
        assert_eq!(super::ticks(&[10, 20, 15, 30, 40, 45]), 25);
        // A clock that is set back.
        assert_eq!(super::ticks(&[100, 120, 5, 10]), 20);
    }
}
