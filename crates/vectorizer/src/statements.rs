//! Statements of kernels as Rust with masks.
//!
//! `live` are the rays that execute what is being written. Where a condition differs between them, `live` is narrowed
//! for the branch and restored behind it; rays that have returned are in no mask any more, their results wait in
//! `result`. Rays that have left a loop, or only its current round, wait in `left` and `skipped` until its end.

use crate::expressions::Scope;
use crate::places::{Place, SHORT_ARRAY};
use crate::uniformity::{LoopExits, loop_exits};
use crate::{VectorizeError, Writer};
use naga::{Block, Expression, Function, Handle, Statement};
use std::fmt::Write;

/// Where a block is.
#[derive(Clone, Copy)]
struct Position {
    /// All rays that will ever execute the block do so now: nothing but uniform conditions around it.
    together: bool,
    /// Values that are stored may overwrite those of all lanes.
    overwrites: bool,
    /// Number of the innermost loop, and how rays leave it.
    innermost: Option<(usize, LoopExits)>,
    /// Number of the innermost labelled block, which is left where no ray is live.
    label: Option<usize>,
    /// Rays of the innermost loop are apart.
    diverged_in_loop: bool,
}

/// The text of a function in the making.
struct Body<'a> {
    scope: Scope<'a>,
    text: String,
    numbers: usize,
    /// Whether results of some rays wait.
    has_results: bool,
}

impl Writer<'_> {
    pub(crate) fn write_function(
        &self,
        handle: Handle<Function>,
        text: &mut String,
    ) -> Result<(), VectorizeError> {
        let function = &self.module.functions[handle];
        let uniformity = self.uniformity.function(handle);
        let name = function.name.as_deref().unwrap_or_default();
        let emitted = emitted_expressions(function);
        let scope = Scope { handle, function, uniformity, emitted: &emitted };
        let mut parameters = String::new();
        for (i, argument) in function.arguments.iter().enumerate() {
            _ = write!(parameters, ", a{i}: {}", self.type_name(argument.ty, uniformity.arguments[i])?);
        }
        let result = match &function.result {
            Some(result) => self.type_name(result.ty, uniformity.result)?,
            None => return Err(self.unsupported(function, "no result".to_owned())),
        };
        _ = writeln!(
            text,
            "#[inline]\n#[target_feature(enable = \"{}\")]\npub fn {name}(globals: &Globals<'_>, mask: Mask{parameters}) \
             -> {result} {{\n    let mut live = mask;",
            self.options.target_features
        );
        if !uniformity.result {
            _ = writeln!(text, "    let mut result: {result} = Zero::zero();");
        }
        // Initial values are made of constants alone.
        let constants = Scope { emitted: &vec![false; emitted.len()], ..scope };
        for (variable, local) in function.local_variables.iter() {
            let uniform = uniformity.variables[variable.index()];
            let kind = self.type_name(local.ty, uniform)?;
            let initial = match local.init {
                Some(expression) => self.value(constants, expression, uniform)?,
                None => "Zero::zero()".to_owned(),
            };
            _ = writeln!(text, "    let mut v{}: {kind} = {initial};", variable.index());
        }
        for (variable, global) in self.module.global_variables.iter() {
            if global.space == naga::AddressSpace::Private && uses(function, variable) {
                let name = global.name.as_deref().unwrap_or_default();
                _ = writeln!(text, "    let mut own_{name} = globals.own.{name}.borrow_mut();");
            }
        }
        let mut body = Body { scope, text: String::new(), numbers: 0, has_results: false };
        let position = Position {
            together: true,
            overwrites: true,
            innermost: None,
            label: None,
            diverged_in_loop: false,
        };
        self.write_block(&mut body, &function.body, position)?;
        text.push_str(&body.text);
        let ends_with_return = matches!(function.body.last(), Some(Statement::Return { .. }));
        if !ends_with_return {
            text.push_str(if uniformity.result { "    unreachable!()\n" } else { "    result\n" });
        }
        text.push_str("}\n\n");
        Ok(())
    }

    fn write_block(
        &self,
        body: &mut Body<'_>,
        block: &Block,
        position: Position,
    ) -> Result<(), VectorizeError> {
        let scope = body.scope;
        let last = block.len().saturating_sub(1);
        for (i, statement) in block.iter().enumerate() {
            match statement {
                Statement::Emit(range) => {
                    for expression in range.clone() {
                        if self.is_pointer(scope, expression) {
                            continue;
                        }
                        let value = self.computed(scope, expression)?;
                        _ = writeln!(body.text, "let e{} = {value};", expression.index());
                    }
                }
                Statement::Block(block) => self.write_block(body, block, position)?,
                Statement::If { condition, accept, reject } => {
                    if self.is_uniform(scope, *condition) {
                        let condition = self.value(scope, *condition, true)?;
                        _ = writeln!(body.text, "if {condition} {{");
                        self.write_block(body, accept, position)?;
                        if !reject.is_empty() {
                            body.text.push_str("} else {\n");
                            self.write_block(body, reject, position)?;
                        }
                        body.text.push_str("}\n");
                    } else {
                        self.write_varying_if(body, *condition, accept, reject, position)?;
                    }
                }
                Statement::Loop { body: inner, continuing, break_if } => {
                    self.write_loop(body, inner, continuing, *break_if, position)?;
                }
                Statement::Break => self.write_break(body, position)?,
                Statement::Continue => {
                    let Some((number, _)) = position.innermost else {
                        return Err(
                            self.unsupported(scope.function, "`continue` outside of loops".to_owned())
                        );
                    };
                    _ = writeln!(
                        body.text,
                        "skipped{number} = or(skipped{number}, live);\nlive = Mask::NONE;"
                    );
                }
                Statement::Return { value: Some(value) } => self.write_return(body, *value, position)?,
                Statement::Store { pointer, value } => self.write_store(body, *pointer, *value, position)?,
                Statement::Call { function, arguments, result } => {
                    if let Some(result) = result {
                        _ = write!(body.text, "let e{} = ", result.index());
                    }
                    let call = self.call(scope, *function, arguments)?;
                    _ = writeln!(body.text, "{call};");
                }
                other => return Err(self.unsupported(scope.function, format!("{other:?}"))),
            }
            if i != last && may_end_rays(statement) {
                self.write_guard(body, position);
            }
        }
        Ok(())
    }

    /// A call of a function, or of its form for rays that agree.
    fn call(
        &self,
        scope: Scope<'_>,
        function: Handle<Function>,
        arguments: &[Handle<Expression>],
    ) -> Result<String, VectorizeError> {
        let callee = self.uniformity.function(function);
        let mut given = Vec::new();
        for (argument, uniform) in arguments.iter().zip(&callee.arguments) {
            given.push(self.value(scope, *argument, *uniform)?);
        }
        let name = self.module.functions[function].name.as_deref().unwrap_or_default();
        let call = |name: &str, given: &[String]| {
            let given: String = given.iter().map(|value| format!(", {value}")).collect();
            format!("{name}(globals, live{given})")
        };
        let otherwise = call(name, &given);
        let Some((copy, agreed)) = self.uniformity.together(function) else { return Ok(otherwise) };
        if callee.arguments[agreed] {
            return Ok(otherwise);
        }
        let together = self.module.functions[copy].name.as_deref().unwrap_or_default();
        if self.is_uniform(scope, arguments[agreed]) {
            given[agreed] = self.value(scope, arguments[agreed], true)?;
            return Ok(call(together, &given));
        }
        let value = std::mem::replace(&mut given[agreed], "one".to_owned());
        let agree = call(together, &given);
        Ok(format!("match together(live, {value}) {{ Some(one) => {agree}, None => {otherwise} }}"))
    }

    /// Leaves the block where no ray is live.
    fn write_guard(&self, body: &mut Body<'_>, position: Position) {
        if position.together {
            if !body.scope.uniformity.result {
                body.text.push_str("if live.none() { return result; }\n");
            }
        } else if let Some(label) = position.label {
            _ = writeln!(body.text, "if live.none() {{ break 'block{label}; }}");
        }
    }

    fn write_varying_if(
        &self,
        body: &mut Body<'_>,
        condition: Handle<Expression>,
        accept: &Block,
        reject: &Block,
        position: Position,
    ) -> Result<(), VectorizeError> {
        let condition = self.value(body.scope, condition, false)?;
        let number = body.number();
        _ = writeln!(body.text, "let before{number} = live;\nlet truth{number} = {condition};");
        let inner = Position {
            together: false,
            overwrites: false,
            label: Some(number),
            diverged_in_loop: true,
            ..position
        };
        let mut written = Vec::new();
        for (block, truth) in [(accept, "and(before, truth)"), (reject, "before.without(truth)")] {
            if block.is_empty() {
                continue;
            }
            let truth = truth
                .replace("before", &format!("before{number}"))
                .replace("truth", &format!("truth{number}"));
            _ = writeln!(body.text, "live = {truth};");
            if self.is_short(block) {
                self.write_block(body, block, inner)?;
            } else {
                _ = writeln!(body.text, "if live.any() {{ 'block{number}: {{");
                self.write_block(body, block, inner)?;
                body.text.push_str("} }\n");
            }
            written.push(may_end_rays_in(block));
            if written.len() == 1 && !reject.is_empty() && !accept.is_empty() {
                _ = writeln!(body.text, "let first{number} = live;");
            }
        }
        if written.iter().any(|ends| *ends) {
            let other = match (accept.is_empty(), reject.is_empty()) {
                (false, false) => format!("first{number}"),
                (false, true) => format!("before{number}.without(truth{number})"),
                (true, _) => format!("and(before{number}, truth{number})"),
            };
            _ = writeln!(body.text, "live = or(live, {other});");
        } else {
            _ = writeln!(body.text, "live = before{number};");
        }
        Ok(())
    }

    /// Blocks that cost less than asking whether any ray needs them.
    fn is_short(&self, block: &Block) -> bool {
        let mut expressions = 0;
        for statement in block {
            match statement {
                Statement::Emit(range) => expressions += range.clone().count(),
                Statement::Store { .. } | Statement::Break | Statement::Continue => expressions += 1,
                _ => return false,
            }
        }
        expressions <= 8
    }

    fn write_loop(
        &self,
        body: &mut Body<'_>,
        inner: &Block,
        continuing: &Block,
        break_if: Option<Handle<Expression>>,
        position: Position,
    ) -> Result<(), VectorizeError> {
        let scope = body.scope;
        let number = body.number();
        let mut exits = loop_exits(scope.uniformity, inner, false);
        exits.varying_break |= break_if.is_some_and(|condition| !self.is_uniform(scope, condition));
        _ = writeln!(
            body.text,
            "let mut left{number} = Mask::NONE;\n'loop{number}: loop {{\nlet mut skipped{number} = Mask::NONE;\n\
             'block{number}: {{"
        );
        let round = Position {
            together: false,
            overwrites: position.overwrites && !exits.varying_break && !exits.varying_continue,
            innermost: Some((number, exits)),
            label: Some(number),
            diverged_in_loop: false,
        };
        self.write_block(body, inner, round)?;
        _ = writeln!(
            body.text,
            "}}\nlive = or(live, skipped{number});\nif live.none() {{ break 'loop{number}; }}"
        );
        let between =
            Position { overwrites: position.overwrites && !exits.varying_break, label: None, ..round };
        self.write_block(body, continuing, between)?;
        if let Some(condition) = break_if {
            let ends = self.value(scope, condition, false)?;
            _ = writeln!(
                body.text,
                "let ends{number} = and(live, {ends});\nleft{number} = or(left{number}, ends{number});\n\
                 live = live.without(ends{number});\nif live.none() {{ break 'loop{number}; }}"
            );
        }
        _ = writeln!(body.text, "}}\nlive = left{number};");
        Ok(())
    }

    fn write_break(&self, body: &mut Body<'_>, position: Position) -> Result<(), VectorizeError> {
        let Some((number, exits)) = position.innermost else {
            return Err(self.unsupported(body.scope.function, "`break` outside of loops".to_owned()));
        };
        _ = writeln!(body.text, "left{number} = or(left{number}, live);");
        if !position.diverged_in_loop && !exits.varying_continue {
            // All rays of this round.
            _ = writeln!(body.text, "break 'loop{number};");
        } else {
            body.text.push_str("live = Mask::NONE;\n");
        }
        Ok(())
    }

    fn write_return(
        &self,
        body: &mut Body<'_>,
        value: Handle<Expression>,
        position: Position,
    ) -> Result<(), VectorizeError> {
        let uniform = body.scope.uniformity.result;
        let value = self.value(body.scope, value, uniform)?;
        if uniform || position.together && !body.has_results {
            _ = writeln!(body.text, "return {value};");
        } else if position.together {
            _ = writeln!(body.text, "return blend(live, {value}, result);");
        } else {
            body.has_results = true;
            _ = writeln!(body.text, "assign(live, &mut result, {value});\nlive = Mask::NONE;");
        }
        Ok(())
    }

    fn write_store(
        &self,
        body: &mut Body<'_>,
        pointer: Handle<Expression>,
        value: Handle<Expression>,
        position: Position,
    ) -> Result<(), VectorizeError> {
        let scope = body.scope;
        let variable = crate::uniformity::stored_variable(scope.function, pointer);
        let uniform = variable.is_some_and(|variable| scope.uniformity.variables[variable]);
        let value = self.value(scope, value, uniform)?;
        let (place, _) = self.place(scope, pointer)?;
        match place {
            Place::Variable(name) if uniform || position.overwrites => {
                _ = writeln!(body.text, "{name} = {value};");
            }
            Place::Variable(name) => _ = writeln!(body.text, "assign(live, &mut {name}, {value});"),
            Place::Element { whole, index, length } => {
                if self.is_uniform(scope, index) {
                    let index = self.value(scope, index, true)?;
                    let place = format!("{whole}[({index} as usize).min({})]", length - 1);
                    if uniform || position.overwrites {
                        _ = writeln!(body.text, "{place} = {value};");
                    } else {
                        _ = writeln!(body.text, "assign(live, &mut {place}, {value});");
                    }
                } else {
                    let index = self.value(scope, index, false)?;
                    let put = if length > SHORT_ARRAY { "put_far" } else { "put" };
                    _ = writeln!(body.text, "{put}(live, &mut {whole}, {index}, {value});");
                }
            }
            Place::Table(_) => {
                return Err(self.unsupported(scope.function, "a table that is written to".to_owned()));
            }
        }
        Ok(())
    }

    /// Whether an expression is a place instead of a value.
    fn is_pointer(&self, scope: Scope<'_>, expression: Handle<Expression>) -> bool {
        let ty = self.info[scope.handle][expression].ty.inner_with(&self.module.types);
        matches!(ty, naga::TypeInner::Pointer { .. } | naga::TypeInner::ValuePointer { .. })
    }
}

impl Body<'_> {
    fn number(&mut self) -> usize {
        self.numbers += 1;
        self.numbers
    }
}

fn uses(function: &Function, variable: Handle<naga::GlobalVariable>) -> bool {
    let mut expressions = function.expressions.iter();
    expressions
        .any(|(_, expression)| matches!(expression, Expression::GlobalVariable(other) if *other == variable))
}

fn emitted_expressions(function: &Function) -> Vec<bool> {
    let mut emitted = vec![false; function.expressions.len()];
    crate::functions::each_statement(&function.body, &mut |statement| {
        if let Statement::Emit(range) = statement {
            range.clone().for_each(|expression| emitted[expression.index()] = true);
        }
    });
    emitted
}

/// Whether rays may not execute what follows a statement.
fn may_end_rays(statement: &Statement) -> bool {
    match statement {
        Statement::Break | Statement::Continue | Statement::Return { .. } => false,
        Statement::Loop { body, .. } => returns_in(body),
        other => crate::functions::blocks_of(other).into_iter().any(may_end_rays_in),
    }
}

fn may_end_rays_in(block: &Block) -> bool {
    block.iter().any(|statement| {
        matches!(statement, Statement::Break | Statement::Continue | Statement::Return { .. })
            || may_end_rays(statement)
    })
}

fn returns_in(block: &Block) -> bool {
    let mut found = false;
    crate::functions::each_statement(block, &mut |statement| {
        found |= matches!(statement, Statement::Return { .. });
    });
    found
}
