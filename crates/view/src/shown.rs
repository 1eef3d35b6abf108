//! What the window can show of a film: the picture, or what lies behind it, in colours.

use crate::canvas::Image;
use kernels::records::kernel::{FilmPixel, LayerPixel};
use render::{Film, ToneCurve, shown_colour};
use std::thread;

/// What is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shown {
    /// The picture.
    #[default]
    Picture,
    /// Share of light that surfaces send on.
    Albedo,
    /// Which way surfaces face: red to the x axis, green to y, blue to z.
    Normal,
    /// How far away everything is: near is bright.
    Depth,
    /// A colour for every object.
    Object,
    /// How many rays a sample took: dark few, bright many.
    Cost,
}

impl Shown {
    /// All of them.
    pub const ALL: [Shown; 6] =
        [Shown::Picture, Shown::Albedo, Shown::Normal, Shown::Depth, Shown::Object, Shown::Cost];

    /// What users call it; layers as in `--layers`.
    pub fn name(self) -> &'static str {
        match self {
            Shown::Picture => "picture",
            Shown::Albedo => "albedo",
            Shown::Normal => "normal",
            Shown::Depth => "depth",
            Shown::Object => "object",
            Shown::Cost => "cost",
        }
    }

    /// What it shows, in a sentence.
    pub fn explanation(self) -> &'static str {
        match self {
            Shown::Picture => "The picture itself",
            Shown::Albedo => "Share of light that surfaces send on",
            Shown::Normal => "Which way surfaces face: red along x, green along y, blue along z",
            Shown::Depth => "How far away everything is; near is bright",
            Shown::Object => "A colour for every object",
            Shown::Cost => "Rays per sample; bright where the picture takes longest",
        }
    }

    /// Whether it is made of the layers of a film and not of its light.
    pub fn is_layer(self) -> bool {
        match self {
            Shown::Picture | Shown::Cost => false,
            Shown::Albedo | Shown::Normal | Shown::Depth | Shown::Object => true,
        }
    }
}

/// A film as it is shown, brightened by `exposure` stops and bent by `curve`, or what its rays cost.
pub fn film_image(film: &Film, exposure: f32, curve: ToneCurve, shown: Shown) -> Image {
    let pixels = if shown == Shown::Cost {
        let most = highest(film.pixels.iter().map(rays_per_sample));
        in_parallel(&film.pixels, |pixel| heat(rays_per_sample(pixel) / most))
    } else {
        in_parallel(&film.pixels, |pixel| {
            let scale = 1.0 / pixel.samples.max(1) as f32;
            packed(shown_colour(pixel.radiance.to_array().map(|sum| sum * scale), exposure, curve))
        })
    };
    Image { width: film.width as usize, height: film.height as usize, pixels }
}

/// Layers of a picture of some width as they are shown.
pub fn layer_image(layers: &[LayerPixel], width: usize, shown: Shown) -> Image {
    let depths = layers.iter().filter(|layer| layer.hits > 0).map(mean_depth);
    let (near, far) =
        depths.fold((f32::INFINITY, 0.0f32), |(near, far), depth| (near.min(depth), far.max(depth)));
    let pixels = in_parallel(layers, |layer| match shown {
        // Albedo is a share of light, so the encoding of pictures suits it.
        Shown::Albedo | Shown::Picture | Shown::Cost => {
            let albedo = layer.albedo.to_array().map(|sum| sum / layer.samples.max(1) as f32);
            packed(shown_colour(albedo, 0.0, ToneCurve::Srgb))
        }
        Shown::Normal if layer.hits > 0 => {
            let sum = layer.normal.to_array();
            let length = sum.iter().map(|v| v * v).sum::<f32>().sqrt().max(1e-20);
            packed(sum.map(|v| byte(0.5 + 0.5 * v / length)))
        }
        Shown::Depth if layer.hits > 0 => {
            // What is twice as far away is half as bright: a horizon must not make all else alike.
            let far = (near / far).min(0.999_999);
            let share = (near / mean_depth(layer) - far) / (1.0 - far);
            packed([byte(0.15 + 0.85 * share); 3])
        }
        Shown::Object if layer.object > 0 => object_colour(layer.object, layer.instance),
        Shown::Normal | Shown::Depth | Shown::Object => 0,
    });
    Image { width, height: layers.len() / width.max(1), pixels }
}

fn mean_depth(layer: &LayerPixel) -> f32 {
    layer.depth / layer.hits.max(1) as f32
}

fn rays_per_sample(pixel: &FilmPixel) -> f32 {
    pixel.rays as f32 / pixel.samples.max(1) as f32
}

/// A high value that a few outliers do not decide: the largest of every 64th, at least 1.
fn highest(values: impl Iterator<Item = f32>) -> f32 {
    values.step_by(64).fold(1.0, f32::max)
}

/// Black, violet, red, yellow, white.
fn heat(share: f32) -> u32 {
    const STOPS: [[f32; 3]; 5] =
        [[0.0, 0.0, 0.05], [0.35, 0.05, 0.45], [0.85, 0.2, 0.25], [1.0, 0.75, 0.2], [1.0, 1.0, 0.9]];
    let place = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let below = (place as usize).min(STOPS.len() - 2);
    let between = place - below as f32;
    packed(std::array::from_fn(|c| byte(STOPS[below][c] + between * (STOPS[below + 1][c] - STOPS[below][c]))))
}

/// A colour that differs from those of neighbouring numbers.
fn object_colour(object: u32, instance: u32) -> u32 {
    let mut hash = object.wrapping_mul(0x9e37_79b9) ^ instance.wrapping_mul(0x85eb_ca6b);
    hash ^= hash >> 15;
    hash = hash.wrapping_mul(0x2c1b_3c6d);
    hash ^= hash >> 13;
    // Neither dark as the sky nor white.
    packed([0, 8, 16].map(|shift| 60 + ((hash >> shift & 255) * 180 / 255) as u8))
}

fn byte(share: f32) -> u8 {
    (share * 255.0).round() as u8
}

fn packed([r, g, b]: [u8; 3]) -> u32 {
    u32::from(r) << 16 | u32::from(g) << 8 | u32::from(b)
}

/// Converts pixels on all processors.
fn in_parallel<T: Sync>(pixels: &[T], convert: impl Fn(&T) -> u32 + Sync) -> Vec<u32> {
    let threads = thread::available_parallelism().map_or(1, usize::from).min(16);
    let mut converted = vec![0; pixels.len()];
    let part = pixels.len().div_ceil(threads).max(4096);
    thread::scope(|scope| {
        for (from, to) in pixels.chunks(part).zip(converted.chunks_mut(part)) {
            let convert = &convert;
            scope.spawn(move || to.iter_mut().zip(from).for_each(|(to, from)| *to = convert(from)));
        }
    });
    converted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_is_shown_as_it_is_saved() {
        let mut film = Film::new(100, 70);
        for (index, pixel) in film.pixels.iter_mut().enumerate() {
            pixel.radiance = [index as f32 * 1e-3, 0.18, 2.0].into();
            pixel.samples = 2;
        }
        for curve in ToneCurve::ALL {
            let image = film_image(&film, 1.0, curve, Shown::Picture);
            assert_eq!((image.width, image.height), (100, 70));
            for (pixel, radiance) in image.pixels.iter().zip(film.radiances()) {
                assert_eq!(*pixel, packed(shown_colour(radiance, 1.0, curve)));
            }
        }
    }

    #[test]
    fn cost_runs_from_dark_to_bright() {
        let mut film = Film::new(2, 1);
        film.pixels[0].rays = 100;
        film.pixels[0].samples = 10;
        let image = film_image(&film, 0.0, ToneCurve::Srgb, Shown::Cost);
        assert!(image.pixels[0] > 0x00f0_f000 && image.pixels[1] < 0x20, "{:x?}", image.pixels);
    }

    #[test]
    fn layers_have_colours_and_the_sky_is_black() {
        let mut layers: [LayerPixel; 3] = bytemuck_zeroed();
        for (layer, depth) in layers.iter_mut().zip([2.0, 4.0]) {
            (layer.samples, layer.hits, layer.object) = (2, 2, depth as u32);
            layer.normal = [0.0, 0.0, 2.0].into();
            layer.depth = 2.0 * depth;
            layer.albedo = [2.0, 0.0, 0.0].into();
        }
        let colours = |shown| layer_image(&layers, 3, shown).pixels;
        assert_eq!(colours(Shown::Normal), [0x80_80ff, 0x80_80ff, 0]);
        assert_eq!(colours(Shown::Depth), [0xff_ffff, 0x26_2626, 0]);
        assert_eq!(colours(Shown::Albedo), [0xff_0000, 0xff_0000, 0]);
        let objects = colours(Shown::Object);
        assert!(objects[0] != objects[1] && objects[2] == 0);
    }

    fn bytemuck_zeroed() -> [LayerPixel; 3] {
        [bytemuck::Zeroable::zeroed(); 3]
    }
}
