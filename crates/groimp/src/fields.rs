//! Fields of a scene node: what the file stores, else what its module assigns, else the class default.

use crate::ReadError;
use crate::components;
use crate::field_errors::{number_of, wrong_value};
use crate::graph::{Graph, NodeIndex};
use crate::modules::StaticValue;
use crate::values::{Kind, Value, parse_numbers};
use crate::view::affine;
use glam::{DAffine3, DMat3, DVec3};
use std::collections::HashMap;

/// What missing fields of a module mean.
pub(crate) type Defaults = HashMap<String, StaticValue>;

/// Access to the fields of one node.
#[derive(Clone, Copy)]
pub(crate) struct Fields<'a> {
    pub graph: &'a Graph,
    /// The node, or the one in whose body this one is.
    pub node: NodeIndex,
    /// Whether the node is in the file; those of bodies are not.
    pub in_file: bool,
    pub defaults: &'a Defaults,
}

/// Where a field's value stands.
#[derive(Clone, Copy)]
pub(crate) enum Field<'a> {
    File(&'a Value),
    Module(&'a StaticValue),
    Missing,
}

impl<'a> Fields<'a> {
    pub fn get(&self, name: &str) -> Field<'a> {
        let stored = if self.in_file { self.graph.field(self.node, name) } else { None };
        match (stored, self.defaults.get(name)) {
            (Some(value), _) => Field::File(value),
            (None, Some(value)) => Field::Module(value),
            (None, None) => Field::Missing,
        }
    }

    /// A number of any type; fails if the file holds something else.
    pub fn number(&self, name: &str, default: f64) -> Result<f64, ReadError> {
        match self.get(name) {
            Field::File(value) if value.kind == Kind::Null => Ok(default),
            Field::File(value) => number_of(self.graph, value, self.owner(), name),
            Field::Module(StaticValue::Number(number)) => Ok(*number),
            Field::Module(_) | Field::Missing => Ok(default),
        }
    }

    /// A truth value; fails if the file holds something else.
    pub fn flag(&self, name: &str, default: bool) -> Result<bool, ReadError> {
        match self.get(name) {
            Field::File(value) => match value.text() {
                "true" => Ok(true),
                "false" => Ok(false),
                _ => Err(wrong_value(self.graph, value, self.owner(), name, "true or false")),
            },
            Field::Module(StaticValue::Bool(flag)) => Ok(*flag),
            Field::Module(_) | Field::Missing => Ok(default),
        }
    }

    /// Three numbers; fails if the file holds something else.
    pub fn vector(&self, name: &str, default: DVec3) -> Result<DVec3, ReadError> {
        match self.get(name) {
            Field::File(value) if value.kind == Kind::Null => Ok(default),
            Field::File(value) => match parse_numbers(value.text()).as_deref() {
                Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
                _ => Err(wrong_value(self.graph, value, self.owner(), name, "three numbers")),
            },
            Field::Module(StaticValue::Vector(vector)) => Ok(DVec3::from_array(*vector)),
            Field::Module(_) | Field::Missing => Ok(default),
        }
    }

    /// The field `transform`, and the class of one that is not known here and counts as identity.
    pub fn transform(&self) -> Result<(DAffine3, Option<&'a str>), ReadError> {
        let value = match self.get("transform") {
            Field::File(value) => value,
            Field::Module(_) | Field::Missing => return Ok((self.module_transform(), None)),
        };
        transform_of(self.graph, value, self.owner())
    }

    /// What a module sets through Null's aliases `x`, `y`, `z`, `scale` and `setRotation`; fields of these names are
    /// never stored.
    fn module_transform(&self) -> DAffine3 {
        let vector = |name: &str| match self.defaults.get(name) {
            Some(StaticValue::Vector(vector)) => Some(DVec3::from_array(*vector)),
            Some(StaticValue::Number(number)) => Some(DVec3::splat(*number)),
            _ => None,
        };
        let rotation = vector("setRotation").map_or(DMat3::IDENTITY, components::rotation);
        DAffine3::from_translation(vector("transform").unwrap_or(DVec3::ZERO))
            * DAffine3::from_mat3(rotation)
            * DAffine3::from_scale(vector("scale").unwrap_or(DVec3::ONE))
    }

    fn owner(&self) -> &'a str {
        self.graph.type_name(self.node)
    }
}

/// A `Transform3D` of the file, and its class if that is not known here and counts as identity.
pub(crate) fn transform_of<'a>(
    graph: &'a Graph,
    value: &Value,
    owner: &str,
) -> Result<(DAffine3, Option<&'a str>), ReadError> {
    if value.kind == Kind::Null {
        return Ok((DAffine3::IDENTITY, None));
    }
    let class = graph.values.type_of(value).unwrap_or("");
    let wrong = |expected| Err(wrong_value(graph, value, owner, "transform", expected));
    match class.rsplit('.').next().unwrap_or("") {
        "TVector3d" => match parse_numbers(value.text()).as_deref() {
            Some(&[x, y, z]) => Ok((DAffine3::from_translation(DVec3::new(x, y, z)), None)),
            _ => wrong("three numbers"),
        },
        "TMatrix4d" => match parse_numbers(value.text()).as_deref().and_then(affine) {
            Some(matrix) => Ok((matrix, None)),
            None => wrong("sixteen numbers"),
        },
        "UniformScale" => match graph.values.find(value.members, "scale") {
            Some(scale) => {
                let scale = number_of(graph, scale, class, "scale")?;
                Ok((DAffine3::from_scale(DVec3::splat(scale)), None))
            }
            None => Ok((DAffine3::IDENTITY, None)),
        },
        _ => match components::transform(graph, class, value)? {
            Some(transform) => Ok((transform, None)),
            None => Ok((DAffine3::IDENTITY, Some(class))),
        },
    }
}
