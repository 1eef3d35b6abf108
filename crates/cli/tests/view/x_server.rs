//! A virtual X server and a user at it: mouse, keys and eyes.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ClientMessageEvent, ConnectionExt, EventMask, ImageFormat,
    InputFocus, KEY_PRESS_EVENT, KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT, Window,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// Xvfb with a connection to it.
pub struct XServer {
    process: Child,
    /// Its name, such as `:99`.
    pub display: String,
    connection: RustConnection,
    root: Window,
    size: (u16, u16),
}

impl XServer {
    /// Starts a server; `None` if Xvfb is not installed.
    pub fn start(size: (u16, u16)) -> Option<Self> {
        let screen = format!("{}x{}x24", size.0, size.1);
        let started = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &screen, "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut process = started.ok()?;
        let mut number = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let display = format!(":{}", number.trim());
        let (connection, screen) = RustConnection::connect(Some(&display)).unwrap();
        let root = connection.setup().roots[screen].root;
        Some(XServer { process, display, connection, root, size })
    }

    /// The first window that opens; gives it the keyboard and returns it with its place on the screen.
    pub fn window(&self) -> (Window, (i16, i16)) {
        for _ in 0..600 {
            for window in self.connection.query_tree(self.root).unwrap().reply().unwrap().children {
                let geometry = self.connection.get_geometry(window).unwrap().reply();
                let Ok(geometry) = geometry else { continue };
                // Others are helpers that nobody sees.
                if geometry.width > 200 {
                    sleep(Duration::from_millis(300));
                    self.connection.set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME).unwrap();
                    self.connection.flush().unwrap();
                    return (window, (geometry.x, geometry.y));
                }
            }
            sleep(Duration::from_millis(100));
        }
        panic!("no window within a minute");
    }

    fn input(&self, kind: u8, detail: u8, (x, y): (i16, i16)) {
        let time = x11rb::CURRENT_TIME;
        self.connection.xtest_fake_input(kind, detail, time, self.root, x, y, 0).unwrap().check().unwrap();
        sleep(Duration::from_millis(15));
    }

    /// Moves the mouse to a point of the screen.
    pub fn move_to(&self, at: (i16, i16)) {
        self.input(MOTION_NOTIFY_EVENT, 0, at);
    }

    /// Clicks with the left button.
    pub fn click(&self, at: (i16, i16)) {
        self.move_to(at);
        sleep(Duration::from_millis(100));
        self.input(BUTTON_PRESS_EVENT, 1, (0, 0));
        self.input(BUTTON_RELEASE_EVENT, 1, (0, 0));
    }

    /// Drags with the left button, slowly enough to be seen.
    pub fn drag(&self, from: (i16, i16), by: (i16, i16)) {
        const STEPS: i16 = 12;
        self.move_to(from);
        self.input(BUTTON_PRESS_EVENT, 1, (0, 0));
        for step in 1..=STEPS {
            self.move_to((from.0 + by.0 * step / STEPS, from.1 + by.1 * step / STEPS));
        }
        self.input(BUTTON_RELEASE_EVENT, 1, (0, 0));
    }

    /// Presses a key, given by its X keysym, together with Ctrl or not.
    pub fn press(&self, keysym: u32, with_control: bool) {
        const CONTROL: u32 = 0xffe3;
        let key = self.keycode(keysym);
        let control = self.keycode(CONTROL);
        if with_control {
            self.input(KEY_PRESS_EVENT, control, (0, 0));
        }
        self.input(KEY_PRESS_EVENT, key, (0, 0));
        self.input(KEY_RELEASE_EVENT, key, (0, 0));
        if with_control {
            self.input(KEY_RELEASE_EVENT, control, (0, 0));
        }
    }

    fn keycode(&self, keysym: u32) -> u8 {
        let setup = self.connection.setup();
        let (first, count) = (setup.min_keycode, setup.max_keycode - setup.min_keycode + 1);
        let mapping = self.connection.get_keyboard_mapping(first, count).unwrap().reply().unwrap();
        let per_key = usize::from(mapping.keysyms_per_keycode);
        let place = mapping.keysyms.chunks(per_key).position(|key| key.contains(&keysym)).unwrap();
        first + u8::try_from(place).unwrap()
    }

    /// Asks a window to close, as window managers do.
    pub fn close(&self, window: Window) {
        let atom =
            |name: &str| self.connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom;
        let data = [atom("WM_DELETE_WINDOW"), x11rb::CURRENT_TIME, 0, 0, 0];
        let event = ClientMessageEvent::new(32, window, atom("WM_PROTOCOLS"), data);
        self.connection.send_event(false, window, EventMask::NO_EVENT, event).unwrap();
        self.connection.flush().unwrap();
    }

    /// What is on the screen: red, green and blue of every pixel.
    pub fn screenshot(&self) -> Vec<[u8; 3]> {
        let (width, height) = self.size;
        let image =
            self.connection.get_image(ImageFormat::Z_PIXMAP, self.root, 0, 0, width, height, !0).unwrap();
        let data = image.reply().unwrap().data;
        data.as_chunks::<4>().0.iter().map(|[b, g, r, _]| [*r, *g, *b]).collect()
    }

    /// Writes what is on the screen.
    pub fn write_screenshot(&self, path: &Path) {
        let file = std::fs::File::create(path).unwrap();
        let mut encoder = png::Encoder::new(file, self.size.0.into(), self.size.1.into());
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        let bytes = self.screenshot().concat();
        encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
    }
}

impl Drop for XServer {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
