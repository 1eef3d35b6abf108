//! Several devices as one: rows are shared out as they are finished, and a device that fails is left out.
//!
//! A pixel is computed by one device from beginning to end of a batch, so on devices of the same kind the picture is
//! that of one of them, bit for bit. On different kinds it depends on their speed which of them computes a pixel; the
//! picture is right, but its last digits may differ from run to run.

use crate::{Batch, ControlFlow, DeviceError, LoadedScene, Progress, RenderSettings, Renderer, View};
use bytemuck::Pod;
use kernels::records::kernel::{FilmPixel, LayerPixel};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Makes a device that stands in when all others have failed, with its name.
pub(crate) type Spare = dyn Fn() -> Result<(String, Box<dyn LoadedScene>), DeviceError> + Send + Sync;

/// A scene on several devices.
pub(crate) struct Several {
    members: Vec<Member>,
    /// Stands in when none is left; taken once.
    spare: Mutex<Option<Box<Spare>>>,
    stand_in: std::sync::OnceLock<Member>,
    /// Another camera than that of the scene, for whoever stands in.
    view: Option<View>,
    /// What went wrong, to be told.
    failures: Mutex<Vec<String>>,
}

/// A device with the scene.
struct Member {
    name: String,
    scene: Box<dyn LoadedScene>,
    has_failed: AtomicBool,
    /// Edge of its tiles after a failure that smaller ones might avoid; 0 for those of the settings.
    tile: AtomicU32,
    /// Samples that it takes in a second, as bits; 0 if unknown.
    speed: AtomicU64,
}

impl Member {
    fn new((name, scene): (String, Box<dyn LoadedScene>)) -> Self {
        Member {
            name,
            scene,
            has_failed: AtomicBool::new(false),
            tile: AtomicU32::new(0),
            speed: AtomicU64::new(0),
        }
    }

    fn is_alive(&self) -> bool {
        !self.has_failed.load(Ordering::Relaxed)
    }

    fn speed(&self) -> f64 {
        f64::from_bits(self.speed.load(Ordering::Relaxed))
    }
}

/// Edge of the tiles that a device gets after it failed: a fraction of the memory, and short launches.
const SMALL_TILE: u32 = 128;
/// Fewest rows that a device gets at a time.
const FEWEST_ROWS: u32 = 16;

/// Rows that are still to be rendered.
struct Queue {
    /// From where nothing was given out yet.
    next: u32,
    rows: u32,
    /// What a device gave back.
    returned: Vec<Range<u32>>,
}

impl Queue {
    /// Rows for a device that does this share of the work of all. Half of what it would do of the rest, so that the
    /// devices end at nearly the same time.
    fn take(&mut self, share: f64) -> Option<Range<u32>> {
        if let Some(rows) = self.returned.pop() {
            return Some(rows);
        }
        let left = self.rows - self.next;
        if left == 0 {
            return None;
        }
        // The conversion saturates. A device that is alone gets all.
        let wanted = if share >= 1.0 { left } else { (f64::from(left) * share * 0.5) as u32 };
        let count = wanted.max(FEWEST_ROWS).min(left);
        self.next += count;
        Some(self.next - count..self.next)
    }
}

/// Adds a batch on one device.
type Work<'a, P> = dyn Fn(
        &(dyn LoadedScene + 'static),
        &RenderSettings,
        &Batch,
        &mut [P],
        &Progress<'_>,
    ) -> Result<(), DeviceError>
    + Sync
    + 'a;

impl Several {
    /// At least one device, with names.
    pub fn new(devices: Vec<(String, Box<dyn LoadedScene>)>, spare: Option<Box<Spare>>) -> Self {
        Several {
            members: devices.into_iter().map(Member::new).collect(),
            spare: Mutex::new(spare),
            stand_in: std::sync::OnceLock::new(),
            view: None,
            failures: Mutex::default(),
        }
    }

    fn alive(&self) -> Vec<&Member> {
        self.members.iter().chain(self.stand_in.get()).filter(|member| member.is_alive()).collect()
    }

    /// Renders rows on all devices; those that fail are left out. `overwrites` if the work does not look at what the
    /// pixels are beforehand.
    fn share_out<P: Pod + Send>(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [P],
        progress: &Progress<'_>,
        overwrites: bool,
        work: &Work<'_, P>,
    ) -> Result<(), DeviceError> {
        assert_eq!(pixels.len(), batch.pixels(settings), "pixels of a batch");
        let width = settings.window().width as usize;
        let run = &Run {
            settings,
            batch,
            width,
            progress,
            overwrites,
            work,
            queue: Mutex::new(Queue { next: 0, rows: batch.rows, returned: Vec::new() }),
            pixels: Mutex::new(pixels),
            done: AtomicU64::new(0),
            failures: &self.failures,
        };
        let mut last = None;
        loop {
            let members = self.alive();
            let results: Vec<Result<(), DeviceError>> = match &members[..] {
                [] => match self.call_spare()? {
                    true => continue,
                    false => return Err(last.unwrap_or(DeviceError::Cancelled)),
                },
                [only] => vec![run.serve(only, 1.0)],
                several => std::thread::scope(|scope| {
                    let threads: Vec<_> = several
                        .iter()
                        .map(|member| {
                            let share = share_of(member, several);
                            scope.spawn(move || run.serve(member, share))
                        })
                        .collect();
                    let joined = threads.into_iter().map(|thread| match thread.join() {
                        Ok(result) => result,
                        Err(panic) => std::panic::resume_unwind(panic),
                    });
                    joined.collect()
                }),
            };
            for result in results {
                match result {
                    Ok(()) => {}
                    Err(DeviceError::Cancelled) => return Err(DeviceError::Cancelled),
                    Err(error) => last = Some(error),
                }
            }
            let queue = lock(&run.queue);
            if queue.next == queue.rows && queue.returned.is_empty() {
                return Ok(());
            }
        }
    }

    /// Brings the device that stands in; false if there is none any more.
    fn call_spare(&self) -> Result<bool, DeviceError> {
        let Some(spare) = lock(&self.spare).take() else { return Ok(false) };
        let (name, mut scene) = spare()?;
        if let Some(view) = &self.view {
            scene.set_view(view)?;
        }
        lock(&self.failures).push(format!("{name} goes on"));
        Ok(self.stand_in.set(Member::new((name, scene))).is_ok())
    }
}

/// What a device does of the work of all, as far as speeds are known.
fn share_of(member: &Member, all: &[&Member]) -> f64 {
    let known: Vec<f64> = all.iter().map(|member| member.speed()).filter(|speed| *speed > 0.0).collect();
    let even = 1.0 / all.len() as f64;
    if known.len() < all.len() {
        // The first rows show how fast it is, so they are few.
        return even * 0.25;
    }
    // Below 1, which stands for a device that is alone.
    (member.speed() / known.iter().sum::<f64>()).clamp(0.0, 0.99)
}

/// A batch that is shared out.
struct Run<'a, P> {
    settings: &'a RenderSettings,
    batch: &'a Batch,
    width: usize,
    progress: &'a Progress<'a>,
    overwrites: bool,
    work: &'a Work<'a, P>,
    queue: Mutex<Queue>,
    pixels: Mutex<&'a mut [P]>,
    /// Samples of all devices.
    done: AtomicU64,
    failures: &'a Mutex<Vec<String>>,
}

impl<P: Pod + Send> Run<'_, P> {
    /// Renders rows on a device until none are left or it fails.
    fn serve(&self, member: &Member, share: f64) -> Result<(), DeviceError> {
        loop {
            let Some(rows) = lock(&self.queue).take(share) else { return Ok(()) };
            let result = self.render(member, &rows);
            let Err(error) = result else { continue };
            lock(&self.queue).returned.push(rows);
            if matches!(error, DeviceError::Cancelled) {
                return Err(error);
            }
            let has_tried = member.tile.swap(SMALL_TILE, Ordering::Relaxed) != 0;
            if !has_tried && self.settings.tile.is_none_or(|tile| tile > SMALL_TILE) {
                lock(self.failures).push(format!("{error}\n  it is tried again with smaller pieces of work"));
                continue;
            }
            member.has_failed.store(true, Ordering::Relaxed);
            lock(self.failures).push(format!("{} is left out, its part is done again: {error}", member.name));
            return Err(error);
        }
    }

    /// Renders some rows of the batch in a copy, which takes their place only when it is complete; or in their place if
    /// that is all of them and what they were is of no interest.
    fn render(&self, member: &Member, rows: &Range<u32>) -> Result<(), DeviceError> {
        let place = rows.start as usize * self.width..rows.end as usize * self.width;
        let mut all = lock(&self.pixels);
        if self.overwrites && place.len() == all.len() {
            // Nobody else has rows meanwhile.
            return self.render_in(member, rows, &mut all);
        }
        let mut copy = all[place.clone()].to_vec();
        drop(all);
        self.render_in(member, rows, &mut copy)?;
        lock(&self.pixels)[place].copy_from_slice(&copy);
        Ok(())
    }

    fn render_in(&self, member: &Member, rows: &Range<u32>, pixels: &mut [P]) -> Result<(), DeviceError> {
        let count = rows.end - rows.start;
        let batch = Batch { first_row: self.batch.first_row + rows.start, rows: count, ..*self.batch };
        let tile = match member.tile.load(Ordering::Relaxed) {
            0 => self.settings.tile,
            edge => Some(edge),
        };
        let settings = RenderSettings { tile, ..self.settings.clone() };
        let reported = AtomicU64::new(0);
        let report = |samples: u64| -> ControlFlow<()> {
            // Reports of one device may overtake each other.
            let before = reported.fetch_max(samples, Ordering::Relaxed);
            let more = samples.saturating_sub(before);
            (self.progress)(self.done.fetch_add(more, Ordering::Relaxed) + more)
        };
        let start = Instant::now();
        let result = (self.work)(member.scene.as_ref(), &settings, &batch, pixels, &report);
        if let Err(error) = result {
            self.done.fetch_sub(reported.into_inner(), Ordering::Relaxed);
            return Err(error);
        }
        let work = pixels.len() as f64 * f64::from(batch.samples);
        let speed = work / start.elapsed().as_secs_f64().max(1e-6);
        member.speed.store(speed.to_bits(), Ordering::Relaxed);
        tracing::trace!("{}: rows {}..{}, {speed:.0} samples/s", member.name, rows.start, rows.end);
        Ok(())
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl LoadedScene for Several {
    fn set_view(&mut self, view: &View) -> Result<(), DeviceError> {
        self.view = Some(view.clone());
        let mut last = None;
        for member in
            self.members.iter_mut().chain(self.stand_in.get_mut()).filter(|member| member.is_alive())
        {
            if let Err(error) = member.scene.set_view(view) {
                member.has_failed.store(true, Ordering::Relaxed);
                lock(&self.failures).push(format!("{} is left out: {error}", member.name));
                last = Some(error);
            }
        }
        match last {
            Some(error) if self.alive().is_empty() && lock(&self.spare).is_none() => Err(error),
            _ => Ok(()),
        }
    }

    fn prepare(&self, renderer: Renderer) -> Result<(), DeviceError> {
        for member in self.alive() {
            member.scene.prepare(renderer)?;
        }
        Ok(())
    }

    fn add_samples(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        self.share_out(settings, batch, pixels, progress, false, &<dyn LoadedScene>::add_samples)
    }

    fn sum_node(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        self.share_out(settings, batch, pixels, progress, true, &<dyn LoadedScene>::sum_node)
    }

    fn add_layers(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [LayerPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        self.share_out(settings, batch, pixels, progress, false, &<dyn LoadedScene>::add_layers)
    }

    fn device_seconds(&self) -> Option<f64> {
        // Also of those that are left out now.
        let clocks = self.members.iter().chain(self.stand_in.get());
        clocks.filter_map(|member| member.scene.device_seconds()).reduce(|a, b| a + b)
    }

    fn failures(&self) -> Vec<String> {
        std::mem::take(&mut *lock(&self.failures))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Film;

    /// Gives every pixel a value that follows from its place and its samples, or fails when its number of calls is
    /// reached.
    struct Fake {
        calls: AtomicU32,
        fails_from: u32,
        /// Whether small tiles help.
        recovers: bool,
        /// How often the camera was moved.
        looks: std::sync::Arc<AtomicU32>,
    }

    impl Fake {
        fn failing_from(call: u32, recovers: bool) -> Self {
            Fake { calls: AtomicU32::new(0), fails_from: call, recovers, looks: Default::default() }
        }

        fn sound() -> Self {
            Self::failing_from(u32::MAX, false)
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
            let fails = call >= self.fails_from && !(self.recovers && settings.tile == Some(SMALL_TILE));
            let first = batch.first_row * settings.window().width;
            for (pixel, number) in pixels.iter_mut().zip(first..) {
                pixel.radiance.x += (number * batch.samples) as f32;
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
        let looks = std::sync::Arc::new(AtomicU32::new(0));
        let looking = || Fake { looks: std::sync::Arc::clone(&looks), ..Fake::sound() };
        let spare = Fake { looks: std::sync::Arc::clone(&looks), ..Fake::sound() };
        let spare = Mutex::new(Some(spare));
        let spare: Box<Spare> = Box::new(move || {
            let fake = lock(&spare).take().ok_or(DeviceError::Cancelled)?;
            Ok(("the spare".to_owned(), Box::new(fake) as Box<dyn LoadedScene>))
        });
        let failing = Fake { fails_from: 0, ..looking() };
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
}
