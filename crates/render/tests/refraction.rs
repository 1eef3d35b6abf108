//! Refracting bodies and two-sided materials against closed forms, on both devices.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::*;
use render::{Device, DeviceChoice, Film, RenderSettings, open_device};
use scene::{DAffine3, DVec3, Interior, Material, MaterialId, Phong, Rgb, Scene, Shape};

const GLASS: Option<Interior> = Some(Interior { refractive_index: 1.5 });
const WATER: Option<Interior> = Some(Interior { refractive_index: 1.33 });
/// Reflectance of glass seen straight on.
const STRAIGHT_ON: f64 = 0.04;

fn clear(b: &mut Builder) -> MaterialId {
    b.scene.add_material(Material::Rgba { color: [0.0; 3], opacity: 0.0 })
}

fn glowing(b: &mut Builder, radiance: Rgb) -> MaterialId {
    b.phong(|s| Phong {
        diffuse: Some(s.add_channel(scene::Channel::Constant([0.0; 3]))),
        emissive: Some(s.add_channel(scene::Channel::Constant(radiance))),
        ..Phong::default()
    })
}

/// A wide slab between z = 0 and z = 0.2.
fn slab(b: &mut Builder, material: MaterialId, interior: Option<Interior>) {
    let shape = Shape::Box { width: 2000.0, height: 2000.0, length: 0.2 };
    b.object(shape, DAffine3::IDENTITY, material).interior = interior;
}

/// Pictures of a scene on the CPU and, if there is one, on the GPU.
fn films(scene: &Scene, settings: &RenderSettings) -> Vec<Film> {
    let mut films = vec![render_on(open_device(DeviceChoice::Cpu, None).unwrap().as_ref(), scene, settings)];
    if let Some(gpu) = gpu() {
        films.push(render_on(&gpu as &dyn Device, scene, settings));
    }
    films
}

#[test]
fn a_slab_of_glass_lets_pass_what_its_two_surfaces_do() {
    let mut b = Builder::new();
    let (clear, glow) = (clear(&mut b), glowing(&mut b, [1.0, 2.0, 0.5]));
    slab(&mut b, clear, GLASS);
    b.rectangle(DVec3::new(0.0, 0.0, -1.0), (4000.0, 4000.0), true, glow);
    probe_down(&mut b, 0.1, 0.2, 5.0);
    // All orders of reflection between the two surfaces: T = (1 - F) / (1 + F).
    let through = (1.0 - STRAIGHT_ON) / (1.0 + STRAIGHT_ON);
    for film in films(&b.scene, &settings(8, 8, 256, 40)) {
        assert_mean(&film, [1.0, 2.0, 0.5].map(|radiance| radiance * through), 4.0);
    }
}

#[test]
fn a_phong_without_specular_channel_loses_what_it_reflects() {
    let mut b = Builder::new();
    let glow = glowing(&mut b, [1.0; 3]);
    let phong = b.phong(|s| Phong {
        diffuse: grey(s, 0.3),
        transparency: grey(s, 1.0),
        interpolated_transparency: true,
        ..Phong::default()
    });
    slab(&mut b, phong, GLASS);
    b.rectangle(DVec3::new(0.0, 0.0, -1.0), (4000.0, 4000.0), true, glow);
    probe_down(&mut b, 0.1, 0.2, 5.0);
    for film in films(&b.scene, &settings(8, 8, 64, 40)) {
        assert_mean(&film, [(1.0 - STRAIGHT_ON).powi(2); 3], 4.0);
    }
}

#[test]
fn a_slab_shifts_what_is_behind_it_by_the_law_of_refraction() {
    // Looking down under 45 degrees: the ray is shifted by d (tan 45 - tan t) with sin t = sin 45 / n.
    let angle = std::f64::consts::FRAC_PI_4;
    let inside = (angle.sin() / 1.5).asin();
    let shift = 0.2 * (angle.tan() - inside.tan());
    // Without the slab the ray meets z = 0 at x = 0; it walks in +x direction on its way down.
    for (edge, bright) in [(-0.004, true), (0.004, false)] {
        let mut b = Builder::new();
        let (clear, glow) = (clear(&mut b), glowing(&mut b, [1.0; 3]));
        slab(&mut b, clear, GLASS);
        // The ground under the slab glows right of the edge.
        let left = -shift + edge;
        b.rectangle(DVec3::new(left + 5.0, 0.0, -1e-4), (10.0, 10.0), true, glow);
        b.look(DVec3::new(-10.0, 0.0, 10.0), DVec3::ZERO, DVec3::Z, 0.001);
        for film in films(&b.scene, &settings(4, 4, 16, 2)) {
            let (mean, _) = mean_and_error(&film);
            assert_eq!(mean[0] > 0.5, bright, "edge {edge}: {mean:?}");
        }
    }
}

#[test]
fn a_clear_body_under_an_even_sky_cannot_be_seen() {
    let mut b = Builder::new();
    let clear = clear(&mut b);
    b.object(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, clear).interior = GLASS;
    // Denser inside: a second medium that the path must keep apart from the first.
    b.object(Shape::Sphere { radius: 0.4 }, at(0.2, 0.0, 0.1), clear).interior = WATER;
    b.sky([1.0, 0.5, 0.25]);
    b.look(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO, DVec3::Z, 35.0);
    for film in films(&b.scene, &settings(16, 16, 256, 200)) {
        assert_mean(&film, [1.0, 0.5, 0.25], 4.0);
    }
}

#[test]
fn radiance_inside_glass_is_larger_by_the_square_of_its_index() {
    let mut b = Builder::new();
    let clear = clear(&mut b);
    b.object(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, clear).interior = GLASS;
    b.sky([1.0; 3]);
    // From the middle all rays leave straight on.
    b.look(DVec3::new(0.0, 0.0, 0.0), DVec3::Y, DVec3::Z, 60.0);
    for film in films(&b.scene, &settings(8, 8, 256, 200)) {
        assert_mean(&film, [2.25; 3], 4.0);
    }
}

#[test]
fn equal_media_have_no_surface_between_them() {
    let picture = |with_ball: bool| {
        let mut b = Builder::new();
        let (clear, grey) = (clear(&mut b), b.diffuse([0.6, 0.5, 0.4]));
        b.object(Shape::Box { width: 2.0, height: 2.0, length: 1.0 }, at(0.0, 0.0, 0.0), clear).interior =
            WATER;
        if with_ball {
            b.object(Shape::Sphere { radius: 0.3 }, at(0.0, 0.0, 0.5), clear).interior = WATER;
        }
        b.rectangle(DVec3::new(0.0, 0.0, -0.1), (8.0, 8.0), true, grey);
        b.sky([1.0; 3]);
        b.look(DVec3::new(0.3, -2.0, 4.0), DVec3::new(0.0, 0.0, 0.4), DVec3::Z, 40.0);
        b.scene
    };
    // The ball costs two surfaces of depth, so the limit must not matter.
    let settings = settings(24, 24, 400, 60);
    for (plain, with_ball) in films(&picture(false), &settings).iter().zip(films(&picture(true), &settings)) {
        let ((a, error_a), (b, error_b)) = (mean_and_error(plain), mean_and_error(&with_ball));
        for c in 0..3 {
            assert!((a[c] - b[c]).abs() < 4.0 * error_a[c].hypot(error_b[c]), "{a:?} {b:?}");
        }
    }
}

#[test]
fn frosted_glass_gains_no_light() {
    let mut b = Builder::new();
    let frosted = b.phong(|s| Phong {
        diffuse: grey(s, 0.5),
        specular: grey(s, 0.2),
        shininess: grey(s, 0.9),
        transparency: grey(s, 0.8),
        transparency_shininess: grey(s, 0.8),
        interpolated_transparency: true,
        ..Phong::default()
    });
    b.object(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, frosted).interior = GLASS;
    b.sky([1.0; 3]);
    b.look(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO, DVec3::Z, 25.0);
    for film in films(&b.scene, &settings(12, 12, 256, 100)) {
        let (mean, error) = mean_and_error(&film);
        assert!(mean[0] < 1.0 + 4.0 * error[0] && mean[0] > 0.5, "{mean:?}");
    }
}

/// A leaf-like rectangle in the plane z = 0 with its front up.
fn two_sided(front: Material, back: Material) -> Builder {
    let mut b = Builder::new();
    let (front, back) = (b.scene.add_material(front), b.scene.add_material(back));
    let both = b.scene.add_material(Material::SideSwitch { front, back });
    b.rectangle(DVec3::ZERO, (2.0, 2.0), true, both);
    b
}

fn rgba(color: Rgb, opacity: f64) -> Material {
    Material::Rgba { color, opacity }
}

#[test]
fn each_side_has_its_material_also_in_a_mirrored_placement() {
    for mirror in [1.0, -1.0] {
        for from_above in [true, false] {
            let mut b = two_sided(rgba([0.9, 0.1, 0.1], 1.0), rgba([0.1, 0.1, 0.9], 1.0));
            let object = &mut b.scene.objects[0];
            object.world_from_object =
                DAffine3::from_scale(DVec3::new(mirror, 1.0, 1.0)) * object.world_from_object;
            b.sky([1.0; 3]);
            let eye = DVec3::new(0.1, 0.1, if from_above { 3.0 } else { -3.0 });
            b.look(eye, DVec3::new(0.1, 0.1, 0.0), DVec3::Y, 0.5);
            let expected = if from_above { [0.9, 0.1, 0.1] } else { [0.1, 0.1, 0.9] };
            for film in films(&b.scene, &settings(6, 6, 64, 1)) {
                assert_mean(&film, expected, 4.0);
            }
        }
    }
}

#[test]
fn a_side_may_be_clear_for_rays_and_shadows() {
    // Clear from below: the glow above is seen through it; opaque from above.
    for from_above in [true, false] {
        let mut b = two_sided(rgba([0.0; 3], 1.0), rgba([0.0; 3], 0.0));
        let glow = glowing(&mut b, [1.0; 3]);
        let z = if from_above { -1.0 } else { 1.0 };
        b.rectangle(DVec3::new(0.0, 0.0, z), (4.0, 4.0), from_above, glow);
        b.look(DVec3::new(0.1, 0.1, -3.0 * z), DVec3::new(0.1, 0.1, 0.0), DVec3::Y, 0.5);
        for film in films(&b.scene, &settings(4, 4, 16, 2)) {
            let (mean, _) = mean_and_error(&film);
            assert_eq!(mean[0], if from_above { 0.0 } else { 1.0 });
        }
    }
    // A lamp above, a white ground below: shadow rays go upwards and meet the clear back.
    let mut b = two_sided(rgba([0.0; 3], 1.0), rgba([0.0; 3], 0.0));
    let white = b.diffuse([1.0; 3]);
    b.rectangle(DVec3::new(0.0, 0.0, -1.0), (20.0, 20.0), true, white);
    b.light(scene::LightKind::Point { power: [4.0 * std::f64::consts::PI; 3] }, at(0.0, 0.0, 1.0));
    b.look(DVec3::new(0.0, 3.0, -0.5), DVec3::new(0.0, 0.0, -1.0), DVec3::Z, 0.05);
    for film in films(&b.scene, &settings(4, 4, 16, 1)) {
        // Intensity 1 W/sr at 2 m on white: 1 / (4 π).
        assert_mean(&film, [0.25 / std::f64::consts::PI; 3], 4.0);
    }
}
