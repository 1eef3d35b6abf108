//! Evaluates the bodies after `==>` as far as they need no running model: the result is a list of nodes.
//!
//! A body is evaluated with an explicit stack; the steps and the nodes are limited by the caller. A body of
//! which a part cannot be evaluated yields nothing, since half of an organ would be worse than none.

use super::declarations::File;
use super::expressions::Meter;
use super::instances::{Instance, Level};
use super::loops::Loop;
use super::statements::Mode;
use super::values::{Failure, Value};
use super::{Chain, Class, Place, Problem, Sources, StaticValue};
use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

/// What the instance of a module holds in a field.
pub(crate) enum Stored {
    /// Nothing: the field has its default value.
    Missing,
    /// A number, a truth value or no object.
    Value(StaticValue),
    /// Something that expressions cannot use.
    Other,
}

/// A node that a body makes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BodyNode {
    /// Full name of the built-in class.
    pub class: String,
    /// The fields that differ from the class.
    pub fields: BTreeMap<String, StaticValue>,
    /// The module, if it has a body itself.
    pub module: Option<Place>,
    /// Index of the parent in the list of nodes, which precedes its children; none hangs at the instance.
    pub parent: Option<usize>,
}

/// An evaluated body.
pub(crate) struct Instantiation {
    /// The nodes, or the first thing that could not be evaluated.
    pub nodes: Result<Vec<BodyNode>, Problem>,
    /// How much work it was.
    pub steps: usize,
}

impl Sources {
    /// Evaluates the body of a module for an instance with these field values.
    pub(crate) fn instantiate(
        &self,
        module: Place,
        stored: &dyn Fn(&str) -> Stored,
        most_nodes: usize,
        most_steps: usize,
    ) -> Instantiation {
        let meter = Rc::new(Meter::new(most_steps));
        let Chain { base, levels, .. } = self.chain(module);
        let Some((level, body)) = levels.iter().find_map(|l| Some((l, l.declaration.body.clone()?))) else {
            return Instantiation { nodes: Ok(Vec::new()), steps: 0 };
        };
        let mut own = Instance::new(self, &base, &levels, meter.clone(), Mode::Representative);
        own.build(&levels, Vec::new());
        // What the constructor lacks is told where the module is resolved.
        own.notes.clear();
        own.mode = Mode::Block;
        for (name, value) in &mut own.variables {
            let integer = matches!(value, Value::Number { integer: true, .. });
            *value = match stored(name) {
                Stored::Missing => continue,
                Stored::Value(StaticValue::Number(value)) => Value::Number { value, integer },
                Stored::Value(StaticValue::Bool(value)) => Value::Bool(value),
                Stored::Value(StaticValue::Null) => Value::Null,
                Stored::Value(StaticValue::Vector(value)) => Value::Vector(value),
                Stored::Value(StaticValue::Shader(value)) => Value::Shader(value),
                Stored::Value(StaticValue::Light(value)) => Value::Light(value),
                Stored::Value(StaticValue::Numbers(values)) => numbers(value, &values),
                Stored::Other => Value::Unknown,
            };
        }
        let file = &self.files[level.file];
        let frames = vec![Frame::Sequence(body, None)];
        let nodes = Vec::new();
        let mut reader =
            Reader { sources: self, file, level, own, frames, nodes, parent: None, most_nodes, meter };
        let done = reader.run();
        Instantiation { steps: reader.meter.steps(), nodes: done.map(|()| reader.nodes) }
    }
}

/// An array as the file stores it; `old` is what the constructor makes of the field.
fn numbers(old: &Value, stored: &[f64]) -> Value {
    let integer = match old {
        Value::Array(old) => matches!(old.first(), Some(Value::Number { integer: true, .. })),
        _ => false,
    };
    Value::Array(stored.iter().map(|value| Value::Number { value: *value, integer }).collect())
}

/// What is still to be done.
enum Frame {
    /// What comes next, and the parent that its nodes have after a comma.
    Sequence(Range<usize>, Option<usize>),
    /// The end of a branch: further nodes hang below this one.
    Parent(Option<usize>),
    Loop(Loop),
}

struct Reader<'a> {
    sources: &'a Sources,
    file: &'a File,
    level: &'a Level<'a>,
    /// The instance itself; its variables are those of the body.
    own: Instance<'a>,
    frames: Vec<Frame>,
    nodes: Vec<BodyNode>,
    parent: Option<usize>,
    most_nodes: usize,
    meter: Rc<Meter>,
}

type Done = Result<(), Problem>;

impl<'a> Reader<'a> {
    fn run(&mut self) -> Done {
        while let Some(frame) = self.frames.pop() {
            match frame {
                Frame::Parent(parent) => self.parent = parent,
                Frame::Sequence(range, _) if range.is_empty() => {}
                Frame::Sequence(range, start) => {
                    self.spend(range.start, 1)?;
                    let frame = self.frames.len();
                    self.frames.push(Frame::Sequence(0..0, None));
                    let next = if self.file.is(range.start, ",") {
                        // Another chain from where this one began.
                        self.parent = start;
                        range.start + 1
                    } else {
                        self.item(range.start, range.end)?
                    };
                    self.frames[frame] = Frame::Sequence(next..range.end.max(next), start);
                }
                Frame::Loop(mut turn) => {
                    self.spend(turn.body.start, 1)?;
                    if self.evaluated(turn.at, |reader| {
                        let level = reader.level;
                        let mut variables = std::mem::take(&mut reader.own.variables);
                        let more = turn.next(&mut variables, |variables, range| {
                            reader.own.scope(level, variables).evaluate(range)
                        });
                        reader.own.variables = variables;
                        more
                    })? {
                        let body = turn.body.clone();
                        self.frames.push(Frame::Loop(turn));
                        self.frames.push(Frame::Sequence(body, self.parent));
                    }
                }
            }
        }
        Ok(())
    }

    fn failure<T>(&self, at: usize, message: impl Into<String>) -> Result<T, Problem> {
        let file = self.file.path.clone();
        Err(Problem { file, line: self.file.line(at), message: message.into() })
    }

    fn spend(&self, at: usize, steps: usize) -> Done {
        if self.meter.spend(steps) { Ok(()) } else { self.failure(at, "the body takes too many steps") }
    }

    /// Turns the failure of an expression into one of the body.
    fn evaluated<T>(
        &mut self,
        at: usize,
        evaluate: impl FnOnce(&mut Self) -> Result<T, Failure>,
    ) -> Result<T, Problem> {
        match evaluate(self) {
            Ok(value) => Ok(value),
            Err(Failure::Unknown(reason)) => self.failure(at, reason),
            Err(Failure::Parameter) => self.failure(at, "the value of a parameter is not known"),
        }
    }

    fn expression(&mut self, range: Range<usize>) -> Result<Value, Problem> {
        let level = self.level;
        self.evaluated(range.start, |reader| reader.own.scope(level, &reader.own.variables).evaluate(range))
    }

    /// Does or prepares what begins at `at`; the result is the index behind it.
    fn item(&mut self, at: usize, end: usize) -> Result<usize, Problem> {
        let file = self.file;
        let after = if file.is_open(at) { file.after(at) } else { at + 1 };
        if file.is(at, "[") {
            self.frames.push(Frame::Parent(self.parent));
            self.frames.push(Frame::Sequence(file.inside(at), self.parent));
            return Ok(after);
        }
        if file.is(at, "(") {
            self.frames.push(Frame::Sequence(file.inside(at), self.parent));
            return Ok(after);
        }
        if file.is(at, "{") {
            self.spend(at, file.inside(at).len())?;
            self.own.run(self.level, file.inside(at), &[";", "}"]);
            return self.own.notes.first().cloned().map_or(Ok(after), Err);
        }
        let header = || if file.is(at + 1, "(") { Some(file.inside(at + 1)) } else { None };
        match (file.word(at), header()) {
            (Some("if"), Some(condition)) => self.choice(at, condition, end),
            (Some("for"), Some(header)) => {
                let start = file.after(at + 1);
                let stop = self.item_end(start, end)?;
                let repeated = self.evaluated(at, |reader| {
                    let level = reader.level;
                    let mut variables = std::mem::take(&mut reader.own.variables);
                    let turn = Loop::new(file, header, start..stop, &mut variables, |variables, range| {
                        reader.own.scope(level, variables).evaluate(range)
                    });
                    reader.own.variables = variables;
                    turn
                })?;
                self.frames.push(Frame::Loop(repeated));
                Ok(stop)
            }
            (
                Some(word @ ("if" | "for" | "while" | "do" | "switch" | "return" | "yield" | "else" | "new")),
                _,
            ) => self.failure(at, format!("'{word}' is not evaluated here")),
            (Some(_), _) => self.node(at, end),
            (None, _) => self.failure(at, "this part of the body is not evaluated"),
        }
    }

    /// `if (condition) item else item`
    fn choice(&mut self, at: usize, condition: Range<usize>, end: usize) -> Result<usize, Problem> {
        let start = self.file.after(at + 1);
        let stop = self.item_end(start, end)?;
        let (other, stop) = if stop < end && self.file.word(stop) == Some("else") {
            let after = self.item_end(stop + 1, end)?;
            (stop + 1..after, after)
        } else {
            (stop..stop, stop)
        };
        match self.expression(condition)? {
            Value::Bool(true) => {
                let then_end = if other.is_empty() { other.start } else { other.start - 1 };
                self.frames.push(Frame::Sequence(start..then_end, self.parent));
            }
            Value::Bool(false) => self.frames.push(Frame::Sequence(other, self.parent)),
            _ => return self.failure(at, "a condition is no truth value"),
        }
        Ok(stop)
    }

    /// The index behind the item at `at`, without doing anything.
    fn item_end(&self, at: usize, end: usize) -> Result<usize, Problem> {
        let file = self.file;
        let mut at = at;
        let mut choices = 0usize;
        loop {
            self.spend(at, 1)?;
            match file.word(at).filter(|_| at < end) {
                Some(word @ ("if" | "for" | "while")) if file.is(at + 1, "(") => {
                    choices += usize::from(word == "if");
                    at = file.after(at + 1);
                    continue;
                }
                Some(_) => {
                    let after = self.extent(at).after;
                    self.spend(at, after - at)?;
                    at = after;
                }
                None => at = if file.is_open(at) { file.after(at) } else { at + 1 },
            }
            if choices == 0 || at >= end || file.word(at) != Some("else") {
                return Ok(at.min(end));
            }
            choices -= 1;
            at += 1;
        }
    }

    /// The parts of the node at `at`, as far as they are there.
    fn extent(&self, at: usize) -> Extent {
        let file = self.file;
        let labelled = file.is(at + 1, ":");
        let name_at = if labelled { at + 2 } else { at };
        let (name, mut after) = file.qualified(name_at).unwrap_or((String::new(), name_at + 1));
        let arguments = if file.is(after, "(") { file.inside(after) } else { after..after };
        if file.is(after, "(") {
            after = file.after(after);
        }
        let mut with = Vec::new();
        while file.is(after, ".") && file.is(after + 1, "(") {
            with.push(file.inside(after + 1));
            after = file.after(after + 1);
        }
        let braces = file.is(after, "{").then(|| file.inside(after));
        if braces.is_some() {
            after = file.after(after);
        }
        Extent { labelled, name, arguments, with, braces, after }
    }

    /// `label:Name(arguments).(statements) { statements }`
    fn node(&mut self, at: usize, end: usize) -> Result<usize, Problem> {
        let Extent { labelled, name, arguments, with, braces, after } = self.extent(at);
        if name.is_empty() || after > end {
            return self.failure(at, "the name of a class is missing");
        }
        // Long names and type parameters take time as well.
        self.spend(at, after - at)?;
        if self.nodes.len() >= self.most_nodes {
            return self.failure(at, "the body makes too many nodes");
        }
        let (sources, level) = (self.sources, self.level);
        let (chain, module) = match sources.class(level.file, level.declaration, &name) {
            Class::Builtin(base) => (Chain { base, levels: Vec::new(), unresolved: Vec::new() }, None),
            Class::Declared(place) => (sources.chain(place), Some(place)),
            Class::Unknown => return self.failure(at, format!("'{name}' is not a known class")),
        };
        let Chain { base, levels, .. } = chain;
        if crate::classes::Class::of(&base).is_none() {
            return self.failure(at, format!("'{name}' extends '{base}', which is no known class of a node"));
        }
        let arguments = self.own.scope(level, &self.own.variables).arguments(arguments);
        let mut node = Instance::new(sources, &base, &levels, self.meter.clone(), Mode::Fresh);
        match levels.first() {
            None => node.construct(level, arguments),
            Some(declared) => {
                if !arguments.is_empty() && arguments.len() != declared.declaration.parameters.len() {
                    return self.failure(at, format!("these arguments of '{name}' are not understood"));
                }
                node.note_failures(level, &arguments);
                node.build(&levels, arguments);
            }
        }
        // Names in what follows are those of the body. That they are so where a field of the node has the
        // same name is unverified.
        std::mem::swap(&mut node.variables, &mut self.own.variables);
        node.mode = Mode::With;
        for range in with {
            node.run(level, range, &[",", ";", "}"]);
        }
        if let Some(range) = braces {
            node.mode = Mode::Braces;
            node.label = self.file.word(at).filter(|_| labelled);
            node.run(level, range, &[";", "}"]);
        }
        std::mem::swap(&mut node.variables, &mut self.own.variables);
        if let Some(note) = node.notes.first() {
            return Err(note.clone());
        }
        let fields = std::mem::take(&mut node.fields);
        let has_body = levels.iter().any(|level| level.declaration.body.is_some());
        let module = module.filter(|_| has_body);
        drop(node);
        self.nodes.push(BodyNode { class: base, fields, module, parent: self.parent });
        self.parent = Some(self.nodes.len() - 1);
        Ok(after)
    }
}

/// Where the parts of a node are.
struct Extent {
    labelled: bool,
    name: String,
    arguments: Range<usize>,
    with: Vec<Range<usize>>,
    braces: Option<Range<usize>>,
    after: usize,
}
