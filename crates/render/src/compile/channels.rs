//! Channel trees as programs for the kernels: every channel becomes a run of records that ends in a value or goes
//! on in the run of a channel before it. So each channel is compiled once, however often and deep it is used.

use super::{CompileError, count};
use kernels::records::kernel::{
    CHANNEL_CHECKER, CHANNEL_CONSTANT, CHANNEL_IMAGE, CHANNEL_LINEAR_UV, CHANNEL_MOVE_UV, ChannelRecord,
};
use scene::{Channel, ChannelId, CoordinateMap, Image, ImageId, Rgb, Scene};
use wgsl_rs::std::{Vec4f, vec4f};

/// The compiled channels of a scene.
pub(super) struct Channels {
    pub records: Vec<ChannelRecord>,
    /// For every channel of the scene, where its program starts.
    pub starts: Vec<u32>,
    /// For every channel of the scene, whether its alpha is below 1 anywhere.
    pub has_holes: Vec<bool>,
    pub texels: Vec<u32>,
}

pub(super) fn compile_channels(scene: &Scene) -> Result<Channels, CompileError> {
    let mut texels = Texels::default();
    let mut records = Vec::with_capacity(scene.channels.len());
    let mut starts: Vec<u32> = Vec::with_capacity(scene.channels.len());
    let mut has_holes: Vec<bool> = Vec::with_capacity(scene.channels.len());
    for channel in &scene.channels {
        let start = count(records.len());
        let holes = match channel {
            Channel::Constant(color) => {
                records.push(constant(*color));
                false
            }
            Channel::ImageMap { image, bilinear, coordinates } => {
                change_coordinates(coordinates, &mut records);
                records.push(texels.image_channel(scene, *image, *bilinear)?);
                scene.images[image.index()].pixels.iter().any(|pixel| pixel[3] < 255)
            }
            Channel::Checker { odd, even, coordinates } => {
                change_coordinates(coordinates, &mut records);
                // A program that went on at a later one might never end.
                let start_of = |id: &ChannelId| {
                    let channel = starts.len();
                    starts.get(id.index()).copied().ok_or(CompileError::ChannelOrder { channel })
                };
                let (odd_start, even_start) = (start_of(odd)?, start_of(even)?);
                let value = vec4f(0.0, 0.0, 0.0, 1.0);
                records.push(ChannelRecord {
                    first: odd_start,
                    size: even_start,
                    ..instruction(CHANNEL_CHECKER, value)
                });
                has_holes[odd.index()] || has_holes[even.index()]
            }
        };
        starts.push(start);
        has_holes.push(holes);
    }
    Ok(Channels { records, starts, has_holes, texels: texels.table })
}

fn change_coordinates(maps: &[CoordinateMap], records: &mut Vec<ChannelRecord>) {
    for map in maps {
        match map {
            CoordinateMap::AffineUv { offset, linear } => {
                let offset = vec4f(-offset.x as f32, -offset.y as f32, 0.0, 0.0);
                records.push(instruction(CHANNEL_MOVE_UV, offset));
                let [x, y] = [linear.x_axis, linear.y_axis];
                let rows = vec4f(x.x as f32, y.x as f32, x.y as f32, y.y as f32);
                records.push(instruction(CHANNEL_LINEAR_UV, rows));
            }
        }
    }
}

pub(super) fn constant([r, g, b]: Rgb) -> ChannelRecord {
    instruction(CHANNEL_CONSTANT, vec4f(r as f32, g as f32, b as f32, 1.0))
}

fn instruction(operation: u32, value: Vec4f) -> ChannelRecord {
    ChannelRecord { value, operation, first: 0, size: 0, bilinear: 0 }
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
            first: self.first_texel(id, image)?,
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
