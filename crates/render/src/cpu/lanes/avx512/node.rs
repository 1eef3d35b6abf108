//! Nodes in the vector unit. Kernels alone call this, which need AVX-512 themselves.

use crate::cpu::lanes::nodes::{LaneNode, LocalRay};
use std::arch::x86_64::*;

/// Children of nodes that rays reach, as bits; `end` are the parameters of the ends of the rays times `-FURTHER`.
///
/// As `kernels::bvh::reached_boxes`, but for rounding, within the cells that boxes are larger than what they hold. The
/// first eight lanes are where the ray enters the boxes of the children, the others where it leaves them, with the
/// opposite sign: so the largest number is what counts in all of them. One step for all rays after another, as the steps
/// of a ray wait for each other.
#[inline(always)]
pub(super) fn reached_children<const N: usize>(
    nodes: [&LaneNode; N],
    rays: [&LocalRay; N],
    end: [f32; N],
) -> [u32; N] {
    // SAFETY: see the module; all that is read are arrays of at least the size, aligned where that is asked for.
    unsafe {
        let mut largest = [_mm512_setzero_ps(); N];
        for k in 0..N {
            largest[k] = _mm512_mask_broadcastss_ps(_mm512_setzero_ps(), 0xff00, _mm_set_ss(end[k]));
        }
        for axis in 0..3 {
            for k in 0..N {
                let (node, ray) = (nodes[k], rays[k]);
                let inverse = _mm512_load_ps(ray.inverse[axis].as_ptr());
                let cell = _mm512_mul_ps(_mm512_set1_ps(node.cell[axis]), inverse);
                let origin = _mm512_set1_ps(ray.ray.origin.to_array()[axis]);
                let corner = _mm512_sub_ps(_mm512_set1_ps(node.corner[axis]), origin);
                let ends = _mm512_cvtepu8_epi32(_mm_loadu_si128(node.ends(axis, ray).cast()));
                let start = _mm512_mul_ps(corner, inverse);
                let parameters = _mm512_fmadd_ps(_mm512_cvtepi32_ps(ends), cell, start);
                largest[k] = _mm512_max_ps(parameters, largest[k]);
            }
        }
        let mut reached = [0; N];
        for k in 0..N {
            let enters = _mm512_castps512_ps256(largest[k]);
            let leaves = _mm256_xor_ps(_mm512_extractf32x8_ps::<1>(largest[k]), _mm256_set1_ps(-0.0));
            reached[k] = u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(enters, leaves));
        }
        reached
    }
}
