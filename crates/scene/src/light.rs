use crate::{Origin, Rgb};
use glam::DAffine3;

/// A light without a visible body. It stands at the origin of its frame and shines along local +z.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// What it emits.
    pub kind: LightKind,
    /// Placement; only position and axis matter, scaling does not change the power.
    pub world_from_light: DAffine3,
    /// Lights everything, also what stands behind something else.
    pub shadowless: bool,
    /// Where it comes from.
    pub origin: Origin,
}

/// What a light emits. Powers are in watts per colour channel.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// Equal intensity in all directions.
    Point {
        /// Emitted power in W per channel.
        power: Rgb,
    },
    /// A cone round local +z with a soft rim.
    Spot {
        /// Emitted power in W per channel.
        power: Rgb,
        /// Half angle of the full-intensity core in radians.
        inner_angle: f64,
        /// Half angle of the cone in radians, at least `inner_angle`.
        outer_angle: f64,
    },
    /// Parallel light along local +z from infinitely far away.
    Directional {
        /// Irradiance on a plane perpendicular to the beam in W/m² per channel.
        irradiance: Rgb,
    },
}

/// What a ray sees that leaves the scene; also a light source.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    /// Radiance in W/(m² sr) per channel, the same in all directions.
    pub radiance: Rgb,
    /// Where it comes from.
    pub origin: Origin,
}
