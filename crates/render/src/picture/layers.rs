//! What an EXR can hold beside the picture itself.

use crate::CompiledScene;
use crate::bands::Band;
use crate::film::{mean_radiance, variance_of_mean};
use bytemuck::Zeroable;
use exr::prelude::{SampleType, Text};
use kernels::records::kernel::LayerPixel;
use std::str::FromStr;

/// A layer of an EXR.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Share of light that the surface sends on; `albedo.R`, `albedo.G`, `albedo.B`.
    Albedo,
    /// Unit normal towards the camera in the world; `N.X`, `N.Y`, `N.Z`.
    Normal,
    /// Distance from the plane of the camera in metres, infinite where nothing is met; `Z`.
    Depth,
    /// Position in the world in metres; `P.X`, `P.Y`, `P.Z`.
    Position,
    /// Node of the scene file, and node of the instance that it is part of; `objectId` and `instanceId`.
    Object,
    /// Number of the material, counted from 1; `materialId`.
    Material,
    /// Number of samples; `samples`.
    Samples,
    /// Variance of the picture's radiance, estimated from the samples; `variance.R`, `variance.G`, `variance.B`.
    Variance,
}

impl Layer {
    /// All layers with their names.
    pub const ALL: [(&'static str, Layer); 8] = [
        ("albedo", Layer::Albedo),
        ("normal", Layer::Normal),
        ("depth", Layer::Depth),
        ("position", Layer::Position),
        ("object", Layer::Object),
        ("material", Layer::Material),
        ("samples", Layer::Samples),
        ("variance", Layer::Variance),
    ];

    fn channels(self) -> &'static [(&'static str, Quantity)] {
        use Quantity as Q;
        match self {
            Layer::Albedo => {
                &[("albedo.R", Q::Albedo(0)), ("albedo.G", Q::Albedo(1)), ("albedo.B", Q::Albedo(2))]
            }
            Layer::Normal => &[("N.X", Q::Normal(0)), ("N.Y", Q::Normal(1)), ("N.Z", Q::Normal(2))],
            Layer::Depth => &[("Z", Q::Depth)],
            Layer::Position => &[("P.X", Q::Position(0)), ("P.Y", Q::Position(1)), ("P.Z", Q::Position(2))],
            Layer::Object => &[("objectId", Q::Object), ("instanceId", Q::Instance)],
            Layer::Material => &[("materialId", Q::Material)],
            Layer::Samples => &[("samples", Q::Samples)],
            Layer::Variance => &[
                ("variance.R", Q::Variance(0)),
                ("variance.G", Q::Variance(1)),
                ("variance.B", Q::Variance(2)),
            ],
        }
    }

    /// Whether it takes rays of its own.
    fn is_traced(self) -> bool {
        !matches!(self, Layer::Samples | Layer::Variance)
    }
}

/// Which layers are wanted, each once, and by what the picture was denoised.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layers {
    wanted: Vec<Layer>,
    denoiser: Option<String>,
}

impl Layers {
    /// Whether none are wanted.
    pub fn is_empty(&self) -> bool {
        self.wanted.is_empty()
    }

    /// Whether any takes rays of its own.
    pub fn are_traced(&self) -> bool {
        self.wanted.iter().any(|layer| layer.is_traced())
    }

    /// Those of a picture that was denoised: `noisy.R`, `noisy.G`, `noisy.B` hold the mean of the samples, which has
    /// no bias, and the file names the denoiser.
    pub fn denoised_by(self, denoiser: String) -> Self {
        Layers { denoiser: Some(denoiser), ..self }
    }

    pub(super) fn denoiser(&self) -> Option<&str> {
        self.denoiser.as_deref()
    }

    /// The channels of the picture and its layers, in the order of their names, as EXR wants it.
    pub(super) fn channels(&self) -> Vec<(&'static str, Quantity)> {
        let mut channels =
            vec![("B", Quantity::Radiance(2)), ("G", Quantity::Radiance(1)), ("R", Quantity::Radiance(0))];
        channels.extend(self.wanted.iter().flat_map(|layer| layer.channels()));
        if self.denoiser.is_some() {
            let noisy = [("noisy.R", 0), ("noisy.G", 1), ("noisy.B", 2)];
            channels.extend(noisy.map(|(name, channel)| (name, Quantity::Noisy(channel))));
        }
        channels.sort_by_key(|(name, _)| *name);
        channels
    }
}

impl FromStr for Layers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut layers = Vec::new();
        for name in text.split(',').map(str::trim) {
            match Layer::ALL.iter().find(|(known, _)| *known == name) {
                Some((_, layer)) => layers.push(*layer),
                None if name == "all" => layers.extend(Layer::ALL.map(|(_, layer)| layer)),
                None => {
                    let known = Layer::ALL.map(|(name, _)| name).join(", ");
                    return Err(format!("`{name}` is no layer; there are {known}, and all"));
                }
            }
        }
        layers.sort_unstable();
        layers.dedup();
        Ok(Layers { wanted: layers, denoiser: None })
    }
}

/// A number that a pixel has; the argument counts red, green, blue or x, y, z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// As the picture is shown.
    Radiance(usize),
    /// Before it was denoised.
    Noisy(usize),
    Albedo(usize),
    Normal(usize),
    Depth,
    Position(usize),
    Object,
    Instance,
    Material,
    Samples,
    Variance(usize),
}

impl Quantity {
    pub(super) fn sample_type(self) -> SampleType {
        match self {
            Quantity::Object | Quantity::Instance | Quantity::Material | Quantity::Samples => SampleType::U32,
            _ => SampleType::F32,
        }
    }

    /// The bytes of the number in a pixel of a band.
    fn bytes(self, band: &Band<'_>, pixel: usize, layers: &LayerPixel, origins: &Origins) -> [u8; 4] {
        let film = &band.pixels[pixel];
        let hits = layers.hits.max(1) as f32;
        match self {
            Quantity::Radiance(c) => band.radiance(pixel)[c].to_ne_bytes(),
            Quantity::Noisy(c) => mean_radiance(film)[c].to_ne_bytes(),
            Quantity::Variance(c) => variance_of_mean(film)[c].to_ne_bytes(),
            Quantity::Samples => film.samples.to_ne_bytes(),
            Quantity::Albedo(c) => (layers.albedo.to_array()[c] / layers.samples.max(1) as f32).to_ne_bytes(),
            Quantity::Normal(c) => {
                let normal = layers.normal.to_array();
                let length = normal.iter().map(|n| n * n).sum::<f32>().sqrt();
                (if length > 0.0 { normal[c] / length } else { 0.0 }).to_ne_bytes()
            }
            Quantity::Depth if layers.hits == 0 => f32::INFINITY.to_ne_bytes(),
            Quantity::Depth => (layers.depth / hits).to_ne_bytes(),
            Quantity::Position(_) if layers.hits == 0 => 0.0f32.to_ne_bytes(),
            Quantity::Position(c) => {
                let local = layers.position.to_array()[c] / hits;
                ((f64::from(local) + origins.world[c]) as f32).to_ne_bytes()
            }
            Quantity::Object => origins.node(layers.object).to_ne_bytes(),
            Quantity::Instance => origins.node(layers.instance).to_ne_bytes(),
            Quantity::Material => layers.material.to_ne_bytes(),
        }
    }
}

/// What the numbers in layers stand for.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    /// Origin of the compiled scene in the world.
    world: [f64; 3],
    /// Ids of the nodes that objects come from.
    nodes: Vec<u32>,
    /// Id and type of every node that is drawn.
    manifest: String,
}

/// Most bytes of the list of nodes in a file.
const MANIFEST_BYTES: usize = 1 << 20;

impl Origins {
    /// Those of a scene.
    pub fn of(scene: &CompiledScene) -> Self {
        let mut named: Vec<_> = scene.origins.iter().map(|origin| (origin.node, origin.type_name)).collect();
        named.sort_unstable_by_key(|(node, name)| (*node, name.index()));
        named.dedup();
        let mut manifest = String::new();
        for (node, name) in named {
            let name = scene.type_names.get(name.index()).map_or("", String::as_str);
            manifest.push_str(&format!("{node} {name}\n"));
            if manifest.len() > MANIFEST_BYTES {
                manifest.push_str("...\n");
                break;
            }
        }
        Origins {
            world: scene.origin.to_array(),
            // GroIMP counts nodes from 0 with 64 bits; the lower half tells those of one project apart.
            nodes: scene.origins.iter().map(|origin| origin.node as u32).collect(),
            manifest,
        }
    }

    /// One line for every node that is drawn: its id and the type that it has in the scene file.
    pub(super) fn manifest(&self) -> Option<Text> {
        // File text is limited to one byte per character.
        Text::new_or_none(&self.manifest).filter(|_| !self.manifest.is_empty())
    }

    /// `number` as in `LayerPixel::object`.
    fn node(&self, number: u32) -> u32 {
        let index = number.checked_sub(1);
        index.and_then(|index| self.nodes.get(index as usize)).copied().unwrap_or(0)
    }
}

/// The bytes of some rows of a band as an EXR block holds them: row by row, in each channel by channel.
pub(super) fn block_bytes(
    band: &Band<'_>,
    rows: std::ops::Range<usize>,
    channels: &[(&'static str, Quantity)],
    origins: &Origins,
) -> Vec<u8> {
    let width = band.width as usize;
    let empty = LayerPixel::zeroed();
    let mut bytes = Vec::with_capacity(rows.len() * width * channels.len() * 4);
    for row in rows {
        for (_, quantity) in channels {
            for pixel in row * width..(row + 1) * width {
                let layers = band.layers.get(pixel).unwrap_or(&empty);
                bytes.extend_from_slice(&quantity.bytes(band, pixel, layers, origins));
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_named_and_listed_once() {
        let two: Layers = "depth, albedo,depth".parse().unwrap();
        assert_eq!(two.wanted, [Layer::Albedo, Layer::Depth]);
        let all: Layers = "all".parse().unwrap();
        assert_eq!(all.wanted.len(), Layer::ALL.len());
        assert!(all.are_traced() && !"samples,variance".parse::<Layers>().unwrap().are_traced());
        let message = "colour".parse::<Layers>().unwrap_err();
        assert!(message.contains("colour") && message.contains("albedo, normal"), "{message}");
        let names: Vec<_> = all.channels().iter().map(|(name, _)| *name).collect();
        assert!(names.is_sorted() && names.len() == 20, "{names:?}");
        let denoised = Layers::default().denoised_by("a denoiser".to_owned());
        let names: Vec<_> = denoised.channels().iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["B", "G", "R", "noisy.B", "noisy.G", "noisy.R"]);
    }
}
