//! The path tracer: an unbiased estimate of the rendering equation (Kajiya 1986).
//!
//! Next event estimation joined with BSDF sampling by multiple importance sampling (Veach 1997, power
//! heuristic), Russian roulette after a few surfaces. Undisturbed passage through clear or cut-out surfaces is no
//! event: it neither counts as a surface nor interrupts the multiple importance sampling.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::bsdf::kernel::*;
    use crate::camera::kernel::*;
    use crate::light::kernel::*;
    use crate::light_tree::kernel::*;
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

    /// The vertex that a ray starts previous, as far as the weights of light that the ray may find depend on it.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct PathVertex {
        pub position: Vec3f,
        pub normal: Vec3f,
        /// Whether light was sampled on both sides.
        pub both_sides: bool,
        /// Density with which the direction was drawn; 0 at the camera and behind ideal mirrors, where no light
        /// sampling competes.
        pub pdf: f32,
        /// Sum of the importances of all lights here.
        pub importance: f32,
    }

    /// Surfaces after which Russian roulette sets in.
    pub const ROULETTE_START: u32 = 3;
    /// By so much likelier than its share of light demands a path goes on: what roulette saves is worth less than the
    /// noise that it makes (measured with Cornell box, bushes and canopy).
    pub const ROULETTE_CAUTION: f32 = 3.0;
    /// Bound on the segments of a path, undisturbed passages included; never reached by real scenes.
    pub const MAX_SEGMENTS: u32 = 512;
    /// A shadow ray ends this fraction before the lamp that it aims at.
    pub const SHADOW_END: f32 = 0.9999;

    /// Weight of light found by following a ray, against finding it by light sampling.
    pub fn found_light_weight(previous: PathVertex, light_pdf: f32) -> f32 {
        if previous.pdf <= 0.0 {
            return 1.0;
        }
        power_heuristic(previous.pdf, light_pdf)
    }

    /// Radiance of the skies that a ray escapes to.
    pub fn escaped_radiance<S: SceneAccess + Copy>(
        scene: S,
        previous: PathVertex,
        direction: Vec3f,
    ) -> Vec3f {
        let lights = S::header(scene).distant_lights;
        let mut sum = vec3f(0.0, 0.0, 0.0);
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..lights {
            let light = S::light(scene, i);
            // A light without importance is only seen and lights nothing.
            if previous.pdf <= 0.0 || light.importance > 0.0 {
                let radiance = distant_radiance::<S>(scene, light, direction);
                if !is_dark(radiance) {
                    let choice = light.importance / max(previous.importance, 1.0e-20);
                    let pdf = distant_pdf::<S>(scene, light, previous.normal, previous.both_sides, direction);
                    sum += radiance * found_light_weight(previous, pdf * choice);
                }
            }
        }
        sum
    }

    /// Radiance of a lamp that a ray runs into; `cos_light` is the cosine at the lamp's front.
    pub fn lamp_radiance<S: SceneAccess + Copy>(
        scene: S,
        index: u32,
        previous: PathVertex,
        position: Vec3f,
        cos_light: f32,
    ) -> Vec3f {
        let light = S::light(scene, index);
        let radiance = area_radiance(light, cos_light);
        if previous.pdf <= 0.0 {
            return radiance;
        }
        if light.shadowless != 0u32 {
            // Its light was counted through everything in the way.
            return vec3f(0.0, 0.0, 0.0);
        }
        let way = position - previous.position;
        let choice = light_probability::<S>(scene, index, previous.position, previous.importance);
        radiance * found_light_weight(previous, area_pdf(light, dot(way, way), cos_light) * choice)
    }

    /// Light of one lamp at a surface point, before anything in its way was looked for.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct DirectLight {
        /// What is scattered of it, in W/(m² sr).
        pub radiance: Vec3f,
        /// How far the shadow ray reaches; 0 if none is needed.
        pub end: f32,
        pub ray: Ray,
    }

    /// Light that one sampled lamp sends along `wo`.
    pub fn direct_light<S: SceneAccess + Copy>(
        scene: S,
        point: SurfacePoint,
        bsdf: Bsdf,
        normal: Vec3f,
        wo: Vec3f,
        importance: f32,
        u: Vec2f,
    ) -> DirectLight {
        let nowhere = Ray { origin: point.position, direction: normal };
        let mut result = DirectLight { radiance: vec3f(0.0, 0.0, 0.0), end: 0.0, ray: nowhere };
        let choice = choose_light::<S>(scene, point.position, importance, u.x);
        if choice.index != NONE {
            let light = S::light(scene, choice.index);
            let both_sides = transmits(bsdf);
            let place = vec2f(choice.left, u.y);
            let sample = sample_light::<S>(scene, light, point.position, normal, both_sides, place);
            let value = evaluate_bsdf(bsdf, normal, wo, sample.direction) * sample.weight;
            if !is_dark(value) && same_side(point, normal, wo, sample.direction) {
                let mut weight = 1.0 / choice.probability;
                if sample.pdf > 0.0 && light.shadowless == 0u32 {
                    let scattered = bsdf_pdf(bsdf, normal, wo, sample.direction);
                    weight *= power_heuristic(sample.pdf * choice.probability, scattered);
                }
                result.radiance = value * weight;
                if light.shadowless == 0u32 {
                    let origin = offset_origin(point, sample.direction);
                    result.ray = Ray { origin, direction: sample.direction };
                    result.end = select(NO_HIT, sample.distance * SHADOW_END, sample.distance < NO_HIT);
                }
            }
        }
        result
    }

    /// A path under way: its next rays and what was collected so far.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct PathState {
        /// In W/(m² sr) per channel.
        pub radiance: Vec3f,
        /// Rays traced, shadow rays included.
        pub rays: u32,
        /// What the path's next light is weighted with.
        pub throughput: Vec3f,
        /// Surfaces touched.
        pub touched: u32,
        /// The next ray, if the path is followed further.
        pub ray: Ray,
        pub follows: bool,
        /// Number of the next ray.
        pub segment: u32,
        /// Numbers in [0, 1) for the light where the next ray ends, well distributed together with its direction: what
        /// of a light is hidden depends on both.
        pub light_numbers: Vec2f,
        pub media: Media,
        pub previous: PathVertex,
        /// What happened at the end of the last ray; `EVENT_SCATTERED` and so on.
        pub event: u32,
        /// Part of the radiance that was sampled from a light at the end of the last ray.
        pub direct: Vec3f,
        /// The shadow ray that is traced before, if it has a length.
        pub shadow: Ray,
        pub shadow_end: f32,
        /// What arrives along the shadow ray if nothing is in its way.
        pub shadow_light: Vec3f,
        /// Whether any ray is left to trace.
        pub goes_on: bool,
    }

    /// The path has left the scene.
    pub const EVENT_ESCAPED: u32 = 4;
    /// Russian roulette has ended the path.
    pub const EVENT_STOPPED: u32 = 5;
    /// The path starts at the camera.
    pub const EVENT_STARTED: u32 = 6;

    /// A path that starts at the camera.
    pub fn start_path(start: CameraSample) -> PathState {
        let first = start.ray;
        PathState {
            radiance: vec3f(0.0, 0.0, 0.0),
            rays: 0,
            throughput: vec3f(1.0, 1.0, 1.0),
            touched: 0,
            ray: first,
            follows: true,
            segment: 0,
            light_numbers: start.light_numbers,
            media: empty_space(),
            previous: PathVertex {
                position: first.origin,
                normal: first.direction,
                both_sides: false,
                pdf: 0.0,
                importance: 0.0,
            },
            event: EVENT_STARTED,
            direct: vec3f(0.0, 0.0, 0.0),
            shadow: first,
            shadow_end: 0.0,
            shadow_light: vec3f(0.0, 0.0, 0.0),
            goes_on: true,
        }
    }

    /// A ray of a path that is to be followed: its shadow ray, if it has one, or its next one.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct RayQuery {
        pub ray: Ray,
        /// Parameter where the ray ends.
        pub t_max: f32,
        pub quest: Quest,
    }

    /// What a path asks the scene next.
    pub fn next_query(key: SampleKey, path: PathState) -> RayQuery {
        let is_shadow = path.shadow_end > 0.0;
        let mut ray = path.ray;
        let mut t_max = NO_HIT;
        if is_shadow {
            ray = path.shadow;
            t_max = path.shadow_end;
        }
        let purpose = select(SEARCH_HIT, SEARCH_LIGHT, is_shadow);
        RayQuery { ray, t_max, quest: Quest { purpose, key, segment: path.segment } }
    }

    /// A path after the answer to its last query; it touches at most `depth` surfaces and may then still find a light.
    pub fn continue_path<S: SceneAccess + Copy>(
        scene: S,
        key: SampleKey,
        depth: u32,
        background: Vec3f,
        before: PathState,
        found: Found,
    ) -> PathState {
        if before.shadow_end > 0.0 {
            return receive_light(before, found.passed);
        }
        meet_surface::<S>(scene, key, depth, background, before, found.hit)
    }

    /// Traces the next ray of a path, and its shadow ray, too, if the scene is small; the path touches at most
    /// `depth` surfaces and may then still find a light.
    ///
    /// In large scenes one ray at a time, whatever it is for: so neighbouring threads of a graphics card, of which
    /// some need no shadow ray, do not wait for each other.
    pub fn extend_path<S: SceneAccess + Copy>(
        scene: S,
        key: SampleKey,
        depth: u32,
        background: Vec3f,
        before: PathState,
    ) -> PathState {
        if has::<S>(scene, FEATURE_MANY_NODES) {
            let query = next_query(key, before);
            let found = search::<S>(scene, query.ray, query.t_max, query.quest);
            return continue_path::<S>(scene, key, depth, background, before, found);
        }
        let hit = closest_hit::<S>(scene, before.ray, key, before.segment);
        let mut path = meet_surface::<S>(scene, key, depth, background, before, hit);
        if path.shadow_end > 0.0 {
            let found = search::<S>(scene, path.shadow, path.shadow_end, light_quest(SEARCH_LIGHT));
            path = receive_light(path, found.passed);
        }
        path
    }

    /// A path with the light that arrives along its shadow ray.
    pub fn receive_light(before: PathState, passed: Vec3f) -> PathState {
        let mut path = before;
        path.rays += 1;
        path.direct = path.shadow_light * passed;
        path.radiance += path.direct;
        path.shadow_end = 0.0;
        path.goes_on = path.follows;
        path
    }

    /// What becomes of a path where its ray meets a surface or the sky.
    pub fn meet_surface<S: SceneAccess + Copy>(
        scene: S,
        key: SampleKey,
        depth: u32,
        background: Vec3f,
        before: PathState,
        hit: Hit,
    ) -> PathState {
        let mut path = before;
        path.rays += 1;
        let ray = before.ray;
        path.direct = vec3f(0.0, 0.0, 0.0);
        path.follows = false;
        path.goes_on = false;

        // The next surface, or the sky. One way out: lanes of processors pay for every return of a whole path.
        if hit.object == NONE {
            path.radiance += path.throughput * escaped_radiance::<S>(scene, path.previous, ray.direction);
            // The background is seen by the eye and in ideal mirrors, it is no light.
            if path.previous.pdf <= 0.0 {
                path.radiance += path.throughput * background_radiance::<S>(scene, background);
            }
            path.event = EVENT_ESCAPED;
        } else {
            let surface = S::surface(scene, hit.object);
            let met = shading_point::<S>(scene, ray, hit);
            let point = met.point;
            let material = met.material;
            let normal = met.normal;
            let wo = -ray.direction;
            let front = met.cos_front >= 0.0;

            // Light that the surface emits.
            if surface.light != NONE {
                path.radiance += path.throughput
                    * lamp_radiance::<S>(scene, surface.light, path.previous, point.position, met.cos_front);
            }
            let mut eta: f32 = 1.0;
            let refracts = has::<S>(scene, FEATURE_MEDIA) && material.refractive_index > 0.0;
            if refracts {
                let outside = leave_medium(path.media, met.body).indices.x;
                let inside = material.refractive_index;
                eta = select(inside / outside, outside / inside, front);
            }
            let bsdf = material_bsdf::<S>(scene, material, met.at, eta, dot(normal, wo));
            // Unverified for GroIMP's path tracer: emissive surfaces shine by themselves.
            path.radiance += path.throughput * bsdf.emissive;
            // Bounded, so that no scene can hold a device for ever.
            let may_go_on = path.segment + 1u32 < MAX_SEGMENTS;
            if path.touched >= depth {
                // Nothing is scattered any more, but clear surfaces are still passed.
                path.throughput *= bsdf.straight;
                path.event = EVENT_ABSORBED;
                if !is_dark(path.throughput) {
                    path.event = EVENT_PASSED;
                    path.follows = may_go_on;
                    path.goes_on = may_go_on;
                }
                path.ray = Ray { origin: offset_origin(point, ray.direction), direction: ray.direction };
                path.segment += 1;
            } else {
                // Light that arrives directly and is scattered here.
                let importance = total_importance::<S>(scene, point.position);
                if importance > 0.0 {
                    let u = path.light_numbers;
                    let direct = direct_light::<S>(scene, point, bsdf, normal, wo, importance, u);
                    let arriving = path.throughput * direct.radiance;
                    if direct.end > 0.0 {
                        path.shadow = direct.ray;
                        path.shadow_end = direct.end;
                        path.shadow_light = arriving;
                        path.goes_on = true;
                    } else {
                        path.direct = arriving;
                        path.radiance += arriving;
                    }
                }

                // Where the path goes on.
                let dimension = DIMENSION_FIRST_SURFACE + path.segment;
                let u = random4(key, dimension);
                path.light_numbers = vec2f(u.z, u.w);
                let sample = sample_bsdf(bsdf, normal, wo, vec2f(u.x, u.y));
                path.event = EVENT_ABSORBED;
                if sample.event != EVENT_ABSORBED && same_side(point, normal, wo, sample.direction) {
                    path.event = sample.event;
                    path.throughput *= sample.weight;
                    if refracts && dot(sample.direction, point.normal) * met.cos_front < 0.0 {
                        if front {
                            path.media = enter_medium(path.media, met.body, material.refractive_index);
                        } else {
                            path.media = leave_medium(path.media, met.body);
                        }
                    }
                    let origin = offset_origin(point, sample.direction);
                    path.ray = Ray { origin, direction: sample.direction };
                    path.segment += 1;
                    path.follows = may_go_on;
                    if sample.event != EVENT_PASSED {
                        path.touched += 1;
                        path.previous = PathVertex {
                            position: point.position,
                            normal,
                            both_sides: transmits(bsdf),
                            pdf: sample.pdf,
                            importance,
                        };
                    }

                    // Russian roulette: weak paths end, the others carry their light.
                    if path.touched >= ROULETTE_START {
                        let survival = min(largest(path.throughput) * ROULETTE_CAUTION, 0.95);
                        if independent_number(key, dimension) < survival {
                            path.throughput *= 1.0 / survival;
                        } else {
                            path.event = EVENT_STOPPED;
                            path.follows = false;
                        }
                    }
                    path.goes_on = path.goes_on || path.follows;
                }
            }
        }
        path
    }
}
