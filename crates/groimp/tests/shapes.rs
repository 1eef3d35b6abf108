//! Shapes that become triangles, against closed forms.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::triangles::*;
use common::{data, directory, file, graph};
use groimp::{Flatness, Limits, Project, ReadOptions};
use scene::{DVec3, Shape, VisibleSides};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::io::Cursor;

const OBJECTS: &str = "de.grogra.imp3d.objects.";

fn node(id: i64, class: &str, fields: &str) -> String {
    format!("<node id=\"{id}\" type=\"{OBJECTS}{class}\" edges=\"+\">{fields}</node>\n")
}

fn fields(values: &[(&str, f64)]) -> String {
    values.iter().map(|(name, value)| data(name, value)).collect()
}

fn read(test: &str, nodes: &str) -> Project {
    groimp::read(&file(test, "graph.xml", graph(nodes).as_bytes())).unwrap()
}

fn one(test: &str, class: &str, values: &[(&str, f64)]) -> Project {
    let project = read(test, &node(1, class, &fields(values)));
    assert!(project.report.skipped.is_empty(), "{}", project.report);
    project
}

fn reasons(project: &Project) -> Vec<&str> {
    project.report.skipped.iter().map(|skipped| skipped.reason.as_str()).collect()
}

/// The default tolerance for a sphere of that radius; the middle of a cell may be twice as far away as its sides.
fn sagitta(radius: f64) -> f64 {
    2.0 * 5e-4 * 2.0 * 3f64.sqrt() * radius
}

#[test]
fn a_supershape_without_fields_is_a_sphere() {
    let project = one("supershape_sphere", "Supershape", &[]);
    let mesh = mesh_of(&project, 0);
    assert_closed(mesh);
    for vertex in 0..mesh.positions.len() {
        let at = mesh.position(vertex);
        assert!((at.length() - 1.0).abs() < 1e-6);
        assert!(normal(mesh, vertex).distance(at) < 1e-4, "{at} {}", normal(mesh, vertex));
    }
    let sphere = 4.0 / 3.0 * PI;
    assert!(volume(mesh) < sphere && volume(mesh) > sphere * (1.0 - sagitta(1.0)).powi(3));
    assert!(mesh.triangles.len() < 20_000, "{}", mesh.triangles.len());
}

/// |x| + |y| + |z| = 1, as the superformula with m = 4 and all exponents 1 in both angles.
#[test]
fn a_supershape_with_edges_is_an_octahedron() {
    let ones = ["n11", "n12", "n13", "n21", "n22", "n23"].map(|name| (name, 1.0));
    let values = [vec![("m1", 4.0), ("m2", 4.0)], ones.to_vec()].concat();
    let project = one("supershape_octahedron", "Supershape", &values);
    let mesh = mesh_of(&project, 0);
    assert_closed(mesh);
    assert!((volume(mesh) - 4.0 / 3.0).abs() < 1e-6, "{}", volume(mesh));
    assert!((area(mesh) - 4.0 * 3f64.sqrt()).abs() < 1e-6, "{}", area(mesh));
    for triangle in mesh.triangles.iter() {
        let corners = triangle.map(|vertex| mesh.position(vertex as usize));
        let middle = corners.iter().sum::<DVec3>() / 3.0;
        for vertex in triangle {
            // Sharp edges: all corners have the normal of the face.
            let expected = middle.signum() / 3f64.sqrt();
            assert!(normal(mesh, *vertex as usize).distance(expected) < 1e-3, "{middle}");
        }
    }
}

#[test]
fn a_supershape_follows_the_superformula() {
    let (a, b) = (1.2, 0.8);
    let (outline, profile) = ([5.0, 1.7, 1.3, 2.2], [3.0, 0.9, 2.5, 1.5]);
    let names = [["m1", "n11", "n12", "n13"], ["m2", "n21", "n22", "n23"]];
    let mut values = vec![("a", a), ("b", b)];
    values.extend(names[0].into_iter().zip(outline).chain(names[1].into_iter().zip(profile)));
    let project = one("supershape_formula", "Supershape", &values);
    let mesh = mesh_of(&project, 0);
    assert_closed(mesh);
    let radius = |angle: f64, [m, n1, n2, n3]: [f64; 4]| {
        let quarter = m * angle / 4.0;
        ((quarter.cos().abs() / a).powf(n2) + (quarter.sin().abs() / b).powf(n3)).powf(-1.0 / n1)
    };
    let point = |u: f64, v: f64| {
        let (theta, phi) = ((2.0 * u - 1.0) * PI, (v - 0.5) * PI);
        let (r1, r2) = (radius(theta, outline), radius(phi, profile));
        let across = r1 * r2 * phi.cos();
        DVec3::new(across * theta.cos(), across * theta.sin(), r2 * phi.sin())
    };
    // Not at multiples of a right angle of m t / 4.
    let kink = |angle: f64, m: f64| (m * angle / TAU - (m * angle / TAU).round()).abs() < 0.01;
    let smooth = |u: f64, v: f64| !kink((2.0 * u - 1.0) * PI, 5.0) && !kink((v - 0.5) * PI, 3.0);
    assert_on_surface(mesh, point, smooth);
    // Slices: area of the outline times the square of the profile, over the height.
    const N: usize = 200_000;
    let middle = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let slice: f64 = (0..N).map(|i| radius((2.0 * middle(i, N) - 1.0) * PI, outline).powi(2)).sum();
    let slice = 0.5 * slice * TAU / N as f64;
    let height = |v: f64| radius((v - 0.5) * PI, profile) * ((v - 0.5) * PI).sin();
    let expected: f64 = (0..N)
        .map(|i| {
            let v = middle(i, N);
            let across = radius((v - 0.5) * PI, profile) * ((v - 0.5) * PI).cos();
            slice * across * across * (height((i as f64 + 1.0) / N as f64) - height(i as f64 / N as f64))
        })
        .sum();
    assert!((volume(mesh) / expected - 1.0).abs() < 0.01, "{} {expected}", volume(mesh));
}

#[test]
fn wedges_of_spheres_have_their_volume_and_area() {
    for (test, radius, theta1, theta2, phi) in [
        ("segment_whole", 2.0, 0.0, PI, TAU),
        ("segment_half", 1.0, 0.0, FRAC_PI_2, TAU),
        ("segment_bowl", 1.0, 2.0, 2.5, TAU),
        ("segment_wedge", 0.5, 0.3, 2.6, 1.0),
        ("segment_slice", 1.0, 0.0, PI, 0.7),
        ("segment_back", 1.0, 1.0, 0.2, -2.0),
        ("segment_single", 1.0, 0.0, f64::from(PI as f32), f64::from(TAU as f32)),
    ] {
        let values = [("radius", -radius), ("theta1", theta1), ("theta2", theta2), ("phi", phi)];
        let project = one(test, "SphereSegmentSolid", &values);
        let mesh = mesh_of(&project, 0);
        assert_closed(mesh);
        let (low, high) = (f64::min(theta1, theta2), f64::max(theta1, theta2));
        let (turn, band) = (f64::abs(phi), low.cos() - high.cos());
        let expected = turn * radius.powi(3) * band / 3.0;
        let relative = 4.0 * sagitta(1.0);
        assert!((volume(mesh) / expected - 1.0).abs() < relative, "{test}: {} {expected}", volume(mesh));
        let mut expected = turn * band + 0.5 * turn * (low.sin() + high.sin());
        if turn < TAU - 1e-6 {
            expected += high - low;
        }
        expected *= radius * radius;
        assert!((area(mesh) / expected - 1.0).abs() < relative, "{test}: {} {expected}", area(mesh));
        let side = |at: DVec3| at.y.atan2(at.x).rem_euclid(TAU);
        for vertex in 0..mesh.positions.len() {
            let at = mesh.position(vertex);
            assert!(at.length() < radius * 1.000001);
            if at.truncate().length() > 1e-3 * radius && turn < PI {
                let azimuth = if phi < 0.0 { TAU - side(at) } else { side(at) };
                assert!(azimuth < turn + 1e-3 || azimuth > TAU - 1e-3, "{test}: {azimuth}");
            }
        }
    }
}

#[test]
fn a_lamella_is_a_paraboloid_with_the_front_of_a_parallelogram() {
    let (width, height, a, b) = (0.4, 1.5, 0.9, -0.3);
    let values = [("width", width), ("height", height), ("a", a), ("b", b)];
    let project = one("lamella", "Lamella", &values);
    let mesh = mesh_of(&project, 0);
    let point = |u: f64, v: f64| {
        let (x, z) = ((u - 0.5) * width, v * height);
        DVec3::new(x, a * x * x + b * z * z, z)
    };
    assert_on_surface(mesh, point, |_, _| true);
    assert_normals_in_front(mesh);
    assert!(mesh.normals.iter().all(|normal| normal[1] > 0.0));
    const N: usize = 500;
    let cell = width * height / (N * N) as f64;
    let expected: f64 = (0..N * N)
        .map(|i| {
            let x = ((i % N) as f64 + 0.5) / N as f64 * width - 0.5 * width;
            let z = ((i / N) as f64 + 0.5) / N as f64 * height;
            (1.0 + (2.0 * a * x).powi(2) + (2.0 * b * z).powi(2)).sqrt() * cell
        })
        .sum();
    assert!((area(mesh) / expected - 1.0).abs() < 1e-3, "{} {expected}", area(mesh));
    let flat = read("lamella_flat", &node(1, "Lamella", &(data("height", -2) + &data("shiftPivot", true))));
    let flat = mesh_of(&flat, 0);
    assert_eq!((flat.triangles.len(), area(flat)), (2, 2.0));
    assert_eq!(flat.bounds(&scene::DAffine3::IDENTITY).unwrap().0, DVec3::new(-0.5, 0.0, -1.0));
}

fn vertex_grid(numbers: &str, u_count: usize, dimension: usize) -> String {
    format!(
        "<object gx:name=\"grid\" gx:type=\"de.grogra.math.VertexGridImpl\"><array gx:name=\"data\" \
         gx:value=\"{numbers}\"/><data gx:name=\"dimension\" gx:value=\"{dimension}\"/><data gx:name=\"uCount\" \
         gx:value=\"{u_count}\"/></object>"
    )
}

#[test]
fn a_patch_has_the_points_of_its_grid() {
    let grid = vertex_grid("0 0 0  1 0 0.5  2 0 0  0 1 0  1 1 0.5  2 1 0", 3, 3) + &data("visibleSides", 1);
    let inline = "<object gx:name=\"grid\" gx:type=\"de.grogra.math.VertexGridImpl\" data=\"{0 0 1 0 0 1 1 1}\" \
                  dimension=\"2\" uCount=\"2\"/>";
    let node_form = "<ref gx:name=\"grid\" gx:value=\"9\"/><node id=\"9\" type=\"de.grogra.math.VertexGridImpl\">\
                     <array gx:name=\"data\"><data gx:value=\"0\"/><data gx:value=\"0\"/><data gx:value=\"1\"/>\
                     <data gx:value=\"0\"/><data gx:value=\"0\"/><data gx:value=\"1\"/><data gx:value=\"1\"/>\
                     <data gx:value=\"1\"/></array><data gx:name=\"dimension\" gx:value=\"2\"/><data gx:name=\"uCount\" \
                     gx:value=\"2\"/></node>";
    let project =
        read("patch", &(node(1, "Patch", &grid) + &node(2, "Patch", inline) + &node(3, "Patch", node_form)));
    let mesh = mesh_of(&project, 0);
    assert_eq!(mesh.positions.len(), 6);
    assert_eq!((mesh.position(4), uv(mesh, 4)), (DVec3::new(1.0, 1.0, 0.5), [0.5, 1.0]));
    assert_eq!((uv(mesh, 0), uv(mesh, 2), uv(mesh, 3)), ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]));
    assert_eq!(mesh.triangles.len(), 4);
    assert_normals_in_front(mesh);
    assert_eq!(normal(mesh, 1), DVec3::Z);
    assert!((area(mesh) - 2.0 * 1.25f64.sqrt()).abs() < 1e-6);
    assert!(matches!(project.scene.objects[0].shape, Shape::Mesh { visible_sides: VisibleSides::Back, .. }));
    let square = mesh_of(&project, 1);
    assert_eq!((area(square), normal(square, 0)), (1.0, DVec3::Z));
    assert_eq!(mesh_of(&project, 2), square);
    // Equal grids are one mesh, wherever they are written.
    assert_eq!(project.scene.meshes.len(), 2);
}

#[test]
fn polygons_are_fans() {
    let vertices = |numbers: &str, dimension: usize| {
        format!(
            "<object gx:name=\"vertices\" gx:type=\"de.grogra.math.VertexListImpl\" data=\"{{{numbers}}}\" \
             dimension=\"{dimension}\"/>"
        )
    };
    let nodes = node(1, "Polygon", &vertices("0 0 1 0 0 1 0 0.000001", 2))
        + &node(2, "Polygon", &(vertices("1 0 0 0 1 0 -1 0 0 0 -1 0", 3) + &data("visibleSides", 0)))
        + &node(3, "Polygon", &vertices("0 0 1 1", 2))
        + &node(4, "Polygon", &vertices("0 0 1 1 2", 2))
        + &node(5, "Polygon", "<null gx:name=\"vertices\"/>");
    let project = read("polygon", &nodes);
    let triangle = mesh_of(&project, 0);
    assert_eq!(&triangle.triangles[..], [[0, 1, 2]]);
    assert_eq!(&triangle.uvs[..], [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let square = mesh_of(&project, 1);
    assert_eq!(&square.triangles[..], [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
    assert_eq!(square.position(4), DVec3::ZERO);
    for (vertex, expected) in
        [[1.0, 0.5], [0.5, 1.0], [0.0, 0.5], [0.5, 0.0], [0.5, 0.5]].into_iter().enumerate()
    {
        assert!(uv(square, vertex).iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-7), "{vertex}");
        assert_eq!(normal(square, vertex), DVec3::Z);
    }
    assert!((area(square) - 2.0).abs() < 1e-7);
    assert!(matches!(project.scene.objects[1].shape, Shape::Mesh { visible_sides: VisibleSides::Front, .. }));
    assert_eq!(
        reasons(&project),
        [
            "it has 2 corners, which span no surface",
            "its 5 numbers are no points with 2 coordinates",
            "it has no vertices"
        ]
    );
}

const REGISTRY: &str = r#"<project xmlns="http://grogra.de/registry" graph="graph.xml"><registry>
<ref name="project"><ref name="objects"><ref name="images">
 <de.grogra.pf.ui.registry.FileObjectItem name="bytes" systemId="pfs:bytes.png"/>
 <de.grogra.pf.ui.registry.FileObjectItem name="words" systemId="pfs:words.png"/>
 <de.grogra.pf.ui.registry.FileObjectItem name="colors" systemId="pfs:colors.png"/>
 <de.grogra.pf.ui.registry.FileObjectItem name="lost" systemId="pfs:lost.png"/></ref></ref></ref>
<ref name="workbench"><ref name="state"><de.grogra.pf.ui.registry.Layout name="layout">
 <de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="visibleLayers={true VISIBLE true}
  camera=(projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.5]
  transformation=(1 0 0 0 0 1 0 0 0 0 1 -5 0 0 0 1))"/>
</de.grogra.pf.ui.registry.Layout></ref></ref></registry></project>"#;

fn png(image: impl Into<image::DynamicImage>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn height_field(image: &str, mapping: &str) -> String {
    format!(
        "<object gx:name=\"grid\" gx:type=\"{OBJECTS}ImageHeightField\"><shared gx:name=\"image\" \
         gx:value=\"/:&quot;/project/objects/images/{image}&quot;\"/>{mapping}</object>"
    )
}

#[test]
fn height_fields_have_the_grey_values_of_their_pictures() {
    // The top row of the picture is the far one.
    let bytes = png(image::GrayImage::from_vec(3, 2, vec![10, 20, 30, 40, 50, 255]).unwrap());
    let words =
        image::ImageBuffer::<image::Luma<u16>, _>::from_vec(2, 2, vec![0u16, 1, 1000, 65535]).unwrap();
    let colors = image::RgbImage::from_fn(2, 2, |x, y| image::Rgb([200, 100, (x + 10 * y) as u8]));
    let mapping = "<object gx:name=\"mapping\" gx:type=\"de.grogra.imp3d.objects.RectangularHeightFieldMapping\" \
                   xWidth=\"4\" yWidth=\"2\" scale=\"0.5\" zeroLevel=\"40\" water=\"WATER\"/>";
    let fields = [
        height_field("bytes", &mapping.replace("WATER", "false")),
        height_field("bytes", &mapping.replace("WATER", "true")),
        height_field("words", ""),
        height_field("colors", ""),
        height_field("lost", ""),
        height_field("nothing", ""),
    ];
    let nodes: String = (1..).zip(&fields).map(|(id, fields)| node(id, "Patch", fields)).collect();
    let graph = graph(&nodes);
    let files = |visible: &str| -> Vec<(&str, Vec<u8>)> {
        vec![
            ("project.gs", REGISTRY.replace("VISIBLE", visible).into_bytes()),
            ("graph.xml", graph.clone().into_bytes()),
            ("bytes.png", bytes.clone()),
            ("words.png", png(words.clone())),
            ("colors.png", png(colors.clone())),
        ]
    };
    let open = |test: &str, visible: &str| {
        let files = files(visible);
        let files: Vec<_> = files.iter().map(|(name, bytes)| (*name, &bytes[..])).collect();
        groimp::read(&directory(test, &files)).unwrap()
    };
    let project = open("heights", "true");
    let points = |object: usize| -> Vec<[f64; 3]> {
        let mesh = mesh_of(&project, object);
        assert_normals_in_front(mesh);
        (0..mesh.positions.len()).map(|i| mesh.position(i).to_array()).collect()
    };
    assert_eq!(
        points(0),
        [
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 5.0],
            [4.0, 0.0, 107.5],
            [0.0, 2.0, -15.0],
            [2.0, 2.0, -10.0],
            [4.0, 2.0, -5.0]
        ]
    );
    assert_eq!(points(1).iter().map(|p| p[2]).collect::<Vec<_>>(), [0.0, 5.0, 107.5, 0.0, 0.0, 0.0]);
    assert_eq!(points(2), [[0.0, 0.0, 1000.0], [1.0, 0.0, 65535.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]]);
    assert_eq!(points(3).iter().map(|p| p[2]).collect::<Vec<_>>(), [10.0, 11.0, 0.0, 1.0]);
    assert_eq!(
        reasons(&project),
        ["its image 'lost.png' is not in the project", "its grid names no image of the project"]
    );
    // Patches are in layer 1 unless they say otherwise.
    let hidden = open("heights_hidden", "false");
    assert!(hidden.scene.objects.is_empty());
    assert!(reasons(&hidden).contains(&"its layer is hidden in the saved view"));
    // With few triangles allowed every other sample is used, and the rim.
    let path = directory(
        "heights_large",
        &[
            ("project.gs", REGISTRY.replace("VISIBLE", "true").as_bytes()),
            ("graph.xml", common::graph(&node(1, "Patch", &height_field("bytes", ""))).as_bytes()),
            ("bytes.png", &png(image::GrayImage::from_fn(100, 80, |x, _| image::Luma([x as u8])))),
        ],
    );
    let limits = Limits { surface_triangles: 1000, ..Limits::default() };
    let project = groimp::read_within(&path, limits).unwrap();
    let mesh = mesh_of(&project, 0);
    assert!((500..=1000).contains(&mesh.triangles.len()), "{}", mesh.triangles.len());
    let (low, high) = mesh.bounds(&scene::DAffine3::IDENTITY).unwrap();
    assert_eq!((low, high), (DVec3::ZERO, DVec3::new(1.0, 1.0, 99.0)));
    assert!(project.report.to_string().contains("drawn coarser"), "{}", project.report);
}

#[test]
fn equal_surfaces_share_a_mesh() {
    let nodes = node(1, "Supershape", &data("m1", 3))
        + &node(2, "Supershape", &data("m1", 3))
        + &node(3, "Supershape", &data("m1", 4))
        + &node(4, "SphereSegmentSolid", "")
        + &node(5, "SphereSegmentSolid", &data("phi", 1));
    let project = read("shared_surfaces", &nodes);
    let ids: Vec<_> = (0..5)
        .map(|i| match project.scene.objects[i].shape {
            Shape::Mesh { mesh, visible_sides: VisibleSides::Both } => mesh.0,
            ref other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(ids, [0, 0, 1, 2, 3]);
}

#[test]
fn flatness_and_limits_decide_about_the_number_of_triangles() {
    let path = file("flatness", "graph.xml", graph(&node(1, "Supershape", &data("a", 3))).as_bytes());
    let count = |options: ReadOptions| {
        let project = groimp::read_with(&path, &options).unwrap();
        assert_closed(mesh_of(&project, 0));
        (mesh_of(&project, 0).triangles.len(), project.report.to_string().contains("coarser"))
    };
    let with = |flatness| count(ReadOptions { flatness, ..ReadOptions::default() });
    let (usual, coarser) = with(Flatness::default());
    assert!(!coarser);
    let (fine, coarser) = with(Flatness::Relative(5e-5));
    assert!(fine > 4 * usual && !coarser, "{fine} {usual}");
    assert!(with(Flatness::Metres(0.5)).0 < usual);
    let limits = Limits { surface_triangles: 1000, ..Limits::default() };
    for flatness in [Flatness::Relative(0.0), Flatness::Metres(f64::NAN)] {
        let (limited, coarser) = count(ReadOptions { flatness, limits, ..ReadOptions::default() });
        assert!(limited <= 1000 && coarser);
    }
    let limits = Limits { total_surface_triangles: 0, ..Limits::default() };
    let project = groimp::read_within(&path, limits).unwrap();
    assert_eq!(reasons(&project), ["the surfaces of this project have too many triangles"]);
}

#[test]
fn what_has_no_extent_is_counted() {
    let nodes = node(1, "Supershape", &data("n12", "Infinity"))
        + &node(2, "Supershape", &data("m1", "NaN"))
        + &node(3, "Supershape", &data("a", 0))
        + &node(4, "SphereSegmentSolid", &data("radius", 0))
        + &node(5, "SphereSegmentSolid", &data("phi", 0))
        + &node(6, "Lamella", &data("width", 0))
        + &node(7, "Lamella", &data("a", "1E300"))
        + &node(8, "Patch", "")
        + &node(9, "Patch", &vertex_grid("1 2 3", 1, 3))
        + &node(10, "Patch", &vertex_grid("0 0 0 0 0 0 0 0 0 0 0 0", 2, 3))
        + &node(11, "NURBSSurface", "");
    let project = read("no_extent", &nodes);
    let drawn: Vec<_> = project.scene.objects.iter().map(|object| object.origin.node).collect();
    assert!(drawn.is_empty(), "{drawn:?}");
    assert_eq!(project.report.skipped.iter().map(|s| s.count).sum::<usize>(), 11, "{}", project.report);
    // A formula with more kinks than any grid can follow ends as well.
    let wild = [("m1", 1e6), ("m2", 1e9), ("n11", 0.1), ("n12", -3.0), ("n13", 60.0)];
    let project = read("wild", &node(1, "Supershape", &fields(&wild)));
    assert!(project.scene.objects.len() + project.report.skipped.len() == 1, "{}", project.report);
}
