//! Inputs that once made a fuzz target fail, and the targets' own corpora, through the same functions.
//!
//! A panic fails the test that reads the input. An input that took too much memory has to fail by itself: here nobody
//! counts.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

use render::fuzzing::TARGETS;
use std::path::{Path, PathBuf};

fn files(folder: &str, target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz").join(folder).join(target);
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn inputs_that_once_failed_and_corpora() {
    for (name, target) in TARGETS {
        let corpus = files("corpus", name);
        assert!(!corpus.is_empty(), "the target {name} has no corpus");
        for file in corpus.into_iter().chain(files("regressions", name)) {
            // The last line before a panic names the input.
            println!("{}", file.display());
            target(&std::fs::read(&file).unwrap());
        }
    }
}
