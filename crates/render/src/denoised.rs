//! A picture whose noise is removed before it is written.
//!
//! What removes it is a function that is handed in: this crate knows no denoiser, only what every one of them wants.
//! It must see the whole picture, so the memory for these pictures grows with their size.

use crate::bands::{BAND_BYTES, Band, BandStatistics, Samples, band_rows, render_bands};
use crate::film::mean_radiance;
use crate::{LoadedScene, Progress, RenderError, RenderSettings};
use kernels::records::kernel::{FilmPixel, LayerPixel};
use std::error::Error;

/// What a denoiser gets to see; row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NoisyPicture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Mean radiance in W/(m² sr). The noise of different pixels is nearly independent whatever the reconstruction
    /// filter, because every sample counts for one pixel alone.
    pub radiance: Vec<[f32; 3]>,
    /// Share of light that is sent on by what is met first, from 0 to 1; 0 for what is not there.
    pub albedo: Vec<[f32; 3]>,
    /// Mean over the samples of the unit normal of what is met first, in the world; 0 for what is not there.
    pub normal: Vec<[f32; 3]>,
}

/// Returns the radiance without noise, as many pixels as there are.
pub type DenoiseFunction<'a> =
    dyn Fn(&NoisyPicture) -> Result<Vec<[f32; 3]>, Box<dyn Error + Send + Sync>> + 'a;

/// Bytes that a picture may take while it is denoised.
const MOST_BYTES: u64 = 4 << 30;
/// Bytes that a pixel takes while it is denoised: sums, layers, four colours here and as many in the denoiser.
const PIXEL_BYTES: u64 =
    (size_of::<FilmPixel>() + size_of::<LayerPixel>() + 8 * size_of::<[f32; 3]>()) as u64;

/// Whether a picture is small enough to be denoised.
///
/// # Errors
/// [`RenderError::TooLargeToDenoise`] if it is not.
pub fn check_denoised_size(settings: &RenderSettings) -> Result<(), RenderError> {
    let window = settings.window();
    let needed = u64::from(window.width) * u64::from(window.height) * PIXEL_BYTES;
    if needed > MOST_BYTES {
        return Err(RenderError::TooLargeToDenoise { needed, limit: MOST_BYTES });
    }
    Ok(())
}

/// As [`render_bands`] with layers, but what the bands show is denoised; the samples are in them nevertheless.
///
/// # Errors
/// As [`render_bands`], or if the picture is too large or `denoise` fails.
pub fn render_denoised<'a>(
    scene: &dyn LoadedScene,
    settings: &RenderSettings,
    samples: impl Into<Samples<'a>>,
    denoise: &DenoiseFunction<'_>,
    progress: &Progress<'_>,
    sink: &mut dyn FnMut(&Band<'_>) -> Result<(), RenderError>,
) -> Result<BandStatistics, RenderError> {
    check_denoised_size(settings)?;
    // All rows in one band.
    render_bands(scene, settings, samples, true, u64::MAX, progress, &mut |whole| {
        let noisy = noisy_picture(whole);
        let denoised = denoise(&noisy).map_err(RenderError::Denoise)?;
        if denoised.len() != whole.pixels.len() {
            return Err(RenderError::Denoise("the denoiser returned a picture of another size".into()));
        }
        drop(noisy);
        let width = whole.width as usize;
        let rows = band_rows(settings, true, BAND_BYTES);
        let size = (rows as usize * width).max(1);
        let parts = whole.pixels.chunks(size).zip(whole.layers.chunks(size)).zip(denoised.chunks(size));
        let first_rows = (0..).step_by(rows.max(1) as usize);
        for (first_row, ((pixels, layers), denoised)) in first_rows.zip(parts) {
            sink(&Band { first_row, width: whole.width, pixels, layers, denoised })?;
        }
        Ok(())
    })
}

fn noisy_picture(band: &Band<'_>) -> NoisyPicture {
    let height = band.pixels.len() / (band.width as usize).max(1);
    let mean = |sum: [f32; 3], pixel: &LayerPixel| sum.map(|sum| sum / pixel.samples.max(1) as f32);
    NoisyPicture {
        width: band.width,
        // Not more than the rows of the picture.
        height: height as u32,
        radiance: band.pixels.iter().map(mean_radiance).collect(),
        albedo: band
            .layers
            .iter()
            .map(|pixel| mean(pixel.albedo.to_array(), pixel).map(|albedo| albedo.clamp(0.0, 1.0)))
            .collect(),
        normal: band.layers.iter().map(|pixel| mean(pixel.normal.to_array(), pixel)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_fits_into_memory_is_denoised() {
        let size = |edge| RenderSettings { width: edge, height: edge, ..RenderSettings::default() };
        assert!(check_denoised_size(&size(4096)).is_ok());
        let error = check_denoised_size(&size(16384)).unwrap_err().to_string();
        assert!(error.contains("memory") && error.contains("--denoise"), "{error}");
        let crop = Some(crate::CropWindow { x: 5000, y: 100, width: 64, height: 64 });
        assert!(check_denoised_size(&RenderSettings { crop, ..size(16384) }).is_ok());
    }
}
