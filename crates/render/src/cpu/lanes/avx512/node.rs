//! Nodes in the vector unit. Kernels alone call this, which need AVX-512 themselves.

use std::arch::x86_64::*;

/// Children of a node, given as its words, that a ray reaches before `t_max`, as bits: the operations of
/// `kernels::bvh::reached_boxes`, except that the nearer end of a box is the lesser one.
#[inline(always)]
pub(super) fn reached_children(words: &[u32; 20], origin: [f32; 4], inverse: [f32; 4], t_max: f32) -> u32 {
    // SAFETY: see the module; 16 bytes are read at words 0, 8, 12 and 16 of 20.
    unsafe {
        let exponents = _mm_cvtepu8_epi32(_mm_cvtsi32_si128(words[3].cast_signed()));
        let inverse = _mm_loadu_ps(inverse.as_ptr());
        let edge = _mm_mul_ps(_mm_castsi128_ps(_mm_slli_epi32::<23>(exponents)), inverse);
        // The fourth number is of no use.
        let corner = _mm_loadu_ps(words.as_ptr().cast());
        let start = _mm_mul_ps(_mm_sub_ps(corner, _mm_loadu_ps(origin.as_ptr())), inverse);
        let (edge, start) = (_mm512_broadcast_f32x4(edge), _mm512_broadcast_f32x4(start));
        // Lower ends in x and y; lower ends in z and upper ends in x; upper ends in y and z.
        let parameters = |word: usize, axes: __m512i| {
            let cells = _mm512_cvtepu8_epi32(_mm_loadu_si128(words.as_ptr().add(word).cast()));
            let (edge, start) = (_mm512_permutexvar_ps(axes, edge), _mm512_permutexvar_ps(axes, start));
            _mm512_add_ps(_mm512_mul_ps(_mm512_cvtepi32_ps(cells), edge), start)
        };
        let axes = |first: i32, second: i32| {
            let (first, second) = (_mm256_set1_epi32(first), _mm256_set1_epi32(second));
            _mm512_inserti64x4::<1>(_mm512_castsi256_si512(first), second)
        };
        let low_xy = parameters(8, axes(0, 1));
        let low_z_high_x = parameters(12, axes(2, 0));
        let high_yz = parameters(16, axes(1, 2));
        let high_xy = _mm512_castsi512_ps(_mm512_alignr_epi64::<4>(
            _mm512_castps_si512(high_yz),
            _mm512_castps_si512(low_z_high_x),
        ));
        let first_half = |pair: __m512| _mm512_castps512_ps256(pair);
        let second_half =
            |pair: __m512| _mm256_castpd_ps(_mm512_extractf64x4_pd::<1>(_mm512_castps_pd(pair)));
        let (near_xy, far_xy) = (_mm512_min_ps(low_xy, high_xy), _mm512_max_ps(low_xy, high_xy));
        let (low_z, high_z) = (first_half(low_z_high_x), second_half(high_yz));
        let (near_z, far_z) = (_mm256_min_ps(low_z, high_z), _mm256_max_ps(low_z, high_z));
        let enters = _mm256_max_ps(first_half(near_xy), second_half(near_xy));
        let enters = _mm256_max_ps(enters, _mm256_max_ps(near_z, _mm256_setzero_ps()));
        let leaves = _mm256_min_ps(first_half(far_xy), second_half(far_xy));
        let leaves = _mm256_min_ps(_mm256_min_ps(leaves, far_z), _mm256_set1_ps(t_max));
        let leaves = _mm256_mul_ps(leaves, _mm256_set1_ps(1.000_000_8));
        u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(enters, leaves))
    }
}
