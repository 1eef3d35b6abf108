//! What must not change a picture: threads, the hierarchy, the place and the size of the scene.

mod common;

use common::garden::garden;
use common::*;
use render::{DeviceChoice, Film, RenderSettings, open_device};
use scene::{DAffine3, DVec3, Image, LightKind, Phong, Scene, Shape};

const SETTINGS: RenderSettings = RenderSettings {
    width: 80,
    height: 60,
    samples: 8,
    depth: 4,
    grid: 3,
    seed: 5,
    ..RenderSettings::DEFAULT
};

fn bytes(film: &Film) -> &[u8] {
    bytemuck::cast_slice(&film.pixels)
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let scene = garden();
    let one = render_on(open_device(DeviceChoice::Cpu, Some(1)).unwrap().as_ref(), &scene, &SETTINGS);
    let five = render_on(open_device(DeviceChoice::Cpu, Some(5)).unwrap().as_ref(), &scene, &SETTINGS);
    assert!(bytes(&one) == bytes(&five));
    let other_seed = render(&scene, &RenderSettings { seed: 6, ..SETTINGS });
    assert!(bytes(&one) != bytes(&other_seed));
}

#[test]
fn the_hierarchy_finds_what_testing_every_object_finds() {
    let scene = garden();
    let fast = render(&scene, &SETTINGS);
    let plain = render_without_bvh(&scene, &SETTINGS);
    let different = fast.pixels.iter().zip(&plain.pixels).filter(|(a, b)| a.radiance != b.radiance).count();
    // Two objects at exactly the same distance may be found in another order.
    assert!(different * 500 <= fast.pixels.len(), "{different} pixels differ");
}

/// Share of pixels whose radiance, times `factor`, differs by more than one percent.
fn share_of_different_pixels(a: &Film, b: &Film, factor: f32) -> f64 {
    let different = a
        .radiances()
        .zip(b.radiances())
        .filter(|(a, b)| (0..3).any(|c| (a[c] - factor * b[c]).abs() > 0.01 * a[c].abs().max(1e-3)))
        .count();
    different as f64 / a.pixels.len() as f64
}

fn moved(scene: &Scene, motion: DAffine3, power: f64) -> Scene {
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        object.world_from_object = motion * object.world_from_object;
    }
    for light in &mut scene.lights {
        light.world_from_light = motion * light.world_from_light;
        if let LightKind::Point { power: p } = &mut light.kind {
            *p = p.map(|p| p * power);
        }
    }
    scene.camera.view_from_world *= motion.inverse();
    scene
}

#[test]
fn a_scene_far_from_the_origin_looks_the_same() {
    let scene = garden();
    let here = render(&scene, &SETTINGS);
    let there = render(
        &moved(&scene, DAffine3::from_translation(DVec3::new(5000.0, -3000.0, 1000.0)), 1.0),
        &SETTINGS,
    );
    assert!(share_of_different_pixels(&here, &there, 1.0) < 0.02);
}

#[test]
fn a_thousand_times_smaller_or_larger_scene_looks_the_same() {
    let scene = garden();
    let natural = render(&scene, &SETTINGS);
    let share_at = |scale: f64| {
        // Power grows with the area that it lights.
        let scaled = moved(&scene, DAffine3::from_scale(DVec3::splat(scale)), scale * scale);
        share_of_different_pixels(&natural, &render(&scaled, &SETTINGS), 1.0)
    };
    // Powers of two change no rounding: an absolute length anywhere in the kernels would show here.
    assert_eq!(share_at(1.0 / 1024.0), 0.0);
    assert_eq!(share_at(1024.0), 0.0);
    // Other factors round differently and so send a few paths elsewhere, as the least change of scale does.
    let least = share_at(1.000_000_1);
    for scale in [1e-3, 1e3] {
        let share = share_at(scale);
        assert!(share < 2.0 * least + 0.01, "scale {scale}: {share}, least {least}");
    }
}

#[test]
fn stacked_leaves_a_millimetre_apart_shade_each_other() {
    // A stack of opaque leaves 10 cm wide and a millimetre apart, a kilometre from the origin: light from above
    // reaches the topmost only.
    let mut b = Builder::new();
    let green = b.diffuse([0.5; 3]);
    for i in 0..5 {
        b.rectangle(DVec3::new(1000.0, 0.0, 0.001 * f64::from(i)), (0.1, 0.1), true, green);
    }
    let down = at(1000.0, 0.0, 5.0) * DAffine3::from_rotation_x(std::f64::consts::PI);
    b.light(LightKind::Directional { irradiance: [std::f64::consts::PI; 3] }, down);
    b.look(DVec3::new(1000.0, 0.0, 1.0), DVec3::new(1000.0, 0.0, 0.0), DVec3::Y, 1.0);
    assert_mean(&render(&b.scene, &settings(16, 16, 16, 1)), [0.5; 3], 5.0);
    b.look(DVec3::new(1000.0, 0.0, -1.0), DVec3::new(1000.0, 0.0, 0.0), DVec3::Y, 1.0);
    assert_mean(&render(&b.scene, &settings(16, 16, 16, 1)), [0.0; 3], 5.0);
}

#[test]
fn the_shadow_of_a_cut_out_leaf_is_the_shadow_of_its_outline() {
    // A square hole in a picture against four strips round it.
    let light = |b: &mut Builder| b.light(LightKind::Point { power: [100.0; 3] }, at(0.3, 0.2, 3.0));
    let view = |b: &mut Builder| b.look(DVec3::new(0.0, 0.0, 0.9), DVec3::ZERO, DVec3::Y, 100.0);

    let mut cut = Builder::new();
    let ground = cut.diffuse([0.5; 3]);
    cut.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    let pixels: Vec<[u8; 4]> = (0..16u32)
        .map(|i| [0, 0, 0, if (1..3).contains(&(i % 4)) && (1..3).contains(&(i / 4)) { 0 } else { 255 }])
        .collect();
    let image = cut.scene.add_image(Image {
        name: "hole".into(),
        width: 4,
        height: 4,
        pixels: pixels.into(),
        srgb: false,
    });
    let frame = cut.phong(|s| Phong {
        diffuse: Some(s.add_channel(scene::Channel::ImageMap {
            image,
            bilinear: false,
            coordinates: vec![],
        })),
        ..Phong::default()
    });
    cut.rectangle(DVec3::new(0.0, 0.0, 1.0), (1.0, 1.0), true, frame);
    light(&mut cut);
    view(&mut cut);

    let mut strips = Builder::new();
    let ground = strips.diffuse([0.5; 3]);
    let black = strips.diffuse([0.0; 3]);
    strips.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    for (x, y, w, h) in
        [(0.0, 0.375, 1.0, 0.25), (0.0, -0.375, 1.0, 0.25), (0.375, 0.0, 0.25, 0.5), (-0.375, 0.0, 0.25, 0.5)]
    {
        strips.rectangle(DVec3::new(x, y, 1.0), (w, h), true, black);
    }
    light(&mut strips);
    view(&mut strips);

    let settings = settings(64, 64, 9, 1);
    let (a, b) = (render(&cut.scene, &settings), render(&strips.scene, &settings));
    assert!(share_of_different_pixels(&a, &b, 1.0) < 0.005);
    let dark = a.radiances().filter(|p| p[0] == 0.0).count();
    assert!(dark > 200 && dark < 64 * 64 - 200, "{dark}");
}
