//! Measures how the error falls with the number of samples and writes `docs/convergence/convergence.csv` and `.svg`.
//!
//! `cargo run --release -p sunshine-render --example convergence [DIRECTORY]`

#![allow(clippy::unwrap_used, reason = "a program for developers; a panic tells what is wrong")]

#[path = "../tests/common/mod.rs"]
mod common;

use common::convergence::{Curve, SAMPLES, measure, scenes};
use std::fmt::Write;
use std::path::PathBuf;

/// Size of a panel and its margin in units of the drawing.
const PANEL: f64 = 260.0;
const MARGIN: f64 = 50.0;
/// Range of the errors shown, as decimal logarithms.
const LOWEST: f64 = -5.0;
const HIGHEST: f64 = 1.0;
/// Range of the samples shown, as decimal logarithm.
const DECADES: f64 = 4.5;

fn main() {
    let directory = std::env::args_os().nth(1).map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/convergence")),
        PathBuf::from,
    );
    let seeds = 5;
    let mut table = "scene,sampler,samples,relative_rms_error\n".to_owned();
    let mut panels = String::new();
    for (number, (name, scene, depth)) in scenes().into_iter().enumerate() {
        let curves = measure(&scene, depth, SAMPLES.len(), seeds);
        for (sampler, curve) in ["independent", "sobol"].iter().zip(&curves) {
            for (step, samples) in SAMPLES.iter().enumerate() {
                writeln!(table, "{name},{sampler},{samples},{:.4e}", curve.error(step)).unwrap();
            }
            let (slope, error) = curve.slope(0);
            println!("{name}, {sampler}: slope {slope:.3} +- {error:.3}");
        }
        panel(&mut panels, number, name, &curves);
    }
    let width = 3.0 * (PANEL + MARGIN) + MARGIN;
    let height = PANEL + 2.0 * MARGIN;
    let drawing = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
         font-size=\"11\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n{panels}</svg>\n"
    );
    std::fs::create_dir_all(&directory).unwrap();
    std::fs::write(directory.join("convergence.csv"), table).unwrap();
    std::fs::write(directory.join("convergence.svg"), drawing).unwrap();
}

/// Place of a point in its panel.
fn place(panel: usize, samples: f64, error: f64) -> (f64, f64) {
    let left = MARGIN + panel as f64 * (PANEL + MARGIN);
    let across = samples.log10() / DECADES;
    let down = (HIGHEST - error.log10()) / (HIGHEST - LOWEST);
    (left + across * PANEL, MARGIN + down * PANEL)
}

fn line(out: &mut String, (x1, y1): (f64, f64), (x2, y2): (f64, f64), style: &str) {
    writeln!(out, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>").unwrap();
}

fn text(out: &mut String, (x, y): (f64, f64), anchor: &str, words: &str) {
    writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{words}</text>").unwrap();
}

fn panel(out: &mut String, number: usize, name: &str, curves: &[Curve; 2]) {
    let corner = |samples: f64, error: f64| place(number, samples, error);
    let right = 10f64.powf(DECADES);
    let (bottom, top) = (10f64.powf(LOWEST), 10f64.powf(HIGHEST));
    for decade in 0..=DECADES as i32 {
        let samples = 10f64.powi(decade);
        line(out, corner(samples, bottom), corner(samples, top), "stroke=\"#ddd\"");
        let (x, y) = corner(samples, bottom);
        text(out, (x, y + 15.0), "middle", &format!("10<tspan dy=\"-4\" font-size=\"8\">{decade}</tspan>"));
    }
    for decade in LOWEST as i32..=HIGHEST as i32 {
        let error = 10f64.powi(decade);
        line(out, corner(1.0, error), corner(right, error), "stroke=\"#ddd\"");
        let (x, y) = corner(1.0, error);
        text(out, (x - 5.0, y + 4.0), "end", &format!("10<tspan dy=\"-4\" font-size=\"8\">{decade}</tspan>"));
    }
    // What 1/sqrt(N) and 1/N would be, from the first error on.
    let first = curves[0].error(0);
    for (power, label) in [(-0.5, "N^-1/2"), (-1.0, "N^-1")] {
        let end = (first / bottom).powf(-1.0 / power).min(right);
        let last = corner(end, first * end.powf(power));
        line(out, corner(1.0, first), last, "stroke=\"#999\" stroke-dasharray=\"3 3\"");
        text(out, (last.0 - 4.0, last.1 - 6.0), "end", label);
    }
    for (curve, (color, sampler)) in curves.iter().zip([("#c0392b", "independent"), ("#2060c0", "sobol")]) {
        let points =
            SAMPLES.iter().enumerate().map(|(step, samples)| corner(f64::from(*samples), curve.error(step)));
        let mut before = None;
        for point in points {
            if let Some(before) = before.replace(point) {
                line(out, before, point, &format!("stroke=\"{color}\" stroke-width=\"2\""));
            }
            writeln!(out, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{color}\"/>", point.0, point.1)
                .unwrap();
        }
        let slope = curve.slope(0).0;
        let (x, y) = corner(1.0, bottom);
        let height = if sampler == "sobol" { 10.0 } else { 26.0 };
        writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{color}\">{sampler}: N^{slope:.2}</text>",
            x + 8.0,
            y - height
        )
        .unwrap();
    }
    let (x, y) = corner(right.sqrt(), top);
    text(out, (x, y - 10.0), "middle", name);
    text(out, (x, y + PANEL + 32.0), "middle", "samples per pixel");
    if number == 0 {
        text(out, (8.0, 20.0), "start", "relative RMS error");
    }
}
