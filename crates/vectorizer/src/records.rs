//! Records of read-only tables, which are passed on by their place in the table.

use crate::VectorizeError;
use crate::functions::each_statement;
use naga::{
    AddressSpace, Expression, Function, GlobalVariable, Handle, Module, Statement, StorageAccess, Type,
    TypeInner,
};
use std::collections::HashMap;

/// Structures that stand for a place in a table.
pub(crate) struct Records {
    tables: HashMap<Handle<Type>, Handle<GlobalVariable>>,
}

impl Records {
    /// Structures that only come from tables: no function composes them or changes a part of them.
    pub(crate) fn of(module: &Module, functions: &[Handle<Function>]) -> Result<Self, VectorizeError> {
        let mut tables = HashMap::new();
        for (handle, global) in module.global_variables.iter() {
            let AddressSpace::Storage { access } = global.space else { continue };
            if access.contains(StorageAccess::STORE) {
                continue;
            }
            let TypeInner::Array { base, .. } = module.types[global.ty].inner else { continue };
            let mut open = vec![base];
            while let Some(ty) = open.pop() {
                if let TypeInner::Struct { members, .. } = &module.types[ty].inner {
                    tables.insert(ty, handle);
                    open.extend(members.iter().map(|member| member.ty));
                }
            }
        }
        // What launches are given as a whole.
        for (_, global) in module.global_variables.iter() {
            if let (AddressSpace::Uniform, TypeInner::Struct { members, .. }) =
                (global.space, &module.types[global.ty].inner)
            {
                members.iter().for_each(|member| _ = tables.remove(&member.ty));
            }
        }
        for function in functions {
            let function = &module.functions[*function];
            for (_, expression) in function.expressions.iter() {
                if let Expression::Compose { ty, .. } | Expression::ZeroValue(ty) = expression {
                    tables.remove(ty);
                }
            }
            each_statement(&function.body, &mut |statement| {
                if let Statement::Store { pointer, .. } = statement
                    && let Expression::AccessIndex { base, .. } = function.expressions[*pointer]
                    && let Expression::LocalVariable(variable) = function.expressions[base]
                {
                    tables.remove(&function.local_variables[variable].ty);
                }
            });
        }
        Ok(Records { tables })
    }

    /// The table that records of this type lie in.
    pub(crate) fn table(&self, ty: Handle<Type>) -> Option<Handle<GlobalVariable>> {
        self.tables.get(&ty).copied()
    }
}
