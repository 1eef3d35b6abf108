//! What pointers lead to: variables, elements of arrays, parts of tables.

use crate::expressions::Scope;
use crate::layout::TablePlace;
use crate::{VectorizeError, Writer};
use naga::{AddressSpace, Expression, Function, Handle, Type, TypeInner};

/// Arrays of integers that are longer than this stay in memory.
pub(crate) const SHORT_ARRAY: u32 = 8;

/// What a pointer leads to.
pub(crate) enum Place {
    /// Rust for a variable or a part of it.
    Variable(String),
    /// A component of a variable by a number that is computed: the variable, the number, the type of the whole.
    Element { whole: String, index: Handle<Expression>, length: u32 },
    /// A part of a table.
    Table(TablePlace),
}

impl Writer<'_> {
    /// Type and place of a field of a record.
    pub(crate) fn member_place(
        &self,
        function: &Function,
        ty: Handle<Type>,
        index: u32,
        place: TablePlace,
    ) -> Result<(Handle<Type>, TablePlace), VectorizeError> {
        match &self.module.types[ty].inner {
            TypeInner::Struct { members, .. } => {
                let member = &members[index as usize];
                Ok((member.ty, TablePlace { offset: place.offset + member.offset / 4, ..place }))
            }
            other => Err(self.unsupported(function, format!("a field of {other:?} in a table"))),
        }
    }

    /// What a pointer leads to, and its type.
    pub(crate) fn place(
        &self,
        scope: Scope<'_>,
        pointer: Handle<Expression>,
    ) -> Result<(Place, Handle<Type>), VectorizeError> {
        // From the variable outwards.
        let mut steps = Vec::new();
        let mut root = pointer;
        while let Expression::Access { base, .. } | Expression::AccessIndex { base, .. } =
            &scope.function.expressions[root]
        {
            steps.push(root);
            root = *base;
        }
        let (mut place, mut ty) = match &scope.function.expressions[root] {
            Expression::LocalVariable(variable) => {
                let ty = scope.function.local_variables[*variable].ty;
                (Place::Variable(format!("v{}", variable.index())), ty)
            }
            Expression::GlobalVariable(variable) => {
                let global = &self.module.global_variables[*variable];
                let name = global.name.as_deref().unwrap_or_default();
                match global.space {
                    AddressSpace::Uniform => (Place::Variable(format!("globals.{name}")), global.ty),
                    AddressSpace::Storage { access } if !access.contains(naga::StorageAccess::STORE) => {
                        let place = TablePlace {
                            table: *variable,
                            word: "0u32".to_owned(),
                            offset: 0,
                            uniform: true,
                        };
                        (Place::Table(place), global.ty)
                    }
                    // Rays have each their own.
                    AddressSpace::Private => (Place::Variable(format!("(*own_{name})")), global.ty),
                    _ => return Err(self.unsupported(scope.function, format!("the variable {name}"))),
                }
            }
            other => return Err(self.unsupported(scope.function, format!("a pointer {other:?}"))),
        };
        for step in steps.into_iter().rev() {
            let inner = &self.module.types[ty].inner;
            // A variable that holds a record leads on into the table.
            if let (Place::Variable(name), Some(table)) = (&place, self.records.table(ty)) {
                let uniform = self.is_uniform(scope, root);
                place = Place::Table(TablePlace { table, word: name.clone(), offset: 0, uniform });
            }
            match (&scope.function.expressions[step], place) {
                (Expression::AccessIndex { index, .. }, Place::Variable(name)) => {
                    let field = self.field_name(scope.function, inner, *index)?;
                    place = Place::Variable(format!("{name}{field}"));
                    ty = self.part_type(scope.function, inner, *index)?;
                }
                (Expression::AccessIndex { index, .. }, Place::Table(table)) => {
                    if let TypeInner::Vector { scalar, .. } = inner {
                        place = Place::Table(TablePlace { offset: table.offset + index, ..table });
                        ty = self.scalar_type(scope.function, *scalar)?;
                    } else {
                        let (member, at) = self.member_place(scope.function, ty, *index, table)?;
                        place = Place::Table(at);
                        ty = member;
                    }
                }
                (Expression::Access { index, .. }, Place::Table(table)) => {
                    let TypeInner::Array { base, stride, .. } = inner else {
                        return Err(
                            self.unsupported(scope.function, "a numbered part of a record".to_owned())
                        );
                    };
                    let uniform = self.is_uniform(scope, *index);
                    let number = self.operand(scope, *index)?;
                    let words = stride / 4;
                    let word = match (words, uniform) {
                        (1, _) => number,
                        (_, true) => format!("multiply({number}, {words}u32)"),
                        (_, false) => format!("multiply({number}, widen({words}u32))"),
                    };
                    place = Place::Table(TablePlace { word, uniform, ..table });
                    ty = *base;
                }
                (Expression::Access { index, .. }, Place::Variable(name)) => {
                    let TypeInner::Array { base, size: naga::ArraySize::Constant(size), .. } = inner else {
                        return Err(self.unsupported(scope.function, "a numbered component".to_owned()));
                    };
                    place = Place::Element { whole: name, index: *index, length: size.get() };
                    ty = *base;
                }
                (_, _) => {
                    return Err(self.unsupported(scope.function, "a part of a numbered part".to_owned()));
                }
            }
        }
        Ok((place, ty))
    }

    fn part_type(
        &self,
        function: &Function,
        inner: &TypeInner,
        index: u32,
    ) -> Result<Handle<Type>, VectorizeError> {
        match inner {
            TypeInner::Struct { members, .. } => Ok(members[index as usize].ty),
            TypeInner::Vector { scalar, .. } => self.scalar_type(function, *scalar),
            TypeInner::Array { base, .. } => Ok(*base),
            other => Err(self.unsupported(function, format!("a part of {other:?}"))),
        }
    }

    fn scalar_type(&self, function: &Function, scalar: naga::Scalar) -> Result<Handle<Type>, VectorizeError> {
        let mut types = self.module.types.iter();
        let found = types.find(|(_, ty)| matches!(ty.inner, TypeInner::Scalar(other) if other == scalar));
        found.map(|(handle, _)| handle).ok_or_else(|| self.unsupported(function, format!("{scalar:?}")))
    }

    pub(crate) fn loaded(
        &self,
        scope: Scope<'_>,
        pointer: Handle<Expression>,
    ) -> Result<String, VectorizeError> {
        let (place, ty) = self.place(scope, pointer)?;
        match place {
            Place::Variable(name) => Ok(name),
            Place::Table(place) => self.fetched(scope.function, ty, &place),
            Place::Element { whole, index, length } => {
                if self.is_uniform(scope, index) {
                    let index = self.operand(scope, index)?;
                    return Ok(format!("{whole}[({index} as usize).min({})]", length - 1));
                }
                // A variable whose parts differ between rays is one in lanes.
                let index = self.value(scope, index, false)?;
                if length > SHORT_ARRAY {
                    return Ok(format!("choose_far(live, &{whole}, {index})"));
                }
                Ok(format!("choose({whole}, {index})"))
            }
        }
    }
}
