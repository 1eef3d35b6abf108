//! What the node types of a file mean: a class of GroIMP, or a module that extends one.

use crate::Limits;
use crate::classes::Class;
use crate::fields::Defaults;
use crate::graph::Graph;
use crate::modules::{Place, ResolvedModule, Sources};
use crate::report::{Location, Report};
use crate::values::Symbol;
use std::collections::HashMap;

/// Steps that the declarations of all types of a file may take; a field that gets a value takes at least one.
const MOST_STEPS: usize = 5_000_000;

/// What a node type means.
pub(crate) struct Type {
    pub class: Class,
    /// The module, if it has a body after `==>`.
    pub body: Option<Place>,
    /// What missing fields mean, where this differs from the class.
    pub defaults: Defaults,
    /// What nodes of this type lack.
    notes: Vec<(String, Option<Location>)>,
}

impl Type {
    /// Notes what a node of this type lacks.
    pub fn report(&self, node: Option<Location>, report: &mut Report) {
        for (message, location) in &self.notes {
            report.warn(message.clone(), location.clone().or_else(|| node.clone()));
        }
    }
}

/// All types of a file.
pub(crate) struct Types(HashMap<Symbol, Type>);

impl Types {
    pub fn new(graph: &Graph, sources: &Sources, limits: Limits) -> Self {
        let mut types = HashMap::new();
        let mut steps_left = limits.body_steps.min(MOST_STEPS);
        for node in &graph.nodes {
            let name = graph.values.name(node.type_name);
            types.entry(node.type_name).or_insert_with(|| read_type(name, sources, &mut steps_left));
        }
        Types(types)
    }

    /// The class of the type of that name.
    pub fn class(&self, name: Symbol) -> Option<Class> {
        self.0.get(&name).map(|known| known.class)
    }

    /// The type of that name in the file.
    pub fn get(&self, name: Symbol) -> Option<&Type> {
        self.0.get(&name)
    }
}

fn read_type(name: &str, sources: &Sources, steps_left: &mut usize) -> Type {
    if let Some(class) = Class::of(name) {
        return Type { class, body: None, defaults: Defaults::new(), notes: Vec::new() };
    }
    let plain = |message| {
        let notes = vec![(message, None)];
        Type { class: Class::Plain, body: None, defaults: Defaults::new(), notes }
    };
    if *steps_left == 0 {
        let message = "the declarations of the modules are too involved; nodes of some types draw nothing";
        return plain(message.to_owned());
    }
    match sources.resolve_within(name, *steps_left) {
        Some((module, steps)) => {
            *steps_left = steps_left.saturating_sub(steps);
            let body = sources.place(name).filter(|_| module.has_body);
            module_type(name, module, body)
        }
        None => plain(format!(
            "the type '{name}' is not known; its nodes draw nothing, what is below them is kept"
        )),
    }
}

fn module_type(name: &str, module: ResolvedModule, body: Option<Place>) -> Type {
    let (file, line) = module.declared_at;
    let declared = Some(Location { file, line });
    let mut notes = Vec::new();
    let class = Class::of(&module.base).unwrap_or_else(|| {
        let base = &module.base;
        let message = format!("module {name} extends '{base}', which is not known; its nodes draw nothing");
        notes.push((message, declared.clone()));
        Class::Plain
    });
    for problem in module.unresolved {
        notes.push((format!("module {name}: {problem}"), declared.clone()));
    }
    let defaults = module.defaults.into_iter().map(|default| (default.field, default.value)).collect();
    Type { class, body, defaults, notes }
}
