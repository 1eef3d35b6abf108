//! Masks.

use super::*;

/// Which lanes something is meant for: all bits of a lane are set, or none.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Mask(pub(super) __m256i);

impl Mask {
    pub const NONE: Mask = Mask(vector!(std::mem::transmute::<[u32; LANES], __m256i>([0; LANES])));
    pub const ALL: Mask = Mask(vector!(std::mem::transmute::<[u32; LANES], __m256i>([u32::MAX; LANES])));

    /// The first lanes.
    #[inline(always)]
    pub fn first(count: usize) -> Self {
        if count >= LANES { Mask::ALL } else { Mask::from_bits((1 << count) - 1) }
    }
    #[inline(always)]
    pub fn any(self) -> bool {
        self.bits() != 0
    }
    #[inline(always)]
    pub fn none(self) -> bool {
        self.bits() == 0
    }
    /// Bit by bit.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        vector!(_mm256_movemask_ps(_mm256_castsi256_ps(self.0))).cast_unsigned()
    }
    /// The mask with the given bits, of which those beyond the lanes mean nothing.
    #[inline(always)]
    pub fn from_bits(bits: u32) -> Self {
        vector!({
            let own = _mm256_set_epi32(128, 64, 32, 16, 8, 4, 2, 1);
            Mask(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(bits.cast_signed()), own), own))
        })
    }
    /// Lanes of this mask that are not in another.
    #[inline(always)]
    pub fn without(self, other: Self) -> Self {
        Mask(vector!(_mm256_andnot_si256(other.0, self.0)))
    }
}

impl Bits for Mask {
    #[inline(always)]
    fn both(self, other: Self) -> Self {
        Mask(vector!(_mm256_and_si256(self.0, other.0)))
    }
    #[inline(always)]
    fn either(self, other: Self) -> Self {
        Mask(vector!(_mm256_or_si256(self.0, other.0)))
    }
    #[inline(always)]
    fn one_of(self, other: Self) -> Self {
        Mask(vector!(_mm256_xor_si256(self.0, other.0)))
    }
    #[inline(always)]
    fn inverted(self) -> Self {
        Mask::ALL.without(self)
    }
}

impl Compare for Mask {
    type Truth = Mask;
    #[inline(always)]
    fn is_equal(self, other: Self) -> Mask {
        self.one_of(other).inverted()
    }
    #[inline(always)]
    fn is_unequal(self, other: Self) -> Mask {
        self.one_of(other)
    }
    #[inline(always)]
    fn is_less(self, other: Self) -> Mask {
        other.without(self)
    }
    #[inline(always)]
    fn is_at_most(self, other: Self) -> Mask {
        self.inverted().either(other)
    }
}

impl Blend for Mask {
    type Mask = Mask;
    #[inline(always)]
    fn blend(mask: Mask, set: Self, clear: Self) -> Self {
        Mask(vector!(_mm256_blendv_epi8(clear.0, set.0, mask.0)))
    }
}

impl Zero for Mask {
    #[inline(always)]
    fn zero() -> Self {
        Mask::NONE
    }
}

impl<T: Blend<Mask = Mask>> Pick<T> for Mask {
    #[inline(always)]
    fn pick(self, yes: T, no: T) -> T {
        T::blend(self, yes, no)
    }
}
