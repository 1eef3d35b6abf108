//! Instances against copies: the same scene described in both ways gives the same picture.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::garden::garden;
use common::*;
use render::{Acceleration, compile, compile_with};
use scene::{
    DAffine3, DVec3, Emission, Group, GroupId, Instance, Light, LightKind, Mesh, Object, Origin, Scene,
    Shape, VisibleSides,
};

fn instance(group: GroupId, world_from_group: DAffine3, node: i64) -> Instance {
    Instance { group, world_from_group, origin: Origin { node, ..ORIGIN } }
}

/// Turned, stretched, mirrored and far from the origin.
fn places() -> [DAffine3; 4] {
    let far = DAffine3::from_translation(DVec3::new(40.0, -25.0, 3.0));
    [
        far,
        far * at(3.5, 1.0, 0.2) * DAffine3::from_rotation_z(2.0),
        far * at(-2.5, 3.0, 0.0) * DAffine3::from_scale(DVec3::new(0.8, -1.1, 1.3)),
        far * at(1.0, 5.0, -0.1) * DAffine3::from_rotation_x(0.4) * DAffine3::from_scale(DVec3::splat(0.5)),
    ]
}

/// The garden's objects at several places.
fn gardens(opaque: bool) -> Scene {
    let mut scene = garden();
    let (planes, objects): (Vec<_>, Vec<_>) =
        std::mem::take(&mut scene.objects).into_iter().partition(|object| object.shape == Shape::Plane);
    scene.objects = planes;
    let objects = objects.into_iter().map(|object| Object {
        material: if opaque { scene.objects[0].material } else { object.material },
        ..object
    });
    let group = scene.add_group(Group { objects: objects.collect(), ..Group::default() });
    scene.instances = (10..).zip(places()).map(|(node, place)| instance(group, place, node)).collect();
    scene.lights[0].world_from_light = places()[0] * scene.lights[0].world_from_light;
    scene.camera = scene::Camera::look_at(
        places()[0].transform_point3(DVec3::new(1.0, -9.0, 6.0)),
        places()[0].transform_point3(DVec3::new(0.5, 2.0, 0.4)),
        DVec3::Z,
        0.7,
    );
    scene
}

#[test]
fn opaque_instances_look_like_copies_in_every_pixel() {
    let scene = gardens(true);
    let settings = settings(80, 60, 4, 3);
    // Without a hierarchy every member is copied to its place.
    let (instances, copies) = (render(&scene, &settings), render_without_bvh(&scene, &settings));
    let mut different = 0;
    for y in 0..60 {
        for x in 0..80 {
            let (a, b) = (instances.radiance(x, y), copies.radiance(x, y));
            different += usize::from((0..3).any(|c| (a[c] - b[c]).abs() > 0.01 * (a[c] + b[c]) + 1e-5));
        }
    }
    // The same random numbers: only paths that pass an edge within rounding go elsewhere.
    assert!(different < 60, "{different} of 4800 pixels differ");
}

#[test]
fn translucent_instances_look_like_copies_on_the_average() {
    let scene = gardens(false);
    let settings = settings(40, 30, 256, 4);
    let (a, b) = (render(&scene, &settings), render_without_bvh(&scene, &settings));
    let ((mean_a, error_a), (mean_b, error_b)) = (mean_and_error(&a), mean_and_error(&b));
    for c in 0..3 {
        let tolerance = 4.0 * error_a[c].hypot(error_b[c]);
        assert!((mean_a[c] - mean_b[c]).abs() < tolerance, "{mean_a:?} {mean_b:?} {tolerance}");
    }
}

#[test]
fn the_gpu_draws_the_same_instances() {
    let Some(gpu) = gpu() else { return };
    let scene = gardens(false);
    let settings = settings(32, 24, 64, 3);
    let (a, b) = (render(&scene, &settings), render_on(&gpu, &scene, &settings));
    let ((mean_a, error_a), (mean_b, error_b)) = (mean_and_error(&a), mean_and_error(&b));
    for c in 0..3 {
        let tolerance = 4.0 * error_a[c].hypot(error_b[c]);
        assert!((mean_a[c] - mean_b[c]).abs() < tolerance, "{mean_a:?} {mean_b:?} {tolerance}");
    }
}

#[test]
fn members_are_stored_once_and_keep_their_origins() {
    let mut scene = gardens(false);
    let members = scene.groups[0].objects.len();
    scene.instances = (0..100)
        .map(|i| instance(GroupId(0), at(f64::from(i % 10) * 4.0, f64::from(i / 10) * 4.0, 0.0), i.into()))
        .collect();
    let compiled = compile(&scene).unwrap();
    assert_eq!(compiled.objects.len(), members + 100 + scene.objects.len());
    let mut nodes: Vec<_> = compiled.objects.iter().map(|object| object.surface.source as usize).collect();
    nodes.sort_unstable();
    nodes.dedup();
    // One number for every object and every instance.
    assert_eq!(nodes.len(), members + 100 + scene.objects.len());
    assert!(nodes.iter().all(|&source| source < compiled.origins.len()));
    let copied = compile_with(&scene, Acceleration::None).unwrap();
    assert_eq!(copied.objects.len(), members * 100 + scene.objects.len());
}

#[test]
fn instances_in_groups_stand_where_both_placements_put_them() {
    // A row of rows of spheres under a camera straight above; brightness counts the covered area.
    let mut b = Builder::new();
    let white = b.diffuse([1.0; 3]);
    let disc = Shape::Sphere { radius: 0.1 };
    let object = b.object(disc, DAffine3::IDENTITY, white).clone();
    b.scene.objects.clear();
    let at_x = |x: f64| Object { world_from_object: at(x, 0.0, 0.0), ..object.clone() };
    let pair = b.scene.add_group(Group { objects: vec![at_x(0.0), at_x(1.0)], ..Group::default() });
    let row = (0..3).map(|i| instance(pair, at(2.0 * f64::from(i), 0.0, 0.0), 1)).collect();
    let row = b.scene.add_group(Group { instances: row, ..Group::default() });
    b.scene.instances = (0..4).map(|i| instance(row, at(0.0, f64::from(i), 0.0), 1)).collect();
    b.look(DVec3::new(2.5, 1.5, 50.0), DVec3::new(2.5, 1.5, 0.0), DVec3::Y, 10.0);
    b.scene.camera.projection = PARALLEL(8.0);
    b.sky([1.0; 3]);
    // Seen from all sides a white convex body under a white sky is as bright as the sky; so hide the sky.
    b.scene.sky = None;
    b.light(
        LightKind::Directional { irradiance: [1.0; 3] },
        at(0.0, 0.0, 60.0) * DAffine3::from_rotation_x(3.0),
    );
    let film = render(&b.scene, &settings(160, 160, 4, 1));
    for j in 0..4 {
        for i in 0..6 {
            let (x, y) = ((f64::from(i) - 2.5) / 8.0 + 0.5, 0.5 - (f64::from(j) - 1.5) / 8.0);
            let lit = film.radiance((160.0 * x) as u32, (160.0 * y) as u32)[0];
            assert!(lit > 0.2, "sphere {i}, {j}: {lit}");
            let beside = film.radiance((160.0 * (x + 0.5 / 8.0)) as u32, (160.0 * y) as u32)[0];
            assert!(beside == 0.0, "beside sphere {i}, {j}: {beside}");
        }
    }
}

#[test]
fn lights_lamps_and_planes_of_groups_are_raised_to_the_scene() {
    let mut b = Builder::new();
    let grey = b.diffuse([0.5; 3]);
    b.rectangle(DVec3::new(0.0, 0.0, 2.0), (0.5, 0.5), false, grey).emission =
        Some(Emission { power: [10.0; 3], exponent: 0.0, shadowless: false });
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), grey);
    b.object(Shape::Sphere { radius: 0.3 }, at(0.0, 0.0, 0.5), grey);
    b.object(Shape::Sphere { radius: 0.1 }, at(0.4, 0.0, 0.2), grey);
    b.light(LightKind::Point { power: [5.0; 3] }, at(0.0, 1.0, 1.0));
    b.look(DVec3::new(0.0, -6.0, 4.0), DVec3::new(1.0, 0.0, 0.4), DVec3::Z, 60.0);
    let mut copies = b.scene.clone();
    let objects = copies.objects.clone();
    copies.objects.extend(
        objects.into_iter().filter(|object| object.shape != Shape::Plane).map(|object| Object {
            world_from_object: at(2.0, 0.0, 0.0) * object.world_from_object,
            ..object
        }),
    );
    let light = copies.lights[0].clone();
    copies.lights.push(Light { world_from_light: at(2.0, 0.0, 0.0) * light.world_from_light, ..light });

    let mut instances = b.scene;
    let (objects, lights) = (std::mem::take(&mut instances.objects), std::mem::take(&mut instances.lights));
    let group = instances.add_group(Group { objects, lights, instances: vec![] });
    instances.instances = vec![instance(group, at(0.0, 0.0, 0.0), 1), instance(group, at(2.0, 0.0, 0.0), 2)];
    assert_eq!(compile(&instances).unwrap().lights.len(), 4);
    let settings = settings(40, 30, 128, 3);
    let (mean_a, error_a) = mean_and_error(&render(&instances, &settings));
    let (mean_b, error_b) = mean_and_error(&render(&copies, &settings));
    for c in 0..3 {
        let tolerance = 4.0 * error_a[c].hypot(error_b[c]);
        assert!((mean_a[c] - mean_b[c]).abs() < tolerance, "{mean_a:?} {mean_b:?} {tolerance}");
    }
}

#[test]
fn a_repeated_mesh_is_stored_once_and_keeps_its_smooth_normals() {
    // A coarse bowl with normals, lit from the side.
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for j in 0..=8u32 {
        for i in 0..=8u32 {
            let [x, y] = [i, j].map(|k| k as f32 / 4.0 - 1.0);
            positions.push([x, y, 0.3 * (x * x + y * y)]);
            if i < 8 && j < 8 {
                let a = j * 9 + i;
                triangles.extend([[a, a + 1, a + 10], [a, a + 10, a + 9]]);
            }
        }
    }
    let normals = positions.iter().map(|[x, y, _]| [-0.6 * x, -0.6 * y, 1.0]).collect::<Vec<_>>();
    let mesh = Mesh {
        positions: positions.into(),
        triangles: triangles.into(),
        normals: normals.into(),
        ..Mesh::default()
    };
    let mut b = Builder::new();
    let white = b.diffuse([0.8; 3]);
    let mesh = b.scene.add_mesh(mesh);
    for (i, place) in places().into_iter().enumerate() {
        let shape = Shape::Mesh { mesh, visible_sides: VisibleSides::Both };
        b.object(shape, place, white).origin = Origin { node: i as i64, ..ORIGIN };
    }
    b.light(LightKind::Point { power: [400.0; 3] }, places()[0] * at(6.0, -6.0, 5.0));
    let centre = places()[0].translation + DVec3::new(0.5, 2.0, 0.0);
    b.look(centre + DVec3::new(0.0, -8.0, 7.0), centre, DVec3::Z, 55.0);
    let compiled = compile(&b.scene).unwrap();
    assert_eq!(compiled.objects.len(), 128 + 4);
    assert_eq!(compiled.triangles(), 4 * 128);
    let settings = settings(80, 60, 4, 2);
    let (a, b) = (render(&b.scene, &settings), render_without_bvh(&b.scene, &settings));
    let mut different = 0;
    for y in 0..60 {
        for x in 0..80 {
            let (a, b) = (a.radiance(x, y)[0], b.radiance(x, y)[0]);
            different += usize::from((a - b).abs() > 0.01 * (a + b) + 1e-5);
        }
    }
    assert!(different < 60, "{different} of 4800 pixels differ");
}

#[test]
fn a_group_that_contains_itself_is_an_error() {
    let mut b = Builder::new();
    let white = b.diffuse([1.0; 3]);
    b.object(Shape::Sphere { radius: 0.1 }, DAffine3::IDENTITY, white);
    let inner = instance(GroupId(0), at(1.0, 0.0, 0.0), 1);
    b.scene.add_group(Group { instances: vec![inner.clone()], ..Group::default() });
    b.scene.instances = vec![inner];
    let error = compile(&b.scene).unwrap_err().to_string();
    assert!(error.contains("contains itself"), "{error}");
}
