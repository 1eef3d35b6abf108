//! Inputs that once made a fuzz target fail, and the targets' own corpora, through the same functions.
//!
//! A panic fails the test that reads the input. An input that took too long or too much memory is small here, and
//! the functions have low limits, so it ends at once or shows as a test that does not.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

use groimp::fuzzing::TARGETS;
use std::path::{Path, PathBuf};

fn files(folder: &str, target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz").join(folder).join(target);
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn read_all(folder: &str) -> usize {
    let mut count = 0;
    for (name, target) in TARGETS {
        for file in files(folder, name) {
            // The last line before a panic names the input.
            println!("{}", file.display());
            target(&std::fs::read(&file).unwrap());
            count += 1;
        }
    }
    count
}

#[test]
fn inputs_that_once_failed() {
    read_all("regressions");
}

#[test]
fn corpora() {
    for (name, _) in TARGETS {
        assert!(!files("corpus", name).is_empty(), "the target {name} has no corpus");
    }
    read_all("corpus");
}
