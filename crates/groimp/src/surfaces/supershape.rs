//! Supershapes (Gielis 2003): spheres whose radius follows the superformula in both angles (scene-format.md 4.5).

use super::grid::Surface;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Kinks of a superformula that get a grid line of their own; with more the cells decide alone.
const MOST_KINKS: f64 = 256.0;

/// `r(t) = (|cos(m t / 4) / a|^n2 + |sin(m t / 4) / b|^n3)^(-1 / n1)`
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Superformula {
    pub a: f64,
    pub b: f64,
    pub m: f64,
    pub n1: f64,
    pub n2: f64,
    pub n3: f64,
}

impl Superformula {
    /// The radius at an angle, and its derivative.
    fn radius(&self, angle: f64) -> (f64, f64) {
        let (sin, cos) = (0.25 * self.m * angle).sin_cos();
        let (x, y) = ((cos / self.a).abs(), (sin / self.b).abs());
        let sum = x.powf(self.n2) + y.powf(self.n3);
        // d|x|/dt = |x| x' / x
        let dx = -0.25 * self.m * sin / self.a * (cos / self.a).signum();
        let dy = 0.25 * self.m * cos / self.b * (sin / self.b).signum();
        // Where nothing changes, an infinite power must not make it NaN.
        let term = |base: f64, exponent: f64, change: f64| {
            if change == 0.0 { 0.0 } else { exponent * base.powf(exponent - 1.0) * change }
        };
        let slope = term(x, self.n2, dx) + term(y, self.n3, dy);
        let radius = sum.powf(-1.0 / self.n1);
        (radius, -radius * slope / (self.n1 * sum))
    }

    /// Angles in an interval round 0 where cosine or sine change their signs, as parts of the interval.
    fn breaks(&self, half: f64) -> Vec<f64> {
        let mut breaks = vec![0.0];
        let distance = 2.0 * PI / self.m.abs();
        let most = (half / distance).floor();
        if (1.0..=0.5 * MOST_KINKS).contains(&most) || most == 0.0 {
            let most = most as i64;
            let inside = (-most..=most).map(|kink| 0.5 + 0.5 * kink as f64 * distance / half);
            // A kink at the very end is that end.
            breaks.extend(inside.filter(|part| (1e-9..1.0 - 1e-9).contains(part)));
        }
        breaks.push(1.0);
        breaks
    }
}

/// `theta` gives the outline seen from above, `phi` the one seen from the side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Supershape {
    pub theta: Superformula,
    pub phi: Superformula,
}

impl Supershape {
    /// Sine and cosine of theta; the ends of the range are the same place.
    fn theta(s: f64) -> (f64, f64, f64) {
        let angle = if s <= 0.0 || s >= 1.0 { PI } else { (2.0 * s - 1.0) * PI };
        let (sin, cos) = if angle == PI { (0.0, -1.0) } else { angle.sin_cos() };
        (angle, sin, cos)
    }

    /// Sine and cosine of phi; at the poles the cosine is nothing but 0.
    fn phi(t: f64) -> (f64, f64, f64) {
        match t {
            ..=0.0 => (-FRAC_PI_2, -1.0, 0.0),
            1.0.. => (FRAC_PI_2, 1.0, 0.0),
            _ => {
                let angle = (t - 0.5) * PI;
                let (sin, cos) = angle.sin_cos();
                (angle, sin, cos)
            }
        }
    }
}

impl Surface for Supershape {
    fn point(&self, s: f64, t: f64) -> DVec3 {
        let ((theta, sin_theta, cos_theta), (phi, sin_phi, cos_phi)) = (Self::theta(s), Self::phi(t));
        let (outline, _) = self.theta.radius(theta);
        let (profile, _) = self.phi.radius(phi);
        let across = outline * profile * cos_phi;
        DVec3::new(across * cos_theta, across * sin_theta, profile * sin_phi)
    }

    fn tangents(&self, s: f64, t: f64) -> [DVec3; 2] {
        let (theta, phi) = ((2.0 * s - 1.0) * PI, (t - 0.5) * PI);
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
        let ((r1, d1), (r2, d2)) = (self.theta.radius(theta), self.phi.radius(phi));
        let by_theta = DVec3::new(d1 * cos_theta - r1 * sin_theta, d1 * sin_theta + r1 * cos_theta, 0.0)
            * (r2 * cos_phi);
        let outward = d2 * cos_phi - r2 * sin_phi;
        let by_phi =
            DVec3::new(r1 * cos_theta * outward, r1 * sin_theta * outward, d2 * sin_phi + r2 * cos_phi);
        [by_theta * (2.0 * PI), by_phi * PI]
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.theta.breaks(PI), self.phi.breaks(FRAC_PI_2)]
    }

    fn least_cells(&self) -> [usize; 2] {
        // Without any break a piece is the whole circle.
        [4, 2]
    }
}
