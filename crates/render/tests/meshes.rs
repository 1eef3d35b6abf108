//! Triangle meshes against shapes and values that are known.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::*;
use scene::{
    Channel, DAffine3, DVec3, Image, LightKind, MaterialId, Mesh, Phong, Scene, Shape, VisibleSides,
};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

const WHITE: [f64; 3] = [1.0; 3];

fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
    Mesh { positions: positions.into(), triangles: triangles.into(), ..Mesh::default() }
}

fn place(b: &mut Builder, mesh: Mesh, visible_sides: VisibleSides, place: DAffine3, material: MaterialId) {
    let mesh = b.scene.add_mesh(mesh);
    b.object(Shape::Mesh { mesh, visible_sides }, place, material);
}

/// The cube [-1, 1]², z in [0, 2], all triangles counter-clockwise from outside.
fn cube() -> Mesh {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        [sign(0), sign(1), sign(2) + 1.0]
    };
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<_> = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh(&[0, 1, 2, 3, 4, 5, 6, 7].map(corner), &triangles)
}

/// A unit sphere with smooth normals.
fn globe(around: u32, along: u32) -> Mesh {
    let mut positions = Vec::new();
    let mut uvs = Vec::new();
    for j in 0..=along {
        for i in 0..=around {
            let (u, v) = (f64::from(i) / f64::from(around), f64::from(j) / f64::from(along));
            let (azimuth, polar) = (u * TAU, v * PI);
            let p = [azimuth.cos() * polar.sin(), azimuth.sin() * polar.sin(), -polar.cos()];
            positions.push(p.map(|x| x as f32));
            uvs.push([u as f32, v as f32]);
        }
    }
    let mut triangles = Vec::new();
    for j in 0..along {
        for i in 0..around {
            let [a, b] = [j * (around + 1) + i, (j + 1) * (around + 1) + i];
            triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
        }
    }
    Mesh { normals: positions.clone().into(), uvs: uvs.into(), ..mesh(&positions, &triangles) }
}

/// The square [-1, 1]², z = 0, front up, with texture coordinates from 0 to 1.
fn square() -> Mesh {
    let positions = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let uvs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    Mesh { uvs: uvs.into(), ..mesh(&positions, &[[0, 1, 2], [0, 2, 3]]) }
}

fn checkered(b: &mut Builder) -> MaterialId {
    let pixels = (0..64u32).map(|i| [(i * 37 % 256) as u8, (i * 91 % 256) as u8, 90, 255]);
    let pixels = pixels.collect::<Vec<_>>().into();
    let image = b.scene.add_image(Image { name: "checks".into(), width: 8, height: 8, pixels, srgb: false });
    b.phong(|s| Phong {
        diffuse: Some(s.add_channel(Channel::ImageMap { image, bilinear: false, coordinates: vec![] })),
        ..Phong::default()
    })
}

fn assert_equal_means(a: &Scene, b: &Scene) {
    let settings = settings(60, 45, 64, 4);
    let (mean_a, error_a) = mean_and_error(&render(a, &settings));
    let (mean_b, error_b) = mean_and_error(&render(b, &settings));
    for c in 0..3 {
        let error = error_a[c].hypot(error_b[c]);
        assert!((mean_a[c] - mean_b[c]).abs() < 5.0 * error, "{mean_a:?} {mean_b:?} {error}");
    }
}

#[test]
fn a_cube_of_triangles_looks_like_a_box() {
    let scene = |as_mesh: bool, mirrored: bool| {
        let mut b = Builder::new();
        let ground = b.diffuse([0.5, 0.4, 0.3]);
        let red = b.diffuse([0.8, 0.2, 0.1]);
        b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
        let mut world = at(0.2, 0.1, 0.3) * DAffine3::from_rotation_z(0.4) * DAffine3::from_rotation_x(0.2);
        if mirrored {
            world *= DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        }
        if as_mesh {
            place(&mut b, cube(), VisibleSides::Front, world, red);
        } else {
            b.object(Shape::Box { width: 2.0, height: 2.0, length: 2.0 }, world, red);
        }
        b.light(LightKind::Point { power: [500.0; 3] }, at(3.0, -4.0, 6.0));
        b.sky([0.3, 0.4, 0.5]);
        b.look(DVec3::new(2.0, -7.0, 4.0), DVec3::new(0.0, 0.0, 0.8), DVec3::Z, 40.0);
        b.scene
    };
    assert_equal_means(&scene(true, false), &scene(false, false));
    assert_equal_means(&scene(true, true), &scene(false, true));
}

#[test]
fn smooth_normals_lose_little_and_gain_nothing() {
    for (around, least) in [(12, 0.93), (48, 0.98)] {
        let mut b = Builder::new();
        let white = b.diffuse(WHITE);
        place(&mut b, globe(around, around / 2), VisibleSides::Both, DAffine3::IDENTITY, white);
        b.sky(WHITE);
        b.look(DVec3::new(0.0, -4.0, 1.0), DVec3::ZERO, DVec3::Z, 25.0);
        let (mean, error) = mean_and_error(&render(&b.scene, &settings(48, 48, 64, 40)));
        assert!(mean[0] < 1.0 + 5.0 * error[0] && mean[0] > least, "{around}: {mean:?} {error:?}");
    }
}

#[test]
fn the_shading_normal_decides_the_brightness() {
    let mut b = Builder::new();
    let white = b.diffuse(WHITE);
    // The length of normals does not matter.
    let tilted = [[0.0, 2.0, 2.0]; 4];
    place(&mut b, Mesh { normals: tilted.into(), ..square() }, VisibleSides::Both, DAffine3::IDENTITY, white);
    let down = DAffine3::from_rotation_x(PI);
    b.light(LightKind::Directional { irradiance: [6.0; 3] }, down);
    probe_down(&mut b, 0.3, 0.1, 3.0);
    assert_mean(&render(&b.scene, &settings(8, 8, 4, 2)), [6.0 * FRAC_PI_4.cos() / PI; 3], 5.0);
}

#[test]
fn no_light_leaks_out_of_a_smooth_body() {
    let mut b = Builder::new();
    let leaf = b.phong(|s| Phong {
        diffuse: grey(s, 0.5),
        specular: grey(s, 0.4),
        shininess: grey(s, 0.3),
        ..Phong::default()
    });
    place(&mut b, globe(10, 6), VisibleSides::Both, DAffine3::IDENTITY, leaf);
    b.light(LightKind::Point { power: [1000.0; 3] }, at(0.0, 0.0, 0.3));
    b.look(DVec3::new(0.0, -4.0, 1.0), DVec3::ZERO, DVec3::Z, 35.0);
    let (mean, _) = mean_and_error(&render(&b.scene, &settings(48, 48, 32, 6)));
    // Inside, the radiance is above 10.
    assert_eq!(mean[0], 0.0);
}

#[test]
fn texture_coordinates_are_interpolated() {
    let scene = |as_mesh: bool| {
        let mut b = Builder::new();
        let checks = checkered(&mut b);
        if as_mesh {
            place(&mut b, square(), VisibleSides::Both, DAffine3::IDENTITY, checks);
        } else {
            // Local z becomes world y.
            let turn = DAffine3::from_rotation_x(-PI / 2.0);
            let shape = Shape::Parallelogram { length: 2.0, axis: DVec3::X, scale_v: false };
            b.object(shape, at(0.0, -1.0, 0.0) * turn, checks);
        }
        b.sky(WHITE);
        b.look(DVec3::new(0.4, -1.0, 3.0), DVec3::ZERO, DVec3::Y, 40.0);
        b.scene
    };
    let settings = settings(64, 64, 1, 2);
    let (mesh, plain) = (render(&scene(true), &settings), render(&scene(false), &settings));
    let differs = |(a, b): &(&_, &_)| {
        let (a, b): (&kernels::records::kernel::FilmPixel, &kernels::records::kernel::FilmPixel) = (*a, *b);
        (a.radiance.x - b.radiance.x).abs() > 1e-4 || (a.radiance.y - b.radiance.y).abs() > 1e-4
    };
    // The same random numbers give the same pixels, but for those on the edge of a texel.
    let different = mesh.pixels.iter().zip(&plain.pixels).filter(differs).count();
    assert!(different * 100 < mesh.pixels.len(), "{different} pixels differ");
    let ((mean, _), (plain_mean, _)) = (mean_and_error(&mesh), mean_and_error(&plain));
    assert!(mean[0] > 0.1 && (mean[0] - plain_mean[0]).abs() < 1e-3, "{mean:?} {plain_mean:?}");
}

/// How much of a black square is seen from above or from below before a white sky: 0 to 1.
fn seen(visible_sides: VisibleSides, from_above: bool, twice: bool) -> f64 {
    let mut b = Builder::new();
    let black = b.diffuse([0.0; 3]);
    let mut mesh = square();
    if twice {
        mesh.triangles = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b, c], [a, c, b]]).collect();
    }
    place(&mut b, mesh, visible_sides, DAffine3::IDENTITY, black);
    b.sky(WHITE);
    let height = if from_above { 3.0 } else { -3.0 };
    b.look(DVec3::new(0.1, 0.2, height), DVec3::new(0.1, 0.2, 0.0), DVec3::Y, 1.0);
    1.0 - mean_and_error(&render(&b.scene, &settings(8, 8, 4, 2))).0[0]
}

#[test]
fn hidden_sides_are_passed_by_camera_rays() {
    use VisibleSides::{Back, Both, Front};
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-5, "{a} is not {b}");
    for (sides, above, below) in [(Front, 1.0, 0.0), (Back, 0.0, 1.0), (Both, 1.0, 1.0)] {
        close(seen(sides, true, false), above);
        close(seen(sides, false, false), below);
        // Listed once per orientation, a mesh has two sides however many of them show.
        close(seen(sides, true, true), 1.0);
        close(seen(sides, false, true), 1.0);
    }
}

#[test]
fn hidden_sides_throw_no_shadow() {
    let ground_under = |visible_sides: VisibleSides| {
        let mut b = Builder::new();
        let white = b.diffuse(WHITE);
        b.object(Shape::Plane, at(0.0, 0.0, 0.0), white);
        let black = b.diffuse([0.0; 3]);
        place(&mut b, square(), visible_sides, at(0.0, 0.0, 1.0), black);
        b.light(LightKind::Directional { irradiance: [PI; 3] }, DAffine3::from_rotation_x(PI));
        b.look(DVec3::new(0.0, -3.0, 0.5), DVec3::ZERO, DVec3::Z, 1.0);
        mean_and_error(&render(&b.scene, &settings(8, 8, 4, 1))).0[0]
    };
    // Shadow rays start at the ground and so meet the back.
    assert!((ground_under(VisibleSides::Front) - 1.0).abs() < 1e-4);
    assert_eq!(ground_under(VisibleSides::Back), 0.0);
    assert_eq!(ground_under(VisibleSides::Both), 0.0);
}

#[test]
fn the_triangles_of_a_veil_let_light_pass_independently() {
    let mut b = Builder::new();
    let veil = b.scene.add_material(scene::Material::Rgba { color: [0.0; 3], opacity: 0.5 });
    place(&mut b, cube(), VisibleSides::Both, at(0.0, 0.0, 0.0), veil);
    b.sky(WHITE);
    b.look(DVec3::new(0.3, -4.0, 1.1), DVec3::new(0.3, 0.0, 1.1), DVec3::Z, 5.0);
    assert_mean(&render(&b.scene, &settings(32, 32, 64, 4)), [0.25; 3], 5.0);
}

#[test]
fn both_devices_agree_about_meshes() {
    let Some(gpu) = gpu() else { return };
    let mut b = Builder::new();
    let ground = b.diffuse([0.5, 0.4, 0.3]);
    let checks = checkered(&mut b);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    place(&mut b, globe(16, 8), VisibleSides::Both, at(-1.1, 0.0, 1.0), checks);
    place(&mut b, cube(), VisibleSides::Front, at(1.4, 0.0, 0.1), ground);
    place(&mut b, square(), VisibleSides::Back, at(0.0, 0.0, 2.5), checks);
    b.light(LightKind::Point { power: [300.0; 3] }, at(2.0, -3.0, 4.0));
    b.sky([0.2, 0.3, 0.4]);
    b.look(DVec3::new(0.0, -6.0, 3.0), DVec3::new(0.0, 0.0, 0.8), DVec3::Z, 45.0);
    let settings = settings(96, 64, 16, 4);
    let (cpu, gpu) = (render(&b.scene, &settings), render_on(&gpu, &b.scene, &settings));
    let far = |a: f32, b: f32| (a - b).abs() > 1e-3 * (a.abs() + 1e-3);
    let pairs = cpu.pixels.iter().zip(&gpu.pixels);
    let different = pairs.filter(|(a, b)| far(a.radiance.x, b.radiance.x)).count();
    assert!(different * 10 < cpu.pixels.len(), "{different} of {} pixels differ", cpu.pixels.len());
    let ((mean_cpu, error_cpu), (mean_gpu, error_gpu)) = (mean_and_error(&cpu), mean_and_error(&gpu));
    for c in 0..3 {
        let error = error_cpu[c].hypot(error_gpu[c]);
        assert!((mean_cpu[c] - mean_gpu[c]).abs() < 5.0 * error, "{mean_cpu:?} {mean_gpu:?}");
    }
}
