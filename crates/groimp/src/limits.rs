//! How much a project may make the reader do.

/// How much a project may become in memory, so that a few kilobytes of input cannot fill it. `docs/limits.md` lists
/// them for users.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one file.
    pub entry_bytes: u64,
    /// Bytes of all files that are read.
    pub total_bytes: u64,
    /// Bytes of all model sources; those beyond are left out, with a warning. Once it is split into tokens, a source
    /// takes some fifty times as much memory.
    pub source_bytes: usize,
    /// Nodes of the graph file.
    pub graph_nodes: usize,
    /// Values of the fields of nodes. A byte of inline syntax can make one, which is a hundred times as large; in XML
    /// a value takes more than 32 bytes.
    pub graph_values: usize,
    /// Pixels of one image; a larger one is replaced by grey, with a warning.
    pub image_pixels: u64,
    /// Pixels of all images; those beyond are replaced by grey, with a warning.
    pub total_image_pixels: u64,
    /// Triangles of one curved surface; it is drawn coarser, or not at all, if that is not enough.
    pub surface_triangles: u64,
    /// Triangles of all curved surfaces; those beyond are not drawn.
    pub total_surface_triangles: u64,
    /// Nodes that all bodies of modules together may make; further ones are left out, with a warning.
    pub body_nodes: usize,
    /// Steps of evaluation that all bodies of modules together may take. A step is about one operand or statement.
    pub body_steps: usize,
    /// Nodes that the masters of instances may have in all their uses; further ones are left out, with a warning.
    pub group_nodes: usize,
    /// Instances, the cells of grids included; further ones are left out, with a warning.
    pub instances: usize,
}

impl Default for Limits {
    /// Far beyond what sensible projects need, within what a small computer can hold.
    fn default() -> Self {
        Limits {
            entry_bytes: 512 << 20,
            total_bytes: 2 << 30,
            source_bytes: 16 << 20,
            graph_nodes: 16 << 20,
            graph_values: 16 << 20,
            image_pixels: 64 << 20,
            total_image_pixels: 512 << 20,
            surface_triangles: 2 << 20,
            total_surface_triangles: 16 << 20,
            body_nodes: 1_000_000,
            body_steps: 50_000_000,
            group_nodes: 50_000_000,
            instances: 8 << 20,
        }
    }
}

/// A limit that can be set by its name.
enum Place<'a> {
    Wide(&'a mut u64),
    Count(&'a mut usize),
}

impl Limits {
    /// All limits: what users call them, and their values.
    pub fn list(&self) -> Vec<(&'static str, u64)> {
        let mut copy = *self;
        let value = |place: Place<'_>| match place {
            Place::Wide(value) => *value,
            Place::Count(value) => *value as u64,
        };
        copy.places().into_iter().map(|(name, place)| (name, value(place))).collect()
    }

    /// Sets the limit of a name; false if there is none of that name.
    pub fn set(&mut self, name: &str, value: u64) -> bool {
        match self.places().into_iter().find(|(known, _)| *known == name) {
            Some((_, Place::Wide(place))) => *place = value,
            Some((_, Place::Count(place))) => *place = usize::try_from(value).unwrap_or(usize::MAX),
            None => return false,
        }
        true
    }

    fn places(&mut self) -> [(&'static str, Place<'_>); 13] {
        let Limits {
            entry_bytes,
            total_bytes,
            source_bytes,
            graph_nodes,
            graph_values,
            image_pixels,
            total_image_pixels,
            surface_triangles,
            total_surface_triangles,
            body_nodes,
            body_steps,
            group_nodes,
            instances,
        } = self;
        [
            ("file-bytes", Place::Wide(entry_bytes)),
            ("total-bytes", Place::Wide(total_bytes)),
            ("source-bytes", Place::Count(source_bytes)),
            ("graph-nodes", Place::Count(graph_nodes)),
            ("graph-values", Place::Count(graph_values)),
            ("image-pixels", Place::Wide(image_pixels)),
            ("total-image-pixels", Place::Wide(total_image_pixels)),
            ("surface-triangles", Place::Wide(surface_triangles)),
            ("total-surface-triangles", Place::Wide(total_surface_triangles)),
            ("body-nodes", Place::Count(body_nodes)),
            ("body-steps", Place::Count(body_steps)),
            ("group-nodes", Place::Count(group_nodes)),
            ("instances", Place::Count(instances)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_limit_can_be_set_and_is_documented_with_its_value() {
        let page = include_str!("../../../docs/limits.md");
        let defaults = Limits::default();
        for (name, value) in defaults.list() {
            let row = page.lines().find(|line| line.starts_with(&format!("| `{name}` |")));
            let row = row.unwrap_or_else(|| panic!("{name} is not in docs/limits.md"));
            assert!(row.contains(&format!("| {value} |")), "{name} is {value}: {row}");
            let mut changed = defaults;
            assert!(changed.set(name, value + 1));
            assert_ne!(changed, defaults);
            assert!(changed.list().contains(&(name, value + 1)));
        }
        assert!(!Limits::default().set("everything", 1));
    }
}
