use glam::{DVec2, DVec3};

/// A number for every point (x, y, z), GroIMP's subclasses of `VolumeFunction`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VolumeFunction {
    /// The product with a direction.
    Gradient {
        /// Need not have unit length.
        direction: DVec3,
    },
    /// Six octaves of folded noise.
    Granite,
    /// Distance from the z axis (unverified, known from GroIMP's GLSL port).
    Wood,
    /// ((sin x + sin y + sin z) / 3)² (unverified, known from GroIMP's GLSL port).
    Leopard,
    /// How fast z² + c escapes, from -1 (at once) to 1 (never), where z starts at the point (x, y), repeated with
    /// period 1 and stretched to [-2, 2].
    Fractal {
        /// At least 1.
        iterations: u32,
        /// Julia: the constant c; Mandel: c is the point.
        constant: Option<DVec2>,
    },
    /// Octaves of noise at `size` times the point.
    Turbulence {
        /// Factor on the point.
        size: f64,
        /// Number of noises summed up.
        octaves: u32,
        /// From one octave to the next the frequency grows by this.
        frequency_ratio: f64,
        /// From one octave to the next the amplitude grows by this.
        noise_ratio: f64,
    },
}

/// A part of the wave form of a volume function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WaveStep {
    /// factor * value + shift.
    Linear {
        /// Multiplied first.
        factor: f64,
        /// Added then.
        shift: f64,
    },
    /// One of the functions of GroIMP's package `de.grogra.math`.
    Function(WaveForm),
}

/// A function of one number, named as GroIMP's class. Outside its domain the nearest value of the domain counts,
/// where GroIMP has no number; exponentials stop growing at an argument of 40.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it; the periodic ones are explained")]
pub enum WaveForm {
    Abs,
    Acos,
    Asin,
    Atan,
    Ceil,
    Floor,
    Cos,
    Sin,
    Tan,
    Cosh,
    Sinh,
    Tanh,
    Exp,
    Exp2,
    Expm1,
    Log,
    Log10,
    Sqr,
    Sqrt,
    /// From -1 to 1 in a period of 1 (this and the following are unverified in GroIMP's CPU classes).
    Ramp,
    /// Up from 0 to 1, down to -1, up to 0 in a period of 1.
    Triangle,
    /// v² (6 - 4v) - 1 in a period of 1.
    Cubic,
    /// 2 |sin πv| - 1.
    Scallop,
    /// sin 2πv.
    Sin01,
}
