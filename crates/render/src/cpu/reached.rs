//! Which children of a node a ray reaches, four at a time with the vector units that every processor of a kind has:
//! `kernels::bvh::reached_boxes` in other words. Boxes in full numbers would save the conversion of bytes and take three
//! times the memory; searches are as fast either way.

use kernels::records::kernel::BvhNode;
use wgsl_rs::std::Vec3f;

/// Children whose boxes a ray reaches before `t_max`, as bits.
#[cfg(not(target_arch = "x86_64"))]
#[inline]
pub(super) fn reached_children(node: &BvhNode, origin: Vec3f, inverse: Vec3f, t_max: f32) -> u32 {
    kernels::bvh::kernel::reached_boxes(*node, origin, inverse, t_max)
}

/// Children whose boxes a ray reaches before `t_max`, as bits.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(super) fn reached_children(node: &BvhNode, origin: Vec3f, inverse: Vec3f, t_max: f32) -> u32 {
    // SAFETY: every processor of this architecture has SSE2. Measured: a search takes half the time.
    unsafe { reached_by_sse2(node, origin, inverse, t_max) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "sse2")]
#[inline]
fn reached_by_sse2(node: &BvhNode, origin: Vec3f, inverse: Vec3f, t_max: f32) -> u32 {
    use kernels::bvh::kernel::{FURTHER, cell_edge};
    use std::arch::x86_64::*;

    let pair = |first: u32, second: u32| i64::from(first) | i64::from(second) << 32;
    let low = [
        pair(node.low_xy.x, node.low_xy.y),
        pair(node.low_xy.z, node.low_xy.w),
        pair(node.low_z_high_x.x, node.low_z_high_x.y),
    ];
    let high = [
        pair(node.low_z_high_x.z, node.low_z_high_x.w),
        pair(node.high_yz.x, node.high_yz.y),
        pair(node.high_yz.z, node.high_yz.w),
    ];
    let corner = node.origin.to_array();
    let (origin, inverse) = (origin.to_array(), inverse.to_array());
    let zero = _mm_setzero_ps();
    let (mut enters, mut leaves) = ([zero; 2], [_mm_set1_ps(t_max); 2]);
    for axis in 0..3 {
        let factor = inverse[axis];
        let edge = _mm_set1_ps(cell_edge(node.exponents >> (8 * axis) & 255) * factor);
        let start = _mm_set1_ps((corner[axis] - origin[axis]) * factor);
        let forwards = factor >= 0.0;
        let (near, far) = if forwards { (low[axis], high[axis]) } else { (high[axis], low[axis]) };
        // Eight bytes as numbers, then as parameters of the ray.
        let parameters = |bytes: i64| {
            let none = _mm_setzero_si128();
            let words = _mm_unpacklo_epi8(_mm_cvtsi64_si128(bytes), none);
            let at = |cells: __m128i| _mm_add_ps(_mm_mul_ps(_mm_cvtepi32_ps(cells), edge), start);
            [at(_mm_unpacklo_epi16(words, none)), at(_mm_unpackhi_epi16(words, none))]
        };
        let (near, far) = (parameters(near), parameters(far));
        for half in 0..2 {
            enters[half] = _mm_max_ps(enters[half], near[half]);
            leaves[half] = _mm_min_ps(leaves[half], far[half]);
        }
    }
    let slack = _mm_set1_ps(FURTHER);
    let reached = |half: usize| _mm_movemask_ps(_mm_cmple_ps(enters[half], _mm_mul_ps(leaves[half], slack)));
    // Four bits each.
    (reached(0) | reached(1) << 4) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::bvh::kernel::reached_boxes;
    use kernels::random::kernel::{pcg4d, unit_float};
    use kernels::traversal::kernel::inverse_direction;
    use wgsl_rs::std::{vec3f, vec4u};

    #[test]
    fn vector_units_find_what_the_kernel_finds() {
        let mut differences = 0;
        let mut reached = 0;
        for i in 0..2000u32 {
            let bits = |number: u32| pcg4d(vec4u(i, number, 0, 0));
            let point = |number: u32| {
                let bits = bits(number);
                vec3f(unit_float(bits.x), unit_float(bits.y), unit_float(bits.z)) * 4.0
            };
            let centred = |number: u32| point(number) - vec3f(2.0, 2.0, 2.0);
            let lower = 0x7f7f_7f7f;
            let (a, b, c) = (bits(0).to_array(), bits(1).to_array(), bits(2).to_array());
            let node = BvhNode {
                origin: centred(3),
                exponents: 0x0079_7979,
                low_xy: vec4u(a[0] & lower, a[1] & lower, a[2] & lower, a[3] & lower),
                low_z_high_x: vec4u(b[0] & lower, b[1] & lower, b[2] | !lower, b[3] | !lower),
                high_yz: vec4u(c[0] | !lower, c[1] | !lower, c[2] | !lower, c[3] | !lower),
                ..bytemuck::Zeroable::zeroed()
            };
            let inverse = inverse_direction(centred(4));
            let expected = reached_boxes(node, centred(5), inverse, 10.0);
            let found = reached_children(&node, centred(5), inverse, 10.0);
            differences += (expected ^ found).count_ones();
            reached += expected.count_ones();
        }
        assert!(reached > 1000);
        assert_eq!(differences, 0, "the same operations in the same order");
    }
}
