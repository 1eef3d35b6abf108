//! Bezier and B-spline surfaces, against de Casteljau and Cox-de Boor.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::triangles::*;
use common::{data, file, graph};
use groimp::Project;
use scene::DVec3;
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

fn node(id: i64, fields: &str) -> String {
    format!("<node id=\"{id}\" type=\"de.grogra.imp3d.objects.NURBSSurface\" edges=\"+\">{fields}</node>\n")
}

fn read(test: &str, nodes: &str) -> Project {
    groimp::read(&file(test, "graph.xml", graph(nodes).as_bytes())).unwrap()
}

fn text(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!("{number:?} ")).collect()
}

fn surface(class: &str, numbers: &[f64], members: &[(&str, &str)]) -> String {
    let members: String = members.iter().map(|(name, value)| data(name, value)).collect();
    format!(
        "<object gx:name=\"surface\" gx:type=\"de.grogra.math.{class}\"><array gx:name=\"data\" gx:value=\"{}\"/>\
         {members}</object>",
        text(numbers)
    )
}

fn draw(test: &str, class: &str, numbers: &[f64], members: &[(&str, &str)]) -> Project {
    let project = read(test, &node(1, &surface(class, numbers, members)));
    assert!(project.report.skipped.is_empty(), "{}", project.report);
    project
}

/// Waves, different in both directions.
fn control_points(u_count: usize, v_count: usize) -> Vec<DVec3> {
    let point = |i: usize| {
        let (x, y) = ((i % u_count) as f64, (i / u_count) as f64);
        DVec3::new(x + 0.2 * y, y - 0.1 * x * x, (1.3 * x).sin() * (0.9 * y).cos())
    };
    (0..u_count * v_count).map(point).collect()
}

fn flat(points: &[DVec3]) -> Vec<f64> {
    points.iter().flat_map(|point| point.to_array()).collect()
}

fn de_casteljau(points: &[DVec3], t: f64) -> DVec3 {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points.windows(2).map(|pair| pair[0].lerp(pair[1], t)).collect();
    }
    points[0]
}

/// The basis function by its definition.
fn cox_de_boor(knots: &[f64], i: usize, degree: usize, t: f64) -> f64 {
    if degree == 0 {
        return if knots[i] <= t && t < knots[i + 1] { 1.0 } else { 0.0 };
    }
    let part = |from: f64, to: f64, value: f64| if to > from { value / (to - from) } else { 0.0 };
    let left = part(knots[i], knots[i + degree], t - knots[i]) * cox_de_boor(knots, i, degree - 1, t);
    let right = part(knots[i + 1], knots[i + degree + 1], knots[i + degree + 1] - t)
        * cox_de_boor(knots, i + 1, degree - 1, t);
    left + right
}

#[test]
fn bezier_surfaces_are_those_of_de_casteljau() {
    for (test, u_count, v_count) in [("bezier_cubic", 4, 4), ("bezier_mixed", 6, 3), ("bezier_flat", 2, 2)] {
        let points = control_points(u_count, v_count);
        let members = [("dimension", "3"), ("uCount", &*u_count.to_string()), ("rational", "false")];
        let project = draw(test, "BezierSurface", &flat(&points), &members);
        let mesh = mesh_of(&project, 0);
        let point = |u: f64, v: f64| {
            let row: Vec<_> = points.chunks(u_count).map(|row| de_casteljau(row, u)).collect();
            de_casteljau(&row, v)
        };
        assert_on_surface(mesh, point, |_, _| true);
        assert_normals_in_front(mesh);
        // The middles of the triangles are as near to the surface as asked for.
        let (low, high) = mesh.bounds(&scene::DAffine3::IDENTITY).unwrap();
        let tolerance = 2.5 * 5e-4 * (high - low).length();
        for triangle in mesh.triangles.iter() {
            let corners = triangle.map(|vertex| vertex as usize);
            let middle = corners.iter().map(|vertex| mesh.position(*vertex)).sum::<DVec3>() / 3.0;
            let [u, v] = [0, 1].map(|i| corners.iter().map(|vertex| uv(mesh, *vertex)[i]).sum::<f64>() / 3.0);
            let on_surface = point(u, v);
            let normal = corners.iter().map(|vertex| normal(mesh, *vertex)).sum::<DVec3>().normalize();
            // Along the normal: sliding within the surface does no harm.
            assert!((middle - on_surface).dot(normal).abs() < tolerance, "{test} at {u} {v}");
        }
    }
}

#[test]
fn b_spline_surfaces_are_those_of_cox_and_de_boor() {
    let points = control_points(6, 5);
    let u_knots = [0.0, 0.0, 0.0, 0.0, 0.4, 1.5, 2.0, 2.0, 2.0, 2.0];
    let v_knots = [-1.0, 0.0, 0.5, 1.0, 1.0, 2.0, 3.0, 4.0];
    let numbers = [flat(&points), u_knots.to_vec(), v_knots.to_vec()].concat();
    let members = [("dimension", "3"), ("uCount", "6"), ("uDegree", "3"), ("vDegree", "2")];
    let project = draw("bspline", "BSplineSurfaceImpl", &numbers, &members);
    let mesh = mesh_of(&project, 0);
    let point = |u: f64, v: f64| {
        // Just inside, where the basis functions are defined.
        let (u, v) = ((2.0 * u).min(2.0 - 1e-12), (0.5 + 1.5 * v).min(2.0 - 1e-12));
        let mut sum = DVec3::ZERO;
        for j in 0..5 {
            for i in 0..6 {
                let weight = cox_de_boor(&u_knots, i, 3, u) * cox_de_boor(&v_knots, j, 2, v);
                sum += points[j * 6 + i] * weight;
            }
        }
        sum
    };
    // The double knot at v = 1/3 is a kink.
    assert_on_surface(mesh, point, |_, v| (v - 1.0 / 3.0).abs() > 1e-3);
    assert_normals_in_front(mesh);
}

/// A quarter of a cylinder is a rational surface exactly; points are stored multiplied by their weight.
#[test]
fn rational_surfaces_make_circles() {
    let w = FRAC_1_SQRT_2;
    let row = |z: f64| [[2.0, 0.0, z, 1.0], [2.0 * w, 2.0 * w, z * w, w], [0.0, 2.0, z, 1.0]].concat();
    let numbers = [row(0.0), row(3.0)].concat();
    let members = [("dimension", "4"), ("uCount", "3"), ("rational", "true")];
    let project = draw("rational", "BezierSurface", &numbers, &members);
    let mesh = mesh_of(&project, 0);
    assert_normals_in_front(mesh);
    for vertex in 0..mesh.positions.len() {
        let at = mesh.position(vertex);
        assert!((at.truncate().length() - 2.0).abs() < 1e-6, "{at}");
        assert!(normal(mesh, vertex).distance(at.with_z(0.0) / 2.0) < 1e-4);
    }
    let expected = 0.5 * PI * 2.0 * 3.0;
    assert!(area(mesh) < expected && area(mesh) > 0.998 * expected, "{}", area(mesh));
    // Straight along z, so one row of cells.
    assert!(mesh.triangles.len() <= 40, "{}", mesh.triangles.len());
    let finer = read(
        "rational_finer",
        &node(1, &(surface("BezierSurface", &numbers, &members) + &data("flatness", 0.1))),
    );
    assert!(mesh_of(&finer, 0).triangles.len() > 2 * mesh.triangles.len());
}

/// A torus of control points, periodic in both directions: closed without a seam.
#[test]
fn periodic_surfaces_are_closed() {
    let (n, m) = (7, 5);
    let points: Vec<_> = (0..n * m)
        .map(|i| {
            let (a, b) = (TAU * (i % n) as f64 / n as f64, TAU * (i / n) as f64 / m as f64);
            let r = 3.0 + b.cos();
            DVec3::new(r * a.cos(), r * a.sin(), b.sin())
        })
        .collect();
    let knots = |count: usize, degree: usize| -> Vec<f64> {
        (0..count + 2 * degree + 1).map(|i| i as f64 * 0.1).collect()
    };
    let numbers = [flat(&points), knots(n, 3), knots(m, 2)].concat();
    let members = [
        ("dimension", "3"),
        ("uCount", "7"),
        ("uDegree", "3"),
        ("uPeriodic", "true"),
        ("vDegree", "2"),
        ("vPeriodic", "true"),
    ];
    let project = draw("periodic", "BSplineSurfaceImpl", &numbers, &members);
    let mesh = mesh_of(&project, 0);
    assert_closed(mesh);
    let point = |u: f64, v: f64| {
        let (u_knots, v_knots) = (knots(n, 3), knots(m, 2));
        let u = u_knots[3] + (u_knots[n + 3] - u_knots[3]) * u.min(1.0 - 1e-9);
        let v = v_knots[2] + (v_knots[m + 2] - v_knots[2]) * v.min(1.0 - 1e-9);
        let mut sum = DVec3::ZERO;
        for j in 0..m + 2 {
            for i in 0..n + 3 {
                let weight = cox_de_boor(&u_knots, i, 3, u) * cox_de_boor(&v_knots, j, 2, v);
                sum += points[(j % m) * n + i % n] * weight;
            }
        }
        sum
    };
    assert_on_surface(mesh, point, |_, _| true);
}

/// An edge of control points at one place: a pole without triangles that have no area.
#[test]
fn surfaces_may_shrink_to_a_point() {
    let rows = [[0.0, 0.0, 1.0].repeat(3), vec![1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0]].concat();
    let project = draw("pole", "BezierSurface", &rows, &[("uCount", "3")]);
    let mesh = mesh_of(&project, 0);
    assert_normals_in_front(mesh);
    for triangle in mesh.triangles.iter() {
        let [a, b, c] = triangle.map(|vertex| mesh.position(vertex as usize));
        assert!((b - a).cross(c - a).length() > 1e-9);
    }
}

#[test]
fn shared_surfaces_are_found() {
    let shared = "<shared gx:name=\"surface\" gx:value=\"MetaGraph:#50\"/>";
    let numbers = text(&flat(&control_points(3, 2)));
    let nodes = node(1, shared)
        + &node(2, shared)
        + &node(3, &surface("BezierSurface", &flat(&control_points(3, 2)), &[("uCount", "3")]))
        + &format!(
            "<node id=\"50\" type=\"de.grogra.graph.impl.SharedObjectNode\"><ref gx:name=\"object\" \
             gx:value=\"51\"/><node id=\"51\" type=\"de.grogra.math.BezierSurface\" \
             edges=\"edge.sharedobject\"><array gx:name=\"data\" gx:value=\"{numbers}\"/><data gx:name=\"uCount\" \
             gx:value=\"3\"/></node></node>"
        );
    let project = read("shared_surface", &nodes);
    assert_eq!((project.scene.objects.len(), project.scene.meshes.len()), (3, 1), "{}", project.report);
}

#[test]
fn surfaces_that_make_no_sense_are_counted() {
    let good = control_points(4, 4);
    let knots = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let spline = |numbers: Vec<f64>, members: &[(&str, &str)]| {
        let all = [&[("dimension", "3"), ("uCount", "4")][..], members].concat();
        surface("BSplineSurfaceImpl", &numbers, &all)
    };
    let with = |u: &[f64], v: &[f64]| [flat(&good), u.to_vec(), v.to_vec()].concat();
    let mut falling = knots;
    falling[4] = -1.0;
    let mut endless = flat(&good);
    endless[5] = f64::INFINITY;
    let bezier = |numbers: &[f64], members: &[(&str, &str)]| surface("BezierSurface", numbers, members);
    let cases = [
        (spline(with(&knots, &knots[1..]), &[]), "make no rows of 4 points with their knots"),
        (spline(with(&falling, &knots), &[]), "knots do not ascend"),
        (spline(with(&[0.0; 8], &knots), &[]), "span no interval"),
        (spline(with(&knots, &knots), &[("uDegree", "0")]), ""),
        (spline(with(&knots, &knots), &[("uDegree", "99999999999999999")]), ""),
        (bezier(&flat(&good), &[("uCount", "4"), ("dimension", "4")]), "coordinates instead of 2 or 3"),
        (bezier(&endless, &[("uCount", "4")]), "not all finite"),
        (bezier(&flat(&good), &[("uCount", "18446744073709551615")]), "make no rows"),
        (bezier(&flat(&good), &[("uCount", "0")]), "make no rows"),
        (bezier(&[0.0; 300], &[("uCount", "50")]), "degree 49"),
        (bezier(&[0.0; 12], &[("uCount", "2"), ("dimension", "3")]), "no extent"),
        (
            bezier(
                &[1.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0],
                &[("uCount", "2"), ("rational", "true")],
            ),
            "weight",
        ),
        (bezier(&[], &[("uCount", "2")]), "make no rows"),
        (surface("SkinnedSurface", &[], &[]), "'SkinnedSurface' is not supported"),
        (surface("SweptSurface", &[], &[]), "'SweptSurface' is not supported"),
        ("<ref gx:name=\"surface\" gx:value=\"77777\"/>".to_owned(), "'77777' is not in the file"),
        ("<null gx:name=\"surface\"/>".to_owned(), "it has no surface"),
        (String::new(), "it has no surface"),
        ("<serialized gx:name=\"surface\" gx:value=\"AA\"/>".to_owned(), "a form that is not read"),
    ];
    let nodes: String = (1..).zip(&cases).map(|(id, (fields, _))| node(id, fields)).collect();
    let project = read("senseless", &nodes);
    assert!(project.scene.objects.is_empty());
    assert_eq!(project.report.skipped.iter().map(|s| s.count).sum::<usize>(), cases.len());
    for (_, expected) in &cases {
        let found = project.report.skipped.iter().any(|skipped| skipped.reason.contains(expected));
        assert!(found, "'{expected}' is missing in\n{}", project.report);
    }
    let path = file("no_numbers", "graph.xml", graph(&node(1, &bezier(&[], &[("uCount", "x")]))).as_bytes());
    assert!(groimp::read(&path).unwrap_err().to_string().contains("field 'uCount'"));
}

/// Changed bytes may be errors, reasons or another surface; only panics and endless work are wrong.
#[test]
fn damaged_surfaces_never_panic() {
    let points = control_points(4, 4);
    let knots = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let numbers = [flat(&points), knots.to_vec(), knots.to_vec()].concat();
    let members = [("dimension", "3"), ("uCount", "4"), ("uDegree", "3"), ("vPeriodic", "false")];
    let wild = |class: &str, fields: String| {
        format!("<node id=\"2\" type=\"de.grogra.imp3d.objects.{class}\" edges=\"+\">{fields}</node>\n")
    };
    let cases = [
        node(1, &surface("BSplineSurfaceImpl", &numbers, &members)),
        wild("Supershape", data("m1", 3.25) + &data("n12", 1.5) + &data("a", 2.5) + &data("m2", 4)),
        wild("SphereSegmentSolid", data("theta1", 0.25) + &data("theta2", 1.5) + &data("phi", 2.5)),
        wild("Lamella", data("width", 2.5) + &data("a", 1.5) + &data("b", -3.5)),
    ];
    // Enough to see the changes, and quick.
    let limits = groimp::Limits { surface_triangles: 2000, ..groimp::Limits::default() };
    let mut random = 1u32;
    for case in cases {
        let text = graph(&case);
        let start = text.find("<node id=\"1\"").or(text.find("<node id=\"2\"")).unwrap();
        for _ in 0..300 {
            let mut bytes = text.clone().into_bytes();
            // Numerical Recipes' quick generator.
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let at = start + (random >> 8) as usize % case.len();
            // Mostly what keeps numbers numbers.
            bytes[at] = b"0123456789.-eE \"x"[(random >> 4) as usize % 17];
            let _ = groimp::read_within(&file("damaged_surface", "graph.xml", &bytes), limits);
        }
    }
}
