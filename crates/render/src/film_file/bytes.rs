//! What films of all kinds have in common: how they begin, their pixels, and the checksum at their end. All numbers
//! have their lowest byte first.

use super::{FILM_MAGIC, FilmFileError};
use kernels::records::kernel::FilmPixel;
use sha2::{Digest, Sha256};
use std::io::{self, Read, Write};

/// Most bytes of the text.
const MOST_TEXT: u32 = 1 << 16;
/// Largest edge of a picture in pixels.
const LONGEST_EDGE: u32 = 1 << 16;
/// Bytes of a pixel.
pub(super) const PIXEL_BYTES: u64 = size_of::<FilmPixel>() as u64;
pub(super) const CHECKSUM_BYTES: u64 = 32;
/// Pixels that are read or written at a time.
const PIECE: usize = 1 << 14;

/// The beginning of a film.
pub(super) struct Head {
    pub version: u32,
    pub text: String,
    pub width: u32,
    pub height: u32,
    /// Bytes up to here.
    pub bytes: u64,
}

impl Head {
    /// Reads it; `length` is that of the file.
    pub fn read(file: &mut Summed<impl Read>, length: u64) -> Result<Self, FilmFileError> {
        use FilmFileError::Inconsistent;
        let mut magic = [0; FILM_MAGIC.len()];
        match file.read_exact(&mut magic) {
            Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => return Err(error.into()),
            Ok(()) if magic == FILM_MAGIC => {}
            _ => return Err(FilmFileError::NotAFilm),
        }
        let version = file.header(length)?;
        if !super::VERSIONS.contains(&version) {
            return Err(FilmFileError::Version { found: version });
        }
        let text_length = file.header(length)?;
        if text_length > MOST_TEXT {
            return Err(Inconsistent("its text is too long"));
        }
        let mut text = vec![0; text_length as usize];
        file.read_exact(&mut text).map_err(|error| cut_off(error, length))?;
        let text = String::from_utf8(text).map_err(|_| Inconsistent("its text is not readable"))?;
        let (width, height) = (file.header(length)?, file.header(length)?);
        if !(1..=LONGEST_EDGE).contains(&width) || !(1..=LONGEST_EDGE).contains(&height) {
            return Err(Inconsistent("its size is impossible"));
        }
        let bytes = FILM_MAGIC.len() as u64 + 16 + u64::from(text_length);
        Ok(Head { version, text, width, height, bytes })
    }

    /// Writes it.
    pub fn write(
        out: &mut Summed<impl Write>,
        version: u32,
        text: &str,
        (width, height): (u32, u32),
    ) -> io::Result<()> {
        let length = u32::try_from(text.len()).ok().filter(|length| *length <= MOST_TEXT);
        let length = length.ok_or_else(|| io::Error::other("the settings are too long for a film"))?;
        out.write_all(&FILM_MAGIC)?;
        out.write_numbers(&[version, length])?;
        out.write_all(text.as_bytes())?;
        out.write_numbers(&[width, height])
    }

    /// At most 2^32.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Before memory is taken for `films` films, at most 2^10, that come after `more` bytes: the file must be as long as
    /// they are, and they must fit.
    pub fn check_length(&self, more: u64, films: u32, length: u64, limit: u64) -> Result<(), FilmFileError> {
        let needed = u64::from(films) * self.pixels() * PIXEL_BYTES;
        let expected = self.bytes + more + needed + CHECKSUM_BYTES;
        if length != expected {
            return Err(FilmFileError::Length { found: length, expected });
        }
        if needed > limit {
            return Err(FilmFileError::TooLarge { needed, limit });
        }
        Ok(())
    }
}

/// The end of a file that should go on.
pub(super) fn cut_off(error: io::Error, found: u64) -> FilmFileError {
    match error.kind() {
        // How long it should be is not known yet, only that it is longer.
        io::ErrorKind::UnexpectedEof => FilmFileError::Length { found, expected: found + 1 },
        _ => error.into(),
    }
}

/// A film with the checksum that belongs to it in the place of its own, which nobody finds by chance: for tests and
/// fuzzing. `None` if it has no room for one.
pub(crate) fn signed(film: &[u8]) -> Option<Vec<u8>> {
    let end = film.len().checked_sub(CHECKSUM_BYTES as usize)?;
    let mut signed = film[..end].to_vec();
    let sum = Sha256::digest(&signed);
    signed.extend_from_slice(&sum);
    Some(signed)
}

/// In the order of the record's fields.
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
pub(super) struct Summed<F> {
    inner: F,
    sum: Sha256,
}

impl<F> Summed<F> {
    pub fn new(inner: F) -> Self {
        Summed { inner, sum: Sha256::new() }
    }
}

impl<F: Write> Summed<F> {
    pub fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sum.update(bytes);
        self.inner.write_all(bytes)
    }

    pub fn write_numbers(&mut self, numbers: &[u32]) -> io::Result<()> {
        numbers.iter().try_for_each(|number| self.write_all(&number.to_le_bytes()))
    }

    pub fn write_pixels(&mut self, pixels: &[FilmPixel]) -> io::Result<()> {
        let mut bytes = Vec::new();
        for piece in pixels.chunks(PIECE) {
            bytes.clear();
            piece.iter().for_each(|pixel| bytes.extend_from_slice(&pixel_bytes(pixel)));
            self.write_all(&bytes)?;
        }
        Ok(())
    }

    /// Ends the file.
    pub fn write_checksum(mut self) -> io::Result<()> {
        let sum = self.sum.finalize();
        self.inner.write_all(&sum)
    }
}

impl<F: Read> Summed<F> {
    fn read_exact(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.inner.read_exact(bytes)?;
        self.sum.update(bytes);
        Ok(())
    }

    /// A number at the beginning of a file of `length` bytes.
    pub fn header(&mut self, length: u64) -> Result<u32, FilmFileError> {
        let mut bytes = [0; 4];
        self.read_exact(&mut bytes).map_err(|error| cut_off(error, length))?;
        Ok(u32::from_le_bytes(bytes))
    }

    /// So many pixels; that the file holds them is known.
    pub fn pixels(&mut self, pixels: usize, length: u64) -> Result<Vec<FilmPixel>, FilmFileError> {
        let mut bytes = Vec::new();
        let mut collected = Vec::with_capacity(pixels);
        while collected.len() < pixels {
            let piece = PIECE.min(pixels - collected.len());
            bytes.resize(piece * PIXEL_BYTES as usize, 0);
            self.read_exact(&mut bytes).map_err(|error| cut_off(error, length))?;
            collected.extend(bytes.as_chunks().0.iter().map(pixel_of));
        }
        Ok(collected)
    }

    /// Ends the file, whose checksum must be right.
    pub fn check(mut self, length: u64) -> Result<(), FilmFileError> {
        let mut stored = [0; CHECKSUM_BYTES as usize];
        self.inner.read_exact(&mut stored).map_err(|error| cut_off(error, length))?;
        if stored[..] != self.sum.finalize()[..] {
            return Err(FilmFileError::Checksum);
        }
        Ok(())
    }
}
