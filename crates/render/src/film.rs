//! What a rendering collects: sums per pixel.

use crate::RenderSettings;
use kernels::records::kernel::FilmPixel;

/// A picture in the making: for every pixel the sums of radiance and of its squares.
#[derive(Clone, Debug)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Row by row from the top; `width * height` entries.
    pub pixels: Vec<FilmPixel>,
}

impl Film {
    /// An empty film.
    pub fn new(width: u32, height: u32) -> Self {
        let pixel: FilmPixel = bytemuck::Zeroable::zeroed();
        Film { width, height, pixels: vec![pixel; width as usize * height as usize] }
    }

    /// An empty film for all that is rendered with some settings.
    pub(crate) fn of(settings: &RenderSettings) -> Self {
        let window = settings.window();
        Self::new(window.width, window.height)
    }

    /// Mean radiance of a pixel in W/(m² sr) per channel; black where nothing was sampled.
    pub fn radiance(&self, x: u32, y: u32) -> [f32; 3] {
        mean_radiance(&self.pixel(x, y))
    }

    /// Variance of the mean radiance of a pixel per channel, estimated from its samples; 0 with fewer than two.
    pub fn variance_of_mean(&self, x: u32, y: u32) -> [f32; 3] {
        variance_of_mean(&self.pixel(x, y))
    }

    /// Variance of the mean of all pixels, row by row from the top.
    pub fn variances_of_mean(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.pixels.iter().map(variance_of_mean)
    }

    /// Mean radiance of all pixels, row by row from the top.
    pub fn radiances(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.pixels.iter().map(mean_radiance)
    }

    /// Number of rays traced for the whole picture, shadow rays included.
    pub fn rays(&self) -> u64 {
        self.pixels.iter().map(|pixel| u64::from(pixel.rays)).sum()
    }

    /// Number of samples taken for the whole picture.
    pub fn samples(&self) -> u64 {
        self.pixels.iter().map(|pixel| u64::from(pixel.samples)).sum()
    }

    fn pixel(&self, x: u32, y: u32) -> FilmPixel {
        self.pixels[y as usize * self.width as usize + x as usize]
    }
}

/// Mean radiance of a pixel in W/(m² sr) per channel; black where nothing was sampled.
pub(crate) fn mean_radiance(pixel: &FilmPixel) -> [f32; 3] {
    let scale = 1.0 / pixel.samples.max(1) as f32;
    pixel.radiance.to_array().map(|sum| sum * scale)
}

/// Variance of the mean radiance per channel, estimated from the samples; 0 with fewer than two.
pub(crate) fn variance_of_mean(pixel: &FilmPixel) -> [f32; 3] {
    if pixel.samples < 2 {
        return [0.0; 3];
    }
    let n = pixel.samples as f32;
    let mean = mean_radiance(pixel);
    let squares = pixel.squares.to_array();
    std::array::from_fn(|c| ((squares[c] / n - mean[c] * mean[c]) / (n - 1.0)).max(0.0))
}

/// Exposure in stops that shows a picture well: the 99th percentile of the lit pixels' luminance comes out as
/// 0.8 of white. 0 for a black picture.
///
/// A percentile, not the maximum, so that a lamp in the picture or a single bright pixel does not darken it.
pub fn automatic_exposure(film: &Film) -> f32 {
    let replay = |see: &mut dyn FnMut([f32; 3])| -> Result<(), std::convert::Infallible> {
        film.radiances().for_each(see);
        Ok(())
    };
    match exposure_of(replay) {
        Ok(stops) => stops,
    }
}

/// As [`automatic_exposure`], for a picture that is shown pixel by pixel whenever `replay` is called. The percentile
/// is exact, but only counts are in memory: positive floats are ordered as their bits are, so the first look counts
/// the upper halves of the bits, the second the lower halves under the one upper half that is wanted.
pub(crate) fn exposure_of<E>(
    mut replay: impl FnMut(&mut dyn FnMut([f32; 3])) -> Result<(), E>,
) -> Result<f32, E> {
    let bits = |[r, g, b]: [f32; 3]| {
        let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        (luminance.is_finite() && luminance > 0.0).then(|| luminance.to_bits())
    };
    let mut upper = vec![0u64; 1 << 16];
    replay(&mut |pixel| {
        if let Some(bits) = bits(pixel) {
            upper[(bits >> 16) as usize] += 1;
        }
    })?;
    let lit: u64 = upper.iter().sum();
    if lit == 0 {
        return Ok(0.0);
    }
    // Rounded down without overflow.
    let mut rank = (lit - 1) - (lit - 1).div_ceil(100);
    let wanted = bin_of_rank(&upper, &mut rank);
    let mut lower = vec![0u64; 1 << 16];
    replay(&mut |pixel| {
        if let Some(bits) = bits(pixel).filter(|bits| bits >> 16 == wanted) {
            lower[(bits & 0xffff) as usize] += 1;
        }
    })?;
    let percentile = f32::from_bits(wanted << 16 | bin_of_rank(&lower, &mut rank));
    Ok((0.8 / percentile).log2())
}

/// The bin that holds the value of a rank; the rank becomes that within the bin.
fn bin_of_rank(counts: &[u64], rank: &mut u64) -> u32 {
    for (bin, &count) in (0..).zip(counts) {
        if *rank < count {
            return bin;
        }
        *rank -= count;
    }
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film_of(values: &[f32]) -> Film {
        let mut film = Film::new(values.len() as u32, 1);
        for (pixel, &value) in film.pixels.iter_mut().zip(values) {
            pixel.radiance.x = 2.0 * value;
            pixel.radiance.y = 2.0 * value;
            pixel.radiance.z = 2.0 * value;
            pixel.squares.x = 2.0 * value * value;
            pixel.samples = 2;
        }
        film
    }

    #[test]
    fn radiance_is_the_mean_of_the_samples() {
        let film = film_of(&[0.5, 3.0]);
        assert_eq!(film.radiance(1, 0), [3.0; 3]);
        assert_eq!(film.variance_of_mean(1, 0)[0], 0.0);
        assert_eq!(film.samples(), 4);
    }

    #[test]
    fn exposure_ignores_a_few_bright_pixels_and_black_ones() {
        let mut values = vec![0.1; 1000];
        values.extend([0.0; 500]);
        values.extend([1e6; 5]);
        assert!((automatic_exposure(&film_of(&values)) - 3.0).abs() < 1e-5);
        assert_eq!(automatic_exposure(&film_of(&[0.0; 4])), 0.0);
    }

    #[test]
    fn the_percentile_is_exact() {
        let values: Vec<f32> = (0..1234).map(|i| 1.0 + ((i * 7919) % 1234) as f32 * 1e-6).collect();
        let mut sorted = values.clone();
        sorted.sort_by(f32::total_cmp);
        let film = film_of(&values);
        let luminance = |v: f32| 0.2126 * v + 0.7152 * v + 0.0722 * v;
        assert_eq!(automatic_exposure(&film), (0.8 / luminance(sorted[1233 * 99 / 100])).log2());
    }
}
