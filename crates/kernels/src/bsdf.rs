//! GroIMP's materials as a scattering function (materials-and-lights.md 1.1 and 1.2).
//!
//! Values include the cosine of the scattered direction; densities are per solid angle; directions point away
//! from the surface. The coefficients at a point are normalised so that no more light leaves than arrives.
//!
//! Deviation from GroIMP: for exponents below 1 the glossy lobe (n+2)/(2π) cosⁿ / max(cos, cos) would reflect up
//! to 7 % more than its coefficient at oblique angles; there it is scaled down, see `glossy_norm`.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::channel::kernel::*;
    use crate::coordinates::kernel::*;
    use crate::medium::kernel::*;
    use crate::records::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// Scattering of light at a point: coefficients of the lobes.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct Bsdf {
        /// Lambertian reflection.
        pub diffuse: Vec3f,
        /// Lambertian transmission.
        pub diffuse_transmission: Vec3f,
        /// Reflection round the mirror direction.
        pub glossy: Vec3f,
        /// Exponent of the mirror lobe; `MIRROR_EXPONENT` and above is an ideal mirror.
        pub exponent: f32,
        /// Transmission round the straight or refracted direction.
        pub glossy_transmission: Vec3f,
        pub transmission_exponent: f32,
        /// Undisturbed passage, on top of what the opacity lets through.
        pub straight: Vec3f,
        /// Radiance that the surface emits by itself.
        pub emissive: Vec3f,
        /// Refractive index on the side of the viewer divided by the one behind the surface.
        pub eta: f32,
    }

    /// A scattered direction.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct BsdfSample {
        pub direction: Vec3f,
        /// Value divided by density; zero if nothing is scattered there.
        pub weight: Vec3f,
        /// Density per solid angle; 0 for ideal mirrors.
        pub pdf: f32,
        pub event: u32,
    }

    /// Nothing was scattered: the light is absorbed.
    pub const EVENT_ABSORBED: u32 = 0;
    /// Scattered into a direction with a finite density.
    pub const EVENT_SCATTERED: u32 = 1;
    /// Reflected by an ideal mirror, or refracted.
    pub const EVENT_MIRRORED: u32 = 2;
    /// Passed the surface undisturbed.
    pub const EVENT_PASSED: u32 = 3;

    /// Lobes at least this sharp are treated as ideal (GroIMP: 2π·10¹⁰ - 2, beyond the precision of floats).
    pub const MIRROR_EXPONENT: f32 = 100000.0;

    /// GroIMP's map from shininess to exponent.
    pub fn shininess_exponent(shininess: f32) -> f32 {
        let y = shininess * (2.0 - shininess);
        if y <= 0.0 {
            return 0.0;
        }
        if y >= 0.99999 {
            return MIRROR_EXPONENT;
        }
        min(-2.0 / log(y), MIRROR_EXPONENT)
    }

    /// Transparency per channel: constant or textured transparency joined with the alpha of the diffuse channel
    /// and the opacity of the material: alpha 0 is clear.
    pub fn clear_transmission(material: MaterialRecord, transparency: Vec4f, alpha: f32) -> Vec3f {
        let cover = alpha * material.opacity;
        let tau = clamp(
            vec3f(transparency.x, transparency.y, transparency.z),
            vec3f(0.0, 0.0, 0.0),
            vec3f(1.0, 1.0, 1.0),
        );
        vec3f(1.0 - cover, 1.0 - cover, 1.0 - cover) + tau * cover
    }

    /// Channels of a material that are read at a point; the first two decide what passes undisturbed.
    pub const MATERIAL_CHANNELS: u32 = 7;
    pub const PASSING_CHANNELS: u32 = 2;

    /// Index of a channel of a material: 0 diffuse, 1 transparency, 2 specular, 3 diffuse transparency, 4 emissive,
    /// 5 shininess, 6 transparency shininess.
    pub fn material_channel(material: MaterialRecord, number: u32) -> u32 {
        if number == 0u32 {
            return material.diffuse;
        }
        if number == 1u32 {
            return material.transparency;
        }
        if number == 2u32 {
            return material.specular;
        }
        if number == 3u32 {
            return material.diffuse_transparency;
        }
        if number == 4u32 {
            return material.emissive;
        }
        if number == 5u32 {
            return material.shininess;
        }
        material.transparency_shininess
    }

    /// What a channel that is not there counts as: black, the diffuse one grey.
    pub fn missing_channel(number: u32) -> Vec4f {
        if number == 0u32 {
            return vec4f(0.5, 0.5, 0.5, 1.0);
        }
        vec4f(0.0, 0.0, 0.0, 1.0)
    }

    /// Whether a material is nothing but Lambertian reflection and transmission.
    pub fn is_lambertian<S: SceneAccess + Copy>(scene: S, material: MaterialRecord) -> bool {
        !has::<S>(scene, FEATURE_LOBES) || (material.flags & MATERIAL_LAMBERTIAN) != 0u32
    }

    /// Channels that decide what passes a surface undisturbed: those of Lambertian ones have no transparency.
    pub fn passing_channels<S: SceneAccess + Copy>(scene: S, material: MaterialRecord) -> u32 {
        select(PASSING_CHANNELS, 1u32, is_lambertian::<S>(scene, material))
    }

    /// The part of the transparency `tau` that is undisturbed passage. A sharp transmission lobe without refraction
    /// is such a passage; of a blurred one only the cut-out is.
    pub fn undisturbed_part(material: MaterialRecord, tau: Vec3f, alpha: f32) -> Vec3f {
        if material.transparency_shininess != NONE {
            let clear = clamp(1.0 - alpha * material.opacity, 0.0, 1.0);
            return vec3f(clear, clear, clear);
        }
        clamp(tau, vec3f(0.0, 0.0, 0.0), vec3f(1.0, 1.0, 1.0))
    }

    /// Undisturbed passage per channel of a surface that a shadow ray crosses; refracting surfaces let pass nothing
    /// undisturbed, unless `through_bodies` says that bending shall not count.
    pub fn surface_transmittance<S: SceneAccess + Copy>(
        scene: S,
        material: MaterialRecord,
        at: TexturePoint,
        through_bodies: bool,
    ) -> Vec3f {
        if has::<S>(scene, FEATURE_MEDIA) && material.refractive_index > 0.0 && !through_bodies {
            return vec3f(0.0, 0.0, 0.0);
        }
        // A loop, so that graphics cards hold the interpreter of channels once.
        let zero = vec4f(0.0, 0.0, 0.0, 0.0);
        let mut values: [Vec4f; 2] = [zero, zero];
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..passing_channels::<S>(scene, material) {
            let channel = material_channel(material, i);
            values[i as usize] = channel_value::<S>(scene, channel, at, missing_channel(i));
        }
        let alpha = values[0].w;
        undisturbed_part(material, clear_transmission(material, values[1], alpha), alpha)
    }

    /// The material of one side of a surface.
    pub fn sided_material<S: SceneAccess + Copy>(scene: S, index: u32, front: bool) -> MaterialRecord {
        let material = S::material(scene, index);
        if !has::<S>(scene, FEATURE_BACKS) || front || material.back == NONE {
            return material;
        }
        S::material(scene, material.back)
    }

    /// The scattering function of a surface that is nothing but Lambertian; no more light leaves than arrives.
    pub fn lambertian_bsdf(reflected: Vec3f, transmitted: Vec3f) -> Bsdf {
        let zero = vec3f(0.0, 0.0, 0.0);
        let diffuse = max(reflected, zero);
        let diffuse_transmission = max(transmitted, zero);
        let scale = 1.0 / max(largest(diffuse + diffuse_transmission), 1.0);
        Bsdf {
            diffuse: diffuse * scale,
            diffuse_transmission: diffuse_transmission * scale,
            glossy: zero,
            exponent: MIRROR_EXPONENT,
            glossy_transmission: zero,
            transmission_exponent: MIRROR_EXPONENT,
            straight: zero,
            emissive: zero,
            eta: 1.0,
        }
    }

    /// The scattering function at a point, given that the ray met the surface (see the module `traversal`). `eta` is the
    /// refractive index on the side of the viewer divided by the one behind, `cosine` that of the viewer.
    pub fn material_bsdf<S: SceneAccess + Copy>(
        scene: S,
        material: MaterialRecord,
        at: TexturePoint,
        eta: f32,
        cosine: f32,
    ) -> Bsdf {
        if (material.flags & MATERIAL_UNIFORM) != 0u32 {
            return lambertian_bsdf(material.diffuse_color, material.transmitted_color);
        }
        let none = vec4f(0.0, 0.0, 0.0, 0.0);
        let mut values: [Vec4f; 7] = [none, none, none, none, none, none, none];
        // Of Lambertian surfaces only the channels 0 and 3 count.
        let lambertian = is_lambertian::<S>(scene, material);
        let step = select(1u32, 3u32, lambertian);
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..select(MATERIAL_CHANNELS, 2u32, lambertian) {
            let number = i * step;
            let channel = material_channel(material, number);
            values[number as usize] = channel_value::<S>(scene, channel, at, missing_channel(number));
        }
        let c_d = values[0];
        if lambertian {
            let transmitted = vec3f(values[3].x, values[3].y, values[3].z);
            return lambertian_bsdf(vec3f(c_d.x, c_d.y, c_d.z), transmitted);
        }
        let tau = clear_transmission(material, values[1], c_d.w);
        let c_s = values[2];
        let c_dt = values[3];
        let emissive = values[4];

        let one = vec3f(1.0, 1.0, 1.0);
        let zero = vec3f(0.0, 0.0, 0.0);
        let interpolated = (material.flags & MATERIAL_INTERPOLATED) != 0u32;
        let mut diffuse = max(vec3f(c_d.x, c_d.y, c_d.z), zero);
        let mut glossy = max(vec3f(c_s.x, c_s.y, c_s.z), zero);
        let mut exponent = select(shininess_exponent(values[5].x), 4.0, material.shininess == NONE);
        let mut transmission_exponent = shininess_exponent(values[6].x);
        // A surface cut out by the alpha of its picture transmits diffusely only where it is.
        let diffuse_transmission = max(vec3f(c_dt.x, c_dt.y, c_dt.z), zero);
        if interpolated {
            diffuse *= one - tau;
            glossy *= one - tau;
        }

        let mut straight = zero;
        let mut blurred = zero;
        if material.refractive_index > 0.0 {
            // All light that arrives meets the surface. What is not refracted is reflected, but GroIMP's Phong
            // without a specular channel loses it.
            let reflected = fresnel_reflectance(eta, cosine);
            let clear = clamp(tau, zero, one);
            blurred = clear * (1.0 - reflected);
            if (material.flags & MATERIAL_MIRRORS) != 0u32 {
                glossy = clear * reflected;
                exponent = MIRROR_EXPONENT;
            }
            if material.specular != NONE {
                glossy += clear * reflected;
            }
            if material.transparency_shininess == NONE {
                transmission_exponent = MIRROR_EXPONENT;
            }
        } else {
            // The coefficients hold for all light that arrives; here only the share `opacity` arrives. What passes
            // undisturbed in all channels was dealt with by the opacity, the coloured rest is left.
            let opacity = max(1.0 - smallest(undisturbed_part(material, tau, c_d.w)), 1.0e-6);
            if material.transparency_shininess == NONE {
                let passed = smallest(tau);
                straight = max(tau - vec3f(passed, passed, passed), zero);
            } else {
                let cut = 1.0 - clamp(c_d.w * material.opacity, 0.0, 1.0);
                blurred = max(tau - vec3f(cut, cut, cut), zero);
            }
            if interpolated {
                diffuse *= 1.0 / opacity;
                glossy *= 1.0 / opacity;
            }
            straight *= 1.0 / opacity;
            blurred *= 1.0 / opacity;
        }

        // No more light may leave than arrives.
        let total = largest(diffuse + glossy + diffuse_transmission + straight + blurred);
        let scale = 1.0 / max(total, 1.0);
        Bsdf {
            diffuse: diffuse * scale,
            diffuse_transmission: diffuse_transmission * scale,
            glossy: glossy * scale,
            exponent,
            glossy_transmission: blurred * scale,
            transmission_exponent,
            straight: straight * scale,
            emissive: max(vec3f(emissive.x, emissive.y, emissive.z), zero),
            eta,
        }
    }

    /// Factor of a glossy lobe: (n+2)/(2π) as in GroIMP, less for exponents below 1, so that the lobe never
    /// reflects more than its coefficient (measured: a test integrates it).
    pub fn glossy_norm(exponent: f32) -> f32 {
        let excess = 1.0 + 0.08 * max(0.0, 1.0 - exponent);
        (exponent + 2.0) / (TWO_PI * excess)
    }

    /// Value of a glossy lobe with axis cosine `along`, cosine included.
    pub fn glossy_value(along: f32, exponent: f32, cos_in: f32, cos_out: f32) -> f32 {
        if along <= 0.0 {
            return 0.0;
        }
        glossy_norm(exponent) * pow(along, exponent) * (cos_in / max(cos_in, cos_out))
    }

    /// Value times cosine for light that arrives from `wi` and leaves to `wo`; ideal lobes excluded.
    /// `normal` is on the side of `wo`.
    pub fn evaluate_bsdf(bsdf: Bsdf, normal: Vec3f, wo: Vec3f, wi: Vec3f) -> Vec3f {
        let cos_o = dot(normal, wo);
        let cos_i = dot(normal, wi);
        if cos_i > 0.0 {
            let mut value = bsdf.diffuse * (cos_i * INVERSE_PI);
            if bsdf.exponent < MIRROR_EXPONENT {
                let along = dot(reflect(-wo, normal), wi);
                value += bsdf.glossy * glossy_value(along, bsdf.exponent, cos_i, cos_o);
            }
            return value;
        }
        let mut value = bsdf.diffuse_transmission * (-cos_i * INVERSE_PI);
        if bsdf.transmission_exponent < MIRROR_EXPONENT {
            let along = dot(refracted_direction(bsdf.eta, normal, wo), wi);
            value +=
                bsdf.glossy_transmission * glossy_value(along, bsdf.transmission_exponent, -cos_i, cos_o);
        }
        // Radiance is squeezed into a smaller solid angle in the denser medium (Veach 1997, 5.2).
        value * (bsdf.eta * bsdf.eta)
    }

    /// Probabilities of the lobes: diffuse, glossy, diffuse transmission, glossy transmission; what is missing
    /// to 1 is undisturbed passage.
    pub fn lobe_probabilities(bsdf: Bsdf) -> Vec4f {
        let lobes = vec4f(
            luminance(bsdf.diffuse),
            luminance(bsdf.glossy),
            luminance(bsdf.diffuse_transmission),
            luminance(bsdf.glossy_transmission),
        );
        let sum = lobes.x + lobes.y + lobes.z + lobes.w + luminance(bsdf.straight);
        lobes * (1.0 / max(sum, 1.0e-20))
    }

    /// Density with which `sample_bsdf` draws `wi`; ideal lobes excluded.
    pub fn bsdf_pdf(bsdf: Bsdf, normal: Vec3f, wo: Vec3f, wi: Vec3f) -> f32 {
        let chance = lobe_probabilities(bsdf);
        let cos_i = dot(normal, wi);
        if cos_i > 0.0 {
            let mut pdf = chance.x * cosine_hemisphere_pdf(cos_i);
            if bsdf.exponent < MIRROR_EXPONENT {
                pdf += chance.y * power_cosine_pdf(dot(reflect(-wo, normal), wi), bsdf.exponent);
            }
            return pdf;
        }
        let mut pdf = chance.z * cosine_hemisphere_pdf(-cos_i);
        if bsdf.transmission_exponent < MIRROR_EXPONENT {
            let along = dot(refracted_direction(bsdf.eta, normal, wo), wi);
            pdf += chance.w * power_cosine_pdf(along, bsdf.transmission_exponent);
        }
        pdf
    }

    /// True if light sampling may find light on the side opposite to where it goes.
    pub fn transmits(bsdf: Bsdf) -> bool {
        let blurred = bsdf.transmission_exponent < MIRROR_EXPONENT;
        largest(bsdf.diffuse_transmission) > 0.0 || (blurred && largest(bsdf.glossy_transmission) > 0.0)
    }

    /// Draws a direction; `u.x` chooses the lobe, and what is left of it and `u.y` the direction within the lobe.
    pub fn sample_bsdf(bsdf: Bsdf, normal: Vec3f, wo: Vec3f, u: Vec2f) -> BsdfSample {
        let chance = lobe_probabilities(bsdf);
        let mut sample =
            BsdfSample { direction: normal, weight: vec3f(0.0, 0.0, 0.0), pdf: 0.0, event: EVENT_ABSORBED };
        let up_to_glossy = chance.x + chance.y;
        let up_to_diffuse_transmission = up_to_glossy + chance.z;
        let up_to_glossy_transmission = up_to_diffuse_transmission + chance.w;
        if u.x < chance.x {
            let within = vec2f(stretched(u.x, 0.0, chance.x), u.y);
            sample.direction = around_axis(normal, cosine_hemisphere(within));
        } else if u.x < up_to_glossy {
            let mirrored = reflect(-wo, normal);
            if bsdf.exponent >= MIRROR_EXPONENT {
                sample.direction = mirrored;
                sample.weight = bsdf.glossy * (1.0 / chance.y);
                sample.event = EVENT_MIRRORED;
                return sample;
            }
            let within = vec2f(stretched(u.x, chance.x, chance.y), u.y);
            sample.direction = around_axis(mirrored, power_cosine(within, bsdf.exponent));
            if dot(sample.direction, normal) <= 0.0 {
                return sample;
            }
        } else if u.x < up_to_diffuse_transmission {
            let within = vec2f(stretched(u.x, up_to_glossy, chance.z), u.y);
            sample.direction = around_axis(-normal, cosine_hemisphere(within));
        } else if u.x < up_to_glossy_transmission {
            let onwards = refracted_direction(bsdf.eta, normal, wo);
            if bsdf.transmission_exponent >= MIRROR_EXPONENT {
                sample.direction = onwards;
                sample.weight = bsdf.glossy_transmission * (bsdf.eta * bsdf.eta / chance.w);
                sample.event = EVENT_MIRRORED;
                return sample;
            }
            let within = vec2f(stretched(u.x, up_to_diffuse_transmission, chance.w), u.y);
            sample.direction = around_axis(onwards, power_cosine(within, bsdf.transmission_exponent));
            if dot(sample.direction, normal) >= 0.0 {
                return sample;
            }
        } else {
            let rest = 1.0 - up_to_glossy_transmission;
            if rest > 1.0e-6 {
                sample.direction = -wo;
                sample.weight = bsdf.straight * (1.0 / rest);
                sample.event = EVENT_PASSED;
            }
            return sample;
        }
        sample.pdf = bsdf_pdf(bsdf, normal, wo, sample.direction);
        if sample.pdf > 0.0 {
            sample.weight = evaluate_bsdf(bsdf, normal, wo, sample.direction) * (1.0 / sample.pdf);
            sample.event = EVENT_SCATTERED;
        }
        sample
    }
}
