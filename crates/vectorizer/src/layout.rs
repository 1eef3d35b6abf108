//! Fields of tables: the words of 32 bits that they lie in.

use crate::{VectorizeError, Writer};
use naga::{Function, GlobalVariable, Handle, Scalar, ScalarKind, Type, TypeInner};

/// A place in a table that an expression stands for.
#[derive(Clone, Debug)]
pub(crate) struct TablePlace {
    pub table: Handle<GlobalVariable>,
    /// Rust for the number of the first word.
    pub word: String,
    /// Words behind that one.
    pub offset: u32,
    pub uniform: bool,
}

impl Writer<'_> {
    /// Rust for the value of a type at a place of a table.
    pub(crate) fn fetched(
        &self,
        function: &Function,
        ty: Handle<Type>,
        place: &TablePlace,
    ) -> Result<String, VectorizeError> {
        if self.records.table(ty).is_some() {
            return Ok(place.number());
        }
        match &self.module.types[ty].inner {
            TypeInner::Scalar(scalar) => self.fetched_number(function, *scalar, place, 0),
            TypeInner::Vector { size, scalar } => {
                let parts = (0..u32::from(*size as u8)).map(|i| {
                    let value = self.fetched_number(function, *scalar, place, i)?;
                    Ok(format!("{}: {value}", crate::structures::COMPONENTS[i as usize]))
                });
                let parts: Vec<String> = parts.collect::<Result<_, VectorizeError>>()?;
                Ok(format!("V{} {{ {} }}", *size as u8, parts.join(", ")))
            }
            TypeInner::Struct { members, .. } => {
                let parts = members.iter().map(|member| {
                    let at = TablePlace { offset: place.offset + member.offset / 4, ..place.clone() };
                    let value = self.fetched(function, member.ty, &at)?;
                    Ok(format!("{}: {value}", member.name.as_deref().unwrap_or("unnamed")))
                });
                let parts: Vec<String> = parts.collect::<Result<_, VectorizeError>>()?;
                Ok(format!("{} {{ {} }}", self.type_name(ty, place.uniform)?, parts.join(", ")))
            }
            other => Err(self.unsupported(function, format!("a table's field of type {other:?}"))),
        }
    }

    fn fetched_number(
        &self,
        function: &Function,
        scalar: Scalar,
        place: &TablePlace,
        component: u32,
    ) -> Result<String, VectorizeError> {
        let table = self.module.global_variables[place.table].name.as_deref().unwrap_or_default();
        let at = TablePlace { offset: place.offset + component, ..place.clone() }.number();
        let word = if place.uniform {
            format!("globals.{table}.word({at})")
        } else {
            format!("words(globals.{table}, live, {at})")
        };
        match scalar.kind {
            ScalarKind::Uint => Ok(word),
            ScalarKind::Float => {
                let kind = if place.uniform { "f32" } else { "F32" };
                Ok(format!("Reinterpret::<{kind}>::reinterpret({word})"))
            }
            _ => Err(self.unsupported(function, format!("a table's field of type {scalar:?}"))),
        }
    }

    pub(crate) fn unsupported(&self, function: &Function, what: String) -> VectorizeError {
        VectorizeError::Unsupported { function: function.name.clone().unwrap_or_default(), what }
    }
}

impl TablePlace {
    /// Rust for the number of the word.
    pub(crate) fn number(&self) -> String {
        match (self.offset, self.uniform) {
            (0, _) => self.word.clone(),
            (offset, true) => format!("add({}, {offset}u32)", self.word),
            (offset, false) => format!("add({}, widen({offset}u32))", self.word),
        }
    }
}
