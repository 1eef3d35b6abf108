//! Renderings that are interrupted, continued, divided into shares and joined: always the same bits.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]
#![allow(clippy::single_range_in_vec_init, reason = "ranges of samples are meant")]

mod common;

use common::*;
use render::{
    BLOCK_SAMPLES, Batch, ControlFlow, DeviceChoice, DeviceError, Ending, Film, FilmFile, FilmSums, Goal,
    LoadedScene, Provenance, RenderSettings, Sampling, StopRule, compile, open_device, render_bands,
    render_passes,
};
use scene::{DVec3, LightKind, Scene, Shape};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

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

fn load() -> Box<dyn LoadedScene> {
    let device = open_device(DeviceChoice::Cpu, Some(2)).unwrap();
    device.load(Arc::new(compile(&small_scene()).unwrap())).unwrap()
}

fn bytes(film: &Film) -> &[u8] {
    bytemuck::cast_slice(&film.pixels)
}

fn film(settings: &RenderSettings, sums: FilmSums) -> Film {
    Film { width: settings.width, height: settings.height, pixels: sums.into_total() }
}

/// 200 samples: three blocks and a beginning of one.
const SAMPLES: u32 = 3 * BLOCK_SAMPLES + 8;

fn plain() -> RenderSettings {
    settings(12, 9, SAMPLES, 3)
}

fn share(loaded: &dyn LoadedScene, settings: &RenderSettings, samples: Range<u32>) -> FilmSums {
    let mut sums = FilmSums::new((settings.width * settings.height) as usize, samples.start);
    let ending = render_passes(loaded, settings, Goal::Samples(samples.end), &mut sums, &go_on, &mut |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(ending.unwrap(), Ending::Complete);
    sums
}

fn assert_shares_join(loaded: &dyn LoadedScene, settings: &RenderSettings) {
    let whole = loaded.render(settings, &go_on).unwrap();
    let mut joined = share(loaded, settings, 128..SAMPLES);
    for samples in [0..64, 64..128] {
        joined.merge(share(loaded, settings, samples)).unwrap();
    }
    assert_eq!(joined.ranges(), [0..SAMPLES]);
    assert!(bytes(&film(settings, joined)) == bytes(&whole));
}

#[test]
fn shares_join_to_the_picture_of_one_run() {
    assert_shares_join(&*load(), &plain());
    // Any number of threads.
    let device = open_device(DeviceChoice::Cpu, Some(3)).unwrap();
    let other = device.load(Arc::new(compile(&small_scene()).unwrap())).unwrap();
    let mut joined = share(&*load(), &plain(), 0..128);
    joined.merge(share(&*other, &plain(), 128..SAMPLES)).unwrap();
    assert!(bytes(&film(&plain(), joined)) == bytes(&load().render(&plain(), &go_on).unwrap()));
}

#[test]
fn shares_join_on_a_graphics_card() {
    let Some(gpu) = gpu() else { return };
    let loaded = render::Device::load(&gpu, Arc::new(compile(&small_scene()).unwrap())).unwrap();
    assert_shares_join(&*loaded, &plain());
}

/// A device that knows nothing of nodes: blocks are added in main memory.
struct BlockByBlock<'a>(&'a dyn LoadedScene);

impl LoadedScene for BlockByBlock<'_> {
    fn set_view(&mut self, _: &render::View) -> Result<(), DeviceError> {
        Ok(())
    }

    fn add_samples(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [kernels::records::kernel::FilmPixel],
        progress: &render::Progress<'_>,
    ) -> Result<(), DeviceError> {
        self.0.add_samples(settings, batch, pixels, progress)
    }

    fn add_layers(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [kernels::records::kernel::LayerPixel],
        progress: &render::Progress<'_>,
    ) -> Result<(), DeviceError> {
        self.0.add_layers(settings, batch, pixels, progress)
    }
}

#[test]
fn a_node_that_a_graphics_card_adds_is_that_of_its_blocks() {
    let Some(gpu) = gpu() else { return };
    let loaded = render::Device::load(&gpu, Arc::new(compile(&small_scene()).unwrap())).unwrap();
    let in_memory = BlockByBlock(&*loaded);
    // 3 x 2 tiles and one; four blocks, eleven and a beginning, and a node that does not begin at 0.
    for (tile, first, samples) in [(5, 0, 256), (64, 0, 256), (5, 0, 11 * 64 + 7), (5, 512, 256)] {
        let settings = RenderSettings { tile: Some(tile), ..settings(13, 9, first + samples, 2) };
        let most = std::sync::atomic::AtomicU64::new(0);
        let sums = |scene: &dyn LoadedScene| {
            let mut sums = FilmSums::new(13 * 9, first);
            while sums.end() < settings.samples {
                let before = 13 * 9 * u64::from(sums.samples());
                let report = |done| {
                    most.fetch_max(before + done, Ordering::Relaxed);
                    ControlFlow::Continue(())
                };
                sums.add(scene, &settings, &Batch::whole(&settings), settings.samples - sums.end(), &report)
                    .unwrap();
            }
            film(&settings, sums)
        };
        let (on_card, in_memory) = (sums(&*loaded), sums(&in_memory));
        assert_eq!(on_card.samples(), 13 * 9 * u64::from(samples));
        assert!(bytes(&on_card) == bytes(&in_memory), "tiles of {tile}, {samples} samples from {first} on");
        assert_eq!(most.into_inner(), 13 * 9 * u64::from(samples));
    }
    // Its clock counts what it did.
    assert!(loaded.device_seconds().is_none_or(|seconds| seconds > 0.0));
}

#[test]
fn a_graphics_card_stops_in_the_middle_of_a_node_and_goes_on() {
    let Some(gpu) = gpu() else { return };
    let loaded = render::Device::load(&gpu, Arc::new(compile(&small_scene()).unwrap())).unwrap();
    let settings = RenderSettings { samples: 260, ..plain() };
    let whole = loaded.render(&settings, &go_on).unwrap();
    let mut sums = share(&*loaded, &settings, 0..3);
    let reports = AtomicU32::new(0);
    let stop = |_: u64| match reports.fetch_add(1, Ordering::Relaxed) {
        4 => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    };
    // What is there is rendered again with the rest of the node, but not forgotten before.
    assert_eq!((sums.room(257), sums.room_anew(257)), (61, 253));
    let error = sums.add(&*loaded, &settings, &Batch::whole(&settings), 253, &stop).unwrap_err();
    assert!(matches!(error, DeviceError::Cancelled));
    assert_eq!(sums.ranges(), [0..3]);
    let three = film(&settings, sums.clone());
    assert!(bytes(&three) == bytes(&film(&settings, share(&*loaded, &settings, 0..3))));
    for (samples, end) in [(253, 256), (4, 260)] {
        sums.add(&*loaded, &settings, &Batch::whole(&settings), samples, &go_on).unwrap();
        assert_eq!(sums.ranges(), [0..end]);
    }
    assert!(bytes(&film(&settings, sums)) == bytes(&whole));
}

#[test]
fn several_devices_make_the_picture_of_one() {
    let Some(gpu) = gpu() else { return };
    let scene = Arc::new(compile(&small_scene()).unwrap());
    // Tall, so that there are rows for all.
    let tall = settings(6, 70, 2, 3);
    let one = render::Device::load(&gpu, Arc::clone(&scene)).unwrap().render(&tall, &go_on).unwrap();
    // The software adapter alone is all graphics cards here; on a machine with several of one kind it is the same.
    let all = open_device(DeviceChoice::AllGpus, None).unwrap();
    let kinds = all.kind();
    let film = all.load(Arc::clone(&scene)).unwrap().render(&tall, &go_on).unwrap();
    if !kinds.contains(" and ") {
        assert!(bytes(&film) == bytes(&one));
    }
    // Different kinds: every pixel is that of one or the other.
    let both = open_device(DeviceChoice::All, Some(1)).unwrap();
    assert!(both.kind().contains("CPU and "), "{}", both.kind());
    let mixed = both.load(Arc::clone(&scene)).unwrap().render(&tall, &go_on).unwrap();
    let cpu = open_device(DeviceChoice::Cpu, Some(1)).unwrap();
    let cpu = cpu.load(scene).unwrap().render(&tall, &go_on).unwrap();
    for (number, pixel) in mixed.pixels.iter().enumerate() {
        let is_of = |film: &Film| bytemuck::bytes_of(&film.pixels[number]) == bytemuck::bytes_of(pixel);
        assert!(is_of(&cpu) || is_of(&film), "pixel {number}");
    }
}

#[test]
fn a_rendering_that_is_stopped_after_every_pass_and_stored_ends_the_same() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.film");
    let loaded = load();
    // Large enough for several passes; the first one has 2^22 samples of all pixels.
    let settings = RenderSettings { seed: 3, ..plain() };
    let whole = loaded.render(&settings, &go_on).unwrap();
    let provenance = Provenance { settings: settings.options(), ..Provenance::default() };
    let mut sums = FilmSums::new(12 * 9, 0);
    let mut ends = Vec::new();
    // Odd goals stand for passes of any length.
    for goal in [1, 7, 63, 64, 100, 129, 130, SAMPLES] {
        let ending =
            render_passes(&*loaded, &settings, Goal::Samples(goal), &mut sums, &go_on, &mut |sums| {
                ends.push(sums.end());
                ControlFlow::Break(())
            });
        while sums.end() < goal {
            render_passes(&*loaded, &settings, Goal::Samples(goal), &mut sums, &go_on, &mut |_| {
                ControlFlow::Continue(())
            })
            .unwrap();
        }
        ending.unwrap();
        FilmFile { provenance: provenance.clone(), width: 12, height: 9, sums }.write(&path).unwrap();
        sums = FilmFile::read(&path).unwrap().sums;
    }
    assert!(ends.contains(&1) && ends.contains(&64), "{ends:?}");
    assert!(bytes(&film(&settings, sums)) == bytes(&whole));
}

#[test]
fn bands_and_passes_give_what_the_whole_film_gives() {
    let loaded = load();
    let whole = loaded.render(&plain(), &go_on).unwrap();
    let mut rows = Vec::new();
    let statistics = render_bands(&*loaded, &plain(), Sampling::Uniform, false, 1, &go_on, &mut |band| {
        rows.extend_from_slice(band.pixels);
        Ok(())
    })
    .unwrap();
    assert!(bytemuck::cast_slice::<_, u8>(&rows) == bytes(&whole));
    assert_eq!((statistics.samples, statistics.rays), (whole.samples(), whole.rays()));
    // A rule that stops at the same number: its sequences are planned for the same number.
    let rule = StopRule { time: None, noise: None, most_samples: SAMPLES };
    let until = render::render_until(&*loaded, &plain(), rule, &go_on).unwrap();
    assert!(bytes(&until) == bytes(&whole));
}

/// Fails after some samples of its third batch.
struct Failing(Box<dyn LoadedScene>, AtomicU32);

impl LoadedScene for Failing {
    fn set_view(&mut self, view: &render::View) -> Result<(), DeviceError> {
        self.0.set_view(view)
    }

    fn add_samples(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [kernels::records::kernel::FilmPixel],
        progress: &render::Progress<'_>,
    ) -> Result<(), DeviceError> {
        if self.1.fetch_add(1, Ordering::Relaxed) == 2 {
            pixels[0].samples += 1;
            return Err(DeviceError::Cancelled);
        }
        self.0.add_samples(settings, batch, pixels, progress)
    }

    fn add_layers(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [kernels::records::kernel::LayerPixel],
        progress: &render::Progress<'_>,
    ) -> Result<(), DeviceError> {
        self.0.add_layers(settings, batch, pixels, progress)
    }
}

#[test]
fn finished_samples_survive_a_device_that_fails() {
    let failing = Failing(load(), AtomicU32::new(0));
    let mut sums = FilmSums::new(12 * 9, 0);
    for samples in [64, 10] {
        sums.add(&failing, &plain(), &Batch::whole(&plain()), samples, &go_on).unwrap();
    }
    let error = sums.add(&failing, &plain(), &Batch::whole(&plain()), 10, &go_on).unwrap_err();
    assert!(matches!(error, DeviceError::Cancelled));
    assert_eq!(sums.ranges(), [0..74]);
    render_passes(&failing, &plain(), Goal::Samples(SAMPLES), &mut sums, &go_on, &mut |_| {
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(bytes(&film(&plain(), sums)) == bytes(&load().render(&plain(), &go_on).unwrap()));
}

#[test]
fn scenes_have_the_same_hash_whenever_they_are_compiled() {
    let hash = |scene: &Scene| compile(scene).unwrap().hash();
    let scene = common::garden::garden();
    let first = hash(&scene);
    assert_eq!(first.len(), 32);
    for _ in 0..3 {
        assert_eq!(hash(&scene), first);
    }
    assert_ne!(hash(&small_scene()), first);
    let mut moved = scene.clone();
    moved.objects[0].world_from_object.translation.x += 1e-3;
    assert_ne!(hash(&moved), first);
}
