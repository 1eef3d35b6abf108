use super::{CompileError, count};
use kernels::records::kernel::{CHANNEL_CONSTANT, CHANNEL_IMAGE, ChannelRecord, MaterialRecord, NONE};
use scene::{Channel, ChannelId, Image, ImageId, Material, Rgb, Scene};
use wgsl_rs::std::vec4f;

/// The tables behind the surfaces.
pub(super) struct Materials {
    pub records: Vec<MaterialRecord>,
    pub channels: Vec<ChannelRecord>,
    pub texels: Vec<u32>,
    /// For every material, whether rays pass it somewhere.
    pub not_opaque: Vec<bool>,
}

pub(super) fn compile_materials(scene: &Scene) -> Result<Materials, CompileError> {
    let mut texels = Texels::default();
    let mut channels = Vec::with_capacity(scene.channels.len());
    for channel in &scene.channels {
        channels.push(match *channel {
            Channel::Constant(color) => constant(color),
            Channel::ImageMap { image, bilinear } => texels.image_channel(scene, image, bilinear)?,
        });
    }
    let index = |id: Option<ChannelId>| id.map_or(NONE, |id| id.0);
    let mut records = Vec::with_capacity(scene.materials.len());
    let mut not_opaque = Vec::with_capacity(scene.materials.len());
    for material in &scene.materials {
        match material {
            Material::Rgba { color, opacity } => {
                channels.push(constant(*color));
                records.push(MaterialRecord {
                    diffuse: count(channels.len() - 1),
                    specular: NONE,
                    shininess: NONE,
                    transparency: NONE,
                    transparency_shininess: NONE,
                    diffuse_transparency: NONE,
                    ambient: NONE,
                    emissive: NONE,
                    interpolated_transparency: 1,
                    opacity: opacity.clamp(0.0, 1.0) as f32,
                    reserved0: 0,
                    reserved1: 0,
                });
                not_opaque.push(*opacity < 1.0);
            }
            Material::Phong(phong) => {
                records.push(MaterialRecord {
                    diffuse: index(phong.diffuse),
                    specular: index(phong.specular),
                    shininess: index(phong.shininess),
                    transparency: index(phong.transparency),
                    transparency_shininess: index(phong.transparency_shininess),
                    diffuse_transparency: index(phong.diffuse_transparency),
                    ambient: index(phong.ambient),
                    emissive: index(phong.emissive),
                    interpolated_transparency: u32::from(phong.interpolated_transparency),
                    opacity: 1.0,
                    reserved0: 0,
                    reserved1: 0,
                });
                not_opaque.push(phong.transparency.is_some() || has_holes(scene, phong.diffuse));
            }
        }
    }
    Ok(Materials { records, channels, texels: texels.table, not_opaque })
}

fn constant([r, g, b]: Rgb) -> ChannelRecord {
    ChannelRecord {
        value: vec4f(r as f32, g as f32, b as f32, 1.0),
        operation: CHANNEL_CONSTANT,
        first_texel: 0,
        size: 0,
        bilinear: 0,
    }
}

/// Whether the alpha of a channel is below 1 anywhere.
fn has_holes(scene: &Scene, channel: Option<ChannelId>) -> bool {
    match channel.and_then(|id| scene.channels.get(id.index())) {
        Some(Channel::ImageMap { image, .. }) => {
            scene.images[image.index()].pixels.iter().any(|pixel| pixel[3] < 255)
        }
        Some(Channel::Constant(_)) | None => false,
    }
}

/// The pixels of all images that are used, each stored once.
#[derive(Default)]
struct Texels {
    table: Vec<u32>,
    first_texel: std::collections::HashMap<ImageId, u32>,
}

impl Texels {
    fn image_channel(
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
            first_texel: self.first_texel(id, image)?,
            size: u32::from(width) | u32::from(height) << 16,
            bilinear: u32::from(bilinear),
        })
    }

    fn first_texel(&mut self, id: ImageId, image: &Image) -> Result<u32, CompileError> {
        if let Some(&first) = self.first_texel.get(&id) {
            return Ok(first);
        }
        let end = self.table.len() + image.pixels.len();
        if u32::try_from(end).is_err() {
            return Err(CompileError::TooManyTexels { texels: end });
        }
        let first = count(self.table.len());
        self.table.extend(image.pixels.iter().map(|pixel| u32::from_le_bytes(*pixel)));
        self.first_texel.insert(id, first);
        Ok(first)
    }
}
