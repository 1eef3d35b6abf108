//! The kernels' view of a scene in main memory.

use super::reached::reached_children;
use crate::CompiledScene;
use kernels::records::kernel::*;
use wgsl_rs::std::{Vec3f, Vec4f, vec4f};

/// What most scenes of plants are made of: there is a path tracer without the rest.
pub(super) const PLAIN_FEATURES: u32 = ALL_FEATURES
    & !(FEATURE_LOBES | FEATURE_MEDIA | FEATURE_PROGRAMS | FEATURE_POSITIONS | FEATURE_LIGHT_TABLES)
    & !(1 << SHAPE_TRIANGLE);

/// The tables of a scene, which has no other than the given features.
#[derive(Clone, Copy)]
pub(crate) struct Slices<'a, const FEATURES: u32> {
    scene: &'a CompiledScene,
    /// That of the scene, or one with another camera.
    header: &'a SceneHeader,
}

impl<'a, const FEATURES: u32> Slices<'a, FEATURES> {
    pub(super) fn new(scene: &'a CompiledScene, header: &'a SceneHeader) -> Self {
        Slices { scene, header }
    }

    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    pub(super) fn scene(self) -> &'a CompiledScene {
        self.scene
    }
}

impl<'a> Slices<'a, ALL_FEATURES> {
    /// The scene through its own camera.
    pub(crate) fn of(scene: &'a CompiledScene) -> Self {
        Self::through(scene, &scene.header)
    }

    /// The scene through another camera.
    pub(crate) fn through(scene: &'a CompiledScene, header: &'a SceneHeader) -> Self {
        Self::new(scene, header)
    }
}

impl<const FEATURES: u32> SceneAccess for Slices<'_, FEATURES> {
    fn features(_scene: Self) -> u32 {
        // A processor's threads do not wait for each other.
        FEATURES & !FEATURE_MANY_NODES
    }
    fn header(scene: Self) -> SceneHeader {
        *scene.header
    }
    #[inline]
    fn node(scene: Self, index: u32) -> BvhNode {
        scene.scene.nodes[index as usize]
    }
    #[inline]
    fn reached_children(scene: Self, index: u32, origin: Vec3f, inverse: Vec3f, t_max: f32) -> u32 {
        reached_children(&scene.scene.nodes[index as usize], origin, inverse, t_max)
    }
    #[inline]
    fn shape(scene: Self, index: u32) -> ShapeRecord {
        scene.scene.objects[index as usize].shape
    }
    fn surface(scene: Self, index: u32) -> SurfaceRecord {
        scene.scene.objects[index as usize].surface
    }
    fn material(scene: Self, index: u32) -> MaterialRecord {
        scene.scene.materials[index as usize]
    }
    fn channel(scene: Self, index: u32) -> ChannelRecord {
        scene.scene.channels[index as usize]
    }
    fn texel(scene: Self, index: u32) -> u32 {
        scene.scene.texels[index as usize]
    }
    fn light(scene: Self, index: u32) -> LightRecord {
        scene.scene.lights[index as usize]
    }
    fn attribute(scene: Self, index: u32) -> Vec4f {
        let [x, y, z, w] = scene.scene.attributes[index as usize];
        vec4f(x, y, z, w)
    }
}
