//! SunSkyLight: the fields of a clear sky.

use crate::ReadError;
use crate::field_errors::wrong_value;
use crate::object_fields::ObjectFields;
use crate::output::Output;
use crate::values::{Kind, parse_numbers};
use glam::DVec3;
use scene::Daylight;

/// Within these turbidities the model gives colours.
const TURBIDITIES: (f64, f64) = (1.7, 10.0);

/// What a SunSkyLight turned out to be.
pub(crate) enum DaylightValue {
    Sky(Daylight),
    /// And why.
    Unusable(&'static str),
}

/// Reads a SunSkyLight. A disabled sun neither shows nor shines; in GroIMP it is invisible, but its light stays.
pub(crate) fn daylight(
    object: &ObjectFields<'_>,
    line: usize,
    out: &mut Output,
) -> Result<DaylightValue, ReadError> {
    let sun = match object.find("sun").filter(|value| value.kind != Kind::Null) {
        None => DVec3::new(0.0, 1.0, 0.4),
        Some(value) => match parse_numbers(value.text()).as_deref() {
            Some(&[x, y, z]) => DVec3::new(x, y, z),
            // Attribute form.
            Some(&[]) => {
                let vector = ObjectFields { members: value.members, ..*object };
                DVec3::new(vector.number("x", 0.0)?, vector.number("y", 0.0)?, vector.number("z", 0.0)?)
            }
            _ => return Err(wrong_value(object.graph, value, object.class, "sun", "three numbers")),
        },
    };
    if sun.try_normalize().is_none() {
        return Ok(DaylightValue::Unusable("the direction to its sun is zero or not a number"));
    }
    let factor = object.number("radianceFactor", 1.0)?;
    let stored = object.number("turbidity", 6.0)?;
    if !(factor.is_finite() && factor >= 0.0 && stored.is_finite()) {
        return Ok(DaylightValue::Unusable("its radianceFactor or turbidity is negative or not a number"));
    }
    let turbidity = stored.clamp(TURBIDITIES.0, TURBIDITIES.1);
    if turbidity != stored {
        let message =
            format!("a SunSkyLight has turbidity {stored}, where its model fails; {turbidity} is used");
        out.report.warn(message, object.graph.location(line));
    }
    Ok(DaylightValue::Sky(Daylight {
        sun,
        turbidity,
        factor,
        shines: !object.flag("disableLight", false),
        has_sun: !object.flag("disableSun", false),
    }))
}
