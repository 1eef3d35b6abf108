//! `--checkpoint` and `--resume`: the film of an unfinished picture, saved now and then.

use crate::arguments::RenderArguments;
use crate::failure::Failure;
use crate::progress::Messages;
use crate::statistics::duration_text;
use render::{FilmFile, FilmSums, Provenance, RenderSettings, write_film};
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Time between two savings unless another is given: little is lost, and saving costs next to nothing.
const EVERY: Duration = Duration::from_secs(300);

/// Where the film is saved, and when it was.
pub struct Checkpoints {
    path: Option<PathBuf>,
    every: Duration,
    last: Instant,
    /// Samples per pixel of the film that is there.
    saved: Option<u32>,
    provenance: Provenance,
    size: (u32, u32),
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
        let window = settings.window();
        Checkpoints {
            path: path(arguments).map(Path::to_owned),
            every: arguments.checkpoint_every.unwrap_or(EVERY),
            last: Instant::now(),
            saved: None,
            provenance,
            size: (window.width, window.height),
            messages,
        }
    }

    /// Saves if it is time to. A full disk is no reason to give up a rendering: the older film is still there, and it
    /// is tried again.
    pub fn save_now_and_then(&mut self, sums: &FilmSums) {
        if self.last.elapsed() < self.every {
            return;
        }
        if let Err(failure) = self.save(sums) {
            let explanation = failure.explanation();
            let reason = explanation.trim_start_matches("error: ").trim_end();
            self.messages.line(&format!("warning: {reason}\n  rendering goes on, and this is tried again"));
        }
    }

    /// Saves what there is.
    pub fn save(&mut self, sums: &FilmSums) -> Result<(), Failure> {
        let Some(path) = &self.path else { return Ok(()) };
        if self.saved == Some(sums.samples()) {
            return Ok(());
        }
        let start = Instant::now();
        let provenance = Provenance { samples: sums.samples(), ..self.provenance.clone() };
        let written = write_film(path, &provenance, self.size, sums);
        tracing::info!(
            samples = sums.samples(),
            "saved {} in {}",
            path.display(),
            duration_text(start.elapsed().as_secs_f64())
        );
        self.last = Instant::now();
        written.map_err(|source| Failure::NotWritable { path: path.clone(), source })?;
        self.saved = Some(sums.samples());
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
    let Some(path) = &arguments.resume else { return Ok(FilmSums::new(pixels, wanted.start)) };
    let film = match FilmFile::read(path) {
        Err(render::FilmFileError::Io(error))
            if error.kind() == io::ErrorKind::NotFound && arguments.checkpoint.as_ref() == Some(path) =>
        {
            messages.line(&format!("there is no {} yet: starting from the beginning", path.display()));
            return Ok(FilmSums::new(pixels, wanted.start));
        }
        result => result.map_err(|source| Failure::Film { path: path.clone(), source })?,
    };
    if let Some(difference) = film.provenance.difference(provenance) {
        return Err(Failure::OtherPicture { path: path.clone(), difference });
    }
    if (film.width, film.height) != (window.width, window.height) {
        return Err(Failure::Film {
            path: path.clone(),
            source: render::FilmFileError::Inconsistent("its size is not that of its settings"),
        });
    }
    let ranges = film.sums.ranges();
    match &ranges[..] {
        [] => return Ok(FilmSums::new(pixels, wanted.start)),
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
    if film.provenance.device != provenance.device {
        messages.line(&format!(
            "warning: {} was begun on {}, this is {}: the picture will be right, but not to the last digit that of \
             one device",
            path.display(),
            film.provenance.device,
            provenance.device
        ));
    }
    messages.line(&format!("continuing {} after {} samples per pixel", path.display(), film.sums.samples()));
    Ok(film.sums)
}
