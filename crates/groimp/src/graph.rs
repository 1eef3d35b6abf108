//! `graph.xml` as flat tables of nodes, tree edges and field values.

use crate::inline;
use crate::report::{Location, Report};
use crate::values::{Kind, Members, Symbol, Value, ValueId, Values};
use crate::xml::{Element, Tag, Xml};
use crate::{Limits, ReadError};
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

const NAMESPACE: &str = "http://grogra.de/xmlpersistence";

/// Position in the table of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct NodeIndex(u32);

impl NodeIndex {
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A node of any of the graphs.
#[derive(Debug)]
pub(crate) struct Node {
    pub id: i64,
    pub type_name: Symbol,
    pub fields: Members,
    pub line: usize,
}

/// All graphs of a file.
pub(crate) struct Graph {
    pub file: String,
    pub values: Values,
    pub nodes: Vec<Node>,
    pub main_root: NodeIndex,
    by_id: HashMap<i64, NodeIndex>,
    /// Targets of the edges of the scene tree, whose successor or branch bit is set. For a picture the two do not
    /// differ.
    edges: Vec<NodeIndex>,
    /// Whether they are successors; for a picture that makes a difference to instances only.
    is_successor: Vec<bool>,
    /// What instances are instances of.
    masters: HashMap<NodeIndex, NodeIndex>,
    /// Edges of node i are `edges[edge_starts[i]..edge_starts[i + 1]]`.
    edge_starts: Vec<usize>,
}

impl Graph {
    /// Reads a graph file; what is odd but harmless goes to the report.
    pub fn parse(file: &str, bytes: &[u8], limits: Limits, report: &mut Report) -> Result<Self, ReadError> {
        let mut parser = Parser::new(file, limits, report);
        let mut xml = Xml::new(file, bytes)?;
        loop {
            match xml.next()? {
                Tag::Start(element) => parser.start(&element)?,
                Tag::End => {
                    parser.stack.pop();
                }
                Tag::Eof => return parser.finish(),
            }
        }
    }

    pub fn node(&self, index: NodeIndex) -> &Node {
        &self.nodes[index.index()]
    }

    pub fn type_name(&self, index: NodeIndex) -> &str {
        self.values.name(self.node(index).type_name)
    }

    pub fn by_id(&self, id: i64) -> Option<NodeIndex> {
        self.by_id.get(&id).copied()
    }

    /// Positions of the tree edges that leave a node, in the order of the file.
    pub fn edges_of(&self, index: NodeIndex) -> Range<usize> {
        self.edge_starts[index.index()]..self.edge_starts[index.index() + 1]
    }

    /// The node that an edge leads to.
    pub fn target(&self, position: usize) -> NodeIndex {
        self.edges[position]
    }

    /// The node that continues a chain.
    pub fn successor(&self, index: NodeIndex) -> Option<NodeIndex> {
        self.edges_of(index).find(|edge| self.is_successor[*edge]).map(|edge| self.edges[edge])
    }

    /// The node whose tree an instance draws.
    pub fn master(&self, index: NodeIndex) -> Option<NodeIndex> {
        self.masters.get(&index).copied()
    }

    /// A field that is stored in the file.
    pub fn field(&self, index: NodeIndex, name: &str) -> Option<&Value> {
        self.values.find(self.node(index).fields, name)
    }

    pub fn location(&self, line: usize) -> Option<Location> {
        Some(Location { file: self.file.clone(), line })
    }
}

/// What an open element is.
#[derive(Clone, Copy)]
enum Open {
    Graph,
    Node(NodeIndex),
    /// A reference to a node, by id.
    NodeRef(i64),
    Value(ValueId),
}

struct RawEdge {
    from: i64,
    to: i64,
    kind: EdgeKind,
    line: usize,
}

/// What an edge means for the picture.
#[derive(Clone, Copy, PartialEq, Eq)]
enum EdgeKind {
    Successor,
    Branch,
    /// From an instance to what it is an instance of.
    Master,
}

impl EdgeKind {
    /// The kind of an edge with these tokens, whatever else they say; `None` if it is no part of the picture.
    fn of(tokens: &str) -> Option<Self> {
        let has = |wanted: &[&str]| tokens.split(',').any(|token| wanted.contains(&token.trim()));
        if has(&["-", ">"]) {
            Some(EdgeKind::Successor)
        } else if has(&["+"]) {
            Some(EdgeKind::Branch)
        } else {
            has(&["edge.master"]).then_some(EdgeKind::Master)
        }
    }
}

struct Parser<'a> {
    file: &'a str,
    report: &'a mut Report,
    most_nodes: usize,
    names: AttributeNames,
    values: Values,
    nodes: Vec<Node>,
    by_id: HashMap<i64, NodeIndex>,
    edges: Vec<RawEdge>,
    roots: BTreeSet<String>,
    main_root: Option<NodeIndex>,
    stack: Vec<Open>,
}

/// Attribute names with the prefix that the file binds to GroIMP's namespace.
struct AttributeNames {
    name: String,
    type_name: String,
    value: String,
}

impl AttributeNames {
    fn new(prefix: &str) -> Self {
        let with = |local: &str| format!("{prefix}:{local}");
        AttributeNames { name: with("name"), type_name: with("type"), value: with("value") }
    }
}

impl<'a> Parser<'a> {
    fn new(file: &'a str, limits: Limits, report: &'a mut Report) -> Self {
        Parser {
            file,
            report,
            most_nodes: limits.graph_nodes,
            names: AttributeNames::new("gx"),
            values: Values::within(limits.graph_values),
            nodes: Vec::new(),
            by_id: HashMap::new(),
            edges: Vec::new(),
            roots: BTreeSet::new(),
            main_root: None,
            stack: Vec::new(),
        }
    }

    fn start(&mut self, element: &Element<'_>) -> Result<(), ReadError> {
        if self.values.is_full() {
            let most = "a smaller graph, or a larger --limit graph-values";
            return Err(self.unexpected(element, "too many values".to_owned(), most));
        }
        if self.nodes.len() >= self.most_nodes {
            let most = "a smaller graph, or a larger --limit graph-nodes";
            return Err(self.unexpected(element, "too many nodes".to_owned(), most));
        }
        let open = match self.stack.last().copied() {
            None => self.root(element)?,
            Some(parent) if element.name == "node" => self.node(parent, element)?,
            Some(Open::Graph | Open::NodeRef(_)) => Open::Value(self.value(element)),
            Some(Open::Node(owner)) => {
                let value = self.value(element);
                let mut fields = self.nodes[owner.index()].fields;
                self.values.append(&mut fields, value);
                self.nodes[owner.index()].fields = fields;
                Open::Value(value)
            }
            Some(Open::Value(owner)) => {
                let value = self.value(element);
                self.values.append_to(owner, value);
                Open::Value(value)
            }
        };
        self.stack.push(open);
        Ok(())
    }

    fn root(&mut self, element: &Element<'_>) -> Result<Open, ReadError> {
        if element.name != "graph" {
            return Err(self.unexpected(element, format!("<{}>", element.name), "<graph ...>"));
        }
        let bound = element.attributes.iter().find(|(_, value)| value == NAMESPACE).map(|(key, _)| *key);
        let prefixes = element.attributes.iter().filter(|(_, value)| value == NAMESPACE);
        let prefix = prefixes.filter_map(|(key, _)| key.strip_prefix("xmlns:")).next();
        if let (Some(_), Some(prefix)) = (bound, prefix) {
            self.names = AttributeNames::new(prefix);
        }
        Ok(Open::Graph)
    }

    fn node(&mut self, parent: Open, element: &Element<'_>) -> Result<Open, ReadError> {
        let (open, to) = match (element.attribute("id"), element.attribute("ref")) {
            (Some(id), _) => {
                let id = self.id(element, id)?;
                (Open::Node(self.declare(id, element)), id)
            }
            (None, Some(id)) => {
                let id = self.id(element, id)?;
                (Open::NodeRef(id), id)
            }
            (None, None) => {
                return Err(self.unexpected(element, "<node> without id and ref".into(), "one of them"));
            }
        };
        let from = match parent {
            Open::Node(index) => Some(self.nodes[index.index()].id),
            Open::NodeRef(id) => Some(id),
            Open::Graph | Open::Value(_) => None,
        };
        if let (Some(from), Some(edges)) = (from, element.attribute("edges"))
            && let Some(kind) = EdgeKind::of(edges)
        {
            self.edges.push(RawEdge { from, to, kind, line: element.line });
        }
        Ok(open)
    }

    fn declare(&mut self, id: i64, element: &Element<'_>) -> NodeIndex {
        let type_name = self.values.intern(element.attribute("type").unwrap_or("de.grogra.graph.impl.Node"));
        // Fewer than 2^32 nodes: every one takes more than a byte, and entries are limited in size.
        let index = NodeIndex(u32::try_from(self.nodes.len()).unwrap_or(u32::MAX));
        self.nodes.push(Node { id, type_name, fields: Members::default(), line: element.line });
        if let Some(earlier) = self.by_id.get(&id) {
            let line = self.nodes[earlier.index()].line;
            let message = format!("node {id} is declared twice; the one in line {line} is used");
            self.report.warn(message, Some(Location { file: self.file.to_owned(), line: element.line }));
        } else {
            self.by_id.insert(id, index);
        }
        if let Some(root) = element.attribute("root") {
            self.roots.insert(root.to_owned());
            if root == "MainGraph" && self.main_root.is_none() {
                self.main_root = Some(index);
            }
        }
        index
    }

    fn value(&mut self, element: &Element<'_>) -> ValueId {
        let kind = match element.name.as_str() {
            "data" | "string" => Kind::Data,
            "array" => Kind::Array,
            "null" => Kind::Null,
            "ref" => Kind::Ref,
            "shared" => Kind::Shared,
            "serialized" => Kind::Serialized,
            _ => Kind::Object,
        };
        let id = self.values.add(Value::new(kind, element.line));
        for (key, text) in &element.attributes {
            if *key == self.names.name {
                let name = self.values.intern(text);
                self.values.get_mut(id).name = Some(name);
            } else if *key == self.names.type_name {
                let name = self.values.intern(text);
                self.values.get_mut(id).type_name = Some(name);
            } else if *key == self.names.value {
                self.values.get_mut(id).text = Some(text.as_ref().into());
            } else if kind == Kind::Object && !key.contains(':') && *key != "xmlns" {
                // Attribute form: every unprefixed attribute is a field in inline syntax.
                let member = inline::parse_value(&mut self.values, text, element.line);
                let name = self.values.intern(key);
                self.values.get_mut(member).name = Some(name);
                self.values.append_to(id, member);
            }
        }
        id
    }

    fn id(&self, element: &Element<'_>, text: &str) -> Result<i64, ReadError> {
        text.trim()
            .parse()
            .map_err(|_| self.unexpected(element, format!("node id '{text}'"), "a whole number below 2^63"))
    }

    fn unexpected(&self, element: &Element<'_>, found: String, expected: &'static str) -> ReadError {
        ReadError::Unexpected { file: self.file.to_owned(), line: element.line, found, expected }
    }

    /// Resolves the edges, which may lead to nodes declared later.
    fn finish(mut self) -> Result<Graph, ReadError> {
        let Some(main_root) = self.main_root else {
            let roots: Vec<_> = self.roots.into_iter().collect();
            let found = if roots.is_empty() { "no root node".to_owned() } else { roots.join(", ") };
            return Err(ReadError::NoMainGraph { file: self.file.to_owned(), found });
        };
        let mut resolved = Vec::with_capacity(self.edges.len());
        let mut masters = HashMap::new();
        for edge in std::mem::take(&mut self.edges) {
            match (self.by_id.get(&edge.from), self.by_id.get(&edge.to)) {
                (Some(from), Some(to)) if edge.kind == EdgeKind::Master => {
                    masters.entry(*from).or_insert(*to);
                }
                (Some(from), Some(to)) => resolved.push((*from, *to, edge.kind == EdgeKind::Successor)),
                (from, _) => {
                    let missing = if from.is_none() { edge.from } else { edge.to };
                    self.report.warn(
                        format!("an edge refers to node {missing}, which is not in the file; it is ignored"),
                        Some(Location { file: self.file.to_owned(), line: edge.line }),
                    );
                }
            }
        }
        // Stable: children stay in the order of the file.
        resolved.sort_by_key(|(from, ..)| from.0);
        let mut edge_starts = vec![0; self.nodes.len() + 1];
        for (from, ..) in &resolved {
            edge_starts[from.index() + 1] += 1;
        }
        for i in 1..edge_starts.len() {
            edge_starts[i] += edge_starts[i - 1];
        }
        let (edges, is_successor) = resolved.into_iter().map(|(_, to, successor)| (to, successor)).unzip();
        let Parser { file, values, nodes, by_id, .. } = self;
        let file = file.to_owned();
        Ok(Graph { file, values, nodes, main_root, by_id, edges, is_successor, masters, edge_starts })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> (Graph, Report) {
        let mut report = Report::default();
        let graph = Graph::parse("graph.xml", text.as_bytes(), Limits::default(), &mut report).unwrap();
        (graph, report)
    }

    #[test]
    fn edges_go_to_nodes_before_and_behind() {
        let (graph, report) = parse(
            r#"<graph xmlns:p="http://grogra.de/xmlpersistence"><node root="MainGraph" id="5" type="N">
            <node ref="7" edges="/,-"/><node id="6" type="A" edges="+"><data p:name="x" p:value="1"/></node>
            <node id="8" type="B"/><node ref="9" edges="-"/></node><node id="7" type="C"/></graph>"#,
        );
        let targets = graph.edges_of(graph.main_root).map(|edge| graph.type_name(graph.target(edge)));
        assert_eq!(targets.collect::<Vec<_>>(), ["C", "A"]);
        let six = graph.by_id(6).unwrap();
        assert_eq!(graph.field(six, "x").unwrap().text(), "1");
        assert_eq!(report.warnings.len(), 1);
        assert!(report.warnings[0].message.contains("node 9"));
    }

    #[test]
    fn attribute_form_gives_members() {
        let (graph, _) = parse(
            r#"<graph xmlns:gx="http://grogra.de/xmlpersistence"><node root="MainGraph" id="0" type="N">
            <object gx:name="s" gx:type="T" guiShader="[a.B true 21]" raytracerShader="null"/></node></graph>"#,
        );
        let switch = graph.field(graph.main_root, "s").unwrap();
        let gui = graph.values.find(switch.members, "guiShader").unwrap();
        assert_eq!((graph.values.type_of(gui), gui.text()), (Some("a.B"), "true 21"));
        assert_eq!(graph.values.find(switch.members, "raytracerShader").unwrap().kind, Kind::Null);
    }

    #[test]
    fn a_graph_without_scene_names_its_roots() {
        let text = br#"<graph><node root="MetaGraph" id="1" type="N"/></graph>"#;
        let error = Graph::parse("graph.xml", text, Limits::default(), &mut Report::default()).err().unwrap();
        assert!(error.to_string().contains("MainGraph, but MetaGraph"), "{error}");
    }
}
