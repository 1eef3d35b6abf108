//! Conversions, as by `as`, and the same bits as another type.

use super::*;

impl Convert<F32> for U32 {
    #[inline(always)]
    fn convert(self) -> F32 {
        // Both halves are exact, and their sum is rounded once.
        vector!({
            let low = _mm256_cvtepi32_ps(_mm256_and_si256(self.0, _mm256_set1_epi32(0xffff)));
            let high = _mm256_cvtepi32_ps(_mm256_srli_epi32::<16>(self.0));
            F32(_mm256_add_ps(_mm256_mul_ps(high, _mm256_set1_ps(65536.0)), low))
        })
    }
}

impl Convert<F32> for I32 {
    #[inline(always)]
    fn convert(self) -> F32 {
        F32(vector!(_mm256_cvtepi32_ps(self.0)))
    }
}

impl Convert<U32> for F32 {
    #[inline(always)]
    fn convert(self) -> U32 {
        vector!({
            // What is no number gives the second.
            let value = F32(_mm256_max_ps(self.0, _mm256_setzero_ps()));
            let half = 2_147_483_648.0f32.widen();
            let is_large = half.is_at_most(value);
            let reduced = value.minus(F32::blend(is_large, half, F32::zero()));
            let low = U32(_mm256_cvttps_epi32(reduced.0));
            let whole = U32::blend(is_large, low.either((1u32 << 31).widen()), low);
            U32::blend(4_294_967_296.0f32.widen().is_at_most(value), u32::MAX.widen(), whole)
        })
    }
}

impl Convert<I32> for F32 {
    #[inline(always)]
    fn convert(self) -> I32 {
        I32::from_array(self.to_array().map(|value| value as i32))
    }
}

impl Convert<I32> for U32 {
    #[inline(always)]
    fn convert(self) -> I32 {
        I32(self.0)
    }
}

impl Convert<U32> for I32 {
    #[inline(always)]
    fn convert(self) -> U32 {
        U32(self.0)
    }
}

impl Convert<U32> for Mask {
    #[inline(always)]
    fn convert(self) -> U32 {
        U32::blend(self, 1u32.widen(), 0u32.widen())
    }
}

impl Reinterpret<U32> for I32 {
    #[inline(always)]
    fn reinterpret(self) -> U32 {
        U32(self.0)
    }
}

impl Reinterpret<I32> for U32 {
    #[inline(always)]
    fn reinterpret(self) -> I32 {
        I32(self.0)
    }
}

impl Reinterpret<F32> for U32 {
    #[inline(always)]
    fn reinterpret(self) -> F32 {
        F32(vector!(_mm256_castsi256_ps(self.0)))
    }
}

impl Reinterpret<U32> for F32 {
    #[inline(always)]
    fn reinterpret(self) -> U32 {
        U32(vector!(_mm256_castps_si256(self.0)))
    }
}
