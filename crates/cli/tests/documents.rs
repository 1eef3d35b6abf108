//! What the documents say is there.

// In tests a panic is the failure report; the exception for tests does not reach helper functions.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

fn sunshine(words: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_sunshine")).args(words).output().unwrap();
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// What stands between single backquotes.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

#[test]
fn files_that_developers_are_sent_to_exist() {
    let page = std::fs::read_to_string(root().join("docs/developer.md")).unwrap();
    let page = page.replace("```", "");
    let files: Vec<_> = quoted(&page).filter(|name| name.starts_with("crates/")).collect();
    assert!(files.len() > 20, "{files:?}");
    for file in files {
        assert!(root().join(file).exists(), "docs/developer.md names {file}");
    }
}

#[test]
fn options_that_users_are_told_exist() {
    let mut help = String::new();
    for command in ["render", "info", "merge", "show", "devices"] {
        help += &sunshine(&[command, "--help"]);
    }
    if cfg!(feature = "view") {
        help += &sunshine(&["view", "--help"]);
    }
    help += &sunshine(&["bench", "run", "--help"]);
    help += &sunshine(&["--help"]);
    for page in [
        "README.md",
        "docs/guide.md",
        "docs/long-renders.md",
        "docs/limits.md",
        "docs/view.md",
        "docs/examples/slurm-array.sh",
    ] {
        let text = std::fs::read_to_string(root().join(page)).unwrap();
        for (number, line) in text.lines().enumerate() {
            // Of other programs.
            let others = ["cargo", "sbatch", "#SBATCH", "vulkaninfo", "scontrol", "srun"];
            if line
                .split("sunshine")
                .next()
                .is_some_and(|before| others.iter().any(|other| before.contains(other)))
            {
                continue;
            }
            for option in
                line.split(|c: char| !c.is_ascii_alphanumeric() && c != '-').filter(|w| w.starts_with("--"))
            {
                let is_option = option.len() > 3 && option[2..].starts_with(|c: char| c.is_ascii_lowercase());
                assert!(!is_option || help.contains(option), "{page}:{}: there is no {option}", number + 1);
            }
        }
    }
}

#[test]
fn manual_pages_and_completions_are_made_of_the_command_line() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path().join("generated");
    let told = sunshine(&["generate", folder.to_str().unwrap()]);
    let mut names: Vec<_> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    for name in
        ["_sunshine", "sunshine.1", "sunshine.bash", "sunshine.fish", "sunshine-render.1", "sunshine-merge.1"]
    {
        assert!(names.iter().any(|there| there == name), "{name} is not among {names:?}");
        assert!(told.contains(name));
    }
    if cfg!(feature = "view") {
        let page = std::fs::read_to_string(folder.join("sunshine-view.1")).unwrap();
        assert!(page.contains("\\-\\-window") && page.contains("\\-\\-depth"), "{page}");
        assert!(!page.contains("checkpoint") && !page.contains("turntable"), "{page}");
    }
    assert!(!names.iter().any(|name| name.contains("generate") || name.contains("help")), "{names:?}");
    let page = std::fs::read_to_string(folder.join("sunshine-render.1")).unwrap();
    assert!(page.contains("sample\\-range") && page.contains("GroIMP"), "{page}");
    let bash = std::fs::read_to_string(folder.join("sunshine.bash")).unwrap();
    assert!(bash.contains("--checkpoint") && bash.contains("merge"));
}
