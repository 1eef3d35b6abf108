//! Kernels with 16 lanes, for processors with AVX-512.

mod node;

pub(super) use lanes::avx512::is_supported;

/// For small scenes of plain materials: every lane searches on its own.
mod small {
    kernels_in_lanes!(
        lanes::avx512,
        "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,bmi1,bmi2,lzcnt,popcnt",
        PLAIN_FEATURES,
        "/small_avx512.rs"
    );
    pub(super) type Workspace = ();
}

/// For large scenes of plain materials: rays take turns.
mod large {
    kernels_in_lanes!(
        lanes::avx512,
        "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,bmi1,bmi2,lzcnt,popcnt",
        PLAIN_FEATURES,
        "/large_avx512.rs"
    );
    search_in_turns!("avx512f,avx512bw,avx512dq,avx512vl,avx512cd,bmi1,bmi2,lzcnt,popcnt");
}

/// For all scenes: rays take turns.
mod general {
    kernels_in_lanes!(
        lanes::avx512,
        "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,bmi1,bmi2,lzcnt,popcnt",
        ALL_FEATURES,
        "/general_avx512.rs"
    );
    search_in_turns!("avx512f,avx512bw,avx512dq,avx512vl,avx512cd,bmi1,bmi2,lzcnt,popcnt");
}

kernels_of_processor!("avx512f,avx512bw,avx512dq,avx512vl,avx512cd,bmi1,bmi2,lzcnt,popcnt");
