//! What can be said about a picture.

use crate::arguments::LimitArguments;
use crate::camera_arguments::CameraArguments;
use crate::daylight_arguments::DaylightArguments;
use crate::option_values::{
    Pixel, SampleRange, Size, parse_acceleration, parse_background, parse_crop, parse_exposure,
    parse_flatness, parse_noise, parse_sample_range, parse_time, parse_visible_layers, picture_path,
    visible_layers_text, whole_number,
};
use crate::sample_choices::{FilterChoice, SamplerChoice};
use clap::Args;
use render::{
    Acceleration, CropWindow, DeviceChoice, Layers, RenderSettings, Renderer, Sampling, StopRule, ToneCurve,
};
use std::path::PathBuf;
use std::time::Duration;

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
    #[arg(long, value_name = "FILE", conflicts_with = "pixel")]
    pub checkpoint: Option<PathBuf>,

    /// Go on with a film that --checkpoint saved, as if it had never been stopped, and keep saving it. The scene and all
    /// settings must be the same. With the same --checkpoint FILE a missing film means: start from the beginning
    #[arg(long, value_name = "FILE", conflicts_with = "pixel")]
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

#[cfg(test)]
mod tests;
