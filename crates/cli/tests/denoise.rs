//! `sunshine render --denoise`, as far as this build and this machine have it.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

use std::path::Path;
use std::process::{Command, Output};

/// Runs `sunshine render` on the Cornell box.
fn render(directory: &Path, words: &[&str], library: Option<&str>) -> Output {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/cornell-box");
    let mut command = Command::new(env!("CARGO_BIN_EXE_sunshine"));
    command.arg("render").arg(scene.canonicalize().unwrap()).args(["--device", "cpu"]).args(words);
    if let Some(library) = library {
        command.env("SUNSHINE_OIDN", library);
    }
    command.current_dir(directory).output().unwrap()
}

fn errors(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

/// Whoever asks for what is not there is told how to get it, before anything is rendered.
#[test]
fn a_denoiser_that_is_missing_can_be_had() {
    let directory = tempfile::tempdir().unwrap();
    let output = render(directory.path(), &["-o", "a.png", "--denoise"], Some("no-such-folder"));
    let message = errors(&output);
    let (code, parts): (i32, &[&str]) = if cfg!(feature = "denoise") {
        (1, &["no-such-folder", "Open Image Denoise", "openimagedenoise.org", "SUNSHINE_OIDN"])
    } else {
        (2, &["built without denoising", "--features denoise", "README"])
    };
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(message.starts_with("error: ") && !message.contains("rendered"), "{message}");
    for part in parts {
        assert!(message.contains(part), "no {part:?} in {message}");
    }
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
}

#[cfg(feature = "denoise")]
mod with_a_library {
    use super::*;
    use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};
    use std::collections::HashMap;

    /// The channels of an EXR by name, and who denoised it.
    fn channels(path: &Path) -> (HashMap<String, Vec<f32>>, Option<String>) {
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(path)
            .unwrap();
        let denoised = image.layer_data.attributes.other.iter().find_map(|(name, value)| {
            (name == &exr::prelude::Text::from("denoised")).then(|| match value {
                exr::meta::attribute::AttributeValue::Text(text) => text.to_string(),
                other => panic!("{other:?}"),
            })
        });
        let floats = image.layer_data.channel_data.list.into_iter().filter_map(|channel| {
            let FlatSamples::F32(values) = channel.sample_data else { return None };
            Some((channel.name.to_string(), values))
        });
        (floats.collect(), denoised)
    }

    /// Whether the library is there; says so if not.
    fn library_is_there(output: &Output) -> bool {
        let missing = errors(output).contains("cannot be loaded");
        if missing {
            eprintln!("skipped: {}", errors(output));
        } else {
            assert_eq!(output.status.code(), Some(0), "{}", errors(output));
        }
        !missing
    }

    #[test]
    fn a_denoised_picture_is_nearer_to_the_truth_and_keeps_the_noisy_one() {
        let directory = tempfile::tempdir().unwrap();
        let few = ["--size", "96x72", "--samples", "8", "--seed", "1"];
        let with = |more: &[&str]| render(directory.path(), &[&few, more].concat(), None);
        let output = with(&["-o", "a.exr", "--denoise", "--stats", "stats.json"]);
        if !library_is_there(&output) {
            return;
        }
        let summary = String::from_utf8(output.stdout).unwrap();
        assert!(
            summary.contains("denoised by Open Image Denoise 2.") && summary.contains("biased"),
            "{summary}"
        );
        let statistics: serde_json::Value =
            serde_json::from_slice(&std::fs::read(directory.path().join("stats.json")).unwrap()).unwrap();
        assert!(statistics["denoiser"].as_str().unwrap().starts_with("Open Image Denoise"), "{statistics}");

        let (denoised, denoiser) = channels(&directory.path().join("a.exr"));
        assert_eq!(denoiser.as_deref(), statistics["denoiser"].as_str());
        // What was rendered is there untouched.
        with(&["-o", "plain.exr"]);
        let (plain, denoiser) = channels(&directory.path().join("plain.exr"));
        assert!(denoiser.is_none() && plain.len() == 3 && denoised.len() == 6);
        for channel in ["R", "G", "B"] {
            assert!(denoised[&format!("noisy.{channel}")] == plain[channel], "{channel}");
        }

        // Another seed, so that neither is nearer to it by chance.
        let many = ["--size", "96x72", "--samples", "256", "--seed", "2", "-o", "many.exr"];
        assert_eq!(render(directory.path(), &many, None).status.code(), Some(0));
        let (exact, _) = channels(&directory.path().join("many.exr"));
        let (mut before, mut after) = (0.0, 0.0);
        for channel in ["R", "G", "B"] {
            let exact = &exact[channel];
            let mean =
                |picture: &[f32]| picture.iter().copied().map(f64::from).sum::<f64>() / exact.len() as f64;
            // The lamp itself, a hundred times as bright as all else, has edges that any picture gets wrong.
            let limit = 4.0 * mean(exact);
            let error = |picture: &[f32]| {
                let squares = picture.iter().zip(exact).filter(|(_, exact)| f64::from(**exact) < limit);
                squares.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
            };
            before += error(&plain[channel]);
            after += error(&denoised[channel]);
            let ratio = mean(&denoised[channel]) / mean(&plain[channel]);
            assert!((ratio - 1.0).abs() < 0.03, "{channel}: {ratio}");
        }
        // A third is left; part of this is noise of the picture that it is compared with.
        assert!(after.sqrt() < 0.5 * before.sqrt(), "error {} becomes {}", before.sqrt(), after.sqrt());
        eprintln!("error {} becomes {}", before.sqrt(), after.sqrt());
    }

    #[test]
    fn every_way_of_sampling_and_both_formats_can_be_denoised() {
        let directory = tempfile::tempdir().unwrap();
        let small = ["--size", "24x40", "--denoise", "--samples", "16"];
        for more in [
            &["-o", "a.png"][..],
            &["-o", "b.png", "--exposure", "1", "--crop", "3,5,17,11"],
            &["-o", "c.exr", "--adaptive", "--layers", "all"],
            &["-o", "d.exr", "--noise", "50%", "--layers", "variance,samples"],
            &["-o", "e.png", "--renderer", "raytracer", "--quiet"],
        ] {
            let output = render(directory.path(), &[&small, more].concat(), None);
            if !library_is_there(&output) {
                return;
            }
            assert!(directory.path().join(more[1]).exists(), "{more:?}");
        }
        // A picture that travels says what was done to it.
        let png = std::fs::read(directory.path().join("a.png")).unwrap();
        assert!(png.windows(19).any(|window| window == b"denoised by Open Im"));
        let (all, _) = channels(&directory.path().join("c.exr"));
        assert!(["noisy.G", "G", "albedo.R", "variance.B"].iter().all(|name| all.contains_key(*name)));
    }

    #[test]
    fn what_does_not_fit_into_memory_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        let output = render(directory.path(), &["-o", "a.png", "--denoise", "--size", "16384x16384"], None);
        if errors(&output).contains("cannot be loaded") {
            eprintln!("skipped: {}", errors(&output));
            return;
        }
        assert_eq!(output.status.code(), Some(1));
        assert!(errors(&output).contains("GB of memory"), "{}", errors(&output));
    }
}
