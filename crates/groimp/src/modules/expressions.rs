//! Evaluation of the expressions that do not depend on a running model.
//!
//! Expressions are evaluated while they are parsed. Recursion happens for brackets, calls and constants,
//! up to a fixed depth; a budget of steps bounds the work, since constants that use other constants twice
//! could otherwise take exponential time.

use super::builtins;
use super::declarations::{Constant, File};
use super::lexer::Kind;
use super::values::{Evaluated, Failure, Value, arithmetic, call, compare, create, logic, unknown};
use super::{Sources, StaticChannel, StaticShader};
use std::cell::Cell;
use std::collections::HashMap;
use std::ops::Range;

const DEEPEST: usize = 60;
/// Steps that the resolution of one module may take.
pub(super) const MOST_STEPS: usize = 50_000;

/// What limits the evaluation; one for each resolved module and each body.
pub(super) struct Meter {
    limit: usize,
    steps: Cell<usize>,
    depth: Cell<usize>,
}

impl Meter {
    pub fn new(limit: usize) -> Self {
        Meter { limit, steps: Cell::new(0), depth: Cell::new(0) }
    }

    /// How much work there was.
    pub fn steps(&self) -> usize {
        self.steps.get()
    }

    /// Counts work; false when there was too much of it.
    pub fn spend(&self, steps: usize) -> bool {
        self.steps.set(self.steps.get().saturating_add(steps));
        self.steps.get() <= self.limit
    }
}

/// Where names are looked up.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    pub sources: &'a Sources,
    pub file: usize,
    /// Full name of the declaration that holds the expression.
    pub owner: &'a str,
    pub variables: &'a HashMap<String, Value>,
    pub meter: &'a Meter,
}

impl<'a> Scope<'a> {
    /// The value of the tokens in a range.
    pub fn evaluate(self, range: Range<usize>) -> Evaluated {
        let file = &self.sources.files[self.file];
        let mut parser = Parser { scope: self, file, at: range.start, end: range.end };
        let value = parser.expression()?;
        if parser.at < parser.end {
            return unknown(format!("'{}' is not evaluated", parser.token()));
        }
        Ok(value)
    }

    /// The values of the arguments in a range between parentheses.
    pub fn arguments(self, range: Range<usize>) -> Vec<(Range<usize>, Evaluated)> {
        let file = &self.sources.files[self.file];
        let mut arguments = Vec::new();
        let mut start = range.start;
        while start < range.end && self.meter.spend(1) {
            let end = file.find(start, range.end, &[","]);
            arguments.push((start..end, self.evaluate(start..end)));
            start = end + 1;
        }
        arguments
    }

    fn name(self, path: &str) -> Evaluated {
        let path = path.strip_prefix("this.").or(path.strip_prefix("super.")).unwrap_or(path);
        if let Some(value) = self.variables.get(path) {
            self.spend(value.weight())?;
            return match value {
                Value::Parameter => Err(Failure::Parameter),
                Value::Unknown => unknown(format!("'{path}' gets its value when the model runs")),
                value => Ok(value.clone()),
            };
        }
        if let Some((file, constant)) = self.sources.constant(self.file, self.owner, path, false) {
            return self.constant(file, constant, path);
        }
        let (holder, last) = path.rsplit_once('.').unwrap_or(("", path));
        let holder = builtins::value_class(holder);
        match (holder, last) {
            ("Math", "PI") => return Ok(Value::real(std::f64::consts::PI)),
            ("Math", "E") => return Ok(Value::real(std::f64::consts::E)),
            ("RGBColor", _) => {
                let colour = builtins::predefined_shader(last).and_then(builtins::predefined_colour);
                if let Some(colour) = colour {
                    return Ok(Value::Channel(StaticChannel::Rgb(colour)));
                }
            }
            ("" | "RGBAShader" | "Library" | "de.grogra.rgg.Library", _) => {
                if let Some(index) = builtins::predefined_shader(last) {
                    return Ok(Value::Shader(StaticShader::Predefined(index)));
                }
            }
            _ => {}
        }
        if let Some(array) = path.strip_suffix(".length")
            && let Value::Array(array) = self.deeper(|| self.name(array))?
        {
            return Ok(Value::Number { value: array.len() as f64, integer: true });
        }
        // A constant that is not imported is an error in GroIMP, but may be a matter of versions.
        self.spend(self.sources.files.len() / 8)?;
        if let Some((file, constant)) = self.sources.constant(self.file, self.owner, path, true) {
            return self.constant(file, constant, path);
        }
        unknown(format!("'{path}' is not a known constant"))
    }

    fn constant(self, file: usize, constant: &Constant, name: &str) -> Evaluated {
        let variables = HashMap::new();
        let scope = Scope { file, owner: &constant.owner, variables: &variables, ..self };
        let value = scope.deeper(|| scope.evaluate(constant.value.clone()))?.converted(&constant.kind);
        // The elements of a constant array are taken for constant, too.
        if !constant.fixed && !matches!(value, Value::Shader(_) | Value::Channel(_)) {
            return unknown(format!("the variable '{name}' may change while the model runs"));
        }
        Ok(value)
    }

    pub(super) fn spend(self, steps: usize) -> Result<(), Failure> {
        if self.meter.spend(steps) { Ok(()) } else { unknown("the declarations are too involved") }
    }

    /// Limits the recursion.
    pub(super) fn deeper<T>(self, inner: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
        let depth = &self.meter.depth;
        if depth.get() >= DEEPEST {
            return unknown("the expression is nested too deeply or refers to itself");
        }
        depth.set(depth.get() + 1);
        let result = inner();
        depth.set(depth.get() - 1);
        result
    }
}

pub(super) struct Parser<'a> {
    pub scope: Scope<'a>,
    pub file: &'a File,
    pub at: usize,
    end: usize,
}

impl Parser<'_> {
    pub(super) fn is(&self, symbol: &str) -> bool {
        self.at < self.end && self.file.is(self.at, symbol)
    }

    /// The current token for messages.
    fn token(&self) -> String {
        match self.file.tokens.get(self.at).map(|t| &t.kind) {
            _ if self.at >= self.end => "nothing".into(),
            Some(Kind::Word(word)) => word.chars().take(40).collect(),
            Some(Kind::Number { value, .. }) => value.to_string(),
            Some(Kind::Text(text)) => format!("\"{}\"", text.chars().take(40).collect::<String>()),
            Some(Kind::Symbol(symbol)) => (*symbol).to_owned(),
            None => "nothing".into(),
        }
    }

    fn expression(&mut self) -> Evaluated {
        let scope = self.scope;
        scope.deeper(|| {
            let condition = self.disjunction()?;
            if self.is("?") { self.choice(&condition) } else { Ok(condition) }
        })
    }

    /// `? a : b` behind a condition; only one of the two is evaluated.
    fn choice(&mut self, condition: &Value) -> Evaluated {
        let start = self.at + 1;
        let mut open = 1;
        let mut colon = self.at;
        while open > 0 {
            colon = self.file.find(colon + 1, self.end, &["?", ":"]);
            if colon >= self.end {
                return unknown("a ':' is missing");
            }
            open = if self.file.is(colon, "?") { open + 1 } else { open - 1 };
        }
        // It reaches as far as the expression does.
        let rest = colon + 1..self.end;
        self.at = self.end;
        self.scope.spend(rest.len())?;
        match condition {
            Value::Bool(true) => self.scope.evaluate(start..colon),
            Value::Bool(false) => self.scope.evaluate(rest),
            _ => unknown("a condition is no truth value"),
        }
    }

    fn disjunction(&mut self) -> Evaluated {
        let mut left = self.conjunction()?;
        while self.is("||") {
            self.at += 1;
            left = logic(&left, &self.conjunction()?, |a, b| a || b)?;
        }
        Ok(left)
    }

    fn conjunction(&mut self) -> Evaluated {
        let mut left = self.comparison()?;
        while self.is("&&") {
            self.at += 1;
            left = logic(&left, &self.comparison()?, |a, b| a && b)?;
        }
        Ok(left)
    }

    /// `a < b` and its like; for comparisons of comparisons one needs parentheses.
    fn comparison(&mut self) -> Evaluated {
        let left = self.sum()?;
        let operators = ["<", "<=", ">", ">=", "==", "!="];
        let Some(operator) = operators.into_iter().find(|o| self.is(o)) else { return Ok(left) };
        self.at += 1;
        compare(&left, &self.sum()?, operator)
    }

    fn sum(&mut self) -> Evaluated {
        let mut left = self.product()?;
        while self.is("+") || self.is("-") {
            let minus = self.is("-");
            self.at += 1;
            let right = self.product()?;
            left = arithmetic(&left, &right, if minus { '-' } else { '+' })?;
        }
        Ok(left)
    }

    fn product(&mut self) -> Evaluated {
        let mut left = self.unary()?;
        while let Some(operator) = ['*', '/', '%'].into_iter().find(|o| self.is(o.encode_utf8(&mut [0; 4]))) {
            self.at += 1;
            let right = self.unary()?;
            left = arithmetic(&left, &right, operator)?;
        }
        Ok(left)
    }

    fn unary(&mut self) -> Evaluated {
        let (mut negative, mut inverted) = (false, false);
        loop {
            match () {
                () if self.is("-") => negative = !negative,
                () if self.is("+") => {}
                () if self.is("!") => inverted = !inverted,
                () => break,
            }
            self.at += 1;
        }
        match self.operand()? {
            Value::Number { value, integer } if negative => Ok(Value::Number { value: -value, integer }),
            Value::Bool(value) if inverted => Ok(Value::Bool(!value)),
            _ if negative || inverted => unknown("a value that is no number has a sign"),
            value => Ok(value),
        }
    }

    /// A primary expression with the with-blocks and indices that follow.
    fn operand(&mut self) -> Evaluated {
        self.scope.spend(1)?;
        let mut value = self.primary()?;
        while self.is(".") && self.file.is(self.at + 1, "(") {
            let block = self.file.inside(self.at + 1);
            self.at = self.file.after(self.at + 1);
            self.with(&mut value, block)?;
        }
        while self.is("[")
            && let Value::Array(array) = &value
        {
            let array = array.clone();
            value = self.element(&array)?;
        }
        if let Value::Array(array) = &value
            && self.is(".")
            && self.file.word(self.at + 1) == Some("length")
        {
            self.at += 2;
            return Ok(Value::Number { value: array.len() as f64, integer: true });
        }
        Ok(value)
    }

    fn primary(&mut self) -> Evaluated {
        if self.at >= self.end {
            return unknown("the expression is not complete");
        }
        match &self.file.tokens[self.at].kind {
            Kind::Number { value, integer } => {
                let value = Value::Number { value: *value, integer: *integer };
                self.at += 1;
                Ok(value)
            }
            Kind::Text(text) => {
                let value = Value::Text(text.clone());
                self.scope.spend(value.weight())?;
                self.at += 1;
                Ok(value)
            }
            Kind::Symbol("(") => {
                let inside = self.file.inside(self.at);
                let after = self.file.after(self.at);
                if let Some((kind, end)) = self.file.type_name(inside.start)
                    && end == inside.end
                    && self.is_cast(&kind, after)
                {
                    self.at = after;
                    let scope = self.scope;
                    return Ok(scope.deeper(|| self.unary())?.converted(&kind));
                }
                self.at = after;
                let mut inner =
                    Parser { scope: self.scope, file: self.file, at: inside.start, end: inside.end };
                let value = inner.expression()?;
                if inner.at < inner.end {
                    return unknown(format!("'{}' is not evaluated", inner.token()));
                }
                Ok(value)
            }
            Kind::Symbol("{") => self.array_literal(),
            Kind::Symbol(symbol) => unknown(format!("'{symbol}' is not evaluated")),
            Kind::Word(word) => {
                let constant = match word.as_str() {
                    "true" => Some(Value::Bool(true)),
                    "false" => Some(Value::Bool(false)),
                    "null" => Some(Value::Null),
                    _ => None,
                };
                if let Some(constant) = constant {
                    self.at += 1;
                    return Ok(constant);
                }
                let created = word == "new";
                let Some((name, after)) = self.file.qualified(self.at + usize::from(created)) else {
                    return unknown("the name of a class is missing");
                };
                if !self.file.is(after, "(") || after >= self.end {
                    self.at = after;
                    if created && self.is("[") {
                        return self.new_array(&name);
                    }
                    return if created {
                        unknown(format!("'new {name}' is not evaluated"))
                    } else {
                        self.scope.name(&name)
                    };
                }
                let arguments = self.scope.arguments(self.file.inside(after));
                self.at = self.file.after(after);
                let mut values = Vec::new();
                for (_, value) in arguments {
                    values.push(value?);
                }
                if created { create(&name, &values) } else { call(&name, &values) }
            }
        }
    }

    /// Tells a cast from an expression in parentheses.
    fn is_cast(&self, kind: &str, after: usize) -> bool {
        const PRIMITIVE: [&str; 6] = ["float", "double", "int", "long", "short", "byte"];
        let operand = after < self.end && !matches!(self.file.tokens[after].kind, Kind::Symbol(_));
        PRIMITIVE.contains(&kind) || (operand && kind.starts_with(char::is_alphabetic))
    }
}
