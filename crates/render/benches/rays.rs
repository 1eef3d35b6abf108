//! Rays per second on one thread of the processor: every shape, and the hierarchy with rays from the camera, scattered
//! rays and shadow rays.
//!
//! ```text
//! cargo bench --bench rays                  # everything
//! cargo bench --bench rays -- scattered     # a part of it
//! ```

#[path = "../tests/common/access.rs"]
mod access;

use access::Access;
use divan::Bencher;
use divan::counter::ItemsCount;
use kernels::hit::kernel::hit_surface;
use kernels::light::kernel::sample_light;
use kernels::light_tree::kernel::{choose_light, total_importance};
use kernels::mesh::kernel::facing_normal;
use kernels::path::kernel::SHADOW_END;
use kernels::records::kernel::{NONE, SceneAccess};
use kernels::shape::kernel::{NO_HIT, Ray, SurfacePoint, offset_origin};
use kernels::warp::kernel::{around_axis, cosine_hemisphere};
use render::cpu::{Cpu, RaySearch, ShadowRay};
use render::{Acceleration, CompiledScene, compile_with};
use scene::{
    DAffine3, DVec3, JavaRandom, Material, Mesh, Object, Origin, Projection, Scene, Shape, TypeNameId,
    VisibleSides,
};
use std::sync::Arc;
use thesis::BuiltIn;
use wgsl_rs::std::{Vec3f, vec2f, vec3f};

fn main() {
    divan::main();
}

/// Scenes for the hierarchy: few objects, a plant, many small objects, many instances of a plant.
const SCENES: [&str; 4] = ["cornell-box", "bush-841", "canopy", "plantation"];
/// Width and height of the picture whose rays are traced.
const EDGE: u32 = 128;
/// Objects of one kind, and rays against each of them.
const OBJECTS: usize = 64;
const RAYS: usize = 1024;

/// Rays against one object after another without a hierarchy; an item is one test.
#[divan::bench(args = ["sphere", "box", "cylinder", "parallelogram", "triangle"])]
fn shape(bencher: Bencher, kind: &str) {
    let mut random = JavaRandom::new(1);
    let (scene, search) = prepared(&shapes(kind, &mut random), Acceleration::None);
    let rays: Vec<Ray> = (0..RAYS)
        .map(|_| {
            let from = on_sphere(&mut random) * 3.0;
            let to = on_sphere(&mut random) * 0.8;
            Ray { origin: from, direction: wgsl_rs::std::normalize(to - from) }
        })
        .collect();
    let tests = scene.objects.len() * rays.len();
    bencher.counter(ItemsCount::new(tests)).bench(|| search.first_hits(divan::black_box(&rays)));
}

/// Neighbouring rays from the camera.
#[divan::bench(args = SCENES)]
fn camera(bencher: Bencher, name: &str) {
    let (_, search, rays) = camera_rays(name);
    bencher.counter(ItemsCount::new(rays.len())).bench(|| search.first_hits(divan::black_box(&rays)));
}

/// Rays in random directions from where those from the camera end.
#[divan::bench(args = SCENES)]
fn scattered(bencher: Bencher, name: &str) {
    let (scene, search, first) = camera_rays(name);
    let mut random = JavaRandom::new(2);
    let rays: Vec<Ray> = surfaces(&scene, &search, &first)
        .into_iter()
        .map(|(point, normal)| {
            let u = vec2f(random.next_float(), random.next_float());
            let direction = around_axis(normal, cosine_hemisphere(u));
            Ray { origin: offset_origin(point, direction), direction }
        })
        .collect();
    bencher.counter(ItemsCount::new(rays.len())).bench(|| search.first_hits(divan::black_box(&rays)));
}

/// Rays from where those from the camera end to lights that are chosen as in pictures.
#[divan::bench(args = SCENES)]
fn shadow(bencher: Bencher, name: &str) {
    let (scene, search, first) = camera_rays(name);
    let mut random = JavaRandom::new(3);
    let access = Access(&scene);
    let rays: Vec<ShadowRay> = surfaces(&scene, &search, &first)
        .into_iter()
        .filter_map(|(point, normal)| {
            let total = total_importance(access, point.position);
            let choice = choose_light(access, point.position, total, random.next_float());
            if choice.index == NONE {
                return None;
            }
            let light = Access::light(access, choice.index);
            let u = vec2f(random.next_float(), random.next_float());
            let sample = sample_light(access, light, point.position, normal, false, u);
            let t_max = if sample.distance < NO_HIT { sample.distance * SHADOW_END } else { NO_HIT };
            let origin = offset_origin(point, sample.direction);
            Some(ShadowRay { ray: Ray { origin, direction: sample.direction }, t_max })
        })
        .collect();
    bencher.counter(ItemsCount::new(rays.len())).bench(|| search.transmittances(divan::black_box(&rays)));
}

/// Objects of one kind about the origin, within the unit sphere, turned in all directions.
fn shapes(kind: &str, random: &mut JavaRandom) -> Scene {
    let mut scene = Scene { type_names: vec!["bench".to_owned()], ..Scene::default() };
    let material = scene.add_material(Material::Rgba { color: [0.5; 3], opacity: 1.0 });
    let mesh = scene.add_mesh(Mesh {
        positions: [[-0.7, -0.7, 0.0], [0.9, -0.4, 0.0], [-0.4, 0.9, 0.0]].into(),
        triangles: [[0, 1, 2]].into(),
        ..Mesh::default()
    });
    let (shape, middle) = match kind {
        "sphere" => (Shape::Sphere { radius: 0.7 }, 0.0),
        "box" => (Shape::Box { width: 1.0, height: 1.0, length: 1.0 }, 0.5),
        "cylinder" => {
            let (base_open, top_open, scale_v) = (false, false, false);
            (Shape::Cylinder { radius: 0.5, length: 1.2, base_open, top_open, scale_v }, 0.6)
        }
        "parallelogram" => {
            (Shape::Parallelogram { length: 1.2, axis: DVec3::new(0.6, 0.0, 0.0), scale_v: false }, 0.6)
        }
        "triangle" => (Shape::Mesh { mesh, visible_sides: VisibleSides::Both }, 0.0),
        other => panic!("no shape {other}"),
    };
    for node in 0..OBJECTS {
        let mut angle = || std::f64::consts::TAU * f64::from(random.next_float());
        let turned = DAffine3::from_rotation_z(angle()) * DAffine3::from_rotation_x(angle());
        scene.objects.push(Object {
            shape: shape.clone(),
            world_from_object: turned * DAffine3::from_translation(DVec3::new(0.0, 0.0, -middle)),
            material,
            emission: None,
            interior: None,
            origin: Origin { node: node as i64, type_name: TypeNameId(0) },
        });
    }
    scene
}

fn on_sphere(random: &mut JavaRandom) -> Vec3f {
    kernels::warp::kernel::polar_direction(2.0 * random.next_float() - 1.0, random.next_float())
}

/// A scene as the device takes it, and ready to be asked.
fn prepared(scene: &Scene, acceleration: Acceleration) -> (Arc<CompiledScene>, RaySearch) {
    let compiled = Arc::new(compile_with(scene, acceleration).expect("it can be compiled"));
    let cpu = Cpu::new(Some(1)).expect("a thread can be started");
    let search = RaySearch::new(&cpu, Arc::clone(&compiled));
    (compiled, search)
}

/// A scene with one ray through the middle of every pixel of a small square picture, row by row.
fn camera_rays(name: &str) -> (Arc<CompiledScene>, RaySearch, Vec<Ray>) {
    let scene = BuiltIn::named(name).expect("it is built in").build();
    let (compiled, search) = prepared(&scene, Acceleration::Bvh);
    let world_from_view = scene.camera.view_from_world.inverse();
    let Projection::Perspective { fov_x, .. } = scene.camera.projection else {
        panic!("built-in scenes are seen in perspective");
    };
    let to_local = |v: DVec3| vec3f(v.x as f32, v.y as f32, v.z as f32);
    let origin = to_local(world_from_view.translation - compiled.origin);
    let scale = (0.5 * fov_x).tan();
    let place = |pixel: u32| (2.0 * (f64::from(pixel) + 0.5) / f64::from(EDGE) - 1.0) * scale;
    let rays = (0..EDGE * EDGE).map(|pixel| {
        let towards = DVec3::new(place(pixel % EDGE), -place(pixel / EDGE), -1.0).normalize();
        Ray { origin, direction: to_local(world_from_view.transform_vector3(towards)) }
    });
    let rays = rays.collect();
    (compiled, search, rays)
}

/// The surfaces where rays end, with the normals towards where they come from.
fn surfaces(scene: &CompiledScene, search: &RaySearch, rays: &[Ray]) -> Vec<(SurfacePoint, Vec3f)> {
    let hits = search.first_hits(rays);
    let met = rays.iter().zip(hits).filter(|(_, hit)| hit.object != NONE);
    met.map(|(ray, hit)| {
        let point = hit_surface(Access(scene), *ray, hit);
        (point, facing_normal(point, -ray.direction))
    })
    .collect()
}
