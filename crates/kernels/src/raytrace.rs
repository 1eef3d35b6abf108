//! The classical ray tracer (Whitted 1980), the first renderer of the thesis: local illumination, ideal reflection
//! and refraction.
//!
//! No light goes from one matte surface to another. The tree of secondary rays is walked with a list of a few
//! waiting rays instead of recursion.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::illumination::kernel::*;
    use crate::light::kernel::*;
    use crate::medium::kernel::*;
    use crate::mesh::kernel::*;
    use crate::random::kernel::*;
    use crate::records::kernel::*;
    use crate::shading::kernel::*;
    use crate::shape::kernel::*;
    use crate::sky::kernel::*;
    use crate::traversal::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// A ray of the tree that is still to be followed.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct PendingRay {
        pub origin: Vec3f,
        pub direction: Vec3f,
        /// Share of its radiance that reaches the picture.
        pub weight: Vec3f,
        /// Surfaces that the light has touched.
        pub touched: u32,
        pub media: Media,
    }

    /// Rays that may wait at the same time; beyond that the weakest are given up. A tree of two rays per surface
    /// needs one place for each level.
    pub const MOST_PENDING: u32 = 12;
    /// Rays of a smaller weight are not followed: less than the smallest step of a picture with 8 bits.
    pub const LEAST_WEIGHT: f32 = 0.00390625;
    /// Bound on the rays of a tree; only reached between surfaces that reflect more than they receive.
    pub const MOST_RAYS: u32 = 512;
    /// Radiance that a ray sees that hits nothing.
    pub fn beyond_radiance<S: SceneAccess + Copy>(scene: S, background: Vec3f, direction: Vec3f) -> Vec3f {
        let lights = S::header(scene).distant_lights;
        let mut sum = background_radiance::<S>(scene, background);
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..lights {
            sum += distant_radiance::<S>(scene, S::light(scene, i), direction);
        }
        sum
    }

    /// Follows a camera ray and all rays that it gives rise to; light touches at most `depth` surfaces on its way
    /// to the camera and may come from a lamp or sky seen in the last of them.
    pub fn trace_rays<S: SceneAccess + Copy>(
        scene: S,
        settings: LaunchSettings,
        key: SampleKey,
        first: Ray,
    ) -> TracedLight {
        let header = S::header(scene);
        let zero = vec3f(0.0, 0.0, 0.0);
        let mut result = TracedLight { radiance: zero, rays: 0 };
        let none =
            PendingRay { origin: zero, direction: zero, weight: zero, touched: 0, media: empty_space() };
        let mut pending: [PendingRay; 12] =
            [none, none, none, none, none, none, none, none, none, none, none, none];
        let mut waiting: u32 = 0;
        let mut current = none;
        current.origin = first.origin;
        current.direction = first.direction;
        current.weight = vec3f(1.0, 1.0, 1.0);

        #[wgsl_allow(non_literal_loop_bounds)]
        for step in 0..MOST_RAYS {
            let ray = Ray { origin: current.origin, direction: current.direction };
            let hit = closest_hit::<S>(scene, ray, key, EVERY_SURFACE);
            result.rays += 1;
            let mut mirrored = none;
            let mut passed = none;
            if hit.object == NONE {
                result.radiance +=
                    current.weight * beyond_radiance::<S>(scene, settings.background, ray.direction);
            } else {
                let surface = S::surface(scene, hit.object);
                let met = shading_point::<S>(scene, ray, hit);
                let point = met.point;
                let record = met.material;
                let normal = met.normal;
                let wo = -ray.direction;
                let front = met.cos_front >= 0.0;
                let refracts = record.refractive_index > 0.0;
                let outside = leave_medium(current.media, met.body);
                let mut eta: f32 = 1.0;
                if refracts {
                    let inside = record.refractive_index;
                    eta = select(inside / outside.indices.x, outside.indices.x / inside, front);
                }
                let material = local_material::<S>(scene, record, met.at, eta, dot(normal, wo));

                let mut seen = material.emissive;
                if surface.light != NONE {
                    seen += area_radiance(S::light(scene, surface.light), met.cos_front);
                }
                let goes_on = current.touched < settings.depth;
                if goes_on {
                    seen += material.ambient * header.ambient * INVERSE_PI;
                    let viewed = ViewedPoint { point, normal, wo };
                    let lit = lit_radiance::<S>(scene, settings, key, step, viewed, material);
                    seen += lit.radiance;
                    result.rays += lit.rays;
                    let direction = reflect(-wo, normal);
                    if same_side(point, normal, wo, direction) {
                        mirrored = PendingRay {
                            origin: offset_origin(point, direction),
                            direction,
                            weight: current.weight * material.mirrored,
                            touched: current.touched + 1u32,
                            media: current.media,
                        };
                    }
                }
                result.radiance += current.weight * seen;
                if !refracts {
                    // Undisturbed passage is no event, as in the path tracer.
                    passed = current;
                    passed.weight = current.weight * material.passed;
                    passed.origin = offset_origin(point, ray.direction);
                } else if goes_on {
                    let direction = refracted_direction(eta, normal, wo);
                    let mut media = outside;
                    if front {
                        media = enter_medium(current.media, met.body, record.refractive_index);
                    }
                    passed = PendingRay {
                        origin: offset_origin(point, direction),
                        direction,
                        weight: current.weight * material.passed,
                        touched: current.touched + 1u32,
                        media,
                    };
                }
            }

            // The stronger ray is followed, the other waits.
            let mirrored_weight = largest(mirrored.weight);
            let passed_weight = largest(passed.weight);
            let mut weaker = passed;
            if mirrored_weight >= passed_weight {
                current = mirrored;
            } else {
                current = passed;
                weaker = mirrored;
            }
            let weaker_weight = min(mirrored_weight, passed_weight);
            if weaker_weight >= LEAST_WEIGHT {
                let mut place = waiting;
                if waiting < MOST_PENDING {
                    waiting += 1;
                } else {
                    let mut least = weaker_weight;
                    #[wgsl_allow(non_literal_loop_bounds)]
                    for i in 0..MOST_PENDING {
                        let weight = largest(pending[i as usize].weight);
                        if weight < least {
                            least = weight;
                            place = i;
                        }
                    }
                }
                if place < MOST_PENDING {
                    pending[place as usize] = weaker;
                }
            }
            if max(mirrored_weight, passed_weight) < LEAST_WEIGHT {
                if waiting == 0u32 {
                    return result;
                }
                waiting -= 1;
                current = pending[waiting as usize];
            }
        }
        result
    }
}
