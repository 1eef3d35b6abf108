//! Channel maps against their definitions, on both devices: a plane glows in the colours of a map.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::*;
use render::{CompileError, DeviceChoice, compile, open_device};
use scene::{Channel, ChannelId, CoordinateMap, DMat2, DVec2, DVec3, Image, Phong, Rgb, Scene, Shape};

const WIDTH: f64 = 4.0;
const PIXELS: u32 = 64;

/// Renders the square [-2, 2]² of a plane, whose u and v are x and y, and compares every pixel over which the
/// expected colour is constant.
fn assert_map(build: impl FnOnce(&mut Scene) -> ChannelId, expected: impl Fn(DVec2) -> Rgb) {
    let mut b = Builder::new();
    let glowing = b.phong(|s| Phong { emissive: Some(build(s)), ..Phong::default() });
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), glowing);
    b.look(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, 50.0);
    b.scene.camera.projection = PARALLEL(WIDTH);
    let cpu = open_device(DeviceChoice::Cpu, None).unwrap();
    let mut films = vec![render_on(cpu.as_ref(), &b.scene, &settings(PIXELS, PIXELS, 2, 1))];
    if let Some(gpu) = gpu() {
        films.push(render_on(&gpu, &b.scene, &settings(PIXELS, PIXELS, 2, 1)));
    }
    for film in films {
        let mut compared = 0;
        for (x, y) in (0..PIXELS).flat_map(|y| (0..PIXELS).map(move |x| (x, y))) {
            // The corners of the pixel, a little wider for rounding.
            let corner = |dx: f64, dy: f64| {
                let part = |p: u32, d: f64| (f64::from(p) + 0.5 + 0.51 * d) / f64::from(PIXELS) - 0.5;
                expected(DVec2::new(part(x, dx), -part(y, dy)) * WIDTH)
            };
            let colors = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0)];
            if colors.iter().any(|c| *c != colors[0]) {
                continue;
            }
            compared += 1;
            for c in 0..3 {
                let found = f64::from(film.radiance(x, y)[c]);
                assert!((found - colors[0][c]).abs() < 1e-5, "({x}, {y}): {found} is not {:?}", colors[0]);
            }
        }
        assert!(compared > PIXELS * PIXELS / 4, "only {compared} pixels could be compared");
    }
}

/// `AffineUVTransformation` as the formulae of its fields state it.
struct Affine {
    offset: (f64, f64),
    scale: (f64, f64),
    angle: f64,
    shear: f64,
}

impl Affine {
    fn apply(&self, p: DVec2) -> DVec2 {
        let (du, dv) = (p.x - self.offset.0, p.y - self.offset.1);
        let a = self.angle.cos() * du + self.angle.sin() * dv;
        let b = -self.angle.sin() * du + self.angle.cos() * dv;
        DVec2::new(self.scale.0 * a - self.shear * self.scale.1 * b, self.scale.1 * b)
    }

    fn map(&self) -> CoordinateMap {
        // The columns are the images of the unit vectors.
        let image = |p: DVec2| self.apply(p) - self.apply(DVec2::ZERO);
        CoordinateMap::AffineUv {
            offset: DVec2::new(self.offset.0, self.offset.1),
            linear: DMat2::from_cols(image(DVec2::X), image(DVec2::Y)),
        }
    }
}

const TURNED: Affine = Affine { offset: (0.3, -0.2), scale: (0.5, 0.7), angle: 0.6, shear: 0.4 };
const WIDE: Affine = Affine { offset: (0.1, 0.0), scale: (0.4, 0.3), angle: -0.2, shear: 0.0 };

fn checker(p: DVec2, odd: Rgb, even: Rgb) -> Rgb {
    let parity = ((2.0 * p.x).floor() as i64 ^ (2.0 * p.y).floor() as i64) & 1;
    if parity == 0 { even } else { odd }
}

const RED: Rgb = [0.75, 0.25, 0.125];
const BLUE: Rgb = [0.125, 0.25, 0.5];
const GREEN: Rgb = [0.25, 1.0, 0.25];

fn picture(scene: &mut Scene) -> scene::ImageId {
    let pixels = vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 0, 255]];
    scene.add_image(Image { name: "four".into(), width: 2, height: 2, pixels: pixels.into(), srgb: false })
}

/// The upper row of the picture is at v = 1.
fn picture_at(p: DVec2) -> Rgb {
    let left = p.x - p.x.floor() < 0.5;
    let lower = p.y - p.y.floor() < 0.5;
    match (lower, left) {
        (false, true) => [1.0, 0.0, 0.0],
        (false, false) => [0.0, 1.0, 0.0],
        (true, true) => [0.0, 0.0, 1.0],
        (true, false) => [1.0, 1.0, 0.0],
    }
}

#[test]
fn a_checkerboard_has_its_second_colour_at_the_origin() {
    assert_eq!(checker(DVec2::splat(0.1), RED, BLUE), BLUE);
    let build = |s: &mut Scene| {
        let odd = s.add_channel(Channel::Constant(RED));
        let even = s.add_channel(Channel::Constant(BLUE));
        s.add_channel(Channel::Checker { odd, even, coordinates: vec![] })
    };
    assert_map(build, |p| checker(p, RED, BLUE));
}

#[test]
fn a_chain_of_transformations_moves_a_picture() {
    let build = |s: &mut Scene| {
        let image = picture(s);
        let coordinates = vec![TURNED.map(), WIDE.map()];
        s.add_channel(Channel::ImageMap { image, bilinear: false, coordinates })
    };
    assert_map(build, |p| picture_at(WIDE.apply(TURNED.apply(p))));
}

#[test]
fn pictures_in_srgb_become_linear_when_they_are_looked_up() {
    let pixels = vec![[255u8, 188, 10, 255]; 4];
    let linear = |byte: f64| match byte / 255.0 {
        value if value <= 0.04045 => value / 12.92,
        value => ((value + 0.055) / 1.055f64).powf(2.4),
    };
    assert_map(
        |scene| {
            let image =
                Image { name: "photograph".into(), width: 2, height: 2, pixels: pixels.into(), srgb: true };
            let image = scene.add_image(image);
            scene.add_channel(Channel::ImageMap { image, bilinear: true, coordinates: vec![] })
        },
        |_| [255.0, 188.0, 10.0].map(linear),
    );
}

#[test]
fn fields_of_a_transformed_checkerboard_see_the_surface() {
    let build = |s: &mut Scene| {
        let image = picture(s);
        let odd = s.add_channel(Channel::ImageMap { image, bilinear: false, coordinates: vec![WIDE.map()] });
        let red = s.add_channel(Channel::Constant(RED));
        let green = s.add_channel(Channel::Constant(GREEN));
        let even = s.add_channel(Channel::Checker { odd: red, even: green, coordinates: vec![] });
        s.add_channel(Channel::Checker { odd, even, coordinates: vec![TURNED.map()] })
    };
    assert_map(build, |p| checker(TURNED.apply(p), picture_at(WIDE.apply(p)), checker(p, RED, GREEN)));
}

#[test]
fn nesting_is_not_limited_and_shared_parts_are_compiled_once() {
    let mut scene = Scene::default();
    let mut last = scene.add_channel(Channel::Constant(RED));
    for _ in 0..1000 {
        last = scene.add_channel(Channel::Checker { odd: last, even: last, coordinates: vec![] });
    }
    scene.camera = scene::Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0);
    assert_eq!(compile(&scene).unwrap().channels.len(), 1001);
    let build = |s: &mut Scene| {
        s.channels = scene.channels.clone();
        last
    };
    assert_map(build, |_| RED);
}

#[test]
fn a_channel_that_refers_to_itself_is_an_error() {
    let mut scene = Scene::default();
    scene.camera = scene::Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0);
    let myself = ChannelId(0);
    scene.add_channel(Channel::Checker { odd: myself, even: myself, coordinates: vec![] });
    assert!(matches!(compile(&scene), Err(CompileError::ChannelOrder { channel: 0 })));
}
