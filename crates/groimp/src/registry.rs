//! `project.gs`: what the project's resources are called and where the saved view looks from.

use crate::ReadError;
use crate::xml::{Element, Tag, Xml};
use std::collections::HashMap;

/// Directories of resources nest a few levels; deeper ones hold nothing that is asked for.
const DEEPEST_DIRECTORY: usize = 64;

/// Bytes of the path of a directory; every resource below it holds a copy.
const LONGEST_DIRECTORY: usize = 1000;

/// The parts of `project.gs` that matter for a picture.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Registry {
    /// Name of the graph file.
    pub graph: String,
    /// Registry path of a file object (an image) to its file in the project.
    pub files: HashMap<String, String>,
    /// Name of a shader to the id of its node in the MetaGraph; the text may be no number.
    pub shaders: HashMap<String, String>,
    /// Model sources.
    pub sources: Vec<String>,
    /// Text and line of the first 3D view.
    pub view: Option<(String, usize)>,
}

impl Registry {
    /// Reads `project.gs`; `file` is its name for messages.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, ReadError> {
        let mut xml = Xml::new(file, bytes)?;
        let mut registry = Registry { graph: "graph.xml".to_owned(), ..Registry::default() };
        // Names of the enclosing directories; other elements count as nameless levels.
        let mut path: Vec<Option<String>> = Vec::new();
        let mut seen_root = false;
        loop {
            match xml.next()? {
                Tag::Start(element) => {
                    if !seen_root {
                        seen_root = true;
                        registry.root(file, &element)?;
                    } else {
                        registry.item(&path, &element);
                    }
                    let name = if element.name == "ref" { element.attribute("name") } else { None };
                    path.push(name.map(|name| name.replace('/', "\\/")));
                }
                Tag::End => {
                    path.pop();
                }
                Tag::Eof if !seen_root => {
                    return Err(ReadError::Unexpected {
                        file: file.to_owned(),
                        line: 1,
                        found: "no element at all".to_owned(),
                        expected: "<project ...>",
                    });
                }
                Tag::Eof => return Ok(registry),
            }
        }
    }

    fn root(&mut self, file: &str, element: &Element<'_>) -> Result<(), ReadError> {
        if element.name != "project" {
            return Err(ReadError::Unexpected {
                file: file.to_owned(),
                line: element.line,
                found: format!("<{}>", element.name),
                expected: "<project ...>",
            });
        }
        if let Some(graph) = element.attribute("graph") {
            self.graph = graph.to_owned();
        }
        Ok(())
    }

    fn item(&mut self, path: &[Option<String>], element: &Element<'_>) {
        let name = element.attribute("name");
        match element.name.as_str() {
            "de.grogra.pf.ui.registry.SourceFile" => {
                // Up to 1.x the name is the location.
                let source = element.attribute("systemId").or(name).and_then(|n| n.strip_prefix("pfs:"));
                self.sources.extend(source.map(str::to_owned));
            }
            "de.grogra.pf.ui.registry.FileObjectItem" => {
                let file = element.attribute("systemId").and_then(|id| id.strip_prefix("pfs:"));
                if let (Some(name), Some(file), Some(directory)) = (name, file, directory(path)) {
                    let path = format!("{directory}/{}", name.replace('/', "\\/"));
                    self.files.entry(path).or_insert_with(|| file.to_owned());
                }
            }
            "de.grogra.pf.registry.SONodeReference" => {
                if let (Some(name), Some(id)) = (name, element.attribute("ref"))
                    && directory(path).as_deref() == Some("/project/objects/3d/shaders")
                {
                    self.shaders.entry(name.to_owned()).or_insert_with(|| id.to_owned());
                }
            }
            "de.grogra.pf.registry.Option"
                if self.view.is_none()
                    && name == Some("view")
                    // A 2D view may have the same name and come first.
                    && element.attribute("type") == Some("de.grogra.imp3d.View3D") =>
            {
                self.view = element.attribute("value").map(|value| (value.to_owned(), element.line));
            }
            _ => {}
        }
    }
}

/// Path of the enclosing directories, as `/project/objects/images`.
fn directory(path: &[Option<String>]) -> Option<String> {
    let length = |path: &[Option<String>]| path.iter().flatten().map(|name| 1 + name.len()).sum::<usize>();
    if path.len() > DEEPEST_DIRECTORY || length(path) > LONGEST_DIRECTORY {
        return None;
    }
    Some(path.iter().flatten().flat_map(|name| ["/", name]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROJECT: &str = r#"<project xmlns="http://grogra.de/registry" graph="g.xml"><registry>
 <ref name="project"><ref name="objects">
  <ref name="files"><de.grogra.pf.ui.registry.SourceFile name="pfs:old.rgg"/>
   <de.grogra.pf.ui.registry.SourceDirectory name="sub" systemId="pfs:sub">
    <de.grogra.pf.ui.registry.SourceFile name="new.rgg" systemId="pfs:sub/new.rgg"/>
   </de.grogra.pf.ui.registry.SourceDirectory></ref>
  <ref name="images"><de.grogra.pf.ui.registry.FileObjectItem name="leaf" systemId="pfs:images/leaf 1.png"/></ref>
  <ref name="3d"><ref name="shaders"><de.grogra.pf.registry.SONodeReference name="Leaf1" ref="94"/></ref>
   <ref name="lights"><de.grogra.pf.registry.SONodeReference name="L" ref="9"/></ref></ref>
 </ref></ref>
 <ref name="workbench"><ref name="state"><de.grogra.pf.ui.registry.Layout name="layout">
  <de.grogra.pf.registry.Option name="view" type="de.grogra.imp2d.View2D" value="flat"/>
  <de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="first"/>
  <de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="second"/>
 </de.grogra.pf.ui.registry.Layout></ref></ref></registry></project>"#;

    #[test]
    fn resources_are_found_by_path() {
        let registry = Registry::parse("project.gs", PROJECT.as_bytes()).unwrap();
        assert_eq!(registry.graph, "g.xml");
        assert_eq!(registry.sources, ["old.rgg", "sub/new.rgg"]);
        assert_eq!(registry.files["/project/objects/images/leaf"], "images/leaf 1.png");
        assert_eq!(registry.shaders.get("Leaf1").map(String::as_str), Some("94"));
        assert_eq!(registry.shaders.len(), 1);
        assert_eq!(registry.view, Some(("first".to_owned(), 13)));
    }

    #[test]
    fn other_xml_is_refused() {
        let error = Registry::parse("project.gs", b"<graph/>").unwrap_err();
        assert!(error.to_string().contains("found <graph>, expected <project"), "{error}");
    }
}
