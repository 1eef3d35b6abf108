//! Materials as records: one for each material and each filling that a body of it has.

use super::channels::{compile_channels, compile_normal_maps, constant};
use super::{CompileError, count};
use kernels::bsdf::kernel::missing_channel;
use kernels::records::kernel::{
    CHANNEL_CONSTANT, ChannelRecord, MATERIAL_INTERPOLATED, MATERIAL_LAMBERTIAN, MATERIAL_MIRRORS,
    MATERIAL_UNIFORM, MATERIAL_USES_POSITION, MaterialRecord, NONE,
};
use scene::{ChannelId, DVec3, Interior, Material, MaterialId, Phong, Scene};
use std::collections::HashMap;
use wgsl_rs::std::{Vec3f, vec3f};

/// The tables behind the surfaces.
pub(super) struct Materials {
    pub records: Vec<MaterialRecord>,
    pub channels: Vec<ChannelRecord>,
    /// For every channel of the scene, where its program starts.
    pub channel_starts: Vec<u32>,
    pub texels: Vec<u32>,
    /// For every record, whether rays pass it somewhere.
    not_opaque: Vec<bool>,
    /// Records of materials that fill bodies, by material and the bits of the refractive index.
    filled: HashMap<(MaterialId, u32), u32>,
}

impl Materials {
    /// Index of the record for objects of a material with a filling.
    pub fn record(&self, material: MaterialId, interior: Option<Interior>) -> u32 {
        let filled = interior.and_then(|interior| self.filled.get(&(material, index_bits(interior))));
        filled.copied().unwrap_or(material.0)
    }

    /// Whether a channel of the record, or of its back, looks at the position.
    pub fn uses_position(&self, record: u32) -> bool {
        let record = &self.records[record as usize];
        let back = self.records.get(record.back as usize).map_or(0, |back| back.flags);
        (record.flags | back) & MATERIAL_USES_POSITION != 0
    }

    /// Whether rays pass some surface with this record somewhere.
    pub fn is_not_opaque(&self, record: u32) -> bool {
        self.not_opaque[record as usize]
    }
}

fn index_bits(interior: Interior) -> u32 {
    (interior.refractive_index as f32).to_bits()
}

pub(super) fn compile_materials(scene: &Scene, origin: DVec3) -> Result<Materials, CompileError> {
    let mut channels = compile_channels(scene, origin)?;
    let mut materials = Vec::with_capacity(scene.materials.len());
    let mut not_opaque = Vec::with_capacity(scene.materials.len());
    for material in &scene.materials {
        match material {
            Material::Rgba { color, opacity } => {
                channels.records.push(constant(*color));
                materials.push(MaterialRecord {
                    diffuse: count(channels.records.len() - 1),
                    flags: MATERIAL_INTERPOLATED | MATERIAL_MIRRORS,
                    opacity: opacity.clamp(0.0, 1.0) as f32,
                    ..black()
                });
                not_opaque.push(*opacity < 1.0);
            }
            Material::Phong(phong) => {
                let normal_map = compile_normal_maps(&phong.normal_maps, &mut channels);
                let uses_position = channels_of(phong).any(|id| channels.uses_position[id.index()]);
                let index = |id: Option<ChannelId>| id.map_or(NONE, |id| channels.starts[id.index()]);
                materials.push(MaterialRecord {
                    diffuse: index(phong.diffuse),
                    specular: index(phong.specular),
                    shininess: index(phong.shininess),
                    transparency: index(phong.transparency),
                    transparency_shininess: index(phong.transparency_shininess),
                    diffuse_transparency: index(phong.diffuse_transparency),
                    ambient: index(phong.ambient),
                    emissive: index(phong.emissive),
                    flags: if phong.interpolated_transparency { MATERIAL_INTERPOLATED } else { 0 }
                        | if uses_position { MATERIAL_USES_POSITION } else { 0 },
                    normal_map,
                    ..black()
                });
                not_opaque.push(
                    phong.transparency.is_some()
                        || phong.diffuse.is_some_and(|id| channels.has_holes[id.index()]),
                );
            }
            // Filled in below, when all sides are known.
            Material::SideSwitch { .. } => {
                materials.push(black());
                not_opaque.push(false);
            }
        }
    }
    for material in &mut materials {
        simplify(material, &channels.records);
    }
    for (index, material) in scene.materials.iter().enumerate() {
        if let Material::SideSwitch { front, back } = material {
            materials[index] = MaterialRecord { back: back.0, ..materials[front.index()] };
            not_opaque[index] = not_opaque[front.index()] || not_opaque[back.index()];
        }
    }
    let mut all = Materials {
        records: materials,
        channels: channels.records,
        channel_starts: channels.starts,
        texels: channels.texels,
        not_opaque,
        filled: HashMap::new(),
    };
    all.fill_bodies(scene);
    Ok(all)
}

impl Materials {
    /// Adds the records of materials whose bodies refract. If nothing in the scene is denser than empty space,
    /// fillings make no difference.
    fn fill_bodies(&mut self, scene: &Scene) {
        let objects = || scene.objects.iter().chain(scene.groups.iter().flat_map(|group| &group.objects));
        let interiors = || objects().filter_map(|object| Some((object.material, object.interior?)));
        if interiors().all(|(_, interior)| interior.refractive_index == 1.0) {
            return;
        }
        for (material, interior) in interiors() {
            self.fill(material, interior);
            if let Material::SideSwitch { front, back } = scene.materials[material.index()] {
                self.fill(front, interior);
                let back = self.fill(back, interior);
                let record = self.fill(material, interior) as usize;
                self.records[record].back = back;
            }
        }
    }

    fn fill(&mut self, material: MaterialId, interior: Interior) -> u32 {
        let key = (material, index_bits(interior));
        if let Some(record) = self.filled.get(&key) {
            return *record;
        }
        let refractive_index = interior.refractive_index as f32;
        let record = self.records[material.index()];
        // Light that is refracted or reflected by the surface of a body is more than Lambertian.
        let flags = record.flags & !(MATERIAL_LAMBERTIAN | MATERIAL_UNIFORM);
        self.records.push(MaterialRecord { refractive_index, flags, ..record });
        // What is refracted does not pass undisturbed, but the ray tracer's shadow rays do not tell.
        self.not_opaque.push(self.not_opaque[material.index()]);
        let record = count(self.records.len() - 1);
        self.filled.insert(key, record);
        record
    }
}

/// Marks a material that needs no more than Lambert's law, and remembers colours that are the same everywhere.
fn simplify(material: &mut MaterialRecord, channels: &[ChannelRecord]) {
    let constant = |index: u32| {
        let record = channels.get(index as usize)?;
        (record.operation == CHANNEL_CONSTANT).then_some(record.value)
    };
    let is_black = |index: u32| {
        index == NONE
            || constant(index).is_some_and(|color| color.x <= 0.0 && color.y <= 0.0 && color.z <= 0.0)
    };
    if ![material.specular, material.transparency, material.emissive].into_iter().all(is_black)
        || material.transparency_shininess != NONE
    {
        return;
    }
    material.flags |= MATERIAL_LAMBERTIAN;
    let color = |number: u32, index: u32| -> Option<Vec3f> {
        let color = if index == NONE { missing_channel(number) } else { constant(index)? };
        Some(vec3f(color.x, color.y, color.z))
    };
    let colors = (color(0, material.diffuse), color(3, material.diffuse_transparency));
    if let (Some(diffuse), Some(transmitted)) = colors {
        material.flags |= MATERIAL_UNIFORM;
        material.diffuse_color = diffuse;
        material.transmitted_color = transmitted;
    }
}

/// A material without any coefficient.
fn black() -> MaterialRecord {
    MaterialRecord {
        diffuse: NONE,
        specular: NONE,
        shininess: NONE,
        transparency: NONE,
        transparency_shininess: NONE,
        diffuse_transparency: NONE,
        ambient: NONE,
        emissive: NONE,
        flags: 0,
        opacity: 1.0,
        back: NONE,
        refractive_index: 0.0,
        normal_map: NONE,
        reserved0: 0,
        reserved1: 0,
        reserved2: 0,
        diffuse_color: vec3f(0.0, 0.0, 0.0),
        reserved3: 0,
        transmitted_color: vec3f(0.0, 0.0, 0.0),
        reserved4: 0,
    }
}

/// All channels of a material.
fn channels_of(phong: &Phong) -> impl Iterator<Item = ChannelId> + '_ {
    let coefficients = [
        phong.diffuse,
        phong.specular,
        phong.shininess,
        phong.transparency,
        phong.transparency_shininess,
        phong.diffuse_transparency,
        phong.ambient,
        phong.emissive,
    ];
    coefficients.into_iter().flatten().chain(phong.normal_maps.iter().map(|map| map.displacement))
}
