//! Files that are complete or not there at all.

use std::fs::{File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes a file under a temporary name in the same directory and renames it when it is complete. After a
/// failure nothing new is there, and an older file of that name is as it was. A program that is killed leaves its
/// temporary file behind; the next one that writes in that directory removes it.
///
/// # Errors
/// What `fill` returns, or what the file system says.
pub fn write_whole_file(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> io::Result<()> {
    let temporary = temporary_beside(path)?;
    let mut writer = BufWriter::with_capacity(1 << 16, temporary.as_file());
    fill(&mut writer)?;
    writer.flush()?;
    drop(writer);
    // Otherwise a power failure could leave the new name with the old nothing in it.
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|error| error.error)?;
    // The new name is there for everybody; that it outlives a power failure is more than some systems can do.
    if cfg!(unix) {
        let _ = File::open(directory_of(path)).and_then(|directory| directory.sync_all());
    }
    Ok(())
}

/// Whether [`write_whole_file`] has a chance, to be asked before hours of work: the directory must be there and
/// take new files, and `path` must not be a directory itself.
///
/// # Errors
/// What is in the way.
pub fn check_writable(path: &Path) -> io::Result<()> {
    temporary_beside(path).map(drop)
}

fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    if path.file_name().is_none() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "this is not the name of a file"));
    }
    if path.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "there is a folder of that name"));
    }
    let directory = directory_of(path);
    remove_abandoned(directory);
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private as a rule; this one becomes an ordinary file.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    for _ in 0..ATTEMPTS {
        let temporary = builder.tempfile_in(directory).map_err(|error| plain_reason(directory, error))?;
        match temporary.as_file().try_lock() {
            // Somebody who looks for abandoned files was faster than the lock.
            Ok(()) if !temporary.path().exists() => {}
            Err(TryLockError::WouldBlock) => {}
            // Where files cannot be locked, nobody removes them.
            Ok(()) | Err(TryLockError::Error(_)) => return Ok(temporary),
        }
    }
    Err(io::Error::other("temporary files vanish as soon as they are made"))
}

/// Names of temporary files begin and end with these.
const PREFIX: &str = ".sunshine-";
const SUFFIX: &str = ".part";
/// It takes bad luck to lose a new file to somebody who cleans up; more than once is something else.
const ATTEMPTS: u32 = 16;

/// Removes temporary files whose program was killed. Those of a running one are locked, and the system takes locks
/// away when a program ends, however it ends.
fn remove_abandoned(directory: &Path) {
    let Ok(entries) = std::fs::read_dir(directory) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_ours = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        // A link of that name is none of ours.
        if !is_ours || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let path = entry.path();
        // Some network file systems lock only what is open for writing.
        if let Ok(file) = File::options().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            // Somebody else may have been faster.
            let _ = std::fs::remove_file(path);
        }
    }
}

fn directory_of(path: &Path) -> &Path {
    // The directory of a bare file name is the empty path.
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Nobody asked for the temporary file, so the common reasons are told without its name.
fn plain_reason(directory: &Path, error: io::Error) -> io::Error {
    let reason = match error.kind() {
        io::ErrorKind::NotFound => format!("there is no folder {}", directory.display()),
        io::ErrorKind::NotADirectory => format!("{} is not a folder", directory.display()),
        io::ErrorKind::PermissionDenied => {
            format!("no new files are allowed in the folder {}", directory.display())
        }
        _ => return error,
    };
    io::Error::new(error.kind(), reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(directory).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_failure_half_way_leaves_the_old_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("data");
        write_whole_file(&path, |file| file.write_all(b"old")).unwrap();
        let result = write_whole_file(&path, |file| {
            file.write_all(b"half of the ne")?;
            file.flush()?;
            Err(io::Error::other("disk full"))
        });
        assert_eq!(result.unwrap_err().to_string(), "disk full");
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(names(directory.path()), ["data"]);
    }

    #[test]
    fn checking_leaves_no_trace() {
        let directory = tempfile::tempdir().unwrap();
        check_writable(&directory.path().join("data")).unwrap();
        assert!(names(directory.path()).is_empty());
    }

    #[test]
    fn what_a_killed_program_left_is_removed_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        // Abandoned, in use, and names that are nearly those.
        for name in [".sunshine-gone.part", ".sunshine-busy.part", "sunshine-a.part", ".sunshine-a.film"] {
            std::fs::write(at(name), b"half").unwrap();
        }
        let busy = File::options().write(true).open(at(".sunshine-busy.part")).unwrap();
        busy.try_lock().unwrap();
        write_whole_file(&at("data"), |file| file.write_all(b"whole")).unwrap();
        let mut left = names(directory.path());
        left.sort();
        assert_eq!(left, [".sunshine-a.film", ".sunshine-busy.part", "data", "sunshine-a.part"]);
    }

    #[test]
    fn what_cannot_become_a_file_is_refused_at_once() {
        let directory = tempfile::tempdir().unwrap();
        assert_eq!(check_writable(directory.path()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        let missing = directory.path().join("missing").join("data");
        assert_eq!(check_writable(&missing).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert!(check_writable(Path::new("..")).is_err());
        assert!(check_writable(Path::new("")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_the_file_as_the_umask_allows() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().unwrap();
        let (ours, plain) = (directory.path().join("ours"), directory.path().join("plain"));
        write_whole_file(&ours, |file| file.write_all(b"x")).unwrap();
        std::fs::write(&plain, b"x").unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
