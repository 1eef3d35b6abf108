//! The command that makes the picture in the window.

use crate::navigation::Sight;
use crate::settings::ViewSettings;
use crate::sight_line::{Extent, SightLine};
use render::{DeviceChoice, Filter, RenderSettings, Sampler, ToneCurve};
use scene::DVec3;

/// What was given when the window was opened and stays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GivenWords {
    /// The project, as it was given.
    pub scene: String,
    /// Options of the camera; they hold until the camera is moved.
    pub camera: Vec<String>,
    /// Options that cannot be changed in the window.
    pub other: Vec<String>,
}

/// The words of `sunshine render` that make the picture; `output` is the file.
pub fn render_words(
    given: &GivenWords,
    settings: &ViewSettings,
    sight: &Sight,
    output: Option<&str>,
) -> Vec<String> {
    let mut words = vec!["sunshine".to_owned(), "render".to_owned(), given.scene.clone()];
    words.extend(given.other.iter().cloned());
    let mut option = |name: &str, value: String| words.extend([format!("--{name}"), value]);
    let (own, usual) = (&settings.render, RenderSettings::default());
    // The size is told always: it is what one looks for first.
    option("size", format!("{}x{}", own.width, own.height));
    if own.renderer != usual.renderer {
        option("renderer", own.renderer.to_string());
    }
    if own.samples != usual.samples {
        option("samples", own.samples.to_string());
    }
    if own.depth != usual.depth {
        option("depth", own.depth.to_string());
    }
    if own.shadow_samples != usual.shadow_samples {
        option("shadow-samples", own.shadow_samples.to_string());
    }
    if own.grid != usual.grid {
        option("grid", own.grid.to_string());
    }
    if own.sampler != usual.sampler {
        option("sampler", sampler_name(own.sampler).to_owned());
    }
    if own.filter != usual.filter {
        option("filter", filter_name(own.filter).to_owned());
    }
    if own.seed != usual.seed {
        option("seed", own.seed.to_string());
    }
    if own.background != usual.background {
        let [r, g, b] = own.background;
        option("background", format!("{r},{g},{b}"));
    }
    if let Some(stops) = settings.exposure {
        option("exposure", stops.to_string());
    }
    if settings.tone_curve != ToneCurve::default() {
        option("tone-curve", settings.tone_curve.to_string());
    }
    if let Some(sun) = settings.sun {
        option("sun", format!("{},{}", sun.azimuth, sun.elevation));
    }
    if let Some(turbidity) = settings.turbidity {
        option("turbidity", turbidity.to_string());
    }
    if let Some(layers) = settings.visible_layers {
        let numbers = (0..u16::BITS).filter(|layer| layers >> layer & 1 != 0);
        option("visible-layers", numbers.map(|layer| layer.to_string()).collect::<Vec<_>>().join(","));
    }
    if settings.device != DeviceChoice::Auto {
        option("device", device_name(settings.device));
    }
    match sight {
        Sight::Given => words.extend(given.camera.iter().cloned()),
        Sight::Moved(line) => words.extend(camera_words(line)),
    }
    if let Some(output) = output {
        words.extend(["-o".to_owned(), output.to_owned()]);
    }
    words
}

/// The options that place the camera.
fn camera_words(line: &SightLine) -> Vec<String> {
    let point = |point: DVec3| format!("{},{},{}", point.x, point.y, point.z);
    let mut words = vec!["--camera-position".to_owned(), point(line.eye)];
    words.extend(["--camera-target".to_owned(), point(line.middle)]);
    if line.up != DVec3::Z {
        words.extend(["--camera-up".to_owned(), point(line.up)]);
    }
    words.extend(match line.extent {
        Extent::Degrees(degrees) => ["--fov".to_owned(), degrees.to_string()],
        Extent::Metres(width) => ["--parallel".to_owned(), width.to_string()],
    });
    if let Some((radius, focus)) = line.lens.filter(|(radius, _)| *radius > 0.0) {
        words.extend(["--aperture".to_owned(), radius.to_string()]);
        if let Some(distance) = focus {
            words.extend(["--focus".to_owned(), distance.to_string()]);
        }
    }
    words
}

/// What users call a sampler.
pub fn sampler_name(sampler: Sampler) -> &'static str {
    match sampler {
        Sampler::Independent => "independent",
        Sampler::Sobol => "sobol",
    }
}

/// What users call a filter.
pub fn filter_name(filter: Filter) -> &'static str {
    match filter {
        Filter::Box => "box",
        Filter::Tent => "tent",
        Filter::Gaussian => "gaussian",
        Filter::BlackmanHarris => "blackman-harris",
    }
}

/// What users call a device.
pub fn device_name(device: DeviceChoice) -> String {
    match device {
        DeviceChoice::Auto => "auto".to_owned(),
        DeviceChoice::Cpu => "cpu".to_owned(),
        DeviceChoice::Gpu(None) => "gpu".to_owned(),
        DeviceChoice::Gpu(Some(number)) => format!("gpu:{number}"),
        DeviceChoice::AllGpus => "gpu:all".to_owned(),
        DeviceChoice::All => "all".to_owned(),
    }
}

/// The words as one types them into a shell.
pub fn shell_line(words: &[String]) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+%@".contains(c);
    let quoted = |word: &String| match word.is_empty() || !word.chars().all(plain) {
        true => format!("'{}'", word.replace('\'', r"'\''")),
        false => word.clone(),
    };
    words.iter().map(quoted).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use render::Renderer;
    use scene::{Camera, SunPosition};

    fn given() -> GivenWords {
        GivenWords {
            scene: "my plant.gsz".to_owned(),
            camera: vec!["--fov".to_owned(), "30".to_owned()],
            other: vec!["--srgb-textures".to_owned()],
        }
    }

    #[test]
    fn only_what_is_not_usual_is_said() {
        let words = render_words(&given(), &ViewSettings::default(), &Sight::Given, None);
        assert_eq!(
            shell_line(&words),
            "sunshine render 'my plant.gsz' --srgb-textures --size 640x480 --fov 30"
        );
    }

    #[test]
    fn every_setting_and_the_camera_are_said() {
        let settings = ViewSettings {
            render: RenderSettings {
                renderer: Renderer::RayTracer,
                samples: 9,
                depth: 2,
                shadow_samples: 3,
                grid: 1,
                seed: 5,
                sampler: Sampler::Independent,
                filter: Filter::BlackmanHarris,
                background: [0.5, 0.0, 1.0],
                ..RenderSettings::default()
            },
            exposure: Some(-1.25),
            tone_curve: ToneCurve::Reinhard,
            device: DeviceChoice::Gpu(Some(1)),
            sun: Some(SunPosition { azimuth: 120.0, elevation: 35.5 }),
            turbidity: Some(3.5),
            visible_layers: Some(0b1011),
            ..ViewSettings::default()
        };
        let line = SightLine { lens: Some((0.01, Some(2.5))), ..SightLine::of(&Camera::default(), None) };
        let words = render_words(&given(), &settings, &Sight::Moved(line), Some("a b.png"));
        assert_eq!(
            shell_line(&words),
            "sunshine render 'my plant.gsz' --srgb-textures --size 640x480 --renderer raytracer --samples 9 --depth 2 \
             --shadow-samples 3 --grid 1 --sampler independent --filter blackman-harris --seed 5 --background 0.5,0,1 \
             --exposure -1.25 --tone-curve reinhard --sun 120,35.5 --turbidity 3.5 --visible-layers 0,1,3 --device gpu:1 --camera-position 0,-5.65685,5.65685 \
             --camera-target 0,-4.94975,4.94975 --fov 60 --aperture 0.01 --focus 2.5 -o 'a b.png'"
        );
    }

    #[test]
    fn quotes_are_quoted() {
        assert_eq!(shell_line(&["it's".to_owned(), String::new()]), r"'it'\''s' ''");
    }
}
