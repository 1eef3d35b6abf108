//! The part of `sunshine render` that takes long: samples, pass after pass, saved and stopped when asked to.

use crate::arguments::RenderArguments;
use crate::checkpoints::{self, Checkpoints, Saved};
use crate::failure::Failure;
use crate::interruption::Interruption;
use crate::option_values::SampleRange;
use crate::progress::{Messages, RenderProgress};
use render::{
    AdaptiveFilm, BAND_BYTES, BLOCK_SAMPLES, ControlFlow, Ending, Film, FilmSums, Goal, LoadedScene,
    Provenance, RenderSettings, Sampling, StopRule, continue_adaptive, film_bytes, render_passes,
};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// What is to be rendered, and how.
pub struct Plan {
    /// With the number of samples that their sequences are planned for.
    pub settings: RenderSettings,
    /// What is rendered into memory as a whole; else it is band by band.
    pub kept: Option<Kept>,
    /// Numbers of the samples.
    pub wanted: SampleRange,
}

/// A picture that is in memory while it is rendered, and can be stopped and saved.
#[derive(Clone, Copy)]
pub enum Kept {
    /// The same samples everywhere, so far.
    Even(Goal),
    /// More where it is noisy.
    Adaptive,
}

impl Plan {
    /// What the arguments ask for. Pictures that fit into a band are kept, so that something can be shown of them
    /// when they are stopped.
    pub fn new(arguments: &RenderArguments) -> Result<Self, Failure> {
        let settings = arguments.settings();
        let is_saved = checkpoints::path(arguments).is_some();
        let wanted = arguments.sample_range.clone().unwrap_or(0..settings.samples);
        check_range(arguments, &settings)?;
        let plan = match arguments.sampling() {
            Sampling::Until(rule) => Plan {
                settings: rule.planned(&settings),
                kept: Some(Kept::Even(Goal::Rule(rule))),
                wanted: 0..rule.most_samples,
            },
            Sampling::Uniform if is_saved || film_bytes(&settings) <= BAND_BYTES => {
                Plan { kept: Some(Kept::Even(Goal::Samples(wanted.end))), settings, wanted }
            }
            Sampling::Uniform => Plan { kept: None, settings, wanted },
            Sampling::Adaptive => Plan { kept: Some(Kept::Adaptive), settings, wanted },
        };
        // Before anything else is done.
        match plan.kept {
            Some(Kept::Even(goal)) => render::check_kept(&plan.settings, goal)?,
            Some(Kept::Adaptive) => render::check_adaptive(&plan.settings)?,
            None => {}
        }
        Ok(plan)
    }

    /// Samples of all pixels, and whether progress is measured by the time.
    fn total(&self) -> (u64, bool) {
        match self.kept {
            Some(Kept::Even(Goal::Rule(StopRule { time: Some(time), .. }))) => {
                (time.as_millis().try_into().unwrap_or(u64::MAX), true)
            }
            _ => {
                let samples = self.wanted.end - self.wanted.start;
                (RenderSettings { samples, ..self.settings.clone() }.total_samples(), false)
            }
        }
    }
}

fn check_range(arguments: &RenderArguments, settings: &RenderSettings) -> Result<(), Failure> {
    let Some(range) = &arguments.sample_range else { return Ok(()) };
    if checkpoints::path(arguments).is_none() {
        return Err(Failure::Usage(
            "--sample-range renders a part of the samples, which is kept in a film; name it with --checkpoint FILE"
                .to_owned(),
        ));
    }
    if range.end > settings.samples {
        return Err(Failure::Usage(format!(
            "--sample-range {}..{} goes beyond the {} samples of the picture; --samples gives the number of all \
             shares together",
            range.start, range.end, settings.samples
        )));
    }
    let is_bound = |sample: u32| sample.is_multiple_of(BLOCK_SAMPLES) || sample == settings.samples;
    if !is_bound(range.start) || !is_bound(range.end) {
        return Err(Failure::Usage(format!(
            "--sample-range {}..{} must begin and end at multiples of {BLOCK_SAMPLES}, or end with the last sample, \
             {}: so much is added up at a time",
            range.start, range.end, settings.samples
        )));
    }
    Ok(())
}

/// Progress as a share of the samples or of the time, whichever is known beforehand.
pub struct Follower {
    progress: RenderProgress,
    total: u64,
    start: Instant,
    by_time: bool,
    interruption: Interruption,
    /// Whether it was said that the rendering will stop.
    told: AtomicBool,
    messages: Messages,
    /// Whether samples are given up when somebody asks to stop.
    gives_up: bool,
}

impl Follower {
    /// Begins to follow.
    pub fn new(plan: &Plan, interruption: Interruption, messages: Messages) -> Self {
        let (total, by_time) = plan.total();
        Follower {
            progress: messages.follow(total),
            total,
            start: Instant::now(),
            by_time,
            interruption,
            told: AtomicBool::new(false),
            messages,
            gives_up: plan.kept.is_none(),
        }
    }

    /// Takes note of the samples that are done.
    pub fn update(&self, samples: u64) -> ControlFlow<()> {
        let milliseconds = || self.start.elapsed().as_millis().try_into().unwrap_or(u64::MAX);
        if self.interruption.is_asked() {
            if self.gives_up {
                return ControlFlow::Break(());
            }
            if !self.told.swap(true, Ordering::Relaxed) {
                self.messages.line("stopping after this pass; once more to stop at once");
            }
        }
        self.progress.update(if self.by_time { milliseconds() } else { samples })
    }

    /// Takes the bar away. A time or a noise may be reached a little before what was expected.
    pub fn finish(&self, ending: Ending) {
        if ending == Ending::Complete {
            let _ = self.progress.update(self.total);
        }
        self.progress.finish();
    }
}

/// A film in memory.
pub struct Rendered {
    /// All that was collected.
    pub film: Film,
    /// Samples per pixel.
    pub samples: u32,
    /// Whether it is complete.
    pub ending: Ending,
    /// Seconds that rendering took.
    pub seconds: f64,
    /// Samples of all pixels that were there already.
    pub continued: u64,
}

/// Renders the whole picture in memory, and saves it as the arguments say.
pub fn render_film(
    arguments: &RenderArguments,
    plan: &Plan,
    kept: Kept,
    scene: &dyn LoadedScene,
    provenance: &Provenance,
    follower: &Follower,
) -> Result<Rendered, Failure> {
    let settings = &plan.settings;
    let messages = follower.messages;
    let mut checkpoints = Checkpoints::new(arguments, settings, provenance.clone(), messages);
    let (continued, start);
    let mut after = |film: &dyn Saved| {
        tracing::debug!(samples = film.samples(), "a pass is done");
        scene.failures().iter().for_each(|failure| messages.line(&format!("warning: {failure}")));
        checkpoints.save_now_and_then(film);
        match follower.interruption.is_asked() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    };
    let update = |done| follower.update(done);
    let (rendered, film): (_, Box<dyn Saved>) = match kept {
        Kept::Even(goal) => {
            let mut sums = checkpoints::sums(arguments, settings, &plan.wanted, provenance, messages)?;
            (continued, start) = (sums.taken(), Instant::now());
            let after = &mut |sums: &FilmSums| after(sums);
            (render_passes(scene, settings, goal, &mut sums, &update, after), Box::new(sums))
        }
        Kept::Adaptive => {
            let mut film = checkpoints::adaptive_film(arguments, settings, provenance, messages)?;
            (continued, start) = (film.taken(), Instant::now());
            let after = &mut |film: &AdaptiveFilm| after(film);
            (continue_adaptive(scene, settings, &mut film, &update, after), Box::new(film))
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    scene.failures().iter().for_each(|failure| messages.line(&format!("warning: {failure}")));
    // Also what was finished before a device failed.
    let saved = checkpoints.save(&*film);
    let ending = rendered?;
    saved?;
    let samples = match (kept, ending) {
        // As it is asked for, and not as it is rounded.
        (Kept::Adaptive, Ending::Complete) => settings.samples,
        _ => film.samples(),
    };
    Ok(Rendered { film: film.into_film(settings), samples, ending, seconds, continued })
}
