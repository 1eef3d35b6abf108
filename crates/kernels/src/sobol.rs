//! A low-discrepancy sequence over samples and pixels: the first two dimensions of Sobol's sequence and two more that are
//! as even among themselves and with those, scrambled after Owen, visited along a Z-order curve.
//!
//! - Scrambling and padding: Burley, "Practical Hash-based Owen Scrambling" (JCGT 9(4), 2020): more dimensions are had in
//!   groups, each with an order of its own that is a nested uniform shuffling. Here that are groups of sixteen, which are
//!   four groups of four that keep one order.
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

    /// The element w of the field of four times every pair of binary digits, which stand for 0, 1, w and w + 1 = w².
    pub fn times_w(digits: u32) -> u32 {
        ((digits >> 1u32) & 1431655765u32) ^ ((digits << 1u32) & 2863311530u32) ^ (digits & 2863311530u32)
    }

    /// The matrix of the binomial coefficients (j over i) w^(j - i) in the field of four times the digits of a number in
    /// base 4, as a product of four sparse matrices.
    pub fn pascal_of_four(index: u32) -> u32 {
        let mut z = index;
        z = z ^ times_w((z >> 2u32) & 858993459u32);
        let second = (z >> 4u32) & 252645135u32;
        z = z ^ second ^ times_w(second);
        z = z ^ times_w((z >> 8u32) & 16711935u32);
        let fourth = z >> 16u32;
        z ^ fourth ^ times_w(fourth)
    }

    /// Four dimensions of a point of a sequence, the first binary digit in the lowest bit.
    ///
    /// Together they are a (0, 4)-sequence in base 4: among 4^m points, every box of volume 4^-m whose edges are powers
    /// of 1/4 has exactly one. The first two, and the last two, are a (0, 2)-sequence in base 2, each pair as even as
    /// Sobol's first two dimensions.
    ///
    /// Why: in the field of four, the matrices (j over i) a^(j - i) with a = 0, 1, w, w² are such a sequence
    /// (Niederreiter, "Point Sets and Sequences with Small Discrepancy", 1987); written with binary digits, a = 0 is the
    /// unit matrix, a = 1 becomes Pascal's triangle modulo 2 and a = w² the product of it and a = w, up to changes within
    /// digits of base 4, which leave every box its point. That two (0, 2)-sequences can be joined so: Ahmed, Pharr,
    /// Ostromoukhov and Huang, "SZ Sequences: Binary-Based (0, 2^q)-Sequences" (2025).
    pub fn sobol4(index: u32) -> Vec4u {
        let second = pascal_of_four(index);
        vec4u(index, pascal(index), second, pascal(second))
    }

    /// Groups of four dimensions that are even together when samples have the same index in all of them.
    pub const GROUPS: u32 = 4;

    /// The index with which a group of four dimensions is asked for, so that groups are even together.
    ///
    /// A matrix whose diagonal is 1 and that has nothing below leaves a group as even as it was, in base 4 and in base
    /// 2; which one decides how even numbers of different groups are together. These come from a search as by
    /// `examples/groups_of_dimensions.rs`, for the least variance of products of functions of two or three successive
    /// directions, and the light at the end, for 4 to 1024 samples. With an independent order in each group the
    /// variance of such products is that of independent numbers, and twice that in the coarsest parts: samples 2 k and
    /// 2 k + 1 are in opposite halves in every dimension, and so their products are alike.
    pub fn index_of_group(index: u32, group: u32) -> u32 {
        let odd = (group & 1u32) != 0u32;
        let upper = (group & 2u32) != 0u32;
        let first =
            select(select(0u32, 4241183679u32, odd), select(2996896550u32, 1302306305u32, odd), upper);
        let second =
            select(select(0u32, 218215217u32, odd), select(2491290171u32, 3829150337u32, odd), upper);
        let third =
            select(select(0u32, 3555275105u32, odd), select(4093891526u32, 1183952838u32, odd), upper);
        reordered(index, vec3u(first, second, third))
    }

    /// A matrix times the binary digits of an index, as a product of three sparse ones whose diagonal is 1.
    pub fn reordered(index: u32, masks: Vec3u) -> u32 {
        let mut z = index;
        z = z ^ ((z >> 4u32) & masks.x);
        z = z ^ ((z >> 2u32) & masks.y);
        z ^ ((z >> 1u32) & masks.z)
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
