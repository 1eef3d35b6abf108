//! Heights that bend the shading normal: GroIMP's `BumpMap` and `WaveMap` (materials-and-lights.md 2.8).
//!
//! The surface is thought of as raised by `h` times the unit normal n, so dp/du grows by n dh/du, dp/dv by n dh/dv,
//! and the cross product of both is the new normal. Deviation from GroIMP, which takes dh/du for both, probably by
//! mistake. The slopes are central differences in u and v. A height that looks at the position sees it move along
//! the tangents.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::channel::kernel::*;
    use crate::coordinates::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use crate::traversal::kernel::*;
    use wgsl_rs::std::*;

    /// Change of the height `index` per unit of u and of v.
    pub fn height_slopes<S: SceneAccess + Copy>(
        scene: S,
        normal_map: ChannelRecord,
        at: TexturePoint,
        local: Tangents,
        world: Tangents,
    ) -> Vec2f {
        let mut slopes = vec2f(0.0, 0.0);
        for k in 0..4 {
            let along_u = k < 2;
            let forward = select(-1.0, 1.0, k % 2 == 0);
            let mut step = forward * normal_map.value.z;
            let mut shifted = at;
            if along_u {
                step = forward * normal_map.value.y;
                shifted.uv = vec2f(at.uv.x + step, at.uv.y);
                shifted.local = at.local + local.du * step;
                shifted.world = at.world + world.du * step;
            } else {
                shifted.uv = vec2f(at.uv.x, at.uv.y + step);
                shifted.local = at.local + local.dv * step;
                shifted.world = at.world + world.dv * step;
            }
            let height = channel_value::<S>(scene, normal_map.first, shifted, vec4f(0.0, 0.0, 0.0, 1.0));
            let part = height.x / (2.0 * step);
            slopes += select(vec2f(0.0, part), vec2f(part, 0.0), vec2b(along_u, along_u));
        }
        slopes
    }

    /// True if the normal map counts at these texture coordinates.
    pub fn normal_map_covers(normal_map: ChannelRecord, uv: Vec2f) -> bool {
        let on_box_top = uv.x >= 0.25 && uv.x <= 0.5 && uv.y >= 0.33333333 && uv.y <= 0.66666667;
        normal_map.size == 0u32 || on_box_top
    }

    /// The point of a hit, `p` on the unit shape, with the shading normal that the normal maps of the material give it.
    pub fn with_normal_maps<S: SceneAccess + Copy>(
        scene: S,
        hit: Hit,
        material: MaterialRecord,
        p: Vec3f,
        at: TexturePoint,
        point: SurfacePoint,
    ) -> SurfacePoint {
        if material.normal_map == NONE {
            return point;
        }
        let shape = S::shape(scene, hit.object);
        let surface = S::surface(scene, hit.object);
        let unit = unit_tangents::<S>(scene, shape, surface, hit.shape.face, p);
        let world = transform_tangents(world_from_unit::<S>(scene, hit.instance, surface), unit);
        let mut local = unit;
        if (material.flags & MATERIAL_USES_POSITION) != 0u32 {
            local = transform_tangents(local_from_unit::<S>(scene, shape, surface), unit);
        }
        let mut normal = point.shading_normal;
        let mut du = world.du;
        let mut dv = world.dv;
        let mut index = material.normal_map;
        while index != NONE {
            let normal_map = S::channel(scene, index);
            index = normal_map.mode;
            if normal_map_covers(normal_map, at.uv) {
                let slopes = height_slopes::<S>(scene, normal_map, at, local, world) * normal_map.value.x;
                // On smooth meshes the triangle is not quite at right angles to the normal.
                du += normal * (slopes.x - dot(du, normal));
                dv += normal * (slopes.y - dot(dv, normal));
                let bent = cross(du, dv);
                let squared = dot(bent, bent);
                if squared > 0.0 {
                    let outward = select(-1.0, 1.0, dot(bent, normal) >= 0.0);
                    normal = bent * (outward / sqrt(squared));
                }
            }
        }
        let mut result = point;
        if dot(normal, point.normal) > 0.0 {
            result.shading_normal = normal;
        }
        result
    }
}
