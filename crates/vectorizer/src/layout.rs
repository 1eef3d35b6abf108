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
        let table = self.module.global_variables[place.table].name.as_deref().unwrap_or_default();
        let at = place.number();
        let inner = &self.module.types[ty].inner;
        if let Some(count) = block_of(inner) {
            // All at once: whether rays agree on the place and whether it lies inside is then asked only once.
            let block = match place.uniform {
                true => format!("globals.{table}.block::<{count}>({at})"),
                false => format!("block::<{count}>(globals.{table}, live, {at})"),
            };
            let value = self.gathered(function, ty, place.uniform, 0, &|word| format!("block[{word}]"))?;
            return Ok(format!("{{ let block = {block}; {value} }}"));
        }
        self.gathered(function, ty, place.uniform, 0, &|_| match place.uniform {
            true => format!("globals.{table}.word({at})"),
            false => format!("words(globals.{table}, live, {at})"),
        })
    }

    /// Rust for a value of a type whose words, from `first` on, some Rust gives.
    fn gathered(
        &self,
        function: &Function,
        ty: Handle<Type>,
        uniform: bool,
        first: u32,
        word: &dyn Fn(u32) -> String,
    ) -> Result<String, VectorizeError> {
        let number = |scalar: Scalar, at: u32| match (scalar.kind, uniform) {
            (ScalarKind::Uint, _) => Ok(word(at)),
            (ScalarKind::Float, true) => Ok(format!("Reinterpret::<f32>::reinterpret({})", word(at))),
            (ScalarKind::Float, false) => Ok(format!("Reinterpret::<F32>::reinterpret({})", word(at))),
            _ => Err(self.unsupported(function, format!("a table's field of type {scalar:?}"))),
        };
        match &self.module.types[ty].inner {
            TypeInner::Scalar(scalar) => number(*scalar, first),
            TypeInner::Vector { size, scalar } => {
                let parts = (0..u32::from(*size as u8)).map(|i| {
                    let value = number(*scalar, first + i)?;
                    Ok(format!("{}: {value}", crate::structures::COMPONENTS[i as usize]))
                });
                let parts: Vec<String> = parts.collect::<Result<_, VectorizeError>>()?;
                Ok(format!("V{} {{ {} }}", *size as u8, parts.join(", ")))
            }
            TypeInner::Struct { members, .. } if self.records.table(ty).is_none() => {
                let parts = members.iter().map(|member| {
                    let value =
                        self.gathered(function, member.ty, uniform, first + member.offset / 4, word)?;
                    Ok(format!("{}: {value}", member.name.as_deref().unwrap_or("unnamed")))
                });
                let parts: Vec<String> = parts.collect::<Result<_, VectorizeError>>()?;
                Ok(format!("{} {{ {} }}", self.type_name(ty, uniform)?, parts.join(", ")))
            }
            other => Err(self.unsupported(function, format!("a table's field of type {other:?}"))),
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

/// Words of a type that has more than one.
fn block_of(ty: &TypeInner) -> Option<u32> {
    match ty {
        TypeInner::Vector { size, .. } => Some(u32::from(*size as u8)),
        TypeInner::Struct { span, .. } => Some(span / 4),
        _ => None,
    }
}
