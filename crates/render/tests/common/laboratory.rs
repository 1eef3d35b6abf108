//! Scenes in which every surface can be asked how much light it absorbs, by what its material promises (the formulas of
//! GroIMP's `RGBAShader` and `Phong` in 64 bits), not by the code that scatters light.

use super::{Builder, ORIGIN};
use kernels::random::kernel::{independent_key, random4};
use render::cpu::Cpu;
use render::{RenderSettings, WorldRay, compile};
use scene::{Channel, DAffine3, DVec3, Emission, Interior, Material, MaterialId, Object, Phong, Rgb, Shape};
use std::f64::consts::{PI, TAU};

/// Batches of rays that know nothing of each other; within a batch rays are spread evenly. Their scatter tells the standard
/// error to a tenth; with a few batches only, sums that are four of them off would be no rarity (1 in 800 with 16).
const BATCHES: u32 = 64;
/// Rays start this far before the surfaces, in metres.
const BEFORE: f64 = 1e-5;

/// What a surface does with light.
#[derive(Clone, Copy)]
pub struct Finish {
    /// Diffuse reflection and transmission, glossy reflection: shares of the light that meets the surface.
    pub diffuse: Rgb,
    pub diffuse_transmission: Rgb,
    pub glossy: Rgb,
    /// GroIMP's shininess of the glossy lobe; 1 is a mirror.
    pub shininess: f64,
    /// Share of the light that meets the surface; the rest passes.
    pub opacity: f64,
}

impl Finish {
    pub fn diffuse(diffuse: Rgb) -> Self {
        Finish { diffuse, diffuse_transmission: [0.0; 3], glossy: [0.0; 3], shininess: 0.5, opacity: 1.0 }
    }

    fn material(self, b: &mut Builder) -> MaterialId {
        if self.diffuse_transmission == [0.0; 3] && self.glossy == [0.0; 3] {
            return b.scene.add_material(Material::Rgba { color: self.diffuse, opacity: self.opacity });
        }
        assert_eq!(self.opacity, 1.0, "only plain colours pass light here");
        b.phong(|scene| {
            let mut channel = |value: Rgb| Some(scene.add_channel(Channel::Constant(value)));
            Phong {
                diffuse: channel(self.diffuse),
                diffuse_transparency: channel(self.diffuse_transmission),
                specular: channel(self.glossy),
                shininess: channel([self.shininess; 3]),
                ..Phong::default()
            }
        })
    }
}

/// Directional albedo of a glossy lobe with coefficient 1 at evenly spaced cosines of the incoming light: the lobe
/// (n+2)/(2π) cosⁿ / max(cosᵢ, cosₒ) loses what lies below the surface.
struct LobeAlbedo(Vec<f64>);

impl LobeAlbedo {
    const STEPS: usize = 64;

    fn new(shininess: f64) -> Self {
        let y = shininess * (2.0 - shininess);
        if y >= 1.0 {
            return LobeAlbedo(vec![1.0; Self::STEPS + 1]);
        }
        let n = -2.0 / y.ln();
        assert!(n >= 1.0, "lobes wider than that are scaled down");
        let albedo = |cos_in: f64| {
            let sin_in = (1.0 - cos_in * cos_in).sqrt();
            let points = 160;
            let mut sum = 0.0;
            for i in 0..points {
                // The cosine to the lobe's axis, distributed as its n-th power.
                let along = ((f64::from(i) + 0.5) / f64::from(points)).powf(1.0 / (n + 1.0));
                let across = (1.0 - along * along).sqrt();
                for j in 0..points {
                    let turn = TAU * (f64::from(j) + 0.5) / f64::from(points);
                    let cos_out = cos_in * along + sin_in * across * turn.cos();
                    sum += cos_out.max(0.0) / cos_out.max(cos_in);
                }
            }
            (n + 2.0) / (n + 1.0) * sum / f64::from(points * points)
        };
        LobeAlbedo((0..=Self::STEPS).map(|i| albedo((i as f64 / Self::STEPS as f64).max(1e-9))).collect())
    }

    fn at(&self, cosine: f64) -> f64 {
        let place = cosine.clamp(0.0, 1.0) * Self::STEPS as f64;
        let below = (place as usize).min(Self::STEPS - 1);
        let part = place - below as f64;
        self.0[below] * (1.0 - part) + self.0[below + 1] * part
    }
}

/// A shape in its own frame, as points are drawn on it.
#[derive(Clone, Copy)]
enum Outline {
    /// Half extents along x and z.
    Rectangle(f64, f64),
    /// Round the origin.
    Ball(f64),
    /// Radius and length of an open tube along z from 0.
    Tube(f64, f64),
    /// Extents of a block that stands on z = 0.
    Block(DVec3),
}

impl Outline {
    fn shape(self) -> Shape {
        match self {
            Outline::Rectangle(x, z) => {
                Shape::Parallelogram { length: 2.0 * z, axis: DVec3::new(x, 0.0, 0.0), scale_v: false }
            }
            Outline::Ball(radius) => Shape::Sphere { radius },
            Outline::Tube(radius, length) => {
                Shape::Cylinder { radius, length, base_open: true, top_open: true, scale_v: false }
            }
            Outline::Block(size) => Shape::Box { width: size.x, height: size.y, length: size.z },
        }
    }

    fn area(self) -> f64 {
        match self {
            Outline::Rectangle(x, z) => 4.0 * x * z,
            Outline::Ball(radius) => 4.0 * PI * radius * radius,
            Outline::Tube(radius, length) => TAU * radius * length,
            Outline::Block(size) => 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x),
        }
    }

    /// A point and its outward normal, evenly distributed for `u` and `v` in [0, 1).
    fn point(self, u: f64, v: f64) -> (DVec3, DVec3) {
        let round = |turn: f64| DVec3::new((TAU * turn).cos(), (TAU * turn).sin(), 0.0);
        match self {
            Outline::Rectangle(x, z) => (DVec3::new((2.0 * u - 1.0) * x, 0.0, 2.0 * v * z), DVec3::Y),
            Outline::Ball(radius) => {
                let height = 2.0 * u - 1.0;
                let normal = round(v) * (1.0 - height * height).sqrt() + DVec3::Z * height;
                (normal * radius, normal)
            }
            Outline::Tube(radius, length) => (round(u) * radius + DVec3::Z * (v * length), round(u)),
            Outline::Block(size) => {
                let faces = [size.y * size.z, size.z * size.x, size.x * size.y];
                let mut place = u * faces.iter().sum::<f64>() * 2.0;
                let mut axis = 0;
                while axis < 2 && place >= 2.0 * faces[axis] {
                    place -= 2.0 * faces[axis];
                    axis += 1;
                }
                let upper = place >= faces[axis];
                let along = place / faces[axis] - f64::from(u8::from(upper));
                let (second, third) = ((axis + 1) % 3, (axis + 2) % 3);
                let (mut point, mut normal) = (DVec3::ZERO, DVec3::ZERO);
                normal[axis] = if upper { 1.0 } else { -1.0 };
                point[axis] = 0.5 * normal[axis] * size[axis];
                point[second] = (along - 0.5) * size[second];
                point[third] = (v - 0.5) * size[third];
                (point + DVec3::Z * (0.5 * size.z), normal)
            }
        }
    }
}

/// One side of a surface.
struct Side {
    world_from_outline: DAffine3,
    outline: Outline,
    /// 1 for the side that normals point to, -1 for the other.
    sign: f64,
    finish: Finish,
}

/// A power in three channels and the variance of its estimate.
#[derive(Clone, Copy, Default, Debug)]
pub struct Power {
    pub watts: Rgb,
    pub variance: Rgb,
}

impl Power {
    fn add(&mut self, other: Power) {
        for c in 0..3 {
            self.watts[c] += other.watts[c];
            self.variance[c] += other.variance[c];
        }
    }

    /// `factor` times the mean of values in their order of [`arriving`]; its variance is that among the batches.
    fn mean(values: &[Rgb], factor: f64) -> Power {
        let n = f64::from(BATCHES);
        let mut power = Power::default();
        for c in 0..3 {
            let mut sums = [0.0; BATCHES as usize];
            for (i, value) in values.iter().enumerate() {
                sums[i % BATCHES as usize] += factor * n * value[c] / values.len() as f64;
            }
            let mean = sums.iter().sum::<f64>() / n;
            power.watts[c] = mean;
            power.variance[c] = sums.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / (n - 1.0) / n;
        }
        power
    }
}

/// A scene whose surfaces are known.
pub struct Laboratory {
    pub builder: Builder,
    sides: Vec<Side>,
}

impl Laboratory {
    pub fn new() -> Self {
        Laboratory { builder: Builder::new(), sides: Vec::new() }
    }

    /// The base of every object is moved to the origin of `place`.
    fn add(&mut self, outline: Outline, place: DAffine3, finish: Finish, signs: &[f64]) -> &mut Object {
        let material = finish.material(&mut self.builder);
        for &sign in signs {
            self.sides.push(Side { world_from_outline: place, outline, sign, finish });
        }
        self.builder.scene.objects.push(Object {
            shape: outline.shape(),
            world_from_object: place,
            material,
            emission: None,
            interior: None,
            origin: ORIGIN,
        });
        self.builder.scene.objects.last_mut().unwrap()
    }

    /// A block that is lit from inside only.
    pub fn room(&mut self, size: DVec3, finish: Finish) {
        self.add(Outline::Block(size), DAffine3::IDENTITY, finish, &[-1.0]);
    }

    pub fn block(&mut self, size: DVec3, place: DAffine3, finish: Finish) {
        self.add(Outline::Block(size), place, finish, &[1.0]);
    }

    pub fn ball(&mut self, radius: f64, centre: DVec3, finish: Finish) {
        self.add(Outline::Ball(radius), DAffine3::from_translation(centre), finish, &[1.0]);
    }

    pub fn tube(&mut self, radius: f64, length: f64, place: DAffine3, finish: Finish) {
        self.add(Outline::Tube(radius, length), place, finish, &[1.0, -1.0]);
    }

    /// A rectangle with half extents along x and z of its frame; the front is y.
    pub fn leaf(&mut self, x: f64, z: f64, place: DAffine3, finish: Finish) -> &mut Object {
        self.add(Outline::Rectangle(x, z), place, finish, &[1.0, -1.0])
    }

    /// A square lamp of 0.8 m that shines down.
    pub fn lamp(&mut self, height: f64, emission: Emission) {
        let down = DAffine3::from_rotation_x(-0.5 * PI);
        let place = DAffine3::from_translation(DVec3::new(0.0, -0.4, height)) * down;
        self.leaf(0.4, 0.4, place, Finish::diffuse([0.2, 0.3, 0.1])).emission = Some(emission);
    }

    /// A ball of glass, which absorbs nothing.
    pub fn glass_ball(&mut self, radius: f64, centre: DVec3) {
        let clear = Finish { opacity: 0.0, ..Finish::diffuse([0.0; 3]) };
        let place = DAffine3::from_translation(centre);
        self.add(Outline::Ball(radius), place, clear, &[]).interior =
            Some(Interior { refractive_index: 1.5 });
    }

    /// Light that all surfaces absorb, and light that a sphere round the origin lets out, as far as rays of sight bring
    /// it: `rays` rays for all surfaces and twice as many for the sphere.
    pub fn measure(&self, settings: &RenderSettings, rays: usize, sphere: Option<f64>) -> (Power, Power) {
        let compiled = compile(&self.builder.scene).unwrap();
        let cpu = Cpu::new(None).unwrap();
        let total: f64 = self.sides.iter().map(|side| side.outline.area()).sum();
        let mut absorbed = Power::default();
        for (number, side) in self.sides.iter().enumerate() {
            let area = side.outline.area();
            // Small surfaces are often bright ones.
            let share = 0.8 * (area / total) + 0.2 / self.sides.len() as f64;
            let count = (rays as f64 * share) as u32 / BATCHES * BATCHES;
            let lobe = LobeAlbedo::new(side.finish.shininess);
            let seed = settings.seed + number as u32 + 1;
            let (rays, cosines): (Vec<WorldRay>, Vec<f64>) = (0..count)
                .map(|i| {
                    arriving(side.world_from_outline, i, seed, |u, v| side.outline.point(u, v), side.sign)
                })
                .unzip();
            let settings = RenderSettings { seed, ..settings.clone() };
            let radiances = cpu.radiance_along(&compiled, &settings, &rays);
            let values: Vec<Rgb> = radiances
                .iter()
                .zip(cosines)
                .map(|(radiance, cosine)| absorbed_share(&side.finish, &lobe, cosine, radiance))
                .collect();
            absorbed.add(Power::mean(&values, PI * area));
        }
        let mut escaped = Power::default();
        if let Some(radius) = sphere {
            let outline = Outline::Ball(radius);
            let seed = settings.seed + 1000;
            let rays: Vec<WorldRay> = (0..2 * rays as u32 / BATCHES * BATCHES)
                .map(|i| arriving(DAffine3::IDENTITY, i, seed, |u, v| outline.point(u, v), -1.0).0)
                .collect();
            let settings = RenderSettings { seed, ..settings.clone() };
            let radiances = cpu.radiance_along(&compiled, &settings, &rays);
            escaped = Power::mean(&radiances, PI * outline.area());
        }
        (absorbed, escaped)
    }
}

/// A ray against light that arrives at a surface, drawn with the cosine, and that cosine. Points and directions of a
/// batch are those of the additive sequence in four dimensions (Roberts, "The Unreasonable Effectiveness of
/// Quasirandom Sequences", 2018), moved at random.
fn arriving(
    frame: DAffine3,
    number: u32,
    seed: u32,
    point: impl Fn(f64, f64) -> (DVec3, DVec3),
    sign: f64,
) -> (WorldRay, f64) {
    // The root of x⁵ = x + 1; and a dimension that no path reaches.
    const STEP: f64 = 1.167_303_978_261_418_7;
    let moved = random4(independent_key(number % BATCHES, 0, seed), 1 << 20).to_array();
    let numbers: [f64; 4] = std::array::from_fn(|axis| {
        (f64::from(moved[axis]) + f64::from(number / BATCHES) / STEP.powi(axis as i32 + 1)).fract()
    });
    let (position, normal) = point(numbers[0], numbers[1]);
    let normal = frame.transform_vector3(normal * sign);
    let cosine = (1.0 - numbers[2]).sqrt();
    let (sin, turn) = (numbers[2].sqrt(), TAU * numbers[3]);
    let (first, second) = normal.any_orthonormal_pair();
    let direction = normal * cosine + first * (sin * turn.cos()) + second * (sin * turn.sin());
    (WorldRay { origin: frame.transform_point3(position) + normal * BEFORE, direction }, cosine)
}

fn absorbed_share(finish: &Finish, lobe: &LobeAlbedo, cosine: f64, radiance: &Rgb) -> Rgb {
    let glossy = lobe.at(cosine);
    std::array::from_fn(|c| {
        let scattered = finish.diffuse[c] + finish.diffuse_transmission[c] + finish.glossy[c] * glossy;
        finish.opacity * (1.0 - scattered) * radiance[c]
    })
}
