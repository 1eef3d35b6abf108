//! Shaders: predefined, stored in the graph, shared by name, or assigned by modules.

use crate::ReadError;
use crate::channels::{Channels, Mean};
use crate::field_errors::wrong_value;
use crate::graph::{Graph, NodeIndex};
use crate::images::Images;
use crate::modules::StaticShader;
use crate::output::Output;
use crate::references::{LONGEST_CHAIN, References};
use crate::registry::Registry;
use crate::values::{Kind, Members, Value, parse_number, tokens};
use scene::{ChannelId, Material, MaterialId, Phong, Rgb};
use std::collections::HashMap;

/// GRAY among the predefined shaders: what an unknown name and the root of the scene get.
pub(crate) const GRAY: u32 = 20;

/// Colours of the predefined shaders, 0xRRGGBB.
const PREDEFINED: [u32; 29] = [
    0x000000, 0x0000AA, 0x00AA00, 0x00AAAA, 0xAA0000, 0xAA00AA, 0xAA5500, 0xAAAAAA, // EGA 0 to 7
    0x555555, 0x5555FF, 0x55FF55, 0x55FFFF, 0xFF5555, 0xFF55FF, 0xFFFF55, 0xFFFFFF, // EGA 8 to 15
    0x000000, 0x0000FF, 0x00FFFF, 0x404040, 0x808080, 0x00FF00, 0xC0C0C0, // BLACK to LIGHT_GRAY
    0xFF00FF, 0xFFC800, 0xFFAFAF, 0xFF0000, 0xFFFF00, 0xFFFFFF, // MAGENTA to WHITE
];

/// Where a shader is described.
#[derive(Clone, Copy)]
pub(crate) enum ShaderSource<'a> {
    /// A field of a node or an object.
    Value(&'a Value),
    /// A node of the graph.
    Node(NodeIndex),
    /// What a module assigns.
    Module(&'a StaticShader),
}

/// The colour 0xRRGGBB in [0, 1].
fn hex(rgb: u32) -> Rgb {
    [16, 8, 0].map(|shift| f64::from((rgb >> shift) & 0xFF) / 255.0)
}

#[derive(Clone, PartialEq, Eq, Hash)]
enum Key {
    Rgba([u64; 4]),
    /// The coefficients, the flag, and the normal maps as displacement, bits of the numbers, and flag.
    Phong([Option<ChannelId>; 8], bool, Vec<(ChannelId, [u64; 3], bool)>),
    SideSwitch(MaterialId, MaterialId),
}

/// A side of a surface.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Side {
    Front,
    Back,
}

/// All materials of a scene, each built once.
pub(crate) struct Shaders<'a> {
    graph: &'a Graph,
    registry: &'a Registry,
    pub references: References<'a>,
    channels: Channels<'a>,
    by_node: HashMap<(NodeIndex, Option<Side>), Option<MaterialId>>,
    by_value: HashMap<Key, MaterialId>,
    means: Vec<Rgb>,
}

impl<'a> Shaders<'a> {
    pub fn new(graph: &'a Graph, registry: &'a Registry, images: Images) -> Self {
        Shaders {
            graph,
            registry,
            references: References { graph, registry },
            channels: Channels::new(graph, registry, images),
            by_node: HashMap::new(),
            by_value: HashMap::new(),
            means: Vec::new(),
        }
    }

    /// A predefined shader; indices count modulo their number, as in GroIMP.
    pub fn predefined(&mut self, index: u32, out: &mut Output) -> MaterialId {
        let [r, g, b] = hex(PREDEFINED[index as usize % PREDEFINED.len()]);
        self.rgba([r, g, b, 1.0], out)
    }

    /// Average colour of a material of this table.
    pub fn mean(&self, material: MaterialId) -> Rgb {
        self.means.get(material.index()).copied().unwrap_or([0.5; 3])
    }

    /// The material; `None` if the shader is null, which means: inherit.
    pub fn resolve<'s>(
        &mut self,
        source: ShaderSource<'s>,
        out: &mut Output,
    ) -> Result<Option<MaterialId>, ReadError>
    where
        'a: 's,
    {
        self.resolve_side(source, None, out)
    }

    /// The material of one side, or of the whole surface.
    fn resolve_side<'s>(
        &mut self,
        source: ShaderSource<'s>,
        side: Option<Side>,
        out: &mut Output,
    ) -> Result<Option<MaterialId>, ReadError>
    where
        'a: 's,
    {
        let mut source = source;
        let mut nodes = Vec::new();
        for _ in 0..LONGEST_CHAIN {
            let step = match source {
                ShaderSource::Module(shader) => self.module_shader(shader, out)?,
                ShaderSource::Value(value) => self.value(value, out)?,
                ShaderSource::Node(index) => {
                    if let Some(known) = self.by_node.get(&(index, side)).copied() {
                        self.by_node.extend(nodes.into_iter().map(|node| ((node, side), known)));
                        return Ok(known);
                    }
                    nodes.push(index);
                    let n = self.graph.node(index);
                    self.class(self.graph.type_name(index), n.fields, None, n.line, out)?
                }
            };
            let material = match (step, side) {
                (Step::Done(material), _) => material,
                (Step::Follow(next), _) => {
                    source = next;
                    continue;
                }
                // A switch within a switch is seen from the same side.
                (Step::Sides { front, .. }, Some(Side::Front)) => {
                    source = front;
                    continue;
                }
                (Step::Sides { back, .. }, Some(Side::Back)) => {
                    source = back;
                    continue;
                }
                // No recursion in depth: the sides have no sides.
                (Step::Sides { front, back }, None) => {
                    let grey = self.predefined(GRAY, out);
                    let front = self.resolve_side(front, Some(Side::Front), out)?.unwrap_or(grey);
                    let back = self.resolve_side(back, Some(Side::Back), out)?.unwrap_or(grey);
                    Some(self.side_switch(front, back, out))
                }
            };
            // Also those on the way: many may lead to the same shader.
            self.by_node.extend(nodes.into_iter().map(|node| ((node, side), material)));
            return Ok(material);
        }
        out.report.warn("a shader refers to itself; grey is used instead", None);
        Ok(Some(self.predefined(GRAY, out)))
    }

    /// The project's file that a registry path names.
    pub fn file_of(&self, path: &str) -> Option<String> {
        self.registry.files.get(path).cloned()
    }

    /// Contents of a file of the project.
    pub fn read_file(&mut self, file: &str) -> Result<Option<Vec<u8>>, ReadError> {
        self.channels.read_file(file)
    }

    fn value<'s>(&mut self, value: &'s Value, out: &mut Output) -> Result<Step<'s>, ReadError>
    where
        'a: 's,
    {
        let target = match value.kind {
            Kind::Null => return Ok(Step::Done(None)),
            Kind::Ref => value.text().parse().ok().and_then(|id| self.graph.by_id(id)),
            Kind::Shared => self.references.shared(value.text()),
            Kind::Data | Kind::Object | Kind::Array | Kind::Serialized => {
                let class = self.graph.values.type_of(value).unwrap_or("");
                return self.class(class, value.members, Some(value), value.line, out);
            }
        };
        if let Some(node) = target {
            return Ok(Step::Follow(ShaderSource::Node(node)));
        }
        let message = format!("the shader '{}' is not in the file; grey is used instead", value.text());
        out.report.warn(message, self.graph.location(value.line));
        Ok(Step::Done(Some(self.predefined(GRAY, out))))
    }

    fn by_name(&mut self, name: &str, out: &mut Output) -> Step<'a> {
        if let Some(node) = self.references.named(name) {
            return Step::Follow(ShaderSource::Node(node));
        }
        out.report.warn(format!("the project has no shader '{name}'; grey is used, as in GroIMP"), None);
        Step::Done(Some(self.predefined(GRAY, out)))
    }

    /// A shader by its class and fields, whether it is a node or a value.
    fn class<'s>(
        &mut self,
        class: &str,
        fields: Members,
        value: Option<&'s Value>,
        line: usize,
        out: &mut Output,
    ) -> Result<Step<'s>, ReadError>
    where
        'a: 's,
    {
        let find = |name| self.graph.values.find(fields, name);
        let present = |name| find(name).filter(|v| v.kind != Kind::Null);
        match class.rsplit('.').next().unwrap_or("") {
            "SharedObjectNode" => {
                Ok(present("object").map_or(Step::Done(None), |v| Step::Follow(ShaderSource::Value(v))))
            }
            "RGBAShader" => {
                let color = match value.and_then(|v| v.text.as_deref().map(|_| v)) {
                    Some(value) => self.rgba_of(value)?,
                    None => [0.5, 0.5, 0.5, 1.0],
                };
                Ok(Step::Done(Some(self.rgba(color, out))))
            }
            "Phong" | "Lambert" => {
                let phong = self.channels.phong(fields, out)?;
                Ok(Step::Done(Some(self.phong(phong, out))))
            }
            // A picture is made: the ray tracer's shader, else the view's; none of them means inherit.
            "AlgorithmSwitchShader" => Ok(present("raytracerShader")
                .or(present("guiShader"))
                .map_or(Step::Done(None), |v| Step::Follow(ShaderSource::Value(v)))),
            // One missing side is as the other one.
            "SideSwitchShader" | "MappedShader" => {
                let (front, back) = (present("frontShader"), present("backShader"));
                Ok(match (front.or(back), back.or(front)) {
                    (Some(front), Some(back)) => {
                        Step::Sides { front: ShaderSource::Value(front), back: ShaderSource::Value(back) }
                    }
                    _ => Step::Done(Some(self.predefined(GRAY, out))),
                })
            }
            "SunSkyLight" => {
                let message = "a SunSkyLight on a surface is drawn in its average colour";
                out.report.warn(message, self.graph.location(line));
                Ok(Step::Done(Some(self.rgba([128.0 / 255.0, 128.0 / 255.0, 1.0, 1.0], out))))
            }
            "ShaderRef" | "MaterialRef" => {
                let name = find("name").map(|v| v.text().to_owned()).unwrap_or_default();
                Ok(self.by_name(&name, out))
            }
            name => {
                let message =
                    format!("shaders of class '{name}' are not supported yet; grey is used instead");
                out.report.warn(message, self.graph.location(line));
                Ok(Step::Done(Some(self.rgba([0.5, 0.5, 0.5, 1.0], out))))
            }
        }
    }

    fn module_shader<'s>(&mut self, shader: &'s StaticShader, out: &mut Output) -> Result<Step<'s>, ReadError>
    where
        'a: 's,
    {
        Ok(match shader {
            StaticShader::Predefined(index) => Step::Done(Some(self.predefined(*index, out))),
            StaticShader::Rgba(color) => Step::Done(Some(self.rgba(*color, out))),
            StaticShader::Named(name) => self.by_name(name, out),
            StaticShader::Phong { channels } => {
                let phong = self.channels.module_phong(channels, out)?;
                Step::Done(Some(self.phong(phong, out)))
            }
            StaticShader::AlgorithmSwitch { gui, raytracer, radiation: _ } => {
                match raytracer.as_deref().or(gui.as_deref()) {
                    Some(shader) => Step::Follow(ShaderSource::Module(shader)),
                    None => Step::Done(None),
                }
            }
        })
    }

    /// List form: `true index` or `[false] r g b [a]`.
    fn rgba_of(&self, value: &Value) -> Result<[f64; 4], ReadError> {
        let wrong = || {
            let expected = "'true index' or 'false red green blue alpha'";
            wrong_value(self.graph, value, "RGBAShader", "value", expected)
        };
        let words: Vec<_> = tokens(value.text()).collect();
        if let ["true", index] = words[..] {
            let index: i64 = index.parse().map_err(|_| wrong())?;
            // Lossless: the remainder is below 29.
            let [r, g, b] = hex(PREDEFINED[index.rem_euclid(PREDEFINED.len() as i64) as usize]);
            return Ok([r, g, b, 1.0]);
        }
        let words = words.strip_prefix(&["false"]).unwrap_or(&words);
        let numbers: Option<Vec<f64>> = words.iter().map(|word| parse_number(word)).collect();
        match numbers.as_deref() {
            Some(&[r, g, b, a]) => Ok([r, g, b, a]),
            Some(&[r, g, b]) => Ok([r, g, b, 1.0]),
            _ => Err(wrong()),
        }
    }

    /// A Lambertian colour with opacity.
    pub fn rgba(&mut self, rgba: [f64; 4], out: &mut Output) -> MaterialId {
        // NaN and negative colours would spread through the whole picture.
        let [r, g, b, a] = rgba.map(|c| if c.is_finite() { c.max(0.0) } else { 0.5 });
        let (color, opacity) = ([r, g, b], a.min(1.0));
        let key = Key::Rgba([r, g, b, opacity].map(f64::to_bits));
        self.material(key, Material::Rgba { color, opacity }, color, out)
    }

    fn phong(&mut self, (phong, Mean(mean)): (Phong, Mean), out: &mut Output) -> MaterialId {
        let channels = [
            phong.diffuse,
            phong.specular,
            phong.shininess,
            phong.transparency,
            phong.transparency_shininess,
            phong.diffuse_transparency,
            phong.ambient,
            phong.emissive,
        ];
        let normal_maps = phong.normal_maps.iter().map(|map| {
            let numbers = [map.scale, map.step.x, map.step.y].map(f64::to_bits);
            (map.displacement, numbers, map.box_top)
        });
        let key = Key::Phong(channels, phong.interpolated_transparency, normal_maps.collect());
        self.material(key, Material::Phong(phong), mean, out)
    }

    fn side_switch(&mut self, front: MaterialId, back: MaterialId, out: &mut Output) -> MaterialId {
        if front == back {
            return front;
        }
        let mean = self.mean(front);
        self.material(Key::SideSwitch(front, back), Material::SideSwitch { front, back }, mean, out)
    }

    fn material(&mut self, key: Key, material: Material, mean: Rgb, out: &mut Output) -> MaterialId {
        if let Some(id) = self.by_value.get(&key) {
            return *id;
        }
        let id = out.scene.add_material(material);
        self.means.push(mean);
        self.by_value.insert(key, id);
        id
    }
}

/// One step along a chain of shaders.
enum Step<'a> {
    Done(Option<MaterialId>),
    Follow(ShaderSource<'a>),
    Sides { front: ShaderSource<'a>, back: ShaderSource<'a> },
}
