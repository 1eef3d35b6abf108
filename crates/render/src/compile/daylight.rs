//! Coefficients of a clear sky and the colour of the sun behind its air.
//!
//! Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight" (SIGGRAPH 1999), appendices 1 and 2; the
//! spectra there are Iqbal's ("An Introduction to Solar Radiation", 1983). Digits as in materials-and-lights.md 3.7;
//! the last ones are unverified for GroIMP.

use scene::{DVec3, Daylight, Rgb};
use std::f64::consts::{FRAC_PI_2, PI};

/// 1 minus the cosine of half the sun's angular diameter of 32 arc minutes; GroIMP's approximation a²/8.
pub(super) const SUN_VERSINE: f64 = SUN_DIAMETER * SUN_DIAMETER / 8.0;
const SUN_DIAMETER: f64 = PI * 32.0 / (60.0 * 180.0);

/// Lumens per watt at the wavelength of best vision: turns luminance into W/(m² sr).
const LUMENS_PER_WATT: f64 = 683.002;

/// A clear sky in numbers.
pub(super) struct DaylightModel {
    /// As `daylight_radiance` in the kernels reads them.
    pub coefficients: [[f32; 4]; 6],
    /// Unit vector to the sun in the sky's axes.
    pub sun: DVec3,
    /// Radiance of the sun's disc in W/(m² sr); `None` without a sun above the horizon.
    pub sun_radiance: Option<Rgb>,
}

pub(super) fn compile_daylight(daylight: &Daylight) -> DaylightModel {
    let sun = daylight.sun.normalize_or(DVec3::Z);
    let t = daylight.turbidity;
    // The model knows no night: a sun below the horizon gives the sky of one at the horizon and does not shine.
    let zenith_angle = sun.z.clamp(0.0, 1.0).acos();
    let perez = |[a, b, c, d, e]: [f64; 5], cos: f64, gamma: f64| {
        (1.0 + a * (b / cos).exp()) * (1.0 + c * (d * gamma).exp() + e * gamma.cos().powi(2))
    };
    let distribution = distribution_coefficients(t);
    let zenith = zenith_values(t, zenith_angle);
    // The published values hold at the zenith, which is the angle of the sun away from it.
    let scale = [0, 1, 2].map(|i| zenith[i] / perez(distribution[i], 1.0, zenith_angle));
    let luminance_scale = scale[0] * 1000.0 / LUMENS_PER_WATT * daylight.factor;
    let a_to_d = |i: usize| {
        let [a, b, c, d, _] = distribution[i];
        [a, b, c, d].map(|x| x as f32)
    };
    let [e_luminance, e_x, e_y] = distribution.map(|[.., e]| e as f32);
    let coefficients = [
        [sun.x as f32, sun.y as f32, sun.z as f32, 0.0],
        a_to_d(0),
        a_to_d(1),
        a_to_d(2),
        [e_luminance, e_x, e_y, 0.0],
        [luminance_scale as f32, scale[1] as f32, scale[2] as f32, 0.0],
    ];
    let has_sun = daylight.has_sun && sun.z > 0.0;
    let sun_radiance = has_sun.then(|| sun_radiance(t, zenith_angle).map(|r| r * daylight.factor));
    DaylightModel { coefficients, sun, sun_radiance }
}

/// A to E of the Perez function for luminance and the chromaticities x and y.
fn distribution_coefficients(t: f64) -> [[f64; 5]; 3] {
    [
        [
            0.17872 * t - 1.46303,
            -0.35540 * t + 0.42749,
            -0.02266 * t + 5.32505,
            0.12064 * t - 2.57705,
            -0.06696 * t + 0.37027,
        ],
        [
            -0.01925 * t - 0.25922,
            -0.06651 * t + 0.00081,
            -0.00041 * t + 0.21247,
            -0.06409 * t - 0.89887,
            -0.00325 * t + 0.04517,
        ],
        [
            -0.01669 * t - 0.26078,
            -0.09495 * t + 0.00921,
            -0.00792 * t + 0.21023,
            -0.04405 * t - 1.65369,
            -0.01092 * t + 0.05291,
        ],
    ]
}

/// Luminance in kcd/m², x and y at the zenith for a sun at the angle `s` from it.
fn zenith_values(t: f64, s: f64) -> [f64; 3] {
    let luminance =
        (4.0453 * t - 4.9710) * ((4.0 / 9.0 - t / 120.0) * (PI - 2.0 * s)).tan() - 0.2155 * t + 2.4192;
    let cubic = |[c3, c2, c1, c0]: [f64; 4]| ((c3 * s + c2) * s + c1) * s + c0;
    let x = cubic([0.00166, -0.00375, 0.00209, 0.0]) * t * t
        + cubic([-0.02903, 0.06377, -0.03202, 0.00394]) * t
        + cubic([0.11693, -0.21196, 0.06052, 0.25886]);
    let y = cubic([0.00275, -0.00610, 0.00317, 0.0]) * t * t
        + cubic([-0.04214, 0.08970, -0.04153, 0.00516]) * t
        + cubic([0.15346, -0.26756, 0.06670, 0.26688]);
    [luminance.max(0.0), x, y]
}

/// Radiance of the sun through the air at the angle `s` from the zenith, as a linear Rec. 709 colour whose luminance
/// is that of the disc divided by 683 lm/W, as for the sky.
fn sun_radiance(t: f64, s: f64) -> Rgb {
    let s = s.min(FRAC_PI_2);
    // Relative optical mass of the air.
    let m = 1.0 / (s.cos() + 0.00094 * (1.6386 - s).powf(-1.253));
    let beta = 0.04608365822 * t - 0.04586025928;
    let mut xyz = [0.0; 3];
    const STEP: u32 = 5;
    for nanometres in (350..=800).step_by(STEP as usize) {
        let wavelength = f64::from(nanometres);
        let micrometres = wavelength / 1000.0;
        let ozone = interpolate(&OZONE, wavelength);
        let gases = interpolate(&MIXED_GASES, wavelength);
        let vapour = 2.0 * interpolate(&WATER_VAPOUR, wavelength);
        let depth = 0.008735 * m * micrometres.powf(-4.08)
            + m * beta * micrometres.powf(-1.3)
            + m * ozone * 0.35
            + 1.41 * gases * m / (1.0 + 118.93 * gases * m).powf(0.45)
            + 0.2385 * vapour * m / (1.0 + 20.07 * vapour * m).powf(0.45);
        let radiance = 100.0 * solar_radiance(wavelength) * (-depth).exp();
        for (sum, response) in xyz.iter_mut().zip(color_matching(wavelength)) {
            *sum += radiance * response * f64::from(STEP);
        }
    }
    let [x, y, z] = xyz;
    let rgb = [
        3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
        -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
        0.0556434 * x - 0.2040259 * y + 1.0572252 * z,
    ];
    let lack = rgb.iter().fold(0.0f64, |lack, c| lack.max(-c));
    rgb.map(|c| c + lack)
}

/// CIE 1931 colour matching functions by the fit of Wyman, Sloan and Shirley, "Simple Analytic Approximations to the
/// CIE XYZ Color Matching Functions" (JCGT 2(2), 2013), multi-lobe form.
fn color_matching(wavelength: f64) -> [f64; 3] {
    let lobe = |height: f64, middle: f64, below: f64, above: f64| {
        let width = if wavelength < middle { below } else { above };
        height * (-0.5 * ((wavelength - middle) / width).powi(2)).exp()
    };
    [
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    ]
}

/// Radiance of the sun outside the air in W/(cm² µm sr), from 380 to 750 nm every 10 nm, 0 elsewhere.
fn solar_radiance(wavelength: f64) -> f64 {
    const RADIANCE: [f64; 38] = [
        165.5, 162.3, 211.2, 258.8, 258.2, 242.3, 267.6, 296.6, 305.4, 300.6, 306.6, 288.3, 287.1, 278.2,
        271.0, 272.3, 263.6, 255.0, 250.6, 253.1, 253.5, 251.3, 246.3, 241.7, 236.8, 232.1, 228.2, 223.4,
        219.7, 215.3, 211.0, 207.3, 202.4, 198.7, 194.3, 190.7, 186.3, 182.6,
    ];
    if !(380.0..=750.0).contains(&wavelength) {
        return 0.0;
    }
    let place = (wavelength - 380.0) / 10.0;
    let low = (place as usize).min(RADIANCE.len() - 2);
    let t = place - low as f64;
    RADIANCE[low] * (1.0 - t) + RADIANCE[low + 1] * t
}

/// Value of a table of (nm, value) in order, constant beyond its ends.
fn interpolate(table: &[(f64, f64)], wavelength: f64) -> f64 {
    let above = table.partition_point(|(at, _)| *at <= wavelength);
    match (above.checked_sub(1).map(|i| table[i]), table.get(above)) {
        (Some((low, a)), Some(&(high, b))) => a + (b - a) * (wavelength - low) / (high - low),
        (Some((_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => 0.0,
    }
}

/// Absorption of ozone in cm⁻¹.
const OZONE: [(f64, f64); 64] = [
    (300.0, 10.0),
    (305.0, 4.8),
    (310.0, 2.7),
    (315.0, 1.35),
    (320.0, 0.8),
    (325.0, 0.38),
    (330.0, 0.16),
    (335.0, 0.075),
    (340.0, 0.04),
    (345.0, 0.019),
    (350.0, 0.007),
    (355.0, 0.0),
    (445.0, 0.003),
    (450.0, 0.003),
    (455.0, 0.004),
    (460.0, 0.006),
    (465.0, 0.008),
    (470.0, 0.009),
    (475.0, 0.012),
    (480.0, 0.014),
    (485.0, 0.017),
    (490.0, 0.021),
    (495.0, 0.025),
    (500.0, 0.03),
    (505.0, 0.035),
    (510.0, 0.04),
    (515.0, 0.045),
    (520.0, 0.048),
    (525.0, 0.057),
    (530.0, 0.063),
    (535.0, 0.07),
    (540.0, 0.075),
    (545.0, 0.08),
    (550.0, 0.085),
    (555.0, 0.095),
    (560.0, 0.103),
    (565.0, 0.11),
    (570.0, 0.12),
    (575.0, 0.122),
    (580.0, 0.12),
    (585.0, 0.118),
    (590.0, 0.115),
    (595.0, 0.12),
    (600.0, 0.125),
    (605.0, 0.13),
    (610.0, 0.12),
    (620.0, 0.105),
    (630.0, 0.09),
    (640.0, 0.079),
    (650.0, 0.067),
    (660.0, 0.057),
    (670.0, 0.048),
    (680.0, 0.036),
    (690.0, 0.028),
    (700.0, 0.023),
    (710.0, 0.018),
    (720.0, 0.014),
    (730.0, 0.011),
    (740.0, 0.01),
    (750.0, 0.009),
    (760.0, 0.007),
    (770.0, 0.004),
    (780.0, 0.0),
    (790.0, 0.0),
];

/// Absorption of the uniformly mixed gases.
const MIXED_GASES: [(f64, f64); 4] = [(759.0, 0.0), (760.0, 3.0), (770.0, 0.21), (771.0, 0.0)];

/// Absorption of water vapour.
const WATER_VAPOUR: [(f64, f64); 13] = [
    (689.0, 0.0),
    (690.0, 0.016),
    (700.0, 0.024),
    (710.0, 0.0125),
    (720.0, 1.0),
    (730.0, 0.87),
    (740.0, 0.061),
    (750.0, 0.001),
    (760.0, 1.0e-5),
    (770.0, 1.0e-5),
    (780.0, 0.0006),
    (790.0, 0.0175),
    (800.0, 0.036),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matching_functions_weigh_equal_energy_equally() {
        let mut sums = [0.0; 3];
        for nanometres in 360..830 {
            for (sum, value) in sums.iter_mut().zip(color_matching(f64::from(nanometres))) {
                *sum += value;
            }
        }
        // The tabulated functions sum to 106.86 each; the fit is good to a percent.
        for sum in sums {
            assert!((sum / 106.86 - 1.0).abs() < 0.01, "{sums:?}");
        }
    }

    #[test]
    fn the_sun_reddens_and_dims_towards_the_horizon() {
        let high = sun_radiance(3.0, 0.3);
        let low = sun_radiance(3.0, 1.4);
        assert!(high[2] / high[0] > 2.0 * low[2] / low[0], "{high:?} {low:?}");
        assert!(high[1] > 2.0 * low[1]);
        // Illuminance across the beam, measured ones are near 100 klx under a high sun and clear air.
        let luminance = 0.2126 * high[0] + 0.7152 * high[1] + 0.0722 * high[2];
        let illuminance = luminance * LUMENS_PER_WATT * 2.0 * PI * SUN_VERSINE;
        assert!((70e3..130e3).contains(&illuminance), "{illuminance}");
    }

    #[test]
    fn a_sun_at_or_below_the_horizon_leaves_finite_numbers() {
        for z in [0.0, 1e-9, -0.5, -1.0] {
            for turbidity in [1.7, 6.0, 10.0] {
                let sun = DVec3::new(0.0, 1.0, z);
                let model =
                    compile_daylight(&Daylight { sun, turbidity, factor: 1.0, shines: true, has_sun: true });
                assert!(model.coefficients.iter().flatten().all(|c| c.is_finite()));
                assert_eq!(model.sun_radiance.is_some(), z > 0.0);
                assert!(model.sun_radiance.is_none_or(|rgb| rgb.iter().all(|c| c.is_finite() && *c >= 0.0)));
            }
        }
    }
}
