//! `--checkpoint` and `--resume`: the film of an unfinished picture, saved now and then.

use crate::arguments::RenderArguments;
use crate::failure::Failure;
use crate::progress::Messages;
use crate::statistics::duration_text;
use render::{
    AdaptiveFilm, Film, FilmFileError, FilmSums, Provenance, RenderSettings, SavedFilm, write_adaptive_film,
    write_film,
};
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Time between two savings unless another is given: little is lost, and saving costs next to nothing.
const EVERY: Duration = Duration::from_secs(300);

/// A film that can be saved.
pub trait Saved {
    /// Samples of all pixels that are in it.
    fn taken(&self) -> u64;

    /// Samples per pixel that are in it, on average.
    fn samples(&self) -> u32;

    /// Writes it, whole or not at all.
    fn write(&self, path: &Path, provenance: &Provenance, settings: &RenderSettings) -> io::Result<()>;

    /// The picture so far.
    fn into_film(self: Box<Self>, settings: &RenderSettings) -> Film;
}

impl Saved for FilmSums {
    fn taken(&self) -> u64 {
        self.pixels() as u64 * u64::from(self.samples())
    }

    fn samples(&self) -> u32 {
        FilmSums::samples(self)
    }

    fn write(&self, path: &Path, provenance: &Provenance, settings: &RenderSettings) -> io::Result<()> {
        let window = settings.window();
        write_film(path, provenance, (window.width, window.height), self)
    }

    fn into_film(self: Box<Self>, settings: &RenderSettings) -> Film {
        let window = settings.window();
        Film { width: window.width, height: window.height, pixels: self.into_total() }
    }
}

impl Saved for AdaptiveFilm {
    fn taken(&self) -> u64 {
        AdaptiveFilm::taken(self)
    }

    fn samples(&self) -> u32 {
        AdaptiveFilm::samples(self)
    }

    fn write(&self, path: &Path, provenance: &Provenance, _: &RenderSettings) -> io::Result<()> {
        write_adaptive_film(path, provenance, self)
    }

    fn into_film(self: Box<Self>, _: &RenderSettings) -> Film {
        self.film()
    }
}

/// Where the film is saved, and when it was.
pub struct Checkpoints {
    path: Option<PathBuf>,
    every: Duration,
    last: Instant,
    /// Samples of all pixels in the film that is there.
    saved: Option<u64>,
    provenance: Provenance,
    settings: RenderSettings,
    messages: Messages,
}

impl Checkpoints {
    /// Saves as the arguments say, or never.
    pub fn new(
        arguments: &RenderArguments,
        settings: &RenderSettings,
        provenance: Provenance,
        messages: Messages,
    ) -> Self {
        Checkpoints {
            path: path(arguments).map(Path::to_owned),
            every: arguments.checkpoint_every.unwrap_or(EVERY),
            last: Instant::now(),
            saved: None,
            provenance,
            settings: settings.clone(),
            messages,
        }
    }

    /// Saves if it is time to. A full disk is no reason to give up a rendering: the older film is still there, and it
    /// is tried again.
    pub fn save_now_and_then(&mut self, film: &dyn Saved) {
        if self.last.elapsed() < self.every {
            return;
        }
        if let Err(failure) = self.save(film) {
            let explanation = failure.explanation();
            let reason = explanation.trim_start_matches("error: ").trim_end();
            self.messages.line(&format!("warning: {reason}\n  rendering goes on, and this is tried again"));
        }
    }

    /// Saves what there is.
    pub fn save(&mut self, film: &dyn Saved) -> Result<(), Failure> {
        let Some(path) = &self.path else { return Ok(()) };
        let taken = film.taken();
        if self.saved == Some(taken) {
            return Ok(());
        }
        let start = Instant::now();
        let samples = film.samples();
        let written = film.write(path, &Provenance { samples, ..self.provenance.clone() }, &self.settings);
        tracing::info!(
            samples,
            "saved {} in {}",
            path.display(),
            duration_text(start.elapsed().as_secs_f64())
        );
        self.last = Instant::now();
        written.map_err(|source| Failure::NotWritable { path: path.clone(), source })?;
        self.saved = Some(taken);
        Ok(())
    }
}

/// The film that is written: a continued one goes on where it is, if no other place is given.
pub fn path(arguments: &RenderArguments) -> Option<&Path> {
    arguments.checkpoint.as_deref().or(arguments.resume.as_deref())
}

/// Refuses to write over a film that would be lost, or over something else.
pub fn check_path(arguments: &RenderArguments) -> Result<(), Failure> {
    let Some(path) = path(arguments) else { return Ok(()) };
    let is_continued = arguments.resume.as_deref() == Some(path);
    if path.exists() && !is_continued {
        return Err(Failure::Usage(format!(
            "--checkpoint {0} exists already; --resume {0} continues it, if it is a film of this picture. Otherwise give \
             another name or remove the file",
            path.display()
        )));
    }
    // A job that is started again and again always says both; the first time there is nothing to go on with.
    match &arguments.resume {
        Some(film) if !film.exists() && arguments.checkpoint.as_ref() != Some(film) => {
            Err(Failure::NoFilm { path: film.clone() })
        }
        _ => Ok(()),
    }
}

/// The sums to go on with: those of the film that is continued, or none.
pub fn sums(
    arguments: &RenderArguments,
    settings: &RenderSettings,
    wanted: &Range<u32>,
    provenance: &Provenance,
    messages: Messages,
) -> Result<FilmSums, Failure> {
    let window = settings.window();
    let pixels = window.width as usize * window.height as usize;
    let none = || FilmSums::new(pixels, wanted.start);
    let Some((path, film)) = continued(arguments, provenance, messages)? else { return Ok(none()) };
    let film = match film {
        SavedFilm::Uniform(film) if (film.width, film.height) == (window.width, window.height) => film,
        _ => return Err(other_film(path)),
    };
    let ranges = film.sums.ranges();
    match &ranges[..] {
        [] => return Ok(none()),
        [range] if range.start == wanted.start && range.end <= wanted.end => {}
        _ => {
            let found: Vec<_> =
                ranges.iter().map(|range| format!("{}..{}", range.start, range.end)).collect();
            return Err(Failure::Usage(format!(
                "--resume {} holds the samples {}, which is no beginning of {}..{}; --sample-range says what to \
                 render, `sunshine merge` joins films",
                path.display(),
                found.join(", "),
                wanted.start,
                wanted.end
            )));
        }
    }
    tell_continued(path, &film.provenance, provenance, film.sums.samples(), messages);
    Ok(film.sums)
}

/// The adaptive film to go on with: that which is continued, or an empty one.
pub fn adaptive_film(
    arguments: &RenderArguments,
    settings: &RenderSettings,
    provenance: &Provenance,
    messages: Messages,
) -> Result<AdaptiveFilm, Failure> {
    match continued(arguments, provenance, messages)? {
        None => Ok(AdaptiveFilm::new(settings)),
        Some((path, SavedFilm::Adaptive(file))) if file.film.is_of(settings) => {
            tell_continued(path, &file.provenance, provenance, file.film.samples(), messages);
            Ok(file.film)
        }
        Some((path, _)) => Err(other_film(path)),
    }
}

/// The film that is continued, if it is one of this picture; none if none is, or if it is still to be begun.
fn continued<'a>(
    arguments: &'a RenderArguments,
    provenance: &Provenance,
    messages: Messages,
) -> Result<Option<(&'a Path, SavedFilm)>, Failure> {
    let Some(path) = arguments.resume.as_deref() else { return Ok(None) };
    let film = match SavedFilm::read(path) {
        Err(FilmFileError::Io(error))
            if error.kind() == io::ErrorKind::NotFound && arguments.checkpoint.as_deref() == Some(path) =>
        {
            messages.line(&format!("there is no {} yet: starting from the beginning", path.display()));
            return Ok(None);
        }
        result => result.map_err(|source| Failure::Film { path: path.to_owned(), source })?,
    };
    match film.provenance().difference(provenance) {
        Some(difference) => Err(Failure::OtherPicture { path: path.to_owned(), difference }),
        None => Ok(Some((path, film))),
    }
}

/// What no film of Sunshine is, unless somebody changed it.
fn other_film(path: &Path) -> Failure {
    let source = FilmFileError::Inconsistent("its size or its samples are not those of its settings");
    Failure::Film { path: path.to_owned(), source }
}

fn tell_continued(path: &Path, film: &Provenance, ours: &Provenance, samples: u32, messages: Messages) {
    if film.device != ours.device {
        messages.line(&format!(
            "warning: {} was begun on {}, this is {}: the picture will be right, but not to the last digit that of \
             one device",
            path.display(),
            film.device,
            ours.device
        ));
    }
    messages.line(&format!("continuing {} after {samples} samples per pixel", path.display()));
}
