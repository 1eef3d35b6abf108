//! Pictures of the project, each decoded once: as textures, and as heights.

use crate::archive::Archive;
use crate::report::{Location, Report};
use crate::surfaces::Heights;
use crate::{Limits, ReadError};
use image::{DynamicImage, ImageReader};
use scene::{Image, ImageId, Scene};
use std::cell::RefCell;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Cursor;
use std::rc::Rc;

/// Access to the pictures; clones share what was read.
#[derive(Clone)]
pub(crate) struct Images(Rc<RefCell<Pictures>>);

struct Pictures {
    archive: Archive,
    /// Registry path of a picture to its file.
    files: HashMap<String, String>,
    srgb: bool,
    by_file: HashMap<String, Option<ImageId>>,
    /// Pixels that may still be decoded.
    pixels_left: u64,
    /// Pictures by a hash of their pixels, so that equal ones in several files are stored once.
    by_content: HashMap<u64, Vec<ImageId>>,
}

impl Images {
    /// `files` has the file of each picture by its path in the registry; `srgb` tells how colours are meant.
    pub fn new(archive: Archive, files: HashMap<String, String>, srgb: bool) -> Self {
        let (by_file, by_content) = (HashMap::new(), HashMap::new());
        let pixels_left = archive.limits().total_image_pixels;
        let pictures = Pictures { archive, files, srgb, by_file, pixels_left, by_content };
        Images(Rc::new(RefCell::new(pictures)))
    }

    /// The file of a picture that is given by its path in the registry.
    pub fn file(&self, registry_path: &str) -> Option<String> {
        self.0.borrow().files.get(registry_path).cloned()
    }

    /// Contents of any file of the project.
    pub fn read_file(&mut self, file: &str) -> Result<Option<Vec<u8>>, ReadError> {
        self.0.borrow_mut().archive.read(file)
    }

    /// The picture in a file of the project; `None`, with a warning, if it is missing or broken.
    pub fn load(
        &mut self,
        file: &str,
        location: Option<Location>,
        scene: &mut Scene,
        report: &mut Report,
    ) -> Result<Option<ImageId>, ReadError> {
        let mut pictures = self.0.borrow_mut();
        if let Some(known) = pictures.by_file.get(file) {
            return Ok(*known);
        }
        let id = match pictures.decode(file)?.and_then(|decoded| pictures.texture(file, decoded)) {
            Ok(image) => Some(pictures.stored_once(image, scene)),
            Err(problem) => {
                report.warn(format!("image '{file}' {problem}; grey is used instead"), location);
                None
            }
        };
        pictures.by_file.insert(file.to_owned(), id);
        Ok(id)
    }

    /// The grey values of a picture in a file of the project; an error text if there are none.
    pub fn heights(&mut self, file: &str) -> Result<Result<Heights, String>, ReadError> {
        Ok(self.0.borrow_mut().decode(file)?.map(heights))
    }
}

impl Pictures {
    /// A decoded picture; the inner error says what is wrong with the file.
    fn decode(&mut self, file: &str) -> Result<Result<DynamicImage, String>, ReadError> {
        Ok(match self.archive.read(file) {
            Ok(Some(bytes)) => decode(&bytes, self.archive.limits(), &mut self.pixels_left),
            Ok(None) => Err("is not in the project".to_owned()),
            Err(error @ ReadError::TooLarge { .. }) => return Err(error),
            Err(error) => Err(format!("cannot be read ({error})")),
        })
    }

    fn texture(&self, file: &str, decoded: DynamicImage) -> Result<Image, String> {
        let image = decoded.into_rgba8();
        let (width, height) = image.dimensions();
        let pixels = image.pixels().map(|pixel| pixel.0).collect::<Vec<_>>();
        if pixels.is_empty() {
            return Err("has no pixels".to_owned());
        }
        Ok(Image { name: file.to_owned(), width, height, pixels: pixels.into(), srgb: self.srgb })
    }

    /// Adds a picture to the scene, unless an equal one is there.
    fn stored_once(&mut self, image: Image, scene: &mut Scene) -> ImageId {
        let mut hasher = DefaultHasher::new();
        (image.width, image.height, &image.pixels).hash(&mut hasher);
        let alike = self.by_content.entry(hasher.finish()).or_default();
        let equal = |id: &&ImageId| {
            let other = &scene.images[id.index()];
            (other.width, other.height) == (image.width, image.height) && other.pixels == image.pixels
        };
        if let Some(known) = alike.iter().find(equal) {
            return *known;
        }
        let id = scene.add_image(image);
        alike.push(id);
        id
    }
}

/// Decodes a picture and takes its pixels from those that are left.
fn decode(bytes: &[u8], limits: Limits, pixels_left: &mut u64) -> Result<DynamicImage, String> {
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
        return Err(format!(
            "has {width} x {height} pixels, more than the limit of {} (--limit image-pixels)",
            limits.image_pixels
        ));
    }
    *pixels_left = pixels_left.checked_sub(count).ok_or_else(|| {
        let most = limits.total_image_pixels;
        format!("is too much: all images together have more than {most} pixels (--limit total-image-pixels)")
    })?;
    reader()?.decode().map_err(broken)
}

/// What GroIMP takes for the heights of a picture: the grey value, else the blue one.
fn heights(image: DynamicImage) -> Heights {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let samples = match image {
        DynamicImage::ImageLuma8(gray) => gray.into_raw().into_iter().map(u16::from).collect(),
        DynamicImage::ImageLumaA8(gray) => gray.pixels().map(|pixel| pixel.0[0].into()).collect(),
        DynamicImage::ImageLuma16(gray) => gray.into_raw(),
        DynamicImage::ImageLumaA16(gray) => gray.pixels().map(|pixel| pixel.0[0]).collect(),
        // All others count in bytes.
        colored => colored.into_rgb8().pixels().map(|pixel| pixel.0[2].into()).collect(),
    };
    Heights { width, height, samples }
}
