use crate::{ChannelId, Distribution, Origin, Rgb};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// A light without a visible body. It stands at the origin of its frame and shines along local +z.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// What it emits.
    pub kind: LightKind,
    /// Placement; only position and axes matter, scaling does not change the power.
    pub world_from_light: DAffine3,
    /// How it fades with distance in the ray tracer; of no account for directional lights.
    pub attenuation: Attenuation,
    /// Lights everything, also what stands behind something else.
    pub shadowless: bool,
    /// Where it comes from.
    pub origin: Origin,
}

/// How a lamp fades with distance in the ray tracer. In the path tracer light always spreads with the square of
/// the distance.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Attenuation {
    /// The higher, the faster; with 0 it does not fade.
    pub exponent: f64,
    /// Distance in metres at which the lamp has the strength that it has without fading.
    pub distance: f64,
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
    /// A point whose intensity follows a table over the sphere, as measured for a luminaire.
    Physical {
        /// Emitted power in W per channel.
        power: Rgb,
        /// Shares of the power by direction in the light's axes.
        distribution: Arc<Distribution>,
    },
}

/// What a ray sees that leaves the scene; also a light source.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    /// Radiance by direction.
    pub radiance: SkyRadiance,
    /// Axes of the sky, in which its radiance is given. Only the rotation matters: scaling and position do not
    /// change what is infinitely far away.
    pub world_from_sky: DAffine3,
    /// Where it comes from.
    pub origin: Origin,
}

impl Sky {
    /// A sky with the same radiance in all directions.
    pub fn uniform(radiance: Rgb, origin: Origin) -> Self {
        Sky { radiance: SkyRadiance::Uniform(radiance), world_from_sky: DAffine3::IDENTITY, origin }
    }
}

/// Radiance of a sky in W/(m² sr) per channel.
#[derive(Clone, Debug, PartialEq)]
pub enum SkyRadiance {
    /// The same in all directions.
    Uniform(Rgb),
    /// A channel, laid round the scene as round a sphere.
    Channel {
        /// The colour by direction.
        channel: ChannelId,
        /// Radiance of the colour 1.
        factor: f64,
    },
    /// A clear sky with its sun.
    Daylight(Daylight),
}

/// Daylight after Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight" (SIGGRAPH 1999), GroIMP's
/// `SunSkyLight`. The zenith is the sky's local +z; what lies below its horizon is black.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Daylight {
    /// Direction to the sun in the sky's axes; any length but 0.
    pub sun: DVec3,
    /// Haziness of the air: 2 is very clear, 10 is hazy; the model holds from 1.7 to 10.
    pub turbidity: f64,
    /// Factor on the radiance of sky and sun.
    pub factor: f64,
    /// Whether the sky and the sun light the scene; otherwise they are only seen.
    pub shines: bool,
    /// Whether there is a sun.
    pub has_sun: bool,
}
