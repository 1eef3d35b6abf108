//! Options that change the daylight of the project.

use crate::failure::Failure;
use clap::Args;
use scene::{Sky, SunPosition};

/// Daylight options of `sunshine render`; what is not given stays as it was saved.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Daylight")]
pub struct DaylightArguments {
    /// Where the sun of the project's SunSkyLight stands, in degrees: its azimuth from the x axis towards the y axis,
    /// and its height above the horizon
    #[arg(long, value_name = "AZIMUTH,ELEVATION", allow_hyphen_values = true, value_parser = parse_sun)]
    pub sun: Option<SunPosition>,

    /// Haziness of the air of the project's SunSkyLight, from 1.7 (very clear) to 10 (hazy)
    #[arg(long, value_name = "T", value_parser = parse_turbidity)]
    pub turbidity: Option<f64>,
}

impl DaylightArguments {
    /// What is given, as options without dashes and their values.
    pub fn options(&self) -> Vec<(&'static str, String)> {
        let sun = self.sun.map(|sun| ("sun", format!("{},{}", sun.azimuth, sun.elevation)));
        let turbidity = self.turbidity.map(|turbidity| ("turbidity", turbidity.to_string()));
        sun.into_iter().chain(turbidity).collect()
    }

    /// Changes a sky.
    ///
    /// # Errors
    /// If something is to be changed and there is no daylight.
    pub fn apply(&self, sky: &mut Option<Sky>) -> Result<(), Failure> {
        if (self.sun, self.turbidity) == (None, None) {
            return Ok(());
        }
        match sky.as_mut().is_some_and(|sky| sky.set_daylight(self.sun, self.turbidity)) {
            true => Ok(()),
            false => Err(Failure::Usage(
                "--sun and --turbidity change the SunSkyLight of a project; this one has none".to_owned(),
            )),
        }
    }
}

fn parse_sun(text: &str) -> Result<SunPosition, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[azimuth, elevation]) if azimuth.abs() <= 360.0 && elevation.abs() <= 90.0 => {
            Ok(SunPosition { azimuth, elevation })
        }
        _ => Err("expected azimuth and height in degrees, for example 135,40".to_owned()),
    }
}

fn parse_turbidity(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|number| (1.7..=10.0).contains(number));
    number.ok_or_else(|| "expected a number from 1.7 to 10, for example 3".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suns_and_hazes() {
        assert_eq!(parse_sun("-30, 45.5"), Ok(SunPosition { azimuth: -30.0, elevation: 45.5 }));
        for wrong in ["", "1", "1,2,3", "1,91", "361,0", "nan,1"] {
            assert!(parse_sun(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_turbidity("2.5"), Ok(2.5));
        assert!(parse_turbidity("1").is_err() && parse_turbidity("nan").is_err());
    }

    #[test]
    fn a_scene_without_daylight_is_refused() {
        assert!(DaylightArguments::default().apply(&mut None).is_ok());
        let arguments = DaylightArguments { turbidity: Some(3.0), ..DaylightArguments::default() };
        assert!(matches!(arguments.apply(&mut None), Err(Failure::Usage(_))));
    }
}
