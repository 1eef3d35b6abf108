//! Access to the objects in fields of surfaces: grids, vertex lists, spline surfaces.
//!
//! How files store these is unverified; the forms that other objects have are accepted: in place, as a node, or
//! shared.

use crate::ReadError;
use crate::field_errors::{number_of, wrong_value};
use crate::fields::{Field, Fields};
use crate::graph::Graph;
use crate::values::{Kind, Members, Value, parse_number, tokens};

/// Shared objects lead to objects; a longer chain is a cycle.
const LONGEST_CHAIN: usize = 64;

/// An object with its fields.
#[derive(Clone, Copy)]
pub(super) struct ObjectValue<'a> {
    pub graph: &'a Graph,
    /// Full name of its class, empty if the file gives none.
    pub class: &'a str,
    members: Members,
}

impl<'a> ObjectValue<'a> {
    /// The object in a field; the inner error says why there is none.
    pub fn of_field(fields: &Fields<'a>, name: &str) -> Result<Self, String> {
        match fields.get(name) {
            Field::File(value) => Self::resolve(fields.graph, value, name),
            Field::Module(_) | Field::Missing => Err(format!("it has no {name}")),
        }
    }

    /// The object in a field of this object.
    pub fn object(&self, name: &str) -> Result<Self, String> {
        match self.graph.values.find(self.members, name) {
            Some(value) => Self::resolve(self.graph, value, name),
            None => Err(format!("it has no {name}")),
        }
    }

    fn resolve(graph: &'a Graph, value: &'a Value, name: &str) -> Result<Self, String> {
        let mut value = value;
        for _ in 0..LONGEST_CHAIN {
            let id = match value.kind {
                Kind::Null => return Err(format!("it has no {name}")),
                Kind::Serialized => return Err(format!("its {name} is stored in a form that is not read")),
                Kind::Ref => value.text(),
                Kind::Shared => value.text().split_once(":#").map_or("", |(_, id)| id),
                Kind::Data | Kind::Object | Kind::Array => {
                    let class = graph.values.type_of(value).unwrap_or("");
                    return Ok(ObjectValue { graph, class, members: value.members });
                }
            };
            let Some(node) = id.trim().parse().ok().and_then(|id| graph.by_id(id)) else {
                return Err(format!("its {name} '{}' is not in the file", value.text()));
            };
            let (class, members) = (graph.type_name(node), graph.node(node).fields);
            match graph.values.find(members, "object") {
                Some(object) if class.ends_with(".SharedObjectNode") => value = object,
                _ => return Ok(ObjectValue { graph, class, members }),
            }
        }
        Err(format!("its {name} refers to itself"))
    }

    /// The class without its package.
    pub fn short_class(&self) -> &'a str {
        self.class.rsplit('.').next().unwrap_or("")
    }

    pub fn find(&self, name: &str) -> Option<&'a Value> {
        self.graph.values.find(self.members, name)
    }

    /// A number; fails if the file holds something else.
    pub fn number(&self, name: &str, default: f64) -> Result<f64, ReadError> {
        self.find(name).map_or(Ok(default), |value| number_of(self.graph, value, self.class, name))
    }

    /// A whole number that is not negative; fails if the file holds something else.
    pub fn count(&self, name: &str, default: usize) -> Result<usize, ReadError> {
        let Some(value) = self.find(name) else { return Ok(default) };
        value
            .text()
            .parse()
            .map_err(|_| wrong_value(self.graph, value, self.class, name, "a whole number, at least 0"))
    }

    /// A truth value; fails if the file holds something else.
    pub fn flag(&self, name: &str, default: bool) -> Result<bool, ReadError> {
        let Some(value) = self.find(name) else { return Ok(default) };
        match value.text() {
            "true" => Ok(true),
            "false" => Ok(false),
            _ => Err(wrong_value(self.graph, value, self.class, name, "true or false")),
        }
    }

    /// An array of numbers, written in one text or as elements; fails if the file holds something else.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, ReadError> {
        let Some(value) = self.find(name).filter(|value| value.kind != Kind::Null) else {
            return Ok(Vec::new());
        };
        let texts = std::iter::once(value.text());
        let texts = texts.chain(self.graph.values.iter(value.members).map(Value::text));
        let numbers: Option<Vec<f64>> = texts.flat_map(tokens).map(parse_number).collect();
        let wrong = || {
            let mut error = wrong_value(self.graph, value, self.class, name, "numbers");
            if let ReadError::WrongValue { found, .. } = &mut error {
                // Arrays may be long.
                *found = found.chars().take(60).collect();
            }
            error
        };
        numbers.ok_or_else(wrong)
    }
}
