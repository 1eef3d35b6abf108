//! Lights: point, spot, directional, area lights and plain skies.

use crate::ReadError;
use crate::channels::color_of;
use crate::fields::{Field, Fields, number_of};
use crate::graph::Graph;
use crate::values::{Kind, Value};
use glam::{DAffine3, DVec3};
use scene::{Camera, Emission, LightKind, Rgb};

/// What a light value turned out to be.
pub(crate) enum LightValue {
    /// Null: nothing shines.
    None,
    Light {
        kind: LightKind,
        shadowless: bool,
    },
    /// Class and reason.
    Skipped(String, &'static str),
}

/// The emission of a light of that power: a brighter colour does not add power.
pub(crate) fn share(power: f64, color: Rgb) -> Rgb {
    let sum: f64 = color.iter().sum();
    if sum > 0.0 && sum.is_finite() { color.map(|c| power * c / sum) } else { [power / 3.0; 3] }
}

/// The light of a LightNode.
pub(crate) fn light(fields: &Fields<'_>) -> Result<LightValue, ReadError> {
    let white_point = LightKind::Point { power: share(100.0, [1.0; 3]) };
    let Field::File(value) = fields.get("light") else {
        return Ok(LightValue::Light { kind: white_point, shadowless: false });
    };
    if value.kind == Kind::Null {
        return Ok(LightValue::None);
    }
    let class = fields.graph.values.type_of(value).unwrap_or("de.grogra.imp3d.objects.PointLight");
    let member = Members { graph: fields.graph, value, class };
    let color = member.color()?;
    let kind = match class.rsplit('.').next().unwrap_or("") {
        "PointLight" => LightKind::Point { power: share(member.number("power", 100.0)?, color) },
        "SpotLight" => {
            let pi = std::f64::consts::PI;
            let (inner, outer) =
                (member.number("innerAngle", pi / 8.0)?, member.number("outerAngle", pi / 6.0)?);
            if !inner.is_finite() || !outer.is_finite() {
                return Ok(LightValue::Skipped(class.to_owned(), "an angle of its cone is not a number"));
            }
            let inner_angle = inner.clamp(0.0, pi);
            let outer_angle = outer.clamp(inner_angle, pi);
            LightKind::Spot { power: share(member.number("power", 100.0)?, color), inner_angle, outer_angle }
        }
        "DirectionalLight" => {
            LightKind::Directional { irradiance: share(member.number("powerDensity", 10.0)?, color) }
        }
        _ => return Ok(LightValue::Skipped(class.to_owned(), "lights of this class are not supported yet")),
    };
    let (LightKind::Point { power }
    | LightKind::Spot { power, .. }
    | LightKind::Directional { irradiance: power }) = &kind;
    if !power.iter().all(|p| p.is_finite() && *p >= 0.0) {
        return Ok(LightValue::Skipped(class.to_owned(), "its power is negative or not a number"));
    }
    Ok(LightValue::Light { kind, shadowless: member.flag("shadowless") })
}

/// The area light of a Parallelogram whose shader has the average colour `color`; an error text if it cannot
/// shine.
pub(crate) fn area_light(
    fields: &Fields<'_>,
    color: Rgb,
) -> Result<Option<Result<Emission, String>>, ReadError> {
    let Field::File(value) = fields.get("light") else { return Ok(None) };
    if value.kind == Kind::Null {
        return Ok(None);
    }
    let class = fields.graph.values.type_of(value).unwrap_or("de.grogra.imp3d.objects.AreaLight");
    if !class.ends_with(".AreaLight") {
        return Ok(Some(Err(format!("its light of class '{class}' is not supported yet"))));
    }
    let member = Members { graph: fields.graph, value, class };
    let power = member.number("power", 100.0)?;
    let exponent = member.number("exponent", 4.0)?;
    if !(power.is_finite() && power >= 0.0 && exponent.is_finite() && exponent >= 0.0) {
        return Ok(Some(Err("power or exponent of its light is negative or not a number".to_owned())));
    }
    let shadowless = member.flag("shadowless");
    Ok(Some(Ok(Emission { power: share(power, color), exponent, shadowless })))
}

/// Radiance of a sky with a plain shader.
pub(crate) fn sky_radiance(power_density: f64, color: Rgb) -> Rgb {
    color.map(|c| power_density * c / (12.0 * std::f64::consts::PI))
}

/// The light that GroIMP's renderers add to a scene without one: its kind and its placement.
pub(crate) fn default_light(camera: &Camera) -> (LightKind, DAffine3) {
    let position_view = DVec3::new(-3000.0, 3000.0, 10000.0);
    let z = -position_view.normalize();
    let (x, y) = z.any_orthonormal_pair();
    let view_from_light = DAffine3::from_mat3_translation(glam::DMat3::from_cols(x, y, z), position_view);
    let kind = LightKind::Directional { irradiance: share(10.0, [1.0; 3]) };
    (kind, camera.view_from_world.inverse() * view_from_light)
}

/// Fields of a light, which is a value and not a node.
struct Members<'a> {
    graph: &'a Graph,
    value: &'a Value,
    class: &'a str,
}

impl Members<'_> {
    fn find(&self, name: &str) -> Option<&Value> {
        self.graph.values.find(self.value.members, name)
    }

    fn number(&self, name: &str, default: f64) -> Result<f64, ReadError> {
        self.find(name).map_or(Ok(default), |value| number_of(self.graph, value, self.class, name))
    }

    fn flag(&self, name: &str) -> bool {
        self.find(name).is_some_and(|value| value.text() == "true")
    }

    fn color(&self) -> Result<Rgb, ReadError> {
        self.find("color").map_or(Ok([1.0; 3]), |value| color_of(self.graph, value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brighter_colours_add_no_power() {
        assert_eq!(share(400.0, [1.0; 3]), [400.0 / 3.0; 3]);
        assert_eq!(share(100.0, [3.0, 1.0, 0.0]), [75.0, 25.0, 0.0]);
        assert_eq!(share(3.0, [0.0; 3]), [1.0; 3]);
    }

    #[test]
    fn the_default_light_comes_from_behind_the_camera() {
        let camera = Camera::default();
        let (_, world_from_light) = default_light(&camera);
        let direction_view =
            camera.view_from_world.transform_vector3(world_from_light.transform_vector3(DVec3::Z));
        assert!((direction_view - DVec3::new(3.0, -3.0, -10.0).normalize()).length() < 1e-12);
    }
}
