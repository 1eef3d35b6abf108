//! Which object a ray hits first, and how much light passes along a shadow ray.
//!
//! Opacity is resolved here: a leaf that is cut out by the alpha of its picture is passed where it is not, on
//! camera rays, scattered rays and shadow rays alike.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::bsdf::kernel::*;
    use crate::bvh::kernel::*;
    use crate::coordinates::kernel::*;
    use crate::mesh::kernel::*;
    use crate::random::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// The first object along a ray; `object` is `NONE` if there is none.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct Hit {
        pub shape: ShapeHit,
        pub object: u32,
        /// The instance that the object was found in, or `NONE`.
        pub instance: u32,
    }

    /// Levels that the hierarchy of the scene, and that of a group, may have; the traversal stack holds both.
    pub const MAX_BVH_DEPTH: u32 = 24;
    /// A convex shape is hit at most twice by a ray; an open one may show both sides of its inside.
    pub const MAX_HITS_PER_OBJECT: u32 = 4;

    /// In place of the number of a segment: no surface is passed by chance, every one that is not fully clear is hit.
    pub const EVERY_SURFACE: u32 = 4294967295;

    /// Reciprocals that are finite also for rays parallel to an axis.
    pub fn inverse_direction(d: Vec3f) -> Vec3f {
        vec3f(1.0 / away_from_zero(d.x), 1.0 / away_from_zero(d.y), 1.0 / away_from_zero(d.z))
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
        if !has::<S>(scene, FEATURE_BACKS) || material.back == NONE {
            return material;
        }
        let outward = object_normal(shape, hit.face, hit_point(shape, ray, hit));
        let onwards = transform_vector(shape.object_from_world, ray.direction);
        if dot(outward, onwards) <= 0.0 {
            return material;
        }
        S::material(scene, material.back)
    }

    /// What a search along a ray is for: the first surface that it meets, or the light that passes undisturbed.
    pub const SEARCH_HIT: u32 = 0;
    pub const SEARCH_LIGHT: u32 = 1;
    /// As `SEARCH_LIGHT`; refracting bodies let light pass as if they did not bend it.
    pub const SEARCH_LIGHT_THROUGH_BODIES: u32 = 2;

    /// What a search is for, and what its random choices depend on.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct Quest {
        /// `SEARCH_HIT` or one of the others.
        pub purpose: u32,
        pub key: SampleKey,
        /// Number of the ray on its path.
        pub segment: u32,
    }

    /// A search for light, which leaves nothing to chance.
    pub fn light_quest(purpose: u32) -> Quest {
        Quest { purpose, key: independent_key(0u32, 0u32, 0u32), segment: 0 }
    }

    /// What was found along a ray so far.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct Found {
        /// The closest hit, or how far the ray reaches.
        pub hit: Hit,
        /// Share of light per channel that passes.
        pub passed: Vec3f,
    }

    /// True if no light is left in any channel.
    pub fn is_dark(color: Vec3f) -> bool {
        color.x <= 0.0 && color.y <= 0.0 && color.z <= 0.0
    }

    /// Whether a ray that looks for a hit meets a partly transparent surface, given its opacity there: with that
    /// probability (but see `EVERY_SURFACE`). The decision depends on the sample, the segment, the instance and the
    /// object alone (on the triangle in case of meshes), so that the order in which objects are visited does not
    /// matter.
    pub fn is_met(
        quest: Quest,
        attempt: u32,
        instance: u32,
        source: u32,
        triangle: u32,
        opacity: f32,
    ) -> bool {
        if opacity >= 1.0 || opacity <= 0.0 || quest.segment == EVERY_SURFACE {
            return opacity > 0.0;
        }
        // Front and back of one object are told apart by the number of the attempt.
        let bits = pcg4d(vec4u(
            quest.key.pixel,
            quest.key.sample,
            DIMENSION_OPACITY + source,
            quest.key.seed
                ^ ((quest.segment * MAX_HITS_PER_OBJECT + attempt) * 2654435769u32)
                ^ (triangle * 2246822519u32)
                ^ ((instance + 1u32) * 3266489917u32),
        ));
        unit_float(bits.x) < opacity
    }

    /// Joins an object to what was found so far; `ray` is in the space of the instance, if there is one.
    pub fn meet_object<S: SceneAccess + Copy>(
        scene: S,
        instance: u32,
        index: u32,
        ray: Ray,
        quest: Quest,
        before: Found,
    ) -> Found {
        let shape = S::shape(scene, index);
        let mut found = before;
        let mut t_min: f32 = 0.0;
        let mut attempt: u32 = 0;
        // One way out: lanes of processors pay for every return.
        while attempt < MAX_HITS_PER_OBJECT {
            let hit = intersect_shape(S::features(scene), shape, ray, t_min, found.hit.shape.t);
            let mut goes_on = hit.t < NO_HIT;
            if goes_on {
                let mut passes = vec3f(0.0, 0.0, 0.0);
                if has::<S>(scene, FEATURE_HOLES) && (shape.kind & FLAG_NOT_OPAQUE) != 0u32 {
                    let material = material_hit::<S>(scene, shape, ray, hit);
                    let at = hit_texture_point::<S>(scene, instance, index, shape, material, ray, hit);
                    let through_bodies = quest.purpose == SEARCH_LIGHT_THROUGH_BODIES;
                    passes = surface_transmittance::<S>(scene, material, at, through_bodies);
                    if quest.purpose == SEARCH_HIT {
                        let source = S::surface(scene, index).source;
                        let opacity = 1.0 - smallest(passes);
                        let triangle = u32(shape.top_radius);
                        let met = is_met(quest, attempt, instance, source, triangle, opacity);
                        passes = select(vec3f(1.0, 1.0, 1.0), vec3f(0.0, 0.0, 0.0), met);
                    }
                }
                goes_on = !is_dark(passes);
                if quest.purpose != SEARCH_HIT {
                    found.passed *= passes;
                } else if !goes_on {
                    found.hit = Hit { shape: hit, object: index, instance };
                }
                t_min = hit.t;
            }
            attempt = select(MAX_HITS_PER_OBJECT, attempt + 1u32, goes_on);
        }
        found
    }

    /// Looks for what a ray meets up to parameter `t_max`. Light that none is left of is not followed further.
    pub fn search<S: SceneAccess + Copy>(scene: S, ray: Ray, t_max: f32, quest: Quest) -> Found {
        let header = S::header(scene);
        let nothing = Hit { shape: ShapeHit { t: t_max, face: 0 }, object: NONE, instance: NONE };
        let mut found = Found { hit: nothing, passed: vec3f(1.0, 1.0, 1.0) };
        // The ray in the space of the instance that is being searched, and how many groups of nodes of the scene
        // wait below those of the instance.
        let mut instance = NONE;
        let mut local = ray;
        let mut inverse = inverse_direction(ray.direction);
        let mut order = visiting_order(inverse);
        let mut outside: u32 = 0;
        let mut stack_first: [u32; 48] = [0u32; 48];
        let mut stack_bits: [u32; 48] = [0u32; 48];
        let mut stacked: u32 = 0;
        let mut children = vec2u(0, 0);
        if header.nodes > 0u32 {
            children = waiting_root(0u32);
        }
        // Objects without bounds are tested first.
        let mut unbounded: u32 = 0;
        let mut searching = true;
        while searching {
            // Children of the node that are objects: those that wait, all of them, and the first one.
            let mut objects: u32 = 0;
            let mut leaves: u32 = 0;
            let mut first_object: u32 = 0;
            if any_waits(children) {
                let mut index = next_node(children, order);
                children = without_next(children);
                if any_waits(children) {
                    stack_first[stacked as usize] = children.x;
                    stack_bits[stacked as usize] = children.y;
                    stacked += 1;
                }
                if has::<S>(scene, 1u32 << SHAPE_INSTANCE) && S::node(scene, index).exponents == NODE_INSTANCE
                {
                    // The root of the group is visited at once.
                    let entrance = S::node(scene, index);
                    instance = entrance.first_object;
                    local = transform_ray(S::shape(scene, instance).object_from_world, ray);
                    inverse = inverse_direction(local.direction);
                    order = visiting_order(inverse);
                    outside = stacked;
                    index = entrance.first_node;
                }
                let node = S::node(scene, index);
                let reached = S::reached_children(scene, index, local.origin, inverse, found.hit.shape.t);
                children = waiting_children(node, reached, order);
                first_object = node.first_object;
                leaves = node.leaves;
                objects = reached & leaves;
            }
            // One place that tests objects, so that graphics cards hold the code once.
            while objects != 0u32 || unbounded < header.unbounded_objects {
                let mut index = unbounded;
                if unbounded < header.unbounded_objects {
                    unbounded += 1;
                } else {
                    index = first_object + children_before(leaves, count_trailing_zeros(objects));
                    objects &= objects - 1u32;
                }
                found = meet_object::<S>(scene, instance, index, local, quest, found);
                if is_dark(found.passed) {
                    // Nothing is left to look for.
                    objects = 0;
                    unbounded = header.unbounded_objects;
                    children = vec2u(0, 0);
                    stacked = 0;
                }
            }
            if !any_waits(children) {
                if has::<S>(scene, 1u32 << SHAPE_INSTANCE) && instance != NONE && stacked == outside {
                    instance = NONE;
                    local = ray;
                    inverse = inverse_direction(ray.direction);
                    order = visiting_order(inverse);
                }
                if stacked > 0u32 {
                    stacked -= 1;
                    children = vec2u(stack_first[stacked as usize], stack_bits[stacked as usize]);
                } else {
                    searching = false;
                }
            }
        }
        found
    }

    /// The first surface that a ray meets.
    pub fn closest_hit<S: SceneAccess + Copy>(scene: S, ray: Ray, key: SampleKey, segment: u32) -> Hit {
        search::<S>(scene, ray, NO_HIT, Quest { purpose: SEARCH_HIT, key, segment }).hit
    }

    /// Share of light per channel that passes undisturbed along a ray up to parameter `t_max`; with
    /// `through_bodies` refracting bodies let light pass as if they did not bend it.
    pub fn shadow_transmittance<S: SceneAccess + Copy>(
        scene: S,
        ray: Ray,
        t_max: f32,
        through_bodies: bool,
    ) -> Vec3f {
        let purpose = select(SEARCH_LIGHT, SEARCH_LIGHT_THROUGH_BODIES, through_bodies);
        search::<S>(scene, ray, t_max, light_quest(purpose)).passed
    }
}
