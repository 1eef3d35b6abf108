//! Removes noise from pictures with Open Image Denoise, version 2.
//!
//! The library is not linked but looked for when a [`Denoiser`] is opened: programs start without it, and are built
//! without it. It guesses what the picture would look like without noise from having seen many pictures; the guess
//! is good to look at and **biased**: it is not what more samples would converge to.

mod interface;
mod library;

use interface::{Device, Guide};
use std::fmt;

/// Environment variable with the library's file or the folder that it is in.
pub const LIBRARY_VARIABLE: &str = "SUNSHINE_OIDN";

/// A picture with noise and what helps to tell noise from detail; row by row from the top, as many entries in each
/// as there are pixels.
#[derive(Clone, Copy, Debug)]
pub struct Noisy<'a> {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Linear radiance in any unit; the noise of different pixels should be independent.
    pub radiance: &'a [[f32; 3]],
    /// Share of light that the surface sends on, from 0 to 1.
    pub albedo: &'a [[f32; 3]],
    /// Mean of the unit normals seen in the pixel, in any space.
    pub normal: &'a [[f32; 3]],
}

/// Why a picture was not denoised.
#[derive(Debug, thiserror::Error)]
pub enum DenoiseError {
    /// There is no library, or it does not load.
    #[error(
        "the library Open Image Denoise cannot be loaded.{}\n  \
         It is free: get version 2 from https://www.openimagedenoise.org/downloads.html, then set the environment \
         variable {LIBRARY_VARIABLE} to its folder `lib` (Windows: `bin`, which must be in PATH, too)",
        .tried.iter().map(|reason| format!("\n  tried {reason}")).collect::<String>()
    )]
    NotFound {
        /// What was tried, each with the reason why it failed.
        tried: Vec<String>,
    },
    /// The library has another interface.
    #[error("{library} is not Open Image Denoise version 2: {reason}")]
    WrongLibrary {
        /// Its file.
        library: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The library refused to work.
    #[error("Open Image Denoise failed while {doing}: {reason}")]
    Failed {
        /// What it was doing.
        doing: &'static str,
        /// What it said.
        reason: String,
    },
}

/// The library, ready to denoise pictures on the processor: the same on every machine, and what takes a second there
/// is not worth a graphics card.
pub struct Denoiser {
    device: Device,
    version: (i32, i32, i32),
}

impl Denoiser {
    /// Looks for the library and starts it with a number of threads, or as many as the processor has.
    ///
    /// It is looked for where [`LIBRARY_VARIABLE`] says, and only there if it is set, else where the system has its
    /// libraries.
    ///
    /// # Errors
    /// If the library is missing or does not start.
    pub fn open(threads: Option<usize>) -> Result<Self, DenoiseError> {
        let functions = library::load(std::env::var_os(LIBRARY_VARIABLE).as_deref())?;
        let device = Device::open(functions, threads)?;
        let number = |name| device.number(name);
        let version = (number(c"versionMajor"), number(c"versionMinor"), number(c"versionPatch"));
        Ok(Denoiser { device, version })
    }

    /// A guess of the picture without noise.
    ///
    /// Albedo and normals have noise, too, where pixels are wider than leaves: they are denoised first, each for
    /// itself, so that the picture is not drawn after their noise. This also keeps the picture's mean much better
    /// (in a Cornell box of 8 samples per pixel to 0.5 %, where it else changes by 4 %).
    ///
    /// # Errors
    /// If the library fails, for example for want of memory.
    ///
    /// # Panics
    /// If the numbers of entries are not that of the pixels.
    pub fn denoise(&self, picture: &Noisy<'_>) -> Result<Vec<[f32; 3]>, DenoiseError> {
        let size = (picture.width, picture.height);
        for pixels in [picture.radiance, picture.albedo, picture.normal] {
            assert_eq!(picture.width.checked_mul(picture.height), Some(pixels.len()), "pixels");
        }
        if picture.radiance.is_empty() {
            return Ok(Vec::new());
        }
        let albedo = self.device.buffer(picture.albedo)?;
        let normal = self.device.buffer(picture.normal)?;
        self.device.denoise_guide(size, Guide::Albedo, &albedo)?;
        self.device.denoise_guide(size, Guide::Normal, &normal)?;
        let radiance = self.device.buffer(picture.radiance)?;
        self.device.denoise_radiance(size, &radiance, &albedo, &normal)?;
        radiance.read(picture.radiance.len())
    }
}

impl fmt::Display for Denoiser {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (major, minor, patch) = self.version;
        write!(f, "Open Image Denoise {major}.{minor}.{patch}")
    }
}

impl fmt::Debug for Denoiser {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Denoiser({self})")
    }
}
