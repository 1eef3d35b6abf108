//! Numbers of single precision.

use super::*;
use crate::vector::Reciprocal;

impl Arithmetic for F32 {
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        F32(vector!(_mm256_add_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        F32(vector!(_mm256_sub_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        F32(vector!(_mm256_mul_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        F32(vector!(_mm256_div_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn remainder(self, other: Self) -> Self {
        let (a, b) = (self.to_array(), other.to_array());
        F32::from_array(std::array::from_fn(|i| a[i] % b[i]))
    }
}

impl Negate for F32 {
    #[inline(always)]
    fn negated(self) -> Self {
        F32(vector!(_mm256_xor_ps(self.0, _mm256_set1_ps(-0.0))))
    }
}

impl Reciprocal for F32 {
    #[inline(always)]
    fn reciprocal(self) -> Self {
        1.0f32.widen().over(self)
    }
}

impl Extremes for F32 {
    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        F32(vector!(_mm256_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        F32(vector!(_mm256_max_ps(self.0, other.0)))
    }
}

impl Round for F32 {
    #[inline(always)]
    fn magnitude(self) -> Self {
        F32(vector!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn floored(self) -> Self {
        F32(vector!(_mm256_round_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn ceiled(self) -> Self {
        F32(vector!(_mm256_round_ps::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn truncated(self) -> Self {
        F32(vector!(_mm256_round_ps::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn root(self) -> Self {
        F32(vector!(_mm256_sqrt_ps(self.0)))
    }
}

impl Transcendental<Mask> for F32 {
    #[inline(always)]
    fn each(self, mask: Mask, function: impl Fn(f32) -> f32) -> Self {
        let mut values = self.to_array();
        let mut rest = mask.bits();
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            values[lane] = function(values[lane]);
            rest &= rest - 1;
        }
        F32::from_array(values)
    }
    #[inline(always)]
    fn each_of_two(self, mask: Mask, other: Self, function: impl Fn(f32, f32) -> f32) -> Self {
        let (mut values, others) = (self.to_array(), other.to_array());
        let mut rest = mask.bits();
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            values[lane] = function(values[lane], others[lane]);
            rest &= rest - 1;
        }
        F32::from_array(values)
    }
}

impl Compare for F32 {
    type Truth = Mask;
    #[inline(always)]
    fn is_equal(self, other: Self) -> Mask {
        Mask(vector!(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0))))
    }
    #[inline(always)]
    fn is_unequal(self, other: Self) -> Mask {
        Mask(vector!(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_NEQ_UQ>(self.0, other.0))))
    }
    #[inline(always)]
    fn is_less(self, other: Self) -> Mask {
        Mask(vector!(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0))))
    }
    #[inline(always)]
    fn is_at_most(self, other: Self) -> Mask {
        Mask(vector!(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0))))
    }
}

impl Blend for F32 {
    type Mask = Mask;
    #[inline(always)]
    fn blend(mask: Mask, set: Self, clear: Self) -> Self {
        F32(vector!(_mm256_blendv_ps(clear.0, set.0, _mm256_castsi256_ps(mask.0))))
    }
}
