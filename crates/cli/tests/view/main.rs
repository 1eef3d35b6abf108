//! `sunshine view` as its users see it, in a virtual X server and on the software graphics card.
//!
//! Needs Xvfb (Debian: `xvfb`, and `libxkbcommon-x11-0` for the keyboard) and skips without; with `SUNSHINE_REQUIRE_X=1`
//! it fails instead. `SUNSHINE_SCREENSHOT=picture.png` keeps what was on the screen, more samples of it, for
//! `docs/view`.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod x_server;

use scene::DVec3;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use x_server::XServer;

const SCREEN: (u16, u16) = (1180, 760);
/// Width of the panel at the right, in pixels.
const PANEL: f64 = 312.0;
/// Keys as X calls them.
const KEY_C: u32 = 0x63;
const KEY_S: u32 = 0x73;
const KEY_Z: u32 = 0x7a;
const KEY_1: u32 = 0x31;
const KEY_BRACKET_RIGHT: u32 = 0x5d;
const KEY_HOME: u32 = 0xff50;

/// The program with what it says.
struct Program {
    process: Child,
    lines: Receiver<String>,
}

impl Program {
    fn start(server: &XServer, directory: &Path, words: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_sunshine"))
            .args(words)
            .current_dir(directory)
            .env("DISPLAY", &server.display)
            .env_remove("WAYLAND_DISPLAY")
            .env("WINIT_X11_SCALE_FACTOR", "1")
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let errors = BufReader::new(process.stderr.take().unwrap());
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in errors.lines().map_while(Result::ok) {
                eprintln!("| {line}");
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Program { process, lines }
    }

    /// Waits until it says something that holds all the parts.
    fn wait_for(&self, parts: &[&str]) -> String {
        // Compiling the kernels for the software card takes long; only a hang fails here.
        let end = Instant::now() + Duration::from_secs(420);
        while let Ok(line) = self.lines.recv_timeout(end.saturating_duration_since(Instant::now())) {
            if parts.iter().all(|part| line.contains(part)) {
                return line;
            }
        }
        panic!("the program never said {parts:?}");
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // It has ended if all went well.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The words of a command without quotes.
fn words(line: &str) -> Vec<&str> {
    line.split_once("command: ").unwrap().1.split(' ').collect()
}

fn point(words: &[&str], option: &str) -> DVec3 {
    let place =
        words.iter().position(|word| *word == option).unwrap_or_else(|| panic!("no {option} in {words:?}"));
    let numbers: Vec<f64> = words[place + 1].split(',').map(|number| number.parse().unwrap()).collect();
    DVec3::new(numbers[0], numbers[1], numbers[2])
}

fn copy_scene(to: &Path) -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/cornell-box");
    let project = to.join("cornell-box");
    std::fs::create_dir(&project).unwrap();
    for file in ["project.gs", "graph.xml"] {
        std::fs::copy(from.join(file), project.join(file)).unwrap();
    }
    project
}

/// The pixels of a PNG.
fn pixels(path: &Path) -> (u32, u32, Vec<u8>) {
    let mut reader =
        png::Decoder::new(BufReader::new(std::fs::File::open(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    (info.width, info.height, bytes)
}

/// Mean difference of two screens in the part where the picture is, from 0 to 255.
fn difference(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    let width = usize::from(SCREEN.0);
    let picture = width - PANEL as usize;
    let in_picture = a.iter().zip(b).enumerate().filter(|(index, _)| index % width < picture);
    let sum: u64 =
        in_picture.map(|(_, (a, b))| (0..3).map(|c| u64::from(a[c].abs_diff(b[c]))).sum::<u64>()).sum();
    sum as f64 / (3 * picture * usize::from(SCREEN.1)) as f64
}

#[test]
fn a_session_at_the_window() {
    let Some(server) = XServer::start(SCREEN) else {
        assert!(
            std::env::var_os("SUNSHINE_REQUIRE_X").is_none(),
            "SUNSHINE_REQUIRE_X is set, but Xvfb is missing"
        );
        return println!("skipped: Xvfb is not installed (Debian: apt-get install xvfb libxkbcommon-x11-0)");
    };
    let directory = tempfile::tempdir().unwrap();
    let project = copy_scene(directory.path());
    // Whoever keeps the picture looks at it, and it has to be clean.
    let kept = std::env::var_os("SUNSHINE_SCREENSHOT").map(PathBuf::from);
    let (device, samples) = match (&kept, render::list_gpus().is_empty()) {
        (Some(_), _) => ("cpu", "48"),
        (None, true) => ("cpu", "8"),
        (None, false) => ("gpu:0", "8"),
    };
    let complete = format!("complete: {samples} samples");
    let window_size = format!("{}x{}", SCREEN.0, SCREEN.1);
    let mut program = Program::start(
        &server,
        directory.path(),
        &[
            &["view", "cornell-box", "--window", &window_size, "--size", "140x120", "--exposure", "0.5"][..],
            &["--samples", samples, "--device", device],
        ]
        .concat(),
    );
    let (window, _) = server.window();
    program.wait_for(&["read 8 objects"]);
    program.wait_for(&["renders on"]);
    program.wait_for(&[&complete]);
    std::thread::sleep(Duration::from_millis(500));
    let before = server.screenshot();

    // The picture keeps its shape within the window.
    let area = (f64::from(SCREEN.0) - PANEL, f64::from(SCREEN.1));
    let width = area.0.min(area.1 * 140.0 / 120.0);
    let height = width * 120.0 / 140.0;
    let middle = ((area.0 / 2.0) as i16, (area.1 / 2.0) as i16);

    // Turn round the box.
    server.drag(middle, (-36, 12));
    program.wait_for(&[&complete]);
    std::thread::sleep(Duration::from_millis(500));
    assert!(difference(&before, &server.screenshot()) > 3.0, "the picture did not move");

    // The tall box stands where the camera of the command line sees it.
    server.press(KEY_C, true);
    let line = program.wait_for(&["command: sunshine render cornell-box"]);
    let command = words(&line);
    let camera = scene::Camera::look_at(
        point(&command, "--camera-position"),
        point(&command, "--camera-target"),
        DVec3::Z,
        1.0,
    );
    let seen = camera.view_from_world.transform_point3(DVec3::new(1.85, 3.5, 2.4));
    let fov = command[command.iter().position(|word| *word == "--fov").unwrap() + 1].parse::<f64>().unwrap();
    let scale = 0.5 * width / (0.5 * fov.to_radians()).tan();
    let at = (area.0 / 2.0 - seen.x / seen.z * scale, area.1 / 2.0 + seen.y / seen.z * scale);
    assert!(at.0 > 0.0 && at.0 < width && at.1 > 0.0 && at.1 < height, "{at:?}");
    server.click((at.0 as i16, at.1 as i16));
    program.wait_for(&["picked", "Box node 16", "RGBA"]);

    // One more bounce of light, a named view, a picture.
    server.press(KEY_BRACKET_RIGHT, false);
    program.wait_for(&["depth 6"]);
    server.press(KEY_1, true);
    program.wait_for(&["this is view 1 now"]);
    assert!(directory.path().join("cornell-box.views.json").exists());
    server.press(KEY_S, true);
    let line = program.wait_for(&["command: sunshine render", "--depth 6"]);
    program.wait_for(&["saved cornell-box.png"]);
    let saved = directory.path().join("cornell-box.png");
    let mut command = words(&line);
    assert_eq!(command.pop(), Some("cornell-box.png"));
    let again = Command::new(env!("CARGO_BIN_EXE_sunshine"))
        .args(&command[1..])
        .arg("again.png")
        .current_dir(directory.path())
        .output()
        .unwrap();
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    let again = directory.path().join("again.png");
    let (saved_pixels, pixels_again) = (pixels(&saved), pixels(&again));
    assert_eq!((saved_pixels.0, saved_pixels.1), (140, 120));
    assert!(saved_pixels == pixels_again, "the saved picture is not that of the command line");
    // With what it tells of itself.
    let record = |path: &Path| render::read_record(path).unwrap();
    assert_eq!(record(&saved), record(&again));
    assert!(std::fs::read(&saved).unwrap() == std::fs::read(&again).unwrap());

    program.wait_for(&[&complete]);
    std::thread::sleep(Duration::from_millis(1000));
    server.write_screenshot(&kept.unwrap_or(directory.path().join("screen.png")));

    // Back to the project's camera and to the view.
    server.press(KEY_HOME, false);
    server.press(KEY_C, true);
    let line = program.wait_for(&["command: sunshine render"]);
    assert!(!line.contains("--camera-position"), "{line}");
    server.press(KEY_Z, true);
    server.press(KEY_C, true);
    let line = program.wait_for(&["command: sunshine render"]);
    assert_eq!(point(&words(&line), "--camera-position"), point(&command, "--camera-position"));
    server.press(KEY_HOME, false);
    server.press(KEY_1, false);
    program.wait_for(&["view 1"]);
    server.press(KEY_C, true);
    let line = program.wait_for(&["command: sunshine render"]);
    assert_eq!(point(&words(&line), "--camera-position"), point(&command, "--camera-position"));

    // Half a project leaves the picture alone; a whole one is shown with the camera where it was.
    let graph = project.join("graph.xml");
    let whole = std::fs::read_to_string(&graph).unwrap();
    std::fs::write(&graph, &whole[..whole.len() / 2]).unwrap();
    program.wait_for(&["error: the scene cannot be read; the picture is that of the last good one"]);
    std::fs::write(&graph, whole.replace("0.14 0.45 0.09 1.0", "0.1 0.2 0.7 1.0")).unwrap();
    program.wait_for(&["the scene was read again"]);
    program.wait_for(&[&complete]);
    server.press(KEY_C, true);
    let line = program.wait_for(&["command: sunshine render"]);
    assert_eq!(point(&words(&line), "--camera-position"), point(&command, "--camera-position"));

    server.close(window);
    assert!(program.process.wait().unwrap().success());
}

#[test]
fn without_a_desktop_there_is_an_explanation_and_pictures_are_made_all_the_same() {
    let directory = tempfile::tempdir().unwrap();
    copy_scene(directory.path());
    let run = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sunshine"));
        for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            command.env_remove(variable);
        }
        command.args(words).current_dir(directory.path()).output().unwrap()
    };
    let window = run(&["view", "cornell-box"]);
    let message = String::from_utf8_lossy(&window.stderr);
    assert_eq!(window.status.code(), Some(1));
    assert!(message.contains("no window can be opened") && message.contains("sunshine render"), "{message}");
    assert!(!message.contains(".rs"), "{message}");
    let picture = run(&["render", "cornell-box", "--size", "8x6", "--samples", "1", "--device", "cpu"]);
    assert!(picture.status.success());
}
