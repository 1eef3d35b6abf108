//! `sunshine`: pictures of GroIMP plant models from the command line.

mod arguments;
mod bench_arguments;
mod bench_command;
mod camera_arguments;
mod checkpoints;
mod daylight_arguments;
mod denoising;
mod devices_command;
mod failure;
mod generate_command;
mod info_command;
mod interruption;
mod log;
mod merge_command;
mod option_values;
mod progress;
mod render_arguments;
mod render_command;
mod render_job;
mod rendering;
mod sample_choices;
mod sequence_command;
mod show_command;
mod statistics;
mod terminal;
#[cfg(feature = "view")]
mod view_arguments;
#[cfg(feature = "view")]
mod view_command;

use arguments::{Arguments, Command};
use failure::Failure;
use std::io::{self, Write};
use std::process::ExitCode;

fn main() -> ExitCode {
    // Ends the process for wrong usage (2), --help and --version (0).
    let arguments = arguments::parse();
    quieten_drivers(arguments.no_cache);
    let answer = log::start(&arguments.log).and_then(|()| answer(arguments));
    match answer.and_then(|answer| print(&answer.text).map(|()| answer.exit_code)) {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            let explanation = terminal::printable(&failure.explanation());
            tracing::error!(target: log::SAID, "{}", explanation.trim_end());
            // There is nowhere left to report that this failed.
            let _ = io::stderr().write_all(explanation.as_bytes());
            failure.exit_code()
        }
    }
}

/// Keeps Mesa from asking the desktop which graphics card it uses where there is no desktop: on a server that only
/// prints complaints between our own messages. Without a cache, Mesa and the driver of NVIDIA store nothing.
fn quieten_drivers(no_cache: bool) {
    let set = |name: &str, value: &str| {
        // SAFETY: called before any other thread exists that could read the environment meanwhile.
        unsafe { std::env::set_var(name, value) };
    };
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        set("NODEVICE_SELECT", "1");
    }
    if no_cache {
        set("MESA_SHADER_CACHE_DISABLE", "true");
        set("__GL_SHADER_DISK_CACHE", "0");
    }
}

/// What there is to say in the end.
struct Answer {
    /// For standard output.
    text: String,
    /// 0 unless somebody stopped the work.
    exit_code: u8,
}

impl From<String> for Answer {
    fn from(text: String) -> Self {
        Answer { text, exit_code: 0 }
    }
}

/// Does what is asked.
fn answer(arguments: Arguments) -> Result<Answer, Failure> {
    Ok(match arguments.command {
        Command::Render(arguments) => return render_command::run(&arguments),
        #[cfg(feature = "view")]
        Command::View(arguments) => view_command::run(&arguments)?.into(),
        Command::Info(arguments) => info_command::run(&arguments)?.into(),
        Command::Devices => devices_command::run().into(),
        Command::Merge(arguments) => merge_command::run(&arguments)?.into(),
        Command::Show(arguments) => show_command::run(&arguments)?.into(),
        Command::Bench(arguments) => bench_command::run(&arguments)?.into(),
        Command::Generate(arguments) => generate_command::run(&arguments)?.into(),
    })
}

fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(terminal::printable(text).as_bytes()).and_then(|()| out.flush()) {
        // Whoever was reading has seen enough, as in `sunshine info plant.gsz | head -1`.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => Ok(result?),
    }
}
