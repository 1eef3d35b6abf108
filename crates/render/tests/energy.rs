//! Light that is emitted is absorbed or escapes, watt for watt.
//!
//! What lamps emit is their definition; what surfaces absorb is the radiance that arrives, by the path tracer, times
//! what the material's formulas leave over (`common/laboratory.rs`); what escapes is the radiance that a sphere round
//! the scene sees inwards. Paths are 400 surfaces long: no surface gives back more than 0.8 of the light, so that
//! less than 10⁻³⁸ is cut off.
//!
//! With ten times as many rays the sums are right to 0.2 %. The tests notice a fifth less light transmitted by leaves,
//! a glossy lobe that is a tenth too weak, or light found by chance that weighs at least 0.2.
//!
//! Tolerances are four standard errors of the sums, from the scatter among batches of rays, and these errors are small.

mod common;

use common::laboratory::{Finish, Laboratory, Power};
use common::{at, settings};
use render::{RenderSettings, Sampler};
use scene::{DAffine3, DVec3, Emission, LightKind, Rgb};
use std::f64::consts::PI;

const RAYS: usize = 600_000;

fn long_paths(seed: u32) -> RenderSettings {
    RenderSettings { sampler: Sampler::Independent, seed, ..settings(1, 1, 1, 400) }
}

fn leaf() -> Finish {
    Finish { diffuse_transmission: [0.15, 0.35, 0.05], ..Finish::diffuse([0.1, 0.4, 0.05]) }
}

fn glossy() -> Finish {
    Finish { glossy: [0.4, 0.5, 0.3], shininess: 0.5, ..Finish::diffuse([0.3, 0.1, 0.4]) }
}

/// One object of every kind, none of which touches another.
fn furnish(lab: &mut Laboratory) {
    lab.ball(0.3, DVec3::new(-0.55, -0.5, 0.4), glossy());
    let waxy = Finish { diffuse: [0.1, 0.25, 0.05], glossy: [0.2; 3], shininess: 0.9, ..leaf() };
    let held = at(0.45, -0.5, 0.6) * DAffine3::from_rotation_z(0.4) * DAffine3::from_rotation_x(0.9);
    lab.leaf(0.3, 0.25, held, leaf());
    let held = at(0.55, -0.55, 1.2) * DAffine3::from_rotation_z(-0.7) * DAffine3::from_rotation_x(1.2);
    lab.leaf(0.2, 0.2, held, waxy);
    let veil = Finish { opacity: 0.5, ..Finish::diffuse([0.7, 0.2, 0.5]) };
    lab.leaf(0.25, 0.25, at(-0.5, 0.5, 0.9) * DAffine3::from_rotation_x(0.5), veil);
    let shiny = Finish { glossy: [0.8, 0.7, 0.6], shininess: 1.0, ..Finish::diffuse([0.0; 3]) };
    lab.ball(0.2, DVec3::new(-0.6, 0.5, 0.35), shiny);
    let polished = Finish { glossy: [0.2; 3], shininess: 0.9, ..Finish::diffuse([0.3, 0.3, 0.5]) };
    let turned = at(0.5, 0.45, 0.1) * DAffine3::from_rotation_z(0.4);
    lab.block(DVec3::new(0.4, 0.3, 0.6), turned, polished);
    let lying = at(-0.8, -0.1, 1.4) * DAffine3::from_rotation_y(0.5 * PI);
    lab.tube(0.12, 0.5, lying, leaf());
    lab.glass_ball(0.2, DVec3::new(0.0, 0.0, 0.4));
}

const LAMP: Rgb = [30.0, 20.0, 10.0];

fn lamp(exponent: f64) -> Emission {
    Emission { power: LAMP, exponent, shadowless: false }
}

/// Asserts that a sum of powers is `expected` within four standard errors, each of which is at most `precision` of it.
fn assert_balance(expected: Rgb, parts: &[Power], precision: f64) {
    for (c, expected) in expected.into_iter().enumerate() {
        let sum: f64 = parts.iter().map(|part| part.watts[c]).sum();
        let error = parts.iter().map(|part| part.variance[c]).sum::<f64>().sqrt();
        let watts: Vec<f64> = parts.iter().map(|part| part.watts[c]).collect();
        eprintln!("channel {c}: {watts:.4?} make {sum:.4} +- {error:.4} of {expected:.4} W");
        assert!(error <= precision * expected, "channel {c}: {error} W tell too little");
        assert!((sum - expected).abs() <= 4.0 * error, "channel {c}: {sum} +- {error} of {expected} W");
    }
}

#[test]
fn a_closed_room_absorbs_what_its_lamp_emits() {
    // Most of the light falls on the walls: what they do shows most.
    let plain = Finish::diffuse([0.5, 0.6, 0.3]);
    for (seed, exponent, walls) in [(0, 0.0, plain), (5000, 2.0, glossy())] {
        let mut lab = Laboratory::new();
        lab.room(DVec3::new(2.0, 2.0, 2.0), walls);
        lab.lamp(1.85, lamp(exponent));
        furnish(&mut lab);
        let (absorbed, _) = lab.measure(&long_paths(seed), RAYS, None);
        assert_balance(LAMP, &[absorbed], 0.008);
    }
}

#[test]
fn a_closed_room_absorbs_what_lights_without_a_body_emit() {
    // Rays of sight meet no such light, only what it lights. Every surface here absorbs the same share, so of the light
    // itself, wherever it falls, that share is absorbed directly, and the rays must bring the rest.
    let share = 0.4;
    let mut lab = Laboratory::new();
    lab.room(DVec3::new(2.0, 2.0, 2.0), Finish::diffuse([0.6; 3]));
    let leaf = Finish { diffuse_transmission: [0.1, 0.3, 0.5], ..Finish::diffuse([0.5, 0.3, 0.1]) };
    lab.leaf(0.5, 0.4, at(0.3, -0.2, 0.9) * DAffine3::from_rotation_x(0.9), leaf);
    lab.tube(0.2, 0.7, at(-0.4, 0.4, 0.3) * DAffine3::from_rotation_x(0.6), leaf);
    lab.ball(0.3, DVec3::new(0.5, 0.5, 0.4), Finish::diffuse([0.6; 3]));
    let (point, spot) = ([10.0, 20.0, 5.0], [20.0, 4.0, 8.0]);
    lab.builder.light(LightKind::Point { power: point }, at(-0.3, -0.5, 1.5));
    let down = at(0.4, 0.1, 1.9) * DAffine3::from_rotation_x(PI - 0.3);
    lab.builder.light(LightKind::Spot { power: spot, inner_angle: 0.5, outer_angle: 0.8 }, down);
    let (indirect, _) = lab.measure(&long_paths(10_000), RAYS, None);
    let emitted: Rgb = std::array::from_fn(|c| point[c] + spot[c]);
    let direct = Power { watts: emitted.map(|watts| share * watts), ..Power::default() };
    assert_balance(emitted, &[direct, indirect], 0.003);
}

/// The same objects on a slab, below a lamp in empty space; all within a sphere of 1.85 m round the origin.
fn open_scene() -> Laboratory {
    let mut lab = Laboratory::new();
    lab.block(DVec3::new(2.2, 2.2, 0.1), at(0.0, 0.0, -0.15), Finish::diffuse([0.6, 0.5, 0.4]));
    lab.lamp(1.7, lamp(1.0));
    furnish(&mut lab);
    lab
}

const SPHERE: f64 = 1.85;

#[test]
fn what_an_open_scene_does_not_absorb_escapes() {
    let (absorbed, escaped) = open_scene().measure(&long_paths(20_000), RAYS, Some(SPHERE));
    assert_balance(LAMP, &[absorbed, escaped], 0.006);
}

#[test]
fn what_a_sky_sends_into_a_sphere_is_absorbed_or_leaves_it() {
    let mut lab = open_scene();
    let sky = [0.1, 0.2, 0.3];
    lab.builder.sky(sky);
    let (absorbed, escaped) = lab.measure(&long_paths(30_000), RAYS, Some(SPHERE));
    let entering = 4.0 * PI * SPHERE * SPHERE * PI;
    let expected = std::array::from_fn(|c| LAMP[c] + entering * sky[c]);
    assert_balance(expected, &[absorbed, escaped], 0.006);
}
