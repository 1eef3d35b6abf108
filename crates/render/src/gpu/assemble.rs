//! Joins the kernels into one WGSL text.
//!
//! The kernels are generic over how the scene is read. `wgsl-rs` 0.1.0-beta.6 instantiates generic functions that
//! are called directly, but loses those that a generic function of another module calls, and names calls and
//! definitions differently where a name has underscores. All pieces are public, so the joining is done here: every
//! generic function of every imported module once, for the one type that stands for the storage buffers.

use std::collections::{HashMap, HashSet};
use wgsl_rs::{Source, ir};

/// The complete WGSL of a module whose entry points call generic kernels, all with the same type argument.
///
/// # Errors
/// If the module instantiates no generic function, or with several types.
pub(super) fn assemble(root: &Source) -> Result<String, String> {
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
    let mut chunks: Vec<Vec<ir::Item>> = Vec::new();
    let mut renamed = Vec::new();
    for source in sources {
        chunks.push((source.ir_constructor)().items);
        for template in source.templates {
            let [parameter] = template.type_params else {
                return Err(format!("kernel {} must have exactly one type parameter", template.name));
            };
            let mut items = (template.ir_constructor)();
            ir::substitute_items(&mut items, &HashMap::from([((*parameter).to_owned(), scene_type.clone())]));
            // The name by which other generic functions call it.
            let name = format!("{}_{suffix}", template.name);
            ir::rename_items(&mut items, template.name, &name);
            // The name by which the entry points call it.
            renamed.push((ir::mangle(&[template.name, suffix]), name));
            chunks.push(items);
        }
    }
    let mut types = ir::TypeImports::default();
    for items in &mut chunks {
        ir::deshadow_items(items);
        types.extend(ir::type_imports_in_items(items));
    }

    let mut wgsl = String::new();
    for items in &mut chunks {
        ir::suffix_items_with_type_imports(items, &types);
        wgsl.push_str(&ir::render_items(items));
        wgsl.push('\n');
    }
    for (mangled, name) in renamed {
        if mangled != name {
            wgsl = wgsl.replace(&mangled, &name);
        }
    }
    Ok(wgsl)
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
    use super::super::shader::kernel::WGSL_SOURCE;

    #[test]
    fn every_called_function_is_defined_once() {
        let wgsl = super::assemble(&WGSL_SOURCE).unwrap();
        for name in
            ["trace_path_Buffers", "closest_hit_Buffers", "transmittance_Buffers", "channel_value_Buffers"]
        {
            assert_eq!(wgsl.matches(&format!("fn {name}(")).count(), 1, "{name}");
        }
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
