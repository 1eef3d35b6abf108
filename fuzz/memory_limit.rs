//! An allocator that ends the process when reading an input takes more memory than it may.
//!
//! libFuzzer's own `-malloc_limit_mb` needs the hooks of a sanitizer, which stable Rust does not have, and its
//! `-rss_limit_mb` looks once a second only. An aborted process is a finding like any other.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes that may be in use at the same time, those of the fuzzer's own Rust code included. Inputs are at most some
/// hundred kilobytes, and the limits of `groimp::fuzzing` let them unpack to a few megabytes.
const MOST_BYTES: usize = 512 << 20;

struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

static IN_USE: AtomicUsize = AtomicUsize::new(0);

fn add(bytes: usize) {
    let before = IN_USE.fetch_add(bytes, Ordering::Relaxed);
    if before.saturating_add(bytes) > MOST_BYTES {
        // Nothing may allocate here, so the message is written in one piece.
        IN_USE.fetch_sub(bytes, Ordering::Relaxed);
        let _ = std::io::stderr().write_all(b"memory limit: more than 512 MiB in use\n");
        std::process::abort();
    }
}

// SAFETY: everything is handed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        add(layout.size());
        // SAFETY: the caller keeps the contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        add(layout.size());
        // SAFETY: the caller keeps the contract.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        add(new_size);
        IN_USE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the contract.
        unsafe { System.realloc(block, layout, new_size) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the contract.
        unsafe { System.dealloc(block, layout) }
    }
}
