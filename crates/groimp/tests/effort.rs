//! Inputs that once took time or memory out of proportion to their size. They are too large to be files, so they are
//! made here. The fuzz targets' functions read them; a test that does not end has found its bug again.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

use groimp::fuzzing;
use std::fmt::Write;

/// About this many bytes have each part of an input.
const SIZE: usize = 200_000;

const OBJECTS: &str = "de.grogra.imp3d.objects";

fn many(part: &str) -> String {
    part.repeat(SIZE / part.len())
}

fn numbered(size: usize, part: impl Fn(usize) -> String) -> String {
    let mut text = String::new();
    for number in 10.. {
        if text.len() > size {
            break;
        }
        write!(text, "{}", part(number)).unwrap();
    }
    text
}

fn sources(text: String) {
    fuzzing::sources(text.as_bytes());
}

fn project(graph: &str, source: &str) {
    let start =
        "<graph xmlns:gx=\"http://grogra.de/xmlpersistence\"><node root=\"MainGraph\" id=\"0\" type=\"N\">";
    fuzzing::project(format!("\n%%%%\n{start}{graph}</node></graph>\n%%%%\n{source}").as_bytes());
}

/// Nodes of the types `Model$A10`, `Model$A11`, ...
fn nodes_of_types() -> String {
    numbered(SIZE, |i| format!("<node id=\"{i}\" type=\"Model$A{i}\"/>"))
}

#[test]
fn type_parameters_that_are_not_closed() {
    sources(format!("module X({})", many("a<b,")));
    sources(format!("module X extends F(1) {{ float a = f({}); }}", many("a<b,")));
}

#[test]
fn many_texts_in_one_line() {
    for part in ["\"\"", "''", "\"a", "\"\\u00"] {
        sources(many(part));
        sources(format!("module X {{ int a = {}; }}", many(part)));
    }
}

#[test]
fn long_names_around_many_declarations() {
    let long = "x".repeat(SIZE);
    sources(format!("module {long} {{ {} }}", many("module a;")));
    sources(format!("class {long} {{ {} }}", many("static int a = 1;")));
    sources(format!("class A {{ {long} {} b; }}", many("a,")));
    sources(format!("class A {{ {}x {} b; }}", many("x."), many("a,")));
    sources(format!("module {}", many("x{module ")));
}

#[test]
fn imports_and_constants_that_are_searched_often() {
    sources(format!("{} module X {{ {} }}", many("import Model.b;"), many("Shader a = RED;")));
    sources(format!("{} module X {{ float b = {} 1; }}", many("const int a = 1;"), many("a+")));
}

#[test]
fn bodies_that_make_large_instances() {
    let fields = numbered(SIZE, |i| format!("int a{i};"));
    sources(format!("module A {{ {fields} }} module B ==> for (1:1000000) A;"));
    let methods = numbered(SIZE, |i| format!("int a{i}() {{}}"));
    sources(format!("module A {{ {methods} }} module B ==> for (1:1000000) A;"));
    let nodes = numbered(SIZE, |i| format!("<node id=\"{i}\" type=\"Model$B\" edges=\"+\"/>"));
    project(&nodes, &format!("module A {{ {fields} }} module B extends A ==> F;"));
}

#[test]
fn a_body_that_asks_a_large_node_for_many_fields() {
    let fields = numbered(SIZE, |i| format!("int a{i};"));
    let stored = many("<data gx:name=\"x\"/>").repeat(4);
    let node = format!("<node id=\"1\" type=\"Model$B\" edges=\"+\">{stored}</node>");
    project(&node, &format!("module A {{ {fields} }} module B extends A ==> F;"));
}

#[test]
fn types_that_share_a_costly_base() {
    let types = numbered(SIZE, |i| format!("module A{i} extends B;"));
    project(&nodes_of_types(), &format!("module B {{ float x = {} 1; }} {types}", many("1+")));
    let fields = numbered(SIZE, |i| format!("int a{i}=1;"));
    project(&nodes_of_types(), &format!("module B {{ {fields} }} {types}"));
}

#[test]
fn shaders_that_lead_to_the_same_large_one() {
    let phong = format!("<node id=\"9\" type=\"de.grogra.imp3d.shading.Phong\">{}</node>", many("<a/>"));
    let spheres = numbered(SIZE, |i| {
        let (sphere, shared) = (2 * i, 2 * i + 1);
        format!(
            "<node id=\"{sphere}\" type=\"{OBJECTS}.Sphere\" edges=\"+\"><ref gx:name=\"shader\" gx:value=\"{shared}\"/></node>\
             <node id=\"{shared}\" type=\"x.SharedObjectNode\"><ref gx:name=\"object\" gx:value=\"9\"/></node>"
        )
    });
    project(&(phong + &spheres), "");
}

#[test]
fn channels_that_share_a_long_chain_of_coordinates() {
    let chain = numbered(SIZE, |i| {
        let next = i + 1;
        format!(
            "<node id=\"{i}\" type=\"AffineUVTransformation\"><ref gx:name=\"input\" gx:value=\"{next}\"/></node>"
        )
    });
    let spheres = numbered(SIZE, |i| {
        let id = 1_000_000 + i;
        format!(
            "<node id=\"{id}\" type=\"{OBJECTS}.Sphere\" edges=\"+\"><object gx:name=\"shader\" gx:type=\"Phong\"><object \
             gx:name=\"diffuse\" gx:type=\"Checker\"><ref gx:name=\"input\" gx:value=\"10\"/></object></object></node>"
        )
    });
    project(&(chain + &spheres), "");
}

#[test]
fn resources_in_directories_with_long_names() {
    let deep = format!("<ref name=\"{}\">", "x".repeat(SIZE / 20)).repeat(20);
    let files = numbered(4 * SIZE, |i| {
        format!("<de.grogra.pf.ui.registry.FileObjectItem name=\"{i}\" systemId=\"pfs:a\"/>")
    });
    let end = "</ref>".repeat(20);
    fuzzing::registry(format!("<project><registry>{deep}{files}{end}</registry></project>").as_bytes());
}

#[test]
fn a_source_that_is_listed_often() {
    let item = "<de.grogra.pf.ui.registry.SourceFile name=\"pfs:Model.rgg\"/>";
    let registry = format!("<project><registry>{}</registry></project>", many(item));
    let graph = "<graph><node root=\"MainGraph\" id=\"0\" type=\"N\"/></graph>";
    fuzzing::project(format!("{registry}\n%%%%\n{graph}\n%%%%\n{}", many("(")).as_bytes());
}

/// The zip reader tries each of these ends, and each time reads the directory up to the entry that is missing.
#[test]
fn a_zip_with_many_ends() {
    let mut bytes = Vec::new();
    let entries: u16 = 5_000;
    for _ in 0..entries {
        bytes.extend([b'P', b'K', 1, 2, 20, 0, 20, 0]);
        bytes.extend([0; 20]);
        bytes.extend([1, 0]);
        bytes.extend([0; 16]);
        bytes.push(b'a');
    }
    let directory = u32::try_from(bytes.len()).unwrap();
    while bytes.len() < 4 * SIZE {
        bytes.extend(b"PK\x05\x06\0\0\0\0");
        bytes.extend((entries + 1).to_le_bytes());
        bytes.extend((entries + 1).to_le_bytes());
        bytes.extend(directory.to_le_bytes());
        bytes.extend([0; 6]);
    }
    fuzzing::archive(&bytes);
}
