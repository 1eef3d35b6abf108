//! Lights and skies of the tree, and the light that a scene without one gets.

use crate::ReadError;
use crate::build::{Builder, Site};
use crate::daylight::{self, DaylightValue};
use crate::fields::{Field, Fields};
use crate::lights::{self, LightValue};
use crate::module_lights;
use crate::modules::StaticValue;
use crate::object_fields::ObjectFields;
use crate::references::Found;
use crate::shapes;
use scene::{Light, MaterialId, Sky, SkyRadiance};

impl<'a> Builder<'a> {
    /// A light shines also when its layer is hidden (unverified).
    pub fn light(&mut self, site: &Site, fields: &Fields<'_>) -> Result<(), ReadError> {
        let light = match fields.get("light") {
            Field::Module(StaticValue::Light(light)) => module_lights::light(light),
            Field::Module(StaticValue::Null) => LightValue::None,
            _ => lights::light(fields, &mut self.shaders, &mut self.distributions, &mut self.out)?,
        };
        match light {
            LightValue::None => {}
            LightValue::Skipped(class, reason) => self.out.report.skip(&class, reason),
            LightValue::Ambient(color) => {
                // It does not count as a light: without another one the path tracer's picture would be black.
                for (sum, c) in self.out.scene.ambient.iter_mut().zip(color) {
                    *sum += c;
                }
                self.out.report.warn("an AmbientLight acts in the ray tracer only", None);
            }
            LightValue::Light { .. } if !shapes::is_invertible(&site.frames.own) => {
                self.skip(site.node, "its transformation is flat or not a number");
            }
            LightValue::Light { kind, attenuation, shadowless } => {
                let origin = self.origin(site.node);
                let world_from_light = site.frames.own;
                let light = Light { kind, world_from_light, attenuation, shadowless, origin };
                self.out.scene.lights.push(light);
                self.has_light = true;
            }
            // That the sky of a LightNode is seen, too, is unverified.
            LightValue::Sky(daylight) => self.set_sky(site, SkyRadiance::Daylight(daylight)),
        }
        Ok(())
    }

    /// The SunSkyLight that the shader of a sky is.
    pub fn sun_sky<'f>(&self, fields: &Fields<'f>) -> Option<Found<'f>>
    where
        'a: 'f,
    {
        let Field::File(value) = fields.get("shader") else { return None };
        self.shaders.references.follow(value).filter(|found| found.class.ends_with(".SunSkyLight"))
    }

    pub fn sky(
        &mut self,
        site: &Site,
        fields: &Fields<'_>,
        sun_sky: Option<Found<'_>>,
        material: MaterialId,
    ) -> Result<(), ReadError> {
        if let Some(Found { class, members, line }) = sun_sky {
            let object = ObjectFields { graph: self.graph, members, class };
            match daylight::daylight(&object, line, &mut self.out)? {
                DaylightValue::Sky(daylight) => self.set_sky(site, SkyRadiance::Daylight(daylight)),
                DaylightValue::Unusable(reason) => self.skip(site.node, reason),
            }
            return Ok(());
        }
        let power_density = fields.number("powerDensity", 50.0)?;
        if !power_density.is_finite() || power_density < 0.0 {
            self.skip(site.node, "its powerDensity is negative or not a number");
        } else {
            self.set_sky(site, lights::sky_radiance(power_density, material, &self.out.scene));
        }
        Ok(())
    }

    /// A scene has one sky: the first one.
    fn set_sky(&mut self, site: &Site, radiance: SkyRadiance) {
        if self.out.scene.sky.is_some() {
            self.skip(site.node, "there is another sky before it");
        } else if !shapes::is_invertible(&site.frames.own) {
            self.skip(site.node, "its transformation is flat or not a number");
        } else {
            let origin = self.origin(site.node);
            // A sky that does not shine is no light; then the default light is added (unverified).
            self.has_light |= match &radiance {
                SkyRadiance::Daylight(daylight) => daylight.shines,
                SkyRadiance::Uniform(_) | SkyRadiance::Channel { .. } => true,
            };
            self.out.scene.sky = Some(Sky { radiance, world_from_sky: site.frames.own, origin });
        }
    }

    pub fn add_default_light(&mut self) {
        let (kind, world_from_light) = lights::default_light(&self.view.camera);
        let origin = self.out.origin(-1, "default light");
        self.out.scene.lights.push(Light {
            kind,
            world_from_light,
            attenuation: Default::default(),
            shadowless: true,
            origin,
        });
        let message =
            "the scene has no light; GroIMP's default light from the upper left behind the camera is added";
        self.out.report.warn(message, None);
    }
}
