//! B-spline and Bezier surfaces, rational or not (Piegl and Tiller, "The NURBS Book", chapters 2 to 4).

use super::grid::Surface;
use glam::{DVec3, DVec4};

/// Highest degree in a direction; the cost of a point grows with its square.
pub(super) const HIGHEST_DEGREE: usize = 32;

/// One parameter direction.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Direction {
    degree: usize,
    knots: Vec<f64>,
    /// Control points that the file has; a periodic direction uses the first ones again at its end.
    stored: usize,
    /// Its ends meet, so that they have to be the same point to the last bit.
    closed: bool,
}

impl Direction {
    /// A direction with that many control points. `knots` are all that belong to it: control points (with those
    /// used again), plus degree, plus 1.
    pub fn new(stored: usize, degree: usize, periodic: bool, knots: Vec<f64>) -> Result<Self, String> {
        if degree == 0 || degree > HIGHEST_DEGREE {
            return Err(format!("its degree {degree} is not between 1 and {HIGHEST_DEGREE}"));
        }
        let used = stored + if periodic { degree } else { 0 };
        if used <= degree {
            return Err(format!("it has {stored} control points in a row, too few for degree {degree}"));
        }
        if knots.len() != used + degree + 1 {
            return Err(format!("it has {} knots instead of {}", knots.len(), used + degree + 1));
        }
        if !knots.iter().all(|knot| knot.is_finite()) || knots.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err("its knots do not ascend".to_owned());
        }
        let direction = Direction { degree, knots, stored, closed: periodic };
        let [first, last] = direction.domain();
        if last > first { Ok(direction) } else { Err("its knots span no interval".to_owned()) }
    }

    /// A Bezier direction: the degree is one less than the number of control points.
    pub fn bezier(control_points: usize) -> Result<Self, String> {
        let degree = control_points.saturating_sub(1);
        let knots = [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat();
        Direction::new(control_points, degree, false, knots)
    }

    /// Where all basis functions sum to 1.
    fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.knots.len() - 1 - self.degree]]
    }

    fn breaks(&self) -> Vec<f64> {
        let [first, last] = self.domain();
        let inside = self.knots[self.degree..self.knots.len() - self.degree].iter();
        let mut breaks: Vec<f64> = inside.map(|knot| (knot - first) / (last - first)).collect();
        breaks.dedup();
        breaks
    }

    /// First control point, and weights of it and the following ones, at a parameter of the unit interval; their
    /// derivatives by that parameter, too.
    fn basis(&self, at: f64) -> (usize, [f64; HIGHEST_DEGREE + 1], [f64; HIGHEST_DEGREE + 1]) {
        let [first, last] = self.domain();
        let at = if self.closed && at >= 1.0 { 0.0 } else { at };
        let knot = first + (last - first) * at;
        let p = self.degree;
        let end = self.knots.len() - 1 - p;
        // The span with knots[span] <= knot < knots[span + 1]; at the end of the domain the last one of any length.
        let span = self.knots[p..end].partition_point(|k| *k <= knot) + p;
        let mut span = span.clamp(p + 1, end) - 1;
        while span > p && self.knots[span] == self.knots[span + 1] {
            span -= 1;
        }
        let mut weights = [0.0; HIGHEST_DEGREE + 1];
        let mut lower = weights;
        weights[0] = 1.0;
        for degree in 1..=p {
            lower = weights;
            weights = [0.0; HIGHEST_DEGREE + 1];
            for i in 0..degree {
                // Basis function number span - degree + 1 + i of the next lower degree.
                let (low, high) = (self.knots[span + 1 + i - degree], self.knots[span + 1 + i]);
                let part = if high > low { lower[i] / (high - low) } else { 0.0 };
                weights[i] += (high - knot) * part;
                weights[i + 1] += (knot - low) * part;
            }
        }
        let mut slopes = [0.0; HIGHEST_DEGREE + 1];
        for i in 0..p {
            let (low, high) = (self.knots[span + 1 + i - p], self.knots[span + 1 + i]);
            let part = if high > low { p as f64 * lower[i] / (high - low) } else { 0.0 };
            slopes[i] -= part;
            slopes[i + 1] += part;
        }
        slopes.iter_mut().for_each(|slope| *slope *= last - first);
        (span - p, weights, slopes)
    }
}

/// A surface of control points (x, y, z, weight), the first three already multiplied by the weight.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BSplineSurface {
    u: Direction,
    v: Direction,
    /// Row by row, u fastest.
    points: Vec<DVec4>,
}

impl BSplineSurface {
    pub fn new(u: Direction, v: Direction, points: Vec<DVec4>) -> Result<Self, String> {
        if points.len() != u.stored * v.stored {
            return Err(format!("it has {} control points, not {} x {}", points.len(), u.stored, v.stored));
        }
        if !points.iter().all(|point| point.is_finite()) {
            return Err("its control points are not all finite".to_owned());
        }
        // Then no denominator vanishes between the control points.
        if !points.iter().all(|point| point.w > 0.0) {
            return Err("a weight of its control points is not positive".to_owned());
        }
        Ok(BSplineSurface { u, v, points })
    }

    /// Homogeneous point and its derivatives by both parameters.
    fn homogeneous(&self, s: f64, t: f64) -> [DVec4; 3] {
        let (first_u, weights_u, slopes_u) = self.u.basis(s);
        let (first_v, weights_v, slopes_v) = self.v.basis(t);
        let mut result = [DVec4::ZERO; 3];
        for j in 0..=self.v.degree {
            let row = (first_v + j) % self.v.stored * self.u.stored;
            let (mut point, mut slope) = (DVec4::ZERO, DVec4::ZERO);
            for i in 0..=self.u.degree {
                let control = self.points[row + (first_u + i) % self.u.stored];
                point += control * weights_u[i];
                slope += control * slopes_u[i];
            }
            result[0] += point * weights_v[j];
            result[1] += slope * weights_v[j];
            result[2] += point * slopes_v[j];
        }
        result
    }
}

impl Surface for BSplineSurface {
    fn point(&self, s: f64, t: f64) -> DVec3 {
        let [point, ..] = self.homogeneous(s, t);
        point.truncate() / point.w
    }

    fn tangents(&self, s: f64, t: f64) -> [DVec3; 2] {
        let [point, ds, dt] = self.homogeneous(s, t);
        let at = point.truncate() / point.w;
        [ds, dt].map(|slope| (slope.truncate() - at * slope.w) / point.w)
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.u.breaks(), self.v.breaks()]
    }

    fn least_cells(&self) -> [usize; 2] {
        // A polynomial of degree p has p - 1 bends at most.
        [&self.u, &self.v].map(|direction| direction.degree.saturating_sub(1).max(1))
    }
}
