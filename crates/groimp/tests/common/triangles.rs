//! Measures of triangle meshes, to compare with closed forms.

use groimp::Project;
use scene::{DVec3, Mesh, Shape};
use std::collections::HashMap;

/// The mesh of an object.
pub fn mesh_of(project: &Project, object: usize) -> &Mesh {
    match &project.scene.objects.get(object).unwrap_or_else(|| panic!("{}", project.report)).shape {
        Shape::Mesh { mesh, .. } => &project.scene.meshes[mesh.index()],
        other => panic!("{other:?}"),
    }
}

pub fn normal(mesh: &Mesh, vertex: usize) -> DVec3 {
    DVec3::from_array(mesh.normals[vertex].map(f64::from))
}

pub fn uv(mesh: &Mesh, vertex: usize) -> [f64; 2] {
    mesh.uvs[vertex].map(f64::from)
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [DVec3; 3]> {
    mesh.triangles.iter().map(|triangle| triangle.map(|vertex| mesh.position(vertex as usize)))
}

pub fn area(mesh: &Mesh) -> f64 {
    corners(mesh).map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
}

/// Volume inside a closed mesh, positive if its front is outside.
pub fn volume(mesh: &Mesh) -> f64 {
    corners(mesh).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Every edge, given by its positions bit for bit, is passed once in each direction; the normals point to the
/// front.
pub fn assert_closed(mesh: &Mesh) {
    let mut edges = HashMap::<_, i32>::new();
    for triangle in mesh.triangles.iter() {
        let place = |i: usize| mesh.positions[triangle[i % 3] as usize].map(f32::to_bits);
        for i in 0..3 {
            assert_ne!(place(i), place(i + 1), "two corners of a triangle at one place");
            *edges.entry((place(i), place(i + 1))).or_default() += 1;
        }
    }
    for ((from, to), count) in &edges {
        assert_eq!((*count, edges.get(&(*to, *from))), (1, Some(&1)), "an edge is open");
    }
    assert!(volume(mesh) > 0.0, "the front is inside");
    assert_normals_in_front(mesh);
}

/// The normals of all corners are unit vectors on the front side of their triangles.
pub fn assert_normals_in_front(mesh: &Mesh) {
    assert_eq!((mesh.normals.len(), mesh.uvs.len()), (mesh.positions.len(), mesh.positions.len()));
    for triangle in mesh.triangles.iter() {
        let [a, b, c] = triangle.map(|vertex| mesh.position(vertex as usize));
        let front = (b - a).cross(c - a).normalize_or_zero();
        for vertex in triangle {
            let normal = normal(mesh, *vertex as usize);
            assert!((normal.length() - 1.0).abs() < 1e-5, "{normal}");
            assert!(normal.dot(front) > -1e-3, "{normal} is behind {front} at {a}");
        }
    }
}

/// The vertices are those of a surface over the unit square, and the normals perpendicular to it. `smooth` tells
/// where differences can be taken.
pub fn assert_on_surface(mesh: &Mesh, point: impl Fn(f64, f64) -> DVec3, smooth: impl Fn(f64, f64) -> bool) {
    let size = (0..mesh.positions.len()).map(|i| mesh.position(i).length()).fold(0.0, f64::max);
    let mut compared = 0;
    for vertex in 0..mesh.positions.len() {
        let [u, v] = uv(mesh, vertex);
        let at = point(u, v);
        // Texture coordinates and positions have single precision.
        assert!(at.distance(mesh.position(vertex)) < 2e-5 * size, "{at} {}", mesh.position(vertex));
        const STEP: f64 = 1e-4;
        if !smooth(u, v) || !(STEP..1.0 - STEP).contains(&u) || !(STEP..1.0 - STEP).contains(&v) {
            continue;
        }
        for tangent in [point(u + STEP, v) - point(u - STEP, v), point(u, v + STEP) - point(u, v - STEP)] {
            let cosine = normal(mesh, vertex).dot(tangent.normalize());
            assert!(cosine.abs() < 1e-3, "{cosine} at {u} {v}");
        }
        compared += 1;
    }
    assert!(compared > 0, "no normal was compared");
}
