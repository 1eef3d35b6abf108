use std::f64::consts::{PI, TAU};

/// How the power of a light is spread over the directions, GroIMP's `LightDistribution`: a table that is
/// interpolated linearly in both angles and integrates to 1 over the sphere.
///
/// Column x of n stands for the angle π x / n from local +z, row y of m for the azimuth 2π y / m − π from
/// local +x; beyond the last column and row the values stay as they are there.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution {
    columns: usize,
    rows: usize,
    densities: Vec<f64>,
}

impl Distribution {
    /// The distribution in proportion to `values`, row by row; `None` if there are not columns × rows of them, one
    /// is negative or not a number, or all are 0.
    pub fn new(columns: usize, rows: usize, values: &[f64]) -> Option<Self> {
        let valid = !values.is_empty()
            && columns.checked_mul(rows) == Some(values.len())
            && values.iter().all(|value| value.is_finite() && *value >= 0.0);
        if !valid {
            return None;
        }
        let (polar, azimuth) = (polar_weights(columns), azimuth_weights(rows));
        let integral: f64 = values
            .chunks_exact(columns)
            .zip(azimuth)
            .map(|(row, weight)| weight * row.iter().zip(&polar).map(|(v, w)| v * w).sum::<f64>())
            .sum();
        if !(integral > 0.0 && integral.is_finite()) {
            return None;
        }
        let densities = values.iter().map(|value| value / integral).collect();
        Some(Distribution { columns, rows, densities })
    }

    /// Number of polar angles, at least 1.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of azimuths, at least 1.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Share of the power per solid angle in sr⁻¹ at a grid point; indices past the end mean the last one.
    pub fn density(&self, column: usize, row: usize) -> f64 {
        self.densities[row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)]
    }

    /// The largest density.
    pub fn max_density(&self) -> f64 {
        self.densities.iter().copied().fold(0.0, f64::max)
    }
}

/// What every column contributes to the integral over the polar angle, sine included; exact for the
/// interpolated function.
fn polar_weights(columns: usize) -> Vec<f64> {
    let mut weights = vec![0.0; columns];
    let step = PI / columns as f64;
    for i in 0..columns {
        let (low, high) = (step * i as f64, step * (i + 1) as f64);
        let all = low.cos() - high.cos();
        // The integral of t sin θ where t runs from 0 to 1 over the strip.
        let rising = (high.sin() - low.sin()) / step - high.cos();
        weights[i] += all - rising;
        weights[(i + 1).min(columns - 1)] += rising;
    }
    weights
}

/// What every row contributes to the integral over the azimuth.
fn azimuth_weights(rows: usize) -> Vec<f64> {
    let mut weights = vec![0.0; rows];
    let step = TAU / rows as f64;
    for i in 0..rows {
        weights[i] += 0.5 * step;
        weights[(i + 1).min(rows - 1)] += 0.5 * step;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_table_is_isotropic() {
        for (columns, rows) in [(1, 1), (1, 5), (7, 1), (18, 36)] {
            let table = Distribution::new(columns, rows, &vec![3.0; columns * rows]).unwrap();
            assert!((table.density(0, 0) * 4.0 * PI - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn any_table_integrates_to_one() {
        let (columns, rows) = (5, 3);
        let values: Vec<f64> = (0..15).map(|i| f64::from(i * i % 7)).collect();
        let table = Distribution::new(columns, rows, &values).unwrap();
        // Midpoint rule on a fine grid, aligned with the table so that the error is of second order.
        let (n, m) = (columns * 400, rows * 40);
        let mut sum = 0.0;
        for i in 0..n {
            let (x, theta) = ((i as f64 + 0.5) / n as f64 * columns as f64, (i as f64 + 0.5) / n as f64 * PI);
            for j in 0..m {
                let y = (j as f64 + 0.5) / m as f64 * rows as f64;
                let (c, r) = (x as usize, y as usize);
                let (s, t) = (x - c as f64, y - r as f64);
                let value = (1.0 - t) * ((1.0 - s) * table.density(c, r) + s * table.density(c + 1, r))
                    + t * ((1.0 - s) * table.density(c, r + 1) + s * table.density(c + 1, r + 1));
                sum += value * theta.sin() * (PI / n as f64) * (TAU / m as f64);
            }
        }
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
    }

    #[test]
    fn what_is_no_table_is_refused() {
        assert_eq!(Distribution::new(2, 2, &[1.0; 3]), None);
        assert_eq!(Distribution::new(0, 0, &[]), None);
        assert_eq!(Distribution::new(1, 1, &[0.0]), None);
        assert_eq!(Distribution::new(1, 1, &[f64::NAN]), None);
        assert_eq!(Distribution::new(2, 1, &[1.0, -1.0]), None);
    }
}
