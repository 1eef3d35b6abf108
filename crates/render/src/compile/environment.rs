//! The density in which directions towards a sky are drawn: a table baked from the sky's own radiance.

use super::CompiledScene;
use super::{count, lights};
use crate::cpu::Slices;
use kernels::records::kernel::{LIGHT_DAYLIGHT, LIGHT_SKY_MAP, LightRecord};
use kernels::sky::kernel::{distant_radiance, out_of_light_axes};
use kernels::warp::kernel::{luminance, polar_direction};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Cells of equal solid angle: rows by height, columns by azimuth. The horizon lies between two rows.
const COLUMNS: usize = 256;
const ROWS: usize = 128;
/// Every cell is sampled at this many points squared.
const POINTS: usize = 4;
/// Of the mean radiance this share is added everywhere, so that a detail that fell between the points of a cell
/// is still found.
const FLOOR: f64 = 0.05;

/// Adds the tables of all skies that need one, and sets their importance.
pub(super) fn add_sky_densities(scene: &mut CompiledScene) {
    for index in 0..scene.header.distant_lights as usize {
        let light = scene.lights[index];
        if light.kind != LIGHT_SKY_MAP && light.kind != LIGHT_DAYLIGHT {
            continue;
        }
        let cells = mean_luminances(scene, light);
        let mean = cells.iter().sum::<f64>() / cells.len() as f64;
        // Below the horizon a clear sky is black.
        let dark_from = if light.kind == LIGHT_DAYLIGHT { COLUMNS * ROWS / 2 } else { cells.len() };
        let record = &mut scene.lights[index];
        record.first = count(scene.attributes.len());
        record.count = lights::size(COLUMNS, ROWS);
        if record.importance > 0.0 {
            // The irradiance of a plane, averaged over its orientations; the least that is not nothing for a map
            // that is black wherever it was looked at.
            let share = lights::aimed_share(relative_variance(&cells[..dark_from]));
            record.importance = ((PI * mean * share) as f32).max(1.0e-12);
        }
        let floor = if mean > 0.0 { FLOOR * mean } else { 1.0 };
        let weights: Vec<f64> =
            cells.iter().enumerate().map(|(i, l)| if i < dark_from { l + floor } else { 0.0 }).collect();
        push_table(&weights, &mut scene.attributes);
    }
}

/// Variance of some numbers, divided by the square of their mean; 0 if that is 0.
fn relative_variance(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    if mean > 0.0 { squares / (mean * mean) } else { 0.0 }
}

/// Mean luminance of the radiance in every cell.
fn mean_luminances(scene: &CompiledScene, light: LightRecord) -> Vec<f64> {
    let access = Slices::of(scene);
    (0..COLUMNS * ROWS)
        .into_par_iter()
        .map(|cell| {
            let (row, column) = (cell / COLUMNS, cell % COLUMNS);
            let mut sum = 0.0;
            for i in 0..POINTS {
                let down = (row as f32 + (i as f32 + 0.5) / POINTS as f32) / ROWS as f32;
                for j in 0..POINTS {
                    let along = (column as f32 + (j as f32 + 0.5) / POINTS as f32) / COLUMNS as f32;
                    let direction = out_of_light_axes(light, polar_direction(1.0 - 2.0 * down, along));
                    let radiance = f64::from(luminance(distant_radiance(access, light, direction)));
                    // A map may hold anything.
                    sum += if radiance.is_finite() { radiance.max(0.0) } else { 0.0 };
                }
            }
            sum / (POINTS * POINTS) as f64
        })
        .collect()
}

/// The table as `sample_table` in the kernels reads it.
fn push_table(weights: &[f64], attributes: &mut Vec<[f32; 4]>) {
    let rows: Vec<f64> = weights.chunks_exact(COLUMNS).map(|row| row.iter().sum()).collect();
    let bands = intervals(&rows);
    attributes.extend(bands.iter().map(|[from, to]| [*from, *to, 0.0, 0.0]));
    let solid_angle = 4.0 * PI / weights.len() as f64;
    for (row, band) in weights.chunks_exact(COLUMNS).zip(&bands) {
        // The probability that 32-bit numbers really have, so that no rounding makes the density wrong.
        let of_row = f64::from(band[1]) - f64::from(band[0]);
        for [from, to] in intervals(row) {
            let pdf = of_row * (f64::from(to) - f64::from(from)) / solid_angle;
            attributes.push([from, to, pdf as f32, 0.0]);
        }
    }
}

/// Neighbouring parts of [0, 1] in proportion to the weights.
fn intervals(weights: &[f64]) -> Vec<[f32; 2]> {
    let total: f64 = weights.iter().sum();
    let last = weights.iter().rposition(|weight| *weight > 0.0);
    let mut sum = 0.0;
    let mut from = 0.0;
    weights
        .iter()
        .enumerate()
        .map(|(i, weight)| {
            sum += weight;
            let to = if last.is_none_or(|last| i >= last) { 1.0 } else { (sum / total) as f32 };
            let interval = [from, to];
            from = to;
            interval
        })
        .collect()
}
