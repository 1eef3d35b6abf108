use crate::{Light, Mesh, Object, Origin, index_type};
use glam::{DAffine3, DVec3};

index_type!(
    /// Position in [`Scene::groups`](crate::Scene::groups).
    GroupId
);

/// Objects, lights and further instances that are placed together, any number of times. "World" in the placements
/// of its members means the space of the group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// What can be hit by a ray.
    pub objects: Vec<Object>,
    /// Lights without a visible body.
    pub lights: Vec<Light>,
    /// Other groups within this one; never, on whatever way round, this one itself.
    pub instances: Vec<Instance>,
}

/// A group at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// What is placed.
    pub group: GroupId,
    /// Where; mirroring and shearing are allowed.
    pub world_from_group: DAffine3,
    /// Where the instance comes from; its members keep their own origins.
    pub origin: Origin,
}

/// An axis-parallel box as (minimum, maximum); `None` if there is nothing finite.
pub(crate) type Bounds = Option<(DVec3, DVec3)>;

pub(crate) fn joined(a: Bounds, b: Bounds) -> Bounds {
    match (a, b) {
        (Some((low, high)), Some((min, max))) => Some((low.min(min), high.max(max))),
        (a, b) => a.or(b),
    }
}

/// The axis-parallel box round a transformed box, both as (minimum, maximum): |M| * half extents (Arvo, "Transforming
/// axis-aligned bounding boxes", 1990).
pub fn transformed_box(bounds: (DVec3, DVec3), matrix: &DAffine3) -> (DVec3, DVec3) {
    let (low, high) = bounds;
    let centre = matrix.transform_point3((low + high) * 0.5);
    let half = (high - low) * 0.5;
    let m = matrix.matrix3;
    let extent = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
    (centre - extent, centre + extent)
}

/// Boxes of all groups in their own spaces.
pub(crate) fn group_bounds(groups: &[Group], meshes: &[Mesh]) -> Vec<Bounds> {
    let own = |group: &Group| {
        group.objects.iter().fold(None, |bounds, object| joined(bounds, object.bounds(meshes)))
    };
    fold_groups(groups, own, |all, instance, inner| {
        joined(all, inner.map(|inner| transformed_box(inner, &instance.world_from_group)))
    })
}

/// Numbers of objects of all groups, those of groups within groups included.
pub(crate) fn group_sizes(groups: &[Group]) -> Vec<u64> {
    fold_groups(groups, |group| group.objects.len() as u64, |all, _, inner| all.saturating_add(inner))
}

/// A value for every group from its own members and the values of the groups in it. Groups may refer to each other
/// in any order; what would make a group contain itself is left out.
fn fold_groups<T: Copy>(
    groups: &[Group],
    own: impl Fn(&Group) -> T,
    add: impl Fn(T, &Instance, T) -> T,
) -> Vec<T> {
    let own: Vec<T> = groups.iter().map(own).collect();
    let mut known: Vec<Option<T>> = vec![None; groups.len()];
    let mut started = vec![false; groups.len()];
    let mut open: Vec<usize> = (0..groups.len()).collect();
    while let Some(&index) = open.last() {
        if known[index].is_some() {
            open.pop();
            continue;
        }
        let inner = groups[index].instances.iter().filter(|instance| instance.group.index() < groups.len());
        if !std::mem::replace(&mut started[index], true) {
            open.extend(inner.map(|instance| instance.group.index()).filter(|inner| !started[*inner]));
            continue;
        }
        let with_inner = |all, instance: &Instance| match known[instance.group.index()] {
            Some(inner) => add(all, instance, inner),
            None => all,
        };
        known[index] = Some(inner.fold(own[index], with_inner));
        open.pop();
    }
    known.into_iter().zip(own).map(|(known, own)| known.unwrap_or(own)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MaterialId, Scene, Shape, TypeNameId};

    #[test]
    fn bounds_reach_through_nested_instances() {
        let origin = Origin { node: 1, type_name: TypeNameId(0) };
        let shape = Shape::Sphere { radius: 1.0 };
        let sphere = Object {
            shape,
            world_from_object: DAffine3::IDENTITY,
            material: MaterialId(0),
            emission: None,
            interior: None,
            origin,
        };
        let place = |group, x, scale: f64| Instance {
            group: GroupId(group),
            world_from_group: DAffine3::from_translation(DVec3::new(x, 0.0, 0.0))
                * DAffine3::from_scale(DVec3::splat(scale)),
            origin,
        };
        // The outer group stands before the inner one.
        let outer = Group { instances: vec![place(1, 10.0, 2.0)], ..Group::default() };
        let inner = Group { objects: vec![sphere], ..Group::default() };
        let scene = Scene {
            groups: vec![outer, inner],
            instances: vec![place(0, 100.0, 1.0), place(0, 0.0, 1.0)],
            ..Scene::default()
        };
        let expected = (DVec3::new(8.0, -2.0, -2.0), DVec3::new(112.0, 2.0, 2.0));
        assert_eq!(scene.bounds(), Some(expected));
        assert_eq!(scene.drawn_objects(), 2);
    }
}
