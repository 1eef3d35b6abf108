//! Checkerboards, changes of coordinates, and maps that stand for a colour.

use crate::ReadError;
use crate::channels::{Channels, MISSING, MapNode, forwards_colors};
use crate::field_errors::{number_of, wrong_value};
use crate::fields::transform_of;
use crate::output::Output;
use crate::values::{Kind, Members, Value, parse_number, parse_numbers, tokens};
use scene::{Channel, ChannelId, CoordinateMap, DAffine3, DMat2, DVec2, DVec3, Rgb};
use std::collections::HashSet;

/// Changes of coordinates one after another; each channel holds its whole chain.
const LONGEST_CHAIN: usize = 100;

/// More octaves of a `Turbulence` are not counted, as in GroIMP.
const MOST_OCTAVES: f64 = 10.0;

/// Maps whose colour counts as coordinates for maps that have them as input.
fn answers_with_color(class: &str) -> bool {
    matches!(
        class,
        "RGBColor"
            | "RGBAShader"
            | "Graytone"
            | "ImageMap"
            | "Carpenter"
            | "Checker"
            | "VolumeChecker"
            | "Gradient"
            | "Granite"
            | "Wood"
            | "Leopard"
            | "Mandel"
            | "Julia"
            | "VolumeTurbulence"
            | "ChannelBlend"
            | "Smooth3D"
            | "Laplace3D"
    )
}

impl<'a> Channels<'a> {
    /// GroIMP's `Checker` and `VolumeChecker`.
    pub(crate) fn checker(
        &mut self,
        map: &MapNode<'a>,
        depth: u32,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let MapNode { fields, line, .. } = *map;
        let coordinates = self.coordinates(fields, line, depth, out)?;
        let mut color = |name, default: f64| -> Result<ChannelId, ReadError> {
            let map = match self.graph.values.find(fields, name) {
                Some(value) => self.channel(value, name, depth + 1, out)?,
                None => None,
            };
            Ok(map.unwrap_or_else(|| self.constant([default; 3], out)))
        };
        let odd = color("color1", 1.0)?;
        let even = color("color2", 0.0)?;
        let mean = self.mean_of(&[odd, even]);
        let channel = match map.short_class() {
            "VolumeChecker" => Channel::VolumeChecker { odd, even, coordinates },
            _ => Channel::Checker { odd, even, coordinates },
        };
        Ok(self.add(None, channel, mean, out))
    }

    /// Average of the average colours of channels; grey if there are none.
    pub(crate) fn mean_of(&self, parts: &[ChannelId]) -> Rgb {
        if parts.is_empty() {
            return MISSING;
        }
        let mut sum = [0.0; 3];
        for id in parts {
            for (sum, part) in sum.iter_mut().zip(self.mean(*id)) {
                *sum += part / parts.len() as f64;
            }
        }
        sum
    }

    /// `RGBAShader` where a channel is expected: its colour and alpha (unverified).
    pub(crate) fn rgba_map(
        &mut self,
        value: &'a Value,
        map: &MapNode<'a>,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let words: Vec<_> = tokens(value.text()).collect();
        // A node has its numbers in fields; so has an object in attribute form.
        let numbers = match words[..] {
            [] | ["true", _] => None,
            _ => {
                let words = words.strip_prefix(&["false"]).unwrap_or(&words);
                words.iter().map(|word| parse_number(word)).collect::<Option<Vec<f64>>>()
            }
        };
        let (color, alpha) = match numbers.as_deref() {
            Some(&[r, g, b, a]) if value.kind != Kind::Ref => ([r, g, b], a),
            Some(&[r, g, b]) if value.kind != Kind::Ref => ([r, g, b], 1.0),
            _ => {
                let part = |name, default| match self.graph.values.find(map.fields, name) {
                    Some(part) => number_of(self.graph, part, "RGBAShader", name),
                    None => Ok(default),
                };
                ([part("x", 0.5)?, part("y", 0.5)?, part("z", 0.5)?], part("w", 1.0)?)
            }
        };
        if alpha == 1.0 || !alpha.is_finite() || !color.iter().all(|c| c.is_finite()) {
            return Ok(self.constant(color, out));
        }
        Ok(self.add(None, Channel::Rgba { color, alpha: alpha.clamp(0.0, 1.0) }, color, out))
    }

    /// `ChannelSPD` with a constant curve as the grey of its value; other curves are not evaluated.
    pub(crate) fn spectral_gray(
        &self,
        fields: Members,
        line: usize,
        out: &mut Output,
    ) -> Result<Rgb, ReadError> {
        let curve = self.graph.values.find(fields, "spectraldistribution").and_then(|v| self.map_node(v));
        match curve {
            Some(curve) if curve.short_class() == "ConstantSPD" => {
                match self.graph.values.find(curve.fields, "value") {
                    Some(value) => Ok([number_of(self.graph, value, "ConstantSPD", "value")?; 3]),
                    None => Ok(MISSING),
                }
            }
            _ => {
                let message = "the spectrum of a ChannelSPD is not evaluated; grey is used instead";
                out.report.warn(message, self.graph.location(line));
                Ok(MISSING)
            }
        }
    }

    /// The colour of a map that only changes coordinates or normals: that of its input.
    pub(crate) fn forwarded(
        &mut self,
        map: &MapNode<'a>,
        depth: u32,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let mut seen: HashSet<_> = map.node.into_iter().collect();
        let (mut fields, mut line) = (map.fields, map.line);
        loop {
            let input = self.graph.values.find(fields, "input").filter(|value| value.kind != Kind::Null);
            match input.and_then(|input| self.map_node(input)) {
                Some(map) if forwards_colors(map.short_class()) => {
                    if map.node.is_some_and(|node| !seen.insert(node)) {
                        let message = "a channel map contains itself; grey is used instead there";
                        out.report.warn(message, self.graph.location(line));
                        return Ok(self.constant(MISSING, out));
                    }
                    (fields, line) = (map.fields, map.line);
                }
                Some(_) => {
                    let channel = match input {
                        Some(input) => self.channel(input, "input", depth + 1, out)?,
                        None => None,
                    };
                    return Ok(channel.unwrap_or_else(|| self.constant(MISSING, out)));
                }
                None => {
                    let message = "a map of coordinates or normals stands where a colour is expected and has \
                                   no colour as its input; grey is used instead";
                    out.report.warn(message, self.graph.location(line));
                    return Ok(self.constant(MISSING, out));
                }
            }
        }
    }

    /// The chain of coordinate maps that starts at the field `input`, in the order of application: the input of
    /// a map comes before the map itself.
    pub(crate) fn coordinates(
        &mut self,
        fields: Members,
        line: usize,
        depth: u32,
        out: &mut Output,
    ) -> Result<Vec<CoordinateMap>, ReadError> {
        let mut maps = Vec::new();
        let mut seen = HashSet::new();
        let (mut fields, mut line) = (fields, line);
        while let Some(input) = self.graph.values.find(fields, "input").filter(|v| v.kind != Kind::Null) {
            if maps.len() == LONGEST_CHAIN {
                let message = format!("more than {LONGEST_CHAIN} inputs of a channel map are left out");
                out.report.warn(message, self.graph.location(line));
                break;
            }
            let map = self.map_node(input).filter(|map| map.node.is_none_or(|node| seen.insert(node)));
            let class = map.as_ref().map_or("", MapNode::short_class);
            match map {
                Some(_) if answers_with_color(class) => {
                    if let Some(id) = self.channel(input, "input", depth + 1, out)? {
                        maps.push(CoordinateMap::Value(id));
                    }
                    break;
                }
                Some(map) if forwards_colors(class) => {
                    (fields, line) = (map.fields, map.line);
                    if let Some(change) = self.coordinate_map(&map, out)? {
                        maps.push(change);
                    }
                }
                _ => {
                    let class = self.map_node(input).map_or("?", |map| map.class);
                    let message = format!(
                        "the input of class '{class}' of a channel map is not supported yet, or contains \
                         itself, and is left out"
                    );
                    out.report.warn(message, self.graph.location(line));
                    break;
                }
            }
        }
        maps.reverse();
        Ok(maps)
    }

    /// What a map does to coordinates; `None` for maps of normals, and, with a warning, if its numbers are not
    /// finite.
    fn coordinate_map(
        &self,
        map: &MapNode<'a>,
        out: &mut Output,
    ) -> Result<Option<CoordinateMap>, ReadError> {
        let class = map.short_class();
        let change = match class {
            "AffineUVTransformation" => self.affine_uv(map.fields)?,
            "XYZTransformation" => match self.affine_xyz(map, out)? {
                Some(change) => change,
                None => return Ok(None),
            },
            "Turbulence" => self.turbulence(map.fields)?,
            _ => return Ok(None),
        };
        let finite = match &change {
            CoordinateMap::AffineUv { offset, linear } => offset.is_finite() && linear.is_finite(),
            CoordinateMap::AffineXyz { matrix, .. } => matrix.is_finite(),
            CoordinateMap::Turbulence { amount, frequency_ratio, noise_ratio, .. } => {
                amount.is_finite() && frequency_ratio.is_finite() && noise_ratio.is_finite()
            }
            CoordinateMap::Value(_) => true,
        };
        if !finite {
            let message = format!("the numbers of a map '{class}' are not finite and it is left out");
            out.report.warn(message, self.graph.location(map.line));
        }
        Ok(finite.then_some(change))
    }

    /// A number of a map, or its default.
    pub(crate) fn number(&self, fields: Members, name: &str, default: f64) -> Result<f64, ReadError> {
        match self.graph.values.find(fields, name).filter(|value| value.kind != Kind::Null) {
            Some(value) => number_of(self.graph, value, "a channel map", name),
            None => Ok(default),
        }
    }

    /// Three numbers of a map, in list form or as fields x, y and z, or their default.
    pub(crate) fn vector(&self, fields: Members, name: &str, default: DVec3) -> Result<DVec3, ReadError> {
        let Some(value) = self.graph.values.find(fields, name).filter(|value| value.kind != Kind::Null)
        else {
            return Ok(default);
        };
        match parse_numbers(value.text()).as_deref() {
            Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
            Some([]) => Ok(DVec3::new(
                self.number(value.members, "x", default.x)?,
                self.number(value.members, "y", default.y)?,
                self.number(value.members, "z", default.z)?,
            )),
            _ => Err(wrong_value(self.graph, value, "a channel map", name, "three numbers")),
        }
    }

    /// `AffineUVTransformation`.
    fn affine_uv(&self, fields: Members) -> Result<CoordinateMap, ReadError> {
        let number = |name, default| self.number(fields, name, default);
        let offset = DVec2::new(number("offsetU", 0.0)?, number("offsetV", 0.0)?);
        let (scale_u, scale_v) = (number("scaleU", 1.0)?, number("scaleV", 1.0)?);
        let shear = number("shear", 0.0)?;
        let turn = DMat2::from_angle(-number("angle", 0.0)?);
        let stretch = DMat2::from_cols(DVec2::new(scale_u, 0.0), DVec2::new(-shear * scale_v, scale_v));
        Ok(CoordinateMap::AffineUv { offset, linear: stretch * turn })
    }

    /// `XYZTransformation`; `None` if it changes nothing.
    fn affine_xyz(&self, map: &MapNode<'a>, out: &mut Output) -> Result<Option<CoordinateMap>, ReadError> {
        let find = |name| self.graph.values.find(map.fields, name);
        let global = find("useGlobal").is_some_and(|value| value.text() == "true");
        let transform = find("transform").filter(|value| value.kind != Kind::Null);
        let (matrix, unknown) = match transform {
            Some(value) => transform_of(self.graph, value, map.class)?,
            None => (DAffine3::IDENTITY, None),
        };
        if let Some(class) = unknown {
            let message = format!("the transform of class '{class}' of a channel map is taken as identity");
            out.report.warn(message, self.graph.location(map.line));
        }
        let changes = global || transform.is_some();
        Ok(changes.then_some(CoordinateMap::AffineXyz { matrix, global }))
    }

    /// `Turbulence`.
    fn turbulence(&self, fields: Members) -> Result<CoordinateMap, ReadError> {
        let octaves = self.number(fields, "octaves", 5.0)?.clamp(0.0, MOST_OCTAVES);
        Ok(CoordinateMap::Turbulence {
            amount: self.vector(fields, "amount", DVec3::splat(0.2))?,
            // At least one: the first noise is not part of the loop over octaves.
            octaves: (octaves as u32).max(1),
            frequency_ratio: self.number(fields, "frequencyRatio", 2.0)?,
            noise_ratio: self.number(fields, "noiseRatio", 2.0)?,
        })
    }
}
