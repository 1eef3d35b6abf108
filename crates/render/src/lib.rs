//! From a scene description to a picture.
//!
//! [`compile`] flattens a [`scene::Scene`] into the records of the kernels and builds the bounding volume
//! hierarchy; a [`Device`] renders the [`CompiledScene`] into a [`Film`]. The two devices, [`cpu`] and [`gpu`],
//! run the same kernels.

pub mod adaptive;
mod bands;
mod compile;
pub mod cpu;
mod denoised;
mod device;
mod events;
mod film;
pub mod gpu;
mod open;
mod passes;
mod picture;
mod rays;
mod renderer;
mod sampling;

pub use bands::{BAND_BYTES, Band, BandStatistics, Sampling, band_rows, render_bands};
pub use compile::{Acceleration, CompileError, CompiledScene, compile, compile_with};
pub use denoised::{DenoiseFunction, NoisyPicture, check_denoised_size, render_denoised};
pub use device::{Batch, ControlFlow, Device, DeviceError, LoadedScene, Progress, RenderSettings};
pub use events::pixel_events;
pub use film::{Film, automatic_exposure};
pub use gpu::{GpuInfo, list_gpus};
pub use open::{DeviceChoice, ReadyDevice, automatic_gpu, load_for, open_device};
pub use passes::{StopRule, relative_noise, render_until};
pub use picture::{
    BandSink, Layer, Layers, Origins, PictureError, PictureFormat, PictureTarget, RenderError,
    check_writable, stream_picture, write_picture, write_whole_file,
};
pub use rays::WorldRay;
pub use renderer::Renderer;
pub use sampling::{CropWindow, Filter, Sampler};
