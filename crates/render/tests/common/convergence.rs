//! How the error of a picture falls with the number of samples.

use super::garden::garden;
use super::{Builder, at, go_on, settings};
use rayon::prelude::*;
use render::{CropWindow, DeviceChoice, Film, LoadedScene, RenderSettings, Sampler, compile, open_device};
use scene::{DVec3, Emission, Scene, Shape};
use std::sync::Arc;

/// Samples per pixel: over four decades.
pub const SAMPLES: [u32; 8] = [1, 4, 16, 64, 256, 1024, 4096, 16384];
/// Width and height of the pictures in pixels. Only every 32nd pixel in both directions is looked at: as large as
/// those of an ordinary picture, and yet few.
const EDGE: u32 = 96;
const STEP: u32 = 32;

/// The scenes: name, what it shows, depth of the paths.
pub fn scenes() -> [(&'static str, Scene, u32); 3] {
    [("soft shadow", soft_shadow(), 1), ("box", closed_box(), 4), ("foliage", garden(), 4)]
}

/// The shadow of a square in the light of a square lamp.
fn soft_shadow() -> Scene {
    let mut b = Builder::new();
    let white = b.diffuse([0.8; 3]);
    let black = b.diffuse([0.0; 3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), white);
    b.rectangle(DVec3::new(0.0, 0.0, 1.0), (0.8, 0.8), true, black);
    b.rectangle(DVec3::new(0.0, 0.0, 3.0), (1.0, 1.0), false, black).emission =
        Some(Emission { power: [40.0; 3], exponent: 1.0, shadowless: false });
    b.look(DVec3::new(1.2, -2.0, 1.2), DVec3::new(0.4, 0.0, 0.0), DVec3::Z, 25.0);
    b.scene
}

/// A room with coloured walls, two blocks and a lamp under the ceiling, open towards the camera.
fn closed_box() -> Scene {
    let mut b = Builder::new();
    let white = b.diffuse([0.7; 3]);
    let red = b.diffuse([0.6, 0.1, 0.1]);
    let green = b.diffuse([0.1, 0.5, 0.1]);
    let black = b.diffuse([0.0; 3]);
    // Local origins of boxes are in the middle of their base.
    let mut block = |centre: (f64, f64, f64), size: (f64, f64, f64), material| {
        let shape = Shape::Box { width: size.0, height: size.1, length: size.2 };
        b.object(shape, at(centre.0, centre.1, centre.2), material);
    };
    block((0.0, 0.0, -0.1), (2.2, 2.2, 0.1), white);
    block((0.0, 0.0, 2.0), (2.2, 2.2, 0.1), white);
    block((0.0, 1.05, 0.0), (2.2, 0.1, 2.0), white);
    block((-1.05, 0.0, 0.0), (0.1, 2.0, 2.0), red);
    block((1.05, 0.0, 0.0), (0.1, 2.0, 2.0), green);
    block((-0.4, 0.3, 0.0), (0.6, 0.6, 1.2), white);
    block((0.4, -0.2, 0.0), (0.6, 0.6, 0.6), white);
    b.rectangle(DVec3::new(0.0, 0.0, 1.98), (0.6, 0.6), false, black).emission =
        Some(Emission { power: [20.0; 3], exponent: 1.0, shadowless: false });
    b.look(DVec3::new(0.0, -4.0, 1.0), DVec3::new(0.0, 0.0, 1.0), DVec3::Z, 35.0);
    b.scene
}

/// What was measured for one scene and one sampler.
pub struct Curve {
    /// For every seed the error at each of [`SAMPLES`]: root mean square over pixels and channels, relative to the
    /// picture's mean.
    pub errors: Vec<Vec<f64>>,
    /// Mean of the picture with most samples for every seed.
    pub means: Vec<f64>,
}

impl Curve {
    /// Root mean square of the errors of all seeds.
    pub fn error(&self, step: usize) -> f64 {
        let sum: f64 = self.errors.iter().map(|errors| errors[step].powi(2)).sum();
        (sum / self.errors.len() as f64).sqrt()
    }

    /// The exponent with which errors fall, from the step `first` on: mean over the seeds and its standard error.
    pub fn slope(&self, first: usize) -> (f64, f64) {
        let slopes: Vec<f64> = self.errors.iter().map(|errors| slope(&errors[first..])).collect();
        mean_and_standard_error(&slopes)
    }
}

/// Mean of some values and the standard error of that mean.
pub fn mean_and_standard_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0) / n).sqrt())
}

/// Slope of the straight line through the logarithms of errors, each at four times the samples of the one before.
fn slope(errors: &[f64]) -> f64 {
    let n = errors.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let numbered = || errors.iter().enumerate().map(|(i, error)| (i as f64 - middle, error.ln()));
    let covariance: f64 = numbered().map(|(x, y)| x * y).sum();
    let variance: f64 = numbered().map(|(x, _)| x * x).sum();
    covariance / variance / 4f64.ln()
}

fn values(film: &Film) -> Vec<f64> {
    film.radiances().flatten().map(f64::from).collect()
}

/// Measures both samplers, the independent one first, against the mean of as many Sobol pictures with most samples
/// and other seeds: its own error adds a tenth to that of the last Sobol picture.
pub fn measure(scene: &Scene, depth: u32, steps: usize, seeds: u32) -> [Curve; 2] {
    let compiled = Arc::new(compile(scene).unwrap());
    // Single pixels leave nothing to share out: the seeds are spread over the threads instead.
    let load = || open_device(DeviceChoice::Cpu, Some(1)).unwrap().load(Arc::clone(&compiled)).unwrap();
    let render = |loaded: &dyn LoadedScene, sampler, samples, seed| {
        let pixels = (0..EDGE * EDGE / (STEP * STEP)).flat_map(|i| {
            let (column, row) = (i % (EDGE / STEP), i / (EDGE / STEP));
            let at = |number| number * STEP + STEP / 2;
            let crop = Some(CropWindow { x: at(column), y: at(row), width: 1, height: 1 });
            let settings =
                RenderSettings { sampler, seed, crop, grid: 1, ..settings(EDGE, EDGE, samples, depth) };
            values(&loaded.render(&settings, &go_on).unwrap())
        });
        pixels.collect::<Vec<f64>>()
    };
    let mean = |picture: &[f64]| picture.iter().sum::<f64>() / picture.len() as f64;
    let most = SAMPLES[steps - 1];
    let references: Vec<Vec<f64>> = (0..seeds)
        .into_par_iter()
        .map(|seed| render(&*load(), Sampler::Sobol, most, 1_000_000 + seed))
        .collect();
    let reference: Vec<f64> = (0..references[0].len())
        .map(|i| references.iter().map(|picture| picture[i]).sum::<f64>() / f64::from(seeds))
        .collect();
    let level = mean(&reference);
    let square_error = |picture: &[f64]| {
        let squares: Vec<f64> = picture.iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).collect();
        mean(&squares) / (level * level)
    };
    [Sampler::Independent, Sampler::Sobol].map(|sampler| {
        let runs: Vec<(Vec<f64>, f64)> = (0..seeds)
            .into_par_iter()
            .map(|seed| {
                let loaded = load();
                let mut last = 0.0;
                let errors = SAMPLES[..steps].iter().map(|&samples| {
                    // Rare bright samples are often missed by few: small pictures are made several times.
                    let repetitions = (256 / samples).max(1);
                    let squares: Vec<f64> = (0..repetitions)
                        .map(|repetition| {
                            let picture = render(&*loaded, sampler, samples, seed + seeds * repetition);
                            last = mean(&picture);
                            square_error(&picture)
                        })
                        .collect();
                    mean(&squares).sqrt()
                });
                (errors.collect(), last)
            })
            .collect();
        let (errors, means) = runs.into_iter().unzip();
        Curve { errors, means }
    })
}
