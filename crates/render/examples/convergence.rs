//! Measures how the error falls with the number of samples and writes `docs/convergence/convergence.csv` and `.svg`.
//!
//! `cargo run --release -p sunshine-render --example convergence [DIRECTORY]`

#![allow(clippy::unwrap_used, reason = "a program for developers; a panic tells what is wrong")]

#[path = "../tests/common/mod.rs"]
mod common;

use common::convergence::{Curve, SAMPLES, Study, measure, scenes};
use std::fmt::Write;
use std::path::PathBuf;

/// Whole pictures; the errors of four strips tell how well slopes are known.
const STUDY: Study = Study { edge: 48, step: 1, seeds: 1, parts: 4 };

/// Size of a panel and the space round it in units of the drawing.
const PANEL: f64 = 280.0;
const BETWEEN: f64 = 56.0;
const LEFT: f64 = 66.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 52.0;
/// Range of the errors shown, as decimal logarithms.
const LOWEST: f64 = -4.0;
const HIGHEST: f64 = 1.0;
/// Range of the samples shown, as decimal logarithm.
const DECADES: f64 = 4.5;

fn main() {
    let directory = std::env::args_os().nth(1).map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/convergence")),
        PathBuf::from,
    );
    let mut table = "scene,sampler,samples,relative_rms_error\n".to_owned();
    let mut panels = String::new();
    for (number, (name, scene, depth)) in scenes().into_iter().enumerate() {
        let curves = measure(&scene, depth, STUDY);
        for (sampler, curve) in ["independent", "sobol"].iter().zip(&curves) {
            for (step, samples) in SAMPLES.iter().enumerate() {
                writeln!(table, "{name},{sampler},{samples},{:.4e}", curve.error(step)).unwrap();
            }
            let (slope, error) = curve.slope(0);
            println!("{name}, {sampler}: slope {slope:.3} +- {error:.3}");
        }
        panel(&mut panels, number, name, &curves);
    }
    let width = LEFT + 3.0 * PANEL + 2.0 * BETWEEN + 20.0;
    let height = TOP + PANEL + BOTTOM;
    let turn = format!("transform=\"rotate(-90 16 {0})\"", TOP + 0.5 * PANEL);
    let drawing = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n\
         <text x=\"16\" y=\"{}\" text-anchor=\"middle\" {turn}>relative RMS error of the pixels</text>\n\
         {panels}</svg>\n",
        TOP + 0.5 * PANEL
    );
    std::fs::create_dir_all(&directory).unwrap();
    std::fs::write(directory.join("convergence.csv"), table).unwrap();
    std::fs::write(directory.join("convergence.svg"), drawing).unwrap();
}

/// Place of a point in its panel.
fn place(panel: usize, samples: f64, error: f64) -> (f64, f64) {
    let left = LEFT + panel as f64 * (PANEL + BETWEEN);
    let across = samples.log10() / DECADES;
    let down = (HIGHEST - error.log10()) / (HIGHEST - LOWEST);
    (left + across * PANEL, TOP + down * PANEL)
}

fn line(out: &mut String, (x1, y1): (f64, f64), (x2, y2): (f64, f64), style: &str) {
    writeln!(out, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>").unwrap();
}

fn text(out: &mut String, (x, y): (f64, f64), style: &str, words: &str) {
    writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" {style}>{words}</text>").unwrap();
}

fn panel(out: &mut String, number: usize, name: &str, curves: &[Curve; 2]) {
    let corner = |samples: f64, error: f64| place(number, samples, error);
    let right = 10f64.powf(DECADES);
    let (bottom, top) = (10f64.powf(LOWEST), 10f64.powf(HIGHEST));
    let power_of_ten = |power| format!("10<tspan dy=\"-5\" font-size=\"9\">{power}</tspan>");
    for decade in 0..=DECADES as i32 {
        let samples = 10f64.powi(decade);
        line(out, corner(samples, bottom), corner(samples, top), "stroke=\"#ddd\"");
        let (x, y) = corner(samples, bottom);
        text(out, (x, y + 17.0), "text-anchor=\"middle\"", &power_of_ten(decade));
    }
    for decade in LOWEST as i32..=HIGHEST as i32 {
        let error = 10f64.powi(decade);
        line(out, corner(1.0, error), corner(right, error), "stroke=\"#ddd\"");
        let (x, y) = corner(1.0, error);
        text(out, (x - 6.0, y + 4.0), "text-anchor=\"end\"", &power_of_ten(decade));
    }
    let frame = "fill=\"none\" stroke=\"#888\"";
    let (x, y) = corner(1.0, top);
    writeln!(out, "<rect x=\"{x}\" y=\"{y}\" width=\"{PANEL}\" height=\"{PANEL}\" {frame}/>").unwrap();
    // What these powers would be, from the first error on.
    let first = curves[0].error(0);
    for (power, label) in [
        (-0.5, "N<tspan dy=\"-5\" font-size=\"9\">−1/2</tspan>"),
        (-0.75, "N<tspan dy=\"-5\" font-size=\"9\">−3/4</tspan>"),
    ] {
        let end = (first / bottom).powf(-1.0 / power).min(right);
        let last = corner(end, first * end.powf(power));
        line(out, corner(1.0, first), last, "stroke=\"#777\" stroke-dasharray=\"4 3\"");
        let (anchor, dx, dy) = if power > -0.6 { ("end", -4.0, -26.0) } else { ("end", -10.0, 2.0) };
        text(out, (last.0 + dx, last.1 + dy), &format!("text-anchor=\"{anchor}\" fill=\"#555\""), label);
    }
    for (row, (curve, (color, sampler))) in
        curves.iter().zip([("#c0392b", "independent"), ("#2060c0", "Sobol")]).enumerate()
    {
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
        let (x, y) = corner(right, top);
        let words = format!("{sampler}: N<tspan dy=\"-5\" font-size=\"9\">−{:.2}</tspan>", -slope);
        let style = format!("text-anchor=\"end\" fill=\"{color}\"");
        text(out, (x - 8.0, y + 20.0 + 18.0 * row as f64), &style, &words);
    }
    let (x, y) = corner(right.sqrt(), top);
    text(out, (x, y - 12.0), "text-anchor=\"middle\" font-weight=\"bold\"", name);
    text(out, (x, y + PANEL + 38.0), "text-anchor=\"middle\"", "samples per pixel, N");
}
