use super::channels::{Channels, compile_channels, constant};
use super::{CompileError, count};
use kernels::records::kernel::{ChannelRecord, MaterialRecord, NONE};
use scene::{ChannelId, Material, Scene};

/// The tables behind the surfaces.
pub(super) struct Materials {
    pub records: Vec<MaterialRecord>,
    pub channels: Vec<ChannelRecord>,
    /// For every channel of the scene, where its program starts.
    pub channel_starts: Vec<u32>,
    pub texels: Vec<u32>,
    /// For every material, whether rays pass it somewhere.
    pub not_opaque: Vec<bool>,
}

pub(super) fn compile_materials(scene: &Scene) -> Result<Materials, CompileError> {
    let Channels { mut records, starts, has_holes, texels } = compile_channels(scene)?;
    let index = |id: Option<ChannelId>| id.map_or(NONE, |id| starts[id.index()]);
    let mut materials = Vec::with_capacity(scene.materials.len());
    let mut not_opaque = Vec::with_capacity(scene.materials.len());
    for material in &scene.materials {
        match material {
            Material::Rgba { color, opacity } => {
                records.push(constant(*color));
                materials.push(MaterialRecord {
                    diffuse: count(records.len() - 1),
                    specular: NONE,
                    shininess: NONE,
                    transparency: NONE,
                    transparency_shininess: NONE,
                    diffuse_transparency: NONE,
                    ambient: NONE,
                    emissive: NONE,
                    interpolated_transparency: 1,
                    opacity: opacity.clamp(0.0, 1.0) as f32,
                    reserved0: 0,
                    reserved1: 0,
                });
                not_opaque.push(*opacity < 1.0);
            }
            Material::Phong(phong) => {
                materials.push(MaterialRecord {
                    diffuse: index(phong.diffuse),
                    specular: index(phong.specular),
                    shininess: index(phong.shininess),
                    transparency: index(phong.transparency),
                    transparency_shininess: index(phong.transparency_shininess),
                    diffuse_transparency: index(phong.diffuse_transparency),
                    ambient: index(phong.ambient),
                    emissive: index(phong.emissive),
                    interpolated_transparency: u32::from(phong.interpolated_transparency),
                    opacity: 1.0,
                    reserved0: 0,
                    reserved1: 0,
                });
                not_opaque.push(
                    phong.transparency.is_some() || phong.diffuse.is_some_and(|id| has_holes[id.index()]),
                );
            }
        }
    }
    Ok(Materials { records: materials, channels: records, channel_starts: starts, texels, not_opaque })
}
