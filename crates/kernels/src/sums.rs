//! Sums of pixels whose samples were collected separately.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use wgsl_rs::std::*;

    /// A pixel with the samples of two. Additions alone, so both devices give the same bits (but for numbers below
    /// 1.2e-38, which graphics cards may take for zero).
    pub fn joined_pixels(first: FilmPixel, second: FilmPixel) -> FilmPixel {
        let mut joined = first;
        joined.radiance += second.radiance;
        joined.squares += second.squares;
        joined.rays = saturating_sum(first.rays, second.rays);
        joined.samples = saturating_sum(first.samples, second.samples);
        joined
    }

    /// The sum, or the largest number if it is larger: a damaged film may hold anything.
    pub fn saturating_sum(a: u32, b: u32) -> u32 {
        a + min(b, 4294967295u32 - a)
    }
}
