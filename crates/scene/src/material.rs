use crate::{ImageId, MaterialId, Rgb, index_type};
use glam::{DMat2, DVec2};

index_type!(
    /// Position in [`Scene::channels`](crate::Scene::channels).
    ChannelId
);

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
}

/// A node of a channel tree: a function from a surface point to a colour with alpha. It refers only to channels
/// that come before it.
#[derive(Clone, Debug, PartialEq)]
pub enum Channel {
    /// The same colour everywhere, alpha 1.
    Constant(Rgb),
    /// A picture, repeated in u and v; v = 0 is its bottom row.
    ImageMap {
        /// The picture.
        image: ImageId,
        /// Interpolate between pixels; otherwise the nearest pixel.
        bilinear: bool,
        /// Applied one after the other to the coordinates of the surface.
        coordinates: Vec<CoordinateMap>,
    },
    /// A checkerboard with two by two fields per unit of u and v. The channels in its fields see the coordinates
    /// of the surface.
    Checker {
        /// In fields where floor(2u) + floor(2v) is odd.
        odd: ChannelId,
        /// In the other fields.
        even: ChannelId,
        /// Applied one after the other to the coordinates of the surface.
        coordinates: Vec<CoordinateMap>,
    },
}

/// A change of the coordinates at which a channel is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub enum CoordinateMap {
    /// `linear * ((u, v) - offset)`, GroIMP's `AffineUVTransformation`.
    AffineUv {
        /// Taken away first.
        offset: DVec2,
        /// Rotation, shear and scale.
        linear: DMat2,
    },
}
