//! Everything that can go wrong, with the exit code it has.

use groimp::ReadError;
use render::{
    CompileError, DeviceError, Difference, FilmFileError, Overlap, PictureError, RecordError, RenderError,
};
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use thesis::{ExperimentError, PlotError};

/// Why a command did not do what it should.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The command line contradicts itself in a way that only looking at all of it shows.
    #[error("{0}")]
    Usage(String),
    /// The scene file is missing or broken.
    #[error("the scene {} cannot be read", path.display())]
    Read {
        /// The scene file.
        path: PathBuf,
        /// What the reader says; boxed because it is large.
        source: Box<ReadError>,
    },
    /// The scene was read but cannot be rendered.
    #[error("the scene cannot be rendered")]
    Compile(#[from] CompileError),
    /// The denoiser is missing or does not start.
    #[cfg(feature = "denoise")]
    #[error("--denoise is not possible")]
    Denoiser(#[from] denoise::DenoiseError),
    /// The device is missing or gave up.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// An experiment could not be carried out.
    #[error("an experiment failed")]
    Experiment(#[from] ExperimentError),
    /// A plot could not be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A file would not be writable; found before rendering.
    #[error("{} cannot be written", path.display())]
    NotWritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// There is no window.
    #[cfg(feature = "view")]
    #[error(transparent)]
    View(#[from] view::ViewError),
    /// The picture could not be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The picture could not be rendered into its file.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// Statistics could not be written.
    #[error("the statistics cannot be written to {}", path.display())]
    Statistics {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file with measurements is missing.
    #[error("{} cannot be read", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file does not hold measurements.
    #[error("{} is not a file that `sunshine bench run` wrote", path.display())]
    Measurements {
        /// The file.
        path: PathBuf,
        /// What was found in it, and where.
        source: serde_json::Error,
    },
    /// There is nothing to continue.
    #[error(
        "there is no film {0}; --resume continues what --checkpoint saved. Give --checkpoint {0} as well to start from \
         the beginning when it is missing",
        path.display()
    )]
    NoFilm {
        /// The file.
        path: PathBuf,
    },
    /// A film cannot be used.
    #[error("the film {} cannot be used", path.display())]
    Film {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: FilmFileError,
    },
    /// A film is one of another picture.
    #[error("the film {} is not of this picture", path.display())]
    OtherPicture {
        /// The file.
        path: PathBuf,
        /// In what it differs.
        #[source]
        difference: Difference,
    },
    /// A film has samples that are there already.
    #[error("the film {} cannot be joined with those before it", path.display())]
    Overlap {
        /// The file.
        path: PathBuf,
        /// What is there twice.
        #[source]
        overlap: Overlap,
    },
    /// A picture is not complete.
    #[error(
        "the picture is not complete: samples {missing} are missing. Merge the films of all shares; a film that was \
         stopped early is finished with --resume. --unfinished makes a picture of what is there"
    )]
    Missing {
        /// What is missing.
        missing: String,
    },
    /// A file does not tell how it was made.
    #[error("{} tells nothing", path.display())]
    Record {
        /// The file.
        path: PathBuf,
        /// Why.
        source: RecordError,
    },
    /// Signals cannot be heard.
    #[error("Ctrl-C cannot be listened to")]
    Signals(#[source] io::Error),
    /// Somebody asked to stop before there was anything to keep.
    #[error(
        "stopped; nothing is written, because a picture of this size is not kept in memory. With --checkpoint FILE it \
         can be stopped and continued at any time"
    )]
    Interrupted {
        /// As shells have it for the signal.
        exit_code: u8,
    },
    /// Standard output does not take any more.
    #[error("the answer cannot be printed")]
    Print(#[from] io::Error),
}

impl Failure {
    /// For `map_err` after reading `path`.
    pub fn reading(path: &Path) -> impl FnOnce(ReadError) -> Self {
        move |error| Failure::Read { path: path.to_owned(), source: Box::new(error) }
    }

    /// 2 for a wrong command line, 130 after Ctrl-C, 1 for everything else.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Failure::Usage(_) => ExitCode::from(2),
            Failure::Interrupted { exit_code } => ExitCode::from(*exit_code),
            _ => ExitCode::from(1),
        }
    }

    /// The message and its causes, one per line.
    pub fn explanation(&self) -> String {
        let mut text = format!("error: {self}\n");
        let mut told = self.to_string();
        let mut cause = self.source();
        while let Some(error) = cause {
            let message = error.to_string();
            // Some errors quote their cause; saying it twice helps nobody.
            if !told.contains(&message) {
                text.push_str(&format!("  because: {message}\n"));
            }
            told = message;
            cause = error.source();
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error)]
    #[error("cannot open x: {source}")]
    struct Quoting {
        source: io::Error,
    }

    #[test]
    fn causes_are_listed_once() {
        let quoting = Quoting { source: io::Error::other("disk on fire") };
        let failure = Failure::NotWritable { path: "a.png".into(), source: io::Error::other(quoting) };
        assert_eq!(
            failure.explanation(),
            "error: a.png cannot be written\n  because: cannot open x: disk on fire\n"
        );
    }
}
