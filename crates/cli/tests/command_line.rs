//! The program as its users call it.

// In tests a panic is the failure report; the exception for tests does not reach helper functions.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Runs the program in `directory`.
fn sunshine(directory: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sunshine")).args(words).current_dir(directory).output().unwrap()
}

fn empty_directory() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn cornell_box() -> PathBuf {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    scenes.join("cornell-box").canonicalize().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Asserts the exit code, that all `parts` are in the error message, and that nothing was left behind.
fn assert_fails(words: &[&str], code: i32, parts: &[&str]) {
    let directory = empty_directory();
    let output = sunshine(directory.path(), words);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{words:?}: {message}");
    assert!(message.starts_with("error: "), "{words:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{words:?}: no {part:?} in {message}");
    }
    assert!(output.stdout.is_empty(), "{words:?}: {}", text(&output.stdout));
    let left: Vec<_> = std::fs::read_dir(directory.path()).unwrap().collect();
    assert!(left.is_empty(), "{words:?}: {left:?}");
}

#[test]
fn wrong_usage_exits_with_2_and_says_what_is_accepted() {
    let render = |option: &'static str, value: &'static str, part: &'static str| {
        assert_fails(&["render", "plant.gsz", option, value], 2, &[option, part]);
    };
    render("--size", "640", "1920x1080");
    render("--size", "0x480", "1 to 65536");
    render("--size", "640x65537", "1 to 65536");
    render("--samples", "0", "at least 1");
    render("--depth", "0", "1 to 1000");
    render("--grid", "65", "1 to 64");
    render("--sampler", "halton", "sobol");
    render("--filter", "sinc", "blackman-harris");
    render("--crop", "1,2,3", "320,240,64,64");
    render("--camera-position", "1,2", "three numbers");
    render("--fov", "0", "0.001 to 179");
    render("--aperture", "0", "metres");
    render("--threads", "0", "1 to 4096");
    render("--exposure", "bright", "number of stops");
    render("--device", "tpu", "gpu:N");
    render("--tile", "0", "1 to 4096");
    render("--time", "soon", "1h30m");
    render("--noise", "5", "2%");
    render("--layers", "colour", "albedo, normal");
    render("--pixel", "3", "320,240");
    assert_fails(&["render"], 2, &["<SCENE>", "--help"]);
    assert_fails(&["rendr"], 2, &["render"]);
    assert_fails(&["info", "plant.gsz", "--jsn"], 2, &["--json"]);
}

#[test]
fn without_a_command_the_help_is_shown() {
    let output = sunshine(empty_directory().path(), &[]);
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    for command in ["render", "info", "devices"] {
        assert!(message.contains(command), "{message}");
    }
}

#[test]
fn help_and_version_are_no_errors() {
    let directory = empty_directory();
    for words in [&["--help"][..], &["render", "--help"], &["--version"]] {
        let output = sunshine(directory.path(), words);
        assert_eq!(output.status.code(), Some(0), "{words:?}");
        assert!(!output.stdout.is_empty() && output.stderr.is_empty(), "{words:?}");
    }
}

#[test]
fn a_wrong_extension_is_refused_before_the_scene_is_even_looked_for() {
    assert_fails(&["render", "missing.gsz", "-o", "picture.jpg"], 2, &["picture.jpg", ".png", ".exr"]);
    assert_fails(&["render", "missing.gsz", "-o", "picture"], 2, &[".png", ".exr"]);
}

#[test]
fn one_name_for_two_outputs_is_wrong_usage() {
    assert_fails(&["render", "missing.gsz", "-o", "a.png", "--stats", "a.png"], 2, &["a.png", "different"]);
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_scene_is_looked_for() {
    let lost = Path::new("no-such-folder").join("picture.png");
    let lost = lost.to_str().unwrap();
    assert_fails(
        &["render", "missing.gsz", "-o", lost],
        1,
        &[lost, "because: there is no folder no-such-folder"],
    );
    assert_fails(&["render", "missing.gsz", "--stats", "no-such-folder/s.json"], 1, &["s.json", "because: "]);
}

#[test]
fn a_missing_scene_exits_with_1_and_names_the_file() {
    assert_fails(&["render", "missing.gsz", "--stats", "s.json"], 1, &["missing.gsz", "because: "]);
    assert_fails(&["info", "missing.gsz"], 1, &["missing.gsz", "because: "]);
}

#[test]
fn a_scene_that_is_none_exits_with_1() {
    let directory = empty_directory();
    let path = directory.path().join("plant.gsz");
    std::fs::write(&path, "this is not an archive").unwrap();
    assert_fails(&["render", path.to_str().unwrap()], 1, &["plant.gsz"]);
}

#[test]
fn devices_always_name_the_cpu_and_one_automatic_choice() {
    let output = sunshine(empty_directory().path(), &["devices"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let listing = text(&output.stdout);
    assert!(listing.starts_with("cpu ") && listing.contains("thread"), "{listing}");
    assert_eq!(listing.matches("<- auto").count(), 1, "{listing}");
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_sunshine"))
        .arg("devices")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Nobody reads what the program prints.
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    // Not "is empty": graphics drivers may have something to say.
    for word in ["panicked", "because"] {
        assert!(!text(&output.stderr).contains(word), "{}", text(&output.stderr));
    }
}

#[test]
fn info_describes_the_cornell_box() {
    let scene = cornell_box();
    let directory = empty_directory();
    let output = sunshine(directory.path(), &["info", scene.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let shapes: u64 = info["shapes"].as_object().unwrap().values().filter_map(|count| count.as_u64()).sum();
    assert!(shapes > 0 && info["objects"] == shapes, "{info}");
    assert!(info["lights"].as_u64() >= Some(1), "{info}");
    assert!(info["bounds"]["min"][0].as_f64() < info["bounds"]["max"][0].as_f64(), "{info}");
    assert!(info["camera"]["projection"].is_string(), "{info}");
    assert!(info["skipped"].is_array() && info["warnings"].is_array(), "{info}");

    let table = sunshine(directory.path(), &["info", scene.to_str().unwrap()]);
    assert!(text(&table.stdout).starts_with("objects "));
}

const SMALL: [&str; 8] = ["--size", "24x16", "--samples", "4", "--device", "cpu", "--threads", "2"];

#[test]
fn the_cornell_box_becomes_a_png_named_after_it_with_statistics() {
    let scene = cornell_box();
    let directory = empty_directory();
    let mut words = vec!["render", scene.to_str().unwrap(), "--stats", "stats.json"];
    words.extend(SMALL);
    let output = sunshine(directory.path(), &words);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let summary = text(&output.stdout);
    for part in ["(chosen automatically; --exposure fixes it)", "samples/s", "wrote cornell-box.png"] {
        assert!(summary.contains(part), "{summary}");
    }
    assert!(text(&output.stderr).contains("rendered 100 %"), "{}", text(&output.stderr));

    let png = std::fs::read(directory.path().join("cornell-box.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));
    // Width and height stand at the same place in every PNG.
    assert_eq!(png[16..24], [0, 0, 0, 24, 0, 0, 0, 16]);

    let stats = std::fs::read(directory.path().join("stats.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_slice(&stats).unwrap();
    assert_eq!((&stats["width"], &stats["height"]), (&24.into(), &16.into()));
    assert_eq!(stats["samples"], 24 * 16 * 4);
    assert!(stats["rays"].as_u64() >= stats["samples"].as_u64(), "{stats}");
    assert!(stats["objects"].as_u64() > Some(0), "{stats}");
    assert!(stats["device"].as_str().unwrap().contains("CPU"), "{stats}");
    for step in ["read", "compile", "upload", "render", "write"] {
        assert!(stats["seconds"][step].as_f64() >= Some(0.0), "{stats}");
    }
    // Processors have no clock of their own.
    assert!(stats.get("device_seconds").is_none(), "{stats}");
}

#[test]
fn quiet_says_nothing_and_exr_does_not_depend_on_exposure() {
    let scene = cornell_box();
    let directory = empty_directory();
    for (name, exposure) in [("a.exr", "0"), ("b.EXR", "3")] {
        let mut words =
            vec!["render", scene.to_str().unwrap(), "-o", name, "--exposure", exposure, "--quiet"];
        words.extend(SMALL);
        let output = sunshine(directory.path(), &words);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(output.stdout.is_empty() && output.stderr.is_empty(), "{}", text(&output.stderr));
    }
    let bytes = |name: &str| std::fs::read(directory.path().join(name)).unwrap();
    assert!(bytes("a.exr").starts_with(&[0x76, 0x2f, 0x31, 0x01]));
    assert_eq!(bytes("a.exr"), bytes("b.EXR"));
}

/// Renders the Cornell box in `directory` and returns standard output.
fn render_small(directory: &Path, words: &[&str]) -> String {
    let scene = cornell_box();
    let mut all = vec!["render", scene.to_str().unwrap(), "--device", "cpu", "--size", "24x16"];
    all.extend(words);
    let output = sunshine(directory, &all);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout).to_owned()
}

fn statistics(directory: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(directory.join("stats.json")).unwrap()).unwrap()
}

#[test]
fn tiles_and_threads_do_not_change_a_byte() {
    let directory = empty_directory();
    for (name, tile, threads) in [("a.png", "5", "1"), ("b.png", "64", "3"), ("c.png", "1", "2")] {
        render_small(directory.path(), &["-o", name, "--samples", "2", "--tile", tile, "--threads", threads]);
    }
    let bytes = |name: &str| std::fs::read(directory.path().join(name)).unwrap();
    assert!(bytes("a.png") == bytes("b.png") && bytes("a.png") == bytes("c.png"));
}

#[test]
fn rendering_stops_by_time_or_noise_and_says_what_it_took() {
    let directory = empty_directory();
    let summary =
        render_small(directory.path(), &["-o", "a.exr", "--time", "0.000001s", "--stats", "stats.json"]);
    assert!(summary.contains("1 samples per pixel"), "{summary}");
    assert_eq!(statistics(directory.path())["samples"], 24 * 16);

    let words = ["-o", "a.exr", "--noise", "30%", "--samples", "4096", "--stats", "stats.json"];
    let summary = render_small(directory.path(), &words);
    assert!(summary.contains("estimated relative error"), "{summary}");
    let statistics = statistics(directory.path());
    assert!(statistics["noise"].as_f64() <= Some(0.3), "{statistics}");
    assert!(statistics["samples_per_pixel"].as_f64() >= Some(16.0), "{statistics}");
}

#[test]
fn adaptive_sampling_spends_the_average() {
    let directory = empty_directory();
    let words = ["-o", "a.png", "--adaptive", "--samples", "16", "--stats", "stats.json"];
    render_small(directory.path(), &words);
    let spent = statistics(directory.path())["samples_per_pixel"].as_f64().unwrap();
    assert!((spent - 16.0).abs() < 0.5, "{spent}");
}

#[test]
fn layers_go_into_an_exr_only() {
    let directory = empty_directory();
    render_small(directory.path(), &["-o", "a.exr", "--samples", "2", "--layers", "all"]);
    let header = std::fs::read(directory.path().join("a.exr")).unwrap();
    // Names of channels stand in the header, each ended by a zero.
    for name in ["albedo.R", "N.X", "Z", "P.Y", "objectId", "materialId", "samples", "variance.B"] {
        let name = [name.as_bytes(), &[0]].concat();
        assert!(header[..2000].windows(name.len()).any(|window| window == name), "{name:?}");
    }
    assert_fails(&["render", "missing.gsz", "-o", "a.png", "--layers", "depth"], 2, &["--layers", ".exr"]);
}

#[test]
fn the_events_of_a_pixel_are_printed_instead_of_a_picture() {
    let directory = empty_directory();
    let events = render_small(directory.path(), &["--pixel", "12,8,2"]);
    for part in ["pixel 12,8 sample 0", "sample 1", "meets the", "node ", "throughput", "radiance ("] {
        assert!(events.contains(part), "no {part:?} in {events}");
    }
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
    assert_fails(&["render", "missing.gsz", "--size", "24x16", "--pixel", "24,0"], 2, &["24,0", "24x16"]);
}

#[test]
fn the_kernels_are_written() {
    let directory = empty_directory();
    render_small(directory.path(), &["-o", "a.png", "--samples", "1", "--dump-wgsl", "kernels/now"]);
    let kernels = std::fs::read_to_string(directory.path().join("kernels/now/path_tracer.wgsl")).unwrap();
    assert!(kernels.contains("fn render_tile(") && kernels.contains("fn render_layers("));
}

#[test]
fn a_part_of_a_picture_outside_of_it_is_wrong_usage() {
    assert_fails(
        &["render", "missing.gsz", "--size", "20x10", "--crop", "10,5,11,5"],
        2,
        &["--crop 10,5,11,5", "20 x 10"],
    );
}

/// Renders a small Cornell box with options; the pixels of the red channel, row by row, and the width.
fn cornell_red(options: &[&str]) -> (Vec<f32>, usize) {
    let directory = empty_directory();
    let scene = cornell_box();
    let mut words = vec!["render", scene.to_str().unwrap(), "-o", "a.exr", "--quiet"];
    words.extend(SMALL);
    words.extend(options);
    let output = sunshine(directory.path(), &words);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let image = exr::prelude::read_first_rgba_layer_from_file(
        directory.path().join("a.exr"),
        |size, _| (vec![0.0f32; size.area()], size.width()),
        |(pixels, width), at, (r, _, _, _): (f32, f32, f32, f32)| pixels[at.y() * *width + at.x()] = r,
    )
    .unwrap();
    image.layer_data.channel_data.pixels
}

#[test]
fn a_part_of_a_picture_has_the_pixels_of_the_whole() {
    let (whole, _) = cornell_red(&[]);
    let (part, width) = cornell_red(&["--crop", "7,3,11,5"]);
    assert_eq!((part.len(), width), (55, 11));
    for (i, value) in part.iter().enumerate() {
        assert_eq!(*value, whole[(3 + i / 11) * 24 + 7 + i % 11]);
    }
}

#[test]
fn the_saved_view_can_be_overridden() {
    let differ = |a: &[f32], b: &[f32]| a.iter().zip(b).filter(|(a, b)| a != b).count();
    let (saved, _) = cornell_red(&[]);
    for options in [
        &["--camera-position", "2,-5,2"][..],
        &["--camera-target", "1,2,1"],
        &["--camera-up", "1,0,1"],
        &["--fov", "20"],
        &["--parallel", "4"],
        &["--aperture", "0.2"],
        &["--filter", "tent"],
        &["--sampler", "independent"],
    ] {
        let (other, _) = cornell_red(options);
        assert!(differ(&saved, &other) > 200, "{options:?}: {}", differ(&saved, &other));
    }
    // A camera behind the closed back of the box sees nothing of its light.
    let (dark, _) = cornell_red(&["--camera-position", "2.75,20,2.75", "--camera-target", "2.75,5.6,2.75"]);
    assert!(dark.iter().all(|value| *value == 0.0));
}

#[test]
fn a_black_picture_is_explained() {
    let directory = empty_directory();
    // A camera that looks away from a lit sphere.
    std::fs::write(
        directory.path().join("graph.xml"),
        "<graph xmlns:gx=\"http://grogra.de/xmlpersistence\"><node root=\"MainGraph\" id=\"0\" type=\"N\">\
         <node id=\"1\" type=\"de.grogra.turtle.M\" edges=\"+\"><data gx:name=\"length\" gx:value=\"100\"/>\
         <node id=\"2\" type=\"de.grogra.imp3d.objects.Sphere\" edges=\"+\"/></node></node></graph>",
    )
    .unwrap();
    let words = ["render", "graph.xml", "-o", "a.png", "--size", "8x8", "--samples", "1", "--device", "cpu"];
    let output = sunshine(directory.path(), &words);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("the picture is black"), "{}", text(&output.stderr));
}

#[test]
fn the_experiments_of_the_thesis_leave_tables_curves_and_pictures() {
    let directory = empty_directory();
    let output = sunshine(directory.path(), &["bench", "thesis", "--quick", "--device", "cpu", "-o", "out"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let answer = text(&output.stdout);
    for part in ["table 5.2", "841", "146.9", "34.56", "cpu: CPU ("] {
        assert!(answer.contains(part), "no {part:?} in {answer}");
    }
    let out = directory.path().join("out");
    let csv = std::fs::read_to_string(out.join("bush-objects.csv")).unwrap();
    // Five sizes, with and without a hierarchy, and the heads of the columns.
    assert_eq!(csv.lines().count(), 11, "{csv}");
    for file in
        ["thesis.txt", "bush-objects.svg", "bush-rays.svg", "cornell-box-cpu.png", "leaf-shadow-cpu.png"]
    {
        assert!(out.join(file).metadata().unwrap().len() > 100, "{file}");
    }
}

#[test]
fn the_pictures_of_the_thesis_are_made_without_measuring() {
    let directory = empty_directory();
    let words = ["bench", "thesis", "--pictures", "--quick", "--device", "cpu", "-o", "out"];
    let output = sunshine(directory.path(), &words);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for (figure, file) in
        [("5.1a", "cylinder-a.png"), ("5.8", "noise-sobol.png"), ("table 5.2", "bush-841.png")]
    {
        assert!(text(&output.stdout).contains(figure), "{}", text(&output.stdout));
        assert!(directory.path().join("out").join(file).metadata().unwrap().len() > 100, "{file}");
    }
    assert!(!directory.path().join("out").join("thesis.txt").exists());
}
