//! What a scene contains, so that devices can leave out what it does not need.

use super::CompiledScene;
use kernels::records::kernel::*;

/// The features of a scene, by looking through its tables.
pub(super) fn features(scene: &CompiledScene) -> u32 {
    let flag = |condition: bool, feature: u32| if condition { feature } else { 0 };
    let objects = scene.objects.iter().fold(0, |all, object| {
        let kind = object.shape.kind;
        all | 1 << (kind & SHAPE_MASK) | flag(kind & FLAG_NOT_OPAQUE != 0, FEATURE_HOLES)
    });
    let materials = scene.materials.iter().fold(0, |all, material| {
        let looks_at_position = material.flags & MATERIAL_USES_POSITION != 0 || material.normal_map != NONE;
        all | flag(material.flags & MATERIAL_LAMBERTIAN == 0, FEATURE_LOBES)
            | flag(material.refractive_index > 0.0, FEATURE_MEDIA)
            | flag(looks_at_position, FEATURE_POSITIONS)
            | flag(material.back != NONE, FEATURE_BACKS)
    });
    let channels = scene.channels.iter().fold(0, |all, channel| match channel.operation {
        CHANNEL_CONSTANT => all,
        CHANNEL_IMAGE => all | FEATURE_IMAGES,
        _ => all | FEATURE_PROGRAMS,
    });
    let lights = scene.lights.iter().fold(0, |all, light| match light.kind {
        LIGHT_SKY_MAP | LIGHT_DAYLIGHT | LIGHT_PHYSICAL => all | FEATURE_LIGHT_TABLES,
        LIGHT_GROUP => all | FEATURE_LIGHT_GROUPS,
        _ => all,
    });
    let nodes = flag(scene.nodes.len() > MANY_NODES as usize, FEATURE_MANY_NODES);
    objects | materials | channels | lights | nodes
}
