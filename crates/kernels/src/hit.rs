//! The surface at a hit, through the placement of its instance.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::mesh::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use crate::traversal::kernel::*;
    use wgsl_rs::std::*;

    /// Bound of the error that carrying points in and out of an instance adds along a unit normal, in metres.
    pub fn placement_error(group_from_world: Affine, world_from_group: Affine, point: SurfacePoint) -> f32 {
        let error_group = transform_magnitude(group_from_world, point.position);
        let error_world =
            transform_magnitude(world_from_group, transform_point(group_from_world, point.position));
        let e = vec4f(error_group.x, error_group.y, error_group.z, 0.0);
        let m = world_from_group;
        let carried = vec3f(dot(abs(m.row0), e), dot(abs(m.row1), e), dot(abs(m.row2), e));
        ROUNDING * dot(abs(point.normal), error_world + carried)
    }

    /// The point of the unit shape that a world-space ray hit.
    pub fn hit_unit_point<S: SceneAccess + Copy>(scene: S, ray: Ray, hit: Hit) -> Vec3f {
        let mut local = ray;
        if has::<S>(scene, 1u32 << SHAPE_INSTANCE) && hit.instance != NONE {
            local = transform_ray(S::shape(scene, hit.instance).object_from_world, ray);
        }
        hit_point(S::shape(scene, hit.object), local, hit.shape)
    }

    /// Everything about the point where a world-space ray hit.
    pub fn hit_surface<S: SceneAccess + Copy>(scene: S, ray: Ray, hit: Hit) -> SurfacePoint {
        let shape = S::shape(scene, hit.object);
        let surface = S::surface(scene, hit.object);
        let v_scale = surface.v_scale;
        if !has::<S>(scene, 1u32 << SHAPE_INSTANCE) || hit.instance == NONE {
            let object_from_world = shape.object_from_world;
            let world_from_object = surface.world_from_object;
            let flat_point =
                surface_point(shape, v_scale, object_from_world, world_from_object, ray, hit.shape);
            let normal = attribute_normal::<S>(scene, shape, surface, flat_point);
            return with_attributes::<S>(scene, shape, surface, flat_point, normal);
        }
        let group_from_world = S::shape(scene, hit.instance).object_from_world;
        let world_from_group = S::surface(scene, hit.instance).world_from_object;
        let object_from_world = compose(shape.object_from_world, group_from_world);
        let world_from_object = compose(world_from_group, surface.world_from_object);
        let mut flat_point =
            surface_point(shape, v_scale, object_from_world, world_from_object, ray, hit.shape);
        // The products of the matrices are rounded, too.
        flat_point.error =
            2.0 * flat_point.error + placement_error(group_from_world, world_from_group, flat_point);
        let normal =
            transform_transposed(group_from_world, attribute_normal::<S>(scene, shape, surface, flat_point));
        with_attributes::<S>(scene, shape, surface, flat_point, normal)
    }
}
