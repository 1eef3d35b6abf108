//! The scattering function against its own sampling: directions follow the density (χ² test), weights are value over
//! density, reflection is reciprocal, and no more light leaves than arrives.

use kernels::bsdf::kernel::*;
use kernels::random::kernel::{independent_key, random4};
use wgsl_rs::std::*;

/// Not the pole of the bins below, where sharp lobes would fall between the points of a grid.
const NORMAL: Vec3f = Vec3f { x: 1.0, y: 0.0, z: 0.0 };

fn grey(value: f32) -> Vec3f {
    vec3f(value, value, value)
}

/// Every lobe by itself and all of them together, with and without refraction.
fn cases() -> Vec<(&'static str, Bsdf)> {
    let black = Bsdf {
        diffuse: grey(0.0),
        diffuse_transmission: grey(0.0),
        glossy: grey(0.0),
        exponent: 4.0,
        glossy_transmission: grey(0.0),
        transmission_exponent: 4.0,
        straight: grey(0.0),
        emissive: grey(0.0),
        eta: 1.0,
    };
    let all = Bsdf {
        diffuse: vec3f(0.2, 0.1, 0.3),
        diffuse_transmission: vec3f(0.1, 0.2, 0.1),
        glossy: grey(0.2),
        exponent: 30.0,
        glossy_transmission: grey(0.2),
        transmission_exponent: 12.0,
        ..black
    };
    vec![
        ("diffuse", Bsdf { diffuse: grey(0.7), ..black }),
        ("diffuse transmission", Bsdf { diffuse_transmission: grey(0.7), ..black }),
        ("wide gloss", Bsdf { glossy: grey(0.8), exponent: 0.5, ..black }),
        ("gloss", Bsdf { glossy: grey(0.8), exponent: 20.0, ..black }),
        ("sharp gloss", Bsdf { glossy: grey(0.8), exponent: 300.0, ..black }),
        (
            "blurred transmission",
            Bsdf { glossy_transmission: grey(0.8), transmission_exponent: 40.0, ..black },
        ),
        ("all lobes", all),
        ("all lobes into glass", Bsdf { eta: 1.0 / 1.5, ..all }),
        ("all lobes out of glass", Bsdf { eta: 1.5, ..all }),
    ]
}

/// Directions of the viewer from straight on to grazing.
fn viewers() -> [Vec3f; 3] {
    [0.05f32, 0.7, 1.4].map(|angle| vec3f(angle.cos(), angle.sin() * 0.8, angle.sin() * 0.6))
}

/// Bins in z and in the turn round it.
const RINGS: usize = 20;
const SECTORS: usize = 24;

fn bin(direction: Vec3f) -> usize {
    let ring = ((f64::from(direction.z) + 1.0) * 0.5 * RINGS as f64) as usize;
    let turn = f64::from(direction.y).atan2(f64::from(direction.x)) / std::f64::consts::TAU;
    let sector = (turn.rem_euclid(1.0) * SECTORS as f64) as usize;
    ring.min(RINGS - 1) * SECTORS + sector.min(SECTORS - 1)
}

/// Integral of the density over every bin, by the midpoints of a fine grid.
fn expected_shares(bsdf: Bsdf, wo: Vec3f) -> Vec<f64> {
    const FINE: usize = 32;
    let mut shares = vec![0.0; RINGS * SECTORS];
    let solid_angle = 2.0 * std::f64::consts::TAU / (RINGS * SECTORS * FINE * FINE) as f64;
    for i in 0..RINGS * FINE {
        let z = (i as f64 + 0.5) / (RINGS * FINE) as f64 * 2.0 - 1.0;
        for j in 0..SECTORS * FINE {
            let turn = (j as f64 + 0.5) / (SECTORS * FINE) as f64 * std::f64::consts::TAU;
            let radius = (1.0 - z * z).sqrt();
            let wi = vec3f((radius * turn.cos()) as f32, (radius * turn.sin()) as f32, z as f32);
            shares[i / FINE * SECTORS + j / FINE] += f64::from(bsdf_pdf(bsdf, NORMAL, wo, wi)) * solid_angle;
        }
    }
    shares
}

#[test]
fn sampled_directions_follow_the_density() {
    const SAMPLES: u32 = 100_000;
    for (name, bsdf) in cases() {
        for (number, wo) in viewers().into_iter().enumerate() {
            let mut counts = vec![0u32; RINGS * SECTORS];
            for index in 0..SAMPLES {
                let u = random4(independent_key(index, number as u32, 3), 1);
                let sample = sample_bsdf(bsdf, NORMAL, wo, vec2f(u.x, u.y));
                if sample.event == EVENT_SCATTERED {
                    counts[bin(sample.direction)] += 1;
                }
            }
            let shares = expected_shares(bsdf, wo);
            // Bins with few expected samples are joined, as the test demands; so is what is absorbed.
            let mut statistic = 0.0;
            let mut bins = 0;
            let (mut rest_expected, mut rest_found) = (f64::from(SAMPLES), f64::from(SAMPLES));
            for (share, found) in shares.iter().zip(&counts) {
                let expected = share * f64::from(SAMPLES);
                if expected >= 10.0 {
                    statistic += (f64::from(*found) - expected).powi(2) / expected;
                    bins += 1;
                    rest_expected -= expected;
                    rest_found -= f64::from(*found);
                }
            }
            if rest_expected >= 10.0 {
                statistic += (rest_found - rest_expected).powi(2) / rest_expected;
                bins += 1;
            }
            // χ² with k degrees of freedom has mean k and variance 2 k; 5 standard deviations, and 2 % for the
            // quadrature of sharp lobes.
            let freedom = f64::from(bins - 1).max(1.0);
            let limit = freedom + 5.0 * (2.0 * freedom).sqrt() + 0.02 * freedom;
            assert!(
                statistic < limit,
                "{name}, viewer {number}: χ² {statistic:.1} of {bins} bins, limit {limit:.1}"
            );
        }
    }
}

#[test]
fn weights_are_value_over_density() {
    for (name, bsdf) in cases() {
        for wo in viewers() {
            for index in 0..500 {
                let u = random4(independent_key(index, 0, 5), 2);
                let sample = sample_bsdf(bsdf, NORMAL, wo, vec2f(u.x, u.y));
                if sample.event != EVENT_SCATTERED {
                    continue;
                }
                let value = evaluate_bsdf(bsdf, NORMAL, wo, sample.direction);
                let pdf = bsdf_pdf(bsdf, NORMAL, wo, sample.direction);
                assert!((sample.pdf - pdf).abs() <= 1e-5 * pdf, "{name}: {} {pdf}", sample.pdf);
                let difference = sample.weight * pdf - value;
                assert!(dot(difference, difference) <= 1e-8 * dot(value, value), "{name}");
            }
        }
    }
}

#[test]
fn reflection_and_straight_transmission_are_reciprocal() {
    for (name, bsdf) in cases().into_iter().filter(|(_, bsdf)| bsdf.eta == 1.0) {
        for index in 0..500 {
            let u = random4(independent_key(index, 0, 9), 3);
            let direction = |cosine: f32, turn: f32| {
                let radius = (1.0 - cosine * cosine).sqrt();
                vec3f(
                    cosine,
                    radius * (std::f32::consts::TAU * turn).cos(),
                    radius * (std::f32::consts::TAU * turn).sin(),
                )
            };
            let a = direction(u.x.max(0.01), u.y);
            let b = direction(2.0 * u.z - 1.0, u.w);
            // The normal is on the side of the viewer; without the cosine of arrival both ways are equal.
            let there = evaluate_bsdf(bsdf, NORMAL, a, b) * (1.0 / b.x.abs());
            let facing = if b.x > 0.0 { NORMAL } else { -NORMAL };
            let back = evaluate_bsdf(bsdf, facing, b, a) * (1.0 / a.x.abs());
            let difference = there - back;
            assert!(
                dot(difference, difference) <= 1e-6 * dot(there, there) + 1e-12,
                "{name}: {there:?} {back:?}"
            );
        }
    }
}

#[test]
fn no_more_light_leaves_than_arrives() {
    const SAMPLES: u32 = 20_000;
    for (name, bsdf) in cases() {
        for wo in viewers() {
            let (mut sum, mut squares) = (0.0, 0.0);
            for index in 0..SAMPLES {
                let u = random4(independent_key(index, 7, 1), 4);
                let sample = sample_bsdf(bsdf, NORMAL, wo, vec2f(u.x, u.y));
                let mut weight = f64::from(sample.weight.x.max(sample.weight.y).max(sample.weight.z));
                if sample.direction.x < 0.0 {
                    // Radiance in another medium counts by the square of its index.
                    weight /= f64::from(bsdf.eta).powi(2);
                }
                sum += weight;
                squares += weight * weight;
            }
            let mean = sum / f64::from(SAMPLES);
            let error = ((squares / f64::from(SAMPLES) - mean * mean).max(0.0) / f64::from(SAMPLES)).sqrt();
            assert!(mean < 1.0 + 4.0 * error + 1e-6, "{name}: {mean} ± {error}");
        }
    }
}
