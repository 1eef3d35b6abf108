use crate::{ImageId, Rgb, VolumeFunction, WaveStep, index_type};
use glam::{DAffine3, DMat2, DVec2, DVec3};

index_type!(
    /// Position in [`Scene::channels`](crate::Scene::channels).
    ChannelId
);

/// A node of a channel tree: a function from a surface point to a colour with alpha. It refers only to channels
/// that come before it.
///
/// A point has texture coordinates (u, v) and a position (x, y, z) in the object's own frame in metres. `coordinates`
/// of a node change both before the node looks at them; the channels that it combines see the surface itself.
#[derive(Clone, Debug, PartialEq)]
pub enum Channel {
    /// The same colour everywhere, alpha 1.
    Constant(Rgb),
    /// The same colour and alpha everywhere, GroIMP's `RGBAShader` where a channel is expected.
    Rgba {
        /// The colour.
        color: Rgb,
        /// In [0, 1].
        alpha: f64,
    },
    /// A picture, repeated in u and v; v = 0 is its bottom row.
    ImageMap {
        /// The picture.
        image: ImageId,
        /// Interpolate between pixels; otherwise the nearest pixel.
        bilinear: bool,
        /// Applied one after the other to the coordinates of the surface.
        coordinates: Vec<CoordinateMap>,
    },
    /// A checkerboard with two by two fields per unit of u and v. The channels in its fields see the coordinates
    /// of the surface.
    Checker {
        /// In fields where floor(2u) + floor(2v) is odd.
        odd: ChannelId,
        /// In the other fields.
        even: ChannelId,
        /// Applied one after the other to the coordinates of the surface.
        coordinates: Vec<CoordinateMap>,
    },
    /// Cubes with an edge of 1 in two colours, GroIMP's `VolumeChecker` (unverified, known from its GLSL port).
    VolumeChecker {
        /// In cubes where floor(x) + floor(y) + floor(z) is odd.
        odd: ChannelId,
        /// In the other cubes.
        even: ChannelId,
        /// Applied one after the other to the coordinates of the surface.
        coordinates: Vec<CoordinateMap>,
    },
    /// The grey value `wave(function(x, y, z))`, alpha 1.
    Volume {
        /// Of the position.
        function: VolumeFunction,
        /// Applied one after the other to the value of the function.
        wave: Vec<WaveStep>,
        /// Applied one after the other to the coordinates of the surface.
        coordinates: Vec<CoordinateMap>,
    },
    /// The grey value cos(2π u count.x) cos(2π v count.y), alpha 1: the height of GroIMP's `WaveMap`.
    Waves {
        /// Waves per unit of u and v.
        count: DVec2,
        /// Applied one after the other to the coordinates of the surface.
        coordinates: Vec<CoordinateMap>,
    },
    /// A ramp of channels along x, GroIMP's `ChannelBlend`: the first before the first position, the last behind
    /// the last, in between two the linear mixture.
    Blend {
        /// In ascending order of their positions as a rule; at least one.
        items: Vec<BlendItem>,
        /// Applied one after the other to the coordinates of the surface; x is looked at.
        coordinates: Vec<CoordinateMap>,
    },
    /// A weighted sum of a channel at points round the surface point, alpha 1, GroIMP's `Smooth3D`, `Laplace3D`.
    Filter {
        /// The weights.
        weights: NeighbourFilter,
        /// Distance of the points along x, y and z in metres, and along u and v.
        step: DVec3,
        /// What is summed up.
        input: ChannelId,
    },
}

/// A channel and where in the ramp of a [`Channel::Blend`] it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendItem {
    /// Where only this channel is seen.
    pub position: f64,
    /// What is seen there.
    pub channel: ChannelId,
}

/// Weights of the 3 x 3 x 3 points that a filter looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NeighbourFilter {
    /// All points alike, 1/27 each.
    Smooth,
    /// 1/2 for the point itself, -1/12 for the six that differ along one axis, 0 for the others.
    Laplace,
}

/// A change of the coordinates at which a channel is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub enum CoordinateMap {
    /// (u, v) becomes `linear * ((u, v) - offset)`, GroIMP's `AffineUVTransformation`.
    AffineUv {
        /// Taken away first.
        offset: DVec2,
        /// Rotation, shear and scale.
        linear: DMat2,
    },
    /// (x, y, z) becomes `matrix * p`, GroIMP's `XYZTransformation`.
    AffineXyz {
        /// The matrix itself, not its inverse.
        matrix: DAffine3,
        /// p is the position in the world instead of that in the object's frame (with the maps before).
        global: bool,
    },
    /// (x, y, z) and (u, v, w) are moved by noise, GroIMP's `Turbulence`. w is 0 on the surface.
    Turbulence {
        /// Factor on the noise per component.
        amount: DVec3,
        /// Number of noises summed up.
        octaves: u32,
        /// From one octave to the next the frequency grows by this.
        frequency_ratio: f64,
        /// From one octave to the next the amplitude grows by this.
        noise_ratio: f64,
    },
    /// The colour (r, g, b) of a channel becomes both (x, y, z) and (u, v, w): in GroIMP maps of colours answer
    /// for coordinates, too.
    Value(ChannelId),
}

/// A height above the surface that bends the shading normal, GroIMP's `BumpMap` and `WaveMap`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// Its red is the height.
    pub displacement: ChannelId,
    /// Metres per unit of the height.
    pub scale: f64,
    /// Distances in u and v over which the slope is measured.
    pub step: DVec2,
    /// Only where u is in [1/4, 1/2] and v in [1/3, 2/3]: the top of a box.
    pub box_top: bool,
}

impl Channel {
    /// The changes of coordinates before the channel looks at them.
    pub fn coordinates(&self) -> &[CoordinateMap] {
        match self {
            Channel::Constant(_) | Channel::Rgba { .. } | Channel::Filter { .. } => &[],
            Channel::ImageMap { coordinates, .. }
            | Channel::Checker { coordinates, .. }
            | Channel::VolumeChecker { coordinates, .. }
            | Channel::Volume { coordinates, .. }
            | Channel::Waves { coordinates, .. }
            | Channel::Blend { coordinates, .. } => coordinates,
        }
    }

    /// The channels whose colours it shows or combines.
    pub fn parts(&self) -> Vec<ChannelId> {
        match self {
            Channel::Constant(_)
            | Channel::Rgba { .. }
            | Channel::ImageMap { .. }
            | Channel::Volume { .. }
            | Channel::Waves { .. } => Vec::new(),
            Channel::Checker { odd, even, .. } | Channel::VolumeChecker { odd, even, .. } => {
                vec![*odd, *even]
            }
            Channel::Blend { items, .. } => items.iter().map(|item| item.channel).collect(),
            Channel::Filter { input, .. } => vec![*input],
        }
    }

    /// The channels whose colours it uses as coordinates.
    pub fn coordinate_values(&self) -> impl Iterator<Item = ChannelId> + '_ {
        self.coordinates().iter().filter_map(|map| match map {
            CoordinateMap::Value(id) => Some(*id),
            CoordinateMap::AffineUv { .. }
            | CoordinateMap::AffineXyz { .. }
            | CoordinateMap::Turbulence { .. } => None,
        })
    }
}
