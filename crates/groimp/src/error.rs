use std::path::PathBuf;

/// Why a project could not be read.
///
/// Only what makes the whole file meaningless is an error; everything else is noted in the
/// [`Report`](crate::Report).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file system refused.
    #[error("cannot read {path}: {source}")]
    Io {
        /// What was to be read.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Neither a zip archive nor anything else that holds a project.
    #[error(
        "{path} is not a zip archive ({reason}); expected a .gsz archive, a project.gs file, a project directory \
         or a graph.xml file"
    )]
    NotAnArchive {
        /// The file.
        path: PathBuf,
        /// What the zip reader found.
        reason: String,
    },
    /// An entry of the archive cannot be unpacked.
    #[error("cannot unpack '{entry}' of {path}: {reason}; the archive is damaged or cut off")]
    BrokenEntry {
        /// The archive.
        path: PathBuf,
        /// Name of the entry.
        entry: String,
        /// What the zip reader found.
        reason: String,
    },
    /// Unpacked, an entry exceeds [`Limits`](crate::Limits).
    #[error("'{entry}' of {path} unpacks to more than {limit} bytes ({which}); --limit raises that")]
    TooLarge {
        /// The archive or directory.
        path: PathBuf,
        /// Name of the entry.
        entry: String,
        /// Which limit.
        which: &'static str,
        /// The limit in bytes.
        limit: u64,
    },
    /// A file that every project has is not there.
    #[error("{path} holds no '{entry}'; a GroIMP project has project.gs and the graph file that it names")]
    MissingEntry {
        /// The archive or directory.
        path: PathBuf,
        /// Name of the entry.
        entry: String,
    },
    /// The XML ends too early or is not well-formed.
    #[error("{file}:{line}: broken XML: {reason}")]
    Xml {
        /// File inside the project.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// What was found and what was expected.
        reason: String,
    },
    /// The file is well-formed XML, but not a graph or a registry.
    #[error("{file}:{line}: found {found}, expected {expected}")]
    Unexpected {
        /// File inside the project.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// What was found.
        found: String,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// A field does not hold what its class demands.
    #[error("{file}:{line}: field '{field}' of {owner} is '{found}', expected {expected}")]
    WrongValue {
        /// File inside the project.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// Class the field belongs to.
        owner: String,
        /// Name of the field.
        field: String,
        /// The text in the file.
        found: String,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// The graph file holds no scene.
    #[error("{file} has no root node named MainGraph, but {found}")]
    NoMainGraph {
        /// File inside the project.
        file: String,
        /// The roots that are there.
        found: String,
    },
}
