//! Files of unfinished pictures: what was collected so far, to be continued or joined. `docs/long-renders.md`
//! describes the format.

mod adaptive;
mod bytes;

use crate::film_memory::film_limit;
use crate::sums::{BLOCK_SAMPLES, Part, is_node};
use crate::{Film, FilmSums, Provenance, write_whole_file};
pub use adaptive::{AdaptiveFilmFile, write_adaptive_film};
pub(crate) use bytes::signed;
use bytes::{Head, Summed};
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

/// First bytes of a film file. As in PNG, a byte that is no text and two kinds of line ends, so that a transfer that
/// changes text does not go unnoticed.
pub const FILM_MAGIC: [u8; 8] = *b"\x93SUN\r\n\x1a\n";
/// Version of the format of films in which every pixel has the same samples.
const UNIFORM: u32 = 1;
/// Version of the format of films with more samples where the picture is noisy.
const ADAPTIVE: u32 = 2;
const VERSIONS: [u32; 2] = [UNIFORM, ADAPTIVE];
/// Most parts: two for each binary digit of the number of samples, and more than sensible shares leave.
const MOST_PARTS: u32 = 1 << 10;

/// A film of either kind.
#[derive(Clone, Debug)]
pub enum SavedFilm {
    /// Every pixel has the same samples.
    Uniform(FilmFile),
    /// More samples where the picture is noisy.
    Adaptive(AdaptiveFilmFile),
}

/// An unfinished picture, or a share of one.
#[derive(Clone, Debug)]
pub struct FilmFile {
    /// How it came about.
    pub provenance: Provenance,
    /// Width in pixels of what is rendered.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// What was collected.
    pub sums: FilmSums,
}

/// Why a film file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum FilmFileError {
    /// The file system refused.
    #[error("the file cannot be read")]
    Io(#[from] io::Error),
    /// It is another kind of file.
    #[error("this is no film of Sunshine; --checkpoint writes them")]
    NotAFilm,
    /// It is newer than this program.
    #[error(
        "the film has format {found}, this program knows {UNIFORM} and {ADAPTIVE}; use a newer version of Sunshine"
    )]
    Version {
        /// Version of the format in the file.
        found: u32,
    },
    /// It is shorter or longer than it says.
    #[error("the film is cut off or damaged: it has {found} bytes and should have {expected}")]
    Length {
        /// Bytes of the file.
        found: u64,
        /// What its beginning says.
        expected: u64,
    },
    /// It does not fit into memory.
    #[error("the film takes {needed} bytes of memory, at most {limit} can be had here")]
    TooLarge {
        /// Bytes that it takes.
        needed: u64,
        /// What is accepted.
        limit: u64,
    },
    /// Its content does not have the checksum that it should have.
    #[error("the film is damaged: its checksum is wrong; an older copy or another run must replace it")]
    Checksum,
    /// It contradicts itself.
    #[error("the film is damaged: {0}")]
    Inconsistent(&'static str),
    /// It is no share of a picture.
    #[error("the film was made with --adaptive: it holds a whole picture, which only --resume goes on with")]
    Adaptive,
}

impl SavedFilm {
    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be read, is damaged or too large.
    pub fn read(path: &Path) -> Result<Self, FilmFileError> {
        let file = File::open(path)?;
        // What is no ordinary file has no length, and reading may never end.
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            return Err(FilmFileError::NotAFilm);
        }
        Self::read_from(BufReader::with_capacity(1 << 18, file), metadata.len(), film_limit())
    }

    /// Reads a file of `length` bytes that may take `limit` bytes of memory.
    pub(crate) fn read_from(file: impl Read, length: u64, limit: u64) -> Result<Self, FilmFileError> {
        let mut file = Summed::new(file);
        let head = Head::read(&mut file, length)?;
        if head.version == ADAPTIVE {
            adaptive::read(head, file, length, limit).map(SavedFilm::Adaptive)
        } else {
            read_uniform(head, file, length, limit).map(SavedFilm::Uniform)
        }
    }

    /// How it came about.
    pub fn provenance(&self) -> &Provenance {
        match self {
            SavedFilm::Uniform(film) => &film.provenance,
            SavedFilm::Adaptive(film) => &film.provenance,
        }
    }
}

impl FilmFile {
    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        write_film(path, &self.provenance, (self.width, self.height), &self.sums)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be read, is damaged or too large, or is of the other kind.
    pub fn read(path: &Path) -> Result<Self, FilmFileError> {
        match SavedFilm::read(path)? {
            SavedFilm::Uniform(film) => Ok(film),
            SavedFilm::Adaptive(_) => Err(FilmFileError::Adaptive),
        }
    }

    /// The picture so far.
    pub fn into_film(self) -> Film {
        Film { width: self.width, height: self.height, pixels: self.sums.into_total() }
    }
}

/// Writes a film file, whole or not at all.
///
/// # Errors
/// What the file system says.
pub fn write_film(
    path: &Path,
    provenance: &Provenance,
    (width, height): (u32, u32),
    sums: &FilmSums,
) -> io::Result<()> {
    write_whole_file(path, |file| write_uniform(file, provenance, (width, height), sums))
}

fn write_uniform(
    file: impl Write,
    provenance: &Provenance,
    size: (u32, u32),
    sums: &FilmSums,
) -> io::Result<()> {
    let mut out = Summed::new(file);
    Head::write(&mut out, UNIFORM, &provenance.to_string(), size)?;
    // Fewer than the digits of a 32-bit number.
    out.write_numbers(&[BLOCK_SAMPLES, sums.parts().len() as u32])?;
    for part in sums.parts() {
        out.write_numbers(&[part.samples.start, part.samples.end])?;
    }
    for part in sums.parts() {
        out.write_pixels(&part.pixels)?;
    }
    out.write_checksum()
}

fn read_uniform(
    head: Head,
    mut file: Summed<impl Read>,
    length: u64,
    limit: u64,
) -> Result<FilmFile, FilmFileError> {
    use FilmFileError::Inconsistent;
    if file.header(length)? != BLOCK_SAMPLES {
        return Err(Inconsistent("it was summed in other blocks"));
    }
    let count = file.header(length)?;
    if count > MOST_PARTS {
        return Err(Inconsistent("it has too many parts"));
    }
    let mut ranges = Vec::new();
    for _ in 0..count {
        ranges.push(file.header(length)?..file.header(length)?);
    }
    if !ranges.iter().all(is_node) {
        return Err(Inconsistent("its samples are divided in an impossible way"));
    }
    head.check_length(8 + 8 * u64::from(count), count, length, limit)?;
    let pixels = head.pixels() as usize;
    let mut parts = Vec::new();
    for samples in ranges {
        parts.push(Part { samples, pixels: file.pixels(pixels, length)? });
    }
    file.check(length)?;
    let counts = |part: &Part| {
        let samples = part.samples.end - part.samples.start;
        part.pixels.iter().all(|pixel| pixel.samples == samples)
    };
    if !parts.iter().all(counts) {
        return Err(Inconsistent("its pixels have other samples than it says"));
    }
    let sums = FilmSums::of_parts(pixels, parts);
    let sums = sums.ok_or(Inconsistent("its samples are divided in an impossible way"))?;
    let Head { text, width, height, .. } = head;
    Ok(FilmFile { provenance: Provenance::parse(&text), width, height, sums })
}

#[cfg(test)]
#[allow(clippy::single_range_in_vec_init, reason = "ranges of samples are meant")]
mod tests {
    use super::bytes::CHECKSUM_BYTES;
    use super::*;
    use bytemuck::Zeroable;
    use kernels::records::kernel::FilmPixel;

    /// 3 x 2 pixels with samples 0 to 192 and 256 to 260.
    fn film() -> FilmFile {
        let part = |samples: std::ops::Range<u32>| {
            let mut pixels = vec![FilmPixel::zeroed(); 6];
            for (i, pixel) in pixels.iter_mut().enumerate() {
                pixel.radiance = [i as f32, -0.0, f32::MIN_POSITIVE / 2.0].into();
                pixel.squares = [f32::INFINITY, 1e-9, 0.1].into();
                pixel.rays = u32::MAX - i as u32;
                pixel.samples = samples.end - samples.start;
            }
            Part { samples, pixels }
        };
        let sums = FilmSums::of_parts(6, vec![part(0..128), part(128..192), part(256..260)]).unwrap();
        let provenance = Provenance { version: "1".to_owned(), samples: 196, ..Provenance::default() };
        FilmFile { provenance, width: 3, height: 2, sums }
    }

    fn bytes_of(film: &FilmFile) -> Vec<u8> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.film");
        film.write(&path).unwrap();
        std::fs::read(path).unwrap()
    }

    fn read(bytes: &[u8]) -> Result<FilmFile, FilmFileError> {
        read_within(bytes, 1 << 20)
    }

    fn read_within(bytes: &[u8], limit: u64) -> Result<FilmFile, FilmFileError> {
        match SavedFilm::read_from(bytes, bytes.len() as u64, limit)? {
            SavedFilm::Uniform(film) => Ok(film),
            SavedFilm::Adaptive(_) => Err(FilmFileError::Adaptive),
        }
    }

    #[test]
    fn a_film_comes_back_bit_for_bit() {
        let film = film();
        let bytes = bytes_of(&film);
        let back = read(&bytes).unwrap();
        assert_eq!((back.width, back.height), (3, 2));
        assert_eq!(back.provenance, film.provenance);
        assert_eq!(back.sums.ranges(), [0..192, 256..260]);
        assert_eq!(bytes_of(&back), bytes);
        // An empty one, too.
        let none = FilmFile { sums: FilmSums::new(6, 0), ..film };
        assert_eq!(read(&bytes_of(&none)).unwrap().sums.samples(), 0);
    }

    #[test]
    fn every_damage_is_noticed() {
        let bytes = bytes_of(&film());
        for length in 0..bytes.len() {
            assert!(read(&bytes[..length]).is_err(), "cut off at {length}");
        }
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            assert!(read(&damaged).is_err(), "changed at {at}");
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert!(matches!(read(&longer), Err(FilmFileError::Length { .. })));
        assert!(matches!(read(b"\x89PNG\r\n\x1a\n"), Err(FilmFileError::NotAFilm)));
    }

    #[test]
    fn forged_numbers_neither_panic_nor_fill_memory() {
        let bytes = bytes_of(&film());
        let text = film().provenance.to_string().len();
        // Every number of the header, one after the other, with a right checksum.
        let numbers = [8, 12].into_iter().chain((16 + text..16 + text + 40).step_by(4));
        for at in numbers {
            for value in [0, 1, 2, 7, 63, 65, 1 << 10, 1 << 16, (1 << 16) + 1, u32::MAX - 63, u32::MAX] {
                let mut forged = bytes.clone();
                if forged[at..at + 4] == u32::to_le_bytes(value) {
                    continue;
                }
                forged[at..at + 4].copy_from_slice(&value.to_le_bytes());
                assert!(read(&signed(&forged).unwrap()).is_err(), "{value} at {at}");
            }
        }
        // Samples of a pixel.
        let mut forged = bytes.clone();
        let end = forged.len() - CHECKSUM_BYTES as usize;
        forged[end - 4] ^= 1;
        assert!(matches!(read(&signed(&forged).unwrap()), Err(FilmFileError::Inconsistent(_))));
        assert!(matches!(read_within(&bytes, 99), Err(FilmFileError::TooLarge { .. })));
    }

    #[test]
    fn what_is_no_ordinary_file_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        assert!(FilmFile::read(directory.path()).is_err());
        assert!(matches!(FilmFile::read(&directory.path().join("none")), Err(FilmFileError::Io(_))));
        if cfg!(unix) {
            assert!(matches!(FilmFile::read(Path::new("/dev/zero")), Err(FilmFileError::NotAFilm)));
        }
    }
}
