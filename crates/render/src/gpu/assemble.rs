//! Joins the kernels into one WGSL text.
//!
//! The kernels are generic over how the scene is read. `wgsl-rs` 0.1.0-beta.6 instantiates generic functions that
//! are called directly, but loses those that a generic function of another module calls, and names calls and
//! definitions differently where a name has underscores. All pieces are public, so the joining is done here: every
//! generic function of every imported module that the entry point reaches once, for the one type that stands for
//! the storage buffers.

use std::collections::{HashMap, HashSet};
use wgsl_rs::{Source, ir};

/// A generic kernel that is put in the place of another one with the same parameters.
#[derive(Clone, Copy)]
pub(super) struct StandIn {
    /// Left out.
    pub replaced: &'static str,
    /// Called instead.
    pub by: &'static str,
}

/// One piece of the text: the plain items of a module, or a generic function.
struct Chunk {
    items: Vec<ir::Item>,
    /// Name under which generic functions call it.
    name: Option<String>,
}

/// The complete WGSL of a module whose entry points call generic kernels, all with the same type argument.
///
/// # Errors
/// If the module instantiates no generic function, or with several types.
pub(super) fn assemble(root: &Source, choice: StandIn) -> Result<String, String> {
    let mut arguments = root.instantiations.iter().map(|instantiation| instantiation.mangled_type_args);
    let suffix = match arguments.next() {
        Some([name]) => *name,
        _ => return Err(format!("module {} instantiates no kernel with one type", root.name)),
    };
    if arguments.any(|other| other != [suffix]) {
        return Err(format!("module {} instantiates kernels with several types", root.name));
    }
    let scene_type = (root.instantiations[0].type_args_constructor)().remove(0);

    // Everything that is defined, with the types that literals in calls depend on.
    let sources = in_order_of_import(root);
    let mut chunks: Vec<Chunk> = Vec::new();
    let mut renamed = Vec::new();
    for source in sources {
        chunks.push(Chunk { items: (source.ir_constructor)().items, name: None });
        for template in source.templates {
            if template.name == choice.replaced {
                continue;
            }
            let called = if template.name == choice.by { choice.replaced } else { template.name };
            let [parameter] = template.type_params else {
                return Err(format!("kernel {} must have exactly one type parameter", template.name));
            };
            let mut items = (template.ir_constructor)();
            ir::substitute_items(&mut items, &HashMap::from([((*parameter).to_owned(), scene_type.clone())]));
            // The name by which other generic functions call it.
            let name = format!("{called}_{suffix}");
            ir::rename_items(&mut items, template.name, &name);
            // The name by which the entry points call it.
            renamed.push((ir::mangle(&[called, suffix]), name.clone()));
            chunks.push(Chunk { items, name: Some(name) });
        }
    }
    let mut types = ir::TypeImports::default();
    for chunk in &mut chunks {
        ir::deshadow_items(&mut chunk.items);
        types.extend(ir::type_imports_in_items(&chunk.items));
    }

    let mut texts: Vec<(Option<String>, String)> = Vec::new();
    for mut chunk in chunks {
        ir::suffix_items_with_type_imports(&mut chunk.items, &types);
        let mut text = ir::render_items(&chunk.items);
        for (mangled, name) in &renamed {
            if mangled != name {
                text = text.replace(mangled, name);
            }
        }
        texts.push((chunk.name, text));
    }
    Ok(reachable(texts))
}

/// The plain pieces and those of the named ones that they call, directly or not, in the given order.
fn reachable(texts: Vec<(Option<String>, String)>) -> String {
    let mut needed: Vec<bool> = texts.iter().map(|(name, _)| name.is_none()).collect();
    let mut open: Vec<usize> = (0..texts.len()).filter(|index| needed[*index]).collect();
    while let Some(caller) = open.pop() {
        for (callee, (name, _)) in texts.iter().enumerate() {
            let Some(name) = name else { continue };
            if !needed[callee] && texts[caller].1.contains(&format!("{name}(")) {
                needed[callee] = true;
                open.push(callee);
            }
        }
    }
    let mut wgsl = String::new();
    for ((_, text), needed) in texts.into_iter().zip(needed) {
        if needed {
            wgsl.push_str(&text);
            wgsl.push('\n');
        }
    }
    wgsl
}

/// The module and all that it imports, imported ones first, each once.
fn in_order_of_import(root: &Source) -> Vec<&Source> {
    let mut ordered = Vec::new();
    let mut seen = HashSet::new();
    let mut open = vec![(root, false)];
    while let Some((source, imports_done)) = open.pop() {
        if imports_done {
            ordered.push(source);
        } else if seen.insert(source.id) {
            open.push((source, true));
            open.extend(source.imports.iter().map(|import| (*import, false)));
        }
    }
    ordered
}

#[cfg(test)]
mod tests {
    use crate::Renderer;

    #[test]
    fn every_called_function_is_defined_once() {
        for renderer in Renderer::ALL {
            let wgsl = super::super::shader::source(renderer, 0).unwrap();
            let count = |name: &str| wgsl.matches(&format!("fn {name}_Buffers(")).count();
            for name in ["add_samples", "search", "channel_value"] {
                assert_eq!(count(name), 1, "{name}");
            }
            // The other renderer is left out.
            let is_path_tracer = renderer == Renderer::PathTracer;
            assert_eq!(count("extend_path"), usize::from(is_path_tracer));
            assert_eq!(count("trace_rays"), usize::from(!is_path_tracer));
            // The whole must be valid WGSL, also on machines without any graphics card.
            let module = wgpu::naga::front::wgsl::parse_str(&wgsl).unwrap();
            wgpu::naga::valid::Validator::new(
                wgpu::naga::valid::ValidationFlags::all(),
                wgpu::naga::valid::Capabilities::empty(),
            )
            .validate(&module)
            .unwrap();
        }
    }
}
