//! Choosing one of many lights in proportion to the irradiance that each may cause.
//!
//! Lights at infinity and the first few others are looked at one by one. Many lights stand in a tree of groups:
//! the choice descends from group to group with one random number, so that it costs the logarithm of their number
//! (Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018). A group is a
//! record in the light table, so that one function judges lights and groups.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// A chosen light and the probability with which it is chosen.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct LightChoice {
        pub index: u32,
        pub probability: f32,
        /// What is left of the random number that it was chosen with: again uniform in [0, 1).
        pub left: f32,
    }

    /// Importance of a group: 0 only where none of its lights has any.
    pub fn group_importance(group: LightRecord, point: Vec3f) -> f32 {
        let way = point - group.position;
        let squared = dot(way, way);
        if group.cos_outer < 3.1 && squared > group.cos_inner {
            let distance = sqrt(squared);
            let angle = acos(clamp(dot(way, group.axis) / distance, -1.0, 1.0));
            // By so much a light may see the point under another angle than the centre does.
            let spread = asin(clamp(sqrt(group.cos_inner) / distance, 0.0, 1.0));
            if angle - spread > group.cos_outer {
                return 0.0;
            }
        }
        // Within the group some lights are nearer than its centre.
        group.importance / max(max(squared, 0.25 * group.cos_inner), 1.0e-20)
    }

    /// Estimate of the irradiance that a light causes at a point if nothing stands between; 0 only where the
    /// light cannot contribute at all.
    pub fn light_importance(light: LightRecord, point: Vec3f) -> f32 {
        if light.kind == LIGHT_GROUP {
            return group_importance(light, point);
        }
        if light.kind == LIGHT_AREA {
            let from_light = point - (light.position + light.edge_v * 0.5);
            if dot(from_light, light.axis) <= 0.0 {
                return 0.0;
            }
            return light.importance / (dot(from_light, from_light) + light.cos_outer);
        }
        if light.kind == LIGHT_POINT || light.kind == LIGHT_SPOT || light.kind == LIGHT_PHYSICAL {
            let from_light = point - light.position;
            let squared = max(dot(from_light, from_light), 1.0e-20);
            if light.kind == LIGHT_SPOT && dot(from_light, light.axis) <= light.cos_outer * sqrt(squared) {
                return 0.0;
            }
            return light.importance / squared;
        }
        // Infinitely far away: the same everywhere.
        light.importance
    }

    /// Sum of the importances of `count` lights or groups from `first` on.
    pub fn sum_of_importances<S: SceneAccess + Copy>(scene: S, first: u32, count: u32, point: Vec3f) -> f32 {
        let mut total: f32 = 0.0;
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..count {
            total += light_importance(S::light(scene, first + i), point);
        }
        total
    }

    /// Importance of everything that shines, at a point.
    pub fn total_importance<S: SceneAccess + Copy>(scene: S, point: Vec3f) -> f32 {
        sum_of_importances::<S>(scene, 0u32, S::header(scene).lights, point)
    }

    /// Chooses a light; `total` is `total_importance` there.
    pub fn choose_light<S: SceneAccess + Copy>(scene: S, point: Vec3f, total: f32, u: f32) -> LightChoice {
        let nothing = LightChoice { index: NONE, probability: 0.0, left: 0.0 };
        let mut choice = LightChoice { index: NONE, probability: 1.0, left: u };
        let mut first: u32 = 0;
        let mut count = S::header(scene).lights;
        let mut sum = total;
        let mut descending = true;
        while descending {
            if sum <= 0.0 {
                return nothing;
            }
            let mut rest = choice.left * sum;
            let mut chosen: f32 = 0.0;
            let mut offset: f32 = 0.0;
            #[wgsl_allow(non_literal_loop_bounds)]
            for i in 0..count {
                let importance = light_importance(S::light(scene, first + i), point);
                // The last light that can contribute is taken when rounding leaves a rest.
                if rest >= 0.0 && importance > 0.0 {
                    choice.index = first + i;
                    chosen = importance;
                    offset = rest;
                }
                rest -= importance;
            }
            choice.probability = max(choice.probability * (chosen / sum), 1.0e-30);
            choice.left = stretched(offset, 0.0, chosen);
            let light = S::light(scene, choice.index);
            descending = has::<S>(scene, FEATURE_LIGHT_GROUPS) && light.kind == LIGHT_GROUP;
            first = light.first;
            count = light.count;
            if descending {
                sum = sum_of_importances::<S>(scene, first, count, point);
            }
        }
        choice
    }

    /// Probability with which `choose_light` chooses a given light at a point; `total` is `total_importance` there.
    pub fn light_probability<S: SceneAccess + Copy>(scene: S, index: u32, point: Vec3f, total: f32) -> f32 {
        let mut probability: f32 = 1.0;
        let mut at = index;
        while at != NONE {
            let light = S::light(scene, at);
            let mut sum = total;
            if has::<S>(scene, FEATURE_LIGHT_GROUPS) && light.parent != NONE {
                let group = S::light(scene, light.parent);
                sum = sum_of_importances::<S>(scene, group.first, group.count, point);
            }
            probability *= light_importance(light, point) / max(sum, 1.0e-30);
            at = select(NONE, light.parent, has::<S>(scene, FEATURE_LIGHT_GROUPS));
        }
        probability
    }
}
