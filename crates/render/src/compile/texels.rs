use super::noise::noise_table;
use super::{CompileError, count};
use kernels::records::kernel::{CHANNEL_IMAGE, ChannelRecord};
use scene::{Image, ImageId, Scene};
use std::collections::HashMap;
use wgsl_rs::std::vec4f;

/// The pixels of all images that are used, each stored once, and the table of the noise if it is used.
#[derive(Default)]
pub(super) struct Texels {
    pub table: Vec<u32>,
    first_texel: HashMap<ImageId, u32>,
    noise: Option<u32>,
}

impl Texels {
    /// The instruction that reads an image.
    pub(super) fn image_channel(
        &mut self,
        scene: &Scene,
        id: ImageId,
        bilinear: bool,
    ) -> Result<ChannelRecord, CompileError> {
        let image = &scene.images[id.index()];
        let too_large = || CompileError::ImageTooLarge {
            name: image.name.clone(),
            width: image.width,
            height: image.height,
        };
        let width = u16::try_from(image.width).map_err(|_| too_large())?;
        let height = u16::try_from(image.height).map_err(|_| too_large())?;
        Ok(ChannelRecord {
            value: vec4f(0.0, 0.0, 0.0, 1.0),
            operation: CHANNEL_IMAGE,
            first: self.first_texel(id, image)?,
            size: u32::from(width) | u32::from(height) << 16,
            mode: u32::from(bilinear) | u32::from(image.srgb) << 1,
        })
    }

    fn first_texel(&mut self, id: ImageId, image: &Image) -> Result<u32, CompileError> {
        if let Some(&first) = self.first_texel.get(&id) {
            return Ok(first);
        }
        let first = self.append(image.pixels.iter().map(|pixel| u32::from_le_bytes(*pixel)))?;
        self.first_texel.insert(id, first);
        Ok(first)
    }

    /// Where the table of the noise starts.
    pub(super) fn noise(&mut self) -> Result<u32, CompileError> {
        if let Some(first) = self.noise {
            return Ok(first);
        }
        let first = self.append(noise_table())?;
        self.noise = Some(first);
        Ok(first)
    }

    fn append(&mut self, words: impl Iterator<Item = u32>) -> Result<u32, CompileError> {
        let first = count(self.table.len());
        self.table.extend(words);
        if u32::try_from(self.table.len()).is_err() {
            return Err(CompileError::TooManyTexels { texels: self.table.len() });
        }
        Ok(first)
    }
}
