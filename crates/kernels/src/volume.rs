//! Functions of a position and of a number that GroIMP's volume maps are made of (materials-and-lights.md 2.6).

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    pub const WAVE_ABS: u32 = 0;
    pub const WAVE_ACOS: u32 = 1;
    pub const WAVE_ASIN: u32 = 2;
    pub const WAVE_ATAN: u32 = 3;
    pub const WAVE_CEIL: u32 = 4;
    pub const WAVE_FLOOR: u32 = 5;
    pub const WAVE_COS: u32 = 6;
    pub const WAVE_SIN: u32 = 7;
    pub const WAVE_TAN: u32 = 8;
    pub const WAVE_COSH: u32 = 9;
    pub const WAVE_SINH: u32 = 10;
    pub const WAVE_TANH: u32 = 11;
    pub const WAVE_EXP: u32 = 12;
    pub const WAVE_EXP2: u32 = 13;
    pub const WAVE_EXPM1: u32 = 14;
    pub const WAVE_LOG: u32 = 15;
    pub const WAVE_LOG10: u32 = 16;
    pub const WAVE_SQR: u32 = 17;
    pub const WAVE_SQRT: u32 = 18;
    pub const WAVE_RAMP: u32 = 19;
    pub const WAVE_TRIANGLE: u32 = 20;
    pub const WAVE_CUBIC: u32 = 21;
    pub const WAVE_SCALLOP: u32 = 22;
    pub const WAVE_SIN01: u32 = 23;

    /// Exponentials stop growing here, so that no infinities arise.
    pub const WAVE_LARGEST_EXPONENT: f32 = 40.0;

    /// True in odd cubes with an edge of 1. In floats, which holds far away, too.
    pub fn in_odd_cube(p: Vec3f) -> bool {
        let fields = floor(p.x) + floor(p.y) + floor(p.z);
        fields - 2.0 * floor(0.5 * fields) >= 0.5
    }

    /// ((sin x + sin y + sin z) / 3)².
    pub fn leopard(p: Vec3f) -> f32 {
        let mean = (sin(p.x) + sin(p.y) + sin(p.z)) / 3.0;
        mean * mean
    }

    /// A coordinate repeated with period 1 and stretched to (-2, 2]. As in GroIMP, whole numbers up to 0 are at
    /// the upper end, those above at the lower.
    pub fn fractal_coordinate(x: f32) -> f32 {
        if x > 0.0 {
            return 4.0 * (x - trunc(x)) - 2.0;
        }
        4.0 * (x + 1.0 + trunc(-x)) - 2.0
    }

    /// Escape of z² + c, from -1 (at once) to 1 (not within `iterations`). That the bound is checked behind each
    /// step, and that a step that leaves it is not counted, is unverified.
    pub fn fractal(z: Vec2f, c: Vec2f, iterations: u32) -> f32 {
        let mut a = z.x;
        let mut b = z.y;
        let mut steps: u32 = 0;
        let mut inside = true;
        while inside && steps < iterations {
            let squares = a * a - b * b;
            b = 2.0 * a * b + c.y;
            a = squares + c.x;
            inside = a * a + b * b <= 4.0;
            if inside {
                steps += 1;
            }
        }
        (2.0 * f32(steps) - f32(iterations)) / f32(iterations)
    }

    /// The periodic wave forms; `f` is in [0, 1).
    pub fn periodic_wave(form: u32, f: f32) -> f32 {
        if form == WAVE_RAMP {
            return 2.0 * f - 1.0;
        }
        if form == WAVE_TRIANGLE {
            if f < 0.25 {
                return 4.0 * f;
            }
            if f < 0.75 {
                return 2.0 - 4.0 * f;
            }
            return 4.0 * f - 4.0;
        }
        if form == WAVE_CUBIC {
            return f * f * (6.0 - 4.0 * f) - 1.0;
        }
        if form == WAVE_SCALLOP {
            return 2.0 * sin(0.5 * TWO_PI * f) - 1.0;
        }
        sin(TWO_PI * f)
    }

    /// A wave form at `v`; outside its domain that of the nearest point of the domain.
    pub fn wave_form(form: u32, v: f32) -> f32 {
        if form >= WAVE_RAMP {
            return periodic_wave(form, v - floor(v));
        }
        if form >= WAVE_COSH && form <= WAVE_EXPM1 {
            let e = clamp(v, -WAVE_LARGEST_EXPONENT, WAVE_LARGEST_EXPONENT);
            if form == WAVE_EXP2 {
                return exp2(e);
            }
            if form == WAVE_EXP {
                return exp(e);
            }
            if form == WAVE_EXPM1 {
                return exp(e) - 1.0;
            }
            let up = exp(e);
            let down = exp(-e);
            if form == WAVE_COSH {
                return 0.5 * (up + down);
            }
            if form == WAVE_SINH {
                return 0.5 * (up - down);
            }
            return (up - down) / (up + down);
        }
        if form == WAVE_ABS {
            return abs(v);
        }
        if form == WAVE_ACOS {
            return acos(clamp(v, -1.0, 1.0));
        }
        if form == WAVE_ASIN {
            return asin(clamp(v, -1.0, 1.0));
        }
        if form == WAVE_ATAN {
            return atan(v);
        }
        if form == WAVE_CEIL {
            return ceil(v);
        }
        if form == WAVE_FLOOR {
            return floor(v);
        }
        if form == WAVE_COS {
            return cos(v);
        }
        if form == WAVE_SIN {
            return sin(v);
        }
        if form == WAVE_TAN {
            return tan(v);
        }
        if form == WAVE_LOG {
            return log(max(v, 1.0e-30));
        }
        if form == WAVE_LOG10 {
            return log(max(v, 1.0e-30)) * 0.4342944819;
        }
        if form == WAVE_SQR {
            return v * v;
        }
        sqrt(max(v, 0.0))
    }
}
