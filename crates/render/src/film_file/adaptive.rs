//! Films of adaptive renderings: two halves, in each of which pixels have different numbers of samples.

use super::bytes::{Head, Summed};
use super::{ADAPTIVE, FilmFileError};
use crate::adaptive::{AdaptiveFilm, Half};
use crate::{Provenance, write_whole_file};
use std::io::{self, Read, Write};
use std::path::Path;

/// An unfinished picture with more samples where it is noisy.
#[derive(Clone, Debug)]
pub struct AdaptiveFilmFile {
    /// How it came about.
    pub provenance: Provenance,
    /// What was collected.
    pub film: AdaptiveFilm,
}

/// Writes a film file, whole or not at all.
///
/// # Errors
/// What the file system says.
pub fn write_adaptive_film(path: &Path, provenance: &Provenance, film: &AdaptiveFilm) -> io::Result<()> {
    write_whole_file(path, |file| write(file, provenance, film))
}

fn write(file: impl Write, provenance: &Provenance, film: &AdaptiveFilm) -> io::Result<()> {
    let mut out = Summed::new(file);
    Head::write(&mut out, ADAPTIVE, &provenance.to_string(), (film.width, film.height))?;
    let [a, b] = &film.halves;
    out.write_numbers(&[u32::from(film.is_planned), a.end, b.end])?;
    out.write_pixels(&a.pixels)?;
    out.write_pixels(&b.pixels)?;
    out.write_checksum()
}

/// Reads what comes after the head.
pub(super) fn read(
    head: Head,
    mut file: Summed<impl Read>,
    length: u64,
    limit: u64,
) -> Result<AdaptiveFilmFile, FilmFileError> {
    use FilmFileError::Inconsistent;
    let is_planned = match file.header(length)? {
        0 => false,
        1 => true,
        _ => return Err(Inconsistent("its samples are neither planned nor not")),
    };
    let ends = [file.header(length)?, file.header(length)?];
    head.check_length(12, 2, length, limit)?;
    let pixels = head.pixels() as usize;
    let [a, b] = ends;
    let halves = [
        Half { end: a, pixels: file.pixels(pixels, length)? },
        Half { end: b, pixels: file.pixels(pixels, length)? },
    ];
    file.check(length)?;
    // Until it is planned how many each shall have, all pixels have the same.
    let is_even = |half: &Half| half.pixels.iter().all(|pixel| pixel.samples == half.end);
    if !is_planned && !halves.iter().all(is_even) {
        return Err(Inconsistent("its pixels have other samples than it says"));
    }
    let Head { text, width, height, .. } = head;
    let film = AdaptiveFilm { width, height, halves, is_planned };
    Ok(AdaptiveFilmFile { provenance: Provenance::parse(&text), film })
}

#[cfg(test)]
mod tests {
    use super::super::SavedFilm;
    use super::super::bytes::{CHECKSUM_BYTES, signed};
    use super::*;
    use crate::RenderSettings;

    fn film(is_planned: bool) -> AdaptiveFilm {
        let settings = RenderSettings { width: 3, height: 2, ..RenderSettings::default() };
        let mut film = AdaptiveFilm::new(&settings);
        film.is_planned = is_planned;
        for (half, end) in film.halves.iter_mut().zip([7, 4]) {
            half.end = end;
            for (i, pixel) in half.pixels.iter_mut().enumerate() {
                pixel.samples = if is_planned { i as u32 + 4 } else { end };
                pixel.radiance = [i as f32, -0.0, f32::MIN_POSITIVE / 2.0].into();
            }
        }
        film
    }

    fn bytes_of(film: &AdaptiveFilm) -> Vec<u8> {
        let mut bytes = Vec::new();
        let provenance = Provenance { version: "1".to_owned(), samples: 8, ..Provenance::default() };
        write(&mut bytes, &provenance, film).unwrap();
        bytes
    }

    fn read_back(bytes: &[u8]) -> Result<AdaptiveFilm, FilmFileError> {
        match SavedFilm::read_from(bytes, bytes.len() as u64, 1 << 20)? {
            SavedFilm::Adaptive(file) => Ok(file.film),
            SavedFilm::Uniform(_) => panic!("another kind"),
        }
    }

    #[test]
    fn an_adaptive_film_comes_back_bit_for_bit() {
        for is_planned in [false, true] {
            let bytes = bytes_of(&film(is_planned));
            assert_eq!(bytes_of(&read_back(&bytes).unwrap()), bytes);
        }
    }

    #[test]
    fn damage_and_forged_numbers_are_noticed() {
        let bytes = bytes_of(&film(false));
        for length in 0..bytes.len() {
            assert!(read_back(&bytes[..length]).is_err(), "cut off at {length}");
        }
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            assert!(read_back(&damaged).is_err(), "changed at {at}");
        }
        // The numbers before the pixels, with a right checksum.
        let first = bytes.len() - CHECKSUM_BYTES as usize - 2 * 6 * 32 - 20;
        for at in (first..first + 20).step_by(4) {
            for value in [0u32, 1, 5, 1 << 16, u32::MAX] {
                let mut forged = bytes.clone();
                forged[at..at + 4].copy_from_slice(&value.to_le_bytes());
                let forged = signed(&forged).unwrap();
                // Samples of pixels that are planned may be any, and are looked at when they are gone on with.
                let is_planned = at == first + 8 && value == 1;
                assert!(forged == bytes || is_planned || read_back(&forged).is_err(), "{value} at {at}");
            }
        }
    }
}
