//! Warps of uniform random numbers to directions, and the densities that belong to them.
//!
//! All densities are per solid angle in sr⁻¹.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use wgsl_rs::std::*;

    pub const PI: f32 = 3.14159265358979;
    pub const INVERSE_PI: f32 = 0.318309886183791;
    pub const TWO_PI: f32 = 6.28318530717959;

    /// A number in [0, 1) that is uniform again after it has chosen the interval of this length from `start` on.
    pub fn stretched(u: f32, start: f32, length: f32) -> f32 {
        clamp((u - start) / length, 0.0, 0.99999994)
    }

    /// Turns a direction given relative to +z into one relative to the unit vector `axis`.
    ///
    /// The two vectors perpendicular to the axis are those of Duff et al., "Building an Orthonormal Basis,
    /// Revisited" (JCGT 6(1), 2017).
    pub fn around_axis(axis: Vec3f, local: Vec3f) -> Vec3f {
        let sign = select(-1.0, 1.0, axis.z >= 0.0);
        let a = -1.0 / (sign + axis.z);
        let b = axis.x * axis.y * a;
        let x = vec3f(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
        let y = vec3f(b, sign + axis.y * axis.y * a, -axis.y);
        normalize(x * local.x + y * local.y + axis * local.z)
    }

    /// Cosine and sine of `u` turns, `u` in [0, 1], to 2e-7; the same on all devices, and in vector units.
    ///
    /// Between -1/8 and 1/8 of a turn by polynomials (the coefficients of Cephes' `sinf` and `cosf`); the other
    /// turns follow by quarters.
    pub fn on_circle(u: f32) -> Vec2f {
        let quarters = floor(4.0 * u + 0.5);
        let x = TWO_PI * (u - 0.25 * quarters);
        let xx = x * x;
        let sine = x + x * xx * (xx * (8.3321608736e-3 - xx * 1.9515295891e-4) - 1.6666654611e-1);
        let cosine = 1.0 - 0.5 * xx
            + xx * xx * (4.166664568298827e-2 + xx * (2.443315711809948e-5 * xx - 1.388731625493765e-3));
        let turned = u32(quarters);
        let swapped = (turned & 1u32) != 0u32;
        let along = select(cosine, sine, swapped);
        let across = select(sine, cosine, swapped);
        let opposite = ((turned + 1u32) & 2u32) != 0u32;
        let below = (turned & 2u32) != 0u32;
        vec2f(select(along, -along, opposite), select(across, -across, below))
    }

    /// A direction with polar angle acos(`cos_theta`) round +z.
    pub fn polar_direction(cos_theta: f32, u: f32) -> Vec3f {
        let sin_theta = sqrt(max(0.0, 1.0 - cos_theta * cos_theta));
        let turned = on_circle(u);
        vec3f(turned.x * sin_theta, turned.y * sin_theta, cos_theta)
    }

    /// A direction round +z with density cos/π.
    pub fn cosine_hemisphere(u: Vec2f) -> Vec3f {
        polar_direction(sqrt(1.0 - u.x), u.y)
    }

    /// Density of `cosine_hemisphere`.
    pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
        max(cos_theta, 0.0) * INVERSE_PI
    }

    /// A direction round +z with density (n + 1)/(2π) cosⁿ.
    pub fn power_cosine(u: Vec2f, exponent: f32) -> Vec3f {
        polar_direction(pow(1.0 - u.x, 1.0 / (exponent + 1.0)), u.y)
    }

    /// Density of `power_cosine`.
    pub fn power_cosine_pdf(cos_theta: f32, exponent: f32) -> f32 {
        if cos_theta <= 0.0 {
            return 0.0;
        }
        (exponent + 1.0) / TWO_PI * pow(cos_theta, exponent)
    }

    /// Weight of a sample drawn with density `pdf` when another strategy could have drawn it with density
    /// `other` (power heuristic with exponent 2, Veach 1997).
    pub fn power_heuristic(pdf: f32, other: f32) -> f32 {
        // The ratio form cannot overflow.
        if pdf <= 0.0 {
            return 0.0;
        }
        let ratio = other / pdf;
        1.0 / (1.0 + ratio * ratio)
    }

    /// Luminance of a linear Rec. 709 colour.
    pub fn luminance(color: Vec3f) -> f32 {
        dot(color, vec3f(0.2126, 0.7152, 0.0722))
    }

    /// The smallest of the three channels.
    pub fn smallest(color: Vec3f) -> f32 {
        min(color.x, min(color.y, color.z))
    }

    /// The largest of the three channels.
    pub fn largest(color: Vec3f) -> f32 {
        max(color.x, max(color.y, color.z))
    }
}

#[cfg(test)]
mod tests {
    use super::kernel::*;
    use crate::random::kernel::{independent_key, random4};
    use wgsl_rs::std::*;

    #[test]
    fn points_on_the_circle_are_cosine_and_sine() {
        for i in 0..=100_000 {
            let u = i as f32 / 100_000.0;
            let angle = std::f64::consts::TAU * f64::from(u);
            let point = on_circle(u);
            assert!((f64::from(point.x) - angle.cos()).abs() < 2e-7, "cosine of {u} turns");
            assert!((f64::from(point.y) - angle.sin()).abs() < 2e-7, "sine of {u} turns");
        }
    }

    /// Chi-square test of a warp round +z against its density, over rings of equal polar angle.
    fn chi_square(warp: impl Fn(Vec2f) -> Vec3f, pdf: impl Fn(f32) -> f64) {
        const BINS: usize = 32;
        let n = 100_000u32;
        let mut counts = [0f64; BINS];
        for i in 0..n {
            let r = random4(independent_key(i, 1, 3), 0);
            let d = warp(vec2f(r.x, r.y));
            assert!((length(d) - 1.0).abs() < 1e-5);
            let cell = ((1.0 - d.z.min(1.0)) * BINS as f32).min(BINS as f32 - 1.0);
            counts[cell as usize] += 1.0;
        }
        let mut chi2 = 0.0f64;
        let mut used = 0.0f64;
        for (k, count) in counts.iter().enumerate() {
            // Integral of 2 pi pdf over the ring by the midpoint rule in the cosine.
            let steps = 1000;
            let probability: f64 = (0..steps)
                .map(|j| 1.0 - (k as f64 + (f64::from(j) + 0.5) / f64::from(steps)) / BINS as f64)
                .map(|c| pdf(c as f32) * std::f64::consts::TAU / BINS as f64 / f64::from(steps))
                .sum();
            let expected = probability * f64::from(n);
            if expected > 5.0 {
                chi2 += (count - expected).powi(2) / expected;
                used += 1.0;
            }
        }
        // Five standard deviations of a chi-square with `used` degrees of freedom.
        assert!(chi2 < used + 5.0 * (2.0 * used).sqrt(), "chi2 {chi2} of {used} cells");
    }

    #[test]
    fn samples_follow_their_densities() {
        chi_square(cosine_hemisphere, |c| f64::from(cosine_hemisphere_pdf(c)));
        chi_square(|u| power_cosine(u, 4.0), |c| f64::from(power_cosine_pdf(c, 4.0)));
        chi_square(|u| power_cosine(u, 50.0), |c| f64::from(power_cosine_pdf(c, 50.0)));
    }

    #[test]
    fn rotating_to_an_axis_keeps_the_angle() {
        for i in 0..1000 {
            let r = random4(independent_key(i, 0, 1), 0);
            let axis = polar_direction(2.0 * r.x - 1.0, r.y);
            let local = cosine_hemisphere(vec2f(r.z, r.w));
            let world = around_axis(axis, local);
            assert!((length(world) - 1.0).abs() < 1e-5);
            assert!((dot(world, axis) - local.z).abs() < 1e-5, "{axis:?}");
        }
    }

    #[test]
    fn heuristic_weights_add_up() {
        assert!((power_heuristic(0.3, 2.0) + power_heuristic(2.0, 0.3) - 1.0).abs() < 1e-6);
        assert_eq!(power_heuristic(1.0, 0.0), 1.0);
    }
}
