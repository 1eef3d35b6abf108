//! A batch that devices work at together: what is the same for all pieces of it.

use super::member::{Effort, Member};
use crate::{Batch, ControlFlow, DeviceError, LoadedScene, Progress, RenderSettings};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Adds a batch on one device, or sums it.
pub(super) type Work<'a, P> = dyn Fn(
        &(dyn LoadedScene + 'static),
        &RenderSettings,
        &Batch,
        &mut [P],
        &Progress<'_>,
    ) -> Result<(), DeviceError>
    + Sync
    + 'a;

/// A batch that is shared out.
pub(super) struct Job<'a> {
    pub settings: &'a RenderSettings,
    progress: &'a Progress<'a>,
    /// Samples of all devices.
    done: AtomicU64,
}

impl<'a> Job<'a> {
    pub fn new(settings: &'a RenderSettings, progress: &'a Progress<'a>) -> Self {
        Job { settings, progress, done: AtomicU64::new(0) }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.settings.window().width as usize
    }

    /// Does a piece of the work on a device. After an error its samples are not counted any more.
    pub fn compute<P>(
        &self,
        member: &Member,
        piece: &Batch,
        pixels: &mut [P],
        work: &Work<'_, P>,
    ) -> Result<Effort, DeviceError> {
        let tile = match member.tile.load(Ordering::Relaxed) {
            0 => self.settings.tile,
            edge => Some(edge),
        };
        let settings = RenderSettings { tile, ..self.settings.clone() };
        let reported = AtomicU64::new(0);
        let report = |samples: u64| -> ControlFlow<()> {
            // Reports of one device may overtake each other.
            let before = reported.fetch_max(samples, Ordering::Relaxed);
            let more = samples.saturating_sub(before);
            (self.progress)(self.done.fetch_add(more, Ordering::Relaxed) + more)
        };
        let start = Instant::now();
        let result = work(member.scene.as_ref(), &settings, piece, pixels, &report);
        if let Err(error) = result {
            self.done.fetch_sub(reported.into_inner(), Ordering::Relaxed);
            return Err(error);
        }
        let samples = pixels.len() as f64 * f64::from(piece.samples);
        let seconds = start.elapsed().as_secs_f64();
        tracing::trace!(
            "{}: {} rows from {}, {} samples from {}: {:.0} samples/s",
            member.name,
            piece.rows,
            piece.first_row,
            piece.samples,
            piece.first_sample,
            samples / seconds.max(1e-6)
        );
        Ok(Effort { samples, seconds })
    }
}
