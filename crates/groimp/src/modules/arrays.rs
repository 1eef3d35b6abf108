//! Arrays: `{1, 2, 3}`, `new float[] {1, 2}`, `new float[4]`, and `name[index]`.

use super::expressions::{Parser, Scope};
use super::values::{Evaluated, Value, unknown};
use std::ops::Range;

/// Elements of an array at most.
const MOST_ELEMENTS: f64 = 100_000.0;

impl Parser<'_> {
    /// `{a, b, ...}` at the current place.
    pub(super) fn array_literal(&mut self) -> Evaluated {
        let inside = self.file.inside(self.at);
        self.at = self.file.after(self.at);
        let scope = self.scope;
        scope.deeper(|| elements(scope, inside))
    }

    /// What follows the element type of `new float[...]`; the type is given by its name.
    pub(super) fn new_array(&mut self, kind: &str) -> Evaluated {
        let mut length = None;
        while self.is("[") {
            let inside = self.file.inside(self.at);
            self.at = self.file.after(self.at);
            if inside.is_empty() {
                continue;
            }
            if length.is_some() {
                return unknown("an array of arrays is not made here");
            }
            length = Some(self.scope.evaluate(inside)?);
        }
        match length {
            None if self.is("{") => self.array_literal(),
            Some(Value::Number { value, integer: true }) if (0.0..=MOST_ELEMENTS).contains(&value) => {
                self.scope.spend(value as usize)?;
                Ok(Value::Array(vec![Value::initial(kind); value as usize].into()))
            }
            _ => unknown("the length of an array is not known"),
        }
    }

    /// `array[index]` for a value before the current place.
    pub(super) fn element(&mut self, array: &[Value]) -> Evaluated {
        let inside = self.file.inside(self.at);
        self.at = self.file.after(self.at);
        match self.scope.evaluate(inside)? {
            Value::Number { value, integer: true } if value >= 0.0 && value < array.len() as f64 => {
                Ok(array[value as usize].clone())
            }
            _ => unknown(format!("an index is not a whole number below {}", array.len())),
        }
    }
}

fn elements(scope: Scope<'_>, range: Range<usize>) -> Evaluated {
    let mut values = Vec::new();
    for (_, value) in scope.arguments(range) {
        values.push(value?);
    }
    Ok(Value::Array(values.into()))
}
