//! The turtle command RN, which turns towards another node: that has to be placed already.

use crate::ReadError;
use crate::build::Builder;
use crate::classes::Class;
use crate::fields::{Field, Fields};
use crate::graph::{Graph, NodeIndex};
use crate::transform::{Frames, Oddity, turned_towards};
use crate::types::Types;
use crate::values::Kind;
use glam::{DAffine3, DVec3};
use std::collections::HashMap;

/// Nodes that some RN points to, and where they stand as soon as they are placed.
pub(crate) struct PlacedTargets(HashMap<NodeIndex, Option<DVec3>>);

impl PlacedTargets {
    pub fn new(graph: &Graph, types: &Types) -> Self {
        let is_rn = |name| types.get(name).is_some_and(|node_type| node_type.class == Class::TowardsNode);
        let commands = (0..graph.nodes.len()).filter(|i| is_rn(graph.nodes[*i].type_name));
        let targets =
            commands.filter_map(|i| target(graph, graph.values.find(graph.nodes[i].fields, "target")?));
        PlacedTargets(targets.map(|target| (target, None)).collect())
    }

    /// Notes where a node stands, if that is of interest. `is_single`: it stands in the file and at one place only.
    pub fn note(&mut self, node: NodeIndex, is_single: bool, frames: &Frames) {
        if let Some(place) = self.0.get_mut(&node).filter(|_| is_single) {
            *place = Some(frames.own.translation);
        }
    }
}

fn target(graph: &Graph, value: &crate::values::Value) -> Option<NodeIndex> {
    // That the reference is stored in a field of this name is unverified.
    let id = if value.kind == Kind::Ref { value.text() } else { return None };
    graph.by_id(id.parse().ok()?)
}

impl Builder<'_> {
    /// The frames of an RN: its head is turned as by RP, towards the origin of the target's own frame.
    pub fn towards_node(&self, fields: &Fields<'_>, parent: DAffine3) -> Result<(Frames, Oddity), ReadError> {
        let found = match fields.get("target") {
            Field::File(value) => target(self.graph, value),
            Field::Module(_) | Field::Missing => None,
        };
        let strength = fields.number("strength", 0.01)?;
        if self.groups.inside {
            let oddity =
                "it is drawn through instances, which have no common direction; its rotation is left out";
            return Ok((Frames { own: parent, post: parent }, Some(oddity.to_owned())));
        }
        let (post, oddity) = match found.map(|target| self.placed_targets.0.get(&target).copied().flatten()) {
            Some(Some(place)) => (turned_towards(parent, place, strength), None),
            Some(None) => (parent, Some("the node it turns to is placed later; its rotation is left out")),
            None => (parent, Some("the node it turns to is not in the file; its rotation is left out")),
        };
        Ok((Frames { own: parent, post }, oddity.map(str::to_owned)))
    }
}
