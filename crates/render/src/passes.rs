//! Pass after pass over the whole picture, until a time is over or the picture is clean enough.
//!
//! Nobody knows beforehand how many samples that takes, so Sobol sequences are planned for the most that there may be.
//! Every leading power of two of them is well distributed, so a pixel's error is that of a sequence planned for the
//! number that is reached in the end, where shorter sequences one after another are independent of each other: 64
//! after 64 have 1.6 times the error at 256 to 4096 samples in the soft shadow of `docs/convergence`, 1.2 times in its
//! box. What is lost is that errors of neighbouring pixels are opposed, which needs the exact number.

use crate::{Batch, DeviceError, Film, LoadedScene, Progress, RenderSettings};
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

    /// Samples of the next pass, given how many were taken in which time and how noisy the picture is; 0 to stop.
    ///
    /// The number of samples doubles from pass to pass, so that looking at the noise costs little, but neither the
    /// time nor what the noise needs by its law of 1/√n is overshot.
    pub fn next_pass(&self, samples: u32, elapsed: Duration, noise: Option<f64>) -> u32 {
        if samples == 0 {
            return 1.min(self.most_samples);
        }
        let mut pass = samples.min(self.most_samples.saturating_sub(samples));
        if let Some(limit) = self.time {
            let left = limit.saturating_sub(elapsed).as_secs_f64();
            let per_sample = elapsed.as_secs_f64() / f64::from(samples);
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
    pub(crate) fn planned(&self, settings: &RenderSettings) -> RenderSettings {
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

/// Renders passes until the rule says stop; the number of samples is that of the rule, not of the settings.
/// `progress` hears of the samples of the whole picture, whose number
/// nobody knows beforehand.
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
    let mut film = Film::of(settings);
    let start = Instant::now();
    let (mut samples, mut done) = (0, 0);
    let mut noise = None;
    loop {
        let pass = rule.next_pass(samples, start.elapsed(), noise);
        if pass == 0 {
            return Ok(film);
        }
        let batch = Batch { first_sample: samples, samples: pass, ..Batch::whole(settings) };
        scene.add_samples(settings, &batch, &mut film.pixels, &|more| progress(done + more))?;
        samples += pass;
        done += film.pixels.len() as u64 * u64::from(pass);
        noise = rule.noise.map(|_| relative_noise(&film));
    }
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
            let pass = rule.next_pass(samples, SECOND, None);
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
        assert_eq!(rule.next_pass(0, 20 * SECOND, None), 1);
        assert_eq!(rule.next_pass(1, 20 * SECOND, None), 0);
        assert_eq!(rule.next_pass(4, 2 * SECOND, None), 4);
        // 1 s a sample and 3 s left.
        assert_eq!(rule.next_pass(7, 7 * SECOND, None), 3);
        assert_eq!(rule.next_pass(7, 9 * SECOND + SECOND / 2, None), 0);
    }

    #[test]
    fn noise_is_approached_by_its_law() {
        let rule = StopRule { time: None, noise: Some(0.1), most_samples: StopRule::MOST_SAMPLES };
        assert_eq!(rule.next_pass(16, SECOND, Some(0.1)), 0);
        assert_eq!(rule.next_pass(16, SECOND, Some(0.125)), 9);
        assert_eq!(rule.next_pass(16, SECOND, Some(1.0)), 16);
        // Few samples may look clean by chance.
        assert_eq!(rule.next_pass(4, SECOND, Some(0.0)), 4);
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
