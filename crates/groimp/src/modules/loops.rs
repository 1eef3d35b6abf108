//! The headers of `for` in bodies: `int i = 0; i < n; i++`, `int i : (a:b)` and `a:b`.

use super::declarations::File;
use super::values::{Evaluated, Failure, Value, arithmetic, unknown};
use std::collections::HashMap;
use std::ops::Range;

type Variables = HashMap<String, Value>;

/// A loop that is being run.
pub(super) struct Loop {
    /// Where it stands.
    pub at: usize,
    /// What is repeated.
    pub body: Range<usize>,
    steps: Steps,
}

enum Steps {
    /// The numbers from `next` to `last`.
    Counting { variable: Option<String>, next: f64, last: f64 },
    /// Condition and what is done between two turns.
    While { condition: Range<usize>, change: Option<Change>, begun: bool },
}

/// An assignment to the loop's variable.
struct Change {
    variable: String,
    amount: Amount,
}

enum Amount {
    /// `i++`, `i--`
    One(f64),
    /// `i += x`, ...
    Computed(char, Range<usize>),
    /// `i = x`
    Value(Range<usize>),
}

impl Loop {
    /// Reads a header and does what comes before the first turn.
    pub fn new(
        file: &File,
        header: Range<usize>,
        body: Range<usize>,
        variables: &mut Variables,
        evaluate: impl Fn(&Variables, Range<usize>) -> Evaluated,
    ) -> Result<Loop, Failure> {
        let Range { start, end } = header;
        let first = file.find(start, end, &[";"]);
        if first == end {
            let steps = counting(file, header, |range| evaluate(variables, range))?;
            return Ok(Loop { at: start, body, steps });
        }
        let second = file.find(first + 1, end, &[";"]);
        if second == end || second == first + 1 {
            return unknown("a 'for' without a condition is not evaluated");
        }
        if start < first {
            let (kind, name) = variable(file, start, "=").ok_or_else(not_understood)?;
            let value = evaluate(variables, assigned(file, start, first))?;
            let value = if kind.is_empty() { value } else { value.converted(&kind) };
            variables.insert(name, value);
        }
        let change = if second + 1 < end { Some(change(file, second + 1..end)?) } else { None };
        let steps = Steps::While { condition: first + 1..second, change, begun: false };
        Ok(Loop { at: start, body, steps })
    }

    /// Prepares the next turn; false when the loop is done.
    pub fn next(
        &mut self,
        variables: &mut Variables,
        evaluate: impl Fn(&Variables, Range<usize>) -> Evaluated,
    ) -> Result<bool, Failure> {
        match &mut self.steps {
            Steps::Counting { variable, next, last } => {
                if *next > *last {
                    return Ok(false);
                }
                if let Some(variable) = variable {
                    variables.insert(variable.clone(), Value::Number { value: *next, integer: true });
                }
                *next += 1.0;
                Ok(true)
            }
            Steps::While { condition, change, begun } => {
                if *begun && let Some(change) = change {
                    change.apply(variables, &evaluate)?;
                }
                *begun = true;
                match evaluate(variables, condition.clone())? {
                    Value::Bool(more) => Ok(more),
                    _ => unknown("a condition is no truth value"),
                }
            }
        }
    }
}

impl Change {
    fn apply(
        &self,
        variables: &mut Variables,
        evaluate: impl Fn(&Variables, Range<usize>) -> Evaluated,
    ) -> Result<(), Failure> {
        let Some(old) = variables.get(&self.variable) else { return Err(not_understood()) };
        let integer = matches!(old, Value::Number { integer: true, .. });
        let new = match &self.amount {
            Amount::One(sign) => arithmetic(old, &Value::Number { value: *sign, integer: true }, '+')?,
            Amount::Computed(operator, range) => {
                arithmetic(old, &evaluate(variables, range.clone())?, *operator)?
            }
            Amount::Value(range) => evaluate(variables, range.clone())?,
        };
        // Java converts the result back to the type of the variable.
        let new = if integer { new.converted("int") } else { new };
        variables.insert(self.variable.clone(), new);
        Ok(())
    }
}

fn not_understood() -> Failure {
    Failure::Unknown("this 'for' is not understood".into())
}

/// `[type] name` before the symbol, as type and name.
fn variable(file: &File, at: usize, symbol: &str) -> Option<(String, String)> {
    if file.is(at + 1, symbol) {
        return Some((String::new(), file.word(at)?.to_owned()));
    }
    let (kind, name_at) = file.type_name(at)?;
    let name = file.word(name_at).filter(|_| file.is(name_at + 1, symbol))?;
    Some((kind, name.to_owned()))
}

/// What stands behind the first `=`.
fn assigned(file: &File, start: usize, end: usize) -> Range<usize> {
    let sign = file.find(start, end, &["="]);
    (sign + 1).min(end)..end
}

fn counting(
    file: &File,
    header: Range<usize>,
    evaluate: impl Fn(Range<usize>) -> Evaluated,
) -> Result<Steps, Failure> {
    let Range { mut start, mut end } = header;
    let declared = variable(file, start, ":").filter(|(kind, _)| !kind.is_empty());
    let mut name = None;
    if let Some((_, variable)) = declared {
        name = Some(variable);
        start = file.find(start, end, &[":"]) + 1;
    }
    while file.is(start, "(") && file.after(start) == end {
        Range { start, end } = file.inside(start);
    }
    let colon = file.find(start, end, &[":"]);
    if colon == end {
        return unknown("a 'for' over anything but a range of numbers is not evaluated");
    }
    let bound = |range| match evaluate(range)? {
        Value::Number { value, integer: true } => Ok(value),
        _ => unknown("the range of a 'for' is not made of whole numbers"),
    };
    Ok(Steps::Counting { variable: name, next: bound(start..colon)?, last: bound(colon + 1..end)? })
}

fn change(file: &File, range: Range<usize>) -> Result<Change, Failure> {
    let Range { start, end } = range;
    for (symbol, sign) in [("++", 1.0), ("--", -1.0)] {
        let at = if file.is(start, symbol) { start + 1 } else { start };
        let after = file.is(start, symbol) || file.is(start + 1, symbol);
        if after && end == start + 2 {
            let variable = file.word(at).ok_or_else(not_understood)?.to_owned();
            return Ok(Change { variable, amount: Amount::One(sign) });
        }
    }
    let variable = file.word(start).ok_or_else(not_understood)?.to_owned();
    for (symbol, operator) in [("+=", '+'), ("-=", '-'), ("*=", '*'), ("/=", '/')] {
        if file.is(start + 1, symbol) {
            return Ok(Change { variable, amount: Amount::Computed(operator, start + 2..end) });
        }
    }
    if file.is(start + 1, "=") {
        return Ok(Change { variable, amount: Amount::Value(start + 2..end) });
    }
    Err(not_understood())
}
