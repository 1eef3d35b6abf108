//! What can be said about the window.

use crate::arguments::RenderArguments;
use crate::failure::Failure;
use crate::option_values::{NamedLimit, Size};
use clap::{Args, Command};
use std::path::Path;
use view::{GivenWords, ViewSettings};

/// `sunshine view`: the options of `sunshine render`, of which the window begins with the picture.
#[derive(Debug, Args)]
pub struct ViewArguments {
    /// The picture.
    #[command(flatten)]
    pub render: RenderArguments,

    /// Width and height of the window
    #[arg(long, value_name = "WxH", default_value_t = Size { width: 1360, height: 860 })]
    pub window: Size,
}

/// Options of `sunshine render` that mean nothing in a window.
const NOT_IN_A_WINDOW: [&str; 14] = [
    "time",
    "noise",
    "adaptive",
    "denoise",
    "checkpoint",
    "resume",
    "checkpoint_every",
    "sample_range",
    "crop",
    "layers",
    "pixel",
    "dump_wgsl",
    "stats",
    "turntable",
];

/// Leaves out of the help what means nothing in a window.
pub fn without_other_options(command: Command) -> Command {
    command.mut_subcommand("view", |view| {
        NOT_IN_A_WINDOW
            .iter()
            .chain(&["more_scenes"])
            .fold(view, |view, name| view.mut_arg(name, |option| option.hide(true)))
    })
}

impl ViewArguments {
    /// Refuses what means nothing in a window.
    ///
    /// # Errors
    /// If something of that kind is given.
    pub fn check(&self) -> Result<(), Failure> {
        if let Some(path) = self.render.more_scenes.first() {
            let text = format!("the window shows one project; open another one for {}", path.display());
            return Err(Failure::Usage(text));
        }
        let RenderArguments {
            time,
            noise,
            adaptive,
            denoise,
            checkpoint,
            resume,
            checkpoint_every,
            sample_range,
            crop,
            layers,
            pixel,
            dump_wgsl,
            stats,
            turntable,
            ..
        } = &self.render;
        let given = [
            time.is_some(),
            noise.is_some(),
            *adaptive,
            *denoise,
            checkpoint.is_some(),
            resume.is_some(),
            checkpoint_every.is_some(),
            sample_range.is_some(),
            crop.is_some(),
            layers.is_some(),
            pixel.is_some(),
            dump_wgsl.is_some(),
            stats.is_some(),
            turntable.is_some(),
        ];
        match NOT_IN_A_WINDOW.iter().zip(given).find(|(_, is_given)| *is_given) {
            None => Ok(()),
            Some((name, _)) => Err(Failure::Usage(format!(
                "--{} is an option of `sunshine render`; the window has no use for it",
                name.replace('_', "-")
            ))),
        }
    }

    /// What is set at first.
    pub fn settings(&self) -> ViewSettings {
        ViewSettings {
            render: self.render.settings(),
            follows_window: self.render.size.is_none(),
            exposure: self.render.exposure,
            tone_curve: self.render.tone_curve,
            device: self.render.device,
            sun: self.render.daylight.sun,
            turbidity: self.render.daylight.turbidity,
            visible_layers: self.render.visible_layers,
        }
    }

    /// What goes into the commands that the window shows and cannot be changed there.
    pub fn given(&self, scene: &Path) -> GivenWords {
        let mut other = Vec::new();
        if self.render.srgb_textures {
            other.push("--srgb-textures".to_owned());
        }
        if let Some(flatness) = self.render.flatness {
            other.extend(["--flatness".to_owned(), flatness.to_string()]);
        }
        if self.render.accel == render::Acceleration::None {
            other.extend(["--accel".to_owned(), "none".to_owned()]);
        }
        for NamedLimit { name, value } in &self.render.limits.limit {
            other.extend(["--limit".to_owned(), format!("{name}={value}")]);
        }
        if let Some(threads) = self.render.threads {
            other.extend(["--threads".to_owned(), threads.to_string()]);
        }
        GivenWords { scene: scene.to_string_lossy().into_owned(), camera: self.render.camera.words(), other }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::{Arguments, Command as Chosen};
    use clap::{CommandFactory, Parser};
    use render::{DeviceChoice, RenderSettings, Renderer, ToneCurve};
    use scene::{Camera, DVec3, Scene, SunPosition};
    use view::{Sight, SightLine, render_words};

    fn view(words: &[&str]) -> ViewArguments {
        let all = ["sunshine", "view", "plant.gsz"].iter().chain(words);
        match Arguments::try_parse_from(all).unwrap().command {
            Chosen::View(arguments) => *arguments,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_window_takes_the_options_of_the_picture() {
        let arguments = view(&["--depth", "3", "--size", "100x80", "--window", "900x700"]);
        assert_eq!(arguments.settings().render.depth, 3);
        assert!(!arguments.settings().follows_window && view(&[]).settings().follows_window);
        assert!(arguments.check().is_ok());
        assert!(matches!(view(&["--time", "5"]).check(), Err(Failure::Usage(_))));
        assert!(matches!(view(&["--dump-wgsl", "x"]).check(), Err(Failure::Usage(_))));
        for words in [
            ["--checkpoint", "a"],
            ["--resume", "a"],
            ["--checkpoint-every", "5"],
            ["--sample-range", "0..64"],
        ] {
            let Err(Failure::Usage(message)) = view(&words).check() else { panic!("{words:?}") };
            assert!(message.contains(words[0]), "{message}");
        }
        let help =
            without_other_options(Arguments::command()).find_subcommand_mut("view").unwrap().render_help();
        let help = help.to_string();
        assert!(help.contains("--depth") && !help.contains("--adaptive"), "{help}");
    }

    #[test]
    fn the_command_of_the_window_makes_its_picture() {
        let given =
            "--srgb-textures --flatness 0.01 --threads 2 --accel none --fov 33 --limit graph-nodes=12345";
        let given: Vec<_> = given.split(' ').collect();
        let given = &given[..];
        let arguments = view(given);
        let settings = ViewSettings {
            render: RenderSettings {
                renderer: Renderer::RayTracer,
                samples: 9,
                depth: 2,
                ..arguments.render.settings()
            },
            exposure: Some(-0.25),
            tone_curve: ToneCurve::Reinhard,
            device: DeviceChoice::Cpu,
            sun: Some(SunPosition { azimuth: -12.5, elevation: 30.0 }),
            turbidity: Some(2.5),
            visible_layers: Some(0b101),
            ..arguments.settings()
        };
        let camera = Camera::look_at(DVec3::new(0.123456789, -2.7, 1.1), DVec3::Z, DVec3::Z, 0.77);
        let line = SightLine::of(&camera, None).orbited(0.321, 0.123).panned(0.11, -0.07);
        for sight in [Sight::Given, Sight::Moved(line)] {
            let words =
                render_words(&arguments.given(Path::new("a plant.gsz")), &settings, &sight, Some("b.exr"));
            let Chosen::Render(read) = Arguments::try_parse_from(&words).unwrap().command else { panic!() };
            assert_eq!(read.scene, Path::new("a plant.gsz"));
            assert_eq!(read.settings(), settings.render);
            assert_eq!((read.exposure, read.device), (settings.exposure, settings.device));
            assert_eq!(read.tone_curve, settings.tone_curve);
            assert_eq!((read.daylight.sun, read.daylight.turbidity), (settings.sun, settings.turbidity));
            let options =
                groimp::ReadOptions { visible_layers: Some(0b101), ..arguments.render.read_options() };
            assert_eq!(read.read_options(), options);
            assert_eq!((read.threads, read.accel), (arguments.render.threads, arguments.render.accel));
            let mut scene = Scene { camera: camera.clone(), ..Scene::default() };
            read.camera.apply(&mut scene).unwrap();
            match sight {
                Sight::Given => assert_eq!(read.camera, arguments.render.camera),
                // To the last bit.
                Sight::Moved(line) => assert_eq!(scene.camera, line.camera()),
            }
        }
    }
}
