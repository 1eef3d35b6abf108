//! How the error of a picture falls with the number of samples.

use super::garden::garden;
use super::{Builder, at, go_on, settings};
use rayon::prelude::*;
use render::{CropWindow, DeviceChoice, LoadedScene, RenderSettings, Sampler, compile, open_device};
use scene::{DVec3, Emission, Scene, Shape};
use std::sync::Arc;

/// Samples per pixel: over four decades.
pub const SAMPLES: [u32; 8] = [1, 4, 16, 64, 256, 1024, 4096, 16384];
/// Which pixels are looked at, and how often.
#[derive(Clone, Copy)]
pub struct Study {
    /// Width and height of the pictures in pixels.
    pub edge: u32,
    /// Only every so many-th pixel in both directions is rendered; 1 for whole pictures.
    pub step: u32,
    /// Pictures of every kind, each with its own seed.
    pub seeds: u32,
    /// The pixels of a picture are shared out, in rows, among so many parts whose errors are taken apart.
    pub parts: usize,
}

impl Study {
    /// Few pixels of an ordinary picture.
    pub const SHORT: Study = Study { edge: 96, step: 32, seeds: 4, parts: 1 };

    fn pixels(self) -> u32 {
        (self.edge / self.step).pow(2)
    }

    /// What is rendered of the picture.
    fn windows(self) -> Vec<Option<CropWindow>> {
        if self.step == 1 {
            return vec![None];
        }
        let columns = self.edge / self.step;
        let at = |number| number * self.step + self.step / 2;
        let pixel = |i| CropWindow { x: at(i % columns), y: at(i / columns), width: 1, height: 1 };
        (0..self.pixels()).map(|i| Some(pixel(i))).collect()
    }
}

/// The scenes: name, what it shows, depth of the paths.
pub fn scenes() -> [(&'static str, Scene, u32); 3] {
    [("soft shadow", soft_shadow(), 1), ("room", room(), 4), ("foliage", garden(), 4)]
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
fn room() -> Scene {
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
    /// For every part of every picture the error at each of [`SAMPLES`]: root mean square over pixels and channels,
    /// relative to the picture's mean.
    pub errors: Vec<Vec<f64>>,
    /// Mean of the picture with most samples for every seed.
    pub means: Vec<f64>,
}

impl Curve {
    /// Root mean square of the errors of all parts.
    pub fn error(&self, step: usize) -> f64 {
        let sum: f64 = self.errors.iter().map(|errors| errors[step].powi(2)).sum();
        (sum / self.errors.len() as f64).sqrt()
    }

    /// The exponent with which errors fall, from the step `first` on: mean over the parts and its standard error.
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

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Measures both samplers, the independent one first.
///
/// There are two references r and s, each the mean of as many Sobol pictures with most samples as the study has seeds,
/// all with seeds of their own. The square error of a picture a is estimated as (a - r)(a - s): its expected value is
/// the variance of a alone, because a, r and s are independent, so the noise of the references does not bend the curve
/// even where the picture is as good as they are.
pub fn measure(scene: &Scene, depth: u32, study: Study) -> [Curve; 2] {
    let compiled = Arc::new(compile(scene).unwrap());
    // Single pixels leave nothing to share out among threads: there the seeds are spread over them instead.
    let threads = if study.step == 1 { None } else { Some(1) };
    let load = || open_device(DeviceChoice::Cpu, threads).unwrap().load(Arc::clone(&compiled)).unwrap();
    let render = |loaded: &dyn LoadedScene, sampler, samples, seed| -> Vec<f64> {
        let values = study.windows().into_iter().flat_map(|crop| {
            let plain = settings(study.edge, study.edge, samples, depth);
            let settings = RenderSettings { sampler, seed, crop, grid: 1, ..plain };
            let film = loaded.render(&settings, &go_on).unwrap();
            film.radiances().flatten().map(f64::from).collect::<Vec<_>>()
        });
        values.collect()
    };
    let most = SAMPLES[SAMPLES.len() - 1];
    let pictures: Vec<Vec<f64>> = (0..2 * study.seeds)
        .into_par_iter()
        .map(|seed| render(&*load(), Sampler::Sobol, most, 1_000_000 + seed))
        .collect();
    let reference = |first: u32| -> Vec<f64> {
        let own = || pictures.iter().skip(first as usize).step_by(2);
        (0..pictures[0].len()).map(|i| mean(&own().map(|picture| picture[i]).collect::<Vec<_>>())).collect()
    };
    let references = [reference(0), reference(1)];
    let level = 0.5 * (mean(&references[0]) + mean(&references[1]));
    let square_errors = |picture: &[f64]| -> Vec<f64> {
        let squares: Vec<f64> = (0..picture.len())
            .map(|i| (picture[i] - references[0][i]) * (picture[i] - references[1][i]) / (level * level))
            .collect();
        squares.chunks(squares.len() / study.parts).map(mean).collect()
    };
    [Sampler::Independent, Sampler::Sobol].map(|sampler| {
        let runs: Vec<(Vec<Vec<f64>>, f64)> = (0..study.seeds)
            .into_par_iter()
            .map(|seed| {
                let loaded = load();
                let mut last = 0.0;
                let mut errors = vec![Vec::new(); study.parts];
                for samples in SAMPLES {
                    // Rare bright samples are often missed by few: small pictures are made several times.
                    let repetitions = (2304 / (samples * study.pixels())).clamp(1, 256);
                    let mut sums = vec![0.0; study.parts];
                    for repetition in 0..repetitions {
                        let picture = render(&*loaded, sampler, samples, seed + study.seeds * repetition);
                        last = mean(&picture);
                        for (sum, square) in sums.iter_mut().zip(square_errors(&picture)) {
                            *sum += square;
                        }
                    }
                    for (errors, sum) in errors.iter_mut().zip(sums) {
                        errors.push((sum / f64::from(repetitions)).sqrt());
                    }
                }
                (errors, last)
            })
            .collect();
        let (errors, means): (Vec<Vec<Vec<f64>>>, Vec<f64>) = runs.into_iter().unzip();
        Curve { errors: errors.concat(), means }
    })
}
