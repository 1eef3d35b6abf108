//! From a scene description to a picture.
//!
//! [`compile`] flattens a [`scene::Scene`] into the records of the kernels and builds the bounding volume
//! hierarchy; a [`Device`] renders the [`CompiledScene`] into a [`Film`]. The two devices, [`cpu`] and [`gpu`],
//! run the same kernels.

mod device;
mod film;
mod picture;

pub use device::{ControlFlow, Device, DeviceError, LoadedScene, Progress, RenderSettings};
pub use film::{Film, automatic_exposure};
pub use picture::{PictureError, PictureFormat, check_writable, write_picture, write_whole_file};
/// A scene in the form that devices take.
pub struct CompiledScene;
