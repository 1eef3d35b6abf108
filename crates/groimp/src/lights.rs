//! Lights: point, spot, directional, physical, ambient and area lights, and skies with a plain shader.

use crate::ReadError;
use crate::daylight::{self, DaylightValue};
use crate::distributions::Distributions;
use crate::fields::{Field, Fields};
use crate::object_fields::ObjectFields;
use crate::output::Output;
use crate::shaders::Shaders;
use crate::values::Kind;
use glam::{DAffine3, DVec3};
use scene::{
    Attenuation, Camera, Daylight, Emission, LightKind, Material, MaterialId, Rgb, Scene, SkyRadiance,
};

/// What a light value turned out to be.
pub(crate) enum LightValue {
    /// Null: nothing shines.
    None,
    Light {
        kind: LightKind,
        attenuation: Attenuation,
        shadowless: bool,
    },
    /// An AmbientLight of that colour.
    Ambient(Rgb),
    /// A SunSkyLight.
    Sky(Daylight),
    /// Class and reason.
    Skipped(String, &'static str),
}

/// Lights wrap lights; a longer chain is a cycle.
const LONGEST_CHAIN: usize = 16;

/// The emission of a light of that power: a brighter colour does not add power.
pub(crate) fn share(power: f64, color: Rgb) -> Rgb {
    let sum: f64 = color.iter().sum();
    if sum > 0.0 && sum.is_finite() { color.map(|c| power * c / sum) } else { [power / 3.0; 3] }
}

/// The light of a LightNode.
pub(crate) fn light(
    fields: &Fields<'_>,
    shaders: &mut Shaders<'_>,
    distributions: &mut Distributions,
    out: &mut Output,
) -> Result<LightValue, ReadError> {
    let white_point = LightKind::Point { power: share(100.0, [1.0; 3]) };
    let Field::File(value) = fields.get("light") else {
        return Ok(checked(white_point, Attenuation::default(), false, "PointLight"));
    };
    let graph = fields.graph;
    let mut value = value;
    // What a SpectralLight around it says.
    let mut spectral_power = None;
    for _ in 0..LONGEST_CHAIN {
        if value.kind == Kind::Null {
            return Ok(LightValue::None);
        }
        let Some(found) = shaders.references.follow(value) else {
            return Ok(LightValue::Skipped("LightNode".to_owned(), "its light is not in the file"));
        };
        let class = if found.class.is_empty() { "de.grogra.imp3d.objects.PointLight" } else { found.class };
        let object = ObjectFields { graph, members: found.members, class };
        if !class.ends_with(".SpectralLight") {
            return object.light(found.line, spectral_power, shaders, distributions, out);
        }
        out.report.warn(
            "the spectrum of a SpectralLight is taken as white; its power and the light in it are used",
            graph.location(found.line),
        );
        let power = object.number("power", 100.0)?;
        spectral_power = spectral_power.or(Some(power));
        match graph.values.find(found.members, "light") {
            Some(inner) => value = inner,
            None => {
                let kind = LightKind::Point { power: share(power, [1.0; 3]) };
                return Ok(checked(kind, Attenuation::default(), false, class));
            }
        }
    }
    Ok(LightValue::Skipped("LightNode".to_owned(), "its light contains itself"))
}

/// The light, unless its power is no power.
fn checked(kind: LightKind, attenuation: Attenuation, shadowless: bool, class: &str) -> LightValue {
    let (LightKind::Point { power }
    | LightKind::Spot { power, .. }
    | LightKind::Physical { power, .. }
    | LightKind::Directional { irradiance: power }) = &kind;
    if !power.iter().all(|p| p.is_finite() && *p >= 0.0) {
        return LightValue::Skipped(class.to_owned(), "its power is negative or not a number");
    }
    LightValue::Light { kind, attenuation, shadowless }
}

/// How a light fades, from the fields of a PointLight; numbers that make no sense leave it as bright everywhere.
pub(crate) fn attenuation(exponent: f64, distance: f64) -> Attenuation {
    if exponent.is_finite() && exponent > 0.0 && distance.is_finite() && distance > 0.0 {
        Attenuation { exponent, distance }
    } else {
        Attenuation::default()
    }
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
    let object = ObjectFields { graph: fields.graph, members: value.members, class };
    let power = object.number("power", 100.0)?;
    let exponent = object.number("exponent", 4.0)?;
    if !(power.is_finite() && power >= 0.0 && exponent.is_finite() && exponent >= 0.0) {
        return Ok(Some(Err("power or exponent of its light is negative or not a number".to_owned())));
    }
    let shadowless = object.flag("shadowless", false);
    Ok(Some(Ok(Emission { power: share(power, color), exponent, shadowless })))
}

/// Radiance of a sky with an ordinary shader: a diffuse colour or picture. What else the shader does is unverified
/// and left out.
pub(crate) fn sky_radiance(power_density: f64, material: MaterialId, scene: &Scene) -> SkyRadiance {
    // A third for each channel, over π, and GroIMP's factor ¼.
    let factor = power_density / (12.0 * std::f64::consts::PI);
    let uniform = |color: Rgb| SkyRadiance::Uniform(color.map(|c| (factor * c).max(0.0)));
    let shown = match &scene.materials[material.index()] {
        // Which side of the sky is seen is unverified.
        Material::SideSwitch { front, .. } => &scene.materials[front.index()],
        material => material,
    };
    match shown {
        Material::Rgba { color, opacity: _ } => uniform(*color),
        Material::SideSwitch { .. } => uniform([0.0; 3]),
        Material::Phong(phong) => match phong.diffuse {
            None => uniform([0.0; 3]),
            Some(channel) => match &scene.channels[channel.index()] {
                scene::Channel::Constant(color) => uniform(*color),
                _ => SkyRadiance::Channel { channel, factor },
            },
        },
    }
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

impl ObjectFields<'_> {
    /// The light that the object is.
    fn light(
        &self,
        line: usize,
        spectral_power: Option<f64>,
        shaders: &mut Shaders<'_>,
        distributions: &mut Distributions,
        out: &mut Output,
    ) -> Result<LightValue, ReadError> {
        // In a SpectralLight the spectrum stands for the colour.
        let color = if spectral_power.is_some() { [1.0; 3] } else { self.color()? };
        let power = |name, default| match spectral_power {
            Some(power) => Ok(share(power, color)),
            None => Ok(share(self.number(name, default)?, color)),
        };
        let kind = match self.class.rsplit('.').next().unwrap_or("") {
            "PointLight" => LightKind::Point { power: power("power", 100.0)? },
            "SpotLight" => {
                let pi = std::f64::consts::PI;
                let (inner, outer) =
                    (self.number("innerAngle", pi / 8.0)?, self.number("outerAngle", pi / 6.0)?);
                if !inner.is_finite() || !outer.is_finite() {
                    let reason = "an angle of its cone is not a number";
                    return Ok(LightValue::Skipped(self.class.to_owned(), reason));
                }
                let inner_angle = inner.clamp(0.0, pi);
                let outer_angle = outer.clamp(inner_angle, pi);
                LightKind::Spot { power: power("power", 100.0)?, inner_angle, outer_angle }
            }
            "DirectionalLight" => LightKind::Directional { irradiance: power("powerDensity", 10.0)? },
            "PhysicalLight" => {
                let power = power("power", 100.0)?;
                match distributions.of_light(self, line, shaders, out)? {
                    Some(distribution) => LightKind::Physical { power, distribution },
                    None => LightKind::Point { power },
                }
            }
            "AmbientLight" if color.iter().all(|c| c.is_finite()) => return Ok(LightValue::Ambient(color)),
            "SunSkyLight" => {
                return Ok(match daylight::daylight(self, line, out)? {
                    DaylightValue::Sky(daylight) => LightValue::Sky(daylight),
                    DaylightValue::Unusable(reason) => LightValue::Skipped(self.class.to_owned(), reason),
                });
            }
            _ => {
                let reason = "lights of this class are not supported yet";
                return Ok(LightValue::Skipped(self.class.to_owned(), reason));
            }
        };
        let attenuation =
            attenuation(self.number("attenuationExponent", 0.0)?, self.number("attenuationDistance", 1.0)?);
        Ok(checked(kind, attenuation, self.flag("shadowless", false), self.class))
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
