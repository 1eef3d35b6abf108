//! Instances: the tree of a master, drawn once as a group and placed as often as the project says.
//!
//! A master is drawn in a space of its own, with the shader and the turtle state that its instance hands on; a
//! second state makes a second group. Tropisms in it act as if the group stood upright at the origin (unverified).

use crate::build::{Builder, Inherited, Root};
use crate::classes::{Amount, Class};
use crate::fields::Fields;
use crate::graph::NodeIndex;
use crate::transform;
use crate::{Limits, ReadError};
use glam::DAffine3;
use scene::{Group, GroupId, Instance, Origin};
use std::collections::{HashMap, VecDeque};

/// Groups that one master may become, one for each state that its instances hand on.
const MOST_STATES: usize = 1024;

/// What the groups of a project are made of.
pub(crate) struct Groups {
    known: HashMap<Root, Vec<(Inherited, GroupId)>>,
    pending: VecDeque<(GroupId, Root, Inherited)>,
    nodes_left: usize,
    instances_left: usize,
    /// Whether what is drawn now belongs to a group.
    pub inside: bool,
}

impl Groups {
    /// No groups yet.
    pub fn within(limits: Limits) -> Self {
        Groups {
            known: HashMap::new(),
            pending: VecDeque::new(),
            nodes_left: limits.group_nodes,
            instances_left: limits.instances,
            inside: false,
        }
    }
}

impl Builder<'_> {
    /// The group of a tree whose root starts with `start`, whatever its frame; `None` if there are too many.
    fn group(&mut self, root: Root, start: Inherited) -> Option<GroupId> {
        let start = Inherited { frame: DAffine3::IDENTITY, ..start };
        let known = self.groups.known.entry(root).or_default();
        if let Some((_, id)) = known.iter().rev().find(|(state, _)| *state == start) {
            return Some(*id);
        }
        if known.len() >= MOST_STATES {
            let message = format!(
                "an instance's master is used with more than {MOST_STATES} different shaders or turtle states; \
                 further ones are not drawn"
            );
            self.out.report.warn(message, None);
            return None;
        }
        let id = self.out.scene.add_group(Group::default());
        known.push((start, id));
        self.groups.pending.push_back((id, root, start));
        Some(id)
    }

    /// Draws an `Instance3D` of `master` and tells from which frame its children start.
    pub fn instance(
        &mut self,
        master: NodeIndex,
        fields: &Fields<'_>,
        own: DAffine3,
        start: Inherited,
        origin: Origin,
    ) -> Result<DAffine3, ReadError> {
        if let Some(group) = self.group(Root::Node(master), start) {
            self.place_group(Instance { group, world_from_group: own, origin });
        }
        let terminal = match fields.number("exportedTransformation", 0.0)? {
            1.0 => self.terminal(master, start)?,
            2.0 => DAffine3::from_translation(self.terminal(master, start)?.translation),
            _ => DAffine3::IDENTITY,
        };
        Ok(own * terminal)
    }

    /// Draws the children of a `GridClonerNode` at every place of its grid, the first quadrant as GroIMP's light
    /// model does. That a picture shows them, too, is unverified.
    pub fn grid_of_clones(
        &mut self,
        fields: &Fields<'_>,
        start: Inherited,
        origin: Origin,
    ) -> Result<(), ReadError> {
        let cells = |name| Ok::<f64, ReadError>(fields.number(name, 10.0)?.floor().max(0.0));
        let (columns, rows) = (cells("xCount")?, cells("yCount")?);
        let step = (fields.number("xDistance", 10.0)?, fields.number("yDistance", 10.0)?);
        if !(step.0.is_finite() && step.1.is_finite()) {
            self.out
                .report
                .skip(self.graph.type_name(fields.node), "the distances of its grid are not finite");
            return Ok(());
        }
        let Some(group) = self.group(Root::ChildrenOf(fields.node), start) else { return Ok(()) };
        // Saturating; placing ends at the limit.
        for row in 0..rows as u32 {
            for column in 0..columns as u32 {
                let offset = glam::DVec3::new(f64::from(column) * step.0, f64::from(row) * step.1, 0.0);
                let world_from_group = start.frame * DAffine3::from_translation(offset);
                if !self.place_group(Instance { group, world_from_group, origin }) {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Adds an instance; false if there are too many.
    fn place_group(&mut self, instance: Instance) -> bool {
        if self.groups.instances_left == 0 {
            let message =
                "the project has too many instances, those in grids included; the rest is not drawn";
            self.out.report.warn(message, None);
            return false;
        }
        self.groups.instances_left -= 1;
        self.out.scene.instances.push(instance);
        true
    }

    /// Draws the groups that instances have asked for, until none is left.
    pub fn draw_groups(&mut self) -> Result<(), ReadError> {
        self.groups.inside = true;
        let mut main = Group::default();
        self.swap_members(&mut main);
        while let Some((id, root, start)) = self.groups.pending.pop_front() {
            self.groups.nodes_left = self.draw_tree(root, start, self.groups.nodes_left)?;
            if self.groups.nodes_left == 0 {
                let message = "the masters of this project's instances have too many nodes in all their uses; \
                               the rest of them is not drawn";
                self.out.report.warn(message, None);
            }
            let mut group = Group::default();
            self.swap_members(&mut group);
            self.out.scene.groups[id.index()] = group;
        }
        self.swap_members(&mut main);
        self.groups.inside = false;
        self.cut_cycles();
        Ok(())
    }

    fn swap_members(&mut self, group: &mut Group) {
        let scene = &mut self.out.scene;
        std::mem::swap(&mut scene.objects, &mut group.objects);
        std::mem::swap(&mut scene.lights, &mut group.lights);
        std::mem::swap(&mut scene.instances, &mut group.instances);
    }

    /// Takes away instances through which a group would contain itself.
    fn cut_cycles(&mut self) {
        #[derive(Clone, Copy, PartialEq)]
        enum Visit {
            Never,
            Open,
            Done,
        }
        let groups = &mut self.out.scene.groups;
        let mut visits = vec![Visit::Never; groups.len()];
        let mut cut = 0;
        for first in 0..groups.len() {
            let mut path = vec![(first, 0usize)];
            while let Some((index, next)) = path.last_mut() {
                visits[*index] = if visits[*index] == Visit::Done { Visit::Done } else { Visit::Open };
                let Some(instance) = groups[*index].instances.get(*next) else {
                    visits[*index] = Visit::Done;
                    path.pop();
                    continue;
                };
                let inner = instance.group.index();
                match visits[inner] {
                    Visit::Open => {
                        groups[*index].instances.remove(*next);
                        cut += 1;
                    }
                    Visit::Done => *next += 1,
                    Visit::Never => {
                        *next += 1;
                        path.push((inner, 0));
                    }
                }
            }
        }
        if cut > 0 {
            let message = format!("{cut} instances would contain themselves; they are left out");
            self.out.report.warn(message, None);
        }
    }

    /// The frame at the end of the chain of successors that starts with a master, relative to the start of it.
    fn terminal(&mut self, master: NodeIndex, start: Inherited) -> Result<DAffine3, ReadError> {
        let mut frame = DAffine3::IDENTITY;
        let mut state = start.state;
        let mut node = Some(master);
        // A chain that is longer than the graph is a cycle.
        for _ in 0..self.graph.nodes.len() {
            let Some(index) = node else { break };
            if let Some(node_type) = self.types.get(self.graph.node(index).type_name) {
                let defaults = &node_type.defaults;
                let fields = Fields { graph: self.graph, node: index, in_file: true, defaults };
                let (frames, _) = transform::frames(node_type.class, &fields, frame, &state)?;
                frame = frames.post;
                match node_type.class {
                    Class::Shoot(amount) => {
                        state.length.local = transform::turtle_length(&fields, amount, &state)?;
                    }
                    Class::State(command) => {
                        let argument = fields.number("argument", command.default_argument())?;
                        state = command.apply(&state, &self.initial, argument, None);
                    }
                    Class::Gravity(Amount::State | Amount::Mul) => state.tropism.local = state.tropism.main,
                    _ => {}
                }
            }
            node = self.graph.successor(index);
        }
        Ok(frame)
    }
}
