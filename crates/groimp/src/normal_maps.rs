//! Maps that bend the shading normal: `BumpMap` and `WaveMap` in the `input` of a Phong (that they belong there is
//! unverified).

use crate::ReadError;
use crate::channels::{Channels, MISSING, MapNode, forwards_colors};
use crate::output::Output;
use crate::values::{Kind, Members};
use scene::{Channel, ChannelId, CoordinateMap, DVec2, NormalMap};
use std::collections::HashSet;

/// Metres per unit of a `BumpMap`'s displacement.
const BUMP_HEIGHT: f64 = 0.02;
/// Distance in u and v over which GroIMP differentiates maps, checkerboards and waves (per wave).
const STEP: f64 = 0.005;
const CHECKER_STEP: f64 = 0.05;
/// Waves per unit of u beyond which 32-bit numbers cannot hold them apart.
const MOST_WAVES: f64 = 1e4;

impl<'a> Channels<'a> {
    /// The normal maps in the chain of inputs of a shader; the innermost comes first. Maps of coordinates in the
    /// chain have no effect on normals.
    pub(crate) fn normal_maps(
        &mut self,
        fields: Members,
        out: &mut Output,
    ) -> Result<Vec<NormalMap>, ReadError> {
        let mut maps = Vec::new();
        let mut seen = HashSet::new();
        let mut fields = fields;
        while let Some(input) = self.graph.values.find(fields, "input").filter(|v| v.kind != Kind::Null) {
            let map = self.map_node(input).filter(|map| {
                forwards_colors(map.short_class()) && map.node.is_none_or(|node| seen.insert(node))
            });
            let Some(map) = map else {
                let message =
                    "the input of a shader is no map of normals, or contains itself, and is left out";
                out.report.warn(message, self.graph.location(input.line));
                break;
            };
            fields = map.fields;
            maps.extend(match map.short_class() {
                "BumpMap" => self.bump_map(&map, out)?,
                "WaveMap" => self.wave_map(&map, out)?,
                _ => None,
            });
        }
        maps.reverse();
        Ok(maps)
    }

    fn bump_map(&mut self, map: &MapNode<'a>, out: &mut Output) -> Result<Option<NormalMap>, ReadError> {
        let scale = BUMP_HEIGHT * self.number(map.fields, "strength", 1.0)?;
        let Some(value) = self.graph.values.find(map.fields, "displacement") else { return Ok(None) };
        let Some(displacement) = self.channel(value, "displacement", 1, out)? else { return Ok(None) };
        let step = slope_step(displacement, out);
        Ok(self.finite(NormalMap { displacement, scale, step, box_top: false }, map, out))
    }

    fn wave_map(&mut self, map: &MapNode<'a>, out: &mut Output) -> Result<Option<NormalMap>, ReadError> {
        let number = |name, default| self.number(map.fields, name, default);
        let scale = number("amplitude", 1.0)?;
        let mut count = DVec2::new(number("uCount", 10.0)?, number("vCount", 10.0)?);
        let box_top = self.graph.values.find(map.fields, "boxTop").is_some_and(|v| v.text() == "true");
        if box_top {
            // The top of a box is a quarter of the width and a third of the height of its cross.
            count *= DVec2::new(4.0, 3.0);
        }
        let coordinates: Vec<CoordinateMap> = self.coordinates(map.fields, map.line, 1, out)?;
        if count.is_finite() {
            count = count.clamp(DVec2::splat(-MOST_WAVES), DVec2::splat(MOST_WAVES));
        }
        let displacement = self.add(None, Channel::Waves { count, coordinates }, MISSING, out);
        let step = STEP / count.abs().max(DVec2::ONE);
        Ok(self.finite(NormalMap { displacement, scale, step, box_top }, map, out))
    }

    fn finite(&self, normals: NormalMap, map: &MapNode<'a>, out: &mut Output) -> Option<NormalMap> {
        let finite = normals.scale.is_finite() && normals.step.is_finite();
        if !finite {
            let message = "the numbers of a map of normals are not finite and it is left out";
            out.report.warn(message, self.graph.location(map.line));
        }
        finite.then_some(normals)
    }
}

/// The distance in u and v over which GroIMP differentiates a map: a pixel of a picture, 0.05 for checkerboards.
fn slope_step(displacement: ChannelId, out: &Output) -> DVec2 {
    match out.scene.channels.get(displacement.index()) {
        Some(Channel::ImageMap { image, .. }) => match out.scene.images.get(image.index()) {
            Some(image) => DVec2::new(1.0 / f64::from(image.width), 1.0 / f64::from(image.height)),
            None => DVec2::splat(STEP),
        },
        Some(Channel::Checker { .. }) => DVec2::splat(CHECKER_STEP),
        _ => DVec2::splat(STEP),
    }
}
