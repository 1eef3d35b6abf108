//! Channels of Phong shaders: constants and pictures.

use crate::ReadError;
use crate::fields::{number_of, wrong_value};
use crate::graph::Graph;
use crate::images::Images;
use crate::inline::registry_path;
use crate::modules::StaticChannel;
use crate::output::Output;
use crate::registry::Registry;
use crate::report::Location;
use crate::values::{Kind, Members, Value, parse_number, tokens};
use scene::{Channel, ChannelId, ImageId, Phong, Rgb};
use std::collections::HashMap;

/// Average colour of a shader.
pub(crate) struct Mean(pub Rgb);

/// Value of a picture that is not there.
const MISSING: Rgb = [0.5; 3];

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
enum Key {
    Constant([u64; 3]),
    Image(ImageId, bool),
}

/// All channels of a scene, each built once.
pub(crate) struct Channels<'a> {
    graph: &'a Graph,
    registry: &'a Registry,
    images: Images,
    by_value: HashMap<Key, ChannelId>,
    means: Vec<Rgb>,
}

impl<'a> Channels<'a> {
    pub fn new(graph: &'a Graph, registry: &'a Registry, images: Images) -> Self {
        Channels { graph, registry, images, by_value: HashMap::new(), means: Vec::new() }
    }

    /// A Phong shader from its fields in the file.
    pub fn phong(&mut self, fields: Members, out: &mut Output) -> Result<(Phong, Mean), ReadError> {
        let mut phong = self.plain_phong(self.graph.values.find(fields, "diffuse").is_some(), out);
        for name in CHANNEL_NAMES {
            if let Some(value) = self.graph.values.find(fields, name) {
                let channel = self.channel(value, name, out)?;
                set(&mut phong, name, channel);
            }
        }
        if let Some(value) = self.graph.values.find(fields, "interpolatedTransparency") {
            phong.interpolated_transparency = value.text() != "false";
        }
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
                    self.image(&path, true, None, out)?
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

    fn channel(
        &mut self,
        value: &'a Value,
        name: &str,
        out: &mut Output,
    ) -> Result<Option<ChannelId>, ReadError> {
        let (class, fields, line) = match value.kind {
            Kind::Null => return Ok(None),
            Kind::Ref => {
                let target = value.text().parse().ok().and_then(|id| self.graph.by_id(id));
                let Some(index) = target else {
                    let message =
                        format!("channel {name} refers to node '{}', which is not in the file", value.text());
                    out.report.warn(message + "; grey is used instead", self.graph.location(value.line));
                    return Ok(Some(self.constant(MISSING, out)));
                };
                let node = self.graph.node(index);
                (self.graph.type_name(index), node.fields, node.line)
            }
            Kind::Data | Kind::Object | Kind::Array | Kind::Shared | Kind::Serialized => {
                (self.graph.values.type_of(value).unwrap_or(""), value.members, value.line)
            }
        };
        let constant = match class.rsplit('.').next().unwrap_or("") {
            "RGBColor" => color_of(self.graph, value)?,
            "Graytone" => match self.graph.values.find(fields, "value") {
                Some(gray) => [number_of(self.graph, gray, "Graytone", "value")?; 3],
                None if value.kind == Kind::Object && value.text.is_some() => {
                    [number_of(self.graph, value, "Graytone", "value")?; 3]
                }
                // The default is unverified.
                None => [0.5; 3],
            },
            "ImageMap" => return self.image_map(fields, line, out).map(Some),
            other => {
                let message =
                    format!("channel maps of class '{other}' are not supported yet; grey is used instead");
                out.report.warn(message, self.graph.location(line));
                MISSING
            }
        };
        Ok(Some(self.constant(constant, out)))
    }

    fn image_map(&mut self, fields: Members, line: usize, out: &mut Output) -> Result<ChannelId, ReadError> {
        let find = |name| self.graph.values.find(fields, name);
        let bilinear = find("bilinearFiltering").is_none_or(|v| v.text() != "false");
        if find("input").is_some_and(|v| v.kind != Kind::Null) {
            let message = "the coordinate transformation of an ImageMap is not supported yet and left out";
            out.report.warn(message, self.graph.location(line));
        }
        let location = self.graph.location(line);
        match find("image").and_then(|image| registry_path(image.text())) {
            Some(path) => self.image(&path, bilinear, location, out),
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
        if let Some(id) = self.by_value.get(&Key::Image(image, bilinear)) {
            return Ok(*id);
        }
        let [r, g, b, _] = out.scene.images[image.index()].mean();
        Ok(self.add(Key::Image(image, bilinear), Channel::ImageMap { image, bilinear }, [r, g, b], out))
    }

    fn constant(&mut self, color: Rgb, out: &mut Output) -> ChannelId {
        // NaN would spread through the whole picture.
        let color = color.map(|c| if c.is_finite() { c } else { 0.5 });
        let key = Key::Constant(color.map(f64::to_bits));
        if let Some(id) = self.by_value.get(&key) {
            return *id;
        }
        self.add(key, Channel::Constant(color), color, out)
    }

    fn add(&mut self, key: Key, channel: Channel, mean: Rgb, out: &mut Output) -> ChannelId {
        let id = out.scene.add_channel(channel);
        self.means.push(mean);
        self.by_value.insert(key, id);
        id
    }
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
