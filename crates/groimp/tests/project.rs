//! A whole project with sources, named shaders and a saved view.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{data, directory, graph};
use groimp::Project;
use scene::{Channel, Material, Object, Phong, Projection, Shape};

const REGISTRY: &str = r#"<project xmlns="http://grogra.de/registry" graph="graph.xml"><registry>
<ref name="project"><ref name="objects">
 <ref name="files"><de.grogra.pf.ui.registry.SourceFile name="pfs:m.rgg"/>
  <de.grogra.pf.ui.registry.SourceFile name="pfs:gone.rgg"/></ref>
 <ref name="3d"><ref name="shaders"><de.grogra.pf.registry.SONodeReference name="Leaf1" ref="94"/></ref></ref>
</ref></ref>
<ref name="workbench"><ref name="state"><de.grogra.pf.ui.registry.Layout name="layout">
 <de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="visibleLayers={true true false}
  camera=(projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.5]
  transformation=(1 0 0 0 0 1 0 0 0 0 1 -5 0 0 0 1))"/>
</de.grogra.pf.ui.registry.Layout></ref></ref></registry></project>"#;

/// The comment is in windows-1252.
const SOURCE: &[u8] =
    b"// gr\xfcn\nmodule Leaf(float len) extends Parallelogram(len, 1) {{setShader(shader(\"Leaf1\"));}}
module Bud extends Sphere(0.25);
module Lost extends Bud {{setShader(shader(\"NoSuchShader\"));}}
module Body ==> Sphere(random(0, 1));
";

const NAMED_PHONG: &str = r#"<node id="94" type="de.grogra.graph.impl.SharedObjectNode">
<ref gx:name="object" gx:value="95"/><node id="95" type="de.grogra.imp3d.shading.Phong" edges="edge.sharedobject">
<object gx:name="diffuse" gx:type="de.grogra.math.RGBColor" gx:value="true 5"/>
<object gx:name="specular" gx:type="de.grogra.math.Graytone" value="0.25"/>
<object gx:name="transparency" gx:type="de.grogra.math.RGBColor" gx:value="false 0.1 0.2 0.3"/></node></node>"#;

fn read(test: &str, nodes: &str) -> Project {
    let text = graph(&format!("{nodes}\n{NAMED_PHONG}"));
    let manifest = b"Name: m.rgg\r\nContent-Type: text/x-grogra-rgg; charset=windows-1252\r\n";
    let root = directory(
        test,
        &[
            ("project.gs", REGISTRY.as_bytes()),
            ("graph.xml", text.as_bytes()),
            ("m.rgg", SOURCE),
            ("META-INF/MANIFEST.MF", manifest),
        ],
    );
    groimp::read(&root).unwrap()
}

fn node(id: i64, type_name: &str, fields: &str) -> String {
    format!("<node id=\"{id}\" type=\"{type_name}\" edges=\"+\">{fields}</node>\n")
}

fn phong<'a>(project: &'a Project, object: &Object) -> &'a Phong {
    match &project.scene.materials[object.material.index()] {
        Material::Phong(phong) => phong,
        other => panic!("{object:?} has no Phong but {other:?}"),
    }
}

#[test]
fn modules_and_named_shaders() {
    let axis = "<object gx:name=\"axis\" gx:value=\"0.5 0.0 0.0\"/>";
    let shared = "<shared gx:name=\"shader\" gx:value=\"MetaGraph:#94\"/>";
    let nodes = node(1, "m$Leaf", &(data("length", 2.0) + axis))
        + &node(2, "m$Bud", shared)
        + &node(3, "m$Lost", "")
        + &node(4, "m$Body", "")
        + &node(5, "m$NotDeclared", "");
    let project = read("modules", &nodes);
    let [leaf, bud, lost] = &project.scene.objects[..] else { panic!("{:?}", project.scene.objects) };
    assert!(matches!(leaf.shape, Shape::Parallelogram { length: 2.0, .. }));
    assert_eq!((leaf.origin.node, bud.origin.node), (1, 2));
    assert_eq!(project.scene.type_names[bud.origin.type_name.index()], "m$Bud");
    assert_eq!(bud.shape, Shape::Sphere { radius: 0.25 });
    assert_eq!(leaf.material, bud.material);
    let constant = |channel: Option<scene::ChannelId>| match project.scene.channels[channel.unwrap().index()]
    {
        Channel::Constant(color) => color,
        ref other => panic!("{other:?} is not a constant"),
    };
    let phong = phong(&project, leaf);
    assert_eq!(constant(phong.diffuse), [0.0, 1.0, 0.0]);
    assert_eq!(constant(phong.specular), [0.25; 3]);
    assert_eq!(constant(phong.transparency), [0.1, 0.2, 0.3]);
    assert!(phong.interpolated_transparency && phong.shininess.is_none());
    let grey = [128.0 / 255.0; 3];
    assert_eq!(project.scene.materials[lost.material.index()], Material::Rgba { color: grey, opacity: 1.0 });
    let report = project.report.to_string();
    for expected in [
        "no shader 'NoSuchShader'",
        "m.rgg:5: module m$Body: its body after ==> is not drawn",
        "the type 'm$NotDeclared' is not known",
        "the source 'gone.rgg' is not in the project",
    ] {
        assert!(report.contains(expected), "'{expected}' is missing in\n{report}");
    }
}

#[test]
fn the_saved_view_hides_layers() {
    let hidden = format!(
        "<node id=\"1\" type=\"de.grogra.imp3d.objects.Sphere\" edges=\"+\">{}{}</node>",
        data("layer", 2),
        node(2, "de.grogra.imp3d.objects.Sphere", &data("layer", 1))
    );
    let light = node(3, "de.grogra.imp3d.objects.LightNode", &data("layer", 2));
    let project = read("layers", &(hidden + &light));
    assert_eq!(project.scene.objects.iter().map(|o| o.origin.node).collect::<Vec<_>>(), [2]);
    assert_eq!(project.scene.lights.len(), 1);
    assert_eq!(project.report.skipped[0].reason, "its layer is hidden in the saved view");
    assert_eq!(project.scene.camera.projection, Projection::Perspective { fov_x: 0.5, aspect: 1.0 });
    assert_eq!(project.scene.camera.view_from_world.translation.z, -5.0);
}

#[test]
fn switches_choose_the_shader_of_pictures() {
    let switch = |gui: &str, raytracer: &str| {
        format!(
            "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.AlgorithmSwitchShader\" \
             guiShader=\"{gui}\" raytracerShader=\"{raytracer}\" \
             radiationShader=\"[de.grogra.imp3d.shading.RGBAShader true 16]\"/>"
        )
    };
    let red = "[de.grogra.imp3d.shading.RGBAShader true 26]";
    let blue = "[de.grogra.imp3d.shading.RGBAShader false 0.0 0.0 1.0 0.5]";
    let sphere = "de.grogra.imp3d.objects.Sphere";
    let both = "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.SideSwitchShader\" frontShader=\"[\
                de.grogra.imp3d.shading.RGBAShader true 26]\" backShader=\"null\"/>";
    let nodes = node(1, sphere, &switch(red, blue))
        + &node(2, sphere, &switch(red, "null"))
        + &node(3, sphere, &switch("null", "null"))
        + &node(4, sphere, both);
    let project = read("switches", &nodes);
    let material = |i: usize| project.scene.materials[project.scene.objects[i].material.index()].clone();
    assert_eq!(material(0), Material::Rgba { color: [0.0, 0.0, 1.0], opacity: 0.5 });
    assert_eq!(material(1), Material::Rgba { color: [1.0, 0.0, 0.0], opacity: 1.0 });
    // No applicable shader means: inherit, here the grey of the root.
    assert_eq!(material(2), Material::Rgba { color: [128.0 / 255.0; 3], opacity: 1.0 });
    assert_eq!(material(3), material(1));
}

#[test]
fn hostile_lights_are_skipped() {
    let light = |id: i64, class: &str, fields: &str| {
        let object = format!(
            "<object gx:name=\"light\" gx:type=\"de.grogra.imp3d.objects.{class}\">{fields}</object>"
        );
        node(id, "de.grogra.imp3d.objects.LightNode", &object)
    };
    let nodes = light(1, "SpotLight", &data("innerAngle", "NaN"))
        + &light(2, "PointLight", &data("power", "-1"))
        + &light(3, "DirectionalLight", &data("powerDensity", "Infinity"))
        + &light(4, "AmbientLight", "")
        + &light(5, "SpotLight", &(data("innerAngle", 2.0) + &data("outerAngle", 1.0)));
    let project = read("hostile_lights", &nodes);
    let [spot] = &project.scene.lights[..] else { panic!("{:?}", project.scene.lights) };
    assert!(matches!(spot.kind, scene::LightKind::Spot { inner_angle: 2.0, outer_angle: 2.0, .. }));
    assert_eq!(project.report.skipped.len(), 3, "{}", project.report);
}

#[test]
fn shaders_that_would_give_back_more_than_they_get_are_named_by_type() {
    let phong = |diffuse: f64, transparency: f64| {
        format!(
            "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.Phong\">\
             <object gx:name=\"diffuse\" gx:type=\"de.grogra.math.Graytone\" value=\"{diffuse}\"/>\
             <object gx:name=\"specular\" gx:type=\"de.grogra.math.Graytone\" value=\"0.4\"/>\
             <object gx:name=\"transparency\" gx:type=\"de.grogra.math.Graytone\" value=\"{transparency}\"/>\
             </object>"
        )
    };
    let sphere = |id, shader: &str| node(id, "de.grogra.imp3d.objects.Sphere", shader);
    let bright = "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.RGBAShader\" gx:value=\"false 2 0 0 1\"/>";
    let nodes = [
        sphere(1, &phong(0.9, 0.0)),
        sphere(2, &phong(0.9, 0.0)),
        // Half of the light passes: (1 - 0.5) * 1.3 + 0.5 is still more than 1; of 0.6 + 0.4 it is 1.
        sphere(3, &phong(0.9, 0.5)),
        sphere(4, &phong(0.6, 0.5)),
        sphere(5, bright),
    ];
    let project = read("gains", &nodes.concat());
    let gains: Vec<_> = project.report.warnings.iter().filter(|w| w.message.contains("gives back")).collect();
    let worst = ["(node 5 and 2 more of this type) gives back up to 2.000"];
    assert_eq!(gains.len(), worst.len(), "{gains:?}");
    for (warning, part) in gains.iter().zip(worst) {
        assert!(warning.message.contains(part), "{warning}");
    }
}
