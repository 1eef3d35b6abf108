//! `-v`, `-vv` and `--log-file`: what happens inside, with times.

use crate::arguments::LogArguments;
use crate::failure::Failure;
use std::fs::File;
use std::io;
use std::sync::Mutex;
use tracing::Level;
use tracing_subscriber::fmt::writer::MakeWriterExt;

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
    let subscriber = tracing_subscriber::fmt().with_max_level(level);
    // A log that begins twice is a mistake of this program and not worth stopping for.
    let _ = match &arguments.log_file {
        None => subscriber.with_writer(shown).try_init(),
        Some(path) => {
            // What an earlier run wrote stays: a job may be continued.
            let file = File::options().append(true).create(true).open(path);
            let file = file.map_err(|source| Failure::NotWritable { path: path.clone(), source })?;
            let both = shown.and(Mutex::new(file));
            subscriber.with_writer(both).try_init()
        }
    };
    Ok(())
}
