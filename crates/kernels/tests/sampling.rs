//! The random numbers of both samplers: distribution, correlations, spectrum of the noise.

use kernels::random::kernel::*;
use kernels::records::kernel::LaunchSettings;
use kernels::sobol::kernel::{BLOCK_LEVELS, sobol4};
use std::f64::consts::TAU;

/// Settings of a picture 640 pixels wide, planned for 2^`bits` samples per pixel.
fn settings(sampler: u32, bits: u32, seed: u32) -> LaunchSettings {
    LaunchSettings {
        width: 640,
        height: 480,
        tile_x: 0,
        tile_y: 0,
        tile_width: 640,
        tile_height: 480,
        first_sample: 0,
        samples: 1 << bits,
        seed,
        grid: 1,
        depth: 1,
        renderer: 0,
        background: wgsl_rs::std::vec3f(0.0, 0.0, 0.0),
        shadow_samples: 1,
        sampler,
        sequence_bits: bits,
        reconstruction: 0,
        counted: 0,
    }
}

/// The four numbers of a sample.
fn numbers(settings: LaunchSettings, (x, y): (u32, u32), sample: u32, dimension: u32) -> [f32; 4] {
    random4(sample_key(settings, x, y, sample), dimension).to_array()
}

/// Looks whether every box of the unit cube with edges base^-e, for each way to share `digits` out as exponents e among the
/// first `D` numbers, holds exactly `each` of the points. Returns the exponents of boxes that do not.
fn uneven_boxes<const D: usize>(points: &[[f32; 4]], base: u32, digits: u32, each: u32) -> Option<[u32; D]> {
    let cells = base.pow(digits);
    assert_eq!(points.len() as u32, each * cells);
    (0..(digits + 1).pow(D as u32))
        .map(|code| std::array::from_fn(|d| code / (digits + 1).pow(d as u32) % (digits + 1)))
        .filter(|exponents: &[u32; D]| exponents.iter().sum::<u32>() == digits)
        .find(|exponents| {
            let mut counts = vec![0u32; cells as usize];
            for point in points {
                let cell = (0..D).fold(0, |cell, d| {
                    let edge = base.pow(exponents[d]);
                    cell * edge + (point[d] * edge as f32) as u32
                });
                counts[cell as usize] += 1;
            }
            counts.iter().any(|&count| count != each)
        })
}

/// Asserts that boxes in base 2 are even.
fn assert_equidistributed<const D: usize>(points: &[[f32; 4]], digits: u32, each: u32) {
    assert_eq!(uneven_boxes::<D>(points, 2, digits, each), None);
}

/// An aligned block of points of the sequence, neither shuffled nor scrambled, their dimensions turned so that `first` is
/// the first.
fn unscrambled(number: u32, block: u32, first: usize) -> Vec<[f32; 4]> {
    let point = |i| {
        let mut point = sobol4(block * number + i).to_array().map(|bits| unit_float(bits.reverse_bits()));
        point.rotate_left(first);
        point
    };
    (0..number).map(point).collect()
}

#[test]
fn all_four_dimensions_are_even_in_base_4() {
    for m in 0..=5 {
        for block in [0, 1, 6] {
            let points = unscrambled(4u32.pow(m), block, 0);
            assert_eq!(uneven_boxes::<4>(&points, 4, m, 1), None, "4^{m} points, block {block}");
        }
    }
}

#[test]
fn either_pair_is_even_in_base_2() {
    for m in 0..=11 {
        for block in [0, 1, 5] {
            for first in [0, 2] {
                assert_equidistributed::<2>(&unscrambled(1 << m, block, first), m, 1);
            }
        }
    }
}

#[test]
fn evenness_is_seen_to_be_missing() {
    // Two equal dimensions.
    let equal: Vec<_> = unscrambled(4, 0, 0).into_iter().map(|[x, ..]| [x; 4]).collect();
    assert!(uneven_boxes::<2>(&equal, 2, 2, 1).is_some());
    // Not in base 2, which no sequence of four dimensions is.
    assert!(uneven_boxes::<4>(&unscrambled(4, 0, 0), 2, 2, 1).is_some());
}

/// The parameter t of the nets of 2^m points in four dimensions, computed from the ranks of the matrices.
const T_OF_FOUR: [u32; 10] = [0, 0, 1, 2, 1, 2, 2, 3, 2, 3];

#[test]
fn sobol_points_of_a_pixel_are_in_every_elementary_interval() {
    for (pixel, dimension, seed) in [((0, 0), 0, 0), ((17, 200), 1, 1), ((639, 479), 6, 9), ((100, 3), 77, 5)]
    {
        for bits in 0..=9 {
            let settings = settings(SAMPLER_SOBOL, bits, seed);
            let points: Vec<_> = (0..1 << bits).map(|i| numbers(settings, pixel, i, dimension)).collect();
            // The pairs are (0, m, 2)-nets in base 2. The four together are so in base 4 (above), which leaves
            // them this uneven in base 2.
            assert_equidistributed::<2>(&points, bits, 1);
            let second: Vec<_> = points.iter().map(|p| [p[2], p[3], p[0], p[1]]).collect();
            assert_equidistributed::<2>(&second, bits, 1);
            let unevenness = T_OF_FOUR[bits as usize];
            assert_equidistributed::<4>(&points, bits - unevenness, 1 << unevenness);
            // So they are in each of the four dimensions alone.
            for d in 0..4 {
                let alone: Vec<_> = points.iter().map(|p| [p[d]; 4]).collect();
                assert_equidistributed::<1>(&alone, bits, 1);
            }
        }
    }
}

#[test]
fn sobol_pictures_are_well_distributed_when_they_are_stopped_early_or_go_on() {
    let settings = settings(SAMPLER_SOBOL, 6, 3);
    for bits in 0..=6 {
        let points: Vec<_> = (0..1 << bits).map(|i| numbers(settings, (5, 7), i, 2)).collect();
        assert_equidistributed::<2>(&points, bits, 1);
    }
    // More samples than were planned: the next 64 are such a set of their own.
    let more: Vec<_> = (64..128).map(|i| numbers(settings, (5, 7), i, 2)).collect();
    assert_equidistributed::<2>(&more, 6, 1);
    let first: Vec<_> = (0..64).map(|i| numbers(settings, (5, 7), i, 2)).collect();
    assert!(more.iter().all(|p| !first.contains(p)));
}

#[test]
fn sobol_points_of_neighbouring_pixels_complete_each_other() {
    let settings = settings(SAMPLER_SOBOL, 2, 3);
    for (level, digits) in [(1, 4), (2, 6), (BLOCK_LEVELS, 2 + 2 * BLOCK_LEVELS)] {
        let edge = 1 << level;
        let points: Vec<_> = (0..edge * edge * 4)
            .map(|i| (i / 4 % edge, i / 4 / edge, i % 4))
            .map(|(x, y, sample)| numbers(settings, (32 + x, 64 + y), sample, 1))
            .collect();
        assert_equidistributed::<2>(&points, digits, 1);
    }
}

#[test]
fn pixels_of_a_block_begin_long_sequences_in_different_places() {
    // Pictures that are stopped early, or looked at, use the first few samples of a sequence that was planned for many.
    let settings = settings(SAMPLER_SOBOL, 20, 5);
    let edge = 1 << BLOCK_LEVELS;
    for (dimension, sample) in [(0, 0), (1, 0), (2, 1), (3, 2), (9, 0)] {
        for component in 0..4 {
            let mut taken = vec![false; (edge * edge) as usize];
            for i in 0..edge * edge {
                let u = numbers(settings, (i % edge, i / edge), sample, dimension)[component];
                taken[(u * (edge * edge) as f32) as usize] = true;
            }
            // Of 256 independent numbers 162 +- 5 bins out of 256 have one; pixels with the same points would share one.
            let bins = taken.into_iter().filter(|&taken| taken).count();
            assert!(bins > 137, "dimension {dimension}, sample {sample}, component {component}: {bins}");
        }
    }
}

/// Correlation of pairs of numbers, times the square root of their count: a normal variate if they are independent.
fn correlation(pairs: impl Iterator<Item = (f32, f32)>) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0f64);
    for (a, b) in pairs {
        sum += (f64::from(a) - 0.5) * (f64::from(b) - 0.5) * 12.0;
        n += 1.0;
    }
    sum / n.sqrt()
}

#[test]
fn independent_numbers_of_neighbours_samples_and_dimensions_are_uncorrelated() {
    let settings = settings(SAMPLER_INDEPENDENT, 4, 7);
    let mut scores = Vec::new();
    // Pixels, samples and dimensions against those a few steps on; all components against each other.
    for (dx, dy, ds, dd) in [
        (0, 0, 0, 0),
        (1, 0, 0, 0),
        (0, 1, 0, 0),
        (1, 1, 0, 0),
        (2, 0, 0, 0),
        (16, 0, 0, 0),
        (0, 0, 1, 0),
        (0, 0, 2, 0),
        (0, 0, 64, 0),
        (0, 0, 0, 1),
        (0, 0, 0, 2),
        (1, 0, 1, 0),
        (1, 0, 0, 1),
    ] {
        for a in 0..4 {
            for b in 0..4 {
                if (dx, dy, ds, dd) == (0, 0, 0, 0) && a >= b {
                    continue;
                }
                scores.push(correlation((0..40_000).map(|i| {
                    let (x, y, s, d) = (i % 50, i / 50 % 50, i / 2500, 1 + i / 2500 % 4);
                    let here = numbers(settings, (x, y), s, d)[a];
                    (here, numbers(settings, (x + dx, y + dy), s + ds, d + dd)[b])
                })));
            }
        }
    }
    // 198 normal variates: none beyond 5 (probability 1e-4); the sum of their squares has standard deviation
    // sqrt(2 n).
    let largest = scores.iter().map(|z| z.abs()).fold(0.0, f64::max);
    assert!(largest < 5.0, "{largest}");
    let n = scores.len() as f64;
    let squares: f64 = scores.iter().map(|z| z * z).sum();
    assert!((squares - n).abs() < 5.0 * (2.0 * n).sqrt(), "{squares} of {n}");
    // The measure itself notices equal numbers.
    assert!(
        correlation(
            (0..1000).map(|i| (numbers(settings, (i, 0), 0, 1)[0], numbers(settings, (i, 0), 0, 1)[0]))
        ) > 5.0
    );
}

#[test]
fn sobol_numbers_of_different_dimensions_are_uncorrelated() {
    for bits in [0, 4, 8] {
        let settings = settings(SAMPLER_SOBOL, bits, 7);
        let count = 40_000u32 >> bits;
        for (a, b) in [(0, 1), (1, 2), (3, 4), (1, 3)] {
            for component in 0..4 {
                let z = correlation((0..count << bits).map(|i| {
                    let pixel = ((i >> bits) % 200, (i >> bits) / 200);
                    let sample = i & ((1 << bits) - 1);
                    let number = |dimension| numbers(settings, pixel, sample, dimension);
                    (number(a)[component], number(b)[component])
                }));
                // Even distribution makes it less than for independent numbers, never more.
                assert!(z.abs() < 5.0, "bits {bits}, dimensions {a} and {b}, component {component}: {z}");
            }
        }
    }
}

/// Variance, over blocks of pixels, of the mean of a product: of a function of the first two numbers of one dimension and
/// one of two numbers of another.
fn variance_of_products(bits: u32, one: u32, other: u32, second_pair: bool) -> f64 {
    let inside = |x: f32, y: f32| f64::from(u8::from(x + 0.3 * (6.0 * y).sin() < 0.5));
    let settings = settings(SAMPLER_SOBOL, bits, 11);
    let edge = 1 << BLOCK_LEVELS;
    let means: Vec<f64> = (0..BLOCKS)
        .map(|block| {
            let pixel = (block % 40 * edge, block / 40 * edge);
            let product = |sample| {
                let (a, b) = (numbers(settings, pixel, sample, one), numbers(settings, pixel, sample, other));
                inside(a[0], a[1]) * if second_pair { inside(b[2], b[3]) } else { inside(b[0], b[1]) }
            };
            (0..settings.samples).map(product).sum::<f64>() / f64::from(settings.samples)
        })
        .collect();
    let mean = means.iter().sum::<f64>() / f64::from(BLOCKS);
    means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / f64::from(BLOCKS - 1)
}

/// Blocks of pixels that a variance is taken over.
const BLOCKS: u32 = 1000;

#[test]
fn successive_dimensions_are_even_together() {
    for second_pair in [false, true] {
        // Dimensions that are no neighbours in a group of groups are shuffled independently.
        let shuffled = variance_of_products(8, 1, 10, second_pair);
        for one in [1, 2, 5, 6] {
            let together = variance_of_products(8, one, one + 1, second_pair);
            // A variance of n values has a relative standard deviation of sqrt(2 / n), the ratio of two 2 / sqrt(n), which
            // is 0.063: were they shuffled independently, it would be 5 of these higher.
            let ratio = together / shuffled;
            assert!(
                ratio < 1.0 - 5.0 * 2.0 / f64::from(BLOCKS).sqrt(),
                "{one}, second pair {second_pair}: {ratio}"
            );
        }
    }
}

const EDGE: usize = 64;

/// Power of a picture's frequencies, relative to white noise of the same variance; the mean is 1. Row by row,
/// frequency 0 first.
fn spectrum(picture: &[f64]) -> Vec<f64> {
    let n = EDGE as f64;
    let mean = picture.iter().sum::<f64>() / (n * n);
    let variance = picture.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * n);
    let turn = |k: usize| (TAU * (k % EDGE) as f64 / n).sin_cos();
    // Rows, then columns.
    let mut rows = vec![(0.0, 0.0); EDGE * EDGE];
    for y in 0..EDGE {
        for u in 0..EDGE {
            for x in 0..EDGE {
                let (s, c) = turn(u * x);
                let value = picture[y * EDGE + x] - mean;
                rows[y * EDGE + u].0 += value * c;
                rows[y * EDGE + u].1 += value * s;
            }
        }
    }
    let mut power = vec![0.0; EDGE * EDGE];
    for v in 0..EDGE {
        for u in 0..EDGE {
            let (mut real, mut imaginary) = (0.0, 0.0);
            for y in 0..EDGE {
                let (s, c) = turn(v * y);
                let (a, b) = rows[y * EDGE + u];
                real += a * c - b * s;
                imaginary += a * s + b * c;
            }
            power[v * EDGE + u] = (real * real + imaginary * imaginary) / (n * n * variance);
        }
    }
    power
}

/// Mean power of the frequencies whose waves are longer than `pixels`.
fn power_of_waves_longer_than(power: &[f64], pixels: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for v in 0..EDGE {
        for u in 0..EDGE {
            let signed = |k: usize| k.min(EDGE - k) as f64;
            let frequency = signed(u).hypot(signed(v)) / EDGE as f64;
            if frequency > 0.0 && frequency < 1.0 / pixels {
                sum += power[v * EDGE + u];
                count += 1.0;
            }
        }
    }
    sum / count
}

/// The power of white noise is exponentially distributed: of half of 4096 frequencies (the other half is the same)
/// one exceeds 21.4 with probability 2048 exp(-21.4) = 1e-6.
const NO_PEAK: f64 = 21.4;

/// The noise of a picture of `f` of the numbers of one dimension.
fn noise(settings: LaunchSettings, dimension: u32, f: impl Fn([f32; 4]) -> f64) -> Vec<f64> {
    (0..(EDGE * EDGE) as u32)
        .map(|i| (i % EDGE as u32, i / EDGE as u32))
        .map(|pixel| (0..settings.samples).map(|s| f(numbers(settings, pixel, s, dimension))).sum())
        .collect()
}

#[test]
fn independent_noise_is_white() {
    for (bits, dimension, seed) in [(0, 0, 0), (0, 1, 1), (0, 9, 0), (3, 0, 2)] {
        for component in 0..4 {
            let settings = settings(SAMPLER_INDEPENDENT, bits, seed);
            let power = spectrum(&noise(settings, dimension, |u| f64::from(u[component])));
            let largest = power.iter().copied().fold(0.0, f64::max);
            assert!(largest < NO_PEAK, "{largest}");
            // About 49 frequencies, half of them independent: standard deviation 0.2.
            let long = power_of_waves_longer_than(&power, 16.0);
            assert!((long - 1.0).abs() < 1.0, "{long}");
        }
    }
}

#[test]
fn stripes_would_be_noticed() {
    // Low bits of a linear congruential generator that goes on from pixel to pixel: they repeat every four rows.
    let mut state = 1u32;
    let picture: Vec<f64> = (0..EDGE * EDGE)
        .map(|_| {
            state = state.wrapping_mul(1_103_515_245).wrapping_add(12345);
            f64::from(state % 256)
        })
        .collect();
    assert!(spectrum(&picture).iter().copied().fold(0.0, f64::max) > NO_PEAK);
}

#[test]
fn sobol_noise_has_no_peaks_and_less_of_long_waves() {
    /// What a pixel might integrate.
    const INTEGRANDS: [fn([f32; 4]) -> f64; 3] = [
        |u| f64::from(u[0]) * f64::from(u[1]),
        |u| f64::from(u8::from(u[0] + u[1] < 0.9)),
        |u| (f64::from(u[1]) + f64::from(u[2]) * f64::from(u[3])).exp(),
    ];
    for (bits, dimension, seed) in [(0, 0, 0), (1, 1, 1), (2, 0, 0), (4, 3, 2)] {
        for (i, f) in INTEGRANDS.into_iter().enumerate() {
            let settings = settings(SAMPLER_SOBOL, bits, seed);
            let power = spectrum(&noise(settings, dimension, f));
            let largest = power.iter().copied().fold(0.0, f64::max);
            let long = power_of_waves_longer_than(&power, 8.0);
            eprintln!("2^{bits} samples, integrand {i}: largest {largest:.1}, long waves {long:.3}");
            // What long waves lack short ones have more, less than twice as much.
            assert!(largest < 2.0 * NO_PEAK, "{largest}");
            // White noise has 1 +- 0.1 here (about 197 frequencies, half of them independent).
            assert!(long < 0.5, "2^{bits} samples, integrand {i}: {long}");
        }
    }
}
