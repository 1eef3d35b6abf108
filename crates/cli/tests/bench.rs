//! `sunshine bench run` and `sunshine bench compare`. What is measured is not judged: times are only looked for.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

fn sunshine(directory: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sunshine")).args(words).current_dir(directory).output().unwrap()
}

/// Asserts success and returns what was printed.
fn answer(output: &Output) -> &str {
    assert!(output.status.success(), "{}", std::str::from_utf8(&output.stderr).unwrap());
    std::str::from_utf8(&output.stdout).unwrap()
}

/// Asserts a failure that is no wrong usage and returns the message.
fn failure(output: &Output) -> &str {
    assert_eq!(output.status.code(), Some(1));
    std::str::from_utf8(&output.stderr).unwrap()
}

#[test]
fn a_run_leaves_a_table_and_a_file_with_all_fields() {
    let directory = tempfile::tempdir().unwrap();
    let run = "bench run cornell-box --device cpu,cpu --samples 1,2,1 --depth 3 --size 8x8 --repeat 2 --threads 1 -o b.json";
    let output = sunshine(directory.path(), &run.split(' ').collect::<Vec<_>>());
    let text = answer(&output);
    for part in ["commit ", "8x8 pixels, depth 3, best of 2", "Mrays/s", "cornell-box", "wrote b.json"] {
        assert!(text.contains(part), "no {part:?} in {text}");
    }
    let file: Value =
        serde_json::from_slice(&std::fs::read(directory.path().join("b.json")).unwrap()).unwrap();
    assert_eq!(file["version"], env!("CARGO_PKG_VERSION"));
    assert!(file["commit"].as_str().unwrap().len() >= 7 && file["date"].as_str().unwrap().ends_with('Z'));
    let machine = &file["machine"];
    assert_eq!(machine["threads"], 1);
    assert!(
        !machine["processor"].as_str().unwrap().is_empty() && !machine["system"].as_str().unwrap().is_empty()
    );
    assert!(machine["graphics_cards"].is_array());

    // What is asked for twice is measured once.
    let rows = file["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for (row, samples) in rows.iter().zip([1, 2]) {
        assert_eq!((&row["scene"], &row["device"]), (&json!("cornell-box"), &json!("cpu")));
        assert_eq!((&row["width"], &row["height"], &row["depth"]), (&json!(8), &json!(8), &json!(3)));
        assert_eq!((&row["samples"], &row["repeats"]), (&json!(samples), &json!(2)));
        assert_eq!((&row["objects"], &row["triangles"]), (&json!(8), &json!(0)));
        assert_eq!(row["device_name"], "CPU (1 thread)");
        for number in ["samples_per_second", "rays_per_second", "scene_bytes"] {
            assert!(row[number].as_f64().unwrap() > 0.0, "{number}");
        }
        for step in ["open", "upload", "first"] {
            assert!(row["seconds"][step].as_f64().unwrap() >= 0.0, "{step}");
        }
        for step in ["read", "compile", "render"] {
            for part in ["best", "spread"] {
                assert!(row["seconds"][step][part].as_f64().unwrap() >= 0.0, "{step} {part}");
            }
        }
        if cfg!(target_os = "linux") {
            assert!(row["peak_memory_bytes"].as_u64().unwrap() > 1 << 20);
            assert!(row["cpu_seconds"].as_f64().unwrap() >= 0.0);
        }
    }
    // A file compared with itself.
    let output = sunshine(directory.path(), &["bench", "compare", "b.json", "b.json"]);
    let text = answer(&output);
    assert!(!text.contains("only in") && !text.contains("differ") && text.contains("1.00"), "{text}");
}

#[test]
fn a_project_is_measured_under_its_name() {
    let directory = tempfile::tempdir().unwrap();
    let scenes =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/cornell-box").canonicalize().unwrap();
    let words =
        ["bench", "run", scenes.to_str().unwrap(), "--device", "cpu", "--samples", "1", "--size", "8x8"];
    let words = [&words[..], &["--repeat", "1", "-o", "b.json", "--quiet"]].concat();
    let output = sunshine(directory.path(), &words);
    answer(&output);
    assert!(output.stderr.is_empty());
    let file: Value =
        serde_json::from_slice(&std::fs::read(directory.path().join("b.json")).unwrap()).unwrap();
    // A scene that is built in has this name already.
    assert_eq!(file["rows"][0]["scene"], scenes.to_str().unwrap());
    assert!(file["rows"][0]["seconds"]["render"].get("spread").is_none());
}

#[test]
fn what_is_not_there_is_told_before_anything_is_measured() {
    let directory = tempfile::tempdir().unwrap();
    let output = sunshine(directory.path(), &["bench", "run", "canopy", "missing.gsz", "-o", "b.json"]);
    assert!(failure(&output).contains("missing.gsz cannot be read"), "{}", failure(&output));
    let output = sunshine(directory.path(), &["bench", "run", "bush-7", "-o", "lost/b.json"]);
    assert!(failure(&output).contains("there is no folder lost"), "{}", failure(&output));
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
}

/// A row of a file that was written by hand: seconds of the rendering, their spread, samples per pixel.
fn row(scene: &str, render: f64, spread: Option<f64>, samples: u32) -> Value {
    let mut row = json!({
        "scene": scene, "objects": 8, "triangles": 0, "device": "cpu", "device_name": "CPU (2 threads)",
        "width": 640, "height": 480, "depth": 5, "samples": samples, "repeats": 3,
        "seconds": {
            "open": 0.0, "read": { "best": 0.5, "spread": 0.1 }, "compile": { "best": 0.25, "spread": 0.0 },
            "upload": 0.0, "first": 0.1, "render": { "best": render }
        },
        "samples_per_second": 1e6 / render, "rays_per_second": 4e6 / render,
        "scene_bytes": 1000, "peak_memory_bytes": 50_000_000
    });
    if let Some(spread) = spread {
        row["seconds"]["render"]["spread"] = spread.into();
    }
    row
}

fn record(commit: &str, rows: &[Value]) -> String {
    let card = json!({ "name": "Card", "backend": "Vulkan", "driver": "7" });
    let machine = json!({
        "processor": "Some CPU", "threads": 2, "graphics_cards": [card], "system": "Some Linux"
    });
    let date = "2008-09-30T12:00:00Z";
    json!({ "version": "0.2.0", "commit": commit, "date": date, "machine": machine, "rows": rows })
        .to_string()
}

#[test]
fn a_comparison_marks_what_changed_and_names_what_is_missing() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(directory.path().join(name), text).unwrap();
    let old = [
        row("faster", 2.0, Some(0.1), 16),
        row("same", 1.0, Some(0.1), 16),
        row("once", 1.0, Some(0.1), 16),
        row("gone", 1.0, None, 16),
    ];
    let new = [
        row("faster", 1.0, Some(0.1), 16),
        row("same", 1.05, Some(0.1), 16),
        row("once", 4.0, None, 16),
        row("gone", 1.0, None, 64),
    ];
    write("old.json", record("1111111", &old));
    write("new.json", record("2222222", &new));
    let output = sunshine(directory.path(), &["bench", "compare", "old.json", "new.json"]);
    let expected = "\
old: sunshine 0.2.0, commit 1111111, 2008-09-30T12:00:00Z, Some CPU, 2 threads, Card (Vulkan 7), Some Linux
new: sunshine 0.2.0, commit 2222222, 2008-09-30T12:00:00Z, Some CPU, 2 threads, Card (Vulkan 7), Some Linux

ratios new : old, below 1 is faster or smaller

scene   device  samples  read    compile    upload    first    render    memory  old Msamples/s  new Msamples/s
faster     cpu       16  1.00       1.00         - ?   1.00 ?    0.50 *    1.00           0.500            1.00
same       cpu       16  1.00       1.00         - ?   1.00 ?    1.05      1.00            1.00           0.952
once       cpu       16  1.00       1.00         - ?   1.00 ?    4.00 ?    1.00            1.00           0.250

* the repeats of old and new do not overlap
? measured once, so that the spread is not known
only in old: gone on cpu, 16 samples, 640x480, depth 5
only in new: gone on cpu, 64 samples, 640x480, depth 5
";
    assert_eq!(answer(&output), expected);

    let other = record("3333333", &[]).replace("Some CPU", "Other CPU");
    write("other.json", other);
    let output = sunshine(directory.path(), &["bench", "compare", "new.json", "other.json"]);
    for part in ["the machines differ", "no row of one file is in the other", "only in old: once"] {
        assert!(answer(&output).contains(part), "{}", answer(&output));
    }
}

#[test]
fn files_that_are_no_measurements_are_named_with_what_was_found() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(directory.path().join(name), text).unwrap();
    let good = record("1111111", &[row("bush", 1.0, None, 16)]);
    write("good.json", &good);
    write("cut.json", &good[..good.len() / 2]);
    write("empty.json", "");
    write("other.json", r#"{ "version": "0.2.0", "width": 640 }"#);
    write("wrong.json", &good.replace("\"samples\":16", "\"samples\":-16"));
    write("deep.json", &"[".repeat(100_000));
    for (file, found) in [
        ("missing.json", "cannot be read"),
        ("cut.json", "EOF"),
        ("empty.json", "EOF"),
        ("other.json", "missing field `commit`"),
        ("wrong.json", "-16"),
        ("deep.json", "line 1"),
    ] {
        for words in [["bench", "compare", "good.json", file], ["bench", "compare", file, "good.json"]] {
            let output = sunshine(directory.path(), &words);
            let message = failure(&output);
            assert!(message.contains(file) && message.contains(found), "{file}: {message}");
        }
    }
}
