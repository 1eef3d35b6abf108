//! `-v`, `-vv` and `--log-file`: what happens inside, with times.

use crate::arguments::LogArguments;
use crate::failure::Failure;
use std::fs::File;
use std::io;
use std::sync::Mutex;
use tracing::Level;
use tracing_subscriber::Layer;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::fmt::layer;
use tracing_subscriber::fmt::writer::MakeWriterExt;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

/// Of what is printed anyway and only noted in the log file.
pub const SAID: &str = "said";

/// Begins to write the log, if there is to be one: to standard error with `-v`, to a file with `--log-file`.
pub fn start(arguments: &LogArguments) -> Result<(), Failure> {
    let level = match arguments.verbose {
        0 if arguments.log_file.is_none() => return Ok(()),
        0 | 1 => Level::INFO,
        2 => Level::DEBUG,
        _ => Level::TRACE,
    };
    let is_shown = arguments.verbose > 0;
    let shown = io::stderr.with_filter(move |event| is_shown && event.target() != SAID);
    // Graphics drivers and their interface write thousands of lines; their warnings do unless everything is wanted.
    let others = if level == Level::TRACE { Level::TRACE } else { Level::WARN };
    let targets = [("sunshine", level), ("render", level), ("view", level), (SAID, level)]
        .into_iter()
        .collect::<Targets>()
        .with_default(others);
    let registry = tracing_subscriber::registry();
    // A log that begins twice is a mistake of this program and not worth stopping for.
    let _ = match &arguments.log_file {
        None => registry.with(layer().with_writer(shown).with_filter(targets)).try_init(),
        Some(path) => {
            // What an earlier run wrote stays: a job may be continued.
            let file = File::options().append(true).create(true).open(path);
            let file = file.map_err(|source| Failure::NotWritable { path: path.clone(), source })?;
            let both = shown.and(Mutex::new(file));
            registry.with(layer().with_writer(both).with_filter(targets)).try_init()
        }
    };
    Ok(())
}
