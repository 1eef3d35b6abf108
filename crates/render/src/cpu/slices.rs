//! The kernels' view of a scene in main memory.

use super::reached::reached_children;
use crate::CompiledScene;
use kernels::records::kernel::*;
use rayon::prelude::*;
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
    /// What of the objects rays are tested with, or nothing.
    shapes: &'a [ShapeLine],
    /// See `leaves_are_single`.
    leaves_are_single: bool,
}

/// A record that takes one line of the processor's cache.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct ShapeLine(ShapeRecord);

/// Those of all objects.
pub(super) fn shape_lines(objects: &[ObjectRecord]) -> Vec<ShapeLine> {
    objects.par_iter().with_min_len(4096).map(|object| ShapeLine(object.shape)).collect()
}

/// See [`Slices::leaves_are_single`].
pub(super) fn leaves_are_single(nodes: &[BvhNode]) -> bool {
    nodes.par_iter().with_min_len(4096).all(|node| {
        let leaves = u64::from(node.leaves0) | u64::from(node.leaves1) << 32;
        let leaves = leaves.to_le_bytes().into_iter().filter(|leaf| *leaf != 0);
        node.exponents == NODE_INSTANCE || (0u8..).zip(leaves).all(|(place, leaf)| leaf == 1 << 5 | place)
    })
}

impl<'a, const FEATURES: u32> Slices<'a, FEATURES> {
    pub(super) fn new(
        scene: &'a CompiledScene,
        header: &'a SceneHeader,
        shapes: &'a [ShapeLine],
        leaves_are_single: bool,
    ) -> Self {
        Slices { scene, header, shapes, leaves_are_single }
    }

    /// Whether all leaves of the hierarchies hold one object, those of a node in the order of its children.
    #[inline]
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    pub(super) fn leaves_are_single(self) -> bool {
        self.leaves_are_single
    }

    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    pub(super) fn scene(self) -> &'a CompiledScene {
        self.scene
    }
}

impl<'a> Slices<'a, ALL_FEATURES> {
    /// A view that needs no preparation, for a few rays.
    pub(crate) fn of(scene: &'a CompiledScene) -> Self {
        Self::through(scene, &scene.header)
    }

    /// As [`Slices::of`], through another camera.
    pub(crate) fn through(scene: &'a CompiledScene, header: &'a SceneHeader) -> Self {
        Slices { scene, header, shapes: &[], leaves_are_single: false }
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
        match scene.shapes.get(index as usize) {
            Some(line) => line.0,
            None => scene.scene.objects[index as usize].shape,
        }
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
