//! Random numbers as a function of (pixel, sample, dimension), never of execution order.
//!
//! Independent numbers come from the 4-D permuted congruential hash of Jarzynski and Olano, "Hash Functions for GPU
//! Rendering" (JCGT 9(3), 2020). One call gives four of them. The other sampler is that of the module `sobol`.

use wgsl_rs::wgsl;

#[wgsl]
#[allow(clippy::module_inception)]
pub mod kernel {
    use crate::records::kernel::*;
    use crate::sobol::kernel::*;
    use wgsl_rs::std::*;

    /// All numbers are independent of each other.
    pub const SAMPLER_INDEPENDENT: u32 = 0;
    /// Scrambled Sobol points in Z-order, see the module `sobol`.
    pub const SAMPLER_SOBOL: u32 = 1;

    /// Identifies one sample of one pixel; with a dimension it selects four random numbers.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct SampleKey {
        /// Index of the pixel in the picture, row by row.
        pub pixel: u32,
        /// Index of the sample within the pixel.
        pub sample: u32,
        /// Chosen by the user; another seed gives an independent picture.
        pub seed: u32,
        /// Sobol: the bits that indices of the block of pixels have. 0 selects independent numbers.
        pub index_mask: u32,
        /// Sobol: place of the pixel's first sample in the sequence of its block of pixels.
        pub start: u32,
        /// Sobol: place of the sample there, shuffled, so that pixels do not have the same points in the same order.
        pub index: u32,
        /// Sobol: tells blocks of pixels, and repetitions of their sequence, apart.
        pub scramble: u32,
    }

    /// Dimension of the position within the pixel, and of the light at the first surface.
    pub const DIMENSION_PIXEL: u32 = 0;
    /// Dimension of the position on the lens.
    pub const DIMENSION_LENS: u32 = 536870912;
    /// Dimension of the direction from the first surface of a path on, and of the light at the next; the others follow.
    pub const DIMENSION_FIRST_SURFACE: u32 = 1;
    /// Added to the object index to decide whether a ray passes a partly transparent object.
    pub const DIMENSION_OPACITY: u32 = 2147483648;

    /// The 4-D PCG hash: every output bit depends on every input bit.
    pub fn pcg4d(v: Vec4u) -> Vec4u {
        let mut x: u32 = v.x * 1664525u32 + 1013904223u32;
        let mut y: u32 = v.y * 1664525u32 + 1013904223u32;
        let mut z: u32 = v.z * 1664525u32 + 1013904223u32;
        let mut w: u32 = v.w * 1664525u32 + 1013904223u32;
        x += y * w;
        y += z * x;
        z += x * y;
        w += y * z;
        x = x ^ (x >> 16u32);
        y = y ^ (y >> 16u32);
        z = z ^ (z >> 16u32);
        w = w ^ (w >> 16u32);
        x += y * w;
        y += z * x;
        z += x * y;
        w += y * z;
        vec4u(x, y, z, w)
    }

    /// The upper 24 bits as a number in [0, 1).
    pub fn unit_float(bits: u32) -> f32 {
        f32(bits >> 8u32) * 0.000000059604644775390625
    }

    /// The key of independent numbers.
    pub fn independent_key(pixel: u32, sample: u32, seed: u32) -> SampleKey {
        SampleKey { pixel, sample, seed, index_mask: 0, start: 0, index: 0, scramble: 0 }
    }

    /// The key of a sample of a picture; `x` and `y` count pixels of the whole picture from the top left.
    pub fn sample_key(settings: LaunchSettings, x: u32, y: u32, sample: u32) -> SampleKey {
        let mut key = independent_key(y * settings.width + x, sample, settings.seed);
        if settings.sampler == SAMPLER_SOBOL {
            let bits = settings.sequence_bits;
            // More samples than planned start a sequence that is scrambled differently.
            let repetition = sample >> bits;
            let block =
                pcg4d(vec4u(x >> BLOCK_LEVELS, y >> BLOCK_LEVELS, repetition ^ 2779096485u32, settings.seed));
            let edge_mask = (1u32 << BLOCK_LEVELS) - 1u32;
            let place = z_order(x & edge_mask, y & edge_mask, block.x);
            key.index_mask = (1u32 << (bits + 2u32 * BLOCK_LEVELS)) - 1u32;
            key.start = place << bits;
            key.scramble = block.y;
            key.index = shuffled_index(key, bits, sample);
        }
        key
    }

    /// The place of a sample of the key's pixel in the sequence of its block, shuffled.
    pub fn shuffled_index(key: SampleKey, bits: u32, sample: u32) -> u32 {
        let place = key.start | (sample & ((1u32 << bits) - 1u32));
        nested_uniform_scramble(place, key.scramble) & key.index_mask
    }

    /// The key of another sample of the same pixel; what the samples of a sequence share is not computed again.
    pub fn key_of_sample(
        settings: LaunchSettings,
        x: u32,
        y: u32,
        other: SampleKey,
        sample: u32,
    ) -> SampleKey {
        let bits = settings.sequence_bits;
        if settings.sampler == SAMPLER_SOBOL && (sample >> bits) != (other.sample >> bits) {
            return sample_key(settings, x, y, sample);
        }
        let mut key = other;
        key.sample = sample;
        if settings.sampler == SAMPLER_SOBOL {
            key.index = shuffled_index(key, bits, sample);
        }
        key
    }

    /// One number, uniform in [0, 1), that is independent of all others of all samplers.
    pub fn independent_number(key: SampleKey, dimension: u32) -> f32 {
        unit_float(pcg4d(vec4u(key.pixel, key.sample, dimension ^ 2654435769u32, key.seed)).x)
    }

    /// Four numbers, uniform in [0, 1) and well distributed together over the samples of a pixel, or independent:
    /// best the first two, and the last two. The numbers of `GROUPS` successive dimensions from a multiple of that on
    /// are well distributed together, too; others are independent.
    pub fn random4(key: SampleKey, dimension: u32) -> Vec4f {
        let sobol = key.index_mask != 0u32;
        let first = select(key.pixel, key.scramble, sobol);
        let second = select(key.sample, 3141592653u32, sobol);
        let mut bits = pcg4d(vec4u(first, second, dimension, key.seed));
        if sobol {
            let mut index = key.index;
            let ensemble = dimension / GROUPS;
            if ensemble != 0u32 {
                // The order of the samples must not be the same in all ensembles of groups.
                let order = mix_bits(key.scramble ^ (ensemble * 2654435769u32));
                index = nested_uniform_scramble(index, order) & key.index_mask;
            }
            bits = scrambled_sobol4(index_of_group(index, dimension % GROUPS), bits);
        }
        vec4f(unit_float(bits.x), unit_float(bits.y), unit_float(bits.z), unit_float(bits.w))
    }

    /// Position of a sample within its pixel in `xy`, and in `zw` numbers for the light that is seen there, in [0, 1)⁴.
    ///
    /// Independent numbers: the pixel is divided into `grid` x `grid` cells that are visited in turn; each pixel
    /// starts at a random cell, so that a sample count that is no multiple of the number of cells stays unbiased.
    /// Sobol points are in strata of all shapes already, which cells would only disturb.
    pub fn camera_numbers(key: SampleKey, grid: u32) -> Vec4f {
        let jitter = random4(key, DIMENSION_PIXEL);
        if key.index_mask != 0u32 {
            return jitter;
        }
        let cells = grid * grid;
        let round = key.sample / cells;
        let start = pcg4d(vec4u(key.pixel, round, 3735928559u32, key.seed)).x;
        let cell = (key.sample % cells + start % cells) % cells;
        let column = cell % grid;
        let row = cell / grid;
        vec4f((f32(column) + jitter.x) / f32(grid), (f32(row) + jitter.y) / f32(grid), jitter.z, jitter.w)
    }

    /// Position of a sample within its pixel, in [0, 1)².
    pub fn pixel_position(key: SampleKey, grid: u32) -> Vec2f {
        let numbers = camera_numbers(key, grid);
        vec2f(numbers.x, numbers.y)
    }
}

#[cfg(test)]
mod tests {
    use super::kernel::*;

    fn key(pixel: u32, sample: u32) -> SampleKey {
        independent_key(pixel, sample, 7)
    }

    #[test]
    fn numbers_are_uniform() {
        // Chi-square with 63 degrees of freedom: mean 63, standard deviation sqrt(126) = 11.2; 5 sigma.
        let mut bins = [0u32; 64];
        let n = 64 * 4000;
        for i in 0..n {
            let x = random4(key(i % 640, i / 640), 3).x;
            assert!((0.0..1.0).contains(&x));
            bins[(x * 64.0) as usize] += 1;
        }
        let expected = f64::from(n) / 64.0;
        let chi2: f64 = bins.iter().map(|&b| (f64::from(b) - expected).powi(2) / expected).sum();
        assert!((chi2 - 63.0).abs() < 5.0 * 126f64.sqrt(), "chi2 {chi2}");
    }

    #[test]
    fn neighbours_and_dimensions_are_uncorrelated() {
        // The correlation of n independent pairs has standard deviation 1/sqrt(n).
        let n = 40_000u32;
        let correlation = |pair: &dyn Fn(u32) -> (f32, f32)| {
            let sum: f64 = (0..n)
                .map(|i| {
                    let (a, b) = pair(i);
                    (f64::from(a) - 0.5) * (f64::from(b) - 0.5)
                })
                .sum();
            (sum / f64::from(n) * 12.0).abs()
        };
        let limit = 5.0 / f64::from(n).sqrt();
        assert!(correlation(&|i| (random4(key(i, 0), 1).x, random4(key(i + 1, 0), 1).x)) < limit);
        assert!(correlation(&|i| (random4(key(i, 0), 1).x, random4(key(i + 640, 0), 1).x)) < limit);
        assert!(correlation(&|i| (random4(key(5, i), 1).x, random4(key(5, i + 1), 1).x)) < limit);
        assert!(correlation(&|i| (random4(key(5, i), 1).x, random4(key(5, i), 2).x)) < limit);
        assert!(correlation(&|i| (random4(key(5, i), 1).x, random4(key(5, i), 1).y)) < limit);
        // The measure itself notices correlated numbers.
        assert!(correlation(&|i| (random4(key(i, 0), 1).x, random4(key(i, 0), 1).x)) > limit);
    }

    #[test]
    fn keys_from_other_keys_are_those_of_the_samples() {
        use crate::records::kernel::LaunchSettings;
        for (sampler, sequence_bits) in [(SAMPLER_INDEPENDENT, 3), (SAMPLER_SOBOL, 3), (SAMPLER_SOBOL, 0)] {
            let settings: LaunchSettings = LaunchSettings {
                width: 100,
                height: 80,
                seed: 9,
                sampler,
                sequence_bits,
                ..bytemuck::Zeroable::zeroed()
            };
            let mut key = sample_key(settings, 17, 33, 5);
            for sample in [6, 7, 8, 5, 40, 41, 1000] {
                key = key_of_sample(settings, 17, 33, key, sample);
                assert_eq!(format!("{key:?}"), format!("{:?}", sample_key(settings, 17, 33, sample)));
            }
        }
    }

    #[test]
    fn samples_visit_every_cell_of_the_pixel_once_per_round() {
        for pixel in 0..50 {
            let mut seen = [0; 9];
            for sample in 0..18 {
                let p = pixel_position(key(pixel, sample), 3);
                seen[(p.x * 3.0) as usize + 3 * (p.y * 3.0) as usize] += 1;
            }
            assert_eq!(seen, [2; 9]);
        }
    }
}
