//! Every channel map against an independent formula, on both devices: a picture of many small bodies, each of which
//! glows in the colour of one map. A pixel must lie between the least and the greatest value that the formula has
//! inside of it.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::*;
use render::{DeviceChoice, open_device};
use scene::{
    BlendItem, Channel, ChannelId, CoordinateMap, DAffine3, DVec2, DVec3, LightKind, Mesh, NeighbourFilter,
    NormalMap, Phong, Scene, Shape, VisibleSides, VolumeFunction, WaveForm, WaveStep,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::rc::Rc;

/// What a map looks at.
#[derive(Clone, Copy)]
struct Point {
    uv: DVec2,
    local: DVec3,
    world: DVec3,
}

type Reference = Rc<dyn Fn(Point) -> f64>;

/// Tiles per row, their size in metres and in pixels.
const COLUMNS: usize = 9;
const TILE: f64 = 2.0;
const PIXELS: u32 = 8;
/// The picture is far from the origin of the world.
const OFFSET: DVec3 = DVec3::new(13.0, -7.0, 5.0);

struct Picture {
    builder: Builder,
    /// Value at a point, given relative to the middle of the tile; `None` where nothing is compared.
    expected: Vec<Box<dyn Fn(DVec2) -> Option<f64>>>,
    names: Vec<String>,
}

impl Picture {
    fn middle(&self) -> DVec3 {
        let number = self.expected.len();
        OFFSET + DVec3::new((number % COLUMNS) as f64, -((number / COLUMNS) as f64), 0.0) * TILE
    }

    fn glowing(&mut self, map: ChannelId) -> scene::MaterialId {
        let scene = &mut self.builder.scene;
        let diffuse = grey(scene, 0.0);
        let phong = Phong { diffuse, emissive: Some(map), ..Phong::default() };
        self.builder.phong(|_| phong)
    }

    fn scene(&mut self) -> &mut Scene {
        &mut self.builder.scene
    }

    /// A slanted parallelogram, 4 by 4 in its own frame, seen as the whole tile.
    fn tile(&mut self, name: &str, map: ChannelId, reference: &Reference) {
        let material = self.glowing(map);
        let middle = self.middle();
        let shape = Shape::Parallelogram { length: 4.0, axis: DVec3::new(2.0, 1.0, 0.0), scale_v: false };
        let turn = DAffine3::from_rotation_x(-FRAC_PI_2) * DAffine3::from_scale(DVec3::splat(0.5));
        // Local z runs along world y.
        let world = DAffine3::from_translation(middle - DVec3::new(0.0, 1.0, 0.0)) * turn;
        self.builder.object(shape, world, material);
        let reference = reference.clone();
        self.names.push(name.to_owned());
        self.expected.push(Box::new(move |p| {
            let local = DVec3::new(2.0 * p.x, p.x, 2.0 * (p.y + 1.0));
            let world = world.transform_point3(local);
            let uv = DVec2::new(0.5 * p.x + 0.5, 0.5 * (p.y + 1.0));
            Some(reference(Point { uv, local, world }))
        }));
    }

    /// A body whose own frame is that of the tile; `height` is z of its upper side.
    fn body(&mut self, name: &str, shape: Shape, height: impl Fn(DVec2) -> Option<f64> + 'static) {
        let direction = DVec3::new(0.1, 0.2, 0.3);
        let map = self.scene().add_channel(Channel::Volume {
            function: VolumeFunction::Gradient { direction },
            wave: vec![WaveStep::Linear { factor: 1.0, shift: 0.6 }],
            coordinates: vec![],
        });
        let material = self.glowing(map);
        let world = DAffine3::from_translation(self.middle());
        self.builder.object(shape, world, material);
        self.names.push(name.to_owned());
        self.expected
            .push(Box::new(move |p| height(p).map(|z| direction.dot(DVec3::new(p.x, p.y, z)) + 0.6)));
    }

    /// Renders on both devices and compares.
    fn check(mut self) {
        let rows = self.expected.len().div_ceil(COLUMNS);
        let tiles = COLUMNS.max(rows);
        let half = DVec3::new((tiles - 1) as f64, -((tiles - 1) as f64), 0.0) * (0.5 * TILE);
        let centre = OFFSET + half;
        self.builder.look(centre + DVec3::Z * 20.0, centre, DVec3::Y, 50.0);
        self.builder.scene.camera.projection = PARALLEL(tiles as f64 * TILE);
        let edge = tiles as u32 * PIXELS;
        let cpu = open_device(DeviceChoice::Cpu, None).unwrap();
        let settings = settings(edge, edge, 4, 1);
        let mut films = vec![("CPU", render_on(cpu.as_ref(), &self.builder.scene, &settings))];
        if let Some(gpu) = gpu() {
            films.push(("GPU", render_on(&gpu, &self.builder.scene, &settings)));
        }
        let mut wrong = Vec::new();
        for (number, expected) in self.expected.iter().enumerate() {
            let name = &self.names[number];
            let (column, row) = ((number % COLUMNS) as u32, (number / COLUMNS) as u32);
            let mut compared = 0;
            for (x, y) in (0..PIXELS).flat_map(|y| (0..PIXELS).map(move |x| (x, y))) {
                const PARTS: i32 = 8;
                let mut low = f64::INFINITY;
                let mut high = f64::NEG_INFINITY;
                let mut whole = true;
                for (i, j) in (0..=PARTS).flat_map(|j| (0..=PARTS).map(move |i| (i, j))) {
                    let part = |p: u32, i: i32| {
                        (f64::from(p) + f64::from(i) / f64::from(PARTS)) / f64::from(PIXELS) - 0.5
                    };
                    match expected(DVec2::new(part(x, i), -part(y, j)) * TILE) {
                        Some(value) => {
                            low = low.min(value.max(0.0));
                            high = high.max(value.max(0.0));
                        }
                        None => whole = false,
                    }
                }
                // A function that changes by so much has a pole in the pixel or beside it.
                if !whole || high - low > 3.0 {
                    continue;
                }
                compared += 1;
                for (device, film) in &films {
                    let found = f64::from(film.radiance(column * PIXELS + x, row * PIXELS + y)[0]);
                    // Between the points of the grid a function goes a little beyond, and floats are rounded.
                    let tolerance = 0.15 * (high - low) + 2e-4 * (1.0 + high.abs());
                    if found < low - tolerance || found > high + tolerance {
                        wrong.push(format!("{device}, {name} ({x}, {y}): {found} not in {low}..{high}"));
                    }
                }
            }
            assert!(compared > 8, "{name}: only {compared} pixels could be compared");
        }
        assert!(
            wrong.is_empty(),
            "{} pixels are wrong:\n{}",
            wrong.len(),
            wrong[..wrong.len().min(20)].join("\n")
        );
    }
}

/// GroIMP's noise from its description, with java.util.Random's recurrence written out.
struct Noise {
    permutation: Vec<usize>,
    values: Vec<f64>,
}

impl Noise {
    fn new() -> Self {
        let mut state: u64 = 123_456_789 ^ 0x5_DEEC_E66D;
        let mut next = |bits: u32| {
            state = (state.wrapping_mul(0x5_DEEC_E66D) + 11) % (1 << 48);
            state >> (48 - bits)
        };
        let mut permutation: Vec<usize> = (0..65536).collect();
        for i in 0..65536 {
            permutation.swap(i, (next(31) >> 15) as usize);
        }
        let values = (0..512).map(|_| 2.0 * next(24) as f64 / 16_777_216.0 - 1.0).collect();
        Noise { permutation, values }
    }

    fn sum(&self, p: DVec3, skip: usize) -> f64 {
        let cell = p.floor();
        let mut sum = 0.0;
        for corner in 0..8 {
            let c = DVec3::new(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2));
            let d = p - cell;
            let s = d * d * (DVec3::splat(3.0) - 2.0 * d);
            let weights = c * s + (DVec3::ONE - c) * (DVec3::ONE - s);
            let at = (cell + c).to_array().map(|x| (x as i64).rem_euclid(65536) as usize);
            let hash = |a: usize, b: usize| self.permutation[self.permutation[a] ^ b];
            let m = self.permutation[hash(at[0], at[1]) ^ at[2]] + skip;
            let r = |k: usize| self.values[(m + k) & 511];
            let slope = DVec3::new(r(1), r(2), r(3)).dot(d - c);
            sum += weights.x * weights.y * weights.z * (0.5 * r(0) + slope);
        }
        sum
    }

    fn noise(&self, p: DVec3) -> f64 {
        (2.0 * self.sum(p, 0)).clamp(-1.0, 1.0)
    }

    fn vector(&self, p: DVec3, octaves: i32, lambda: f64, omega: f64) -> DVec3 {
        let octave = |k: i32| {
            let q = p * lambda.powi(k);
            DVec3::new(self.sum(q, 0), self.sum(q, 8), self.sum(q, 16)) * omega.powi(k)
        };
        (0..octaves).map(octave).sum()
    }
}

fn volume(function: VolumeFunction, wave: &[WaveStep]) -> Channel {
    Channel::Volume { function, wave: wave.to_vec(), coordinates: vec![] }
}

fn linear(factor: f64, shift: f64) -> WaveStep {
    WaveStep::Linear { factor, shift }
}

fn gradient(direction: DVec3) -> VolumeFunction {
    VolumeFunction::Gradient { direction }
}

fn fractal(p: DVec3, iterations: i32, constant: Option<DVec2>) -> f64 {
    let part = |x: f64| 4.0 * (if x > 0.0 { x - x.trunc() } else { x + 1.0 + (-x).trunc() }) - 2.0;
    let (mut a, mut b) = (part(p.x), part(p.y));
    let c = constant.unwrap_or(DVec2::new(a, b));
    let mut i = 0;
    while i < iterations {
        (a, b) = (a * a - b * b + c.x, 2.0 * a * b + c.y);
        if a * a + b * b > 4.0 {
            break;
        }
        i += 1;
    }
    f64::from(2 * i - iterations) / f64::from(iterations)
}

fn leopard(p: DVec3) -> f64 {
    ((p.x.sin() + p.y.sin() + p.z.sin()) / 3.0).powi(2)
}

fn odd_cube(p: DVec3) -> bool {
    (p.x.floor() + p.y.floor() + p.z.floor()).rem_euclid(2.0) == 1.0
}

type Definition = fn(f64) -> f64;

/// The wave forms with their definitions.
fn wave_forms() -> Vec<(WaveForm, Definition)> {
    fn part(v: f64) -> f64 {
        v - v.floor()
    }
    vec![
        (WaveForm::Abs, f64::abs),
        (WaveForm::Acos, |v| v.clamp(-1.0, 1.0).acos()),
        (WaveForm::Asin, |v| v.clamp(-1.0, 1.0).asin()),
        (WaveForm::Atan, f64::atan),
        (WaveForm::Ceil, f64::ceil),
        (WaveForm::Floor, f64::floor),
        (WaveForm::Cos, f64::cos),
        (WaveForm::Sin, f64::sin),
        (WaveForm::Tan, f64::tan),
        (WaveForm::Cosh, f64::cosh),
        (WaveForm::Sinh, f64::sinh),
        (WaveForm::Tanh, f64::tanh),
        (WaveForm::Exp, f64::exp),
        (WaveForm::Exp2, f64::exp2),
        (WaveForm::Expm1, f64::exp_m1),
        (WaveForm::Log, |v| v.max(1e-30).ln()),
        (WaveForm::Log10, |v| v.max(1e-30).log10()),
        (WaveForm::Sqr, |v| v * v),
        (WaveForm::Sqrt, |v| v.max(0.0).sqrt()),
        (WaveForm::Ramp, |v| 2.0 * part(v) - 1.0),
        (WaveForm::Triangle, |v| match part(v) {
            f if f < 0.25 => 4.0 * f,
            f if f < 0.75 => 2.0 - 4.0 * f,
            f => 4.0 * f - 4.0,
        }),
        (WaveForm::Cubic, |v| part(v).powi(2) * (6.0 - 4.0 * part(v)) - 1.0),
        (WaveForm::Scallop, |v| 2.0 * (PI * part(v)).sin().abs() - 1.0),
        (WaveForm::Sin01, |v| (TAU * v).sin()),
    ]
}

fn shifted(coordinates: &[CoordinateMap], mut channel: Channel) -> Channel {
    match &mut channel {
        Channel::Volume { coordinates: c, .. }
        | Channel::Waves { coordinates: c, .. }
        | Channel::VolumeChecker { coordinates: c, .. }
        | Channel::Blend { coordinates: c, .. } => *c = coordinates.to_vec(),
        _ => unreachable!(),
    }
    channel
}

#[test]
fn all_maps_agree_with_their_definitions() {
    let mut picture = Picture { builder: Builder::new(), expected: Vec::new(), names: Vec::new() };
    let noise = Rc::new(Noise::new());
    let mut tile = |name: &str, channel: Channel, reference: Reference| -> (ChannelId, Reference) {
        let id = picture.scene().add_channel(channel);
        picture.tile(name, id, &reference);
        (id, reference)
    };
    let half = &[linear(0.5, 0.5)];
    // Plain functions of the position.
    let slope = DVec3::new(0.3, -0.2, 0.1);
    let ramp =
        tile("Gradient", volume(gradient(slope), half), Rc::new(move |p| 0.5 * slope.dot(p.local) + 0.5));
    let n = noise.clone();
    tile(
        "Granite",
        volume(VolumeFunction::Granite, half),
        Rc::new(move |p| {
            let fold = |t: f64| if t > 0.0 { t - 0.5 } else { -0.5 - t };
            let sum = |i: i32| 0.5f64.powi(i) * fold(n.noise(p.local * (4.0 * 2f64.powi(i))));
            0.5 * (0..6).map(sum).sum::<f64>() + 0.5
        }),
    );
    let wave = [linear(0.7, 0.1), WaveStep::Function(WaveForm::Sin01), linear(0.5, 0.5)];
    let wood = |p: Point| p.local.truncate().length();
    tile(
        "Wood",
        volume(VolumeFunction::Wood, &wave),
        Rc::new(move |p| 0.5 * (TAU * (0.7 * wood(p) + 0.1)).sin() + 0.5),
    );
    let spots = tile("Leopard", volume(VolumeFunction::Leopard, &[]), Rc::new(|p| leopard(p.local)));
    let mandel = VolumeFunction::Fractal { iterations: 10, constant: None };
    tile("Mandel", volume(mandel, half), Rc::new(|p| 0.5 * fractal(p.local, 10, None) + 0.5));
    let c = DVec2::new(-0.6, 0.4);
    let julia = VolumeFunction::Fractal { iterations: 7, constant: Some(c) };
    tile("Julia", volume(julia, half), Rc::new(move |p| 0.5 * fractal(p.local, 7, Some(c)) + 0.5));
    let n = noise.clone();
    tile(
        "VolumeTurbulence",
        volume(
            VolumeFunction::Turbulence { size: 0.6, octaves: 3, frequency_ratio: 1.7, noise_ratio: 0.6 },
            half,
        ),
        Rc::new(move |p| {
            let octave = |k: i32| 0.6f64.powi(k) * n.noise(p.local * (0.6 * 1.7f64.powi(k)));
            0.5 * (0..3).map(octave).sum::<f64>() + 0.5
        }),
    );
    // Coordinates.
    let matrix = DAffine3::from_rotation_y(0.4) * DAffine3::from_translation(DVec3::new(0.1, 0.2, 0.3));
    let moved = [CoordinateMap::AffineXyz { matrix, global: false }];
    let channel = shifted(&moved, volume(VolumeFunction::Leopard, &[]));
    tile("XYZTransformation", channel, Rc::new(move |p| leopard(matrix.transform_point3(p.local))));
    let moved = [CoordinateMap::AffineXyz { matrix, global: true }];
    let channel = shifted(&moved, volume(VolumeFunction::Leopard, &[]));
    tile("useGlobal", channel, Rc::new(move |p| leopard(matrix.transform_point3(p.world))));
    let amount = DVec3::new(0.4, 0.3, 0.2);
    let turbulence =
        [CoordinateMap::Turbulence { amount, octaves: 3, frequency_ratio: 1.5, noise_ratio: 0.7 }];
    let n = noise.clone();
    let swirl = move |p: DVec3| p + amount * n.vector(p, 3, 1.5, 0.7);
    let f = swirl.clone();
    let channel = shifted(&turbulence, volume(VolumeFunction::Leopard, &[]));
    tile("Turbulence of xyz", channel, Rc::new(move |p| leopard(f(p.local))));
    let count = DVec2::new(1.0, 2.0);
    let waves = |q: DVec2| 0.5 * (TAU * q.x).cos() * (2.0 * TAU * q.y).cos();
    let channel = shifted(&turbulence, Channel::Waves { count, coordinates: vec![] });
    tile("Turbulence of uv", channel, Rc::new(move |p| 2.0 * waves(swirl(p.uv.extend(0.0)).truncate())));
    let channel =
        shifted(&[CoordinateMap::Value(ramp.0)], volume(VolumeFunction::Leopard, &[linear(3.0, 0.0)]));
    let f = ramp.1.clone();
    tile("a value as coordinates", channel, Rc::new(move |p| 3.0 * leopard(DVec3::splat(f(p)))));
    // Combinations.
    let (odd, even) = (spots.0, ramp.0);
    let (f, g) = (spots.1.clone(), ramp.1.clone());
    let checker = tile(
        "VolumeChecker",
        Channel::VolumeChecker { odd, even, coordinates: vec![] },
        Rc::new(move |p| if odd_cube(p.local) { f(p) } else { g(p) }),
    );
    let item = |position: f64, id: ChannelId| BlendItem { position, channel: id };
    let (f, g, h) = (spots.1.clone(), ramp.1.clone(), checker.1.clone());
    let items = vec![item(-0.5, spots.0), item(0.3, ramp.0), item(0.8, checker.0)];
    let mix = move |t: f64, p: Point| match t {
        t if t < -0.5 => f(p),
        t if t < 0.3 => f(p) + (g(p) - f(p)) * (t + 0.5) / 0.8,
        t if t < 0.8 => g(p) + (h(p) - g(p)) * (t - 0.3) / 0.5,
        _ => h(p),
    };
    let m = mix.clone();
    let blend = tile(
        "ChannelBlend",
        Channel::Blend { items: items.clone(), coordinates: vec![] },
        Rc::new(move |p| m(p.local.x, p)),
    );
    let m = mix.clone();
    let (f, g) = (spots.1.clone(), blend.1.clone());
    tile(
        "a blend of blends by a value",
        Channel::Blend {
            items: vec![item(0.0, blend.0), item(0.5, ramp.0)],
            coordinates: vec![CoordinateMap::Value(spots.0)],
        },
        {
            let r = ramp.1.clone();
            Rc::new(move |p| {
                let t = f(p).clamp(0.0, 0.5) / 0.5;
                let _ = &m;
                g(p) * (1.0 - t) + r(p) * t
            })
        },
    );
    let step = DVec3::new(0.2, 0.15, 0.3);
    let at = |p: Point, i: i32, j: i32, k: i32| {
        let d = DVec3::new(0.2 * f64::from(i), 0.15 * f64::from(j), 0.3 * f64::from(k));
        Point { uv: p.uv + d.truncate(), local: p.local + d, world: p.world }
    };
    let smooth = move |f: &Reference, p: Point| {
        let points = (0..27).map(|n| at(p, n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
        points.map(|q| f(q)).sum::<f64>() / 27.0
    };
    let f = checker.1.clone();
    let smoothed = tile(
        "Smooth3D",
        Channel::Filter { weights: NeighbourFilter::Smooth, step, input: checker.0 },
        Rc::new(move |p| smooth(&f, p)),
    );
    let f = blend.1.clone();
    tile(
        "Laplace3D of a blend",
        Channel::Filter { weights: NeighbourFilter::Laplace, step, input: blend.0 },
        Rc::new(move |p| {
            let faces = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)];
            (6.0 * f(p) - faces.iter().map(|(i, j, k)| f(at(p, *i, *j, *k))).sum::<f64>()) / 12.0
        }),
    );
    let f = smoothed.1.clone();
    tile(
        "Smooth3D of Smooth3D",
        Channel::Filter { weights: NeighbourFilter::Smooth, step, input: smoothed.0 },
        Rc::new(move |p| smooth(&f, p)),
    );
    tile("RGBAShader", Channel::Rgba { color: [0.3; 3], alpha: 0.5 }, Rc::new(|_| 0.3));
    for (form, definition) in wave_forms() {
        // v runs through -1.05 to 1.95, scaled back to what can glow.
        let wave = [linear(0.75, 0.45), WaveStep::Function(form), linear(0.1, 0.8)];
        let channel = volume(gradient(DVec3::X), &wave);
        tile(
            &format!("{form:?}"),
            channel,
            Rc::new(move |p| 0.1 * definition(0.75 * p.local.x + 0.45) + 0.8),
        );
    }
    // Other bodies: their own frame is in metres, whatever the unit shape is.
    let disc = |radius: f64| move |p: DVec2| (p.length() < radius).then_some(p.length());
    let sphere = Shape::Sphere { radius: 0.9 };
    picture.body("Sphere", sphere, move |p| disc(0.9)(p).map(|d| (0.81 - d * d).max(0.0).sqrt()));
    let inside = |p: DVec2| p.x.abs() < 0.8 && p.y.abs() < 0.6;
    let block = Shape::Box { width: 1.6, height: 1.2, length: 0.5 };
    picture.body("Box", block, move |p| inside(p).then_some(0.5));
    let can = Shape::Cylinder { radius: 0.9, length: 0.7, base_open: false, top_open: false, scale_v: false };
    picture.body("Cylinder", can, move |p| disc(0.9)(p).map(|_| 0.7));
    let cone = Shape::Cone { radius: 0.9, length: 0.8, open: false, scale_v: true };
    picture.body("Cone", cone, move |p| disc(0.9)(p).map(|d| 0.8 * (1.0 - d / 0.9)));
    let mesh = picture.scene().add_mesh(Mesh {
        positions: vec![[-0.8, -0.8, 0.0], [0.8, -0.8, 0.2], [0.8, 0.8, 0.4], [-0.8, 0.8, 0.2]].into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
        ..Mesh::default()
    });
    let on_mesh = |p: DVec2| p.x.abs() < 0.8 && p.y.abs() < 0.8;
    let shape = Shape::Mesh { mesh, visible_sides: VisibleSides::Both };
    picture.body("Mesh", shape, move |p| on_mesh(p).then_some(0.2 + 0.125 * (p.x + p.y)));
    picture.check();
}

#[test]
fn normal_maps_bend_the_shading_normal() {
    // A picture of its own: the light of glowing bodies would be scattered, too.
    let mut picture = Picture { builder: Builder::new(), expected: Vec::new(), names: Vec::new() };
    add_bumps(&mut picture);
    picture.check();
}

/// Two flat tiles under a slanting light, bent by waves and by a function of the position.
fn add_bumps(picture: &mut Picture) {
    let toward_light = DVec3::new(0.3, 0.2, 1.0).normalize();
    let place = DAffine3::from_mat3(scene::DMat3::from_cols(
        toward_light.any_orthonormal_pair().0,
        toward_light.any_orthonormal_pair().1,
        -toward_light,
    ));
    picture.builder.light(LightKind::Directional { irradiance: [PI; 3] }, place);
    let count = DVec2::new(1.0, 1.0);
    let waves = picture.scene().add_channel(Channel::Waves { count, coordinates: vec![] });
    let slope = DVec3::new(2.0, 1.5, -1.0);
    let ramp = picture.scene().add_channel(volume(gradient(slope), &[]));
    for (name, displacement, scale) in [("WaveMap", waves, 0.2), ("BumpMap", ramp, 0.1)] {
        let map = NormalMap { displacement, scale, step: DVec2::splat(0.005), box_top: false };
        let phong = Phong { diffuse: grey(picture.scene(), 0.8), normal_maps: vec![map], ..Phong::default() };
        let material = picture.builder.phong(|_| phong);
        let middle = picture.middle();
        // u and v run from the lower left corner of the tile along x and y, 2 m each; local z is world y.
        let shape = Shape::Parallelogram { length: 2.0, axis: DVec3::X, scale_v: false };
        let turn = DAffine3::from_translation(middle - DVec3::Y) * DAffine3::from_rotation_x(-FRAC_PI_2);
        picture.builder.object(shape, turn, material);
        picture.names.push(name.to_owned());
        picture.expected.push(Box::new(move |p| {
            let (u, v) = (0.5 * p.x + 0.5, 0.5 * p.y + 0.5);
            // Slopes per metre.
            let (along_x, along_y) = if name == "WaveMap" {
                (-PI * (TAU * u).sin() * (TAU * v).cos(), -PI * (TAU * u).cos() * (TAU * v).sin())
            } else {
                (slope.x, slope.z)
            };
            // The parallelogram's front looks down: the surface is raised away from the viewer.
            let normal = DVec3::new(scale * along_x, scale * along_y, 1.0).normalize();
            Some(0.8 * normal.dot(toward_light).max(0.0))
        }));
    }
}
