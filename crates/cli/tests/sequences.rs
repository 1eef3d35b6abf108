//! Several pictures by one command.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name)
}

/// Renders small pictures in `directory`.
fn render(directory: &Path, scenes: &[&str], words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sunshine"))
        .arg("render")
        .args(scenes.iter().map(|name| scene(name)))
        .args(["--size", "24x18", "--samples", "2", "--device", "cpu"])
        .args(words)
        .current_dir(directory)
        .output()
        .unwrap()
}

fn names(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_turntable_begins_with_the_saved_view_and_turns() {
    let directory = tempfile::tempdir().unwrap();
    let output = render(directory.path(), &["first-plant"], &["--turntable", "3", "-o", "turn.exr"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(names(directory.path()), ["turn-0001.exr", "turn-0002.exr", "turn-0003.exr"]);
    let single = render(directory.path(), &["first-plant"], &["-o", "single.exr"]);
    assert!(single.status.success());
    let bytes = |name: &str| std::fs::read(directory.path().join(name)).unwrap();
    assert_eq!(bytes("turn-0001.exr"), bytes("single.exr"));
    assert_ne!(bytes("turn-0001.exr"), bytes("turn-0002.exr"));
    assert_ne!(bytes("turn-0002.exr"), bytes("turn-0003.exr"));
    // Every picture tells its own camera.
    let record = |name: &str| render::read_record(&directory.path().join(name)).unwrap();
    assert!(!record("turn-0001.exr").contains("--camera-position"));
    let (second, third) = (record("turn-0002.exr"), record("turn-0003.exr"));
    assert!(second.contains("--camera-position") && second.contains("scene hash: ") && second != third);
}

#[test]
fn a_growth_has_the_camera_and_the_exposure_of_its_first_step() {
    let directory = tempfile::tempdir().unwrap();
    let scenes = ["cornell-box", "shapes", "cornell-box"];
    let output = render(directory.path(), &scenes, &["-o", "growth.png"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(names(directory.path()), ["growth-0001.png", "growth-0002.png", "growth-0003.png"]);
    let bytes = |name: &str| std::fs::read(directory.path().join(name)).unwrap();
    assert_eq!(bytes("growth-0001.png"), bytes("growth-0003.png"));
    assert!(
        String::from_utf8_lossy(&output.stdout)
            .contains("wrote 3 pictures, growth-0001.png to growth-0003.png")
    );
}

#[test]
fn what_is_meant_for_one_picture_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    for (scenes, words) in [
        (&["shapes", "glass"][..], &["--turntable", "3"][..]),
        (&["shapes"], &["--turntable", "3", "--stats", "a.json"]),
        (&["shapes", "glass"], &["--pixel", "1,1"]),
        (&["shapes"], &["--turntable", "0"]),
        (&["shapes"], &["--turntable", "3", "--checkpoint", "a.film"]),
        (&["shapes", "glass"], &["--resume", "a.film", "--checkpoint", "a.film"]),
        (&["shapes", "glass"], &["--samples", "64", "--sample-range", "0..64"]),
    ] {
        let output = render(directory.path(), scenes, words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(names(directory.path()).is_empty());
    }
}
