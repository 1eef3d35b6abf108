//! Pictures against an established renderer, and radiances that are known exactly, read from GroIMP projects.
//!
//! The references and how they were made: tests/data/peers/README.md.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

use exr::prelude::{FlatSamples, read_all_flat_layers_from_file};
use render::{ControlFlow, DeviceChoice, Film, RenderSettings, Sampler, compile, open_device};
use std::path::PathBuf;
use std::sync::Arc;

fn peers() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/peers"))
}

fn render_project(name: &str, settings: &RenderSettings) -> Film {
    let project = groimp::read(&peers().join(name)).unwrap();
    assert!(project.report.is_empty(), "{:?}", project.report);
    let device = open_device(DeviceChoice::Cpu, None).unwrap();
    let scene = Arc::new(compile(&project.scene).unwrap());
    // The scores need the variance of the mean, which single samples predict only if they are independent.
    let settings = RenderSettings { sampler: Sampler::Independent, ..settings.clone() };
    device.load(scene).unwrap().render(&settings, &|_| ControlFlow::Continue(())).unwrap()
}

/// A reference picture: mean radiance and its standard error per pixel and channel.
struct Reference {
    width: usize,
    mean: [Vec<f32>; 3],
    error: [Vec<f32>; 3],
}

fn read_reference(name: &str) -> Reference {
    let image = read_all_flat_layers_from_file(peers().join(format!("{name}.exr"))).unwrap();
    let layer = &image.layer_data[0];
    let channel = |wanted: &str| {
        let channel =
            layer.channel_data.list.iter().find(|channel| channel.name.to_string() == wanted).unwrap();
        match &channel.sample_data {
            FlatSamples::F32(samples) => samples.clone(),
            _ => panic!("channel {wanted} is not float32"),
        }
    };
    Reference {
        width: layer.size.x(),
        mean: ["R", "G", "B"].map(channel),
        error: ["stderr.R", "stderr.G", "stderr.B"].map(channel),
    }
}

/// Compares blocks of 16 x 16 pixels by their Z-score: the difference of the means over the standard error that both
/// pictures predict.
fn assert_agrees(name: &str, film: &Film) {
    const BLOCK: u32 = 16;
    let reference = read_reference(name);
    assert_eq!(reference.width, film.width as usize);
    let mut scores = Vec::new();
    for block_y in (0..film.height).step_by(BLOCK as usize) {
        for block_x in (0..film.width).step_by(BLOCK as usize) {
            for c in 0..3 {
                let (mut difference, mut variance, mut level) = (0.0f64, 0.0f64, 0.0f64);
                for y in block_y..block_y + BLOCK {
                    for x in block_x..block_x + BLOCK {
                        let index = y as usize * reference.width + x as usize;
                        let expected = f64::from(reference.mean[c][index]);
                        difference += f64::from(film.radiance(x, y)[c]) - expected;
                        variance += f64::from(film.variance_of_mean(x, y)[c])
                            + f64::from(reference.error[c][index]).powi(2);
                        level += expected;
                    }
                }
                // The reference's lamp reflects nothing, ours up to a hundredth: 1e-4 of the picture.
                let systematic = 2e-4 * level;
                scores.push(difference.abs() / (variance + systematic * systematic + 1e-12).sqrt());
            }
        }
    }
    let largest = scores.iter().copied().fold(0.0, f64::max);
    let mean_square = scores.iter().map(|z| z * z).sum::<f64>() / scores.len() as f64;
    eprintln!("{name}: {} block values, largest Z {largest:.2}, mean Z² {mean_square:.3}", scores.len());
    // Among a thousand normal values one beyond 5 comes up once in 1700 pictures. The three channels of a block are
    // correlated, so the mean of Z² scatters by sqrt(2 / blocks).
    let scatter = (2.0 * 3.0 / scores.len() as f64).sqrt();
    assert!(largest < 5.0, "largest Z {largest}");
    assert!(mean_square < 1.0 + 5.0 * scatter, "mean Z² {mean_square}");
}

#[test]
fn the_cornell_box_agrees_with_mitsuba() {
    let settings = RenderSettings { width: 256, height: 256, samples: 144, seed: 1, ..Default::default() };
    assert_agrees("cornell", &render_project("cornell", &settings));
}

#[test]
fn soft_shadows_agree_with_mitsuba() {
    let settings = RenderSettings { width: 352, height: 224, samples: 108, seed: 2, ..Default::default() };
    assert_agrees("penumbra", &render_project("penumbra", &settings));
}

/// Renders a scene of `make_materials.py` with as many surfaces per path as its reference.
fn assert_material_agrees(name: &str, depth: u32) {
    let settings =
        RenderSettings { width: 128, height: 96, samples: 256, depth, seed: 4, ..Default::default() };
    assert_agrees(name, &render_project(name, &settings));
}

#[test]
fn a_spot_light_on_solids_agrees_with_mitsuba() {
    assert_material_agrees("spot", 5);
}

#[test]
fn cut_out_leaves_in_sun_and_sky_agree_with_mitsuba() {
    assert_material_agrees("leaves", 5);
}

#[test]
fn refraction_agrees_with_mitsuba() {
    assert_material_agrees("glass", 10);
}

#[test]
fn mirrors_agree_with_mitsuba() {
    assert_material_agrees("mirrors", 6);
}

#[test]
fn half_transparent_sheets_agree_with_mitsuba() {
    assert_material_agrees("veils", 5);
}

#[test]
fn checkerboards_under_a_lamp_and_a_sky_agree_with_mitsuba() {
    assert_material_agrees("textures", 5);
}

#[test]
fn single_lights_over_a_plane_have_their_exact_radiance() {
    // (project, exact radiance at the centre of the picture), from the laws of the lights; the area light's value
    // includes the finite size of the lamp to four digits.
    let pi = std::f64::consts::PI;
    let cases = [
        ("calib_point", [2.0, 1.0, 0.5].map(|e| e * 0.5 / pi), 0.0),
        ("calib_sun", [2.0, 1.0, 0.5].map(|e| e * 0.5 / pi), 0.0),
        ("calib_sky", [1.0, 0.5, 0.25].map(|e| e * 0.5), 0.0),
        ("calib_area", [100.0, 50.0, 25.0].map(|l| l * 2.0 * 0.5 / pi / 100.0 * 0.9917), 3e-4),
        ("calib_leaf", [2.0 * 0.05, 0.4, 0.5 * 0.05].map(|e| e / pi), 0.0),
    ];
    for (name, expected, systematic) in cases {
        // The centre of a picture of one degree; the light falls off towards its edges by less than 1e-4.
        let settings =
            RenderSettings { width: 32, height: 32, samples: 72, depth: 1, seed: 3, ..Default::default() };
        let film = render_project(name, &settings);
        let n = f64::from(film.width * film.height);
        for (c, expected) in expected.into_iter().enumerate() {
            let pixels = || (0..film.height).flat_map(|y| (0..film.width).map(move |x| (x, y)));
            let mean = pixels().map(|(x, y)| f64::from(film.radiance(x, y)[c])).sum::<f64>() / n;
            let error =
                pixels().map(|(x, y)| f64::from(film.variance_of_mean(x, y)[c])).sum::<f64>().sqrt() / n;
            let tolerance = 5.0 * error + (2e-4 + systematic) * expected;
            assert!((mean - expected).abs() < tolerance, "{name} channel {c}: {mean} for {expected}");
        }
    }
}
