//! Writes kernels in WGSL as Rust in which every value has one lane per ray.
//!
//! Graphics cards execute a kernel for many rays at once: where rays go different ways, all of them go both, and a mask
//! says whose results count (ispc does the same for processors: Pharr and Mark, "ispc: A SPMD compiler for
//! high-performance CPU programming", 2012). Here the kernels' WGSL, as naga reads it, becomes Rust over the types of the
//! crate `lanes`, so that the one source of the kernels serves the vector units of processors, too.
//!
//! - Values that are the same for all rays stay plain numbers ([`uniformity`]): settings, features of the scene,
//!   counters of loops over lights.
//! - Records of read-only tables are passed on by their place; fields are fetched where they are used ([`records`]).
//! - `if` becomes a mask, skipped where no ray is left; `return`, `break` and `continue` take rays out of it
//!   ([`statements`]).

mod error;
mod expressions;
mod functions;
mod layout;
mod places;
mod records;
mod statements;
mod structures;
mod uniformity;

pub use error::VectorizeError;
use functions::{function_named, reachable_functions, together_name};
use records::Records;
use std::fmt::Write;
use uniformity::Uniformity;

/// What is to be written.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Functions that are called from outside, and which of their parameters may differ between rays.
    pub roots: &'a [(&'a str, &'a [bool])],
    /// Functions that are written once more for one of their parameters, of one word or a record, being the same for
    /// all rays. Where it may differ, the rays are asked whether it does.
    pub together: &'a [(&'a str, usize)],
    /// What the processor must have, as for `target_feature(enable)`.
    pub target_features: &'a str,
}

/// The Rust text of kernels and all that they call. It is meant to be included where the names of a module of `lanes`
/// such as `lanes::avx512` and those of `lanes` itself are in scope; it defines `Globals`, which gives access to the
/// tables, next to the structures and functions of the kernels.
///
/// # Errors
/// If the text is no valid WGSL, a named function is missing, or something is used that has no lanes.
pub fn vectorize(wgsl: &str, options: Options<'_>) -> Result<String, VectorizeError> {
    let mut module = naga::front::wgsl::parse_str(wgsl)
        .map_err(|error| VectorizeError::Parse { reason: error.emit_to_string(wgsl) })?;
    for (name, _) in options.together {
        let mut copy = module.functions[function_named(&module, name)?].clone();
        copy.name = Some(together_name(name));
        module.functions.append(copy, naga::Span::default());
    }
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    let info = validator
        .validate(&module)
        .map_err(|error| VectorizeError::Validate { reason: error.emit_to_string(wgsl) })?;
    let functions = reachable_functions(&module, &options)?;
    let records = Records::of(&module, &functions)?;
    let uniformity = Uniformity::of(&module, &functions, &options)?;
    let writer = Writer { module: &module, info: &info, options, records, uniformity };

    let mut text = String::new();
    writer.write_globals(&mut text)?;
    writer.write_structures(&functions, &mut text)?;
    for function in functions {
        writer.write_function(function, &mut text)?;
    }
    Ok(text)
}

/// What is known of the module while it is written.
pub(crate) struct Writer<'a> {
    pub module: &'a naga::Module,
    pub info: &'a naga::valid::ModuleInfo,
    pub options: Options<'a>,
    pub records: Records,
    pub uniformity: Uniformity,
}

impl Writer<'_> {
    /// `Globals`: the tables as words, and what is the same for all of a launch.
    fn write_globals(&self, text: &mut String) -> Result<(), VectorizeError> {
        text.push_str("/// What the kernels read.\n#[derive(Clone, Copy)]\npub struct Globals<'a> {\n");
        text.push_str("    pub own: &'a Own,\n");
        for (_, global) in self.module.global_variables.iter() {
            let name = global.name.as_deref().unwrap_or_default();
            match global.space {
                naga::AddressSpace::Storage { access } if !access.contains(naga::StorageAccess::STORE) => {
                    _ = writeln!(text, "    pub {name}: Table<'a>,");
                }
                naga::AddressSpace::Uniform => {
                    let kind = self.type_name(global.ty, true)?;
                    _ = writeln!(text, "    pub {name}: {kind},");
                }
                _ => {}
            }
        }
        text.push_str("}\n\n");
        self.write_own(text)?;
        for (handle, global) in self.module.global_variables.iter() {
            if global.space == naga::AddressSpace::Uniform {
                let name = global.name.as_deref().unwrap_or_default();
                let kind = self.type_name(global.ty, true)?;
                let place =
                    layout::TablePlace { table: handle, word: "0u32".to_owned(), offset: 0, uniform: true };
                let value = self.fetched(&naga::Function::default(), global.ty, &place)?;
                let value = value.replace(&format!("globals.{name}."), "words.");
                _ = writeln!(
                    text,
                    "/// `{name}` from the words that it lies in.\npub fn read_{name}(words: Table<'_>) -> {kind} {{\n    \
                     {value}\n}}\n"
                );
            }
        }
        Ok(())
    }

    /// `Own`: the private variables, which keep their values from one call to the next.
    fn write_own(&self, text: &mut String) -> Result<(), VectorizeError> {
        let (mut fields, mut values) = (String::new(), String::new());
        for (_, global) in self.module.global_variables.iter() {
            if global.space == naga::AddressSpace::Private {
                let name = global.name.as_deref().unwrap_or_default();
                _ = writeln!(fields, "    pub {name}: RefCell<{}>,", self.type_name(global.ty, false)?);
                _ = write!(values, " {name}: RefCell::new(Zero::zero()),");
            }
        }
        _ = writeln!(
            text,
            "/// What every ray has of its own.\npub struct Own {{\n{fields}}}\n\nimpl Own {{\n    /// All zero.\n    \
             #[target_feature(enable = \"{}\")]\n    pub fn new() -> Self {{\n        Own {{{values} }}\n    }}\n}}\n",
            self.options.target_features
        );
        Ok(())
    }
}
