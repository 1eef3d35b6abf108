//! Draws what the bodies of modules make, in the frames of their instances.
//!
//! Bodies may make modules that have bodies. How deep that goes, how many nodes it makes and how much work
//! it takes is limited; what is beyond the limits is left out and reported.

use crate::build::{Builder, Inherited};
use crate::classes::Class;
use crate::fields::{Defaults, Fields};
use crate::modules::{Instantiation, Place, StaticValue, Stored};
use crate::report::Location;
use crate::values::{Kind, Value, parse_number, tokens};
use crate::{Limits, ReadError};
use std::collections::HashMap;

/// Bodies within bodies that are drawn.
const DEEPEST: usize = 64;

/// Steps of evaluation that one body may take. A step is about one operand or statement.
const MOST_STEPS: usize = 1_000_000;

/// What the bodies of a project may still use.
pub(crate) struct Bodies {
    nodes_left: usize,
    steps_left: usize,
}

impl Bodies {
    pub fn within(limits: Limits) -> Self {
        Bodies { nodes_left: limits.body_nodes, steps_left: limits.body_steps }
    }
}

/// A body that is to be drawn.
struct Pending {
    module: Place,
    depth: usize,
    defaults: Defaults,
    start: Inherited,
}

impl Builder<'_> {
    /// Draws the body of an instance and the bodies in it.
    pub fn draw_body(
        &mut self,
        module: Place,
        instance: &Fields<'_>,
        start: Inherited,
    ) -> Result<(), ReadError> {
        let mut pending = Vec::new();
        self.one_body(module, instance, start, 1, &mut pending)?;
        while let Some(Pending { module, depth, defaults, start }) = pending.pop() {
            let fields =
                Fields { graph: self.graph, node: instance.node, in_file: false, defaults: &defaults };
            self.one_body(module, &fields, start, depth, &mut pending)?;
        }
        Ok(())
    }

    fn one_body(
        &mut self,
        module: Place,
        instance: &Fields<'_>,
        start: Inherited,
        depth: usize,
        pending: &mut Vec<Pending>,
    ) -> Result<(), ReadError> {
        let Bodies { nodes_left, steps_left } = self.bodies;
        if nodes_left == 0 || steps_left == 0 {
            pending.clear();
            let message = "the bodies after ==> of this project make too many nodes or take too many steps; \
                           the rest of them is not drawn";
            self.out.report.warn(message, None);
            return Ok(());
        }
        let name = self.sources.type_name(module);
        if depth > DEEPEST {
            let message = format!("module {name}: bodies after ==> that are nested deeper are not drawn");
            self.out.report.warn(message, None);
            return Ok(());
        }
        let most_steps = steps_left.min(MOST_STEPS);
        // A module may ask for as many fields as the instance stores, so they are not searched one by one.
        let in_file = if instance.in_file { fields_by_name(instance) } else { HashMap::new() };
        let stored = |field: &str| stored(instance, &in_file, field);
        let Instantiation { nodes, steps } =
            self.sources.instantiate(module, &stored, nodes_left, most_steps);
        self.bodies.steps_left = steps_left.saturating_sub(steps);
        let nodes = match nodes {
            Ok(nodes) => nodes,
            Err(problem) => {
                let message = format!("module {name}: its body after ==> is not drawn: {}", problem.message);
                let location = Location { file: problem.file, line: problem.line };
                self.out.report.warn(message, Some(location));
                return Ok(());
            }
        };
        self.bodies.nodes_left = nodes_left - nodes.len().min(nodes_left);
        let mut handed_on: Vec<Inherited> = Vec::with_capacity(nodes.len());
        for node in nodes {
            let inherited = node.parent.and_then(|parent| handed_on.get(parent)).unwrap_or(&start);
            let class = Class::of(&node.class).unwrap_or(Class::Plain);
            let defaults: Defaults = node.fields.into_iter().collect();
            let fields =
                Fields { graph: self.graph, node: instance.node, in_file: false, defaults: &defaults };
            let placed = self.place(class, &fields, *inherited)?;
            handed_on.push(placed.for_children);
            if let Some(module) = node.module {
                pending.push(Pending { module, depth: depth + 1, defaults, start: placed.for_body });
            }
        }
        Ok(())
    }
}

/// The fields that the file stores for a node; the first of a name counts, as everywhere.
fn fields_by_name<'a>(instance: &Fields<'a>) -> HashMap<&'a str, &'a Value> {
    let graph = instance.graph;
    let mut fields = HashMap::new();
    for value in graph.values.iter(graph.node(instance.node).fields) {
        if let Some(name) = value.name {
            fields.entry(graph.values.name(name)).or_insert(value);
        }
    }
    fields
}

/// A field of an instance as expressions see it.
fn stored(instance: &Fields<'_>, in_file: &HashMap<&str, &Value>, field: &str) -> Stored {
    let value = match (in_file.get(field), instance.defaults.get(field)) {
        (Some(value), _) => value,
        // The defaults of a node in the file are those that its module computes anyhow.
        (None, Some(_)) if instance.in_file => return Stored::Missing,
        (None, Some(value)) => return Stored::Value(value.clone()),
        (None, None) => return Stored::Missing,
    };
    match (value.kind, value.text()) {
        (Kind::Null, _) => Stored::Value(StaticValue::Null),
        (Kind::Data, "true") => Stored::Value(StaticValue::Bool(true)),
        (Kind::Data, "false") => Stored::Value(StaticValue::Bool(false)),
        (Kind::Data, text) => {
            parse_number(text).map_or(Stored::Other, |n| Stored::Value(StaticValue::Number(n)))
        }
        (Kind::Array, _) => array(instance, value).map_or(Stored::Other, Stored::Value),
        _ => Stored::Other,
    }
}

/// An array of numbers, written in one text or as elements.
fn array(instance: &Fields<'_>, array: &Value) -> Option<StaticValue> {
    let elements = instance.graph.values.iter(array.members).map(Value::text);
    let texts = std::iter::once(array.text()).chain(elements);
    texts.flat_map(tokens).map(parse_number).collect::<Option<_>>().map(StaticValue::Numbers)
}
