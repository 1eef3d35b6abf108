use super::daylight::{self, SUN_VERSINE};
use super::light_tree::{self, Placed};
use super::{count, vector};
use kernels::records::kernel::{
    LIGHT_AREA, LIGHT_DAYLIGHT, LIGHT_DIRECTIONAL, LIGHT_PHYSICAL, LIGHT_POINT, LIGHT_SKY, LIGHT_SKY_MAP,
    LIGHT_SPOT, LIGHT_SUN, LightRecord, NONE,
};
use scene::{
    Attenuation, DAffine3, DVec3, Distribution, Emission, Light, LightKind, Rgb, Scene, Shape, Sky,
    SkyRadiance,
};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// The table of lights.
pub(super) struct Lights {
    /// Lights infinitely far away, the other ones and groups without a parent, the rest of the tree.
    pub records: Vec<LightRecord>,
    /// How many of the records are infinitely far away.
    pub distant: u32,
    /// How many of the records have no parent.
    pub top: u32,
    /// For every object of the scene, its light or `NONE`.
    pub of_object: Vec<u32>,
    /// What the records refer to among the attributes.
    tables: Tables,
}

/// Tables of lights, counted from 0 until they are appended to the attributes.
#[derive(Default)]
struct Tables {
    entries: Vec<[f32; 4]>,
    /// Where distributions start, by their address: lamps of the same kind share one.
    starts: HashMap<*const Distribution, u32>,
}

impl Lights {
    /// Moves the tables of the lights to the end of the attributes.
    pub fn append_tables(&mut self, attributes: &mut Vec<[f32; 4]>) {
        let start = count(attributes.len());
        attributes.append(&mut self.tables.entries);
        for record in &mut self.records {
            match record.kind {
                LIGHT_PHYSICAL => record.first += start,
                LIGHT_DAYLIGHT => record.program += start,
                _ => {}
            }
        }
    }
}

/// `channels` tells where the programs of the scene's channels start.
pub(super) fn compile_lights(scene: &Scene, local_from_world: &DAffine3, channels: &[u32]) -> Lights {
    let mut records = Vec::new();
    let mut tables = Tables::default();
    if let Some(sky) = &scene.sky {
        compile_sky(sky, channels, &mut records, &mut tables);
    }
    let mut placed = Vec::new();
    for light in &scene.lights {
        let local_from_light = *local_from_world * light.world_from_light;
        let (record, limit) = bodiless(light, &local_from_light, &mut tables);
        if record.kind == LIGHT_DIRECTIONAL {
            records.push(record);
        } else {
            let centre = local_from_light.translation;
            placed.push(Placed { record, centre, radius: 0.0, limit, object: None });
        }
    }
    for (index, object) in scene.objects.iter().enumerate() {
        if let (Some(emission), Shape::Parallelogram { length, axis, .. }) = (&object.emission, &object.shape)
        {
            let local_from_object = *local_from_world * object.world_from_object;
            let centre = local_from_object.transform_point3(DVec3::new(0.0, 0.0, 0.5 * length));
            let corner = local_from_object.transform_point3(*axis);
            let other_corner = local_from_object.transform_point3(-*axis);
            placed.push(Placed {
                record: area(emission, &local_from_object, *axis, *length),
                centre,
                radius: (corner - centre).length().max((other_corner - centre).length()),
                limit: FRAC_PI_2,
                object: Some(index),
            });
        }
    }
    let distant = count(records.len());
    let mut of_object = vec![NONE; scene.objects.len()];
    let top = light_tree::arrange(placed, &mut records, &mut of_object);
    Lights { records, distant, top, of_object, tables }
}

/// A light without a body, and the largest angle from its axis at which it shines.
fn bodiless(light: &Light, local_from_light: &DAffine3, tables: &mut Tables) -> (LightRecord, f64) {
    let Attenuation { exponent, distance } = light.attenuation;
    let axis = local_from_light.transform_vector3(DVec3::Z).normalize_or(DVec3::Z);
    let placed = LightRecord {
        position: vector(local_from_light.translation),
        axis: vector(axis),
        shadowless: u32::from(light.shadowless),
        edge_u: vector(DVec3::new(exponent, distance, 0.0)),
        ..dark(LIGHT_POINT)
    };
    match &light.kind {
        LightKind::Point { power } => {
            let intensity = power.map(|p| p / (4.0 * PI));
            let record =
                LightRecord { emission: rgb(intensity), importance: luminance(intensity) as f32, ..placed };
            (record, PI)
        }
        LightKind::Spot { power, inner_angle, outer_angle } => {
            let (cos_inner, cos_outer) = (inner_angle.cos(), outer_angle.cos());
            // Solid angle that the profile is worth: the core and half of the rim.
            let solid_angle = TAU * (1.0 - 0.5 * (cos_inner + cos_outer));
            let intensity = power.map(|p| p / solid_angle);
            let record = LightRecord {
                kind: LIGHT_SPOT,
                emission: rgb(intensity),
                cos_inner: cos_inner as f32,
                cos_outer: cos_outer as f32,
                importance: luminance(intensity) as f32,
                ..placed
            };
            (record, *outer_angle)
        }
        LightKind::Directional { irradiance } => {
            let record = LightRecord {
                kind: LIGHT_DIRECTIONAL,
                emission: rgb(*irradiance),
                importance: luminance(*irradiance) as f32,
                ..placed
            };
            (record, PI)
        }
        LightKind::Physical { power, distribution } => {
            let record = LightRecord {
                kind: LIGHT_PHYSICAL,
                emission: rgb(*power),
                importance: (luminance(*power) * distribution.max_density()) as f32,
                cos_inner: exponent as f32,
                cos_outer: distance as f32,
                first: tables.start_of(distribution),
                count: size(distribution.columns(), distribution.rows()),
                ..with_axes(placed, local_from_light)
            };
            (record, PI)
        }
    }
}

/// How much a sky counts when it is chosen which light a ray is aimed at, beside the irradiance that it causes;
/// `variance` is that of its radiance over all directions, relative to the square of the mean.
///
/// The rays that surfaces scatter are there anyway and find an even sky as well as rays that are aimed at it, so that
/// the aimed ones are better spent on lamps and on the sun, which scattered rays do not find. (Measured: a bush under a
/// lamp and an even sky has a sixth of the error.) What is left serves places that no lamp reaches. The brighter spots
/// a sky has, the more it is like a lamp.
pub(super) fn aimed_share(variance: f64) -> f64 {
    const LEAST: f64 = 0.001;
    (variance / (1.0 + variance)).max(LEAST)
}

/// The sky, and the sun if it has one.
fn compile_sky(sky: &Sky, channels: &[u32], records: &mut Vec<LightRecord>, tables: &mut Tables) {
    match &sky.radiance {
        SkyRadiance::Uniform(radiance) => records.push(LightRecord {
            emission: rgb(*radiance),
            // Irradiance of a whole hemisphere.
            importance: (PI * luminance(*radiance) * aimed_share(0.0)) as f32,
            ..dark(LIGHT_SKY)
        }),
        SkyRadiance::Channel { channel, factor } => records.push(LightRecord {
            emission: rgb([*factor; 3]),
            // Replaced when the density is known.
            importance: 1.0,
            program: channels[channel.index()],
            ..with_axes(dark(LIGHT_SKY_MAP), &sky.world_from_sky)
        }),
        SkyRadiance::Daylight(daylight) => {
            let model = daylight::compile_daylight(daylight);
            let importance = if daylight.shines { 1.0 } else { 0.0 };
            let sky_record = LightRecord {
                importance,
                program: count(tables.entries.len()),
                ..with_axes(dark(LIGHT_DAYLIGHT), &sky.world_from_sky)
            };
            tables.entries.extend(model.coefficients);
            records.push(sky_record);
            if let Some(radiance) = model.sun_radiance {
                let [x, y, z] = axes(&sky.world_from_sky);
                let towards = x * model.sun.x + y * model.sun.y + z * model.sun.z;
                let normal_irradiance = luminance(radiance) * TAU * SUN_VERSINE;
                records.push(LightRecord {
                    axis: vector(-towards),
                    emission: rgb(radiance),
                    cos_inner: SUN_VERSINE as f32,
                    importance: importance * normal_irradiance as f32,
                    ..dark(LIGHT_SUN)
                });
            }
        }
    }
}

/// The orthonormal axes nearest to those of a placement: the direction of z, and x made perpendicular to it. A
/// mirrored placement stays mirrored.
fn axes(placement: &DAffine3) -> [DVec3; 3] {
    let z = placement.transform_vector3(DVec3::Z).normalize_or(DVec3::Z);
    let x = placement.transform_vector3(DVec3::X).reject_from_normalized(z);
    let x = x.normalize_or(z.any_orthonormal_vector());
    let y = z.cross(x) * if placement.matrix3.determinant() < 0.0 { -1.0 } else { 1.0 };
    [x, y, z]
}

fn with_axes(record: LightRecord, placement: &DAffine3) -> LightRecord {
    let [x, y, z] = axes(placement);
    LightRecord { edge_u: vector(x), edge_v: vector(y), axis: vector(z), ..record }
}

impl Tables {
    /// Where the table of a distribution starts. Every entry holds the four corners of its cell, so that a look-up
    /// reads one.
    fn start_of(&mut self, distribution: &Arc<Distribution>) -> u32 {
        let next = count(self.entries.len());
        let start = *self.starts.entry(Arc::as_ptr(distribution)).or_insert(next);
        if start == next {
            for row in 0..distribution.rows() {
                for column in 0..distribution.columns() {
                    let at = |column, row| distribution.density(column, row) as f32;
                    self.entries.push([
                        at(column, row),
                        at(column + 1, row),
                        at(column, row + 1),
                        at(column + 1, row + 1),
                    ]);
                }
            }
        }
        start
    }
}

/// The size of a table in one number.
///
/// # Panics
/// If it has more than 65535 columns or rows; [`super::check_distributions`] excludes it.
pub(super) fn size(columns: usize, rows: usize) -> u32 {
    let part = |n: usize| u32::from(u16::try_from(n).expect("the sizes of distributions are checked"));
    part(columns) | part(rows) << 16
}

fn area(emission: &Emission, local_from_object: &DAffine3, axis: DVec3, length: f64) -> LightRecord {
    let edge_u = local_from_object.transform_vector3(axis);
    let edge_v = local_from_object.transform_vector3(DVec3::new(0.0, 0.0, length));
    let area = 2.0 * edge_u.cross(edge_v).length();
    // The front is z × axis; a mirrored placement turns the cross product of the edges round.
    let front = edge_v.cross(edge_u).normalize_or(DVec3::Y)
        * local_from_object.matrix3.determinant().signum()
        * length.signum();
    let radiance = emission.power.map(|p| p / area * (emission.exponent + 2.0) / TAU);
    LightRecord {
        position: vector(local_from_object.translation),
        axis: vector(front),
        shadowless: u32::from(emission.shadowless),
        emission: rgb(radiance),
        cos_inner: emission.exponent as f32,
        edge_u: vector(edge_u),
        cos_outer: area as f32,
        edge_v: vector(edge_v),
        importance: (luminance(radiance) * area) as f32,
        ..dark(LIGHT_AREA)
    }
}

pub(super) fn dark(kind: u32) -> LightRecord {
    LightRecord { kind, parent: NONE, program: NONE, ..bytemuck::Zeroable::zeroed() }
}

fn rgb([r, g, b]: Rgb) -> wgsl_rs::std::Vec3f {
    wgsl_rs::std::vec3f(r as f32, g as f32, b as f32)
}

pub(super) fn luminance([r, g, b]: Rgb) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
