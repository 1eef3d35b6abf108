//! Grids of points: the class `Patch` (scene-format.md 4.3).

use super::grid::{MeshBuilder, narrowed};
use glam::DVec3;
use scene::Mesh;

/// Points in rows; a point that the file gives no z has 0.
pub(super) struct VertexGrid {
    pub u_count: usize,
    pub v_count: usize,
    /// Row by row, u fastest.
    pub points: Vec<DVec3>,
}

/// Picture and mapping of an `ImageHeightField`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeightField {
    pub x_width: f64,
    pub y_width: f64,
    pub scale: f64,
    pub zero_level: f64,
    /// What is not above the zero level is level.
    pub water: bool,
}

/// Grey values of a picture: 0 to 255, or 0 to 65535 if it has 16 bits.
pub(crate) struct Heights {
    pub width: usize,
    pub height: usize,
    /// Row by row from the top.
    pub samples: Vec<u16>,
}

impl HeightField {
    /// The grid over a picture whose bottom row comes first. Where the picture has more samples than triangles
    /// are allowed, evenly spaced ones are used; the flag tells so.
    pub fn grid(&self, heights: &Heights, most_triangles: usize) -> Result<(VertexGrid, bool), String> {
        let (nu, nv) = (heights.width, heights.height);
        if nu < 2 || nv < 2 {
            return Err(format!("its picture has {nu} x {nv} pixels, which span no surface"));
        }
        let mut step = 1;
        while (nu - 1).div_ceil(step) * (nv - 1).div_ceil(step) * 2 > most_triangles {
            step += 1;
        }
        let picked = |count: usize| {
            let mut picked: Vec<usize> = (0..count).step_by(step).collect();
            // The rim stays where it is.
            if picked.last() != Some(&(count - 1)) {
                picked.push(count - 1);
            }
            picked
        };
        let (columns, rows) = (picked(nu), picked(nv));
        let mut points = Vec::with_capacity(columns.len() * rows.len());
        for &j in &rows {
            for &i in &columns {
                let sample = f64::from(heights.samples[(nv - 1 - j) * nu + i]);
                let level = self.water && sample <= self.zero_level;
                points.push(DVec3::new(
                    i as f64 * self.x_width / (nu - 1) as f64,
                    j as f64 * self.y_width / (nv - 1) as f64,
                    if level { 0.0 } else { (sample - self.zero_level) * self.scale },
                ));
            }
        }
        Ok((VertexGrid { u_count: columns.len(), v_count: rows.len(), points }, step > 1))
    }
}

impl VertexGrid {
    /// The quadrilaterals between the points. Normals are those of the smooth surface through the points, with
    /// differences of neighbours as tangents.
    pub fn mesh(&self) -> Result<Mesh, String> {
        let (nu, nv) = (self.u_count, self.v_count);
        if nu < 2 || nv < 2 {
            return Err(format!("its grid has {nu} x {nv} points, which span no surface"));
        }
        let at = |i: usize, j: usize| self.points[j * nu + i];
        let mut mesh = MeshBuilder::default();
        for j in 0..nv {
            for i in 0..nu {
                let du = at((i + 1).min(nu - 1), j) - at(i.saturating_sub(1), j);
                let dv = at(i, (j + 1).min(nv - 1)) - at(i, j.saturating_sub(1));
                let uv = [i as f64 / (nu - 1) as f64, j as f64 / (nv - 1) as f64];
                mesh.vertex(narrowed(at(i, j))?, du.cross(dv).normalize_or_zero(), uv);
            }
        }
        for j in 0..nv - 1 {
            for i in 0..nu - 1 {
                let corner = j * nu + i;
                mesh.quad([corner, corner + 1, corner + nu + 1, corner + nu]);
            }
        }
        if mesh.triangles.is_empty() { Err("it has no extent".to_owned()) } else { Ok(mesh.finish()) }
    }
}
