//! Maps that compute a grey value from the position: GroIMP's subclasses of `VolumeFunction`.

use crate::ReadError;
use crate::channels::{Channels, MISSING, MapNode};
use crate::output::Output;
use crate::values::{Kind, Members, Value};
use scene::{Channel, ChannelId, DVec2, DVec3, VolumeFunction, WaveForm, WaveStep};
use std::f64::consts::{E, PI};

/// Parts of a chain of wave forms beyond which a file is not meant seriously.
const MOST_WAVE_STEPS: usize = 64;
/// More iterations of Mandel and Julia are not computed; values change by less than 0.1 % there.
const MOST_ITERATIONS: f64 = 10_000.0;

impl<'a> Channels<'a> {
    pub(crate) fn volume_map(
        &mut self,
        map: &MapNode<'a>,
        depth: u32,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let fields = map.fields;
        let number = |name, default| self.number(fields, name, default);
        let iterations = || -> Result<u32, ReadError> {
            // Lossless: clamped to the range. Without any iteration GroIMP divides by zero.
            Ok(number("iterations", 10.0)?.clamp(1.0, MOST_ITERATIONS) as u32)
        };
        let mut strength = 1.0;
        let function = match map.short_class() {
            "Granite" => VolumeFunction::Granite,
            "Wood" => VolumeFunction::Wood,
            "Leopard" => VolumeFunction::Leopard,
            "Mandel" => VolumeFunction::Fractal { iterations: iterations()?, constant: None },
            "Julia" => {
                let constant = DVec2::new(number("cx", 0.6)?, number("cy", 0.6)?);
                VolumeFunction::Fractal { iterations: iterations()?, constant: Some(constant) }
            }
            "VolumeTurbulence" => {
                let octaves = number("octaves", 5.0)?.clamp(1.0, 11.0);
                let noise_ratio = number("noiseRatio", 1.0)?;
                if noise_ratio.abs() > 1.0 {
                    strength = noise_ratio.abs().powf(1.0 - octaves.floor());
                }
                VolumeFunction::Turbulence {
                    size: number("size", 1.0)?,
                    octaves: octaves as u32,
                    frequency_ratio: number("frequencyRatio", 2.0)?,
                    noise_ratio,
                }
            }
            _ => VolumeFunction::Gradient { direction: self.vector(fields, "direction", DVec3::X)? },
        };
        let factor = strength * number("frequency", 1.0)?;
        let mut wave = vec![WaveStep::Linear { factor, shift: number("phase", 0.0)? }];
        if !self.wave_form(self.graph.values.find(fields, "waveForm"), &mut wave)? {
            let message = "a wave form is a spline or a formula, or unknown; grey is used instead of its map";
            out.report.warn(message, self.graph.location(map.line));
            return Ok(self.constant(MISSING, out));
        }
        let coordinates = self.coordinates(fields, map.line, depth, out)?;
        Ok(self.add(None, Channel::Volume { function, wave, coordinates }, MISSING, out))
    }

    /// Appends a `FloatToFloat`; false if it cannot be evaluated. Chains are unfolded.
    fn wave_form(&self, value: Option<&'a Value>, wave: &mut Vec<WaveStep>) -> Result<bool, ReadError> {
        enum Task<'v> {
            Form(&'v Value),
            Step(WaveStep),
        }
        let linear = |factor, shift| WaveStep::Linear { factor, shift };
        let mut tasks: Vec<Task<'a>> = value.into_iter().map(Task::Form).collect();
        while let Some(task) = tasks.pop() {
            if wave.len() + tasks.len() > MOST_WAVE_STEPS {
                return Ok(false);
            }
            let value = match task {
                Task::Step(step) => {
                    wave.push(step);
                    continue;
                }
                Task::Form(value) => value,
            };
            if value.kind == Kind::Null {
                continue;
            }
            let Some(map) = self.map_node(value) else { return Ok(false) };
            let class = map.short_class();
            if class == "Chain" {
                let part = |fields: Members, name| self.graph.values.find(fields, name).map(Task::Form);
                let factor = self.number(map.fields, "factor", 1.0)?;
                let shift = self.number(map.fields, "shift", 0.0)?;
                // The stack is emptied from its end.
                tasks.extend(part(map.fields, "second"));
                tasks.push(Task::Step(linear(factor, shift)));
                tasks.extend(part(map.fields, "first"));
                continue;
            }
            let golden_ratio = 0.5 * (1.0 + 5f64.sqrt());
            wave.push(match class {
                "Id" => continue,
                "Pi" => linear(PI, 0.0),
                "E" => linear(E, 0.0),
                "Phi" => linear(golden_ratio, 0.0),
                _ => match form(class) {
                    Some(form) => WaveStep::Function(form),
                    None => return Ok(false),
                },
            });
        }
        Ok(true)
    }
}

fn form(class: &str) -> Option<WaveForm> {
    Some(match class {
        "Abs" => WaveForm::Abs,
        "Acos" => WaveForm::Acos,
        "Asin" => WaveForm::Asin,
        "Atan" => WaveForm::Atan,
        "Ceil" => WaveForm::Ceil,
        "Floor" => WaveForm::Floor,
        "Cos" => WaveForm::Cos,
        "Sin" => WaveForm::Sin,
        "Tan" => WaveForm::Tan,
        "Cosh" => WaveForm::Cosh,
        "Sinh" => WaveForm::Sinh,
        "Tanh" => WaveForm::Tanh,
        "Exp" => WaveForm::Exp,
        "Exp2" => WaveForm::Exp2,
        "Expm1" => WaveForm::Expm1,
        "Log" => WaveForm::Log,
        "Log10" => WaveForm::Log10,
        "Sqr" => WaveForm::Sqr,
        "Sqrt" => WaveForm::Sqrt,
        "Ramp" => WaveForm::Ramp,
        "Triangle" => WaveForm::Triangle,
        "Cubic" => WaveForm::Cubic,
        "Scallop" => WaveForm::Scallop,
        "Sin01" => WaveForm::Sin01,
        _ => return None,
    })
}
