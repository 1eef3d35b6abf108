//! Bodies of modules in a whole project: frames, shaders, layers and limits.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{data, directory, graph};
use glam::DVec3;
use groimp::Project;
use scene::{Material, Shape};

const REGISTRY: &str = r#"<project xmlns="http://grogra.de/registry" graph="graph.xml"><registry>
<ref name="project"><ref name="objects"><ref name="files">
 <de.grogra.pf.ui.registry.SourceFile name="pfs:m.rgg"/></ref></ref></ref>
<ref name="workbench"><ref name="state"><de.grogra.pf.ui.registry.Layout name="layout">
 <de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="visibleLayers={true true false}
  camera=(projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.5]
  transformation=(1 0 0 0 0 1 0 0 0 0 1 -5 0 0 0 1))"/>
</de.grogra.pf.ui.registry.Layout></ref></ref></registry></project>"#;

fn read(test: &str, source: &str, nodes: &str) -> Project {
    let files: [(&str, &[u8]); 3] = [
        ("project.gs", REGISTRY.as_bytes()),
        ("graph.xml", &graph(nodes).into_bytes()),
        ("m.rgg", source.as_bytes()),
    ];
    groimp::read(&directory(test, &files)).unwrap()
}

fn node(id: i64, type_name: &str, fields: &str) -> String {
    format!("<node id=\"{id}\" type=\"{type_name}\" edges=\"+\">{fields}</node>\n")
}

#[test]
fn bodies_start_at_the_own_frame_and_real_children_at_the_post_frame() {
    let source = "module Organ(float r) extends Box(2, 1, 1) {{setShader(RED);}} ==> M(3) Sphere(r) Tip;
        module Tip ==> M(r) Sphere(0.125).(setShader(GREEN));
        const float r = 10;";
    let fields = data("r", 0.5) + &data("length", 2);
    let child = node(8, "de.grogra.imp3d.objects.Sphere", "");
    let project = read("body_frames", source, &node(7, "m$Organ", &(fields + &child)));
    let scene = &project.scene;
    let found: Vec<_> = scene
        .objects
        .iter()
        .map(|o| (o.origin.node, o.shape.name(), o.world_from_object.translation.z))
        .collect();
    assert_eq!(found, [(7, "Box", 0.0), (7, "Sphere", 3.0), (7, "Sphere", 13.0), (8, "Sphere", 2.0)]);
    let color = |i: usize| match &scene.materials[scene.objects[i].material.index()] {
        Material::Rgba { color, .. } => *color,
        other => panic!("{other:?}"),
    };
    assert_eq!([color(1), color(2), color(3)], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
    assert_eq!(scene.objects[1].shape, Shape::Sphere { radius: 0.5 });
    let types: Vec<_> =
        scene.objects.iter().map(|o| scene.type_names[o.origin.type_name.index()].as_str()).collect();
    assert_eq!(types[..3], ["m$Organ"; 3]);
}

#[test]
fn turtle_state_goes_through_bodies() {
    let source = "module X ==> D(0.5) P(RED) [F(1)] RL(90) L(2) F0;";
    let project = read("body_turtle", source, &node(7, "m$X", ""));
    let [up, side] = &project.scene.objects[..] else { panic!("{:?}", project.scene.objects) };
    assert!(matches!(up.shape, Shape::Cylinder { radius: 0.25, length: 1.0, .. }), "{up:?}");
    assert!(matches!(side.shape, Shape::Cylinder { radius: 0.25, length: 2.0, .. }), "{side:?}");
    let head = side.world_from_object.transform_vector3(DVec3::Z);
    assert!((head - DVec3::NEG_Y).length() < 1e-12, "{head}");
    assert_eq!(up.material, side.material);
}

#[test]
fn hidden_layers_and_bodies_that_need_a_model_are_reported() {
    let source = "module X(int k) ==> Sphere(1).(setLayer(k)) Sphere(1).(setLayer(1));
        module Y ==> Null\n Sphere(random(0, 1));";
    let hidden = data("k", 2);
    let nodes = node(1, "m$X", &hidden) + &node(2, "m$X", "") + &node(3, "m$Y", "") + &node(4, "m$Y", "");
    let project = read("body_layers", source, &nodes);
    assert_eq!(project.scene.objects.len(), 3);
    let report = project.report.to_string();
    assert!(report.contains("skipped: 1 x m$X: its layer is hidden"), "{report}");
    assert!(report.contains("warning: m.rgg:3: module m$Y: its body after ==> is not drawn: "), "{report}");
    assert!(report.contains("(2 times)"), "{report}");
}

#[test]
fn bodies_without_end_are_cut() {
    for (test, source, expected) in [
        ("body_deep", "module X ==> Sphere(1) X;", "nested deeper"),
        ("body_wide", "module X ==> for (1:5000) (Null) X X;", "too many nodes"),
        ("body_long", "module X ==> for (int i = 0; true; i++) ();", "too involved"),
    ] {
        let project = read(test, source, &node(1, "m$X", ""));
        let report = project.report.to_string();
        assert!(report.contains(expected), "{test}: {report}");
        assert!(project.scene.objects.len() <= 64, "{test}");
    }
}

#[test]
fn bodies_make_lights_from_arrays_of_the_file() {
    let source =
        "module Lamp(double power) extends LightNode().(setLight(new DirectionalLight().(setPowerDensity(
            power), getColor().set(new RGBColor(1, 1, 0)))));
        const int n = 3;
        module X { float[] power = new float[n]; }
        ==> [for (int j = 0; j <= n - 1; j++) ([M(j) Lamp(power[j])])]
            Parallelogram(1, 1).(setLight(new AreaLight().(setPower(6), setExponent(0))), setShader(WHITE));";
    let powers = "<array gx:name=\"power\" gx:value=\"2.0 4.0 8.0\"/>";
    let project = read("body_lights", source, &node(1, "m$X", powers));
    assert!(project.report.is_empty(), "{}", project.report);
    let lights: Vec<_> = project
        .scene
        .lights
        .iter()
        .map(|light| match light.kind {
            scene::LightKind::Directional { irradiance } => {
                (light.world_from_light.translation.z, irradiance)
            }
            ref other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(lights, [(0.0, [1.0, 1.0, 0.0]), (1.0, [2.0, 2.0, 0.0]), (2.0, [4.0, 4.0, 0.0])]);
    let lamp = project.scene.objects[0].emission.unwrap();
    assert_eq!((lamp.power, lamp.exponent), ([2.0; 3], 0.0));
}

#[test]
fn bodies_place_with_rotations_and_scales() {
    let source =
        "module X ==> Null().(setTranslation(1, 2, 3), setRotation(0, Math.PI / 2, 0), setScale(1, 2, 4))
        Sphere(1), Sphere(2);";
    let project = read("body_rotation", source, &node(1, "m$X", ""));
    let [turned, plain] = &project.scene.objects[..] else { panic!("{}", project.report) };
    let frame = turned.world_from_object;
    assert_eq!(frame.translation, DVec3::new(1.0, 2.0, 3.0));
    for (axis, expected) in [(DVec3::X, DVec3::NEG_Z), (DVec3::Y, 2.0 * DVec3::Y), (DVec3::Z, 4.0 * DVec3::X)]
    {
        assert!((frame.transform_vector3(axis) - expected).length() < 1e-12, "{frame}");
    }
    assert_eq!(plain.world_from_object, scene::DAffine3::IDENTITY);
}
