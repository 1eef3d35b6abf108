use super::channels::{compile_channels, compile_normal_maps, constant};
use super::{CompileError, count};
use kernels::records::kernel::{ChannelRecord, MaterialRecord, NONE};
use scene::{ChannelId, DVec3, Material, Phong, Scene};

/// The tables behind the surfaces.
pub(super) struct Materials {
    pub records: Vec<MaterialRecord>,
    pub channels: Vec<ChannelRecord>,
    pub texels: Vec<u32>,
    /// For every material, whether rays pass it somewhere.
    pub not_opaque: Vec<bool>,
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
                    specular: NONE,
                    shininess: NONE,
                    transparency: NONE,
                    transparency_shininess: NONE,
                    diffuse_transparency: NONE,
                    ambient: NONE,
                    emissive: NONE,
                    interpolated_transparency: 1,
                    opacity: opacity.clamp(0.0, 1.0) as f32,
                    normal_map: NONE,
                    uses_position: 0,
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
                    interpolated_transparency: u32::from(phong.interpolated_transparency),
                    opacity: 1.0,
                    normal_map,
                    uses_position: u32::from(uses_position),
                });
                not_opaque.push(
                    phong.transparency.is_some()
                        || phong.diffuse.is_some_and(|id| channels.has_holes[id.index()]),
                );
            }
        }
    }
    Ok(Materials { records: materials, channels: channels.records, texels: channels.texels, not_opaque })
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
