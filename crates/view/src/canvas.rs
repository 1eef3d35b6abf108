//! The pixels of a window in main memory: the picture, and over it what egui draws.
//!
//! The film is in main memory anyhow, so a window without a graphics card shows the same as one with a card, and
//! nothing competes with the kernels. What egui draws is a few thousand small triangles.

use crate::textures::{Texture, Textures};
use egui::epaint::{ClippedPrimitive, Mesh, Primitive, Vertex};

/// Pixels row by row from the top, as windows take them: red in bits 16 to 23, green 8 to 15, blue 0 to 7.
pub struct Canvas<'a> {
    /// In pixels.
    pub width: usize,
    /// In pixels.
    pub height: usize,
    /// `width * height` of them.
    pub pixels: &'a mut [u32],
}

/// A picture of its own size.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    /// In pixels.
    pub width: usize,
    /// In pixels.
    pub height: usize,
    /// As those of a [`Canvas`].
    pub pixels: Vec<u32>,
}

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Area {
    /// Columns left of it.
    pub x: usize,
    /// Rows above it.
    pub y: usize,
    /// Its columns.
    pub width: usize,
    /// Its rows.
    pub height: usize,
}

impl Canvas<'_> {
    /// Fills everything with one colour.
    pub fn clear(&mut self, colour: u32) {
        self.pixels.fill(colour);
    }

    /// Draws an image, enlarged or reduced to fill an area; every pixel is that of the image which its middle lies in.
    pub fn draw_image(&mut self, image: &Image, area: Area) {
        if image.width == 0 || image.height == 0 || area.width == 0 || area.height == 0 {
            return;
        }
        let columns: Vec<usize> = (0..area.width.min(self.width.saturating_sub(area.x)))
            .map(|x| (2 * x + 1) * image.width / (2 * area.width))
            .collect();
        for y in 0..area.height.min(self.height.saturating_sub(area.y)) {
            let row = (2 * y + 1) * image.height / (2 * area.height);
            let source = &image.pixels[row * image.width..][..image.width];
            let line = &mut self.pixels[(area.y + y) * self.width + area.x..][..columns.len()];
            if image.width == area.width {
                line.copy_from_slice(&source[..columns.len()]);
            } else {
                for (pixel, &column) in line.iter_mut().zip(&columns) {
                    *pixel = source[column];
                }
            }
        }
    }

    /// Draws what egui made of its shapes.
    pub fn draw_meshes(
        &mut self,
        primitives: &[ClippedPrimitive],
        textures: &Textures,
        pixels_per_point: f32,
    ) {
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            // Nothing of this program asks for callbacks.
            let Primitive::Mesh(mesh) = primitive else { continue };
            let Some(texture) = textures.get(mesh.texture_id) else { continue };
            let edge =
                |value: f32, most: usize| (value * pixels_per_point).round().clamp(0.0, most as f32) as usize;
            let clip = Clip {
                left: edge(clip_rect.min.x, self.width),
                right: edge(clip_rect.max.x, self.width),
                top: edge(clip_rect.min.y, self.height),
                bottom: edge(clip_rect.max.y, self.height),
            };
            if clip.left < clip.right && clip.top < clip.bottom {
                self.draw_mesh(mesh, texture, clip, pixels_per_point);
            }
        }
    }

    fn draw_mesh(&mut self, mesh: &Mesh, texture: &Texture, clip: Clip, pixels_per_point: f32) {
        let corner = |index: &u32| {
            mesh.vertices.get(*index as usize).map(|v| Corner::new(v, texture, pixels_per_point))
        };
        for triangle in mesh.indices.as_chunks::<3>().0 {
            let [a, b, c] = triangle;
            if let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) {
                self.draw_triangle([a, b, c], texture, clip);
            }
        }
    }

    fn draw_triangle(&mut self, corners: [Corner; 3], texture: &Texture, clip: Clip) {
        let [a, b, c] = corners;
        let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if !(area.is_finite() && area != 0.0) {
            return;
        }
        let top = a.y.min(b.y).min(c.y);
        let bottom = a.y.max(b.y).max(c.y);
        // Rows and columns whose middle lies inside; of an edge that two triangles share, one of them draws.
        let first = |edge: f32| (edge - 0.5).ceil().max(0.0) as usize;
        let slopes = Slopes::new(&corners, area);
        let is_flat = slopes.x == [0.0; 6] && slopes.y == [0.0; 6];
        let flat = is_flat.then(|| texture.shade(a.values));
        for y in first(top).max(clip.top)..first(bottom).min(clip.bottom) {
            let middle = y as f32 + 0.5;
            let (mut left, mut right) = (f32::INFINITY, f32::NEG_INFINITY);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let (low, high) = if p.y <= q.y { (p, q) } else { (q, p) };
                if low.y <= middle && middle < high.y {
                    let x = low.x + (high.x - low.x) * ((middle - low.y) / (high.y - low.y));
                    left = left.min(x);
                    right = right.max(x);
                }
            }
            if left > right {
                continue;
            }
            let (start, end) = (first(left).max(clip.left), first(right).min(clip.right));
            if start >= end {
                continue;
            }
            let row = &mut self.pixels[y * self.width..][start..end];
            match flat {
                Some(colour) if colour[3] >= 255.0 => row.fill(opaque(colour)),
                Some(colour) => row.iter_mut().for_each(|pixel| *pixel = blend(*pixel, colour)),
                None => {
                    let mut values = slopes.at(&a, start as f32 + 0.5, middle);
                    for pixel in row {
                        *pixel = blend(*pixel, texture.shade(values));
                        for (value, step) in values.iter_mut().zip(slopes.x) {
                            *value += step;
                        }
                    }
                }
            }
        }
    }
}

/// Pixels that may be drawn to; right and bottom are the first beyond.
#[derive(Clone, Copy, Debug)]
struct Clip {
    left: usize,
    right: usize,
    top: usize,
    bottom: usize,
}

/// A corner of a triangle in pixels.
#[derive(Clone, Copy, Debug)]
struct Corner {
    x: f32,
    y: f32,
    /// Place in the texture in its pixels; red, green, blue, alpha from 0 to 255, the colours multiplied with alpha.
    values: [f32; 6],
}

impl Corner {
    fn new(vertex: &Vertex, texture: &Texture, pixels_per_point: f32) -> Self {
        let [r, g, b, a] = vertex.color.to_array().map(f32::from);
        let (u, v) = (vertex.uv.x * texture.width as f32, vertex.uv.y * texture.height as f32);
        Corner {
            x: vertex.pos.x * pixels_per_point,
            y: vertex.pos.y * pixels_per_point,
            values: [u, v, r, g, b, a],
        }
    }
}

/// How values change per pixel.
struct Slopes {
    x: [f32; 6],
    y: [f32; 6],
}

impl Slopes {
    fn new([a, b, c]: &[Corner; 3], area: f32) -> Self {
        let of = |i: usize| (b.values[i] - a.values[i], c.values[i] - a.values[i]);
        Slopes {
            x: std::array::from_fn(|i| (of(i).0 * (c.y - a.y) - of(i).1 * (b.y - a.y)) / area),
            y: std::array::from_fn(|i| (of(i).1 * (b.x - a.x) - of(i).0 * (c.x - a.x)) / area),
        }
    }

    fn at(&self, from: &Corner, x: f32, y: f32) -> [f32; 6] {
        std::array::from_fn(|i| from.values[i] + self.x[i] * (x - from.x) + self.y[i] * (y - from.y))
    }
}

fn opaque([r, g, b, _]: [f32; 4]) -> u32 {
    let byte = |value: f32| (value + 0.5).clamp(0.0, 255.0) as u32;
    byte(r) << 16 | byte(g) << 8 | byte(b)
}

/// A colour over another, in encoded values as egui expects.
fn blend(under: u32, [r, g, b, a]: [f32; 4]) -> u32 {
    if a <= 0.0 && r <= 0.0 && g <= 0.0 && b <= 0.0 {
        return under;
    }
    let through = 1.0 - a / 255.0;
    let below = |shift: u32| (under >> shift & 255) as f32 * through;
    opaque([r + below(16), g + below(8), b + below(0), 255.0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Color32, Pos2, Rect, TextureId};

    fn white() -> Textures {
        let mut textures = Textures::default();
        textures.put_white(TextureId::default());
        textures
    }

    fn drawn(width: usize, height: usize, meshes: Vec<Mesh>) -> Vec<u32> {
        let mut pixels = vec![0x00_10_20_30; width * height];
        let clip_rect = Rect::from_min_max(Pos2::ZERO, Pos2::new(width as f32, height as f32));
        let primitives: Vec<_> = meshes
            .into_iter()
            .map(|mesh| ClippedPrimitive { clip_rect, primitive: Primitive::Mesh(mesh) })
            .collect();
        Canvas { width, height, pixels: &mut pixels }.draw_meshes(&primitives, &white(), 1.0);
        pixels
    }

    fn rectangle(rect: Rect, colour: Color32) -> Mesh {
        let mut mesh = Mesh::default();
        mesh.add_colored_rect(rect, colour);
        mesh
    }

    #[test]
    fn a_rectangle_covers_its_pixels_once() {
        let rect = Rect::from_min_max(Pos2::new(1.0, 1.0), Pos2::new(3.0, 4.0));
        // Half transparent: a pixel of both triangles would be brighter.
        let pixels = drawn(4, 5, vec![rectangle(rect, Color32::from_rgba_premultiplied(100, 0, 0, 128))]);
        for y in 0..5 {
            for x in 0..4 {
                let inside = (1..3).contains(&x) && (1..4).contains(&y);
                let expected = if inside { 0x00_6c_10_18 } else { 0x00_10_20_30 };
                assert_eq!(pixels[y * 4 + x], expected, "{x},{y}");
            }
        }
    }

    #[test]
    fn what_lies_outside_is_cut_off_and_nonsense_is_left_out() {
        let all = Rect::from_min_max(Pos2::new(-50.0, -1e9), Pos2::new(1e6, 70.0));
        assert!(drawn(3, 3, vec![rectangle(all, Color32::WHITE)]).iter().all(|&pixel| pixel == 0x00ff_ffff));
        let mut nonsense = rectangle(all, Color32::WHITE);
        nonsense.vertices.iter_mut().for_each(|vertex| vertex.pos.x = f32::NAN);
        nonsense.indices.extend([0, 1, 99]);
        assert_eq!(drawn(3, 3, vec![nonsense])[0], 0x00_10_20_30);
    }

    #[test]
    fn colours_run_between_corners() {
        let mut mesh = rectangle(Rect::from_min_max(Pos2::ZERO, Pos2::new(4.0, 1.0)), Color32::BLACK);
        for vertex in &mut mesh.vertices {
            vertex.color = if vertex.pos.x > 0.0 { Color32::from_rgb(0, 0, 200) } else { Color32::BLACK };
        }
        assert_eq!(drawn(4, 1, vec![mesh]), [25, 75, 125, 175]);
    }

    #[test]
    fn images_are_enlarged_and_cut_off() {
        let image = Image { width: 2, height: 1, pixels: vec![1, 2] };
        let mut pixels = [0; 12];
        let mut canvas = Canvas { width: 4, height: 3, pixels: &mut pixels };
        canvas.draw_image(&image, Area { x: 1, y: 1, width: 4, height: 4 });
        assert_eq!(pixels, [0, 0, 0, 0, 0, 1, 1, 2, 0, 1, 1, 2]);
    }
}
