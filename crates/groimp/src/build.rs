//! From the graph to the scene: depth-first along the tree edges, with an explicit stack.

use crate::body::Bodies;
use crate::classes::{Amount, AxisShape, Class, Skip};
use crate::distributions::Distributions;
use crate::fields::{Field, Fields};
use crate::graph::{Graph, Node, NodeIndex};
use crate::groups::Groups;
use crate::interiors;
use crate::lights;
use crate::meshes::Meshes;
use crate::module_lights;
use crate::modules::{Sources, StaticValue};
use crate::output::Output;
use crate::shaders::{GRAY, ShaderSource, Shaders};
use crate::shapes::{self, Geometry};
use crate::surfaces::{SurfaceClass, Surfaces};
use crate::targets::PlacedTargets;
use crate::transform::{self, Frames};
use crate::turtle_state::{EGA_COLORS, StateCommand, TurtleState, initial_turtle_state};
use crate::types::Types;
use crate::view::View;
use crate::{Limits, ReadError};
use glam::{DAffine3, DVec3};
use scene::{Interior, MaterialId, Object, Origin};

/// A drawn node's frames; what tests compare with known figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnFrames {
    /// Id of the node.
    pub node: i64,
    /// Origin of the frame that the geometry lives in.
    pub own_origin: DVec3,
    /// Origin of the frame that children start from.
    pub post_origin: DVec3,
}

/// What a node inherits from its parent.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Inherited {
    pub frame: DAffine3,
    pub state: TurtleState,
    pub material: MaterialId,
    pub interior: Option<Interior>,
}

/// Where a tree that is drawn starts.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Root {
    /// With this node.
    Node(NodeIndex),
    /// With the children of this node.
    ChildrenOf(NodeIndex),
}

/// What a node hands on.
pub(crate) struct Placed {
    pub for_children: Inherited,
    /// What the content of its body starts with.
    pub for_body: Inherited,
}

/// A node on the path from the root to the current one.
struct OnPath {
    node: NodeIndex,
    next_edge: usize,
    last_edge: usize,
    for_children: Inherited,
}

/// How far the traversal of a tree has come with a node. Every tree has its number, so that the table serves all.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Visit {
    OnPath(u32),
    Done(u32),
}

/// What a project consists of, once its files are read.
pub(crate) struct Parts<'a> {
    pub graph: &'a Graph,
    pub view: &'a View,
    pub types: &'a Types,
    pub sources: &'a Sources,
    pub shaders: Shaders<'a>,
    pub surfaces: Surfaces,
}

pub(crate) struct Builder<'a> {
    pub graph: &'a Graph,
    pub view: &'a View,
    pub types: &'a Types,
    pub sources: &'a Sources,
    pub bodies: Bodies,
    pub shaders: Shaders<'a>,
    pub out: Output,
    pub frames: Vec<DrawnFrames>,
    pub groups: Groups,
    pub initial: TurtleState,
    meshes: Meshes,
    surfaces: Surfaces,
    pub placed_targets: PlacedTargets,
    pub distributions: Distributions,
    visits: Vec<Visit>,
    tree: u32,
    pub has_light: bool,
}

impl<'a> Builder<'a> {
    pub fn new(parts: Parts<'a>, out: Output, limits: Limits) -> Self {
        let Parts { graph, view, types, sources, shaders, surfaces } = parts;
        let initial = TurtleState::default();
        Builder {
            graph,
            view,
            types,
            sources,
            bodies: Bodies::within(limits),
            shaders,
            out,
            frames: Vec::new(),
            surfaces,
            placed_targets: PlacedTargets::new(graph, types),
            distributions: Distributions::default(),
            groups: Groups::within(limits),
            initial,
            meshes: Meshes::default(),
            visits: vec![Visit::Done(0); graph.nodes.len()],
            tree: 0,
            has_light: false,
        }
    }

    /// Draws everything that hangs below the root of the main graph.
    pub fn build(&mut self) -> Result<(), ReadError> {
        self.initial = initial_turtle_state(self.graph)?;
        let material = self.shaders.predefined(GRAY, &mut self.out);
        let root = Inherited { frame: DAffine3::IDENTITY, state: self.initial, material, interior: None };
        self.draw_tree(Root::Node(self.graph.main_root), root, usize::MAX)?;
        self.draw_groups()?;
        self.out.scene.camera = self.view.camera.clone();
        if !self.has_light {
            self.add_default_light();
        }
        Ok(())
    }

    /// Draws a tree of at most `nodes_left` nodes and returns how many are left then.
    pub fn draw_tree(
        &mut self,
        root: Root,
        start: Inherited,
        mut nodes_left: usize,
    ) -> Result<usize, ReadError> {
        // Fewer trees than nodes.
        self.tree += 1;
        let mut path = Vec::new();
        match root {
            Root::Node(node) => self.enter(node, start, &mut path)?,
            Root::ChildrenOf(node) => self.descend(node, start, &mut path),
        }
        while let Some(top) = path.last_mut() {
            if top.next_edge == top.last_edge {
                self.visits[top.node.index()] = Visit::Done(self.tree);
                path.pop();
                continue;
            }
            let child = self.graph.target(top.next_edge);
            top.next_edge += 1;
            let inherited = top.for_children;
            match self.visits[child.index()] {
                Visit::OnPath(tree) | Visit::Done(tree) if tree != self.tree => {
                    if nodes_left == 0 {
                        return Ok(0);
                    }
                    nodes_left -= 1;
                    self.enter(child, inherited, &mut path)?;
                }
                again => self.reached_again(child, again),
            }
        }
        Ok(nodes_left)
    }

    fn enter(
        &mut self,
        node: NodeIndex,
        inherited: Inherited,
        path: &mut Vec<OnPath>,
    ) -> Result<(), ReadError> {
        let for_children = self.node(node, inherited)?;
        self.descend(node, for_children, path);
        if self.types.class(self.graph.node(node).type_name) == Some(Class::GridCloner) {
            // Its children stand in the cells of its grid instead.
            let top = path.last_mut().filter(|top| top.node == node);
            top.into_iter().for_each(|top| top.next_edge = top.last_edge);
        }
        Ok(())
    }

    fn descend(&mut self, node: NodeIndex, for_children: Inherited, path: &mut Vec<OnPath>) {
        self.visits[node.index()] = Visit::OnPath(self.tree);
        let edges = self.graph.edges_of(node);
        path.push(OnPath { node, next_edge: edges.start, last_edge: edges.end, for_children });
    }

    fn reached_again(&mut self, node: NodeIndex, visit: Visit) {
        let node = self.graph.node(node);
        let message = if matches!(visit, Visit::OnPath(_)) {
            format!("node {} is its own descendant; the cycle is cut", node.id)
        } else {
            format!("node {} can be reached by two paths; it is drawn at the first", node.id)
        };
        self.out.report.warn(message, self.graph.location(node.line));
    }

    /// Draws one node of the file, with its body, and tells what its children inherit.
    fn node(&mut self, node: NodeIndex, inherited: Inherited) -> Result<Inherited, ReadError> {
        let Node { type_name, line, .. } = *self.graph.node(node);
        let Some(node_type) = self.types.get(type_name) else { return Ok(inherited) };
        node_type.report(self.graph.location(line), &mut self.out.report);
        let fields = Fields { graph: self.graph, node, in_file: true, defaults: &node_type.defaults };
        let placed = self.place(node_type.class, &fields, inherited)?;
        if let Some(module) = node_type.body {
            self.draw_body(module, &fields, placed.for_body)?;
        }
        Ok(placed.for_children)
    }

    /// Draws a node of the file or of a body.
    pub fn place(
        &mut self,
        class: Class,
        fields: &Fields<'_>,
        inherited: Inherited,
    ) -> Result<Placed, ReadError> {
        let node = fields.node;
        let location = self.graph.location(self.graph.node(node).line);
        let Inherited { frame, mut state, mut material, mut interior } = inherited;
        if class == Class::RggRoot {
            state = self.initial;
        }
        let (mut frames, oddity) = match class {
            Class::TowardsNode => self.towards_node(fields, frame)?,
            _ => transform::frames(class, fields, frame, &state)?,
        };
        self.placed_targets.note(node, fields.in_file && !self.groups.inside, &frames);
        if let Some(oddity) = oddity {
            let message = format!("{}: {oddity}", self.graph.type_name(node));
            self.out.report.warn(message, location);
        }
        let sun_sky = if class == Class::Sky { self.sun_sky(fields) } else { None };
        if class.has_shader() && sun_sky.is_none() {
            material = self.shader_field(fields)?.unwrap_or(material);
            if let Field::File(value) = fields.get("interior") {
                let filling =
                    interiors::interior(value, self.graph, &self.shaders.references, &mut self.out.report)?;
                interior = filling.or(interior);
            }
        }
        let site = Site { node, class, frames, interior };
        match class {
            Class::Shoot(amount) => material = self.shoot(&site, fields, amount, &mut state, material)?,
            Class::State(command) => {
                (state, material) = self.state_command(command, fields, &state, material)?;
            }
            Class::Gravity(Amount::State | Amount::Mul) => state.tropism.local = state.tropism.main,
            Class::LightNode => self.light(&site, fields)?,
            Class::Sky => self.sky(&site, fields, sun_sky, material)?,
            Class::Sphere => self.draw(&site, fields, shapes::sphere(fields)?, material)?,
            Class::Plane => {
                let shape = scene::Shape::Plane;
                let geometry = Geometry { shape, own_from_object: DAffine3::IDENTITY };
                self.draw(&site, fields, Some(geometry), material)?;
            }
            Class::Mesh => self.mesh(&site, fields, material)?,
            Class::Surface(surface) => self.surface(&site, surface, fields, material)?,
            Class::Axis(shape) => {
                self.draw(&site, fields, shapes::axis_shape(shape, fields)?, material)?;
            }
            Class::Instance => frames.post = self.place_instance(&site, fields, inherited, material)?,
            Class::GridCloner => {
                let start = Inherited { frame: frames.post, state, material, interior };
                let origin = self.origin(node);
                self.grid_of_clones(fields, start, origin)?;
            }
            Class::Line => self.skip(node, Skip::NotVisible.reason()),
            Class::Skipped(skip) => self.skip(node, skip.reason()),
            Class::Plain
            | Class::RggRoot
            | Class::Null
            | Class::Move(_)
            | Class::Rotation(_)
            | Class::RotateXyz
            | Class::Scale
            | Class::Translate
            | Class::AdjustLu
            | Class::Gravity(_)
            | Class::HeadDown
            | Class::Directional
            | Class::TowardsPoint
            | Class::Orthogonal
            | Class::TowardsNode
            | Class::Alias(_) => {}
        }
        let for_children = Inherited { frame: frames.post, state, material, interior };
        // Which turtle state a body starts with is unverified.
        Ok(Placed { for_children, for_body: Inherited { frame: frames.own, ..for_children } })
    }

    /// Draws an `Instance3D` and returns the frame of its children.
    fn place_instance(
        &mut self,
        site: &Site,
        fields: &Fields<'_>,
        inherited: Inherited,
        material: MaterialId,
    ) -> Result<DAffine3, ReadError> {
        let Frames { own, post } = site.frames;
        let layer = fields.number("layer", site.class.default_layer())? as i64;
        let master = self.graph.master(site.node).filter(|_| fields.in_file);
        let Some(master) = master else {
            self.skip(site.node, "it refers to no master");
            return Ok(post);
        };
        if !self.view.shows(layer) {
            self.skip(site.node, "its layer is hidden in the saved view");
            return Ok(post);
        }
        if !shapes::is_invertible(&own) {
            self.skip(site.node, "its transformation is flat or not a number");
            return Ok(post);
        }
        let interior = site.interior;
        let start = Inherited { frame: own, state: inherited.state, material, interior };
        let origin = self.origin(site.node);
        let exported = self.instance(master, fields, own, start, origin)?;
        // What the master exports counts only where the instance moves its children at all.
        Ok(if fields.flag("transforming", true)? { exported } else { post })
    }

    pub fn skip(&mut self, node: NodeIndex, reason: &str) {
        self.out.report.skip(self.graph.type_name(node), reason);
    }

    /// The node's own shader; `None` means: inherit.
    fn shader_field(&mut self, fields: &Fields<'_>) -> Result<Option<MaterialId>, ReadError> {
        let source = match fields.get("shader") {
            Field::File(value) => ShaderSource::Value(value),
            Field::Module(StaticValue::Shader(shader)) => ShaderSource::Module(shader),
            Field::Module(_) | Field::Missing => return Ok(None),
        };
        self.shaders.resolve(source, &mut self.out)
    }

    fn shoot(
        &mut self,
        site: &Site,
        fields: &Fields<'_>,
        amount: Amount,
        state: &mut TurtleState,
        inherited: MaterialId,
    ) -> Result<MaterialId, ReadError> {
        let length = transform::turtle_length(fields, amount, state)?;
        let stored = fields.number("diameter", -1.0)?;
        let diameter = if stored >= 0.0 { stored } else { state.diameter.local };
        let color = fields.number("color", -1.0)?.round() as i64;
        let material = if let Some(shader) = self.shader_field(fields)? {
            state.color.local = -1;
            state.shader.local = Some(shader);
            shader
        } else {
            if color >= 0 {
                state.color.local = color;
            }
            match state.color.local {
                0.. => self.ega(state.color.local),
                _ => state.shader.local.unwrap_or(inherited),
            }
        };
        state.length.local = length;
        state.diameter.local = diameter;
        self.draw(site, fields, shapes::shoot(length, diameter), material)?;
        Ok(material)
    }

    fn ega(&mut self, color: i64) -> MaterialId {
        // Lossless: the remainder is below 16.
        self.shaders.predefined(color.rem_euclid(EGA_COLORS) as u32, &mut self.out)
    }

    fn state_command(
        &mut self,
        command: StateCommand,
        fields: &Fields<'_>,
        state: &TurtleState,
        inherited: MaterialId,
    ) -> Result<(TurtleState, MaterialId), ReadError> {
        let argument = fields.number("argument", command.default_argument())?;
        if !command.sets_color() {
            return Ok((command.apply(state, &self.initial, argument, None), inherited));
        }
        let shader = if argument >= 0.0 {
            Some(self.ega(argument.round() as i64))
        } else {
            self.shader_field(fields)?
        };
        // Pl is for the next shoot only.
        let material = if command.is_local() { inherited } else { shader.unwrap_or(inherited) };
        Ok((command.apply(state, &self.initial, argument, shader), material))
    }

    fn mesh(&mut self, site: &Site, fields: &Fields<'_>, material: MaterialId) -> Result<(), ReadError> {
        let geometry = self.meshes.geometry(fields, &mut self.out.scene)?;
        self.draw_or_skip(site, fields, geometry, material)
    }

    fn surface(
        &mut self,
        site: &Site,
        class: SurfaceClass,
        fields: &Fields<'_>,
        material: MaterialId,
    ) -> Result<(), ReadError> {
        let geometry = self.surfaces.geometry(class, fields, &mut self.out)?;
        self.draw_or_skip(site, fields, geometry, material)
    }

    fn draw_or_skip(
        &mut self,
        site: &Site,
        fields: &Fields<'_>,
        geometry: Result<Geometry, String>,
        material: MaterialId,
    ) -> Result<(), ReadError> {
        match geometry {
            Ok(geometry) => self.draw(site, fields, Some(geometry), material),
            Err(reason) => {
                self.record(site);
                self.out.report.skip(self.graph.type_name(site.node), reason);
                Ok(())
            }
        }
    }

    fn draw(
        &mut self,
        site: &Site,
        fields: &Fields<'_>,
        geometry: Option<Geometry>,
        material: MaterialId,
    ) -> Result<(), ReadError> {
        self.record(site);
        let type_name = self.graph.type_name(site.node);
        let layer = fields.number("layer", site.class.default_layer())? as i64;
        let visible = self.view.shows(layer);
        let mut emission = None;
        if site.class == Class::Axis(AxisShape::Parallelogram) {
            let color = self.shaders.mean(material);
            let light = match fields.get("light") {
                Field::Module(StaticValue::Light(light)) => Some(module_lights::area_light(light, color)),
                _ => lights::area_light(fields, color)?,
            };
            match light {
                Some(Ok(light)) => emission = Some(light),
                Some(Err(reason)) => self.out.report.skip(type_name, reason),
                None => {}
            }
        }
        let Some(geometry) = geometry else {
            self.skip(site.node, "it has no extent");
            return Ok(());
        };
        if !visible {
            self.skip(site.node, "its layer is hidden in the saved view");
            return Ok(());
        }
        let world_from_object = site.frames.own * geometry.own_from_object;
        if !shapes::is_invertible(&world_from_object) {
            self.skip(site.node, "its transformation is flat or not a number");
            return Ok(());
        }
        self.has_light |= emission.is_some();
        let origin = self.origin(site.node);
        let shape = geometry.shape;
        let interior = site.interior;
        let object = Object { shape, world_from_object, material, emission, interior, origin };
        self.out.scene.objects.push(object);
        Ok(())
    }

    fn record(&mut self, site: &Site) {
        if self.groups.inside {
            return;
        }
        self.frames.push(DrawnFrames {
            node: self.graph.node(site.node).id,
            own_origin: site.frames.own.translation,
            post_origin: site.frames.post.translation,
        });
    }

    pub fn origin(&mut self, node: NodeIndex) -> Origin {
        self.out.origin(self.graph.node(node).id, self.graph.type_name(node))
    }
}

/// A node and where it stands.
pub(crate) struct Site {
    pub node: NodeIndex,
    pub class: Class,
    pub frames: Frames,
    interior: Option<Interior>,
}
