//! Launches of work on a graphics card: short ones, so that it can be shared, and the next one in time, so that it never
//! waits.

use super::Gpu;
use crate::{ControlFlow, DeviceError};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// A launch should take about this long: long enough to keep the card busy, short enough for a desktop that
/// shares it, far below the two seconds after which systems reset it.
const LAUNCH_TIME: Duration = Duration::from_millis(80);
/// Launches that the card has at a time: one that it works on, and the next.
const MOST_AT_A_TIME: usize = 2;

/// Launches on their way.
pub(super) struct Launches<'a> {
    gpu: &'a Gpu,
    pace: Pace,
    /// In the order of their submission.
    running: VecDeque<Launch>,
    /// When the last one ended.
    last_end: Instant,
    /// Hears of the samples of all pixels that were done.
    report: &'a mut dyn FnMut(u64) -> ControlFlow<()>,
}

struct Launch {
    submission: wgpu::SubmissionIndex,
    start: Instant,
    /// Per pixel, and of all pixels.
    samples: u32,
    all_samples: u64,
}

impl<'a> Launches<'a> {
    pub(super) fn new(gpu: &'a Gpu, report: &'a mut dyn FnMut(u64) -> ControlFlow<()>) -> Self {
        let pace = Pace { samples: 1 };
        Launches { gpu, pace, running: VecDeque::new(), last_end: Instant::now(), report }
    }

    /// Samples per pixel that the next launch should have.
    pub(super) fn samples(&self) -> u32 {
        self.pace.samples
    }

    /// Launches what takes samples for a number of pixels, and waits until only this is left to do.
    pub(super) fn submit(
        &mut self,
        encoder: wgpu::CommandEncoder,
        samples: u32,
        pixels: u64,
    ) -> Result<(), DeviceError> {
        let start = Instant::now();
        let submission = self.gpu.queue.submit([encoder.finish()]);
        let all_samples = pixels * u64::from(samples);
        self.running.push_back(Launch { submission, start, samples, all_samples });
        while self.running.len() >= MOST_AT_A_TIME {
            self.finish_first()?;
        }
        Ok(())
    }

    /// Waits until all is done.
    pub(super) fn finish(&mut self) -> Result<(), DeviceError> {
        while !self.running.is_empty() {
            self.finish_first()?;
        }
        Ok(())
    }

    fn finish_first(&mut self) -> Result<(), DeviceError> {
        const DOING: &str = "rendering";
        let Some(launch) = self.running.pop_front() else { return Ok(()) };
        self.gpu
            .device
            .poll(wgpu::PollType::Wait { submission_index: Some(launch.submission), timeout: None })
            .map_err(|error| self.gpu.failed(DOING, error.to_string()))?;
        self.gpu.check(DOING)?;
        let now = Instant::now();
        // It begins when the one before it ends.
        self.pace.learn(launch.samples, now - launch.start.max(self.last_end));
        self.last_end = now;
        match (self.report)(launch.all_samples) {
            ControlFlow::Break(()) => Err(DeviceError::Cancelled),
            ControlFlow::Continue(()) => Ok(()),
        }
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
