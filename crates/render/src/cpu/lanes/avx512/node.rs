//! Nodes in the vector unit. Kernels alone call this, which need AVX-512 themselves.

use crate::cpu::lanes::nodes::{LaneNode, LocalRay};
use std::arch::x86_64::*;

/// Children of a node that a ray reaches, as bits; `end` is the parameter of its end times `-FURTHER`.
///
/// As `kernels::bvh::reached_boxes`, but for rounding, within the cells that boxes are larger than what they hold. The
/// first eight lanes are where the ray enters the boxes of the children, the others where it leaves them, with the
/// opposite sign: so the largest number is what counts in all of them.
#[inline(always)]
pub(super) fn reached_children(node: &LaneNode, ray: &LocalRay, end: f32) -> u32 {
    // SAFETY: see the module; all that is read are arrays of at least the size.
    unsafe {
        let inverse = _mm256_loadu_ps(ray.inverse.as_ptr().cast());
        let twice = |numbers: &[f32; 4]| _mm256_broadcast_ps(&_mm_loadu_ps(numbers.as_ptr()));
        let cell = _mm256_mul_ps(twice(&node.cell), inverse);
        let corner = _mm256_sub_ps(twice(&node.corner), _mm256_loadu_ps(ray.origin.as_ptr().cast()));
        let start = _mm256_mul_ps(corner, inverse);
        let parameters = |axis: usize, lanes: __m512i| {
            let spread = |numbers: __m256| _mm512_permutexvar_ps(lanes, _mm512_castps256_ps512(numbers));
            let ends = _mm512_cvtepu8_epi32(_mm_loadu_si128(node.ends(axis, ray).cast()));
            _mm512_fmadd_ps(_mm512_cvtepi32_ps(ends), spread(cell), spread(start))
        };
        let lanes = |axis: i32| {
            let [enters, leaves] = [axis, axis + 4].map(|number| _mm256_set1_epi32(number));
            _mm512_inserti64x4::<1>(_mm512_castsi256_si512(enters), leaves)
        };
        let bounds = _mm512_mask_broadcastss_ps(_mm512_setzero_ps(), 0xff00, _mm_set_ss(end));
        let xy = _mm512_max_ps(parameters(0, lanes(0)), parameters(1, lanes(1)));
        let largest = _mm512_max_ps(xy, _mm512_max_ps(parameters(2, lanes(2)), bounds));
        let enters = _mm512_castps512_ps256(largest);
        let leaves = _mm256_xor_ps(_mm512_extractf32x8_ps::<1>(largest), _mm256_set1_ps(-0.0));
        u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(enters, leaves))
    }
}
