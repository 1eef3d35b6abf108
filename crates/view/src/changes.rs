//! Notices that a project was saved again.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// What a project's files look like from outside: their names, sizes and times.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fingerprint(Vec<(PathBuf, u64, Option<SystemTime>)>);

/// Most files of an unpacked project that are looked at.
const MOST_FILES: usize = 4096;
/// Deepest folder in an unpacked project that is looked into.
const DEEPEST: usize = 4;

impl Fingerprint {
    /// Looks at a project's archive, or at all files of its folder.
    pub fn of(project: &Path) -> Self {
        let is_part = ["project.gs", "graph.xml"].iter().any(|part| project.ends_with(part));
        let folder = match (project.is_dir(), is_part, project.parent()) {
            (true, _, _) => Some(project),
            // The folder of a bare file name is the empty path.
            (false, true, Some(parent)) if parent.as_os_str().is_empty() => Some(Path::new(".")),
            (false, true, parent) => parent,
            (false, false, _) => None,
        };
        let mut files = Vec::new();
        let mut folders: Vec<(PathBuf, usize)> =
            folder.map(|path| (path.to_owned(), 0)).into_iter().collect();
        if folder.is_none() {
            files.push(project.to_owned());
        }
        while let Some((folder, depth)) = folders.pop() {
            let Ok(entries) = std::fs::read_dir(&folder) else { continue };
            for entry in entries.flatten().take(MOST_FILES.saturating_sub(files.len())) {
                match entry.file_type() {
                    Ok(kind) if kind.is_dir() && depth < DEEPEST => folders.push((entry.path(), depth + 1)),
                    Ok(kind) if !kind.is_dir() => files.push(entry.path()),
                    _ => {}
                }
            }
        }
        files.sort();
        let describe = |path: PathBuf| {
            let metadata = std::fs::metadata(&path).ok()?;
            Some((path, metadata.len(), metadata.modified().ok()))
        };
        Fingerprint(files.into_iter().filter_map(describe).collect())
    }
}

/// How long a project must stay as it is before it is read: whoever saves it may not be done.
const SETTLED: Duration = Duration::from_millis(300);

/// Decides when a project is read again.
#[derive(Clone, Debug)]
pub struct Changes {
    /// What was read last, whether it was good or not.
    read: Fingerprint,
    /// What was seen last, and since when.
    seen: Option<(Fingerprint, Duration)>,
}

impl Changes {
    /// Begins with what is read now.
    pub fn new(read: Fingerprint) -> Self {
        Changes { read, seen: None }
    }

    /// Takes a look at a time since some beginning; `true` if the project is to be read now. A project that is gone
    /// is on its way to be written anew.
    pub fn look(&mut self, now: Duration, found: Fingerprint) -> bool {
        if found == self.read || found.0.is_empty() {
            self.seen = None;
            return false;
        }
        match &self.seen {
            Some((seen, since)) if *seen == found => {
                if now.saturating_sub(*since) < SETTLED {
                    return false;
                }
                self.read = found;
                self.seen = None;
                true
            }
            _ => {
                self.seen = Some((found, now));
                false
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn print(size: u64) -> Fingerprint {
        Fingerprint(vec![("a".into(), size, None)])
    }

    #[test]
    fn a_project_is_read_once_it_has_settled() {
        let ms = Duration::from_millis;
        let mut changes = Changes::new(print(1));
        assert!(!changes.look(ms(0), print(1)));
        assert!(!changes.look(ms(500), print(2)));
        // Still being written.
        assert!(!changes.look(ms(1000), print(3)));
        assert!(!changes.look(ms(1100), print(3)));
        assert!(changes.look(ms(1400), print(3)));
        assert!(!changes.look(ms(2000), print(3)));
    }

    #[test]
    fn a_project_that_is_replaced_is_waited_for() {
        let ms = Duration::from_millis;
        let mut changes = Changes::new(print(1));
        for time in [0, 500, 1000] {
            assert!(!changes.look(ms(time), Fingerprint::default()));
        }
        assert!(!changes.look(ms(1500), print(2)));
        assert!(changes.look(ms(2000), print(2)));
        // Back to what was read: nothing to do.
        assert!(!changes.look(ms(2500), print(3)));
        assert!(!changes.look(ms(3000), print(2)));
        assert!(!changes.look(ms(3500), print(3)));
        assert!(changes.look(ms(4000), print(3)));
    }

    #[test]
    fn fingerprints_tell_changes_in_archives_and_folders() {
        let directory = tempfile::tempdir().unwrap();
        let archive = directory.path().join("a.gsz");
        std::fs::write(&archive, "1").unwrap();
        let before = Fingerprint::of(&archive);
        assert_eq!(before, Fingerprint::of(&archive));
        std::fs::write(&archive, "12").unwrap();
        assert_ne!(before, Fingerprint::of(&archive));
        assert_eq!(Fingerprint::of(&directory.path().join("missing.gsz")), Fingerprint::default());

        let project = directory.path().join("oak");
        std::fs::create_dir_all(project.join("images")).unwrap();
        std::fs::write(project.join("project.gs"), "").unwrap();
        let before = [Fingerprint::of(&project), Fingerprint::of(&project.join("project.gs"))];
        std::fs::write(project.join("images/leaf.png"), "x").unwrap();
        assert!(
            before[0] != Fingerprint::of(&project)
                && before[1] != Fingerprint::of(&project.join("project.gs"))
        );
    }
}
