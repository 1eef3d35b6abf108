//! Physical lights and the choice among many lights.
//!
//! Tolerances are five standard errors, predicted from the samples themselves, plus the rounding of 32-bit sums,
//! except where a comment says otherwise.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::access::Access;
use common::*;
use kernels::light::kernel::distribution_density;
use kernels::light_tree::kernel::{choose_light, light_importance, light_probability, total_importance};
use kernels::random::kernel::{independent_key, random4};
use kernels::records::kernel::{LIGHT_GROUP, NONE};
use kernels::warp::kernel::polar_direction;
use render::{CompiledScene, compile};
use scene::{DAffine3, DVec3, Distribution, Emission, LightKind, Scene, Shape};
use std::f64::consts::PI;
use std::sync::Arc;
use wgsl_rs::std::{Vec3f, vec3f};

fn down(x: f64, y: f64, z: f64) -> DAffine3 {
    at(x, y, z) * DAffine3::from_rotation_x(PI)
}

fn table(columns: usize, rows: usize, value: impl Fn(usize, usize) -> f64) -> Arc<Distribution> {
    let values: Vec<f64> = (0..columns * rows).map(|i| value(i % columns, i / columns)).collect();
    Arc::new(Distribution::new(columns, rows, &values).unwrap())
}

#[test]
fn an_even_distribution_is_a_point_light() {
    let mut b = Builder::new();
    let grey = b.diffuse([0.5; 3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), grey);
    let distribution = table(12, 5, |_, _| 2.0);
    b.light(LightKind::Physical { power: [40.0, 20.0, 10.0], distribution }, down(0.0, 0.0, 2.0));
    probe_down(&mut b, 1.0, 0.0, 0.2);
    let squared = 5.0f64;
    let expected = [40.0, 20.0, 10.0].map(|p| p / (4.0 * PI) / squared * (2.0 / squared.sqrt()) * 0.5 / PI);
    let (mean, _) = mean_and_error(&render(&b.scene, &settings(8, 8, 16, 1)));
    for c in 0..3 {
        // The probe sees a patch over which the irradiance varies a little.
        assert!((mean[c] / expected[c] - 1.0).abs() < 1e-3, "{mean:?} {expected:?}");
    }
}

#[test]
fn a_distribution_is_interpolated_in_both_angles() {
    // Six columns of 30 degrees, four rows of 90: the density at some angles by hand.
    let distribution = table(6, 4, |x, y| (1 + x + 2 * y) as f64);
    let mut b = Builder::new();
    let grey = b.diffuse([1.0; 3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), grey);
    let turn = DAffine3::from_rotation_z(0.3) * DAffine3::from_rotation_x(0.5);
    b.light(LightKind::Physical { power: [1.0; 3], distribution: Arc::clone(&distribution) }, turn);
    let compiled = compile(&b.scene).unwrap();
    let unit = distribution.density(0, 0);
    for (theta, phi, value) in [
        (0.0f64, -180.0f64, 1.0),
        (15.0, -180.0, 1.5),
        (75.0, -180.0, 3.5),
        (75.0, -135.0, 4.5),
        (60.0, 45.0, 8.0),
        // Beyond the last column and row nothing changes.
        (170.0, 0.0, 10.0),
        (90.0, 135.0, 10.0),
        (90.0, 179.0, 10.0),
    ] {
        let (theta, phi) = (theta.to_radians().max(1e-4), phi.to_radians());
        let local = DVec3::new(phi.cos() * theta.sin(), phi.sin() * theta.sin(), theta.cos());
        let d = turn.transform_vector3(local);
        let d = vec3f(d.x as f32, d.y as f32, d.z as f32);
        let found = f64::from(distribution_density(Access(&compiled), compiled.lights[0], d));
        // At the seam of the azimuth rounding may choose the other side; the angles there are nudged.
        let expected = value * unit;
        let seam = phi.to_degrees() == -180.0;
        let other = if seam { (value + 6.0) * unit } else { expected };
        assert!(
            (found / expected - 1.0).abs() < 1e-3 || (found / other - 1.0).abs() < 1e-3,
            "{theta} {phi}: {} expected {value}",
            found / unit
        );
    }
    // Over the sphere it adds up to 1.
    let (rows, columns) = (300, 400);
    let mut sum = 0.0;
    for i in 0..rows {
        for j in 0..columns {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / rows as f32;
            let d = polar_direction(z, (j as f32 + 0.5) / columns as f32);
            sum += f64::from(distribution_density(Access(&compiled), compiled.lights[0], d));
        }
    }
    let integral = sum * 4.0 * PI / f64::from(rows * columns);
    // Midpoint rule across kinks and one seam.
    assert!((integral - 1.0).abs() < 3e-3, "{integral}");
}

#[test]
fn lamps_of_one_kind_share_their_table() {
    let mut b = Builder::new();
    let (one, other) = (table(6, 4, |x, y| (1 + x + y) as f64), table(2, 1, |_, _| 1.0));
    for distribution in [&one, &other, &one] {
        let distribution = Arc::clone(distribution);
        b.light(LightKind::Physical { power: [1.0; 3], distribution }, down(0.0, 0.0, 2.0));
    }
    let compiled = compile(&b.scene).unwrap();
    assert_eq!(compiled.attributes.len(), 26);
    assert_eq!([0, 1, 2].map(|i| compiled.lights[i].first), [0, 24, 0]);
}

/// Random numbers of a fixed seed.
fn random(index: u32, dimension: u32) -> [f64; 4] {
    random4(independent_key(index, 0, 77), dimension).to_array().map(f64::from)
}

/// Lamps of all kinds with a place, of very different power, scattered in a room.
fn mixed(count: u32) -> Scene {
    let mut b = Builder::new();
    let grey = b.diffuse([0.5; 3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), grey);
    for i in 0..count {
        let [x, y, z, w] = random(i, 0);
        let place = at(20.0 * x - 10.0, 20.0 * y - 10.0, 0.2 + 4.0 * z);
        let [a, c, power, _] = random(i, 1);
        let turned = place * DAffine3::from_rotation_z(6.3 * a) * DAffine3::from_rotation_x(3.1 * c);
        let power = [100.0 * power.powi(4) + 0.01; 3];
        match i % 4 {
            0 => b.light(LightKind::Point { power }, place),
            1 => {
                let (inner_angle, outer_angle) = (0.2 * w, 0.2 + w);
                b.light(LightKind::Spot { power, inner_angle, outer_angle }, turned);
            }
            2 => {
                let distribution = table(6, 1, |x, _| if x < 3 { 3.0 - x as f64 } else { 0.0 });
                b.light(LightKind::Physical { power, distribution }, turned);
            }
            _ => {
                let shape =
                    Shape::Parallelogram { length: 0.3, axis: DVec3::new(0.2, 0.0, 0.0), scale_v: false };
                let emission = Emission { power, exponent: 1.0, shadowless: false };
                b.object(shape, turned, grey).emission = Some(emission);
            }
        }
    }
    b.light(LightKind::Directional { irradiance: [0.2; 3] }, down(0.0, 0.0, 0.0));
    b.sky([0.02; 3]);
    b.scene
}

/// All lights that are no groups.
fn single_lights(compiled: &CompiledScene) -> Vec<u32> {
    (0..).zip(&compiled.lights).filter(|(_, light)| light.kind != LIGHT_GROUP).map(|(i, _)| i).collect()
}

fn random_point(index: u32) -> Vec3f {
    let [x, y, z, _] = random(index, 2);
    vec3f((24.0 * x - 12.0) as f32, (24.0 * y - 12.0) as f32, (5.0 * z - 2.0) as f32)
}

#[test]
fn the_probabilities_of_all_lights_add_up_to_one() {
    for count in [1, 7, 8, 9, 33, 1000] {
        let scene = mixed(count);
        let compiled = compile(&scene).unwrap();
        let access = Access(&compiled);
        let lights = single_lights(&compiled);
        assert_eq!(lights.len(), count as usize + 2);
        assert_eq!(compiled.lights.len() == lights.len(), count <= 8, "{count}");
        for i in 0..200 {
            let point = random_point(i);
            let total = total_importance(access, point);
            let mut sum = 0.0;
            // A choice fails where the estimate of a group promised light that its lights do not give.
            for &light in &lights {
                let probability = light_probability(access, light, point, total);
                let importance = light_importance(compiled.lights[light as usize], point);
                // Whatever can contribute can be chosen.
                assert!(
                    (importance > 0.0) == (probability > 0.0),
                    "light {light} at {point:?}: {probability}"
                );
                sum += f64::from(probability);
            }
            assert!(sum < 1.0 + 1e-3, "{sum}");
            if count <= 8 {
                assert!((sum - 1.0).abs() < 1e-4, "{sum}");
            }
        }
    }
    // Without spots and lamps, which shine into a part of the room only, nothing is lost.
    let compiled = compile(&grid(2000).0).unwrap();
    let access = Access(&compiled);
    for i in 0..100 {
        let point = random_point(i);
        let total = total_importance(access, point);
        let lights = single_lights(&compiled);
        let sum: f64 = lights.iter().map(|&l| f64::from(light_probability(access, l, point, total))).sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    }
}

#[test]
fn lights_are_chosen_as_often_as_their_probability_says() {
    let scene = mixed(64);
    let compiled = compile(&scene).unwrap();
    let access = Access(&compiled);
    let n = 100_000u32;
    for place in 0..5 {
        let point = random_point(1000 + place);
        let total = total_importance(access, point);
        let mut counts = vec![0f64; compiled.lights.len()];
        let mut failed = 0f64;
        for i in 0..n {
            let u = random4(independent_key(i, place, 3), 0).x;
            let choice = choose_light(access, point, total, u);
            if choice.index == NONE {
                failed += 1.0;
                continue;
            }
            counts[choice.index as usize] += 1.0;
            let probability = light_probability(access, choice.index, point, total);
            assert!((choice.probability / probability - 1.0).abs() < 1e-4);
        }
        let (mut chi2, mut used, mut rest) = (0.0, 0.0, f64::from(n));
        for light in single_lights(&compiled) {
            let expected = f64::from(light_probability(access, light, point, total)) * f64::from(n);
            rest -= expected;
            if expected > 5.0 {
                chi2 += (counts[light as usize] - expected).powi(2) / expected;
                used += 1.0;
            }
        }
        if rest > 5.0 {
            chi2 += (failed - rest).powi(2) / rest;
            used += 1.0;
        } else {
            assert!(failed < 20.0, "{failed} {rest}");
        }
        assert!(chi2 < used + 5.0 * f64::sqrt(2.0 * used), "{chi2} of {used}");
    }
}

/// The same lights without groups: all are looked at everywhere.
fn without_tree(mut compiled: CompiledScene) -> CompiledScene {
    let kept = single_lights(&compiled);
    compiled.lights = kept.iter().map(|&i| compiled.lights[i as usize]).collect();
    for light in &mut compiled.lights {
        light.parent = NONE;
    }
    for object in &mut compiled.objects {
        if let Some(place) = kept.iter().position(|&i| i == object.surface.light) {
            object.surface.light = place as u32;
        }
    }
    compiled.header.lights = kept.len() as u32;
    compiled
}

#[test]
fn the_tree_gives_the_picture_of_a_loop_over_all_lights() {
    let mut b = Builder { scene: mixed(500) };
    b.look(DVec3::new(0.0, 0.0, 25.0), DVec3::ZERO, DVec3::Y, 45.0);
    let device = render::open_device(render::DeviceChoice::Cpu, None).unwrap();
    let compiled = compile(&b.scene).unwrap();
    let flat = without_tree(compiled.clone());
    let settings = settings(48, 48, 64, 1);
    let [tree, all] = [compiled, flat].map(|compiled| {
        let film = device.load(Arc::new(compiled)).unwrap().render(&settings, &go_on).unwrap();
        mean_and_error(&film)
    });
    let error = tree.1[0].hypot(all.1[0]);
    assert!((tree.0[0] - all.0[0]).abs() < 5.0 * error, "{tree:?} {all:?}");
    // Looking at a few groups is hardly noisier: it had 1.04 times the error when this was written.
    assert!(tree.1[0] < 2.0 * all.1[0], "{} {}", tree.1[0], all.1[0]);
}

/// Point lights on a grid over a plane, and their powers.
fn grid(count: u32) -> (Scene, Vec<(DVec3, f64)>) {
    let mut b = Builder::new();
    let grey = b.diffuse([0.5; 3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), grey);
    let side = f64::from(count).sqrt().ceil() as u32;
    let mut lights = Vec::new();
    for i in 0..count {
        let place = DVec3::new(
            f64::from(i % side) - 0.5 * f64::from(side),
            f64::from(i / side) - 0.5 * f64::from(side),
            1.5,
        );
        let power = 1.0 + f64::from(i % 7);
        b.light(LightKind::Point { power: [power; 3] }, DAffine3::from_translation(place));
        lights.push((place, power));
    }
    (b.scene, lights)
}

#[test]
fn two_thousand_lights_add_up() {
    let (scene, lights) = grid(2000);
    let gpu = gpu();
    let mut b = Builder { scene };
    for (x, y) in [(0.0, 0.0), (-21.0, 3.3), (19.4, 19.7), (60.0, -5.0)] {
        probe_down(&mut b, x, y, 0.02);
        let irradiance: f64 = lights
            .iter()
            .map(|(place, power)| {
                let way = *place - DVec3::new(x, y, 0.0);
                power / (4.0 * PI) / way.length_squared() * way.z / way.length()
            })
            .sum();
        let expected = irradiance * 0.5 / PI;
        assert_mean(&render(&b.scene, &settings(32, 32, 64, 1)), [expected; 3], 5.0);
        if x == 0.0
            && let Some(gpu) = &gpu
        {
            assert_mean(&render_on(gpu, &b.scene, &settings(16, 16, 16, 1)), [expected; 3], 5.0);
        }
    }
}

#[test]
fn a_lamp_cut_into_many_gives_the_same_light() {
    // Found by light sampling and by reflection; both probabilities of the tree must be right.
    let lamp = |parts: u32| {
        let mut b = Builder::new();
        let glossy = b.phong(|s| scene::Phong {
            diffuse: grey(s, 0.4),
            specular: grey(s, 0.4),
            shininess: grey(s, 0.5),
            ..scene::Phong::default()
        });
        let black = b.diffuse([0.0; 3]);
        b.object(Shape::Plane, at(0.0, 0.0, 0.0), glossy);
        let size = 4.0 / f64::from(parts);
        let power = 50.0 / f64::from(parts * parts);
        for i in 0..parts * parts {
            let x = size * (f64::from(i % parts) + 0.5) - 2.0;
            let y = size * (f64::from(i / parts) + 0.5) - 2.0;
            b.rectangle(DVec3::new(x, y, 1.0), (size, size), false, black).emission =
                Some(Emission { power: [power; 3], exponent: 0.0, shadowless: false });
        }
        b.look(DVec3::new(0.5, -1.0, 0.5), DVec3::ZERO, DVec3::Z, 5.0);
        b.scene
    };
    let settings = settings(32, 32, 256, 1);
    let (one, one_error) = mean_and_error(&render(&lamp(1), &settings));
    let (many, many_error) = mean_and_error(&render(&lamp(20), &settings));
    let error = one_error[0].hypot(many_error[0]);
    assert!((one[0] - many[0]).abs() < 5.0 * error, "{} {} {error}", one[0], many[0]);
    assert!(error < 0.005 * one[0], "{error} {}", one[0]);
}

#[test]
fn a_room_of_many_lamps_is_the_same_picture_on_both_devices() {
    let Some(gpu) = gpu() else { return };
    let mut b = Builder { scene: mixed(60) };
    b.look(DVec3::new(0.0, -12.0, 6.0), DVec3::ZERO, DVec3::Z, 60.0);
    let settings = settings(16, 12, 16, 2);
    let (cpu, gpu) = (render(&b.scene, &settings), render_on(&gpu, &b.scene, &settings));
    let ((a, ea), (b, eb)) = (mean_and_error(&cpu), mean_and_error(&gpu));
    assert!((a[0] - b[0]).abs() < 5.0 * ea[0].hypot(eb[0]), "{a:?} {b:?}");
    let far = cpu.radiances().zip(gpu.radiances()).filter(|(a, b)| (a[1] - b[1]).abs() > 2e-3 * a[1].abs());
    let different = far.count();
    assert!(different * 10 < cpu.pixels.len(), "{different} pixels differ");
}
