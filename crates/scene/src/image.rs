use std::sync::Arc;

/// A picture used as a texture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// What a user knows it by, the file name as a rule.
    pub name: String,
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// Red, green, blue, alpha of every pixel, row by row from the top; `width * height` entries.
    pub pixels: Arc<[[u8; 4]]>,
    /// Colours are encoded as sRGB (IEC 61966-2-1) and become linear when they are looked up, before they are
    /// filtered; otherwise they are linear, byte / 255. Alpha is linear in any case.
    pub srgb: bool,
}

impl Image {
    /// The mean of the linear values, alpha included.
    pub fn mean(&self) -> [f64; 4] {
        // How often each value occurs: exact, and the curve is evaluated for 256 values instead of every pixel.
        let mut counts = [[0u64; 256]; 4];
        for pixel in self.pixels.iter() {
            for (counts, value) in counts.iter_mut().zip(pixel) {
                counts[usize::from(*value)] += 1;
            }
        }
        let number = self.pixels.len().max(1) as f64;
        let mean = |channel: usize| {
            let linear = |value: usize| {
                let encoded = value as f64 / 255.0;
                if self.srgb && channel < 3 { linear_of_srgb(encoded) } else { encoded }
            };
            let sum: f64 = (0..256).map(|value| counts[channel][value] as f64 * linear(value)).sum();
            sum / number
        };
        [mean(0), mean(1), mean(2), mean(3)]
    }
}

/// The linear value of an sRGB component in [0, 1] (IEC 61966-2-1).
fn linear_of_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_linear() {
        let pixels: Vec<[u8; 4]> = vec![[0, 188, 255, 128], [255, 188, 255, 128]];
        let image =
            |srgb| Image { name: String::new(), width: 2, height: 1, pixels: pixels.clone().into(), srgb };
        assert_eq!(image(false).mean(), [0.5, 188.0 / 255.0, 1.0, 128.0 / 255.0]);
        let [r, g, b, a] = image(true).mean();
        assert_eq!([r, b, a], [0.5, 1.0, 128.0 / 255.0]);
        // The value of half the brightness.
        assert!((g - 0.5).abs() < 0.003, "{g}");
    }
}
