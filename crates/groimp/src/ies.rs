//! Photometric files of the standard IESNA LM-63 (1986 to 2002): the luminous intensity of a luminaire by direction.
//!
//! Type C, which nearly all files are: vertical angles from straight down, horizontal angles round the vertical.
//! Straight down becomes the light's local +z, the horizontal angle 0 its local +x; both are unverified for GroIMP.

use crate::values::parse_number;
use scene::Distribution;

/// Why a file cannot be used.
#[derive(Debug, thiserror::Error, PartialEq)]
pub(crate) enum IesError {
    #[error("it is no IES file: it has no line that starts with TILT=")]
    NoTilt,
    #[error("its lamp tilt '{0}' is not supported, only TILT=NONE is")]
    Tilt(String),
    #[error("it ends early or holds something else than a number: {0} is missing")]
    Missing(&'static str),
    #[error("its photometric type {0} is not supported, only type C (1) is")]
    Type(f64),
    #[error("its {0} angles do not rise or do not cover a symmetric part of the sphere")]
    Angles(&'static str),
    #[error("an intensity is negative or all are 0")]
    Intensities,
}

/// Most angles in either direction; finer ones are not measured.
const MOST_ANGLES: f64 = 4096.0;
/// Size of the table that becomes of it: a degree by three degrees.
const COLUMNS: usize = 180;
const ROWS: usize = 120;

/// Reads a photometric file.
pub(crate) fn parse(text: &str) -> Result<Distribution, IesError> {
    let mut rest = None;
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        offset += line.len();
        if let Some(tilt) = line.trim().strip_prefix("TILT=") {
            if tilt.trim() != "NONE" {
                return Err(IesError::Tilt(tilt.trim().chars().take(40).collect()));
            }
            rest = Some(&text[offset..]);
            break;
        }
    }
    let mut words = rest
        .ok_or(IesError::NoTilt)?
        .split(|c: char| c.is_whitespace() || c == ',')
        .filter(|word| !word.is_empty());
    let mut number =
        |what| words.next().and_then(parse_number).filter(|n| n.is_finite()).ok_or(IesError::Missing(what));
    for what in ["the number of lamps", "the lumens per lamp", "the multiplier"] {
        number(what)?;
    }
    let mut amount = |what| {
        let n = number(what)?;
        if (1.0..=MOST_ANGLES).contains(&n) { Ok(n as usize) } else { Err(IesError::Missing(what)) }
    };
    let verticals = amount("the number of vertical angles")?;
    let horizontals = amount("the number of horizontal angles")?;
    let photometric_type = number("the photometric type")?;
    if photometric_type != 1.0 {
        return Err(IesError::Type(photometric_type));
    }
    for what in [
        "the units",
        "the width",
        "the length",
        "the height",
        "the ballast factor",
        "a reserved number",
        "the watts",
    ] {
        number(what)?;
    }
    let mut list = |n: usize, what| (0..n).map(|_| number(what)).collect::<Result<Vec<f64>, _>>();
    let vertical = list(verticals, "a vertical angle")?;
    let horizontal = list(horizontals, "a horizontal angle")?;
    let intensities = list(verticals * horizontals, "an intensity")?;
    let measured = Measured { vertical, horizontal, intensities };
    measured.check()?;
    Distribution::new(COLUMNS, ROWS, &measured.table()).ok_or(IesError::Intensities)
}

struct Measured {
    /// Degrees from straight down, rising.
    vertical: Vec<f64>,
    /// Degrees round the vertical, rising from 0.
    horizontal: Vec<f64>,
    /// All vertical angles of the first horizontal one, then those of the next.
    intensities: Vec<f64>,
}

impl Measured {
    fn check(&self) -> Result<(), IesError> {
        let rises = |angles: &[f64]| angles.windows(2).all(|pair| pair[0] < pair[1]);
        let (Some(&low), Some(&high)) = (self.vertical.first(), self.vertical.last()) else {
            return Err(IesError::Angles("vertical"));
        };
        if !rises(&self.vertical) || low < 0.0 || high > 180.0 {
            return Err(IesError::Angles("vertical"));
        }
        let last = self.horizontal.last().copied();
        if self.horizontal.first() != Some(&0.0)
            || !rises(&self.horizontal)
            || !last.is_some_and(|last| [0.0, 90.0, 180.0, 360.0].contains(&last))
        {
            return Err(IesError::Angles("horizontal"));
        }
        Ok(())
    }

    fn table(&self) -> Vec<f64> {
        let mut values = Vec::with_capacity(COLUMNS * ROWS);
        for row in 0..ROWS {
            let azimuth = self.folded(360.0 * row as f64 / ROWS as f64 - 180.0);
            for column in 0..COLUMNS {
                values.push(self.intensity(180.0 * column as f64 / COLUMNS as f64, azimuth));
            }
        }
        values
    }

    /// The measured horizontal angle that is equivalent by symmetry.
    fn folded(&self, azimuth: f64) -> f64 {
        let full = azimuth.rem_euclid(360.0);
        let half = if full > 180.0 { 360.0 - full } else { full };
        match self.horizontal.last().copied().unwrap_or(0.0) {
            last if last >= 360.0 => full,
            last if last >= 180.0 => half,
            last if last >= 90.0 => half.min(180.0 - half),
            _ => 0.0,
        }
    }

    /// Interpolated intensity; 0 outside the measured vertical angles.
    fn intensity(&self, vertical: f64, horizontal: f64) -> f64 {
        let (low, high) = (self.vertical[0], self.vertical[self.vertical.len() - 1]);
        if vertical < low || vertical > high {
            return 0.0;
        }
        let (v, s) = place(&self.vertical, vertical);
        let (h, t) = place(&self.horizontal, horizontal);
        let at = |h: usize, v: usize| {
            let (h, v) = (h.min(self.horizontal.len() - 1), v.min(self.vertical.len() - 1));
            self.intensities[h * self.vertical.len() + v]
        };
        (1.0 - t) * ((1.0 - s) * at(h, v) + s * at(h, v + 1))
            + t * ((1.0 - s) * at(h + 1, v) + s * at(h + 1, v + 1))
    }
}

/// Index of the last angle that is not above `angle`, and how far it is to the next.
fn place(angles: &[f64], angle: f64) -> (usize, f64) {
    let low = angles.partition_point(|a| *a <= angle).saturating_sub(1);
    match (angles.get(low), angles.get(low + 1)) {
        (Some(a), Some(b)) => (low, ((angle - a) / (b - a)).clamp(0.0, 1.0)),
        _ => (low, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn file(counts: &str, angles: &str, values: &str) -> String {
        format!(
            "IESNA:LM-63-2002\n[TEST] none\nTILT=NONE\n1 1000 1.0 {counts} 1 2 0 0 0\n1.0 1.0 40\n{angles}\n{values}\n"
        )
    }

    #[test]
    fn an_even_file_is_isotropic() {
        let table = parse(&file("3 1", "0 90 180\n0", "50 50 50")).unwrap();
        assert!((table.density(17, 5) * 4.0 * PI - 1.0).abs() < 1e-9);
    }

    #[test]
    fn symmetric_parts_are_unfolded() {
        // Brighter towards the horizontal angle 90, in each notation.
        let quarter = parse(&file("2 2", "0 180 0 90", "1 1\n3 3")).unwrap();
        let half = parse(&file("2 3", "0 180 0 90 180", "1 1 3 3 1 1")).unwrap();
        let full = parse(&file("2 5", "0 180 0 90 180 270 360", "1 1 3 3 1 1 3 3 1 1")).unwrap();
        // Row 30 of 120 is the azimuth -90 degrees, row 60 is 0.
        for table in [&quarter, &half, &full] {
            assert!((table.density(90, 30) / table.density(90, 60) - 3.0).abs() < 1e-9);
            assert_eq!(table.density(90, 30), table.density(90, 90));
        }
        let one_side = parse(&file("2 3", "0 180 0 90 180", "1 1 1 1 3 3")).unwrap();
        assert!((one_side.density(90, 0) / one_side.density(90, 60) - 3.0).abs() < 1e-9);
    }

    #[test]
    fn beyond_the_measured_angles_it_is_dark() {
        let table = parse(&file("2 1", "0 90 0", "5 5")).unwrap();
        assert!(table.density(45, 0) > 0.0);
        assert_eq!(table.density(100, 0), 0.0);
    }

    #[test]
    fn what_is_no_such_file_is_refused() {
        assert_eq!(parse("hello"), Err(IesError::NoTilt));
        assert_eq!(parse("TILT=INCLUDE\n1"), Err(IesError::Tilt("INCLUDE".into())));
        assert_eq!(parse("TILT=NONE\n1 1 1"), Err(IesError::Missing("the number of vertical angles")));
        assert_eq!(
            parse("TILT=NONE\n1 1 1 1e9 1 1"),
            Err(IesError::Missing("the number of vertical angles"))
        );
        assert_eq!(parse("TILT=NONE\n1 1 1 2 1 2 1 0 0 0 1 1 1"), Err(IesError::Type(2.0)));
        assert_eq!(parse(&file("2 1", "90 0 0", "5 5")), Err(IesError::Angles("vertical")));
        assert_eq!(parse(&file("2 2", "0 90 0 45", "5 5 5 5")), Err(IesError::Angles("horizontal")));
        assert_eq!(parse(&file("2 1", "0 90 0", "0 0")), Err(IesError::Intensities));
        assert_eq!(parse(&file("2 1", "0 90 0", "5 x")), Err(IesError::Missing("an intensity")));
    }
}
