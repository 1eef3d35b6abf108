//! Masks.

use super::*;

/// Which lanes something is meant for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Mask(pub(super) u16);

impl Mask {
    pub const NONE: Mask = Mask(0);
    pub const ALL: Mask = Mask(u16::MAX);

    /// The first lanes.
    #[inline(always)]
    pub fn first(count: usize) -> Self {
        if count >= LANES { Mask::ALL } else { Mask((1 << count) - 1) }
    }
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0 != 0
    }
    #[inline(always)]
    pub fn none(self) -> bool {
        self.0 == 0
    }
    /// Bit by bit.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        u32::from(self.0)
    }
    /// The mask with the given bits, of which those beyond the lanes mean nothing.
    #[inline(always)]
    pub fn from_bits(bits: u32) -> Self {
        Mask(bits as u16)
    }
    /// Lanes of this mask that are not in another.
    #[inline(always)]
    pub fn without(self, other: Self) -> Self {
        Mask(self.0 & !other.0)
    }
}

impl Bits for Mask {
    #[inline(always)]
    fn both(self, other: Self) -> Self {
        Mask(self.0 & other.0)
    }
    #[inline(always)]
    fn either(self, other: Self) -> Self {
        Mask(self.0 | other.0)
    }
    #[inline(always)]
    fn one_of(self, other: Self) -> Self {
        Mask(self.0 ^ other.0)
    }
    #[inline(always)]
    fn inverted(self) -> Self {
        Mask(!self.0)
    }
}

impl Compare for Mask {
    type Truth = Mask;
    #[inline(always)]
    fn is_equal(self, other: Self) -> Mask {
        Mask(!(self.0 ^ other.0))
    }
    #[inline(always)]
    fn is_unequal(self, other: Self) -> Mask {
        Mask(self.0 ^ other.0)
    }
    #[inline(always)]
    fn is_less(self, other: Self) -> Mask {
        Mask(!self.0 & other.0)
    }
    #[inline(always)]
    fn is_at_most(self, other: Self) -> Mask {
        Mask(!self.0 | other.0)
    }
}

impl Blend for Mask {
    type Mask = Mask;
    #[inline(always)]
    fn blend(mask: Mask, set: Self, clear: Self) -> Self {
        Mask(set.0 & mask.0 | clear.0 & !mask.0)
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
