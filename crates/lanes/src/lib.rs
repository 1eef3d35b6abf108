//! Numbers in lanes: one value per ray in every register of the processor.
//!
//! Kernels that run in lanes follow many rays at once, as on a graphics card: every value has one lane per ray, and a
//! mask says which rays a piece of the kernel is executed for. [`vector`] has what vectors of either kind share, the
//! functions here are what kernels consist of; they take plain numbers, which are the same for all rays, and numbers
//! in lanes alike. Each kind of processor has a module with the numbers:
//!
//! - `avx512`: 16 lanes, x86-64 with AVX-512 (F, BW, DQ, VL, CD);
//! - `avx2`: 8 lanes, x86-64 with AVX2, BMI1 and LZCNT;
//!
//! Results are those of plain numbers, bit for bit, except for the signs of zeros and where a result is not a number.

#[cfg(target_arch = "x86_64")]
#[macro_use]
mod widen;
#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
mod plain;
mod table;
pub mod vector;

pub use table::Table;
pub use vector::{V2, V3, V4};

/// Arithmetic; integers wrap around.
pub trait Arithmetic: Copy {
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    /// Division of integers by zero gives the dividend, as in WGSL.
    fn over(self, other: Self) -> Self;
    /// What remains of a division; of integers by zero, nothing.
    fn remainder(self, other: Self) -> Self;
}

/// Numbers with a sign.
pub trait Negate: Copy {
    fn negated(self) -> Self;
}

/// Numbers as rows of bits, and truth values.
pub trait Bits: Copy {
    fn both(self, other: Self) -> Self;
    fn either(self, other: Self) -> Self;
    fn one_of(self, other: Self) -> Self;
    fn inverted(self) -> Self;
}

/// Integers whose bits move; by how many places is taken modulo 32.
pub trait Shift<Places>: Copy {
    fn upwards(self, places: Places) -> Self;
    fn downwards(self, places: Places) -> Self;
}

/// Integers of 32 bits.
pub trait Integer: Copy {
    fn bits_reversed(self) -> Self;
    fn ones(self) -> Self;
    fn zeros_behind(self) -> Self;
}

/// Numbers with an order.
pub trait Compare: Copy {
    type Truth;
    fn is_equal(self, other: Self) -> Self::Truth;
    fn is_unequal(self, other: Self) -> Self::Truth;
    fn is_less(self, other: Self) -> Self::Truth;
    fn is_at_most(self, other: Self) -> Self::Truth;
}

/// The lesser and the greater of two.
pub trait Extremes: Copy {
    fn lesser(self, other: Self) -> Self;
    fn greater(self, other: Self) -> Self;
}

/// Functions of one number that processors have in lanes.
pub trait Round: Copy {
    fn magnitude(self) -> Self;
    fn floored(self) -> Self;
    fn ceiled(self) -> Self;
    fn truncated(self) -> Self;
    fn root(self) -> Self;
}

/// Functions that are computed lane by lane; in lanes that the mask leaves out the result means nothing.
pub trait Transcendental<Mask>: Copy {
    fn each(self, mask: Mask, function: impl Fn(f32) -> f32) -> Self;
    fn each_of_two(self, mask: Mask, other: Self, function: impl Fn(f32, f32) -> f32) -> Self;
}

/// Values of which one of two is taken in every lane.
pub trait Blend: Copy {
    type Mask: Copy;
    fn blend(mask: Self::Mask, set: Self, clear: Self) -> Self;
}

/// Values whose bits are all zero where nothing else was said.
pub trait Zero: Copy {
    fn zero() -> Self;
}

/// Conversion as by `as`: numbers out of range become the nearest one.
pub trait Convert<To>: Copy {
    fn convert(self) -> To;
}

/// The same bits, understood as another type.
pub trait Reinterpret<To>: Copy {
    fn reinterpret(self) -> To;
}

macro_rules! functions {
    ($($name:ident($first:ident $(, $more:ident)*) = $method:path : $bound:path;)*) => { $(
        #[inline(always)]
        pub fn $name<T: $bound>($first: T $(, $more: T)*) -> T {
            $method($first $(, $more)*)
        }
    )* };
}

functions! {
    add(a, b) = Arithmetic::plus: Arithmetic;
    subtract(a, b) = Arithmetic::minus: Arithmetic;
    multiply(a, b) = Arithmetic::times: Arithmetic;
    divide(a, b) = Arithmetic::over: Arithmetic;
    modulo(a, b) = Arithmetic::remainder: Arithmetic;
    negate(a) = Negate::negated: Negate;
    and(a, b) = Bits::both: Bits;
    or(a, b) = Bits::either: Bits;
    xor(a, b) = Bits::one_of: Bits;
    not(a) = Bits::inverted: Bits;
    reverse_bits(a) = Integer::bits_reversed: Integer;
    count_one_bits(a) = Integer::ones: Integer;
    count_trailing_zeros(a) = Integer::zeros_behind: Integer;
    min(a, b) = Extremes::lesser: Extremes;
    max(a, b) = Extremes::greater: Extremes;
    abs(a) = Round::magnitude: Round;
    floor(a) = Round::floored: Round;
    ceil(a) = Round::ceiled: Round;
    trunc(a) = Round::truncated: Round;
    sqrt(a) = Round::root: Round;
}

/// `a << places`.
#[inline(always)]
pub fn shift_left<T: Shift<P>, P>(a: T, places: P) -> T {
    a.upwards(places)
}

/// `a >> places`; places that become free are filled with the sign of signed integers.
#[inline(always)]
pub fn shift_right<T: Shift<P>, P>(a: T, places: P) -> T {
    a.downwards(places)
}

#[inline(always)]
pub fn equal<T: Compare>(a: T, b: T) -> T::Truth {
    a.is_equal(b)
}

#[inline(always)]
pub fn not_equal<T: Compare>(a: T, b: T) -> T::Truth {
    a.is_unequal(b)
}

#[inline(always)]
pub fn less<T: Compare>(a: T, b: T) -> T::Truth {
    a.is_less(b)
}

#[inline(always)]
pub fn less_equal<T: Compare>(a: T, b: T) -> T::Truth {
    a.is_at_most(b)
}

#[inline(always)]
pub fn greater<T: Compare>(a: T, b: T) -> T::Truth {
    b.is_less(a)
}

#[inline(always)]
pub fn greater_equal<T: Compare>(a: T, b: T) -> T::Truth {
    b.is_at_most(a)
}

#[inline(always)]
pub fn clamp<T: Extremes>(a: T, low: T, high: T) -> T {
    a.greater(low).lesser(high)
}

/// `set` in the lanes of the mask, `clear` in the others.
#[inline(always)]
pub fn blend<T: Blend>(mask: T::Mask, set: T, clear: T) -> T {
    T::blend(mask, set, clear)
}

/// Replaces a value in the lanes of the mask.
#[inline(always)]
pub fn assign<T: Blend>(mask: T::Mask, place: &mut T, value: T) {
    *place = T::blend(mask, value, *place);
}

/// One of two values, by a truth value that may differ between rays.
pub trait Pick<T> {
    fn pick(self, yes: T, no: T) -> T;
}

impl<T> Pick<T> for bool {
    #[inline(always)]
    fn pick(self, yes: T, no: T) -> T {
        if self { yes } else { no }
    }
}

#[inline(always)]
pub fn pick<T, C: Pick<T>>(which: C, yes: T, no: T) -> T {
    which.pick(yes, no)
}

impl<T: Blend, const N: usize> Blend for [T; N] {
    type Mask = T::Mask;
    #[inline(always)]
    fn blend(mask: T::Mask, set: Self, clear: Self) -> Self {
        std::array::from_fn(|i| T::blend(mask, set[i], clear[i]))
    }
}

impl<T: Zero, const N: usize> Zero for [T; N] {
    #[inline(always)]
    fn zero() -> Self {
        [T::zero(); N]
    }
}

macro_rules! transcendental {
    ($($name:ident = $function:expr;)*) => { $(
        #[inline(always)]
        pub fn $name<T: Transcendental<M>, M>(mask: M, a: T) -> T {
            a.each(mask, $function)
        }
    )* };
}

transcendental! {
    sin = f32::sin;
    cos = f32::cos;
    tan = f32::tan;
    asin = f32::asin;
    acos = f32::acos;
    atan = f32::atan;
    exp = f32::exp;
    exp2 = f32::exp2;
    log = f32::ln;
}

#[inline(always)]
pub fn pow<T: Transcendental<M>, M>(mask: M, base: T, exponent: T) -> T {
    base.each_of_two(mask, exponent, f32::powf)
}

#[inline(always)]
pub fn atan2<T: Transcendental<M>, M>(mask: M, y: T, x: T) -> T {
    y.each_of_two(mask, x, f32::atan2)
}
