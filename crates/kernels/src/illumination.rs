//! Local illumination: eq. 4.3 of the thesis, OpenGL's lighting with Blinn's half vector, with shadows; for plain
//! colours it comes down to Lambert's law.
//!
//! The scale of brightness, in one place: the colour of a light (d and s of eq. 4.3) is its irradiance on a
//! surface that faces it, over π. A white surface has then the radiance that it has in the path tracer. As in
//! GroIMP's own ray tracer lamps do not grow weaker with distance, unless their attenuation says so: everywhere
//! they give the irradiance of one metre. See `lamp_light`.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::bsdf::kernel::*;
    use crate::channel::kernel::*;
    use crate::coordinates::kernel::*;
    use crate::light::kernel::*;
    use crate::medium::kernel::*;
    use crate::mesh::kernel::*;
    use crate::random::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use crate::sky::kernel::*;
    use crate::traversal::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// What a ray and all that it gives rise to bring home.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct TracedLight {
        /// In W/(m² sr) per channel.
        pub radiance: Vec3f,
        /// Rays traced, shadow rays included.
        pub rays: u32,
    }

    /// How a point looks: coefficients of eq. 4.3 and of the secondary rays, for all light that arrives.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct LocalMaterial {
        /// Radiance that the surface emits by itself.
        pub emissive: Vec3f,
        pub ambient: Vec3f,
        pub diffuse: Vec3f,
        /// Lambertian transmission.
        pub diffuse_transmission: Vec3f,
        /// Of the highlights.
        pub specular: Vec3f,
        /// Exponent of the highlights.
        pub exponent: f32,
        /// Weight of the ray in the mirror direction.
        pub mirrored: Vec3f,
        /// Weight of the ray that goes on, straight or refracted.
        pub passed: Vec3f,
    }

    /// A point and from where it is seen.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct ViewedPoint {
        pub point: SurfacePoint,
        /// Unit normal for scattering, on the side of the viewer.
        pub normal: Vec3f,
        /// Unit vector towards the viewer.
        pub wo: Vec3f,
    }

    /// Channels that are read at a point: those of `material_channel` and the ambient one.
    pub const LOCAL_CHANNELS: u32 = 8;
    /// First dimension of the shadow rays; each ray of the tree has 65536 for as many lights.
    pub const DIMENSION_SHADOW: u32 = 1073741824;
    /// A shadow ray ends this fraction before the lamp that it aims at.
    pub const LAMP_END: f32 = 0.9999;

    /// The material at a point (materials-and-lights.md 1.1 and 1.2). `eta` is the refractive index on the side of
    /// the viewer divided by the one behind, `cosine` that of the viewer.
    ///
    /// What a partly transparent surface transmits diffusely, emits or reflects of the ambient light counts by
    /// the share of the light that meets it, so that leaves that are cut out by a picture have soft edges.
    pub fn local_material<S: SceneAccess + Copy>(
        scene: S,
        material: MaterialRecord,
        at: TexturePoint,
        eta: f32,
        cosine: f32,
    ) -> LocalMaterial {
        let none = vec4f(0.0, 0.0, 0.0, 0.0);
        let mut values: [Vec4f; 8] = [none, none, none, none, none, none, none, none];
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..LOCAL_CHANNELS {
            let mut channel = material.ambient;
            if i < MATERIAL_CHANNELS {
                channel = material_channel(material, i);
            }
            values[i as usize] = channel_value::<S>(scene, channel, at, missing_channel(i));
        }
        let c_d = values[0];
        let c_s = values[2];
        let c_dt = values[3];
        let c_e = values[4];
        let c_a = values[7];
        let zero = vec3f(0.0, 0.0, 0.0);
        let one = vec3f(1.0, 1.0, 1.0);
        let tau = clamp(clear_transmission(material, values[1], c_d.w), zero, one);
        let mut met: f32 = 1.0;
        let mut passed = tau;
        let mut fresnel = zero;
        if material.refractive_index > 0.0 {
            let reflected = fresnel_reflectance(eta, cosine);
            passed = tau * (1.0 - reflected);
            if (material.flags & MATERIAL_MIRRORS) != 0u32 || material.specular != NONE {
                fresnel = tau * reflected;
            }
        } else {
            met = 1.0 - smallest(undisturbed_part(material, tau, c_d.w));
        }
        let mut kept = vec3f(met, met, met);
        if (material.flags & MATERIAL_INTERPOLATED) != 0u32 {
            kept = one - tau;
        }
        let specular = max(vec3f(c_s.x, c_s.y, c_s.z), zero) * kept;
        LocalMaterial {
            emissive: max(vec3f(c_e.x, c_e.y, c_e.z), zero) * met,
            ambient: max(vec3f(c_a.x, c_a.y, c_a.z), zero) * met,
            diffuse: max(vec3f(c_d.x, c_d.y, c_d.z), zero) * kept,
            diffuse_transmission: max(vec3f(c_dt.x, c_dt.y, c_dt.z), zero) * met,
            specular,
            exponent: select(shininess_exponent(values[5].x), 4.0, material.shininess == NONE),
            mirrored: specular + fresnel,
            passed,
        }
    }

    /// Share of light from `direction` that is scattered towards the viewer by Lambert's law.
    pub fn lambert(material: LocalMaterial, normal: Vec3f, direction: Vec3f) -> Vec3f {
        let cosine = dot(normal, direction);
        if cosine >= 0.0 {
            return material.diffuse * cosine;
        }
        material.diffuse_transmission * (-cosine)
    }

    /// The bracket of eq. 4.3: `lambert` and the highlight. Ideal mirrors have none, they show what there is.
    pub fn local_illumination(material: LocalMaterial, normal: Vec3f, wo: Vec3f, direction: Vec3f) -> Vec3f {
        let value = lambert(material, normal, direction);
        if dot(normal, direction) <= 0.0 || material.exponent >= MIRROR_EXPONENT {
            return value;
        }
        // On the same side as the viewer, so that the sum cannot vanish.
        let across = wo + direction;
        let along = dot(normal, across) / sqrt(max(dot(across, across), 1.0e-20));
        value + material.specular * pow(clamp(along, 1.0e-6, 1.0), material.exponent)
    }

    /// How a lamp fades with distance in metres. GroIMP keeps exponent and distance for its previews and for
    /// POV-Ray, whose law this is; unverified for GroIMP's preview. With the exponent 0 lamps do not fade.
    pub fn attenuation(exponent: f32, reference: f32, distance: f32) -> f32 {
        if exponent <= 0.0 || reference <= 0.0 {
            return 1.0;
        }
        2.0 / (1.0 + pow(distance / reference, exponent))
    }

    /// Direction, distance and colour (as `weight`) of a light that is no sky, seen from a point; an area light as
    /// if it stood in its middle.
    pub fn lamp_light<S: SceneAccess + Copy>(scene: S, light: LightRecord, point: Vec3f) -> LightSample {
        if light.kind == LIGHT_DIRECTIONAL || light.kind == LIGHT_SUN {
            let solid_angle = select(1.0, TWO_PI * light.cos_inner, light.kind == LIGHT_SUN);
            return LightSample {
                direction: -light.axis,
                distance: NO_HIT,
                weight: light.emission * (solid_angle * INVERSE_PI),
                pdf: 0.0,
            };
        }
        let is_area = light.kind == LIGHT_AREA;
        let to_lamp = light.position + light.edge_v * select(0.0, 0.5, is_area) - point;
        let distance = sqrt(dot(to_lamp, to_lamp));
        if distance < 1.0e-10 {
            return no_light();
        }
        let direction = to_lamp * (1.0 / distance);
        let cos_light = -dot(direction, light.axis);
        let mut intensity = light.emission;
        let mut fading = vec2f(light.edge_u.x, light.edge_u.y);
        if is_area {
            intensity = area_radiance(light, cos_light) * (max(cos_light, 0.0) * light.cos_outer);
            fading = vec2f(0.0, 0.0);
        } else if light.kind == LIGHT_SPOT {
            intensity *= spot_profile(cos_light, light.cos_inner, light.cos_outer);
        } else if light.kind == LIGHT_PHYSICAL {
            intensity *= distribution_density::<S>(scene, light, -direction);
            fading = vec2f(light.cos_inner, light.cos_outer);
        }
        let weight = intensity * (attenuation(fading.x, fading.y, distance) * INVERSE_PI);
        LightSample { direction, distance, weight, pdf: 0.0 }
    }

    /// Place `i` of `count` well spread points in the unit square (a Fibonacci lattice), all moved by `shift`, round
    /// the edges.
    pub fn spread_point(i: u32, count: u32, shift: Vec2f) -> Vec2f {
        let u = f32(i) / f32(count) + shift.x;
        // The golden ratio as a fraction of 2³².
        let v = unit_float(i * 2654435769u32) + shift.y;
        vec2f(min(u - floor(u), 0.99999994), min(v - floor(v), 0.99999994))
    }

    /// Light of all lamps and skies that is scattered towards the viewer, shadow rays included. `step` is the number
    /// of the ray in the tree.
    pub fn lit_radiance<S: SceneAccess + Copy>(
        scene: S,
        settings: LaunchSettings,
        key: SampleKey,
        step: u32,
        viewed: ViewedPoint,
        material: LocalMaterial,
    ) -> TracedLight {
        let point = viewed.point;
        let normal = viewed.normal;
        let wo = viewed.wo;
        let mut result = TracedLight { radiance: vec3f(0.0, 0.0, 0.0), rays: 0 };
        let transmits_light = largest(material.diffuse_transmission) > 0.0;
        let lights = S::header(scene).all_lights;
        #[wgsl_allow(non_literal_loop_bounds)]
        for index in 0..lights {
            let light = S::light(scene, index);
            // A sky without importance is only seen.
            if light.kind != LIGHT_GROUP && light.importance > 0.0 {
                let sky = is_sky(light.kind);
                let has_shadow = light.shadowless == 0u32;
                let soft = sky || (has_shadow && light.kind == LIGHT_AREA);
                let mut lamp = no_light();
                let mut scattered = vec3f(0.0, 0.0, 0.0);
                let mut rays: u32 = 1;
                if soft {
                    rays = settings.shadow_samples;
                }
                if !sky {
                    lamp = lamp_light::<S>(scene, light, point.position);
                    scattered = local_illumination(material, normal, wo, lamp.direction) * lamp.weight;
                    // The middle of the lamp lights nothing, so no part of it does.
                    if is_dark(scattered) {
                        rays = 0;
                    }
                }
                let mut shift = vec4f(0.0, 0.0, 0.0, 0.0);
                if soft && rays > 0u32 {
                    shift = random4(key, DIMENSION_SHADOW + (step << 16u32) + index);
                }
                let mut arrived = vec3f(0.0, 0.0, 0.0);
                #[wgsl_allow(non_literal_loop_bounds)]
                for i in 0..rays {
                    let mut direction = lamp.direction;
                    let mut distance = lamp.distance;
                    let mut share = scattered;
                    if soft {
                        let u = spread_point(i, rays, vec2f(shift.x, shift.y));
                        let sample =
                            sample_light::<S>(scene, light, point.position, normal, transmits_light, u);
                        direction = sample.direction;
                        distance = sample.distance;
                        if sky {
                            share = lambert(material, normal, direction) * sample.weight * INVERSE_PI;
                        } else if dot(normal, direction) * dot(normal, lamp.direction) <= 0.0 {
                            // This part of the lamp is below the surface.
                            share = vec3f(0.0, 0.0, 0.0);
                        }
                    }
                    if !is_dark(share) && same_side(point, normal, wo, direction) {
                        let mut open = vec3f(1.0, 1.0, 1.0);
                        if has_shadow {
                            let ray = Ray { origin: offset_origin(point, direction), direction };
                            let end = select(NO_HIT, distance * LAMP_END, distance < NO_HIT);
                            open = shadow_transmittance::<S>(scene, ray, end, true);
                            result.rays += 1;
                        }
                        arrived += share * open;
                    }
                }
                if rays > 0u32 {
                    result.radiance += arrived * (1.0 / f32(rays));
                }
            }
        }
        result
    }
}
