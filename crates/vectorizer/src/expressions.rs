//! Expressions of kernels as Rust.

use crate::layout::TablePlace;
use crate::structures::{COMPONENTS, scalar_name};
use crate::uniformity::FunctionUniformity;
use crate::{VectorizeError, Writer};
use naga::{
    BinaryOperator, Expression, Function, Handle, Literal, MathFunction, Type, TypeInner, UnaryOperator,
};

/// The function that is being written.
#[derive(Clone, Copy)]
pub(crate) struct Scope<'a> {
    pub handle: Handle<Function>,
    pub function: &'a Function,
    pub uniformity: &'a FunctionUniformity,
    /// Which expressions are computed by a statement.
    pub emitted: &'a [bool],
}

impl Writer<'_> {
    pub(crate) fn is_uniform(&self, scope: Scope<'_>, expression: Handle<Expression>) -> bool {
        scope.uniformity.expressions[expression.index()]
    }

    fn inner<'b>(&'b self, scope: Scope<'b>, expression: Handle<Expression>) -> &'b TypeInner {
        self.info[scope.handle][expression].ty.inner_with(&self.module.types)
    }

    fn type_handle(&self, scope: Scope<'_>, expression: Handle<Expression>) -> Option<Handle<Type>> {
        self.info[scope.handle][expression].ty.handle()
    }

    /// Rust for a value, in lanes if asked for.
    pub(crate) fn value(
        &self,
        scope: Scope<'_>,
        expression: Handle<Expression>,
        uniform: bool,
    ) -> Result<String, VectorizeError> {
        let text = self.operand(scope, expression)?;
        if self.is_uniform(scope, expression) && !uniform { Ok(format!("widen({text})")) } else { Ok(text) }
    }

    /// Rust for a value that was computed before, or needs no computation.
    pub(crate) fn operand(
        &self,
        scope: Scope<'_>,
        expression: Handle<Expression>,
    ) -> Result<String, VectorizeError> {
        match &scope.function.expressions[expression] {
            Expression::Literal(literal) => self.literal(scope.function, literal),
            Expression::Constant(constant) => {
                self.constant(scope.function, self.module.constants[*constant].init)
            }
            Expression::ZeroValue(ty) => {
                let uniform = self.is_uniform(scope, expression);
                Ok(format!("<{} as Zero>::zero()", self.type_name(*ty, uniform)?))
            }
            Expression::FunctionArgument(number) => Ok(format!("a{number}")),
            // Values made of constants are written where they are used.
            Expression::Compose { .. } | Expression::Splat { .. } if !scope.emitted[expression.index()] => {
                self.computed(scope, expression)
            }
            _ => Ok(format!("e{}", expression.index())),
        }
    }

    fn literal(&self, function: &Function, literal: &Literal) -> Result<String, VectorizeError> {
        match literal {
            Literal::F32(value) => Ok(format!("{value:?}f32")),
            Literal::U32(value) => Ok(format!("{value}u32")),
            Literal::I32(value) => Ok(format!("({value}i32)")),
            Literal::Bool(value) => Ok(value.to_string()),
            other => Err(self.unsupported(function, format!("the literal {other:?}"))),
        }
    }

    fn constant(
        &self,
        function: &Function,
        expression: Handle<Expression>,
    ) -> Result<String, VectorizeError> {
        match &self.module.global_expressions[expression] {
            Expression::Literal(literal) => self.literal(function, literal),
            other => Err(self.unsupported(function, format!("the constant {other:?}"))),
        }
    }

    /// Rust for what an expression computes.
    pub(crate) fn computed(
        &self,
        scope: Scope<'_>,
        expression: Handle<Expression>,
    ) -> Result<String, VectorizeError> {
        let uniform = self.is_uniform(scope, expression);
        let value = |other: &Handle<Expression>| self.value(scope, *other, uniform);
        match &scope.function.expressions[expression] {
            Expression::Compose { ty, components } => self.composed(scope, *ty, components, uniform),
            Expression::AccessIndex { base, index } => self.part(scope, *base, *index, expression),
            Expression::Access { base, index } => {
                let whole = value(base)?;
                let (fields, _) = self.elements(scope, *base)?;
                if uniform {
                    let index = value(index)?;
                    return Ok(format!(
                        "{{ let all = {whole}; [{}][{index} as usize] }}",
                        joined(&fields, "all")
                    ));
                }
                Ok(format!(
                    "{{ let all = {whole}; choose([{}], {}) }}",
                    joined(&fields, "all"),
                    self.value(scope, *index, false)?
                ))
            }
            Expression::Splat { size, value: part } => {
                let part = value(part)?;
                let fields = COMPONENTS.iter().take(*size as usize).map(|name| format!("{name}: part"));
                let fields: Vec<String> = fields.collect();
                Ok(format!("{{ let part = {part}; V{} {{ {} }} }}", *size as u8, fields.join(", ")))
            }
            Expression::Swizzle { size, vector, pattern } => {
                let whole = value(vector)?;
                let fields = COMPONENTS.iter().zip(pattern).take(*size as usize);
                let fields: Vec<String> =
                    fields.map(|(name, of)| format!("{name}: all.{}", COMPONENTS[*of as usize])).collect();
                Ok(format!("{{ let all = {whole}; V{} {{ {} }} }}", *size as u8, fields.join(", ")))
            }
            Expression::Load { pointer } => self.loaded(scope, *pointer),
            Expression::Unary { op, expr } => {
                let name = if *op == UnaryOperator::Negate { "negate" } else { "not" };
                Ok(format!("{name}({})", value(expr)?))
            }
            Expression::Binary { op, left, right } => self.binary(scope, *op, *left, *right, uniform),
            Expression::Select { condition, accept, reject } => {
                let (yes, no) = (value(accept)?, value(reject)?);
                let condition_text = self.operand(scope, *condition)?;
                if let TypeInner::Vector { size, .. } = self.inner(scope, *condition) {
                    let fields = COMPONENTS.iter().take(*size as usize);
                    let fields: Vec<String> = fields
                        .map(|name| format!("{name}: pick(which.{name}, yes.{name}, no.{name})"))
                        .collect();
                    let which = value(condition)?;
                    let size = *size as u8;
                    return Ok(format!(
                        "{{ let (which, yes, no) = ({which}, {yes}, {no}); V{size} {{ {} }} }}",
                        fields.join(", ")
                    ));
                }
                if self.is_uniform(scope, *condition) {
                    Ok(format!("if {condition_text} {{ {yes} }} else {{ {no} }}"))
                } else {
                    Ok(format!("blend({condition_text}, {yes}, {no})"))
                }
            }
            Expression::Math { fun, arg, arg1, arg2, .. } => {
                let arguments: Vec<String> = [Some(arg), arg1.as_ref(), arg2.as_ref()]
                    .into_iter()
                    .flatten()
                    .map(value)
                    .collect::<Result<_, _>>()?;
                self.mathematics(scope, *fun, &arguments.join(", "), uniform)
            }
            Expression::As { expr, kind, convert } => {
                let (from, name) = match self.inner(scope, *expr) {
                    TypeInner::Scalar(scalar) => (*scalar, String::from("{}")),
                    TypeInner::Vector { size, scalar } => (*scalar, format!("V{}<{{}}>", *size as u8)),
                    other => {
                        return Err(self.unsupported(scope.function, format!("a conversion of {other:?}")));
                    }
                };
                let operand = value(expr)?;
                if from.kind == *kind {
                    return Ok(operand);
                }
                let to = scalar_name(naga::Scalar { kind: *kind, width: 4 }, uniform)
                    .ok_or_else(|| self.unsupported(scope.function, format!("a conversion to {kind:?}")))?;
                let to = name.replace("{}", to);
                Ok(match convert {
                    Some(_) => format!("Convert::<{to}>::convert({operand})"),
                    None => format!("Reinterpret::<{to}>::reinterpret({operand})"),
                })
            }
            other => Err(self.unsupported(scope.function, format!("{other:?}"))),
        }
    }

    fn composed(
        &self,
        scope: Scope<'_>,
        ty: Handle<Type>,
        components: &[Handle<Expression>],
        uniform: bool,
    ) -> Result<String, VectorizeError> {
        let values: Vec<String> =
            components.iter().map(|part| self.value(scope, *part, uniform)).collect::<Result<_, _>>()?;
        let name = self.type_name(ty, uniform)?;
        match &self.module.types[ty].inner {
            TypeInner::Struct { members, .. } => {
                let fields = members.iter().zip(&values);
                let fields: Vec<String> = fields
                    .map(|(member, value)| {
                        format!("{}: {value}", member.name.as_deref().unwrap_or("unnamed"))
                    })
                    .collect();
                Ok(format!("{name} {{ {} }}", fields.join(", ")))
            }
            TypeInner::Vector { size, .. } => {
                // Parts may be vectors themselves.
                let mut parts = Vec::new();
                for (component, value) in components.iter().zip(values) {
                    match self.inner(scope, *component) {
                        TypeInner::Vector { size, .. } => {
                            parts.extend(
                                COMPONENTS.iter().take(*size as usize).map(|name| format!("{value}.{name}")),
                            );
                        }
                        _ => parts.push(value),
                    }
                }
                let fields: Vec<String> =
                    COMPONENTS.iter().zip(parts).map(|(name, part)| format!("{name}: {part}")).collect();
                Ok(format!("V{} {{ {} }}", *size as u8, fields.join(", ")))
            }
            TypeInner::Array { .. } => Ok(format!("[{}]", values.join(", "))),
            other => Err(self.unsupported(scope.function, format!("a value of type {other:?}"))),
        }
    }

    /// A field of a value.
    fn part(
        &self,
        scope: Scope<'_>,
        base: Handle<Expression>,
        index: u32,
        _expression: Handle<Expression>,
    ) -> Result<String, VectorizeError> {
        let whole = self.operand(scope, base)?;
        if let Some(ty) = self.type_handle(scope, base)
            && let Some(table) = self.records.table(ty)
        {
            let place = TablePlace { table, word: whole, offset: 0, uniform: self.is_uniform(scope, base) };
            let (member, place) = self.member_place(scope.function, ty, index, place)?;
            return self.fetched(scope.function, member, &place);
        }
        let field = self.field_name(scope.function, self.inner(scope, base), index)?;
        Ok(format!("{whole}{field}"))
    }

    pub(crate) fn field_name(
        &self,
        function: &Function,
        inner: &TypeInner,
        index: u32,
    ) -> Result<String, VectorizeError> {
        match inner {
            TypeInner::Struct { members, .. } => {
                Ok(format!(".{}", members[index as usize].name.as_deref().unwrap_or("unnamed")))
            }
            TypeInner::Vector { .. } => Ok(format!(".{}", COMPONENTS[index as usize])),
            TypeInner::Array { .. } => Ok(format!("[{index}]")),
            other => Err(self.unsupported(function, format!("a part of {other:?}"))),
        }
    }

    /// How the components of a vector or an array are written behind its name, and how many there are.
    fn elements(
        &self,
        scope: Scope<'_>,
        base: Handle<Expression>,
    ) -> Result<(Vec<String>, u32), VectorizeError> {
        match self.inner(scope, base) {
            TypeInner::Vector { size, .. } => {
                let count = *size as usize;
                Ok((COMPONENTS.iter().take(count).map(|name| format!(".{name}")).collect(), count as u32))
            }
            TypeInner::Array { size: naga::ArraySize::Constant(size), .. } => {
                Ok(((0..size.get()).map(|i| format!("[{i}]")).collect(), size.get()))
            }
            other => Err(self.unsupported(scope.function, format!("a numbered part of {other:?}"))),
        }
    }

    fn binary(
        &self,
        scope: Scope<'_>,
        op: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
        uniform: bool,
    ) -> Result<String, VectorizeError> {
        use BinaryOperator as Op;
        let (a, b) = (self.value(scope, left, uniform)?, self.value(scope, right, uniform)?);
        if op == Op::Multiply {
            let is_vector = |operand| matches!(self.inner(scope, operand), TypeInner::Vector { .. });
            match (is_vector(left), is_vector(right)) {
                (true, false) => return Ok(format!("scale({a}, {b})")),
                (false, true) => return Ok(format!("scale({b}, {a})")),
                _ => {}
            }
        }
        let name = match op {
            Op::Add => "add",
            Op::Subtract => "subtract",
            Op::Multiply => "multiply",
            Op::Divide => "divide",
            Op::Modulo => "modulo",
            Op::Equal => "equal",
            Op::NotEqual => "not_equal",
            Op::Less => "less",
            Op::LessEqual => "less_equal",
            Op::Greater => "greater",
            Op::GreaterEqual => "greater_equal",
            Op::And | Op::LogicalAnd => "and",
            Op::InclusiveOr | Op::LogicalOr => "or",
            Op::ExclusiveOr => "xor",
            Op::ShiftLeft => "shift_left",
            Op::ShiftRight => "shift_right",
        };
        Ok(format!("{name}({a}, {b})"))
    }

    fn mathematics(
        &self,
        scope: Scope<'_>,
        function: MathFunction,
        arguments: &str,
        _uniform: bool,
    ) -> Result<String, VectorizeError> {
        use MathFunction as Math;
        let plain = match function {
            Math::Abs => "abs",
            Math::Min => "min",
            Math::Max => "max",
            Math::Clamp => "clamp",
            Math::Floor => "floor",
            Math::Ceil => "ceil",
            Math::Trunc => "trunc",
            Math::Sqrt => "sqrt",
            Math::Dot => "dot",
            Math::Cross => "cross",
            Math::Normalize => "normalize",
            Math::Reflect => "reflect",
            Math::ReverseBits => "reverse_bits",
            Math::CountOneBits => "count_one_bits",
            Math::CountTrailingZeros => "count_trailing_zeros",
            _ => "",
        };
        if !plain.is_empty() {
            return Ok(format!("{plain}({arguments})"));
        }
        let by_lane = match function {
            Math::Sin => "sin",
            Math::Cos => "cos",
            Math::Tan => "tan",
            Math::Asin => "asin",
            Math::Acos => "acos",
            Math::Atan => "atan",
            Math::Atan2 => "atan2",
            Math::Exp => "exp",
            Math::Exp2 => "exp2",
            Math::Log => "log",
            Math::Pow => "pow",
            other => return Err(self.unsupported(scope.function, format!("the function {other:?}"))),
        };
        Ok(format!("{by_lane}(live, {arguments})"))
    }
}

fn joined(fields: &[String], of: &str) -> String {
    fields.iter().map(|field| format!("{of}{field}")).collect::<Vec<_>>().join(", ")
}
