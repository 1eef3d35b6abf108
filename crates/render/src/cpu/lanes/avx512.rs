//! Kernels with 16 lanes, for processors with AVX-512.

mod node;

pub(super) use lanes::avx512::is_supported;

kernels_of_processor!(
    lanes::avx512,
    "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,bmi1,bmi2,lzcnt,popcnt",
    "/small_avx512.rs",
    "/large_avx512.rs",
    "/general_avx512.rs"
);
