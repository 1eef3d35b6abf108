//! Rendering a scene of the thesis and taking the time.

use render::{
    Acceleration, CompileError, ControlFlow, Device, DeviceError, Film, RenderSettings, compile_with,
};
use scene::Scene;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The machine that is measured.
pub struct Machine {
    /// What it is called, for titles and file names.
    pub name: String,
    /// Its devices, each with a short name such as `cpu` or `gpu`.
    pub devices: Vec<(String, Box<dyn Device>)>,
}

/// How large the pictures are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// As in the thesis.
    Full,
    /// An eighth of the width and height, to see whether everything works.
    Quick,
}

impl Scale {
    pub(crate) fn of(self, pixels: u32) -> u32 {
        match self {
            Scale::Full => pixels,
            Scale::Quick => (pixels / 8).max(1),
        }
    }
}

/// Why an experiment failed.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// A scene could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A device failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
}

/// A picture and how long it took.
pub(crate) struct Timed {
    pub film: Film,
    /// Time of the rendering, without reading, compiling and starting, in seconds.
    pub seconds: f64,
}

/// A measurement that took less is repeated, and the shortest of three counts.
const SHORT: Duration = Duration::from_secs(2);
const REPETITIONS: usize = 3;

/// Renders a scene. A first run with one sample, which drivers use to finish compiling, is not counted.
pub(crate) fn render_timed(
    device: &dyn Device,
    scene: &Scene,
    settings: &RenderSettings,
    acceleration: Acceleration,
) -> Result<Timed, ExperimentError> {
    let loaded = device.load(Arc::new(compile_with(scene, acceleration)?))?;
    let go_on = |_| ControlFlow::Continue(());
    loaded.render(&RenderSettings { samples: 1, ..settings.clone() }, &go_on)?;
    let mut shortest: Option<Timed> = None;
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        let film = loaded.render(settings, &go_on)?;
        let elapsed = start.elapsed();
        if shortest.as_ref().is_none_or(|known| elapsed.as_secs_f64() < known.seconds) {
            shortest = Some(Timed { film, seconds: elapsed.as_secs_f64() });
        }
        if elapsed > SHORT {
            break;
        }
    }
    // The loop runs at least once.
    shortest.ok_or(ExperimentError::Device(DeviceError::Cancelled))
}
