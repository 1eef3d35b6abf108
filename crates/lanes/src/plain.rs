//! Numbers that are the same for all rays.

use crate::*;

macro_rules! arithmetic {
    ($($type:ty: $plus:ident $minus:ident $times:ident;)*) => { $(
        impl Arithmetic for $type {
            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                self.$plus(other)
            }
            #[inline(always)]
            fn minus(self, other: Self) -> Self {
                self.$minus(other)
            }
            #[inline(always)]
            fn times(self, other: Self) -> Self {
                self.$times(other)
            }
            #[inline(always)]
            fn over(self, other: Self) -> Self {
                self.checked_div(other).unwrap_or(self)
            }
            #[inline(always)]
            fn remainder(self, other: Self) -> Self {
                self.checked_rem(other).unwrap_or(0)
            }
        }
        impl Bits for $type {
            #[inline(always)]
            fn both(self, other: Self) -> Self {
                self & other
            }
            #[inline(always)]
            fn either(self, other: Self) -> Self {
                self | other
            }
            #[inline(always)]
            fn one_of(self, other: Self) -> Self {
                self ^ other
            }
            #[inline(always)]
            fn inverted(self) -> Self {
                !self
            }
        }
        impl Shift<u32> for $type {
            #[inline(always)]
            fn upwards(self, places: u32) -> Self {
                self.wrapping_shl(places)
            }
            #[inline(always)]
            fn downwards(self, places: u32) -> Self {
                self.wrapping_shr(places)
            }
        }
        impl Integer for $type {
            #[inline(always)]
            fn bits_reversed(self) -> Self {
                self.reverse_bits()
            }
            #[inline(always)]
            fn ones(self) -> Self {
                self.count_ones() as $type
            }
            #[inline(always)]
            fn zeros_behind(self) -> Self {
                self.trailing_zeros() as $type
            }
        }
        impl Extremes for $type {
            #[inline(always)]
            fn lesser(self, other: Self) -> Self {
                std::cmp::Ord::min(self, other)
            }
            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                std::cmp::Ord::max(self, other)
            }
        }
    )* };
}

arithmetic! {
    u32: wrapping_add wrapping_sub wrapping_mul;
    i32: wrapping_add wrapping_sub wrapping_mul;
}

impl Arithmetic for f32 {
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self - other
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self * other
    }
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self / other
    }
    #[inline(always)]
    fn remainder(self, other: Self) -> Self {
        self % other
    }
}

impl Negate for f32 {
    #[inline(always)]
    fn negated(self) -> Self {
        -self
    }
}

impl Negate for i32 {
    #[inline(always)]
    fn negated(self) -> Self {
        self.wrapping_neg()
    }
}

impl Extremes for f32 {
    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        f32::min(self, other)
    }
    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        f32::max(self, other)
    }
}

impl Round for f32 {
    #[inline(always)]
    fn magnitude(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    fn floored(self) -> Self {
        f32::floor(self)
    }
    #[inline(always)]
    fn ceiled(self) -> Self {
        f32::ceil(self)
    }
    #[inline(always)]
    fn truncated(self) -> Self {
        f32::trunc(self)
    }
    #[inline(always)]
    fn root(self) -> Self {
        f32::sqrt(self)
    }
}

impl<M> Transcendental<M> for f32 {
    #[inline(always)]
    fn each(self, _mask: M, function: impl Fn(f32) -> f32) -> Self {
        function(self)
    }
    #[inline(always)]
    fn each_of_two(self, _mask: M, other: Self, function: impl Fn(f32, f32) -> f32) -> Self {
        function(self, other)
    }
}

impl Bits for bool {
    #[inline(always)]
    fn both(self, other: Self) -> Self {
        self & other
    }
    #[inline(always)]
    fn either(self, other: Self) -> Self {
        self | other
    }
    #[inline(always)]
    fn one_of(self, other: Self) -> Self {
        self ^ other
    }
    #[inline(always)]
    fn inverted(self) -> Self {
        !self
    }
}

macro_rules! compare {
    ($($type:ty = $zero:expr),*) => { $(
        impl Compare for $type {
            type Truth = bool;
            #[inline(always)]
            fn is_equal(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn is_unequal(self, other: Self) -> bool {
                self != other
            }
            #[inline(always)]
            fn is_less(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn is_at_most(self, other: Self) -> bool {
                self <= other
            }
        }
        impl Zero for $type {
            #[inline(always)]
            fn zero() -> Self {
                $zero
            }
        }
    )* };
}

compare!(f32 = 0.0, u32 = 0, i32 = 0, bool = false);

macro_rules! convert {
    ($($from:ty => $to:ty),*) => { $(
        impl Convert<$to> for $from {
            #[inline(always)]
            fn convert(self) -> $to {
                self as $to
            }
        }
    )* };
}

convert!(f32 => u32, f32 => i32, u32 => f32, i32 => f32, u32 => i32, i32 => u32, bool => u32);

impl Reinterpret<f32> for u32 {
    #[inline(always)]
    fn reinterpret(self) -> f32 {
        f32::from_bits(self)
    }
}

impl Reinterpret<u32> for f32 {
    #[inline(always)]
    fn reinterpret(self) -> u32 {
        self.to_bits()
    }
}

impl Reinterpret<u32> for i32 {
    #[inline(always)]
    fn reinterpret(self) -> u32 {
        self.cast_unsigned()
    }
}

impl Reinterpret<i32> for u32 {
    #[inline(always)]
    fn reinterpret(self) -> i32 {
        self.cast_signed()
    }
}
