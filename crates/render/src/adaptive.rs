//! More samples where the picture is noisy, without a bias.
//!
//! A pixel whose samples happen to be dark looks clean; if it then got fewer samples and all were averaged, the
//! picture would come out too dark. So the picture is rendered as two independent halves A and B. Each takes a few
//! samples everywhere first; how many it takes on top is decided by the first samples of the *other* half. Within
//! one half the number of samples is therefore independent of their values, its mean has no bias, and neither has
//! the mean of the two halves, which have the same weight always.
//!
//! Sobol sequences are planned for the most samples that a pixel may get, as in `passes`.

use crate::film_memory::check_film;
use crate::passes::{PassPace, Watch};
use crate::{
    Batch, ControlFlow, DeviceError, Ending, Film, LoadedScene, Progress, RenderError, RenderSettings,
};
use kernels::records::kernel::FilmPixel;
use std::array;

/// Share of the samples that is taken everywhere first.
const FIRST_SHARE: f64 = 0.25;
/// Share of the others that every pixel gets all the same, so that nothing is missed for good.
const EVEN_SHARE: f64 = 0.2;
/// A pixel gets at most this multiple of the average.
const MOST: f64 = 16.0;
/// Joined to the seed for the second half.
const OTHER_HALF: u32 = 0x9e37_79b9;

/// An adaptive rendering in the making.
#[derive(Clone, Debug)]
pub struct AdaptiveFilm {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) halves: [Half; 2],
    /// Whether it is known how many samples every pixel shall have.
    pub(crate) is_planned: bool,
}

/// One of the two independent halves.
#[derive(Clone, Debug)]
pub(crate) struct Half {
    /// The first sample that no pixel has yet.
    pub end: u32,
    /// Sums of the samples before `end`. The number of samples is that which the pixel has or, once that is planned,
    /// shall have.
    pub pixels: Vec<FilmPixel>,
}

/// How an adaptive rendering spends its samples.
struct Shares {
    /// Settings of the halves.
    halves: [RenderSettings; 2],
    /// Samples that every pixel of a half gets first.
    first: u32,
    /// What it gets on top, on average.
    more: f64,
}

impl Shares {
    fn of(settings: &RenderSettings) -> Self {
        let per_half = f64::from(settings.samples.max(4)) / 2.0;
        let first = ((per_half * FIRST_SHARE).round() as u32).max(2);
        let halves = [settings.seed, settings.seed ^ OTHER_HALF].map(|seed| RenderSettings {
            seed,
            samples: (per_half * MOST) as u32,
            ..settings.clone()
        });
        Shares { halves, first, more: per_half - f64::from(first) }
    }
}

impl AdaptiveFilm {
    /// Nothing yet.
    pub fn new(settings: &RenderSettings) -> Self {
        let Film { width, height, pixels } = Film::of(settings);
        let half = Half { end: 0, pixels };
        AdaptiveFilm { width, height, halves: [half.clone(), half], is_planned: false }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.halves[0].pixels.len()
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Samples of all pixels that are in it.
    pub fn taken(&self) -> u64 {
        self.halves.iter().flat_map(Half::taken).map(|pixel| u64::from(pixel.samples)).sum()
    }

    /// Samples per pixel that are in it, on average.
    pub fn samples(&self) -> u32 {
        let pixels = self.pixels().max(1) as u64;
        u32::try_from((self.taken() + pixels / 2) / pixels).unwrap_or(u32::MAX)
    }

    /// Whether it can be a film of a picture with these settings. What a file says might be anything.
    pub fn is_of(&self, settings: &RenderSettings) -> bool {
        let window = settings.window();
        let Shares { halves: [half, _], first, .. } = Shares::of(settings);
        let allowed = if self.is_planned { first..=half.samples.max(first) } else { 0..=first };
        let fits = |half: &Half| {
            allowed.contains(&half.end) && half.pixels.iter().all(|pixel| allowed.contains(&pixel.samples))
        };
        (window.width, window.height) == (self.width, self.height) && self.halves.iter().all(fits)
    }

    /// The picture so far.
    pub fn film(&self) -> Film {
        let [a, b] = &self.halves;
        let pixels = a.taken().zip(b.taken()).map(|(a, b)| join(&a, &b)).collect();
        Film { width: self.width, height: self.height, pixels }
    }

    /// Decides how many samples every pixel shall have, each half by the other.
    fn plan(&mut self, shares: &Shares) {
        let [a, b] = &self.halves;
        let wanted = [b, a].map(|other| {
            let film = Film { width: self.width, height: self.height, pixels: other.pixels.clone() };
            sample_counts(&film, shares.first, shares.more)
        });
        for (half, wanted) in self.halves.iter_mut().zip(wanted) {
            for (pixel, wanted) in half.pixels.iter_mut().zip(wanted) {
                pixel.samples = wanted;
            }
        }
        self.is_planned = true;
    }

    /// The half that is worked at next, and the last sample of its pixels, which is not taken any more.
    fn next(&self, shares: &Shares) -> Option<(usize, u32)> {
        let ends = self.halves.iter().map(|half| match self.is_planned {
            false => shares.first,
            true => half.pixels.iter().map(|pixel| pixel.samples).max().unwrap_or(0),
        });
        ends.enumerate().find(|(half, end)| self.halves[*half].end < *end)
    }
}

impl Half {
    /// Its pixels with the number of samples that are in them.
    fn taken(&self) -> impl Iterator<Item = FilmPixel> + '_ {
        self.pixels.iter().map(|pixel| FilmPixel { samples: pixel.samples.min(self.end), ..*pixel })
    }
}

/// Whether an adaptive rendering fits into memory: both halves, and the one that samples are being added to again.
///
/// # Errors
/// [`RenderError::FilmTooLarge`] if it does not.
pub fn check_adaptive(settings: &RenderSettings) -> Result<(), RenderError> {
    let window = settings.window();
    check_film(3 * u64::from(window.width) * u64::from(window.height) * size_of::<FilmPixel>() as u64)
}

/// Renders a picture with `settings.samples` per pixel on average, at least four.
///
/// # Errors
/// As [`LoadedScene::add_samples`].
pub fn render_adaptive(
    scene: &dyn LoadedScene,
    settings: &RenderSettings,
    progress: &Progress<'_>,
) -> Result<Film, DeviceError> {
    let mut film = AdaptiveFilm::new(settings);
    continue_adaptive(scene, settings, &mut film, progress, &mut |_| ControlFlow::Continue(()))?;
    Ok(film.film())
}

/// Adds passes to `film` until it has `settings.samples` per pixel on average. `after` is asked between them whether to
/// go on, `progress` hears of all samples of the picture, those that were there before included. What comes out does
/// not depend on the passes.
///
/// # Errors
/// As [`LoadedScene::add_samples`]; all samples of finished passes are in `film` nevertheless.
pub fn continue_adaptive(
    scene: &dyn LoadedScene,
    settings: &RenderSettings,
    film: &mut AdaptiveFilm,
    progress: &Progress<'_>,
    after: &mut dyn FnMut(&AdaptiveFilm) -> ControlFlow<()>,
) -> Result<Ending, DeviceError> {
    let shares = Shares::of(settings);
    let pixel_count = film.pixels() as u64;
    let mut pace = PassPace::new(pixel_count);
    loop {
        if !film.is_planned && film.next(&shares).is_none() {
            film.plan(&shares);
        }
        let Some((index, end)) = film.next(&shares) else { return Ok(Ending::Complete) };
        let half = &shares.halves[index];
        let first_sample = film.halves[index].end;
        let samples = pace.samples.min(end - first_sample);
        let batch = Batch { first_sample, samples, counted: film.is_planned, ..Batch::whole(half) };
        let taken = film.taken();
        let watch = Watch::start();
        // A device that fails leaves some tiles with the new samples and some without.
        let mut pixels = film.halves[index].pixels.clone();
        scene.add_samples(half, &batch, &mut pixels, &|more| {
            watch.note(more);
            progress(taken + more)
        })?;
        film.halves[index] = Half { end: first_sample + samples, pixels };
        pace.learn(&watch.finish(pixel_count, samples));
        if after(film).is_break() {
            let is_complete = film.is_planned && film.next(&shares).is_none();
            return Ok(if is_complete { Ending::Complete } else { Ending::Stopped });
        }
    }
}

/// Samples of every pixel, the `first` ones included; `more` are added on average. They grow with the estimated
/// standard deviation relative to the radiance, which serves the mean of the relative errors best (Neyman
/// allocation), taken over the neighbourhood because few samples are a poor estimate.
fn sample_counts(film: &Film, first: u32, more: f64) -> Vec<u32> {
    let (width, height) = (film.width as usize, film.height as usize);
    let luminance = |c: [f32; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    let means: Vec<f32> =
        film.radiances().map(luminance).map(|l| if l.is_finite() { l } else { 0.0 }).collect();
    let variances: Vec<f32> = film
        .variances_of_mean()
        .map(|variance| luminance(variance) * first as f32)
        .map(|variance| if variance.is_finite() { variance } else { 0.0 })
        .collect();
    let floor = 0.05 * means.iter().map(|&m| f64::from(m)).sum::<f64>() / means.len().max(1) as f64;
    let mut weights = vec![0.0f64; means.len()];
    for y in 0..height {
        for x in 0..width {
            let (mut variance, mut mean, mut count) = (0.0, 0.0, 0.0);
            for row in y.saturating_sub(1)..(y + 2).min(height) {
                for column in x.saturating_sub(1)..(x + 2).min(width) {
                    variance += f64::from(variances[row * width + column]);
                    mean += f64::from(means[row * width + column]);
                    count += 1.0;
                }
            }
            let relative = (variance / count).sqrt() / (mean / count + floor).max(1e-30);
            weights[y * width + x] = relative;
        }
    }
    let mean_weight = weights.iter().sum::<f64>() / weights.len().max(1) as f64;
    // What one pixel may not get more of, the others do.
    let capped = |scale: f64, weight: f64| (weight * scale).min(MOST);
    let mut scale = 1.0 / mean_weight.max(1e-30);
    for _ in 0..8 {
        let sum: f64 = weights.iter().map(|&weight| capped(scale, weight)).sum();
        scale *= weights.len() as f64 / sum.max(1e-30);
    }
    // Rounding errors are carried on, so that the average is met.
    let mut carry = 0.0;
    weights
        .iter()
        .map(|&weight| {
            let share = if mean_weight > 0.0 { capped(scale, weight) } else { 1.0 };
            let exact = more.max(0.0) * (EVEN_SHARE + (1.0 - EVEN_SHARE) * share) + carry;
            let whole = exact.floor().max(0.0);
            carry = exact - whole;
            first + whole as u32
        })
        .collect()
}

/// The pixel whose mean is that of the means of two, and whose variance follows from theirs.
fn join(a: &FilmPixel, b: &FilmPixel) -> FilmPixel {
    // Of an unfinished picture.
    if a.samples == 0 || b.samples == 0 {
        return if b.samples == 0 { *a } else { *b };
    }
    let samples = a.samples.saturating_add(b.samples);
    let n = samples as f32;
    let moments = |pixel: &FilmPixel| {
        let n = pixel.samples.max(1) as f32;
        let (sums, squares) = (pixel.radiance.to_array(), pixel.squares.to_array());
        array::from_fn::<_, 3, _>(|c| {
            let mean = sums[c] / n;
            (mean, ((squares[c] / n - mean * mean) / (n - 1.0).max(1.0)).max(0.0))
        })
    };
    let (of_a, of_b) = (moments(a), moments(b));
    let mean: [f32; 3] = array::from_fn(|c| 0.5 * (of_a[c].0 + of_b[c].0));
    let variance: [f32; 3] = array::from_fn(|c| 0.25 * (of_a[c].1 + of_b[c].1));
    FilmPixel {
        radiance: mean.map(|mean| mean * n).into(),
        rays: a.rays.saturating_add(b.rays),
        // So that the variance of the mean comes out when it is computed from the sums.
        squares: array::from_fn::<f32, 3, _>(|c| n * (variance[c] * (n - 1.0) + mean[c] * mean[c])).into(),
        samples,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(values: &[f32]) -> FilmPixel {
        FilmPixel {
            radiance: [values.iter().sum(); 3].into(),
            rays: 1,
            squares: [values.iter().map(|v| v * v).sum(); 3].into(),
            samples: values.len() as u32,
        }
    }

    #[test]
    fn halves_weigh_the_same_whatever_their_samples() {
        let mut film = Film::new(1, 1);
        film.pixels[0] = join(&pixel(&[1.0, 3.0]), &pixel(&[4.0, 4.0, 4.0, 4.0, 4.0, 4.0]));
        assert!((film.radiance(0, 0)[0] - 3.0).abs() < 1e-6);
        // Variance of the mean of the first is 1, of the second 0.
        assert!((film.variance_of_mean(0, 0)[0] - 0.25).abs() < 1e-5);
        assert_eq!((film.samples(), film.rays()), (8, 2));
    }

    #[test]
    fn the_average_number_of_samples_is_met_and_noise_gets_more() {
        let mut film = Film::new(64, 64);
        for (i, entry) in film.pixels.iter_mut().enumerate() {
            *entry = if i % 64 < 8 { pixel(&[0.0, 2.0]) } else { pixel(&[1.0, 1.01]) };
        }
        let counts = sample_counts(&film, 2, 10.0);
        let mean = counts.iter().sum::<u32>() as f64 / counts.len() as f64;
        assert!((mean - 12.0).abs() < 0.1, "{mean}");
        assert!(
            counts[0] > 40 && counts[40] < 8 && counts.iter().all(|&n| n >= 4),
            "{} {}",
            counts[0],
            counts[40]
        );
        // Nothing to see: the same for all.
        assert!(sample_counts(&Film::new(8, 8), 2, 10.0).iter().all(|&n| n == 12));
    }
}
