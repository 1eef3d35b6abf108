//! From a film to an image file: PNG to look at, EXR to measure.

mod encode;
mod layers;
mod record;
mod spool;
mod stream;
mod whole_file;

use crate::bands::Band;
use crate::{DeviceError, Film, ToneCurve};
use std::error::Error;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

pub use encode::shown_colour;
pub use layers::{Layer, Layers, Origins};
pub(crate) use record::record_of;
pub use record::{RecordError, read_record};
pub use stream::{BandSink, PictureTarget, stream_picture};
pub use whole_file::{check_writable, write_whole_file};

/// The kinds of image file that a [`Film`] can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// 8 bits per channel, exposed and encoded as sRGB.
    Png,
    /// Radiance in W/(m² sr) as 32-bit floats, never scaled.
    Exr,
}

impl PictureFormat {
    /// The format that a file name stands for, by its extension; upper and lower case are the same.
    ///
    /// # Errors
    /// [`PictureError::UnknownFormat`] for any other extension and for none.
    pub fn from_path(path: &Path) -> Result<Self, PictureError> {
        let extension = path.extension().unwrap_or_default();
        if extension.eq_ignore_ascii_case("png") {
            Ok(PictureFormat::Png)
        } else if extension.eq_ignore_ascii_case("exr") {
            Ok(PictureFormat::Exr)
        } else {
            Err(PictureError::UnknownFormat { path: path.to_owned() })
        }
    }

    /// Whether an exposure changes what is written.
    pub fn is_exposed(self) -> bool {
        self == PictureFormat::Png
    }
}

impl fmt::Display for PictureFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            PictureFormat::Png => "PNG",
            PictureFormat::Exr => "EXR",
        })
    }
}

/// Why a picture could not be written.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file name does not say which format is wanted.
    #[error("the picture '{}' must end in .png (to look at) or .exr (unscaled radiance)", path.display())]
    UnknownFormat {
        /// The file name.
        path: PathBuf,
    },
    /// The file could not be written; a file that was there before is untouched.
    #[error("cannot write the picture {}", path.display())]
    Write {
        /// Where to.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// Why a picture was not rendered into its file.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The device failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The file could not be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The whole film must be in memory for what is wanted, and does not fit.
    #[error(
        "the whole picture must be kept: it would take {:.1} GB of memory, and {:.1} GB can be had here. --time, --noise, \
         --adaptive and --checkpoint keep it; make the picture smaller, render parts of it with --crop, or give \
         --samples alone",
        *.needed as f64 / 1e9,
        *.limit as f64 / 1e9
    )]
    FilmTooLarge {
        /// Bytes that the picture takes.
        needed: u64,
        /// What is accepted.
        limit: u64,
    },
    /// Denoising takes too much memory.
    #[error(
        "denoising looks at the whole picture at once, which takes {:.1} GB of memory; at most {:.1} GB are taken: render \
         a smaller picture, or one without --denoise, which is written part by part",
        *.needed as f64 / 1e9,
        *.limit as f64 / 1e9
    )]
    TooLargeToDenoise {
        /// Bytes that the picture takes.
        needed: u64,
        /// What is accepted.
        limit: u64,
    },
    /// The picture could not be denoised.
    #[error("the picture could not be denoised")]
    Denoise(#[source] Box<dyn Error + Send + Sync>),
}

/// Writes a film as the kind of image that the extension of `path` names. `exposure`, in stops, brightens a PNG, which
/// has the usual tone curve; an EXR is never scaled.
///
/// The file appears under its name only when it is complete.
///
/// # Errors
/// If the extension is unknown or the file cannot be written.
pub fn write_picture(film: &Film, path: &Path, exposure: f32) -> Result<(), RenderError> {
    let target = PictureTarget {
        path,
        width: film.width,
        height: film.height,
        exposure: Some(exposure),
        tone_curve: ToneCurve::default(),
        layers: &Layers::default(),
        origins: &Origins::default(),
        provenance: None,
    };
    let band = Band { first_row: 0, width: film.width, pixels: &film.pixels, layers: &[], denoised: &[] };
    stream_picture(&target, |sink| sink(&band)).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::{ReadChannels, ReadLayers, read};
    use std::fs::File;
    use std::io::BufReader;

    /// 3 x 2 pixels of two samples each; a value above white and one above what half floats hold among them.
    fn film() -> Film {
        let mut film = Film::new(3, 2);
        let values = [[0.0, 0.18, 1.0], [0.5, 0.25, 0.125], [2.0, -0.1, 1e6], [0.1; 3], [0.2; 3], [0.3; 3]];
        for (pixel, value) in film.pixels.iter_mut().zip(values) {
            pixel.radiance = value.map(|v: f32| 2.0 * v).into();
            pixel.samples = 2;
        }
        film
    }

    fn read_png(path: &Path) -> (u32, u32, Vec<[u8; 3]>) {
        let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
        assert!(reader.info().srgb.is_some());
        (info.width, info.height, bytes.as_chunks::<3>().0.to_vec())
    }

    fn read_exr(path: &Path) -> (usize, usize, Vec<[f32; 3]>) {
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .rgb_channels(
                |size, channels| {
                    assert_eq!(channels.0.sample_type, ::exr::prelude::SampleType::F32);
                    (size.0, vec![[0.0; 3]; size.area()])
                },
                |(width, pixels): &mut (usize, Vec<[f32; 3]>), at, (r, g, b): (f32, f32, f32)| {
                    pixels[at.y() * *width + at.x()] = [r, g, b];
                },
            )
            .first_valid_layer()
            .all_attributes()
            .from_file(path)
            .unwrap();
        let size = image.layer_data.size;
        (size.0, size.1, image.layer_data.channel_data.pixels.1)
    }

    #[test]
    fn the_extension_chooses_the_format_in_any_case() {
        for (name, format) in [
            ("a.png", Some(PictureFormat::Png)),
            ("dir.exr/b.PNG", Some(PictureFormat::Png)),
            ("c.tar.Exr", Some(PictureFormat::Exr)),
            ("d.jpg", None),
            ("png", None),
            (".png", None),
            ("", None),
        ] {
            assert_eq!(PictureFormat::from_path(Path::new(name)).ok(), format, "{name}");
        }
        let message = PictureFormat::from_path(Path::new("d.jpg")).unwrap_err().to_string();
        assert!(
            message.contains("d.jpg") && message.contains(".png") && message.contains(".exr"),
            "{message}"
        );
    }

    #[test]
    fn png_holds_srgb_values_with_the_top_row_first() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.png");
        write_picture(&film(), &path, 0.0).unwrap();
        let (width, height, pixels) = read_png(&path);
        assert_eq!((width, height), (3, 2));
        // 18 % grey is 118 in sRGB; half is 188, a quarter 137, an eighth 99.
        assert_eq!(pixels[0], [0, 118, 255]);
        assert_eq!(pixels[1], [188, 137, 99]);
        assert_eq!(pixels[2], [255, 0, 255]);
        assert!(pixels[3] < pixels[4] && pixels[4] < pixels[5]);
    }

    #[test]
    fn a_stop_doubles_the_light_of_a_png() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.png");
        write_picture(&film(), &path, 1.0).unwrap();
        assert_eq!(read_png(&path).2[1], [255, 188, 137]);
        write_picture(&film(), &path, -1.0).unwrap();
        assert_eq!(read_png(&path).2[1][..2], [137, 99]);
    }

    #[test]
    fn exr_holds_the_radiance_unchanged_by_exposure() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.EXR");
        write_picture(&film(), &path, 5.0).unwrap();
        let (width, height, pixels) = read_exr(&path);
        assert_eq!((width, height), (3, 2));
        assert_eq!(pixels, film().radiances().collect::<Vec<_>>());
    }

    #[test]
    fn a_large_picture_of_odd_size_comes_back_from_exr() {
        let mut film = Film::new(67, 131);
        for (i, pixel) in film.pixels.iter_mut().enumerate() {
            pixel.radiance = [i as f32, 0.5, 1.0 / (i + 1) as f32].into();
            pixel.samples = 1;
        }
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.exr");
        write_picture(&film, &path, 0.0).unwrap();
        assert_eq!(read_exr(&path).2, film.radiances().collect::<Vec<_>>());
    }

    #[test]
    fn a_picture_without_pixels_leaves_nothing_behind() {
        let directory = tempfile::tempdir().unwrap();
        for name in ["a.png", "a.exr"] {
            let error = write_picture(&Film::new(0, 4), &directory.path().join(name), 0.0).unwrap_err();
            assert!(matches!(error, RenderError::Picture(PictureError::Write { .. })));
        }
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
    }
}
