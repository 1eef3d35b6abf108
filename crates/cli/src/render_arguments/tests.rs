use super::*;
use crate::arguments::{Arguments, Command};
use clap::Parser;
use render::{Filter, Sampler};

fn render(words: &[&str]) -> Result<RenderArguments, clap::Error> {
    let all = ["sunshine", "render", "plant.gsz"].iter().chain(words);
    match Arguments::try_parse_from(all)?.command {
        Command::Render(arguments) => Ok(*arguments),
        other => panic!("{other:?}"),
    }
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
    for wrong in ["", "640", "x", "640x", "x480", "0x480", "640x0", "640x65537", "-1x5", "1.5x2", "1x2x3"] {
        assert!(wrong.parse::<Size>().is_err(), "{wrong}");
    }
    assert_eq!("640x70000".parse::<Size>().unwrap_err(), "height: expected a whole number from 1 to 65536");
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
    for wrong in [["--sampler", "halton"], ["--filter", "sinc"], ["--crop", "1,2,3"], ["--crop", "0,0,0,1"]] {
        assert!(render(&wrong).is_err(), "{wrong:?}");
    }
}

#[test]
fn cameras() {
    let given =
        "--camera-position=1,2,3 --camera-target -1,0,0 --camera-up 0,1,0 --fov 40 --aperture 0.1 --focus 2";
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
