//! `sunshine view`: a window on a scene.

use crate::arguments::{Arguments, Command};
use crate::failure::Failure;
use crate::progress::Messages;
use crate::render_command::default_output;
use crate::render_job::{picture_options, provenance_of};
use crate::view_arguments::ViewArguments;
use clap::Parser;
use render::Provenance;
use std::path::Path;
use std::sync::Arc;
use view::{ReadScene, ViewOptions, explained};

/// Opens the window; returns when it is closed.
pub fn run(arguments: &ViewArguments) -> Result<String, Failure> {
    arguments.check()?;
    let messages = Messages { quiet: arguments.render.quiet };
    let project = arguments.render.scene.clone();
    if !project.exists() {
        // Here, where somebody looks; later errors are told in the window.
        let reason = std::io::Error::from(std::io::ErrorKind::NotFound);
        return Err(Failure::Unreadable { path: project, source: reason });
    }
    let output = arguments.render.output.clone().unwrap_or_else(|| default_output(&project));
    let read = {
        let (project, camera) = (project.clone(), arguments.render.camera.clone());
        let (options, daylight) = (arguments.render.read_options(), arguments.render.daylight.clone());
        move |visible_layers| {
            let options = groimp::ReadOptions { visible_layers, ..options };
            let mut read = groimp::read_with(&project, &options).map_err(|error| explained(&error))?;
            let scene = &mut read.scene;
            // The window moves the sun; here it is only asked whether there is one.
            let asked = camera.apply(scene).and_then(|()| daylight.apply(&mut scene.sky.clone()));
            asked.map_err(|error| explained(&error))?;
            let skipped = read.report.skipped.iter().map(|skipped| format!("not drawn: {skipped}"));
            let warnings = skipped.chain(read.report.warnings.iter().map(ToString::to_string)).collect();
            Ok(ReadScene { scene: read.scene, warnings, visible_layers: read.visible_layers })
        }
    };
    let scene = project.clone();
    let threads = arguments.render.threads.map(|threads| threads as usize);
    view::run(ViewOptions {
        given: arguments.given(&project),
        settings: arguments.settings(),
        acceleration: arguments.render.accel,
        output: output.to_string_lossy().into_owned(),
        window: (f64::from(arguments.window.width), f64::from(arguments.window.height)),
        read: Box::new(read),
        open: Arc::new(move |choice| render::open_device(choice, threads)),
        record: Box::new(move |words: &[String]| record(&scene, words)),
        note: Box::new(move |text| messages.line(text)),
        project,
    })?;
    Ok(String::new())
}

/// What a saved picture tells of itself: the same as one that its command makes.
fn record(scene: &Path, words: &[String]) -> Provenance {
    // A file name that looks like an option is no part of the record.
    let known = Arguments::try_parse_from(words).ok();
    let settings = match known.map(|arguments| arguments.command) {
        Some(Command::Render(render)) => picture_options(&render, &render.settings(), &render.camera),
        _ => Vec::new(),
    };
    Provenance { settings, ..provenance_of(scene) }
}
