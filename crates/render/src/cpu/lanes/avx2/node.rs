//! Nodes in the vector unit. Kernels alone call this, which need AVX2 themselves.

use std::arch::x86_64::*;

/// Children of a node, given as its words, that a ray reaches before `t_max`, as bits: the operations of
/// `kernels::bvh::reached_boxes`, except that the nearer end of a box is the lesser one.
#[inline(always)]
pub(super) fn reached_children(words: &[u32; 20], origin: [f32; 4], inverse: [f32; 4], t_max: f32) -> u32 {
    // SAFETY: see the module; 16 bytes are read at word 0 of 20, 8 bytes at words 8 to 18.
    unsafe {
        let exponents = _mm_cvtepu8_epi32(_mm_cvtsi32_si128(words[3].cast_signed()));
        let inverse = _mm_loadu_ps(inverse.as_ptr());
        let edge = _mm_mul_ps(_mm_castsi128_ps(_mm_slli_epi32::<23>(exponents)), inverse);
        // The fourth number is of no use.
        let corner = _mm_loadu_ps(words.as_ptr().cast());
        let start = _mm_mul_ps(_mm_sub_ps(corner, _mm_loadu_ps(origin.as_ptr())), inverse);
        let (edge, start) = (_mm256_set_m128(edge, edge), _mm256_set_m128(start, start));
        let parameters = |word: usize, edge: __m256, start: __m256| {
            let cells = _mm256_cvtepu8_epi32(_mm_loadl_epi64(words.as_ptr().add(word).cast()));
            _mm256_add_ps(_mm256_mul_ps(_mm256_cvtepi32_ps(cells), edge), start)
        };
        let ends = |low: usize, high: usize, edge: __m256, start: __m256| {
            let (low, high) = (parameters(low, edge, start), parameters(high, edge, start));
            (_mm256_min_ps(low, high), _mm256_max_ps(low, high))
        };
        let x = ends(8, 14, _mm256_permute_ps::<0x00>(edge), _mm256_permute_ps::<0x00>(start));
        let y = ends(10, 16, _mm256_permute_ps::<0x55>(edge), _mm256_permute_ps::<0x55>(start));
        let z = ends(12, 18, _mm256_permute_ps::<0xaa>(edge), _mm256_permute_ps::<0xaa>(start));
        let enters = _mm256_max_ps(_mm256_max_ps(x.0, y.0), _mm256_max_ps(z.0, _mm256_setzero_ps()));
        let leaves = _mm256_min_ps(_mm256_min_ps(x.1, y.1), _mm256_min_ps(z.1, _mm256_set1_ps(t_max)));
        let leaves = _mm256_mul_ps(leaves, _mm256_set1_ps(1.000_000_8));
        _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enters, leaves)).cast_unsigned()
    }
}
