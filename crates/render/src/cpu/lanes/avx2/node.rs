//! Nodes in the vector unit. Kernels alone call this, which need AVX2 themselves.

use crate::cpu::lanes::nodes::{LaneNode, LocalRay};
use std::arch::x86_64::*;

/// Children of nodes that rays reach, as bits; `end` are the parameters of the ends of the rays times `-FURTHER`.
#[inline(always)]
pub(super) fn reached_children<const N: usize>(
    nodes: [&LaneNode; N],
    rays: [&LocalRay; N],
    end: [f32; N],
) -> [u32; N] {
    let mut reached = [0; N];
    for k in 0..N {
        reached[k] = reached_by_one(nodes[k], rays[k], end[k]);
    }
    reached
}

/// The same for one ray.
///
/// As `kernels::bvh::reached_boxes`, but for rounding, within the cells that boxes are larger than what they hold.
/// Where a ray leaves a box has the opposite sign, so that the largest number is what counts.
#[inline(always)]
fn reached_by_one(node: &LaneNode, ray: &LocalRay, end: f32) -> u32 {
    // SAFETY: see the module; all that is read are arrays of at least the size, aligned where that is asked for.
    unsafe {
        let parameters = |axis: usize, leaves: bool| {
            let half = if leaves { 8 } else { 0 };
            let inverse = _mm256_load_ps(ray.inverse[axis][half..].as_ptr());
            let cell = _mm256_mul_ps(_mm256_set1_ps(node.cell[axis]), inverse);
            let origin = _mm256_set1_ps(ray.ray.origin.to_array()[axis]);
            let corner = _mm256_sub_ps(_mm256_set1_ps(node.corner[axis]), origin);
            let ends = node.ends(axis, ray).add(half);
            let ends = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(ends.cast())));
            _mm256_add_ps(_mm256_mul_ps(ends, cell), _mm256_mul_ps(corner, inverse))
        };
        let largest = |leaves: bool, bound: __m256| {
            let xy = _mm256_max_ps(parameters(0, leaves), parameters(1, leaves));
            _mm256_max_ps(xy, _mm256_max_ps(parameters(2, leaves), bound))
        };
        let enters = largest(false, _mm256_setzero_ps());
        let leaves = _mm256_xor_ps(largest(true, _mm256_set1_ps(end)), _mm256_set1_ps(-0.0));
        _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enters, leaves)).cast_unsigned()
    }
}
