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
            _ => panic!("no Phong here"),
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

/// Where a chain of turtle commands ends, and what was reported.
fn end(test: &str, nodes: &[(&str, String)]) -> (DAffine3, String) {
    let full: Vec<_> = nodes
        .iter()
        .map(|(name, fields)| (format!("de.grogra.turtle.{name}"), fields.clone()))
        .chain([(SPHERE.to_owned(), String::new())])
        .collect();
    let nodes: Vec<_> = full.iter().map(|(name, fields)| (name.as_str(), fields.as_str())).collect();
    let project = groimp::read(&file(test, "graph.xml", graph(&chain(&nodes)).as_bytes())).unwrap();
    (project.scene.objects.last().unwrap().world_from_object, project.report.to_string())
}

#[test]
fn the_aliases_turn_towards_what_they_are_called() {
    let a90 = |angle: f64| data("angle", angle);
    for (name, angle, head) in [
        ("Plus", 90.0, [1.0, 0.0, 0.0]),
        ("Minus", -90.0, [-1.0, 0.0, 0.0]),
        ("Left", 90.0, [1.0, 0.0, 0.0]),
        // Stored with their final signs.
        ("Right", -90.0, [-1.0, 0.0, 0.0]),
        ("Up", -90.0, [0.0, 1.0, 0.0]),
        ("Down", 90.0, [0.0, -1.0, 0.0]),
    ] {
        let (frame, report) = end(&format!("alias_{name}"), &[(name, a90(angle))]);
        near(frame.matrix3.z_axis, head);
        assert_eq!(report.contains("not certain"), !matches!(name, "Plus" | "Minus"), "{report}");
    }
}

#[test]
fn lengths_come_from_fields_and_from_the_state() {
    let argument = |value: f64| data("argument", value);
    for (test, nodes, z) in [
        ("f_after_l", vec![("L", argument(3.0)), ("F", String::new())], 1.0),
        ("f0", vec![("L", argument(3.0)), ("F0", String::new())], 3.0),
        ("fadd", vec![("L", argument(3.0)), ("FAdd", argument(0.5))], 3.5),
        ("fmul", vec![("L", argument(3.0)), ("FMul", argument(0.5))], 1.5),
        ("fmul_none", vec![("L", argument(3.0)), ("FMul", String::new())], 3.0),
        ("m0", vec![("L", argument(3.0)), ("M0", String::new())], 3.0),
        ("madd", vec![("L", argument(3.0)), ("MAdd", argument(-1.0))], 2.0),
        ("mmul", vec![("L", argument(3.0)), ("MMul", argument(2.0))], 6.0),
        ("m_negative", vec![("M", data("length", -10.0))], -10.0),
        // Back to a quarter of the last shoot.
        ("mrel", vec![("F", data("length", 8.0)), ("MRel", data("x", 0.25))], 2.0),
        ("after_f", vec![("F", data("length", 8.0)), ("F0", String::new())], 16.0),
        ("lmul", vec![("L", argument(3.0)), ("LMul", argument(2.0)), ("F0", String::new())], 6.0),
        ("llocal", vec![("L", argument(3.0)), ("LlAdd", argument(2.0)), ("F0", String::new())], 5.0),
        ("l0", vec![("L", argument(3.0)), ("L0", String::new()), ("F0", String::new())], 100.0),
    ] {
        near(end(test, &nodes).0.translation, [0.0, 0.0, z]);
    }
}

#[test]
fn tropisms_use_and_reset_the_state() {
    let argument = |value: f64| data("argument", value);
    let lying = || ("RL", data("angle", -90.0));
    let head = |test: &str, nodes: Vec<(&str, String)>| end(test, &nodes).0.matrix3.z_axis;
    // RL(-90) turns the head to +y; gravity bends it to y - g z.
    let bent = |g: f64| DVec3::new(0.0, 1.0, -g).normalize().to_array();
    near(head("rv", vec![lying(), ("RV", argument(-0.5))]), bent(-0.5));
    near(head("rv0", vec![("V", argument(0.3)), lying(), ("RV0", String::new())]), bent(0.3));
    near(head("rvadd", vec![("V", argument(0.3)), lying(), ("RVAdd", argument(0.2))]), bent(0.5));
    near(head("rvmul", vec![("V", argument(0.3)), lying(), ("RVMul", argument(2.0))]), bent(0.6));
    // The local value holds once.
    let nodes = vec![("Vl", argument(9.0)), ("RVMul", argument(0.0)), lying(), ("RV0", String::new())];
    near(head("rv0_twice", nodes), [0.0, 1.0, 0.0]);
    let direction = "<object gx:name=\"direction\" gx:value=\"0 0 2\"/>".to_owned() + &data("strength", 0.25);
    near(head("rd", vec![lying(), ("RD", direction.clone())]), [0.0, 0.5f64.cos(), 0.5f64.sin()]);
    // y . (0, 0, 2) is 0: orthogonal already.
    near(head("ro", vec![lying(), ("RO", direction)]), [0.0, 1.0, 0.0]);
    let target = "<object gx:name=\"target\" gx:value=\"0 0 5\"/>".to_owned() + &data("strength", 1.0);
    near(head("rp", vec![lying(), ("RP", target)]), [0.0, 1f64.cos(), 1f64.sin()]);
}

#[test]
fn rn_turns_to_nodes_that_are_placed() {
    let node = |id: i64, name: &str, fields: &str| {
        format!("<node id=\"{id}\" type=\"{name}\" edges=\"+\">{fields}</node>\n")
    };
    let rn = |id: i64, target: i64| {
        let fields = format!("<ref gx:name=\"target\" gx:value=\"{target}\"/>") + &data("strength", 0.5);
        node(id, "de.grogra.turtle.RN", &(fields + &node(id + 1, SPHERE, "")))
    };
    let mark = "<object gx:name=\"transform\" gx:type=\"de.grogra.math.TVector3d\" gx:value=\"7 0 0\"/>";
    let nodes = node(1, "de.grogra.imp3d.objects.Null", mark)
        + &rn(10, 1)
        + &rn(20, 30)
        + &rn(40, 99)
        + &node(30, SPHERE, mark);
    let project = groimp::read(&file("rn", "graph.xml", graph(&nodes).as_bytes())).unwrap();
    let head = |i: usize| project.scene.objects[i].world_from_object.matrix3.z_axis;
    near(head(0), [0.5f64.sin(), 0.0, 0.5f64.cos()]);
    near(head(1), [0.0, 0.0, 1.0]);
    near(head(2), [0.0, 0.0, 1.0]);
    let report = project.report.to_string();
    assert!(report.contains("is placed later") && report.contains("is not in the file"), "{report}");
}

#[test]
fn transformations_whose_fields_speak_for_themselves() {
    let read = |test: &str, members: &str| {
        let transform = format!(
            "<object gx:name=\"transform\" gx:type=\"de.grogra.math.ComponentTransform\" {members}/>"
        );
        let nodes = [("de.grogra.imp3d.objects.Null", transform.as_str()), (SPHERE, "")];
        let project = groimp::read(&file(test, "graph.xml", graph(&chain(&nodes)).as_bytes())).unwrap();
        (project.scene.objects[0].world_from_object, project.report.to_string())
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    let members = format!("translation=\"(1 2 3)\" rotation=\"(0 {quarter} 0)\" scale=\"(1 2 4)\"");
    let (frame, _) = read("components", &members);
    near(frame.translation, [1.0, 2.0, 3.0]);
    near(frame.matrix3.x_axis, [0.0, 0.0, -1.0]);
    near(frame.matrix3.y_axis, [0.0, 2.0, 0.0]);
    near(frame.matrix3.z_axis, [4.0, 0.0, 0.0]);
    let (frame, _) = read("axis_angle", &format!("axis=\"(0 0 2)\" angle=\"{quarter}\" scale=\"3\""));
    near(frame.matrix3.x_axis, [0.0, 3.0, 0.0]);
    let (frame, report) = read("unknown_component", "translation=\"(1 2 3)\" wobble=\"5\"");
    assert_eq!(frame, DAffine3::IDENTITY);
    assert!(
        report.contains("its transform of class 'de.grogra.math.ComponentTransform' is not known"),
        "{report}"
    );
}

/// Placements that mirror are kept as they are, the normals are the renderer's business; flat ones are counted.
#[test]
fn mirrored_placements_stay_and_flat_ones_are_counted() {
    let mirrored = data("scaleX", -2.0);
    let scene = read("mirrored", &[("de.grogra.turtle.Scale", &mirrored), (SPHERE, "")]).scene;
    assert_eq!(scene.objects[0].world_from_object.matrix3.determinant(), -2.0);
    let flat = data("scaleY", 0.0);
    let surface = "de.grogra.imp3d.objects.Supershape";
    let project = read("flat_surface", &[("de.grogra.turtle.Scale", &flat), (surface, "")]);
    assert_eq!(project.report.skipped[0].reason, "its transformation is flat or not a number");
}
