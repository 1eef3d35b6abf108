//! What the reader makes of every class of the reference: the table in docs/groimp-support.md is written by this test
//! from what reading a small project with that class reports. Set `SUNSHINE_BLESS=1` to accept a change.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{file, graph};
use groimp::Project;
use std::fmt::Write;

const OBJECTS: &str = "de.grogra.imp3d.objects.";
const SHADING: &str = "de.grogra.imp3d.shading.";
const TURTLE: &str = "de.grogra.turtle.";
const MATH: &str = "de.grogra.math.";

/// A row of the table: what is read, and the project that shows what becomes of it.
struct Case {
    class: String,
    content: String,
}

fn case(class: impl Into<String>, content: impl Into<String>) -> Case {
    Case { class: class.into(), content: content.into() }
}

fn node(package: &str, class: &str, content: &str) -> String {
    format!("<node id=\"1\" type=\"{package}{class}\" edges=\"+\">{content}</node>")
}

fn data(name: &str, value: &str) -> String {
    format!("<data gx:name=\"{name}\" gx:value=\"{value}\"/>")
}

fn object(name: &str, class: &str, content: &str) -> String {
    format!("<object gx:name=\"{name}\" gx:type=\"{class}\">{content}</object>")
}

fn floats(name: &str, values: &str) -> String {
    format!("<array gx:name=\"{name}\" gx:value=\"{values}\"/>")
}

/// A sphere that carries a value in one of its fields.
fn sphere(content: &str) -> String {
    node(OBJECTS, "Sphere", content)
}

fn shapes() -> Vec<Case> {
    let grid = object(
        "grid",
        &format!("{MATH}VertexGridImpl"),
        &(floats("data", "0 0 0 1 0 0 0 1 0 1 1 1") + &data("dimension", "3") + &data("uCount", "2")),
    );
    let vertices = object(
        "vertices",
        &format!("{MATH}VertexListImpl"),
        &(floats("data", "0 0 0 1 0 0 1 1 0 0 1 0") + &data("dimension", "3")),
    );
    let points = floats("data", "0 0 0 1 0 0 0 1 0 1 1 1");
    let bezier = object(
        "surface",
        &format!("{MATH}BezierSurface"),
        &(points.clone() + &data("dimension", "3") + &data("uCount", "2")),
    );
    let knots = floats("data", "0 0 0 1 0 0 0 1 0 1 1 1 0 0 1 1 0 0 1 1");
    let spline = object(
        "surface",
        &format!("{MATH}BSplineSurfaceImpl"),
        &(knots
            + &data("dimension", "3")
            + &data("uCount", "2")
            + &data("uDegree", "1")
            + &data("vDegree", "1")),
    );
    let swept = object("surface", &format!("{OBJECTS}SweptSurface"), "");
    let master = format!("<node id=\"2\" type=\"{OBJECTS}Sphere\" edges=\"edge.master\"/>");
    let mut cases: Vec<Case> = [
        "Null",
        "ShadedNull",
        "Sphere",
        "Box",
        "Cylinder",
        "Cone",
        "Frustum",
        "Plane",
        "Parallelogram",
        "SphereSegmentSolid",
        "Supershape",
        "Lamella",
    ]
    .map(|class| case(class, node(OBJECTS, class, "")))
    .into();
    cases.extend([
        case("MeshNode without polygons", node(OBJECTS, "MeshNode", "")),
        case("Patch of a VertexGridImpl", node(OBJECTS, "Patch", &grid)),
        case("Polygon", node(OBJECTS, "Polygon", &vertices)),
        case("NURBSSurface of a BezierSurface", node(OBJECTS, "NURBSSurface", &bezier)),
        case("NURBSSurface of a BSplineSurfaceImpl", node(OBJECTS, "NURBSSurface", &spline)),
        case("NURBSSurface of a SweptSurface", node(OBJECTS, "NURBSSurface", &swept)),
        case("Instance3D", node(OBJECTS, "Instance3D", &master)),
        case(
            "GridClonerNode",
            node(
                OBJECTS,
                "GridClonerNode",
                &format!("<node id=\"2\" type=\"{OBJECTS}Sphere\" edges=\"+\"/>"),
            ),
        ),
    ]);
    let invisible = [
        "NURBSCurve",
        "Point",
        "PointCloud",
        "Line",
        "TextLabel",
        "SensorNode",
        "SensorNodeGrid",
        "SensorAreaGrid",
    ];
    cases.extend(invisible.map(|class| case(class, node(OBJECTS, class, ""))));
    cases
}

/// Commands are followed by a sphere, so that their frame is used.
fn turtle() -> Vec<Case> {
    let command = |class: &str, fields: &str| {
        let child = format!("<node id=\"2\" type=\"{OBJECTS}Sphere\" edges=\"-\"/>");
        case(class, node(TURTLE, class, &(fields.to_owned() + &child)))
    };
    let mut cases: Vec<Case> =
        ["F", "F0", "FAdd", "FMul", "M", "M0", "MAdd", "MMul", "MRel"].map(|class| command(class, "")).into();
    let turns = [
        "RL",
        "RU",
        "RH",
        "Plus",
        "Minus",
        "Left",
        "Right",
        "Up",
        "Down",
        "Rotate",
        "Scale",
        "Translate",
        "AdjustLU",
    ];
    cases.extend(turns.map(|class| command(class, "")));
    cases.extend(["RV", "RV0", "RVAdd", "RVMul", "RG", "RD", "RP", "RO"].map(|class| command(class, "")));
    cases.push(command("RN", "<ref gx:name=\"target\" gx:value=\"2\"/>"));
    for letter in ["L", "D", "V", "N", "C", "H", "U", "P"] {
        for form in ["", "0", "Add", "Mul", "l", "lAdd", "lMul"] {
            // Colours are not added.
            if letter != "P" || form.is_empty() || form == "l" {
                cases.push(command(&format!("{letter}{form}"), ""));
            }
        }
    }
    cases.push(command("OR", ""));
    cases
}

fn transforms() -> Vec<Case> {
    let transform = |class: &str, attributes: &str| {
        let value = format!("<object gx:name=\"transform\" gx:type=\"{MATH}{class}\" {attributes}/>");
        case(class, sphere(&value))
    };
    vec![
        transform("TVector3d", "gx:value=\"1 2 3\""),
        transform("TMatrix4d", "gx:value=\"1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\""),
        transform("UniformScale", "scale=\"2\""),
        transform("ComponentTransform", "rotation=\"0 0 1\" translation=\"1 2 3\""),
    ]
}

fn shaders() -> Vec<Case> {
    let shader = |class: &str, attributes: &str| {
        let value = format!("<object gx:name=\"shader\" gx:type=\"{SHADING}{class}\" {attributes}/>");
        case(class, sphere(&value))
    };
    let rgba = format!("[{SHADING}RGBAShader true 21]");
    vec![
        shader("RGBAShader", "gx:value=\"true 21\""),
        shader("Phong", ""),
        shader("SideSwitchShader", &format!("frontShader=\"{rgba}\" backShader=\"null\"")),
        shader("AlgorithmSwitchShader", &format!("guiShader=\"{rgba}\"")),
        shader("ShaderRef", "name=\"missing\""),
        shader("SunSkyLight", ""),
        shader("IORShader", ""),
        case("IOR (interior)", sphere(&format!("<object gx:name=\"interior\" gx:type=\"{SHADING}IOR\"/>"))),
    ]
}

fn channel_maps() -> Vec<Case> {
    let map = |class: &str, content: &str| {
        let package = if matches!(class, "RGBColor" | "Graytone") { MATH } else { SHADING };
        let diffuse = object("diffuse", &format!("{package}{class}"), content);
        case(class, sphere(&object("shader", &format!("{SHADING}Phong"), &diffuse)))
    };
    let mut cases = vec![
        map("RGBColor", ""),
        map("Graytone", &data("value", "0.3")),
        map("RGBAShader", ""),
        map("ChannelSPD", ""),
        case("ImageMap without an image", map("ImageMap", "").content),
    ];
    let plain = [
        "Checker",
        "VolumeChecker",
        "Gradient",
        "Granite",
        "Wood",
        "Leopard",
        "Mandel",
        "Julia",
        "VolumeTurbulence",
        "Carpenter",
    ];
    cases.extend(plain.map(|class| map(class, "")));
    // Maps of coordinates are the input of another map, filters have one.
    for class in ["AffineUVTransformation", "XYZTransformation", "Turbulence"] {
        let input = object("input", &format!("{SHADING}{class}"), "");
        cases.push(case(format!("{class} (input of a Checker)"), map("Checker", &input).content));
    }
    let checker = object("input", &format!("{SHADING}Checker"), "");
    cases.extend(["Smooth3D", "Laplace3D"].map(|class| map(class, &checker)));
    let item = object("blend", &format!("{SHADING}BlendItem"), &(checker + &data("value", "0.5")));
    cases.push(map("ChannelBlend", &item));
    for class in ["BumpMap", "WaveMap"] {
        let input = object("input", &format!("{SHADING}{class}"), "");
        cases.push(case(
            format!("{class} (input of a Phong)"),
            sphere(&object("shader", &format!("{SHADING}Phong"), &input)),
        ));
    }
    cases
}

/// Forms of `VolumeFunction.waveForm`.
fn wave_forms() -> Vec<Case> {
    let forms = [
        "Abs",
        "Acos",
        "Asin",
        "Atan",
        "Ceil",
        "Floor",
        "Cos",
        "Sin",
        "Tan",
        "Cosh",
        "Sinh",
        "Tanh",
        "Exp",
        "Exp2",
        "Expm1",
        "Log",
        "Log10",
        "Sqr",
        "Sqrt",
        "Id",
        "Pi",
        "E",
        "Phi",
        "Ramp",
        "Triangle",
        "Cubic",
        "Scallop",
        "Sin01",
        "Chain",
        "SplineFunction",
        "CustomFunction",
    ];
    forms
        .map(|form| {
            let gradient = object(
                "diffuse",
                &format!("{SHADING}Gradient"),
                &object("waveForm", &format!("{MATH}{form}"), ""),
            );
            case(form, sphere(&object("shader", &format!("{SHADING}Phong"), &gradient)))
        })
        .into()
}

fn lights() -> Vec<Case> {
    let light = |package: &str, class: &str, content: &str| {
        case(class, node(OBJECTS, "LightNode", &object("light", &format!("{package}{class}"), content)))
    };
    let sky = |class: &str| {
        let shader = format!("<object gx:name=\"shader\" gx:type=\"{SHADING}{class}\"/>");
        case(format!("Sky with {class}"), node(OBJECTS, "Sky", &shader))
    };
    vec![
        light(OBJECTS, "PointLight", ""),
        light(OBJECTS, "SpotLight", ""),
        light(OBJECTS, "DirectionalLight", ""),
        light(OBJECTS, "AmbientLight", ""),
        light(OBJECTS, "PhysicalLight", ""),
        light(OBJECTS, "SpectralLight", ""),
        light(SHADING, "SunSkyLight", ""),
        case(
            "AreaLight",
            node(OBJECTS, "Parallelogram", &object("light", &format!("{OBJECTS}AreaLight"), "")),
        ),
        sky("RGBAShader"),
        sky("Phong"),
        sky("SunSkyLight"),
    ]
}

/// What became of a project, in a few words.
fn outcome(project: &Project) -> String {
    let scene = &project.scene;
    let mut parts = Vec::new();
    let mut counted = |count: usize, one: &str, many: &str| match count {
        0 => {}
        1 => parts.push(format!("1 {one}")),
        _ => parts.push(format!("{count} {many}")),
    };
    counted(scene.objects.len(), "object", "objects");
    counted(scene.instances.len(), "instance", "instances");
    let default_light = |name: &str| name == "default light";
    let lights =
        scene.lights.iter().filter(|light| !default_light(&scene.type_names[light.origin.type_name.index()]));
    let lamps = scene.objects.iter().filter(|object| object.emission.is_some()).count();
    counted(lights.count() + lamps, "light", "lights");
    counted(usize::from(scene.sky.is_some()), "sky", "skies");
    let mut text = if parts.is_empty() { "nothing drawn".to_owned() } else { parts.join(", ") };
    for skipped in &project.report.skipped {
        write!(text, "; **not drawn**: {}", skipped.reason).unwrap();
    }
    for warning in &project.report.warnings {
        if !warning.message.contains("GroIMP's default light") {
            write!(text, "; *reported*: {}", warning.message).unwrap();
        }
    }
    text
}

#[test]
fn the_table_of_supported_classes_is_what_reading_them_gives() {
    let mut text = String::from(
        "# What Sunshine makes of GroIMP's classes\n\n\
         This page is written by a test that reads one small project for every class of the file format (`cargo test -p \
         sunshine-groimp --test support`), so it says\nwhat the program does. A class with no remark is drawn or takes \
         effect as in GroIMP; what is left out or uncertain stands behind\nit in the words of the report that \
         `sunshine info` prints. What is drawn in another way on purpose is in `units.md`.\n",
    );
    let chapters = [
        ("Shapes and other objects", shapes()),
        ("Turtle commands (each followed by a sphere)", turtle()),
        ("Transformations", transforms()),
        ("Shaders and interiors (of a sphere)", shaders()),
        ("Channel maps (as the colour of a Phong shader of a sphere)", channel_maps()),
        ("Wave forms of volume functions", wave_forms()),
        ("Lights and skies", lights()),
    ];
    for (title, cases) in chapters {
        write!(text, "\n## {title}\n\n| class | what is read from a project with it |\n| --- | --- |\n")
            .unwrap();
        for Case { class, content } in cases {
            let path = file("support", "graph.xml", graph(&content).as_bytes());
            let outcome = match groimp::read(&path) {
                Ok(project) => outcome(&project),
                Err(error) => panic!("{class}: {error}"),
            };
            writeln!(text, "| {class} | {} |", outcome.replace('|', "\\|")).unwrap();
        }
    }
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/groimp-support.md");
    if std::env::var_os("SUNSHINE_BLESS").is_some() {
        std::fs::write(page, &text).unwrap();
    }
    let written = std::fs::read_to_string(page).unwrap_or_default();
    assert!(
        text == written,
        "docs/groimp-support.md is out of date; look at the change with SUNSHINE_BLESS=1 and git diff"
    );
}
