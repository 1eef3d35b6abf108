//! `sunshine`: pictures of GroIMP plant models from the command line.

mod arguments;
mod bench_arguments;
mod bench_command;
mod camera_arguments;
mod denoising;
mod devices_command;
mod failure;
mod info_command;
mod option_values;
mod progress;
mod render_command;
mod statistics;

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use std::io::{self, Write};
use std::process::ExitCode;

fn main() -> ExitCode {
    quieten_drivers();
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

/// Keeps Mesa from asking the desktop which graphics card it uses where there is no desktop: on a server that only
/// prints complaints between our own messages.
fn quieten_drivers() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: called first in `main`; no other thread exists that could read the environment meanwhile.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// Does what is asked and returns what there is to say on standard output.
fn answer(arguments: Arguments) -> Result<String, Failure> {
    match arguments.command {
        Command::Render(arguments) => render_command::run(&arguments),
        Command::Info(arguments) => info_command::run(&arguments),
        Command::Devices => Ok(devices_command::run()),
        Command::Bench(arguments) => bench_command::run(&arguments),
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
