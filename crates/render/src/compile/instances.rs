//! Instances of groups: nested ones are resolved to placements of single groups, and what cannot stand in a group of
//! the kernels (lights, lamps, unbounded planes) is brought up to the scene.

use super::CompileError;
use scene::{DAffine3, Group, Instance, Light, Object, Origin, Scene, Shape};
use std::borrow::Cow;

/// A group at a place in the world.
#[derive(Clone, Copy)]
pub(super) struct Placement {
    /// Position in `Scene::groups`.
    pub group: usize,
    pub world_from_group: DAffine3,
    pub origin: Origin,
}

/// Groups within groups that are followed; real projects have two or three.
const DEEPEST: usize = 64;
/// Placements at most, so that a small file cannot ask for more memory than there is.
const MOST_PLACEMENTS: usize = 1 << 24;

/// All places of all groups, instances in groups included.
///
/// # Errors
/// If a group contains itself, or if there are too many.
pub(super) fn placements(scene: &Scene) -> Result<Vec<Placement>, CompileError> {
    let place = |instance: &Instance, world: DAffine3| Placement {
        group: instance.group.index(),
        world_from_group: world * instance.world_from_group,
        origin: instance.origin,
    };
    let mut all: Vec<Placement> = Vec::with_capacity(scene.instances.len());
    all.extend(scene.instances.iter().map(|instance| place(instance, DAffine3::IDENTITY)));
    // Level by level: what instances in groups place is appended behind.
    let mut level = 0..all.len();
    for _ in 0..DEEPEST {
        if level.is_empty() {
            return Ok(all);
        }
        for index in level.clone() {
            let outer = all[index];
            let Some(group) = scene.groups.get(outer.group) else { continue };
            if all.len() + group.instances.len() > MOST_PLACEMENTS {
                return Err(CompileError::TooManyInstances { most: MOST_PLACEMENTS });
            }
            all.extend(group.instances.iter().map(|instance| place(instance, outer.world_from_group)));
        }
        level = level.end..all.len();
    }
    Err(CompileError::NestedInstances { deepest: DEEPEST })
}

/// Whether an object can be a member of a group in the kernels.
pub(super) fn stays_in_group(object: &Object) -> bool {
    object.emission.is_none() && object.shape != Shape::Plane
}

/// The scene with all lights, lamps and planes of its groups among its own.
pub(super) fn with_raised_members<'a>(scene: &'a Scene, placements: &[Placement]) -> Cow<'a, Scene> {
    let has_some = |group: &Group| !group.lights.is_empty() || !group.objects.iter().all(stays_in_group);
    let raise: Vec<bool> = scene.groups.iter().map(has_some).collect();
    if !raise.contains(&true) {
        return Cow::Borrowed(scene);
    }
    let mut raised = scene.clone();
    for placement in placements.iter().filter(|placement| raise.get(placement.group) == Some(&true)) {
        let group = &scene.groups[placement.group];
        for object in group.objects.iter().filter(|object| !stays_in_group(object)) {
            let world_from_object = placement.world_from_group * object.world_from_object;
            raised.objects.push(Object { world_from_object, ..object.clone() });
        }
        for light in &group.lights {
            let world_from_light = placement.world_from_group * light.world_from_light;
            raised.lights.push(Light { world_from_light, ..light.clone() });
        }
    }
    Cow::Owned(raised)
}
