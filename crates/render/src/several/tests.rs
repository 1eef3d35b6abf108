//! Devices that only pretend: what comes out is that of one of them, whatever happens.

use super::*;
use crate::sums::sum_of_parts;
use crate::{BLOCK_SAMPLES, ControlFlow, Film};
use bytemuck::Zeroable;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64};

/// Gives every pixel a value that follows from its place and its samples, and in its last digits from the order in
/// which they are added; or fails when its number of calls is reached.
#[derive(Default)]
struct Fake {
    calls: AtomicU32,
    fails_from: Option<u32>,
    /// Whether small tiles help.
    recovers: bool,
    /// How often the camera was moved.
    looks: Arc<AtomicU32>,
    /// Batches that it was asked to sum, and where the pixels of each were.
    sums: Arc<Mutex<Vec<(Batch, usize)>>>,
    /// Its first sum waits until there are so many in all.
    waits_for: usize,
}

impl Fake {
    fn failing_from(call: u32, recovers: bool) -> Self {
        Fake { fails_from: Some(call), recovers, ..Fake::default() }
    }

    fn sound() -> Self {
        Fake::default()
    }
}

impl LoadedScene for Fake {
    fn set_view(&mut self, _: &View) -> Result<(), DeviceError> {
        self.looks.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }

    fn add_samples(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        let call = self.calls.fetch_add(1, Ordering::Relaxed);
        let helps = self.recovers && settings.tile == Some(SMALL_TILE);
        let fails = self.fails_from.is_some_and(|from| call >= from) && !helps;
        let first = batch.first_row * settings.window().width;
        for (pixel, number) in pixels.iter_mut().zip(first..) {
            for sample in batch.first_sample..batch.first_sample + batch.samples {
                pixel.radiance.x += ((number * 31 + sample * 17) % 97) as f32 + 0.1;
            }
            pixel.samples += batch.samples;
            if fails {
                let device = "card".to_owned();
                return Err(DeviceError::Gpu { device, doing: "testing", reason: "lost".to_owned() });
            }
        }
        match progress(pixels.len() as u64 * u64::from(batch.samples)) {
            ControlFlow::Break(()) => Err(DeviceError::Cancelled),
            ControlFlow::Continue(()) => Ok(()),
        }
    }

    fn sum_node(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        lock(&self.sums).push((*batch, pixels.as_ptr() as usize));
        while lock(&self.sums).len() < self.waits_for {
            std::thread::yield_now();
        }
        sum_of_parts(batch, BLOCK_SAMPLES, pixels, progress, |block, pixels, progress| {
            pixels.fill(FilmPixel::zeroed());
            self.add_samples(settings, block, pixels, progress)
        })
    }

    fn add_layers(
        &self,
        _: &RenderSettings,
        _: &Batch,
        _: &mut [LayerPixel],
        _: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        Ok(())
    }
}

fn settings() -> RenderSettings {
    RenderSettings { width: 7, height: 100, samples: 3, ..RenderSettings::default() }
}

fn bytes(film: &Film) -> Vec<u8> {
    bytemuck::cast_slice(&film.pixels).to_vec()
}

fn several(devices: Vec<Fake>, spare: Option<Box<Spare>>) -> Several {
    let named = devices.into_iter().zip(0..).map(|(fake, number)| -> (String, Box<dyn LoadedScene>) {
        (format!("device {number}"), Box::new(fake))
    });
    Several::new(named.collect(), spare)
}

/// Renders several pictures, as passes do, and compares each with that of one sound device.
fn assert_right(several: &Several) -> String {
    let expected = bytes(&Fake::sound().render(&settings(), &|_| ControlFlow::Continue(())).unwrap());
    let most = AtomicU64::new(0);
    for _ in 0..4 {
        let film = several
            .render(&settings(), &|done| {
                most.fetch_max(done, Ordering::Relaxed);
                ControlFlow::Continue(())
            })
            .unwrap();
        assert!(bytes(&film) == expected);
    }
    assert_eq!(most.into_inner(), settings().total_samples());
    several.failures().join("\n")
}

#[test]
fn any_number_of_devices_makes_the_same_picture() {
    for count in 1..5 {
        let told = assert_right(&several((0..count).map(|_| Fake::sound()).collect(), None));
        assert_eq!(told, "");
    }
}

#[test]
fn a_device_that_fails_is_left_out_and_its_rows_are_done_again() {
    for call in 0..4 {
        let told = assert_right(&several(vec![Fake::failing_from(call, false), Fake::sound()], None));
        // It may never have come to its failure.
        assert!(told.is_empty() || call > 0 || told.contains("device 0 is left out"), "{told}");
    }
}

#[test]
fn smaller_pieces_of_work_are_tried_first() {
    let told = assert_right(&several(vec![Fake::failing_from(1, true)], None));
    assert!(told.contains("smaller pieces") && !told.contains("left out"), "{told}");
}

#[test]
fn a_spare_goes_on_when_none_is_left() {
    let spare: Box<Spare> =
        Box::new(|| Ok(("the spare".to_owned(), Box::new(Fake::sound()) as Box<dyn LoadedScene>)));
    let told = assert_right(&several(vec![Fake::failing_from(1, false)], Some(spare)));
    assert!(told.contains("device 0 is left out") && told.contains("the spare goes on"), "{told}");
}

#[test]
fn whoever_stands_in_looks_through_the_same_camera() {
    let looks = Arc::new(AtomicU32::new(0));
    let looking = || Fake { looks: Arc::clone(&looks), ..Fake::sound() };
    let spare = Fake { looks: Arc::clone(&looks), ..Fake::sound() };
    let spare = Mutex::new(Some(spare));
    let spare: Box<Spare> = Box::new(move || {
        let fake = lock(&spare).take().ok_or(DeviceError::Cancelled)?;
        Ok(("the spare".to_owned(), Box::new(fake) as Box<dyn LoadedScene>))
    });
    let failing = Fake { fails_from: Some(0), ..looking() };
    let mut several = several(vec![failing, looking()], Some(spare));
    let scene = crate::compile(&scene::Scene::default()).unwrap();
    several.set_view(&scene.view(&scene::Camera::default()).unwrap()).unwrap();
    assert_eq!(looks.load(Ordering::Relaxed), 2);
    several.members[1].has_failed.store(true, Ordering::Relaxed);
    let told = assert_right(&several);
    assert!(told.contains("the spare goes on"), "{told}");
    assert_eq!(looks.load(Ordering::Relaxed), 3);
}

#[test]
fn without_a_spare_the_failure_is_told() {
    let lonely = several(vec![Fake::failing_from(0, false), Fake::failing_from(0, false)], None);
    let error = lonely.render(&settings(), &|_| ControlFlow::Continue(())).unwrap_err();
    assert!(matches!(error, DeviceError::Gpu { .. }), "{error}");
    let error = several(vec![Fake::sound(), Fake::sound()], None)
        .render(&settings(), &|_| ControlFlow::Break(()))
        .unwrap_err();
    assert!(matches!(error, DeviceError::Cancelled), "{error}");
}

/// A node of 16 blocks; what one device gives.
fn node() -> (Batch, Vec<FilmPixel>) {
    let samples = 16 * BLOCK_SAMPLES;
    let batch = Batch { first_sample: 3 * samples, samples, ..Batch::whole(&settings()) };
    let mut pixels = vec![FilmPixel::zeroed(); 700];
    Fake::sound().sum_node(&settings(), &batch, &mut pixels, &go_on).unwrap();
    (batch, pixels)
}

fn go_on(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Sums a node as if the devices were known to be so fast, and compares it with that of one sound device.
fn assert_sums_node(several: &Several, speeds: &[f64]) {
    let (batch, expected) = node();
    for (member, speed) in several.members.iter().zip(speeds) {
        member.set_speed(*speed);
    }
    // What it was before is of no interest.
    let mut pixels = vec![FilmPixel { samples: 9, ..FilmPixel::zeroed() }; expected.len()];
    let most = AtomicU64::new(0);
    several
        .sum_node(&settings(), &batch, &mut pixels, &|done| {
            most.fetch_max(done, Ordering::Relaxed);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!(bytemuck::cast_slice::<_, u8>(&pixels) == bytemuck::cast_slice::<_, u8>(&expected), "{speeds:?}");
    assert_eq!(most.into_inner(), 700 * u64::from(batch.samples), "{speeds:?}");
}

/// Fast ones, slow ones, and those between.
const SPEEDS: [&[f64]; 8] = [
    &[5.0],
    &[5.0, 5.0],
    &[5.0, 2.0],
    &[1.0, 30.0],
    &[5.0, 5.0, 0.5],
    &[1.0, 2.0, 0.1, 0.2],
    &[5.0, 4.0, 3.0, 2.0, 1.0],
    &[1.0, 20.0, 1.0, 20.0, 1.0],
];

#[test]
fn a_node_is_the_same_however_many_devices_share_it() {
    for speeds in SPEEDS {
        let several = several(speeds.iter().map(|_| Fake::sound()).collect(), None);
        for _ in 0..5 {
            assert_sums_node(&several, speeds);
        }
        assert_eq!(several.failures().len(), 0);
    }
}

#[test]
fn sub_nodes_and_rows_of_devices_that_fail_are_done_again() {
    for speeds in SPEEDS {
        for call in [0, 1, 3, 9, 20] {
            for recovers in [false, true] {
                // All but the last, which is sometimes the slow one.
                let fakes = (1..speeds.len()).map(|_| Fake::failing_from(call, recovers));
                let several = several(fakes.chain([Fake::sound()]).collect(), None);
                for _ in 0..3 {
                    assert_sums_node(&several, speeds);
                }
                let told = several.failures().join("\n");
                assert!(!recovers || !told.contains("left out"), "{told}");
            }
        }
    }
}

#[test]
fn a_spare_ends_a_node_that_others_began() {
    for call in [0, 1, 3] {
        let spare: Box<Spare> =
            Box::new(|| Ok(("the spare".to_owned(), Box::new(Fake::sound()) as Box<dyn LoadedScene>)));
        let fakes = vec![Fake::failing_from(call, false), Fake::failing_from(call + 1, false)];
        let several = several(fakes, Some(spare));
        assert_sums_node(&several, &[5.0, 5.0]);
        let told = several.failures().join("\n");
        assert!(told.contains("device 0 is left out") && told.contains("device 1 is left out"), "{told}");
        assert!(told.contains("the spare goes on"), "{told}");
    }
}

#[test]
fn fast_devices_share_samples_and_slow_ones_get_rows() {
    let sums: [Arc<Mutex<Vec<_>>>; 3] = Default::default();
    let fakes = sums.iter().map(|sums| Fake { sums: Arc::clone(sums), ..Fake::default() });
    assert_sums_node(&several(fakes.collect(), None), &[10.0, 8.0, 2.0]);
    let [first, second, slow] = sums.map(|sums| lock(&sums).clone());
    let whole = 16 * BLOCK_SAMPLES;
    let mut sub_nodes = 0;
    for (batch, _) in first.iter().chain(&second) {
        // 8 sub-nodes of two blocks; or what the slow one was late with.
        match batch.samples == whole {
            true => assert!(batch.first_row >= 90, "{batch:?}"),
            false => {
                assert_eq!((batch.first_row, batch.rows, batch.samples), (0, 90, whole / 8));
                sub_nodes += 1;
            }
        }
    }
    assert_eq!(sub_nodes, 8);
    for (batch, _) in slow {
        assert_eq!((batch.first_row, batch.rows, batch.samples), (90, 10, whole));
    }
}

#[test]
fn films_are_few_even_if_a_device_stays_behind() {
    // One of them waits in the midst of its first sub-node until the other has begun all others.
    let sums = Arc::new(Mutex::new(Vec::new()));
    let waiting = Fake { sums: Arc::clone(&sums), waits_for: 8, ..Fake::default() };
    let other = Fake { sums: Arc::clone(&sums), ..Fake::default() };
    assert_sums_node(&several(vec![waiting, other], None), &[5.0, 5.0]);
    let mut films: Vec<usize> = lock(&sums).iter().map(|(_, place)| *place).collect();
    assert_eq!(films.len(), 8);
    films.sort_unstable();
    films.dedup();
    assert!(films.len() as u64 <= tree::Tree::most_films(2, 8), "{}", films.len());
}

#[test]
fn a_node_is_cancelled_on_all_devices() {
    let (batch, mut pixels) = node();
    for speeds in SPEEDS {
        let several = several(speeds.iter().map(|_| Fake::sound()).collect(), None);
        for (member, speed) in several.members.iter().zip(speeds) {
            member.set_speed(*speed);
        }
        let stop = |done| if done > 10_000 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let error = several.sum_node(&settings(), &batch, &mut pixels, &stop).unwrap_err();
        assert!(matches!(error, DeviceError::Cancelled), "{error}");
        assert_eq!(several.failures().len(), 0);
    }
}

#[test]
fn long_renders_of_all_sizes_of_nodes_are_those_of_one_device() {
    // Nodes of 16, 2 and 1 blocks, and a beginning of one.
    let settings = RenderSettings { samples: 19 * BLOCK_SAMPLES + 5, ..settings() };
    let expected = Fake::sound().render(&settings, &go_on).unwrap();
    for speeds in SPEEDS {
        let several = several(speeds.iter().map(|_| Fake::sound()).collect(), None);
        for _ in 0..3 {
            assert!(bytes(&several.render(&settings, &go_on).unwrap()) == bytes(&expected));
        }
    }
}

#[test]
fn several_devices_of_which_none_is_left_are_replaced_by_the_spare() {
    let spare: Box<Spare> =
        Box::new(|| Ok(("the spare".to_owned(), Box::new(Fake::sound()) as Box<dyn LoadedScene>)));
    let cards = several(vec![Fake::failing_from(2, false), Fake::failing_from(1, false)], None);
    let all = Several::new(vec![("all cards".to_owned(), Box::new(cards))], Some(spare));
    let told = assert_right(&all);
    assert!(told.contains("device 0 is left out") && told.contains("all cards is left out"), "{told}");
    assert!(told.contains("the spare goes on"), "{told}");
}
