//! Conversions, as by `as`, and the same bits as another type.

use super::*;

impl Convert<F32> for U32 {
    #[inline(always)]
    fn convert(self) -> F32 {
        F32(vector!(_mm512_cvtepu32_ps(self.0)))
    }
}

impl Convert<F32> for I32 {
    #[inline(always)]
    fn convert(self) -> F32 {
        F32(vector!(_mm512_cvtepi32_ps(self.0)))
    }
}

impl Convert<U32> for F32 {
    #[inline(always)]
    fn convert(self) -> U32 {
        // What is too large gives all ones; what is no number, the second.
        U32(vector!(_mm512_cvttps_epu32(_mm512_max_ps(self.0, _mm512_setzero_ps()))))
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
        F32(vector!(_mm512_castsi512_ps(self.0)))
    }
}

impl Reinterpret<U32> for F32 {
    #[inline(always)]
    fn reinterpret(self) -> U32 {
        U32(vector!(_mm512_castps_si512(self.0)))
    }
}
