//! Channel maps as the file stores them.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{data, file, graph};
use groimp::Project;
use scene::{
    Channel, CoordinateMap, DAffine3, DMat2, DVec2, DVec3, Material, NeighbourFilter, VolumeFunction,
    WaveForm, WaveStep,
};

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

#[test]
fn volume_maps_with_wave_forms_and_coordinates() {
    let form = |class: &str, fields: &str, name: &str| {
        format!("<object gx:name=\"{name}\" gx:type=\"de.grogra.math.{class}\">{fields}</object>")
    };
    let chain =
        form("Sin", "", "first") + &data("factor", 2.0) + &data("shift", 0.5) + &form("Sqr", "", "second");
    let fields = form("Chain", &chain, "waveForm") + &data("frequency", 3.0) + &reference("input", 11);
    let place = "<object gx:name=\"transform\" gx:type=\"de.grogra.math.TVector3d\" gx:value=\"1 2 3\"/>";
    let maps = map(10, "Wood", &fields)
        + &map(11, "Turbulence", &(data("octaves", 20) + &reference("input", 12)))
        + &map(12, "XYZTransformation", &(place.to_owned() + &data("useGlobal", true)));
    let project = read("volume", &maps);
    let Channel::Volume { function, wave, coordinates } = diffuse(&project) else { panic!("not a volume") };
    assert_eq!(*function, VolumeFunction::Wood);
    let linear = |factor, shift| WaveStep::Linear { factor, shift };
    let function = WaveStep::Function;
    let expected = [linear(3.0, 0.0), function(WaveForm::Sin), linear(2.0, 0.5), function(WaveForm::Sqr)];
    assert_eq!(wave[..], expected);
    let matrix = DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0));
    let amount = DVec3::splat(0.2);
    let turbulence =
        CoordinateMap::Turbulence { amount, octaves: 10, frequency_ratio: 2.0, noise_ratio: 2.0 };
    assert_eq!(coordinates[..], [CoordinateMap::AffineXyz { matrix, global: true }, turbulence]);
    assert_eq!(project.report.warnings.len(), 1, "{}", project.report);
}

#[test]
fn blends_filters_and_their_inputs() {
    let item = |value: f64, next: &str| {
        let color = "<object gx:name=\"input\" gx:type=\"de.grogra.math.Graytone\" value=\"0.25\"/>";
        data("value", value) + color + next
    };
    let maps = map(10, "Smooth3D", &(data("sx", 0.5) + &reference("input", 11)))
        + &map(11, "ChannelBlend", &(reference("blend", 12) + &reference("input", 14)))
        + &map(12, "BlendItem", &item(-1.0, &reference("next", 13)))
        + &map(13, "BlendItem", &item(1.0, &reference("next", 12)))
        + &map(14, "Granite", "");
    let project = read("blend", &maps);
    let Channel::Filter { weights, step, input } = diffuse(&project) else { panic!("not a filter") };
    assert_eq!((*weights, *step), (NeighbourFilter::Smooth, DVec3::new(0.5, 1.0, 1.0)));
    let Channel::Blend { items, coordinates } = &project.scene.channels[input.index()] else {
        panic!("no blend")
    };
    assert_eq!(items.iter().map(|item| item.position).collect::<Vec<_>>(), [-1.0, 1.0]);
    let [CoordinateMap::Value(granite)] = coordinates[..] else { panic!("{coordinates:?}") };
    assert!(matches!(project.scene.channels[granite.index()], Channel::Volume { .. }));
    assert!(project.report.to_string().contains("contains itself"), "{}", project.report);
}

#[test]
fn normal_maps_stand_in_the_input_of_the_shader() {
    let sphere = format!(
        "<node id=\"1\" type=\"de.grogra.imp3d.objects.Sphere\" edges=\"+\">\
         <object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.Phong\">{}</object></node>",
        reference("input", 10)
    );
    let maps =
        map(10, "BumpMap", &(data("strength", 3) + &reference("displacement", 12) + &reference("input", 11)))
            + &map(11, "WaveMap", &(data("uCount", 4) + &data("boxTop", true)))
            + &map(12, "Checker", "");
    let text = graph(&format!("{sphere}{maps}"));
    let project = groimp::read(&file("normals", "graph.xml", text.as_bytes())).unwrap();
    let Material::Phong(phong) = &project.scene.materials[project.scene.objects[0].material.index()] else {
        panic!("not a Phong")
    };
    // The input comes first.
    let [wave, bump] = phong.normal_maps[..] else { panic!("{phong:?}") };
    assert!(wave.box_top && wave.scale == 1.0 && !bump.box_top);
    assert_eq!((bump.scale, bump.step), (0.06, DVec2::splat(0.05)));
    let Channel::Waves { count, .. } = &project.scene.channels[wave.displacement.index()] else { panic!() };
    assert_eq!(*count, DVec2::new(16.0, 30.0));
}

#[test]
fn what_cannot_be_evaluated_is_grey_and_reported() {
    let spline = "<object gx:name=\"waveForm\" gx:type=\"de.grogra.math.SplineFunction\"/>";
    let project = read("spline", &map(10, "Gradient", spline));
    assert_eq!(*diffuse(&project), Channel::Constant([0.5; 3]));
    assert!(project.report.to_string().contains("spline"), "{}", project.report);
    // A filter of a filter of a filter: 27³ evaluations.
    let filters: String = (10..13).map(|id| map(id, "Smooth3D", &reference("input", id + 1))).collect();
    let project = read("filters", &(filters + &map(13, "Granite", "")));
    assert_eq!(*diffuse(&project), Channel::Constant([0.5; 3]));
    assert!(project.report.to_string().contains("too many blends and filters"), "{}", project.report);
    assert!(project.scene.channels.iter().any(|channel| matches!(channel, Channel::Filter { .. })));
}
