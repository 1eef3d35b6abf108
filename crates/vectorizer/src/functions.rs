//! Which functions are needed.

use crate::{Options, VectorizeError};
use naga::{Block, Function, Handle, Module, Statement};

/// The roots and all that they call, called functions first.
pub(crate) fn reachable_functions(
    module: &Module,
    options: &Options<'_>,
) -> Result<Vec<Handle<Function>>, VectorizeError> {
    let mut needed = vec![false; module.functions.len()];
    let mut open = Vec::new();
    for (name, _) in options.roots {
        open.push(function_named(module, name)?);
    }
    for (name, _) in options.together {
        open.push(function_named(module, &together_name(name))?);
    }
    while let Some(function) = open.pop() {
        if std::mem::replace(&mut needed[function.index()], true) {
            continue;
        }
        open.extend(called_functions(&module.functions[function].body));
    }
    // WGSL allows no recursion, and naga keeps functions behind those that they call, but for the other forms of some,
    // which the order does not matter for.
    Ok(module.functions.iter().map(|(handle, _)| handle).filter(|handle| needed[handle.index()]).collect())
}

/// The function of the given name.
pub(crate) fn function_named(module: &Module, name: &str) -> Result<Handle<Function>, VectorizeError> {
    let mut functions = module.functions.iter();
    let found = functions.find(|(_, function)| function.name.as_deref() == Some(name));
    found.map(|(handle, _)| handle).ok_or_else(|| VectorizeError::MissingFunction { name: name.to_owned() })
}

/// The form of a function for rays that agree.
pub(crate) fn together_name(name: &str) -> String {
    format!("{name}_together")
}

fn called_functions(body: &Block) -> Vec<Handle<Function>> {
    let mut called = Vec::new();
    each_statement(body, &mut |statement| {
        if let Statement::Call { function, .. } = statement {
            called.push(*function);
        }
    });
    called
}

/// All statements of a block and of the blocks in it.
pub(crate) fn each_statement<'a>(body: &'a Block, visit: &mut impl FnMut(&'a Statement)) {
    let mut open: Vec<&Block> = vec![body];
    while let Some(block) = open.pop() {
        for statement in block {
            visit(statement);
            open.extend(blocks_of(statement));
        }
    }
}

/// The blocks that a statement consists of.
pub(crate) fn blocks_of(statement: &Statement) -> Vec<&Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Switch { cases, .. } => cases.iter().map(|case| &case.body).collect(),
        Statement::Loop { body, continuing, .. } => vec![body, continuing],
        _ => Vec::new(),
    }
}
