//! The bounding volume hierarchies of the scene and of its groups: built by `obvhs`, laid out for the kernels.

use super::objects::Primitives;
use super::{Acceleration, count};
use kernels::records::kernel::{BvhNode, INSTANCE_BIT, ObjectRecord, SHAPE_INSTANCE, SHAPE_MASK};
use kernels::traversal::kernel::MAX_BVH_DEPTH;
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::builder::build_bvh2, bvh2::node::Bvh2Node};
use scene::DVec3;
use std::ops::Range;
use std::time::Duration;
use wgsl_rs::std::{Vec3f, vec3f};

/// Objects in the order in which the hierarchies refer to them.
pub(super) struct Hierarchy {
    /// Root of the scene first, then the hierarchies of the groups.
    pub nodes: Vec<BvhNode>,
    /// The unbounded objects, then the bounded ones, then those of the groups.
    pub objects: Vec<ObjectRecord>,
    /// How many objects at the front are outside the hierarchy.
    pub unbounded: usize,
}

/// With no more objects than this a hierarchy does not pay; the kernels rely on a root with two children.
const FEW_OBJECTS: usize = 4;
/// Objects in a leaf at most.
const LEAF_OBJECTS: usize = 4;

/// Arranges the objects of a scene and of its groups, each of which has at least two. The instances among the
/// objects of the scene name their group in the field that becomes the root of its hierarchy.
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
    let placed = hierarchy.objects.len();
    let roots: Vec<u32> = groups.iter().map(|group| hierarchy.append(&group.bounded, &group.boxes)).collect();
    for object in &mut hierarchy.objects[..placed] {
        if is_instance(object) {
            object.shape.material = roots[object.shape.material as usize];
        }
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
        // Leaf objects of the builder are counted in 32 bits.
        let params =
            BvhBuildParams { max_prims_per_leaf: LEAF_OBJECTS as u32, ..BvhBuildParams::medium_build() };
        let bvh = build_bvh2(&boxes, params, &mut Duration::default());
        let layout = |source, order: Vec<u32>| Layout {
            source,
            boxes: &boxes,
            is_instance: objects.iter().map(is_instance).collect(),
            order,
            first_node: self.nodes.len(),
            first_object: self.objects.len(),
        };
        let mut layout_of_builder = layout(&bvh.nodes[..], bvh.primitive_indices.clone());
        let (nodes, order) = match layout_of_builder.nodes() {
            Some(nodes) => (nodes, layout_of_builder.order),
            None => {
                // Too deep for the traversal stack, as happens when very many objects share one place: halved
                // again and again instead.
                let mut halved = layout(&[], (0..count(boxes.len())).collect());
                (halved.nodes().unwrap_or_default(), halved.order)
            }
        };
        let root = count(self.nodes.len());
        self.nodes.extend(nodes);
        self.objects.extend(order.iter().map(|&index| objects[index as usize]));
        root
    }
}

/// What stands below a node.
enum Below {
    /// The tree of the builder under this node.
    Source(usize),
    /// These places in the order of objects, to be halved.
    Objects(Range<usize>),
}

/// A tree on its way into the form of the kernels: the boxes of both children in the parent.
struct Layout<'a> {
    /// What the builder made; empty for a hierarchy of least depth.
    source: &'a [Bvh2Node],
    boxes: &'a [Aabb],
    is_instance: Vec<bool>,
    /// The objects as leaves refer to them.
    order: Vec<u32>,
    first_node: usize,
    first_object: usize,
}

impl Layout<'_> {
    /// The nodes; `None` if the tree is too deep.
    fn nodes(&mut self) -> Option<Vec<BvhNode>> {
        let mut nodes = vec![bytemuck::Zeroable::zeroed()];
        let root = match self.source.first() {
            Some(root) if !root.is_leaf() => Below::Source(0),
            _ => Below::Objects(0..self.order.len()),
        };
        let mut open = vec![(root, 0usize, 1u32)];
        while let Some((below, place, depth)) = open.pop() {
            if depth > MAX_BVH_DEPTH {
                return None;
            }
            let mut node: BvhNode = bytemuck::Zeroable::zeroed();
            for (side, (child, aabb)) in self.children(below).into_iter().enumerate() {
                let (index, objects) = match self.leaf(&child) {
                    Some(leaf) => leaf,
                    None => {
                        nodes.push(bytemuck::Zeroable::zeroed());
                        open.push((child, nodes.len() - 1, depth + 1));
                        (count(self.first_node + nodes.len() - 1), 0)
                    }
                };
                set_child(&mut node, side, &aabb, index, objects);
            }
            nodes[place] = node;
        }
        Some(nodes)
    }

    fn children(&mut self, below: Below) -> [(Below, Aabb); 2] {
        match below {
            Below::Source(index) => {
                let left = self.source[index].first_index as usize;
                [left, left + 1].map(|child| {
                    let node = &self.source[child];
                    let below = if node.is_leaf() {
                        let first = node.first_index as usize;
                        Below::Objects(first..first + node.prim_count as usize)
                    } else {
                        Below::Source(child)
                    };
                    (below, *node.aabb())
                })
            }
            Below::Objects(range) => self.halves(range).map(|half| {
                let aabb = joined(self.boxes, &self.order[half.clone()]);
                (Below::Objects(half), aabb)
            }),
        }
    }

    /// Index and number of objects of a child that needs no node of its own: an instance, or a few others.
    fn leaf(&self, below: &Below) -> Option<(u32, u32)> {
        let Below::Objects(range) = below else { return None };
        let first = count(self.first_object + range.start);
        let instances =
            self.order[range.clone()].iter().filter(|index| self.is_instance[**index as usize]).count();
        match (range.len(), instances) {
            (1, 1) => Some((first | INSTANCE_BIT, 0)),
            (..=LEAF_OBJECTS, 0) => Some((first, count(range.len()))),
            _ => None,
        }
    }

    /// Halves objects along the longest axis of their box.
    fn halves(&mut self, range: Range<usize>) -> [Range<usize>; 2] {
        let members = &mut self.order[range.clone()];
        let extent = joined(self.boxes, members).diagonal();
        let axis = if extent.x >= extent.y && extent.x >= extent.z {
            0
        } else if extent.y >= extent.z {
            1
        } else {
            2
        };
        let middle = members.len() / 2;
        let boxes = self.boxes;
        members.select_nth_unstable_by(middle, |a, b| {
            boxes[*a as usize].center()[axis].total_cmp(&boxes[*b as usize].center()[axis])
        });
        [range.start..range.start + middle, range.start + middle..range.end]
    }
}

fn joined(boxes: &[Aabb], members: &[u32]) -> Aabb {
    members.iter().fold(Aabb::empty(), |all, &index| all.union(&boxes[index as usize]))
}

fn set_child(node: &mut BvhNode, side: usize, aabb: &Aabb, child: u32, objects: u32) {
    let low: Vec3f = vec3f(aabb.min.x, aabb.min.y, aabb.min.z);
    let high: Vec3f = vec3f(aabb.max.x, aabb.max.y, aabb.max.z);
    if side == 0 {
        (node.min0, node.max0, node.child0, node.count0) = (low, high, child, objects);
    } else {
        (node.min1, node.max1, node.child1, node.count1) = (low, high, child, objects);
    }
}

/// A box in 32 bits that contains the exact one, and what rounding in the intersection may add.
fn rounded_outwards(low: DVec3, high: DVec3) -> Aabb {
    let margin = (low.abs().max(high.abs()) * 4e-7).max(DVec3::splat(1e-30));
    let (low, high) = (low - margin, high + margin);
    Aabb::new(
        [low.x as f32, low.y as f32, low.z as f32].into(),
        [high.x as f32, high.y as f32, high.z as f32].into(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::records::kernel::{SHAPE_BOX, ShapeRecord};

    fn check_contains_all(nodes: &[BvhNode], objects: usize) {
        let mut seen = vec![0; objects];
        let mut open = vec![(0u32, 1)];
        while let Some((index, depth)) = open.pop() {
            assert!(depth <= MAX_BVH_DEPTH);
            let node = nodes[index as usize];
            for (child, count) in [(node.child0, node.count0), (node.child1, node.count1)] {
                if child & INSTANCE_BIT != 0 {
                    seen[(child ^ INSTANCE_BIT) as usize] += 1;
                } else if count == 0 {
                    open.push((child, depth + 1));
                }
                for object in child..child + count {
                    seen[object as usize] += 1;
                }
            }
        }
        assert!(seen.iter().all(|&n| n == 1));
    }

    fn objects(kinds: impl Iterator<Item = u32>) -> Vec<ObjectRecord> {
        let zero: ObjectRecord = bytemuck::Zeroable::zeroed();
        kinds.map(|kind| ObjectRecord { shape: ShapeRecord { kind, ..zero.shape }, ..zero }).collect()
    }

    #[test]
    fn coincident_objects_do_not_overflow_the_traversal_stack() {
        let mut hierarchy = Hierarchy { nodes: Vec::new(), objects: Vec::new(), unbounded: 0 };
        let records = objects(std::iter::repeat_n(SHAPE_BOX, 5000));
        hierarchy.append(&records, &vec![(DVec3::ZERO, DVec3::ONE); 5000]);
        check_contains_all(&hierarchy.nodes, 5000);
    }

    #[test]
    fn instances_stand_alone_in_the_tree() {
        for instances in [1, 2, 3, 7, 50] {
            let kinds = (0..50).map(|i| if i % 7 < instances { SHAPE_INSTANCE } else { SHAPE_BOX });
            let records = objects(kinds);
            let place = |i: u32| DVec3::new(f64::from(i % 5), f64::from(i % 3), 0.0);
            let boxes: Vec<_> = (0..50).map(|i| (place(i), place(i) + DVec3::ONE)).collect();
            let mut hierarchy = Hierarchy { nodes: Vec::new(), objects: Vec::new(), unbounded: 0 };
            hierarchy.append(&records, &boxes);
            check_contains_all(&hierarchy.nodes, 50);
            for node in &hierarchy.nodes {
                for (child, count) in [(node.child0, node.count0), (node.child1, node.count1)] {
                    if child & INSTANCE_BIT != 0 {
                        assert!(is_instance(&hierarchy.objects[(child ^ INSTANCE_BIT) as usize]));
                    }
                    assert!((child..child + count).all(|i| !is_instance(&hierarchy.objects[i as usize])));
                }
            }
        }
    }

    #[test]
    fn boxes_in_32_bits_contain_the_exact_ones() {
        let (low, high) = (DVec3::new(0.1, -1000.1, 5e-8), DVec3::new(0.1, 1000.3, 6e-8));
        let aabb = rounded_outwards(low, high);
        assert!(
            f64::from(aabb.min.x) < low.x && f64::from(aabb.min.y) < low.y && f64::from(aabb.min.z) < low.z
        );
        assert!(
            f64::from(aabb.max.x) > high.x
                && f64::from(aabb.max.y) > high.y
                && f64::from(aabb.max.z) > high.z
        );
    }
}
