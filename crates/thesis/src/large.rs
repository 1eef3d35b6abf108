//! Scenes that are built in, from a handful of objects to a million, so that machines can be measured without files.

use crate::bush::{Draw, add, add_bush, along_z};
use crate::scenes::{ThesisScene, ground, look, origin, point_light, scene};
use scene::{
    Channel, DAffine3, DVec3, Group, Instance, JavaRandom, Light, LightKind, Material, Phong, Scene, Shape,
    Sky, TypeNameId,
};
use std::f64::consts::{PI, TAU};

/// A scene that is built in.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// What it is asked for by; bushes by their number of objects.
    pub name: &'static str,
    /// Whether it is so large that it is built only when it is asked for by name.
    pub is_huge: bool,
    build: fn() -> Scene,
}

impl BuiltIn {
    /// The scene of a name.
    pub fn named(name: &str) -> Option<Self> {
        BUILT_IN.into_iter().find(|built_in| built_in.name == name)
    }

    /// Builds it, the same every time.
    pub fn build(self) -> Scene {
        (self.build)()
    }
}

const fn built_in(name: &'static str, build: fn() -> Scene) -> BuiltIn {
    BuiltIn { name, is_huge: false, build }
}

/// All of them, from few objects to many.
pub const BUILT_IN: [BuiltIn; 9] = [
    built_in("cornell-box", || scene(ThesisScene::CornellBox)),
    built_in("bush-7", || scene(ThesisScene::Bush(1))),
    built_in("bush-25", || scene(ThesisScene::Bush(2))),
    built_in("bush-85", || scene(ThesisScene::Bush(3))),
    built_in("bush-271", || scene(ThesisScene::Bush(4))),
    built_in("bush-841", || scene(ThesisScene::Bush(5))),
    built_in("canopy", canopy),
    built_in("plantation", plantation),
    BuiltIn { name: "forest", is_huge: true, build: forest },
];

/// Number of leaves of the canopy.
const LEAVES: u32 = 100_000;
/// Its edge in metres, and the area of all leaves per area of ground.
const CANOPY_EDGE: f64 = 10.0;
const LEAF_AREA_INDEX: f64 = 3.0;
/// Bushes of the plantation: in a row, and rows. With 840 objects each and the ground they make 999,601 objects.
const PLANTATION: [u32; 2] = [35, 34];
/// The same for the forest: 1,008,100,801 objects.
const FOREST: [u32; 2] = [1096, 1095];
/// From bush to bush in metres.
const DISTANCE: f64 = 1.5;
/// Steps of growth of each bush.
const STEPS: i32 = 5;

fn empty() -> Scene {
    Scene { type_names: vec!["thesis".to_owned()], ..Scene::default() }
}

/// Square leaves in all positions and directions in a layer 2 m high, which let light through, under sun and sky.
fn canopy() -> Scene {
    let mut scene = empty();
    ground(&mut scene, [0.18, 0.14, 0.10]);
    let reflected = scene.add_channel(Channel::Constant([0.10, 0.50, 0.10]));
    let transmitted = scene.add_channel(Channel::Constant([0.05, 0.40, 0.05]));
    let leaf = scene.add_material(Material::Phong(Phong {
        diffuse: Some(reflected),
        diffuse_transparency: Some(transmitted),
        ..Phong::default()
    }));
    let edge = (LEAF_AREA_INDEX * CANOPY_EDGE * CANOPY_EDGE / f64::from(LEAVES)).sqrt();
    let shape = Shape::Parallelogram { length: edge, axis: DVec3::new(0.5 * edge, 0.0, 0.0), scale_v: false };
    let mut draw = Draw(JavaRandom::new(2024));
    for _ in 0..LEAVES {
        let half = 0.5 * CANOPY_EDGE;
        let centre = DVec3::new(draw.between(-half, half), draw.between(-half, half), draw.between(0.1, 2.1));
        // Uniformly distributed rotations: Euler angles about z, y and z, the middle one with a uniform cosine.
        let turn = DAffine3::from_rotation_z(draw.between(0.0, TAU))
            * DAffine3::from_rotation_y(draw.between(-1.0, 1.0).acos())
            * DAffine3::from_rotation_z(draw.between(0.0, TAU));
        add(
            &mut scene,
            shape.clone(),
            DAffine3::from_translation(centre) * turn * along_z(-0.5 * edge),
            leaf,
        );
    }
    add_sun(&mut scene);
    scene.sky = Some(Sky::uniform([0.30, 0.36, 0.45], origin()));
    look(&mut scene, [0.0, -9.5, 7.0], [0.0, 0.0, 0.9], 50.0);
    scene
}

fn add_sun(scene: &mut Scene) {
    scene.lights.push(Light {
        kind: LightKind::Directional { irradiance: [3.0, 2.9, 2.7] },
        // It shines along the local z axis: down, at 60 degrees above the horizon.
        world_from_light: DAffine3::from_rotation_z(0.6) * DAffine3::from_rotation_x(PI - 0.52),
        attenuation: Default::default(),
        shadowless: false,
        origin: origin(),
    });
}

/// One bush, placed so often that there are about a million objects.
fn plantation() -> Scene {
    let mut scene = bushes(PLANTATION);
    point_light(&mut scene, DVec3::new(-20.0, -25.0, 35.0), 190_000.0);
    look(&mut scene, [-8.0, -38.0, 14.0], [0.0, -6.0, 0.5], 50.0);
    scene
}

/// The same bush so often that there are about a thousand million objects, under the sun.
fn forest() -> Scene {
    let mut scene = bushes(FOREST);
    add_sun(&mut scene);
    let edge = -0.5 * DISTANCE * f64::from(FOREST[1]);
    look(&mut scene, [-8.0, edge - 12.0, 25.0], [0.0, edge + 60.0, 0.5], 50.0);
    scene
}

/// Bushes in rows, on the ground and under a sky.
fn bushes([columns, rows]: [u32; 2]) -> Scene {
    let mut scene = empty();
    add_bush(&mut scene, STEPS);
    let objects = std::mem::take(&mut scene.objects);
    let group = scene.add_group(Group { objects, ..Group::default() });
    ground(&mut scene, [0.33, 0.29, 0.22]);
    let mut draw = Draw(JavaRandom::new(99));
    scene.instances.reserve((columns * rows) as usize);
    for number in 0..columns * rows {
        let column = f64::from(number % columns) - 0.5 * f64::from(columns - 1);
        let row = f64::from(number / columns) - 0.5 * f64::from(rows - 1);
        let foot = DVec3::new(
            DISTANCE * column + draw.between(-0.25, 0.25),
            DISTANCE * row + draw.between(-0.25, 0.25),
            0.0,
        );
        let world_from_group = DAffine3::from_translation(foot)
            * DAffine3::from_rotation_z(draw.between(0.0, TAU))
            * DAffine3::from_scale(DVec3::splat(draw.between(0.85, 1.15)));
        let origin = scene::Origin { node: i64::from(number), type_name: TypeNameId(0) };
        scene.instances.push(Instance { group, world_from_group, origin });
    }
    scene.sky = Some(Sky::uniform([0.35, 0.42, 0.55], origin()));
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_of_objects_agree() {
        for (name, objects) in
            [("bush-7", 7), ("bush-841", 841), ("canopy", 100_001), ("plantation", 999_601)]
        {
            assert_eq!(BuiltIn::named(name).unwrap().build().drawn_objects(), objects, "{name}");
        }
        assert!(BuiltIn::named("bush").is_none());
    }

    #[test]
    fn the_forest_has_a_thousand_million_objects_and_is_not_built_unasked() {
        // Without building it: in each bush 840 of the 841 objects of the bush on the ground.
        assert_eq!(u64::from(FOREST[0] * FOREST[1]) * 840 + 1, 1_008_100_801);
        let huge: Vec<&str> = BUILT_IN.iter().filter(|scene| scene.is_huge).map(|scene| scene.name).collect();
        assert_eq!(huge, ["forest"]);
    }

    #[test]
    fn the_canopy_is_lit_from_above() {
        let sun = &canopy().lights[0];
        assert!(sun.world_from_light.transform_vector3(DVec3::Z).z < -0.8);
    }
}
