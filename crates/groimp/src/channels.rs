//! Channels of Phong shaders: constants, pictures and the maps of the modules `channel_maps`, `volume_maps`,
//! `blends`, `normal_maps` and `carpenter`.

use crate::ReadError;
use crate::field_errors::{number_of, wrong_value};
use crate::graph::{Graph, NodeIndex};
use crate::images::Images;
use crate::inline::registry_path;
use crate::modules::StaticChannel;
use crate::output::Output;
use crate::registry::Registry;
use crate::report::Location;
use crate::values::{Kind, Members, Value, parse_number, tokens};
use scene::{Channel, ChannelId, CoordinateMap, Effort, ImageId, Phong, Rgb};
use std::collections::HashMap;

/// Average colour of a shader.
pub(crate) struct Mean(pub Rgb);

/// Value of a picture that is not there.
pub(crate) const MISSING: Rgb = [0.5; 3];

/// Constants of `math.RGBColor`, 0xRRGGBB.
const COLORS: [[u8; 3]; 13] = [
    [0, 0, 0],
    [0, 0, 255],
    [0, 255, 255],
    [64, 64, 64],
    [128, 128, 128],
    [0, 255, 0],
    [192, 192, 192],
    [255, 0, 255],
    [255, 200, 0],
    [255, 175, 175],
    [255, 0, 0],
    [255, 255, 0],
    [255, 255, 255],
];

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Key {
    Constant([u64; 3]),
    Image(ImageId, bool),
}

/// Maps in maps are read so deep; beyond it stands a file made to exhaust the stack.
const MAX_DEPTH: u32 = 100;

/// Where a channel map stands in the file.
pub(crate) struct MapNode<'a> {
    pub class: &'a str,
    pub fields: Members,
    pub line: usize,
    /// The node, if it is one and not written in place.
    pub node: Option<NodeIndex>,
}

impl<'a> MapNode<'a> {
    /// The class without its package.
    pub fn short_class(&self) -> &'a str {
        self.class.rsplit('.').next().unwrap_or("")
    }
}

/// All channels of a scene, each built once.
pub(crate) struct Channels<'a> {
    pub(crate) graph: &'a Graph,
    registry: &'a Registry,
    images: Images,
    by_value: HashMap<Key, ChannelId>,
    /// What the nodes of maps became; `None` while one is being read.
    by_node: HashMap<NodeIndex, Option<ChannelId>>,
    means: Vec<Rgb>,
    efforts: Vec<Effort>,
    /// Pictures of `Carpenter` maps by the bits of their numbers.
    pub(crate) carpenters: HashMap<[u64; 3], ImageId>,
}

impl<'a> Channels<'a> {
    pub fn new(graph: &'a Graph, registry: &'a Registry, images: Images) -> Self {
        Channels {
            graph,
            registry,
            images,
            by_value: HashMap::new(),
            by_node: HashMap::new(),
            means: Vec::new(),
            efforts: Vec::new(),
            carpenters: HashMap::new(),
        }
    }

    /// Contents of a file of the project.
    pub fn read_file(&mut self, file: &str) -> Result<Option<Vec<u8>>, ReadError> {
        self.images.read_file(file)
    }

    /// A Phong shader from its fields in the file.
    pub fn phong(&mut self, fields: Members, out: &mut Output) -> Result<(Phong, Mean), ReadError> {
        let mut phong = self.plain_phong(self.graph.values.find(fields, "diffuse").is_some(), out);
        for name in CHANNEL_NAMES {
            if let Some(value) = self.graph.values.find(fields, name) {
                let channel = self.channel(value, name, 0, out)?;
                set(&mut phong, name, channel);
            }
        }
        if let Some(value) = self.graph.values.find(fields, "interpolatedTransparency") {
            phong.interpolated_transparency = value.text() != "false";
        }
        phong.normal_maps = self.normal_maps(fields, out)?;
        Ok(self.with_mean(phong))
    }

    /// A Phong shader that a module makes.
    pub fn module_phong(
        &mut self,
        channels: &[(String, StaticChannel)],
        out: &mut Output,
    ) -> Result<(Phong, Mean), ReadError> {
        let mut phong = self.plain_phong(channels.iter().any(|(name, _)| name == "diffuse"), out);
        for (name, channel) in channels {
            let channel = match channel {
                StaticChannel::Rgb(color) => self.constant(*color, out),
                StaticChannel::Gray(value) => self.constant([*value; 3], out),
                StaticChannel::Image(image) => {
                    let path = format!("/project/objects/images/{}", image.replace('/', "\\/"));
                    self.image(&path, true, Vec::new(), None, out)?
                }
            };
            set(&mut phong, name, Some(channel));
        }
        Ok(self.with_mean(phong))
    }

    /// What `new Phong()` is, without the diffuse channel if that is set in any case.
    fn plain_phong(&mut self, sets_diffuse: bool, out: &mut Output) -> Phong {
        let diffuse = if sets_diffuse { None } else { Some(self.constant([0.5; 3], out)) };
        Phong { diffuse, interpolated_transparency: true, ..Phong::default() }
    }

    fn with_mean(&self, phong: Phong) -> (Phong, Mean) {
        let mean = phong.diffuse.and_then(|id| self.means.get(id.index()).copied());
        (phong, Mean(mean.unwrap_or([0.0; 3])))
    }

    /// A channel, or a map inside of `depth` others.
    pub(crate) fn channel(
        &mut self,
        value: &'a Value,
        name: &str,
        depth: u32,
        out: &mut Output,
    ) -> Result<Option<ChannelId>, ReadError> {
        if value.kind == Kind::Null {
            return Ok(None);
        }
        let Some(map) = self.map_node(value) else {
            let message =
                format!("channel {name} refers to node '{}', which is not in the file", value.text());
            out.report.warn(message + "; grey is used instead", self.graph.location(value.line));
            return Ok(Some(self.constant(MISSING, out)));
        };
        if depth > MAX_DEPTH {
            let message = format!("channel maps are nested deeper than {MAX_DEPTH}; grey is used instead");
            out.report.warn(message, self.graph.location(map.line));
            return Ok(Some(self.constant(MISSING, out)));
        }
        let Some(node) = map.node else { return self.read_map(value, &map, depth, out).map(Some) };
        match self.by_node.get(&node) {
            Some(Some(id)) => Ok(Some(*id)),
            Some(None) => {
                let message = "a channel map contains itself; grey is used instead there";
                out.report.warn(message, self.graph.location(map.line));
                Ok(Some(self.constant(MISSING, out)))
            }
            None => {
                self.by_node.insert(node, None);
                let id = self.read_map(value, &map, depth, out)?;
                self.by_node.insert(node, Some(id));
                Ok(Some(id))
            }
        }
    }

    /// Where the map stands that a value is or refers to; `None` if there is no such node.
    pub(crate) fn map_node(&self, value: &'a Value) -> Option<MapNode<'a>> {
        if value.kind == Kind::Ref {
            let index = value.text().parse().ok().and_then(|id| self.graph.by_id(id))?;
            let node = self.graph.node(index);
            let class = self.graph.type_name(index);
            return Some(MapNode { class, fields: node.fields, line: node.line, node: Some(index) });
        }
        let class = self.graph.values.type_of(value).unwrap_or("");
        Some(MapNode { class, fields: value.members, line: value.line, node: None })
    }

    fn read_map(
        &mut self,
        value: &'a Value,
        map: &MapNode<'a>,
        depth: u32,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let MapNode { fields, line, .. } = *map;
        let constant = match map.short_class() {
            "RGBColor" => color_of(self.graph, value)?,
            "RGBAShader" => return self.rgba_map(value, map, out),
            "Graytone" => match self.graph.values.find(fields, "value") {
                Some(gray) => [number_of(self.graph, gray, "Graytone", "value")?; 3],
                None if value.kind == Kind::Object && value.text.is_some() => {
                    [number_of(self.graph, value, "Graytone", "value")?; 3]
                }
                // The default is unverified.
                None => [0.5; 3],
            },
            "ChannelSPD" => self.spectral_gray(fields, line, out)?,
            "ImageMap" => return self.image_map(fields, line, depth, out),
            "Carpenter" => return self.carpenter(fields, line, depth, out),
            "Checker" | "VolumeChecker" => return self.checker(map, depth, out),
            "Gradient" | "Granite" | "Wood" | "Leopard" | "Mandel" | "Julia" | "VolumeTurbulence" => {
                return self.volume_map(map, depth, out);
            }
            "ChannelBlend" => return self.blend(map, depth, out),
            "Smooth3D" | "Laplace3D" => return self.neighbour_filter(map, depth, out),
            class if forwards_colors(class) => return self.forwarded(map, depth, out),
            other => {
                let message =
                    format!("channel maps of class '{other}' are not supported yet; grey is used instead");
                out.report.warn(message, self.graph.location(line));
                MISSING
            }
        };
        Ok(self.constant(constant, out))
    }

    fn image_map(
        &mut self,
        fields: Members,
        line: usize,
        depth: u32,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let graph = self.graph;
        let find = |name| graph.values.find(fields, name);
        let bilinear = find("bilinearFiltering").is_none_or(|v| v.text() != "false");
        let coordinates = self.coordinates(fields, line, depth, out)?;
        let location = self.graph.location(line);
        match find("image").and_then(|image| registry_path(image.text())) {
            Some(path) => self.image(&path, bilinear, coordinates, location, out),
            None => {
                let message = "an ImageMap names no image of the project; grey is used instead";
                out.report.warn(message, location);
                Ok(self.constant(MISSING, out))
            }
        }
    }

    fn image(
        &mut self,
        path: &str,
        bilinear: bool,
        coordinates: Vec<CoordinateMap>,
        location: Option<Location>,
        out: &mut Output,
    ) -> Result<ChannelId, ReadError> {
        let Some(file) = self.registry.files.get(path) else {
            let message = format!("image '{path}' is not among the project's images; grey is used instead");
            out.report.warn(message, location);
            return Ok(self.constant(MISSING, out));
        };
        let image = self.images.load(file, location, &mut out.scene, &mut out.report)?;
        let Some(image) = image else { return Ok(self.constant(MISSING, out)) };
        let plain = coordinates.is_empty().then_some(Key::Image(image, bilinear));
        if let Some(id) = plain.and_then(|key| self.by_value.get(&key)) {
            return Ok(*id);
        }
        let [r, g, b, _] = out.scene.images[image.index()].mean();
        let channel = Channel::ImageMap { image, bilinear, coordinates };
        Ok(self.add(plain, channel, [r, g, b], out))
    }

    pub(crate) fn constant(&mut self, color: Rgb, out: &mut Output) -> ChannelId {
        // NaN would spread through the whole picture.
        let color = color.map(|c| if c.is_finite() { c } else { 0.5 });
        let key = Key::Constant(color.map(f64::to_bits));
        if let Some(id) = self.by_value.get(&key) {
            return *id;
        }
        self.add(Some(key), Channel::Constant(color), color, out)
    }

    /// Average colour of a channel.
    pub(crate) fn mean(&self, id: ChannelId) -> Rgb {
        self.means.get(id.index()).copied().unwrap_or(MISSING)
    }

    /// Adds a channel that other places with the same key, if it has one, use, too.
    pub(crate) fn add(
        &mut self,
        key: Option<Key>,
        channel: Channel,
        mean: Rgb,
        out: &mut Output,
    ) -> ChannelId {
        let effort = Effort::of(&channel, |id| {
            self.efforts.get(id.index()).copied().unwrap_or(Effort { steps: 1, pending: 0 })
        });
        if !effort.is_bounded() {
            // The caller's parts are there, but nobody looks at them.
            let message = "a channel map combines too many blends and filters; grey is used instead";
            out.report.warn(message, None);
            return self.constant(MISSING, out);
        }
        self.efforts.push(effort);
        let id = out.scene.add_channel(channel);
        self.means.push(mean);
        if let Some(key) = key {
            self.by_value.insert(key, id);
        }
        id
    }
}

/// Whether a map answers for colours with those of its input.
pub(crate) fn forwards_colors(class: &str) -> bool {
    matches!(class, "AffineUVTransformation" | "XYZTransformation" | "Turbulence" | "BumpMap" | "WaveMap")
}

const CHANNEL_NAMES: [&str; 8] = [
    "diffuse",
    "specular",
    "shininess",
    "transparency",
    "transparencyShininess",
    "diffuseTransparency",
    "ambient",
    "emissive",
];

fn set(phong: &mut Phong, name: &str, channel: Option<ChannelId>) {
    match name {
        "diffuse" => phong.diffuse = channel,
        "specular" => phong.specular = channel,
        "shininess" => phong.shininess = channel,
        "transparency" => phong.transparency = channel,
        "transparencyShininess" => phong.transparency_shininess = channel,
        "diffuseTransparency" => phong.diffuse_transparency = channel,
        "ambient" => phong.ambient = channel,
        "emissive" => phong.emissive = channel,
        _ => {}
    }
}

/// An RGBColor: `true index`, `false r g b`, or `r g b` in files up to 0.9.7.2.
pub(crate) fn color_of(graph: &Graph, value: &Value) -> Result<Rgb, ReadError> {
    let wrong = || {
        wrong_value(
            graph,
            value,
            "RGBColor",
            "value",
            "'true index', 'false red green blue' or three numbers",
        )
    };
    let words: Vec<_> = tokens(value.text()).collect();
    if let ["true", index] = words[..] {
        let index: i64 = index.parse().map_err(|_| wrong())?;
        // Lossless: the remainder is below 13.
        let color = COLORS[index.rem_euclid(COLORS.len() as i64) as usize];
        return Ok(color.map(|c| f64::from(c) / 255.0));
    }
    let words = words.strip_prefix(&["false"]).unwrap_or(&words);
    let numbers: Option<Vec<f64>> = words.iter().map(|word| parse_number(word)).collect();
    match numbers.as_deref() {
        Some(&[r, g, b]) => Ok([r, g, b]),
        // Attribute form or no value at all.
        Some([]) => {
            let part = |name| match graph.values.find(value.members, name) {
                Some(part) => number_of(graph, part, "RGBColor", name),
                None => Ok(0.5),
            };
            Ok([part("x")?, part("y")?, part("z")?])
        }
        _ => Err(wrong()),
    }
}
