//! The bounding volume hierarchy: built by `obvhs`, laid out for the kernels.

use super::objects::Primitives;
use super::{Acceleration, count};
use kernels::records::kernel::{BvhNode, ObjectRecord};
use kernels::traversal::kernel::MAX_BVH_DEPTH;
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::builder::build_bvh2, bvh2::node::Bvh2Node};
use scene::DVec3;
use std::time::Duration;
use wgsl_rs::std::{Vec3f, vec3f};

/// Objects in the order in which the hierarchy refers to them.
pub(super) struct Hierarchy {
    pub nodes: Vec<BvhNode>,
    /// The unbounded objects, then the others.
    pub objects: Vec<ObjectRecord>,
    /// How many objects at the front are outside the hierarchy.
    pub unbounded: usize,
}

/// With no more objects than this a hierarchy does not pay; the kernels rely on a root with two children.
const FEW_OBJECTS: usize = 4;
/// Objects in a leaf at most.
const LEAF_OBJECTS: u32 = 4;

pub(super) fn arrange(primitives: Primitives, acceleration: Acceleration) -> Hierarchy {
    let Primitives { mut unbounded, mut bounded, boxes, .. } = primitives;
    if bounded.len() <= FEW_OBJECTS || acceleration == Acceleration::None {
        unbounded.append(&mut bounded);
        let count = unbounded.len();
        return Hierarchy { nodes: Vec::new(), objects: unbounded, unbounded: count };
    }
    let boxes: Vec<Aabb> = boxes.iter().map(|&(low, high)| rounded_outwards(low, high)).collect();
    let params = BvhBuildParams { max_prims_per_leaf: LEAF_OBJECTS, ..BvhBuildParams::medium_build() };
    let bvh = build_bvh2(&boxes, params, &mut Duration::default());
    let first = unbounded.len();
    let mut order = bvh.primitive_indices;
    let mut nodes = lay_out(&bvh.nodes, first);
    if nodes.is_empty() {
        // Too deep for the traversal stack, as happens when very many objects share one place.
        order = (0..count(boxes.len())).collect();
        nodes = split_by_count(&boxes, &mut order, first);
    }
    let mut objects = unbounded;
    objects.extend(order.iter().map(|&index| bounded[index as usize]));
    Hierarchy { nodes, objects, unbounded: first }
}

/// The nodes with the boxes of both children in the parent; empty if the tree is too deep.
fn lay_out(source: &[Bvh2Node], first_object: usize) -> Vec<BvhNode> {
    if source[0].is_leaf() {
        return Vec::new();
    }
    let mut nodes = vec![bytemuck::Zeroable::zeroed()];
    // (index in the source, index in the result, depth)
    let mut open = vec![(0usize, 0usize, 1u32)];
    while let Some((from, to, depth)) = open.pop() {
        if depth > MAX_BVH_DEPTH {
            return Vec::new();
        }
        let left = source[from].first_index as usize;
        let mut node: BvhNode = bytemuck::Zeroable::zeroed();
        for (side, child) in [left, left + 1].into_iter().enumerate() {
            let source_child = &source[child];
            let (index, objects) = if source_child.is_leaf() {
                (first_object + source_child.first_index as usize, source_child.prim_count)
            } else {
                nodes.push(bytemuck::Zeroable::zeroed());
                open.push((child, nodes.len() - 1, depth + 1));
                (nodes.len() - 1, 0)
            };
            set_child(&mut node, side, source_child.aabb(), index, objects);
        }
        nodes[to] = node;
    }
    nodes
}

/// A hierarchy of least depth: every node halves its objects along its longest axis.
fn split_by_count(boxes: &[Aabb], order: &mut [u32], first_object: usize) -> Vec<BvhNode> {
    let mut nodes: Vec<BvhNode> = vec![bytemuck::Zeroable::zeroed()];
    let mut open = vec![(0usize, 0..order.len())];
    while let Some((to, range)) = open.pop() {
        let members = &mut order[range.clone()];
        let extent = joined(boxes, members).diagonal();
        let axis = if extent.x >= extent.y && extent.x >= extent.z {
            0
        } else if extent.y >= extent.z {
            1
        } else {
            2
        };
        let middle = members.len() / 2;
        members.select_nth_unstable_by(middle, |a, b| {
            boxes[*a as usize].center()[axis].total_cmp(&boxes[*b as usize].center()[axis])
        });
        let mut node: BvhNode = bytemuck::Zeroable::zeroed();
        let halves = [range.start..range.start + middle, range.start + middle..range.end];
        for (side, half) in halves.into_iter().enumerate() {
            let aabb = joined(boxes, &order[half.clone()]);
            if half.len() <= LEAF_OBJECTS as usize {
                set_child(&mut node, side, &aabb, first_object + half.start, count(half.len()));
            } else {
                nodes.push(bytemuck::Zeroable::zeroed());
                set_child(&mut node, side, &aabb, nodes.len() - 1, 0);
                open.push((nodes.len() - 1, half));
            }
        }
        nodes[to] = node;
    }
    nodes
}

fn joined(boxes: &[Aabb], members: &[u32]) -> Aabb {
    members.iter().fold(Aabb::empty(), |all, &index| all.union(&boxes[index as usize]))
}

fn set_child(node: &mut BvhNode, side: usize, aabb: &Aabb, child: usize, objects: u32) {
    let low: Vec3f = vec3f(aabb.min.x, aabb.min.y, aabb.min.z);
    let high: Vec3f = vec3f(aabb.max.x, aabb.max.y, aabb.max.z);
    if side == 0 {
        (node.min0, node.max0, node.child0, node.count0) = (low, high, count(child), objects);
    } else {
        (node.min1, node.max1, node.child1, node.count1) = (low, high, count(child), objects);
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

    fn check_contains_all(nodes: &[BvhNode], objects: usize) {
        let mut seen = vec![0; objects];
        let mut open = vec![(0u32, 1)];
        while let Some((index, depth)) = open.pop() {
            assert!(depth <= MAX_BVH_DEPTH);
            let node = nodes[index as usize];
            for (child, count) in [(node.child0, node.count0), (node.child1, node.count1)] {
                if count == 0 {
                    open.push((child, depth + 1));
                }
                for object in child..child + count {
                    seen[object as usize] += 1;
                }
            }
        }
        assert!(seen.iter().all(|&n| n == 1));
    }

    #[test]
    fn coincident_objects_do_not_overflow_the_traversal_stack() {
        let boxes = vec![Aabb::new([0.0; 3].into(), [1.0; 3].into()); 5000];
        let bvh = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        let nodes = lay_out(&bvh.nodes, 0);
        if !nodes.is_empty() {
            check_contains_all(&nodes, boxes.len());
        }
        let mut order: Vec<u32> = (0..5000).collect();
        let nodes = split_by_count(&boxes, &mut order, 0);
        check_contains_all(&nodes, boxes.len());
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
