//! How samples are spread and weighted, as users call it.

use clap::ValueEnum;
use render::{Filter, Sampler};

/// A [`Sampler`] as users call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplerChoice {
    /// Every number is drawn for itself
    Independent,
    /// Scrambled Sobol points, shared out among neighbouring pixels: less noise, and finer
    Sobol,
}

impl SamplerChoice {
    /// That of the renderer.
    pub fn of(sampler: Sampler) -> Self {
        match sampler {
            Sampler::Independent => SamplerChoice::Independent,
            Sampler::Sobol => SamplerChoice::Sobol,
        }
    }
}

impl From<SamplerChoice> for Sampler {
    fn from(choice: SamplerChoice) -> Self {
        match choice {
            SamplerChoice::Independent => Sampler::Independent,
            SamplerChoice::Sobol => Sampler::Sobol,
        }
    }
}

/// A [`Filter`] as users call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FilterChoice {
    /// The same everywhere in the pixel: sharp
    Box,
    /// Falls linearly over 1 pixel
    Tent,
    /// Bell curve, 0.5 pixels wide
    Gaussian,
    /// Bell curve that is a little narrower and ends smoothly
    BlackmanHarris,
}

impl FilterChoice {
    /// That of the renderer.
    pub fn of(filter: Filter) -> Self {
        match filter {
            Filter::Box => FilterChoice::Box,
            Filter::Tent => FilterChoice::Tent,
            Filter::Gaussian => FilterChoice::Gaussian,
            Filter::BlackmanHarris => FilterChoice::BlackmanHarris,
        }
    }
}

impl From<FilterChoice> for Filter {
    fn from(choice: FilterChoice) -> Self {
        match choice {
            FilterChoice::Box => Filter::Box,
            FilterChoice::Tent => Filter::Tent,
            FilterChoice::Gaussian => Filter::Gaussian,
            FilterChoice::BlackmanHarris => Filter::BlackmanHarris,
        }
    }
}
