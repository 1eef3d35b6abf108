//! One function for each reader of untrusted bytes, for the fuzz targets in `fuzz/` and the regression tests.
//!
//! Nothing here checks results: whatever the bytes are, reading them must end soon, in little memory and without
//! a panic. The limits are far below the default ones, so that what costs too much shows on small inputs.

use crate::archive::{self, Archive};
use crate::graph::Graph;
use crate::modules::{SourceFile, Sources, StaticValue, Stored};
use crate::registry::Registry;
use crate::report::Report;
use crate::values::{Members, Value, Values, parse_numbers};
use crate::view::View;
use crate::{Limits, ReadOptions, inline, java_stream, meshes, read_archive};
use std::collections::HashMap;

/// Stands between the files in the inputs of [`sources`] and [`project`].
pub const SEPARATOR: &[u8] = b"\n%%%%\n";

/// A target by its name, which is also that of its binary and its folders.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 7] = [
    ("archive", archive),
    ("registry", registry),
    ("graph", graph),
    ("java_stream", java_stream),
    ("sources", sources),
    ("inline_values", inline_values),
    ("project", project),
];

const LIMITS: Limits = Limits {
    entry_bytes: 1 << 20,
    total_bytes: 4 << 20,
    source_bytes: 1 << 20,
    graph_nodes: 1 << 18,
    graph_values: 1 << 20,
    image_pixels: 1 << 16,
    total_image_pixels: 1 << 18,
    body_nodes: 2_000,
    body_steps: 100_000,
    surface_triangles: 2_000,
    total_surface_triangles: 10_000,
    group_nodes: 20_000,
    instances: 10_000,
};

/// How the targets read projects.
fn options() -> ReadOptions {
    ReadOptions { limits: LIMITS, ..ReadOptions::default() }
}

/// A `.gsz`: container, manifest and all that the project leads to.
pub fn archive(bytes: &[u8]) {
    let _ = archive::manifest_charsets(&String::from_utf8_lossy(bytes));
    if let Ok(mut archive) = Archive::from_zip(bytes.to_vec(), LIMITS) {
        for entry in archive.entry_names().into_iter().take(16) {
            let _ = archive.read(&entry);
            let _ = archive.read_source(&entry);
        }
    }
    if let Ok(archive) = Archive::from_zip(bytes.to_vec(), LIMITS) {
        let _ = read_archive(archive, &options());
    }
}

/// `project.gs` and the saved view in it.
pub fn registry(bytes: &[u8]) {
    if let Ok(registry) = Registry::parse("project.gs", bytes)
        && let Some((text, line)) = &registry.view
    {
        let _ = View::parse(text, *line);
    }
}

/// `graph.xml` up to its tables.
pub fn graph(bytes: &[u8]) {
    let mut report = Report::default();
    if let Ok(graph) = Graph::parse("graph.xml", bytes, LIMITS, &mut report) {
        for index in graph.nodes.iter().filter_map(|node| graph.by_id(node.id)) {
            let _ = graph.type_name(index);
            for edge in graph.edges_of(index) {
                let _ = graph.node(graph.target(edge));
            }
            visit(&graph.values, graph.node(index).fields);
        }
    }
    let _ = report.to_string();
}

/// A Java object stream and the mesh in it.
pub fn java_stream(bytes: &[u8]) {
    if let Ok(object) = java_stream::parse(bytes) {
        let _ = meshes::polygon_mesh(&object);
    }
}

/// Up to three model sources: declarations, defaults and bodies.
pub fn sources(bytes: &[u8]) {
    let names = ["Model.rgg", "sub/Other.rgg", "Third.java"];
    let files: Vec<SourceFile> = sections(bytes)
        .zip(names)
        .map(|(text, path)| SourceFile {
            path: path.to_owned(),
            text: String::from_utf8_lossy(text).into_owned(),
        })
        .collect();
    let sources = Sources::parse(&files);
    let _ = sources.problems();
    for name in sources.type_names().into_iter().take(16) {
        let _ = sources.resolve(name);
        if let Some(place) = sources.place(name) {
            let stored = |field: &str| match field.len() % 3 {
                0 => Stored::Missing,
                1 => Stored::Value(StaticValue::Number(2.0)),
                _ => Stored::Other,
            };
            let _ = sources.instantiate(place, &stored, LIMITS.body_nodes, LIMITS.body_steps);
        }
    }
}

/// Values in inline syntax, as in attributes and in the saved view.
pub fn inline_values(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let mut values = Values::default();
    let id = inline::parse_value(&mut values, text, 1);
    let members = values.get(id).members;
    visit(&values, members);
    let _ = inline::registry_path(text);
    let _ = View::parse(text, 1);
}

/// A whole project of up to four files: `project.gs` (a plain one, if it is empty), `graph.xml`, `Model.rgg` and a
/// picture.
pub fn project(bytes: &[u8]) {
    let names = ["project.gs", "graph.xml", "Model.rgg", "picture"];
    let mut files: HashMap<String, Vec<u8>> =
        names.iter().map(|name| (*name).to_owned()).zip(sections(bytes).map(<[u8]>::to_vec)).collect();
    if let Some(registry) = files.get_mut("project.gs").filter(|registry| registry.is_empty()) {
        *registry = PLAIN_PROJECT.as_bytes().to_vec();
    }
    if let Ok(archive) = Archive::from_files(files, LIMITS)
        && let Ok((project, _)) = read_archive(archive, &options())
    {
        let _ = project.report.to_string();
    }
}

const PLAIN_PROJECT: &str = r#"<project graph="graph.xml"><registry><ref name="project"><ref name="objects">
<ref name="files"><de.grogra.pf.ui.registry.SourceFile name="Model.rgg" systemId="pfs:Model.rgg"/></ref>
<ref name="images"><de.grogra.pf.ui.registry.FileObjectItem name="i" systemId="pfs:picture"/></ref>
<ref name="3d"><ref name="shaders"><de.grogra.pf.registry.SONodeReference name="s" ref="9"/></ref></ref>
</ref></ref></registry></project>"#;

/// The parts between the separators.
fn sections(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = Some(bytes);
    std::iter::from_fn(move || {
        let bytes = rest?;
        match bytes.windows(SEPARATOR.len()).position(|window| window == SEPARATOR) {
            Some(at) => {
                rest = Some(&bytes[at + SEPARATOR.len()..]);
                Some(&bytes[..at])
            }
            None => {
                rest = None;
                Some(bytes)
            }
        }
    })
}

/// Looks at all members of a value, at any depth.
fn visit(values: &Values, members: Members) {
    let mut pending = vec![members];
    while let Some(members) = pending.pop() {
        for value in values.iter(members) {
            let _ = parse_numbers(value.text());
            let _ = values.type_of(value);
            pending.push(Value::clone(value).members);
        }
    }
}
