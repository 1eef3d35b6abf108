//! Reads GroIMP projects without GroIMP: archive, registry, graph, module declarations, turtle, shapes, shaders,
//! lights and the saved view become a [`Scene`](scene::Scene); what could not be taken over is in a [`Report`].
//!
//! Reading is lenient: unknown fields, types and attributes are passed over, unknown node types counted. Only
//! files that cannot be understood at all, and fields that hold something else than their class demands, are
//! errors, with file and line. No recursion depends on the input, so chains of any depth can be read.

mod archive;
mod blends;
mod body;
mod build;
mod carpenter;
mod channel_maps;
mod channels;
mod classes;
mod components;
mod daylight;
mod distributions;
mod energy;
mod error;
mod field_errors;
mod fields;
#[doc(hidden)]
pub mod fuzzing;
mod graph;
mod groups;
mod ies;
mod images;
mod inline;
mod interiors;
mod java_stream;
mod light_nodes;
mod lights;
mod limits;
mod meshes;
mod module_lights;
pub mod modules;
mod normal_maps;
mod object_fields;
mod options;
mod output;
mod references;
mod registry;
mod report;
mod shaders;
mod shapes;
mod surfaces;
mod targets;
mod transform;
mod turtle_state;
mod types;
mod values;
mod view;
mod volume_maps;
mod xml;

#[doc(hidden)]
pub use build::DrawnFrames;
pub use error::ReadError;
pub use limits::Limits;
pub use options::{Flatness, ReadOptions};
pub use report::{Location, Report, Skipped, Warning};

use archive::Archive;
use build::{Builder, Parts};
use graph::Graph;
use images::Images;
use modules::{SourceFile, Sources};
use output::Output;
use registry::Registry;
use shaders::Shaders;
use std::collections::HashSet;
use std::path::Path;
use surfaces::Surfaces;
use types::Types;
use view::View;

/// A project that was read.
#[derive(Clone, Debug)]
pub struct Project {
    /// What GroIMP would make a picture of.
    pub scene: scene::Scene,
    /// What is missing in the scene or odd in the project.
    pub report: Report,
    /// Layers that are drawn, layer n as bit n.
    pub visible_layers: u16,
}

/// Reads a `.gsz` archive, a `project.gs` file, a project directory or a bare graph (`.xml`, without named
/// shaders, images, modules and the saved view), within the default [`Limits`].
///
/// Fails if the file cannot be opened, is none of these, is damaged or holds no main graph, or if a field that
/// is needed holds something else than its class demands.
pub fn read(path: &Path) -> Result<Project, ReadError> {
    read_within(path, Limits::default())
}

/// As [`read`], within the given limits.
pub fn read_within(path: &Path, limits: Limits) -> Result<Project, ReadError> {
    read_with(path, &ReadOptions { limits, ..ReadOptions::default() })
}

/// As [`read`], as the caller chooses.
pub fn read_with(path: &Path, options: &ReadOptions) -> Result<Project, ReadError> {
    let (project, _) = read_all(path, options)?;
    Ok(project)
}

/// The frames of all nodes with a shape of the project's tree, hidden ones too, to compare with known figures.
#[doc(hidden)]
pub fn drawn_frames(path: &Path) -> Result<Vec<DrawnFrames>, ReadError> {
    let (_, frames) = read_all(path, &ReadOptions::default())?;
    Ok(frames)
}

fn read_all(path: &Path, options: &ReadOptions) -> Result<(Project, Vec<DrawnFrames>), ReadError> {
    read_archive(Archive::open(path, options.limits)?, options)
}

fn read_archive(
    mut archive: Archive,
    options: &ReadOptions,
) -> Result<(Project, Vec<DrawnFrames>), ReadError> {
    let limits = options.limits;
    let mut report = Report::default();
    let registry = match archive.registry.clone() {
        Some(file) => Registry::parse(&file, &archive.require(&file)?)?,
        None => Registry { graph: archive.graph.clone().unwrap_or_default(), ..Registry::default() },
    };
    let graph = Graph::parse(&registry.graph, &archive.require(&registry.graph)?, limits, &mut report)?;
    let sources = read_sources(&mut archive, &registry, &mut report)?;
    let mut view = read_view(&archive, &registry, &mut report);
    if let Some(layers) = options.visible_layers {
        view.show_layers(layers);
    }
    let types = Types::new(&graph, &sources, limits);
    let images = Images::new(archive, registry.files.clone(), options.srgb_textures);
    let shaders = Shaders::new(&graph, &registry, images.clone());
    let surfaces = Surfaces::new(options, images);
    let parts = Parts { graph: &graph, view: &view, types: &types, sources: &sources, shaders, surfaces };
    let mut builder = Builder::new(parts, Output::with_report(report), limits);
    builder.build()?;
    let Builder { out: Output { scene, mut report, .. }, frames, .. } = builder;
    energy::warn_of_gains(&scene, &mut report);
    Ok((Project { scene, report, visible_layers: view.shown_layers() }, frames))
}

fn read_sources(
    archive: &mut Archive,
    registry: &Registry,
    report: &mut Report,
) -> Result<Sources, ReadError> {
    let mut files = Vec::new();
    let most = archive.limits().source_bytes;
    let mut bytes = 0;
    let mut seen = HashSet::new();
    for path in registry.sources.iter().filter(|path| seen.insert(path.as_str())) {
        match archive.read_source(path)? {
            Some(text) if text.len() > most - bytes => {
                let message = format!(
                    "the sources have more than {most} bytes; '{path}' is left out (--limit source-bytes)"
                );
                report.warn(message, None);
            }
            Some(text) => {
                bytes += text.len();
                files.push(SourceFile { path: path.clone(), text });
            }
            None => report.warn(format!("the source '{path}' is not in the project"), None),
        }
    }
    let sources = Sources::parse(&files);
    for problem in sources.problems() {
        let location = Location { file: problem.file.clone(), line: problem.line };
        report.warn(problem.message.clone(), Some(location));
    }
    Ok(sources)
}

fn read_view(archive: &Archive, registry: &Registry, report: &mut Report) -> View {
    let Some((text, line)) = &registry.view else { return View::default() };
    let (view, problems) = View::parse(text, *line);
    let file = archive.registry.clone().unwrap_or_default();
    for problem in problems {
        report.warn(problem, Some(Location { file: file.clone(), line: *line }));
    }
    view
}
