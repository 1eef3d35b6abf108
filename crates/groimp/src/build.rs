//! From the graph to the scene: depth-first along the tree edges, with an explicit stack.

use crate::body::Bodies;
use crate::classes::{Amount, AxisShape, Class, Skip};
use crate::fields::{Field, Fields};
use crate::graph::{Graph, Node, NodeIndex};
use crate::lights::{self, LightValue};
use crate::meshes::Meshes;
use crate::modules::{Sources, StaticValue};
use crate::output::Output;
use crate::shaders::{GRAY, ShaderSource, Shaders};
use crate::shapes::{self, Geometry};
use crate::transform::{self, Frames};
use crate::turtle_state::{EGA_COLORS, StateCommand, TurtleState, initial_turtle_state};
use crate::types::Types;
use crate::values::Kind;
use crate::view::View;
use crate::{Limits, ReadError};
use glam::{DAffine3, DVec3};
use scene::{Light, MaterialId, Object, Origin, Sky};

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
#[derive(Clone, Copy)]
pub(crate) struct Inherited {
    pub frame: DAffine3,
    state: TurtleState,
    material: MaterialId,
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

#[derive(Clone, Copy, PartialEq, Eq)]
enum Visit {
    Never,
    OnPath,
    Done,
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
    meshes: Meshes,
    initial: TurtleState,
    has_light: bool,
}

impl<'a> Builder<'a> {
    pub fn new(
        graph: &'a Graph,
        view: &'a View,
        types: &'a Types,
        sources: &'a Sources,
        shaders: Shaders<'a>,
        out: Output,
        limits: Limits,
    ) -> Self {
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
            meshes: Meshes::default(),
            initial,
            has_light: false,
        }
    }

    /// Draws everything that hangs below the root of the main graph.
    pub fn build(&mut self) -> Result<(), ReadError> {
        self.initial = initial_turtle_state(self.graph)?;
        let material = self.shaders.predefined(GRAY, &mut self.out);
        let root = Inherited { frame: DAffine3::IDENTITY, state: self.initial, material };
        let mut visits = vec![Visit::Never; self.graph.nodes.len()];
        let mut path = Vec::new();
        self.enter(self.graph.main_root, root, &mut visits, &mut path)?;
        while let Some(top) = path.last_mut() {
            if top.next_edge == top.last_edge {
                visits[top.node.index()] = Visit::Done;
                path.pop();
                continue;
            }
            let child = self.graph.target(top.next_edge);
            top.next_edge += 1;
            let inherited = top.for_children;
            match visits[child.index()] {
                Visit::Never => self.enter(child, inherited, &mut visits, &mut path)?,
                again => self.reached_again(child, again),
            }
        }
        self.out.scene.camera = self.view.camera.clone();
        if !self.has_light {
            self.add_default_light();
        }
        Ok(())
    }

    fn enter(
        &mut self,
        node: NodeIndex,
        inherited: Inherited,
        visits: &mut [Visit],
        path: &mut Vec<OnPath>,
    ) -> Result<(), ReadError> {
        visits[node.index()] = Visit::OnPath;
        let for_children = self.node(node, inherited)?;
        let edges = self.graph.edges_of(node);
        path.push(OnPath { node, next_edge: edges.start, last_edge: edges.end, for_children });
        Ok(())
    }

    fn reached_again(&mut self, node: NodeIndex, visit: Visit) {
        let node = self.graph.node(node);
        let message = if visit == Visit::OnPath {
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
        let Inherited { frame, mut state, mut material } = inherited;
        if class == Class::RggRoot {
            state = self.initial;
        }
        let (frames, oddity) = transform::frames(class, fields, frame, &state)?;
        if let Some(oddity) = oddity {
            let message = format!("{}: {oddity}", self.graph.type_name(node));
            self.out.report.warn(message, location);
        }
        if class.has_shader() {
            material = self.shader_field(fields)?.unwrap_or(material);
        }
        let site = Site { node, class, frames };
        match class {
            Class::Shoot(amount) => material = self.shoot(&site, fields, amount, &mut state, material)?,
            Class::State(command) => {
                (state, material) = self.state_command(command, fields, &state, material)?;
            }
            Class::Gravity(Amount::State | Amount::Mul) => state.tropism.local = state.tropism.main,
            Class::LightNode => self.light(&site, fields)?,
            Class::Sky => self.sky(&site, fields, material)?,
            Class::Sphere => self.draw(&site, fields, shapes::sphere(fields)?, material)?,
            Class::Plane => {
                let shape = scene::Shape::Plane;
                let geometry = Geometry { shape, own_from_object: DAffine3::IDENTITY };
                self.draw(&site, fields, Some(geometry), material)?;
            }
            Class::Mesh => self.mesh(&site, fields, material)?,
            Class::Axis(shape) => {
                self.draw(&site, fields, shapes::axis_shape(shape, fields)?, material)?;
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
            | Class::UnknownTurn => {}
        }
        let for_children = Inherited { frame: frames.post, state, material };
        // Which turtle state a body starts with is unverified.
        Ok(Placed { for_children, for_body: Inherited { frame: frames.own, ..for_children } })
    }

    fn skip(&mut self, node: NodeIndex, reason: &str) {
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
        match self.meshes.geometry(fields, &mut self.out.scene)? {
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
            match lights::area_light(fields, color)? {
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
        self.out.scene.objects.push(Object { shape, world_from_object, material, emission, origin });
        Ok(())
    }

    fn record(&mut self, site: &Site) {
        self.frames.push(DrawnFrames {
            node: self.graph.node(site.node).id,
            own_origin: site.frames.own.translation,
            post_origin: site.frames.post.translation,
        });
    }

    fn origin(&mut self, node: NodeIndex) -> Origin {
        self.out.origin(self.graph.node(node).id, self.graph.type_name(node))
    }

    /// A light shines also when its layer is hidden (unverified).
    fn light(&mut self, site: &Site, fields: &Fields<'_>) -> Result<(), ReadError> {
        match lights::light(fields)? {
            LightValue::None => {}
            LightValue::Skipped(class, reason) => self.out.report.skip(&class, reason),
            LightValue::Light { .. } if !shapes::is_invertible(&site.frames.own) => {
                self.skip(site.node, "its transformation is flat or not a number");
            }
            LightValue::Light { kind, shadowless } => {
                let origin = self.origin(site.node);
                let light = Light { kind, world_from_light: site.frames.own, shadowless, origin };
                self.out.scene.lights.push(light);
                self.has_light = true;
            }
        }
        Ok(())
    }

    fn sky(&mut self, site: &Site, fields: &Fields<'_>, material: MaterialId) -> Result<(), ReadError> {
        let class = match fields.get("shader") {
            Field::File(v) => Some(v),
            Field::Module(_) | Field::Missing => None,
        };
        let class = class.and_then(|v| match v.kind {
            Kind::Ref => {
                v.text().parse().ok().and_then(|id| self.graph.by_id(id)).map(|i| self.graph.type_name(i))
            }
            _ => self.graph.values.type_of(v),
        });
        if class.is_some_and(|class| class.ends_with(".SunSkyLight")) {
            self.skip(site.node, "skies with a SunSkyLight are not supported yet");
            return Ok(());
        }
        let power_density = fields.number("powerDensity", 50.0)?;
        if !power_density.is_finite() || power_density < 0.0 {
            self.skip(site.node, "its powerDensity is negative or not a number");
        } else if self.out.scene.sky.is_some() {
            self.skip(site.node, "there is another sky before it");
        } else {
            let radiance = lights::sky_radiance(power_density, self.shaders.mean(material));
            let origin = self.origin(site.node);
            self.out.scene.sky = Some(Sky { radiance, origin });
            self.has_light = true;
        }
        Ok(())
    }

    fn add_default_light(&mut self) {
        let (kind, world_from_light) = lights::default_light(&self.view.camera);
        let origin = self.out.origin(-1, "default light");
        self.out.scene.lights.push(Light { kind, world_from_light, shadowless: true, origin });
        let message =
            "the scene has no light; GroIMP's default light from the upper left behind the camera is added";
        self.out.report.warn(message, None);
    }
}

/// A node and where it stands.
struct Site {
    node: NodeIndex,
    class: Class,
    frames: Frames,
}
