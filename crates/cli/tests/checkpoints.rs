//! Renderings that are stopped, killed, continued and shared out.

// In tests a panic is the failure report; the exception for tests does not reach helper functions.
#![allow(clippy::unwrap_used)]

use render::FilmFile;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

fn scene(name: &str) -> String {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    scenes.join(name).canonicalize().unwrap().to_str().unwrap().to_owned()
}

fn command(directory: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sunshine"));
    command.args(words).current_dir(directory).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn sunshine(directory: &Path, words: &[&str]) -> Output {
    command(directory, words).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

fn succeeds(directory: &Path, words: &[&str]) -> String {
    let output = sunshine(directory, words);
    assert_eq!(output.status.code(), Some(0), "{words:?}: {}", text(&output.stderr));
    text(&output.stdout).to_owned()
}

/// Asserts the exit code and that all `parts` are in the error message.
fn fails(directory: &Path, words: &[&str], code: i32, parts: &[&str]) {
    let output = sunshine(directory, words);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{words:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{words:?}: no {part:?} in {message}");
    }
}

fn render<'a>(scene: &'a str, words: &[&'a str]) -> Vec<&'a str> {
    let mut all = vec!["render", scene, "--device", "cpu", "--threads", "2"];
    if !words.contains(&"--size") {
        all.extend(["--size", "16x12"]);
    }
    all.extend(words);
    all
}

fn names(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn film(directory: &Path, name: &str) -> FilmFile {
    FilmFile::read(&directory.join(name)).unwrap()
}

fn bytes(directory: &Path, name: &str) -> Vec<u8> {
    std::fs::read(directory.join(name)).unwrap()
}

#[test]
fn shares_in_any_order_are_the_picture_of_one_run_byte_for_byte() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let scene = scene("cornell-box");
    for share in ["64..192", "0..64", "192..200"] {
        let name = format!("part-{share}.film");
        let words = ["--samples", "200", "--sample-range", share, "--checkpoint", &name];
        succeeds(at, &render(&scene, &words));
    }
    assert_eq!(names(at), ["part-0..64.film", "part-192..200.film", "part-64..192.film"]);
    for picture in ["whole.png", "whole.exr"] {
        succeeds(at, &render(&scene, &["--samples", "200", "-o", picture]));
        let merged = picture.replace("whole", "merged");
        let films = ["part-192..200.film", "part-64..192.film", "part-0..64.film"];
        let mut words = vec!["merge", "-o", &merged];
        words.extend(films);
        let summary = succeeds(at, &words);
        assert!(summary.contains("200 samples per pixel"), "{summary}");
        assert!(bytes(at, picture) == bytes(at, &merged), "{picture}");
    }
    // Joined step by step, then the picture by the renderer, which can make layers, too.
    succeeds(at, &["merge", "part-0..64.film", "part-192..200.film", "-o", "some.film"]);
    let summary = succeeds(at, &["merge", "part-64..192.film", "some.film", "-o", "all.film"]);
    assert!(summary.contains("complete"), "{summary}");
    succeeds(at, &render(&scene, &["--samples", "200", "--resume", "all.film", "-o", "resumed.exr"]));
    assert!(bytes(at, "whole.exr") == bytes(at, "resumed.exr"));

    // What is wrong with films is said.
    fails(at, &["merge", "some.film", "-o", "a.png"], 1, &["64..192 are missing", "--unfinished"]);
    succeeds(at, &["merge", "some.film", "--unfinished", "-o", "a.png"]);
    fails(at, &["merge", "some.film", "part-0..64.film", "-o", "a.png"], 1, &["part-0..64.film", "0 to 64"]);
    let other =
        ["--samples", "200", "--sample-range", "64..192", "--depth", "3", "--checkpoint", "other.film"];
    succeeds(at, &render(&scene, &other));
    fails(
        at,
        &["merge", "some.film", "other.film", "-o", "a.png"],
        1,
        &["other.film", "--depth 3", "--depth 5"],
    );
    fails(at, &["merge", "a.png", "-o", "b.png"], 1, &["a.png", "no film"]);
}

#[test]
fn pictures_and_films_tell_how_they_were_made() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let scene = scene("cornell-box");
    let words = ["--samples", "2", "--fov", "40", "--checkpoint", "a.film", "-o", "a.png"];
    succeeds(at, &render(&scene, &words));
    for file in ["a.png", "a.film"] {
        let shown = succeeds(at, &["show", file]);
        for part in [
            "scene: cornell-box",
            "device: CPU",
            "--size 16x12",
            "--fov 40",
            "samples per pixel: 2",
            "version: ",
        ] {
            assert!(shown.contains(part), "{file}: no {part:?} in {shown}");
        }
    }
    fails(at, &["show", &scene], 1, &["neither"]);
    fails(at, &["show", "nothing.png"], 1, &["nothing.png", "because: "]);
}

#[test]
fn what_does_not_fit_together_is_explained() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let cornell = scene("cornell-box");
    let save = render(&cornell, &["--samples", "2", "--checkpoint", "a.film", "-o", "a.png"]);
    succeeds(at, &save);
    // Work that is done is not written over by mistake.
    fails(at, &save, 2, &["a.film exists already", "--resume a.film"]);
    let go_on = |words: &[&str], code, parts: &[&str]| {
        let mut all = render(&cornell, &["--resume", "a.film", "-o", "a.png"]);
        all.extend(words);
        fails(at, &all, code, parts);
    };
    go_on(&["--samples", "4"], 1, &["not of this picture", "--samples 2", "--samples 4"]);
    go_on(&["--samples", "2", "--seed", "1"], 1, &["--seed 0", "--seed 1"]);
    go_on(&["--samples", "2", "--srgb-textures"], 1, &["--srgb-textures"]);
    go_on(&["--samples", "2", "--adaptive"], 1, &["made with no --adaptive, now there is --adaptive"]);
    let other = scene("first-plant");
    fails(
        at,
        &render(&other, &["--samples", "2", "--resume", "a.film", "-o", "b.png"]),
        1,
        &["another scene (cornell-box)", "project has changed"],
    );
    fails(at, &render(&cornell, &["--resume", "none.film"]), 1, &["there is no film none.film"]);
    // A copy that is cut off, and something else.
    let film = bytes(at, "a.film");
    std::fs::write(at.join("cut.film"), &film[..film.len() / 2]).unwrap();
    fails(at, &render(&cornell, &["--samples", "2", "--resume", "cut.film"]), 1, &["cut off or damaged"]);
    fails(at, &render(&cornell, &["--samples", "2", "--resume", "a.png", "-o", "b.png"]), 1, &["no film"]);
    let share = |range: &'static str, parts: &[&str]| {
        let words = ["--samples", "200", "--sample-range", range, "--checkpoint", "s.film"];
        fails(at, &render(&cornell, &words), 2, parts);
    };
    share("0..32", &["multiples of 64"]);
    share("64..300", &["beyond the 200 samples"]);
    share("64..64", &["greater"]);
    fails(at, &render(&cornell, &["--sample-range", "0..64"]), 2, &["--checkpoint"]);
}

#[test]
fn a_film_that_is_missing_is_begun_and_one_that_is_complete_is_only_shown() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let scene = scene("cornell-box");
    let words = ["--samples", "3", "--checkpoint", "a.film", "--resume", "a.film", "-o", "a.png"];
    succeeds(at, &render(&scene, &words));
    let picture = bytes(at, "a.png");
    std::fs::remove_file(at.join("a.png")).unwrap();
    let again = sunshine(at, &render(&scene, &words));
    assert!(text(&again.stderr).contains("continuing a.film after 3 samples"), "{}", text(&again.stderr));
    assert!(bytes(at, "a.png") == picture);
}

#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").arg(name).arg(child.id().to_string()).status().unwrap();
    assert!(status.success());
}

/// Waits until a file is there.
fn wait_for(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(300), "no {}", path.display());
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[cfg(unix)]
#[test]
fn the_first_signal_keeps_everything() {
    for (name, code) in [("-INT", 130), ("-TERM", 143)] {
        let directory = tempfile::tempdir().unwrap();
        let at = directory.path();
        let scene = scene("cornell-box");
        // Minutes of work.
        let words =
            ["--samples", "1000000", "--checkpoint", "a.film", "--checkpoint-every", "0.01s", "-o", "a.png"];
        let child = command(at, &render(&scene, &words)).spawn().unwrap();
        wait_for(&at.join("a.film"));
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        let summary = text(&output.stdout);
        assert!(
            summary.contains("of 1000000 samples per pixel; the same command with --resume a.film"),
            "{summary}"
        );
        assert_eq!(names(at), ["a.film", "a.png"]);
        let film = film(at, "a.film");
        assert!(film.sums.samples() > 0 && film.sums.samples() < 1_000_000);
        // The picture is that of the film.
        succeeds(at, &["merge", "a.film", "--unfinished", "-o", "b.png"]);
        assert!(bytes(at, "a.png") == bytes(at, "b.png"));
    }
}

#[cfg(unix)]
#[test]
fn the_second_signal_stops_at_once() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let scene = scene("first-plant");
    // A pass over so many pixels takes seconds.
    let words = ["--size", "2000x2000", "--samples", "64", "-o", "a.png", "--log-file", "log"];
    let mut child = command(at, &render(&scene, &words)).spawn().unwrap();
    while !std::fs::read_to_string(at.join("log")).is_ok_and(|log| log.contains("is ready")) {
        std::thread::sleep(Duration::from_millis(5));
    }
    // Signals are listened to a moment after that is said.
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-INT");
    std::thread::sleep(Duration::from_millis(50));
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(names(at), ["log"]);
}

/// Stopped and gone on with again and again, as far as there is time for: on slow machines a run comes to its end before
/// it is stopped.
#[cfg(unix)]
#[test]
fn an_adaptive_picture_that_is_stopped_is_that_of_one_run_byte_for_byte() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let scene = scene("cornell-box");
    let words = ["--size", "48x36", "--samples", "256", "--adaptive"];
    let picture = |more: &[&'static str]| render(&scene, &[&words[..], more].concat());
    succeeds(at, &picture(&["-o", "whole.exr", "--layers", "samples,variance"]));
    let saved =
        ["-o", "a.exr", "--layers", "samples,variance", "--checkpoint", "a.film", "--resume", "a.film"];
    let saved = picture(&[&saved[..], &["--checkpoint-every", "0.001s"]].concat());
    let mut stops = 0;
    loop {
        let _ = std::fs::remove_file(at.join("a.exr"));
        let mut child = command(at, &saved).spawn().unwrap();
        let before = std::fs::metadata(at.join("a.film")).and_then(|file| file.modified()).ok();
        // Until something was added.
        while child.try_wait().unwrap().is_none()
            && std::fs::metadata(at.join("a.film")).and_then(|file| file.modified()).ok() == before
        {
            std::thread::sleep(Duration::from_millis(1));
        }
        // Every second time without a warning.
        if stops % 2 == 0 {
            signal(&child, "-INT");
        } else {
            child.kill().unwrap();
        }
        let output = child.wait_with_output().unwrap();
        match output.status.code() {
            Some(0) => break,
            Some(130) => {
                let shown = succeeds(at, &["show", "a.film"]);
                assert!(shown.contains("--adaptive") && shown.contains("samples on average"), "{shown}");
                assert!(at.join("a.exr").exists(), "the picture so far");
            }
            Some(code) => panic!("{code}: {}", text(&output.stderr)),
            None => {}
        }
        stops += 1;
        if stops == 20 {
            succeeds(at, &saved);
            break;
        }
    }
    println!("{stops} stops");
    assert!(bytes(at, "a.exr") == bytes(at, "whole.exr"));
    // Only going on with it is possible.
    fails(at, &["merge", "a.film", "-o", "b.png"], 1, &["a.film", "made with --adaptive"]);
    let other = picture(&["--seed", "1", "--resume", "a.film", "-o", "b.png"]);
    fails(at, &other, 1, &["--seed 0", "--seed 1"]);
    let even = render(&scene, &["--size", "48x36", "--samples", "256", "--resume", "a.film", "-o", "b.png"]);
    fails(at, &even, 1, &["made with --adaptive, now there is no --adaptive"]);
}

/// Numbers that look random, the same ones every time (Marsaglia 2003).
struct Random(u64);

impl Random {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % bound
    }
}

/// Kills a rendering at random moments, continues it, kills it again, and when it is complete begins a new one. After
/// each kill the films and pictures must be whole.
fn kill_at_random(kills: u32, seed: u64) {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let scene = scene("cornell-box");
    let options = ["--size", "48x36", "--samples", "320", "--quiet"];
    let mut reference = render(&scene, &options);
    reference.extend([
        "-o",
        "reference.png",
        "--checkpoint",
        "reference.film",
        "--checkpoint-every",
        "0.001s",
    ]);
    let start = Instant::now();
    succeeds(at, &reference);
    let mut duration = start.elapsed();
    let expected = (bytes(at, "reference.png"), bytes(at, "reference.film"));
    std::fs::remove_file(at.join("reference.png")).unwrap();
    std::fs::remove_file(at.join("reference.film")).unwrap();

    let mut words = render(&scene, &options);
    words.extend([
        "-o",
        "a.png",
        "--checkpoint",
        "a.film",
        "--resume",
        "a.film",
        "--checkpoint-every",
        "0.001s",
    ]);
    let mut random = Random(seed);
    let (mut killed, mut complete, mut with_film, mut abandoned, mut samples) = (0, 0, 0, 0, 0);
    while killed < kills || (with_film == 0 && killed < 10 * kills) {
        let begun = Instant::now();
        let is_new = !at.join("a.film").exists();
        let mut child = command(at, &words).spawn().unwrap();
        let moment = Duration::from_micros(random.below(duration.as_micros() as u64 * 5 / 4));
        while begun.elapsed() < moment && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_micros(500));
        }
        // SIGKILL; it may be over already.
        child.kill().unwrap();
        let status = child.wait().unwrap();
        if status.success() && is_new {
            // So that most moments lie within a run, however busy the machine was at first.
            duration = duration.min(begun.elapsed());
        } else if !status.success() && with_film == 0 {
            // And so that some run gets as far as a film, however busy it is now.
            duration += duration / 4;
        }
        let left = names(at);
        abandoned += left.iter().filter(|name| name.ends_with(".part")).count();
        if left.contains(&"a.film".to_owned()) {
            let film = film(at, "a.film");
            // Never back behind what was saved.
            assert!(film.sums.samples() >= samples, "{} after {samples}", film.sums.samples());
            samples = film.sums.samples();
            with_film += 1;
        }
        if left.contains(&"a.png".to_owned()) {
            assert!(bytes(at, "a.png") == expected.0, "a picture that is not whole");
        }
        if status.success() {
            assert!(bytes(at, "a.film") == expected.1 && left.contains(&"a.png".to_owned()));
            complete += 1;
            samples = 0;
            std::fs::remove_file(at.join("a.film")).unwrap();
            std::fs::remove_file(at.join("a.png")).unwrap();
        } else {
            killed += 1;
        }
    }
    succeeds(at, &words);
    assert!(bytes(at, "a.png") == expected.0 && bytes(at, "a.film") == expected.1);
    // What the kills left is removed by the next run.
    assert_eq!(names(at), ["a.film", "a.png"]);
    println!(
        "{killed} kills, {complete} runs complete, {with_film} times a film, {abandoned} abandoned files seen"
    );
    assert!(with_film > 0);
}

#[test]
fn a_kill_at_any_moment_leaves_whole_files() {
    kill_at_random(10, 0x5eed);
}

/// The same for long.
#[test]
#[ignore = "takes minutes"]
fn two_hundred_kills_leave_whole_files() {
    kill_at_random(200, 0x0bad_5eed);
}
