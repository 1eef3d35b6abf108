//! What `sunshine info --json` says about every project of the corpus, as reviewed snapshots. Set `SUNSHINE_BLESS=1` to
//! accept a change.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder with the projects; without it there is nothing to do, except where all tests must run.
fn corpus() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/corpus");
    let root = std::env::var_os("SUNSHINE_CORPUS").map_or(beside, PathBuf::from);
    if root.is_dir() {
        return Some(root);
    }
    assert!(std::env::var_os("CI").is_none(), "no corpus at {}", root.display());
    eprintln!("skipped: no corpus at {}; set SUNSHINE_CORPUS", root.display());
    None
}

#[test]
fn info_about_the_corpus_matches_the_reviewed_snapshots() {
    let Some(corpus) = corpus() else { return };
    let snapshots = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus_info");
    let bless = std::env::var_os("SUNSHINE_BLESS").is_some();
    std::fs::create_dir_all(&snapshots).unwrap();
    let mut projects: Vec<_> =
        std::fs::read_dir(corpus).unwrap().map(|entry| entry.unwrap().path()).collect();
    projects.sort();
    assert!(!projects.is_empty());
    for project in projects {
        let output = Command::new(env!("CARGO_BIN_EXE_sunshine"))
            .args(["info", "--json"])
            .arg(&project)
            .output()
            .unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {message}", project.display());
        let name = project.file_stem().unwrap().to_string_lossy().replace(' ', "-");
        let snapshot = snapshots.join(format!("{name}.json"));
        if bless {
            std::fs::write(&snapshot, &output.stdout).unwrap();
        }
        let reviewed = std::fs::read(&snapshot).unwrap_or_default();
        assert!(
            reviewed == output.stdout,
            "info about {} differs from {}; review it with SUNSHINE_BLESS=1 and git diff",
            project.display(),
            snapshot.display()
        );
    }
}
