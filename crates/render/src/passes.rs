//! Pass after pass over the whole picture, until a time is over or the picture is clean enough.
//!
//! Nobody knows beforehand how many samples that takes, so Sobol sequences are planned for the most that there may be.
//! Every leading power of two of them is well distributed, so a pixel's error is that of a sequence planned for the
//! number that is reached in the end, where shorter sequences one after another are independent of each other: 64
//! after 64 have 1.6 times the error at 256 to 4096 samples in the soft shadow of `docs/convergence`, 1.2 times in its
//! box. What is lost is that errors of neighbouring pixels are opposed, which needs the exact number.

use crate::{Batch, ControlFlow, DeviceError, Film, FilmSums, LoadedScene, Progress, RenderSettings};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// When to stop; at the first of all that is given. At least one pass is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRule {
    /// No pass is begun that would probably end after this time.
    pub time: Option<Duration>,
    /// The estimated relative error, see [`relative_noise`].
    pub noise: Option<f64>,
    /// Most samples per pixel.
    pub most_samples: u32,
}

impl StopRule {
    /// Most samples per pixel when nothing else is said: sums of 32-bit floats gain nothing beyond.
    pub const MOST_SAMPLES: u32 = 1 << 20;

    /// Samples of the next pass, given how many there are, how many of them were taken in which time, and how noisy
    /// the picture is; 0 to stop.
    ///
    /// The number of samples doubles from pass to pass, so that looking at the noise costs little, but neither the
    /// time nor what the noise needs by its law of 1/√n is overshot.
    pub fn next_pass(&self, samples: u32, taken: u32, elapsed: Duration, noise: Option<f64>) -> u32 {
        if samples == 0 {
            return 1.min(self.most_samples);
        }
        let mut pass = samples.min(self.most_samples.saturating_sub(samples));
        if let Some(limit) = self.time {
            let left = limit.saturating_sub(elapsed).as_secs_f64();
            // One to learn how long it takes.
            if taken == 0 {
                return pass.min(1);
            }
            let per_sample = elapsed.as_secs_f64() / f64::from(taken);
            // Saturates; without a measurable time per sample nothing is in the way.
            pass = pass.min((left / per_sample.max(1e-12)) as u32);
        }
        // The variance of a few samples tells nothing.
        if let (Some(level), Some(noise)) = (self.noise, noise)
            && samples >= LEAST_SAMPLES
        {
            if noise <= level {
                return 0;
            }
            let needed = f64::from(samples) * (noise / level).powi(2);
            pass = pass.min(((needed - f64::from(samples)).ceil() as u32).max(1));
        }
        pass
    }

    /// The settings with sequences planned for the most samples.
    pub fn planned(&self, settings: &RenderSettings) -> RenderSettings {
        RenderSettings { samples: self.most_samples, ..settings.clone() }
    }
}

/// Samples per pixel before the noise is looked at.
const LEAST_SAMPLES: u32 = 16;
/// Share of the noisiest pixels that [`relative_noise`] leaves out.
const TRIMMED: f64 = 0.01;

/// Estimated relative error of a picture: the root mean square over the pixels of the standard error of their
/// luminance divided by their luminance, to which 5 % of the picture's mean luminance is added, so that the dark
/// parts, whose noise nobody sees, do not count for most. The worst 1 % of the pixels is left out. 0 for a black
/// picture; infinite with fewer than two samples.
///
/// The standard error of the luminance is that of fully correlated channels, which is the largest that it can be.
pub fn relative_noise(film: &Film) -> f64 {
    const WEIGHTS: [f32; 3] = [0.2126, 0.7152, 0.0722];
    let luminance = |c: [f32; 3]| f64::from((0..3).map(|i| WEIGHTS[i] * c[i]).sum::<f32>());
    let count = film.pixels.len().max(1) as f64;
    let mean = film.radiances().map(luminance).filter(|l| l.is_finite()).sum::<f64>() / count;
    if mean <= 0.0 {
        return 0.0;
    }
    if film.pixels.iter().all(|pixel| pixel.samples < 2) {
        return f64::INFINITY;
    }
    let mut errors: Vec<f64> = film
        .radiances()
        .zip(film.variances_of_mean())
        .map(|(radiance, variance)| {
            let error = luminance(variance.map(f32::sqrt)) / (luminance(radiance).max(0.0) + 0.05 * mean);
            error * error
        })
        .filter(|squared| squared.is_finite())
        .collect();
    let kept = ((errors.len() as f64 * (1.0 - TRIMMED)).ceil() as usize).min(errors.len());
    if kept == 0 {
        return 0.0;
    }
    errors.select_nth_unstable_by(kept - 1, f64::total_cmp);
    (errors[..kept].iter().sum::<f64>() / kept as f64).sqrt()
}

/// How far a rendering goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Up to the sample of this number, which is not taken any more.
    Samples(u32),
    /// As far as a rule says.
    Rule(StopRule),
}

/// Why a rendering ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The goal is reached.
    Complete,
    /// Somebody asked to stop between two passes.
    Stopped,
}

/// Adds passes over the whole picture to `sums` until the goal is reached. `after` is asked between them whether to
/// go on: every few seconds, or for each sample where one of all pixels takes longer. `progress` hears of all samples
/// of the picture, those that were there before included. What comes out depends on the number of samples alone, not
/// on the passes.
///
/// The settings must be those that the rule planned.
///
/// # Errors
/// As [`LoadedScene::add_samples`]; all samples of finished passes are in `sums` nevertheless.
pub fn render_passes(
    scene: &dyn LoadedScene,
    settings: &RenderSettings,
    goal: Goal,
    sums: &mut FilmSums,
    progress: &Progress<'_>,
    after: &mut dyn FnMut(&FilmSums) -> ControlFlow<()>,
) -> Result<Ending, DeviceError> {
    let start = Instant::now();
    let before = sums.samples();
    let pixels = sums.pixels() as u64;
    let mut pace = PassPace::new(pixels);
    loop {
        let wanted = match goal {
            Goal::Samples(end) => end.saturating_sub(sums.end()),
            Goal::Rule(rule) => {
                let samples = sums.samples();
                // Looking at a picture takes time, too.
                let noise = rule.noise.filter(|_| samples > 0).map(|_| noise_so_far(settings, sums));
                rule.next_pass(samples, samples - before, start.elapsed(), noise)
            }
        };
        if wanted == 0 {
            return Ok(Ending::Complete);
        }
        let end = sums.end() + wanted;
        while sums.end() < end {
            let most = pace.samples.min(end - sums.end());
            let samples = match pace.is_rather_repeated(sums.begun()) {
                true => sums.room_anew(most),
                false => sums.room(most),
            };
            let done = pixels * u64::from(sums.samples());
            let watch = Watch::start();
            sums.add(scene, settings, &Batch::whole(settings), samples, &|more| {
                watch.note(more);
                progress(done + more)
            })?;
            pace.learn(&watch.finish(pixels, samples));
            if after(sums).is_break() {
                return Ok(if sums.end() < end { Ending::Stopped } else { Ending::Complete });
            }
        }
    }
}

fn noise_so_far(settings: &RenderSettings, sums: &FilmSums) -> f64 {
    let window = settings.window();
    relative_noise(&Film { width: window.width, height: window.height, pixels: sums.total() })
}

/// Samples per pixel that are taken before somebody is asked whether to go on.
pub(crate) struct PassPace {
    pub samples: u32,
    last: PassTime,
}

impl PassPace {
    /// Long enough that the time between passes, when a graphics card has nothing to do, does not count; short enough
    /// for somebody who waits after asking to stop.
    const SECONDS: f64 = 2.0;
    /// Samples of the first pass in all pixels together, when nothing is known yet: a blink for a graphics card, some
    /// seconds for a small processor.
    const FIRST: u64 = 1 << 22;

    pub fn new(pixels: u64) -> Self {
        let samples = u32::try_from(Self::FIRST / pixels.max(1)).unwrap_or(u32::MAX).max(1);
        PassPace { samples, last: PassTime::default() }
    }

    pub fn learn(&mut self, pass: &PassTime) {
        // Saturates.
        self.samples = ((Self::SECONDS / pass.sample.max(1e-9)) as u32).max(1);
        self.last = *pass;
    }

    /// Whether so many samples per pixel take less time than bringing their film to the device and back.
    fn is_rather_repeated(&self, samples: u32) -> bool {
        f64::from(samples) * self.last.sample < self.last.once
    }
}

/// Seconds of a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PassTime {
    /// For a sample of all pixels.
    sample: f64,
    /// For what is done once, however many samples there are.
    once: f64,
}

/// How fast a pass goes.
pub(crate) struct Watch {
    start: Instant,
    /// The first and the last report: when, and how many samples of all pixels were done.
    reports: Mutex<Option<[(Instant, u64); 2]>>,
}

impl Watch {
    pub fn start() -> Self {
        Watch { start: Instant::now(), reports: Mutex::new(None) }
    }

    pub fn note(&self, samples: u64) {
        let mut reports = self.reports.lock().unwrap_or_else(PoisonError::into_inner);
        let now = (Instant::now(), samples);
        match &mut *reports {
            None => *reports = Some([now, now]),
            // Reports of several threads may overtake each other.
            Some([_, last]) if samples > last.1 => *last = now,
            Some(_) => {}
        }
    }

    /// The time of so many samples of so many pixels.
    pub fn finish(self, pixels: u64, samples: u32) -> PassTime {
        let all = self.start.elapsed().as_secs_f64();
        let reports = self.reports.into_inner().unwrap_or_else(PoisonError::into_inner);
        let between =
            reports.map(|[first, last]| ((last.0 - first.0).as_secs_f64(), (last.1 - first.1) as f64));
        pass_time(all, f64::from(samples), between, pixels as f64)
    }
}

/// Divides the seconds of a pass, given those between its first report and its last with the samples of all pixels that
/// were taken meanwhile. If that is nothing to judge by, all of it is for the samples.
fn pass_time(all: f64, samples: f64, between: Option<(f64, f64)>, pixels: f64) -> PassTime {
    /// Shorter times are those of the clock.
    const SHORTEST: f64 = 2e-4;
    match between.filter(|(time, taken)| *time >= SHORTEST && 2.0 * taken >= samples * pixels) {
        Some((time, taken)) => {
            let sample = time / taken * pixels;
            PassTime { sample, once: (all - samples * sample).max(0.0) }
        }
        None => PassTime { sample: all / samples.max(1.0), once: 0.0 },
    }
}

/// Renders passes until the rule says stop; the number of samples is that of the rule, not of the settings.
/// `progress` hears of the samples of the whole picture, whose number nobody knows beforehand.
///
/// # Errors
/// As [`LoadedScene::add_samples`].
pub fn render_until(
    scene: &dyn LoadedScene,
    settings: &RenderSettings,
    rule: StopRule,
    progress: &Progress<'_>,
) -> Result<Film, DeviceError> {
    let settings = &rule.planned(settings);
    let window = settings.window();
    let mut sums = FilmSums::new(Batch::whole(settings).pixels(settings), 0);
    let go_on = &mut |_: &FilmSums| ControlFlow::Continue(());
    render_passes(scene, settings, Goal::Rule(rule), &mut sums, progress, go_on)?;
    Ok(Film { width: window.width, height: window.height, pixels: sums.into_total() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn passes_double_and_end_at_the_most_samples() {
        let rule = StopRule { time: None, noise: None, most_samples: 21 };
        let mut samples = 0;
        let mut passes = Vec::new();
        loop {
            let pass = rule.next_pass(samples, samples, SECOND, None);
            if pass == 0 {
                break;
            }
            passes.push(pass);
            samples += pass;
        }
        assert_eq!(passes, [1, 1, 2, 4, 8, 5]);
    }

    #[test]
    fn a_time_is_not_overshot_but_the_first_pass_is_made() {
        let rule = StopRule { time: Some(10 * SECOND), noise: None, most_samples: StopRule::MOST_SAMPLES };
        assert_eq!(rule.next_pass(0, 0, 20 * SECOND, None), 1);
        assert_eq!(rule.next_pass(1, 1, 20 * SECOND, None), 0);
        assert_eq!(rule.next_pass(4, 4, 2 * SECOND, None), 4);
        // 1 s a sample and 3 s left.
        assert_eq!(rule.next_pass(7, 7, 7 * SECOND, None), 3);
        assert_eq!(rule.next_pass(7, 7, 9 * SECOND + SECOND / 2, None), 0);
        // Continued: the time is that of the new samples.
        assert_eq!(rule.next_pass(100, 0, Duration::ZERO, None), 1);
        assert_eq!(rule.next_pass(107, 7, 7 * SECOND, None), 3);
    }

    #[test]
    fn what_is_done_once_says_nothing_about_the_next_pass() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        // 4 samples of 100 pixels in 40 ms; the last 3 of them took 3 ms.
        let pass = pass_time(0.040, 4.0, Some((0.003, 300.0)), 100.0);
        assert!(near(pass.sample, 0.001) && near(pass.once, 0.036), "{pass:?}");
        let mut pace = PassPace::new(100);
        assert!(!pace.is_rather_repeated(0) && !pace.is_rather_repeated(4));
        pace.learn(&pass);
        assert_eq!(pace.samples, 2000);
        assert!(pace.is_rather_repeated(4) && !pace.is_rather_repeated(40));
        // One report, or most of it before the first one: then all of the time is for the samples.
        for between in [None, Some((0.0, 0.0)), Some((0.001, 100.0)), Some((0.0001, 300.0))] {
            let pass = pass_time(0.040, 4.0, between, 100.0);
            assert!(near(pass.sample, 0.010) && pass.once == 0.0, "{pass:?}");
        }
    }

    #[test]
    fn noise_is_approached_by_its_law() {
        let rule = StopRule { time: None, noise: Some(0.1), most_samples: StopRule::MOST_SAMPLES };
        assert_eq!(rule.next_pass(16, 16, SECOND, Some(0.1)), 0);
        assert_eq!(rule.next_pass(16, 16, SECOND, Some(0.125)), 9);
        assert_eq!(rule.next_pass(16, 16, SECOND, Some(1.0)), 16);
        // Few samples may look clean by chance.
        assert_eq!(rule.next_pass(4, 4, SECOND, Some(0.0)), 4);
    }

    #[test]
    fn noise_of_known_pixels() {
        let mut film = Film::new(100, 1);
        for pixel in &mut film.pixels {
            // Samples 0.9 and 1.1: mean 1, standard error of the mean 0.1.
            pixel.radiance = [2.0; 3].into();
            pixel.squares = [0.81 + 1.21; 3].into();
            pixel.samples = 2;
        }
        assert!((relative_noise(&film) - 0.1 / 1.05).abs() < 1e-5, "{}", relative_noise(&film));
        // One wild pixel of a hundred is left out, but for its part in the mean.
        film.pixels[7].squares = [1e6; 3].into();
        assert!((relative_noise(&film) - 0.1 / 1.05).abs() < 1e-5);
        assert_eq!(relative_noise(&Film::new(4, 4)), 0.0);
    }
}
