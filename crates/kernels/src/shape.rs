//! Rays against the unit shapes, and the surface data of a hit.
//!
//! Every shape is a unit shape under an affine matrix. Rays are carried to object space without normalising
//! their direction, so that the ray parameter t means the same in both spaces.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// A half line; points are `origin + t * direction`. The direction need not have unit length.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct Ray {
        pub origin: Vec3f,
        pub direction: Vec3f,
    }

    /// Where a ray meets a unit shape. No hit: `t` is `NO_HIT`.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct ShapeHit {
        pub t: f32,
        /// Part of the surface: 0 lateral surface or only side, 1 base cap, 2 top cap; box: 0 to 5 for
        /// -x, +x, -y, +y, -z, +z.
        pub face: u32,
    }

    /// Ray parameter of a ray that hits nothing; larger than any distance.
    pub const NO_HIT: f32 = 1.0e30;

    /// Geometry of a hit in world space.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct SurfacePoint {
        pub position: Vec3f,
        /// Bound of the rounding error of `position` along the normal, in metres.
        pub error: f32,
        /// Outward unit normal.
        pub normal: Vec3f,
        pub uv: Vec2f,
        /// Unit normal for scattering, less than a right angle from `normal`; differs on smooth meshes only.
        pub shading_normal: Vec3f,
    }

    pub fn transform_ray(matrix: Affine, ray: Ray) -> Ray {
        Ray {
            origin: transform_point(matrix, ray.origin),
            direction: transform_vector(matrix, ray.direction),
        }
    }

    pub fn no_hit() -> ShapeHit {
        ShapeHit { t: NO_HIT, face: 0 }
    }

    /// Parameter of the point of the ray that is closest to `centre`. Roots are computed relative to it, which
    /// keeps their precision when the ray starts far away from a small shape.
    pub fn closest_approach(ray: Ray, centre: Vec3f) -> f32 {
        dot(centre - ray.origin, ray.direction) / dot(ray.direction, ray.direction)
    }

    pub fn intersect_sphere(ray: Ray, t_min: f32, t_max: f32) -> ShapeHit {
        let t_mid = closest_approach(ray, vec3f(0.0, 0.0, 0.0));
        let p = ray.origin + ray.direction * t_mid;
        let a = dot(ray.direction, ray.direction);
        let discriminant = 1.0 - dot(p, p);
        let mut result = no_hit();
        if discriminant >= 0.0 {
            let half = sqrt(discriminant / a);
            let near = t_mid - half;
            let far = t_mid + half;
            let enters = near > t_min && near < t_max;
            if enters || (far > t_min && far < t_max) {
                result.t = select(far, near, enters);
            }
        }
        result
    }

    /// A divisor that is never zero.
    pub fn away_from_zero(x: f32) -> f32 {
        if abs(x) < 1.0e-20 {
            return select(-1.0e-20, 1.0e-20, x >= 0.0);
        }
        x
    }

    pub fn intersect_box(ray: Ray, t_min: f32, t_max: f32) -> ShapeHit {
        let d = vec3f(
            away_from_zero(ray.direction.x),
            away_from_zero(ray.direction.y),
            away_from_zero(ray.direction.z),
        );
        // Where the ray enters and leaves the three slabs.
        let inverse = vec3f(1.0, 1.0, 1.0) / d;
        let centre = -ray.origin * inverse;
        let half = abs(inverse);
        let enter = centre - half;
        let leave = centre + half;
        let t_in = max(enter.x, max(enter.y, enter.z));
        let t_out = min(leave.x, min(leave.y, leave.z));
        let mut result = no_hit();
        if t_in <= t_out {
            let from_outside = t_in > t_min;
            let t = select(t_out, t_in, from_outside);
            let side = select(d, -d, from_outside);
            let per_axis = select(leave, enter, from_outside);
            if t > t_min && t < t_max {
                let x = select(0u32, 1u32, side.x > 0.0);
                let y = select(2u32, 3u32, side.y > 0.0);
                let z = select(4u32, 5u32, side.z > 0.0);
                let face = select(select(z, y, t == per_axis.y), x, t == per_axis.x);
                result = ShapeHit { t, face };
            }
        }
        result
    }

    /// Cylinder, cone and frustum: lateral surface and up to two caps.
    pub fn intersect_frustum(
        kind: u32,
        base_radius: f32,
        top_radius: f32,
        ray: Ray,
        t_min: f32,
        t_max: f32,
    ) -> ShapeHit {
        let mut best = no_hit();
        best.t = t_max;

        // Lateral surface: x² + y² = r(z)², relative to the point of closest approach to the axis' middle.
        let slope = top_radius - base_radius;
        let t_mid = closest_approach(ray, vec3f(0.0, 0.0, 0.5));
        let p = ray.origin + ray.direction * t_mid;
        let d = ray.direction;
        let radius = base_radius + slope * p.z;
        let a = d.x * d.x + d.y * d.y - slope * slope * d.z * d.z;
        let half_b = p.x * d.x + p.y * d.y - radius * slope * d.z;
        let c = p.x * p.x + p.y * p.y - radius * radius;
        let discriminant = half_b * half_b - a * c;
        // At 0 the ray touches the surface or is parallel to that of a cylinder: neither is a hit.
        if discriminant > 0.0 {
            // The stable pair of roots: q / a and c / q.
            let root = sqrt(discriminant);
            let q = -(half_b + select(-root, root, half_b >= 0.0));
            let t0 = t_mid + c / away_from_zero(q);
            let t1 = t_mid + q / away_from_zero(a);
            let near = min(t0, t1);
            let far = max(t0, t1);
            if on_lateral_surface(base_radius, top_radius, ray, near) && near > t_min && near < best.t {
                best.t = near;
            } else {
                if on_lateral_surface(base_radius, top_radius, ray, far) && far > t_min && far < best.t {
                    best.t = far;
                }
            }
        }

        // Caps.
        let dz = away_from_zero(d.z);
        if (kind & FLAG_BASE_OPEN) == 0u32 {
            let t = -ray.origin.z / dz;
            if t > t_min && t < best.t && within_radius(ray, t, base_radius) {
                best = ShapeHit { t, face: 1 };
            }
        }
        if (kind & FLAG_TOP_OPEN) == 0u32 {
            let t = (1.0 - ray.origin.z) / dz;
            if t > t_min && t < best.t && within_radius(ray, t, top_radius) {
                best = ShapeHit { t, face: 2 };
            }
        }
        best.t = select(NO_HIT, best.t, best.t < t_max);
        best
    }

    pub fn on_lateral_surface(base_radius: f32, top_radius: f32, ray: Ray, t: f32) -> bool {
        let z = ray.origin.z + t * ray.direction.z;
        let radius = base_radius + (top_radius - base_radius) * z;
        // The mirror image of a cone beyond its apex has a negative radius.
        z >= 0.0 && z <= 1.0 && radius >= 0.0
    }

    pub fn within_radius(ray: Ray, t: f32, radius: f32) -> bool {
        let x = ray.origin.x + t * ray.direction.x;
        let y = ray.origin.y + t * ray.direction.y;
        x * x + y * y <= radius * radius
    }

    /// Plane, parallelogram and triangle, given a ray in the world: where it crosses their plane is known after a
    /// third of the work, and most rays that reach a box do not cross it in time.
    ///
    /// A triangle of a mesh reaches beyond its edges by the rounding error of the point there, so that rays do not
    /// slip through between neighbours, which round differently.
    pub fn intersect_flat(
        features: u32,
        flags: u32,
        object_from_world: Affine,
        ray: Ray,
        t_min: f32,
        t_max: f32,
    ) -> ShapeHit {
        let m = object_from_world;
        let kind = flags & SHAPE_MASK;
        let mut across = m.row1;
        let is_plane = (features & (1u32 << SHAPE_PLANE)) != 0u32 && kind == SHAPE_PLANE;
        if is_plane {
            across = m.row2;
        }
        let slope = turn_row(across, ray.direction);
        let t = -transform_row(across, ray.origin) / away_from_zero(slope);
        let mut result = no_hit();
        if t > t_min && t < t_max {
            let x = transform_row(m.row0, ray.origin) + t * turn_row(m.row0, ray.direction);
            let z = transform_row(m.row2, ray.origin) + t * turn_row(m.row2, ray.direction);
            let mut inside = is_plane || (abs(x) <= 1.0 && z >= 0.0 && z <= 1.0);
            if (features & (1u32 << SHAPE_TRIANGLE)) != 0u32 && kind == SHAPE_TRIANGLE {
                let far = abs(ray.origin) + abs(ray.direction) * abs(t);
                let margin_x = ROUNDING * transform_row(abs(m.row0), far);
                let margin_z = ROUNDING * transform_row(abs(m.row2), far);
                let hidden = select(FLAG_BACK_HIDDEN, FLAG_FRONT_HIDDEN, slope < 0.0);
                inside = x >= -margin_x
                    && z >= -margin_z
                    && x + z <= 1.0 + margin_x + margin_z
                    && (flags & hidden) == 0u32;
            }
            result.t = select(NO_HIT, t, inside);
        }
        result
    }

    /// The first hit of a world-space ray with the shape at t in (`t_min`, `t_max`); `features` tells which shapes
    /// there may be.
    pub fn intersect_shape(
        features: u32,
        shape: ShapeRecord,
        ray_world: Ray,
        t_min: f32,
        t_max: f32,
    ) -> ShapeHit {
        // All that is needed is fetched here, once for all kinds of shapes: processors with lanes fetch where they are told.
        let object_from_world = shape.object_from_world;
        let flags = shape.kind;
        let kind = flags & SHAPE_MASK;
        // One way out: lanes of processors pay for every return.
        let mut result = no_hit();
        if kind >= SHAPE_PLANE {
            result = intersect_flat(features, flags, object_from_world, ray_world, t_min, t_max);
        } else {
            let ray = transform_ray(object_from_world, ray_world);
            if (features & (1u32 << SHAPE_FRUSTUM)) != 0u32 && kind == SHAPE_FRUSTUM {
                result = intersect_frustum(flags, shape.base_radius, shape.top_radius, ray, t_min, t_max);
            } else if (features & (1u32 << SHAPE_SPHERE)) != 0u32 && kind == SHAPE_SPHERE {
                result = intersect_sphere(ray, t_min, t_max);
            } else if (features & (1u32 << SHAPE_BOX)) != 0u32 {
                result = intersect_box(ray, t_min, t_max);
            }
        }
        result
    }

    /// Moves a point in object space exactly onto the surface that was hit, which makes its error independent
    /// of the length of the ray.
    pub fn snap_to_surface(shape: ShapeRecord, face: u32, p: Vec3f) -> Vec3f {
        let kind = shape.kind & SHAPE_MASK;
        if kind == SHAPE_SPHERE {
            return normalize(p);
        }
        if kind == SHAPE_PLANE {
            return vec3f(p.x, p.y, 0.0);
        }
        if kind == SHAPE_PARALLELOGRAM || kind == SHAPE_TRIANGLE {
            return vec3f(p.x, 0.0, p.z);
        }
        if kind == SHAPE_BOX {
            let side = f32(face & 1u32) * 2.0 - 1.0;
            if face < 2u32 {
                return vec3f(side, p.y, p.z);
            }
            if face < 4u32 {
                return vec3f(p.x, side, p.z);
            }
            return vec3f(p.x, p.y, side);
        }
        if face == 1u32 {
            return vec3f(p.x, p.y, 0.0);
        }
        if face == 2u32 {
            return vec3f(p.x, p.y, 1.0);
        }
        let z = clamp(p.z, 0.0, 1.0);
        let radius = max(0.0, shape.base_radius + (shape.top_radius - shape.base_radius) * z);
        let scale = radius / max(sqrt(p.x * p.x + p.y * p.y), 1.0e-20);
        vec3f(p.x * scale, p.y * scale, z)
    }

    /// Outward normal in object space; not of unit length.
    pub fn object_normal(shape: ShapeRecord, face: u32, p: Vec3f) -> Vec3f {
        let kind = shape.kind & SHAPE_MASK;
        if kind == SHAPE_SPHERE {
            return p;
        }
        if kind == SHAPE_PLANE {
            return vec3f(0.0, 0.0, 1.0);
        }
        if kind == SHAPE_PARALLELOGRAM || kind == SHAPE_TRIANGLE {
            return vec3f(0.0, 1.0, 0.0);
        }
        if kind == SHAPE_BOX {
            let side = f32(face & 1u32) * 2.0 - 1.0;
            if face < 2u32 {
                return vec3f(side, 0.0, 0.0);
            }
            if face < 4u32 {
                return vec3f(0.0, side, 0.0);
            }
            return vec3f(0.0, 0.0, side);
        }
        if face == 1u32 {
            return vec3f(0.0, 0.0, -1.0);
        }
        if face == 2u32 {
            return vec3f(0.0, 0.0, 1.0);
        }
        // Gradient of x² + y² - r(z)², with the direction of (x, y) kept where the radius vanishes.
        let radial = max(sqrt(p.x * p.x + p.y * p.y), 1.0e-20);
        vec3f(p.x / radial, p.y / radial, shape.base_radius - shape.top_radius)
    }

    /// Angle round z as a fraction of the full turn, in [0, 1).
    pub fn turn_fraction(p: Vec3f) -> f32 {
        let u = atan2(p.y, p.x) / TWO_PI;
        select(u, u + 1.0, u < 0.0)
    }

    /// Texture coordinates, scene-format.md chapter 4.1; on a triangle the weights of its second and third corner.
    pub fn texture_coordinates(shape: ShapeRecord, v_scale: f32, face: u32, p: Vec3f) -> Vec2f {
        let kind = shape.kind & SHAPE_MASK;
        if kind == SHAPE_PARALLELOGRAM {
            return vec2f(0.5 * p.x + 0.5, p.z * v_scale);
        }
        if kind == SHAPE_TRIANGLE {
            return vec2f(p.x, p.z);
        }
        if kind == SHAPE_PLANE {
            return vec2f(p.x, p.y);
        }
        if kind == SHAPE_SPHERE {
            return vec2f(turn_fraction(p), acos(clamp(-p.z, -1.0, 1.0)) * INVERSE_PI);
        }
        if kind == SHAPE_BOX {
            return box_cross(face, p);
        }
        if face == 0u32 {
            return vec2f(turn_fraction(p), p.z * v_scale);
        }
        let radius = max(select(shape.top_radius, shape.base_radius, face == 1u32), 1.0e-20);
        let x = 0.5 * p.x / radius;
        let y = 0.5 * p.y / radius;
        vec2f(x + 0.5, select(0.5 + y, 0.5 - y, face == 1u32))
    }

    /// The 4 by 3 cross that unfolds a box.
    pub fn box_cross(face: u32, p: Vec3f) -> Vec2f {
        let mut uv = vec2f((p.x + 3.0) / 8.0, (p.y + 3.0) / 6.0);
        if face == 0u32 {
            uv = vec2f((p.z + 1.0) / 8.0, (p.y + 3.0) / 6.0);
        }
        if face == 1u32 {
            uv = vec2f((5.0 - p.z) / 8.0, (p.y + 3.0) / 6.0);
        }
        if face == 2u32 {
            uv = vec2f((p.x + 3.0) / 8.0, (p.z + 1.0) / 6.0);
        }
        if face == 3u32 {
            uv = vec2f((p.x + 3.0) / 8.0, (5.0 - p.z) / 6.0);
        }
        if face == 4u32 {
            uv = vec2f((7.0 - p.x) / 8.0, (p.y + 3.0) / 6.0);
        }
        clamp(uv, vec2f(0.0, 0.0), vec2f(1.0, 1.0))
    }

    /// Unit roundoff of 32-bit floats times a safety factor for the handful of operations between two hits.
    pub const ROUNDING: f32 = 4.0e-7;

    /// The point in object space, exactly on the surface, where a world-space ray hit.
    pub fn hit_point(shape: ShapeRecord, ray_world: Ray, hit: ShapeHit) -> Vec3f {
        let ray = transform_ray(shape.object_from_world, ray_world);
        snap_to_surface(shape, hit.face, ray.origin + ray.direction * hit.t)
    }

    /// Everything about the point where `ray` hit the shape at parameter `hit.t`, except the attributes of meshes. The
    /// matrices are those of the shape, or of its instance in case of a group.
    pub fn surface_point(
        shape: ShapeRecord,
        v_scale: f32,
        object_from_world: Affine,
        world_from_object: Affine,
        ray: Ray,
        hit: ShapeHit,
    ) -> SurfacePoint {
        let local = transform_ray(object_from_world, ray);
        let p = snap_to_surface(shape, hit.face, local.origin + local.direction * hit.t);
        let position = transform_point(world_from_object, p);
        let normal = normalize(transform_transposed(object_from_world, object_normal(shape, hit.face, p)));

        // Rounding error of the position, and of carrying a ray from there back to object space, where the next
        // intersection is decided; both brought to world space.
        let error_world = transform_magnitude(world_from_object, p);
        let error_object = transform_magnitude(object_from_world, position);
        let m = world_from_object;
        let e = vec4f(error_object.x, error_object.y, error_object.z, 0.0);
        let carried = vec3f(dot(abs(m.row0), e), dot(abs(m.row1), e), dot(abs(m.row2), e));
        let error = ROUNDING * dot(abs(normal), error_world + carried);

        SurfacePoint {
            position,
            error,
            normal,
            uv: texture_coordinates(shape, v_scale, hit.face, p),
            shading_normal: normal,
        }
    }

    /// Start of a ray that leaves the surface in `direction` without meeting it again by rounding.
    pub fn offset_origin(point: SurfacePoint, direction: Vec3f) -> Vec3f {
        let side = select(-1.0, 1.0, dot(direction, point.normal) >= 0.0);
        point.position + point.normal * (side * point.error)
    }
}
