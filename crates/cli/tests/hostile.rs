//! Projects that somebody made to do harm: each ends with an error or a picture, and none reads anything outside.

// In tests a panic is the failure report; the exception for tests does not reach helper functions.
#![allow(clippy::unwrap_used)]

use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SPHERE: &str = "de.grogra.imp3d.objects.Sphere";

/// `project.gs` with an image, a source and another graph file.
fn registry(image: &str, source: &str, graph: &str) -> String {
    format!(
        "<project graph=\"{graph}\"><registry><ref name=\"project\"><ref name=\"objects\"><ref name=\"images\">\
         <de.grogra.pf.ui.registry.FileObjectItem name=\"i\" systemId=\"pfs:{image}\"/></ref>\
         <ref name=\"files\"><de.grogra.pf.ui.registry.SourceFile name=\"s\" systemId=\"pfs:{source}\"/></ref>\
         </ref></ref></registry></project>"
    )
}

fn graph(children: &str) -> String {
    format!(
        "<graph xmlns:gx=\"http://grogra.de/xmlpersistence\" xmlns=\"http://grogra.de/xmlpersistence\">\
         <node root=\"MainGraph\" id=\"0\" type=\"de.grogra.graph.impl.Node\">{children}</node></graph>"
    )
}

fn node(id: &str, type_name: &str, inside: &str) -> String {
    format!("<node id=\"{id}\" type=\"{type_name}\" edges=\"-\">{inside}</node>")
}

fn field(name: &str, value: &str) -> String {
    format!("<data gx:name=\"{name}\" gx:value=\"{value}\"/>")
}

/// A sphere whose colour is the image of the registry.
fn textured() -> String {
    let shader = "<object gx:name=\"shader\" gx:type=\"de.grogra.imp3d.shading.Phong\"><object gx:name=\"diffuse\" \
                  gx:type=\"de.grogra.imp3d.shading.ImageMap\"><shared gx:name=\"image\" \
                  gx:value=\"/:&quot;/project/objects/images/i&quot;\"/></object></object>";
    graph(&(node("1", SPHERE, shader) + &node("2", "secret$Secret", "")))
}

/// Red, as no other image here.
fn secret_image() -> Vec<u8> {
    let mut png = Cursor::new(Vec::new());
    let red = image::RgbImage::from_pixel(2, 2, image::Rgb([255, 0, 0]));
    red.write_to(&mut png, image::ImageFormat::Png).unwrap();
    png.into_inner()
}

const SECRET_SOURCE: &str = "module Secret extends Sphere(7);";

fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        writer.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn write(path: &Path, bytes: impl AsRef<[u8]>) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

/// Nothing of what lies outside is in the scene, and what was asked for is named.
fn assert_contained(project: &Path, name: &str) {
    let project = groimp::read(project).unwrap();
    assert!(project.scene.images.is_empty(), "{name}: an image from outside was read");
    assert_eq!(project.scene.drawn_objects(), 1, "{name}: a source from outside was read");
    let report = project.report.to_string();
    assert!(report.contains("is not in the project"), "{name}: {report}");
}

#[test]
fn names_lead_nowhere_outside_a_directory() {
    let outside = tempfile::tempdir().unwrap();
    let secret = outside.path().canonicalize().unwrap();
    write(&secret.join("secret.png"), secret_image());
    write(&secret.join("secret.rgg"), SECRET_SOURCE);
    write(&secret.join("secret.xml"), textured());
    let absolute = secret.to_str().unwrap().to_owned();
    let project = secret.join("a/b/project");
    let cases = [
        ("../../../secret.png".to_owned(), "../../../secret.rgg".to_owned()),
        (format!("{absolute}/secret.png"), format!("{absolute}/secret.rgg")),
        ("images/../../../../secret.png".to_owned(), "./../../../secret.rgg".to_owned()),
        ("..\\..\\..\\secret.png".to_owned(), "..\\..\\..\\secret.rgg".to_owned()),
        (format!("file://{absolute}/secret.png"), format!("file://{absolute}/secret.rgg")),
    ];
    for (image, source) in &cases {
        write(&project.join("project.gs"), registry(image, source, "graph.xml"));
        write(&project.join("graph.xml"), textured());
        write(&project.join("images/leaf.png"), secret_image());
        assert_contained(&project, image);
        // The name of the graph itself.
        let graph = source.replace("secret.rgg", "secret.xml");
        write(&project.join("project.gs"), registry("i.png", "s.rgg", &graph));
        let error = groimp::read(&project).unwrap_err().to_string();
        assert!(error.contains("secret.xml"), "{error}");
    }
    // The test would notice: inside the project all of it is read.
    write(&project.join("inside/secret.rgg"), SECRET_SOURCE);
    write(&project.join("project.gs"), registry("images/leaf.png", "inside/secret.rgg", "graph.xml"));
    let read = groimp::read(&project).unwrap();
    assert_eq!((read.scene.images.len(), read.scene.drawn_objects()), (1, 2), "{}", read.report);
}

#[cfg(unix)]
#[test]
fn links_and_pipes_lead_nowhere_outside_a_directory() {
    use std::os::unix::fs::symlink;
    let outside = tempfile::tempdir().unwrap();
    let secret = outside.path().canonicalize().unwrap();
    write(&secret.join("secret.png"), secret_image());
    write(&secret.join("secret.rgg"), SECRET_SOURCE);
    write(&secret.join("secret.xml"), textured());
    let project = secret.join("project");
    write(&project.join("graph.xml"), textured());
    symlink(secret.join("secret.png"), project.join("link.png")).unwrap();
    std::fs::create_dir(project.join("linked")).unwrap();
    symlink(secret.join("secret.rgg"), project.join("linked/secret.rgg")).unwrap();
    symlink("../secret.xml", project.join("link.xml")).unwrap();
    symlink("..", project.join("up")).unwrap();
    symlink("round.png", project.join("round.png")).unwrap();
    symlink("/dev/zero", project.join("zero.png")).unwrap();
    let pipe = Command::new("mkfifo").arg(project.join("pipe.png")).status().unwrap();
    assert!(pipe.success());
    for (image, source) in
        [("link.png", "linked/secret.rgg"), ("up/secret.png", "up/secret.rgg"), ("pipe.png", "zero.png")]
    {
        write(&project.join("project.gs"), registry(image, source, "graph.xml"));
        assert_contained(&project, image);
    }
    write(&project.join("project.gs"), registry("zero.png", "pipe.png", "graph.xml"));
    assert_contained(&project, "zero.png");
    for graph in ["link.xml", "up/secret.xml", "zero.png", "pipe.png"] {
        write(&project.join("project.gs"), registry("i.png", "s.rgg", graph));
        let error = groimp::read(&project).unwrap_err().to_string();
        assert!(error.contains(graph), "{error}");
    }
    // A link in a circle is an error of the system's; it must be told, not followed.
    write(&project.join("project.gs"), registry("round.png", "s.rgg", "graph.xml"));
    let read = groimp::read(&project).unwrap();
    assert!(read.scene.images.is_empty() && read.report.to_string().contains("round.png"));
    // A link to the project itself is the user's own choice, and so are links that stay inside.
    symlink(&project, secret.join("chosen")).unwrap();
    symlink("graph.xml", project.join("inner.xml")).unwrap();
    write(&project.join("project.gs"), registry("i.png", "s.rgg", "inner.xml"));
    assert_eq!(groimp::read(&secret.join("chosen")).unwrap().scene.drawn_objects(), 1);
}

#[test]
fn names_in_an_archive_stay_in_it() {
    let directory = tempfile::tempdir().unwrap();
    let image = secret_image();
    for name in ["../secret.png", "/etc/secret.png", "a/../../secret.png", "..\\secret.png"] {
        let source = name.replace(".png", ".rgg");
        let registry = registry(name, &source, "graph.xml");
        let bytes = zipped(&[
            ("project.gs", registry.as_bytes()),
            ("graph.xml", textured().as_bytes()),
            (name, &image),
            (&source, SECRET_SOURCE.as_bytes()),
        ]);
        let path = directory.path().join("a.gsz");
        std::fs::write(&path, bytes).unwrap();
        assert_contained(&path, name);
    }
    // Nothing was unpacked.
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
}

/// Projects that want too much, each with what is said about it; `None` where only the end matters.
fn projects(directory: &Path) -> Vec<(PathBuf, Option<&'static str>)> {
    let mut all = Vec::new();
    let mut archive = |name: &str, graph: &str, more: &[(&str, &[u8])], said| {
        let registry = registry("i.png", "s.rgg", "graph.xml");
        let mut files = vec![("project.gs", registry.as_bytes()), ("graph.xml", graph.as_bytes())];
        files.extend(more);
        let path = directory.join(name);
        std::fs::write(&path, zipped(&files)).unwrap();
        all.push((path, said));
    };
    let spaces = vec![b' '; 3 << 20];
    archive("bomb.gsz", &graph(&" ".repeat(3 << 20)), &[], Some("--limit"));
    archive("image-bomb.gsz", &textured(), &[("i.png", &spaces)], Some("--limit"));
    let deep = "<node id=\"1\" type=\"T\" edges=\"-\">".repeat(12_000) + &"</node>".repeat(12_000);
    archive("deep.gsz", &graph(&deep), &[], None);
    let wide: String = (1..30_000).map(|id| format!("<node id=\"{id}\" type=\"T\" edges=\"-\"/>")).collect();
    archive("many-nodes.gsz", &graph(&wide), &[], Some("graph-nodes"));
    let inline = field("shader", &"[".repeat(200_000));
    archive("nested-values.gsz", &graph(&node("1", SPHERE, &inline)), &[], None);
    let laughs = "<!DOCTYPE l [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\"><!ENTITY c \
                  \"&b;&b;&b;&b;&b;&b;&b;&b;\"><!ENTITY x SYSTEM \"file:///etc/passwd\">]>";
    let laughs = format!("{laughs}{}", graph(&node("1", SPHERE, &field("name", "&c;&x;"))));
    archive("entities.gsz", &laughs, &[], None);
    // A picture of 65535 x 65535 pixels in its header, and nothing behind it.
    let mut header = secret_image();
    header[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
    archive("image-header.gsz", &textured(), &[("i.png", &header)], None);
    for (number, value) in ["1e999", "nan", "-1", "1e308", "99999999999999999999", "0x7fffffff", "1e-320", ""]
        .into_iter()
        .enumerate()
    {
        let fields = field("radius", value) + &field("transform", value);
        archive(&format!("number-{number}.gsz"), &graph(&node("1", SPHERE, &fields)), &[], None);
        let id = graph(&(node(value, SPHERE, "") + &node(value, SPHERE, "")));
        archive(&format!("id-{number}.gsz"), &id, &[], None);
    }
    // A stream that says it holds two billion numbers, and one that refers to itself.
    for (number, stream) in
        ["rO0ABXVyAAJbRAAAAAAAAAAAAgAAeHB/////", "rO0ABXEAfgAA", "rO0ABXNyAAFBAAAAAAAAAAACAAB4cQB+AAA="]
            .into_iter()
            .enumerate()
    {
        let mesh = format!("<serialized gx:name=\"polygons\" gx:value=\"{stream}\"/>");
        let mesh = graph(&node("1", "de.grogra.imp3d.objects.MeshNode", &mesh));
        archive(&format!("stream-{number}.gsz"), &mesh, &[], None);
    }
    let body = "module A ==> { for (int i = 0; i < 2000000000; i++) { Sphere(1) } };";
    archive("endless-body.gsz", &graph(&node("1", "A", "")), &[("s.rgg", body.as_bytes())], None);
    let nested = format!("module A({}1{});", "(".repeat(100_000), ")".repeat(100_000));
    archive("nested-source.gsz", &graph(&node("1", "A", "")), &[("s.rgg", nested.as_bytes())], None);
    // No archives at all.
    for (name, bytes) in
        [("empty.gsz", &b""[..]), ("noise.gsz", b"PK\x03\x04\xff\xff\xff\xff"), ("end.gsz", b"PK\x05\x06")]
    {
        let path = directory.join(name);
        std::fs::write(&path, bytes).unwrap();
        all.push((path, Some("not a zip archive")));
    }
    all
}

fn sunshine(directory: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sunshine")).args(words).current_dir(directory).output().unwrap()
}

#[test]
fn every_hostile_project_ends_with_an_explanation_or_a_picture() {
    let directory = tempfile::tempdir().unwrap();
    let projects = projects(directory.path());
    assert!(projects.len() > 30, "{}", projects.len());
    for (path, said) in projects {
        let words = [
            "render",
            path.to_str().unwrap(),
            "-o",
            "a.png",
            "--size",
            "4x4",
            "--samples",
            "1",
            "--device",
            "cpu",
            // So that what costs too much shows on small inputs.
            "--limit",
            "file-bytes=2000000",
            "--limit",
            "graph-nodes=20000",
            "--limit",
            "body-nodes=1000",
            "--limit",
            "body-steps=100000",
        ];
        let output = sunshine(directory.path(), &words);
        let message = String::from_utf8_lossy(&output.stderr);
        let code = output.status.code();
        assert!(code == Some(0) || code == Some(1), "{}: {code:?} {message}", path.display());
        assert!(!message.contains("panicked"), "{}: {message}", path.display());
        if let Some(said) = said {
            assert!(message.contains(said), "{}: no {said:?} in {message}", path.display());
        }
        assert!(!message.contains("root:"), "{}: {message}", path.display());
    }
}

#[test]
fn names_cannot_move_the_cursor() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.gsz");
    let name = "img\u{1b}[2J\u{202e}gnp.exe";
    let registry = registry(&name.replace('\u{1b}', "\u{9b}"), "s.rgg", "graph.xml");
    let bytes = zipped(&[("project.gs", registry.as_bytes()), ("graph.xml", textured().as_bytes())]);
    std::fs::write(&path, bytes).unwrap();
    for words in [&["info"][..], &["render", "--size", "4x4", "--samples", "1", "--device", "cpu"]] {
        let mut all = words.to_vec();
        all.push(path.to_str().unwrap());
        let output = sunshine(directory.path(), &all);
        assert!(output.status.success());
        let said = [output.stdout, output.stderr].concat();
        let said = String::from_utf8(said).unwrap();
        assert!(said.contains("gnp.exe"), "{said}");
        assert!(!said.contains(['\u{1b}', '\u{9b}', '\u{202e}']), "{said:?}");
    }
}

#[test]
fn limits_have_names() {
    let directory = tempfile::tempdir().unwrap();
    let wrong = |words: &[&str], part: &str| {
        let output = sunshine(directory.path(), words);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(part), "{message}");
    };
    wrong(&["info", "a.gsz", "--limit", "much=1"], "total-image-pixels");
    wrong(&["info", "a.gsz", "--limit", "instances"], "total-bytes=8000000000");
    wrong(&["render", "a.gsz", "--limit", "instances=-1"], "whole number");
}
