//! Kernels with 8 lanes, for processors with AVX2.

mod node;

pub(super) use lanes::avx2::is_supported;

kernels_of_processor!(
    lanes::avx2,
    "avx2,bmi1,bmi2,lzcnt,popcnt",
    "/small_avx2.rs",
    "/large_avx2.rs",
    "/general_avx2.rs"
);
