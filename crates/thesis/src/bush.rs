//! The bush of the thesis: at every step of growth each tip gets three branches with a leaf.

use scene::{
    Channel, DAffine3, DVec3, Image, JavaRandom, Material, MaterialId, Object, Origin, Phong, Scene, Shape,
    TypeNameId,
};
use std::f64::consts::TAU;

/// Length and radius of the first branches in metres, and what every step makes of them.
const FIRST_LENGTH: f64 = 0.62;
const FIRST_RADIUS: f64 = 0.028;
const LENGTH_FACTOR: f64 = 0.74;
const RADIUS_FACTOR: f64 = 0.62;
/// Thinner than this no branch becomes.
const LEAST_RADIUS: f64 = 0.0012;
/// Length of the first leaves; every step makes them shorter.
const LEAF_LENGTH: f64 = 0.30;
const LEAF_FACTOR: f64 = 0.88;
/// Edge of the picture on the leaves in pixels.
const LEAF_PIXELS: u32 = 256;

/// Numbers that the growth draws.
pub(crate) struct Draw(pub(crate) JavaRandom);

impl Draw {
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.0.next_float())
    }
}

/// A branch: its frame, step and length.
struct Branch {
    frame: DAffine3,
    step: i32,
    length: f64,
}

/// Adds a bush after `steps` steps of growth: 6, 24, 84, 270, 840 objects for 1 to 5, to which the thesis counts the
/// ground. From the third step on some older branches have a second leaf, which makes its counts.
pub(crate) fn add_bush(scene: &mut Scene, steps: i32) {
    let bark = scene.add_material(Material::Rgba { color: [0.28, 0.19, 0.12], opacity: 1.0 });
    let leaf = leaf_material(scene);
    let mut draw = Draw(JavaRandom::new(2008));
    let mut tips = vec![DAffine3::IDENTITY];
    let mut branches: Vec<Branch> = Vec::new();
    for step in 1..=steps {
        let length = FIRST_LENGTH * LENGTH_FACTOR.powi(step - 1);
        let radius = (FIRST_RADIUS * RADIUS_FACTOR.powi(step - 1)).max(LEAST_RADIUS);
        let mut next = Vec::with_capacity(tips.len() * 3);
        for tip in tips {
            let start = draw.between(0.0, TAU);
            for third in 0..3 {
                let turn = start + TAU * f64::from(third) / 3.0 + draw.between(-0.3, 0.3);
                let bend = draw.between(0.31, 0.84);
                let frame = tip * DAffine3::from_rotation_z(turn) * DAffine3::from_rotation_x(bend);
                let shape =
                    Shape::Cylinder { radius, length, base_open: false, top_open: false, scale_v: false };
                add(scene, shape, frame, bark);
                add_leaf(scene, leaf, &mut draw, frame, step, length);
                next.push(frame * along_z(length));
                branches.push(Branch { frame, step, length });
            }
        }
        tips = next;
    }
    for _ in 0..second_leaves(steps) {
        // Lossless: there are fewer branches than fit into the integers of a float.
        let place = draw.between(0.0, branches.len() as f64) as usize;
        let Branch { frame, step, length } = branches[place.min(branches.len() - 1)];
        let height = length * draw.between(0.2, 0.9);
        add_leaf(scene, leaf, &mut draw, frame, step, height);
    }
}

/// How many leaves more than branches the thesis counts.
fn second_leaves(steps: i32) -> usize {
    match u32::try_from(steps - 2) {
        Ok(grown @ 1..) => 6 * (3usize.pow(grown) - 2usize.pow(grown)),
        _ => 0,
    }
}

fn add_leaf(
    scene: &mut Scene,
    material: MaterialId,
    draw: &mut Draw,
    branch: DAffine3,
    step: i32,
    height: f64,
) {
    let length = (LEAF_LENGTH * LEAF_FACTOR.powi(step)).max(0.035);
    let frame = branch
        * along_z(height)
        * DAffine3::from_rotation_z(draw.between(0.0, TAU))
        * DAffine3::from_rotation_x(draw.between(0.61, 1.31));
    let axis = DVec3::new(0.3 * length, 0.0, 0.0);
    add(scene, Shape::Parallelogram { length, axis, scale_v: false }, frame, material);
}

pub(crate) fn along_z(distance: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(0.0, 0.0, distance))
}

/// Adds an object; its node is its number.
pub(crate) fn add(
    scene: &mut Scene,
    shape: Shape,
    world_from_object: DAffine3,
    material: MaterialId,
) -> usize {
    let number = scene.objects.len();
    let node = i64::try_from(number).unwrap_or(i64::MAX);
    let origin = Origin { node, type_name: TypeNameId(0) };
    scene.objects.push(Object { shape, world_from_object, material, emission: None, interior: None, origin });
    number
}

/// A green leaf that is cut out by the alpha of its picture.
pub(crate) fn leaf_material(scene: &mut Scene) -> MaterialId {
    let image = scene.add_image(leaf_image());
    let diffuse = scene.add_channel(Channel::ImageMap { image, bilinear: false, coordinates: Vec::new() });
    scene.add_material(Material::Phong(Phong {
        diffuse: Some(diffuse),
        interpolated_transparency: true,
        ..Phong::default()
    }))
}

/// The outline of a leaf with its veins; the stem is below.
fn leaf_image() -> Image {
    let size = LEAF_PIXELS;
    let pixels = (0..size * size).map(|i| {
        let part = |k: u32| (f64::from(k) + 0.5) / f64::from(size);
        let (u, v) = (2.0 * part(i % size) - 1.0, 1.0 - part(i / size));
        let half = 0.95 * (std::f64::consts::PI * v.powf(0.75)).sin().max(0.0).powf(0.8) * (1.0 - 0.35 * v);
        let inside = u.abs() < half || (u.abs() < 0.04 && v < 0.12);
        let ribs = ((v - 0.55 * u.abs()) * 7.0).rem_euclid(1.0);
        let vein = u.abs() < 0.03 || (ribs - 0.5).abs() > 0.45;
        let [r, g, b] = if vein { [82, 120, 36] } else { [23, 82, 14] };
        [r, g, b, if inside { 255 } else { 0 }]
    });
    Image { name: "leaf".into(), width: size, height: size, pixels: pixels.collect(), srgb: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_makes_the_counts_of_the_thesis() {
        for (steps, objects) in [(1, 7), (2, 25), (3, 85), (4, 271), (5, 841)] {
            let mut scene = Scene::default();
            add_bush(&mut scene, steps);
            // The thesis counts the ground, too.
            assert_eq!(scene.objects.len() + 1, objects);
        }
    }
}
