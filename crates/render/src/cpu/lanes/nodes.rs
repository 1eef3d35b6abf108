//! What searches in turns keep of nodes and rays, with any number of lanes.

use crate::CompiledScene;
use kernels::bvh::kernel::{FURTHER, cell_edge, visiting_order};
use kernels::records::kernel::{BvhNode, NODE_INSTANCE};
use kernels::shape::kernel::Ray;
use kernels::traversal::kernel::inverse_direction;
use rayon::prelude::*;
use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch, _pext_u32};

/// A node of the hierarchy in two lines of the processor's cache, ready for vector units.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(in crate::cpu) struct LaneNode {
    /// Ends of the children's boxes in x, y and z, in cells: the lower ones, the upper ones, and the lower ones once
    /// more, so that the ends where a ray enters and those where it leaves stand next to each other for rays of both
    /// directions.
    cells: [[u8; 24]; 3],
    /// As in the kernels' node.
    pub(super) first_node: u32,
    pub(super) first_object: u32,
    /// Corner of the grid of cells, and the edges of a cell.
    pub(super) corner: [f32; 3],
    pub(super) cell: [f32; 3],
    /// Children that are nodes, as bits; `NODE_INSTANCE` for an instance, which has no boxes.
    pub(super) nodes: u32,
    /// Children that are objects, as bits.
    pub(super) leaves: u32,
    unused: [u32; 4],
}

impl LaneNode {
    fn new(node: &BvhNode) -> Self {
        let bytes = |words: [u32; 2]| -> [u8; 8] {
            let [[a, b, c, d], [e, f, g, h]] = words.map(u32::to_le_bytes);
            [a, b, c, d, e, f, g, h]
        };
        let (xy, zx, yz) = (node.low_xy, node.low_z_high_x, node.high_yz);
        let low = [[xy.x, xy.y], [xy.z, xy.w], [zx.x, zx.y]].map(bytes);
        let high = [[zx.z, zx.w], [yz.x, yz.y], [yz.z, yz.w]].map(bytes);
        let mut cells = [[0; 24]; 3];
        for (cells, (low, high)) in cells.iter_mut().zip(low.iter().zip(&high)) {
            for (place, end) in cells.iter_mut().zip(low.iter().chain(high).chain(low)) {
                *place = *end;
            }
        }
        let is_instance = node.exponents == NODE_INSTANCE;
        let edge = |axis: u32| cell_edge(node.exponents >> (8 * axis) & 255);
        LaneNode {
            cells,
            first_node: node.first_node,
            first_object: node.first_object,
            corner: node.origin.to_array(),
            cell: [edge(0), edge(1), edge(2)],
            nodes: if is_instance { NODE_INSTANCE } else { node.exponents >> 24 },
            leaves: if is_instance { 0 } else { node.leaves },
            unused: [0; 4],
        }
    }

    /// Ends of the boxes where a ray enters them, then those where it leaves them, 16 bytes.
    #[inline(always)]
    pub(super) fn ends(&self, axis: usize, ray: &LocalRay) -> *const u8 {
        // In one array, so that 16 bytes from either place are within it.
        self.cells[axis][ray.sides[axis] as usize % 16..].as_ptr()
    }
}

/// Those of a scene.
pub(super) fn lane_nodes(scene: &CompiledScene) -> Vec<LaneNode> {
    scene.nodes.par_iter().with_min_len(4096).map(LaneNode::new).collect()
}

/// Bits of children moved to their places in the order of visits, for each of the eight orders: `kernels::bvh::in_order`
/// as a table.
pub(super) static IN_ORDER: [[u8; 256]; 8] = places_in_order();

const fn places_in_order() -> [[u8; 256]; 8] {
    let mut table = [[0; 256]; 8];
    let mut order = 0;
    while order < 8 {
        let mut children = 0;
        while children < 256 {
            let mut child = 0;
            while child < 8 {
                if children >> child & 1 != 0 {
                    table[order][children] |= 1 << (child ^ order);
                }
                child += 1;
            }
            children += 1;
        }
        order += 1;
    }
    table
}

/// A ray in the space of the nodes that are being searched.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct LocalRay {
    /// For each axis the reciprocal of the direction for where the ray enters the eight boxes, then its negative times
    /// `FURTHER` for where it leaves them.
    pub(super) inverse: [[f32; 16]; 3],
    pub(super) ray: Ray,
    /// Where the ends of boxes that it meets first begin in `LaneNode::cells`.
    sides: [u8; 3],
    pub(super) order: u32,
}

impl LocalRay {
    #[inline(always)]
    pub(super) fn new(ray: Ray) -> Self {
        let inverse = inverse_direction(ray.direction);
        let numbers = inverse.to_array();
        LocalRay {
            inverse: numbers.map(|number| {
                let [enters, leaves] = [[number; 8], [-FURTHER * number; 8]];
                std::array::from_fn(|lane| if lane < 8 { enters[lane] } else { leaves[lane - 8] })
            }),
            ray,
            sides: numbers.map(|number| if number >= 0.0 { 0 } else { 8 }),
            order: visiting_order(inverse),
        }
    }
}

/// Nodes that wait, as `kernels::bvh::waiting_children` writes them.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    pub(super) first: u32,
    pub(super) bits: u32,
}

/// Asks for a line of an entry of a table to be brought into the cache; a number beyond the table does nothing of use
/// or harm.
#[inline(always)]
pub(super) fn fetch_ahead<T>(table: &[T], index: u32, line: usize) {
    const LINE: usize = 64;
    let entry = table.as_ptr().wrapping_add(index as usize).cast::<i8>();
    // SAFETY: every processor of this architecture has SSE, and nothing is read.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(entry.wrapping_add(line * LINE)) };
}

/// The bits that are picked by a mask, next to each other. Kernels alone call this, which need BMI2 themselves.
#[inline(always)]
pub(super) fn packed_bits(bits: u32, mask: u32) -> u32 {
    // SAFETY: the kernels that call this are compiled for, and chosen on, processors with BMI2.
    unsafe { _pext_u32(bits, mask) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::bvh::kernel::in_order;
    use wgsl_rs::std::{vec3f, vec4u};

    #[test]
    fn the_table_holds_the_orders_of_the_kernel() {
        for (order, places) in (0u32..).zip(&IN_ORDER) {
            for (children, place) in (0u32..).zip(places) {
                assert_eq!(u32::from(*place), in_order(children, order), "{children:08b} in order {order}");
            }
        }
    }

    #[test]
    fn a_node_keeps_what_the_kernels_read() {
        let node = BvhNode {
            origin: vec3f(1.0, 2.0, 3.0),
            exponents: 0b0000_0110 << 24 | 120 << 16 | 126 << 8 | 127,
            first_node: 7,
            first_object: 9,
            leaves: 0b1001,
            unused: 0,
            low_xy: vec4u(0x0302_0100, 0x0706_0504, 0x1312_1110, 0x1716_1514),
            low_z_high_x: vec4u(0x2322_2120, 0x2726_2524, 0x8382_8180, 0x8786_8584),
            high_yz: vec4u(0x9392_9190, 0x9796_9594, 0xa3a2_a1a0, 0xa7a6_a5a4),
        };
        let lane = LaneNode::new(&node);
        assert_eq!((lane.nodes, lane.leaves, lane.first_node, lane.first_object), (6, 0b1001, 7, 9));
        assert_eq!((lane.corner, lane.cell), ([1.0, 2.0, 3.0], [1.0, 0.5, 0.5f32.powi(7)]));
        for direction in [vec3f(1.0, 1.0, 1.0), vec3f(-1.0, -1.0, -1.0)] {
            let ray = LocalRay::new(Ray { origin: vec3f(0.0, 0.0, 0.0), direction });
            for axis in 0..3u8 {
                let (low, high) = (16 * axis, 0x80 + 16 * axis);
                let [enters, leaves] = if direction.x > 0.0 { [low, high] } else { [high, low] };
                let expected: Vec<u8> = (enters..enters + 8).chain(leaves..leaves + 8).collect();
                let ends = &lane.cells[usize::from(axis)][usize::from(ray.sides[usize::from(axis)])..][..16];
                assert_eq!(ends, expected);
                assert_eq!(lane.ends(axis.into(), &ray), ends.as_ptr());
            }
        }
        let instance = BvhNode { exponents: NODE_INSTANCE, leaves: 1, ..node };
        assert_eq!((LaneNode::new(&instance).nodes, LaneNode::new(&instance).leaves), (NODE_INSTANCE, 0));
    }
}
