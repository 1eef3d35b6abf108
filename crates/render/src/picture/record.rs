//! What the files of pictures and films tell of themselves.

use super::encode::RECORD;
use crate::film_file::FILM_MAGIC;
use crate::{FilmFileError, SavedFilm, film_limit};
use exr::meta::MetaData;
use std::fmt::Write;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

/// Most bytes of the texts in a PNG.
const MOST_TEXT: usize = 1 << 20;

/// Why a file does not tell how it came about.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The file system refused.
    #[error("the file cannot be read")]
    Io(#[from] io::Error),
    /// It is no picture and no film.
    #[error("this is neither a .png nor an .exr nor a film of Sunshine")]
    UnknownKind,
    /// The picture is damaged.
    #[error("the picture is damaged: {0}")]
    Damaged(String),
    /// The film cannot be read.
    #[error(transparent)]
    Film(#[from] FilmFileError),
    /// Somebody else made it, or removed the text.
    #[error("the picture does not tell how it was made: another program made it, or saved it again")]
    NoRecord,
}

/// How a picture or a film came about, as text: a line for each thing.
///
/// # Errors
/// If it is neither, is damaged, or does not tell.
pub fn read_record(path: &Path) -> Result<String, RecordError> {
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    if !metadata.is_file() {
        return Err(RecordError::UnknownKind);
    }
    record_of(BufReader::new(file), metadata.len(), film_limit())
}

/// As [`read_record`], of a file of `length` bytes; a film may take `limit` bytes of memory.
pub(crate) fn record_of(
    mut file: impl BufRead + Seek,
    length: u64,
    limit: u64,
) -> Result<String, RecordError> {
    let mut magic = Vec::new();
    file.by_ref().take(8).read_to_end(&mut magic)?;
    file.seek(SeekFrom::Start(0))?;
    if magic == FILM_MAGIC {
        film_record(file, length, limit)
    } else if magic == *b"\x89PNG\r\n\x1a\n" {
        png_record(file)
    } else if magic.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        exr_record(file)
    } else {
        Err(RecordError::UnknownKind)
    }
}

fn png_record(file: impl BufRead + Seek) -> Result<String, RecordError> {
    let damaged = |error: png::DecodingError| RecordError::Damaged(error.to_string());
    let reader = png::Decoder::new_with_limits(file, png::Limits { bytes: MOST_TEXT });
    // Up to the first pixel; the texts stand before.
    let reader = reader.read_info().map_err(damaged)?;
    let info = reader.info();
    let record = info.utf8_text.iter().find(|text| text.keyword == RECORD).ok_or(RecordError::NoRecord)?;
    // It may be compressed, a thousand times at most.
    let mut record = record.clone();
    record.decompress_text_with_limit(MOST_TEXT).map_err(damaged)?;
    let mut text = record.get_text().map_err(damaged)?;
    // What the denoiser left.
    for comment in info.uncompressed_latin1_text.iter().filter(|text| text.keyword == "Comment") {
        // Text in memory takes whatever is written.
        let _ = writeln!(text, "{}", comment.text);
    }
    Ok(text)
}

fn exr_record(file: impl BufRead + Seek) -> Result<String, RecordError> {
    let meta =
        MetaData::read_from_buffered(file, false).map_err(|error| RecordError::Damaged(error.to_string()))?;
    let attributes =
        meta.headers.first().map(|header| &header.own_attributes).ok_or(RecordError::NoRecord)?;
    let is_ours = attributes.software_name.as_ref().is_some_and(|name| name.to_string().starts_with(RECORD));
    let record = attributes.comments.as_ref().filter(|_| is_ours).ok_or(RecordError::NoRecord)?;
    let mut text = record.to_string();
    for (name, value) in &attributes.other {
        if let ("denoised", exr::meta::attribute::AttributeValue::Text(denoiser)) =
            (name.to_string().as_str(), value)
        {
            let _ = writeln!(text, "denoised by {denoiser}");
        }
    }
    Ok(text)
}

fn film_record(file: impl Read, length: u64, limit: u64) -> Result<String, RecordError> {
    let film = SavedFilm::read_from(file, length, limit)?;
    let mut text = film.provenance().to_string();
    let (size, samples) = match &film {
        SavedFilm::Uniform(film) => {
            let ranges: Vec<String> =
                film.sums.ranges().iter().map(|range| format!("{}..{}", range.start, range.end)).collect();
            let ranges = if ranges.is_empty() { "none".to_owned() } else { ranges.join(", ") };
            ((film.width, film.height), format!("samples {ranges}"))
        }
        SavedFilm::Adaptive(film) => {
            (film.film.size(), format!("{} samples on average", film.film.samples()))
        }
    };
    let _ = writeln!(text, "film: {} x {} pixels, {samples}", size.0, size.1);
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::Band;
    use crate::picture::{Layers, Origins, PictureTarget, stream_picture};
    use crate::{Film, FilmFile, Provenance, ToneCurve};

    fn provenance() -> Provenance {
        Provenance {
            version: "1.2.3".to_owned(),
            scene: "Bäume – 木.gsz".to_owned(),
            scene_hash: "0123".to_owned(),
            device: "CPU".to_owned(),
            samples: 7,
            settings: vec![("depth".to_owned(), "5".to_owned())],
        }
    }

    fn write(path: &Path) {
        let film = Film::new(3, 2);
        let target = PictureTarget {
            path,
            width: 3,
            height: 2,
            exposure: Some(1.5),
            tone_curve: ToneCurve::Reinhard,
            layers: &Layers::default().denoised_by("a denoiser".to_owned()),
            origins: &Origins::default(),
            provenance: Some(&provenance()),
        };
        let band = Band { first_row: 0, width: 3, pixels: &film.pixels, layers: &[], denoised: &[] };
        stream_picture(&target, |sink| sink(&band)).unwrap();
    }

    #[test]
    fn pictures_tell_how_they_came_about() {
        let directory = tempfile::tempdir().unwrap();
        for name in ["a.png", "a.exr"] {
            let path = directory.path().join(name);
            write(&path);
            let text = read_record(&path).unwrap();
            let read = Provenance::parse(&text);
            let scene = if name == "a.png" { "Bäume – 木.gsz" } else { "Bäume ? ?.gsz" };
            assert_eq!(read, Provenance { scene: scene.to_owned(), ..provenance() }, "{text}");
            assert!(text.contains("denoised by a denoiser"), "{text}");
            assert_eq!(text.contains("exposure: +1.500 stops"), name == "a.png", "{text}");
            assert_eq!(text.contains("tone curve: reinhard"), name == "a.png", "{text}");
        }
    }

    #[test]
    fn films_tell_what_they_hold() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.film");
        let film =
            FilmFile { provenance: provenance(), width: 3, height: 2, sums: crate::FilmSums::new(6, 0) };
        film.write(&path).unwrap();
        let text = read_record(&path).unwrap();
        assert_eq!(Provenance::parse(&text), provenance());
        assert!(text.contains("3 x 2 pixels, samples none"), "{text}");
    }

    #[test]
    fn a_picture_from_elsewhere_does_not_fill_memory() {
        let png = |text: png::text_metadata::ITXtChunk| {
            let mut bytes = Vec::new();
            let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
            encoder.set_color(png::ColorType::Rgb);
            let mut writer = encoder.write_header().unwrap();
            writer.write_text_chunk(&text).unwrap();
            writer.write_image_data(&[0; 3]).unwrap();
            writer.finish().unwrap();
            record_of(std::io::Cursor::new(&bytes), bytes.len() as u64, 1 << 20)
        };
        let mut text = png::text_metadata::ITXtChunk::new(RECORD, "first\nlast");
        assert_eq!(png(text.clone()).unwrap(), "first\nlast");
        text.compressed = true;
        assert_eq!(png(text).unwrap(), "first\nlast");
        // A hundred megabytes that are a hundred kilobytes in the file.
        let mut large = png::text_metadata::ITXtChunk::new(RECORD, "a".repeat(100 << 20));
        large.compressed = true;
        assert!(matches!(png(large), Err(RecordError::Damaged(_))));
    }

    #[test]
    fn what_tells_nothing_is_explained() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        crate::write_picture(&Film::new(3, 2), &path, 0.0).unwrap();
        assert!(matches!(read_record(&path), Err(RecordError::NoRecord)));
        let whole = std::fs::read(&path).unwrap();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert!(read_record(&path).is_err());
        }
        let path = directory.path().join("a.exr");
        write(&path);
        let whole = std::fs::read(&path).unwrap();
        for at in (0..whole.len()).step_by(3) {
            let mut damaged = whole.clone();
            damaged[at] = !damaged[at];
            std::fs::write(&path, &damaged).unwrap();
            // Whatever it says, it says something.
            let _ = read_record(&path);
        }
        std::fs::write(&path, b"text").unwrap();
        assert!(matches!(read_record(&path), Err(RecordError::UnknownKind)));
        assert!(matches!(read_record(directory.path()), Err(RecordError::UnknownKind)));
    }
}
