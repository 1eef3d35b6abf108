//! Channel maps as the file stores them.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{data, file, graph};
use groimp::Project;
use scene::{Channel, CoordinateMap, DMat2, DVec2, Material};

/// Reads a sphere whose diffuse channel is node 10.
fn read(test: &str, maps: &str) -> Project {
    let sphere = "<node id=\"1\" type=\"de.grogra.imp3d.objects.Sphere\" edges=\"+\">\
        <object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.Phong\">\
        <ref gx:name=\"diffuse\" gx:value=\"10\"/></object></node>";
    groimp::read(&file(test, "graph.xml", graph(&format!("{sphere}{maps}")).as_bytes())).unwrap()
}

fn map(id: i64, class: &str, fields: &str) -> String {
    format!(
        "<node id=\"{id}\" type=\"de.grogra.imp3d.shading.{class}\" edges=\"channel.input\">{fields}</node>"
    )
}

fn reference(name: &str, id: i64) -> String {
    format!("<ref gx:name=\"{name}\" gx:value=\"{id}\"/>")
}

fn diffuse(project: &Project) -> &Channel {
    let Material::Phong(phong) = &project.scene.materials[project.scene.objects[0].material.index()] else {
        panic!("not a Phong")
    };
    &project.scene.channels[phong.diffuse.unwrap().index()]
}

#[test]
fn a_checker_with_a_chain_of_transformations() {
    let red = "<object gx:name=\"color1\" gx:type=\"de.grogra.math.RGBColor\" gx:value=\"true 10\"/>";
    let outer = data("scaleU", 4.0) + &data("offsetV", 0.5) + &reference("input", 12);
    let maps = map(10, "Checker", &(red.to_owned() + &reference("input", 11)))
        + &map(11, "AffineUVTransformation", &outer)
        + &map(12, "AffineUVTransformation", &(data("angle", 0.5) + &data("shear", 2.0)));
    let project = read("checker", &maps);
    let Channel::Checker { odd, even, coordinates } = diffuse(&project) else { panic!("not a checker") };
    assert_eq!(project.scene.channels[odd.index()], Channel::Constant([1.0, 0.0, 0.0]));
    assert_eq!(project.scene.channels[even.index()], Channel::Constant([0.0; 3]));
    // The input comes first.
    let [CoordinateMap::AffineUv { offset, linear }, outer] = &coordinates[..] else {
        panic!("{coordinates:?}")
    };
    let wide = DMat2::from_cols(DVec2::new(4.0, 0.0), DVec2::Y);
    assert_eq!(*outer, CoordinateMap::AffineUv { offset: DVec2::new(0.0, 0.5), linear: wide });
    assert_eq!(*offset, DVec2::ZERO);
    let (sin, cos) = 0.5f64.sin_cos();
    let expected = DMat2::from_cols(DVec2::new(cos + 2.0 * sin, -sin), DVec2::new(sin - 2.0 * cos, cos));
    assert!(linear.abs_diff_eq(expected, 1e-12), "{linear} is not {expected}");
    // The only remark is that the scene has no light.
    assert_eq!(project.report.warnings.len(), 1, "{}", project.report);
}

#[test]
fn maps_that_contain_themselves_are_reported() {
    let maps = map(10, "Checker", &(reference("color1", 10) + &reference("input", 11)))
        + &map(11, "AffineUVTransformation", &reference("input", 11));
    let project = read("circle", &maps);
    assert!(matches!(diffuse(&project), Channel::Checker { .. }));
    let report = project.report.to_string();
    for expected in ["a channel map contains itself", "or contains itself, and is left out"] {
        assert!(report.contains(expected), "'{expected}' is missing in\n{report}");
    }
}

#[test]
fn endless_nesting_is_reported() {
    let maps: String = (10..10_000).map(|id| map(id, "Checker", &reference("color2", id + 1))).collect();
    assert!(read("nesting", &maps).report.to_string().contains("nested deeper than 100"));
}
