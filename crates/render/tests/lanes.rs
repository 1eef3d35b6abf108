//! Rays side by side in the lanes of vector units against one after another: the same pictures, bit for bit.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::garden::garden;
use common::{Builder, ORIGIN, at, go_on, grey, settings};
use kernels::records::kernel::FilmPixel;
use render::cpu::{Cpu, Lanes};
use render::{Batch, Device, RenderSettings, compile};
use scene::{DAffine3, DVec3, Group, Instance, LightKind, Scene, Shape};
use std::sync::Arc;

/// Few objects of one material, under a lamp and a sky: every lane searches on its own.
fn few_objects() -> Scene {
    let mut b = Builder::new();
    let grey = b.diffuse([0.6, 0.5, 0.4]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), grey);
    b.object(Shape::Sphere { radius: 0.7 }, at(0.3, 0.2, 0.8), grey);
    b.object(Shape::Box { width: 0.8, height: 0.9, length: 0.7 }, at(-1.0, -0.3, 0.0), grey);
    lights(&mut b);
    b.scene
}

/// Hundreds of leaves that let light pass, some in groups: rays take turns.
fn many_leaves() -> Scene {
    let mut b = Builder::new();
    let ground = b.diffuse([0.3, 0.3, 0.2]);
    let leaf = b.phong(|s| scene::Phong {
        diffuse: grey(s, 0.4),
        diffuse_transparency: grey(s, 0.3),
        ..scene::Phong::default()
    });
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    for i in 0..900 {
        let t = f64::from(i);
        let place = at((t * 0.71).sin() * 2.0, (t * 1.13).cos() * 2.0, 0.1 + (t * 0.37).fract() * 2.0)
            * DAffine3::from_rotation_z(t)
            * DAffine3::from_rotation_x(t * 0.37);
        b.object(Shape::Parallelogram { length: 0.15, axis: DVec3::X * 0.1, scale_v: false }, place, leaf);
    }
    lights(&mut b);
    b.scene
}

/// The same leaves as two instances of a group.
fn groups() -> Scene {
    let mut scene = many_leaves();
    let objects = scene.objects.split_off(1);
    let group = scene.add_group(Group { objects, ..Group::default() });
    scene.instances = [at(-1.5, 0.0, 0.0), at(1.5, 0.5, 0.1) * DAffine3::from_rotation_z(1.0)]
        .into_iter()
        .map(|world_from_group| Instance { group, world_from_group, origin: ORIGIN })
        .collect();
    scene
}

fn lights(b: &mut Builder) {
    b.light(LightKind::Point { power: [200.0, 190.0, 180.0] }, at(1.0, -3.0, 5.0));
    b.sky([0.4, 0.5, 0.6]);
    b.look(DVec3::new(0.5, -6.0, 3.0), DVec3::new(0.0, 0.0, 0.7), DVec3::Z, 45.0);
}

/// The bits of the film with so many lanes.
fn film(scene: &Scene, lanes: Lanes, settings: &RenderSettings) -> Vec<u32> {
    let cpu = Cpu::new(Some(2)).unwrap().with_lanes(lanes);
    let loaded = cpu.load(Arc::new(compile(scene).unwrap())).unwrap();
    let batch = Batch::whole(settings);
    let mut pixels: Vec<FilmPixel> =
        vec![bytemuck::Zeroable::zeroed(); (settings.width * settings.height) as usize];
    loaded.add_samples(settings, &batch, &mut pixels, &go_on).unwrap();
    bytemuck::cast_slice(&pixels).to_vec()
}

#[test]
fn pictures_are_the_same_with_any_number_of_lanes() {
    for (name, scene) in [
        ("few objects", few_objects()),
        ("leaves", many_leaves()),
        ("groups", groups()),
        ("garden", garden()),
    ] {
        // A width and a height that are no multiples of anything.
        let settings = settings(45, 31, 6, 6);
        let one = film(&scene, Lanes::One, &settings);
        assert!(one.iter().any(|bits| *bits != 0), "{name} is dark");
        // Processors without the vector unit follow fewer rays, and compare less.
        for lanes in [Lanes::Eight, Lanes::Sixteen] {
            let film = film(&scene, lanes, &settings);
            let differing = one.iter().zip(&film).position(|(a, b)| a != b);
            assert_eq!(differing, None, "first word of the film of {name} that differs with {lanes:?} lanes");
        }
    }
}
