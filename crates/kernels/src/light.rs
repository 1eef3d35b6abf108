//! Lights: sampling one, and the densities that multiple importance sampling needs.
//!
//! Formulas: materials-and-lights.md chapter 3. Densities are per solid angle; lights without extent have
//! density 0 and are only ever sampled here.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use crate::sky::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// Light from one direction.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct LightSample {
        /// Unit vector towards the light.
        pub direction: Vec3f,
        /// Distance in metres, or `NO_HIT` for lights at infinity.
        pub distance: f32,
        /// Radiance divided by density; irradiance for lights without extent.
        pub weight: Vec3f,
        /// Density per solid angle, 0 for lights without extent.
        pub pdf: f32,
    }

    /// Share of the core's intensity that a spot light emits at an angle with cosine `cos_angle`.
    pub fn spot_profile(cos_angle: f32, cos_inner: f32, cos_outer: f32) -> f32 {
        if cos_angle >= cos_inner {
            return 1.0;
        }
        if cos_angle <= cos_outer {
            return 0.0;
        }
        let t = (cos_angle - cos_outer) / (cos_inner - cos_outer);
        t * t * (3.0 - 2.0 * t)
    }

    /// Radiance that leaves an area light at an angle with cosine `cos_angle` from its front.
    pub fn area_radiance(light: LightRecord, cos_angle: f32) -> Vec3f {
        if cos_angle <= 0.0 {
            return vec3f(0.0, 0.0, 0.0);
        }
        if light.cos_inner == 0.0 {
            return light.emission;
        }
        light.emission * pow(cos_angle, light.cos_inner)
    }

    /// Share of its power per solid angle that a physical light sends in a world direction: interpolated in its
    /// table, whose entries hold the corners of the cells.
    pub fn distribution_density<S: SceneAccess + Copy>(
        scene: S,
        light: LightRecord,
        direction: Vec3f,
    ) -> f32 {
        let columns = light.count & 65535u32;
        let rows = light.count >> 16u32;
        let local = to_light_axes(light, direction);
        let x = acos(clamp(local.z, -1.0, 1.0)) * INVERSE_PI * f32(columns);
        // The table starts at the azimuth -π.
        let turn = turn_fraction(local) + 0.5;
        let y = (turn - floor(turn)) * f32(rows);
        let column = min(u32(x), columns - 1u32);
        let row = min(u32(y), rows - 1u32);
        let wx = clamp(x - f32(column), 0.0, 1.0);
        let wy = clamp(y - f32(row), 0.0, 1.0);
        let corners = S::attribute(scene, light.first + row * columns + column);
        let near = corners.x * (1.0 - wx) + corners.y * wx;
        let far = corners.z * (1.0 - wx) + corners.w * wx;
        near * (1.0 - wy) + far * wy
    }

    /// Density with which a point of an area light is sampled, seen from a distance under an angle with cosine
    /// `cos_light` at the lamp.
    pub fn area_pdf(light: LightRecord, squared_distance: f32, cos_light: f32) -> f32 {
        squared_distance / max(abs(cos_light) * light.cos_outer, 1.0e-20)
    }

    pub fn no_light() -> LightSample {
        LightSample { direction: vec3f(0.0, 0.0, 1.0), distance: 0.0, weight: vec3f(0.0, 0.0, 0.0), pdf: 0.0 }
    }

    /// Light that arrives at a surface point with unit normal `normal`, from a light that needs no table; from a
    /// physical light as if its density were 1 everywhere.
    pub fn sample_plain_light(
        light: LightRecord,
        point: Vec3f,
        normal: Vec3f,
        both_sides: bool,
        u: Vec2f,
    ) -> LightSample {
        if light.kind == LIGHT_DIRECTIONAL {
            return LightSample {
                direction: -light.axis,
                distance: NO_HIT,
                weight: light.emission,
                pdf: 0.0,
            };
        }
        if light.kind == LIGHT_SKY || light.kind == LIGHT_SUN {
            let mut sky = sample_sun(light, u);
            if light.kind == LIGHT_SKY {
                sky = sample_uniform_sky(normal, both_sides, u);
            }
            return from_sky(sky, light.emission);
        }
        let mut aim = light.position;
        if light.kind == LIGHT_AREA {
            aim = light.position + light.edge_u * (2.0 * u.x - 1.0) + light.edge_v * u.y;
        }
        let to_light = aim - point;
        let squared = dot(to_light, to_light);
        if squared < 1.0e-20 {
            return no_light();
        }
        let distance = sqrt(squared);
        let direction = to_light * (1.0 / distance);
        let cos_light = -dot(direction, light.axis);
        if light.kind == LIGHT_AREA {
            if cos_light <= 0.0 {
                return no_light();
            }
            let pdf = area_pdf(light, squared, cos_light);
            return LightSample {
                direction,
                distance,
                weight: area_radiance(light, cos_light) * (1.0 / pdf),
                pdf,
            };
        }
        let mut intensity = light.emission;
        if light.kind == LIGHT_SPOT {
            intensity *= spot_profile(cos_light, light.cos_inner, light.cos_outer);
        }
        LightSample { direction, distance, weight: intensity * (1.0 / squared), pdf: 0.0 }
    }

    /// Light of the given radiance from a direction that was drawn.
    pub fn from_sky(sky: SkyDirection, radiance: Vec3f) -> LightSample {
        if sky.pdf <= 0.0 {
            return no_light();
        }
        LightSample {
            direction: sky.direction,
            distance: NO_HIT,
            weight: radiance * (1.0 / sky.pdf),
            pdf: sky.pdf,
        }
    }

    /// Light that arrives at a surface point with unit normal `normal`.
    pub fn sample_light<S: SceneAccess + Copy>(
        scene: S,
        light: LightRecord,
        point: Vec3f,
        normal: Vec3f,
        both_sides: bool,
        u: Vec2f,
    ) -> LightSample {
        let tables = has::<S>(scene, FEATURE_LIGHT_TABLES);
        if tables && (light.kind == LIGHT_SKY_MAP || light.kind == LIGHT_DAYLIGHT) {
            let sky = sample_table::<S>(scene, light, u);
            return from_sky(sky, distant_radiance::<S>(scene, light, sky.direction));
        }
        let mut sample = sample_plain_light(light, point, normal, both_sides, u);
        if tables && light.kind == LIGHT_PHYSICAL {
            sample.weight *= distribution_density::<S>(scene, light, -sample.direction);
        }
        sample
    }
}
