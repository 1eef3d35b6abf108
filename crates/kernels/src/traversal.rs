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
        /// The instance that the object was found in, or `NONE`.
        pub instance: u32,
    }

    /// Levels of the hierarchy of the scene, and of the hierarchy of a group, that the traversal stack can hold
    /// together; the compiler of scenes keeps to them.
    pub const MAX_BVH_DEPTH: u32 = 48;
    /// A convex shape is hit at most twice by a ray; an open one may show both sides of its inside.
    pub const MAX_HITS_PER_OBJECT: u32 = 4;

    /// In place of the number of a segment: no surface is passed by chance, every one that is not fully clear is hit.
    pub const EVERY_SURFACE: u32 = 4294967295;

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
        instance: u32,
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
        texture_point::<S>(scene, instance, shape, surface, material, p, uv)
    }

    /// Material of the side of an object that a ray has hit; the ray is in the same space as the record.
    pub fn material_hit<S: SceneAccess + Copy>(
        scene: S,
        shape: ShapeRecord,
        ray: Ray,
        hit: ShapeHit,
    ) -> MaterialRecord {
        let material = S::material(scene, shape.material);
        if material.back == NONE {
            return material;
        }
        let outward = object_normal(shape, hit.face, hit_point(shape, ray, hit));
        let onwards = transform_vector(shape.object_from_world, ray.direction);
        if dot(outward, onwards) <= 0.0 {
            return material;
        }
        S::material(scene, material.back)
    }

    /// Joins an object to the closest hit so far; `ray` is in the space of the instance, if there is one. Partly
    /// transparent surfaces are met with the probability of their opacity (but see `EVERY_SURFACE`); the decision depends on the sample, the
    /// segment, the instance and the object alone (on the triangle in case of meshes), so that the order in which
    /// objects are visited does not matter.
    pub fn closer_hit<S: SceneAccess + Copy>(
        scene: S,
        instance: u32,
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
                return Hit { shape: hit, object: index, instance };
            }
            let material = material_hit::<S>(scene, shape, ray, hit);
            let at = hit_texture_point::<S>(scene, instance, index, shape, material, ray, hit);
            let opacity = surface_opacity::<S>(scene, material, at);
            if opacity >= 1.0 || (opacity > 0.0 && segment == EVERY_SURFACE) {
                return Hit { shape: hit, object: index, instance };
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
                        ^ (triangle * 2246822519u32)
                        ^ ((instance + 1u32) * 3266489917u32),
                ));
                if unit_float(bits.x) < opacity {
                    return Hit { shape: hit, object: index, instance };
                }
            }
            t_min = hit.t;
        }
        best
    }

    /// The children of a node: where their objects, or they themselves, start; how many objects there are to be
    /// tested, 0 for inner nodes and for those that are not reached.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct LeafPair {
        pub first0: u32,
        pub count0: u32,
        pub first1: u32,
        pub count1: u32,
    }

    pub fn reached_leaves(node: BvhNode, reached0: bool, reached1: bool) -> LeafPair {
        LeafPair {
            first0: node.child0,
            count0: select(0u32, node.count0, reached0),
            first1: node.child1,
            count1: select(0u32, node.count1, reached1),
        }
    }

    /// The object number `i` of both leaves together.
    pub fn leaf_object(leaves: LeafPair, i: u32) -> u32 {
        select(leaves.first1 + (i - leaves.count0), leaves.first0 + i, i < leaves.count0)
    }

    /// The first surface that a ray meets.
    pub fn closest_hit<S: SceneAccess + Copy>(scene: S, ray: Ray, key: SampleKey, segment: u32) -> Hit {
        let header = S::header(scene);
        let mut best = Hit { shape: no_hit(), object: NONE, instance: NONE };
        // The ray in the space of the instance that is being searched, and how many nodes of the scene wait
        // below those of the instance.
        let mut instance = NONE;
        let mut local = ray;
        let mut inverse = inverse_direction(ray.direction);
        let mut waiting: u32 = 0;
        let mut stack: [u32; 96] = [0u32; 96];
        // Unbounded objects come first, then the root, which waits on the stack.
        let mut stacked: u32 = select(0u32, 1u32, header.nodes > 0u32);
        let mut current = NONE;
        let mut searching = true;
        while searching {
            let mut children = LeafPair { first0: 0, count0: header.unbounded_objects, first1: 0, count1: 0 };
            let mut t0 = NO_HIT;
            let mut t1 = NO_HIT;
            if current != NONE {
                if (current & INSTANCE_BIT) != 0u32 {
                    instance = current ^ INSTANCE_BIT;
                    let placement = S::shape(scene, instance);
                    local = transform_ray(placement.object_from_world, ray);
                    inverse = inverse_direction(local.direction);
                    waiting = stacked;
                    current = placement.material;
                }
                let node = S::node(scene, current);
                t0 = box_entry(local.origin, inverse, node.min0, node.max0, best.shape.t);
                t1 = box_entry(local.origin, inverse, node.min1, node.max1, best.shape.t);
                children = reached_leaves(node, t0 < NO_HIT, t1 < NO_HIT);
            }
            // Leaves are tested at once, inner nodes are descended into, the nearer one first. One loop over the
            // objects of both, so that graphics cards hold their code once.
            #[wgsl_allow(non_literal_loop_bounds)]
            for i in 0..(children.count0 + children.count1) {
                if i < children.count0 || t1 < best.shape.t {
                    best =
                        closer_hit::<S>(scene, instance, leaf_object(children, i), local, key, segment, best);
                }
            }
            let descend0 = t0 < NO_HIT && children.count0 == 0u32;
            let descend1 = t1 < NO_HIT && children.count1 == 0u32;
            if descend0 && descend1 {
                let first = t0 <= t1;
                stack[stacked as usize] = select(children.first0, children.first1, first);
                stacked += 1;
                current = select(children.first1, children.first0, first);
            } else if descend0 {
                current = children.first0;
            } else if descend1 {
                current = children.first1;
            } else {
                if instance != NONE && stacked == waiting {
                    instance = NONE;
                    local = ray;
                    inverse = inverse_direction(ray.direction);
                }
                if stacked > 0u32 {
                    stacked -= 1;
                    current = stack[stacked as usize];
                } else {
                    searching = false;
                }
            }
        }
        best
    }

    /// Share of light per channel that passes one object between the ends of a shadow ray.
    pub fn object_transmittance<S: SceneAccess + Copy>(
        scene: S,
        instance: u32,
        index: u32,
        ray: Ray,
        t_max: f32,
        through_bodies: bool,
    ) -> Vec3f {
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
            let material = material_hit::<S>(scene, shape, ray, hit);
            let at = hit_texture_point::<S>(scene, instance, index, shape, material, ray, hit);
            passed *= surface_transmittance::<S>(scene, material, at, through_bodies);
            t_min = hit.t;
        }
        passed
    }

    /// True if no light is left in any channel.
    pub fn is_dark(color: Vec3f) -> bool {
        color.x <= 0.0 && color.y <= 0.0 && color.z <= 0.0
    }

    /// Share of light per channel that passes undisturbed along a ray up to parameter `t_max`.
    pub fn transmittance<S: SceneAccess + Copy>(scene: S, ray: Ray, t_max: f32) -> Vec3f {
        shadow_transmittance::<S>(scene, ray, t_max, false)
    }

    /// As `transmittance`; with `through_bodies` refracting bodies let light pass as if they did not bend it.
    pub fn shadow_transmittance<S: SceneAccess + Copy>(
        scene: S,
        ray: Ray,
        t_max: f32,
        through_bodies: bool,
    ) -> Vec3f {
        let header = S::header(scene);
        let mut passed = vec3f(1.0, 1.0, 1.0);
        // As in `closest_hit`, but in any order.
        let mut instance = NONE;
        let mut local = ray;
        let mut inverse = inverse_direction(ray.direction);
        let mut waiting: u32 = 0;
        let mut stack: [u32; 96] = [0u32; 96];
        let mut stacked: u32 = select(0u32, 1u32, header.nodes > 0u32);
        let mut current = NONE;
        let mut searching = true;
        while searching {
            let mut children = LeafPair { first0: 0, count0: header.unbounded_objects, first1: 0, count1: 0 };
            let mut reached0 = false;
            let mut reached1 = false;
            if current != NONE {
                if (current & INSTANCE_BIT) != 0u32 {
                    instance = current ^ INSTANCE_BIT;
                    let placement = S::shape(scene, instance);
                    local = transform_ray(placement.object_from_world, ray);
                    inverse = inverse_direction(local.direction);
                    waiting = stacked;
                    current = placement.material;
                }
                let node = S::node(scene, current);
                reached0 = box_entry(local.origin, inverse, node.min0, node.max0, t_max) < NO_HIT;
                reached1 = box_entry(local.origin, inverse, node.min1, node.max1, t_max) < NO_HIT;
                children = reached_leaves(node, reached0, reached1);
            }
            #[wgsl_allow(non_literal_loop_bounds)]
            for i in 0..(children.count0 + children.count1) {
                let object = leaf_object(children, i);
                passed *= object_transmittance::<S>(scene, instance, object, local, t_max, through_bodies);
            }
            let descend0 = reached0 && children.count0 == 0u32;
            let descend1 = reached1 && children.count1 == 0u32;
            if is_dark(passed) {
                return passed;
            }
            if descend0 && descend1 {
                stack[stacked as usize] = children.first1;
                stacked += 1;
                current = children.first0;
            } else if descend0 {
                current = children.first0;
            } else if descend1 {
                current = children.first1;
            } else {
                if instance != NONE && stacked == waiting {
                    instance = NONE;
                    local = ray;
                    inverse = inverse_direction(ray.direction);
                }
                if stacked > 0u32 {
                    stacked -= 1;
                    current = stack[stacked as usize];
                } else {
                    searching = false;
                }
            }
        }
        passed
    }
}
