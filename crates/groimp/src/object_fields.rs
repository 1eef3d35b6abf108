//! Access to the fields of an object that is no node of the tree, such as a light.

use crate::ReadError;
use crate::channels::color_of;
use crate::field_errors::number_of;
use crate::graph::Graph;
use crate::values::{Members, Value};
use scene::Rgb;

/// An object that is a value as a rule and no node of the tree.
pub(crate) struct ObjectFields<'a> {
    pub graph: &'a Graph,
    pub members: Members,
    pub class: &'a str,
}

impl ObjectFields<'_> {
    pub fn find(&self, name: &str) -> Option<&Value> {
        self.graph.values.find(self.members, name)
    }

    pub fn number(&self, name: &str, default: f64) -> Result<f64, ReadError> {
        self.find(name).map_or(Ok(default), |value| number_of(self.graph, value, self.class, name))
    }

    pub fn flag(&self, name: &str, default: bool) -> bool {
        self.find(name).map_or(default, |value| value.text() == "true")
    }

    pub fn color(&self) -> Result<Rgb, ReadError> {
        self.find("color").map_or(Ok([1.0; 3]), |value| color_of(self.graph, value))
    }
}
