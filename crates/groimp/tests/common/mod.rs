//! Small projects written for a test.
#![allow(dead_code)] // Not every test file uses everything.

pub mod triangles;

use std::path::{Path, PathBuf};

/// A file in a fresh directory of its own.
pub fn file(test: &str, name: &str, bytes: &[u8]) -> PathBuf {
    directory(test, &[(name, bytes)]).join(name)
}

/// A fresh directory with the given files.
pub fn directory(test: &str, files: &[(&str, &[u8])]) -> PathBuf {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = std::fs::remove_dir_all(&root);
    for (name, bytes) in files {
        let path = root.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    root
}

/// Graph file with the given elements below the root of the main graph.
pub fn graph(children: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<graph xmlns:gx=\"http://grogra.de/xmlpersistence\" \
         xmlns=\"http://grogra.de/xmlpersistence\">\n<node root=\"MainGraph\" id=\"0\" \
         type=\"de.grogra.graph.impl.Node\">\n{children}\n</node>\n</graph>\n"
    )
}

/// Nested nodes, each the successor of the one before: `(type, fields)`; ids count from 1.
pub fn chain(nodes: &[(&str, &str)]) -> String {
    let mut text = String::new();
    for (i, (type_name, fields)) in nodes.iter().enumerate() {
        text += &format!("<node id=\"{}\" type=\"{type_name}\" edges=\"-\">{fields}\n", i + 1);
    }
    text + &"</node>".repeat(nodes.len())
}

/// A field with a number.
pub fn data(name: &str, value: impl std::fmt::Display) -> String {
    format!("<data gx:name=\"{name}\" gx:value=\"{value}\"/>")
}
