//! One function for each reader of Sunshine's own files, for the fuzz targets in `fuzz/` and the regression tests. Films
//! are passed from one to another, and pictures come from anywhere.
//!
//! Nothing here checks results: whatever the bytes are, reading them must end soon, in little memory and without a
//! panic.

use crate::film_file::{AdaptiveFilmFile, SavedFilm, signed};
use crate::picture::record_of;
use crate::{FilmFile, RenderSettings, relative_noise};
use std::io::Cursor;

/// A target by its name, which is also that of its binary and its folders.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 2] = [("film", film), ("record", record)];

/// Bytes that a film may take.
const LIMIT: u64 = 1 << 24;

/// A film as it is, and with the checksum that it should have, which nobody finds by chance.
pub fn film(bytes: &[u8]) {
    look_at_film(bytes);
    if let Some(signed) = signed(bytes) {
        look_at_film(&signed);
    }
}

/// What `sunshine show` reads of pictures and films.
pub fn record(bytes: &[u8]) {
    let _ = record_of(Cursor::new(bytes), bytes.len() as u64, LIMIT);
}

/// What `--resume` and `sunshine merge` do with a film.
fn look_at_film(bytes: &[u8]) {
    match SavedFilm::read_from(bytes, bytes.len() as u64, LIMIT) {
        Err(error) => {
            let _ = error.to_string();
        }
        Ok(SavedFilm::Uniform(film)) => {
            let FilmFile { provenance, sums, .. } = &film;
            let _ = provenance.difference(&provenance.clone());
            let planned = provenance.setting("samples").and_then(|samples| samples.parse().ok());
            let _ = (sums.missing(0..planned.unwrap_or(0)), sums.room(planned.unwrap_or(0)));
            let _ = sums.clone().merge(sums.clone());
            // Without samples there is no picture, however large it would be.
            if sums.samples() > 0 {
                let _ = relative_noise(&film.into_film());
            }
        }
        Ok(SavedFilm::Adaptive(AdaptiveFilmFile { provenance, film })) => {
            let (width, height) = film.size();
            let settings =
                RenderSettings { width, height, samples: provenance.samples, ..RenderSettings::default() };
            let _ = (film.is_of(&settings), film.samples());
            let _ = relative_noise(&film.film());
        }
    }
}
