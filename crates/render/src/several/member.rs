//! A device with the scene, and what it may be expected to do beside others.

use super::lock;
use crate::LoadedScene;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// A device with the scene.
pub(super) struct Member {
    pub name: String,
    pub scene: Box<dyn LoadedScene>,
    pub has_failed: AtomicBool,
    /// Edge of its tiles after a failure that smaller ones might avoid; 0 for those of the settings.
    pub tile: AtomicU32,
    speed: Mutex<Speed>,
}

/// How fast a device is.
#[derive(Default)]
struct Speed {
    /// Samples that it takes in a second; 0 if unknown.
    known: f64,
    /// What it did of the present batch.
    effort: Effort,
}

/// Work that was done.
#[derive(Clone, Copy, Default)]
#[must_use = "a device learns its speed by it"]
pub(super) struct Effort {
    /// Samples of all pixels.
    pub samples: f64,
    pub seconds: f64,
}

impl Member {
    pub fn new((name, scene): (String, Box<dyn LoadedScene>)) -> Self {
        Member {
            name,
            scene,
            has_failed: AtomicBool::new(false),
            tile: AtomicU32::new(0),
            speed: Mutex::default(),
        }
    }

    pub fn is_alive(&self) -> bool {
        !self.has_failed.load(Ordering::Relaxed)
    }

    /// Samples that it takes in a second; 0 if unknown.
    pub fn speed(&self) -> f64 {
        lock(&self.speed).known
    }

    /// Begins to work at another batch. Its speed stays that of the last one until something is done.
    pub fn begin(&self) {
        lock(&self.speed).effort = Effort::default();
    }

    /// Takes note of work. All of a batch counts together: small pieces, as the last ones are, leave a card half empty
    /// and say little.
    pub fn learn(&self, work: Effort) {
        let mut speed = lock(&self.speed);
        speed.effort.samples += work.samples;
        speed.effort.seconds += work.seconds;
        speed.known = speed.effort.samples / speed.effort.seconds.max(1e-6);
    }

    #[cfg(test)]
    pub fn set_speed(&self, samples_per_second: f64) {
        lock(&self.speed).known = samples_per_second;
    }
}

/// Slower than this share of the speed of the fastest, a device would be waited for.
const SLOW: f64 = 0.25;

/// How a device compares with the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Standing {
    /// What it does of the work of all; 1 if it is alone.
    pub share: f64,
    /// Its speed as a share of that of the fastest.
    pace: f64,
    /// The paces of all others that are not slow.
    others: f64,
}

impl Standing {
    /// Of a device that works by itself.
    pub const ALONE: Self = Standing { share: 1.0, pace: 1.0, others: 0.0 };

    /// Of the device of this number among all that work, given their speeds; 0 stands for one that is unknown.
    pub fn of(speeds: &[f64], number: usize) -> Self {
        if speeds.len() < 2 {
            return Self::ALONE;
        }
        let even = 1.0 / speeds.len() as f64;
        if speeds.iter().any(|speed| *speed <= 0.0) {
            // The first rows show how fast it is, so they are few.
            return Standing { share: even * 0.25, pace: 1.0, others: (speeds.len() - 1) as f64 };
        }
        let fastest = speeds.iter().copied().fold(0.0, f64::max);
        let paces: Vec<f64> = speeds.iter().map(|speed| speed / fastest).collect();
        let others = paces.iter().enumerate().filter(|(other, pace)| *other != number && **pace >= SLOW);
        let others = others.map(|(_, pace)| pace).sum();
        let pace = paces[number];
        // Below 1, which stands for a device that is alone.
        Standing { share: (pace / paces.iter().sum::<f64>()).clamp(0.0, 0.99), pace, others }
    }

    /// Whether the others would have to wait for it if it took as large a piece of work as they do.
    pub fn is_slow(&self) -> bool {
        self.pace < SLOW
    }

    /// Whether it ends one of `left` equal pieces of work no later than the others all of them, who have just begun one
    /// each.
    pub fn ends_in_time(&self, left: u32) -> bool {
        self.others / self.pace <= self.others + f64::from(left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_the_speeds() {
        let of = |speeds: &[f64]| -> Vec<f64> {
            (0..speeds.len()).map(|number| Standing::of(speeds, number).share).collect()
        };
        assert_eq!(of(&[7.0]), [1.0]);
        assert_eq!(of(&[2.0, 1.0, 1.0]), [0.5, 0.25, 0.25]);
        // A first look.
        assert_eq!(of(&[3.0, 0.0]), [0.125, 0.125]);
        assert_eq!(of(&[1e9, 1e-9])[0], 0.99);
    }

    #[test]
    fn a_slow_device_leaves_the_last_piece_to_others() {
        let standing = |number| Standing::of(&[10.0, 10.0, 4.0, 1.0], number);
        assert_eq!([0, 1, 2, 3].map(|number| standing(number).is_slow()), [false, false, false, true]);
        assert!(standing(0).ends_in_time(1) && standing(1).ends_in_time(1));
        assert!(!standing(2).ends_in_time(2) && standing(2).ends_in_time(3));
        assert!(Standing::ALONE.ends_in_time(1));
        // The fastest takes anything, or nobody would.
        assert!(Standing::of(&[10.0, 1.0], 0).ends_in_time(1));
    }
}
