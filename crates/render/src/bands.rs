//! A picture band by band: rows are rendered, handed on and forgotten, so that memory does not grow with the picture.

use crate::film::mean_radiance;
use crate::film_memory::check_kept;
use crate::passes::{StopRule, render_until};
use crate::{Batch, Film, FilmSums, Goal, LoadedScene, Progress, RenderError, RenderSettings, adaptive};
use bytemuck::Zeroable;
use kernels::records::kernel::{FilmPixel, LayerPixel};

/// Finished rows of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Band<'a> {
    /// The uppermost row, from the top of the picture.
    pub first_row: u32,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Row by row from the top.
    pub pixels: &'a [FilmPixel],
    /// As many, or none if no layers are wanted.
    pub layers: &'a [LayerPixel],
    /// As many, or none: the radiance that is shown instead of the mean of the samples.
    pub denoised: &'a [[f32; 3]],
}

impl Band<'_> {
    /// Radiance of a pixel in W/(m² sr) as it is shown.
    pub(crate) fn radiance(&self, pixel: usize) -> [f32; 3] {
        self.denoised.get(pixel).copied().unwrap_or_else(|| mean_radiance(&self.pixels[pixel]))
    }
}

/// How the samples are spread over the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling {
    /// The same number for every pixel: that of the settings.
    Uniform,
    /// On average that of the settings, more where the picture is noisy; see [`adaptive`].
    Adaptive,
    /// The same for every pixel until a time is over or the picture is clean enough.
    Until(StopRule),
}

/// Where the samples of a picture come from.
#[derive(Clone, Copy, Debug)]
pub enum Samples<'a> {
    /// They are still to be taken.
    ToTake(Sampling),
    /// They are taken already: all of the picture's window.
    Taken(&'a Film),
}

impl From<Sampling> for Samples<'_> {
    fn from(sampling: Sampling) -> Self {
        Samples::ToTake(sampling)
    }
}

/// Bytes that a band may take as a rule.
pub const BAND_BYTES: u64 = 256 << 20;
/// Bands have a multiple of this number of rows: the height of EXR's compressed blocks.
const ROW_STEP: u32 = 16;

/// What a rendering took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BandStatistics {
    /// Samples taken for the whole picture.
    pub samples: u64,
    /// Rays traced for the whole picture, shadow rays included.
    pub rays: u64,
    /// Whether no light at all arrived.
    pub black: bool,
    /// Most bytes that bands took at a time.
    pub peak_bytes: u64,
    /// Estimated relative error where the whole film was at hand, see [`crate::relative_noise`].
    pub noise: Option<f64>,
}

/// Rows of a band of a picture, given the bytes that it may take: all rows if they fit, else a multiple of 16.
pub fn band_rows(settings: &RenderSettings, with_layers: bool, bytes: u64) -> u32 {
    let layer = if with_layers { size_of::<LayerPixel>() } else { 0 };
    let film = FilmSums::most_films(settings.samples) as usize * size_of::<FilmPixel>();
    let row = u64::from(settings.window().width) * (film + layer) as u64;
    let rows = u32::try_from(bytes / row.max(1)).unwrap_or(u32::MAX);
    let height = settings.window().height;
    if rows >= height { height } else { (rows / ROW_STEP).max(1) * ROW_STEP }
}

/// Renders a picture, with the layers if they are wanted, and hands its bands from top to bottom to `sink`. A band
/// takes about `bytes`. `progress` hears of the samples of the whole picture. For samples that are taken already the
/// settings must be those that they were taken with, so that the layers are made of the same rays.
///
/// # Errors
/// If the device fails, `progress` asks to stop, or `sink` fails.
pub fn render_bands<'a>(
    scene: &dyn LoadedScene,
    settings: &RenderSettings,
    samples: impl Into<Samples<'a>>,
    with_layers: bool,
    bytes: u64,
    progress: &Progress<'_>,
    sink: &mut dyn FnMut(&Band<'_>) -> Result<(), RenderError>,
) -> Result<BandStatistics, RenderError> {
    let (planned, rendered);
    let (settings, film) = match samples.into() {
        Samples::Taken(film) => (settings, Some(film)),
        Samples::ToTake(Sampling::Uniform) => (settings, None),
        Samples::ToTake(Sampling::Adaptive) => {
            adaptive::check_adaptive(settings)?;
            rendered = adaptive::render_adaptive(scene, settings, progress)?;
            (settings, Some(&rendered))
        }
        Samples::ToTake(Sampling::Until(rule)) => {
            // So that the layers are made of the same rays as the picture.
            planned = rule.planned(settings);
            check_kept(&planned, Goal::Rule(rule))?;
            rendered = render_until(scene, settings, rule, progress)?;
            (&planned, Some(&rendered))
        }
    };
    let rows = band_rows(settings, with_layers, bytes);
    let window = settings.window();
    let width = window.width as usize;
    let mut statistics =
        BandStatistics { black: true, noise: film.map(crate::relative_noise), ..BandStatistics::default() };
    let mut layers: Vec<LayerPixel> = Vec::new();
    for first_row in (0..window.height).step_by(rows.max(1) as usize) {
        let done = statistics.samples;
        let batch = Batch { first_row, rows: rows.min(window.height - first_row), ..Batch::whole(settings) };
        let count = batch.pixels(settings);
        let own;
        let mut films = 0;
        let pixels = match film {
            Some(film) => &film.pixels[first_row as usize * width..][..count],
            None => {
                let mut sums = FilmSums::new(count, 0);
                sums.add_all(scene, settings, &batch, &|samples| progress(done + samples))?;
                films = FilmSums::most_films(settings.samples) as usize;
                own = sums.into_total();
                &own[..]
            }
        };
        if with_layers {
            layers.clear();
            layers.resize(count, LayerPixel::zeroed());
            let samples = mean_samples(pixels);
            // Whether to stop is asked all the same.
            let still = |_| progress(done);
            scene.add_layers(settings, &Batch { samples, ..batch }, &mut layers, &still)?;
        }
        let taken = films * count * size_of::<FilmPixel>() + layers.capacity() * size_of::<LayerPixel>();
        statistics.peak_bytes = statistics.peak_bytes.max(taken as u64);
        statistics.samples += pixels.iter().map(|pixel| u64::from(pixel.samples)).sum::<u64>();
        statistics.rays += pixels.iter().map(|pixel| u64::from(pixel.rays)).sum::<u64>();
        statistics.black &= pixels.iter().all(|pixel| pixel.radiance.to_array() == [0.0; 3]);
        sink(&Band { first_row, width: window.width, pixels, layers: &layers, denoised: &[] })?;
    }
    Ok(statistics)
}

/// Samples per pixel, on average.
fn mean_samples(pixels: &[FilmPixel]) -> u32 {
    let sum: u64 = pixels.iter().map(|pixel| u64::from(pixel.samples)).sum();
    u32::try_from(sum / pixels.len().max(1) as u64).unwrap_or(u32::MAX).max(1)
}
