//! Where on its surface a channel is evaluated, and in which directions the texture coordinates grow there.
//!
//! Objects whose material looks at the position have three entries in the attribute table more: the rows of the
//! matrix that carries their unit shape to the frame that they have in GroIMP, in metres. They stand at
//! `SurfaceRecord::attributes`, on triangles behind the entries of the corners.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// The coordinates of a surface point that channels look at.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct TexturePoint {
        /// Texture coordinates.
        pub uv: Vec2f,
        /// Position in the object's own frame in GroIMP, in metres. Zero if the material does not look at it.
        pub local: Vec3f,
        /// Position in the compiled scene, which is the world moved to the scene's middle, in metres. Zero if the
        /// material does not look at it.
        pub world: Vec3f,
    }

    /// Change of a point per unit of u and of v.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct Tangents {
        pub du: Vec3f,
        pub dv: Vec3f,
    }

    /// A point of which only the texture coordinates matter.
    pub fn uv_point(uv: Vec2f) -> TexturePoint {
        TexturePoint { uv, local: vec3f(0.0, 0.0, 0.0), world: vec3f(0.0, 0.0, 0.0) }
    }

    /// From the unit shape to the object's own frame.
    pub fn local_from_unit<S: SceneAccess + Copy>(
        scene: S,
        shape: ShapeRecord,
        surface: SurfaceRecord,
    ) -> Affine {
        let corners = select(0u32, 4u32, (shape.kind & SHAPE_MASK) == SHAPE_TRIANGLE);
        let first = surface.attributes + corners;
        Affine {
            row0: S::attribute(scene, first),
            row1: S::attribute(scene, first + 1u32),
            row2: S::attribute(scene, first + 2u32),
        }
    }

    /// From the unit shape to the compiled scene, through the instance if there is one.
    pub fn world_from_unit<S: SceneAccess + Copy>(scene: S, instance: u32, surface: SurfaceRecord) -> Affine {
        if instance == NONE {
            return surface.world_from_object;
        }
        compose(S::surface(scene, instance).world_from_object, surface.world_from_object)
    }

    /// The point `p` of the unit shape, whose texture coordinates are `uv`, as channels see it.
    pub fn texture_point<S: SceneAccess + Copy>(
        scene: S,
        instance: u32,
        shape: ShapeRecord,
        surface: SurfaceRecord,
        material: MaterialRecord,
        p: Vec3f,
        uv: Vec2f,
    ) -> TexturePoint {
        let mut at = uv_point(uv);
        if (material.flags & MATERIAL_USES_POSITION) != 0u32 {
            at.local = transform_point(local_from_unit::<S>(scene, shape, surface), p);
            at.world = transform_point(world_from_unit::<S>(scene, instance, surface), p);
        }
        at
    }

    /// Tangents of a triangle in the plane y = 0 of the unit shape; zero without texture coordinates.
    pub fn triangle_tangents<S: SceneAccess + Copy>(scene: S, surface: SurfaceRecord) -> Tangents {
        let zero = vec3f(0.0, 0.0, 0.0);
        let mut tangents = Tangents { du: zero, dv: zero };
        if surface.attributes == NONE {
            return tangents;
        }
        let a = S::attribute(scene, surface.attributes);
        let b = S::attribute(scene, surface.attributes + 1u32);
        let c = S::attribute(scene, surface.attributes + 2u32);
        let v = S::attribute(scene, surface.attributes + 3u32);
        // u and v grow linearly along the edges; the inverse of their matrix gives the tangents.
        let u1 = b.w - a.w;
        let u2 = c.w - a.w;
        let v1 = v.y - v.x;
        let v2 = v.z - v.x;
        let determinant = u1 * v2 - u2 * v1;
        if abs(determinant) < 1.0e-20 {
            return tangents;
        }
        tangents.du = vec3f(v2, 0.0, -v1) * (1.0 / determinant);
        tangents.dv = vec3f(-u2, 0.0, u1) * (1.0 / determinant);
        tangents
    }

    /// Tangents of a box's cross (see `box_cross`).
    pub fn box_tangents(face: u32) -> Tangents {
        let mut du = vec3f(8.0, 0.0, 0.0);
        let mut dv = vec3f(0.0, 6.0, 0.0);
        if face == 0u32 {
            du = vec3f(0.0, 0.0, 8.0);
        }
        if face == 1u32 {
            du = vec3f(0.0, 0.0, -8.0);
        }
        if face == 2u32 {
            dv = vec3f(0.0, 0.0, 6.0);
        }
        if face == 3u32 {
            dv = vec3f(0.0, 0.0, -6.0);
        }
        if face == 4u32 {
            du = vec3f(-8.0, 0.0, 0.0);
        }
        Tangents { du, dv }
    }

    /// Tangents at the point `p` of a unit shape in its own space.
    pub fn unit_tangents<S: SceneAccess + Copy>(
        scene: S,
        shape: ShapeRecord,
        surface: SurfaceRecord,
        face: u32,
        p: Vec3f,
    ) -> Tangents {
        if (shape.kind & SHAPE_MASK) == SHAPE_TRIANGLE {
            return triangle_tangents::<S>(scene, surface);
        }
        shape_tangents(shape, surface.v_scale, face, p)
    }

    /// Tangents of the analytic shapes: the derivatives of the inverse of `texture_coordinates`.
    pub fn shape_tangents(shape: ShapeRecord, v_factor: f32, face: u32, p: Vec3f) -> Tangents {
        let kind = shape.kind & SHAPE_MASK;
        let v_scale = away_from_zero(v_factor);
        if kind == SHAPE_PARALLELOGRAM {
            return Tangents { du: vec3f(2.0, 0.0, 0.0), dv: vec3f(0.0, 0.0, 1.0 / v_scale) };
        }
        if kind == SHAPE_PLANE {
            return Tangents { du: vec3f(1.0, 0.0, 0.0), dv: vec3f(0.0, 1.0, 0.0) };
        }
        if kind == SHAPE_BOX {
            return box_tangents(face);
        }
        let round = vec3f(-p.y, p.x, 0.0) * TWO_PI;
        let radial = max(sqrt(p.x * p.x + p.y * p.y), 1.0e-6);
        if kind == SHAPE_SPHERE {
            let up = vec3f(-p.z * p.x / radial, -p.z * p.y / radial, radial);
            return Tangents { du: round, dv: up * (0.5 * TWO_PI) };
        }
        if face == 0u32 {
            let slope = shape.top_radius - shape.base_radius;
            let up = vec3f(slope * p.x / radial, slope * p.y / radial, 1.0);
            return Tangents { du: round, dv: up * (1.0 / v_scale) };
        }
        let diameter = 2.0 * select(shape.top_radius, shape.base_radius, face == 1u32);
        let dv = vec3f(0.0, select(diameter, -diameter, face == 1u32), 0.0);
        Tangents { du: vec3f(diameter, 0.0, 0.0), dv }
    }

    /// Tangents carried by a matrix.
    pub fn transform_tangents(matrix: Affine, tangents: Tangents) -> Tangents {
        Tangents { du: transform_vector(matrix, tangents.du), dv: transform_vector(matrix, tangents.dv) }
    }
}

#[cfg(test)]
mod tests {
    use super::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use wgsl_rs::std::*;

    #[test]
    fn texture_coordinates_grow_along_the_tangents() {
        let zero = vec4f(0.0, 0.0, 0.0, 0.0);
        let identity = Affine { row0: zero, row1: zero, row2: zero };
        let p = vec3f(0.5, 0.3, 0.4);
        for (kind, faces) in [
            (SHAPE_SPHERE, 0..1),
            (SHAPE_BOX, 0..6),
            (SHAPE_FRUSTUM, 0..3),
            (SHAPE_PLANE, 0..1),
            (SHAPE_PARALLELOGRAM, 0..1),
        ] {
            let shape = ShapeRecord {
                object_from_world: identity,
                kind,
                material: 0,
                base_radius: 1.0,
                top_radius: 0.7,
            };
            for face in faces {
                let on = |p: Vec3f| snap_to_surface(shape, face, p);
                let uv = |p: Vec3f| texture_coordinates(shape, 1.5, face, p);
                let p = on(p);
                let tangents = shape_tangents(shape, 1.5, face, p);
                let step = 1.0e-3;
                for (tangent, du, dv) in [(tangents.du, step, 0.0), (tangents.dv, 0.0, step)] {
                    let (before, after) = (uv(p), uv(on(p + tangent * step)));
                    let error = (after.x - before.x - du).abs().max((after.y - before.y - dv).abs());
                    assert!(error < 2.0e-5, "shape {kind}, face {face}: {error}");
                }
            }
        }
    }
}
