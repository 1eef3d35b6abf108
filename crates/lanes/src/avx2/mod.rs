//! Eight lanes in the registers of AVX2.
//!
//! The functions are inlined into kernels that are compiled for the features named in [`is_supported`] and must not be
//! called elsewhere on processors without them.

use crate::*;
use std::arch::x86_64::*;

// SAFETY of all calls of vector instructions below: only kernels that `is_supported` was asked for execute them.
// Measured: see docs/performance.md, "Lanes".
macro_rules! vector {
    ($call:expr) => {
        unsafe { $call }
    };
}

mod conversions;
mod floats;
mod integers;
mod mask;
mod memory;

pub use mask::Mask;
pub use memory::{block, choose, choose_far, put, put_far, words};

widen!();

/// Rays side by side.
pub const LANES: usize = 8;

/// Whether this processor has what the kernels are compiled for.
pub fn is_supported() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

/// Numbers of single precision.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct F32(__m256);

/// Integers without sign.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct U32(__m256i);

/// Integers with a sign.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct I32(__m256i);

impl F32 {
    #[inline(always)]
    pub fn from_array(values: [f32; LANES]) -> Self {
        F32(vector!(_mm256_loadu_ps(values.as_ptr())))
    }
    #[inline(always)]
    pub fn to_array(self) -> [f32; LANES] {
        let mut values = [0.0; LANES];
        vector!(_mm256_storeu_ps(values.as_mut_ptr(), self.0));
        values
    }
}

impl U32 {
    #[inline(always)]
    pub fn from_array(values: [u32; LANES]) -> Self {
        U32(vector!(_mm256_loadu_si256(values.as_ptr().cast())))
    }
    #[inline(always)]
    pub fn to_array(self) -> [u32; LANES] {
        let mut values = [0; LANES];
        vector!(_mm256_storeu_si256(values.as_mut_ptr().cast(), self.0));
        values
    }
}

impl I32 {
    #[inline(always)]
    fn to_array(self) -> [i32; LANES] {
        let mut values = [0; LANES];
        vector!(_mm256_storeu_si256(values.as_mut_ptr().cast(), self.0));
        values
    }
    #[inline(always)]
    fn from_array(values: [i32; LANES]) -> Self {
        I32(vector!(_mm256_loadu_si256(values.as_ptr().cast())))
    }
}

impl Widen for f32 {
    type Lanes = F32;
    #[inline(always)]
    fn widen(self) -> F32 {
        F32(vector!(_mm256_set1_ps(self)))
    }
}

impl Widen for u32 {
    type Lanes = U32;
    #[inline(always)]
    fn widen(self) -> U32 {
        U32(vector!(_mm256_set1_epi32(self.cast_signed())))
    }
}

impl Widen for i32 {
    type Lanes = I32;
    #[inline(always)]
    fn widen(self) -> I32 {
        I32(vector!(_mm256_set1_epi32(self)))
    }
}

impl Zero for F32 {
    #[inline(always)]
    fn zero() -> Self {
        0.0f32.widen()
    }
}

impl Zero for U32 {
    #[inline(always)]
    fn zero() -> Self {
        0u32.widen()
    }
}

impl Zero for I32 {
    #[inline(always)]
    fn zero() -> Self {
        0i32.widen()
    }
}
