//! Maps that combine several values of others: `ChannelBlend`, `Smooth3D`, `Laplace3D`.

use crate::ReadError;
use crate::channels::{Channels, MISSING, MapNode};
use crate::output::Output;
use crate::values::Kind;
use scene::{BlendItem, Channel, ChannelId, DVec3, NeighbourFilter};
use std::collections::HashSet;

/// Items of a `ChannelBlend` beyond which a file is not meant seriously.
const MOST_ITEMS: usize = 1000;

impl<'a> Channels<'a> {
    /// `ChannelBlend`: x of its input chooses between its items; without items it is its input.
    pub(crate) fn blend(
        &mut self,
        map: &MapNode<'a>,
        depth: u32,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let mut items = Vec::new();
        let mut seen = HashSet::new();
        let mut next = self.graph.values.find(map.fields, "blend");
        while let Some(value) = next.filter(|value| value.kind != Kind::Null) {
            let item = self.map_node(value).filter(|item| {
                item.short_class() == "BlendItem"
                    && items.len() < MOST_ITEMS
                    && item.node.is_none_or(|node| seen.insert(node))
            });
            let Some(item) = item else {
                let message = format!(
                    "an item of a ChannelBlend is no BlendItem, contains itself, or is one of more than \
                     {MOST_ITEMS}, and is left out"
                );
                out.report.warn(message, self.graph.location(value.line));
                break;
            };
            // That a missing position is 0 is unverified.
            let position = self.number(item.fields, "value", 0.0)?;
            let channel = match self.graph.values.find(item.fields, "input") {
                Some(input) => self.channel(input, "input", depth + 1, out)?,
                None => None,
            };
            let channel = channel.unwrap_or_else(|| {
                let message = "an item of a ChannelBlend has no input; grey is used instead";
                out.report.warn(message, self.graph.location(item.line));
                self.constant(MISSING, out)
            });
            if position.is_finite() {
                items.push(BlendItem { position, channel });
            }
            next = self.graph.values.find(item.fields, "next");
        }
        if items.is_empty() {
            return self.forwarded(map, depth, out);
        }
        let coordinates = self.coordinates(map.fields, map.line, depth, out)?;
        let mean = self.mean_of(&items.iter().map(|item| item.channel).collect::<Vec<_>>());
        Ok(self.add(None, Channel::Blend { items, coordinates }, mean, out))
    }

    /// `Smooth3D` and `Laplace3D`.
    pub(crate) fn neighbour_filter(
        &mut self,
        map: &MapNode<'a>,
        depth: u32,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let number = |name| self.number(map.fields, name, 1.0);
        let step = DVec3::new(number("sx")?, number("sy")?, number("sz")?);
        let input = match self.graph.values.find(map.fields, "input") {
            Some(input) => self.channel(input, "input", depth + 1, out)?,
            None => None,
        };
        let Some(input) = input.filter(|_| step.is_finite()) else {
            let message = "a filter of a channel has no input, or no finite steps; grey is used instead";
            out.report.warn(message, self.graph.location(map.line));
            return Ok(self.constant(MISSING, out));
        };
        let (weights, mean) = match map.short_class() {
            "Smooth3D" => (NeighbourFilter::Smooth, self.mean(input)),
            _ => (NeighbourFilter::Laplace, [0.0; 3]),
        };
        Ok(self.add(None, Channel::Filter { weights, step, input }, mean, out))
    }
}
