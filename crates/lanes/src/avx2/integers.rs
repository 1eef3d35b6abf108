//! Integers.

use super::*;

macro_rules! integers {
    ($type:ident, $min:ident, $max:ident, $down:ident) => {
        impl Arithmetic for $type {
            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                $type(vector!(_mm256_add_epi32(self.0, other.0)))
            }
            #[inline(always)]
            fn minus(self, other: Self) -> Self {
                $type(vector!(_mm256_sub_epi32(self.0, other.0)))
            }
            #[inline(always)]
            fn times(self, other: Self) -> Self {
                $type(vector!(_mm256_mullo_epi32(self.0, other.0)))
            }
            #[inline(always)]
            fn over(self, other: Self) -> Self {
                let (a, b) = (self.to_array(), other.to_array());
                $type::from_array(std::array::from_fn(|i| a[i].over(b[i])))
            }
            #[inline(always)]
            fn remainder(self, other: Self) -> Self {
                let (a, b) = (self.to_array(), other.to_array());
                $type::from_array(std::array::from_fn(|i| a[i].remainder(b[i])))
            }
        }
        impl Bits for $type {
            #[inline(always)]
            fn both(self, other: Self) -> Self {
                $type(vector!(_mm256_and_si256(self.0, other.0)))
            }
            #[inline(always)]
            fn either(self, other: Self) -> Self {
                $type(vector!(_mm256_or_si256(self.0, other.0)))
            }
            #[inline(always)]
            fn one_of(self, other: Self) -> Self {
                $type(vector!(_mm256_xor_si256(self.0, other.0)))
            }
            #[inline(always)]
            fn inverted(self) -> Self {
                $type(vector!(_mm256_xor_si256(self.0, _mm256_set1_epi32(-1))))
            }
        }
        impl Shift<U32> for $type {
            #[inline(always)]
            fn upwards(self, places: U32) -> Self {
                let places = places.both(31u32.widen());
                $type(vector!(_mm256_sllv_epi32(self.0, places.0)))
            }
            #[inline(always)]
            fn downwards(self, places: U32) -> Self {
                let places = places.both(31u32.widen());
                $type(vector!($down(self.0, places.0)))
            }
        }
        impl Compare for $type {
            type Truth = Mask;
            #[inline(always)]
            fn is_equal(self, other: Self) -> Mask {
                Mask(vector!(_mm256_cmpeq_epi32(self.0, other.0)))
            }
            #[inline(always)]
            fn is_unequal(self, other: Self) -> Mask {
                self.is_equal(other).inverted()
            }
            #[inline(always)]
            fn is_less(self, other: Self) -> Mask {
                other.is_at_most(self).inverted()
            }
            #[inline(always)]
            fn is_at_most(self, other: Self) -> Mask {
                self.greater(other).is_equal(other)
            }
        }
        impl Extremes for $type {
            #[inline(always)]
            fn lesser(self, other: Self) -> Self {
                $type(vector!($min(self.0, other.0)))
            }
            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                $type(vector!($max(self.0, other.0)))
            }
        }
        impl Blend for $type {
            type Mask = Mask;
            #[inline(always)]
            fn blend(mask: Mask, set: Self, clear: Self) -> Self {
                $type(vector!(_mm256_blendv_epi8(clear.0, set.0, mask.0)))
            }
        }
        impl Integer for $type {
            #[inline(always)]
            fn bits_reversed(self) -> Self {
                $type(reversed(self.0))
            }
            #[inline(always)]
            fn ones(self) -> Self {
                $type::from_array(self.to_array().map(Integer::ones))
            }
            #[inline(always)]
            fn zeros_behind(self) -> Self {
                $type::from_array(self.to_array().map(Integer::zeros_behind))
            }
        }
    };
}

integers!(U32, _mm256_min_epu32, _mm256_max_epu32, _mm256_srlv_epi32);
integers!(I32, _mm256_min_epi32, _mm256_max_epi32, _mm256_srav_epi32);

impl Negate for I32 {
    #[inline(always)]
    fn negated(self) -> Self {
        0i32.widen().minus(self)
    }
}

/// The bits of every lane backwards: bytes change places, halves of bytes are looked up.
#[inline(always)]
fn reversed(bits: __m256i) -> __m256i {
    const REVERSED: [u8; 16] = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];
    const BACKWARDS: [u8; 16] = [3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12];
    vector!({
        let low_halves = _mm256_broadcastsi128_si256(_mm_loadu_si128(REVERSED.as_ptr().cast()));
        let high_halves = _mm256_slli_epi32::<4>(low_halves);
        let backwards = _mm256_broadcastsi128_si256(_mm_loadu_si128(BACKWARDS.as_ptr().cast()));
        let half = _mm256_set1_epi32(0x0f0f_0f0f);
        let bytes = _mm256_shuffle_epi8(bits, backwards);
        let low = _mm256_shuffle_epi8(high_halves, _mm256_and_si256(bytes, half));
        let high = _mm256_shuffle_epi8(low_halves, _mm256_and_si256(_mm256_srli_epi32::<4>(bytes), half));
        _mm256_or_si256(low, high)
    })
}
