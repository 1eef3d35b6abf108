//! From a scene description to a picture.
//!
//! [`compile`] flattens a [`scene::Scene`] into the records of the kernels and builds the bounding volume
//! hierarchy; a [`Device`] renders the [`CompiledScene`] into a [`Film`]. The two devices, [`cpu`] and [`gpu`],
//! run the same kernels.

mod adaptive;
mod bands;
mod compile;
pub mod cpu;
mod denoised;
mod device;
mod events;
mod film;
mod film_file;
mod film_memory;
#[doc(hidden)]
pub mod fuzzing;
pub mod gpu;
mod open;
mod passes;
mod picking;
mod picture;
mod provenance;
mod rays;
mod renderer;
mod sampling;
mod several;
mod sums;
mod tone_curve;

pub use adaptive::{AdaptiveFilm, check_adaptive, continue_adaptive, render_adaptive};
pub use bands::{BAND_BYTES, Band, BandStatistics, Samples, Sampling, band_rows, render_bands};
pub use compile::{Acceleration, CompileError, CompiledScene, View, compile, compile_with};
pub use denoised::{DenoiseFunction, NoisyPicture, check_denoised_size, render_denoised};
pub use device::{Batch, ControlFlow, Device, DeviceError, LoadedScene, Progress, RenderSettings};
pub use events::pixel_events;
pub use film::{Film, automatic_exposure};
pub use film_file::{
    AdaptiveFilmFile, FILM_MAGIC, FilmFile, FilmFileError, SavedFilm, write_adaptive_film, write_film,
};
pub use film_memory::{check_kept, film_bytes, film_limit};
pub use gpu::{GpuInfo, list_gpus};
pub use open::{DeviceChoice, ReadyDevice, automatic_gpu, load_for, open_device};
pub use passes::{Ending, Goal, StopRule, relative_noise, render_passes, render_until};
pub use picking::{Picked, pick};
pub use picture::{
    BandSink, Layer, Layers, Origins, PictureError, PictureFormat, PictureTarget, RecordError, RenderError,
    check_writable, read_record, shown_colour, stream_picture, write_picture, write_whole_file,
};
pub use provenance::{Difference, Provenance};
pub use rays::WorldRay;
pub use renderer::Renderer;
pub use sampling::{CropWindow, Filter, Sampler};
pub use sums::{BLOCK_SAMPLES, FilmSums, Overlap};
pub use tone_curve::ToneCurve;
