//! Pictures whose exact radiance is known.
//!
//! Tolerances are five standard errors, predicted from the samples themselves, plus the rounding of 32-bit sums.

mod common;

use common::*;
use scene::{DAffine3, DVec3, Emission, LightKind, Phong, Shape};
use std::f64::consts::PI;

#[test]
fn a_white_sphere_in_a_uniform_sky_is_invisible() {
    let mut b = Builder::new();
    let white = b.diffuse([1.0; 3]);
    b.object(Shape::Sphere { radius: 1.0 }, at(0.0, 0.0, 0.0), white);
    b.sky([0.7, 1.0, 1.3]);
    b.look(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO, DVec3::Z, 45.0);
    assert_mean(&render(&b.scene, &settings(64, 64, 64, 20)), [0.7, 1.0, 1.3], 5.0);
}

#[test]
fn the_furnace_holds_for_transmitting_and_half_opaque_surfaces() {
    // Every lobe at once, coefficients that add up to 1: nothing may be lost or gained except what the glossy
    // lobe sheds at grazing angles, so the glossy coefficient is 0 here.
    let mut b = Builder::new();
    let leaf =
        b.phong(|s| Phong { diffuse: grey(s, 0.6), diffuse_transparency: grey(s, 0.4), ..Phong::default() });
    let glass = b.phong(|s| Phong {
        diffuse: grey(s, 1.0),
        transparency: grey(s, 0.3),
        interpolated_transparency: true,
        ..Phong::default()
    });
    let mirror = b.phong(|s| Phong {
        diffuse: grey(s, 0.0),
        specular: grey(s, 1.0),
        shininess: grey(s, 1.0),
        ..Phong::default()
    });
    let veil = b.scene.add_material(scene::Material::Rgba { color: [1.0; 3], opacity: 0.4 });
    for (x, material) in [(-3.0, leaf), (-1.0, glass), (1.0, mirror), (3.0, veil)] {
        b.object(Shape::Sphere { radius: 0.8 }, at(x, 0.0, 0.0), material);
    }
    b.sky([1.0; 3]);
    b.look(DVec3::new(0.0, -8.0, 0.0), DVec3::ZERO, DVec3::Z, 60.0);
    assert_mean(&render(&b.scene, &settings(120, 40, 128, 200)), [1.0; 3], 5.0);
}

#[test]
fn glossy_surfaces_never_reflect_more_than_arrives() {
    for shininess in [0.0, 0.05, 0.3, 0.6, 0.9, 0.99] {
        let mut b = Builder::new();
        let glossy = b.phong(|s| Phong {
            diffuse: grey(s, 0.0),
            specular: grey(s, 1.0),
            shininess: grey(s, shininess),
            ..Phong::default()
        });
        b.object(Shape::Plane, at(0.0, 0.0, 0.0), glossy);
        b.sky([1.0; 3]);
        for degrees in [0.0f64, 20.0, 40.0, 60.0, 80.0] {
            let angle = degrees.to_radians();
            let eye = DVec3::new(angle.sin(), 0.0, angle.cos());
            b.look(eye, DVec3::ZERO, DVec3::Y, 0.1);
            let (mean, error) = mean_and_error(&render(&b.scene, &settings(32, 32, 128, 1)));
            assert!(mean[0] <= 1.0 + 5.0 * error[0], "shininess {shininess} at {degrees}: {}", mean[0]);
            if degrees == 0.0 && shininess >= 0.6 {
                // At normal incidence GroIMP's lobe reflects exactly its coefficient.
                assert!((mean[0] - 1.0).abs() <= 5.0 * error[0] + 1e-3, "{}", mean[0]);
            }
        }
    }
}

#[test]
fn irradiance_of_a_point_light_falls_with_the_square_of_the_distance() {
    for distance in [0.5, 2.0, 10.0] {
        let mut b = Builder::new();
        let ground = b.diffuse([0.5; 3]);
        b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
        b.light(LightKind::Point { power: [40.0, 20.0, 10.0] }, at(0.0, 0.0, distance));
        probe_down(&mut b, 0.0, 0.0, 0.3);
        let expected = [40.0, 20.0, 10.0].map(|p| p / (4.0 * PI) / (distance * distance) * 0.5 / PI);
        assert_mean(&render(&b.scene, &settings(8, 8, 16, 1)), expected, 5.0);
    }
}

#[test]
fn a_spot_light_has_groimps_profile_and_power() {
    let (inner, outer) = (0.4f64, 0.7f64);
    let power = 30.0;
    let density = 1.0 / (2.0 * PI * (1.0 - 0.5 * (inner.cos() + outer.cos())));
    for angle in [0.0, 0.3, 0.5, 0.6, 0.69, 0.75f64] {
        let height = 3.0;
        let mut b = Builder::new();
        let ground = b.diffuse([0.8; 3]);
        b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
        // Local +z points down.
        let down = at(0.0, 0.0, height) * DAffine3::from_rotation_x(PI);
        b.light(LightKind::Spot { power: [power; 3], inner_angle: inner, outer_angle: outer }, down);
        probe_down(&mut b, height * angle.tan(), 0.0, 0.2);
        let t = ((angle.cos() - outer.cos()) / (inner.cos() - outer.cos())).clamp(0.0, 1.0);
        let distance = height / angle.cos();
        let irradiance = power * density * t * t * (3.0 - 2.0 * t) * angle.cos() / (distance * distance);
        let expected = irradiance * 0.8 / PI;
        let film = render(&b.scene, &settings(8, 8, 16, 1));
        // The probe sees a patch, over which the steep rim of the profile varies a little.
        let (mean, _) = mean_and_error(&film);
        assert!((mean[0] - expected).abs() <= 2e-4 * irradiance.max(0.01), "{angle}: {} {expected}", mean[0]);
    }
}

#[test]
fn a_rectangular_lamp_has_its_form_factor() {
    // Lambertian rectangle 2a x 2b at height h over the point below its middle; four times the corner formula of
    // Howell's catalogue (configuration B-5).
    let (a, b_, h, power) = (0.8f64, 0.5f64, 1.5f64, 12.0);
    let (x, y) = (a / h, b_ / h);
    let corner = (x / (1.0 + x * x).sqrt() * (y / (1.0 + x * x).sqrt()).atan()
        + y / (1.0 + y * y).sqrt() * (x / (1.0 + y * y).sqrt()).atan())
        / (2.0 * PI);
    let radiance = power / (PI * 4.0 * a * b_);
    let expected = PI * radiance * 4.0 * corner * 0.6 / PI;

    let mut b = Builder::new();
    let ground = b.diffuse([0.6; 3]);
    let black = b.diffuse([0.0; 3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    b.rectangle(DVec3::new(0.0, 0.0, h), (2.0 * a, 2.0 * b_), false, black).emission =
        Some(Emission { power: [power; 3], exponent: 0.0, shadowless: false });
    probe_down(&mut b, 0.0, 0.0, 0.2);
    assert_mean(&render(&b.scene, &settings(24, 24, 256, 1)), [expected; 3], 5.0);

    // From below the lamp shows its radiance, from above it is dark.
    b.look(DVec3::new(0.0, 0.0, 0.5), DVec3::new(0.0, 0.0, h), DVec3::Y, 5.0);
    assert_mean(&render(&b.scene, &settings(8, 8, 16, 1)), [radiance; 3], 5.0);
    b.look(DVec3::new(0.0, 0.0, 3.0), DVec3::new(0.0, 0.0, h), DVec3::Y, 5.0);
    assert_mean(&render(&b.scene, &settings(8, 8, 16, 1)), [0.0; 3], 5.0);
}

#[test]
fn a_concentrated_lamp_emits_its_power() {
    // A small lamp far away: intensity on the axis is power (e + 2) / (2 pi).
    let (power, exponent, height) = (10.0, 4.0, 50.0);
    let mut b = Builder::new();
    let ground = b.diffuse([1.0; 3]);
    let black = b.diffuse([0.0; 3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    b.rectangle(DVec3::new(0.0, 0.0, height), (0.05, 0.05), false, black).emission =
        Some(Emission { power: [power; 3], exponent, shadowless: false });
    probe_down(&mut b, 0.0, 0.0, 0.2);
    let expected = power * (exponent + 2.0) / (2.0 * PI) / (height * height) / PI;
    assert_mean(&render(&b.scene, &settings(8, 8, 64, 1)), [expected; 3], 5.0);
}

#[test]
fn a_directional_light_lights_by_the_cosine() {
    let mut b = Builder::new();
    let ground = b.diffuse([0.5; 3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    let tilted = DAffine3::from_rotation_x(PI - 1.0);
    b.light(LightKind::Directional { irradiance: [6.0; 3] }, tilted);
    probe_down(&mut b, 0.0, 0.0, 0.2);
    assert_mean(&render(&b.scene, &settings(8, 8, 16, 3)), [6.0 * 1f64.cos() * 0.5 / PI; 3], 5.0);
}

#[test]
fn light_between_two_parallel_walls_adds_up_as_a_geometric_series() {
    // Inside a closed white box with one lamp every radiance is finite: a sphere of albedo rho that encloses a
    // point light has the indirect radiance L_direct / (1 - rho) everywhere.
    let rho = 0.5;
    let mut b = Builder::new();
    let wall = b.diffuse([rho; 3]);
    b.object(Shape::Sphere { radius: 2.0 }, at(0.0, 0.0, 0.0), wall);
    b.light(LightKind::Point { power: [8.0; 3] }, at(0.0, 0.0, 0.0));
    b.look(DVec3::ZERO, DVec3::Y, DVec3::Z, 60.0);
    let direct = 8.0 / (4.0 * PI) / 4.0 * rho / PI;
    assert_mean(&render(&b.scene, &settings(32, 32, 64, 1)), [direct; 3], 5.0);
    assert_mean(&render(&b.scene, &settings(32, 32, 64, 3)), [direct * (1.0 + rho + rho * rho); 3], 5.0);
    assert_mean(&render(&b.scene, &settings(32, 32, 64, 100)), [direct / (1.0 - rho); 3], 5.0);
}

#[test]
fn half_opaque_sheets_attenuate_shadows_and_views() {
    let mut b = Builder::new();
    let ground = b.diffuse([0.5; 3]);
    let veil = b.scene.add_material(scene::Material::Rgba { color: [0.0; 3], opacity: 0.25 });
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    b.rectangle(DVec3::new(0.0, 0.0, 1.0), (4.0, 4.0), true, veil);
    b.light(LightKind::Point { power: [40.0; 3] }, at(0.0, 0.0, 2.0));
    let lit = 40.0 / (4.0 * PI) / 4.0 * 0.5 / PI;
    probe_down(&mut b, 0.0, 0.0, 0.5);
    assert_mean(&render(&b.scene, &settings(16, 16, 64, 1)), [0.75 * lit; 3], 5.0);
    probe_down(&mut b, 0.0, 0.0, 1.5);
    assert_mean(&render(&b.scene, &settings(16, 16, 256, 1)), [0.75 * 0.75 * lit; 3], 5.0);
}

#[test]
fn coloured_glass_colours_shadows_and_views() {
    let mut b = Builder::new();
    let ground = b.diffuse([0.5; 3]);
    let glass = b.phong(|s| Phong {
        diffuse: grey(s, 0.0),
        transparency: Some(s.add_channel(scene::Channel::Constant([0.9, 0.5, 0.2]))),
        interpolated_transparency: true,
        ..Phong::default()
    });
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    b.rectangle(DVec3::new(0.0, 0.0, 1.0), (400.0, 400.0), true, glass);
    b.sky([1.0; 3]);
    let once = [0.9, 0.5, 0.2];
    probe_down(&mut b, 0.0, 0.0, 0.5);
    assert_mean(&render(&b.scene, &settings(16, 16, 256, 1)), once.map(|t| 0.5 * t), 5.0);
    probe_down(&mut b, 0.0, 0.0, 1.5);
    assert_mean(&render(&b.scene, &settings(16, 16, 1024, 1)), once.map(|t| 0.5 * t * t), 5.0);
}
