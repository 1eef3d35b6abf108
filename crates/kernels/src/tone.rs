//! From radiance to the 8-bit values of a PNG.

use crate::warp::kernel::luminance;
use wgsl_rs::std::{Vec3f, vec3f};
use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use wgsl_rs::std::*;

    /// The sRGB transfer function (IEC 61966-2-1) of a linear value, clamped to [0, 1].
    pub fn srgb_encode(linear: f32) -> f32 {
        if linear >= 1.0 {
            return 1.0;
        }
        let x = max(linear, 0.0);
        if x <= 0.0031308 {
            return 12.92 * x;
        }
        1.055 * pow(x, 1.0 / 2.4) - 0.055
    }

    /// The linear value of an sRGB component in [0, 1].
    pub fn srgb_decode(encoded: f32) -> f32 {
        if encoded <= 0.04045 {
            return encoded / 12.92;
        }
        pow((encoded + 0.055) / 1.055, 2.4)
    }

    /// Exposed and encoded colour, each channel in [0, 1]; `exposure` is in stops.
    pub fn tone_map(radiance: Vec3f, exposure: f32) -> Vec3f {
        let exposed = radiance * exp2(exposure);
        vec3f(srgb_encode(exposed.x), srgb_encode(exposed.y), srgb_encode(exposed.z))
    }
}

/// The luminance that [`reinhard_tone_map`] shows as white; what is brighter is cut off. Two stops above 1.
pub const REINHARD_WHITE: f32 = 4.0;

/// As [`kernel::tone_map`], but with Reinhard's global operator between exposure and encoding: "Photographic Tone
/// Reproduction for Digital Images" (Reinhard et al. 2002), eq. 4, L_d = L (1 + L / L_white²) / (1 + L).
///
/// L is the relative luminance (Rec. 709) of the exposed colour, whose channels are all scaled by L_d / L: hue and
/// saturation stay, and strong colours may reach the gamut's end before white does. The paper's key value is left to
/// the exposure. Not among the kernels: only finished films are toned, and no program need be compiled for it.
pub fn reinhard_tone_map(radiance: Vec3f, exposure: f32) -> Vec3f {
    let exposed = radiance * exposure.exp2();
    // Negative luminance is black anyway. Infinity would become 0 / 0; all above the bound has the limit's factor.
    let relative = luminance(exposed).clamp(0.0, 1e30);
    let toned = exposed * ((1.0 + relative / (REINHARD_WHITE * REINHARD_WHITE)) / (1.0 + relative));
    vec3f(kernel::srgb_encode(toned.x), kernel::srgb_encode(toned.y), kernel::srgb_encode(toned.z))
}

#[cfg(test)]
mod tests {
    use super::kernel::{srgb_decode, srgb_encode, tone_map};
    use super::{REINHARD_WHITE, reinhard_tone_map};
    use wgsl_rs::std::{Vec3f, vec3f};

    fn grey(radiance: f32, exposure: f32) -> f32 {
        let Vec3f { x, y, z } = reinhard_tone_map(vec3f(radiance, radiance, radiance), exposure);
        assert!(x == y && y == z);
        x
    }

    #[test]
    fn reinhard_rises_from_black_to_white_at_its_white_point() {
        assert_eq!(grey(0.0, 3.0), 0.0);
        assert_eq!(grey(-1.0, 0.0), 0.0);
        // 1 becomes (1 + 1 / 16) / 2.
        assert!((grey(1.0, 0.0) - srgb_encode(0.53125)).abs() < 1e-6);
        assert!((grey(0.25, 2.0) - grey(1.0, 0.0)).abs() < 1e-6);
        assert!((grey(REINHARD_WHITE, 0.0) - 1.0).abs() < 1e-6);
        let below = grey(0.98 * REINHARD_WHITE, 0.0);
        assert!(below < 1.0 && below > 0.98);
        let mut last = 0.0;
        for step in 1..400 {
            let value = grey(step as f32 * 0.01, 0.0);
            assert!(value > last, "{step}");
            last = value;
        }
        for bright in [4.1, 1e3, 1e35, f32::INFINITY] {
            assert_eq!(grey(bright, 0.0), 1.0, "{bright}");
        }
    }

    #[test]
    fn reinhard_keeps_the_hue_of_what_fits_and_hardly_touches_the_dark() {
        let leaf = vec3f(0.9, 1.8, 0.3);
        let toned = reinhard_tone_map(leaf, 0.0).to_array().map(srgb_decode);
        assert!(toned.iter().all(|channel| *channel < 1.0));
        assert!((toned[0] / toned[1] - 0.5).abs() < 1e-3 && (toned[2] / toned[1] - 1.0 / 6.0).abs() < 1e-3);
        // The other curve cuts its green off, and so turns it yellow.
        assert_eq!(tone_map(leaf, 0.0).y, 1.0);
        let dark = vec3f(0.002, 0.004, 0.001);
        let (one, other) = (reinhard_tone_map(dark, 0.0), tone_map(dark, 0.0));
        assert!((one.y - other.y).abs() < 1e-3);
    }

    #[test]
    fn srgb_end_points_and_middle_grey() {
        assert_eq!(srgb_encode(-1.0), 0.0);
        assert_eq!(srgb_encode(2.0), 1.0);
        // 18 % grey is 118/255 in sRGB.
        assert_eq!((srgb_encode(0.18) * 255.0).round(), 118.0);
        for byte in 0..=255u8 {
            let value = f32::from(byte) / 255.0;
            assert!((srgb_encode(srgb_decode(value)) - value).abs() < 1e-5);
        }
        // The two branches meet.
        assert!((srgb_encode(0.0031308) - srgb_encode(0.0031309)).abs() < 1e-5);
    }
}
