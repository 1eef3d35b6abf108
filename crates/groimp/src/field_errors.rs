//! Values of the file that must be of a kind, and what is said if they are not.

use crate::ReadError;
use crate::graph::Graph;
use crate::values::{Value, parse_number};

/// The number that a value of the file holds.
pub(crate) fn number_of(graph: &Graph, value: &Value, owner: &str, field: &str) -> Result<f64, ReadError> {
    parse_number(value.text()).ok_or_else(|| wrong_value(graph, value, owner, field, "a number"))
}

/// The error for a value that its field cannot hold.
pub(crate) fn wrong_value(
    graph: &Graph,
    value: &Value,
    owner: &str,
    field: &str,
    expected: &'static str,
) -> ReadError {
    ReadError::WrongValue {
        file: graph.file.clone(),
        line: value.line,
        owner: owner.to_owned(),
        field: field.to_owned(),
        found: value.text().to_owned(),
        expected,
    }
}
