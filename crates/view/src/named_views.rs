//! Views that the user wants to come back to, in a small file beside the project.

use crate::sight_line::{Extent, SightLine};
use render::write_whole_file;
use scene::DVec3;
use serde::{Deserialize, Serialize};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// A view with a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedView {
    /// What the user calls it.
    pub name: String,
    /// Where the camera stands, in metres, as `--camera-position`.
    position: [f64; 3],
    /// What it looks at, as `--camera-target`.
    target: [f64; 3],
    /// What is upwards, as `--camera-up`.
    up: [f64; 3],
    /// Opening angle in degrees, as `--fov`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fov: Option<f64>,
    /// Width of the picture in metres in parallel projection, as `--parallel`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    parallel: Option<f64>,
    /// Radius of the lens in metres, as `--aperture`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    aperture: Option<f64>,
    /// Distance in focus in metres, as `--focus`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    focus: Option<f64>,
}

/// The list in the file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NamedViews {
    /// In the order of the number keys.
    pub views: Vec<NamedView>,
}

/// Largest file that is read.
const MOST_BYTES: u64 = 1 << 20;
/// Most views.
const MOST_VIEWS: usize = 1000;

impl NamedView {
    /// A view with a name.
    pub fn new(name: String, line: &SightLine) -> Self {
        let (fov, parallel) = match line.extent {
            Extent::Degrees(degrees) => (Some(degrees), None),
            Extent::Metres(width) => (None, Some(width)),
        };
        NamedView {
            name,
            position: line.eye.to_array(),
            target: line.middle.to_array(),
            up: line.up.to_array(),
            fov,
            parallel,
            aperture: line.lens.map(|(radius, _)| radius),
            focus: line.lens.and_then(|(_, focus)| focus),
        }
    }

    /// The camera; what the view does not say is taken from the one that is there. `None` if its numbers make no view.
    pub fn line(&self, now: &SightLine) -> Option<SightLine> {
        let extent = match (self.parallel, self.fov) {
            (Some(width), _) => Extent::Metres(width),
            (None, Some(degrees)) => Extent::Degrees(degrees),
            (None, None) => now.extent,
        };
        let usable_extent = match extent {
            Extent::Degrees(degrees) => (0.001..=179.0).contains(&degrees),
            Extent::Metres(width) => (1e-9..=1e9).contains(&width),
        };
        let length = |length: f64| (1e-9..=1e9).contains(&length);
        let usable_lens = self.aperture.is_none_or(length) && self.focus.is_none_or(length);
        let [eye, middle, up] = [self.position, self.target, self.up].map(DVec3::from);
        let points = [eye, middle, up].into_iter().all(|p| p.is_finite() && p.abs().max_element() <= 1e9);
        let turned = (middle - eye).normalize_or_zero().cross(up.normalize_or_zero()).length() > 1e-6;
        let lens = self.aperture.map(|radius| (radius, self.focus));
        (points && turned && usable_extent && usable_lens).then_some(SightLine {
            eye,
            middle,
            up,
            extent,
            lens,
            ..*now
        })
    }
}

impl NamedViews {
    /// The file for a project: `plant.views.json` beside `plant.gsz`, or beside the folder of an unpacked project.
    /// GroIMP's own files are never written to.
    pub fn path(project: &Path) -> PathBuf {
        let is_part = ["project.gs", "graph.xml"].iter().any(|part| project.ends_with(part));
        let whole = match project.canonicalize() {
            Ok(path) if is_part => path.parent().map_or(path.clone(), Path::to_owned),
            Ok(path) => path,
            Err(_) => project.to_owned(),
        };
        let name = match whole.is_dir() {
            true => whole.file_name(),
            false => whole.file_stem(),
        };
        let mut name = name.unwrap_or("scene".as_ref()).to_owned();
        name.push(".views.json");
        whole.with_file_name(name)
    }

    /// Reads the file; an empty list if there is none.
    ///
    /// # Errors
    /// If it cannot be read or holds something else, in words.
    pub fn read(path: &Path) -> Result<Self, String> {
        let wrong = |reason: String| format!("the views in {} cannot be read: {reason}", path.display());
        let file = match std::fs::File::open(path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(error) => return Err(wrong(error.to_string())),
        };
        let mut text = String::new();
        file.take(MOST_BYTES).read_to_string(&mut text).map_err(|error| wrong(error.to_string()))?;
        let mut list: Self = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        list.views.truncate(MOST_VIEWS);
        Ok(list)
    }

    /// Writes the file; an older one stays if that fails.
    ///
    /// # Errors
    /// In words.
    pub fn write(&self, path: &Path) -> Result<(), String> {
        let wrong = |reason: String| format!("the views cannot be saved in {}: {reason}", path.display());
        let text = serde_json::to_string_pretty(self).map_err(|error| wrong(error.to_string()))?;
        write_whole_file(path, |file| file.write_all(text.as_bytes()))
            .map_err(|error| wrong(error.to_string()))
    }

    /// Puts a view at a place counted from 0, in exchange for the one there, or behind the last one. Returns its name.
    pub fn put(&mut self, place: usize, line: &SightLine) -> Option<&str> {
        let place = place.min(self.views.len());
        if place >= MOST_VIEWS {
            return None;
        }
        match self.views.get_mut(place) {
            Some(view) => *view = NamedView::new(std::mem::take(&mut view.name), line),
            None => self.views.push(NamedView::new(format!("view {}", place + 1), line)),
        }
        self.views.get(place).map(|view| view.name.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Camera;

    fn line() -> SightLine {
        SightLine::of(&Camera::default(), None)
    }

    #[test]
    fn views_are_read_back_as_they_were() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("plant.views.json");
        assert_eq!(NamedViews::read(&path), Ok(NamedViews::default()));
        let mut views = NamedViews::default();
        assert_eq!(views.put(0, &line()), Some("view 1"));
        let second =
            SightLine { lens: Some((0.1, None)), extent: Extent::Metres(3.0), ..line().orbited(0.4, 0.1) };
        assert_eq!(views.put(7, &second), Some("view 2"));
        views.views[0].name = "from above".to_owned();
        views.write(&path).unwrap();
        let read = NamedViews::read(&path).unwrap();
        assert_eq!(read, views);
        assert_eq!(read.views[0].line(&second).unwrap().eye, line().eye);
        assert_eq!(read.views[1].line(&line()), Some(second));
        // A view in its place keeps its name.
        assert_eq!(views.put(0, &second), Some("from above"));
    }

    #[test]
    fn broken_files_and_impossible_views_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("plant.views.json");
        std::fs::write(&path, "{\"views\": [{\"name\": 3}]}").unwrap();
        assert!(NamedViews::read(&path).unwrap_err().contains("plant.views.json"));
        let view = |position: [f64; 3], fov: f64| NamedView {
            position,
            fov: Some(fov),
            ..NamedView::new("a".to_owned(), &line())
        };
        let target = line().middle.to_array();
        assert!(view([1.0, 2.0, 3.0], 40.0).line(&line()).is_some());
        for wrong in [
            view(target, 40.0),
            view([f64::NAN; 3], 40.0),
            view([1e300, 0.0, 0.0], 40.0),
            view([1.0; 3], 200.0),
        ] {
            assert_eq!(wrong.line(&line()), None, "{wrong:?}");
        }
    }

    #[test]
    fn the_file_lies_beside_the_project_never_in_it() {
        let directory = tempfile::tempdir().unwrap();
        let root = directory.path().canonicalize().unwrap();
        let project = root.join("oak.v1");
        std::fs::create_dir(&project).unwrap();
        std::fs::write(project.join("project.gs"), "").unwrap();
        for given in [project.clone(), project.join("project.gs")] {
            assert_eq!(NamedViews::path(&given), root.join("oak.v1.views.json"));
        }
        let archive = root.join("oak.v2.gsz");
        std::fs::write(&archive, "").unwrap();
        assert_eq!(NamedViews::path(&archive), root.join("oak.v2.views.json"));
    }
}
