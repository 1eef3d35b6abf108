//! The ray tracer against pictures that were computed by hand, and one device against the other.
//!
//! The colour of a light is its irradiance over π, and lamps do not fade with distance.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::garden::garden;
use common::*;
use render::{Film, RenderSettings, Renderer};
use scene::{
    Attenuation, Camera, Channel, DAffine3, DVec3, Emission, Image, Interior, LightKind, Material,
    MaterialId, Phong, Rgb, Scene, Shape,
};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Samples per pixel and axis.
const FINE: u32 = 16;

fn traced(width: u32, height: u32, depth: u32) -> RenderSettings {
    RenderSettings {
        samples: FINE * FINE,
        grid: FINE,
        renderer: Renderer::RayTracer,
        ..settings(width, height, 1, depth)
    }
}

/// Few samples where all of them see the same.
fn probed(depth: u32) -> RenderSettings {
    RenderSettings { renderer: Renderer::RayTracer, ..settings(4, 4, 9, depth) }
}

/// A camera that looks down along parallel rays; `width` is that of the picture in metres.
fn look_down(b: &mut Builder, width: f64) {
    b.scene.camera = Camera { view_from_world: at(0.0, 0.0, -10.0), projection: PARALLEL(width), lens: None };
}

/// The mean of a function of the point of the picture over a pixel, or `None` where it is not defined all over.
fn pixel_mean(film: &Film, width: f64, x: u32, y: u32, f: impl Fn(f64, f64) -> Option<f64>) -> Option<f64> {
    let step = width / f64::from(film.width);
    let mut sum = 0.0;
    for i in 0..FINE * FINE {
        let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(FINE);
        let px = (f64::from(x) + offset(i % FINE)) * step - 0.5 * width;
        let py = 0.5 * step * f64::from(film.height) - (f64::from(y) + offset(i / FINE)) * step;
        sum += f(px, py)?;
    }
    Some(sum / f64::from(FINE * FINE))
}

/// Asserts that one channel of a picture follows a closed form; `within` of the greatest value is allowed, the
/// samples are jittered. Returns the number of pixels.
fn assert_picture(
    film: &Film,
    width: f64,
    channel: usize,
    within: f64,
    f: impl Fn(f64, f64) -> Option<f64>,
) -> usize {
    let mut compared = Vec::new();
    for y in 0..film.height {
        for x in 0..film.width {
            if let Some(expected) = pixel_mean(film, width, x, y, &f) {
                compared.push((x, y, f64::from(film.radiance(x, y)[channel]), expected));
            }
        }
    }
    let greatest = compared.iter().fold(0.0, |greatest, pixel| pixel.3.max(greatest));
    assert!(greatest > 0.0);
    for &(x, y, seen, expected) in &compared {
        assert!((seen - expected).abs() < within * greatest, "pixel {x} {y}: {seen}, expected {expected}");
    }
    compared.len()
}

/// The point of the unit sphere that a look down meets; its normal, too.
fn on_sphere(x: f64, y: f64) -> Option<DVec3> {
    let squared = 1.0 - x * x - y * y;
    (squared > 0.0).then(|| DVec3::new(x, y, squared.sqrt()))
}

/// A placement whose z axis points along `axis`.
fn towards(position: DVec3, axis: DVec3) -> DAffine3 {
    let z = axis.normalize();
    let (x, y) = z.any_orthonormal_pair();
    DAffine3::from_mat3_translation(scene::DMat3::from_cols(x, y, z), position)
}

fn glowing(b: &mut Builder, radiance: Rgb) -> MaterialId {
    b.phong(|s| Phong {
        diffuse: grey(s, 0.0),
        emissive: Some(s.add_channel(Channel::Constant(radiance))),
        ..Phong::default()
    })
}

/// An ideal mirror.
fn mirror(b: &mut Builder, reflectance: f64) -> MaterialId {
    b.phong(|s| Phong {
        diffuse: grey(s, 0.0),
        specular: grey(s, reflectance),
        shininess: grey(s, 1.0),
        ..Phong::default()
    })
}

fn mean(film: &Film) -> Rgb {
    mean_and_error(film).0
}

fn assert_near(seen: Rgb, expected: Rgb, within: f64) {
    for c in 0..3 {
        assert!((seen[c] - expected[c]).abs() <= within, "{seen:?}, expected {expected:?}");
    }
}

const LAMP: DVec3 = DVec3::new(2.0, 1.0, 3.0);
const SPOT: DVec3 = DVec3::new(-3.0, 0.5, 4.0);
const BEAM: DVec3 = DVec3::new(0.3, 0.6, -1.0);

fn three_lights() -> [(LightKind, DAffine3); 3] {
    [
        (LightKind::Point { power: [50.0, 20.0, 10.0] }, towards(LAMP, DVec3::X)),
        (
            LightKind::Spot { power: [9.0, 40.0, 6.0], inner_angle: 0.1, outer_angle: 0.3 },
            towards(SPOT, -SPOT),
        ),
        (LightKind::Directional { irradiance: [2.0, 3.0, 4.0] }, towards(DVec3::ZERO, BEAM)),
    ]
}

/// What a white sphere scatters of each of the three lights in a channel, by Lambert's law.
fn lambert(light: usize, channel: usize, p: DVec3) -> f64 {
    let from = |lamp: DVec3| (lamp - p).normalize();
    match (light, &three_lights()[light].0) {
        (_, LightKind::Point { power }) => power[channel] / (4.0 * PI) / PI * from(LAMP).dot(p).max(0.0),
        (_, LightKind::Spot { power, .. }) => {
            let (inner, outer) = (0.1f64.cos(), 0.3f64.cos());
            let intensity = power[channel] / (TAU * (1.0 - 0.5 * (inner + outer)));
            let t = ((from(SPOT).dot(SPOT.normalize()) - outer) / (inner - outer)).clamp(0.0, 1.0);
            intensity * t * t * (3.0 - 2.0 * t) / PI * from(SPOT).dot(p).max(0.0)
        }
        (_, LightKind::Directional { irradiance }) => {
            irradiance[channel] / PI * p.dot(-BEAM.normalize()).max(0.0)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_sphere_in_the_light_of_three_lamps() {
    let scene = |lights: &[usize]| {
        let mut b = Builder::new();
        let color = b.diffuse([0.5, 1.0, 0.25]);
        b.object(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, color);
        for &light in lights {
            let (kind, place) = three_lights()[light].clone();
            b.light(kind, place);
        }
        look_down(&mut b, 2.4);
        b.scene
    };
    let settings = traced(24, 24, 1);
    for (light, channel) in [(0, 0), (1, 1), (2, 2)] {
        let color = [0.5, 1.0, 0.25][channel];
        let film = render(&scene(&[light]), &settings);
        let compared = assert_picture(&film, 2.4, channel, 2e-3, |x, y| {
            on_sphere(x, y).map(|p| color * lambert(light, channel, p))
        });
        assert!(compared > 250, "{compared}");
        // Nothing is seen beside the sphere.
        assert_eq!(film.radiance(0, 0), [0.0; 3]);
    }
    let film = render(&scene(&[0, 1, 2]), &settings);
    for channel in 0..3 {
        assert_picture(&film, 2.4, channel, 2e-3, |x, y| {
            let color = [0.5, 1.0, 0.25][channel];
            on_sphere(x, y).map(|p| (0..3).map(|light| color * lambert(light, channel, p)).sum())
        });
    }
}

#[test]
fn a_phong_sphere_has_the_highlight_of_the_half_vector() {
    // Shininess 0.5: y = 0.75, exponent -2 / ln y.
    let exponent = -2.0 / 0.75f64.ln();
    let mut b = Builder::new();
    let shiny = b.phong(|s| Phong {
        diffuse: grey(s, 0.2),
        specular: grey(s, 0.5),
        shininess: grey(s, 0.5),
        ambient: grey(s, 0.3),
        emissive: grey(s, 0.125),
        ..Phong::default()
    });
    b.scene.ambient = [PI, 0.5 * PI, 0.0];
    b.object(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, shiny);
    let (kind, place) = three_lights()[0].clone();
    b.light(kind, place);
    look_down(&mut b, 2.4);
    let film = render(&b.scene, &traced(24, 24, 1));
    let expected = |channel: usize, p: DVec3| {
        let to_lamp = (LAMP - p).normalize();
        let half = (to_lamp + DVec3::Z).normalize();
        let power = [50.0, 20.0, 10.0][channel] / (4.0 * PI * PI);
        let lit = to_lamp.dot(p);
        let highlight = if lit > 0.0 { 0.5 * half.dot(p).max(0.0).powf(exponent) } else { 0.0 };
        0.125 + 0.3 * [1.0, 0.5, 0.0][channel] + power * (0.2 * lit.max(0.0) + highlight)
    };
    for channel in 0..3 {
        // The highlight ends abruptly where the light does, within a pixel.
        let compared =
            assert_picture(&film, 2.4, channel, 1e-2, |x, y| on_sphere(x, y).map(|p| expected(channel, p)));
        assert!(compared > 250, "{compared}");
    }
}

#[test]
fn a_mirror_shows_a_patch_where_geometry_puts_it() {
    let mut b = Builder::new();
    let (glass, glow) = (mirror(&mut b, 0.75), glowing(&mut b, [1.0, 2.0, 4.0]));
    // Looking down at a mirror in the plane z = y + 1, which turns the view horizontally to -y. A patch in the plane
    // y = -3 spans x from -0.3 to 0.5 and z from 0.7 to 1.3: it is seen where y = z - 1.
    let tilt = at(0.0, 0.0, 1.0) * DAffine3::from_rotation_x(FRAC_PI_4);
    b.object(Shape::Plane, tilt, glass);
    let patch = Shape::Parallelogram { length: 0.6, axis: DVec3::new(0.4, 0.0, 0.0), scale_v: false };
    b.object(patch, at(0.1, -3.0, 0.7), glow);
    look_down(&mut b, 1.0);
    let expected = |x: f64, y: f64| {
        let z = y + 1.0;
        if x > -0.3 && x < 0.5 && z > 0.7 && z < 1.3 { 0.75 } else { 0.0 }
    };
    for depth in [1, 5] {
        // Edges of the patch are edges of pixels: no sample of this seed is rounded to the other side.
        let film = render(&b.scene, &RenderSettings { seed: 1, ..traced(20, 20, depth) });
        assert_eq!(film.rays(), 2 * film.samples(), "one ray to the mirror, one to the patch or beyond");
        for (channel, factor) in [1.0, 2.0, 4.0].into_iter().enumerate() {
            let compared = assert_picture(&film, 1.0, channel, 1e-5, |x, y| Some(factor * expected(x, y)));
            assert_eq!(compared, 400);
        }
    }
}

#[test]
fn what_a_mirror_shows_must_be_lit_within_the_depth() {
    let mut b = Builder::new();
    let (glass, white) = (mirror(&mut b, 1.0), b.diffuse([1.0; 3]));
    b.rectangle(DVec3::ZERO, (40.0, 40.0), true, glass);
    b.rectangle(DVec3::new(0.0, 0.0, 20.0), (40.0, 40.0), false, white);
    b.light(LightKind::Directional { irradiance: [PI; 3] }, DAffine3::IDENTITY);
    probe_down(&mut b, 0.0, 0.0, 5.0);
    // The beam goes up, through the mirror if it cast a shadow.
    b.scene.lights[0].shadowless = true;
    assert_near(mean(&render(&b.scene, &probed(1))), [0.0; 3], 0.0);
    assert_near(mean(&render(&b.scene, &probed(2))), [1.0; 3], 1e-5);
}

/// Reflectance of unpolarised light between air and glass.
fn fresnel(angle: f64) -> f64 {
    let inside = (angle.sin() / 1.5).asin();
    let across = ((angle - inside).sin() / (angle + inside).sin()).powi(2);
    let along = ((angle - inside).tan() / (angle + inside).tan()).powi(2);
    0.5 * (across + along)
}

#[test]
fn a_slab_of_glass_shifts_and_dims_what_is_behind_it() {
    let inside = (FRAC_PI_4.sin() / 1.5).asin();
    let shift = 0.2 * (FRAC_PI_4.tan() - inside.tan());
    for (edge, bright) in [(-0.004, true), (0.004, false)] {
        let mut b = Builder::new();
        let clear = b.scene.add_material(Material::Rgba { color: [0.0; 3], opacity: 0.0 });
        let glow = glowing(&mut b, [1.0; 3]);
        let slab = Shape::Box { width: 2000.0, height: 2000.0, length: 0.2 };
        b.object(slab, DAffine3::IDENTITY, clear).interior = Some(Interior { refractive_index: 1.5 });
        b.rectangle(DVec3::new(edge - shift + 5.0, 0.0, -1e-4), (10.0, 10.0), true, glow);
        b.look(DVec3::new(-10.0, 0.0, 10.0), DVec3::ZERO, DVec3::Z, 0.001);
        let film = render(&b.scene, &probed(2));
        let through = if bright { (1.0 - fresnel(FRAC_PI_4)).powi(2) } else { 0.0 };
        assert_near(mean(&film), [through; 3], 1e-4);
    }
}

#[test]
fn beyond_the_critical_angle_glass_is_a_mirror() {
    let mut b = Builder::new();
    let clear = b.scene.add_material(Material::Rgba { color: [0.0; 3], opacity: 0.0 });
    let glow = glowing(&mut b, [1.0; 3]);
    // Inside of a body, looking at its top under 60 degrees; what glows is at the bottom.
    let body = Shape::Box { width: 2000.0, height: 2000.0, length: 1.0 };
    b.object(body, DAffine3::IDENTITY, clear).interior = Some(Interior { refractive_index: 1.5 });
    b.rectangle(DVec3::new(0.0, 0.0, 0.1), (100.0, 100.0), true, glow);
    b.look(DVec3::new(0.0, 0.0, 0.5), DVec3::new(3f64.sqrt(), 0.0, 1.5), DVec3::Z, 0.001);
    assert_near(mean(&render(&b.scene, &probed(3))), [1.0; 3], 1e-5);
}

/// White ground under a lamp of 2 m x 2 m in a height of 4 m that looks down, seen at (x, 0).
fn under_a_lamp(x: f64, blocker: impl FnOnce(&mut Builder)) -> Rgb {
    let mut b = Builder::new();
    let (white, black) = (b.diffuse([1.0; 3]), b.diffuse([0.0; 3]));
    b.object(Shape::Plane, DAffine3::IDENTITY, white);
    b.rectangle(DVec3::new(0.0, 0.0, 4.0), (2.0, 2.0), false, black).emission =
        Some(Emission { power: [30.0; 3], exponent: 0.0, shadowless: false });
    blocker(&mut b);
    probe_down(&mut b, x, 0.0, 1.0);
    let settings = RenderSettings { shadow_samples: 191, ..traced(4, 4, 1) };
    mean(&render(&b.scene, &settings))
}

#[test]
fn the_edge_of_a_soft_shadow_has_the_share_of_the_lamp_that_is_seen() {
    for x in [-1.5, -1.0, -0.5, 0.0, 0.3, 0.9, 1.0, 1.5f64] {
        let open = under_a_lamp(x, |_| ())[0];
        // The lamp's middle under the angle a: intensity P / π · cos a, once more the cosine at the ground.
        let squared_cosine = 16.0 / (16.0 + x * x);
        assert!((open / (30.0 / PI / PI * squared_cosine) - 1.0).abs() < 1e-4, "{open} at {x}");
        // A half plane at half the height that ends at x = 0: of the lamp is seen what is right of -x.
        let half_hidden = under_a_lamp(x, |b| {
            let black = b.diffuse([0.0; 3]);
            b.rectangle(DVec3::new(-50.0, 0.0, 2.0), (100.0, 100.0), true, black);
        })[0];
        let share = (0.5 * (1.0 + x)).clamp(0.0, 1.0);
        // The 191 rays are stratified across the edge: the error is below one of them, and it averages out.
        assert!((half_hidden / open - share).abs() < 2e-3, "{} at {x}, expected {share}", half_hidden / open);
    }
}

#[test]
fn lamps_without_extent_throw_hard_shadows() {
    for kind in 0..3 {
        let brightness = |x: f64| {
            let mut b = Builder::new();
            let (white, black) = (b.diffuse([1.0; 3]), b.diffuse([0.0; 3]));
            b.object(Shape::Plane, DAffine3::IDENTITY, white);
            b.rectangle(DVec3::new(-50.0, 0.0, 2.0), (100.0, 100.0), true, black);
            let kind = match kind {
                0 => LightKind::Point { power: [30.0; 3] },
                1 => LightKind::Spot { power: [30.0; 3], inner_angle: 0.5, outer_angle: 0.6 },
                _ => LightKind::Directional { irradiance: [1.0; 3] },
            };
            b.light(kind, towards(DVec3::new(0.0, 0.0, 4.0), -DVec3::Z));
            probe_down(&mut b, x, 0.0, 1.0);
            mean(&render(&b.scene, &probed(1)))[0]
        };
        assert_eq!(brightness(-0.01), 0.0);
        assert!(brightness(0.01) > 0.1);
    }
}

#[test]
fn semi_transparent_sheets_colour_shadows() {
    let open = under_a_lamp(0.0, |_| ());
    let behind = |material: fn(&mut Builder) -> MaterialId| {
        let seen = under_a_lamp(0.0, |b| {
            let material = material(b);
            b.rectangle(DVec3::new(0.0, 0.0, 2.0), (9.0, 9.0), true, material);
        });
        [0, 1, 2].map(|c| seen[c] / open[c])
    };
    let veil = behind(|b| b.scene.add_material(Material::Rgba { color: [0.3, 0.9, 0.1], opacity: 0.25 }));
    assert_near(veil, [0.75; 3], 1e-4);
    let foil = behind(|b| {
        b.phong(|s| Phong {
            diffuse: grey(s, 0.4),
            transparency: Some(s.add_channel(Channel::Constant([1.0, 0.5, 0.0]))),
            ..Phong::default()
        })
    });
    assert_near(foil, [1.0, 0.5, 0.0], 1e-4);
    // A picture whose left half is cut out: half of the lamp's light passes on each side of the middle.
    let cut_out = behind(|b| {
        let image = b.scene.add_image(Image {
            name: "half".into(),
            width: 2,
            height: 1,
            pixels: vec![[255, 255, 255, 0], [255; 4]].into(),
            srgb: false,
        });
        b.phong(|s| Phong {
            diffuse: Some(s.add_channel(Channel::ImageMap { image, bilinear: false, coordinates: vec![] })),
            ..Phong::default()
        })
    });
    assert_near(cut_out, [0.5; 3], 2e-3);
    // A pane of glass is crossed twice; its shadow does not tell that it refracts.
    let mut glass = under_a_lamp(0.0, |b| {
        let pale = b.scene.add_material(Material::Rgba { color: [0.0; 3], opacity: 0.2 });
        let pane = Shape::Box { width: 9.0, height: 9.0, length: 0.1 };
        b.object(pane, at(0.0, 0.0, 2.0), pale).interior = Some(Interior { refractive_index: 1.5 });
    });
    for c in 0..3 {
        glass[c] /= open[c];
    }
    assert_near(glass, [0.64; 3], 1e-4);
}

#[test]
fn a_veil_is_split_without_noise() {
    let mut b = Builder::new();
    let veil = b.scene.add_material(Material::Rgba { color: [0.8, 0.4, 0.2], opacity: 0.25 });
    let glow = glowing(&mut b, [1.0; 3]);
    // More sheets than rays may wait; none of them costs depth.
    for i in 0..20 {
        b.rectangle(DVec3::new(0.0, 0.0, 0.1 * f64::from(i)), (40.0, 40.0), true, veil);
    }
    b.rectangle(DVec3::new(0.0, 0.0, -0.1), (40.0, 40.0), true, glow);
    b.light(LightKind::Directional { irradiance: [PI; 3] }, towards(DVec3::ZERO, -DVec3::Z));
    b.scene.lights[0].shadowless = true;
    probe_down(&mut b, 0.0, 0.0, 5.0);
    let film = render(&b.scene, &probed(1));
    // Of each sheet alpha times its colour is seen, through those above it; rays that carry less than 1/256 end.
    let followed = (0..20).take_while(|i| 0.75f64.powi(*i) >= 1.0 / 256.0).count() as i32;
    let sheets = 1.0 - 0.75f64.powi(followed);
    assert_near(mean(&film), [0.8, 0.4, 0.2].map(|color| color * sheets), 1e-5);
    assert!((0..16).all(|i| film.radiance(i % 4, i / 4) == film.radiance(0, 0)));
}

#[test]
fn a_leaf_shines_through_by_its_diffuse_transparency() {
    let mut b = Builder::new();
    let leaf = b.phong(|s| Phong {
        diffuse: grey(s, 0.5),
        diffuse_transparency: Some(s.add_channel(Channel::Constant([0.1, 0.4, 0.0]))),
        ..Phong::default()
    });
    b.rectangle(DVec3::ZERO, (4.0, 4.0), true, leaf);
    let from_below = DVec3::new(0.6, 0.0, 0.8);
    b.light(LightKind::Directional { irradiance: [PI; 3] }, towards(DVec3::ZERO, from_below));
    probe_down(&mut b, 0.0, 0.0, 5.0);
    assert_near(mean(&render(&b.scene, &probed(1))), [0.08, 0.32, 0.0], 1e-5);
}

#[test]
fn an_even_sky_gives_white_ground_its_own_radiance() {
    let mut b = Builder::new();
    let color = b.diffuse([1.0, 0.5, 0.25]);
    b.object(Shape::Plane, DAffine3::IDENTITY, color);
    b.sky([3.0; 3]);
    probe_down(&mut b, 0.0, 0.0, 5.0);
    assert_near(mean(&render(&b.scene, &probed(1))), [3.0, 1.5, 0.75], 1e-4);
}

#[test]
fn lamps_fade_only_as_their_attenuation_says() {
    let brightness = |height: f64, attenuation| {
        let mut b = Builder::new();
        let white = b.diffuse([1.0; 3]);
        b.object(Shape::Plane, DAffine3::IDENTITY, white);
        b.light(LightKind::Point { power: [4.0 * PI * PI; 3] }, at(0.0, 0.0, height));
        b.scene.lights[0].attenuation = attenuation;
        probe_down(&mut b, 0.0, 0.0, 0.5);
        mean(&render(&b.scene, &probed(1)))[0]
    };
    let fading = Attenuation { exponent: 2.0, distance: 3.0 };
    for (height, attenuation, expected) in [
        (1.0, Attenuation::default(), 1.0),
        (100.0, Attenuation::default(), 1.0),
        (3.0, fading, 1.0),
        (6.0, fading, 2.0 / 5.0),
        (30.0, fading, 2.0 / 101.0),
    ] {
        assert!((brightness(height, attenuation) - expected).abs() < 1e-4, "{height} {attenuation:?}");
    }
}

#[test]
fn the_background_is_seen_and_no_light() {
    let mut b = Builder::new();
    let (white, glass) = (b.diffuse([1.0; 3]), mirror(&mut b, 0.5));
    let background = [0.25, 0.5, 1.0];
    let shown = |b: &Builder, renderer| {
        let settings = RenderSettings { background, renderer, ..settings(4, 4, 4, 3) };
        mean(&render(&b.scene, &settings))
    };
    let seen = background.map(f64::from);
    b.light(LightKind::Point { power: [0.0; 3] }, at(0.0, 0.0, 9.0));
    for (object, factor) in [(None, 1.0), (Some(white), 0.0), (Some(glass), 0.5)] {
        b.scene.objects.clear();
        if let Some(material) = object {
            b.object(Shape::Plane, DAffine3::IDENTITY, material);
        }
        probe_down(&mut b, 0.0, 0.0, 5.0);
        for renderer in Renderer::ALL {
            assert_near(shown(&b, renderer), seen.map(|c| factor * c), 1e-6);
        }
    }
    b.scene.objects.clear();
    b.sky([2.0; 3]);
    for renderer in Renderer::ALL {
        assert_near(shown(&b, renderer), [2.0; 3], 1e-6);
    }
}

#[test]
fn the_tree_of_rays_stays_small_between_surfaces_that_gain_light() {
    let mut b = Builder::new();
    // Every surface sends on twice what it receives.
    let gain = b.phong(|s| Phong {
        diffuse: grey(s, 0.0),
        specular: grey(s, 1.0),
        shininess: grey(s, 1.0),
        transparency: grey(s, 1.0),
        interpolated_transparency: false,
        ..Phong::default()
    });
    let half = b.phong(|s| Phong {
        diffuse: grey(s, 0.0),
        specular: grey(s, 0.9),
        shininess: grey(s, 1.0),
        transparency: grey(s, 0.5),
        interpolated_transparency: false,
        ..Phong::default()
    });
    for i in 0..30 {
        let material = if i % 2 == 0 { gain } else { half };
        b.rectangle(DVec3::new(0.0, 0.0, 0.1 * f64::from(i)), (400.0, 400.0), true, material);
    }
    b.light(LightKind::Directional { irradiance: [1.0; 3] }, DAffine3::IDENTITY);
    b.sky([1.0; 3]);
    b.look(DVec3::new(0.0, -1.0, 5.0), DVec3::ZERO, DVec3::Z, 20.0);
    let film = render(&b.scene, &RenderSettings { samples: 1, ..probed(1000) });
    assert!(film.pixels.iter().all(|pixel| pixel.radiance.x.is_finite()));
    assert!(film.rays() <= 16 * 512 * 20, "{}", film.rays());
}

/// The garden under an area light, with a mirror, a glass ball and a shining Phong ball.
fn show() -> Scene {
    let mut b = Builder { scene: garden() };
    let glass = b.scene.add_material(Material::Rgba { color: [0.1; 3], opacity: 0.1 });
    let silver = mirror(&mut b, 0.8);
    let shiny = b.phong(|s| Phong {
        diffuse: Some(s.add_channel(Channel::Constant([0.6, 0.1, 0.1]))),
        specular: grey(s, 0.4),
        shininess: grey(s, 0.8),
        ambient: grey(s, 0.2),
        ..Phong::default()
    });
    let black = b.diffuse([0.0; 3]);
    b.scene.ambient = [2.0; 3];
    b.object(Shape::Sphere { radius: 0.4 }, at(-1.2, -1.2, 0.5), glass).interior =
        Some(Interior { refractive_index: 1.4 });
    b.object(Shape::Sphere { radius: 0.3 }, at(1.2, -1.6, 0.3), shiny);
    b.object(Shape::Sphere { radius: 0.5 }, at(0.3, 1.9, 0.5), silver);
    b.rectangle(DVec3::new(-1.0, 0.0, 4.0), (1.0, 1.0), false, black).emission =
        Some(Emission { power: [20.0; 3], exponent: 1.0, shadowless: false });
    let (kind, place) = three_lights()[1].clone();
    b.light(kind, place);
    b.scene
}

#[test]
fn both_devices_make_the_same_picture_and_twice_the_same() {
    let scene = show();
    let settings = RenderSettings {
        samples: 4,
        grid: 2,
        shadow_samples: 5,
        renderer: Renderer::RayTracer,
        background: [0.1, 0.2, 0.3],
        ..settings(64, 48, 1, 4)
    };
    let cpu = render(&scene, &settings);
    assert!(
        bytemuck::cast_slice::<_, u8>(&cpu.pixels)
            == bytemuck::cast_slice::<_, u8>(&render(&scene, &settings).pixels)
    );
    let slow = render_without_bvh(&scene, &settings);
    assert!(bytemuck::cast_slice::<_, u8>(&cpu.pixels) == bytemuck::cast_slice::<_, u8>(&slow.pixels));
    let Some(device) = gpu() else { return };
    let gpu = render_on(&device, &scene, &settings);
    assert!(
        bytemuck::cast_slice::<_, u8>(&gpu.pixels)
            == bytemuck::cast_slice::<_, u8>(&render_on(&device, &scene, &settings).pixels)
    );
    let scale = render::automatic_exposure(&cpu).exp2();
    let mut different = 0;
    for (a, b) in cpu.radiances().zip(gpu.radiances()) {
        let far = (0..3).any(|c| {
            let (a, b) = ((a[c] * scale).min(1.0), (b[c] * scale).min(1.0));
            (a - b).abs() > 1.0 / 255.0
        });
        different += usize::from(far);
    }
    // Where a ray just meets or misses an edge the devices may disagree.
    assert!(different * 100 <= cpu.pixels.len(), "{different} of {} pixels differ", cpu.pixels.len());
}
