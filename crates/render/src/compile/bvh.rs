//! The bounding volume hierarchies of the scene and of its groups, laid out for the kernels.
//!
//! Binary trees come from `obvhs` ([`binary`](super::binary)); here they are folded into nodes with up to eight
//! children ([`collapse`](super::collapse)). Instances have the boxes of what is in their groups
//! ([`outline`](super::outline)).

use super::binary::{BinaryTree, rounded_outwards};
use super::collapse::Collapse;
use super::node_encoding::{Child, Content, arrange_in_slots, encode};
use super::objects::Primitives;
use super::outline::Outline;
use super::{Acceleration, count};
use kernels::records::kernel::{BvhNode, NODE_INSTANCE, ObjectRecord};
use kernels::traversal::kernel::MAX_BVH_DEPTH;
use obvhs::aabb::Aabb;
use rayon::prelude::*;
use scene::DVec3;

/// Objects in the order in which the hierarchies refer to them.
pub(super) struct Hierarchy {
    /// Root of the scene first, then the hierarchies of the groups.
    pub nodes: Vec<BvhNode>,
    /// The unbounded objects, then the bounded ones, then those of the groups.
    pub objects: Vec<ObjectRecord>,
    /// How many objects at the front are outside the hierarchy.
    pub unbounded: usize,
}

/// With no more objects than this a hierarchy does not pay.
const FEW_OBJECTS: usize = 2;

/// Arranges the objects of a scene and of its groups.
pub(super) fn arrange(scene: Primitives, groups: Vec<Primitives>, acceleration: Acceleration) -> Hierarchy {
    let Primitives { mut unbounded, mut bounded, boxes, instances } = scene;
    let few = bounded.len() <= FEW_OBJECTS && instances.is_empty();
    if few || acceleration == Acceleration::None {
        unbounded.append(&mut bounded);
        let count = unbounded.len();
        return Hierarchy { nodes: Vec::new(), objects: unbounded, unbounded: count };
    }
    let trees: Vec<(Folded, Outline)> = groups
        .par_iter()
        .map(|group| {
            let (tree, folded) = Folded::over(&in_32_bits(&group.boxes), group.bounded.len());
            (folded, Outline::new(&tree, instances.len()))
        })
        .collect();
    let mut boxes = in_32_bits(&boxes);
    boxes.par_extend(instances.par_iter().map(|instance| {
        let (low, high) = trees[instance.group()].1.bounds(&instance.local_from_group);
        rounded_outwards(low, high)
    }));
    let objects_alone = bounded.len();
    bounded.extend(instances.iter().map(|instance| instance.record));

    let mut hierarchy = Hierarchy { nodes: Vec::new(), unbounded: unbounded.len(), objects: unbounded };
    hierarchy.append(Folded::over(&boxes, objects_alone).1, &bounded);
    let nodes_of_scene = hierarchy.nodes.len();
    let roots: Vec<u32> = trees
        .into_iter()
        .zip(&groups)
        .map(|((folded, _), group)| hierarchy.append(folded, &group.bounded))
        .collect();
    let Hierarchy { nodes, objects, .. } = &mut hierarchy;
    for node in nodes[..nodes_of_scene].iter_mut().filter(|node| node.exponents == NODE_INSTANCE) {
        let group = objects[node.first_object as usize].shape.material;
        node.first_node = roots[group as usize];
    }
    hierarchy
}

fn in_32_bits(boxes: &[(DVec3, DVec3)]) -> Vec<Aabb> {
    boxes.iter().map(|&(low, high)| rounded_outwards(low, high)).collect()
}

impl Hierarchy {
    /// Adds a tree over some objects and returns its root.
    fn append(&mut self, folded: Folded, objects: &[ObjectRecord]) -> u32 {
        let (root, first_object) = (count(self.nodes.len()), count(self.objects.len()));
        self.nodes.extend(folded.nodes.into_iter().map(|node| match node.exponents {
            // Where its group starts is not known yet.
            NODE_INSTANCE => BvhNode { first_object: node.first_object + first_object, ..node },
            _ => BvhNode {
                first_node: node.first_node + root,
                first_object: node.first_object + first_object,
                ..node
            },
        }));
        self.objects.extend(folded.order.iter().map(|&index| objects[index as usize]));
        root
    }
}

/// A tree of wide nodes, counted from its root on.
struct Folded {
    nodes: Vec<BvhNode>,
    /// The objects as nodes refer to them.
    order: Vec<u32>,
}

impl Folded {
    /// A tree over the boxes of some objects, of which the first `objects_alone` are no instances; and the binary one that
    /// it was folded from.
    fn over(boxes: &[Aabb], objects_alone: usize) -> (BinaryTree, Self) {
        let tree = BinaryTree::by_surface_area(boxes);
        if let Some(folded) = Self::fold(&tree, objects_alone) {
            return (tree, folded);
        }
        // Too deep for the traversal stack, as happens when very many objects share one place.
        let tree = BinaryTree::of_least_depth(boxes);
        let nothing = Folded { nodes: Vec::new(), order: Vec::new() };
        let folded = Self::fold(&tree, objects_alone).unwrap_or(nothing);
        (tree, folded)
    }

    /// Nothing if the tree is too deep.
    fn fold(tree: &BinaryTree, objects_alone: usize) -> Option<Self> {
        let collapse = Collapse::new(tree);
        let mut nodes: Vec<BvhNode> = vec![bytemuck::Zeroable::zeroed()];
        let mut order = Vec::with_capacity(tree.len() / 2 + 1);
        let mut open = vec![(tree.root(), 0usize, 1u32)];
        while let Some((binary, place, depth)) = open.pop() {
            if depth > MAX_BVH_DEPTH {
                return None;
            }
            let parts = arrange_in_slots(collapse.children(binary), |&part| *tree.aabb(part));
            // Instances stand in the order of objects by themselves, before those of the leaves.
            let first_node = count(nodes.len());
            let mut members = Vec::new();
            let children = parts.map(|part| {
                let part = part?;
                let content = match tree.single_box(part) {
                    // A box of its own spares an object more work than it makes, measured on plants and canopies.
                    Some(object) if (object as usize) < objects_alone => {
                        members.push(object);
                        Content::Object
                    }
                    Some(object) => {
                        nodes.push(BvhNode {
                            exponents: NODE_INSTANCE,
                            first_object: count(order.len()),
                            ..bytemuck::Zeroable::zeroed()
                        });
                        order.push(object);
                        Content::Node
                    }
                    None => {
                        open.push((part, nodes.len(), depth + 1));
                        nodes.push(bytemuck::Zeroable::zeroed());
                        Content::Node
                    }
                };
                Some(Child { aabb: *tree.aabb(part), content })
            });
            nodes[place] = encode(&children, first_node, count(order.len()));
            order.append(&mut members);
        }
        Some(Folded { nodes, order })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::objects::PlacedGroup;
    use kernels::records::kernel::{SHAPE_BOX, SHAPE_INSTANCE, SHAPE_MASK, ShapeRecord};
    use scene::DAffine3;
    use std::collections::HashMap;

    /// Numbers its objects by their radius.
    fn records(kind: u32, count: usize) -> Vec<ObjectRecord> {
        let zero: ObjectRecord = bytemuck::Zeroable::zeroed();
        (0..count)
            .map(|i| {
                let shape = ShapeRecord { kind, base_radius: i as f32, ..zero.shape };
                ObjectRecord { shape, ..zero }
            })
            .collect()
    }

    fn primitives(boxes: &[(DVec3, DVec3)]) -> Primitives {
        Primitives {
            bounded: records(SHAPE_BOX, boxes.len()),
            boxes: boxes.to_vec(),
            ..Primitives::default()
        }
    }

    /// Visits all that a root leads to: how often each object is found, with the instance that it is found in.
    fn found(hierarchy: &Hierarchy) -> HashMap<(Option<u32>, u32), usize> {
        let mut found = HashMap::new();
        let mut open = vec![(0u32, 1, None)];
        while let Some((index, depth, instance)) = open.pop() {
            assert!(depth <= MAX_BVH_DEPTH + 1);
            let node = hierarchy.nodes[index as usize];
            if node.exponents == NODE_INSTANCE {
                let object = hierarchy.objects[node.first_object as usize];
                assert_eq!((object.shape.kind & SHAPE_MASK, instance), (SHAPE_INSTANCE, None));
                open.push((node.first_node, 1, Some(node.first_object)));
                continue;
            }
            let nodes = node.exponents >> 24;
            open.extend((0..nodes.count_ones()).map(|child| (node.first_node + child, depth + 1, instance)));
            assert_eq!(nodes & node.leaves, 0);
            for object in (node.first_object..).take(node.leaves.count_ones() as usize) {
                assert_eq!(hierarchy.objects[object as usize].shape.kind & SHAPE_MASK, SHAPE_BOX);
                *found.entry((instance, object)).or_default() += 1;
            }
        }
        found
    }

    fn check_contains_all(boxes: &[(DVec3, DVec3)]) {
        let found = found(&arrange(primitives(boxes), Vec::new(), Acceleration::Bvh));
        assert_eq!(found.len(), boxes.len());
        assert!(found.into_values().all(|times| times == 1));
    }

    fn places(number: u32) -> Vec<(DVec3, DVec3)> {
        let place = |i: u32| DVec3::new(f64::from(i % 5), f64::from(i * 7 % 11), f64::from(i / 30));
        (0..number).map(|i| (place(i), place(i) + DVec3::ONE)).collect()
    }

    #[test]
    fn coincident_objects_do_not_overflow_the_traversal_stack() {
        check_contains_all(&[(DVec3::ZERO, DVec3::ONE); 5000]);
    }

    #[test]
    fn objects_that_grow_without_end_do_not_overflow_the_traversal_stack() {
        // Each twice as large as the one before, all from one corner: the best binary tree is a chain.
        let boxes: Vec<_> =
            (0..60).map(|i| (DVec3::ZERO, DVec3::splat(f64::from(i).exp2() * 1e-9))).collect();
        check_contains_all(&boxes);
    }

    #[test]
    fn every_member_of_every_instance_is_found_once() {
        for (objects, instances, members) in
            [(0, 1, 2), (1, 1, 300), (50, 7, 3), (3, 40, 900), (0, 20_000, 70)]
        {
            let scene = Primitives {
                instances: (0..instances)
                    .map(|i| PlacedGroup {
                        record: records(SHAPE_INSTANCE, 1)[0],
                        local_from_group: DAffine3::from_rotation_z(f64::from(i))
                            * DAffine3::from_translation(DVec3::new(
                                f64::from(i % 100),
                                f64::from(i / 100),
                                0.0,
                            )),
                    })
                    .collect(),
                ..primitives(&places(objects))
            };
            let hierarchy = arrange(scene, vec![primitives(&places(members))], Acceleration::Bvh);
            let found = found(&hierarchy);
            assert_eq!(found.len(), (objects + instances * members) as usize);
            assert!(found.into_values().all(|times| times == 1));
            assert_eq!(hierarchy.objects.len(), (objects + instances + members) as usize);
        }
    }
}
