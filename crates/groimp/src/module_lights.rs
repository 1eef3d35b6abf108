//! Lights that modules make in their bodies: `LightNode().(setLight(new SpotLight().(setPower(10))))`.

use crate::lights::{LightValue, attenuation, share};
use crate::modules::{StaticLight, StaticValue};
use scene::{Emission, LightKind, Rgb};
use std::f64::consts::PI;

impl StaticLight {
    fn number(&self, name: &str, default: f64) -> f64 {
        match self.properties.get(name) {
            Some(StaticValue::Number(number)) => *number,
            _ => default,
        }
    }

    fn flag(&self, name: &str) -> bool {
        self.properties.get(name) == Some(&StaticValue::Bool(true))
    }

    fn color(&self) -> Rgb {
        match self.properties.get("color") {
            Some(StaticValue::Vector(color)) => *color,
            _ => [1.0; 3],
        }
    }
}

/// The light of a LightNode; the defaults are those of the classes.
pub(crate) fn light(light: &StaticLight) -> LightValue {
    let skipped = |reason| LightValue::Skipped(light.class.clone(), reason);
    let strength = |name: &str, default: f64| {
        let strength = light.number(name, default);
        (strength.is_finite() && strength >= 0.0).then(|| share(strength, light.color()))
    };
    let kind = match light.class.rsplit('.').next().unwrap_or("") {
        "PointLight" => strength("power", 100.0).map(|power| LightKind::Point { power }),
        "SpotLight" => {
            let (inner, outer) = (light.number("innerAngle", PI / 8.0), light.number("outerAngle", PI / 6.0));
            if !inner.is_finite() || !outer.is_finite() {
                return skipped("an angle of its cone is not a number");
            }
            let inner_angle = inner.clamp(0.0, PI);
            let outer_angle = outer.clamp(inner_angle, PI);
            strength("power", 100.0).map(|power| LightKind::Spot { power, inner_angle, outer_angle })
        }
        "DirectionalLight" => {
            strength("powerDensity", 10.0).map(|irradiance| LightKind::Directional { irradiance })
        }
        _ => return skipped("lights of this class in bodies of modules are not supported"),
    };
    match kind {
        Some(kind) => {
            let (exponent, distance) =
                (light.number("attenuationExponent", 0.0), light.number("attenuationDistance", 1.0));
            let attenuation = attenuation(exponent, distance);
            LightValue::Light { kind, attenuation, shadowless: light.flag("shadowless") }
        }
        None => skipped("its power is negative or not a number"),
    }
}

/// The area light of a Parallelogram whose shader has the average colour `color`; an error text if it cannot shine.
pub(crate) fn area_light(light: &StaticLight, color: Rgb) -> Result<Emission, String> {
    if !light.class.ends_with(".AreaLight") {
        return Err(format!("its light of class '{}' is not supported", light.class));
    }
    let (power, exponent) = (light.number("power", 100.0), light.number("exponent", 4.0));
    if !(power.is_finite() && power >= 0.0 && exponent.is_finite() && exponent >= 0.0) {
        return Err("power or exponent of its light is negative or not a number".to_owned());
    }
    Ok(Emission { power: share(power, color), exponent, shadowless: light.flag("shadowless") })
}
