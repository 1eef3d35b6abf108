//! What every renderer asks at a hit before light comes into play: which side of which material, where its channels
//! are evaluated, and the normal that its normal maps leave.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::bsdf::kernel::*;
    use crate::bump::kernel::*;
    use crate::coordinates::kernel::*;
    use crate::hit::kernel::*;
    use crate::mesh::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use crate::traversal::kernel::*;
    use wgsl_rs::std::*;

    /// A hit, ready to be shaded.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct ShadingPoint {
        pub point: SurfacePoint,
        /// Material of the side that the ray meets.
        pub material: MaterialRecord,
        /// Where its channels are evaluated.
        pub at: TexturePoint,
        /// Unit normal for scattering, on the side of the viewer.
        pub normal: Vec3f,
        /// Cosine of the viewer's direction with the outward normal: negative at the back.
        pub cos_front: f32,
        /// Tells the medium inside apart from others: by what it comes from and by its instance.
        pub body: u32,
    }

    /// What a ray meets in a hit.
    pub fn shading_point<S: SceneAccess + Copy>(scene: S, ray: Ray, hit: Hit) -> ShadingPoint {
        let shape = S::shape(scene, hit.object);
        let surface = S::surface(scene, hit.object);
        let mut point = hit_surface::<S>(scene, ray, hit);
        let wo = -ray.direction;
        let cos_front = dot(point.normal, wo);
        let material = sided_material::<S>(scene, shape.material, cos_front >= 0.0);
        let mut at = uv_point(point.uv);
        let looks_at_position =
            (material.flags & MATERIAL_USES_POSITION) != 0u32 || material.normal_map != NONE;
        if has::<S>(scene, FEATURE_POSITIONS) && looks_at_position {
            let p = hit_unit_point::<S>(scene, ray, hit);
            at = texture_point::<S>(scene, hit.instance, shape, surface, material, p, point.uv);
            point = with_normal_maps::<S>(scene, hit, material, p, at, point);
        }
        let normal = facing_normal(point, wo);
        let body = surface.source ^ ((hit.instance + 1u32) * 2654435769u32);
        ShadingPoint { point, material, at, normal, cos_front, body }
    }
}
