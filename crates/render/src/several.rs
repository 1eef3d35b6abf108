//! Several devices as one: work is shared out as it is finished, and a device that fails is left out.
//!
//! What is shared out are rows of the picture; or, where that would leave graphics cards half empty, nodes of the tree of
//! samples that [`FilmSums`](crate::FilmSums) are formed by. Either way a block of a pixel's samples is computed by one
//! device and the blocks are added in the same order, so on devices of the same kind the picture is that of one of them,
//! bit for bit. On different kinds it depends on their speed which of them computes what; the picture is right, but its
//! last digits may differ from run to run.

mod job;
mod member;
mod nodes;
mod rows;
#[cfg(test)]
mod tests;
mod tree;

use crate::{Batch, DeviceError, LoadedScene, Progress, RenderSettings, Renderer, View, film_limit};
use bytemuck::Pod;
use job::{Job, Work};
use kernels::records::kernel::{FilmPixel, LayerPixel};
use member::{Member, Standing};
use nodes::{Nodes, Plan};
use rows::Rows;
use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// Makes a device that stands in when all others have failed, with its name.
pub(crate) type Spare = dyn Fn() -> Result<(String, Box<dyn LoadedScene>), DeviceError> + Send + Sync;

/// A scene on several devices.
pub(crate) struct Several {
    members: Vec<Member>,
    /// Stands in when none is left; taken once.
    spare: Mutex<Option<Box<Spare>>>,
    stand_in: OnceLock<Member>,
    /// Another camera than that of the scene, for whoever stands in.
    view: Option<View>,
    /// What went wrong, to be told.
    failures: Mutex<Vec<String>>,
}

/// Edge of the tiles that a device gets after it failed: a fraction of the memory, and short launches.
const SMALL_TILE: u32 = 128;

/// How a batch is divided into pieces, which devices take one after the other.
trait Division: Sync {
    /// What a device does at a time.
    type Piece;

    /// A piece for a device, if there is one that it should do.
    fn take(&self, standing: &Standing) -> Option<Self::Piece>;

    /// Does a piece on a device. After an error it is to be done again.
    fn render(&self, member: &Member, standing: &Standing, piece: Self::Piece) -> Result<(), DeviceError>;

    /// Whether all is done, once nobody works any more.
    fn is_complete(&self) -> bool;
}

impl Several {
    /// At least one device, with names.
    pub fn new(devices: Vec<(String, Box<dyn LoadedScene>)>, spare: Option<Box<Spare>>) -> Self {
        Several {
            members: devices.into_iter().map(Member::new).collect(),
            spare: Mutex::new(spare),
            stand_in: OnceLock::new(),
            view: None,
            failures: Mutex::default(),
        }
    }

    fn alive(&self) -> Vec<&Member> {
        self.members.iter().chain(self.stand_in.get()).filter(|member| member.is_alive()).collect()
    }

    /// Does a batch on all devices, divided by rows. `overwrites` if the work does not look at what the pixels are
    /// beforehand.
    fn share_rows<P: Pod + Send>(
        &self,
        job: &Job<'_>,
        batch: &Batch,
        pixels: &mut [P],
        overwrites: bool,
        work: &Work<'_, P>,
    ) -> Result<(), DeviceError> {
        assert_eq!(pixels.len(), batch.pixels(job.settings), "pixels of a batch");
        self.share_out(job.settings, &Rows::new(job, batch, overwrites, work, pixels))
    }

    /// Does a batch on all devices; those that fail are left out.
    fn share_out(&self, settings: &RenderSettings, division: &impl Division) -> Result<(), DeviceError> {
        let mut last = None;
        self.alive().iter().for_each(|member| member.begin());
        loop {
            let members = self.alive();
            let speeds: Vec<f64> = members.iter().map(|member| member.speed()).collect();
            let serve = |(number, member): (usize, &Member)| {
                self.serve(settings, division, member, &Standing::of(&speeds, number))
            };
            let results: Vec<Result<(), DeviceError>> = match &members[..] {
                [] => match self.call_spare()? {
                    true => continue,
                    false => return Err(last.unwrap_or_else(|| self.nobody())),
                },
                [only] => vec![serve((0, only))],
                several => std::thread::scope(|scope| {
                    let serve = &serve;
                    let threads: Vec<_> = several
                        .iter()
                        .enumerate()
                        .map(|(number, member)| scope.spawn(move || serve((number, member))))
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
            if division.is_complete() {
                return Ok(());
            }
        }
    }

    /// Does pieces of a batch on a device until none are left for it or it fails.
    fn serve(
        &self,
        settings: &RenderSettings,
        division: &impl Division,
        member: &Member,
        standing: &Standing,
    ) -> Result<(), DeviceError> {
        while let Some(piece) = division.take(standing) {
            let Err(error) = division.render(member, standing, piece) else { continue };
            if matches!(error, DeviceError::Cancelled) {
                return Err(error);
            }
            let has_tried = member.tile.swap(SMALL_TILE, Ordering::Relaxed) != 0;
            if !has_tried && settings.tile.is_none_or(|tile| tile > SMALL_TILE) {
                lock(&self.failures)
                    .push(format!("{error}\n  it is tried again with smaller pieces of work"));
                continue;
            }
            member.has_failed.store(true, Ordering::Relaxed);
            lock(&self.failures)
                .push(format!("{} is left out, its part is done again: {error}", member.name));
            return Err(error);
        }
        Ok(())
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

    /// All have failed in earlier batches. Not that somebody asked to stop: who stands in for all of these shall go on.
    fn nobody(&self) -> DeviceError {
        let names: Vec<&str> = self.members.iter().map(|member| &member.name[..]).collect();
        let reason = "it failed before".to_owned();
        DeviceError::Gpu { device: names.join(" and "), doing: "rendering", reason }
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
        let job = Job::new(settings, progress);
        self.share_rows(&job, batch, pixels, false, &<dyn LoadedScene>::add_samples)
    }

    fn sum_node(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [FilmPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        assert_eq!(pixels.len(), batch.pixels(settings), "pixels of a batch");
        let job = Job::new(settings, progress);
        let speeds: Vec<f64> = self.alive().iter().map(|member| member.speed()).collect();
        match Plan::new(&speeds, batch, job.width(), &film_limit) {
            Some(plan) => self.share_out(settings, &Nodes::new(&job, batch, &plan, pixels)),
            None => self.share_rows(&job, batch, pixels, true, &<dyn LoadedScene>::sum_node),
        }
    }

    fn add_layers(
        &self,
        settings: &RenderSettings,
        batch: &Batch,
        pixels: &mut [LayerPixel],
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        let job = Job::new(settings, progress);
        self.share_rows(&job, batch, pixels, false, &<dyn LoadedScene>::add_layers)
    }

    fn device_seconds(&self) -> Option<f64> {
        // Also of those that are left out now.
        let clocks = self.members.iter().chain(self.stand_in.get());
        clocks.filter_map(|member| member.scene.device_seconds()).reduce(|a, b| a + b)
    }

    fn failures(&self) -> Vec<String> {
        // Also those of members that are several devices themselves.
        let members = self.members.iter().chain(self.stand_in.get());
        let mut failures: Vec<String> = members.flat_map(|member| member.scene.failures()).collect();
        failures.append(&mut lock(&self.failures));
        failures
    }
}
