//! The live view: a window on a scene that is rendered while the camera moves.
//!
//! Three threads: the window ([`window`]), which never waits; one that renders ([`refining`]) what lies on the
//! [`desk`]; one that reads, compiles and opens devices ([`preparing`]). What the window knows is in a [`session`], which
//! needs no window and is tested without one.

mod actions;
mod canvas;
mod changes;
mod command_line;
mod desk;
mod events;
mod messages;
mod named_views;
mod navigation;
mod overlay;
mod panel;
mod preparing;
mod refining;
mod saving;
mod schedule;
mod session;
mod settings;
mod shown;
mod sight_line;
mod style;
mod textures;
mod window;

pub use command_line::{GivenWords, render_words, shell_line};
pub use events::explained;
pub use navigation::Sight;
pub use preparing::{OpenFunction, ReadFunction, ReadScene, RecordFunction};
pub use settings::ViewSettings;
pub use sight_line::{Extent, SightLine};
pub use window::Note;

use changes::{Changes, Fingerprint};
use desk::Desk;
use events::{Event, Report};
use preparing::Preparer;
use refining::Refiner;
use render::{Acceleration, DeviceChoice};
use session::Session;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};
use window::{Shell, Wake};
use winit::event_loop::EventLoop;

/// What is to be seen and how.
pub struct ViewOptions {
    /// The project; it is read again when it changes.
    pub project: PathBuf,
    /// What of the command line goes into the commands that the window shows.
    pub given: GivenWords,
    /// What is set at first.
    pub settings: ViewSettings,
    /// How objects are found along a ray.
    pub acceleration: Acceleration,
    /// File name for pictures at first.
    pub output: String,
    /// Size of the window in points.
    pub window: (f64, f64),
    /// Reads the project.
    pub read: ReadFunction,
    /// Opens devices.
    pub open: OpenFunction,
    /// What saved pictures tell of themselves.
    pub record: RecordFunction,
    /// Hears of what happens in the window.
    pub note: Note,
}

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The system has no desktop, or lacks a library for it.
    #[error(
        "no window can be opened: {reason}. `sunshine view` needs a desktop; `sunshine render` makes pictures without one"
    )]
    NoWindow {
        /// What the system says.
        reason: String,
    },
    /// A thread could not be started.
    #[error("a thread cannot be started: {0}")]
    Thread(#[from] std::io::Error),
}

/// How often the project is looked at.
const LOOK: Duration = Duration::from_millis(400);

/// Opens the window and returns when it is closed and all pictures are saved.
///
/// # Errors
/// If there can be no window.
pub fn run(options: ViewOptions) -> Result<(), ViewError> {
    let no_window = |reason: String| ViewError::NoWindow { reason };
    let events = EventLoop::<Wake>::with_user_event()
        .build()
        .map_err(|error| no_window(reason(&error.to_string())))?;
    let (sender, receiver) = mpsc::channel();
    let proxy = events.create_proxy();
    let report: Report = Arc::new(move |event| {
        // Neither is heard any more when the window is closed.
        let _ = sender.send(event);
        let _ = proxy.send_event(Wake);
    });
    let desk = Arc::new(Desk::default());
    let (errands, errands_of_preparer) = mpsc::channel();

    let ViewOptions { project, given, settings, acceleration, output, window, read, open, record, note } =
        options;
    let watched = project.clone();
    let first_look = Fingerprint::of(&watched);
    let session = Session::new(&project, given, settings, output);

    let preparer =
        Preparer::new(read, Arc::clone(&open), record, acceleration, Arc::clone(&desk), Arc::clone(&report));
    let preparing = thread::Builder::new()
        .name("view-prepare".to_owned())
        .spawn(move || preparer.run(&errands_of_preparer))?;
    let open_processor = Box::new(move || open(DeviceChoice::Cpu));
    let refiner = Refiner::new(Arc::clone(&desk), Arc::clone(&report), open_processor);
    let refining = thread::Builder::new().name("view-refine".to_owned()).spawn(move || refiner.run())?;
    let watched_desk = Arc::clone(&desk);
    let watching = thread::Builder::new().name("view-watch".to_owned()).spawn(move || {
        let start = Instant::now();
        let mut changes = Changes::new(first_look);
        while !watched_desk.is_over() {
            thread::sleep(LOOK);
            if changes.look(start.elapsed(), Fingerprint::of(&watched)) {
                report(Event::ProjectChanged);
            }
        }
    })?;

    let mut shell = Shell::new(session, Arc::clone(&desk), errands, receiver, note, window);
    let result = events.run_app(&mut shell);
    desk.end();
    shell.errands = None;
    let failure = shell.failure.take();
    drop(shell);
    for thread in [refining, preparing, watching] {
        // A panic was told in the terminal.
        let _ = thread.join();
    }
    match (failure, result) {
        (Some(reason), _) => Err(no_window(reason)),
        (None, Err(error)) => Err(no_window(reason(&error.to_string()))),
        (None, Ok(())) => Ok(()),
    }
}

/// What the system says, without the place in the source of the library that it said it to.
fn reason(text: &str) -> String {
    let said = text.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    said.map_or(text, |(_, reason)| reason).trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_for_users() {
        assert_eq!(reason("os error at /src/linux/mod.rs:765: no display is set."), "no display is set");
        assert_eq!(reason("no display"), "no display");
    }
}
