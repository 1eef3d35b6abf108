//! From radiance to the 8-bit values of a PNG.

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

#[cfg(test)]
mod tests {
    use super::kernel::{srgb_decode, srgb_encode};

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
