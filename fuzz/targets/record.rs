#![no_main]

use memory_limit as _;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| render::fuzzing::record(bytes));
