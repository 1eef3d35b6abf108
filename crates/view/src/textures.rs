//! The images that egui draws with: its letters, above all.

use egui::epaint::ImageDelta;
use egui::{ImageData, TextureId, TexturesDelta};
use std::collections::HashMap;

/// An image with alpha.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// In pixels, at least 1.
    pub width: usize,
    /// In pixels, at least 1.
    pub height: usize,
    /// Red, green, blue, alpha, row by row from the top; colours are multiplied with alpha.
    pixels: Vec<[u8; 4]>,
}

impl Texture {
    /// The texture at a place in its pixels times a colour, all in 0 to 255.
    pub fn shade(&self, [u, v, r, g, b, a]: [f32; 6]) -> [f32; 4] {
        let texel = self.sample(u - 0.5, v - 0.5);
        [r * texel[0], g * texel[1], b * texel[2], a * texel[3]].map(|value| value / 255.0)
    }

    /// Linear between the middles of the four nearest pixels.
    fn sample(&self, u: f32, v: f32) -> [f32; 4] {
        let (x, y) = (u.floor(), v.floor());
        let (fx, fy) = (u - x, v - y);
        let texel = |x: f32, y: f32| {
            let column = x.clamp(0.0, self.width as f32 - 1.0) as usize;
            let row = y.clamp(0.0, self.height as f32 - 1.0) as usize;
            self.pixels[row * self.width + column].map(f32::from)
        };
        // Letters lie on pixels as a rule.
        if fx.abs() < 1e-3 && fy.abs() < 1e-3 {
            return texel(x, y);
        }
        let mut sum = [0.0; 4];
        for (texel, weight) in [
            (texel(x, y), (1.0 - fx) * (1.0 - fy)),
            (texel(x + 1.0, y), fx * (1.0 - fy)),
            (texel(x, y + 1.0), (1.0 - fx) * fy),
            (texel(x + 1.0, y + 1.0), fx * fy),
        ] {
            for (sum, value) in sum.iter_mut().zip(texel) {
                *sum += weight * value;
            }
        }
        sum
    }

    /// Replaces a part of it; what does not fit is left out.
    fn patch(&mut self, [x, y]: [usize; 2], part: &Texture) {
        let columns = part.width.min(self.width.saturating_sub(x));
        for row in 0..part.height.min(self.height.saturating_sub(y)) {
            let source = &part.pixels[row * part.width..][..columns];
            self.pixels[(y + row) * self.width + x..][..columns].copy_from_slice(source);
        }
    }
}

/// All images that egui uses at the moment.
#[derive(Debug, Default)]
pub struct Textures(HashMap<TextureId, Texture>);

impl Textures {
    /// An image.
    pub fn get(&self, id: TextureId) -> Option<&Texture> {
        self.0.get(&id)
    }

    /// Takes over new and changed images; those that are to go are returned, for after painting.
    pub fn update(&mut self, delta: &mut TexturesDelta) -> Vec<TextureId> {
        for (id, deltas) in delta.set.drain() {
            for delta in deltas {
                self.set(id, &delta);
            }
        }
        delta.free.drain().collect()
    }

    /// Forgets images.
    pub fn forget(&mut self, ids: &[TextureId]) {
        for id in ids {
            self.0.remove(id);
        }
    }

    fn set(&mut self, id: TextureId, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size;
        if width == 0 || height == 0 {
            return;
        }
        let texture =
            Texture { width, height, pixels: image.pixels.iter().map(|pixel| pixel.to_array()).collect() };
        match delta.pos {
            None => {
                self.0.insert(id, texture);
            }
            Some(at) => {
                if let Some(whole) = self.0.get_mut(&id) {
                    whole.patch(at, &texture);
                }
            }
        }
    }

    #[cfg(test)]
    pub fn put_white(&mut self, id: TextureId) {
        self.0.insert(id, Texture { width: 1, height: 1, pixels: vec![[255; 4]] });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::TextureOptions;
    use egui::epaint::ColorImage;
    use egui::{Color32, Context, RawInput};

    #[test]
    fn parts_replace_parts_and_images_are_forgotten() {
        let mut textures = Textures::default();
        let id = TextureId::Managed(7);
        let mut delta = TexturesDelta::default();
        delta.push(id, ImageDelta::full(ColorImage::filled([3, 2], Color32::BLACK), TextureOptions::LINEAR));
        let part = ColorImage::filled([2, 2], Color32::WHITE);
        delta.push(id, ImageDelta::partial([2, 1], part, TextureOptions::LINEAR));
        assert!(textures.update(&mut delta).is_empty());
        let texture = textures.get(id).unwrap();
        assert_eq!(texture.pixels.iter().filter(|pixel| pixel[0] == 255).count(), 1);
        // In the middle of the last pixel, and half way to the one before.
        assert_eq!(texture.shade([2.5, 1.5, 255.0, 255.0, 255.0, 255.0])[0], 255.0);
        assert_eq!(texture.shade([2.0, 1.5, 255.0, 255.0, 255.0, 255.0])[0], 127.5);
        delta.free(id);
        let gone = textures.update(&mut delta);
        textures.forget(&gone);
        assert!(textures.get(id).is_none());
    }

    #[test]
    fn letters_arrive() {
        let context = Context::default();
        let mut output = context.run_ui(RawInput::default(), |ui| {
            ui.label("leaf");
        });
        let mut textures = Textures::default();
        textures.update(&mut output.textures_delta);
        let font = textures.get(TextureId::default()).unwrap();
        assert!(font.pixels.iter().any(|pixel| pixel[3] > 0));
    }
}
