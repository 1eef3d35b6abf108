//! `Carpenter`: a grey picture of a fractal landscape, made when a project is read.

use crate::ReadError;
use crate::channels::Channels;
use crate::output::Output;
use crate::values::Members;
use scene::{Channel, ChannelId, Image, ImageId, JavaRandom};

/// GroIMP's `SyntheticTexture`s have this many pixels in both directions.
const SIZE: usize = 256;

impl<'a> Channels<'a> {
    /// `Carpenter(color = 0.5, noise = 1, roughness = 1)`; its field `seed` is ignored, as in GroIMP.
    pub(crate) fn carpenter(
        &mut self,
        fields: Members,
        line: usize,
        depth: u32,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let number = |name, default| self.number(fields, name, default);
        let numbers = [number("color", 0.5)?, number("noise", 1.0)?, number("roughness", 1.0)?];
        let numbers = numbers.map(|n| if n.is_finite() { n.clamp(-1e3, 1e3) } else { 0.0 });
        let coordinates = self.coordinates(fields, line, depth, out)?;
        let key = numbers.map(f64::to_bits);
        let image: ImageId = match self.carpenters.get(&key) {
            Some(image) => *image,
            None => {
                let image = out.scene.add_image(landscape(numbers));
                self.carpenters.insert(key, image);
                image
            }
        };
        let [r, g, b, _] = out.scene.images[image.index()].mean();
        Ok(self.add(None, Channel::ImageMap { image, bilinear: true, coordinates }, [r, g, b], out))
    }
}

/// The picture: grey `color + height`, limited to [0, 1].
///
/// Known of GroIMP are diamond-square, the factor 2^-roughness from level to level, and Java's generator with
/// seed 0. Unverified choices: the field is periodic and starts at 0 in its one corner; every random offset is
/// uniform in ± noise/2 on the first level; squares' middles come before edges' middles on each level, row by row
/// from the bottom.
fn landscape([color, noise, roughness]: [f64; 3]) -> Image {
    let mut heights = vec![0.0f64; SIZE * SIZE];
    let at = |x: usize, y: usize| (y % SIZE) * SIZE + x % SIZE;
    let mut random = JavaRandom::new(0);
    let mut amplitude = noise;
    let mut step = SIZE;
    while step > 1 {
        let half = step / 2;
        let mut offset = || amplitude * (f64::from(random.next_float()) - 0.5);
        for y in (0..SIZE).step_by(step) {
            for x in (0..SIZE).step_by(step) {
                let corners = [at(x, y), at(x + step, y), at(x, y + step), at(x + step, y + step)];
                let mean = corners.iter().map(|i| heights[*i]).sum::<f64>() / 4.0;
                heights[at(x + half, y + half)] = mean + offset();
            }
        }
        for y in (0..SIZE).step_by(half) {
            // The middles of edges: every second point, beginning with the first in odd rows.
            for x in ((half - y % step)..SIZE).step_by(step) {
                let around =
                    [at(x + half, y), at(x + SIZE - half, y), at(x, y + half), at(x, y + SIZE - half)];
                let mean = around.iter().map(|i| heights[*i]).sum::<f64>() / 4.0;
                heights[at(x, y)] = mean + offset();
            }
        }
        amplitude *= 2f64.powf(-roughness);
        step = half;
    }
    let pixel = |row: usize, x: usize| {
        let grey = (color + heights[at(x, SIZE - 1 - row)]).clamp(0.0, 1.0);
        let byte = (grey * 255.0).round() as u8;
        [byte, byte, byte, 255]
    };
    let pixels: Vec<[u8; 4]> = (0..SIZE).flat_map(|row| (0..SIZE).map(move |x| pixel(row, x))).collect();
    let size = SIZE as u32;
    Image { name: "Carpenter".to_owned(), width: size, height: size, pixels: pixels.into(), srgb: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rougher_landscapes_vary_more_from_pixel_to_pixel() {
        let variation = |roughness: f64| {
            let image = landscape([0.5, 0.5, roughness]);
            let pairs = image.pixels.windows(2).map(|pair| f64::from(pair[0][0].abs_diff(pair[1][0])));
            pairs.sum::<f64>()
        };
        assert!(variation(2.0) < variation(1.0) && variation(1.0) < variation(0.2));
        assert!(landscape([0.5, 0.0, 1.0]).pixels.iter().all(|pixel| *pixel == [128, 128, 128, 255]));
        // The first random number, drawn by hand: nextFloat of Random(0) is 0.73096776.
        let first = landscape([0.5, 0.5, 1.0]).pixels[127 * SIZE + 128][0];
        assert_eq!(first, (255.0 * (0.5f64 + 0.5 * (0.730_967_76 - 0.5))).round() as u8);
    }
}
