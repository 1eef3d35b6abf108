//! Files of unfinished pictures: what was collected so far, to be continued or joined. `docs/film.md` describes the
//! format.

use crate::film_memory::film_limit;
use crate::sums::{BLOCK_SAMPLES, Part, is_node};
use crate::{Film, FilmSums, Provenance, write_whole_file};
use kernels::records::kernel::FilmPixel;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

/// First bytes of a film file. As in PNG, a byte that is no text and two kinds of line ends, so that a transfer that
/// changes text does not go unnoticed.
pub const FILM_MAGIC: [u8; 8] = *b"\x93SUN\r\n\x1a\n";
/// Version of the format.
const VERSION: u32 = 1;
/// Most bytes of the text.
const MOST_TEXT: u32 = 1 << 16;
/// Largest edge of a picture in pixels.
const LONGEST_EDGE: u32 = 1 << 16;
/// Most parts: two for each binary digit of the number of samples, and more than sensible shares leave.
const MOST_PARTS: u32 = 1 << 10;
const PIXEL_BYTES: u64 = size_of::<FilmPixel>() as u64;
const CHECKSUM_BYTES: u64 = 32;
/// Pixels that are read or written at a time.
const PIECE: usize = 1 << 14;

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
    #[error("the film has format {found}, this program knows {VERSION}; use a newer version of Sunshine")]
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
    /// If it cannot be read, is damaged or too large.
    pub fn read(path: &Path) -> Result<Self, FilmFileError> {
        Self::read_within(path, film_limit())
    }

    /// As [`FilmFile::read`], if it takes at most `limit` bytes of memory.
    ///
    /// # Errors
    /// As [`FilmFile::read`].
    pub fn read_within(path: &Path, limit: u64) -> Result<Self, FilmFileError> {
        let file = File::open(path)?;
        // What is no ordinary file has no length, and reading may never end.
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            return Err(FilmFileError::NotAFilm);
        }
        read_film(BufReader::with_capacity(1 << 18, file), metadata.len(), limit)
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
    write_whole_file(path, |file| {
        let mut out = Summed { inner: file, sum: Sha256::new() };
        let text = provenance.to_string();
        let length = u32::try_from(text.len()).ok().filter(|length| *length <= MOST_TEXT);
        let length = length.ok_or_else(|| io::Error::other("the settings are too long for a film"))?;
        out.write_all(&FILM_MAGIC)?;
        out.write_numbers(&[VERSION, length])?;
        out.write_all(text.as_bytes())?;
        // Fewer than the digits of a 32-bit number.
        out.write_numbers(&[width, height, BLOCK_SAMPLES, sums.parts().len() as u32])?;
        for part in sums.parts() {
            out.write_numbers(&[part.samples.start, part.samples.end])?;
        }
        let mut bytes = Vec::new();
        for pixels in sums.parts().iter().flat_map(|part| part.pixels.chunks(PIECE)) {
            bytes.clear();
            pixels.iter().for_each(|pixel| bytes.extend_from_slice(&pixel_bytes(pixel)));
            out.write_all(&bytes)?;
        }
        let sum = out.sum.clone().finalize();
        out.inner.write_all(&sum)
    })
}

fn read_film(file: impl Read, length: u64, limit: u64) -> Result<FilmFile, FilmFileError> {
    use FilmFileError::Inconsistent;
    let mut file = Summed { inner: file, sum: Sha256::new() };
    let mut magic = [0; FILM_MAGIC.len()];
    match file.read_exact(&mut magic) {
        Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => return Err(error.into()),
        Ok(()) if magic == FILM_MAGIC => {}
        _ => return Err(FilmFileError::NotAFilm),
    }
    let header = |file: &mut Summed<_>| file.number().map_err(|error| cut_off(error, length));
    let version = header(&mut file)?;
    if version != VERSION {
        return Err(FilmFileError::Version { found: version });
    }
    let text_length = header(&mut file)?;
    if text_length > MOST_TEXT {
        return Err(Inconsistent("its text is too long"));
    }
    let mut text = vec![0; text_length as usize];
    file.read_exact(&mut text).map_err(|error| cut_off(error, length))?;
    let text = String::from_utf8(text).map_err(|_| Inconsistent("its text is not readable"))?;
    let (width, height) = (header(&mut file)?, header(&mut file)?);
    if !(1..=LONGEST_EDGE).contains(&width) || !(1..=LONGEST_EDGE).contains(&height) {
        return Err(Inconsistent("its size is impossible"));
    }
    if header(&mut file)? != BLOCK_SAMPLES {
        return Err(Inconsistent("it was summed in other blocks"));
    }
    let count = header(&mut file)?;
    if count > MOST_PARTS {
        return Err(Inconsistent("it has too many parts"));
    }
    let mut ranges = Vec::new();
    for _ in 0..count {
        ranges.push(header(&mut file)?..header(&mut file)?);
    }
    if !ranges.iter().all(is_node) {
        return Err(Inconsistent("its samples are divided in an impossible way"));
    }
    // At most 2^10 parts of 2^32 pixels of 2^5 bytes. Before memory is taken the file must have that length.
    let pixels = u64::from(width) * u64::from(height);
    let film_bytes = u64::from(count) * pixels * PIXEL_BYTES;
    let header_bytes = FILM_MAGIC.len() as u64 + 24 + u64::from(text_length) + 8 * u64::from(count);
    let expected = header_bytes + film_bytes + CHECKSUM_BYTES;
    if length != expected {
        return Err(FilmFileError::Length { found: length, expected });
    }
    if film_bytes > limit {
        return Err(FilmFileError::TooLarge { needed: film_bytes, limit });
    }
    let pixels = pixels as usize;
    let mut parts = Vec::new();
    let mut bytes = Vec::new();
    for samples in ranges {
        let mut collected = Vec::with_capacity(pixels);
        while collected.len() < pixels {
            let piece = PIECE.min(pixels - collected.len());
            bytes.resize(piece * PIXEL_BYTES as usize, 0);
            file.read_exact(&mut bytes).map_err(|error| cut_off(error, expected))?;
            collected.extend(bytes.as_chunks().0.iter().map(pixel_of));
        }
        parts.push(Part { samples, pixels: collected });
    }
    let sum = file.sum.clone().finalize();
    let mut stored = [0; CHECKSUM_BYTES as usize];
    file.inner.read_exact(&mut stored).map_err(|error| cut_off(error, expected))?;
    if stored[..] != sum[..] {
        return Err(FilmFileError::Checksum);
    }
    let counts = |part: &Part| {
        let samples = part.samples.end - part.samples.start;
        part.pixels.iter().all(|pixel| pixel.samples == samples)
    };
    if !parts.iter().all(counts) {
        return Err(Inconsistent("its pixels have other samples than it says"));
    }
    let sums = FilmSums::of_parts(pixels, parts);
    let sums = sums.ok_or(Inconsistent("its samples are divided in an impossible way"))?;
    Ok(FilmFile { provenance: Provenance::parse(&text), width, height, sums })
}

/// The end of a file that should go on.
fn cut_off(error: io::Error, found: u64) -> FilmFileError {
    match error.kind() {
        // How long it should be is not known yet, only that it is longer.
        io::ErrorKind::UnexpectedEof => FilmFileError::Length { found, expected: found + 1 },
        _ => error.into(),
    }
}

/// In the order of the record's fields; all numbers in this format have their lowest byte first.
fn pixel_bytes(pixel: &FilmPixel) -> [u8; PIXEL_BYTES as usize] {
    let [r, g, b] = pixel.radiance.to_array().map(f32::to_bits);
    let [rr, gg, bb] = pixel.squares.to_array().map(f32::to_bits);
    let mut bytes = [0; PIXEL_BYTES as usize];
    for (place, number) in
        bytes.as_chunks_mut().0.iter_mut().zip([r, g, b, pixel.rays, rr, gg, bb, pixel.samples])
    {
        *place = number.to_le_bytes();
    }
    bytes
}

fn pixel_of(bytes: &[u8; PIXEL_BYTES as usize]) -> FilmPixel {
    let mut numbers = [0; 8];
    for (number, place) in numbers.iter_mut().zip(bytes.as_chunks().0) {
        *number = u32::from_le_bytes(*place);
    }
    let [r, g, b, rays, rr, gg, bb, samples] = numbers;
    FilmPixel {
        radiance: [r, g, b].map(f32::from_bits).into(),
        rays,
        squares: [rr, gg, bb].map(f32::from_bits).into(),
        samples,
    }
}

/// Reads or writes and sums up what passes.
struct Summed<F> {
    inner: F,
    sum: Sha256,
}

impl<F: Write> Summed<F> {
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sum.update(bytes);
        self.inner.write_all(bytes)
    }

    fn write_numbers(&mut self, numbers: &[u32]) -> io::Result<()> {
        numbers.iter().try_for_each(|number| self.write_all(&number.to_le_bytes()))
    }
}

impl<F: Read> Summed<F> {
    fn read_exact(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.inner.read_exact(bytes)?;
        self.sum.update(bytes);
        Ok(())
    }

    fn number(&mut self) -> io::Result<u32> {
        let mut bytes = [0; 4];
        self.read_exact(&mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }
}

#[cfg(test)]
#[allow(clippy::single_range_in_vec_init, reason = "ranges of samples are meant")]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

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
        read_film(bytes, bytes.len() as u64, 1 << 20)
    }

    /// With the checksum that belongs to it.
    fn signed(mut bytes: Vec<u8>) -> Vec<u8> {
        let end = bytes.len() - CHECKSUM_BYTES as usize;
        let sum = Sha256::digest(&bytes[..end]);
        bytes[end..].copy_from_slice(&sum);
        bytes
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
                assert!(read(&signed(forged)).is_err(), "{value} at {at}");
            }
        }
        // Samples of a pixel.
        let mut forged = bytes.clone();
        let end = forged.len() - CHECKSUM_BYTES as usize;
        forged[end - 4] ^= 1;
        assert!(matches!(read(&signed(forged)), Err(FilmFileError::Inconsistent(_))));
        assert!(matches!(read_film(&bytes[..], bytes.len() as u64, 99), Err(FilmFileError::TooLarge { .. })));
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
