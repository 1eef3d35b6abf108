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
}

impl Image {
    /// The mean of the linear values (byte / 255), alpha included.
    pub fn mean(&self) -> [f64; 4] {
        let mut sum = [0u64; 4];
        for pixel in self.pixels.iter() {
            for (s, p) in sum.iter_mut().zip(pixel) {
                *s += u64::from(*p);
            }
        }
        let count = self.pixels.len().max(1) as f64;
        sum.map(|s| s as f64 / (255.0 * count))
    }
}
