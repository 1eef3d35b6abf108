//! What searches in turns keep of rays and nodes, with any number of lanes.

use kernels::bvh::kernel::visiting_order;
use kernels::shape::kernel::Ray;
use kernels::traversal::kernel::inverse_direction;
use std::arch::x86_64::*;

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
pub(super) struct LocalRay {
    pub(super) ray: Ray,
    /// With a fourth number that means nothing.
    pub(super) inverse: [f32; 4],
    pub(super) origin: [f32; 4],
    pub(super) order: u32,
}

impl LocalRay {
    #[inline(always)]
    pub(super) fn new(ray: Ray) -> Self {
        let inverse = inverse_direction(ray.direction);
        let padded = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        LocalRay {
            ray,
            inverse: padded(inverse.to_array()),
            origin: padded(ray.origin.to_array()),
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

impl Waiting {
    /// A single node.
    pub(super) const fn root(index: u32) -> Self {
        Waiting { first: index, bits: 1 }
    }
}

/// Which of eight bytes are not zero, as bits.
#[inline(always)]
pub(super) fn bytes_in_use(bytes: u64) -> u32 {
    // SAFETY: every processor of this architecture has SSE2.
    let empty = unsafe {
        _mm_movemask_epi8(_mm_cmpeq_epi8(_mm_cvtsi64_si128(bytes.cast_signed()), _mm_setzero_si128()))
    };
    !empty.cast_unsigned() & 255
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

    #[test]
    fn the_table_holds_the_orders_of_the_kernel() {
        for (order, places) in (0u32..).zip(&IN_ORDER) {
            for (children, place) in (0u32..).zip(places) {
                assert_eq!(u32::from(*place), in_order(children, order), "{children:08b} in order {order}");
            }
        }
    }

    #[test]
    fn bytes_are_in_use_where_a_bit_is_set() {
        assert_eq!(bytes_in_use(0), 0);
        assert_eq!(bytes_in_use(u64::MAX), 255);
        assert_eq!(bytes_in_use(0x8000_0100_0000_0020), 0b1010_0001);
    }
}
