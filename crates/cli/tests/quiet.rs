//! What is told besides the answer, and what is written besides the files that are named.

// In tests a panic is the failure report; the exception for tests does not reach helper functions.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn cornell_box() -> PathBuf {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    scenes.join("cornell-box").canonicalize().unwrap()
}

/// Renders in `directory/work`, for a user whose home is `directory/home`.
fn render(directory: &Path, words: &[&str]) -> Output {
    let work = directory.join("work");
    std::fs::create_dir_all(&work).unwrap();
    let home = directory.join("home");
    std::fs::create_dir_all(&home).unwrap();
    let scene = cornell_box();
    let mut command = Command::new(env!("CARGO_BIN_EXE_sunshine"));
    command.args(["render", scene.to_str().unwrap(), "-o", "a.png", "--size", "8x6", "--samples", "1"]);
    let output = command
        .args(words)
        .current_dir(&work)
        .env("HOME", &home)
        .env("XDG_CACHE_HOME", home.join("cache"))
        .env_remove("XDG_CONFIG_HOME")
        .env_remove("XDG_DATA_HOME")
        .env_remove("XDG_STATE_HOME")
        .env("TMPDIR", directory.join("work"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

/// All files below a directory.
fn files(directory: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut pending = vec![directory.to_owned()];
    while let Some(directory) = pending.pop() {
        for entry in std::fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { pending.push(path) } else { found.push(path) }
        }
    }
    found
}

#[test]
fn nothing_is_written_but_what_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let scene_before = files(&cornell_box());
    render(directory.path(), &["--device", "cpu"]);
    assert_eq!(files(directory.path()), [directory.path().join("work/a.png")]);
    assert_eq!(files(&cornell_box()), scene_before);
}

#[test]
fn drivers_keep_to_the_cache_directory_and_can_be_kept_from_it() {
    if render::list_gpus().is_empty() {
        assert!(std::env::var_os("SUNSHINE_REQUIRE_GPU").is_none(), "no graphics card");
        eprintln!("skipped: no graphics card");
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    render(directory.path(), &["--device", "gpu", "--no-cache"]);
    assert_eq!(files(directory.path()), [directory.path().join("work/a.png")]);
    // Its driver and their interface say little unless everything is asked for.
    let more = String::from_utf8(render(directory.path(), &["--device", "gpu", "-vv"]).stderr).unwrap();
    assert!(more.contains("is ready after") && more.lines().count() < 100, "{more}");
    let cache = directory.path().join("home/cache");
    for file in files(directory.path()) {
        assert!(file.starts_with(&cache) || file.ends_with("work/a.png"), "{}", file.display());
    }
}

#[test]
fn the_log_tells_the_steps() {
    let directory = tempfile::tempdir().unwrap();
    let told = |words: &[&str]| {
        let mut all = vec!["--device", "cpu"];
        all.extend(words);
        String::from_utf8(render(directory.path(), &all).stderr).unwrap()
    };
    let plain = told(&[]);
    assert!(!plain.contains("INFO") && plain.contains("rendered 100 %"), "{plain}");
    let verbose = told(&["-v"]);
    assert!(verbose.contains("INFO") && verbose.contains("read the scene in"), "{verbose}");
    assert!(!verbose.contains("DEBUG"), "{verbose}");
    // Once, although it is in the log, too.
    assert_eq!(verbose.matches("rendered 100 %").count(), 1, "{verbose}");
    let more = told(&["-vv"]);
    assert!(more.contains("a pass is done") && more.contains("scene hash"), "{more}");

    // A file takes everything, and what is there stays.
    let quiet = told(&["--quiet", "--log-file", "log"]);
    assert_eq!(quiet, "");
    told(&["--log-file", "log", "-vv"]);
    let log = std::fs::read_to_string(directory.path().join("work/log")).unwrap();
    assert_eq!(log.matches("is ready after").count(), 2, "{log}");
    assert!(log.contains("a pass is done") && log.contains("rendered 100 %"), "{log}");
}
