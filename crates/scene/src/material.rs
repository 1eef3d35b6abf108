use crate::{ChannelId, MaterialId, NormalMap, Rgb};

/// How a surface reflects and transmits light.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// A two-sided Lambertian colour, GroIMP's `RGBAShader`.
    Rgba {
        /// Albedo, as a rule in [0, 1].
        color: Rgb,
        /// Share of light that meets the surface; the rest passes straight through. In [0, 1].
        opacity: f64,
    },
    /// GroIMP's `Phong`, also the plain Lambertian surface with a picture on it.
    Phong(Phong),
    /// One material for each side, GroIMP's `SideSwitchShader`. Neither of them is such a switch itself.
    SideSwitch {
        /// Of the side that normals point to.
        front: MaterialId,
        /// Of the other side.
        back: MaterialId,
    },
}

/// GroIMP's `Phong` material: every coefficient is a channel that may vary over the surface.
/// A missing channel is 0, except `shininess` (exponent 4) and `transparency_shininess` (clear).
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Phong {
    /// Diffuse reflection; the alpha of a picture in this channel cuts the surface out.
    pub diffuse: Option<ChannelId>,
    /// Glossy reflection.
    pub specular: Option<ChannelId>,
    /// GroIMP's shininess value of the reflected lobe in [0, 1], not the exponent.
    pub shininess: Option<ChannelId>,
    /// Straight or refracted transmission.
    pub transparency: Option<ChannelId>,
    /// GroIMP's shininess value of the transmitted lobe in [0, 1].
    pub transparency_shininess: Option<ChannelId>,
    /// Diffuse transmission, as of a leaf held against the light.
    pub diffuse_transparency: Option<ChannelId>,
    /// Reflection of scene-wide ambient light; used by the ray tracer only.
    pub ambient: Option<ChannelId>,
    /// Emitted radiance in W/(m² sr).
    pub emissive: Option<ChannelId>,
    /// Whether transparency takes away from diffuse and glossy reflection (GroIMP's default).
    pub interpolated_transparency: bool,
    /// What bends the shading normal, applied one after the other.
    pub normal_maps: Vec<NormalMap>,
}
