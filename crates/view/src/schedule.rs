//! In which passes a picture becomes clean: coarse at once, then sharp, then more and more samples.

/// A piece of work after which there is something new to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// The picture is this much smaller in width and height; 1 for the picture itself.
    pub divisor: u32,
    /// Number of the first sample of every pixel.
    pub first_sample: u32,
    /// Samples for every pixel.
    pub samples: u32,
}

/// Time in seconds after which a moving picture should follow.
const MOVING: f64 = 0.05;
/// Time in seconds that a pass of a picture at rest may take.
const RESTING: f64 = 0.25;
/// Coarsest picture.
const COARSEST: u32 = 16;
/// Longest time in seconds until the first sharp picture, for which no coarser one is made.
const SHARP: f64 = 0.2;

/// Plans passes by how fast the last ones were.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// Samples of a pixel per second, of all pixels together.
    rate: f64,
    /// What has been made of this picture: divisor and samples.
    done: Option<(u32, u32)>,
}

impl Default for Schedule {
    fn default() -> Self {
        // A processor's; the first pass will tell.
        Schedule { rate: 1e6, done: None }
    }
}

impl Schedule {
    /// Another picture begins.
    pub fn restart(&mut self) {
        self.done = None;
    }

    /// Another device or renderer begins, whose speed is unknown.
    pub fn forget_rate(&mut self) {
        *self = Schedule::default();
    }

    /// The next pass of a picture of so many pixels that is to get so many samples; `None` if there is nothing more to
    /// do. A picture in motion is never made sharper than it can follow.
    pub fn next(&self, pixels: u64, samples: u32, is_moving: bool) -> Option<Pass> {
        let seconds = |divisor: u32| pixels as f64 / f64::from(divisor * divisor) / self.rate;
        match self.done {
            None => {
                // One that is fast enough, or the coarsest.
                let allowed = if is_moving { MOVING } else { SHARP };
                let powers = [1, 2, 4, 8, COARSEST];
                let divisor = powers.into_iter().find(|divisor| seconds(*divisor) <= allowed);
                let first = if is_moving { divisor } else { divisor.filter(|divisor| *divisor == 1) };
                let coarse = powers.into_iter().find(|divisor| seconds(*divisor) <= MOVING);
                let divisor = first.or(coarse).unwrap_or(COARSEST);
                Some(Pass { divisor, first_sample: 0, samples: self.samples(pixels, divisor, 0, samples) })
            }
            Some(_) if is_moving => None,
            Some((1, done)) if done >= samples => None,
            Some((1, done)) => {
                Some(Pass { divisor: 1, first_sample: done, samples: self.samples(pixels, 1, done, samples) })
            }
            Some((divisor, _)) => {
                let finer = [divisor / 4, divisor / 2]
                    .into_iter()
                    .find(|finer| *finer >= 1 && seconds(*finer) <= SHARP);
                // Sharp at last, however long it takes.
                let divisor = finer.unwrap_or(divisor / 2).max(1);
                Some(Pass { divisor, first_sample: 0, samples: 1 })
            }
        }
    }

    /// Samples that fit into the time of a pass.
    fn samples(&self, pixels: u64, divisor: u32, done: u32, samples: u32) -> u32 {
        if divisor > 1 || done == 0 {
            return 1.min(samples);
        }
        let fitting = (RESTING * self.rate / pixels.max(1) as f64) as u32;
        // The speed of a few samples says little of that of many.
        fitting.clamp(1, done.saturating_mul(4).max(1)).min(samples.saturating_sub(done))
    }

    /// Takes note of a pass that was made.
    pub fn made(&mut self, pass: Pass, pixels: u64, seconds: f64) {
        self.done = Some((pass.divisor, pass.first_sample + pass.samples));
        let samples =
            (pixels / u64::from(pass.divisor * pass.divisor)).max(1) as f64 * f64::from(pass.samples);
        let rate = samples / seconds.max(1e-5);
        // Passes differ: views through leaves are slower than those of the sky.
        self.rate = if rate < self.rate { rate } else { self.rate + 0.5 * (rate - self.rate) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Passes on a device with a given speed, until nothing is left.
    fn passes(rate: f64, pixels: u64, samples: u32) -> Vec<Pass> {
        let mut schedule = Schedule::default();
        let mut passes = Vec::new();
        while let Some(pass) = schedule.next(pixels, samples, false) {
            let made = pixels as f64 / f64::from(pass.divisor * pass.divisor) * f64::from(pass.samples);
            schedule.made(pass, pixels, made / rate);
            passes.push(pass);
            assert!(passes.len() < 1000);
        }
        passes
    }

    #[test]
    fn every_sample_is_taken_once_and_the_last_picture_is_sharp() {
        for (rate, samples) in [(1e4, 3), (1e6, 64), (1e9, 64), (1e9, 1)] {
            let sharp: Vec<_> =
                passes(rate, 300_000, samples).into_iter().filter(|pass| pass.divisor == 1).collect();
            let mut next = 0;
            for pass in sharp {
                assert_eq!(pass.first_sample, next);
                next += pass.samples;
            }
            assert_eq!(next, samples);
        }
    }

    #[test]
    fn slow_devices_show_something_coarse_first_and_get_sharper() {
        let divisors: Vec<_> = passes(1e5, 1_000_000, 1).into_iter().map(|pass| pass.divisor).collect();
        assert!(divisors[0] >= 4 && divisors.is_sorted_by(|a, b| a >= b), "{divisors:?}");
        assert_eq!(divisors.last(), Some(&1));
    }

    #[test]
    fn fast_devices_are_sharp_while_the_camera_moves() {
        let mut schedule = Schedule::default();
        let pixels = 1_000_000;
        for _ in 0..20 {
            schedule.restart();
            let pass = schedule.next(pixels, 64, true).unwrap();
            let samples = pixels / u64::from(pass.divisor * pass.divisor);
            schedule.made(pass, pixels, samples as f64 / 1e9);
            // Nothing more until the camera moves on or rests.
            assert_eq!(schedule.next(pixels, 64, true), None);
        }
        schedule.restart();
        assert_eq!(schedule.next(pixels, 64, true), Some(Pass { divisor: 1, first_sample: 0, samples: 1 }));
        schedule.made(Pass { divisor: 1, first_sample: 0, samples: 1 }, pixels, 1e-3);
        let rest = schedule.next(pixels, 64, false).unwrap();
        assert_eq!((rest.divisor, rest.first_sample), (1, 1));
    }

    #[test]
    fn passes_at_rest_stay_short() {
        for pass in passes(1e6, 100_000, 1000).into_iter().skip(4) {
            assert!(f64::from(pass.samples) * 0.1 <= 2.0 * RESTING, "{pass:?}");
        }
    }
}
