//! Side switches and interiors.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{file, graph};
use scene::{Interior, Material, Scene};

const NODE: &str = "de.grogra.imp3d.objects.";
const SHADING: &str = "de.grogra.imp3d.shading.";

fn read(test: &str, nodes: &str) -> groimp::Project {
    groimp::read(&file(test, "graph.xml", graph(nodes).as_bytes())).unwrap()
}

fn rgba(red: f64, green: f64, blue: f64) -> String {
    format!("[{SHADING}RGBAShader false {red} {green} {blue} 1.0]")
}

fn sphere(id: u32, content: &str) -> String {
    format!("<node id=\"{id}\" type=\"{NODE}Sphere\" edges=\"+\">{content}</node>")
}

fn switch(front: &str, back: &str) -> String {
    format!(
        "<object gx:name=\"shader\" gx:type=\"{SHADING}SideSwitchShader\" frontShader=\"{front}\" \
         backShader=\"{back}\"/>"
    )
}

fn colors(scene: &Scene, object: usize) -> Vec<[f64; 3]> {
    let color = |material: &Material| match material {
        Material::Rgba { color, .. } => *color,
        other => panic!("{other:?}"),
    };
    match &scene.materials[scene.objects[object].material.index()] {
        Material::SideSwitch { front, back } => {
            vec![color(&scene.materials[front.index()]), color(&scene.materials[back.index()])]
        }
        single => vec![color(single)],
    }
}

#[test]
fn a_side_switch_has_a_material_for_each_side() {
    let (red, blue) = (rgba(1.0, 0.0, 0.0), rgba(0.0, 0.0, 1.0));
    let inner = format!("[{SHADING}SideSwitchShader frontShader={blue} backShader={red}]");
    let text = [
        sphere(1, &switch(&red, &blue)),
        sphere(2, &switch(&red, "null")),
        sphere(3, &switch("null", "null")),
        // Seen from the front, the inner switch shows its front, too.
        sphere(4, &switch(&inner, &inner)),
        sphere(5, &switch(&red, &red)),
    ];
    let project = read("side-switch", &text.concat());
    let scene = &project.scene;
    let (red, blue, grey) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [128.0 / 255.0; 3]);
    assert_eq!(colors(scene, 0), [red, blue]);
    assert_eq!(colors(scene, 1), [red]);
    assert_eq!(colors(scene, 2), [grey]);
    assert_eq!(colors(scene, 3), [blue, red]);
    assert_eq!(colors(scene, 4), [red]);
    assert!(project.report.skipped.is_empty(), "{:?}", project.report);
}

#[test]
fn switches_that_contain_themselves_are_reported() {
    let shader = format!(
        "<node id=\"9\" type=\"{SHADING}SideSwitchShader\"><ref gx:name=\"frontShader\" gx:value=\"9\"/></node>"
    );
    let project =
        read("side-switch-cycle", &sphere(1, &format!("<ref gx:name=\"shader\" gx:value=\"9\"/>{shader}")));
    assert_eq!(colors(&project.scene, 0), [[128.0 / 255.0; 3]]);
    assert!(project.report.warnings.iter().any(|warning| warning.message.contains("refers to itself")));
}

#[test]
fn interiors_are_inherited_and_checked() {
    let ior = |index: &str| {
        format!("<object gx:name=\"interior\" gx:type=\"{SHADING}IOR\" indexOfRefraction=\"{index}\"/>")
    };
    let node = format!(
        "<node id=\"7\" type=\"{SHADING}IOR\"><data gx:name=\"indexOfRefraction\" gx:value=\"1.7\"/></node>"
    );
    let text = [
        sphere(1, ""),
        sphere(2, &(ior("1.33") + &sphere(3, ""))),
        sphere(4, &format!("<ref gx:name=\"interior\" gx:value=\"7\"/>{node}")),
        sphere(5, &ior("-2")),
    ];
    let project = read("interiors", &text.concat());
    let interiors: Vec<_> = project.scene.objects.iter().map(|object| object.interior).collect();
    let filled = |refractive_index| Some(Interior { refractive_index });
    assert_eq!(interiors, [None, filled(1.33), filled(1.33), filled(1.7), None]);
    assert!(project.report.warnings.iter().any(|warning| warning.message.contains("refractive index -2")));
}
