//! Where the sun stands.

use crate::{Sky, SkyRadiance};
use glam::DVec3;

/// Where the sun stands in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// In degrees, from the x axis (0) towards the y axis (90).
    pub azimuth: f64,
    /// Height above the horizon in degrees, at most 90.
    pub elevation: f64,
}

impl SunPosition {
    /// That of a direction in the world.
    pub fn of(direction: DVec3) -> Self {
        let direction = direction.normalize_or(DVec3::Z);
        SunPosition {
            azimuth: direction.y.atan2(direction.x).to_degrees(),
            elevation: direction.z.clamp(-1.0, 1.0).asin().to_degrees(),
        }
    }

    /// The unit vector to the sun in the world.
    pub fn direction(self) -> DVec3 {
        let (azimuth, elevation) = (self.azimuth.to_radians(), self.elevation.to_radians());
        DVec3::new(azimuth.cos() * elevation.cos(), azimuth.sin() * elevation.cos(), elevation.sin())
    }
}

impl Sky {
    /// Where the sun stands and how hazy the air is; `None` if the sky is no daylight.
    pub fn daylight(&self) -> Option<(SunPosition, f64)> {
        let SkyRadiance::Daylight(daylight) = self.radiance else { return None };
        let direction = self.world_from_sky.transform_vector3(daylight.sun);
        Some((SunPosition::of(direction), daylight.turbidity))
    }

    /// Changes where the sun stands and how hazy the air is (from 1.7 to 10); `false` if the sky is no daylight.
    pub fn set_daylight(&mut self, sun: Option<SunPosition>, turbidity: Option<f64>) -> bool {
        let SkyRadiance::Daylight(daylight) = &mut self.radiance else { return false };
        if let Some(sun) = sun {
            let direction = self.world_from_sky.matrix3.inverse() * sun.direction();
            // A sky that is squeezed to nothing has no directions.
            if let Some(direction) = direction.try_normalize() {
                daylight.sun = direction;
            }
        }
        if let Some(turbidity) = turbidity {
            daylight.turbidity = turbidity;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Daylight, Origin, TypeNameId};
    use glam::DAffine3;

    #[test]
    fn the_sun_is_where_it_was_put_however_the_sky_is_turned() {
        let origin = Origin { node: 1, type_name: TypeNameId(0) };
        let mut sky = Sky::uniform([1.0; 3], origin);
        let sun = SunPosition { azimuth: 120.0, elevation: 30.0 };
        assert!(sky.daylight().is_none() && !sky.set_daylight(Some(sun), None));
        let daylight = Daylight { sun: DVec3::X, turbidity: 6.0, factor: 1.0, shines: true, has_sun: true };
        sky.radiance = SkyRadiance::Daylight(daylight);
        sky.world_from_sky = DAffine3::from_axis_angle(DVec3::ONE.normalize(), 1.0);
        assert!(sky.set_daylight(Some(sun), Some(3.0)));
        let (found, turbidity) = sky.daylight().unwrap();
        assert!(
            (found.azimuth - 120.0).abs() < 1e-9 && (found.elevation - 30.0).abs() < 1e-9 && turbidity == 3.0
        );
    }
}
