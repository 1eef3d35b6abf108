//! What the threads of the view tell its window.

use crate::canvas::Image;
use render::CompiledScene;
use scene::Scene;
use std::path::PathBuf;
use std::sync::Arc;

/// Something that happened.
pub enum Event {
    /// There is something new to show.
    Frame(Box<Frame>),
    /// The scene was read, for the first time or again, and compiled.
    SceneRead(SceneNews),
    /// The project was saved again.
    ProjectChanged,
    /// The project was saved again, but nothing of the scene is different.
    NothingNew,
    /// The scene could not be read or compiled; why.
    SceneFailed(String),
    /// A device has begun to render.
    DeviceReady {
        /// What users know it by.
        name: String,
        /// Whether it only stands in until the chosen one is ready.
        stands_in: bool,
    },
    /// A device could not be opened, or failed; why. The processor goes on.
    DeviceFailed(String),
    /// The graphics cards of this machine, in the order of their numbers.
    Gpus(Vec<String>),
    /// Something that was asked for is not possible.
    Refused(String),
    /// A picture is being saved.
    Saving {
        /// The file.
        path: PathBuf,
        /// How much of it is done, from 0 to 1.
        share: f32,
    },
    /// A picture was saved.
    Saved {
        /// The file.
        path: PathBuf,
        /// How long it took.
        seconds: f64,
    },
    /// A picture could not be saved; why.
    SaveFailed {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        reason: String,
    },
}

/// A scene that was read.
pub struct SceneNews {
    /// As it was read, the sun where the user put it.
    pub scene: Arc<Scene>,
    /// As it is rendered.
    pub compiled: Arc<CompiledScene>,
    /// What the reader left out or was unsure of.
    pub warnings: Vec<String>,
    /// Layers of GroIMP that are drawn, layer n as bit n.
    pub visible_layers: u16,
    /// Whether the project had changed.
    pub is_reread: bool,
    /// How long reading and compiling took, in seconds.
    pub seconds: f64,
}

/// A picture at some stage.
#[derive(Clone, Debug)]
pub struct Frame {
    /// What is to be seen.
    pub image: Image,
    /// Whether it is as sharp as the window; a coarser one stands in while the camera moves.
    pub is_sharp: bool,
    /// Whether nothing more will come.
    pub is_done: bool,
    /// Samples per pixel.
    pub samples: u32,
    /// Samples per pixel in the end.
    pub most_samples: u32,
    /// Time that this picture took so far.
    pub seconds: f64,
    /// Rays per second, shadow rays included; 0 for layers.
    pub rays_per_second: f64,
    /// Estimated relative error, once there is one.
    pub noise: Option<f64>,
    /// Brightness in stops with which it is shown.
    pub exposure: f32,
}

/// Hears of events, from any thread.
pub type Report = Arc<dyn Fn(Event) + Send + Sync>;

/// An error and its causes, in one line.
pub fn explained(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut told = text.clone();
    let mut cause = error.source();
    while let Some(error) = cause {
        let message = error.to_string();
        // Some errors quote their cause.
        if !told.contains(&message) {
            text.push_str(&format!(": {message}"));
        }
        told = message;
        cause = error.source();
    }
    text
}
