//! The bounding volume hierarchies of the scene and of its groups, laid out for the kernels.
//!
//! Binary trees come from `obvhs` ([`binary`](super::binary)); here they are folded into nodes with up to eight
//! children ([`collapse`](super::collapse)).

use super::binary::{BinaryTree, NodeNumber, rounded_outwards};
use super::collapse::Collapse;
use super::node_encoding::{Child, Content, arrange_in_slots, encode};
use super::objects::Primitives;
use super::{Acceleration, count};
use kernels::records::kernel::{BvhNode, NODE_INSTANCE, ObjectRecord, SHAPE_INSTANCE, SHAPE_MASK};
use kernels::traversal::kernel::MAX_BVH_DEPTH;
use obvhs::aabb::Aabb;
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
/// Objects in a leaf at most; those of eight leaves must fit into the bits of a word. One: a box of its own spares an
/// object more work than it makes, measured on plants and canopies.
pub(crate) const LEAF_OBJECTS: usize = 1;

/// Arranges the objects of a scene and of its groups. The instances among the objects of the scene name their group
/// in the field `material`.
pub(super) fn arrange(scene: Primitives, groups: Vec<Primitives>, acceleration: Acceleration) -> Hierarchy {
    let Primitives { mut unbounded, mut bounded, boxes } = scene;
    let few = bounded.len() <= FEW_OBJECTS && !bounded.iter().any(is_instance);
    if few || acceleration == Acceleration::None {
        unbounded.append(&mut bounded);
        let count = unbounded.len();
        return Hierarchy { nodes: Vec::new(), objects: unbounded, unbounded: count };
    }
    let mut hierarchy = Hierarchy { nodes: Vec::new(), unbounded: unbounded.len(), objects: unbounded };
    hierarchy.append(&bounded, &boxes);
    let nodes_of_scene = hierarchy.nodes.len();
    let roots: Vec<u32> = groups.iter().map(|group| hierarchy.append(&group.bounded, &group.boxes)).collect();
    let Hierarchy { nodes, objects, .. } = &mut hierarchy;
    for node in nodes[..nodes_of_scene].iter_mut().filter(|node| node.exponents == NODE_INSTANCE) {
        let group = objects[node.first_object as usize].shape.material;
        node.first_node = roots[group as usize];
    }
    hierarchy
}

fn is_instance(object: &ObjectRecord) -> bool {
    object.shape.kind & SHAPE_MASK == SHAPE_INSTANCE
}

impl Hierarchy {
    /// Adds a tree over some objects and returns its root.
    fn append(&mut self, objects: &[ObjectRecord], boxes: &[(DVec3, DVec3)]) -> u32 {
        let boxes: Vec<Aabb> = boxes.iter().map(|&(low, high)| rounded_outwards(low, high)).collect();
        let is_instance: Vec<bool> = objects.iter().map(is_instance).collect();
        let folded = |tree: &BinaryTree| {
            let mut folding = Folding {
                tree,
                is_instance: &is_instance,
                nodes: Vec::new(),
                order: Vec::with_capacity(objects.len()),
                first_node: self.nodes.len(),
                first_object: self.objects.len(),
            };
            folding.run().then_some((folding.nodes, folding.order))
        };
        let (nodes, order) = folded(&BinaryTree::by_surface_area(&boxes))
            // Too deep for the traversal stack, as happens when very many objects share one place.
            .or_else(|| folded(&BinaryTree::of_least_depth(&boxes)))
            .unwrap_or_default();
        let root = count(self.nodes.len());
        self.nodes.extend(nodes);
        self.objects.extend(order.iter().map(|&index| objects[index as usize]));
        root
    }
}

/// A binary tree on its way into wide nodes.
struct Folding<'a> {
    tree: &'a BinaryTree,
    is_instance: &'a [bool],
    nodes: Vec<BvhNode>,
    /// The objects as leaves refer to them.
    order: Vec<u32>,
    /// Where in the whole hierarchy the nodes and the objects of this tree start.
    first_node: usize,
    first_object: usize,
}

impl Folding<'_> {
    /// Makes the nodes; false if the tree is too deep.
    fn run(&mut self) -> bool {
        let collapse = Collapse::new(self.tree);
        self.nodes.push(bytemuck::Zeroable::zeroed());
        let mut open = vec![(self.tree.root(), 0usize, 1u32)];
        while let Some((binary, place, depth)) = open.pop() {
            if depth > MAX_BVH_DEPTH {
                return false;
            }
            let parts = arrange_in_slots(collapse.children(binary), |&part| *self.tree.aabb(part));
            // Instances stand in the order of objects by themselves, before those of the leaves.
            let first_node = self.nodes.len();
            let mut members = Vec::new();
            let children = parts.map(|part| {
                let part = part?;
                let content = match self.leaf(part) {
                    Leaf::Objects(objects) => {
                        let count = objects.len();
                        members.extend(objects);
                        Content::Objects(count)
                    }
                    Leaf::Instance(object) => {
                        self.order.push(object);
                        self.nodes.push(BvhNode {
                            exponents: NODE_INSTANCE,
                            first_object: count(self.first_object + self.order.len() - 1),
                            ..bytemuck::Zeroable::zeroed()
                        });
                        Content::Node
                    }
                    Leaf::None => {
                        open.push((part, self.nodes.len(), depth + 1));
                        self.nodes.push(bytemuck::Zeroable::zeroed());
                        Content::Node
                    }
                };
                Some(Child { aabb: *self.tree.aabb(part), content })
            });
            self.nodes[place] = encode(
                &children,
                count(self.first_node + first_node),
                count(self.first_object + self.order.len()),
            );
            self.order.append(&mut members);
        }
        true
    }

    /// What a part of the tree becomes.
    fn leaf(&self, part: NodeNumber) -> Leaf {
        if self.tree.count(part) > LEAF_OBJECTS {
            return Leaf::None;
        }
        let objects = self.tree.boxes(part);
        let is_instance = |index: &u32| self.is_instance[*index as usize];
        match objects[..] {
            [object] if is_instance(&object) => Leaf::Instance(object),
            _ if objects.iter().any(is_instance) => Leaf::None,
            _ => Leaf::Objects(objects),
        }
    }
}

enum Leaf {
    /// Too much for a leaf.
    None,
    Instance(u32),
    Objects(Vec<u32>),
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::bvh::kernel::leaf_objects;
    use kernels::records::kernel::{SHAPE_BOX, ShapeRecord};

    fn check_contains_all(hierarchy: &Hierarchy, objects: usize) {
        let mut seen = vec![0; objects];
        let mut open = vec![(0u32, 1)];
        while let Some((index, depth)) = open.pop() {
            assert!(depth <= MAX_BVH_DEPTH + 1);
            let node = hierarchy.nodes[index as usize];
            if node.exponents == NODE_INSTANCE {
                assert!(is_instance(&hierarchy.objects[node.first_object as usize]));
                seen[node.first_object as usize] += 1;
                continue;
            }
            let nodes = node.exponents >> 24;
            open.extend((0..nodes.count_ones()).map(|child| (node.first_node + child, depth + 1)));
            let members = leaf_objects(node, !nodes & 255);
            for bit in (0..32).filter(|bit| members >> bit & 1 == 1) {
                let object = (node.first_object + bit) as usize;
                assert!(!is_instance(&hierarchy.objects[object]));
                seen[object] += 1;
            }
        }
        assert!(seen.iter().all(|&n| n == 1));
    }

    fn objects(kinds: impl Iterator<Item = u32>) -> Vec<ObjectRecord> {
        let zero: ObjectRecord = bytemuck::Zeroable::zeroed();
        kinds.map(|kind| ObjectRecord { shape: ShapeRecord { kind, ..zero.shape }, ..zero }).collect()
    }

    fn hierarchy(kinds: &[u32], boxes: &[(DVec3, DVec3)]) -> Hierarchy {
        let mut hierarchy = Hierarchy { nodes: Vec::new(), objects: Vec::new(), unbounded: 0 };
        hierarchy.append(&objects(kinds.iter().copied()), boxes);
        hierarchy
    }

    #[test]
    fn coincident_objects_do_not_overflow_the_traversal_stack() {
        let hierarchy = hierarchy(&[SHAPE_BOX; 5000], &[(DVec3::ZERO, DVec3::ONE); 5000]);
        check_contains_all(&hierarchy, 5000);
    }

    #[test]
    fn objects_that_grow_without_end_do_not_overflow_the_traversal_stack() {
        // Each twice as large as the one before, all from one corner: the best binary tree is a chain.
        let boxes: Vec<_> =
            (0..60).map(|i| (DVec3::ZERO, DVec3::splat(f64::from(i).exp2() * 1e-9))).collect();
        check_contains_all(&hierarchy(&[SHAPE_BOX; 60], &boxes), 60);
    }

    #[test]
    fn instances_stand_alone_in_the_tree() {
        for instances in [1, 2, 3, 7, 50] {
            let kinds: Vec<u32> =
                (0..50).map(|i| if i % 7 < instances { SHAPE_INSTANCE } else { SHAPE_BOX }).collect();
            let place = |i: u32| DVec3::new(f64::from(i % 5), f64::from(i % 3), 0.0);
            let boxes: Vec<_> = (0..50).map(|i| (place(i), place(i) + DVec3::ONE)).collect();
            check_contains_all(&hierarchy(&kinds, &boxes), 50);
        }
    }

    #[test]
    fn a_single_instance_makes_a_tree() {
        let hierarchy = hierarchy(&[SHAPE_INSTANCE], &[(DVec3::ZERO, DVec3::ONE)]);
        check_contains_all(&hierarchy, 1);
    }
}
