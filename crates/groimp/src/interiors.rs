//! What bodies are filled with: GroIMP's `IOR` (materials-and-lights.md 1.6).

use crate::ReadError;
use crate::field_errors::number_of;
use crate::graph::Graph;
use crate::references::References;
use crate::report::Report;
use crate::values::Value;
use scene::Interior;

/// The filling that a field `interior` names, in place, as a node or as a shared object; `None` inherits.
pub(crate) fn interior(
    value: &Value,
    graph: &Graph,
    references: &References<'_>,
    report: &mut Report,
) -> Result<Option<Interior>, ReadError> {
    let Some(found) = references.follow(value) else { return Ok(None) };
    if !found.class.ends_with(".IOR") {
        let message = format!("the interior of class '{}' is not known and left out", found.class);
        report.warn(message, graph.location(value.line));
        return Ok(None);
    }
    let index = match graph.values.find(found.members, "indexOfRefraction") {
        Some(value) => number_of(graph, value, found.class, "indexOfRefraction")?,
        None => 1.0,
    };
    if !(index.is_finite() && index > 0.0) {
        let message = format!("the refractive index {index} is not possible; the interior is left out");
        report.warn(message, graph.location(value.line));
        return Ok(None);
    }
    Ok(Some(Interior { refractive_index: index }))
}
