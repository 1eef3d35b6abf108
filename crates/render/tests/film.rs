//! Tiles, bands, passes and adaptive sampling: what they must not change, and what they must.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::garden::garden;
use common::*;
use render::{
    Band, BandStatistics, Batch, ControlFlow, Device, DeviceChoice, Ending, Film, Layers, LoadedScene,
    Origins, PictureTarget, RenderError, RenderSettings, Sampling, StopRule, ToneCurve, compile, open_device,
    relative_noise, render_bands, stream_picture, write_picture,
};
use scene::{DVec3, LightKind, Phong, Scene, Shape};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use std::sync::Arc;

fn hash(film: &Film) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytemuck::cast_slice::<_, u8>(&film.pixels).hash(&mut hasher);
    hasher.finish()
}

fn load(device: &dyn Device, scene: &Scene) -> Box<dyn LoadedScene> {
    device.load(Arc::new(compile(scene).unwrap())).unwrap()
}

fn cpu(threads: usize) -> Box<dyn Device> {
    open_device(DeviceChoice::Cpu, Some(threads)).unwrap()
}

/// A lit sphere on the ground with a penumbra.
fn small_scene() -> Scene {
    let mut b = Builder::new();
    let ground = b.diffuse([0.5, 0.4, 0.3]);
    let red = b.diffuse([0.8, 0.2, 0.2]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    b.object(Shape::Sphere { radius: 0.5 }, at(0.0, 0.0, 0.5), red);
    b.light(LightKind::Point { power: [50.0; 3] }, at(2.0, -2.0, 3.0));
    b.sky([0.1, 0.15, 0.2]);
    b.look(DVec3::new(0.0, -4.0, 2.0), DVec3::new(0.0, 0.0, 0.3), DVec3::Z, 50.0);
    b.scene
}

#[test]
fn neither_tiles_nor_threads_change_a_bit() {
    let scene = garden();
    let plain = settings(37, 29, 3, 4);
    let reference = hash(&load(&*cpu(1), &scene).render(&plain, &go_on).unwrap());
    let five = load(&*cpu(5), &scene);
    for tile in [None, Some(1), Some(7), Some(16), Some(4096)] {
        let film = five.render(&RenderSettings { tile, ..plain.clone() }, &go_on).unwrap();
        assert_eq!(hash(&film), reference, "tile {tile:?}");
    }
}

#[test]
fn tiles_change_no_bit_on_a_graphics_card() {
    let Some(gpu) = gpu() else { return };
    let loaded = load(&gpu, &small_scene());
    let plain = settings(37, 29, 3, 3);
    let reference = hash(&loaded.render(&plain, &go_on).unwrap());
    for tile in [8, 13, 1024] {
        let film = loaded.render(&RenderSettings { tile: Some(tile), ..plain.clone() }, &go_on).unwrap();
        assert_eq!(hash(&film), reference, "tile {tile}");
    }
    // Sums that are continued, and a number of samples for every pixel.
    assert_eq!(hash(&in_two_batches(&*loaded, &plain)), reference);
    assert_counted_batches(&*loaded, &plain);
}

fn in_two_batches(loaded: &dyn LoadedScene, settings: &RenderSettings) -> Film {
    let mut film = Film::new(settings.width, settings.height);
    let first = Batch { samples: 1, ..Batch::whole(settings) };
    let rest = Batch { first_sample: 1, samples: settings.samples - 1, ..Batch::whole(settings) };
    for batch in [first, rest] {
        loaded.add_samples(settings, &batch, &mut film.pixels, &go_on).unwrap();
    }
    film
}

/// Pixels that ask for all samples get what all get, the others fewer.
fn assert_counted_batches(loaded: &dyn LoadedScene, settings: &RenderSettings) {
    let all = loaded.render(settings, &go_on).unwrap();
    let mut one = Film::new(settings.width, settings.height);
    let first = Batch { samples: 1, ..Batch::whole(settings) };
    loaded.add_samples(settings, &first, &mut one.pixels, &go_on).unwrap();
    let mut film = one.clone();
    for (i, pixel) in film.pixels.iter_mut().enumerate() {
        pixel.samples = if i % 3 == 0 { settings.samples } else { 1 };
    }
    let rest =
        Batch { first_sample: 1, samples: settings.samples - 1, counted: true, ..Batch::whole(settings) };
    loaded.add_samples(settings, &rest, &mut film.pixels, &go_on).unwrap();
    for (i, pixel) in film.pixels.iter().enumerate() {
        let expected = if i % 3 == 0 { all.pixels[i] } else { one.pixels[i] };
        assert_eq!(bytemuck::bytes_of(pixel), bytemuck::bytes_of(&expected), "pixel {i}");
    }
}

#[test]
fn batches_join_to_the_same_picture() {
    let loaded = load(&*cpu(2), &small_scene());
    let plain = settings(20, 15, 5, 3);
    let whole = hash(&loaded.render(&plain, &go_on).unwrap());
    assert_eq!(hash(&in_two_batches(&*loaded, &plain)), whole);
    assert_counted_batches(&*loaded, &plain);
}

/// Streams a picture with bands of at most `bytes`.
fn stream(path: &Path, settings: &RenderSettings, bytes: u64, layers: &str) -> (BandStatistics, Vec<u8>) {
    let scene = Arc::new(compile(&small_scene()).unwrap());
    let loaded = cpu(2).load(Arc::clone(&scene)).unwrap();
    let layers: Layers = if layers.is_empty() { Layers::default() } else { layers.parse().unwrap() };
    let target = PictureTarget {
        path,
        width: settings.width,
        height: settings.height,
        exposure: None,
        tone_curve: ToneCurve::default(),
        layers: &layers,
        origins: &Origins::of(&scene),
        provenance: None,
    };
    let mut statistics = BandStatistics::default();
    stream_picture(&target, |sink| {
        statistics =
            render_bands(&*loaded, settings, Sampling::Uniform, layers.are_traced(), bytes, &go_on, sink)?;
        Ok(())
    })
    .unwrap();
    (statistics, std::fs::read(path).unwrap())
}

#[test]
fn bands_bound_the_memory_and_change_no_byte_of_the_file() {
    let directory = tempfile::tempdir().unwrap();
    // 16384 pixels make a row of 512 KiB; a band has 16 of them at least.
    let wide = settings(16384, 64, 1, 1);
    const ROW: u64 = 16384 * 32;
    for (name, layers) in [("a.png", ""), ("a.exr", ""), ("b.exr", "depth,object,samples")] {
        let path = directory.path().join(name);
        let (narrow, in_bands) = stream(&path, &wide, 1, layers);
        let (broad, at_once) = stream(&path, &wide, 1 << 40, layers);
        let row = if layers.is_empty() { ROW } else { 3 * ROW };
        assert_eq!((narrow.peak_bytes, broad.peak_bytes), (16 * row, 64 * row), "{name}");
        assert_eq!((narrow.samples, narrow.rays), (broad.samples, broad.rays));
        assert!(!narrow.black && narrow.samples == 16384 * 64);
        assert!(in_bands == at_once, "{name}");
    }
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 3);
}

#[test]
fn a_streamed_png_is_that_of_the_whole_film() {
    let directory = tempfile::tempdir().unwrap();
    let plain = settings(33, 50, 4, 2);
    let (_, streamed) = stream(&directory.path().join("a.png"), &plain, 1, "");
    let film = load(&*cpu(2), &small_scene()).render(&plain, &go_on).unwrap();
    let path = directory.path().join("b.png");
    write_picture(&film, &path, render::automatic_exposure(&film)).unwrap();
    assert!(streamed == std::fs::read(path).unwrap());
}

#[test]
fn a_rendering_that_fails_leaves_no_file() {
    let directory = tempfile::tempdir().unwrap();
    let layers = Layers::default();
    for (name, exposure) in [("a.png", None), ("a.png", Some(0.0)), ("a.exr", None)] {
        let path = directory.path().join(name);
        let origins = Origins::default();
        let target = PictureTarget {
            path: &path,
            width: 8,
            height: 32,
            exposure,
            tone_curve: ToneCurve::default(),
            layers: &layers,
            origins: &origins,
            provenance: None,
        };
        let result = stream_picture(&target, |sink| {
            let film = Film::new(8, 16);
            sink(&Band { first_row: 0, width: 8, pixels: &film.pixels, layers: &[], denoised: &[] })?;
            Err(RenderError::Device(render::DeviceError::Cancelled))
        });
        assert!(matches!(result, Err(RenderError::Device(render::DeviceError::Cancelled))), "{name}");
    }
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
}

/// Renders with another way of sampling.
fn film_of(sampling: Sampling, settings: &RenderSettings) -> (Film, BandStatistics) {
    let loaded = load(&*cpu(2), &small_scene());
    let mut film = Film::new(settings.width, 0);
    let statistics = render_bands(&*loaded, settings, sampling, false, 1 << 20, &go_on, &mut |band| {
        film.pixels.extend_from_slice(band.pixels);
        Ok(())
    })
    .unwrap();
    film.height = settings.height;
    (film, statistics)
}

#[test]
fn a_time_that_is_over_at_once_gives_one_sample_per_pixel() {
    let rule = StopRule { time: Some(std::time::Duration::from_nanos(1)), noise: None, most_samples: 100 };
    let plain = RenderSettings { sampler: render::Sampler::Independent, ..settings(32, 24, 64, 3) };
    let (film, statistics) = film_of(Sampling::Until(rule), &plain);
    assert_eq!(statistics.samples, 32 * 24);
    let one = load(&*cpu(1), &small_scene()).render(&RenderSettings { samples: 1, ..plain }, &go_on).unwrap();
    assert_eq!(hash(&film), hash(&one));
}

#[test]
fn noise_is_reached_and_not_far_undercut() {
    // A Sobol sequence depends on the planned number of samples.
    let plain = RenderSettings { sampler: render::Sampler::Independent, ..settings(32, 24, 64, 3) };
    let rule = StopRule { time: None, noise: Some(0.05), most_samples: StopRule::MOST_SAMPLES };
    let (film, statistics) = film_of(Sampling::Until(rule), &plain);
    let noise = relative_noise(&film);
    // At the least the samples at which noise is first looked at are taken.
    assert!(noise <= 0.05 && (noise > 0.04 || film.pixels[0].samples == 16), "{noise}");
    assert_eq!(statistics.noise, Some(noise));
    // The picture is that of the same number of samples in one go.
    let samples = film.pixels[0].samples;
    let at_once =
        load(&*cpu(1), &small_scene()).render(&RenderSettings { samples, ..plain }, &go_on).unwrap();
    assert_eq!(hash(&film), hash(&at_once));
}

#[test]
fn an_open_number_of_samples_is_planned_for_the_most() {
    // Whatever number is reached, by whatever passes, the samples are the first of one long sequence.
    let most_samples = 4096;
    let plain = settings(16, 12, 64, 3);
    let rule = StopRule { time: None, noise: Some(0.03), most_samples };
    let (film, _) = film_of(Sampling::Until(rule), &plain);
    let samples = film.pixels[0].samples;
    assert!(samples > 16 && samples < most_samples, "{samples}");
    let planned = RenderSettings { samples: most_samples, ..plain };
    let mut at_once = Film::new(16, 12);
    let batch = Batch { samples, ..Batch::whole(&planned) };
    load(&*cpu(1), &small_scene()).add_samples(&planned, &batch, &mut at_once.pixels, &go_on).unwrap();
    assert_eq!(hash(&film), hash(&at_once));
}

#[test]
fn the_estimated_noise_is_the_error_of_independent_samples() {
    // Against a picture with far less noise, over pixels whose error is estimated from 32 samples.
    let plain = RenderSettings { sampler: render::Sampler::Independent, ..settings(32, 24, 32, 3) };
    let loaded = load(&*cpu(2), &small_scene());
    let film = loaded.render(&plain, &go_on).unwrap();
    let exact = loaded.render(&RenderSettings { samples: 4096, seed: 9, ..plain }, &go_on).unwrap();
    let luminance = |c: [f32; 3]| f64::from(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]);
    let mean = exact.radiances().map(luminance).sum::<f64>() / exact.pixels.len() as f64;
    let squares = film
        .radiances()
        .zip(exact.radiances())
        .map(|(a, b)| ((luminance(a) - luminance(b)) / (luminance(b) + 0.05 * mean)).powi(2));
    let mut squares: Vec<f64> = squares.collect();
    squares.sort_by(f64::total_cmp);
    squares.truncate(squares.len() * 99 / 100);
    let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    // Strata within a pixel make the true error smaller than that of independent samples, never larger: 760 pixels
    // tell it to 1/√1520 = 2.6 %, five of which are 13 %.
    let estimate = relative_noise(&film);
    assert!(error < 1.13 * estimate && error > 0.3 * estimate, "error {error} estimate {estimate}");
}

#[test]
fn adaptive_sampling_has_no_bias_and_spends_what_was_asked_for() {
    // Few samples, so that a bias by pixels that happen to look clean would be large; many pictures, so that the
    // error of their mean is small. The ground is lit by a body that shines but is no light: only one path in some
    // finds it.
    let mut b = Builder::new();
    let white = b.diffuse([0.7; 3]);
    let shining = b.phong(|s| Phong { emissive: grey(s, 8.0), ..Phong::default() });
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), white);
    b.object(Shape::Sphere { radius: 0.3 }, at(0.0, 0.0, 1.2), shining);
    b.look(DVec3::new(0.0, -3.0, 1.0), DVec3::ZERO, DVec3::Z, 20.0);
    let loaded = load(&*cpu(2), &b.scene);

    let reference = loaded.render(&settings(16, 12, 16384, 1), &go_on).unwrap();
    let (exact, exact_error) = mean_and_error(&reference);
    const PICTURES: u32 = 200;
    let mut means = Vec::new();
    let mut least = u32::MAX;
    let mut most = 0;
    for seed in 0..PICTURES {
        let plain = RenderSettings { seed: 100 + seed, ..settings(16, 12, 16, 1) };
        let film = render::render_adaptive(&*loaded, &plain, &go_on).unwrap();
        let spent = film.samples() as f64 / film.pixels.len() as f64;
        assert!((spent - 16.0).abs() < 0.5, "{spent}");
        least = least.min(film.pixels.iter().map(|pixel| pixel.samples).min().unwrap());
        most = most.max(film.pixels.iter().map(|pixel| pixel.samples).max().unwrap());
        means.push(mean_and_error(&film).0[1]);
    }
    assert!((4..12).contains(&least) && most > 24, "{least} to {most}");
    let n = f64::from(PICTURES);
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n * (n - 1.0));
    let error = variance.sqrt().hypot(exact_error[1]);
    assert!((mean - exact[1]).abs() < 4.0 * error, "{mean} exact {} error {error}", exact[1]);
    // The test would notice a bias of five percent; counts that a half decides for itself cost twenty.
    assert!(4.0 * error < 0.05 * exact[1], "{error} of {}", exact[1]);
}

#[test]
fn an_adaptive_picture_does_not_depend_on_where_it_was_stopped() {
    let mut b = Builder::new();
    let white = b.diffuse([0.7; 3]);
    let shining = b.phong(|s| Phong { emissive: grey(s, 8.0), ..Phong::default() });
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), white);
    b.object(Shape::Sphere { radius: 0.3 }, at(0.0, 0.0, 1.2), shining);
    b.look(DVec3::new(0.0, -3.0, 1.0), DVec3::ZERO, DVec3::Z, 20.0);
    let loaded = load(&*cpu(2), &b.scene);
    // So many pixels that a pass is some samples only.
    let plain = settings(256, 192, 96, 1);
    let whole = render::render_adaptive(&*loaded, &plain, &go_on).unwrap();
    let mut film = render::AdaptiveFilm::new(&plain);
    let mut passes = 0;
    let mut taken = 0;
    loop {
        let mut stop = |film: &render::AdaptiveFilm| {
            assert!(film.taken() > taken && film.is_of(&plain), "{} after {taken}", film.taken());
            taken = film.taken();
            ControlFlow::Break(())
        };
        passes += 1;
        let ending = render::continue_adaptive(&*loaded, &plain, &mut film, &go_on, &mut stop).unwrap();
        // The picture so far has no other brightness than that of its samples.
        assert!(film.film().pixels.iter().all(|pixel| pixel.samples > 0));
        if ending == Ending::Complete {
            break;
        }
    }
    assert!(passes > 3, "{passes}");
    let bytes = |film: &Film| bytemuck::cast_slice::<_, u8>(&film.pixels).to_vec();
    assert!(bytes(&film.film()) == bytes(&whole));
    // What a file might say of other settings.
    assert!(!film.is_of(&settings(256, 192, 8, 1)) && !film.is_of(&settings(192, 256, 96, 1)));
}
