//! Instances, shared masters and grids of clones.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{data, file, graph};
use glam::DVec3;
use groimp::Project;
use scene::Shape;

const OBJECTS: &str = "de.grogra.imp3d.objects.";

fn read(test: &str, nodes: &str) -> Project {
    groimp::read(&file(test, "graph.xml", graph(nodes).as_bytes())).unwrap()
}

fn object(id: i64, class: &str, edges: &str, content: &str) -> String {
    format!("<node id=\"{id}\" type=\"{OBJECTS}{class}\" edges=\"{edges}\">{content}</node>\n")
}

fn moved(x: f64, y: f64, z: f64) -> String {
    format!("<object gx:name=\"transform\" gx:type=\"de.grogra.math.TVector3d\" gx:value=\"{x} {y} {z}\"/>")
}

/// Red as a shader of a node.
const RED: &str =
    "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.RGBAShader\" gx:value=\"false 1 0 0 1\"/>";

#[test]
fn a_master_is_drawn_once_and_placed_by_every_instance() {
    let sphere = object(12, "Sphere", "-", &data("radius", 0.5));
    let master =
        object(10, "Null", "edge.master", &(moved(0.0, 0.0, 1.0) + &object(11, "Cylinder", "+", &sphere)));
    let first = object(1, "Instance3D", "+", &(moved(5.0, 0.0, 0.0) + &master));
    let second =
        object(2, "Instance3D", "+", &(moved(0.0, 7.0, 0.0) + "<node ref=\"10\" edges=\"edge.master\"/>"));
    let project = read("instances-shared", &(first + &second));
    let scene = &project.scene;
    assert!(scene.objects.is_empty());
    assert_eq!((scene.groups.len(), scene.instances.len()), (1, 2));
    let group = &scene.groups[0];
    assert_eq!(group.objects.len(), 2);
    assert_eq!(group.objects[0].world_from_object.translation, DVec3::Z);
    // The cylinder moves its child to its end.
    assert_eq!(group.objects[1].world_from_object.translation, DVec3::new(0.0, 0.0, 2.0));
    assert_eq!(group.objects[1].origin.node, 12);
    let places: Vec<_> =
        scene.instances.iter().map(|instance| instance.world_from_group.translation).collect();
    assert_eq!(places, [DVec3::new(5.0, 0.0, 0.0), DVec3::new(0.0, 7.0, 0.0)]);
    assert_eq!(scene.instances[1].origin.node, 2);
    let (low, high) = scene.bounds().unwrap();
    assert_eq!((low, high), (DVec3::new(-1.0, -1.0, 1.0), DVec3::new(6.0, 8.0, 2.5)));
}

#[test]
fn members_without_a_shader_take_that_of_their_instance() {
    let master = object(10, "Null", "edge.master", &object(11, "Sphere", "+", ""));
    let plain = object(1, "Instance3D", "+", &master);
    let again = "<node ref=\"10\" edges=\"edge.master\"/>";
    let red = object(2, "Instance3D", "+", &format!("{RED}{again}"));
    let red_too = object(3, "Instance3D", "+", &format!("{RED}{again}"));
    let scene = read("instances-shader", &(plain + &red + &red_too)).scene;
    assert_eq!((scene.groups.len(), scene.instances.len()), (2, 3));
    assert_eq!(scene.instances[1].group, scene.instances[2].group);
    let material = |instance: usize| {
        let group = &scene.groups[scene.instances[instance].group.index()];
        &scene.materials[group.objects[0].material.index()]
    };
    assert_eq!(material(1), &scene::Material::Rgba { color: [1.0, 0.0, 0.0], opacity: 1.0 });
    assert_ne!(material(0), material(1));
}

#[test]
fn an_instance_may_export_the_frame_at_the_end_of_its_master() {
    // The master turns the head to +x and walks on by 2; a branch does not count.
    let branch = "<node id=\"15\" type=\"de.grogra.turtle.M\" edges=\"+\"><data gx:name=\"length\" gx:value=\"9\"/></node>";
    let walk = format!(
        "{branch}<node id=\"13\" type=\"de.grogra.turtle.RU\" edges=\"-\">{}\
         <node id=\"14\" type=\"de.grogra.turtle.M\" edges=\"-\">{}</node></node>",
        data("angle", 90),
        data("length", 2)
    );
    let master = object(10, "Null", "edge.master", &walk);
    let case = |exported: u32, id: i64, master: &str| {
        let child = object(id + 1, "Cylinder", "-", "");
        let field = data("exportedTransformation", exported);
        object(id, "Instance3D", "+", &format!("{}{field}{master}{child}", moved(1.0, 0.0, 0.0)))
    };
    let again = "<node ref=\"10\" edges=\"edge.master\"/>";
    let text = case(0, 20, &master) + &case(1, 30, again) + &case(2, 40, again);
    let scene = read("instances-export", &text).scene;
    let frames: Vec<_> = scene.objects.iter().map(|object| object.world_from_object).collect();
    assert!((frames[0].translation - DVec3::X).length() < 1e-12);
    assert!((frames[1].translation - DVec3::new(3.0, 0.0, 0.0)).length() < 1e-12);
    assert!((frames[1].matrix3.z_axis - DVec3::X).length() < 1e-12);
    assert!((frames[2].translation - DVec3::new(3.0, 0.0, 0.0)).length() < 1e-12);
    assert!((frames[2].matrix3.z_axis - DVec3::Z).length() < 1e-12);
}

#[test]
fn a_grid_repeats_its_children_and_nothing_else() {
    let fields = data("xCount", 3) + &data("yCount", 2) + &data("xDistance", 2.0) + &data("yDistance", 5.0);
    let child = object(2, "Sphere", "+", &moved(0.0, 0.0, 1.0));
    let grid = object(1, "GridClonerNode", "+", &(moved(1.0, 0.0, 0.0) + &fields + &child));
    let scene = read("instances-grid", &(grid + &object(5, "Box", "+", ""))).scene;
    assert_eq!(scene.objects.len(), 1);
    assert!(matches!(scene.objects[0].shape, Shape::Box { .. }));
    assert_eq!(scene.groups[0].objects.len(), 1);
    let mut places: Vec<_> = scene.instances.iter().map(|i| i.world_from_group.translation).collect();
    places.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
    let expected = [1.0, 3.0, 5.0].map(|x| [DVec3::new(x, 0.0, 0.0), DVec3::new(x, 5.0, 0.0)]).concat();
    assert_eq!(places, expected);
}

#[test]
fn masters_that_contain_instances_nest_and_cycles_are_cut() {
    // The master of the first instance holds an instance of itself and one of another master.
    let inner = object(20, "Null", "edge.master", &object(21, "Sphere", "+", ""));
    let own =
        object(12, "Instance3D", "+", &(moved(0.0, 0.0, 1.0) + "<node ref=\"10\" edges=\"edge.master\"/>"));
    let other = object(13, "Instance3D", "+", &(moved(0.0, 2.0, 0.0) + &inner));
    let master = object(10, "Null", "edge.master", &(own + &other));
    let project = read("instances-cycle", &object(1, "Instance3D", "+", &master));
    assert_eq!(project.scene.bounds(), Some((DVec3::new(-1.0, 1.0, -1.0), DVec3::new(1.0, 3.0, 1.0))));
    let warnings: Vec<_> = project.report.warnings.iter().map(ToString::to_string).collect();
    assert!(warnings.iter().any(|warning| warning.contains("contain themselves")), "{warnings:?}");
}

#[test]
fn an_instance_of_nothing_and_a_huge_grid_are_reported() {
    let huge = data("xCount", 1e9) + &data("yCount", 1e9);
    let endless = data("xDistance", "Infinity");
    let text = object(1, "Instance3D", "+", "")
        + &object(2, "GridClonerNode", "+", &huge)
        + &object(3, "GridClonerNode", "+", &endless);
    let limits = groimp::Limits { instances: 1000, ..groimp::Limits::default() };
    let path = file("instances-nothing", "graph.xml", graph(&text).as_bytes());
    let project = groimp::read_within(&path, limits).unwrap();
    let reasons: Vec<_> = project.report.skipped.iter().map(|skipped| skipped.reason.as_str()).collect();
    assert!(reasons[0].contains("no master") && reasons[1].contains("not finite"), "{reasons:?}");
    assert_eq!(project.scene.instances.len(), limits.instances);
    assert!(project.report.warnings.iter().any(|warning| warning.message.contains("too many instances")));
}

#[test]
fn a_light_in_a_master_shines_from_every_instance() {
    let master = object(10, "Null", "edge.master", &object(11, "LightNode", "+", ""));
    let scene = read("instances-light", &object(1, "Instance3D", "+", &master)).scene;
    assert!(scene.lights.is_empty(), "no default light is needed");
    assert_eq!(scene.groups[0].lights.len(), 1);
}
