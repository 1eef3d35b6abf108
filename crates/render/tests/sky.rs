//! Skies against closed forms and against the daylight model written down once more.
//!
//! Tolerances are five standard errors, predicted from the samples themselves, plus the rounding of 32-bit sums,
//! except where a comment says otherwise.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::access::Access;
use common::*;
use kernels::random::kernel::{independent_key, random4};
use kernels::records::kernel::LIGHT_SKY;
use kernels::sky::kernel::{sample_table, table_pdf, to_light_axes};
use render::compile;
use scene::{Channel, DAffine3, DVec3, Daylight, Image, Rgb, Scene, Shape, Sky, SkyRadiance};
use std::f64::consts::{FRAC_PI_2, PI};
use wgsl_rs::std::vec2f;

const ALBEDO: f64 = 0.5;

/// A grey ground seen from above.
fn ground(builder: &mut Builder) {
    let grey = builder.diffuse([ALBEDO; 3]);
    builder.object(Shape::Plane, at(0.0, 0.0, 0.0), grey);
    probe_down(builder, 0.0, 0.0, 0.3);
}

/// A sky with a picture of 8 x 8 pixels.
fn picture(builder: &mut Builder, factor: f64, turn: DAffine3, pixel: impl Fn(u32, u32) -> u8) {
    let pixels: Vec<[u8; 4]> = (0..64).map(|i| pixel(i % 8, i / 8)).map(|v| [v, v, v, 255]).collect();
    let image = Image { name: "sky".into(), width: 8, height: 8, pixels: pixels.into(), srgb: false };
    let image = builder.scene.add_image(image);
    let channel = Channel::ImageMap { image, bilinear: false, coordinates: vec![] };
    let channel = builder.scene.add_channel(channel);
    let radiance = SkyRadiance::Channel { channel, factor };
    builder.scene.sky = Some(Sky { radiance, world_from_sky: turn, origin: ORIGIN });
}

fn daylight(builder: &mut Builder, daylight: Daylight, turn: DAffine3) {
    let radiance = SkyRadiance::Daylight(daylight);
    builder.scene.sky = Some(Sky { radiance, world_from_sky: turn, origin: ORIGIN });
}

const MORNING: Daylight =
    Daylight { sun: DVec3::new(0.0, 1.0, 0.8), turbidity: 3.0, factor: 1.0, shines: true, has_sun: false };

/// Radiance seen when looking up into a direction.
fn seen(builder: &mut Builder, direction: DVec3) -> Rgb {
    builder.look(DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.0, 0.0, 1.0) + direction, DVec3::X, 0.01);
    mean_and_error(&render(&builder.scene, &settings(4, 4, 9, 1))).0
}

#[test]
fn an_even_picture_is_a_uniform_sky() {
    let mut b = Builder::new();
    ground(&mut b);
    picture(&mut b, 3.0, DAffine3::from_rotation_x(0.7), |_, _| 255);
    assert_mean(&render(&b.scene, &settings(32, 32, 64, 1)), [3.0 * ALBEDO; 3], 5.0);
    let looked = seen(&mut b, DVec3::new(0.3, 0.2, 0.9));
    assert!((looked[1] - 3.0).abs() < 1e-5, "{looked:?}");
}

#[test]
fn a_sky_with_one_bright_half_has_its_irradiance() {
    // Rows count from the top, which is the zenith; columns by the azimuth. A plane sees the bright half of the sphere
    // whole, not at all or cut in half.
    let upper = |_: u32, row: u32| if row < 4 { 255 } else { 0 };
    let side = |column: u32, _: u32| if column < 4 { 255 } else { 0 };
    let quarter = DAffine3::from_rotation_x(FRAC_PI_2);
    type Pixels<'a> = &'a dyn Fn(u32, u32) -> u8;
    let cases: [(Pixels, DAffine3, f64); 5] = [
        (&upper, DAffine3::IDENTITY, 1.0),
        (&upper, DAffine3::from_rotation_x(PI), 0.0),
        (&upper, quarter, 0.5),
        // Azimuths from 0 to 180 degrees: the half towards +y, which the quarter turn lifts to the zenith.
        (&side, DAffine3::IDENTITY, 0.5),
        (&side, quarter, 1.0),
    ];
    for (case, (pixel, turn, share)) in cases.into_iter().enumerate() {
        let mut b = Builder::new();
        ground(&mut b);
        picture(&mut b, 2.0, turn, pixel);
        let film = render(&b.scene, &settings(32, 32, 64, 1));
        let (mean, error) = mean_and_error(&film);
        let expected = 2.0 * ALBEDO * share;
        assert!((mean[0] - expected).abs() <= 5.0 * error[0] + 1e-5, "case {case}: {} {expected}", mean[0]);
    }
}

#[test]
fn a_small_bright_spot_is_found_also_behind_glossy_reflection() {
    // One pixel of the 64; the irradiance of its patch of the sky in closed form: rows by the angle from the zenith.
    let mut b = Builder::new();
    ground(&mut b);
    picture(&mut b, 100.0, DAffine3::IDENTITY, |column, row| u8::from((column, row) == (3, 1)) * 255);
    let step = PI / 8.0;
    let irradiance = 100.0 * (PI / 4.0) * 0.5 * ((2.0 * step).sin().powi(2) - step.sin().powi(2));
    let film = render(&b.scene, &settings(32, 32, 64, 1));
    assert_mean(&film, [irradiance * ALBEDO / PI; 3], 5.0);
    // The light is found: without a table most samples would miss it.
    let (mean, error) = mean_and_error(&film);
    assert!(error[0] < 0.005 * mean[0], "{} {}", mean[0], error[0]);

    // A mirror shows it, and a glossy plane reflects on the whole what it would of a directional light within the
    // roughness: here only that light sampling and finding it by reflection give the same.
    let mut wide = b.scene.clone();
    let glossy = scene::Phong {
        specular: grey(&mut wide, 0.8),
        shininess: grey(&mut wide, 0.6),
        diffuse: grey(&mut wide, 0.0),
        ..scene::Phong::default()
    };
    wide.materials[0] = scene::Material::Phong(glossy);
    let with_table = render(&wide, &settings(32, 32, 256, 1));
    // Stops the table from ever being used: then only reflected rays find the sky.
    let reflected_only = render_without_light_sampling(&wide, &settings(32, 32, 256, 1));
    let ((a, ea), (b, eb)) = (mean_and_error(&with_table), mean_and_error(&reflected_only));
    assert!((a[0] - b[0]).abs() <= 5.0 * ea[0].hypot(eb[0]), "{} {} {} {}", a[0], b[0], ea[0], eb[0]);
    assert!(a[0] > 20.0 * ea[0]);
}

/// The same picture with a sky that is found by scattered rays alone: its probability is next to nothing, so that
/// the weights of the light samples, where one is taken, are, too.
fn render_without_light_sampling(scene: &Scene, settings: &render::RenderSettings) -> render::Film {
    let mut compiled = compile(scene).unwrap();
    compiled.lights[0].importance *= 1e-12;
    // A black light takes the choices.
    let black = kernels::records::kernel::LightRecord {
        kind: LIGHT_SKY,
        importance: 1.0,
        emission: wgsl_rs::std::vec3f(0.0, 0.0, 0.0),
        ..compiled.lights[0]
    };
    compiled.lights.insert(1, black);
    compiled.header.lights += 1;
    compiled.header.distant_lights += 1;
    let device = render::open_device(render::DeviceChoice::Cpu, None).unwrap();
    device.load(std::sync::Arc::new(compiled)).unwrap().render(settings, &go_on).unwrap()
}

#[test]
fn weighting_by_both_strategies_does_not_change_the_mean() {
    let mut b = Builder::new();
    ground(&mut b);
    daylight(&mut b, MORNING, DAffine3::IDENTITY);
    let both = render(&b.scene, &settings(32, 32, 128, 1));
    let reflected_only = render_without_light_sampling(&b.scene, &settings(32, 32, 128, 1));
    let ((a, ea), (b, eb)) = (mean_and_error(&both), mean_and_error(&reflected_only));
    for c in 0..3 {
        assert!((a[c] - b[c]).abs() <= 5.0 * ea[c].hypot(eb[c]), "{a:?} {b:?}");
    }
}

#[test]
fn directions_follow_the_density_of_the_table() {
    let mut b = Builder::new();
    ground(&mut b);
    daylight(&mut b, MORNING, DAffine3::from_rotation_x(0.4));
    let compiled = compile(&b.scene).unwrap();
    let (access, light) = (Access(&compiled), compiled.lights[0]);
    // Bins of equal solid angle: 8 by height, 16 by azimuth.
    let bin = |d| {
        let local = to_light_axes(light, d);
        let row = ((0.5 * (1.0 - local.z)) * 8.0).clamp(0.0, 7.0) as usize;
        let turn = (local.y.atan2(local.x) / std::f32::consts::TAU).rem_euclid(1.0);
        row * 16 + ((turn * 16.0) as usize).min(15)
    };
    let n = 200_000u32;
    let mut counts = [0f64; 128];
    let mut expected = [0f64; 128];
    for i in 0..n {
        let r = random4(independent_key(i, 0, 5), 0);
        let drawn = sample_table(access, light, vec2f(r.x, r.y));
        counts[bin(drawn.direction)] += 1.0;
        let found = table_pdf(access, light, drawn.direction);
        // Rounding may put a direction at the edge of a cell into the next one.
        if i % 100 == 0 {
            assert!((found / drawn.pdf - 1.0).abs() < 0.5, "{found} {}", drawn.pdf);
        }
    }
    // The density over a grid that is finer than the table's cells.
    let (rows, columns) = (512, 1024);
    let mut total = 0.0;
    for row in 0..rows {
        for column in 0..columns {
            let z = 1.0 - 2.0 * (row as f32 + 0.5) / rows as f32;
            let local = kernels::warp::kernel::polar_direction(z, (column as f32 + 0.5) / columns as f32);
            let d = kernels::sky::kernel::out_of_light_axes(light, local);
            let p = f64::from(table_pdf(access, light, d)) * 4.0 * PI / f64::from(rows * columns);
            expected[bin(d)] += p * f64::from(n);
            total += p;
        }
    }
    assert!((total - 1.0).abs() < 1e-3, "{total}");
    let mut chi2 = 0.0;
    let mut used = 0.0;
    for (count, expected) in counts.iter().zip(expected) {
        if expected > 5.0 {
            chi2 += (count - expected) * (count - expected) / expected;
            used += 1.0;
        } else {
            assert_eq!(*count, 0.0, "{expected}");
        }
    }
    assert!(used == 64.0 && chi2 < used + 5.0 * (2.0f64 * used).sqrt(), "{chi2} of {used}");
}

/// Luminance in kcd/m², x and y of Preetham's sky: the appendix of the paper, written down again.
fn preetham(t: f64, sun_angle: f64, angle: f64, gamma: f64) -> [f64; 3] {
    let f = |k: [f64; 10], theta: f64, gamma: f64| {
        let [a, b, c, d, e] = [0, 2, 4, 6, 8].map(|i| k[i] * t + k[i + 1]);
        (1.0 + a * (b / theta.cos()).exp()) * (1.0 + c * (d * gamma).exp() + e * gamma.cos() * gamma.cos())
    };
    let luminance =
        [0.17872, -1.46303, -0.3554, 0.42749, -0.02266, 5.32505, 0.12064, -2.57705, -0.06696, 0.37027];
    let x = [-0.01925, -0.25922, -0.06651, 0.00081, -0.00041, 0.21247, -0.06409, -0.89887, -0.00325, 0.04517];
    let y = [-0.01669, -0.26078, -0.09495, 0.00921, -0.00792, 0.21023, -0.04405, -1.65369, -0.01092, 0.05291];
    let s = sun_angle;
    let powers = [s.powi(3), s.powi(2), s, 1.0];
    let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * s);
    let zenith_luminance = (4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192;
    let chromaticity = |m: [[f64; 4]; 3]| {
        m.iter()
            .zip([t * t, t, 1.0])
            .map(|(k, t)| t * k.iter().zip(powers).map(|(k, p)| k * p).sum::<f64>())
            .sum::<f64>()
    };
    let zenith_x = chromaticity([
        [0.00166, -0.00375, 0.00209, 0.0],
        [-0.02903, 0.06377, -0.03202, 0.00394],
        [0.11693, -0.21196, 0.06052, 0.25886],
    ]);
    let zenith_y = chromaticity([
        [0.00275, -0.00610, 0.00317, 0.0],
        [-0.04214, 0.08970, -0.04153, 0.00516],
        [0.15346, -0.26756, 0.06670, 0.26688],
    ]);
    let ratio = |k| f(k, angle, gamma) / f(k, 0.0, s);
    [zenith_luminance * ratio(luminance), zenith_x * ratio(x), zenith_y * ratio(y)]
}

/// Luminance in kcd/m² and chromaticity of a radiance.
fn luminance_and_chromaticity([r, g, b]: Rgb) -> [f64; 3] {
    // sRGB's primaries, IEC 61966-2-1.
    let x = 0.4124564 * r + 0.3575761 * g + 0.1804375 * b;
    let y = 0.2126729 * r + 0.7151522 * g + 0.0721750 * b;
    let z = 0.0193339 * r + 0.1191920 * g + 0.9503041 * b;
    [y * 0.683002, x / (x + y + z), y / (x + y + z)]
}

#[test]
fn the_clear_sky_is_preethams() {
    for (turbidity, sun) in
        [(2.0, DVec3::new(0.0, 1.0, 1.5)), (3.0, DVec3::new(1.0, 1.0, 0.5)), (6.0, DVec3::new(0.0, 1.0, 0.4))]
    {
        let mut b = Builder::new();
        let white = b.diffuse([1.0; 3]);
        b.object(Shape::Sphere { radius: 0.1 }, at(0.0, 0.0, 0.0), white);
        daylight(&mut b, Daylight { sun, turbidity, ..MORNING }, DAffine3::IDENTITY);
        let sun = sun.normalize();
        for direction in
            [DVec3::Z, DVec3::new(0.5, -0.5, 1.0), DVec3::new(-1.0, 0.2, 0.2), DVec3::new(0.1, 0.8, 0.5)]
        {
            let direction = direction.normalize();
            let found = luminance_and_chromaticity(seen(&mut b, direction));
            let gamma = direction.dot(sun).acos();
            let expected = preetham(turbidity, sun.z.acos(), direction.z.acos(), gamma);
            for c in 0..3 {
                // The picture is 0.01 rad wide, over which the sky varies a little.
                assert!((found[c] / expected[c] - 1.0).abs() < 2e-3, "{direction}: {found:?} {expected:?}");
            }
        }
        assert_eq!(seen(&mut b, DVec3::new(0.3, 0.0, -0.2)), [0.0; 3]);
    }
}

#[test]
fn a_turned_sky_is_seen_and_shines_from_the_same_side() {
    let turn = DAffine3::from_rotation_x(0.9);
    let direction = DVec3::new(0.2, 0.1, 0.9).normalize();
    let mut b = Builder::new();
    let white = b.diffuse([1.0; 3]);
    b.object(Shape::Sphere { radius: 0.1 }, at(0.0, 0.0, 0.0), white);
    daylight(&mut b, MORNING, DAffine3::IDENTITY);
    let plain = seen(&mut b, direction);
    daylight(&mut b, MORNING, turn);
    let turned = seen(&mut b, turn.transform_vector3(direction));
    for c in 0..3 {
        assert!((plain[c] / turned[c] - 1.0).abs() < 2e-3, "{plain:?} {turned:?}");
    }
    // A plane that is turned with the sky is as bright as before; the ground of the room is not.
    let irradiance = |turn: DAffine3, plane: DAffine3| {
        let mut b = Builder::new();
        let grey = b.diffuse([ALBEDO; 3]);
        b.object(Shape::Plane, plane, grey);
        daylight(&mut b, MORNING, turn);
        let up = plane.transform_vector3(DVec3::Z);
        b.look(up * 0.3, DVec3::ZERO, DVec3::X, 0.05);
        mean_and_error(&render(&b.scene, &settings(32, 32, 64, 1)))
    };
    let (a, ea) = irradiance(DAffine3::IDENTITY, DAffine3::IDENTITY);
    let (b, eb) = irradiance(turn, turn);
    assert!((a[1] - b[1]).abs() <= 5.0 * ea[1].hypot(eb[1]), "{a:?} {b:?}");
    let (c, ec) = irradiance(turn, DAffine3::IDENTITY);
    assert!((a[1] - c[1]).abs() > 20.0 * ea[1].hypot(ec[1]), "{a:?} {c:?}");
}

#[test]
fn the_ground_receives_the_integral_of_the_clear_sky() {
    let sun = MORNING.sun.normalize();
    let mut luminous = 0.0;
    let (rows, columns) = (400, 800);
    for i in 0..rows {
        let angle = FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(rows);
        for j in 0..columns {
            let azimuth = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(columns);
            let d = DVec3::new(angle.sin() * azimuth.cos(), angle.sin() * azimuth.sin(), angle.cos());
            let [luminance, ..] = preetham(MORNING.turbidity, sun.z.acos(), angle, d.dot(sun).acos());
            luminous += luminance * angle.cos() * angle.sin();
        }
    }
    let klux = luminous * FRAC_PI_2 / f64::from(rows) * 2.0 * PI / f64::from(columns);
    let mut b = Builder::new();
    ground(&mut b);
    daylight(&mut b, MORNING, DAffine3::IDENTITY);
    let film = render(&b.scene, &settings(48, 48, 128, 1));
    let (mean, error) = mean_and_error(&film);
    let found = luminance_and_chromaticity(mean)[0] * PI / ALBEDO;
    // The channels err together; the relative error of green is that of the luminance.
    let tolerance = 5.0 * error[1] / mean[1] + 1e-4;
    assert!((found / klux - 1.0).abs() < tolerance, "{found} klx, expected {klux}");
    assert!(tolerance < 0.01, "{tolerance}");
}

#[test]
fn the_sun_gives_its_radiance_times_solid_angle_times_cosine() {
    for turn in [DAffine3::IDENTITY, DAffine3::from_rotation_x(-0.3)] {
        let mut b = Builder::new();
        ground(&mut b);
        // A dark sky round it: the factor acts on both, so the difference to the same sky without sun is the sun.
        let mut light = |has_sun: bool| {
            daylight(&mut b, Daylight { has_sun, ..MORNING }, turn);
            probe_down(&mut b, 0.0, 0.0, 0.3);
            mean_and_error(&render(&b.scene, &settings(32, 32, 256, 1)))
        };
        let ((lit, lit_error), (dim, dim_error)) = (light(true), light(false));
        let towards = turn.transform_vector3(MORNING.sun.normalize());
        daylight(&mut b, Daylight { has_sun: true, ..MORNING }, turn);
        let disc = seen_small(&mut b, towards);
        daylight(&mut b, MORNING, turn);
        let halo = seen_small(&mut b, towards);
        let half_angle = 16.0 / 60.0 * PI / 180.0;
        let solid_angle = 2.0 * PI * (1.0 - f64::cos(half_angle));
        for c in 0..3 {
            let sun = disc[c] - halo[c];
            assert!(sun > 1000.0 * halo[c]);
            let expected = sun * solid_angle * towards.z * ALBEDO / PI;
            let tolerance = 5.0 * lit_error[c].hypot(dim_error[c]) + 2e-4 * expected;
            assert!((lit[c] - dim[c] - expected).abs() < tolerance, "{} {expected}", lit[c] - dim[c]);
            assert!(tolerance < 0.01 * expected, "{tolerance} {expected}");
        }
    }
}

/// The middle of the sun's disc.
fn seen_small(builder: &mut Builder, direction: DVec3) -> Rgb {
    let eye = DVec3::new(0.0, 0.0, 1.0);
    builder.look(eye, eye + direction, DVec3::X, 1e-3);
    mean_and_error(&render(&builder.scene, &settings(4, 4, 9, 1))).0
}

#[test]
fn the_disc_of_the_sun_has_its_size() {
    // The mean over a picture that holds the whole disc.
    let mut b = Builder::new();
    let white = b.diffuse([1.0; 3]);
    b.object(Shape::Sphere { radius: 0.1 }, at(0.0, 0.0, 0.0), white);
    daylight(&mut b, Daylight { has_sun: true, ..MORNING }, DAffine3::IDENTITY);
    let towards = MORNING.sun.normalize();
    let disc = seen_small(&mut b, towards);
    let eye = DVec3::new(0.0, 0.0, 1.0);
    let degrees = 1.0f64;
    b.look(eye, eye + towards, DVec3::X, degrees);
    let film = render(&b.scene, &settings(64, 64, 36, 1));
    let (mean, error) = mean_and_error(&film);
    let radius = 16.0f64 / 60.0;
    let expected = disc[1] * PI * radius * radius / (degrees * degrees);
    // The sky beside it adds a thousandth.
    assert!((mean[1] - expected).abs() < 5.0 * error[1] + 3e-3 * expected, "{} {expected}", mean[1]);
}

#[test]
fn a_sky_that_does_not_shine_is_only_seen() {
    let mut b = Builder::new();
    ground(&mut b);
    daylight(&mut b, Daylight { shines: false, has_sun: true, ..MORNING }, DAffine3::IDENTITY);
    assert_mean(&render(&b.scene, &settings(16, 16, 64, 3)), [0.0; 3], 5.0);
    assert!(seen(&mut b, DVec3::Z)[2] > 1.0);
}

#[test]
fn daylight_is_the_same_picture_on_both_devices() {
    let Some(gpu) = gpu() else { return };
    let mut b = Builder::new();
    let grey = b.diffuse([0.5, 0.4, 0.3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), grey);
    b.object(Shape::Sphere { radius: 0.5 }, at(0.0, 0.0, 0.5), grey);
    b.look(DVec3::new(0.0, -5.0, 1.5), DVec3::new(0.0, 0.0, 0.8), DVec3::Z, 60.0);
    daylight(&mut b, Daylight { has_sun: true, ..MORNING }, DAffine3::from_rotation_z(0.3));
    let day = b.scene.clone();
    picture(&mut b, 2.0, DAffine3::IDENTITY, |column, row| (column * 31 + row * 4) as u8);
    for scene in [day, b.scene] {
        let settings = settings(40, 30, 32, 2);
        let (cpu, gpu) = (render(&scene, &settings), render_on(&gpu, &scene, &settings));
        let ((a, ea), (b, eb)) = (mean_and_error(&cpu), mean_and_error(&gpu));
        for c in 0..3 {
            assert!((a[c] - b[c]).abs() < 5.0 * ea[c].hypot(eb[c]), "{a:?} {b:?}");
        }
        let far =
            cpu.radiances().zip(gpu.radiances()).filter(|(a, b)| (a[1] - b[1]).abs() > 2e-3 * a[1].abs());
        let different = far.count();
        assert!(different * 10 < cpu.pixels.len(), "{different} pixels differ");
    }
}
