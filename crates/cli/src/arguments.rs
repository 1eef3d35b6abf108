//! What can be said on the command line.

use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use render::{DeviceChoice, PictureFormat, RenderSettings};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

/// Makes physically based pictures of GroIMP plant models.
#[derive(Debug, Parser)]
#[command(name = "sunshine", version, arg_required_else_help = true)]
#[command(max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a picture of a scene
    Render(RenderArguments),
    /// Show what a scene holds, and what of it cannot be drawn
    Info(InfoArguments),
    /// List the processors and graphics cards that can render
    Devices,
}

/// `sunshine render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    /// GroIMP project: a .gsz file, or an unpacked project's folder, project.gs or graph.xml
    pub scene: PathBuf,

    /// Picture to write: .png to look at, .exr to measure in [default: the scene's name with .png, in the
    /// current folder]
    #[arg(short, long, value_name = "FILE", value_parser = picture_path())]
    pub output: Option<PathBuf>,

    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", default_value_t = Size::of(&RenderSettings::default()))]
    pub size: Size,

    /// Light paths followed per pixel; four times as many halve the noise and take four times as long
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().samples,
          value_parser = whole_number(1..=u32::MAX))]
    pub samples: u32,

    /// Number of surfaces that a light path may touch; 1 shows direct light only, shaded leaves need 5 or more
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().depth,
          value_parser = whole_number(1..=1000))]
    pub depth: u32,

    /// Divide every pixel into N x N cells and spread the samples evenly over them; smooths edges
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().grid,
          value_parser = whole_number(1..=64))]
    pub grid: u32,

    /// What computes: auto (a graphics card if there is one, else the processor), cpu, gpu, or gpu:N for the
    /// card that `sunshine devices` lists under that number
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = str::parse::<DeviceChoice>)]
    pub device: DeviceChoice,

    /// Start of the random numbers: the same number repeats a picture exactly, another gives independent noise
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().seed,
          value_parser = whole_number(0..=u32::MAX))]
    pub seed: u32,

    /// Brightness of a .png in photographic stops: +1 is twice as bright, -1 half. Chosen from the picture when
    /// missing; give it to compare pictures. An .exr is never changed
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = parse_exposure)]
    pub exposure: Option<f32>,

    /// Take the colours of images for sRGB, as photographs are stored. GroIMP takes them for linear, which makes
    /// them paler; without this option they look as in GroIMP
    #[arg(long)]
    pub srgb_textures: bool,

    /// Largest distance in metres between curved surfaces (splines, supershapes, height fields) and the triangles
    /// that are drawn for them [default: 1/2000 of the surface's size]
    #[arg(long, value_name = "METRES", value_parser = parse_flatness)]
    pub flatness: Option<f64>,

    /// Processor threads to use [default: all]
    #[arg(long, value_name = "N", value_parser = whole_number(1..=4096))]
    pub threads: Option<u32>,

    /// Render in squares of N x N pixels; it changes the memory taken, never the picture [default: 1024 on a graphics
    /// card, 128 on one in software, strips on the processor]
    #[arg(long, value_name = "N", value_parser = whole_number(1..=4096))]
    pub tile: Option<u32>,

    /// Write times and counts to this file, as JSON
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,

    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl RenderArguments {
    /// What the reader needs to know of them.
    pub fn read_options(&self) -> groimp::ReadOptions {
        groimp::ReadOptions {
            srgb_textures: self.srgb_textures,
            flatness: self.flatness.map(groimp::Flatness::Metres).unwrap_or_default(),
            ..groimp::ReadOptions::default()
        }
    }

    /// What the renderer needs to know of them.
    pub fn settings(&self) -> RenderSettings {
        RenderSettings {
            width: self.size.width,
            height: self.size.height,
            samples: self.samples,
            depth: self.depth,
            grid: self.grid,
            seed: self.seed,
            tile: self.tile,
        }
    }
}

/// `sunshine info`.
#[derive(Debug, Args)]
pub struct InfoArguments {
    /// GroIMP project: a .gsz file, or an unpacked project's folder, project.gs or graph.xml
    pub scene: PathBuf,

    /// Print JSON, for other programs to read
    #[arg(long)]
    pub json: bool,
}

/// Width and height of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
}

impl Size {
    /// Longest edge in pixels.
    const MAXIMUM: u32 = 65536;

    fn of(settings: &RenderSettings) -> Self {
        Size { width: settings.width, height: settings.height }
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text
            .split_once(['x', 'X', '×'])
            .ok_or("expected width, x and height in pixels, for example 1920x1080")?;
        let edge = whole_number(1..=Self::MAXIMUM);
        Ok(Size {
            width: edge(width).map_err(|error| format!("width: {error}"))?,
            height: edge(height).map_err(|error| format!("height: {error}"))?,
        })
    }
}

/// A parser of whole numbers that says what is accepted.
fn whole_number(range: RangeInclusive<u32>) -> impl Fn(&str) -> Result<u32, String> + Clone {
    move |text| {
        let accepted = text.trim().parse().ok().filter(|number| range.contains(number));
        accepted.ok_or_else(|| match (range.start(), range.end()) {
            (low, &u32::MAX) => format!("expected a whole number, at least {low}"),
            (low, high) => format!("expected a whole number from {low} to {high}"),
        })
    }
}

fn parse_exposure(text: &str) -> Result<f32, String> {
    // Beyond this every picture is black or white; it also keeps infinities and NaN out.
    const LIMIT: f32 = 100.0;
    let stops = text.trim().parse().ok().filter(|stops: &f32| stops.abs() <= LIMIT);
    stops.ok_or_else(|| format!("expected a number of stops from -{LIMIT} to {LIMIT}, for example -1.5"))
}

/// A distance in metres, from a micrometre up.
fn parse_flatness(text: &str) -> Result<f64, String> {
    let metres = text.trim().parse().ok().filter(|metres: &f64| metres.is_finite() && *metres >= 1e-6);
    metres.ok_or_else(|| "expected a distance in metres, at least 0.000001, for example 0.001".to_owned())
}

/// A parser of file names that takes pictures alone.
fn picture_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| PictureFormat::from_path(&path).map(|_| path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn render(words: &[&str]) -> Result<RenderArguments, clap::Error> {
        let all = ["sunshine", "render", "plant.gsz"].iter().chain(words);
        match Arguments::try_parse_from(all)?.command {
            Command::Render(arguments) => Ok(arguments),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_definition_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn defaults() {
        let arguments = render(&[]).unwrap();
        assert_eq!(arguments.settings(), RenderSettings::default());
        assert_eq!(arguments.size, Size { width: 640, height: 480 });
        assert_eq!(arguments.device, DeviceChoice::Auto);
        assert_eq!((arguments.samples, arguments.depth, arguments.grid, arguments.seed), (64, 5, 3, 0));
        assert_eq!(arguments.read_options(), groimp::ReadOptions::default());
        assert!(arguments.output.is_none() && arguments.exposure.is_none() && !arguments.quiet);
    }

    #[test]
    fn sizes() {
        let size = |width, height| Ok(Size { width, height });
        assert_eq!("1920x1080".parse::<Size>(), size(1920, 1080));
        assert_eq!("1X65536".parse::<Size>(), size(1, 65536));
        assert_eq!("8×6".parse::<Size>(), size(8, 6));
        for wrong in ["", "640", "x", "640x", "x480", "0x480", "640x0", "640x65537", "-1x5", "1.5x2", "1x2x3"]
        {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
        assert_eq!(
            "640x70000".parse::<Size>().unwrap_err(),
            "height: expected a whole number from 1 to 65536"
        );
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        for wrong in [
            ["--samples", "0"],
            ["--samples", "4294967296"],
            ["--depth", "0"],
            ["--depth", "1001"],
            ["--grid", "0"],
            ["--grid", "65"],
            ["--seed", "-1"],
            ["--threads", "0"],
            ["--exposure", "nan"],
            ["--exposure", "inf"],
            ["--device", "tpu"],
            ["--size", "big"],
            ["--output", "picture.jpg"],
        ] {
            assert!(render(&wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn exposures_may_be_negative() {
        assert_eq!(render(&["--exposure", "-1.5"]).unwrap().exposure, Some(-1.5));
        assert_eq!(render(&["--exposure=+2"]).unwrap().exposure, Some(2.0));
    }

    #[test]
    fn images_may_be_srgb() {
        assert!(render(&["--srgb-textures"]).unwrap().read_options().srgb_textures);
    }

    #[test]
    fn devices() {
        assert_eq!(render(&["--device", "gpu:1"]).unwrap().device, DeviceChoice::Gpu(Some(1)));
        assert_eq!(render(&["--device", "cpu"]).unwrap().device, DeviceChoice::Cpu);
    }
}
