//! `--denoise`: everybody can say it; whether it works depends on how the program was built.

#[cfg(not(feature = "denoise"))]
pub use absent::Denoiser;
#[cfg(feature = "denoise")]
pub use present::Denoiser;

#[cfg(feature = "denoise")]
mod present {
    use crate::failure::Failure;
    use render::NoisyPicture;
    use std::error::Error;
    use std::fmt;

    /// Open Image Denoise.
    pub struct Denoiser(denoise::Denoiser);

    impl Denoiser {
        /// Looks for the library.
        pub fn open(threads: Option<usize>) -> Result<Self, Failure> {
            Ok(Denoiser(denoise::Denoiser::open(threads)?))
        }

        /// Radiance without noise.
        pub fn denoise(&self, picture: &NoisyPicture) -> Result<Vec<[f32; 3]>, Box<dyn Error + Send + Sync>> {
            let noisy = denoise::Noisy {
                width: picture.width as usize,
                height: picture.height as usize,
                radiance: &picture.radiance,
                albedo: &picture.albedo,
                normal: &picture.normal,
            };
            Ok(self.0.denoise(&noisy)?)
        }
    }

    impl fmt::Display for Denoiser {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            self.0.fmt(f)
        }
    }
}

#[cfg(not(feature = "denoise"))]
mod absent {
    use crate::failure::Failure;
    use render::NoisyPicture;
    use std::error::Error;
    use std::fmt;

    /// There is none.
    pub enum Denoiser {}

    impl Denoiser {
        /// Says how to get one.
        pub fn open(_threads: Option<usize>) -> Result<Self, Failure> {
            Err(Failure::Usage(
                "--denoise: this sunshine was built without denoising. `cargo build --release --features denoise` \
                 builds one that has it; README.md says more"
                    .to_owned(),
            ))
        }

        /// Never called.
        pub fn denoise(
            &self,
            _picture: &NoisyPicture,
        ) -> Result<Vec<[f32; 3]>, Box<dyn Error + Send + Sync>> {
            match *self {}
        }
    }

    impl fmt::Display for Denoiser {
        fn fmt(&self, _: &mut fmt::Formatter<'_>) -> fmt::Result {
            match *self {}
        }
    }
}
