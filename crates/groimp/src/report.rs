//! What reading left out or could not make sense of.

use std::collections::HashMap;
use std::fmt;

/// Scene nodes that are not in the [`Scene`](scene::Scene), counted by type and reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// Type as in the file.
    pub type_name: String,
    /// How many.
    pub count: usize,
    /// Why.
    pub reason: String,
}

/// A place in one of the project's files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// File inside the project.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
}

/// Something that is wrong or uncertain in the project, but did not stop reading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What was found and what was made of it.
    pub message: String,
    /// Where it was found first.
    pub location: Option<Location>,
    /// How often it was found.
    pub count: usize,
}

/// What reading left out or could not make sense of; empty when the scene is complete.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// What is not drawn, in the order of first occurrence.
    pub skipped: Vec<Skipped>,
    /// What is wrong or uncertain, in the order of first occurrence.
    pub warnings: Vec<Warning>,
    skipped_index: HashMap<(String, String), usize>,
    warning_index: HashMap<String, usize>,
}

impl Report {
    /// Whether nothing was left out and nothing was odd.
    pub fn is_empty(&self) -> bool {
        self.skipped.is_empty() && self.warnings.is_empty()
    }

    pub(crate) fn skip(&mut self, type_name: &str, reason: impl Into<String>) {
        let reason = reason.into();
        let next = self.skipped.len();
        let index = *self.skipped_index.entry((type_name.to_owned(), reason.clone())).or_insert(next);
        if index == next {
            self.skipped.push(Skipped { type_name: type_name.to_owned(), count: 0, reason });
        }
        self.skipped[index].count += 1;
    }

    pub(crate) fn warn(&mut self, message: impl Into<String>, location: Option<Location>) {
        let message = message.into();
        let next = self.warnings.len();
        let index = *self.warning_index.entry(message.clone()).or_insert(next);
        if index == next {
            self.warnings.push(Warning { message, location, count: 0 });
        }
        self.warnings[index].count += 1;
    }
}

impl fmt::Display for Skipped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} x {}: {}", self.count, self.type_name, self.reason)
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.line)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(location) = &self.location {
            write!(f, "{location}: ")?;
        }
        f.write_str(&self.message)?;
        if self.count > 1 {
            write!(f, " ({} times)", self.count)?;
        }
        Ok(())
    }
}

impl fmt::Display for Report {
    /// One line per entry.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for skipped in &self.skipped {
            writeln!(f, "skipped: {skipped}")?;
        }
        for warning in &self.warnings {
            writeln!(f, "warning: {warning}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_entries_are_counted_together() {
        let mut report = Report::default();
        assert!(report.is_empty());
        report.skip("a.B", "later");
        report.skip("a.B", "later");
        report.skip("a.B", "never");
        report.warn("odd", Some(Location { file: "graph.xml".into(), line: 7 }));
        report.warn("odd", Some(Location { file: "graph.xml".into(), line: 9 }));
        assert_eq!(
            report.to_string(),
            "skipped: 2 x a.B: later\nskipped: 1 x a.B: never\nwarning: graph.xml:7: odd (2 times)\n"
        );
    }
}
