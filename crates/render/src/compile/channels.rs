//! Channel trees as programs for the kernels: every channel becomes a run of records that ends in a value or goes
//! on in the run of a channel before it. So each channel is compiled once, however often and deep it is used.

use super::texels::Texels;
use super::{CompileError, count};
use kernels::noise::kernel::{NOISE_GRANITE, NOISE_SCALAR};
use kernels::records::kernel::*;
use kernels::volume::kernel::*;
use scene::{
    Channel, ChannelId, CoordinateMap, DMat3, DVec3, Effort, NeighbourFilter, NormalMap, Rgb, Scene,
    VolumeFunction, WaveForm, WaveStep,
};
use wgsl_rs::std::{Vec4f, vec4f};

/// The compiled channels of a scene.
pub(super) struct Channels {
    pub records: Vec<ChannelRecord>,
    /// For every channel of the scene, where its program starts.
    pub starts: Vec<u32>,
    /// For every channel of the scene, whether its alpha is below 1 anywhere.
    pub has_holes: Vec<bool>,
    /// For every channel of the scene, whether it looks at the position.
    pub uses_position: Vec<bool>,
    pub texels: Vec<u32>,
}

/// Which coordinates a channel looks at, after they were changed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reads {
    Nothing,
    Uv,
    Xyz,
}

/// Numbers beyond it, which only a broken file holds, would become infinite in the kernels.
const LARGEST: f64 = 1e15;
/// The largest factor between octaves of noise: ten of them keep within the range of floats.
const LARGEST_RATIO: f64 = 1e3;

/// Compiles the channels; `origin` is the middle of the compiled scene in the world.
pub(super) fn compile_channels(scene: &Scene, origin: DVec3) -> Result<Channels, CompileError> {
    let mut programs =
        Programs { scene, origin, texels: Texels::default(), records: Vec::new(), starts: Vec::new() };
    let mut has_holes: Vec<bool> = Vec::with_capacity(scene.channels.len());
    let mut uses_position: Vec<bool> = Vec::with_capacity(scene.channels.len());
    let mut efforts: Vec<Effort> = Vec::with_capacity(scene.channels.len());
    for (number, channel) in scene.channels.iter().enumerate() {
        // A program that went on at a later one might never end.
        let parts = channel.parts();
        if parts.iter().copied().chain(channel.coordinate_values()).any(|id| id.index() >= number) {
            return Err(CompileError::ChannelOrder { channel: number });
        }
        let effort = Effort::of(channel, |id| efforts[id.index()]);
        if !effort.is_bounded() {
            return Err(CompileError::ChannelTooComplex { channel: number });
        }
        let start = programs.channel(channel)?;
        efforts.push(effort);
        programs.starts.push(start);
        has_holes.push(
            has_own_holes(scene, channel) || {
                // A filter answers alpha 1.
                !matches!(channel, Channel::Filter { .. }) && parts.iter().any(|id| has_holes[id.index()])
            },
        );
        uses_position.push(
            looks_at_position(channel)
                || parts.into_iter().chain(channel.coordinate_values()).any(|id| uses_position[id.index()]),
        );
    }
    let Programs { records, starts, texels, .. } = programs;
    Ok(Channels { records, starts, has_holes, uses_position, texels: texels.table })
}

/// Appends the normal maps of a material; the index of the first or `NONE`.
pub(super) fn compile_normal_maps(maps: &[NormalMap], channels: &mut Channels) -> u32 {
    let mut next = NONE;
    for map in maps.iter().rev() {
        let value = numbers([map.scale, map.step.x, map.step.y, 0.0]);
        channels.records.push(ChannelRecord {
            first: channels.starts[map.displacement.index()],
            size: u32::from(map.box_top),
            mode: next,
            ..instruction(CHANNEL_NORMAL_MAP, value)
        });
        next = count(channels.records.len() - 1);
    }
    next
}

/// Whether the alpha of the channel itself, not of its parts, is below 1 anywhere.
fn has_own_holes(scene: &Scene, channel: &Channel) -> bool {
    match channel {
        Channel::Rgba { alpha, .. } => *alpha < 1.0,
        Channel::ImageMap { image, .. } => {
            scene.images[image.index()].pixels.iter().any(|pixel| pixel[3] < 255)
        }
        Channel::Constant(_)
        | Channel::Checker { .. }
        | Channel::VolumeChecker { .. }
        | Channel::Volume { .. }
        | Channel::Waves { .. }
        | Channel::Blend { .. }
        | Channel::Filter { .. } => false,
    }
}

fn reads(channel: &Channel) -> Reads {
    match channel {
        Channel::Constant(_) | Channel::Rgba { .. } | Channel::Filter { .. } => Reads::Nothing,
        Channel::ImageMap { .. } | Channel::Checker { .. } | Channel::Waves { .. } => Reads::Uv,
        Channel::VolumeChecker { .. } | Channel::Volume { .. } | Channel::Blend { .. } => Reads::Xyz,
    }
}

/// Whether the channel itself looks at the position on the surface or in the world.
fn looks_at_position(channel: &Channel) -> bool {
    let coordinates = channel.coordinates();
    let value = coordinates.iter().any(|map| matches!(map, CoordinateMap::Value(_)));
    let global = coordinates.iter().any(|map| matches!(map, CoordinateMap::AffineXyz { global: true, .. }));
    reads(channel) == Reads::Xyz && (!value || global)
}

struct Programs<'a> {
    scene: &'a Scene,
    origin: DVec3,
    texels: Texels,
    records: Vec<ChannelRecord>,
    starts: Vec<u32>,
}

impl Programs<'_> {
    fn push(&mut self, record: ChannelRecord) {
        self.records.push(record);
    }

    fn start_of(&self, id: ChannelId) -> u32 {
        self.starts[id.index()]
    }

    /// Appends the program of a channel; where it starts.
    fn channel(&mut self, channel: &Channel) -> Result<u32, CompileError> {
        let start = count(self.records.len());
        self.coordinates(channel.coordinates(), reads(channel))?;
        let opaque = vec4f(0.0, 0.0, 0.0, 1.0);
        match channel {
            Channel::Constant(color) => self.push(constant(*color)),
            Channel::Rgba { color: [r, g, b], alpha } => {
                self.push(instruction(CHANNEL_CONSTANT, numbers([*r, *g, *b, alpha.clamp(0.0, 1.0)])));
            }
            Channel::ImageMap { image, bilinear, .. } => {
                let record = self.texels.image_channel(self.scene, *image, *bilinear)?;
                self.push(record);
            }
            Channel::Checker { odd, even, .. } | Channel::VolumeChecker { odd, even, .. } => {
                let volume = matches!(channel, Channel::VolumeChecker { .. });
                self.push(ChannelRecord {
                    first: self.start_of(*odd),
                    size: self.start_of(*even),
                    ..instruction(if volume { CHANNEL_VOLUME_CHECKER } else { CHANNEL_CHECKER }, opaque)
                });
            }
            Channel::Volume { function, wave, .. } => {
                self.volume_function(function)?;
                self.wave(wave);
                self.push(instruction(CHANNEL_GREY, opaque));
            }
            Channel::Waves { count, .. } => {
                self.push(instruction(CHANNEL_WAVES, numbers([count.x, count.y, 0.0, 0.0])));
                self.push(instruction(CHANNEL_GREY, opaque));
            }
            Channel::Blend { items, .. } => {
                if items.is_empty() {
                    self.push(constant([0.5; 3]));
                } else {
                    self.push(ChannelRecord {
                        size: count(items.len()),
                        ..instruction(CHANNEL_BLEND, opaque)
                    });
                }
                for item in items {
                    let position = numbers([item.position, 0.0, 0.0, 0.0]);
                    let first = self.start_of(item.channel);
                    self.push(ChannelRecord { first, ..instruction(CHANNEL_ITEM, position) });
                }
            }
            Channel::Filter { weights, step, input } => {
                let size = match weights {
                    NeighbourFilter::Smooth => 27,
                    NeighbourFilter::Laplace => 7,
                };
                let step = numbers([step.x, step.y, step.z, 0.0]);
                let first = self.start_of(*input);
                self.push(ChannelRecord { first, size, ..instruction(CHANNEL_FILTER, step) });
            }
        }
        Ok(start)
    }

    /// Appends the changes of coordinates that have an effect on what is read.
    fn coordinates(&mut self, maps: &[CoordinateMap], reads: Reads) -> Result<(), CompileError> {
        // What comes before a value is forgotten.
        let last = maps.iter().rposition(|map| matches!(map, CoordinateMap::Value(_))).unwrap_or(0);
        for map in &maps[last..] {
            match map {
                CoordinateMap::AffineUv { offset, linear } if reads == Reads::Uv => {
                    let offset = numbers([-offset.x, -offset.y, 0.0, 0.0]);
                    self.push(instruction(CHANNEL_MOVE_UV, offset));
                    let [x, y] = [linear.x_axis, linear.y_axis];
                    self.push(instruction(CHANNEL_LINEAR_UV, numbers([x.x, y.x, x.y, y.y])));
                }
                CoordinateMap::AffineXyz { matrix, global } if reads == Reads::Xyz => {
                    let m: DMat3 = matrix.matrix3.transpose();
                    // The compiled scene lies round the origin.
                    let moved = if *global { matrix.matrix3 * self.origin } else { DVec3::ZERO };
                    let t = matrix.translation + moved;
                    let row = |axis: DVec3, t: f64| numbers([axis.x, axis.y, axis.z, t]);
                    self.push(ChannelRecord {
                        first: u32::from(*global),
                        ..instruction(CHANNEL_AFFINE_XYZ, row(m.x_axis, t.x))
                    });
                    self.push(instruction(CHANNEL_OPERAND, row(m.y_axis, t.y)));
                    self.push(instruction(CHANNEL_OPERAND, row(m.z_axis, t.z)));
                }
                CoordinateMap::Turbulence { amount, octaves, frequency_ratio, noise_ratio }
                    if reads != Reads::Nothing =>
                {
                    let value = numbers([amount.x, amount.y, amount.z, 0.0]);
                    self.noise(
                        ChannelRecord {
                            size: *octaves,
                            mode: u32::from(reads == Reads::Uv),
                            ..instruction(CHANNEL_TURBULENCE, value)
                        },
                        *frequency_ratio,
                        *noise_ratio,
                    )?;
                }
                CoordinateMap::Value(id) => {
                    let value = vec4f(0.0, 0.0, 0.0, 0.0);
                    let first = self.start_of(*id);
                    self.push(ChannelRecord { first, ..instruction(CHANNEL_CALL, value) });
                }
                CoordinateMap::AffineUv { .. }
                | CoordinateMap::AffineXyz { .. }
                | CoordinateMap::Turbulence { .. } => {}
            }
        }
        Ok(())
    }

    fn noise(&mut self, record: ChannelRecord, frequency: f64, amplitude: f64) -> Result<(), CompileError> {
        let first = self.texels.noise()?;
        self.push(ChannelRecord { first, ..record });
        let ratio = |x: f64| x.clamp(-LARGEST_RATIO, LARGEST_RATIO);
        self.push(instruction(CHANNEL_OPERAND, numbers([ratio(frequency), ratio(amplitude), 0.0, 0.0])));
        Ok(())
    }

    fn volume_function(&mut self, function: &VolumeFunction) -> Result<(), CompileError> {
        let nothing = vec4f(0.0, 0.0, 0.0, 0.0);
        let noise = |size: f64, octaves: u32, kind: u32| ChannelRecord {
            size: octaves,
            mode: kind,
            ..instruction(CHANNEL_NOISE, numbers([size, 0.0, 0.0, 0.0]))
        };
        match *function {
            VolumeFunction::Gradient { direction: d } => {
                self.push(instruction(CHANNEL_GRADIENT, numbers([d.x, d.y, d.z, 0.0])));
            }
            VolumeFunction::Granite => self.noise(noise(4.0, 6, NOISE_GRANITE), 2.0, 0.5)?,
            VolumeFunction::Wood => self.push(instruction(CHANNEL_WOOD, nothing)),
            VolumeFunction::Leopard => self.push(instruction(CHANNEL_LEOPARD, nothing)),
            VolumeFunction::Fractal { iterations, constant } => {
                let c = constant.unwrap_or_default();
                self.push(ChannelRecord {
                    first: u32::from(constant.is_some()),
                    size: iterations.max(1),
                    ..instruction(CHANNEL_FRACTAL, numbers([c.x, c.y, 0.0, 0.0]))
                });
            }
            VolumeFunction::Turbulence { size, octaves, frequency_ratio, noise_ratio } => {
                self.noise(noise(size, octaves, NOISE_SCALAR), frequency_ratio, noise_ratio)?;
            }
        }
        Ok(())
    }

    /// Appends a wave form, neighbouring linear parts in one.
    fn wave(&mut self, wave: &[WaveStep]) {
        let mut linear = (1.0, 0.0);
        for step in wave {
            match *step {
                WaveStep::Linear { factor, shift } => {
                    linear = (factor * linear.0, factor * linear.1 + shift);
                }
                WaveStep::Function(form) => {
                    self.linear(linear);
                    linear = (1.0, 0.0);
                    let first = wave_form_number(form);
                    let record = instruction(CHANNEL_WAVE_FORM, vec4f(0.0, 0.0, 0.0, 0.0));
                    self.push(ChannelRecord { first, ..record });
                }
            }
        }
        self.linear(linear);
    }

    fn linear(&mut self, (factor, shift): (f64, f64)) {
        if (factor, shift) != (1.0, 0.0) {
            self.push(instruction(CHANNEL_LINEAR, numbers([factor, shift, 0.0, 0.0])));
        }
    }
}

fn wave_form_number(form: WaveForm) -> u32 {
    match form {
        WaveForm::Abs => WAVE_ABS,
        WaveForm::Acos => WAVE_ACOS,
        WaveForm::Asin => WAVE_ASIN,
        WaveForm::Atan => WAVE_ATAN,
        WaveForm::Ceil => WAVE_CEIL,
        WaveForm::Floor => WAVE_FLOOR,
        WaveForm::Cos => WAVE_COS,
        WaveForm::Sin => WAVE_SIN,
        WaveForm::Tan => WAVE_TAN,
        WaveForm::Cosh => WAVE_COSH,
        WaveForm::Sinh => WAVE_SINH,
        WaveForm::Tanh => WAVE_TANH,
        WaveForm::Exp => WAVE_EXP,
        WaveForm::Exp2 => WAVE_EXP2,
        WaveForm::Expm1 => WAVE_EXPM1,
        WaveForm::Log => WAVE_LOG,
        WaveForm::Log10 => WAVE_LOG10,
        WaveForm::Sqr => WAVE_SQR,
        WaveForm::Sqrt => WAVE_SQRT,
        WaveForm::Ramp => WAVE_RAMP,
        WaveForm::Triangle => WAVE_TRIANGLE,
        WaveForm::Cubic => WAVE_CUBIC,
        WaveForm::Scallop => WAVE_SCALLOP,
        WaveForm::Sin01 => WAVE_SIN01,
    }
}

pub(super) fn constant([r, g, b]: Rgb) -> ChannelRecord {
    instruction(CHANNEL_CONSTANT, numbers([r, g, b, 1.0]))
}

/// Four numbers in 32 bits, none of them infinite or NaN.
fn numbers(values: [f64; 4]) -> Vec4f {
    let [x, y, z, w] = values.map(|v| if v.is_nan() { 0.0 } else { v.clamp(-LARGEST, LARGEST) as f32 });
    vec4f(x, y, z, w)
}

fn instruction(operation: u32, value: Vec4f) -> ChannelRecord {
    ChannelRecord { value, operation, first: 0, size: 0, mode: 0 }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_kernels_stack_holds_what_scenes_may_need() {
        assert_eq!(kernels::channel::kernel::MAX_PENDING, scene::Effort::MAX_PENDING);
    }
}
