//! Files that are not what they seem: errors that name the place, or warnings; never a panic.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{chain, data, directory, file, graph};
use groimp::{Limits, Project, ReadError};
use std::io::{Cursor, Write};
use std::path::Path;

const RU: &str = "de.grogra.turtle.RU";
const SPHERE: &str = "de.grogra.imp3d.objects.Sphere";
const PROJECT: &str =
    "<project xmlns=\"http://grogra.de/registry\" graph=\"graph.xml\"><registry/></project>";

fn read_graph(test: &str, text: &str) -> Result<Project, ReadError> {
    groimp::read(&file(test, "graph.xml", text.as_bytes()))
}

fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        writer.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// Compressible only in part, so that cutting it hurts.
fn noise(len: usize) -> Vec<u8> {
    let mut state = 1u64;
    (0..len)
        .map(|_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 56) as u8
        })
        .collect()
}

#[test]
fn a_missing_file() {
    let error = groimp::read(Path::new("no/such/file.gsz")).unwrap_err();
    assert!(
        matches!(error, ReadError::Io { .. }) && error.to_string().contains("no/such/file.gsz"),
        "{error}"
    );
}

#[test]
fn random_bytes() {
    let error = groimp::read(&file("random", "x.gsz", &noise(5000))).unwrap_err();
    assert!(matches!(error, ReadError::NotAnArchive { .. }), "{error}");
    assert!(error.to_string().contains("expected a .gsz archive"), "{error}");
    assert!(groimp::read(&file("random_xml", "graph.xml", &noise(5000))).is_err());
    assert!(groimp::read(&file("empty", "x.gsz", b"")).is_err());
    assert!(groimp::read(&file("empty_xml", "graph.xml", b"")).is_err());
}

#[test]
fn a_zip_cut_off_anywhere() {
    let text = graph(&chain(&[(SPHERE, "")]));
    let whole =
        zipped(&[("project.gs", PROJECT.as_bytes()), ("graph.xml", text.as_bytes()), ("n", &noise(3000))]);
    let path = file("whole", "x.gsz", &whole);
    assert_eq!(groimp::read(&path).unwrap().scene.objects.len(), 1);
    for len in (0..whole.len()).step_by(97) {
        assert!(groimp::read(&file("cut_zip", "x.gsz", &whole[..len])).is_err(), "{len} bytes");
    }
}

#[test]
fn damaged_zips_never_panic() {
    let text = graph(&chain(&[(SPHERE, "")]));
    let whole = zipped(&[("project.gs", PROJECT.as_bytes()), ("graph.xml", text.as_bytes())]);
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x55;
        let _ = groimp::read(&file("damaged_zip", "x.gsz", &bytes));
    }
}

#[test]
fn a_zip_without_project() {
    let error = groimp::read(&file("no_project", "x.gsz", &zipped(&[("a", b"b")]))).unwrap_err();
    assert!(error.to_string().contains("holds no 'project.gs'"), "{error}");
    let without_graph = zipped(&[("project.gs", PROJECT.as_bytes())]);
    let error = groimp::read(&file("no_graph", "x.gsz", &without_graph)).unwrap_err();
    assert!(error.to_string().contains("holds no 'graph.xml'"), "{error}");
}

#[test]
fn a_zip_bomb() {
    let zeros = vec![b' '; 1 << 20];
    let bomb = zipped(&[("project.gs", PROJECT.as_bytes()), ("graph.xml", &zeros)]);
    assert!(bomb.len() < 10_000);
    let path = file("bomb", "x.gsz", &bomb);
    let small = Limits { entry_bytes: 100_000, ..Limits::default() };
    let error = groimp::read_within(&path, small).unwrap_err();
    assert!(
        matches!(&error, ReadError::TooLarge { entry, limit: 100_000, .. } if entry == "graph.xml"),
        "{error}"
    );
    let total = Limits { total_bytes: 100_000, ..Limits::default() };
    let error = groimp::read_within(&path, total).unwrap_err();
    assert!(
        matches!(error, ReadError::TooLarge { which: "all files together", limit: 100_000, .. }),
        "{error}"
    );
}

#[test]
fn xml_cut_off_anywhere() {
    let text = graph(&chain(&[(RU, &data("angle", 5.0)), (SPHERE, "")]));
    let end = text.rfind("</graph>").unwrap();
    for len in 0..end {
        assert!(read_graph("cut_xml", &text[..len]).is_err(), "{len} bytes");
    }
    let error = read_graph("cut_xml", &text[..end]).unwrap_err();
    assert!(error.to_string().contains("graph.xml:8: broken XML: the file ends"), "{error}");
}

#[test]
fn mismatched_tags_name_the_line() {
    let error = read_graph("mismatch", "<graph>\n<node id=\"1\">\n</nod>\n</graph>").unwrap_err();
    assert!(error.to_string().starts_with("graph.xml:3: broken XML"), "{error}");
}

#[test]
fn a_wrong_number_names_file_line_and_field() {
    let text = graph(&chain(&[(RU, ""), (SPHERE, &data("radius", "1,5"))]));
    let error = read_graph("wrong_number", &text).unwrap_err();
    assert_eq!(
        error.to_string(),
        "graph.xml:5: field 'radius' of de.grogra.imp3d.objects.Sphere is '1,5', expected a number"
    );
    let error = read_graph("wrong_id", &graph("<node id=\"x\" type=\"t\"/>")).unwrap_err();
    assert!(error.to_string().starts_with("graph.xml:4: found node id 'x'"), "{error}");
}

#[test]
fn an_unknown_type_keeps_what_is_below() {
    let project = read_graph("unknown", &graph(&chain(&[("foreign.Thing", ""), (SPHERE, "")]))).unwrap();
    assert_eq!(project.scene.objects.len(), 1);
    let warning = &project.report.warnings[0];
    assert!(
        warning.to_string().starts_with("graph.xml:4: the type 'foreign.Thing' is not known"),
        "{warning}"
    );
}

#[test]
fn cycles_and_second_paths_are_cut() {
    let cycle = format!("<node id=\"1\" type=\"{SPHERE}\" edges=\"-\"><node ref=\"1\" edges=\"-\"/></node>");
    let project = read_graph("cycle", &graph(&cycle)).unwrap();
    assert_eq!(project.scene.objects.len(), 1);
    assert!(project.report.warnings[0].message.contains("its own descendant"), "{}", project.report);
    let twice = format!("<node ref=\"1\" edges=\"+\"/><node id=\"1\" type=\"{SPHERE}\" edges=\"-\"/>");
    let project = read_graph("twice", &graph(&twice)).unwrap();
    assert_eq!(project.scene.objects.len(), 1);
    assert!(project.report.warnings[0].message.contains("two paths"), "{}", project.report);
}

#[test]
fn shaders_that_refer_to_themselves_are_grey() {
    let text = graph(&format!(
        "<node id=\"1\" type=\"{SPHERE}\" edges=\"-\"><ref gx:name=\"shader\" gx:value=\"2\"/></node>\n<node \
         id=\"2\" type=\"de.grogra.graph.impl.SharedObjectNode\"><ref gx:name=\"object\" gx:value=\"2\"/></node>"
    ));
    let project = read_graph("shader_cycle", &text).unwrap();
    assert!(project.report.warnings[0].message.contains("refers to itself"), "{}", project.report);
}

#[test]
fn missing_and_broken_images_are_grey() {
    let registry = r#"<project graph="graph.xml"><registry><ref name="project"><ref name="objects"><ref name="images">
 <de.grogra.pf.ui.registry.FileObjectItem name="gone" systemId="pfs:images/gone.png"/>
 <de.grogra.pf.ui.registry.FileObjectItem name="outside" systemId="pfs:../outside.png"/>
 <de.grogra.pf.ui.registry.FileObjectItem name="broken" systemId="pfs:broken.png"/>
</ref></ref></ref></registry></project>"#;
    let sphere = |id: i32, image: &str| {
        format!(
            "<node id=\"{id}\" type=\"{SPHERE}\" edges=\"+\"><ref gx:name=\"shader\" gx:value=\"{0}\"/><node \
             id=\"{0}\" type=\"de.grogra.imp3d.shading.Phong\"><ref gx:name=\"diffuse\" gx:value=\"{1}\"/></node>\
             <node id=\"{1}\" type=\"de.grogra.imp3d.shading.ImageMap\"><shared gx:name=\"image\" \
             gx:value=\"/:&quot;/project/objects/images/{image}&quot;\"/></node></node>\n",
            id + 100,
            id + 200
        )
    };
    let names = ["gone", "outside", "broken", "unregistered"];
    let spheres: String = names.iter().zip(1..).map(|(name, id)| sphere(id, name)).collect();
    let root = directory(
        "images",
        &[
            ("project.gs", registry.as_bytes()),
            ("graph.xml", graph(&spheres).as_bytes()),
            ("broken.png", b"\x89PNG"),
        ],
    );
    for path in [root.clone(), root.join("project.gs")] {
        let project = groimp::read(&path).unwrap();
        assert_eq!(project.scene.objects.len(), 4);
        assert_eq!(project.scene.channels, [scene::Channel::Constant([0.5; 3])]);
        let about_images =
            project.report.warnings.iter().filter(|w| w.message.contains("grey is used")).count();
        assert_eq!(about_images, 4, "{}", project.report);
    }
}

#[test]
fn images_beyond_the_pixel_limit_are_grey() {
    let registry = r#"<project graph="graph.xml"><registry><ref name="project"><ref name="objects"><ref name="images">
 <de.grogra.pf.ui.registry.FileObjectItem name="i" systemId="pfs:i.bmp"/></ref></ref></ref></registry></project>"#;
    let text = graph(&chain(&[(
        SPHERE,
        "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.Phong\"><object gx:name=\"diffuse\" \
         gx:type=\"de.grogra.imp3d.shading.ImageMap\"><shared gx:name=\"image\" \
         gx:value=\"/:&quot;/project/objects/images/i&quot;\"/></object></object>",
    )]));
    let mut bmp = Cursor::new(Vec::new());
    image::RgbImage::from_pixel(20, 10, image::Rgb([255, 0, 51]))
        .write_to(&mut bmp, image::ImageFormat::Bmp)
        .unwrap();
    let files: &[(&str, &[u8])] =
        &[("project.gs", registry.as_bytes()), ("graph.xml", text.as_bytes()), ("i.bmp", &bmp.into_inner())];
    let root = directory("pixels", files);
    let project = groimp::read(&root).unwrap();
    assert_eq!(project.scene.images[0].mean(), [1.0, 0.0, 0.2, 1.0]);
    let limits = Limits { image_pixels: 199, ..Limits::default() };
    let project = groimp::read_within(&root, limits).unwrap();
    assert!(project.scene.images.is_empty());
    assert!(project.report.to_string().contains("20 x 10 pixels"), "{}", project.report);
}

/// Changed bytes may be errors, warnings or another scene; only panics are wrong.
#[test]
fn damaged_graphs_never_panic() {
    let phong = "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.Phong\"><object gx:name=\"diffuse\" \
                 gx:type=\"de.grogra.math.RGBColor\" gx:value=\"true 3\"/></object>";
    let switch = "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.AlgorithmSwitchShader\" \
                  guiShader=\"[de.grogra.imp3d.shading.RGBAShader true 21]\" raytracerShader=\"null\"/>";
    let spot = "<object gx:name=\"light\" gx:type=\"de.grogra.imp3d.objects.SpotLight\"><object gx:name=\"color\" \
                gx:value=\"false 1.0 1.0 1.0\"/><data gx:name=\"innerAngle\" gx:value=\"0.1\"/></object>";
    let matrix = "<object gx:name=\"transform\" gx:type=\"de.grogra.math.TMatrix4d\" gx:value=\"1 0 0 0 0 1 0 0 0 0 1 \
                  0 0 0 0 1\"/>";
    let text = graph(&chain(&[
        (RU, &data("angle", "45.0")),
        ("de.grogra.turtle.RV", &data("argument", "-0.1")),
        ("de.grogra.turtle.P", &data("argument", "7")),
        ("de.grogra.turtle.F", &data("length", "5.0E-4")),
        ("de.grogra.imp3d.objects.Frustum", &(data("topRadius", "0.3") + phong)),
        ("de.grogra.imp3d.objects.Parallelogram", &(data("length", "-1.0") + switch + matrix)),
        ("de.grogra.imp3d.objects.LightNode", spot),
    ]));
    let random = noise(3 * 4000);
    for triple in random.chunks_exact(3) {
        let mut bytes = text.clone().into_bytes();
        let at = usize::from(u16::from_le_bytes([triple[0], triple[1]])) % bytes.len();
        // Printable bytes stay well-formed more often and so get further.
        bytes[at] = b' ' + triple[2] % 95;
        let _ = groimp::read(&file("damaged_graph", "graph.xml", &bytes));
    }
}

/// Nested nodes, nested field values and nested brackets, read and dropped on a stack of 128 KiB.
#[test]
fn depth_costs_no_stack() {
    const DEPTH: usize = 100_000;
    let mut text = String::new();
    for id in 1..=DEPTH {
        text += &format!("<node id=\"{id}\" type=\"{RU}\" edges=\"-\">");
    }
    text += &format!("<node id=\"{}\" type=\"{SPHERE}\" edges=\"-\">", DEPTH + 1);
    text += &"<object gx:name=\"f\">".repeat(DEPTH);
    text += &"</object>".repeat(DEPTH);
    text += &format!("<object gx:name=\"g\" h=\"{}{}\"/></node>", "[a ".repeat(DEPTH), "]".repeat(DEPTH));
    text += &"</node>".repeat(DEPTH);
    let path = file("deep", "graph.xml", graph(&text).as_bytes());
    let read = move || {
        let project = groimp::read(&path).unwrap();
        project.scene.objects.len()
    };
    let thread = std::thread::Builder::new().stack_size(128 * 1024).spawn(read).unwrap();
    assert_eq!(thread.join().unwrap(), 1);
}
