//! With-blocks behind objects in expressions: `new Phong().(setDiffuse(c), shininess = 4)`.

use super::expressions::Parser;
use super::values::{Failure, Value, property_of_getter, property_of_setter, set_property, unknown};
use std::ops::Range;

impl Parser<'_> {
    /// The statements of `.( ... )`.
    pub(super) fn with(&mut self, value: &mut Value, block: Range<usize>) -> Result<(), Failure> {
        let mut start = block.start;
        while start < block.end {
            self.scope.spend(1)?;
            let end = self.file.find(start, block.end, &[",", ";"]);
            let name = self.file.word(start).unwrap_or_default();
            if self.file.is(start + 1, "(")
                && self.file.after(start + 1) == end
                && let Some(property) = property_of_setter(name)
            {
                // How the editor shows the rays of a light may depend on anything.
                if matches!(
                    (&*value, &*property),
                    (Value::Light(_), "visualize" | "numberofrays" | "raylength")
                ) {
                    start = end + 1;
                    continue;
                }
                let argument = self.scope.evaluate(self.file.inside(start + 1))?;
                set_property(value, &property, argument)?;
            } else if let Some(property) = property_of_getter(name)
                && self.file.is(start + 1, "(")
                && self.file.inside(start + 1).is_empty()
                && self.file.is(start + 3, ".")
                && self.file.word(start + 4) == Some("set")
                && self.file.is(start + 5, "(")
                && self.file.after(start + 5) == end
            {
                // `getColor().set(value)` changes the colour in place.
                let argument = self.scope.evaluate(self.file.inside(start + 5))?;
                set_property(value, &property, argument)?;
            } else if self.file.is(start + 1, "=") {
                let argument = self.scope.evaluate(start + 2..end)?;
                set_property(value, name, argument)?;
            } else if start < end {
                return unknown(format!("'{name}' in a with-block is not evaluated"));
            }
            start = end + 1;
        }
        Ok(())
    }
}
