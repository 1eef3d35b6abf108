//! The solid `SphereSegmentSolid`, a wedge of a sphere.

use super::grid::{MeshBuilder, narrowed};
use glam::DVec3;
use scene::Mesh;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Edges round a full circle or along half of one at most.
const MOST_EDGES: f64 = 4096.0;

/// All points of a sphere whose angle to +z is between `theta1` and `theta2` and whose azimuth, counted from +x
/// to +y, is between 0 and `phi`; angles in radians.
///
/// This reading of the fields is unverified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SphereSegment {
    radius: f64,
    theta: [f64; 2],
    /// In (0, 2 pi].
    phi: f64,
    /// Azimuth of the first side.
    start: f64,
}

impl SphereSegment {
    /// `None` if nothing is left of the sphere. The angles may come in any order; a negative `phi` turns the
    /// other way round.
    pub fn new(radius: f64, theta1: f64, theta2: f64, phi: f64) -> Option<Self> {
        if ![radius, theta1, theta2, phi].iter().all(|number| number.is_finite()) {
            return None;
        }
        let theta = [theta1.min(theta2), theta1.max(theta2)].map(|theta| theta.clamp(0.0, PI));
        let phi = phi.clamp(-TAU, TAU);
        // Single precision stores 2 pi a little too small or too large.
        let whole = phi.abs() > TAU - 1e-6;
        let start = if whole { 0.0 } else { phi.min(0.0) };
        let phi = if whole { TAU } else { phi.abs() };
        let theta =
            [if theta[0] < 1e-6 { 0.0 } else { theta[0] }, if theta[1] > PI - 1e-6 { PI } else { theta[1] }];
        let radius = radius.abs();
        (radius > 0.0 && phi > 1e-9 && theta[1] - theta[0] > 1e-9).then_some(SphereSegment {
            radius,
            theta,
            phi,
            start,
        })
    }

    /// Diagonal of the box round the whole sphere.
    pub fn diagonal(&self) -> f64 {
        2.0 * 3f64.sqrt() * self.radius
    }

    fn is_whole(&self) -> bool {
        self.phi == TAU
    }

    /// Unit vector of a grid point; the same at both ends of a full circle, and for all azimuths at the poles.
    fn direction(&self, azimuth: f64, theta: f64) -> DVec3 {
        let (sin, cos) = match theta {
            ..=0.0 => (0.0, 1.0),
            PI.. => (0.0, -1.0),
            _ => theta.sin_cos(),
        };
        let azimuth = if self.is_whole() && azimuth >= 1.0 { 0.0 } else { azimuth };
        let (y, x) = (self.start + self.phi * azimuth).sin_cos();
        DVec3::new(sin * x, sin * y, cos)
    }

    /// The triangles, at most `tolerance` metres away from the solid. `most` bounds their number; the flag tells
    /// whether it made them coarser.
    pub fn mesh(&self, tolerance: f64, most: usize) -> Result<(Mesh, bool), String> {
        // An edge over the angle 2 x is radius * (1 - cos x) away from its arc. A cell has the errors of both
        // directions.
        let angle = 2.0 * (1.0 - (0.5 * tolerance / self.radius).min(1.0)).acos();
        let [low, high] = self.theta;
        let edges = |range: f64| (range / angle).ceil().clamp(1.0, MOST_EDGES) as usize;
        // Not fewer than show that it is round.
        let mut columns = edges(self.phi).max((8.0 * self.phi / TAU).ceil() as usize);
        let mut rows = edges(high - low).max(((high - low) * 4.0 / PI).ceil() as usize);
        let mut coarser = angle * MOST_EDGES < TAU;
        while (columns * (rows + 1) * 2 + rows * 2) > most && columns * rows > 1 {
            (columns, rows, coarser) = (columns.div_ceil(2), rows.div_ceil(2), true);
        }
        let columns = columns.max(if self.is_whole() { 3 } else { 1 });
        let azimuth = |i: usize| i as f64 / columns as f64;
        let theta = |j: usize| if j == rows { high } else { low + (high - low) * (j as f64 / rows as f64) };
        let place = |i: usize, j: usize| narrowed(self.direction(azimuth(i), theta(j)) * self.radius);

        let mut mesh = MeshBuilder::default();
        for j in 0..=rows {
            for i in 0..=columns {
                let uv = [(self.start + self.phi * azimuth(i)) / TAU, 1.0 - theta(j) / PI];
                mesh.vertex(place(i, j)?, self.direction(azimuth(i), theta(j)), uv);
            }
        }
        let vertex = |i: usize, j: usize| j * (columns + 1) + i;
        for j in 0..rows {
            for i in 0..columns {
                // Rows go down, so that this is counter-clockwise from outside.
                mesh.quad([vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)]);
            }
        }
        for (j, up) in [(0, true), (rows, false)] {
            let theta = theta(j);
            if theta > 0.0 && theta < PI {
                self.cone(&mut mesh, theta, up, columns, |i| place(i, j), azimuth)?;
            }
        }
        if !self.is_whole() {
            for (i, last) in [(0, false), (columns, true)] {
                self.side(&mut mesh, azimuth(i), last, rows, |j| place(i, j))?;
            }
        }
        Ok((mesh.finish(), coarser))
    }

    /// The surface between the centre and a circle of the sphere; `up` if the solid is below it.
    fn cone(
        &self,
        mesh: &mut MeshBuilder,
        theta: f64,
        up: bool,
        columns: usize,
        place: impl Fn(usize) -> Result<[f32; 3], String>,
        azimuth: impl Fn(usize) -> f64,
    ) -> Result<(), String> {
        let sign = if up { 1.0 } else { -1.0 };
        // Perpendicular to the lines of the cone: their direction a right angle further up.
        let normal = |azimuth: f64| {
            let flat = theta - FRAC_PI_2;
            let (y, x) = (self.start + self.phi * azimuth).sin_cos();
            DVec3::new(flat.sin() * x, flat.sin() * y, flat.cos()) * sign
        };
        for i in 0..columns {
            let uv = |at: [f32; 3]| {
                let [x, y] = [at[0], at[1]].map(|c| f64::from(c) / self.radius);
                [0.5 * (x + 1.0), 0.5 * (1.0 + sign * y)]
            };
            let (a, b) = (place(i)?, place(i + 1)?);
            let middle = 0.5 * (azimuth(i) + azimuth(i + 1));
            let centre = mesh.vertex([0.0; 3], normal(middle), [0.5, 0.5]);
            let a = mesh.vertex(a, normal(azimuth(i)), uv(a));
            let b = mesh.vertex(b, normal(azimuth(i + 1)), uv(b));
            mesh.triangle(if up { [centre, a, b] } else { [centre, b, a] });
        }
        Ok(())
    }

    /// The flat side at one azimuth; `last` if the solid lies before it.
    fn side(
        &self,
        mesh: &mut MeshBuilder,
        azimuth: f64,
        last: bool,
        rows: usize,
        place: impl Fn(usize) -> Result<[f32; 3], String>,
    ) -> Result<(), String> {
        let (sin, cos) = (self.start + self.phi * azimuth).sin_cos();
        let normal = DVec3::new(-sin, cos, 0.0) * if last { 1.0 } else { -1.0 };
        let uv = |at: [f32; 3]| {
            let [x, y, z] = at.map(|c| f64::from(c) / self.radius);
            [x.hypot(y), 0.5 * (1.0 + z)]
        };
        let centre = mesh.vertex([0.0; 3], normal, [0.0, 0.5]);
        let rim = (0..=rows)
            .map(|j| place(j).map(|at| mesh.vertex(at, normal, uv(at))))
            .collect::<Result<Vec<_>, _>>()?;
        for pair in rim.windows(2) {
            // From +z to +x is counter-clockwise seen from +y.
            mesh.triangle(if last { [centre, pair[0], pair[1]] } else { [centre, pair[1], pair[0]] });
        }
        Ok(())
    }
}
