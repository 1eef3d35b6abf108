//! A low-discrepancy sequence over samples and pixels: the first two dimensions of Sobol's sequence, and the same in
//! another order as a second pair, scrambled after Owen, visited along a Z-order curve.
//!
//! - Sequence and padding: Burley, "Practical Hash-based Owen Scrambling" (JCGT 9(4), 2020): more dimensions than
//!   four are had in groups of four, each with an order of its own that is a nested uniform shuffling.
//! - Order over the pixels: Ahmed and Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via
//!   Hierarchical Ordering of Pixels" (ACM TOG 39(6), 2020): four neighbouring pixels, and four such blocks, and so
//!   on, share one well-distributed part of the sequence, so that their errors are opposed and the rest of the noise
//!   has little in it that eyes or filters see.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use wgsl_rs::std::*;

    /// Binary logarithm of the edge of the pixel blocks that share a scrambled sequence. Errors are opposed up to
    /// this distance; larger blocks would make indices long and so the sequence costly.
    pub const BLOCK_LEVELS: u32 = 4;

    /// Avalanches the bits of a number (the finaliser of MurmurHash3).
    pub fn mix_bits(bits: u32) -> u32 {
        let mut x = bits;
        x = x ^ (x >> 16u32);
        x *= 2246822507u32;
        x = x ^ (x >> 13u32);
        x *= 3266489909u32;
        x ^ (x >> 16u32)
    }

    /// Changes every bit depending on the lower ones alone. In numbers with reversed bits this is a random
    /// permutation of a binary tree, which is Owen scrambling (Laine and Karras 2011; constants of Vegdahl,
    /// "Building a Better LK Hash", 2021).
    pub fn permute_upwards(bits: u32, seed: u32) -> u32 {
        let mut x = bits;
        x = x ^ (x * 1025551850u32);
        x += seed;
        x *= (seed >> 16u32) | 1u32;
        x = x ^ (x * 89287766u32);
        x ^ (x * 1403136100u32)
    }

    /// Owen scrambling: digits of a binary fraction, or of an index, change depending on those before.
    pub fn nested_uniform_scramble(bits: u32, seed: u32) -> u32 {
        reverse_bits(permute_upwards(reverse_bits(bits), seed))
    }

    /// Pascal's triangle modulo 2 times the binary digits of a number, as a product of five sparse matrices: the second
    /// dimension of Sobol's sequence.
    pub fn pascal(index: u32) -> u32 {
        let mut y = index;
        y = y ^ ((y >> 1u32) & 1431655765u32);
        y = y ^ ((y >> 2u32) & 858993459u32);
        y = y ^ ((y >> 4u32) & 252645135u32);
        y = y ^ ((y >> 8u32) & 16711935u32);
        y ^ (y >> 16u32)
    }

    /// Four dimensions of a point of a sequence, the first binary digit in the lowest bit.
    ///
    /// The first two are Sobol's. So are the last two, of an index that a matrix has changed whose diagonal is 1 and
    /// that has nothing below: this leaves a pair as evenly distributed as it was (a (0, 2)-sequence). Sobol's own third
    /// and fourth dimensions are not, and cost a loop. The matrix, a product of three sparse ones, was searched at
    /// random for the evenness of the pairs across, and of all four.
    pub fn sobol4(index: u32) -> Vec4u {
        let mut z = index;
        z = z ^ ((z >> 4u32) & 111726858u32);
        z = z ^ ((z >> 6u32) & 39179627u32);
        z = z ^ ((z >> 3u32) & 228095095u32);
        vec4u(index, pascal(index), z, pascal(z))
    }

    /// The same point scrambled, each dimension with a seed of its own; binary fractions of 32 digits.
    pub fn scrambled_sobol4(index: u32, seeds: Vec4u) -> Vec4u {
        let point = sobol4(index);
        vec4u(
            reverse_bits(permute_upwards(point.x, seeds.x)),
            reverse_bits(permute_upwards(point.y, seeds.y)),
            reverse_bits(permute_upwards(point.z, seeds.z)),
            reverse_bits(permute_upwards(point.w, seeds.w)),
        )
    }

    /// Place of a pixel of a block on a Z-order curve whose quadrants are permuted at random on every level.
    ///
    /// All 24 orders of four quadrants are affine maps of two bits: images of 1 and 2 that differ from 0 and from
    /// each other, and what is added. With all of them no direction of the picture is preferred.
    pub fn z_order(x: u32, y: u32, seed: u32) -> u32 {
        let mut place: u32 = 0;
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..BLOCK_LEVELS {
            let level = BLOCK_LEVELS - 1u32 - i;
            let right = (x >> level) & 1u32;
            let down = (y >> level) & 1u32;
            // Depends on the quadrants before; the leading 1 tells levels apart.
            let random = mix_bits(seed ^ (((1u32 << (2u32 * i)) | place) * 2654435769u32));
            let first = 1u32 + (random >> 8u32) % 3u32;
            // One of the two numbers left.
            let second = 1u32 + (first + ((random >> 4u32) & 1u32)) % 3u32;
            let quadrant = (right * first) ^ (down * second) ^ (random & 3u32);
            place = (place << 2u32) | quadrant;
        }
        place
    }
}

#[cfg(test)]
mod tests {
    use super::kernel::*;

    /// The dimensions as fractions.
    fn point(index: u32) -> [f64; 4] {
        sobol4(index).to_array().map(|bits| f64::from(bits.reverse_bits()) / 4_294_967_296.0)
    }

    #[test]
    fn the_first_points_are_those_of_sobol() {
        let first_pair = |index| point(index)[..2].to_vec();
        assert_eq!(point(0), [0.0; 4]);
        assert_eq!(first_pair(1), [0.5, 0.5]);
        assert_eq!(first_pair(2), [0.25, 0.75]);
        assert_eq!(first_pair(3), [0.75, 0.25]);
        assert_eq!(first_pair(4), [0.125, 0.625]);
        assert_eq!(first_pair(5), [0.625, 0.125]);
        assert_eq!(first_pair(8), [0.0625, 0.9375]);
    }

    #[test]
    fn the_second_pair_is_the_first_in_another_order() {
        // In every aligned block of a power of two, which is what makes it as evenly distributed.
        for digits in 0..12 {
            for block in [0u32, 1, 5] {
                let mut order: Vec<u32> = (0..1 << digits).map(|i| sobol4((block << digits) | i).z).collect();
                let start = order[0] >> digits << digits;
                order.sort_unstable();
                assert!(order.into_iter().eq(start..start + (1 << digits)));
            }
        }
        assert!((0..4096).all(|i| sobol4(i).w == pascal(sobol4(i).z)));
    }

    #[test]
    fn scrambling_permutes_every_subtree() {
        for seed in [0, 1, 0xdead_beef] {
            for digits in 1..10u32 {
                // The leading digits of the result are a permutation of the leading digits.
                let mut seen = vec![false; 1 << digits];
                for leading in 0..1u32 << digits {
                    let scrambled = nested_uniform_scramble(leading << (32 - digits), seed);
                    seen[(scrambled >> (32 - digits)) as usize] = true;
                }
                assert!(seen.iter().all(|&seen| seen));
            }
        }
    }

    #[test]
    fn the_curve_visits_all_pixels_and_stays_within_quadrants() {
        let edge = 1u32 << BLOCK_LEVELS;
        let mut seen = vec![false; (edge * edge) as usize];
        let mut first = [0u32; 4];
        for seed in 0..1000 {
            seen.fill(false);
            for i in 0..edge * edge {
                let (x, y) = (i % edge, i / edge);
                let place = z_order(x, y, seed);
                seen[place as usize] = true;
                // Neighbours in a block of 2 x 2 have consecutive places.
                assert_eq!(place >> 2, z_order(x ^ 1, y ^ 1, seed) >> 2);
            }
            assert!(seen.iter().all(|&seen| seen));
            first[(z_order(0, 0, seed) >> (2 * BLOCK_LEVELS - 2)) as usize] += 1;
        }
        // Binomial with n = 1000, p = 1/4: standard deviation 13.7; 5 sigma.
        assert!(first.iter().all(|count| (180..320).contains(count)), "{first:?}");
    }
}
