//! How samples are spread over the pixels and what part of the picture is rendered.

use crate::RenderSettings;
use kernels::random::kernel::{SAMPLER_INDEPENDENT, SAMPLER_SOBOL};
use kernels::reconstruction::kernel::{FILTER_BLACKMAN_HARRIS, FILTER_BOX, FILTER_GAUSSIAN, FILTER_TENT};
use kernels::records::kernel::MAX_SEQUENCE_BITS;

/// Where random numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Sampler {
    /// Numbers that know nothing of each other.
    Independent,
    /// Scrambled Sobol points: less noise, spread over the pixels so that it is seen less; see the kernel module
    /// `sobol`.
    #[default]
    Sobol,
}

impl Sampler {
    /// As the kernels number it.
    pub(crate) fn code(self) -> u32 {
        match self {
            Sampler::Independent => SAMPLER_INDEPENDENT,
            Sampler::Sobol => SAMPLER_SOBOL,
        }
    }
}

/// How light that arrives around the middle of a pixel is weighted. Every sample counts the same: where it is taken
/// is drawn with the filter as density (see the kernel module `reconstruction`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Filter {
    /// The pixel's own square.
    #[default]
    Box,
    /// Falls linearly up to a radius of 1 pixel.
    Tent,
    /// Standard deviation 0.5 pixels, radius 1.5 pixels.
    Gaussian,
    /// The four-term window with a radius of 1.5 pixels.
    BlackmanHarris,
}

impl Filter {
    /// As the kernels number it.
    pub(crate) fn code(self) -> u32 {
        match self {
            Filter::Box => FILTER_BOX,
            Filter::Tent => FILTER_TENT,
            Filter::Gaussian => FILTER_GAUSSIAN,
            Filter::BlackmanHarris => FILTER_BLACKMAN_HARRIS,
        }
    }
}

/// A part of a picture, in pixels of the whole picture from its top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CropWindow {
    /// Columns left of it.
    pub x: u32,
    /// Rows above it.
    pub y: u32,
    /// Its columns, at least 1.
    pub width: u32,
    /// Its rows, at least 1.
    pub height: u32,
}

impl CropWindow {
    /// Whether all of it lies in a picture of the given size.
    pub fn lies_in(&self, width: u32, height: u32) -> bool {
        let fits = |start: u32, extent: u32, whole: u32| {
            extent > 0 && start.checked_add(extent).is_some_and(|end| end <= whole)
        };
        fits(self.x, self.width, width) && fits(self.y, self.height, height)
    }
}

impl RenderSettings {
    /// The part of the picture that is rendered, cut off at the picture's edges; never empty.
    pub fn window(&self) -> CropWindow {
        let whole = CropWindow { x: 0, y: 0, width: self.width, height: self.height };
        let crop = self.crop.unwrap_or(whole);
        let x = crop.x.min(self.width.saturating_sub(1));
        let y = crop.y.min(self.height.saturating_sub(1));
        CropWindow {
            x,
            y,
            width: crop.width.max(1).min(self.width - x),
            height: crop.height.max(1).min(self.height - y),
        }
    }

    /// Binary logarithm of the number of samples for which the sequence is best, rounded up.
    pub(crate) fn sequence_bits(&self) -> u32 {
        let samples = u64::from(self.samples.max(1));
        samples.next_power_of_two().trailing_zeros().min(MAX_SEQUENCE_BITS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(crop: (u32, u32, u32, u32)) -> (u32, u32, u32, u32) {
        let (x, y, width, height) = crop;
        let crop = Some(CropWindow { x, y, width, height });
        let settings = RenderSettings { width: 40, height: 30, crop, ..RenderSettings::default() };
        let CropWindow { x, y, width, height } = settings.window();
        (x, y, width, height)
    }

    #[test]
    fn windows_are_cut_off_at_the_edges() {
        assert_eq!(window((3, 4, 10, 20)), (3, 4, 10, 20));
        assert_eq!(window((30, 20, 100, u32::MAX)), (30, 20, 10, 10));
        assert_eq!(window((u32::MAX, 29, 0, 5)), (39, 29, 1, 1));
        let all = RenderSettings { width: 40, height: 30, ..RenderSettings::default() };
        assert_eq!(all.window(), CropWindow { x: 0, y: 0, width: 40, height: 30 });
        assert!(all.window().lies_in(40, 30) && !all.window().lies_in(39, 30));
        assert!(!CropWindow { x: u32::MAX, y: 0, width: 2, height: 1 }.lies_in(40, 30));
    }

    #[test]
    fn sequences_are_as_long_as_the_samples_need() {
        for (samples, bits) in
            [(0, 0), (1, 0), (2, 1), (3, 2), (64, 6), (65, 7), (u32::MAX, MAX_SEQUENCE_BITS)]
        {
            let settings = RenderSettings { samples, ..RenderSettings::default() };
            assert_eq!(settings.sequence_bits(), bits, "{samples}");
        }
    }
}
