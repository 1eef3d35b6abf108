//! Lights: choosing one, sampling it, and the densities that multiple importance sampling needs.
//!
//! Formulas: materials-and-lights.md chapter 3. Densities are per solid angle; lights without extent have
//! density 0 and are only ever sampled here.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
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

    /// A chosen light and the probability with which it is chosen.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct LightChoice {
        pub index: u32,
        pub probability: f32,
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

    /// Estimate of the irradiance that a light causes at a point if nothing stands between; 0 only where the
    /// light cannot contribute at all.
    pub fn light_importance(light: LightRecord, point: Vec3f) -> f32 {
        if light.kind == LIGHT_DIRECTIONAL || light.kind == LIGHT_SKY {
            return light.importance;
        }
        if light.kind == LIGHT_AREA {
            let from_light = point - (light.position + light.edge_v * 0.5);
            if dot(from_light, light.axis) <= 0.0 {
                return 0.0;
            }
            return light.importance / (dot(from_light, from_light) + light.cos_outer);
        }
        let from_light = point - light.position;
        let squared = max(dot(from_light, from_light), 1.0e-20);
        if light.kind == LIGHT_SPOT && dot(from_light, light.axis) <= light.cos_outer * sqrt(squared) {
            return 0.0;
        }
        light.importance / squared
    }

    /// Sum of the importances of all lights at a point.
    pub fn total_importance<S: SceneAccess + Copy>(scene: S, point: Vec3f) -> f32 {
        let lights = S::header(scene).lights;
        let mut total: f32 = 0.0;
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..lights {
            total += light_importance(S::light(scene, i), point);
        }
        total
    }

    /// Chooses a light in proportion to its importance at a point; `total` is `total_importance` there.
    pub fn choose_light<S: SceneAccess + Copy>(scene: S, point: Vec3f, total: f32, u: f32) -> LightChoice {
        let lights = S::header(scene).lights;
        let mut rest = u * total;
        let mut choice = LightChoice { index: NONE, probability: 0.0 };
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..lights {
            let importance = light_importance(S::light(scene, i), point);
            // The last light that can contribute is taken when rounding leaves a rest.
            if rest >= 0.0 && importance > 0.0 {
                choice = LightChoice { index: i, probability: importance / total };
            }
            rest -= importance;
        }
        choice
    }

    /// Density with which the sky is sampled in `direction` at a surface: by the cosine, on the side of `normal`
    /// or on both.
    pub fn sky_pdf(normal: Vec3f, direction: Vec3f, both_sides: bool) -> f32 {
        let cosine = dot(normal, direction);
        if both_sides {
            return 0.5 * abs(cosine) * INVERSE_PI;
        }
        cosine_hemisphere_pdf(cosine)
    }

    /// Density with which a point of an area light is sampled, seen from a distance under an angle with cosine
    /// `cos_light` at the lamp.
    pub fn area_pdf(light: LightRecord, squared_distance: f32, cos_light: f32) -> f32 {
        squared_distance / max(abs(cos_light) * light.cos_outer, 1.0e-20)
    }

    pub fn no_light() -> LightSample {
        LightSample { direction: vec3f(0.0, 0.0, 1.0), distance: 0.0, weight: vec3f(0.0, 0.0, 0.0), pdf: 0.0 }
    }

    /// Light that arrives at a surface point with unit normal `normal`.
    pub fn sample_light(
        light: LightRecord,
        point: Vec3f,
        normal: Vec3f,
        both_sides: bool,
        u: Vec2f,
    ) -> LightSample {
        if light.kind == LIGHT_SKY {
            let mut side = 1.0;
            let mut first = u.x;
            if both_sides {
                // One number chooses the side and, stretched, the angle.
                if first < 0.5 {
                    first *= 2.0;
                } else {
                    first = min(first * 2.0 - 1.0, 0.99999994);
                    side = -1.0;
                }
            }
            let direction = around_axis(normal * side, cosine_hemisphere(vec2f(first, u.y)));
            let pdf = sky_pdf(normal, direction, both_sides);
            if pdf <= 0.0 {
                return no_light();
            }
            return LightSample { direction, distance: NO_HIT, weight: light.emission * (1.0 / pdf), pdf };
        }
        if light.kind == LIGHT_DIRECTIONAL {
            return LightSample {
                direction: -light.axis,
                distance: NO_HIT,
                weight: light.emission,
                pdf: 0.0,
            };
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
}
