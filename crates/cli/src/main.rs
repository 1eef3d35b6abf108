//! `sunshine`: pictures of GroIMP plant models from the command line.

mod arguments;
mod devices_command;
mod failure;
mod info_command;
mod progress;
mod render_command;
mod statistics;

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use std::io::{self, Write};
use std::process::ExitCode;

fn main() -> ExitCode {
    // Ends the process for wrong usage (2), --help and --version (0).
    let arguments = Arguments::parse();
    match answer(arguments).and_then(|text| print(&text)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // There is nowhere left to report that this failed.
            let _ = io::stderr().write_all(failure.explanation().as_bytes());
            failure.exit_code()
        }
    }
}

/// Does what is asked and returns what there is to say on standard output.
fn answer(arguments: Arguments) -> Result<String, Failure> {
    match arguments.command {
        Command::Render(arguments) => render_command::run(&arguments),
        Command::Info(arguments) => info_command::run(&arguments),
        Command::Devices => Ok(devices_command::run()),
    }
}

fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // Whoever was reading has seen enough, as in `sunshine info plant.gsz | head -1`.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => Ok(result?),
    }
}
