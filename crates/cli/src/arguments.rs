//! What can be said on the command line.

use crate::bench_arguments::{CompareArguments, MatrixArguments};
use crate::camera_arguments::CameraArguments;
use crate::daylight_arguments::DaylightArguments;
use crate::option_values::{
    NamedLimit, Pixel, SampleRange, Size, parse_acceleration, parse_background, parse_crop, parse_exposure,
    parse_flatness, parse_limit, parse_noise, parse_sample_range, parse_time, parse_visible_layers,
    picture_path, visible_layers_text, whole_number,
};
use clap::{ArgAction, Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use render::{
    Acceleration, CropWindow, DeviceChoice, Filter, Layers, RenderSettings, Renderer, Sampler, Sampling,
    StopRule, ToneCurve,
};
use std::path::PathBuf;
use std::time::Duration;

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

/// `sunshine render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    /// GroIMP project: a .gsz file, or an unpacked project's folder, project.gs or graph.xml
    pub scene: PathBuf,

    /// More projects, as the steps of a growth: every one becomes a numbered picture, all with the camera and the
    /// exposure of the first
    #[arg(value_name = "SCENE")]
    pub more_scenes: Vec<PathBuf>,

    /// Picture to write: .png to look at, .exr to measure in [default: the scene's name with .png, in the
    /// current folder]. Of several pictures the names get numbers: plant-0001.png and so on
    #[arg(short, long, value_name = "FILE", value_parser = picture_path())]
    pub output: Option<PathBuf>,

    /// Width and height of the picture in pixels [default: 640x480]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,

    /// How light is computed: pathtracer (all of it, with noise) or raytracer (direct light, shadows, mirrors and
    /// glass, as GroIMP's own ray tracer)
    #[arg(long, value_name = "RENDERER", default_value_t = RenderSettings::default().renderer)]
    pub renderer: Renderer,

    /// Light paths followed per pixel; four times as many halve the noise and take four times as long. With --time or
    /// --noise the most that a pixel gets [default: 64; without bound with --time or --noise]
    #[arg(long, value_name = "N", value_parser = whole_number(1..=u32::MAX))]
    pub samples: Option<u32>,

    /// Render until this time is over, for example 90, 90s, 10m or 1h30m; at least one path per pixel is followed
    #[arg(long, value_name = "LIMIT", value_parser = parse_time)]
    pub time: Option<Duration>,

    /// Render until the estimated relative error of the pixels is at most this, for example 0.02 or 2%
    #[arg(long, value_name = "LEVEL", value_parser = parse_noise)]
    pub noise: Option<f64>,

    /// Spend more of the samples where the picture is noisy; --samples is the average
    #[arg(long, conflicts_with_all = ["time", "noise"])]
    pub adaptive: bool,

    /// Remove the noise that is left with Open Image Denoise: good to look at with few samples, but biased. It is a
    /// guess of what the picture might be; small leaves, veins and soft shadows may be blurred or invented. Measure in
    /// pictures without it; an .exr keeps them as noisy.R, noisy.G, noisy.B. README.md says how to get it
    #[arg(long, conflicts_with = "pixel")]
    pub denoise: bool,

    /// Save the unfinished picture to this film file every few minutes, at the end, and when Ctrl-C or the batch system
    /// stops the rendering; --resume goes on with it. Whatever happens, the file is whole: the last state that was saved
    #[arg(long, value_name = "FILE", conflicts_with_all = ["adaptive", "pixel"])]
    pub checkpoint: Option<PathBuf>,

    /// Go on with a film that --checkpoint saved, as if it had never been stopped, and keep saving it. The scene and all
    /// settings must be the same. With the same --checkpoint FILE a missing film means: start from the beginning
    #[arg(long, value_name = "FILE", conflicts_with_all = ["adaptive", "pixel"])]
    pub resume: Option<PathBuf>,

    /// Time between two savings of --checkpoint, for example 90, 90s or 10m [default: 5m]
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    pub checkpoint_every: Option<Duration>,

    /// Render only these of the --samples, to share them among machines: from A, which is a multiple of 64, up to and
    /// without B, a multiple of 64 or the last. `sunshine merge` joins the films of all shares to exactly the picture
    /// of one run. A picture is written only if --output names it
    #[arg(long, value_name = "A..B", value_parser = parse_sample_range,
          conflicts_with_all = ["adaptive", "pixel", "time", "noise"])]
    pub sample_range: Option<SampleRange>,

    /// Number of surfaces that a light path may touch; 1 shows direct light only, shaded leaves need 5 or more
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().depth,
          value_parser = whole_number(1..=1000))]
    pub depth: u32,

    /// Ray tracer: shadow rays to every area light and sky; more make soft shadows smoother
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().shadow_samples,
          value_parser = whole_number(1..=65536))]
    pub shadow_samples: u32,

    /// Radiance in W/(m² sr) of what lies behind the scene if it has no sky; seen, but lighting nothing
    #[arg(long, value_name = "R,G,B", default_value = "0,0,0", value_parser = parse_background)]
    pub background: [f32; 3],

    /// Divide every pixel into N x N cells and spread the samples evenly over them; smooths edges. For
    /// `--sampler independent`: the other spreads its samples evenly anyway
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().grid,
          value_parser = whole_number(1..=64))]
    pub grid: u32,

    /// What computes: auto (a graphics card if there is one, else the processor), cpu, gpu, gpu:N for the card that
    /// `sunshine devices` lists under that number, gpu:all for all cards together, or all for them and the processor
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = str::parse::<DeviceChoice>)]
    pub device: DeviceChoice,

    /// Start of the random numbers: the same number repeats a picture exactly, another gives independent noise
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().seed,
          value_parser = whole_number(0..=u32::MAX))]
    pub seed: u32,

    /// How samples are spread
    #[arg(long, value_enum, default_value_t = SamplerChoice::of(RenderSettings::default().sampler))]
    pub sampler: SamplerChoice,

    /// How light that arrives around the middle of a pixel is weighted
    #[arg(long, value_enum, default_value_t = FilterChoice::of(RenderSettings::default().filter))]
    pub filter: FilterChoice,

    /// Render only a part of the picture: columns left of it, rows above it, its width and height, in pixels. They
    /// are exactly those of the whole picture
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT", value_parser = parse_crop)]
    pub crop: Option<CropWindow>,

    /// Brightness of a .png in photographic stops: +1 is twice as bright, -1 half. Chosen from the picture when
    /// missing; give it to compare pictures. An .exr is never changed
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = parse_exposure)]
    pub exposure: Option<f32>,

    /// What becomes of bright parts of a .png: srgb cuts off what is brighter than white, reinhard bends it down, which
    /// keeps leaves and lamps from looking burnt and darkens the rest a little. An .exr is never changed
    #[arg(long, value_name = "CURVE", default_value_t = ToneCurve::default())]
    pub tone_curve: ToneCurve,

    /// Take the colours of images for sRGB, as photographs are stored. GroIMP takes them for linear, which makes
    /// them paler; without this option they look as in GroIMP
    #[arg(long)]
    pub srgb_textures: bool,

    /// Layers to draw, from 0 to 15 with commas between, instead of those of the saved view
    #[arg(long, value_name = "N,N,...", value_parser = parse_visible_layers)]
    pub visible_layers: Option<u16>,

    /// Largest distance in metres between curved surfaces (splines, supershapes, height fields) and the triangles
    /// that are drawn for them [default: 1/2000 of the surface's size]
    #[arg(long, value_name = "METRES", value_parser = parse_flatness)]
    pub flatness: Option<f64>,

    /// How objects are found along a ray: bvh by a hierarchy of boxes, none by testing every object, which is slow and
    /// there to compare with
    #[arg(long, value_name = "KIND", default_value = "bvh", value_parser = parse_acceleration)]
    pub accel: Acceleration,

    /// Processor threads to use [default: all]
    #[arg(long, value_name = "N", value_parser = whole_number(1..=4096))]
    pub threads: Option<u32>,

    /// What an .exr shall hold beside the picture, separated by commas: albedo, normal, depth, position, object,
    /// material, samples, variance, or all
    #[arg(long, value_name = "LAYERS", value_parser = str::parse::<Layers>)]
    pub layers: Option<Layers>,

    /// Instead of a picture, print everything that happens on the paths of one pixel, counted from the top left: the
    /// first 4 or N of them, on the processor
    #[arg(long, value_name = "X,Y[,N]", value_parser = str::parse::<Pixel>)]
    pub pixel: Option<Pixel>,

    /// Write the program that graphics cards run to this folder, in WGSL
    #[arg(long, value_name = "DIR")]
    pub dump_wgsl: Option<PathBuf>,

    /// Render in squares of N x N pixels; it changes the memory taken, never the picture [default: 1024 on a graphics
    /// card, 128 on one in software, strips on the processor]
    #[arg(long, value_name = "N", value_parser = whole_number(1..=4096))]
    pub tile: Option<u32>,

    /// Write times and counts to this file, as JSON
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,

    /// Bounds on what the project may contain.
    #[command(flatten)]
    pub limits: LimitArguments,

    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,

    /// Make N pictures, with the camera going once round what it looks at, to the left
    #[arg(long, value_name = "N", value_parser = whole_number(1..=100_000))]
    pub turntable: Option<u32>,

    /// What changes the saved view.
    #[command(flatten)]
    pub camera: CameraArguments,

    /// What changes the sun.
    #[command(flatten)]
    pub daylight: DaylightArguments,
}

impl RenderArguments {
    /// What the reader needs to know of them.
    pub fn read_options(&self) -> groimp::ReadOptions {
        groimp::ReadOptions {
            srgb_textures: self.srgb_textures,
            visible_layers: self.visible_layers,
            flatness: self.flatness.map(groimp::Flatness::Metres).unwrap_or_default(),
            limits: self.limits.limits(),
        }
    }

    /// What the renderer needs to know of them.
    pub fn settings(&self) -> RenderSettings {
        let size = self.size.unwrap_or(Size::of(&RenderSettings::default()));
        RenderSettings {
            width: size.width,
            height: size.height,
            samples: self.samples.unwrap_or(RenderSettings::default().samples),
            depth: self.depth,
            grid: self.grid,
            seed: self.seed,
            renderer: self.renderer,
            shadow_samples: self.shadow_samples,
            background: self.background,
            sampler: self.sampler.into(),
            filter: self.filter.into(),
            crop: self.crop,
            tile: self.tile,
        }
    }

    /// The options beside the renderer's settings that make the picture what it is, to be told in its file; `camera`
    /// is what changes the saved view.
    pub fn scene_options(&self, camera: &CameraArguments) -> Vec<(String, String)> {
        let mut options = camera.options();
        options.extend(self.daylight.options());
        if let Some(layers) = self.visible_layers {
            options.push(("visible-layers", visible_layers_text(layers)));
        }
        if self.srgb_textures {
            options.push(("srgb-textures", String::new()));
        }
        if let Some(flatness) = self.flatness {
            options.push(("flatness", flatness.to_string()));
        }
        if self.accel == Acceleration::None {
            options.push(("accel", "none".to_owned()));
        }
        options.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }

    /// How the samples are to be spread.
    pub fn sampling(&self) -> Sampling {
        match (self.time, self.noise) {
            (None, None) if self.adaptive => Sampling::Adaptive,
            (None, None) => Sampling::Uniform,
            (time, noise) => Sampling::Until(StopRule {
                time,
                noise,
                most_samples: self.samples.unwrap_or(StopRule::MOST_SAMPLES),
            }),
        }
    }
}

/// A [`Sampler`] as users call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplerChoice {
    /// Every number is drawn for itself
    Independent,
    /// Scrambled Sobol points, shared out among neighbouring pixels: less noise, and finer
    Sobol,
}

impl SamplerChoice {
    fn of(sampler: Sampler) -> Self {
        match sampler {
            Sampler::Independent => SamplerChoice::Independent,
            Sampler::Sobol => SamplerChoice::Sobol,
        }
    }
}

impl From<SamplerChoice> for Sampler {
    fn from(choice: SamplerChoice) -> Self {
        match choice {
            SamplerChoice::Independent => Sampler::Independent,
            SamplerChoice::Sobol => Sampler::Sobol,
        }
    }
}

/// A [`Filter`] as users call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FilterChoice {
    /// The same everywhere in the pixel: sharp
    Box,
    /// Falls linearly over 1 pixel
    Tent,
    /// Bell curve, 0.5 pixels wide
    Gaussian,
    /// Bell curve that is a little narrower and ends smoothly
    BlackmanHarris,
}

impl FilterChoice {
    fn of(filter: Filter) -> Self {
        match filter {
            Filter::Box => FilterChoice::Box,
            Filter::Tent => FilterChoice::Tent,
            Filter::Gaussian => FilterChoice::Gaussian,
            Filter::BlackmanHarris => FilterChoice::BlackmanHarris,
        }
    }
}

impl From<FilterChoice> for Filter {
    fn from(choice: FilterChoice) -> Self {
        match choice {
            FilterChoice::Box => Filter::Box,
            FilterChoice::Tent => Filter::Tent,
            FilterChoice::Gaussian => Filter::Gaussian,
            FilterChoice::BlackmanHarris => Filter::BlackmanHarris,
        }
    }
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

    fn render(words: &[&str]) -> Result<RenderArguments, clap::Error> {
        let all = ["sunshine", "render", "plant.gsz"].iter().chain(words);
        match Arguments::try_parse_from(all)?.command {
            Command::Render(arguments) => Ok(*arguments),
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
        assert_eq!((arguments.settings().width, arguments.settings().height), (640, 480));
        assert_eq!(arguments.device, DeviceChoice::Auto);
        assert_eq!((arguments.depth, arguments.grid, arguments.seed), (5, 3, 0));
        assert_eq!(arguments.settings().samples, 64);
        assert_eq!(arguments.sampling(), Sampling::Uniform);
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
            ["--tone-curve", "filmic"],
            ["--device", "tpu"],
            ["--size", "big"],
            ["--output", "picture.jpg"],
            ["--renderer", "radiosity"],
            ["--shadow-samples", "0"],
            ["--background", "1,1"],
            ["--background", "1,1,1,x"],
            ["--background", "1,-1,1"],
            ["--background", "1,nan,1"],
        ] {
            assert!(render(&wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn samplers_filters_and_parts_of_pictures() {
        for (word, sampler) in [("independent", Sampler::Independent), ("sobol", Sampler::Sobol)] {
            assert_eq!(render(&["--sampler", word]).unwrap().settings().sampler, sampler);
        }
        for (word, filter) in [
            ("box", Filter::Box),
            ("tent", Filter::Tent),
            ("gaussian", Filter::Gaussian),
            ("blackman-harris", Filter::BlackmanHarris),
        ] {
            assert_eq!(render(&["--filter", word]).unwrap().settings().filter, filter);
        }
        let crop = CropWindow { x: 3, y: 0, width: 5, height: 7 };
        assert_eq!(render(&["--crop", "3, 0,5,7"]).unwrap().settings().crop, Some(crop));
        for wrong in
            [["--sampler", "halton"], ["--filter", "sinc"], ["--crop", "1,2,3"], ["--crop", "0,0,0,1"]]
        {
            assert!(render(&wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn cameras() {
        let given = "--camera-position=1,2,3 --camera-target -1,0,0 --camera-up 0,1,0 --fov 40 --aperture 0.1 --focus 2";
        let camera = render(&given.split(' ').collect::<Vec<_>>()).unwrap().camera;
        assert_eq!(camera.camera_target.unwrap().x, -1.0);
        assert_eq!((camera.fov, camera.aperture, camera.focus), (Some(40.0), Some(0.1), Some(2.0)));
        for wrong in [
            &["--fov", "180"][..],
            &["--focus", "2"],
            &["--parallel", "0"],
            &["--fov", "40", "--parallel", "2"],
            &["--camera-position", "1,2"],
        ] {
            assert!(render(wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn exposures_may_be_negative() {
        assert_eq!(render(&["--exposure", "-1.5"]).unwrap().exposure, Some(-1.5));
        assert_eq!(render(&["--exposure=+2"]).unwrap().exposure, Some(2.0));
    }

    #[test]
    fn there_are_two_tone_curves() {
        assert_eq!(render(&[]).unwrap().tone_curve, ToneCurve::Srgb);
        assert_eq!(render(&["--tone-curve", "reinhard"]).unwrap().tone_curve, ToneCurve::Reinhard);
    }

    #[test]
    fn the_ray_tracer_has_settings() {
        let words = ["--renderer", "raytracer", "--shadow-samples", "191", "--background", "0.2, 0.3,0.5"];
        let settings = render(&words).unwrap().settings();
        assert_eq!(settings.renderer, Renderer::RayTracer);
        assert_eq!((settings.shadow_samples, settings.background), (191, [0.2, 0.3, 0.5]));
    }

    #[test]
    fn images_may_be_srgb() {
        assert!(render(&["--srgb-textures"]).unwrap().read_options().srgb_textures);
    }

    #[test]
    fn times_noise_and_pixels() {
        let seconds = |text: &str| parse_time(text).map(|time| time.as_secs_f64());
        assert_eq!(seconds("90"), Ok(90.0));
        assert_eq!(seconds("1.5s"), Ok(1.5));
        assert_eq!(seconds("10m"), Ok(600.0));
        assert_eq!(seconds("1h30m"), Ok(5400.0));
        for wrong in ["", "0", "m", "1d", "30m1h", "1h30", "-1s", "1m2m", "nan", "1e999", "s1"] {
            assert!(parse_time(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_noise("0.02"), Ok(0.02));
        assert_eq!(parse_noise("2 %"), Ok(0.02));
        for wrong in ["", "0", "-1", "nan", "2", "%"] {
            assert!(parse_noise(wrong).is_err(), "{wrong}");
        }
        assert_eq!("3,4".parse(), Ok(Pixel { x: 3, y: 4, samples: 4 }));
        assert_eq!("3, 4, 1".parse(), Ok(Pixel { x: 3, y: 4, samples: 1 }));
        for wrong in ["", "3", "3,", "3,-4", "1,2,3,4"] {
            assert!(wrong.parse::<Pixel>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_time_or_a_noise_lifts_the_bound_on_samples() {
        let rule = |words: &[&str]| match render(words).unwrap().sampling() {
            Sampling::Until(rule) => rule,
            other => panic!("{other:?}"),
        };
        assert_eq!(rule(&["--time", "1m"]).most_samples, StopRule::MOST_SAMPLES);
        assert_eq!(rule(&["--noise", "1%", "--samples", "100"]).most_samples, 100);
        assert_eq!(render(&["--adaptive"]).unwrap().sampling(), Sampling::Adaptive);
        assert!(render(&["--adaptive", "--time", "1m"]).is_err());
    }

    #[test]
    fn layers_are_bits() {
        assert_eq!(parse_visible_layers("0, 3,15"), Ok(0x8009));
        for wrong in ["", "16", "-1", "1,,2", "x"] {
            assert!(parse_visible_layers(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn devices() {
        assert_eq!(render(&["--device", "gpu:1"]).unwrap().device, DeviceChoice::Gpu(Some(1)));
        assert_eq!(render(&["--device", "cpu"]).unwrap().device, DeviceChoice::Cpu);
    }
}
