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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile;
    use scene::{
        Channel, DAffine3, Emission, Interior, Material, MaterialId, Object, Origin, Phong, Scene, Shape,
        TypeNameId,
    };

    const SPHERE: u32 = 1 << SHAPE_SPHERE;

    /// A sphere of a material.
    fn sphere(scene: &mut Scene, material: Material, interior: Option<Interior>) {
        let material = scene.add_material(material);
        scene.objects.push(Object {
            shape: Shape::Sphere { radius: 1.0 },
            world_from_object: DAffine3::IDENTITY,
            material,
            emission: None,
            interior,
            origin: Origin { node: 0, type_name: TypeNameId(0) },
        });
    }

    fn features_of(change: impl FnOnce(&mut Scene)) -> u32 {
        let mut scene = Scene { type_names: vec!["test".to_owned()], ..Scene::default() };
        change(&mut scene);
        compile(&scene).unwrap().features
    }

    fn grey(opacity: f64) -> Material {
        Material::Rgba { color: [0.5; 3], opacity }
    }

    #[test]
    fn a_scene_has_the_features_that_it_needs_and_no_others() {
        assert_eq!(features_of(|_| ()), 0);
        assert_eq!(features_of(|scene| sphere(scene, grey(1.0), None)), SPHERE);
        assert_eq!(features_of(|scene| sphere(scene, grey(0.5), None)), SPHERE | FEATURE_HOLES);
        let glass = Some(Interior { refractive_index: 1.5 });
        let filled = features_of(|scene| sphere(scene, grey(0.5), glass));
        assert_eq!(filled, SPHERE | FEATURE_HOLES | FEATURE_LOBES | FEATURE_MEDIA);
        let shiny = features_of(|scene| {
            let specular = scene.add_channel(Channel::Constant([0.5; 3]));
            sphere(scene, Material::Phong(Phong { specular: Some(specular), ..Phong::default() }), None);
        });
        assert_eq!(shiny, SPHERE | FEATURE_LOBES);
        let sides = features_of(|scene| {
            let front = scene.add_material(grey(1.0));
            let back = scene.add_material(grey(1.0));
            sphere(scene, Material::SideSwitch { front, back }, None);
        });
        assert_eq!(sides, SPHERE | FEATURE_BACKS);
        let many = features_of(|scene| {
            for i in 0..2000 {
                sphere(scene, grey(1.0), None);
                let place = scene::DVec3::new(f64::from(i % 50), f64::from(i / 50), 0.0) * 3.0;
                scene.objects[i as usize].world_from_object = DAffine3::from_translation(place);
                scene.objects[i as usize].material = MaterialId(0);
            }
        });
        assert_eq!(many, SPHERE | FEATURE_MANY_NODES);
    }

    #[test]
    fn a_black_channel_is_no_lobe_and_a_lamp_none_either() {
        let features = features_of(|scene| {
            let black = scene.add_channel(Channel::Constant([0.0; 3]));
            let phong = Phong { specular: Some(black), emissive: Some(black), ..Phong::default() };
            sphere(scene, Material::Phong(phong), None);
            sphere(scene, grey(1.0), None);
            scene.objects[1].shape =
                Shape::Parallelogram { length: 1.0, axis: scene::DVec3::X, scale_v: false };
            scene.objects[1].emission = Some(Emission { power: [1.0; 3], exponent: 0.0, shadowless: false });
        });
        assert_eq!(features, SPHERE | 1 << SHAPE_PARALLELOGRAM);
    }
}
