//! The curved sheet `Lamella`.

use super::grid::Surface;
use glam::DVec3;

/// A sheet along the head, like a parallelogram, and bent to a paraboloid: x in ±width/2, z in 0..height (or in
/// ±height/2 with `shift_pivot`), y = a x² + b z². The front is that of a parallelogram.
///
/// All of it is unverified: known are the names of the fields, and that it is a curved sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lamella {
    pub width: f64,
    pub height: f64,
    pub a: f64,
    pub b: f64,
    pub shift_pivot: bool,
}

impl Lamella {
    fn place(&self, s: f64, t: f64) -> [f64; 2] {
        let pivot = if self.shift_pivot { 0.5 } else { 0.0 };
        // From +x to -x, so that the front is on the side of +y.
        [(0.5 - s) * self.width, (t - pivot) * self.height]
    }
}

impl Surface for Lamella {
    fn point(&self, s: f64, t: f64) -> DVec3 {
        let [x, z] = self.place(s, t);
        DVec3::new(x, self.a * x * x + self.b * z * z, z)
    }

    fn tangents(&self, s: f64, t: f64) -> [DVec3; 2] {
        let [x, z] = self.place(s, t);
        let by_s = DVec3::new(1.0, 2.0 * self.a * x, 0.0) * -self.width;
        let by_t = DVec3::new(0.0, 2.0 * self.b * z, 1.0) * self.height;
        [by_s, by_t]
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [vec![0.0, 1.0], vec![0.0, 1.0]]
    }

    fn least_cells(&self) -> [usize; 2] {
        [1, 1]
    }

    fn uv(&self, s: f64, t: f64) -> [f64; 2] {
        [1.0 - s, t]
    }
}
