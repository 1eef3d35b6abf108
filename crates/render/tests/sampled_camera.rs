//! Reconstruction filters, the lens and crop windows in whole pictures.

mod common;

use common::garden::garden;
use common::*;
use render::{CropWindow, Film, Filter, RenderSettings, Sampler, compile};
use scene::{Camera, DVec3, Lens, Projection, Scene};
use std::f64::consts::PI;

const EDGE: u32 = 8;

/// White sky, with a black half-plane over all x > `x`, seen from 4 m above in a picture 8 m wide there.
fn step(x: f64, projection: Projection, lens: Option<Lens>) -> Scene {
    let mut b = Builder::new();
    let black = b.diffuse([0.0; 3]);
    b.rectangle(DVec3::new(x + 500.0, 0.0, 0.0), (1000.0, 1000.0), true, black);
    b.sky([1.0; 3]);
    b.look(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y, 90.0);
    b.scene.camera = Camera { projection, lens, ..b.scene.camera };
    b.scene
}

/// Mean radiance of each column.
fn columns(film: &Film) -> Vec<f64> {
    (0..film.width)
        .map(|x| (0..film.height).map(|y| f64::from(film.radiance(x, y)[0])).sum::<f64>())
        .map(|sum| sum / f64::from(film.height))
        .collect()
}

/// Mean of `f` over [a, b].
fn mean(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let n = 2000;
    (0..n).map(|i| f(a + (b - a) * (f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
}

#[test]
fn a_step_seen_through_a_filter_is_its_integral() {
    /// Density by distance from the middle of the pixel, up to a radius.
    type Profile = (Filter, fn(f64) -> f64, f64);
    const PROFILES: [Profile; 4] = [
        (Filter::Box, |_| 1.0, 0.5),
        (Filter::Tent, |x| 1.0 - x.abs(), 1.0),
        (Filter::Gaussian, |x| (-2.0 * x * x).exp() / ((0.5 * PI).sqrt() * 0.997_300_203_9), 1.5),
        (
            Filter::BlackmanHarris,
            |x| {
                let t = PI * x / 1.5;
                (0.35875 + 0.48829 * t.cos() + 0.14128 * (2.0 * t).cos() + 0.01168 * (3.0 * t).cos())
                    / (2.0 * 1.5 * 0.35875)
            },
            1.5,
        ),
    ];
    let edge = 0.3;
    let scene = step(edge, PARALLEL(f64::from(EDGE)), None);
    for (filter, density, radius) in PROFILES {
        for (sampler, tolerance) in [
            // 1024 samples lie in 1024 columns of the same width in terms of the filter's integral: at most one of
            // them is cut by the edge.
            (Sampler::Sobol, 1.1 / 1024.0),
            // Five standard deviations of at most 0.5 / sqrt(8 rows * 1024 samples).
            (Sampler::Independent, 5.0 * 0.5 / 8192f64.sqrt()),
        ] {
            let settings = RenderSettings { filter, sampler, grid: 1, ..settings(EDGE, EDGE, 1024, 1) };
            for (column, value) in columns(&render(&scene, &settings)).into_iter().enumerate() {
                let middle = column as f64 + 0.5 - 0.5 * f64::from(EDGE);
                let end = (edge - middle).clamp(-radius, radius);
                let expected = mean(density, -radius, end) * (end + radius);
                assert!(
                    (value - expected).abs() < tolerance,
                    "{filter:?} {sampler:?}, column {column}: {value}, expected {expected}"
                );
            }
        }
    }
}

/// Share of a disc of radius 1 left of a line at `x`.
fn disc_share(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / PI
}

#[test]
fn the_circle_of_confusion_is_that_of_a_thin_lens() {
    let perspective = Projection::Perspective { fov_x: PI / 2.0, aspect: 1.0 };
    let edge = 0.3;
    let distance = 4.0;
    for projection in [perspective, PARALLEL(8.0)] {
        for focus in [2.0, 3.0, 8.0] {
            let radius = 1.5;
            let scene = step(edge, projection, Some(Lens { radius, focus: Some(focus) }));
            let film = render(&scene, &settings(EDGE, EDGE, 2048, 1));
            // Radius of the blurred image of a point, in the plane of the step.
            let blur = radius * (1.0f64 - distance / focus).abs();
            for (column, value) in columns(&film).into_iter().enumerate() {
                let left = column as f64 - 0.5 * f64::from(EDGE);
                let expected = mean(|x| disc_share((edge - x) / blur), left, left + 1.0);
                // Five standard deviations of independent samples, which these are better than.
                let tolerance = 5.0 * 0.5 / (8.0 * 2048f64).sqrt();
                assert!(
                    (value - expected).abs() < tolerance,
                    "{projection:?}, focus {focus}, column {column}: {value}, expected {expected}"
                );
            }
        }
    }
}

#[test]
fn what_is_in_focus_is_sharp_and_the_middle_is_in_focus_by_itself() {
    for projection in [Projection::Perspective { fov_x: PI / 2.0, aspect: 1.0 }, PARALLEL(8.0)] {
        let settings = settings(EDGE, EDGE, 256, 1);
        // The middle of the picture is black.
        let sharp = columns(&render(&step(-0.7, projection, None), &settings));
        for focus in [Some(4.0), None] {
            let lens = Lens { radius: 1.5, focus };
            let blurred = columns(&render(&step(-0.7, projection, Some(lens)), &settings));
            for (a, b) in sharp.iter().zip(&blurred) {
                // Rounding may send single samples to the other side.
                assert!((a - b).abs() < 2.0 / 2048.0, "{projection:?} {focus:?}: {sharp:?} {blurred:?}");
            }
        }
    }
    let header = |scene: &Scene| compile(scene).unwrap().header;
    let on_sky = step(0.5, PARALLEL(8.0), Some(Lens { radius: 1.0, focus: None }));
    assert_eq!(header(&on_sky).vergence, 0.0);
    for (radius, focus) in [(-1.0, Some(1.0)), (f64::NAN, None), (1.0, Some(0.0)), (1.0, Some(-2.0))] {
        assert!(compile(&step(0.5, PARALLEL(8.0), Some(Lens { radius, focus }))).is_err());
    }
}

/// Asserts that a part of a picture has the very pixels of the whole.
fn assert_part_equals_whole(render: impl Fn(&RenderSettings) -> Film) {
    for sampler in [Sampler::Independent, Sampler::Sobol] {
        let settings = RenderSettings { sampler, filter: Filter::Gaussian, ..settings(40, 30, 4, 3) };
        let crop = CropWindow { x: 7, y: 5, width: 21, height: 13 };
        let whole = render(&settings);
        let part = render(&RenderSettings { crop: Some(crop), ..settings });
        assert_eq!((part.width, part.height), (21, 13));
        for (i, pixel) in part.pixels.iter().enumerate() {
            let (x, y) = (7 + i % 21, 5 + i / 21);
            assert!(bytemuck::bytes_of(pixel) == bytemuck::bytes_of(&whole.pixels[y * 40 + x]), "{x} {y}");
        }
    }
}

#[test]
fn a_part_of_a_picture_has_the_pixels_of_the_whole() {
    let mut scene = garden();
    scene.camera.lens = Some(Lens { radius: 0.05, focus: None });
    assert_part_equals_whole(|settings| render(&scene, settings));
    if let Some(gpu) = gpu() {
        assert_part_equals_whole(|settings| render_on(&gpu, &scene, settings));
    }
}
