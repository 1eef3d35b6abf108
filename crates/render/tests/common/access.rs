//! The kernels' view of a compiled scene, for tests that call single kernel functions.

use kernels::bvh::kernel::reached_boxes;
use kernels::records::kernel::*;
use render::CompiledScene;
use wgsl_rs::std::{Vec3f, Vec4f, vec4f};

#[derive(Clone, Copy)]
pub struct Access<'a>(pub &'a CompiledScene);

impl SceneAccess for Access<'_> {
    fn features(scene: Self) -> u32 {
        scene.0.features
    }
    fn header(scene: Self) -> SceneHeader {
        scene.0.header
    }
    fn node(scene: Self, index: u32) -> BvhNode {
        scene.0.nodes[index as usize]
    }
    fn reached_children(scene: Self, index: u32, origin: Vec3f, inverse: Vec3f, t_max: f32) -> u32 {
        reached_boxes(scene.0.nodes[index as usize], origin, inverse, t_max)
    }
    fn shape(scene: Self, index: u32) -> ShapeRecord {
        scene.0.objects[index as usize].shape
    }
    fn surface(scene: Self, index: u32) -> SurfaceRecord {
        scene.0.objects[index as usize].surface
    }
    fn material(scene: Self, index: u32) -> MaterialRecord {
        scene.0.materials[index as usize]
    }
    fn channel(scene: Self, index: u32) -> ChannelRecord {
        scene.0.channels[index as usize]
    }
    fn texel(scene: Self, index: u32) -> u32 {
        scene.0.texels[index as usize]
    }
    fn light(scene: Self, index: u32) -> LightRecord {
        scene.0.lights[index as usize]
    }
    fn attribute(scene: Self, index: u32) -> Vec4f {
        let [x, y, z, w] = scene.0.attributes[index as usize];
        vec4f(x, y, z, w)
    }
}
