//! From a scene description to a picture.
//!
//! [`compile`] flattens a [`scene::Scene`] into the records of the kernels and builds the bounding volume
//! hierarchy; a [`Device`] renders the [`CompiledScene`] into a [`Film`]. The two devices, [`cpu`] and [`gpu`],
//! run the same kernels.

mod compile;
pub mod cpu;
mod device;
mod film;
pub mod gpu;
mod open;
mod picture;
mod renderer;
mod sampling;

pub use compile::{Acceleration, CompileError, CompiledScene, compile, compile_with};
pub use device::{ControlFlow, Device, DeviceError, LoadedScene, Progress, RenderSettings};
pub use film::{Film, automatic_exposure};
pub use gpu::{GpuInfo, list_gpus};
pub use open::{DeviceChoice, automatic_gpu, open_device, open_device_for};
pub use picture::{PictureError, PictureFormat, check_writable, write_picture, write_whole_file};
pub use renderer::Renderer;
pub use sampling::{CropWindow, Filter, Sampler};
