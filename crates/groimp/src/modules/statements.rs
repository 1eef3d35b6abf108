//! Runs the statements of initialisers, with-blocks and constructors as far as they need no running model.

use super::declarations::File;
use super::instances::{Instance, Level};
use super::values::{Failure, Value, property_of_setter, set_property};
use std::ops::Range;

/// What an instance is made for, and which code is being run on it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    /// The object that files compare with: what files always contain need not be known.
    Representative,
    /// A node of a body is constructed; all of it has to be known.
    Fresh,
    /// The with-block of a node of a body: the variables are those of the body, all else is the node's.
    With,
    /// A block in braces behind a node of a body, which may assign to variables of the body as well.
    Braces,
    /// A block of the body on its own.
    Block,
}

impl<'a> Instance<'a> {
    /// Runs the statements in a range. The blocks in it are run like their surroundings.
    pub fn run(&mut self, level: &Level<'a>, range: Range<usize>, separators: &[&str]) {
        const CONTROL: [&str; 14] = [
            "if",
            "for",
            "while",
            "do",
            "switch",
            "try",
            "return",
            "throw",
            "synchronized",
            "break",
            "continue",
            "else",
            "catch",
            "finally",
        ];
        let file = self.file(level);
        let mut at = range.start;
        while at < range.end {
            if !self.meter.spend(1) {
                return self.note(level, at, "the declarations are too involved to be evaluated");
            }
            if file.is(at, "{") || separators.iter().any(|s| file.is(at, s)) {
                at += 1;
            } else if file.word(at).is_some_and(|word| CONTROL.contains(&word)) {
                let word = file.word(at).unwrap_or_default();
                self.note(level, at, &format!("a statement with '{word}' is not evaluated"));
                at = after_control(file, at, range.end);
            } else {
                let end = file.find(at + 1, range.end, separators);
                let end = if file.is_open(at) { file.after(at).min(range.end) } else { end };
                self.statement(level, at..end);
                at = end.max(at + 1);
            }
        }
    }

    fn statement(&mut self, level: &Level<'a>, range: Range<usize>) {
        let file = self.file(level);
        let Range { mut start, end } = range;
        let node = |word: &str| matches!(word, "this" | "super") || self.label == Some(word);
        while file.word(start).is_some_and(node) && file.is(start + 1, ".") {
            start += 2;
        }
        let word = file.word(start).unwrap_or_default();
        let call = |at: usize| at < end && file.is(at, "(") && file.after(at) == end;
        if word.is_empty() {
            return self.note(level, start, "this statement is not evaluated");
        }
        if call(start + 1) {
            return self.call(level, word, start);
        }
        if file.is(start + 1, "=") {
            return self.assignment(level, word, start + 2..end);
        }
        // The notation for properties.
        if word == "this" && file.is(start + 1, "[") && file.is(start + 3, "]") && file.is(start + 4, "=") {
            let name = file.word(start + 2).unwrap_or_default();
            return self.assignment(level, name, start + 5..end);
        }
        if file.is(start + 1, ".") && call(start + 3) && self.variables.contains_key(word) {
            return self.call_of_variable(level, word, start);
        }
        let from = if matches!(word, "final" | "const") { start + 1 } else { start };
        if let Some((kind, at)) = file.type_name(from)
            && let Some(name) = file.word(at).filter(|_| at < end)
            && (at + 1 == end || file.is(at + 1, "="))
        {
            let value = self.scope(level, &self.variables).evaluate(at + 2..end.max(at + 2));
            self.variables.insert(name.to_owned(), value.map_or(Value::Unknown, |v| v.converted(&kind)));
            return;
        }
        self.note(level, start, &format!("the statement with '{word}' is not evaluated"));
    }

    fn assignment(&mut self, level: &Level<'a>, name: &str, range: Range<usize>) {
        let start = range.start;
        match self.scope(level, &self.variables).evaluate(range) {
            Ok(value) => self.assign(name, value),
            Err(failure) => self.note_value(level, start, &format!("'{name}'"), &failure),
        }
    }

    fn call(&mut self, level: &Level<'a>, method: &str, at: usize) {
        if self.methods.contains(method) {
            return self.note(level, at, &format!("the method '{method}' is not evaluated"));
        }
        // Constructors are followed elsewhere.
        if matches!(method, "super" | "this" | "print" | "println") {
            return;
        }
        let Some(property) = property_of_setter(method) else {
            return self.note(level, at, &format!("the call of '{method}' is not evaluated"));
        };
        // A rotation becomes a fresh object in `transform`, which files always contain.
        if property == "name" || (property == "rotation" && self.mode == Mode::Representative) {
            return;
        }
        // A body has no effect on its own node, which is drawn already.
        if self.mode == Mode::Block {
            return self.note(level, at, &format!("the call of '{method}' is not evaluated"));
        }
        let range = self.file(level).inside(at + 1);
        let mut values = Vec::new();
        for (range, value) in self.scope(level, &self.variables).arguments(range) {
            match value {
                Ok(value) => values.push(value),
                Err(failure) => {
                    return self.note_value(level, range.start, &format!("'{property}'"), &failure);
                }
            }
        }
        if !self.set(&property, values) {
            self.note(level, at, &format!("the call of '{method}' is not understood"));
        }
    }

    /// `variable.setName(value)` for a shader in a local variable.
    fn call_of_variable(&mut self, level: &Level<'a>, variable: &str, at: usize) {
        let file = self.file(level);
        let method = file.word(at + 2).unwrap_or_default();
        let mut object = self.variables.insert(variable.to_owned(), Value::Unknown).unwrap_or(Value::Unknown);
        let argument = self.scope(level, &self.variables).evaluate(file.inside(at + 3));
        let property = property_of_setter(method);
        let set = |property: String| argument.and_then(|value| set_property(&mut object, &property, value));
        let done = property.map_or(Err(Failure::Unknown(format!("'{method}' is not evaluated"))), set);
        if let Err(failure) = done {
            self.note_value(level, at, &format!("'{variable}'"), &failure);
        }
        self.variables.insert(variable.to_owned(), object);
    }
}

/// The index behind a control statement; an `else` or `catch` belongs to it.
fn after_control(file: &File, at: usize, end: usize) -> usize {
    let mut at = at;
    loop {
        at = file.find(at + 1, end, &["{", ";", "}"]);
        let block = file.is(at, "{");
        if at < end && (block || file.is(at, ";")) {
            at = if block { file.after(at) } else { at + 1 };
            let more = file.word(at).filter(|_| at < end);
            if more.is_some_and(|w| matches!(w, "else" | "catch" | "finally") || (block && w == "while")) {
                continue;
            }
        }
        return at.min(end);
    }
}
