//! Names of types, and the kernels' structures: one for rays side by side, and one, `Uniform...`, for values that are
//! the same for all rays.

use crate::{VectorizeError, Writer};
use naga::{ArraySize, Function, Handle, Scalar, ScalarKind, StructMember, Type, TypeInner};
use std::fmt::Write;

/// Names of the components of vectors.
pub(crate) const COMPONENTS: [&str; 4] = ["x", "y", "z", "w"];

/// Name of a number's type.
pub(crate) fn scalar_name(scalar: Scalar, uniform: bool) -> Option<&'static str> {
    let (plain, lanes) = match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) => ("f32", "F32"),
        (ScalarKind::Uint, 4) => ("u32", "U32"),
        (ScalarKind::Sint, 4) => ("i32", "I32"),
        (ScalarKind::Bool, _) => ("bool", "Mask"),
        _ => return None,
    };
    Some(if uniform { plain } else { lanes })
}

impl Writer<'_> {
    /// Name of a type of values.
    pub(crate) fn type_name(&self, ty: Handle<Type>, uniform: bool) -> Result<String, VectorizeError> {
        if self.records.table(ty).is_some() {
            return Ok(if uniform { "u32" } else { "U32" }.to_owned());
        }
        self.inner_type_name(&self.module.types[ty].inner, self.module.types[ty].name.as_deref(), uniform)
    }

    /// Name of a type that may have no handle.
    pub(crate) fn inner_type_name(
        &self,
        inner: &TypeInner,
        name: Option<&str>,
        uniform: bool,
    ) -> Result<String, VectorizeError> {
        let unsupported =
            || VectorizeError::Unsupported { function: "(types)".to_owned(), what: format!("{inner:?}") };
        match inner {
            TypeInner::Scalar(scalar) => {
                scalar_name(*scalar, uniform).map(str::to_owned).ok_or_else(unsupported)
            }
            TypeInner::Vector { size, scalar } => {
                let number = scalar_name(*scalar, uniform).ok_or_else(unsupported)?;
                Ok(format!("V{}<{number}>", *size as u8))
            }
            TypeInner::Array { base, size: ArraySize::Constant(size), .. } => {
                Ok(format!("[{}; {size}]", self.type_name(*base, uniform)?))
            }
            TypeInner::Struct { .. } => {
                let name = name.ok_or_else(unsupported)?;
                Ok(if uniform { format!("Uniform{name}") } else { name.to_owned() })
            }
            _ => Err(unsupported()),
        }
    }

    /// The structures that functions use.
    pub(crate) fn write_structures(
        &self,
        _functions: &[Handle<Function>],
        text: &mut String,
    ) -> Result<(), VectorizeError> {
        for (handle, ty) in self.module.types.iter() {
            if let (TypeInner::Struct { members, .. }, Some(name)) = (&ty.inner, &ty.name)
                && self.records.table(handle).is_none()
            {
                let has_runtime_array = members.iter().any(|member| {
                    let inner = &self.module.types[member.ty].inner;
                    matches!(inner, TypeInner::Array { size: ArraySize::Dynamic, .. })
                });
                if !has_runtime_array {
                    self.write_structure(name, members, text)?;
                }
            }
        }
        Ok(())
    }

    fn write_structure(
        &self,
        name: &str,
        members: &[StructMember],
        text: &mut String,
    ) -> Result<(), VectorizeError> {
        let fields = || members.iter().map(|member| (member.name.as_deref().unwrap_or("unnamed"), member.ty));
        let each = |write: &dyn Fn(&str) -> String| {
            fields().map(|(field, _)| format!("{field}: {}", write(field))).collect::<Vec<_>>().join(", ")
        };
        for uniform in [true, false] {
            let prefix = if uniform { "Uniform" } else { "" };
            _ = writeln!(text, "#[derive(Clone, Copy, Debug)]\npub struct {prefix}{name} {{");
            for (field, ty) in fields() {
                _ = writeln!(text, "    pub {field}: {},", self.type_name(ty, uniform)?);
            }
            text.push_str("}\n");
            _ = writeln!(
                text,
                "impl Zero for {prefix}{name} {{\n    #[inline(always)]\n    fn zero() -> Self {{\n        \
                 {prefix}{name} {{ {} }}\n    }}\n}}",
                each(&|_| "Zero::zero()".to_owned())
            );
        }
        _ = writeln!(
            text,
            "impl Widen for Uniform{name} {{\n    type Lanes = {name};\n    #[inline(always)]\n    \
             fn widen(self) -> {name} {{\n        {name} {{ {} }}\n    }}\n}}",
            each(&|field| format!("self.{field}.widen()"))
        );
        _ = writeln!(
            text,
            "impl Blend for {name} {{\n    type Mask = Mask;\n    #[inline(always)]\n    \
             fn blend(mask: Mask, set: Self, clear: Self) -> Self {{\n        {name} {{ {} }}\n    }}\n}}\n",
            each(&|field| format!("Blend::blend(mask, set.{field}, clear.{field})"))
        );
        Ok(())
    }
}
