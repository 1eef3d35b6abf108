//! The class `Polygon`: a fan round the centre of its corners (scene-format.md 4.4).

use super::grid::{MeshBuilder, narrowed};
use glam::DVec3;
use scene::Mesh;
use std::f64::consts::TAU;

/// Relative to the size of the polygon: if its ends are nearer, it is closed in the file and the last corner is
/// the first one again.
const SAME: f64 = 1e-5;

/// The triangles of a polygon with these corners.
pub(super) fn polygon(corners: &[DVec3]) -> Result<Mesh, String> {
    if !corners.iter().all(|corner| corner.is_finite()) {
        return Err("it has points that are not finite".to_owned());
    }
    let size = corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
    let corners = match corners {
        [first, inner @ .., last] if first.distance(*last) <= SAME * size => &corners[..inner.len() + 1],
        all => all,
    };
    let count = corners.len();
    if count < 3 {
        return Err(format!("it has {count} corners, which span no surface"));
    }
    let mut mesh = MeshBuilder::default();
    if let [a, b, c] = *corners {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        for (corner, uv) in corners.iter().zip(uvs) {
            mesh.vertex(narrowed(*corner)?, normal, uv);
        }
        mesh.triangle([0, 1, 2]);
    } else {
        let centre = corners.iter().sum::<DVec3>() / count as f64;
        // Twice the area of a triangle as its length: the average counts large ones more.
        let flat = |k: usize| (corners[(k + 1) % count] - corners[k]).cross(centre - corners[k]);
        for (k, corner) in corners.iter().enumerate() {
            let normal = flat(k) + flat((k + count - 1) % count);
            let (sin, cos) = (TAU * k as f64 / count as f64).sin_cos();
            let uv = [0.5 * (cos + 1.0), 0.5 * (sin + 1.0)];
            mesh.vertex(narrowed(*corner)?, normal.normalize_or_zero(), uv);
        }
        let normal = (0..count).map(flat).sum::<DVec3>().normalize_or_zero();
        let centre = mesh.vertex(narrowed(centre)?, normal, [0.5, 0.5]);
        for k in 0..count {
            mesh.triangle([k, (k + 1) % count, centre]);
        }
    }
    if mesh.triangles.is_empty() { Err("it has no extent".to_owned()) } else { Ok(mesh.finish()) }
}
