//! Makes an instance of a module as its constructor without arguments would do.
//!
//! A module without parameters passes the arguments of its `extends` clause to the base class, one with
//! parameters calls the base constructor without arguments. Instance initialisers run in both cases.
//! Whether the with-block of a module with parameters runs is not certain; constants in it are used all the
//! same, because then a file that lacks the field cannot mean anything else.

use super::builtins::{self, Target};
use super::declarations::{Declaration, File, Member};
use super::expressions::{Meter, Scope};
use super::statements::Mode;
use super::values::{Evaluated, Failure, Value};
use super::{Problem, Sources, StaticShader, StaticValue};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;

const MOST_NOTES: usize = 30;

/// A declaration in the chain of base classes.
pub(super) struct Level<'a> {
    pub file: usize,
    pub declaration: &'a Declaration,
}

/// Values for the parameters of a constructor, with the places where they are given. Empty for a call
/// without arguments.
pub(super) type Arguments = Vec<(Range<usize>, Evaluated)>;

pub(super) struct Instance<'a> {
    sources: &'a Sources,
    /// The built-in class.
    class: &'a str,
    pub fields: BTreeMap<String, StaticValue>,
    /// Names that expressions may use: parameters, fields and local variables.
    pub variables: HashMap<String, Value>,
    /// Fields that modules declare themselves.
    own: HashSet<&'a str>,
    pub methods: HashSet<&'a str>,
    pub meter: Rc<Meter>,
    /// What could not be evaluated.
    pub notes: Vec<Problem>,
    pub mode: Mode,
    /// The name that a body gives to this node.
    pub label: Option<&'a str>,
}

impl<'a> Instance<'a> {
    /// An instance that nothing was done to yet. The chain begins with the module itself.
    pub fn new(
        sources: &'a Sources,
        class: &'a str,
        chain: &[Level<'a>],
        meter: Rc<Meter>,
        mode: Mode,
    ) -> Self {
        // What is made anew for each instance, whether or not an expression has to be evaluated for it.
        let parts = |d: &Declaration| d.methods.len() + d.members.len() + d.parameters.len();
        let levels_above = chain.len().saturating_sub(1);
        meter.spend(levels_above + chain.iter().map(|level| parts(level.declaration)).sum::<usize>());
        Instance {
            sources,
            class,
            fields: BTreeMap::new(),
            variables: HashMap::new(),
            own: HashSet::new(),
            methods: chain.iter().flat_map(|l| l.declaration.methods.iter().map(String::as_str)).collect(),
            meter,
            notes: Vec::new(),
            mode,
            label: None,
        }
    }

    /// Runs the constructors, so that the fields are those that differ from the built-in class.
    pub fn build(&mut self, chain: &[Level<'a>], arguments: Arguments) {
        // Arguments are computed upwards, from the module to the built-in class, ...
        let mut bound = Vec::new();
        let mut arguments = arguments;
        for (index, level) in chain.iter().enumerate() {
            let parameters = self.bind(level, &arguments);
            let called_by = std::mem::take(&mut arguments);
            if level.declaration.parameters.is_empty() || !called_by.is_empty() {
                arguments = self.base_arguments(level, parameters.as_ref());
                if index + 1 < chain.len() {
                    self.note_failures(level, &arguments);
                }
            }
            bound.push(parameters);
        }
        // ... and the constructors run downwards.
        if let Some(level) = chain.last() {
            self.construct(level, arguments);
        }
        for (level, parameters) in chain.iter().zip(bound).rev() {
            self.run_level(level, parameters);
        }
    }

    pub fn file(&self, level: &Level) -> &'a File {
        &self.sources.files[level.file]
    }

    pub fn note(&mut self, level: &Level, at: usize, text: &str) {
        let file = self.file(level);
        let note = Problem { file: file.path.clone(), line: file.line(at), message: text.to_owned() };
        if self.notes.len() < MOST_NOTES && !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    pub fn note_value(&mut self, level: &Level, at: usize, what: &str, failure: &Failure) {
        // Objects that an expression creates are never omitted in files, so nothing is lost.
        let stored = self.mode == Mode::Representative && self.file(level).word(at) == Some("new");
        match failure {
            Failure::Unknown(reason) if !stored => {
                self.note(level, at, &format!("the value of {what} cannot be determined: {reason}"));
            }
            Failure::Parameter if self.mode != Mode::Representative => {
                self.note(level, at, &format!("the value of {what} depends on an unknown parameter"));
            }
            _ => {}
        }
    }

    pub fn note_failures(&mut self, level: &Level, arguments: &Arguments) {
        for (range, value) in arguments {
            if let Err(failure) = value {
                self.note_value(level, range.start, "a constructor argument", failure);
            }
        }
    }

    pub fn scope<'b>(&'b self, level: &Level<'b>, variables: &'b HashMap<String, Value>) -> Scope<'b> {
        let owner = &level.declaration.full_name;
        Scope { sources: self.sources, file: level.file, owner, variables, meter: &self.meter }
    }

    /// The parameter values of a level that is constructed with arguments.
    fn bind(&self, level: &Level, arguments: &Arguments) -> Option<HashMap<String, Value>> {
        if arguments.is_empty() {
            return None;
        }
        let mut values = arguments.iter().map(|(_, value)| value.clone().unwrap_or(Value::Unknown));
        let parameters = level.declaration.parameters.iter().map(|parameter| {
            let value = values.next().unwrap_or(Value::Unknown);
            (parameter.name.clone(), value.converted(&parameter.kind))
        });
        Some(parameters.collect())
    }

    /// The arguments that a level passes to its base class.
    fn base_arguments(&self, level: &Level, parameters: Option<&HashMap<String, Value>>) -> Arguments {
        let declaration = level.declaration;
        let file = self.file(level);
        let explicit = declaration.constructor.as_ref().map(|body| body.start);
        let explicit = explicit.filter(|at| file.word(*at) == Some("super") && file.is(at + 1, "("));
        let range = explicit.map(|at| file.inside(at + 1));
        let range = range.or_else(|| declaration.base.as_ref()?.arguments.clone());
        let none = HashMap::new();
        range.map_or_else(Vec::new, |range| self.scope(level, parameters.unwrap_or(&none)).arguments(range))
    }

    /// Runs the constructor of the built-in class.
    pub fn construct(&mut self, level: &Level, arguments: Arguments) {
        // Of an unknown class the user has been told already.
        if builtins::class(self.class).as_deref() != Some(self.class) {
            return;
        }
        let Some(targets) = builtins::constructor(self.class, arguments.len()) else {
            let class = builtins::simple_name(self.class);
            let text = format!("these arguments of '{class}' are not understood");
            let at = arguments.first().map_or(0, |(range, _)| range.start);
            return self.note(level, at, &text);
        };
        for (target, (range, value)) in targets.iter().zip(arguments) {
            if *target == Target::Nothing {
                continue;
            }
            match value {
                Ok(value) => {
                    if !self.set_target(*target, value) {
                        self.note(level, range.start, "this constructor argument is not understood");
                    }
                }
                Err(failure) => self.note_value(level, range.start, "a constructor argument", &failure),
            }
        }
    }

    fn set_target(&mut self, target: Target, value: Value) -> bool {
        let number = value.number();
        match (target, number) {
            (Target::Nothing, _) => {}
            (Target::Field(name), _) => self.set_field(name, value),
            (Target::Component(name, index), Some(number)) => self.set_component(name, index, number),
            (Target::HalfAxis, Some(_)) => self.set_field("width", value),
            (Target::Negated(name), Some(number)) => self.set_field(name, Value::real(-number)),
            (Target::AllScales, Some(_)) => return self.set("scale", vec![value]),
            (Target::Colour, _) => {
                let (argument, shader) = match value {
                    Value::Number { value, .. } if (0.0..=15.5).contains(&value) => {
                        (value, StaticShader::Predefined((value.round() as u32).min(15)))
                    }
                    Value::Number { value, .. } => {
                        let [r, g, b] = builtins::colour(value as i64 as u32);
                        (-1.0, StaticShader::Rgba([r, g, b, 1.0]))
                    }
                    Value::Shader(shader) => (-1.0, shader),
                    _ => return false,
                };
                self.set_field("argument", Value::real(argument));
                self.set_field("shader", Value::Shader(shader));
            }
            _ => return false,
        }
        true
    }

    /// Runs the part of the constructor that a declaration adds.
    fn run_level(&mut self, level: &Level<'a>, parameters: Option<HashMap<String, Value>>) {
        let declaration = level.declaration;
        let given = parameters.is_some();
        let mut values = parameters.unwrap_or_default();
        for parameter in &declaration.parameters {
            let missing = match self.mode {
                Mode::Representative => Value::Parameter,
                _ => Value::initial(&parameter.kind),
            };
            let value = values.remove(&parameter.name).unwrap_or(missing);
            if !parameter.reuses_field {
                self.own.insert(&parameter.name);
            }
            if given && value != Value::Unknown {
                self.assign(&parameter.name, value);
            } else {
                self.variables.insert(parameter.name.clone(), value);
            }
        }
        for with in declaration.base.iter().flat_map(|base| &base.with) {
            self.run(level, with.clone(), &[",", ";", "}"]);
        }
        if !given {
            for parameter in &declaration.parameters {
                let value = if !parameter.reuses_field {
                    Value::initial(&parameter.kind)
                } else {
                    match self.fields.get(&parameter.name) {
                        Some(StaticValue::Number(value)) => Value::real(*value),
                        Some(StaticValue::Shader(shader)) => Value::Shader(shader.clone()),
                        _ => Value::Unknown,
                    }
                };
                self.variables.insert(parameter.name.clone(), value);
            }
        }
        for member in &declaration.members {
            match member {
                Member::Initialiser(range) => self.run(level, range.clone(), &[";", "}"]),
                Member::Field { kind, name, value: None } => {
                    self.own.insert(name);
                    self.variables.insert(name.clone(), Value::initial(kind));
                }
                Member::Field { kind, name, value: Some(range) } => {
                    self.own.insert(name);
                    let value = self.scope(level, &self.variables).evaluate(range.clone());
                    match value {
                        Ok(value) => self.assign(name, value.converted(kind)),
                        // Such a field is seldom of interest for a picture.
                        Err(_) => {
                            self.variables.insert(name.clone(), Value::Unknown);
                        }
                    }
                }
            }
        }
        if let Some(body) = &declaration.constructor {
            self.run(level, body.clone(), &[";", "}"]);
        }
    }

    /// Calls a setter with arguments; false if it is not known.
    pub fn set(&mut self, property: &str, values: Vec<Value>) -> bool {
        let simple = builtins::simple_name(self.class);
        let numbers: Option<Vec<f64>> = values.iter().map(Value::number).collect();
        let numbers = numbers.unwrap_or_default();
        let property = if property == "translation" { "transform" } else { property };
        if property == "color" {
            return self.set_colour(&values, &numbers);
        }
        match (property, values.as_slice()) {
            ("open", [value]) if matches!(simple, "Cylinder" | "Frustum") => {
                self.set_field("baseOpen", value.clone());
                self.set_field("topOpen", value.clone());
            }
            ("scale", _) if simple == "Scale" && matches!(numbers.len(), 1 | 3) => {
                for (index, name) in ["scaleX", "scaleY", "scaleZ"].into_iter().enumerate() {
                    self.set_field(name, Value::real(numbers[if numbers.len() == 3 { index } else { 0 }]));
                }
            }
            // A matrix is a fresh object, which files always contain.
            ("scale", [_, _, _])
                if self.mode == Mode::Representative && builtins::has_transform(self.class) => {}
            ("rotation" | "scale", [_, _, _])
                if numbers.len() == 3 && builtins::has_transform(self.class) =>
            {
                // Not `rotation`, which modules may have as a field of their own.
                let name = if property == "rotation" { "setRotation" } else { property };
                self.fields.insert(name.into(), StaticValue::Vector([numbers[0], numbers[1], numbers[2]]));
            }
            ("rotation", _) => return false,
            (_, [value]) => self.set_field(property, value.clone()),
            _ => match numbers.as_slice() {
                [x, y, z] => self.set_field(property, Value::Vector([*x, *y, *z])),
                _ => return false,
            },
        }
        true
    }

    fn set_colour(&mut self, values: &[Value], numbers: &[f64]) -> bool {
        use super::StaticChannel::Rgb;
        let rgba = match (values, numbers) {
            ([Value::Number { value, integer: true }], _) => {
                if builtins::has_indexed_colour(self.class) && (-1.0..16.0).contains(value) {
                    self.set_field("color", Value::real(*value));
                    return true;
                }
                let [r, g, b] = builtins::colour(*value as i64 as u32);
                [r, g, b, 1.0]
            }
            ([Value::Channel(Rgb([r, g, b])) | Value::Vector([r, g, b])], _) => [*r, *g, *b, 1.0],
            ([Value::Shader(StaticShader::Rgba(rgba))], _) => *rgba,
            ([Value::Shader(StaticShader::Predefined(index))], _) => {
                let Some([r, g, b]) = builtins::predefined_colour(*index) else { return false };
                [r, g, b, 1.0]
            }
            (_, [r, g, b]) => [*r, *g, *b, 1.0],
            (_, [r, g, b, a]) => [*r, *g, *b, *a],
            _ => return false,
        };
        if builtins::has_rgb_colour(self.class) {
            self.set_field("color", Value::Vector([rgba[0], rgba[1], rgba[2]]));
        } else {
            self.set_field("shader", Value::Shader(StaticShader::Rgba(rgba)));
        }
        true
    }

    /// A plain assignment: to a field of the module or to one of the built-in class.
    pub fn assign(&mut self, name: &str, value: Value) {
        if self.mode == Mode::Braces && self.variables.contains_key(name) {
            self.variables.insert(name.to_owned(), value);
            return;
        }
        if !self.own.contains(name) {
            return self.set_field(name, value);
        }
        if !builtins::is_builtin_field(self.class, name)
            && let Some(value) = value.clone().into_static()
        {
            self.fields.insert(name.to_owned(), value);
        }
        if self.has_own_variables() {
            self.variables.insert(name.to_owned(), value);
        }
    }

    fn has_own_variables(&self) -> bool {
        !matches!(self.mode, Mode::With | Mode::Braces)
    }

    /// Sets a field of the built-in class, given by its name or that of an alias.
    fn set_field(&mut self, name: &str, value: Value) {
        let number = value.number();
        let index = ["x", "y", "z"].iter().position(|axis| *axis == name);
        match (number, index) {
            (Some(width), _) if name == "width" && builtins::simple_name(self.class) == "Parallelogram" => {
                self.fields.insert("axis".into(), StaticValue::Vector([width / 2.0, 0.0, 0.0]));
            }
            (Some(number), Some(index)) if builtins::has_transform(self.class) => {
                self.set_component("transform", index, number);
            }
            _ => {
                if let Some(value) = value.clone().into_static() {
                    self.fields.insert(name.to_owned(), value);
                }
            }
        }
        if !self.own.contains(name) && self.has_own_variables() {
            self.variables.insert(name.to_owned(), value);
        }
    }

    fn set_component(&mut self, name: &str, index: usize, number: f64) {
        let mut vector = match self.fields.get(name) {
            Some(StaticValue::Vector(vector)) => *vector,
            _ => [0.0; 3],
        };
        vector[index] = number;
        self.fields.insert(name.to_owned(), StaticValue::Vector(vector));
    }
}
