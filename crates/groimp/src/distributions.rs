//! LightDistribution: tables of intensities, in the graph or in a photometric file of the project.
//!
//! How GroIMP writes them is unverified, so several forms are accepted.

use crate::ReadError;
use crate::ies;
use crate::inline::registry_path;
use crate::object_fields::ObjectFields;
use crate::output::Output;
use crate::shaders::Shaders;
use crate::values::{Kind, Members, Value, Values, parse_number, tokens};
use scene::Distribution;
use std::collections::HashMap;
use std::sync::Arc;

/// Entries of a table; more are no measurement.
const MOST_ENTRIES: usize = 1 << 22;

/// All distributions that came from files, each read once.
#[derive(Default)]
pub(crate) struct Distributions {
    by_file: HashMap<String, Option<Arc<Distribution>>>,
}

impl Distributions {
    /// The distribution of a PhysicalLight; `None`, with a warning if it names one, means: isotropic.
    pub fn of_light(
        &mut self,
        light: &ObjectFields<'_>,
        line: usize,
        shaders: &mut Shaders<'_>,
        out: &mut Output,
    ) -> Result<Option<Arc<Distribution>>, ReadError> {
        let Some(value) = light.find("distribution").filter(|value| value.kind != Kind::Null) else {
            return Ok(None);
        };
        let path = if value.kind == Kind::Shared { registry_path(value.text()) } else { None };
        if let Some(file) = path.as_deref().and_then(|path| shaders.file_of(path)) {
            return self.of_file(&file, line, light, shaders, out);
        }
        let found = shaders.references.follow(value);
        let members = found.map_or(value.members, |found| found.members);
        // A distribution may name its file itself.
        let named = light
            .graph
            .values
            .iter(members)
            .find_map(|member| registry_path(member.text()).and_then(|path| shaders.file_of(&path)));
        if let Some(file) = named {
            return self.of_file(&file, line, light, shaders, out);
        }
        let table = table(&ObjectFields { members, ..*light })?;
        if table.is_none() {
            let message = "the distribution of a PhysicalLight holds no table of numbers that fits its size; it \
                           shines equally in all directions";
            out.report.warn(message, light.graph.location(line));
        }
        Ok(table.map(Arc::new))
    }

    fn of_file(
        &mut self,
        file: &str,
        line: usize,
        light: &ObjectFields<'_>,
        shaders: &mut Shaders<'_>,
        out: &mut Output,
    ) -> Result<Option<Arc<Distribution>>, ReadError> {
        if let Some(known) = self.by_file.get(file) {
            return Ok(known.clone());
        }
        let parsed = match shaders.read_file(file) {
            Ok(Some(bytes)) => {
                ies::parse(&String::from_utf8_lossy(&bytes)).map_err(|error| error.to_string())
            }
            Ok(None) => Err("it is not in the project".to_owned()),
            Err(error @ ReadError::TooLarge { .. }) => return Err(error),
            Err(error) => Err(error.to_string()),
        };
        let distribution = match parsed {
            Ok(distribution) => Some(Arc::new(distribution)),
            Err(reason) => {
                let message = format!(
                    "the light distribution '{file}' cannot be used: {reason}; its lights shine equally in all \
                     directions"
                );
                out.report.warn(message, light.graph.location(line));
                None
            }
        };
        self.by_file.insert(file.to_owned(), distribution.clone());
        Ok(distribution)
    }
}

/// A table from the fields `width`, `height` and any list of as many numbers.
fn table(object: &ObjectFields<'_>) -> Result<Option<Distribution>, ReadError> {
    let (width, height) = (object.number("width", 0.0)?, object.number("height", 0.0)?);
    let valid = |n: f64| (1.0..=65535.0).contains(&n) && n.fract() == 0.0;
    if !valid(width) || !valid(height) {
        return Ok(None);
    }
    let (width, height) = (width as usize, height as usize);
    if width * height > MOST_ENTRIES {
        return Ok(None);
    }
    let values = &object.graph.values;
    let lists = values.iter(object.members).map(|member| numbers_in(values, member, width * height));
    let list = lists.into_iter().flatten().find(|list| list.len() == width * height);
    Ok(list.and_then(|list| Distribution::new(width, height, &list)))
}

/// All numbers in a value and in what it contains, in order; `None` if there are more than `most` or something else
/// is among them.
fn numbers_in(values: &Values, value: &Value, most: usize) -> Option<Vec<f64>> {
    if value.name.is_some_and(|name| matches!(values.name(name), "width" | "height")) {
        return None;
    }
    let mut numbers = Vec::new();
    let mut open = vec![value];
    while let Some(value) = open.pop() {
        for word in tokens(value.text()) {
            numbers.push(parse_number(word)?);
        }
        if numbers.len() > most {
            return None;
        }
        let members: Members = value.members;
        let start = open.len();
        open.extend(values.iter(members));
        open[start..].reverse();
    }
    Some(numbers)
}
