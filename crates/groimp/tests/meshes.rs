//! Meshes in Java streams as GroIMP writes them.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use common::{data, file, graph};
use groimp::Project;
use scene::{DVec3, Material, Shape, VisibleSides};

const MESH: &str = "de.grogra.imp3d.objects.MeshNode";

/// Stream of a PolygonMesh, byte for byte as scene-format.md 2.7 describes it.
fn polygon_mesh(indices: &[i32], n: Option<&[f32]>, t: Option<&[f32]>, v: &[f32]) -> Vec<u8> {
    let mut s = Writer(vec![0xAC, 0xED, 0, 5, 0x73, 0x72]);
    s.text("de.grogra.imp3d.objects.PolygonMesh");
    s.0.extend([0xC6, 0x41, 0xA1, 0x8A, 0x27, 0xDA, 0x61, 0x0B, 2, 0, 5]);
    s.0.push(b'I');
    s.text("stamp");
    s.array_field("indices", Some("[I"));
    s.array_field("n", Some("[F"));
    s.array_field("t", None);
    s.array_field("v", None);
    s.0.extend([0x78, 0x72]);
    s.text("de.grogra.imp3d.objects.PolygonsBase");
    s.0.extend([0x5D, 0x7C, 0xA9, 0x2E, 0x7D, 0x06, 0x25, 0x0B, 2, 0, 0, 0x78, 0x70]);
    // Handles: 0 class, 1 "[I", 2 "[F", 3 superclass, 4 object, 5 int[] class, 6 indices, 7 float[] class.
    s.0.extend([0, 0, 0, 3]);
    s.0.extend([0x75, 0x72]);
    s.text("[I");
    s.0.extend([0x4D, 0xBA, 0x60, 0x26, 0x76, 0xEA, 0xB2, 0xA5, 2, 0, 0, 0x78, 0x70]);
    s.0.extend((indices.len() as u32).to_be_bytes());
    s.0.extend(indices.iter().flat_map(|index| index.to_be_bytes()));
    let mut is_first = true;
    for floats in [n, t, Some(v)] {
        let Some(floats) = floats else {
            s.0.push(0x70);
            continue;
        };
        if is_first {
            s.0.extend([0x75, 0x72]);
            s.text("[F");
            s.0.extend([0x0B, 0x9C, 0x81, 0x89, 0x22, 0xE0, 0x0C, 0x42, 2, 0, 0, 0x78, 0x70]);
        } else {
            s.0.extend([0x75, 0x71, 0, 0x7E, 0, 7]);
        }
        is_first = false;
        s.0.extend((floats.len() as u32).to_be_bytes());
        s.0.extend(floats.iter().flat_map(|number| number.to_be_bytes()));
    }
    s.0
}

struct Writer(Vec<u8>);

impl Writer {
    fn text(&mut self, text: &str) {
        self.0.extend((text.len() as u16).to_be_bytes());
        self.0.extend(text.bytes());
    }

    /// A field of an array type, with the type's name or a reference to handle 2, "[F".
    fn array_field(&mut self, name: &str, type_name: Option<&str>) {
        self.0.push(b'[');
        self.text(name);
        match type_name {
            Some(type_name) => {
                self.0.push(0x74);
                self.text(type_name);
            }
            None => self.0.extend([0x71, 0, 0x7E, 0, 2]),
        }
    }
}

const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5];
/// A triangle and the same the other way round, as imported meshes list them.
const TWICE: [i32; 6] = [0, 1, 2, 0, 2, 1];

fn serialized(stream: &[u8]) -> String {
    format!("<serialized gx:name=\"polygons\" gx:value=\"{}\"/>", STANDARD.encode(stream))
}

fn node(id: i64, fields: &str) -> String {
    format!("<node id=\"{id}\" type=\"{MESH}\" edges=\"+\">{fields}</node>\n")
}

fn read(test: &str, nodes: &str) -> Project {
    groimp::read(&file(test, "graph.xml", graph(nodes).as_bytes())).unwrap()
}

#[test]
fn a_mesh_with_everything() {
    let normals = [0.0f32, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 1.0, 0.0];
    let uvs = [0.0f32, 0.0, 1.0, 0.0, 0.0, 1.0];
    let stream = polygon_mesh(&TWICE, Some(&normals), Some(&uvs), &CORNERS);
    let fields = serialized(&stream)
        + &data("visibleSides", 0)
        + "<object gx:name=\"transform\" gx:type=\"de.grogra.math.TVector3d\" gx:value=\"1.0 2.0 3.0\"/>"
        + "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.RGBAShader\" \
           gx:value=\"false 0.0 0.5 0.0 1.0\"/>";
    let project = read("mesh_everything", &node(1, &fields));
    let [object] = &project.scene.objects[..] else { panic!("{}", project.report) };
    let Shape::Mesh { mesh, visible_sides } = object.shape else { panic!("{object:?}") };
    assert_eq!(visible_sides, VisibleSides::Front);
    assert_eq!(object.world_from_object.translation, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(
        project.scene.materials[object.material.index()],
        Material::Rgba { color: [0.0, 0.5, 0.0], opacity: 1.0 }
    );
    let mesh = &project.scene.meshes[mesh.index()];
    assert_eq!(&mesh.triangles[..], [[0, 1, 2], [0, 2, 1]]);
    assert_eq!(mesh.positions[2], [0.0, 1.0, 0.5]);
    assert_eq!(mesh.normals[1], [0.0, 0.0, 2.0]);
    assert_eq!(mesh.uvs[2], [0.0, 1.0]);
    assert!(project.report.skipped.is_empty(), "{}", project.report);
}

#[test]
fn equal_meshes_are_stored_once() {
    let stream = polygon_mesh(&TWICE, None, None, &CORNERS);
    let other = polygon_mesh(&TWICE[..3], None, None, &CORNERS);
    let nodes = node(1, &serialized(&stream))
        + &node(2, &(serialized(&stream) + &data("visibleSides", 1)))
        + &node(3, &serialized(&other));
    let project = read("mesh_once", &nodes);
    let meshes: Vec<_> = project
        .scene
        .objects
        .iter()
        .map(|object| match object.shape {
            Shape::Mesh { mesh, visible_sides } => (mesh.0, visible_sides),
            _ => panic!("{object:?}"),
        })
        .collect();
    assert_eq!(meshes, [(0, VisibleSides::Both), (0, VisibleSides::Back), (1, VisibleSides::Both)]);
    assert_eq!(project.scene.meshes.len(), 2);
    assert!(project.scene.meshes[0].normals.is_empty() && project.scene.meshes[0].uvs.is_empty());
}

#[test]
fn broken_meshes_are_counted() {
    let whole = polygon_mesh(&TWICE, None, None, &CORNERS);
    let cases = [
        (serialized(&whole[..whole.len() - 1]), "too early"),
        (serialized(b"no stream"), "no Java stream header"),
        ("<serialized gx:name=\"polygons\" gx:value=\"%%%\"/>".to_owned(), "not base64"),
        (serialized(&polygon_mesh(&[0, 1, 3], None, None, &CORNERS)), "index 3 refers to no vertex"),
        (serialized(&polygon_mesh(&[0, 1, -1], None, None, &CORNERS)), "index -1 refers to no vertex"),
        (serialized(&polygon_mesh(&[0, 1], None, None, &CORNERS)), "no whole triangles"),
        (serialized(&polygon_mesh(&TWICE, None, None, &CORNERS[..8])), "no multiple of 3"),
        (serialized(&polygon_mesh(&TWICE, None, None, &[f32::NAN; 9])), "not finite"),
        (serialized(&polygon_mesh(&TWICE, Some(&CORNERS[..6]), None, &CORNERS)), "3 vertices, but 2 normals"),
        (serialized(&polygon_mesh(&[], None, None, &CORNERS)), "it has no polygons"),
        ("<null gx:name=\"polygons\"/>".to_owned(), "it has no polygons"),
        (String::new(), "it has no polygons"),
    ];
    let nodes: String = (1..).zip(&cases).map(|(id, (fields, _))| node(id, fields)).collect();
    // What is broken must not take its children along.
    let below =
        format!("{}<node id=\"99\" type=\"de.grogra.imp3d.objects.Sphere\" edges=\"+\"/>", cases[0].0);
    let project = read("mesh_broken", &(nodes + &node(98, &below)));
    assert_eq!(project.scene.objects.len(), 1);
    assert_eq!(project.report.skipped.iter().map(|skipped| skipped.count).sum::<usize>(), cases.len() + 1);
    for (_, expected) in &cases {
        let found = project.report.skipped.iter().any(|skipped| skipped.reason.contains(expected));
        assert!(found, "'{expected}' is missing in\n{}", project.report);
    }
}

#[test]
fn a_stream_changed_anywhere_does_no_harm() {
    let whole = polygon_mesh(&TWICE, None, None, &CORNERS);
    let changed = |at: usize, value: u8| {
        let mut stream = whole.clone();
        stream[at] = value;
        node(1 + at as i64 * 3 + i64::from(value % 3), &serialized(&stream))
    };
    let nodes: String =
        (0..whole.len()).flat_map(|at| [0u8, 0x71, 0xFF].map(|value| changed(at, value))).collect();
    let project = read("mesh_changed", &nodes);
    for mesh in &project.scene.meshes {
        assert!(mesh.triangles.iter().flatten().all(|index| (*index as usize) < mesh.positions.len()));
    }
}
