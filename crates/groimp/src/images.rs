//! Pictures of the project, each decoded once.

use crate::archive::Archive;
use crate::report::{Location, Report};
use crate::{Limits, ReadError};
use image::ImageReader;
use scene::{Image, ImageId, Scene};
use std::collections::HashMap;
use std::io::Cursor;

/// Pictures by the file they are stored in.
pub(crate) struct Images {
    archive: Archive,
    by_file: HashMap<String, Option<ImageId>>,
}

impl Images {
    pub fn new(archive: Archive) -> Self {
        Images { archive, by_file: HashMap::new() }
    }

    /// Contents of any file of the project.
    pub fn read_file(&mut self, file: &str) -> Result<Option<Vec<u8>>, ReadError> {
        self.archive.read(file)
    }

    /// The picture in a file of the project; `None`, with a warning, if it is missing or broken.
    pub fn load(
        &mut self,
        file: &str,
        location: Option<Location>,
        scene: &mut Scene,
        report: &mut Report,
    ) -> Result<Option<ImageId>, ReadError> {
        if let Some(known) = self.by_file.get(file) {
            return Ok(*known);
        }
        let decoded = match self.archive.read(file) {
            Ok(Some(bytes)) => decode(file, &bytes, self.archive.limits()),
            Ok(None) => Err("is not in the project".to_owned()),
            Err(error @ ReadError::TooLarge { .. }) => return Err(error),
            Err(error) => Err(format!("cannot be read ({error})")),
        };
        let id = match decoded {
            Ok(image) => Some(scene.add_image(image)),
            Err(problem) => {
                report.warn(format!("image '{file}' {problem}; grey is used instead"), location);
                None
            }
        };
        self.by_file.insert(file.to_owned(), id);
        Ok(id)
    }
}

fn decode(file: &str, bytes: &[u8], limits: Limits) -> Result<Image, String> {
    let reader = || {
        ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|error| format!("cannot be decoded ({error})"))
    };
    let broken = |error: image::ImageError| format!("cannot be decoded ({error})");
    // The header tells the size before anything is allocated for pixels.
    let (width, height) = reader()?.into_dimensions().map_err(broken)?;
    let count = u64::from(width) * u64::from(height);
    if count > limits.image_pixels {
        return Err(format!("has {width} x {height} pixels, more than the limit of {}", limits.image_pixels));
    }
    let image = reader()?.decode().map_err(broken)?.into_rgba8();
    let (width, height) = image.dimensions();
    let pixels = image.pixels().map(|pixel| pixel.0).collect::<Vec<_>>();
    if pixels.is_empty() {
        return Err("has no pixels".to_owned());
    }
    Ok(Image { name: file.to_owned(), width, height, pixels: pixels.into() })
}
