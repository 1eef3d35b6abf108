//! Objects that stand for others: references, shared objects, names of the registry.

use crate::graph::{Graph, Node, NodeIndex};
use crate::registry::Registry;
use crate::values::{Kind, Members, Value};

/// References lead to references; a longer chain is a cycle.
pub(crate) const LONGEST_CHAIN: usize = 64;

/// Follows what refers to something else.
#[derive(Clone, Copy)]
pub(crate) struct References<'a> {
    pub graph: &'a Graph,
    pub registry: &'a Registry,
}

impl<'a> References<'a> {
    /// The object that a value is or refers to, through names and shared objects; `None` if there is none.
    pub fn follow<'s>(&self, value: &'s Value) -> Option<Found<'s>>
    where
        'a: 's,
    {
        let mut value = value;
        for _ in 0..LONGEST_CHAIN {
            let node = match value.kind {
                Kind::Null => return None,
                Kind::Ref => self.graph.by_id(value.text().parse().ok()?)?,
                Kind::Shared => self.shared(value.text())?,
                Kind::Data | Kind::Object | Kind::Array | Kind::Serialized => {
                    let class = self.graph.values.type_of(value).unwrap_or("");
                    let found = Found { class, members: value.members, line: value.line };
                    match self.next(&found) {
                        Next::Value(next) => value = next,
                        Next::Nothing => return None,
                        Next::Node(node) => match self.at_node(node) {
                            Ok(found) => return Some(found),
                            Err(next) => value = next?,
                        },
                        Next::Arrived => return Some(found),
                    }
                    continue;
                }
            };
            match self.at_node(node) {
                Ok(found) => return Some(found),
                Err(next) => value = next?,
            }
        }
        None
    }

    /// The object at a node, or the value that it refers to instead.
    fn at_node(&self, node: NodeIndex) -> Result<Found<'a>, Option<&'a Value>> {
        let mut node = node;
        for _ in 0..LONGEST_CHAIN {
            let Node { fields, line, .. } = *self.graph.node(node);
            let found = Found { class: self.graph.type_name(node), members: fields, line };
            match self.next(&found) {
                Next::Arrived => return Ok(found),
                Next::Value(value) => return Err(Some(value)),
                Next::Node(next) => node = next,
                Next::Nothing => break,
            }
        }
        Err(None)
    }

    fn next(&self, found: &Found<'_>) -> Next<'a> {
        let present = |name| self.graph.values.find(found.members, name).filter(|v| v.kind != Kind::Null);
        let to = |value: Option<&'a Value>| value.map_or(Next::Nothing, Next::Value);
        match found.class.rsplit('.').next().unwrap_or("") {
            "SharedObjectNode" => to(present("object")),
            "AlgorithmSwitchShader" => to(present("raytracerShader").or(present("guiShader"))),
            "ShaderRef" | "MaterialRef" => {
                let named = present("name").and_then(|name| self.named(name.text()));
                named.map_or(Next::Nothing, Next::Node)
            }
            _ => Next::Arrived,
        }
    }

    /// Node of a shared object: `MetaGraph:#94`, or a path in the registry.
    pub fn shared(&self, text: &str) -> Option<NodeIndex> {
        if let Some((_, id)) = text.split_once(":#") {
            return self.graph.by_id(id.trim().parse().ok()?);
        }
        let path = crate::inline::registry_path(text)?;
        self.named(path.strip_prefix("/project/objects/3d/shaders/")?)
    }

    pub fn named(&self, name: &str) -> Option<NodeIndex> {
        self.graph.by_id(self.registry.shaders.get(name)?.trim().parse().ok()?)
    }
}

/// An object of the file.
pub(crate) struct Found<'a> {
    /// Empty if the file does not say.
    pub class: &'a str,
    pub members: Members,
    pub line: usize,
}

/// Where an object leads that stands for another one.
enum Next<'a> {
    /// It stands for itself.
    Arrived,
    Value(&'a Value),
    Node(NodeIndex),
    Nothing,
}
