use crate::Report;
use scene::{Origin, Scene, TypeNameId};
use std::collections::HashMap;

/// What reading produces, step by step.
#[derive(Default)]
pub(crate) struct Output {
    pub scene: Scene,
    pub report: Report,
    type_names: HashMap<String, TypeNameId>,
}

impl Output {
    pub fn with_report(report: Report) -> Self {
        Output { report, ..Output::default() }
    }

    /// The origin of what a node of the file becomes.
    pub fn origin(&mut self, node: i64, type_name: &str) -> Origin {
        if let Some(type_name) = self.type_names.get(type_name) {
            return Origin { node, type_name: *type_name };
        }
        // Fewer types than nodes, and these are fewer than 2^32.
        let id = TypeNameId(u32::try_from(self.scene.type_names.len()).unwrap_or(u32::MAX));
        self.scene.type_names.push(type_name.to_owned());
        self.type_names.insert(type_name.to_owned(), id);
        Origin { node, type_name: id }
    }
}
