//! Static resolution of the modules that model sources declare.
//!
//! Files do not store a value that equals that of a freshly made object, and for a user module such an
//! object is made by code in the model source. This module reads the declarations, follows the `extends`
//! chain to a built-in class and evaluates what does not need a running model: constructor arguments,
//! with-blocks and instance initialisers that are made of constants.

mod arrays;
mod bodies;
#[cfg(test)]
mod bodies_tests;
mod builtins;
mod declarations;
mod expressions;
mod instances;
mod lexer;
mod loops;
mod parser;
mod statements;
#[cfg(test)]
mod tests;
mod values;
mod with_blocks;

use declarations::{Constant, Declaration, File};
use expressions::{MOST_STEPS, Meter};
use instances::{Instance, Level};
use statements::Mode;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

/// A source file of a project.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// Path inside the project, e.g. `sub/test.rgg`.
    pub path: String,
    /// Decoded text.
    pub text: String,
}

/// A place in a source that could not be understood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Path of the source.
    pub file: String,
    /// Line number from 1.
    pub line: usize,
    /// A sentence for the user.
    pub message: String,
}

/// What a user module is.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedModule {
    /// Full name of the built-in class at the end of the `extends` chain; an unknown class is given by its
    /// name as written.
    pub base: String,
    /// What missing fields mean where this differs from the built-in class; each field once, in
    /// alphabetical order. Fields that the module itself declares are included if they have a constant
    /// value; the others are 0, false or null.
    ///
    /// `transform` is given as a translation. `scale` of a class with a `transform` is one factor or three, and
    /// `setRotation` are angles in radians about x, then y, then z. They belong to the default of `transform` and have
    /// no meaning when the file stores a `transform`.
    pub defaults: Vec<FieldDefault>,
    /// Whether a `==>` instantiation body is declared anywhere in the chain.
    pub has_body: bool,
    /// File and line of the declaration.
    pub declared_at: (String, usize),
    /// What could not be evaluated, one sentence each, for the user.
    pub unresolved: Vec<String>,
}

/// The value of a missing field.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldDefault {
    /// Name of the field as in files.
    pub field: String,
    /// What its absence means.
    pub value: StaticValue,
}

/// A value that is known without running the model.
#[derive(Clone, Debug, PartialEq)]
pub enum StaticValue {
    /// A number of any type.
    Number(f64),
    /// A truth value.
    Bool(bool),
    /// A vector, or an RGB colour.
    Vector([f64; 3]),
    /// A shader.
    Shader(StaticShader),
    /// A light.
    Light(StaticLight),
    /// An array of numbers.
    Numbers(Vec<f64>),
    /// No object.
    Null,
}

/// A light that is known without running the model.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticLight {
    /// Full name of its class.
    pub class: String,
    /// The properties that are set (`power`, `color`, ...).
    pub properties: BTreeMap<String, StaticValue>,
}

/// A shader that is known without running the model.
#[derive(Clone, Debug, PartialEq)]
pub enum StaticShader {
    /// A predefined RGBAShader by its index; `EGA_n` is n, `BLACK` 16.
    Predefined(u32),
    /// A Lambertian colour with opacity.
    Rgba([f64; 4]),
    /// The shader of that name in the project.
    Named(String),
    /// A Phong shader; channels that are not listed have the default of the class.
    Phong {
        /// Field name (`diffuse`, `diffuseTransparency`, ...) and value.
        channels: Vec<(String, StaticChannel)>,
    },
    /// One shader for each purpose.
    AlgorithmSwitch {
        /// For the interactive view.
        gui: Option<Box<StaticShader>>,
        /// For ray tracing.
        raytracer: Option<Box<StaticShader>>,
        /// For the light model.
        radiation: Option<Box<StaticShader>>,
    },
}

/// A colour channel of a shader.
#[derive(Clone, Debug, PartialEq)]
pub enum StaticChannel {
    /// A colour.
    Rgb([f64; 3]),
    /// A grey value.
    Gray(f64),
    /// The image of that name in the project.
    Image(String),
}

/// The declarations of all source files of a project.
pub struct Sources {
    files: Vec<File>,
    by_base_name: HashMap<String, Vec<usize>>,
    /// For each file those that it imports, wholly or in part.
    imported: Vec<Vec<usize>>,
    /// File and index of a declaration by node type.
    by_type: HashMap<String, (usize, usize)>,
    problems: Vec<Problem>,
}

/// File and index of a declaration.
pub(crate) type Place = (usize, usize);

pub(crate) use bodies::{Instantiation, Stored};

/// A longer chain of `extends` is taken for an error.
const LONGEST_CHAIN: usize = 100;

impl Sources {
    /// Reads the declarations. Never fails: what cannot be understood is listed in [`Sources::problems`].
    pub fn parse(files: &[SourceFile]) -> Sources {
        let files: Vec<File> = files.iter().map(|file| File::parse(&file.path, &file.text)).collect();
        let mut sources = Sources {
            files,
            by_base_name: HashMap::new(),
            imported: Vec::new(),
            by_type: HashMap::new(),
            problems: Vec::new(),
        };
        for (index, file) in sources.files.iter().enumerate() {
            sources.by_base_name.entry(file.base_name.clone()).or_default().push(index);
            for (name, declaration) in &file.by_name {
                sources.by_type.entry(format!("{}{name}", file.prefix)).or_insert((index, *declaration));
            }
            sources.problems.extend(file.complaints.iter().map(|(line, message)| Problem {
                file: file.path.clone(),
                line: *line,
                message: message.clone(),
            }));
        }
        sources.imported = (0..sources.files.len()).map(|file| sources.imports_of(file)).collect();
        sources
    }

    /// The places that could not be understood.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Resolves a node type such as `test$Leaf`; None if there is no such declaration.
    pub fn resolve(&self, type_name: &str) -> Option<ResolvedModule> {
        self.resolve_within(type_name, MOST_STEPS).map(|(module, _)| module)
    }

    /// As [`Sources::resolve`] with at most that many steps of evaluation; also how many it were.
    pub(crate) fn resolve_within(
        &self,
        type_name: &str,
        most_steps: usize,
    ) -> Option<(ResolvedModule, usize)> {
        let start = self.place(type_name)?;
        let Chain { base, levels, mut unresolved } = self.chain(start);
        let has_body = levels.iter().any(|level| level.declaration.body.is_some());
        let meter = Rc::new(Meter::new(most_steps.min(MOST_STEPS)));
        let mut instance = Instance::new(self, &base, &levels, meter.clone(), Mode::Representative);
        instance.build(&levels, Vec::new());
        let notes = instance.notes.iter();
        unresolved.extend(notes.map(|note| format!("{}:{}: {}", note.file, note.line, note.message)));
        let fields = std::mem::take(&mut instance.fields).into_iter();
        let defaults = fields.map(|(field, value)| FieldDefault { field, value }).collect();
        let declaration = &self.files[start.0].declarations[start.1];
        let declared_at = (self.files[start.0].path.clone(), declaration.line);
        Some((ResolvedModule { base, defaults, has_body, declared_at, unresolved }, meter.steps()))
    }

    /// All node types that are declared, in alphabetical order.
    pub(crate) fn type_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.by_type.keys().map(String::as_str).collect();
        names.sort_unstable();
        names
    }

    /// The declaration of a node type.
    pub(crate) fn place(&self, type_name: &str) -> Option<Place> {
        self.by_type.get(type_name).copied()
    }

    /// The type of the nodes that a declaration makes.
    pub(crate) fn type_name(&self, (file, declaration): Place) -> String {
        let file = &self.files[file];
        format!("{}{}", file.prefix, file.declarations[declaration].full_name)
    }

    /// Follows the `extends` clauses from a declaration to a built-in class.
    fn chain(&self, start: Place) -> Chain<'_> {
        let mut unresolved = Vec::new();
        let mut chain = Vec::new();
        let mut seen = HashSet::new();
        let mut place = start;
        let base = loop {
            let (file, declaration) = (&self.files[place.0], &self.files[place.0].declarations[place.1]);
            if !seen.insert(place) || chain.len() == LONGEST_CHAIN {
                unresolved.push(format!(
                    "{}:{}: '{}' extends itself, so it is treated as a plain node",
                    file.path, declaration.line, declaration.name
                ));
                break builtins::NODE.to_owned();
            }
            chain.push(Level { file: place.0, declaration });
            let Some(base) = &declaration.base else { break builtins::NODE.to_owned() };
            match self.class(place.0, declaration, &base.name) {
                Class::Declared(next) => place = next,
                Class::Builtin(name) => break name,
                Class::Unknown => {
                    unresolved.push(format!(
                        "{}:{}: '{}' extends '{}', which is not a known class",
                        file.path, declaration.line, declaration.name, base.name
                    ));
                    break base.name.clone();
                }
            }
        };
        Chain { base, levels: chain, unresolved }
    }

    /// What a class name means in a declaration.
    fn class(&self, file: usize, declaration: &Declaration, name: &str) -> Class {
        let here = &self.files[file];
        let nested = name.replace('.', "$");
        // From the inside out: nested in the declaration, beside it, at file level.
        let mut outer = declaration.full_name.as_str();
        loop {
            let full = if outer.is_empty() { nested.clone() } else { format!("{outer}${nested}") };
            if let Some(index) = here.by_name.get(&full) {
                return Class::Declared((file, *index));
            }
            if outer.is_empty() {
                break;
            }
            outer = outer.rsplit_once('$').map_or("", |(outer, _)| outer);
        }
        if let Some(place) = self.by_type.get(&nested).or_else(|| self.by_type.get(name)) {
            return Class::Declared(*place);
        }
        let simple = name.rsplit('.').next().unwrap_or(name);
        let declared =
            |file: usize| self.files[file].by_name.get(&nested).map(|i| Class::Declared((file, *i)));
        if let Some(class) = self.imported[file].iter().copied().find_map(declared) {
            return class;
        }
        // A single class that is imported hides a built-in one of the same name.
        let import = here.imports.iter().find(|import| !name.contains('.') && last(import) == name);
        if let Some(class) = builtins::class(import.map_or(name, String::as_str)) {
            return Class::Builtin(class);
        }
        if import.is_some_and(|import| import.contains('.')) && builtins::class(simple).is_some() {
            return Class::Unknown;
        }
        // GroIMP itself would not look into files that are not imported, so they come last.
        (0..self.files.len()).find_map(declared).unwrap_or(Class::Unknown)
    }

    /// The files that a file imports, wholly or in part.
    fn imports_of(&self, file: usize) -> Vec<usize> {
        let parts = self.files[file].imports.iter().flat_map(|import| import.split('.').rev().take(2));
        let mut seen = HashSet::new();
        let named = parts.filter(|part| seen.insert(*part)).filter_map(|part| self.by_base_name.get(part));
        named.flatten().copied().filter(|index| *index != file).collect()
    }

    /// The constant that a name means in a declaration, and its file; in this and the imported files, or in
    /// the others.
    fn constant(&self, file: usize, owner: &str, path: &str, others: bool) -> Option<(usize, &Constant)> {
        let (holder, name) = match path.rsplit_once('.') {
            Some((holder, name)) => (Some(last(holder)), name),
            None => (None, path),
        };
        let holds = |constant: &&Constant, holder: &str| last_nested(&constant.owner) == holder;
        let within = |file: usize| {
            let constants = self.files[file].constants.get(name)?;
            let found = match holder {
                Some(holder) if holder == self.files[file].base_name => {
                    constants.iter().find(|c| c.owner.is_empty() || holds(c, holder))
                }
                Some(holder) => constants.iter().find(|c| holds(c, holder)),
                None => {
                    let mut inner = constants.iter().filter(|c| owner.starts_with(&c.owner));
                    inner.by_ref().max_by_key(|c| c.owner.len()).or_else(|| constants.first())
                }
            };
            found.map(|constant| (file, constant))
        };
        if others {
            return (0..self.files.len()).find_map(within);
        }
        within(file).or_else(|| self.imported[file].iter().copied().find_map(within))
    }
}

/// A module with its base classes.
struct Chain<'a> {
    /// The built-in class at the end, or the name of an unknown one.
    base: String,
    /// The declarations, beginning with the module itself.
    levels: Vec<Level<'a>>,
    unresolved: Vec<String>,
}

enum Class {
    Declared((usize, usize)),
    Builtin(String),
    Unknown,
}

fn last(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

fn last_nested(path: &str) -> &str {
    path.rsplit('$').next().unwrap_or(path)
}
