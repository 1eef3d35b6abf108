//! The scenes of the thesis's pictures.

use crate::bush::{add, add_bush, along_z, leaf_material};
use scene::{
    Camera, DAffine3, DMat3, DVec3, Emission, Light, LightKind, Material, MaterialId, Origin, Rgb, Scene,
    Shape, Sky, TypeNameId,
};
use std::f64::consts::FRAC_PI_2;

/// What the thesis shows or measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThesisScene {
    /// One cylinder, figure 5.1: how edges become smooth.
    Cylinder,
    /// Sphere and box in the light of a point, figure 5.2: hard shadows.
    PointShadow,
    /// The same under a parallelogram lamp, figures 5.3 and 5.4: soft shadows.
    AreaShadow,
    /// The shadow of one cut-out leaf, figure 5.5.
    LeafShadow,
    /// The Cornell box, figure 5.6.
    CornellBox,
    /// The bush after so many steps of growth, figures 5.9 to 5.11.
    Bush(i32),
}

/// Builds a scene.
pub fn scene(which: ThesisScene) -> Scene {
    let mut scene = Scene { type_names: vec!["thesis".to_owned()], ..Scene::default() };
    match which {
        ThesisScene::Cylinder => cylinder(&mut scene),
        ThesisScene::PointShadow => {
            shadow_table(&mut scene);
            point_light(&mut scene, DVec3::new(1.5, -1.0, 3.0), 300.0);
        }
        ThesisScene::AreaShadow => {
            shadow_table(&mut scene);
            let black = diffuse(&mut scene, [0.0; 3]);
            let lamp = rectangle(&mut scene, DVec3::new(1.5, -1.0, 3.0), (1.0, 1.0), black);
            scene.objects[lamp].emission =
                Some(Emission { power: [100.0; 3], exponent: 0.0, shadowless: false });
        }
        ThesisScene::LeafShadow => leaf_shadow(&mut scene),
        ThesisScene::CornellBox => cornell_box(&mut scene),
        ThesisScene::Bush(steps) => bush(&mut scene, steps),
    }
    scene
}

pub(crate) fn origin() -> Origin {
    Origin { node: 0, type_name: TypeNameId(0) }
}

fn diffuse(scene: &mut Scene, color: Rgb) -> MaterialId {
    scene.add_material(Material::Rgba { color, opacity: 1.0 })
}

pub(crate) fn point_light(scene: &mut Scene, position: DVec3, watts: f64) {
    scene.lights.push(Light {
        kind: LightKind::Point { power: [watts / 3.0; 3] },
        world_from_light: DAffine3::from_translation(position),
        attenuation: Default::default(),
        shadowless: false,
        origin: origin(),
    });
}

pub(crate) fn look(scene: &mut Scene, eye: [f64; 3], target: [f64; 3], degrees: f64) {
    let (eye, target) = (DVec3::from_array(eye), DVec3::from_array(target));
    scene.camera = Camera::look_at(eye, target, DVec3::Z, degrees.to_radians());
}

pub(crate) fn ground(scene: &mut Scene, color: Rgb) {
    let material = diffuse(scene, color);
    add(scene, Shape::Plane, DAffine3::IDENTITY, material);
}

/// A horizontal rectangle round `centre` whose front looks down.
fn rectangle(scene: &mut Scene, centre: DVec3, size: (f64, f64), material: MaterialId) -> usize {
    let shape =
        Shape::Parallelogram { length: size.1, axis: DVec3::new(0.5 * size.0, 0.0, 0.0), scale_v: false };
    // Local z runs along world y; the front of axis +x is local +y, which becomes world -z.
    let turn = DAffine3::from_rotation_x(-FRAC_PI_2);
    add(
        scene,
        shape,
        DAffine3::from_translation(centre - DVec3::new(0.0, 0.5 * size.1, 0.0)) * turn,
        material,
    )
}

fn cylinder(scene: &mut Scene) {
    let green = diffuse(scene, [0.2, 0.6, 0.25]);
    let shape =
        Shape::Cylinder { radius: 0.5, length: 2.0, base_open: false, top_open: false, scale_v: false };
    add(scene, shape, DAffine3::from_rotation_x(0.5) * along_z(-1.0), green);
    point_light(scene, DVec3::new(3.0, -4.0, 4.0), 900.0);
    look(scene, [0.0, -5.0, 1.0], [0.0, 0.0, 0.0], 40.0);
}

fn shadow_table(scene: &mut Scene) {
    ground(scene, [0.6, 0.6, 0.6]);
    let (red, blue) = (diffuse(scene, [0.7, 0.2, 0.15]), diffuse(scene, [0.2, 0.3, 0.7]));
    let ball = DAffine3::from_translation(DVec3::new(-0.6, 0.2, 0.5));
    add(scene, Shape::Sphere { radius: 0.5 }, ball, red);
    let turned = DAffine3::from_translation(DVec3::new(0.8, 0.4, 0.0)) * DAffine3::from_rotation_z(0.5);
    add(scene, Shape::Box { width: 0.7, height: 0.7, length: 1.0 }, turned, blue);
    look(scene, [0.0, -5.5, 3.0], [0.0, 0.0, 0.4], 40.0);
}

fn leaf_shadow(scene: &mut Scene) {
    ground(scene, [0.7, 0.7, 0.7]);
    let leaf = leaf_material(scene);
    let shape = Shape::Parallelogram { length: 1.0, axis: DVec3::new(0.3, 0.0, 0.0), scale_v: false };
    let held = DAffine3::from_translation(DVec3::new(0.0, 0.0, 0.5)) * DAffine3::from_rotation_x(-1.2);
    add(scene, shape, held, leaf);
    point_light(scene, DVec3::new(0.8, -0.3, 3.0), 300.0);
    look(scene, [0.0, -3.2, 2.4], [0.0, 0.3, 0.3], 40.0);
}

/// The box of the thesis: red and green walls, grey else, a lamp under the ceiling; 2 m wide.
fn cornell_box(scene: &mut Scene) {
    let (grey, red, green) = (
        diffuse(scene, [0.73, 0.71, 0.68]),
        diffuse(scene, [0.63, 0.06, 0.05]),
        diffuse(scene, [0.14, 0.45, 0.09]),
    );
    let black = diffuse(scene, [0.0; 3]);
    // A wall: middle, normal and the vector from the middle to the upper edge.
    let mut wall = |centre: [f64; 3], normal: [f64; 3], up: [f64; 3], material: MaterialId| {
        let [centre, normal, up] = [centre, normal, up].map(DVec3::from_array);
        let frame = DMat3::from_cols(normal.cross(up).normalize(), normal, up.normalize());
        let shape = Shape::Parallelogram { length: 2.0, axis: DVec3::X, scale_v: false };
        add(scene, shape, DAffine3::from_mat3_translation(frame, centre - up), material);
    };
    wall([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], grey);
    wall([0.0, 0.0, 2.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], grey);
    wall([0.0, 1.0, 1.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], grey);
    wall([-1.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], red);
    wall([1.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], green);
    let tall = DAffine3::from_translation(DVec3::new(-0.35, 0.3, 0.0)) * DAffine3::from_rotation_z(0.3);
    add(scene, Shape::Box { width: 0.6, height: 0.6, length: 1.2 }, tall, grey);
    let short = DAffine3::from_translation(DVec3::new(0.35, -0.3, 0.0)) * DAffine3::from_rotation_z(-0.3);
    add(scene, Shape::Box { width: 0.6, height: 0.6, length: 0.6 }, short, grey);
    let lamp = rectangle(scene, DVec3::new(0.0, 0.0, 1.99), (0.5, 0.4), black);
    scene.objects[lamp].emission =
        Some(Emission { power: [20.0, 17.0, 12.0], exponent: 0.0, shadowless: false });
    look(scene, [0.0, -4.6, 1.0], [0.0, 0.0, 1.0], 48.0);
}

fn bush(scene: &mut Scene, steps: i32) {
    ground(scene, [0.33, 0.29, 0.22]);
    add_bush(scene, steps);
    point_light(scene, DVec3::new(3.0, -3.0, 5.0), 3500.0);
    scene.sky = Some(Sky::uniform([0.35, 0.42, 0.55], origin()));
    look(scene, [0.0, -5.2, 2.5], [0.0, 0.0, 1.0], 42.0);
}
