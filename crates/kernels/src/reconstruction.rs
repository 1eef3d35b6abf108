//! Reconstruction filters by importance sampling: where around the middle of its pixel a sample is taken.
//!
//! Ernst, Stamminger and Greiner, "Filter Importance Sampling" (IEEE Symposium on Interactive Ray Tracing, 2006):
//! the position is drawn with the filter as density. As no filter here is negative, all samples have the same weight
//! and every pixel is rendered by itself. All filters are products of one function of x and y each.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use wgsl_rs::std::*;

    /// Constant within the pixel: radius 0.5 pixels.
    pub const FILTER_BOX: u32 = 0;
    /// Falls linearly to 0: radius 1 pixel.
    pub const FILTER_TENT: u32 = 1;
    /// Normal distribution with standard deviation `GAUSSIAN_SIGMA`, cut off at a radius of 1.5 pixels.
    pub const FILTER_GAUSSIAN: u32 = 2;
    /// The four-term window of Harris 1978 with a radius of 1.5 pixels.
    pub const FILTER_BLACKMAN_HARRIS: u32 = 3;

    /// In pixels.
    pub const GAUSSIAN_SIGMA: f32 = 0.5;
    /// Share of the normal distribution within three standard deviations, where it is cut off.
    pub const GAUSSIAN_SHARE: f32 = 0.9973002;
    /// In pixels.
    pub const BLACKMAN_HARRIS_RADIUS: f32 = 1.5;

    /// Inverse of the error function for arguments in (-1, 1); Giles, "Approximating the erfinv Function" (GPU
    /// Computing Gems, 2011).
    pub fn inverse_erf(y: f32) -> f32 {
        let w = -log((1.0 - y) * (1.0 + y));
        if w < 5.0 {
            let t = w - 2.5;
            let mut p: f32 = 0.0000000281022636;
            p = 0.000000343273939 + p * t;
            p = -0.0000035233877 + p * t;
            p = -0.00000439150654 + p * t;
            p = 0.00021858087 + p * t;
            p = -0.00125372503 + p * t;
            p = -0.00417768164 + p * t;
            p = 0.246640727 + p * t;
            return (1.50140941 + p * t) * y;
        }
        let t = sqrt(w) - 3.0;
        let mut p: f32 = -0.000200214257;
        p = 0.000100950558 + p * t;
        p = 0.00134934322 + p * t;
        p = -0.00367342844 + p * t;
        p = 0.00573950773 + p * t;
        p = -0.0076224613 + p * t;
        p = 0.00943887047 + p * t;
        p = 1.00167406 + p * t;
        (2.83297682 + p * t) * y
    }

    /// Density of the Blackman-Harris window over [-1, 1].
    pub fn blackman_harris_pdf(x: f32) -> f32 {
        let angle = 3.14159265358979 * x;
        0.5 + (0.48829 * cos(angle) + 0.14128 * cos(2.0 * angle) + 0.01168 * cos(3.0 * angle)) / 0.7175
    }

    /// Share of the Blackman-Harris window left of `x` in [-1, 1].
    pub fn blackman_harris_cdf(x: f32) -> f32 {
        let angle = 3.14159265358979 * x;
        let waves = 0.48829 * sin(angle) + 0.07064 * sin(2.0 * angle) + 0.00389333 * sin(3.0 * angle);
        0.5 + 0.5 * x + waves / (3.14159265358979 * 0.7175)
    }

    /// The place left of which lies the share `u` of the Blackman-Harris window: Newton's method, kept within an
    /// interval that is halved wherever a step would leave it.
    pub fn inverse_blackman_harris(u: f32) -> f32 {
        let mut low: f32 = -1.0;
        let mut high: f32 = 1.0;
        // The normal distribution with the same variance is never far.
        let mut x = clamp(0.3917 * inverse_erf((2.0 * u - 1.0) * 0.9999), -0.95, 0.95);
        for _step in 0..8 {
            let error = blackman_harris_cdf(x) - u;
            if error > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let next = x - error / max(blackman_harris_pdf(x), 0.0001);
            x = select(0.5 * (low + high), next, next >= low && next <= high);
        }
        x
    }

    /// Distance from the middle of the pixel along one axis, in pixels, drawn with the filter as density.
    pub fn filter_offset(kind: u32, u: f32) -> f32 {
        if kind == FILTER_TENT {
            if u < 0.5 {
                return sqrt(2.0 * u) - 1.0;
            }
            return 1.0 - sqrt(2.0 - 2.0 * u);
        }
        if kind == FILTER_GAUSSIAN {
            return 1.41421356 * GAUSSIAN_SIGMA * inverse_erf((2.0 * u - 1.0) * GAUSSIAN_SHARE);
        }
        if kind == FILTER_BLACKMAN_HARRIS {
            return BLACKMAN_HARRIS_RADIUS * inverse_blackman_harris(u);
        }
        u - 0.5
    }

    /// Where a sample is taken, in pixels from the top left corner of its pixel; `u` uniform in the unit square.
    pub fn filter_position(kind: u32, u: Vec2f) -> Vec2f {
        // Not by way of the middle, so that a box does not round.
        if kind == FILTER_BOX {
            return u;
        }
        vec2f(0.5 + filter_offset(kind, u.x), 0.5 + filter_offset(kind, u.y))
    }
}

#[cfg(test)]
mod tests {
    use super::kernel::*;
    use std::f64::consts::PI;

    /// Density of a filter at a distance from the middle, written independently of the kernels; radius.
    type Profile = (u32, fn(f64) -> f64, f64);

    const PROFILES: [Profile; 4] = [
        (FILTER_BOX, |_| 1.0, 0.5),
        (FILTER_TENT, |x| 1.0 - x.abs(), 1.0),
        (FILTER_GAUSSIAN, |x| (-2.0 * x * x).exp() / ((0.5 * PI).sqrt() * 0.997_300_203_9), 1.5),
        (
            FILTER_BLACKMAN_HARRIS,
            |x| {
                let phase = PI * (x / 1.5 + 1.0);
                let window = 0.35875 - 0.48829 * phase.cos() + 0.14128 * (2.0 * phase).cos()
                    - 0.01168 * (3.0 * phase).cos();
                window / (2.0 * 1.5 * 0.35875)
            },
            1.5,
        ),
    ];

    /// Integral of `f` over [a, b] by the midpoint rule.
    fn integral(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
        let n = 20_000;
        let h = (b - a) / f64::from(n);
        (0..n).map(|i| f(a + (f64::from(i) + 0.5) * h)).sum::<f64>() * h
    }

    #[test]
    fn the_share_left_of_an_offset_is_its_random_number() {
        // The closed inverse against numerical integration: no statistics.
        for (kind, density, radius) in PROFILES {
            assert!((integral(density, -radius, radius) - 1.0).abs() < 1e-6, "{kind}");
            for i in 0..=200u32 {
                let u = f64::from(i) / 200.0 * (1.0 - 1e-7);
                let x = f64::from(filter_offset(kind, u as f32));
                assert!(x.abs() <= radius * (1.0 + 1e-4), "filter {kind} at {u}: {x}");
                let share = integral(density, -radius, x);
                assert!((share - u).abs() < 3e-6, "filter {kind} at {u}: {x} has {share}");
            }
        }
    }

    #[test]
    fn moments_and_histograms_follow_the_density() {
        let n = 100_000u32;
        for (kind, density, radius) in PROFILES {
            // Stratified numbers: each half-open cell once.
            let offsets: Vec<f64> =
                (0..n).map(|i| f64::from(filter_offset(kind, (i as f32 + 0.5) / n as f32))).collect();
            let mean = offsets.iter().sum::<f64>() / f64::from(n);
            let variance = offsets.iter().map(|x| x * x).sum::<f64>() / f64::from(n);
            let expected = integral(|x| x * x * density(x), -radius, radius);
            assert!(mean.abs() < 1e-4, "filter {kind}: mean {mean}");
            assert!((variance - expected).abs() < 1e-4, "filter {kind}: {variance}, expected {expected}");
            let cells = 30;
            for cell in 0..cells {
                let edge = |i: i32| radius * (2.0 * f64::from(i) / f64::from(cells) - 1.0);
                let (a, b) = (edge(cell), edge(cell + 1));
                let share = offsets.iter().filter(|x| (a..b).contains(*x)).count() as f64 / f64::from(n);
                // A stratum may lie across each edge, and the upper tail is drawn in steps of 2^-24.
                assert!((share - integral(density, a, b)).abs() < 3.0 / f64::from(n) + 1e-5, "{kind} {cell}");
            }
        }
    }

    #[test]
    fn variances_are_those_of_the_closed_forms() {
        let variance = |kind: u32| {
            let n = 1_000_000;
            (0..n).map(|i| f64::from(filter_offset(kind, (i as f32 + 0.5) / n as f32)).powi(2)).sum::<f64>()
                / f64::from(n)
        };
        // Truncation of a normal distribution at three standard deviations leaves 0.97334 of its variance.
        let gaussian = 0.25 * 0.973_337;
        // Fourier integrals of x² over the window.
        let blackman_harris = 2.25
            * (0.35875 / 3.0 - 2.0 * 0.48829 / PI.powi(2) + 2.0 * 0.14128 / (2.0 * PI).powi(2)
                - 2.0 * 0.01168 / (3.0 * PI).powi(2))
            / 0.35875;
        for (kind, expected) in [
            (FILTER_BOX, 1.0 / 12.0),
            (FILTER_TENT, 1.0 / 6.0),
            (FILTER_GAUSSIAN, gaussian),
            (FILTER_BLACKMAN_HARRIS, blackman_harris),
        ] {
            assert!((variance(kind) - expected).abs() < 2e-5, "filter {kind}: {} {expected}", variance(kind));
        }
    }
}
