//! Chains of nodes with known results.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{chain, data, file, graph};
use glam::DVec3;
use groimp::Project;
use scene::{DAffine3, Material, Shape};

const F: &str = "de.grogra.turtle.F";
const RU: &str = "de.grogra.turtle.RU";
const RL: &str = "de.grogra.turtle.RL";
const SPHERE: &str = "de.grogra.imp3d.objects.Sphere";
const PARALLELOGRAM: &str = "de.grogra.imp3d.objects.Parallelogram";

fn read(test: &str, nodes: &[(&str, &str)]) -> Project {
    let project = groimp::read(&file(test, "graph.xml", graph(&chain(nodes)).as_bytes())).unwrap();
    for warning in &project.report.warnings {
        assert!(warning.message.contains("no light"), "{warning}");
    }
    project
}

/// Frame of the last object, a sphere as a marker.
fn marker(test: &str, nodes: &[(&str, &str)]) -> DAffine3 {
    let mut nodes = nodes.to_vec();
    nodes.push((SPHERE, ""));
    read(test, &nodes).scene.objects.last().unwrap().world_from_object
}

fn near(found: DVec3, expected: [f64; 3]) {
    assert!((found - DVec3::from_array(expected)).length() < 1e-6, "{found} is not {expected:?}");
}

#[test]
fn rotations_turn_the_head() {
    let a90 = data("angle", 90.0);
    let tip = |test, nodes: &[(&str, &str)]| marker(test, nodes).translation;
    near(tip("ru", &[(F, ""), (RU, &a90), (F, "")]), [1.0, 0.0, 1.0]);
    near(tip("rl", &[(F, ""), (RL, &a90), (F, "")]), [0.0, -1.0, 1.0]);
    near(tip("rurl", &[(F, ""), (RU, &a90), (RL, &a90), (F, "")]), [0.0, -1.0, 1.0]);
    near(tip("rg", &[(RL, &a90), ("de.grogra.turtle.RG", ""), (F, "")]), [0.0, 0.0, -1.0]);
}

#[test]
fn rotate_applies_x_then_y_then_z() {
    let fields = data("rotateX", 90.0) + &data("rotateY", 90.0);
    let frame = marker("rotate", &[("de.grogra.turtle.Rotate", &fields)]);
    near(frame.matrix3.z_axis, [1.0, 0.0, 0.0]);
    near(frame.matrix3.x_axis, [0.0, 1.0, 0.0]);
}

#[test]
fn adjust_lu_makes_the_left_axis_horizontal() {
    let turns =
        [(RL, data("angle", 50.0)), (RU, data("angle", 30.0)), ("de.grogra.turtle.RH", data("angle", 70.0))];
    let mut nodes: Vec<_> = turns.iter().map(|(t, f)| (*t, f.as_str())).collect();
    nodes.push(("de.grogra.turtle.AdjustLU", ""));
    let frame = marker("adjust", &nodes);
    assert!(frame.matrix3.x_axis.z.abs() < 1e-12, "{frame}");
    assert!(frame.matrix3.y_axis.z > 0.0, "{frame}");
}

#[test]
fn a_bare_shoot_has_the_class_defaults() {
    let scene = read("bare_f", &[(F, "")]).scene;
    let [shoot] = &scene.objects[..] else { panic!("{:?}", scene.objects) };
    assert!(matches!(shoot.shape, Shape::Cylinder { radius: 0.05, length: 1.0, .. }), "{:?}", shoot.shape);
    let color = [1.0, 1.0, f64::from(0x55) / 255.0];
    assert_eq!(scene.materials[shoot.material.index()], Material::Rgba { color, opacity: 1.0 });
}

#[test]
fn the_shader_of_a_shoot_goes_on_below_it() {
    let red =
        "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.RGBAShader\" gx:value=\"true 26\"/>";
    let scene =
        read("inherit", &[(SPHERE, ""), (F, ""), (SPHERE, ""), (SPHERE, red), (PARALLELOGRAM, "")]).scene;
    let colors: Vec<_> = scene
        .objects
        .iter()
        .map(|object| match scene.materials[object.material.index()] {
            Material::Rgba { color, .. } => color.map(|c| (c * 255.0).round() as u8),
            Material::Phong(_) => panic!("no Phong here"),
        })
        .collect();
    let yellow = [255, 255, 85];
    assert_eq!(colors, [[128; 3], yellow, yellow, [255, 0, 0], [255, 0, 0]]);
}

#[test]
fn diameter_commands_reach_the_next_shoot() {
    let scene = read("diameter", &[("de.grogra.turtle.D", &data("argument", 3.0)), (F, "")]).scene;
    assert!(matches!(scene.objects[0].shape, Shape::Cylinder { radius: 1.5, .. }));
}

#[test]
fn axis_shapes_move_their_children_and_spheres_do_not() {
    let size = data("length", 3.0) + &data("width", 1.0) + &data("height", 2.0);
    let scene = read("box", &[("de.grogra.imp3d.objects.Box", &size), (SPHERE, ""), (SPHERE, "")]).scene;
    assert_eq!(scene.objects[0].bounds(&[]), Some((DVec3::new(-0.5, -1.0, 0.0), DVec3::new(0.5, 1.0, 3.0))));
    near(scene.objects[1].world_from_object.translation, [0.0, 0.0, 3.0]);
    near(scene.objects[2].world_from_object.translation, [0.0, 0.0, 3.0]);
}

#[test]
fn a_leaf_lies_flat_after_rl() {
    let axis = "<object gx:name=\"axis\" gx:value=\"0.5 0.0 0.0\"/>";
    let leaf = data("length", 2.0) + axis;
    let scene = read("leaf", &[(RL, &data("angle", -90.0)), (PARALLELOGRAM, &leaf)]).scene;
    let (low, high) = scene.objects[0].bounds(&[]).unwrap();
    near(low, [-0.5, 0.0, 0.0]);
    near(high, [0.5, 2.0, 0.0]);
    let bare = read("bare_leaf", &[(PARALLELOGRAM, "")]).scene;
    assert_eq!(bare.objects[0].shape, Shape::Parallelogram { length: 1.0, axis: DVec3::X, scale_v: false });
}

#[test]
fn a_scaled_leaf_scales_what_follows() {
    let fields = "<object gx:name=\"axis\" gx:value=\"0.5 0.0 0.0\"/><object gx:name=\"transform\" \
                  gx:type=\"de.grogra.math.UniformScale\" scale=\"0.1\"/>";
    let scene = read("scaled", &[(PARALLELOGRAM, fields), (F, "")]).scene;
    let (low, high) = scene.objects[0].bounds(&[]).unwrap();
    near(low, [-0.05, 0.0, 0.0]);
    near(high, [0.05, 0.0, 0.1]);
    let (low, high) = scene.objects[1].bounds(&[]).unwrap();
    assert!((low.z - 0.1).abs() < 1e-12 && (high.z - 0.2).abs() < 1e-12, "{low} {high}");
}

#[test]
fn a_light_stands_where_the_turtle_is() {
    let project = read(
        "light",
        &[("de.grogra.turtle.M", &data("length", 0.05)), ("de.grogra.imp3d.objects.LightNode", "")],
    );
    let [light] = &project.scene.lights[..] else { panic!("{:?}", project.scene.lights) };
    near(light.world_from_light.translation, [0.0, 0.0, 0.05]);
    assert_eq!(light.kind, scene::LightKind::Point { power: [100.0 / 3.0; 3] });
    assert!(project.report.is_empty(), "{}", project.report);
}

#[test]
fn area_lights_shine_in_the_colour_of_their_shader() {
    let fields = "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.RGBAShader\" gx:value=\"false 0.6 \
                  0.3 0.1 1.0\"/><object gx:name=\"light\" gx:type=\"de.grogra.imp3d.objects.AreaLight\"><data \
                  gx:name=\"power\" gx:value=\"50\"/></object>";
    let project = read("area", &[(PARALLELOGRAM, fields)]);
    let emission = project.scene.objects[0].emission.unwrap();
    near(DVec3::from_array(emission.power), [30.0, 15.0, 5.0]);
    assert_eq!((emission.exponent, emission.shadowless), (4.0, false));
    assert!(project.scene.lights.is_empty());
}

#[test]
fn a_plain_sky_has_a_radiance() {
    let fields =
        "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.RGBAShader\" gx:value=\"true 28\"/>";
    let project = read("sky", &[("de.grogra.imp3d.objects.Sky", fields)]);
    let scene::SkyRadiance::Uniform(radiance) = project.scene.sky.unwrap().radiance else { panic!() };
    near(DVec3::from_array(radiance), [50.0 / (12.0 * std::f64::consts::PI); 3]);
}

#[test]
fn flat_and_empty_shapes_are_counted() {
    let flat = data("scaleX", 0.0);
    let zero = data("radius", 0.0);
    let nan = data("radius", "NaN");
    let project =
        read("flat", &[(SPHERE, &zero), (SPHERE, &nan), ("de.grogra.turtle.Scale", &flat), (SPHERE, "")]);
    assert!(project.scene.objects.is_empty());
    let skipped: Vec<_> = project.report.skipped.iter().map(|s| (s.count, s.reason.as_str())).collect();
    assert_eq!(skipped, [(2, "it has no extent"), (1, "its transformation is flat or not a number")]);
}
