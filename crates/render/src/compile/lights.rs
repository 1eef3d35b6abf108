use super::{count, vector};
use kernels::records::kernel::{
    LIGHT_AREA, LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SKY, LIGHT_SPOT, LightRecord, NONE,
};
use scene::{DAffine3, DVec3, Emission, LightKind, Rgb, Scene, Shape};
use std::f64::consts::{PI, TAU};

/// The table of lights.
pub(super) struct Lights {
    pub records: Vec<LightRecord>,
    /// For every object of the scene, its light or `NONE`.
    pub of_object: Vec<u32>,
    /// Index of the sky.
    pub sky: Option<u32>,
}

pub(super) fn compile_lights(scene: &Scene, local_from_world: &DAffine3) -> Lights {
    let mut records: Vec<LightRecord> = scene
        .lights
        .iter()
        .map(|light| bodiless(&light.kind, &(*local_from_world * light.world_from_light), light.shadowless))
        .collect();
    let mut of_object = vec![NONE; scene.objects.len()];
    for (object, light) in scene.objects.iter().zip(&mut of_object) {
        if let (Some(emission), Shape::Parallelogram { length, axis, .. }) = (&object.emission, &object.shape)
        {
            *light = count(records.len());
            let local_from_object = *local_from_world * object.world_from_object;
            records.push(area(emission, &local_from_object, *axis, *length));
        }
    }
    let sky = scene.sky.as_ref().map(|sky| {
        records.push(LightRecord {
            emission: rgb(sky.radiance),
            // Irradiance of a whole hemisphere.
            importance: (PI * luminance(sky.radiance)) as f32,
            ..dark(LIGHT_SKY)
        });
        count(records.len() - 1)
    });
    Lights { records, of_object, sky }
}

fn bodiless(kind: &LightKind, local_from_light: &DAffine3, shadowless: bool) -> LightRecord {
    let axis = local_from_light.transform_vector3(DVec3::Z).normalize_or(DVec3::Z);
    let placed = LightRecord {
        position: vector(local_from_light.translation),
        axis: vector(axis),
        shadowless: u32::from(shadowless),
        ..dark(LIGHT_POINT)
    };
    match *kind {
        LightKind::Point { power } => {
            let intensity = power.map(|p| p / (4.0 * PI));
            LightRecord { emission: rgb(intensity), importance: luminance(intensity) as f32, ..placed }
        }
        LightKind::Spot { power, inner_angle, outer_angle } => {
            let (cos_inner, cos_outer) = (inner_angle.cos(), outer_angle.cos());
            // Solid angle that the profile is worth: the core and half of the rim.
            let solid_angle = TAU * (1.0 - 0.5 * (cos_inner + cos_outer));
            let intensity = power.map(|p| p / solid_angle);
            LightRecord {
                kind: LIGHT_SPOT,
                emission: rgb(intensity),
                cos_inner: cos_inner as f32,
                cos_outer: cos_outer as f32,
                importance: luminance(intensity) as f32,
                ..placed
            }
        }
        LightKind::Directional { irradiance } => LightRecord {
            kind: LIGHT_DIRECTIONAL,
            emission: rgb(irradiance),
            importance: luminance(irradiance) as f32,
            ..placed
        },
    }
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

fn dark(kind: u32) -> LightRecord {
    LightRecord { kind, ..bytemuck::Zeroable::zeroed() }
}

fn rgb([r, g, b]: Rgb) -> wgsl_rs::std::Vec3f {
    wgsl_rs::std::vec3f(r as f32, g as f32, b as f32)
}

fn luminance([r, g, b]: Rgb) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
