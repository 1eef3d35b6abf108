//! Kernels with 8 lanes, for processors with AVX2.

mod node;

pub(super) use lanes::avx2::is_supported;

/// For small scenes of plain materials: every lane searches on its own.
mod small {
    kernels_in_lanes!(lanes::avx2, "avx2,bmi1,bmi2,lzcnt,popcnt", PLAIN_FEATURES, "/small_avx2.rs");
    pub(super) type Workspace = ();
}

/// For large scenes of plain materials: rays take turns.
mod large {
    kernels_in_lanes!(lanes::avx2, "avx2,bmi1,bmi2,lzcnt,popcnt", PLAIN_FEATURES, "/large_avx2.rs");
    search_in_turns!("avx2,bmi1,bmi2,lzcnt,popcnt");
}

/// For all scenes: rays take turns.
mod general {
    kernels_in_lanes!(lanes::avx2, "avx2,bmi1,bmi2,lzcnt,popcnt", ALL_FEATURES, "/general_avx2.rs");
    search_in_turns!("avx2,bmi1,bmi2,lzcnt,popcnt");
}

kernels_of_processor!("avx2,bmi1,bmi2,lzcnt,popcnt");
