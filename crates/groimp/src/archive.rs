//! The files of a project: entries of a zip archive or files below a directory.

use crate::{Limits, ReadError};
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::{Component, Path, PathBuf};

/// What a zip archive can be read from.
trait Seekable: Read + Seek {}

impl<T: Read + Seek> Seekable for T {}

type Zip = zip::ZipArchive<Metered>;

/// A zip file of which no more is read than a sound archive needs.
///
/// The zip reader tries every place that looks like the end of a directory, and an entry can be listed under many
/// names; both would read the same bytes again and again.
struct Metered {
    file: Box<dyn Seekable>,
    left: u64,
}

impl Metered {
    /// All bytes several times over: once for the directory and once for each file, with room to spare.
    fn new(mut file: Box<dyn Seekable>) -> io::Result<Self> {
        let length = file.seek(SeekFrom::End(0))?;
        Ok(Metered { file, left: length.saturating_mul(8).saturating_add(1 << 20) })
    }
}

impl Read for Metered {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        let too_much = || io::Error::other("the archive refers to the same bytes too often");
        self.left = self.left.checked_sub(count as u64).ok_or_else(too_much)?;
        Ok(count)
    }
}

impl Seek for Metered {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.file.seek(position)
    }
}

/// Bytes of the name of a file in a project; messages about the file hold a copy.
const LONGEST_NAME: usize = 1000;

enum Storage {
    Zip(Box<Zip>),
    Directory(PathBuf),
    Memory(HashMap<String, Vec<u8>>),
}

/// An opened project.
pub(crate) struct Archive {
    path: PathBuf,
    storage: Storage,
    limits: Limits,
    read_bytes: u64,
    charsets: HashMap<String, String>,
    /// The registry file; `None` for a bare graph.
    pub registry: Option<String>,
    /// The graph file of a bare graph.
    pub graph: Option<String>,
}

impl Archive {
    /// Opens a `.gsz`, a `project.gs`, a project directory or a graph file.
    pub fn open(path: &Path, limits: Limits) -> Result<Self, ReadError> {
        let io_error = |source| ReadError::Io { path: path.to_owned(), source };
        let is_directory = std::fs::metadata(path).map_err(io_error)?.is_dir();
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        let extension = extension.as_deref().and_then(|e| e.to_str());
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let parent = path.parent().map(Path::to_owned).unwrap_or_default();
        let (storage, registry, graph) = if is_directory {
            (Storage::Directory(path.to_owned()), Some("project.gs".to_owned()), None)
        } else if extension == Some("gs") {
            (Storage::Directory(parent), Some(name), None)
        } else if extension == Some("xml") {
            (Storage::Directory(parent), None, Some(name))
        } else {
            // What is no ordinary file may block or never end.
            if !std::fs::metadata(path).map_err(io_error)?.is_file() {
                let reason = "not an ordinary file".to_owned();
                return Err(ReadError::NotAnArchive { path: path.to_owned(), reason });
            }
            let file = Box::new(File::open(path).map_err(io_error)?);
            (open_zip(path, file)?, Some("project.gs".to_owned()), None)
        };
        Archive::new(path, storage, limits, registry, graph)
    }

    /// Opens the bytes of a `.gsz`.
    pub fn from_zip(bytes: Vec<u8>, limits: Limits) -> Result<Self, ReadError> {
        let path = Path::new("memory.gsz");
        let storage = open_zip(path, Box::new(Cursor::new(bytes)))?;
        Archive::new(path, storage, limits, Some("project.gs".to_owned()), None)
    }

    /// A project of the given files.
    pub fn from_files(files: HashMap<String, Vec<u8>>, limits: Limits) -> Result<Self, ReadError> {
        let registry = Some("project.gs".to_owned());
        Archive::new(Path::new("memory"), Storage::Memory(files), limits, registry, None)
    }

    fn new(
        path: &Path,
        storage: Storage,
        limits: Limits,
        registry: Option<String>,
        graph: Option<String>,
    ) -> Result<Self, ReadError> {
        let (path, charsets) = (path.to_owned(), HashMap::new());
        let mut archive = Archive { path, storage, limits, read_bytes: 0, charsets, registry, graph };
        if archive.registry.is_some()
            && let Some(manifest) = archive.read("META-INF/MANIFEST.MF")?
        {
            archive.charsets = manifest_charsets(&String::from_utf8_lossy(&manifest));
        }
        Ok(archive)
    }

    /// Names of all entries of a zip archive.
    pub fn entry_names(&self) -> Vec<String> {
        match &self.storage {
            Storage::Zip(archive) => archive.file_names().map(str::to_owned).collect(),
            Storage::Directory(_) | Storage::Memory(_) => Vec::new(),
        }
    }

    /// Limits given on opening.
    pub fn limits(&self) -> Limits {
        self.limits
    }

    /// Contents of an entry, `None` if there is no such entry (or it lies outside the project).
    pub fn read(&mut self, entry: &str) -> Result<Option<Vec<u8>>, ReadError> {
        if entry.len() > LONGEST_NAME || !is_inside(entry) {
            return Ok(None);
        }
        let (which, limit) = if self.limits.entry_bytes <= self.limits.total_bytes - self.read_bytes {
            ("one file", self.limits.entry_bytes)
        } else {
            ("all files together", self.limits.total_bytes - self.read_bytes)
        };
        let unpacked = match &mut self.storage {
            Storage::Zip(archive) => read_zip(archive, entry, limit).map_err(|reason| {
                ReadError::BrokenEntry { path: self.path.clone(), entry: entry.to_owned(), reason }
            })?,
            Storage::Directory(root) => read_below(root, entry, limit)
                .map_err(|source| ReadError::Io { path: root.join(entry), source })?,
            Storage::Memory(files) => files.get(entry).cloned(),
        };
        let Some(bytes) = unpacked else { return Ok(None) };
        if bytes.len() as u64 > limit {
            let limit = if which == "one file" { limit } else { self.limits.total_bytes };
            return Err(ReadError::TooLarge {
                path: self.path.clone(),
                entry: entry.to_owned(),
                which,
                limit,
            });
        }
        self.read_bytes += bytes.len() as u64;
        Ok(Some(bytes))
    }

    /// Contents of an entry without which there is no project.
    pub fn require(&mut self, entry: &str) -> Result<Vec<u8>, ReadError> {
        self.read(entry)?
            .ok_or_else(|| ReadError::MissingEntry { path: self.path.clone(), entry: entry.to_owned() })
    }

    /// A model source as text, in the character set that the manifest names.
    pub fn read_source(&mut self, entry: &str) -> Result<Option<String>, ReadError> {
        let Some(bytes) = self.read(entry)? else { return Ok(None) };
        let charset = self.charsets.get(entry).and_then(|c| encoding_rs::Encoding::for_label(c.as_bytes()));
        // Without a manifest the two character sets that occur are told apart by validity.
        let charset = charset.unwrap_or_else(|| match std::str::from_utf8(&bytes) {
            Ok(_) => encoding_rs::UTF_8,
            Err(_) => encoding_rs::WINDOWS_1252,
        });
        Ok(Some(charset.decode(&bytes).0.into_owned()))
    }
}

fn open_zip(path: &Path, source: Box<dyn Seekable>) -> Result<Storage, ReadError> {
    let source = Metered::new(source).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
    let archive = zip::ZipArchive::new(source)
        .map_err(|error| ReadError::NotAnArchive { path: path.to_owned(), reason: error.to_string() })?;
    Ok(Storage::Zip(Box::new(archive)))
}

fn read_zip(archive: &mut Zip, entry: &str, limit: u64) -> Result<Option<Vec<u8>>, String> {
    let file = match archive.by_name(entry) {
        Ok(file) => file,
        Err(zip::result::ZipError::FileNotFound) => return Ok(None),
        Err(error) => return Err(error.to_string()),
    };
    // The size in the header may lie, so count what really comes out.
    let mut bytes = Vec::new();
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    Ok(Some(bytes))
}

/// Whether a name stays in its project: relative, without `..`, and the same on every system.
fn is_inside(entry: &str) -> bool {
    let stays = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    !entry.contains(['\\', '\0']) && Path::new(entry).components().all(stays)
}

fn read_below(root: &Path, entry: &str, limit: u64) -> io::Result<Option<Vec<u8>>> {
    let relative = Path::new(entry);
    let root = if root.as_os_str().is_empty() { Path::new(".") } else { root };
    let real = match root.join(relative).canonicalize() {
        Ok(real) => real,
        Err(error)
            if matches!(
                error.kind(),
                io::ErrorKind::NotFound | io::ErrorKind::NotADirectory | io::ErrorKind::InvalidInput
            ) =>
        {
            return Ok(None);
        }
        Err(error) => return Err(error),
    };
    // Links must not lead out of the project either.
    if !real.starts_with(root.canonicalize()?) || !real.is_file() {
        return Ok(None);
    }
    let mut bytes = Vec::new();
    File::open(real)?.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok(Some(bytes))
}

/// Entry name to character set.
pub(crate) fn manifest_charsets(manifest: &str) -> HashMap<String, String> {
    // Long lines are folded: a line that starts with a space goes on where the last one ended.
    let unfolded = manifest.replace("\r\n", "\n").replace('\r', "\n").replace("\n ", "");
    let mut charsets = HashMap::new();
    let mut name = None;
    for line in unfolded.lines() {
        if let Some(value) = line.strip_prefix("Name:") {
            name = Some(value.trim().to_owned());
        } else if let Some(value) = line.strip_prefix("Content-Type:") {
            let charset = value.split(';').find_map(|part| part.trim().strip_prefix("charset="));
            if let (Some(name), Some(charset)) = (name.take(), charset) {
                charsets.insert(name, charset.trim_matches('"').to_owned());
            }
        }
    }
    charsets
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charsets_are_found_in_folded_lines() {
        let manifest = "Manifest-Version: 1.0\r\n\r\nName: a very lo\r\n ng name.rgg\r\nContent-Type: \
                        text/x-grogra-rgg; charset=windows-1252\r\n\r\nName: graph.xml\r\nContent-Type: x/y\r\n";
        let charsets = manifest_charsets(manifest);
        assert_eq!(charsets.get("a very long name.rgg").map(String::as_str), Some("windows-1252"));
        assert_eq!(charsets.len(), 1);
    }

    #[test]
    fn names_stay_inside() {
        for inside in ["graph.xml", "a/b.png", "./a", "a/./b", "..a", "a..", "ä b/c:d"] {
            assert!(is_inside(inside), "{inside}");
        }
        for outside in ["../a", "a/../../b", "a/..", "/etc/passwd", "..", "a\\..\\b", "C:\\a", "a\0b"] {
            assert!(!is_inside(outside), "{outside:?}");
        }
    }
}
