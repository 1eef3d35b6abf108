//! Nodes in the vector unit. Kernels alone call this, which need AVX2 themselves.

use crate::cpu::lanes::nodes::{LaneNode, LocalRay};
use std::arch::x86_64::*;

/// Children of a node that a ray reaches, as bits; `end` is the parameter of its end times `-FURTHER`.
///
/// As `kernels::bvh::reached_boxes`, but for rounding, within the cells that boxes are larger than what they hold.
/// Where a ray leaves a box has the opposite sign, so that the largest number is what counts.
#[inline(always)]
pub(super) fn reached_children(node: &LaneNode, ray: &LocalRay, end: f32) -> u32 {
    // SAFETY: see the module; all that is read are arrays of at least the size.
    unsafe {
        let inverse = _mm256_loadu_ps(ray.inverse.as_ptr().cast());
        let twice = |numbers: &[f32; 4]| _mm256_broadcast_ps(&_mm_loadu_ps(numbers.as_ptr()));
        let cell = _mm256_mul_ps(twice(&node.cell), inverse);
        let corner = _mm256_sub_ps(twice(&node.corner), _mm256_loadu_ps(ray.origin.as_ptr().cast()));
        let start = _mm256_mul_ps(corner, inverse);
        let half = |numbers: __m256, leaves: bool| {
            if leaves {
                _mm256_permute2f128_ps::<0x11>(numbers, numbers)
            } else {
                _mm256_permute2f128_ps::<0x00>(numbers, numbers)
            }
        };
        let parameters = |axis: usize, leaves: bool, cell: __m256, start: __m256| {
            let ends = node.ends(axis, ray).add(if leaves { 8 } else { 0 });
            let ends = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(ends.cast())));
            _mm256_add_ps(_mm256_mul_ps(ends, cell), start)
        };
        let largest = |leaves: bool, bound: __m256| {
            let (cell, start) = (half(cell, leaves), half(start, leaves));
            let x = parameters(0, leaves, _mm256_permute_ps::<0x00>(cell), _mm256_permute_ps::<0x00>(start));
            let y = parameters(1, leaves, _mm256_permute_ps::<0x55>(cell), _mm256_permute_ps::<0x55>(start));
            let z = parameters(2, leaves, _mm256_permute_ps::<0xaa>(cell), _mm256_permute_ps::<0xaa>(start));
            _mm256_max_ps(_mm256_max_ps(x, y), _mm256_max_ps(z, bound))
        };
        let enters = largest(false, _mm256_setzero_ps());
        let leaves = _mm256_xor_ps(largest(true, _mm256_set1_ps(end)), _mm256_set1_ps(-0.0));
        _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enters, leaves)).cast_unsigned()
    }
}
