//! Which object a ray hits first, and how much light passes along a shadow ray.
//!
//! Opacity is resolved here: a leaf that is cut out by the alpha of its picture is passed where it is not, on
//! camera rays, scattered rays and shadow rays alike.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::bsdf::kernel::*;
    use crate::coordinates::kernel::*;
    use crate::mesh::kernel::*;
    use crate::random::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use wgsl_rs::std::*;

    /// The first object along a ray; `object` is `NONE` if there is none.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct Hit {
        pub shape: ShapeHit,
        pub object: u32,
    }

    /// Levels of the hierarchy that the traversal stack can hold; the compiler of scenes keeps to it.
    pub const MAX_BVH_DEPTH: u32 = 64;
    /// A convex shape is hit at most twice by a ray; an open one may show both sides of its inside.
    pub const MAX_HITS_PER_OBJECT: u32 = 4;

    /// Reciprocals that are finite also for rays parallel to an axis.
    pub fn inverse_direction(d: Vec3f) -> Vec3f {
        vec3f(1.0 / away_from_zero(d.x), 1.0 / away_from_zero(d.y), 1.0 / away_from_zero(d.z))
    }

    /// Distance at which a ray enters a box, or `NO_HIT`. Conservative: rounding never loses a box (Ize, "Robust
    /// BVH Ray Traversal", JCGT 2(2), 2013).
    pub fn box_entry(origin: Vec3f, inverse: Vec3f, low: Vec3f, high: Vec3f, t_max: f32) -> f32 {
        let a = (low - origin) * inverse;
        let b = (high - origin) * inverse;
        let near = min(a, b);
        let far = max(a, b);
        let t_in = max(max(near.x, near.y), max(near.z, 0.0));
        let t_out = min(min(far.x, far.y), min(far.z, t_max));
        select(NO_HIT, t_in, t_in <= t_out * 1.0000004)
    }

    /// Where channels are evaluated for a hit that is not yet known to count.
    pub fn hit_texture_point<S: SceneAccess + Copy>(
        scene: S,
        index: u32,
        shape: ShapeRecord,
        material: MaterialRecord,
        ray: Ray,
        hit: ShapeHit,
    ) -> TexturePoint {
        let p = hit_point(shape, ray, hit);
        let surface = S::surface(scene, index);
        let weights = texture_coordinates(shape, surface.v_scale, hit.face, p);
        let uv = attribute_uv::<S>(scene, shape, surface, weights);
        texture_point::<S>(scene, shape, surface, material, p, uv)
    }

    /// Joins an object to the closest hit so far. Partly transparent surfaces are met with the probability of
    /// their opacity; the decision depends on the sample, the segment and the object alone (on the triangle in
    /// case of meshes), so that the order in which objects are visited does not matter.
    pub fn closer_hit<S: SceneAccess + Copy>(
        scene: S,
        index: u32,
        ray: Ray,
        key: SampleKey,
        segment: u32,
        best: Hit,
    ) -> Hit {
        let shape = S::shape(scene, index);
        let mut t_min: f32 = 0.0;
        #[wgsl_allow(non_literal_loop_bounds)]
        for attempt in 0..MAX_HITS_PER_OBJECT {
            let hit = intersect_shape(shape, ray, t_min, best.shape.t);
            if hit.t >= NO_HIT {
                return best;
            }
            if (shape.kind & FLAG_NOT_OPAQUE) == 0u32 {
                return Hit { shape: hit, object: index };
            }
            let material = S::material(scene, shape.material);
            let at = hit_texture_point::<S>(scene, index, shape, material, ray, hit);
            let opacity = surface_opacity::<S>(scene, material, at);
            if opacity >= 1.0 {
                return Hit { shape: hit, object: index };
            }
            if opacity > 0.0 {
                // Front and back of one object are told apart by the number of the attempt.
                let triangle = u32(shape.top_radius);
                let bits = pcg4d(vec4u(
                    key.pixel,
                    key.sample,
                    DIMENSION_OPACITY + S::surface(scene, index).source,
                    key.seed
                        ^ ((segment * MAX_HITS_PER_OBJECT + attempt) * 2654435769u32)
                        ^ (triangle * 2246822519u32),
                ));
                if unit_float(bits.x) < opacity {
                    return Hit { shape: hit, object: index };
                }
            }
            t_min = hit.t;
        }
        best
    }

    /// The first surface that a ray meets.
    pub fn closest_hit<S: SceneAccess + Copy>(scene: S, ray: Ray, key: SampleKey, segment: u32) -> Hit {
        let header = S::header(scene);
        let mut best = Hit { shape: no_hit(), object: NONE };
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..header.unbounded_objects {
            best = closer_hit::<S>(scene, i, ray, key, segment, best);
        }
        if header.nodes == 0u32 {
            return best;
        }

        let inverse = inverse_direction(ray.direction);
        let mut stack: [u32; 64] = [0u32; 64];
        let mut stacked: u32 = 0;
        let mut current: u32 = 0;
        let mut searching = true;
        while searching {
            let node = S::node(scene, current);
            let t0 = box_entry(ray.origin, inverse, node.min0, node.max0, best.shape.t);
            let t1 = box_entry(ray.origin, inverse, node.min1, node.max1, best.shape.t);
            // Leaves are tested at once, inner nodes are descended into, the nearer one first.
            let mut descend0 = t0 < NO_HIT;
            let mut descend1 = t1 < NO_HIT;
            if descend0 && node.count0 > 0u32 {
                #[wgsl_allow(non_literal_loop_bounds)]
                for i in 0..node.count0 {
                    best = closer_hit::<S>(scene, node.child0 + i, ray, key, segment, best);
                }
                descend0 = false;
            }
            if descend1 && node.count1 > 0u32 {
                if t1 < best.shape.t {
                    #[wgsl_allow(non_literal_loop_bounds)]
                    for i in 0..node.count1 {
                        best = closer_hit::<S>(scene, node.child1 + i, ray, key, segment, best);
                    }
                }
                descend1 = false;
            }
            if descend0 && descend1 {
                let first = t0 <= t1;
                stack[stacked as usize] = select(node.child0, node.child1, first);
                stacked += 1;
                current = select(node.child1, node.child0, first);
            } else if descend0 {
                current = node.child0;
            } else if descend1 {
                current = node.child1;
            } else if stacked > 0u32 {
                stacked -= 1;
                current = stack[stacked as usize];
            } else {
                searching = false;
            }
        }
        best
    }

    /// Share of light per channel that passes one object between the ends of a shadow ray.
    pub fn object_transmittance<S: SceneAccess + Copy>(scene: S, index: u32, ray: Ray, t_max: f32) -> Vec3f {
        let shape = S::shape(scene, index);
        let mut passed = vec3f(1.0, 1.0, 1.0);
        let mut t_min: f32 = 0.0;
        #[wgsl_allow(non_literal_loop_bounds)]
        for _attempt in 0..MAX_HITS_PER_OBJECT {
            let hit = intersect_shape(shape, ray, t_min, t_max);
            if hit.t >= NO_HIT {
                return passed;
            }
            if (shape.kind & FLAG_NOT_OPAQUE) == 0u32 {
                return vec3f(0.0, 0.0, 0.0);
            }
            let material = S::material(scene, shape.material);
            let at = hit_texture_point::<S>(scene, index, shape, material, ray, hit);
            passed *= surface_transmittance::<S>(scene, material, at);
            t_min = hit.t;
        }
        passed
    }

    /// True if no light is left in any channel.
    pub fn is_dark(color: Vec3f) -> bool {
        color.x <= 0.0 && color.y <= 0.0 && color.z <= 0.0
    }

    /// Share of light per channel that passes along a ray up to parameter `t_max`.
    pub fn transmittance<S: SceneAccess + Copy>(scene: S, ray: Ray, t_max: f32) -> Vec3f {
        let header = S::header(scene);
        let mut passed = vec3f(1.0, 1.0, 1.0);
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..header.unbounded_objects {
            passed *= object_transmittance::<S>(scene, i, ray, t_max);
        }
        if header.nodes == 0u32 || is_dark(passed) {
            return passed;
        }

        let inverse = inverse_direction(ray.direction);
        let mut stack: [u32; 64] = [0u32; 64];
        let mut stacked: u32 = 0;
        let mut current: u32 = 0;
        let mut searching = true;
        while searching {
            let node = S::node(scene, current);
            let mut descend0 = box_entry(ray.origin, inverse, node.min0, node.max0, t_max) < NO_HIT;
            let mut descend1 = box_entry(ray.origin, inverse, node.min1, node.max1, t_max) < NO_HIT;
            if descend0 && node.count0 > 0u32 {
                #[wgsl_allow(non_literal_loop_bounds)]
                for i in 0..node.count0 {
                    passed *= object_transmittance::<S>(scene, node.child0 + i, ray, t_max);
                }
                descend0 = false;
            }
            if descend1 && node.count1 > 0u32 {
                #[wgsl_allow(non_literal_loop_bounds)]
                for i in 0..node.count1 {
                    passed *= object_transmittance::<S>(scene, node.child1 + i, ray, t_max);
                }
                descend1 = false;
            }
            if is_dark(passed) {
                return passed;
            }
            if descend0 && descend1 {
                stack[stacked as usize] = node.child1;
                stacked += 1;
                current = node.child0;
            } else if descend0 {
                current = node.child0;
            } else if descend1 {
                current = node.child1;
            } else if stacked > 0u32 {
                stacked -= 1;
                current = stack[stacked as usize];
            } else {
                searching = false;
            }
        }
        passed
    }
}
