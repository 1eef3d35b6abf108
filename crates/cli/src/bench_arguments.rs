//! What can be said after `sunshine bench run` and `sunshine bench compare`.

use crate::option_values::{Size, whole_number};
use clap::Args;
use render::{DeviceChoice, RenderSettings};
use std::path::PathBuf;

/// `sunshine bench run`.
#[derive(Debug, Args)]
pub struct MatrixArguments {
    /// GroIMP projects, or names of scenes that are built in: cornell-box, bush-7, bush-25, bush-85, bush-271, bush-841,
    /// canopy (100,000 leaves), plantation (bushes with a million objects), forest (with a thousand million) [default: all
    /// that are built in but the forest]
    #[arg(value_name = "PROJECT")]
    pub scenes: Vec<PathBuf>,

    /// Devices to measure, separated by commas: cpu, gpu, gpu:N [default: the processor, and a graphics card if there
    /// is one]
    #[arg(long, value_name = "DEVICES", value_delimiter = ',', value_parser = str::parse::<DeviceChoice>)]
    pub device: Vec<DeviceChoice>,

    /// Light paths per pixel, one number or several separated by commas
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "16", value_parser = whole_number(1..=u32::MAX))]
    pub samples: Vec<u32>,

    /// Number of surfaces that a light path may touch
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().depth,
          value_parser = whole_number(1..=1000))]
    pub depth: u32,

    /// Width and height of the pictures in pixels
    #[arg(long, value_name = "WxH", default_value_t = Size::of(&RenderSettings::default()))]
    pub size: Size,

    /// How often everything is measured; the shortest time counts, and the longest tells the spread
    #[arg(long, value_name = "K", default_value = "3", value_parser = whole_number(1..=1000))]
    pub repeat: u32,

    /// File to write the measurements to, as JSON
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Processor threads to use [default: all]
    #[arg(long, value_name = "N", value_parser = whole_number(1..=4096))]
    pub threads: Option<u32>,

    /// Print nothing but the table and errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// `sunshine bench compare`.
#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Measurements that were made first
    #[arg(value_name = "OLD.json")]
    pub old: PathBuf,

    /// Measurements that are compared with them
    #[arg(value_name = "NEW.json")]
    pub new: PathBuf,
}
