//! Field values of nodes and objects, in one flat table: nesting costs no stack, neither when values are read
//! nor when they are dropped.

use crate::Limits;
use std::collections::HashMap;

/// An interned name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Symbol(u32);

/// Position in the table of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ValueId(u32);

/// How a value was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A number, a boolean, a string.
    Data,
    /// A composite value; its fields are its members, its list form is its text.
    Object,
    Array,
    Null,
    /// Reference to a node; the text is the id.
    Ref,
    /// Shared object; the text is `provider:what`.
    Shared,
    /// Base64 of a Java object.
    Serialized,
}

/// Fields of a node or members of a value, in the order of the file.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Members {
    first: Option<ValueId>,
    last: Option<ValueId>,
}

/// One value.
#[derive(Clone, Debug)]
pub(crate) struct Value {
    pub name: Option<Symbol>,
    pub kind: Kind,
    pub type_name: Option<Symbol>,
    pub text: Option<Box<str>>,
    pub line: usize,
    pub members: Members,
    next: Option<ValueId>,
}

impl Value {
    pub fn new(kind: Kind, line: usize) -> Self {
        Value { name: None, kind, type_name: None, text: None, line, members: Members::default(), next: None }
    }

    /// The text, empty if there is none.
    pub fn text(&self) -> &str {
        self.text.as_deref().unwrap_or("").trim()
    }
}

/// All values of a file and the names that occur in it.
pub(crate) struct Values {
    /// Most values, see [`Limits::graph_values`].
    most: usize,
    values: Vec<Value>,
    names: Vec<Box<str>>,
    symbols: HashMap<Box<str>, Symbol>,
}

impl Default for Values {
    fn default() -> Self {
        Values::within(Limits::default().graph_values)
    }
}

impl Values {
    /// An empty table for at most so many values.
    pub fn within(most: usize) -> Self {
        // They are counted in 32 bits.
        let most = most.min(1 << 31);
        Values { most, values: Vec::new(), names: Vec::new(), symbols: HashMap::new() }
    }

    /// The symbol of a name, new or old.
    pub fn intern(&mut self, name: &str) -> Symbol {
        if let Some(symbol) = self.symbols.get(name) {
            return *symbol;
        }
        let symbol = Symbol(u32::try_from(self.names.len()).unwrap_or(u32::MAX));
        self.names.push(name.into());
        self.symbols.insert(name.into(), symbol);
        symbol
    }

    pub fn name(&self, symbol: Symbol) -> &str {
        &self.names[symbol.0 as usize]
    }

    /// Adds a value that belongs to nothing yet.
    ///
    /// # Panics
    /// Never, since readers stop when the table [is full](Values::is_full).
    pub fn add(&mut self, value: Value) -> ValueId {
        let id = ValueId(u32::try_from(self.values.len()).expect("fewer than 2^32 values"));
        self.values.push(value);
        id
    }

    /// Whether there are as many values as there may be.
    pub fn is_full(&self) -> bool {
        self.values.len() >= self.most
    }

    pub fn get(&self, id: ValueId) -> &Value {
        &self.values[id.0 as usize]
    }

    pub fn get_mut(&mut self, id: ValueId) -> &mut Value {
        &mut self.values[id.0 as usize]
    }

    /// Appends a value to a list.
    pub fn append(&mut self, members: &mut Members, value: ValueId) {
        match members.last {
            Some(last) => self.get_mut(last).next = Some(value),
            None => members.first = Some(value),
        }
        members.last = Some(value);
    }

    /// Appends a value to the members of another.
    pub fn append_to(&mut self, owner: ValueId, value: ValueId) {
        let mut members = self.get(owner).members;
        self.append(&mut members, value);
        self.get_mut(owner).members = members;
    }

    /// All values of a list.
    pub fn iter(&self, members: Members) -> impl Iterator<Item = &Value> {
        let mut at = members.first;
        std::iter::from_fn(move || {
            let value = self.get(at?);
            at = value.next;
            Some(value)
        })
    }

    /// The first value of that name.
    pub fn find(&self, members: Members, name: &str) -> Option<&Value> {
        let symbol = *self.symbols.get(name)?;
        self.iter(members).find(|value| value.name == Some(symbol))
    }

    /// Class of a value as in the file.
    pub fn type_of(&self, value: &Value) -> Option<&str> {
        value.type_name.map(|symbol| self.name(symbol))
    }
}

/// A number as Java writes it.
pub(crate) fn parse_number(text: &str) -> Option<f64> {
    let text = text.trim();
    // Java accepts a type suffix: 1.0f, 1.0d.
    let bare = text
        .strip_suffix(['f', 'F', 'd', 'D'])
        .filter(|t| t.ends_with(|c: char| c.is_ascii_digit() || c == '.'));
    bare.unwrap_or(text).parse().ok()
}

/// Numbers separated by white space or commas; `None` if one of them is not a number.
pub(crate) fn parse_numbers(text: &str) -> Option<Vec<f64>> {
    tokens(text).map(parse_number).collect()
}

/// Words separated by white space or commas.
pub(crate) fn tokens(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || c == ',').filter(|token| !token.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn java_numbers() {
        assert_eq!(parse_number("5.0E-4"), Some(0.0005));
        assert_eq!(parse_number("1.5f"), Some(1.5));
        assert_eq!(parse_number("-Infinity"), Some(f64::NEG_INFINITY));
        assert!(parse_number("NaN").unwrap().is_nan());
        assert_eq!(parse_number("1,5"), None);
        assert_eq!(parse_number(""), None);
        assert_eq!(parse_numbers("0.5, 0 1"), Some(vec![0.5, 0.0, 1.0]));
        assert_eq!(parse_numbers("0.5 x"), None);
    }
}
