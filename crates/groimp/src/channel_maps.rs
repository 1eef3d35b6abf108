//! Checkerboards and changes of texture coordinates.

use crate::ReadError;
use crate::channels::Channels;
use crate::fields::number_of;
use crate::output::Output;
use crate::values::{Kind, Members};
use scene::{Channel, ChannelId, CoordinateMap, DMat2, DVec2};
use std::collections::HashSet;

/// Changes of coordinates one after another; each channel holds its whole chain.
const LONGEST_CHAIN: usize = 100;

impl<'a> Channels<'a> {
    /// GroIMP's `Checker`.
    pub(crate) fn checker(
        &mut self,
        fields: Members,
        line: usize,
        depth: u32,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let coordinates = self.coordinates(fields, line, out)?;
        let mut color = |name, default: f64| -> Result<ChannelId, ReadError> {
            let map = match self.graph.values.find(fields, name) {
                Some(value) => self.channel(value, name, depth + 1, out)?,
                None => None,
            };
            Ok(map.unwrap_or_else(|| self.constant([default; 3], out)))
        };
        let odd = color("color1", 1.0)?;
        let even = color("color2", 0.0)?;
        let (a, b) = (self.mean(odd), self.mean(even));
        let mean = [0, 1, 2].map(|c| 0.5 * (a[c] + b[c]));
        Ok(self.add(None, Channel::Checker { odd, even, coordinates }, mean, out))
    }

    /// The chain of coordinate maps that starts at the field `input`, in the order of application: the input of
    /// a map comes before the map itself.
    pub(crate) fn coordinates(
        &self,
        fields: Members,
        line: usize,
        out: &mut Output,
    ) -> Result<Vec<CoordinateMap>, ReadError> {
        let mut maps = Vec::new();
        let mut seen = HashSet::new();
        let (mut fields, mut line) = (fields, line);
        while let Some(input) = self.graph.values.find(fields, "input").filter(|v| v.kind != Kind::Null) {
            let map = self.map_node(input);
            let supported = map.filter(|map| {
                map.short_class() == "AffineUVTransformation" && map.node.is_none_or(|node| seen.insert(node))
            });
            let Some(map) = supported else {
                let class = self.map_node(input).map_or("?", |map| map.class);
                let message = format!(
                    "the input of class '{class}' of a channel map is not supported yet, or contains itself, \
                     and is left out"
                );
                out.report.warn(message, self.graph.location(line));
                break;
            };
            if maps.len() == LONGEST_CHAIN {
                let message = format!("more than {LONGEST_CHAIN} inputs of a channel map are left out");
                out.report.warn(message, self.graph.location(line));
                break;
            }
            (fields, line) = (map.fields, map.line);
            match self.affine_uv(fields)? {
                Some(affine) => maps.push(affine),
                None => out.report.warn(
                    "an AffineUVTransformation has numbers that are not finite and is left out".to_owned(),
                    self.graph.location(line),
                ),
            }
        }
        maps.reverse();
        Ok(maps)
    }

    /// `AffineUVTransformation`; `None` if it is not made of finite numbers.
    fn affine_uv(&self, fields: Members) -> Result<Option<CoordinateMap>, ReadError> {
        let number = |name, default| match self.graph.values.find(fields, name) {
            Some(value) => number_of(self.graph, value, "AffineUVTransformation", name),
            None => Ok(default),
        };
        let offset = DVec2::new(number("offsetU", 0.0)?, number("offsetV", 0.0)?);
        let (scale_u, scale_v) = (number("scaleU", 1.0)?, number("scaleV", 1.0)?);
        let shear = number("shear", 0.0)?;
        let turn = DMat2::from_angle(-number("angle", 0.0)?);
        let stretch = DMat2::from_cols(DVec2::new(scale_u, 0.0), DVec2::new(-shear * scale_v, scale_v));
        let linear = stretch * turn;
        let finite = offset.is_finite() && linear.is_finite();
        Ok(finite.then_some(CoordinateMap::AffineUv { offset, linear }))
    }
}
