//! Wide nodes as the kernels read them: the boxes of the children on a grid of bytes.

use kernels::records::kernel::BvhNode;
use obvhs::aabb::Aabb;
use wgsl_rs::std::{Vec4u, vec3f, vec4u};

/// A child of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Child {
    pub aabb: Aabb,
    pub content: Content,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Another node.
    Node,
    /// An object.
    Object,
}

/// By so many cells, beyond rounding to whole ones, boxes reach further than their objects: more than what the
/// kernel loses near the grid, where its numbers are at most some hundred cells.
const MARGIN: f64 = 0.02;
/// Cells between the lowest and the highest box.
const CELLS: f64 = 254.0;
/// A cell is not smaller than this part of the coordinates, so that 32 bits hold the corner of the grid well enough.
const SMALLEST_CELL: f64 = 1.0 / 131_072.0;

/// Children at their places in a node, if they are there.
pub(super) type Slots<T> = [Option<T>; 8];

/// Gives every child the free place on whose side of the node it lies most.
pub(super) fn arrange_in_slots<T>(children: Vec<T>, aabb: impl Fn(&T) -> Aabb) -> Slots<T> {
    let all = children.iter().fold(Aabb::empty(), |all, child| all.union(&aabb(child)));
    let middle = all.center();
    let mut left: Vec<(T, [f32; 3])> = children
        .into_iter()
        .map(|child| {
            let offset = (aabb(&child).center() - middle).to_array();
            (child, offset)
        })
        .collect();
    let mut slots: Slots<T> = Default::default();
    while !left.is_empty() {
        let mut best = (f32::NEG_INFINITY, 0, 0);
        for (index, (_, offset)) in left.iter().enumerate() {
            for slot in (0..slots.len()).filter(|&slot| slots[slot].is_none()) {
                let along =
                    (0..3).map(|axis| if slot >> axis & 1 == 1 { offset[axis] } else { -offset[axis] });
                let fit: f32 = along.sum();
                if fit > best.0 {
                    best = (fit, index, slot);
                }
            }
        }
        slots[best.2] = Some(left.swap_remove(best.1).0);
    }
    slots
}

/// A node with its children in their places. `first_node` and `first_object` are where the nodes and the objects
/// of the children, in the order of their places, start.
pub(super) fn encode(children: &Slots<Child>, first_node: u32, first_object: u32) -> BvhNode {
    let all = children.iter().flatten().fold(Aabb::empty(), |all, child| all.union(&child.aabb));
    let (low, high) = (all.min.to_array().map(f64::from), all.max.to_array().map(f64::from));
    let mut exponents = [0u32; 3];
    let mut origin = [0f32; 3];
    let mut cell = [0f64; 3];
    for axis in 0..3 {
        let coordinates = low[axis].abs().max(high[axis].abs());
        let wanted = ((high[axis] - low[axis]) / CELLS).max(coordinates * SMALLEST_CELL);
        // The power of two above, as a biased exponent within the range of normal numbers.
        let exponent = (wanted.log2().ceil() + 127.0).clamp(1.0, 250.0);
        exponents[axis] = exponent as u32;
        cell[axis] = (exponent - 127.0).exp2();
        origin[axis] = (low[axis] - 0.5 * cell[axis]) as f32;
    }
    let mut node = BvhNode {
        origin: vec3f(origin[0], origin[1], origin[2]),
        exponents: exponents[0] | exponents[1] << 8 | exponents[2] << 16,
        first_node,
        first_object,
        ..bytemuck::Zeroable::zeroed()
    };
    // Where there is no child the box is empty: its lower end is above the upper one.
    let mut low_cells = [[255u8; 8]; 3];
    let mut high_cells = [[0u8; 8]; 3];
    for (slot, child) in children.iter().enumerate() {
        let Some(child) = child else { continue };
        let (low, high) = (child.aabb.min.to_array(), child.aabb.max.to_array());
        for axis in 0..3 {
            let cells = |end: f32| (f64::from(end) - f64::from(origin[axis])) / cell[axis];
            // Saturates at the ends of the grid.
            low_cells[axis][slot] = (cells(low[axis]) - MARGIN).floor() as u8;
            high_cells[axis][slot] = (cells(high[axis]) + MARGIN).ceil() as u8;
        }
        match child.content {
            Content::Node => node.exponents |= 1 << (24 + slot),
            Content::Object => node.leaves |= 1 << slot,
        }
    }
    let words = |bytes: [u8; 8]| {
        let [a, b, c, d, e, f, g, h] = bytes;
        [u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h])]
    };
    let pair = |first: [u8; 8], second: [u8; 8]| -> Vec4u {
        let ([a, b], [c, d]) = (words(first), words(second));
        vec4u(a, b, c, d)
    };
    node.low_xy = pair(low_cells[0], low_cells[1]);
    node.low_z_high_x = pair(low_cells[2], high_cells[0]);
    node.high_yz = pair(high_cells[1], high_cells[2]);
    node
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::bvh::kernel::{cell_edge, children_before, in_order, next_node, reached_boxes};
    use kernels::bvh::kernel::{visiting_order, waiting_children, without_next};
    use kernels::traversal::kernel::inverse_direction;

    fn children(number: usize, size: f32, distance: f32) -> Vec<Child> {
        (0..number)
            .map(|i| {
                let low =
                    [(i % 3) as f32 * size + distance, (i % 2) as f32 * size - distance, i as f32 * size];
                let high = [low[0] + 0.3 * size, low[1], low[2] + 0.01 * size];
                let content = if i % 3 == 0 { Content::Node } else { Content::Object };
                Child { aabb: Aabb::new(low.into(), high.into()), content }
            })
            .collect()
    }

    #[test]
    fn boxes_on_the_grid_contain_the_given_ones() {
        for (size, distance) in [(1.0, 0.0), (1e-4, 5.0), (1e6, 1e3), (1e-12, 0.0)] {
            let children = arrange_in_slots(children(8, size, distance), |child| child.aabb);
            let node = encode(&children, 10, 20);
            let byte = |low: u32, high: u32, slot: usize| {
                let word = if slot < 4 { low } else { high };
                f64::from(word >> (8 * (slot % 4)) & 255)
            };
            for (slot, child) in children.iter().enumerate() {
                let Some(child) = child else { continue };
                let axes = [
                    (
                        node.origin.x,
                        0,
                        (node.low_xy.x, node.low_xy.y),
                        (node.low_z_high_x.z, node.low_z_high_x.w),
                    ),
                    (node.origin.y, 8, (node.low_xy.z, node.low_xy.w), (node.high_yz.x, node.high_yz.y)),
                    (
                        node.origin.z,
                        16,
                        (node.low_z_high_x.x, node.low_z_high_x.y),
                        (node.high_yz.z, node.high_yz.w),
                    ),
                ];
                for (axis, (origin, shift, low, high)) in axes.into_iter().enumerate() {
                    let edge = f64::from(cell_edge(node.exponents >> shift & 255));
                    let at = |cells: f64| f64::from(origin) + cells * edge;
                    // The margin is kept but for the rounding of the corner of the grid.
                    let margin = 0.01 * edge;
                    assert!(at(byte(low.0, low.1, slot)) + margin <= f64::from(child.aabb.min[axis]));
                    assert!(at(byte(high.0, high.1, slot)) - margin >= f64::from(child.aabb.max[axis]));
                }
            }
        }
    }

    #[test]
    fn rays_reach_the_children_that_they_aim_at_nearest_first() {
        let corner = |i: usize| [i & 1, i >> 1 & 1, i >> 2].map(|side| 4.0 * side as f32);
        let children: Vec<Child> = (0..8)
            .map(|i| {
                let low = corner(i);
                let aabb = Aabb::new(low.into(), low.map(|x| x + 1.0).into());
                Child { aabb, content: if i < 4 { Content::Node } else { Content::Object } }
            })
            .collect();
        let slots = arrange_in_slots(children, |child| child.aabb);
        let node = encode(&slots, 100, 200);
        for i in 0..8 {
            let middle = corner(i).map(|x| x + 0.5);
            // Across the other corners of the lower layer, or down from above.
            let direction = if i < 4 { vec3f(1.0, 1e-3, 1e-4) } else { vec3f(1e-4, 1e-3, -1.0) };
            let start = |x: f32, d: f32| x - 10.0 * d;
            let origin = vec3f(
                start(middle[0], direction.x),
                start(middle[1], direction.y),
                start(middle[2], direction.z),
            );
            let inverse = inverse_direction(direction);
            let reached = reached_boxes(node, origin, inverse, 1e30);
            assert_ne!(reached & 1 << i, 0, "child {i} stands in its corner's place and is reached");
            assert_eq!(reached.count_ones(), 2);
            assert_eq!(reached_boxes(node, origin, inverse, 1.0), 0, "too far");
            let order = visiting_order(inverse);
            assert_eq!(in_order(in_order(reached, order), order), reached);
            let waiting = waiting_children(node, reached, order);
            if i < 4 {
                // From smaller to larger x: both are nodes, the one with the smaller number comes first.
                let nearest = reached.trailing_zeros();
                assert_eq!(next_node(waiting, order), 100 + nearest);
                let rest = without_next(waiting);
                assert_eq!(next_node(rest, order), 100 + (reached & !(1 << nearest)).trailing_zeros());
            } else {
                // The upper one is an object.
                assert_eq!(reached & node.leaves, 1 << i);
                assert_eq!(children_before(node.leaves, i as u32), i as u32 - 4);
                // The lower one is visited afterwards.
                assert_eq!(next_node(waiting, order), 100 + (i as u32 - 4));
            }
        }
    }
}
