//! What triangles of a mesh have besides their plane: texture coordinates and smooth normals.
//!
//! They stand in the attribute table, four entries per triangle from `SurfaceRecord::attributes` on. Entries 0 to
//! 2 belong to the corners: unit normal, in the space of the group or, outside groups, of the scene, and u. The last
//! one holds the three v and, as w, 1 if the normals count. A smooth normal decides how light is scattered; the sides of the surface and the starts of rays
//! are those of the flat triangle, so that no light leaks through.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use wgsl_rs::std::*;

    /// A smooth normal is bent until it has this cosine with the viewer, whom the flat triangle faces.
    pub const LEAST_FACING: f32 = 1.0e-3;

    /// Texture coordinates, given those of the unit shape. On a triangle the latter are the weights of its second
    /// and third corner; a mesh without texture coordinates has (0, 0) everywhere.
    pub fn attribute_uv<S: SceneAccess + Copy>(
        scene: S,
        shape: ShapeRecord,
        surface: SurfaceRecord,
        uv: Vec2f,
    ) -> Vec2f {
        if !has::<S>(scene, 1u32 << SHAPE_TRIANGLE) || (shape.kind & SHAPE_MASK) != SHAPE_TRIANGLE {
            return uv;
        }
        if surface.attributes == NONE {
            return vec2f(0.0, 0.0);
        }
        let a = S::attribute(scene, surface.attributes);
        let b = S::attribute(scene, surface.attributes + 1u32);
        let c = S::attribute(scene, surface.attributes + 2u32);
        let v = S::attribute(scene, surface.attributes + 3u32);
        let rest = 1.0 - uv.x - uv.y;
        vec2f(a.w * rest + b.w * uv.x + c.w * uv.y, v.x * rest + v.y * uv.x + v.z * uv.y)
    }

    /// Smooth normal in the space of the group, or of the scene, at a point whose `uv` are the weights of the
    /// corners; of any length, zero if there is none.
    pub fn attribute_normal<S: SceneAccess + Copy>(
        scene: S,
        shape: ShapeRecord,
        surface: SurfaceRecord,
        point: SurfacePoint,
    ) -> Vec3f {
        let none = vec3f(0.0, 0.0, 0.0);
        if !has::<S>(scene, 1u32 << SHAPE_TRIANGLE)
            || (shape.kind & SHAPE_MASK) != SHAPE_TRIANGLE
            || surface.attributes == NONE
        {
            return none;
        }
        let last = S::attribute(scene, surface.attributes + 3u32);
        if last.w == 0.0 {
            return none;
        }
        let a = S::attribute(scene, surface.attributes);
        let b = S::attribute(scene, surface.attributes + 1u32);
        let c = S::attribute(scene, surface.attributes + 2u32);
        let sum = vec3f(a.x, a.y, a.z) * (1.0 - point.uv.x - point.uv.y)
            + vec3f(b.x, b.y, b.z) * point.uv.x
            + vec3f(c.x, c.y, c.z) * point.uv.y;
        // Normals that cancel out say nothing.
        select(none, sum, dot(sum, sum) >= 1.0e-12)
    }

    /// The point with what the attributes of its triangle say; `smooth_normal` is its smooth normal in world space, of
    /// any length, zero if there is none.
    pub fn with_attributes<S: SceneAccess + Copy>(
        scene: S,
        shape: ShapeRecord,
        surface: SurfaceRecord,
        point: SurfacePoint,
        smooth_normal: Vec3f,
    ) -> SurfacePoint {
        let mut result = point;
        let squared = dot(smooth_normal, smooth_normal);
        if squared > 0.0 {
            // A triangle that is listed a second time the other way round shares its normals with the first. The
            // scattering normal is never more than a right angle away from the normal of the flat triangle.
            let side = select(-1.0, 1.0, dot(smooth_normal, point.normal) >= 0.0);
            result.shading_normal = smooth_normal * (side / sqrt(squared));
        }
        result.uv = attribute_uv::<S>(scene, shape, surface, point.uv);
        result
    }

    /// The shading normal on the side of `wo`. Where the flat triangle faces the viewer and the smooth surface
    /// does not, it is bent towards the viewer.
    pub fn facing_normal(point: SurfacePoint, wo: Vec3f) -> Vec3f {
        let side = select(-1.0, 1.0, dot(point.normal, wo) >= 0.0);
        let normal = point.shading_normal * side;
        let cosine = dot(normal, wo);
        if cosine >= 0.0 {
            return normal;
        }
        normalize(normal + wo * (LEAST_FACING - cosine))
    }

    /// True if a scattered direction is on the same side of the flat triangle as of the smooth surface. Light in
    /// other directions would reflect into the body or transmit out of it; it is absorbed.
    pub fn same_side(point: SurfacePoint, facing: Vec3f, wo: Vec3f, direction: Vec3f) -> bool {
        let of_triangle = dot(point.normal, direction) * dot(point.normal, wo);
        let of_surface = dot(facing, direction);
        (of_triangle >= 0.0 && of_surface >= 0.0) || (of_triangle <= 0.0 && of_surface <= 0.0)
    }
}
