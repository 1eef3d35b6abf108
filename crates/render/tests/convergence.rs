//! The error falls as it should with the number of samples: as 1/√N with independent numbers, faster with the
//! Sobol sampler.

mod common;

use common::convergence::*;

#[test]
fn independent_errors_fall_with_the_square_root_and_sobol_errors_faster() {
    // Four decades and a bit, at a few pixels; the plot in docs/convergence takes whole pictures.
    for (name, scene, depth) in scenes() {
        let [independent, sobol] = measure(&scene, depth, Study::SHORT);
        let (slope, error) = independent.slope(0);
        let (sobol_slope, sobol_error) = sobol.slope(0);
        let last = SAMPLES.len() - 1;
        // Geometric mean over the last three steps.
        let gain =
            (last - 2..=last).map(|step| independent.error(step) / sobol.error(step)).product::<f64>().cbrt();
        eprintln!(
            "{name}: independent {slope:.3} +- {error:.3}, sobol {sobol_slope:.3} +- {sobol_error:.3}, \
             {gain:.2} times less noise at {} samples and more",
            SAMPLES[last - 2]
        );
        // Five standard errors from the scatter among seeds; they come from four values themselves, so 0.01 more.
        assert!((slope + 0.5).abs() < 5.0 * error + 0.01, "{name}: slope {slope} +- {error}");
        // Steeper, beyond the scatter. Behind several surfaces the integrand has many dimensions, so not by much.
        let difference = slope - sobol_slope;
        assert!(difference > 1.5 * error.hypot(sobol_error), "{name}: {slope} and {sobol_slope}");
        for (step, samples) in SAMPLES.iter().enumerate().skip(2) {
            let (a, b) = (independent.error(step), sobol.error(step));
            assert!(b < a, "{name}: {b} against {a} at {samples} samples");
        }
        assert!(gain > 1.3, "{name}: {gain}");
        // Both are right: their means agree within the scatter among seeds.
        let ((a, da), (b, db)) =
            (mean_and_standard_error(&independent.means), mean_and_standard_error(&sobol.means));
        assert!((a - b).abs() < 6.0 * da.hypot(db), "{name}: {a} +- {da} and {b} +- {db}");
    }
}
