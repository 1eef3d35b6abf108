//! Which values are the same for all rays.
//!
//! Everything is until something says otherwise: parameters that are given values that differ, results that depend on
//! them, variables that are set where some rays are not. What is found is carried through all functions until nothing
//! changes.

use crate::functions::{function_named, together_name};
use crate::{Options, VectorizeError};
use naga::{Block, Expression, Function, Handle, Module, Statement};
use std::collections::HashMap;

/// What is uniform in one function.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FunctionUniformity {
    pub arguments: Vec<bool>,
    pub variables: Vec<bool>,
    pub expressions: Vec<bool>,
    pub result: bool,
}

/// How rays leave a loop early.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LoopExits {
    /// Some rays end the loop before others.
    pub varying_break: bool,
    /// Some rays skip the rest of a round.
    pub varying_continue: bool,
}

/// What is uniform in every function.
pub(crate) struct Uniformity {
    functions: HashMap<Handle<Function>, FunctionUniformity>,
    /// The forms of functions for rays that agree on a parameter.
    together: HashMap<Handle<Function>, (Handle<Function>, usize)>,
}

impl Uniformity {
    pub(crate) fn of(
        module: &Module,
        functions: &[Handle<Function>],
        options: &Options<'_>,
    ) -> Result<Self, VectorizeError> {
        let start = |handle: &Handle<Function>| {
            let function = &module.functions[*handle];
            let facts = FunctionUniformity {
                arguments: vec![true; function.arguments.len()],
                variables: vec![true; function.local_variables.len()],
                expressions: vec![true; function.expressions.len()],
                result: true,
            };
            (*handle, facts)
        };
        let mut found =
            Uniformity { functions: functions.iter().map(start).collect(), together: HashMap::new() };
        for (name, argument) in options.together {
            let copy = function_named(module, &together_name(name))?;
            found.together.insert(function_named(module, name)?, (copy, *argument));
            if let Some(facts) = found.functions.get_mut(&copy) {
                facts.result = false;
            }
        }
        for (name, varying) in options.roots {
            let handle = function_named(module, name)?;
            if let Some(facts) = found.functions.get_mut(&handle) {
                for (uniform, varies) in facts.arguments.iter_mut().zip(*varying) {
                    *uniform = !varies;
                }
                facts.result = false;
            }
        }
        let mut changed = true;
        while changed {
            changed = false;
            for handle in functions {
                changed |= found.visit(module, *handle);
            }
        }
        Ok(found)
    }

    pub(crate) fn function(&self, handle: Handle<Function>) -> &FunctionUniformity {
        &self.functions[&handle]
    }

    /// The form of a function for rays that agree on a parameter, and that parameter's number.
    pub(crate) fn together(&self, handle: Handle<Function>) -> Option<(Handle<Function>, usize)> {
        self.together.get(&handle).copied()
    }

    /// Looks at a function again; whether anything was learnt.
    fn visit(&mut self, module: &Module, handle: Handle<Function>) -> bool {
        let function = &module.functions[handle];
        let mut facts = self.functions[&handle].clone();
        self.visit_expressions(module, function, &mut facts);
        let mut calls = Vec::new();
        visit_block(function, &mut facts, &function.body, Divergence::default(), &mut calls);
        let mut changed = facts != self.functions[&handle];
        self.functions.insert(handle, facts);
        for (callee, arguments) in calls {
            let copy = self.together(callee);
            let callees = [Some((callee, usize::MAX)), copy].into_iter().flatten();
            for (callee, agreed) in callees {
                let Some(facts) = self.functions.get_mut(&callee) else { continue };
                for (number, (uniform, given)) in facts.arguments.iter_mut().zip(&arguments).enumerate() {
                    let given = *given || number == agreed;
                    changed |= *uniform && !given;
                    *uniform &= given;
                }
            }
        }
        changed
    }

    fn visit_expressions(&self, module: &Module, function: &Function, facts: &mut FunctionUniformity) {
        // Operands stand before what uses them.
        for (handle, expression) in function.expressions.iter() {
            let uniform = |other: &Handle<Expression>| facts.expressions[other.index()];
            let result = match expression {
                Expression::FunctionArgument(number) => facts.arguments[*number as usize],
                Expression::LocalVariable(variable) => facts.variables[variable.index()],
                Expression::GlobalVariable(variable) => {
                    module.global_variables[*variable].space != naga::AddressSpace::Private
                }
                Expression::CallResult(callee) => {
                    self.functions.get(callee).is_some_and(|callee| callee.result)
                }
                Expression::Compose { components, .. } => components.iter().all(uniform),
                Expression::Access { base, index } => uniform(base) && uniform(index),
                Expression::AccessIndex { base, .. } => uniform(base),
                Expression::Splat { value, .. } => uniform(value),
                Expression::Swizzle { vector, .. } => uniform(vector),
                Expression::Load { pointer } => uniform(pointer),
                Expression::Unary { expr, .. } | Expression::As { expr, .. } => uniform(expr),
                Expression::Binary { left, right, .. } => uniform(left) && uniform(right),
                Expression::Select { condition, accept, reject } => {
                    uniform(condition) && uniform(accept) && uniform(reject)
                }
                Expression::Relational { argument, .. } => uniform(argument),
                Expression::Math { arg, arg1, arg2, arg3, .. } => {
                    [Some(arg), arg1.as_ref(), arg2.as_ref(), arg3.as_ref()]
                        .into_iter()
                        .flatten()
                        .all(uniform)
                }
                _ => true,
            };
            facts.expressions[handle.index()] = result;
        }
    }
}

/// Where the walk through a function is.
#[derive(Clone, Copy, Default)]
struct Divergence {
    /// Some rays that are still needed in this function are not here.
    function: bool,
    /// The same since the innermost loop has begun.
    in_loop: bool,
}

type Call = (Handle<Function>, Vec<bool>);

fn visit_block(
    function: &Function,
    facts: &mut FunctionUniformity,
    block: &Block,
    divergence: Divergence,
    calls: &mut Vec<Call>,
) {
    for statement in block {
        match statement {
            Statement::If { condition, accept, reject } => {
                let varies = !facts.expressions[condition.index()];
                let inner = Divergence {
                    function: divergence.function || varies,
                    in_loop: divergence.in_loop || varies,
                };
                visit_block(function, facts, accept, inner, calls);
                visit_block(function, facts, reject, inner, calls);
            }
            Statement::Block(block) => visit_block(function, facts, block, divergence, calls),
            Statement::Loop { body, continuing, break_if } => {
                let mut exits = loop_exits(facts, body, false);
                exits.varying_break |= break_if.is_some_and(|handle| !facts.expressions[handle.index()]);
                let ends_apart = divergence.function || exits.varying_break;
                let apart = Divergence { function: ends_apart || exits.varying_continue, in_loop: false };
                visit_block(function, facts, body, apart, calls);
                let together = Divergence { function: ends_apart, in_loop: false };
                visit_block(function, facts, continuing, together, calls);
            }
            Statement::Store { pointer, value } => {
                if let Some(variable) = stored_variable(function, *pointer) {
                    let uniform = !divergence.function
                        && facts.expressions[value.index()]
                        && indices_are_uniform(function, facts, *pointer);
                    facts.variables[variable] &= uniform;
                }
            }
            Statement::Return { value: Some(value) } => {
                facts.result &= !divergence.function && facts.expressions[value.index()];
            }
            Statement::Call { function: callee, arguments, .. } => {
                let given = arguments.iter().map(|argument| facts.expressions[argument.index()]);
                calls.push((*callee, given.collect()));
            }
            _ => {}
        }
    }
}

/// How rays leave a loop with the given body; `diverged`: some are not here since the loop has begun.
pub(crate) fn loop_exits(facts: &FunctionUniformity, body: &Block, diverged: bool) -> LoopExits {
    let mut exits = LoopExits::default();
    let mut open = vec![(body, diverged)];
    while let Some((block, diverged)) = open.pop() {
        for statement in block {
            match statement {
                Statement::Break => exits.varying_break |= diverged,
                Statement::Continue => exits.varying_continue |= diverged,
                Statement::If { condition, accept, reject } => {
                    let varies = diverged || !facts.expressions[condition.index()];
                    open.extend([(accept, varies), (reject, varies)]);
                }
                Statement::Block(block) => open.push((block, diverged)),
                // Loops within have exits of their own.
                _ => {}
            }
        }
    }
    exits
}

/// The variable that a pointer leads into.
pub(crate) fn stored_variable(function: &Function, pointer: Handle<Expression>) -> Option<usize> {
    let mut pointer = pointer;
    loop {
        match &function.expressions[pointer] {
            Expression::LocalVariable(variable) => return Some(variable.index()),
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => pointer = *base,
            _ => return None,
        }
    }
}

fn indices_are_uniform(function: &Function, facts: &FunctionUniformity, pointer: Handle<Expression>) -> bool {
    let mut pointer = pointer;
    loop {
        match &function.expressions[pointer] {
            Expression::Access { base, index } => {
                if !facts.expressions[index.index()] {
                    return false;
                }
                pointer = *base;
            }
            Expression::AccessIndex { base, .. } => pointer = *base,
            _ => return true,
        }
    }
}
