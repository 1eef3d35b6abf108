//! What can be said on the command line.

use crate::bench_arguments::{CompareArguments, MatrixArguments};
use crate::option_values::{NamedLimit, parse_exposure, parse_limit, whole_number};
pub use crate::render_arguments::RenderArguments;
use clap::{ArgAction, Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use render::{DeviceChoice, ToneCurve};
use std::path::PathBuf;

/// Makes physically based pictures of GroIMP plant models.
#[derive(Debug, Parser)]
#[command(name = "sunshine", version, arg_required_else_help = true)]
#[command(max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,

    /// What is told beside the answer.
    #[command(flatten)]
    pub log: LogArguments,

    /// Keep the drivers of graphics cards from storing compiled programs for the next time; everything else that
    /// Sunshine writes is named on the command line
    #[arg(long, global = true)]
    pub no_cache: bool,
}

/// What every command can tell of its work.
#[derive(Debug, Args)]
pub struct LogArguments {
    /// Tell what is being done, with times; -vv tells more, -vvv also what the drivers of graphics cards say
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub verbose: u8,

    /// Append what is being done, with times, and all messages to this file
    #[arg(long, global = true, value_name = "FILE")]
    pub log_file: Option<PathBuf>,
}

/// The definition of the command line, from which help, manual pages and completions are made.
pub fn command() -> clap::Command {
    let command = Arguments::command();
    #[cfg(feature = "view")]
    let command = crate::view_arguments::without_other_options(command);
    command
}

/// Reads the command line; ends the process if it is wrong, or for help.
pub fn parse() -> Arguments {
    let matches = command().get_matches();
    Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a picture of a scene
    Render(Box<RenderArguments>),
    /// Open a window on a scene: look at it from everywhere, change settings, pick, save pictures
    #[cfg(feature = "view")]
    View(Box<crate::view_arguments::ViewArguments>),
    /// Show what a scene holds, and what of it cannot be drawn
    Info(InfoArguments),
    /// List the processors and graphics cards that can render
    Devices,
    /// Join films that were rendered with --sample-range
    Merge(MergeArguments),
    /// Tell how a picture or a film was made
    Show(ShowArguments),
    /// Measure this machine
    Bench(BenchArguments),
    /// Write manual pages and completions for shells
    #[command(hide = true)]
    Generate(GenerateArguments),
}

/// `sunshine bench`.
#[derive(Debug, Args)]
pub struct BenchArguments {
    /// What to measure.
    #[command(subcommand)]
    pub command: BenchCommand,
}

/// What can be measured.
#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// Repeat the experiments of the thesis of 2008: tables beside its figures, curves and pictures
    Thesis(ThesisArguments),
    /// Measure scenes on devices: seconds of every step, rays and samples per second, memory
    Run(MatrixArguments),
    /// Compare two files that `bench run` wrote
    Compare(CompareArguments),
}

/// `sunshine bench thesis`.
#[derive(Debug, Args)]
pub struct ThesisArguments {
    /// Folder for tables (.txt, .csv), curves (.svg) and pictures (.png) [default: thesis- and the name of this
    /// machine]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,

    /// Measure this device; may be given several times [default: the processor, and a graphics card if there is one]
    #[arg(long, value_name = "DEVICE", value_parser = str::parse::<DeviceChoice>)]
    pub device: Vec<DeviceChoice>,

    /// Small pictures, to see in a minute whether everything works; their times say little
    #[arg(long)]
    pub quick: bool,

    /// Instead of measuring, make the pictures of its figures, small and without noise, on the first device
    #[arg(long)]
    pub pictures: bool,

    /// Processor threads to use [default: all]
    #[arg(long, value_name = "N", value_parser = whole_number(1..=4096))]
    pub threads: Option<u32>,

    /// Print nothing but the tables and errors
    #[arg(long)]
    pub quiet: bool,
}

/// `sunshine merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Films of one picture, in any order
    #[arg(required = true, value_name = "FILM")]
    pub films: Vec<PathBuf>,

    /// What to write: a .png or an .exr of the picture, or a .film, to be merged with others
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Make a picture although samples are missing, to see how it will look
    #[arg(long)]
    pub unfinished: bool,

    /// Brightness of a .png in photographic stops; chosen from the picture when missing
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = parse_exposure)]
    pub exposure: Option<f32>,

    /// What becomes of bright parts of a .png: srgb cuts off what is brighter than white, reinhard bends it down
    #[arg(long, value_name = "CURVE", default_value_t = ToneCurve::default())]
    pub tone_curve: ToneCurve,

    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// `sunshine show`.
#[derive(Debug, Args)]
pub struct ShowArguments {
    /// Pictures (.png, .exr) and films that Sunshine wrote
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
}

/// `sunshine generate`.
#[derive(Debug, Args)]
pub struct GenerateArguments {
    /// Where to put the files
    pub folder: PathBuf,
}

/// `sunshine info`.
#[derive(Debug, Args)]
pub struct InfoArguments {
    /// GroIMP project: a .gsz file, or an unpacked project's folder, project.gs or graph.xml
    pub scene: PathBuf,

    /// Print JSON, for other programs to read
    #[arg(long)]
    pub json: bool,

    /// Bounds on what the project may contain.
    #[command(flatten)]
    pub limits: LimitArguments,
}

/// What a project may contain.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct LimitArguments {
    /// Read projects that are larger than usual, or only smaller ones: for example --limit total-bytes=8000000000. May
    /// be given several times; docs/limits.md lists the names
    #[arg(long, value_name = "NAME=NUMBER", value_parser = parse_limit)]
    pub limit: Vec<NamedLimit>,
}

impl LimitArguments {
    /// The usual limits with those that are given.
    pub fn limits(&self) -> groimp::Limits {
        let mut limits = groimp::Limits::default();
        for NamedLimit { name, value } in &self.limit {
            limits.set(name, *value);
        }
        limits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_is_consistent() {
        Arguments::command().debug_assert();
    }
}
