//! Sums of pixels whose samples were collected separately.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;

    /// A pixel with the samples of two. Additions alone, so both devices give the same bits (but for numbers below
    /// 1.2e-38, which graphics cards may take for zero).
    pub fn joined_pixels(first: FilmPixel, second: FilmPixel) -> FilmPixel {
        let mut joined = first;
        joined.radiance += second.radiance;
        joined.squares += second.squares;
        joined.rays += second.rays;
        joined.samples += second.samples;
        joined
    }
}
