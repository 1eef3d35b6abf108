struct Affine {
    row0: vec4f,
    row1: vec4f,
    row2: vec4f
}

struct BvhNode {
    min0: vec3f,
    child0: u32,
    max0: vec3f,
    count0: u32,
    min1: vec3f,
    child1: u32,
    max1: vec3f,
    count1: u32
}
const INSTANCE_BIT: u32 = 2147483648u;
const SHAPE_SPHERE: u32 = 0u;
const SHAPE_BOX: u32 = 1u;
const SHAPE_FRUSTUM: u32 = 2u;
const SHAPE_PLANE: u32 = 3u;
const SHAPE_PARALLELOGRAM: u32 = 4u;
const SHAPE_TRIANGLE: u32 = 5u;
const SHAPE_INSTANCE: u32 = 6u;
const SHAPE_MASK: u32 = 255u;
const FLAG_BASE_OPEN: u32 = 256u;
const FLAG_TOP_OPEN: u32 = 512u;
const FLAG_NOT_OPAQUE: u32 = 1024u;
const FLAG_FRONT_HIDDEN: u32 = 2048u;
const FLAG_BACK_HIDDEN: u32 = 4096u;

struct ShapeRecord {
    object_from_world: Affine,
    kind: u32,
    material: u32,
    base_radius: f32,
    top_radius: f32
}

struct SurfaceRecord {
    world_from_object: Affine,
    v_scale: f32,
    light: u32,
    source: u32,
    attributes: u32
}

struct ObjectRecord {
    shape: ShapeRecord,
    surface: SurfaceRecord
}
const NONE: u32 = 4294967295u;

struct MaterialRecord {
    diffuse: u32,
    specular: u32,
    shininess: u32,
    transparency: u32,
    transparency_shininess: u32,
    diffuse_transparency: u32,
    ambient: u32,
    emissive: u32,
    interpolated_transparency: u32,
    opacity: f32,
    reserved0: u32,
    reserved1: u32
}
const CHANNEL_CONSTANT: u32 = 0u;
const CHANNEL_IMAGE: u32 = 1u;
const CHANNEL_CHECKER: u32 = 2u;
const CHANNEL_MOVE_UV: u32 = 3u;
const CHANNEL_LINEAR_UV: u32 = 4u;

struct ChannelRecord {
    value: vec4f,
    operation: u32,
    first: u32,
    size: u32,
    bilinear: u32
}
const LIGHT_POINT: u32 = 0u;
const LIGHT_SPOT: u32 = 1u;
const LIGHT_DIRECTIONAL: u32 = 2u;
const LIGHT_AREA: u32 = 3u;
const LIGHT_SKY: u32 = 4u;

struct LightRecord {
    position: vec3f,
    kind: u32,
    axis: vec3f,
    shadowless: u32,
    emission: vec3f,
    cos_inner: f32,
    edge_u: vec3f,
    cos_outer: f32,
    edge_v: vec3f,
    importance: f32
}
const CAMERA_PERSPECTIVE: u32 = 0u;
const CAMERA_PARALLEL: u32 = 1u;

struct SceneHeader {
    world_from_view: Affine,
    view_scale_x: f32,
    view_scale_y: f32,
    start_distance: f32,
    camera: u32,
    unbounded_objects: u32,
    nodes: u32,
    lights: u32,
    sky: u32
}

struct LaunchSettings {
    width: u32,
    height: u32,
    tile_x: u32,
    tile_y: u32,
    tile_width: u32,
    tile_height: u32,
    first_sample: u32,
    samples: u32,
    seed: u32,
    grid: u32,
    depth: u32,
    reserved: u32
}

struct FilmPixel {
    radiance: vec3f,
    rays: u32,
    squares: vec3f,
    samples: u32
}

fn transform_point(matrix: Affine, point: vec3f) -> vec3f {
    let p = vec4f(point.x, point.y, point.z, 1.0);
    return vec3f(dot(matrix.row0, p), dot(matrix.row1, p), dot(matrix.row2, p));
}

fn compose_row(row: vec4f, second: Affine) -> vec4f {
    return ((((second.row0 * row.x) + (second.row1 * row.y)) + (second.row2 * row.z)) + vec4f(0.0, 0.0, 0.0, row.w));
}

fn compose(first: Affine, second: Affine) -> Affine {
    return Affine(compose_row(first.row0, second), compose_row(first.row1, second), compose_row(first.row2, second));
}

fn transform_vector(matrix: Affine, direction: vec3f) -> vec3f {
    let d = vec4f(direction.x, direction.y, direction.z, 0.0);
    return vec3f(dot(matrix.row0, d), dot(matrix.row1, d), dot(matrix.row2, d));
}

fn transform_transposed(matrix: Affine, normal: vec3f) -> vec3f {
    return vec3f((((matrix.row0.x * normal.x) + (matrix.row1.x * normal.y)) + (matrix.row2.x * normal.z)), (((matrix.row0.y * normal.x) + (matrix.row1.y * normal.y)) + (matrix.row2.y * normal.z)), (((matrix.row0.z * normal.x) + (matrix.row1.z * normal.y)) + (matrix.row2.z * normal.z)));
}

fn transform_magnitude(matrix: Affine, point: vec3f) -> vec3f {
    let p = vec4f(abs(point.x), abs(point.y), abs(point.z), 1.0);
    return vec3f(dot(abs(matrix.row0), p), dot(abs(matrix.row1), p), dot(abs(matrix.row2), p));
}

const PI: f32 = 3.14159265358979;
const INVERSE_PI: f32 = 0.318309886183791;
const TWO_PI: f32 = 6.28318530717959;

fn around_axis(axis: vec3f, local: vec3f) -> vec3f {
    let sign = select(-1.0, 1.0, (axis.z >= 0.0));
    let a = (-1.0 / (sign + axis.z));
    let b = ((axis.x * axis.y) * a);
    let x = vec3f((1.0 + (((sign * axis.x) * axis.x) * a)), (sign * b), (-sign * axis.x));
    let y = vec3f(b, (sign + ((axis.y * axis.y) * a)), -axis.y);
    return normalize((((x * local.x) + (y * local.y)) + (axis * local.z)));
}

fn polar_direction(cos_theta: f32, u: f32) -> vec3f {
    let sin_theta = sqrt(max(0.0, (1.0 - (cos_theta * cos_theta))));
    let phi = (TWO_PI * u);
    return vec3f((cos(phi) * sin_theta), (sin(phi) * sin_theta), cos_theta);
}

fn cosine_hemisphere(u: vec2f) -> vec3f {
    return polar_direction(sqrt((1.0 - u.x)), u.y);
}

fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    return (max(cos_theta, 0.0) * INVERSE_PI);
}

fn power_cosine(u: vec2f, exponent: f32) -> vec3f {
    return polar_direction(pow((1.0 - u.x), (1.0 / (exponent + 1.0))), u.y);
}

fn power_cosine_pdf(cos_theta: f32, exponent: f32) -> f32 {
    if (cos_theta <= 0.0) {
        return 0.0;
    }
    return (((exponent + 1.0) / TWO_PI) * pow(cos_theta, exponent));
}

fn power_heuristic(pdf: f32, other: f32) -> f32 {
    if (pdf <= 0.0) {
        return 0.0;
    }
    let ratio = (other / pdf);
    return (1.0 / (1.0 + (ratio * ratio)));
}

fn luminance(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

fn smallest(color: vec3f) -> f32 {
    return min(color.x, min(color.y, color.z));
}

fn largest(color: vec3f) -> f32 {
    return max(color.x, max(color.y, color.z));
}

struct Ray {
    origin: vec3f,
    direction: vec3f
}

struct ShapeHit {
    t: f32,
    face: u32
}
const NO_HIT: f32 = 1.0e30;

struct SurfacePoint {
    position: vec3f,
    error: f32,
    normal: vec3f,
    uv: vec2f,
    shading_normal: vec3f
}

fn transform_ray(matrix: Affine, ray: Ray) -> Ray {
    return Ray(transform_point(matrix, ray.origin), transform_vector(matrix, ray.direction));
}

fn no_hit() -> ShapeHit {
    return ShapeHit(NO_HIT, 0u);
}

fn closest_approach(ray: Ray, centre: vec3f) -> f32 {
    return (dot((centre - ray.origin), ray.direction) / dot(ray.direction, ray.direction));
}

fn intersect_sphere(ray: Ray, t_min: f32, t_max: f32) -> ShapeHit {
    let t_mid = closest_approach(ray, vec3f(0.0, 0.0, 0.0));
    let p = (ray.origin + (ray.direction * t_mid));
    let a = dot(ray.direction, ray.direction);
    let discriminant = (1.0 - dot(p, p));
    if (discriminant < 0.0) {
        return no_hit();
    }
    let half = sqrt((discriminant / a));
    if (((t_mid - half) > t_min) && ((t_mid - half) < t_max)) {
        return ShapeHit((t_mid - half), 0u);
    }
    if (((t_mid + half) > t_min) && ((t_mid + half) < t_max)) {
        return ShapeHit((t_mid + half), 0u);
    }
    return no_hit();
}

fn away_from_zero(x: f32) -> f32 {
    if (abs(x) < 1.0e-20) {
        return select(-1.0e-20, 1.0e-20, (x >= 0.0));
    }
    return x;
}

fn intersect_box(ray: Ray, t_min: f32, t_max: f32) -> ShapeHit {
    let d = vec3f(away_from_zero(ray.direction.x), away_from_zero(ray.direction.y), away_from_zero(ray.direction.z));
    let centre = (-ray.origin / d);
    let half = (vec3f(1.0, 1.0, 1.0) / abs(d));
    let enter = (centre - half);
    let leave = (centre + half);
    let t_in = max(enter.x, max(enter.y, enter.z));
    let t_out = min(leave.x, min(leave.y, leave.z));
    if (t_in > t_out) {
        return no_hit();
    }
    var t = t_in;
    var side = vec3f(-d.x, -d.y, -d.z);
    var per_axis = enter;
    if (t <= t_min) {
        t = t_out;
        side = d;
        per_axis = leave;
    }
    if ((t <= t_min) || (t >= t_max)) {
        return no_hit();
    }
    if (t == per_axis.x) {
        return ShapeHit(t, select(0u, 1u, (side.x > 0.0)));
    }
    if (t == per_axis.y) {
        return ShapeHit(t, select(2u, 3u, (side.y > 0.0)));
    }
    return ShapeHit(t, select(4u, 5u, (side.z > 0.0)));
}

fn intersect_frustum(shape: ShapeRecord, ray: Ray, t_min: f32, t_max: f32) -> ShapeHit {
    var best = no_hit();
    best.t = t_max;
    let slope = (shape.top_radius - shape.base_radius);
    let t_mid = closest_approach(ray, vec3f(0.0, 0.0, 0.5));
    let p = (ray.origin + (ray.direction * t_mid));
    let d = ray.direction;
    let radius = (shape.base_radius + (slope * p.z));
    let a = (((d.x * d.x) + (d.y * d.y)) - (((slope * slope) * d.z) * d.z));
    let half_b = (((p.x * d.x) + (p.y * d.y)) - ((radius * slope) * d.z));
    let c = (((p.x * p.x) + (p.y * p.y)) - (radius * radius));
    let discriminant = ((half_b * half_b) - (a * c));
    if (discriminant >= 0.0) {
        let root = sqrt(discriminant);
        let q = -(half_b + select(-root, root, (half_b >= 0.0)));
        let t0 = (t_mid + (c / away_from_zero(q)));
        let t1 = (t_mid + (q / away_from_zero(a)));
        let near = min(t0, t1);
        let far = max(t0, t1);
        if ((on_lateral_surface(shape, ray, near) && (near > t_min)) && (near < best.t)) {
            best.t = near;
        } else {
            if ((on_lateral_surface(shape, ray, far) && (far > t_min)) && (far < best.t)) {
                best.t = far;
            }
        }
    }
    let dz = away_from_zero(d.z);
    if ((shape.kind & FLAG_BASE_OPEN) == 0u) {
        let t = (-ray.origin.z / dz);
        if (((t > t_min) && (t < best.t)) && within_radius(ray, t, shape.base_radius)) {
            best = ShapeHit(t, 1u);
        }
    }
    if ((shape.kind & FLAG_TOP_OPEN) == 0u) {
        let t = ((1.0 - ray.origin.z) / dz);
        if (((t > t_min) && (t < best.t)) && within_radius(ray, t, shape.top_radius)) {
            best = ShapeHit(t, 2u);
        }
    }
    if (best.t >= t_max) {
        return no_hit();
    }
    return best;
}

fn on_lateral_surface(shape: ShapeRecord, ray: Ray, t: f32) -> bool {
    let z = (ray.origin.z + (t * ray.direction.z));
    let radius = (shape.base_radius + ((shape.top_radius - shape.base_radius) * z));
    return (((z >= 0.0) && (z <= 1.0)) && (radius >= 0.0));
}

fn within_radius(ray: Ray, t: f32, radius: f32) -> bool {
    let x = (ray.origin.x + (t * ray.direction.x));
    let y = (ray.origin.y + (t * ray.direction.y));
    return (((x * x) + (y * y)) <= (radius * radius));
}

fn intersect_flat(flags: u32, ray: Ray, t_min: f32, t_max: f32) -> ShapeHit {
    let kind = (flags & SHAPE_MASK);
    if (kind == SHAPE_PLANE) {
        let t = (-ray.origin.z / away_from_zero(ray.direction.z));
        if ((t > t_min) && (t < t_max)) {
            return ShapeHit(t, 0u);
        }
        return no_hit();
    }
    let t = (-ray.origin.y / away_from_zero(ray.direction.y));
    let x = (ray.origin.x + (t * ray.direction.x));
    let z = (ray.origin.z + (t * ray.direction.z));
    var inside = (((abs(x) <= 1.0) && (z >= 0.0)) && (z <= 1.0));
    if (kind == SHAPE_TRIANGLE) {
        let hidden = select(FLAG_BACK_HIDDEN, FLAG_FRONT_HIDDEN, (ray.direction.y < 0.0));
        inside = ((((x >= 0.0) && (z >= 0.0)) && ((x + z) <= 1.0)) && ((flags & hidden) == 0u));
    }
    if ((inside && (t > t_min)) && (t < t_max)) {
        return ShapeHit(t, 0u);
    }
    return no_hit();
}

fn intersect_shape(shape: ShapeRecord, ray_world: Ray, t_min: f32, t_max: f32) -> ShapeHit {
    let ray = transform_ray(shape.object_from_world, ray_world);
    let kind = (shape.kind & SHAPE_MASK);
    if (kind >= SHAPE_PLANE) {
        return intersect_flat(shape.kind, ray, t_min, t_max);
    }
    if (kind == SHAPE_FRUSTUM) {
        return intersect_frustum(shape, ray, t_min, t_max);
    }
    if (kind == SHAPE_SPHERE) {
        return intersect_sphere(ray, t_min, t_max);
    }
    return intersect_box(ray, t_min, t_max);
}

fn snap_to_surface(shape: ShapeRecord, face: u32, p: vec3f) -> vec3f {
    let kind = (shape.kind & SHAPE_MASK);
    if (kind == SHAPE_SPHERE) {
        return normalize(p);
    }
    if (kind == SHAPE_PLANE) {
        return vec3f(p.x, p.y, 0.0);
    }
    if ((kind == SHAPE_PARALLELOGRAM) || (kind == SHAPE_TRIANGLE)) {
        return vec3f(p.x, 0.0, p.z);
    }
    if (kind == SHAPE_BOX) {
        let side = ((f32((face & 1u)) * 2.0) - 1.0);
        if (face < 2u) {
            return vec3f(side, p.y, p.z);
        }
        if (face < 4u) {
            return vec3f(p.x, side, p.z);
        }
        return vec3f(p.x, p.y, side);
    }
    if (face == 1u) {
        return vec3f(p.x, p.y, 0.0);
    }
    if (face == 2u) {
        return vec3f(p.x, p.y, 1.0);
    }
    let z = clamp(p.z, 0.0, 1.0);
    let radius = max(0.0, (shape.base_radius + ((shape.top_radius - shape.base_radius) * z)));
    let scale = (radius / max(sqrt(((p.x * p.x) + (p.y * p.y))), 1.0e-20));
    return vec3f((p.x * scale), (p.y * scale), z);
}

fn object_normal(shape: ShapeRecord, face: u32, p: vec3f) -> vec3f {
    let kind = (shape.kind & SHAPE_MASK);
    if (kind == SHAPE_SPHERE) {
        return p;
    }
    if (kind == SHAPE_PLANE) {
        return vec3f(0.0, 0.0, 1.0);
    }
    if ((kind == SHAPE_PARALLELOGRAM) || (kind == SHAPE_TRIANGLE)) {
        return vec3f(0.0, 1.0, 0.0);
    }
    if (kind == SHAPE_BOX) {
        let side = ((f32((face & 1u)) * 2.0) - 1.0);
        if (face < 2u) {
            return vec3f(side, 0.0, 0.0);
        }
        if (face < 4u) {
            return vec3f(0.0, side, 0.0);
        }
        return vec3f(0.0, 0.0, side);
    }
    if (face == 1u) {
        return vec3f(0.0, 0.0, -1.0);
    }
    if (face == 2u) {
        return vec3f(0.0, 0.0, 1.0);
    }
    let radial = max(sqrt(((p.x * p.x) + (p.y * p.y))), 1.0e-20);
    return vec3f((p.x / radial), (p.y / radial), (shape.base_radius - shape.top_radius));
}

fn turn_fraction(p: vec3f) -> f32 {
    let u = (atan2(p.y, p.x) / TWO_PI);
    return select(u, (u + 1.0), (u < 0.0));
}

fn texture_coordinates(shape: ShapeRecord, v_scale: f32, face: u32, p: vec3f) -> vec2f {
    let kind = (shape.kind & SHAPE_MASK);
    if (kind == SHAPE_PARALLELOGRAM) {
        return vec2f(((0.5 * p.x) + 0.5), (p.z * v_scale));
    }
    if (kind == SHAPE_TRIANGLE) {
        return vec2f(p.x, p.z);
    }
    if (kind == SHAPE_PLANE) {
        return vec2f(p.x, p.y);
    }
    if (kind == SHAPE_SPHERE) {
        return vec2f(turn_fraction(p), (acos(clamp(-p.z, -1.0, 1.0)) * INVERSE_PI));
    }
    if (kind == SHAPE_BOX) {
        return box_cross(face, p);
    }
    if (face == 0u) {
        return vec2f(turn_fraction(p), (p.z * v_scale));
    }
    let radius = max(select(shape.top_radius, shape.base_radius, (face == 1u)), 1.0e-20);
    let x = ((0.5 * p.x) / radius);
    let y = ((0.5 * p.y) / radius);
    return vec2f((x + 0.5), select((0.5 + y), (0.5 - y), (face == 1u)));
}

fn box_cross(face: u32, p: vec3f) -> vec2f {
    var uv = vec2f(((p.x + 3.0) / 8.0), ((p.y + 3.0) / 6.0));
    if (face == 0u) {
        uv = vec2f(((p.z + 1.0) / 8.0), ((p.y + 3.0) / 6.0));
    }
    if (face == 1u) {
        uv = vec2f(((5.0 - p.z) / 8.0), ((p.y + 3.0) / 6.0));
    }
    if (face == 2u) {
        uv = vec2f(((p.x + 3.0) / 8.0), ((p.z + 1.0) / 6.0));
    }
    if (face == 3u) {
        uv = vec2f(((p.x + 3.0) / 8.0), ((5.0 - p.z) / 6.0));
    }
    if (face == 4u) {
        uv = vec2f(((7.0 - p.x) / 8.0), ((p.y + 3.0) / 6.0));
    }
    return clamp(uv, vec2f(0.0, 0.0), vec2f(1.0, 1.0));
}
const ROUNDING: f32 = 4.0e-7;

fn hit_point(shape: ShapeRecord, ray_world: Ray, hit: ShapeHit) -> vec3f {
    let ray = transform_ray(shape.object_from_world, ray_world);
    return snap_to_surface(shape, hit.face, (ray.origin + (ray.direction * hit.t)));
}

fn surface_point(shape: ShapeRecord, surface: SurfaceRecord, ray: Ray, hit: ShapeHit) -> SurfacePoint {
    let p = hit_point(shape, ray, hit);
    let position = transform_point(surface.world_from_object, p);
    let normal = normalize(transform_transposed(shape.object_from_world, object_normal(shape, hit.face, p)));
    let error_world = transform_magnitude(surface.world_from_object, p);
    let error_object = transform_magnitude(shape.object_from_world, position);
    let m = surface.world_from_object;
    let e = vec4f(error_object.x, error_object.y, error_object.z, 0.0);
    let carried = vec3f(dot(abs(m.row0), e), dot(abs(m.row1), e), dot(abs(m.row2), e));
    let error = (ROUNDING * dot(abs(normal), (error_world + carried)));
    return SurfacePoint(position, error, normal, texture_coordinates(shape, surface.v_scale, hit.face, p), normal);
}

fn offset_origin(point: SurfacePoint, direction: vec3f) -> vec3f {
    let side = select(-1.0, 1.0, (dot(direction, point.normal) >= 0.0));
    return (point.position + (point.normal * (side * point.error)));
}

struct SampleKey {
    pixel: u32,
    sample: u32,
    seed: u32
}
const DIMENSION_PIXEL: u32 = 0u;
const DIMENSION_FIRST_SURFACE: u32 = 1u;
const DIMENSIONS_PER_SURFACE: u32 = 2u;
const DIMENSION_OPACITY: u32 = 2147483648u;

fn pcg4d(v: vec4u) -> vec4u {
    var x: u32 = ((v.x * 1664525u) + 1013904223u);
    var y: u32 = ((v.y * 1664525u) + 1013904223u);
    var z: u32 = ((v.z * 1664525u) + 1013904223u);
    var w: u32 = ((v.w * 1664525u) + 1013904223u);
    x += (y * w);
    y += (z * x);
    z += (x * y);
    w += (y * z);
    x = (x ^ (x >> 16u));
    y = (y ^ (y >> 16u));
    z = (z ^ (z >> 16u));
    w = (w ^ (w >> 16u));
    x += (y * w);
    y += (z * x);
    z += (x * y);
    w += (y * z);
    return vec4u(x, y, z, w);
}

fn unit_float(bits: u32) -> f32 {
    return (f32((bits >> 8u)) * 0.000000059604644775390625);
}

fn random4(key: SampleKey, dimension: u32) -> vec4f {
    let bits = pcg4d(vec4u(key.pixel, key.sample, dimension, key.seed));
    return vec4f(unit_float(bits.x), unit_float(bits.y), unit_float(bits.z), unit_float(bits.w));
}

fn pixel_position(key: SampleKey, grid: u32) -> vec2f {
    let jitter = random4(key, DIMENSION_PIXEL);
    let cells = (grid * grid);
    let round = (key.sample / cells);
    let start = pcg4d(vec4u(key.pixel, round, 3735928559u, key.seed)).x;
    let cell = (((key.sample % cells) + (start % cells)) % cells);
    let column = (cell % grid);
    let row = (cell / grid);
    return vec2f(((f32(column) + jitter.x) / f32(grid)), ((f32(row) + jitter.y) / f32(grid)));
}

const LEAST_FACING: f32 = 1.0e-3;

fn facing_normal(point: SurfacePoint, wo: vec3f) -> vec3f {
    let side = select(-1.0, 1.0, (dot(point.normal, wo) >= 0.0));
    let normal = (point.shading_normal * side);
    let cosine = dot(normal, wo);
    if (cosine >= 0.0) {
        return normal;
    }
    return normalize((normal + (wo * (LEAST_FACING - cosine))));
}

fn same_side(point: SurfacePoint, facing: vec3f, wo: vec3f, direction: vec3f) -> bool {
    let of_triangle = (dot(point.normal, direction) * dot(point.normal, wo));
    let of_surface = dot(facing, direction);
    return (((of_triangle >= 0.0) && (of_surface >= 0.0)) || ((of_triangle <= 0.0) && (of_surface <= 0.0)));
}

fn attribute_normal_Buffers(scene: Buffers, shape: ShapeRecord, surface: SurfaceRecord, point: SurfacePoint) -> vec3f {
    let none = vec3f(0.0, 0.0, 0.0);
    if (((shape.kind & SHAPE_MASK) != SHAPE_TRIANGLE) || (surface.attributes == NONE)) {
        return none;
    }
    let last = Buffers_attribute(scene, (surface.attributes + 3u));
    if (last.w == 0.0) {
        return none;
    }
    let a = Buffers_attribute(scene, surface.attributes);
    let b = Buffers_attribute(scene, (surface.attributes + 1u));
    let c = Buffers_attribute(scene, (surface.attributes + 2u));
    let sum = (((vec3f(a.x, a.y, a.z) * ((1.0 - point.uv.x) - point.uv.y)) + (vec3f(b.x, b.y, b.z) * point.uv.x)) + (vec3f(c.x, c.y, c.z) * point.uv.y));
    return select(none, sum, (dot(sum, sum) >= 1.0e-12));
}

fn attribute_uv_Buffers(scene: Buffers, shape: ShapeRecord, surface: SurfaceRecord, uv: vec2f) -> vec2f {
    if ((shape.kind & SHAPE_MASK) != SHAPE_TRIANGLE) {
        return uv;
    }
    if (surface.attributes == NONE) {
        return vec2f(0.0, 0.0);
    }
    let a = Buffers_attribute(scene, surface.attributes);
    let b = Buffers_attribute(scene, (surface.attributes + 1u));
    let c = Buffers_attribute(scene, (surface.attributes + 2u));
    let v = Buffers_attribute(scene, (surface.attributes + 3u));
    let rest = ((1.0 - uv.x) - uv.y);
    return vec2f((((a.w * rest) + (b.w * uv.x)) + (c.w * uv.y)), (((v.x * rest) + (v.y * uv.x)) + (v.z * uv.y)));
}

fn with_attributes_Buffers(
    scene: Buffers,
    shape: ShapeRecord,
    surface: SurfaceRecord,
    point: SurfacePoint,
    smooth_normal: vec3f,
) -> SurfacePoint {
    var result = point;
    let squared = dot(smooth_normal, smooth_normal);
    if (squared > 0.0) {
        let side = select(-1.0, 1.0, (dot(smooth_normal, point.normal) >= 0.0));
        result.shading_normal = (smooth_normal * (side / sqrt(squared)));
    }
    result.uv = attribute_uv_Buffers(scene, shape, surface, point.uv);
    return result;
}

fn unpack_texel(texel: u32) -> vec4f {
    return (vec4f(f32((texel & 255u)), f32(((texel >> 8u) & 255u)), f32(((texel >> 16u) & 255u)), f32((texel >> 24u))) * (1.0 / 255.0));
}

fn in_odd_field(uv: vec2f) -> bool {
    let fields = (floor((2.0 * uv.x)) + floor((2.0 * uv.y)));
    return ((fields - (2.0 * floor((0.5 * fields)))) >= 0.5);
}

fn channel_value_Buffers(scene: Buffers, index: u32, uv: vec2f, missing: vec4f) -> vec4f {
    if (index == NONE) {
        return missing;
    }
    let channel = Buffers_channel(scene, index);
    if (channel.operation == CHANNEL_IMAGE) {
        return image_color_Buffers(scene, channel, uv);
    }
    if (channel.operation == CHANNEL_CONSTANT) {
        return channel.value;
    }
    return run_channel_Buffers(scene, index, uv);
}

fn fetch_texel_Buffers(scene: Buffers, channel: ChannelRecord, column: u32, row: u32) -> vec4f {
    let width = (channel.size & 65535u);
    let height = (channel.size >> 16u);
    let x = (column % width);
    let y = ((height - 1u) - (row % height));
    return unpack_texel(Buffers_texel(scene, ((channel.first + (y * width)) + x)));
}

fn image_color_Buffers(scene: Buffers, channel: ChannelRecord, uv: vec2f) -> vec4f {
    let width = f32((channel.size & 65535u));
    let height = f32((channel.size >> 16u));
    let x = ((uv.x - floor(uv.x)) * width);
    let y = ((uv.y - floor(uv.y)) * height);
    let column = u32(x);
    let row = u32(y);
    let corner = fetch_texel_Buffers(scene, channel, column, row);
    if (channel.bilinear == 0u) {
        return corner;
    }
    let wx = (x - floor(x));
    let wy = (y - floor(y));
    let right = fetch_texel_Buffers(scene, channel, (column + 1u), row);
    let above = fetch_texel_Buffers(scene, channel, column, (row + 1u));
    let above_right = fetch_texel_Buffers(scene, channel, (column + 1u), (row + 1u));
    let lower = ((corner * (1.0 - wx)) + (right * wx));
    let upper = ((above * (1.0 - wx)) + (above_right * wx));
    return ((lower * (1.0 - wy)) + (upper * wy));
}

fn run_channel_Buffers(scene: Buffers, start: u32, surface_uv: vec2f) -> vec4f {
    var uv = surface_uv;
    var index = start;
    var channel = Buffers_channel(scene, index);
    while (channel.operation > CHANNEL_IMAGE) {
        if (channel.operation == CHANNEL_CHECKER) {
            index = select(channel.size, channel.first, in_odd_field(uv));
            uv = surface_uv;
        } else {
            let v = channel.value;
            if (channel.operation == CHANNEL_MOVE_UV) {
                uv = vec2f((uv.x + v.x), (uv.y + v.y));
            } else {
                uv = vec2f(((v.x * uv.x) + (v.y * uv.y)), ((v.z * uv.x) + (v.w * uv.y)));
            }
            index += 1u;
        }
        channel = Buffers_channel(scene, index);
    }
    if (channel.operation == CHANNEL_IMAGE) {
        return image_color_Buffers(scene, channel, uv);
    }
    return channel.value;
}

struct Bsdf {
    diffuse: vec3f,
    diffuse_transmission: vec3f,
    glossy: vec3f,
    exponent: f32,
    glossy_transmission: vec3f,
    transmission_exponent: f32,
    straight: vec3f,
    emissive: vec3f
}

struct BsdfSample {
    direction: vec3f,
    weight: vec3f,
    pdf: f32,
    event: u32
}
const EVENT_ABSORBED: u32 = 0u;
const EVENT_SCATTERED: u32 = 1u;
const EVENT_MIRRORED: u32 = 2u;
const EVENT_PASSED: u32 = 3u;
const MIRROR_EXPONENT: f32 = 100000.0;

fn shininess_exponent(shininess: f32) -> f32 {
    let y = (shininess * (2.0 - shininess));
    if (y <= 0.0) {
        return 0.0;
    }
    if (y >= 0.99999) {
        return MIRROR_EXPONENT;
    }
    return min((-2.0 / log(y)), MIRROR_EXPONENT);
}

fn undisturbed_part(material: MaterialRecord, tau: vec3f, alpha: f32) -> vec3f {
    if (material.transparency_shininess != NONE) {
        let clear = clamp((1.0 - (alpha * material.opacity)), 0.0, 1.0);
        return vec3f(clear, clear, clear);
    }
    return clamp(tau, vec3f(0.0, 0.0, 0.0), vec3f(1.0, 1.0, 1.0));
}

fn glossy_norm(exponent: f32) -> f32 {
    let excess = (1.0 + (0.08 * max(0.0, (1.0 - exponent))));
    return ((exponent + 2.0) / (TWO_PI * excess));
}

fn glossy_value(along: f32, exponent: f32, cos_in: f32, cos_out: f32) -> f32 {
    if (along <= 0.0) {
        return 0.0;
    }
    return ((glossy_norm(exponent) * pow(along, exponent)) * (cos_in / max(cos_in, cos_out)));
}

fn evaluate_bsdf(bsdf: Bsdf, normal: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let cos_o = dot(normal, wo);
    let cos_i = dot(normal, wi);
    if (cos_i > 0.0) {
        var value = (bsdf.diffuse * (cos_i * INVERSE_PI));
        if (bsdf.exponent < MIRROR_EXPONENT) {
            let along = dot(reflect(-wo, normal), wi);
            value += (bsdf.glossy * glossy_value(along, bsdf.exponent, cos_i, cos_o));
        }
        return value;
    }
    var value = (bsdf.diffuse_transmission * (-cos_i * INVERSE_PI));
    if (bsdf.transmission_exponent < MIRROR_EXPONENT) {
        let along = dot(-wo, wi);
        value += (bsdf.glossy_transmission * glossy_value(along, bsdf.transmission_exponent, -cos_i, cos_o));
    }
    return value;
}

fn lobe_probabilities(bsdf: Bsdf) -> vec4f {
    let lobes = vec4f(luminance(bsdf.diffuse), luminance(bsdf.glossy), luminance(bsdf.diffuse_transmission), luminance(bsdf.glossy_transmission));
    let sum = ((((lobes.x + lobes.y) + lobes.z) + lobes.w) + luminance(bsdf.straight));
    return (lobes * (1.0 / max(sum, 1.0e-20)));
}

fn bsdf_pdf(bsdf: Bsdf, normal: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let chance = lobe_probabilities(bsdf);
    let cos_i = dot(normal, wi);
    if (cos_i > 0.0) {
        var pdf = (chance.x * cosine_hemisphere_pdf(cos_i));
        if (bsdf.exponent < MIRROR_EXPONENT) {
            pdf += (chance.y * power_cosine_pdf(dot(reflect(-wo, normal), wi), bsdf.exponent));
        }
        return pdf;
    }
    var pdf = (chance.z * cosine_hemisphere_pdf(-cos_i));
    if (bsdf.transmission_exponent < MIRROR_EXPONENT) {
        pdf += (chance.w * power_cosine_pdf(dot(-wo, wi), bsdf.transmission_exponent));
    }
    return pdf;
}

fn sample_bsdf(bsdf: Bsdf, normal: vec3f, wo: vec3f, u: vec3f) -> BsdfSample {
    let chance = lobe_probabilities(bsdf);
    var sample = BsdfSample(normal, vec3f(0.0, 0.0, 0.0), 0.0, EVENT_ABSORBED);
    let up_to_glossy = (chance.x + chance.y);
    let up_to_diffuse_transmission = (up_to_glossy + chance.z);
    let up_to_glossy_transmission = (up_to_diffuse_transmission + chance.w);
    if (u.x < chance.x) {
        sample.direction = around_axis(normal, cosine_hemisphere(vec2f(u.y, u.z)));
    } else if (u.x < up_to_glossy) {
        let mirrored = reflect(-wo, normal);
        if (bsdf.exponent >= MIRROR_EXPONENT) {
            sample.direction = mirrored;
            sample.weight = (bsdf.glossy * (1.0 / chance.y));
            sample.event = EVENT_MIRRORED;
            return sample;
        }
        sample.direction = around_axis(mirrored, power_cosine(vec2f(u.y, u.z), bsdf.exponent));
        if (dot(sample.direction, normal) <= 0.0) {
            return sample;
        }
    } else if (u.x < up_to_diffuse_transmission) {
        sample.direction = around_axis(-normal, cosine_hemisphere(vec2f(u.y, u.z)));
    } else if (u.x < up_to_glossy_transmission) {
        if (bsdf.transmission_exponent >= MIRROR_EXPONENT) {
            sample.direction = -wo;
            sample.weight = (bsdf.glossy_transmission * (1.0 / chance.w));
            sample.event = EVENT_MIRRORED;
            return sample;
        }
        sample.direction = around_axis(-wo, power_cosine(vec2f(u.y, u.z), bsdf.transmission_exponent));
        if (dot(sample.direction, normal) >= 0.0) {
            return sample;
        }
    } else {
        let rest = (1.0 - up_to_glossy_transmission);
        if (rest > 1.0e-6) {
            sample.direction = -wo;
            sample.weight = (bsdf.straight * (1.0 / rest));
            sample.event = EVENT_PASSED;
        }
        return sample;
    }
    sample.pdf = bsdf_pdf(bsdf, normal, wo, sample.direction);
    if (sample.pdf > 0.0) {
        sample.weight = (evaluate_bsdf(bsdf, normal, wo, sample.direction) * (1.0 / sample.pdf));
        sample.event = EVENT_SCATTERED;
    }
    return sample;
}

fn clear_transmission_Buffers(scene: Buffers, material: MaterialRecord, uv: vec2f, alpha: f32) -> vec3f {
    let zero = vec4f(0.0, 0.0, 0.0, 1.0);
    let channel = channel_value_Buffers(scene, material.transparency, uv, zero);
    let cover = (alpha * material.opacity);
    let tau = vec3f(channel.x, channel.y, channel.z);
    return (vec3f((1.0 - cover), (1.0 - cover), (1.0 - cover)) + (tau * cover));
}

fn material_bsdf_Buffers(scene: Buffers, material: MaterialRecord, uv: vec2f) -> Bsdf {
    let black = vec4f(0.0, 0.0, 0.0, 1.0);
    let c_d = channel_value_Buffers(scene, material.diffuse, uv, vec4f(0.5, 0.5, 0.5, 1.0));
    let c_s = channel_value_Buffers(scene, material.specular, uv, black);
    let c_dt = channel_value_Buffers(scene, material.diffuse_transparency, uv, black);
    let emissive = channel_value_Buffers(scene, material.emissive, uv, black);
    let tau = clear_transmission_Buffers(scene, material, uv, c_d.w);
    let one = vec3f(1.0, 1.0, 1.0);
    let zero = vec3f(0.0, 0.0, 0.0);
    var diffuse = max(vec3f(c_d.x, c_d.y, c_d.z), zero);
    var glossy = max(vec3f(c_s.x, c_s.y, c_s.z), zero);
    let diffuse_transmission = max(vec3f(c_dt.x, c_dt.y, c_dt.z), zero);
    if (material.interpolated_transparency != 0u) {
        diffuse *= (one - tau);
        glossy *= (one - tau);
    }
    let opacity = max((1.0 - smallest(undisturbed_part(material, tau, c_d.w))), 1.0e-6);
    var straight = zero;
    var blurred = zero;
    if (material.transparency_shininess == NONE) {
        let passed = smallest(tau);
        straight = max((tau - vec3f(passed, passed, passed)), zero);
    } else {
        let cut = (1.0 - clamp((c_d.w * material.opacity), 0.0, 1.0));
        blurred = max((tau - vec3f(cut, cut, cut)), zero);
    }
    if (material.interpolated_transparency != 0u) {
        diffuse *= (1.0 / opacity);
        glossy *= (1.0 / opacity);
    }
    straight *= (1.0 / opacity);
    blurred *= (1.0 / opacity);
    let total = largest(((((diffuse + glossy) + diffuse_transmission) + straight) + blurred));
    let scale = (1.0 / max(total, 1.0));
    let shininess = channel_value_Buffers(scene, material.shininess, uv, black);
    let transmission_shininess = channel_value_Buffers(scene, material.transparency_shininess, uv, black);
    return Bsdf((diffuse * scale), (diffuse_transmission * scale), (glossy * scale), select(shininess_exponent(shininess.x), 4.0, (material.shininess == NONE)), (blurred * scale), shininess_exponent(transmission_shininess.x), (straight * scale), vec3f(emissive.x, emissive.y, emissive.z));
}

fn surface_opacity_Buffers(scene: Buffers, material: MaterialRecord, uv: vec2f) -> f32 {
    return (1.0 - smallest(surface_transmittance_Buffers(scene, material, uv)));
}

fn surface_transmittance_Buffers(scene: Buffers, material: MaterialRecord, uv: vec2f) -> vec3f {
    let grey = vec4f(0.5, 0.5, 0.5, 1.0);
    let diffuse = channel_value_Buffers(scene, material.diffuse, uv, grey);
    let tau = clear_transmission_Buffers(scene, material, uv, diffuse.w);
    return undisturbed_part(material, tau, diffuse.w);
}

struct Hit {
    shape: ShapeHit,
    object: u32,
    instance: u32
}
const MAX_BVH_DEPTH: u32 = 48u;
const MAX_HITS_PER_OBJECT: u32 = 4u;

fn inverse_direction(d: vec3f) -> vec3f {
    return vec3f((1.0 / away_from_zero(d.x)), (1.0 / away_from_zero(d.y)), (1.0 / away_from_zero(d.z)));
}

fn box_entry(
    origin: vec3f,
    inverse: vec3f,
    low: vec3f,
    high: vec3f,
    t_max: f32,
) -> f32 {
    let a = ((low - origin) * inverse);
    let b = ((high - origin) * inverse);
    let near = min(a, b);
    let far = max(a, b);
    let t_in = max(max(near.x, near.y), max(near.z, 0.0));
    let t_out = min(min(far.x, far.y), min(far.z, t_max));
    return select(NO_HIT, t_in, (t_in <= (t_out * 1.0000004)));
}

fn is_dark(color: vec3f) -> bool {
    return (((color.x <= 0.0) && (color.y <= 0.0)) && (color.z <= 0.0));
}

fn closer_hit_Buffers(
    scene: Buffers,
    instance: u32,
    index: u32,
    ray: Ray,
    key: SampleKey,
    segment: u32,
    best: Hit,
) -> Hit {
    let shape = Buffers_shape(scene, index);
    var t_min: f32 = 0.0;
    for (var attempt = 0u; attempt < MAX_HITS_PER_OBJECT; attempt++) {
        let hit = intersect_shape(shape, ray, t_min, best.shape.t);
        if (hit.t >= NO_HIT) {
            return best;
        }
        if ((shape.kind & FLAG_NOT_OPAQUE) == 0u) {
            return Hit(hit, index, instance);
        }
        let uv = hit_uv_Buffers(scene, index, shape, ray, hit);
        let opacity = surface_opacity_Buffers(scene, Buffers_material(scene, shape.material), uv);
        if (opacity >= 1.0) {
            return Hit(hit, index, instance);
        }
        if (opacity > 0.0) {
            let triangle = u32(shape.top_radius);
            let bits = pcg4d(vec4u(key.pixel, key.sample, (DIMENSION_OPACITY + Buffers_surface(scene, index).source), (((key.seed ^ (((segment * MAX_HITS_PER_OBJECT) + attempt) * 2654435769u)) ^ (triangle * 2246822519u)) ^ ((instance + 1u) * 3266489917u))));
            if (unit_float(bits.x) < opacity) {
                return Hit(hit, index, instance);
            }
        }
        t_min = hit.t;
    }
    return best;
}

fn closest_hit_Buffers(scene: Buffers, ray: Ray, key: SampleKey, segment: u32) -> Hit {
    let header = Buffers_header(scene);
    var best = Hit(no_hit(), NONE, NONE);
    for (var i = 0u; i < header.unbounded_objects; i++) {
        best = closer_hit_Buffers(scene, NONE, i, ray, key, segment, best);
    }
    if (header.nodes == 0u) {
        return best;
    }
    var instance = NONE;
    var local = ray;
    var inverse = inverse_direction(ray.direction);
    var waiting: u32 = 0u;
    var stack: array<u32, 96> = array<u32, 96>();
    var stacked: u32 = 0u;
    var current: u32 = 0u;
    var searching = true;
    while searching {
        if ((current & INSTANCE_BIT) != 0u) {
            instance = (current ^ INSTANCE_BIT);
            let placement = Buffers_shape(scene, instance);
            local = transform_ray(placement.object_from_world, ray);
            inverse = inverse_direction(local.direction);
            waiting = stacked;
            current = placement.material;
        }
        let node = Buffers_node(scene, current);
        let t0 = box_entry(local.origin, inverse, node.min0, node.max0, best.shape.t);
        let t1 = box_entry(local.origin, inverse, node.min1, node.max1, best.shape.t);
        var descend0 = (t0 < NO_HIT);
        var descend1 = (t1 < NO_HIT);
        if (descend0 && (node.count0 > 0u)) {
            for (var i = 0u; i < node.count0; i++) {
                best = closer_hit_Buffers(scene, instance, (node.child0 + i), local, key, segment, best);
            }
            descend0 = false;
        }
        if (descend1 && (node.count1 > 0u)) {
            if (t1 < best.shape.t) {
                for (var i = 0u; i < node.count1; i++) {
                    best = closer_hit_Buffers(scene, instance, (node.child1 + i), local, key, segment, best);
                }
            }
            descend1 = false;
        }
        if (descend0 && descend1) {
            let first = (t0 <= t1);
            stack[u32(stacked)] = select(node.child0, node.child1, first);
            stacked += 1u;
            current = select(node.child1, node.child0, first);
        } else if descend0 {
            current = node.child0;
        } else if descend1 {
            current = node.child1;
        } else {
            if ((instance != NONE) && (stacked == waiting)) {
                instance = NONE;
                local = ray;
                inverse = inverse_direction(ray.direction);
            }
            if (stacked > 0u) {
                stacked -= 1u;
                current = stack[u32(stacked)];
            } else {
                searching = false;
            }
        }
    }
    return best;
}

fn hit_uv_Buffers(
    scene: Buffers,
    index: u32,
    shape: ShapeRecord,
    ray: Ray,
    hit: ShapeHit,
) -> vec2f {
    let p = hit_point(shape, ray, hit);
    let surface = Buffers_surface(scene, index);
    let uv = texture_coordinates(shape, surface.v_scale, hit.face, p);
    return attribute_uv_Buffers(scene, shape, surface, uv);
}

fn object_transmittance_Buffers(scene: Buffers, index: u32, ray: Ray, t_max: f32) -> vec3f {
    let shape = Buffers_shape(scene, index);
    var passed = vec3f(1.0, 1.0, 1.0);
    var t_min: f32 = 0.0;
    for (var _attempt = 0u; _attempt < MAX_HITS_PER_OBJECT; _attempt++) {
        let hit = intersect_shape(shape, ray, t_min, t_max);
        if (hit.t >= NO_HIT) {
            return passed;
        }
        if ((shape.kind & FLAG_NOT_OPAQUE) == 0u) {
            return vec3f(0.0, 0.0, 0.0);
        }
        let uv = hit_uv_Buffers(scene, index, shape, ray, hit);
        passed *= surface_transmittance_Buffers(scene, Buffers_material(scene, shape.material), uv);
        t_min = hit.t;
    }
    return passed;
}

fn transmittance_Buffers(scene: Buffers, ray: Ray, t_max: f32) -> vec3f {
    let header = Buffers_header(scene);
    var passed = vec3f(1.0, 1.0, 1.0);
    for (var i = 0u; i < header.unbounded_objects; i++) {
        passed *= object_transmittance_Buffers(scene, i, ray, t_max);
    }
    if ((header.nodes == 0u) || is_dark(passed)) {
        return passed;
    }
    var instance = NONE;
    var local = ray;
    var inverse = inverse_direction(ray.direction);
    var waiting: u32 = 0u;
    var stack: array<u32, 96> = array<u32, 96>();
    var stacked: u32 = 0u;
    var current: u32 = 0u;
    var searching = true;
    while searching {
        if ((current & INSTANCE_BIT) != 0u) {
            instance = (current ^ INSTANCE_BIT);
            let placement = Buffers_shape(scene, instance);
            local = transform_ray(placement.object_from_world, ray);
            inverse = inverse_direction(local.direction);
            waiting = stacked;
            current = placement.material;
        }
        let node = Buffers_node(scene, current);
        var descend0 = (box_entry(local.origin, inverse, node.min0, node.max0, t_max) < NO_HIT);
        var descend1 = (box_entry(local.origin, inverse, node.min1, node.max1, t_max) < NO_HIT);
        if (descend0 && (node.count0 > 0u)) {
            for (var i = 0u; i < node.count0; i++) {
                passed *= object_transmittance_Buffers(scene, (node.child0 + i), local, t_max);
            }
            descend0 = false;
        }
        if (descend1 && (node.count1 > 0u)) {
            for (var i = 0u; i < node.count1; i++) {
                passed *= object_transmittance_Buffers(scene, (node.child1 + i), local, t_max);
            }
            descend1 = false;
        }
        if is_dark(passed) {
            return passed;
        }
        if (descend0 && descend1) {
            stack[u32(stacked)] = node.child1;
            stacked += 1u;
            current = node.child0;
        } else if descend0 {
            current = node.child0;
        } else if descend1 {
            current = node.child1;
        } else {
            if ((instance != NONE) && (stacked == waiting)) {
                instance = NONE;
                local = ray;
                inverse = inverse_direction(ray.direction);
            }
            if (stacked > 0u) {
                stacked -= 1u;
                current = stack[u32(stacked)];
            } else {
                searching = false;
            }
        }
    }
    return passed;
}

struct LightSample {
    direction: vec3f,
    distance: f32,
    weight: vec3f,
    pdf: f32
}

struct LightChoice {
    index: u32,
    probability: f32
}

fn spot_profile(cos_angle: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    if (cos_angle >= cos_inner) {
        return 1.0;
    }
    if (cos_angle <= cos_outer) {
        return 0.0;
    }
    let t = ((cos_angle - cos_outer) / (cos_inner - cos_outer));
    return ((t * t) * (3.0 - (2.0 * t)));
}

fn area_radiance(light: LightRecord, cos_angle: f32) -> vec3f {
    if (cos_angle <= 0.0) {
        return vec3f(0.0, 0.0, 0.0);
    }
    if (light.cos_inner == 0.0) {
        return light.emission;
    }
    return (light.emission * pow(cos_angle, light.cos_inner));
}

fn light_importance(light: LightRecord, point: vec3f) -> f32 {
    if ((light.kind == LIGHT_DIRECTIONAL) || (light.kind == LIGHT_SKY)) {
        return light.importance;
    }
    if (light.kind == LIGHT_AREA) {
        let from_light = (point - (light.position + (light.edge_v * 0.5)));
        if (dot(from_light, light.axis) <= 0.0) {
            return 0.0;
        }
        return (light.importance / (dot(from_light, from_light) + light.cos_outer));
    }
    let from_light = (point - light.position);
    let squared = max(dot(from_light, from_light), 1.0e-20);
    if ((light.kind == LIGHT_SPOT) && (dot(from_light, light.axis) <= (light.cos_outer * sqrt(squared)))) {
        return 0.0;
    }
    return (light.importance / squared);
}

fn sky_pdf(normal: vec3f, direction: vec3f, both_sides: bool) -> f32 {
    let cosine = dot(normal, direction);
    if both_sides {
        return ((0.5 * abs(cosine)) * INVERSE_PI);
    }
    return cosine_hemisphere_pdf(cosine);
}

fn area_pdf(light: LightRecord, squared_distance: f32, cos_light: f32) -> f32 {
    return (squared_distance / max((abs(cos_light) * light.cos_outer), 1.0e-20));
}

fn no_light() -> LightSample {
    return LightSample(vec3f(0.0, 0.0, 1.0), 0.0, vec3f(0.0, 0.0, 0.0), 0.0);
}

fn sample_light(
    light: LightRecord,
    point: vec3f,
    normal: vec3f,
    both_sides: bool,
    u: vec2f,
) -> LightSample {
    if (light.kind == LIGHT_SKY) {
        var side = 1.0;
        var first = u.x;
        if both_sides {
            if (first < 0.5) {
                first *= 2.0;
            } else {
                first = min(((first * 2.0) - 1.0), 0.99999994);
                side = -1.0;
            }
        }
        let direction = around_axis((normal * side), cosine_hemisphere(vec2f(first, u.y)));
        let pdf = sky_pdf(normal, direction, both_sides);
        if (pdf <= 0.0) {
            return no_light();
        }
        return LightSample(direction, NO_HIT, (light.emission * (1.0 / pdf)), pdf);
    }
    if (light.kind == LIGHT_DIRECTIONAL) {
        return LightSample(-light.axis, NO_HIT, light.emission, 0.0);
    }
    var aim = light.position;
    if (light.kind == LIGHT_AREA) {
        aim = ((light.position + (light.edge_u * ((2.0 * u.x) - 1.0))) + (light.edge_v * u.y));
    }
    let to_light = (aim - point);
    let squared = dot(to_light, to_light);
    if (squared < 1.0e-20) {
        return no_light();
    }
    let distance = sqrt(squared);
    let direction = (to_light * (1.0 / distance));
    let cos_light = -dot(direction, light.axis);
    if (light.kind == LIGHT_AREA) {
        if (cos_light <= 0.0) {
            return no_light();
        }
        let pdf = area_pdf(light, squared, cos_light);
        return LightSample(direction, distance, (area_radiance(light, cos_light) * (1.0 / pdf)), pdf);
    }
    var intensity = light.emission;
    if (light.kind == LIGHT_SPOT) {
        intensity *= spot_profile(cos_light, light.cos_inner, light.cos_outer);
    }
    return LightSample(direction, distance, (intensity * (1.0 / squared)), 0.0);
}

fn choose_light_Buffers(scene: Buffers, point: vec3f, total: f32, u: f32) -> LightChoice {
    let lights = Buffers_header(scene).lights;
    var rest = (u * total);
    var choice = LightChoice(NONE, 0.0);
    for (var i = 0u; i < lights; i++) {
        let importance = light_importance(Buffers_light(scene, i), point);
        if ((rest >= 0.0) && (importance > 0.0)) {
            choice = LightChoice(i, (importance / total));
        }
        rest -= importance;
    }
    return choice;
}

fn total_importance_Buffers(scene: Buffers, point: vec3f) -> f32 {
    let lights = Buffers_header(scene).lights;
    var total: f32 = 0.0;
    for (var i = 0u; i < lights; i++) {
        total += light_importance(Buffers_light(scene, i), point);
    }
    return total;
}

fn placement_error(group_from_world: Affine, world_from_group: Affine, point: SurfacePoint) -> f32 {
    let error_group = transform_magnitude(group_from_world, point.position);
    let error_world = transform_magnitude(world_from_group, transform_point(group_from_world, point.position));
    let e = vec4f(error_group.x, error_group.y, error_group.z, 0.0);
    let m = world_from_group;
    let carried = vec3f(dot(abs(m.row0), e), dot(abs(m.row1), e), dot(abs(m.row2), e));
    return (ROUNDING * dot(abs(point.normal), (error_world + carried)));
}

fn hit_surface_Buffers(scene: Buffers, ray: Ray, hit: Hit) -> SurfacePoint {
    var shape = Buffers_shape(scene, hit.object);
    var surface = Buffers_surface(scene, hit.object);
    if (hit.instance == NONE) {
        let flat_point = surface_point(shape, surface, ray, hit.shape);
        let normal = attribute_normal_Buffers(scene, shape, surface, flat_point);
        return with_attributes_Buffers(scene, shape, surface, flat_point, normal);
    }
    let group_from_world = Buffers_shape(scene, hit.instance).object_from_world;
    let world_from_group = Buffers_surface(scene, hit.instance).world_from_object;
    shape.object_from_world = compose(shape.object_from_world, group_from_world);
    surface.world_from_object = compose(world_from_group, surface.world_from_object);
    var flat_point = surface_point(shape, surface, ray, hit.shape);
    flat_point.error = ((2.0 * flat_point.error) + placement_error(group_from_world, world_from_group, flat_point));
    let normal = transform_transposed(group_from_world, attribute_normal_Buffers(scene, shape, surface, flat_point));
    return with_attributes_Buffers(scene, shape, surface, flat_point, normal);
}

fn camera_ray(header: SceneHeader, settings: LaunchSettings, x: f32, y: f32) -> Ray {
    let width = f32(settings.width);
    let image_x = ((((2.0 * x) - width) / width) * header.view_scale_x);
    let image_y = (((f32(settings.height) - (2.0 * y)) / width) * header.view_scale_y);
    if (header.camera == CAMERA_PARALLEL) {
        let start = vec3f(image_x, image_y, header.start_distance);
        return Ray(transform_point(header.world_from_view, start), normalize(transform_vector(header.world_from_view, vec3f(0.0, 0.0, -1.0))));
    }
    let direction = vec3f(image_x, image_y, -1.0);
    return Ray(transform_point(header.world_from_view, vec3f(0.0, 0.0, 0.0)), normalize(transform_vector(header.world_from_view, direction)));
}

struct PathSample {
    radiance: vec3f,
    rays: u32
}

struct PathVertex {
    position: vec3f,
    pdf: f32,
    sky_pdf: f32,
    importance: f32
}
const ROULETTE_START: u32 = 3u;
const MAX_SEGMENTS: u32 = 512u;
const SHADOW_END: f32 = 0.9999;

fn found_light_weight(previous: PathVertex, light_pdf: f32) -> f32 {
    if (previous.pdf <= 0.0) {
        return 1.0;
    }
    return power_heuristic(previous.pdf, light_pdf);
}

fn transmits(bsdf: Bsdf) -> bool {
    return (largest((bsdf.diffuse_transmission + bsdf.glossy_transmission)) > 0.0);
}

fn direct_light_Buffers(
    scene: Buffers,
    point: SurfacePoint,
    bsdf: Bsdf,
    normal: vec3f,
    wo: vec3f,
    importance: f32,
    u: vec3f,
) -> PathSample {
    var result = PathSample(vec3f(0.0, 0.0, 0.0), 0u);
    let choice = choose_light_Buffers(scene, point.position, importance, u.x);
    if (choice.index == NONE) {
        return result;
    }
    let light = Buffers_light(scene, choice.index);
    let both_sides = transmits(bsdf);
    let sample = sample_light(light, point.position, normal, both_sides, vec2f(u.y, u.z));
    let value = (evaluate_bsdf(bsdf, normal, wo, sample.direction) * sample.weight);
    if (is_dark(value) || !same_side(point, normal, wo, sample.direction)) {
        return result;
    }
    var weight = (1.0 / choice.probability);
    if ((sample.pdf > 0.0) && (light.shadowless == 0u)) {
        let scattered = bsdf_pdf(bsdf, normal, wo, sample.direction);
        weight *= power_heuristic((sample.pdf * choice.probability), scattered);
    }
    result.radiance = (value * weight);
    if (light.shadowless == 0u) {
        let ray = Ray(offset_origin(point, sample.direction), sample.direction);
        var t_max = NO_HIT;
        if (sample.distance < NO_HIT) {
            t_max = (sample.distance * SHADOW_END);
        }
        result.radiance *= transmittance_Buffers(scene, ray, t_max);
        result.rays = 1u;
    }
    return result;
}

fn escaped_radiance_Buffers(scene: Buffers, previous: PathVertex) -> vec3f {
    let header = Buffers_header(scene);
    if (header.sky == NONE) {
        return vec3f(0.0, 0.0, 0.0);
    }
    let sky = Buffers_light(scene, header.sky);
    let choice = (sky.importance / max(previous.importance, 1.0e-20));
    return (sky.emission * found_light_weight(previous, (previous.sky_pdf * choice)));
}

fn lamp_radiance_Buffers(
    scene: Buffers,
    index: u32,
    previous: PathVertex,
    position: vec3f,
    cos_light: f32,
) -> vec3f {
    let light = Buffers_light(scene, index);
    let radiance = area_radiance(light, cos_light);
    if (previous.pdf <= 0.0) {
        return radiance;
    }
    if (light.shadowless != 0u) {
        return vec3f(0.0, 0.0, 0.0);
    }
    let way = (position - previous.position);
    let choice = (light_importance(light, previous.position) / max(previous.importance, 1.0e-20));
    return (radiance * found_light_weight(previous, (area_pdf(light, dot(way, way), cos_light) * choice)));
}

fn render_pixel_Buffers(
    scene: Buffers,
    settings: LaunchSettings,
    x: u32,
    y: u32,
    before: FilmPixel,
) -> FilmPixel {
    let header = Buffers_header(scene);
    var film = before;
    for (var i = 0u; i < settings.samples; i++) {
        let key = SampleKey(((y * settings.width) + x), (settings.first_sample + i), settings.seed);
        let position = pixel_position(key, settings.grid);
        let ray = camera_ray(header, settings, (f32(x) + position.x), (f32(y) + position.y));
        let path = trace_path_Buffers(scene, key, ray, settings.depth);
        film.radiance += path.radiance;
        film.squares += (path.radiance * path.radiance);
        film.rays += path.rays;
        film.samples += 1u;
    }
    return film;
}

fn trace_path_Buffers(scene: Buffers, key: SampleKey, first: Ray, depth: u32) -> PathSample {
    var result = PathSample(vec3f(0.0, 0.0, 0.0), 0u);
    var throughput = vec3f(1.0, 1.0, 1.0);
    var ray = first;
    var touched: u32 = 0u;
    var previous = PathVertex(first.origin, 0.0, 0.0, 0.0);
    for (var segment = 0u; segment < MAX_SEGMENTS; segment++) {
        let hit = closest_hit_Buffers(scene, ray, key, segment);
        result.rays += 1u;
        if (hit.object == NONE) {
            result.radiance += (throughput * escaped_radiance_Buffers(scene, previous));
            return result;
        }
        let shape = Buffers_shape(scene, hit.object);
        let surface = Buffers_surface(scene, hit.object);
        let point = hit_surface_Buffers(scene, ray, hit);
        let wo = -ray.direction;
        let cos_front = dot(point.normal, wo);
        let normal = facing_normal(point, wo);
        if (surface.light != NONE) {
            result.radiance += (throughput * lamp_radiance_Buffers(scene, surface.light, previous, point.position, cos_front));
        }
        let bsdf = material_bsdf_Buffers(scene, Buffers_material(scene, shape.material), point.uv);
        result.radiance += (throughput * bsdf.emissive);
        if (touched >= depth) {
            throughput *= bsdf.straight;
            if is_dark(throughput) {
                return result;
            }
            ray = Ray(offset_origin(point, ray.direction), ray.direction);
            continue;
        }
        let dimension = (DIMENSION_FIRST_SURFACE + (segment * DIMENSIONS_PER_SURFACE));
        let u_light = random4(key, dimension);
        let importance = total_importance_Buffers(scene, point.position);
        if (importance > 0.0) {
            let direct = direct_light_Buffers(scene, point, bsdf, normal, wo, importance, vec3f(u_light.x, u_light.y, u_light.z));
            result.radiance += (throughput * direct.radiance);
            result.rays += direct.rays;
        }
        let u = random4(key, (dimension + 1u));
        let sample = sample_bsdf(bsdf, normal, wo, vec3f(u.x, u.y, u.z));
        if ((sample.event == EVENT_ABSORBED) || !same_side(point, normal, wo, sample.direction)) {
            return result;
        }
        throughput *= sample.weight;
        ray = Ray(offset_origin(point, sample.direction), sample.direction);
        if (sample.event != EVENT_PASSED) {
            touched += 1u;
            previous = PathVertex(point.position, sample.pdf, sky_pdf(normal, sample.direction, transmits(bsdf)), importance);
        }
        if (touched >= ROULETTE_START) {
            let survival = min(largest(throughput), 0.95);
            if (u.w >= survival) {
                return result;
            }
            throughput *= (1.0 / survival);
        }
    }
    return result;
}

@group(0) @binding(0) var<uniform> HEADER: SceneHeader;
@group(0) @binding(1) var<uniform> SETTINGS: LaunchSettings;
@group(0) @binding(2) var<storage, read> NODES: array<BvhNode>;
@group(0) @binding(3) var<storage, read> OBJECTS: array<ObjectRecord>;
@group(0) @binding(4) var<storage, read> MATERIALS: array<MaterialRecord>;
@group(0) @binding(5) var<storage, read> CHANNELS: array<ChannelRecord>;
@group(0) @binding(6) var<storage, read> TEXELS: array<u32>;
@group(0) @binding(7) var<storage, read> LIGHTS: array<LightRecord>;
@group(0) @binding(8) var<storage, read> ATTRIBUTES: array<vec4f>;
@group(0) @binding(9) var<storage, read_write> FILM: array<FilmPixel>;

struct Buffers {
    unused: u32
}

fn Buffers_header(_scene: Buffers) -> SceneHeader {
    return HEADER;
}

fn Buffers_node(_scene: Buffers, index: u32) -> BvhNode {
    return NODES[u32(index)];
}

fn Buffers_shape(_scene: Buffers, index: u32) -> ShapeRecord {
    return OBJECTS[u32(index)].shape;
}

fn Buffers_surface(_scene: Buffers, index: u32) -> SurfaceRecord {
    return OBJECTS[u32(index)].surface;
}

fn Buffers_material(_scene: Buffers, index: u32) -> MaterialRecord {
    return MATERIALS[u32(index)];
}

fn Buffers_channel(_scene: Buffers, index: u32) -> ChannelRecord {
    return CHANNELS[u32(index)];
}

fn Buffers_texel(_scene: Buffers, index: u32) -> u32 {
    return TEXELS[u32(index)];
}

fn Buffers_light(_scene: Buffers, index: u32) -> LightRecord {
    return LIGHTS[u32(index)];
}

fn Buffers_attribute(_scene: Buffers, index: u32) -> vec4f {
    return ATTRIBUTES[u32(index)];
}

@compute @workgroup_size(8, 8) fn render_tile(@builtin(global_invocation_id) id: vec3u) {
    let settings = SETTINGS;
    if ((id.x < settings.tile_width) && (id.y < settings.tile_height)) {
        let index = ((id.y * settings.tile_width) + id.x);
        let before = FILM[u32(index)];
        let after = render_pixel_Buffers(Buffers(0u), settings, (settings.tile_x + id.x), (settings.tile_y + id.y), before);
        FILM[u32(index)] = after;
    }
}

