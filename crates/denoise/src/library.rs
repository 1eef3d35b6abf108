//! Where the library is.

use crate::DenoiseError;
use crate::interface::Functions;
use libloading::Library;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// What its file is called, the likeliest first.
const NAMES: &[&str] = if cfg!(windows) {
    &["OpenImageDenoise.dll"]
} else if cfg!(target_os = "macos") {
    &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"]
} else {
    &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"]
};

/// Loads the library from a file or folder, or from where the system has its libraries.
pub(crate) fn load(place: Option<&OsStr>) -> Result<Functions, DenoiseError> {
    let mut tried = Vec::new();
    for path in candidates(place) {
        // SAFETY: loading runs the library's initialisers. What has this name, or was named by the user, is taken for
        // Open Image Denoise, whose initialisers have no conditions; nothing guards against another library that
        // pretends to be it.
        match unsafe { Library::new(&path) } {
            Ok(library) => return Functions::of(library, &path),
            Err(error) => tried.push(reason(&path, &error)),
        }
    }
    Err(DenoiseError::NotFound { tried })
}

fn candidates(place: Option<&OsStr>) -> Vec<PathBuf> {
    let Some(place) = place.filter(|place| !place.is_empty()).map(Path::new) else {
        return NAMES.iter().map(PathBuf::from).collect();
    };
    if place.is_dir() {
        return NAMES.iter().map(|name| place.join(name)).collect();
    }
    // A name without a folder would be looked for in the system's folders, not where the user is.
    let here = place.parent().is_some_and(|parent| parent.as_os_str().is_empty());
    vec![if here { Path::new(".").join(place) } else { place.to_owned() }]
}

fn reason(path: &Path, error: &libloading::Error) -> String {
    let (path, error) = (path.display().to_string(), error.to_string());
    // Most systems name the file themselves.
    if error.contains(&path) { error } else { format!("{path}: {error}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_found_is_named_with_a_way_out() {
        let missing = std::env::temp_dir().join("no such folder of denoisers");
        let error = load(Some(missing.as_os_str())).err().unwrap().to_string();
        for part in
            ["no such folder of denoisers", "openimagedenoise.org", "SUNSHINE_OIDN", "Open Image Denoise"]
        {
            assert!(error.contains(part), "no {part:?} in {error}");
        }
        // A folder without it: all names are tried.
        let empty = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let error = load(Some(empty.as_os_str())).err().unwrap().to_string();
        assert!(NAMES.iter().all(|name| error.contains(name)), "{error}");
    }

    #[test]
    fn a_file_that_is_no_library_is_an_error() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        let error = load(Some(file.as_os_str())).err().unwrap();
        assert!(matches!(error, DenoiseError::NotFound { .. }));
        assert!(error.to_string().contains("Cargo.toml"), "{error}");
    }

    #[test]
    fn places_become_files() {
        assert_eq!(candidates(None).len(), NAMES.len());
        assert_eq!(candidates(Some(OsStr::new(""))), candidates(None));
        assert_eq!(candidates(Some(OsStr::new("oidn.so"))), [Path::new("./oidn.so")]);
        assert_eq!(candidates(Some(OsStr::new("/opt/oidn.so"))), [Path::new("/opt/oidn.so")]);
    }
}
