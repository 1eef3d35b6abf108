//! How radiance becomes the brightness of a picture that is looked at.

use kernels::tone::kernel::tone_map;
use kernels::tone::reinhard_tone_map;
use std::str::FromStr;

/// What follows the exposure of a PNG. Radiance that is measured in never goes through it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ToneCurve {
    /// The encoding of sRGB alone (IEC 61966-2-1); what is brighter than white is cut off.
    #[default]
    Srgb,
    /// Reinhard's global operator with a white point two stops above white (Reinhard et al. 2002, eq. 4), then sRGB.
    Reinhard,
}

impl ToneCurve {
    /// All of them.
    pub const ALL: [Self; 2] = [ToneCurve::Srgb, ToneCurve::Reinhard];

    /// What users call it.
    pub fn name(self) -> &'static str {
        match self {
            ToneCurve::Srgb => "srgb",
            ToneCurve::Reinhard => "reinhard",
        }
    }

    /// Encoded colour, each channel in [0, 1], of a radiance in W/(m² sr) that is brightened by `exposure` stops.
    pub(crate) fn encode(self, radiance: [f32; 3], exposure: f32) -> [f32; 3] {
        let encoded = match self {
            ToneCurve::Srgb => tone_map(radiance.into(), exposure),
            ToneCurve::Reinhard => reinhard_tone_map(radiance.into(), exposure),
        };
        encoded.to_array()
    }
}

impl std::fmt::Display for ToneCurve {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ToneCurve {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|curve| curve.name() == text)
            .ok_or_else(|| format!("`{text}` is no tone curve; use srgb or reinhard"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for curve in ToneCurve::ALL {
            assert_eq!(curve.to_string().parse(), Ok(curve));
        }
        assert!("filmic".parse::<ToneCurve>().is_err());
    }
}
