var<private> stack_bits: array<u32, 48>;
var<private> stack_first: array<u32, 48>;
struct Affine {
    row0: vec4f,
    row1: vec4f,
    row2: vec4f
}

struct BvhNode {
    origin: vec3f,
    exponents: u32,
    first_node: u32,
    first_object: u32,
    leaves: u32,
    unused: u32,
    low_xy: vec4u,
    low_z_high_x: vec4u,
    high_yz: vec4u
}
const NODE_INSTANCE: u32 = 4294967295u;
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
const MATERIAL_INTERPOLATED: u32 = 1u;
const MATERIAL_MIRRORS: u32 = 2u;
const MATERIAL_USES_POSITION: u32 = 4u;
const MATERIAL_LAMBERTIAN: u32 = 8u;
const MATERIAL_UNIFORM: u32 = 16u;

struct MaterialRecord {
    diffuse: u32,
    specular: u32,
    shininess: u32,
    transparency: u32,
    transparency_shininess: u32,
    diffuse_transparency: u32,
    ambient: u32,
    emissive: u32,
    flags: u32,
    opacity: f32,
    back: u32,
    refractive_index: f32,
    normal_map: u32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
    diffuse_color: vec3f,
    reserved3: u32,
    transmitted_color: vec3f,
    reserved4: u32
}
const CHANNEL_CONSTANT: u32 = 0u;
const CHANNEL_IMAGE: u32 = 1u;
const CHANNEL_CHECKER: u32 = 2u;
const CHANNEL_MOVE_UV: u32 = 3u;
const CHANNEL_LINEAR_UV: u32 = 4u;
const CHANNEL_VOLUME_CHECKER: u32 = 5u;
const CHANNEL_AFFINE_XYZ: u32 = 6u;
const CHANNEL_TURBULENCE: u32 = 7u;
const CHANNEL_NOISE: u32 = 8u;
const CHANNEL_GRADIENT: u32 = 9u;
const CHANNEL_WOOD: u32 = 10u;
const CHANNEL_LEOPARD: u32 = 11u;
const CHANNEL_FRACTAL: u32 = 12u;
const CHANNEL_WAVES: u32 = 13u;
const CHANNEL_LINEAR: u32 = 14u;
const CHANNEL_WAVE_FORM: u32 = 15u;
const CHANNEL_GREY: u32 = 16u;
const CHANNEL_CALL: u32 = 17u;
const CHANNEL_BLEND: u32 = 18u;
const CHANNEL_ITEM: u32 = 19u;
const CHANNEL_FILTER: u32 = 20u;
const CHANNEL_OPERAND: u32 = 21u;
const CHANNEL_NORMAL_MAP: u32 = 22u;

struct ChannelRecord {
    value: vec4f,
    operation: u32,
    first: u32,
    size: u32,
    mode: u32
}
const LIGHT_POINT: u32 = 0u;
const LIGHT_SPOT: u32 = 1u;
const LIGHT_DIRECTIONAL: u32 = 2u;
const LIGHT_AREA: u32 = 3u;
const LIGHT_SKY: u32 = 4u;
const LIGHT_SKY_MAP: u32 = 5u;
const LIGHT_DAYLIGHT: u32 = 6u;
const LIGHT_SUN: u32 = 7u;
const LIGHT_PHYSICAL: u32 = 8u;
const LIGHT_GROUP: u32 = 9u;

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
    importance: f32,
    first: u32,
    count: u32,
    parent: u32,
    program: u32
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
    distant_lights: u32,
    ambient: vec3f,
    all_lights: u32,
    lens_radius: f32,
    vergence: f32,
    reserved0: u32,
    reserved1: u32
}
const RENDERER_PATH_TRACER: u32 = 0u;
const RENDERER_RAY_TRACER: u32 = 1u;

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
    renderer: u32,
    background: vec3f,
    shadow_samples: u32,
    sampler: u32,
    sequence_bits: u32,
    reconstruction: u32,
    counted: u32
}
const MAX_SEQUENCE_BITS: u32 = 20u;

struct FilmPixel {
    radiance: vec3f,
    rays: u32,
    squares: vec3f,
    samples: u32
}

struct LayerPixel {
    albedo: vec3f,
    samples: u32,
    normal: vec3f,
    hits: u32,
    position: vec3f,
    depth: f32,
    object: u32,
    instance: u32,
    material: u32,
    reserved: u32
}

fn launched_samples(settings: LaunchSettings, pixel_samples: u32) -> u32 {
    if (settings.counted == 0u) {
        return settings.samples;
    }
    return min(settings.samples, (max(pixel_samples, settings.first_sample) - settings.first_sample));
}
const FEATURE_LOBES: u32 = 256u;
const FEATURE_MEDIA: u32 = 512u;
const FEATURE_IMAGES: u32 = 1024u;
const FEATURE_PROGRAMS: u32 = 2048u;
const FEATURE_POSITIONS: u32 = 4096u;
const FEATURE_BACKS: u32 = 8192u;
const FEATURE_HOLES: u32 = 16384u;
const FEATURE_LIGHT_TABLES: u32 = 32768u;
const FEATURE_LIGHT_GROUPS: u32 = 65536u;
const FEATURE_MANY_NODES: u32 = 131072u;
const ALL_FEATURES: u32 = 262143u;
const MANY_NODES: u32 = 2u;

fn transform_point(matrix: Affine, point: vec3f) -> vec3f {
    return vec3f(transform_row(matrix.row0, point), transform_row(matrix.row1, point), transform_row(matrix.row2, point));
}

fn transform_row(row: vec4f, point: vec3f) -> f32 {
    return ((((row.x * point.x) + (row.y * point.y)) + (row.z * point.z)) + row.w);
}

fn turn_row(row: vec4f, direction: vec3f) -> f32 {
    return (((row.x * direction.x) + (row.y * direction.y)) + (row.z * direction.z));
}

fn compose_row(row: vec4f, second: Affine) -> vec4f {
    return ((((second.row0 * row.x) + (second.row1 * row.y)) + (second.row2 * row.z)) + vec4f(0.0, 0.0, 0.0, row.w));
}

fn compose(first: Affine, second: Affine) -> Affine {
    return Affine(compose_row(first.row0, second), compose_row(first.row1, second), compose_row(first.row2, second));
}

fn transform_vector(matrix: Affine, direction: vec3f) -> vec3f {
    return vec3f(turn_row(matrix.row0, direction), turn_row(matrix.row1, direction), turn_row(matrix.row2, direction));
}

fn transform_transposed(matrix: Affine, normal: vec3f) -> vec3f {
    return vec3f((((matrix.row0.x * normal.x) + (matrix.row1.x * normal.y)) + (matrix.row2.x * normal.z)), (((matrix.row0.y * normal.x) + (matrix.row1.y * normal.y)) + (matrix.row2.y * normal.z)), (((matrix.row0.z * normal.x) + (matrix.row1.z * normal.y)) + (matrix.row2.z * normal.z)));
}

fn transform_magnitude(matrix: Affine, point: vec3f) -> vec3f {
    let p = vec4f(abs(point.x), abs(point.y), abs(point.z), 1.0);
    return vec3f(dot(abs(matrix.row0), p), dot(abs(matrix.row1), p), dot(abs(matrix.row2), p));
}

fn has_Buffers(scene: Buffers, feature: u32) -> bool {
    return ((Buffers_features(scene) & feature) != 0u);
}

const PI: f32 = 3.14159265358979;
const INVERSE_PI: f32 = 0.318309886183791;
const TWO_PI: f32 = 6.28318530717959;

fn stretched(u: f32, start: f32, length: f32) -> f32 {
    return clamp(((u - start) / length), 0.0, 0.99999994);
}

fn around_axis(axis: vec3f, local: vec3f) -> vec3f {
    let sign = select(-1.0, 1.0, (axis.z >= 0.0));
    let a = (-1.0 / (sign + axis.z));
    let b = ((axis.x * axis.y) * a);
    let x = vec3f((1.0 + (((sign * axis.x) * axis.x) * a)), (sign * b), (-sign * axis.x));
    let y = vec3f(b, (sign + ((axis.y * axis.y) * a)), -axis.y);
    return normalize((((x * local.x) + (y * local.y)) + (axis * local.z)));
}

fn on_circle(u: f32) -> vec2f {
    let quarters = floor(((4.0 * u) + 0.5));
    let x = (TWO_PI * (u - (0.25 * quarters)));
    let xx = (x * x);
    let sine = (x + ((x * xx) * ((xx * (8.3321608736e-3 - (xx * 1.9515295891e-4))) - 1.6666654611e-1)));
    let cosine = ((1.0 - (0.5 * xx)) + ((xx * xx) * (4.166664568298827e-2 + (xx * ((2.443315711809948e-5 * xx) - 1.388731625493765e-3)))));
    let turned = u32(quarters);
    let swapped = ((turned & 1u) != 0u);
    let along = select(cosine, sine, swapped);
    let across = select(sine, cosine, swapped);
    let opposite = (((turned + 1u) & 2u) != 0u);
    let below = ((turned & 2u) != 0u);
    return vec2f(select(along, -along, opposite), select(across, -across, below));
}

fn polar_direction(cos_theta: f32, u: f32) -> vec3f {
    let sin_theta = sqrt(max(0.0, (1.0 - (cos_theta * cos_theta))));
    let turned = on_circle(u);
    return vec3f((turned.x * sin_theta), (turned.y * sin_theta), cos_theta);
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
    var result = no_hit();
    if (discriminant >= 0.0) {
        let half = sqrt((discriminant / a));
        let near = (t_mid - half);
        let far = (t_mid + half);
        let enters = ((near > t_min) && (near < t_max));
        if (enters || ((far > t_min) && (far < t_max))) {
            result.t = select(far, near, enters);
        }
    }
    return result;
}

fn away_from_zero(x: f32) -> f32 {
    if (abs(x) < 1.0e-20) {
        return select(-1.0e-20, 1.0e-20, (x >= 0.0));
    }
    return x;
}

fn intersect_box(ray: Ray, t_min: f32, t_max: f32) -> ShapeHit {
    let d = vec3f(away_from_zero(ray.direction.x), away_from_zero(ray.direction.y), away_from_zero(ray.direction.z));
    let inverse = (vec3f(1.0, 1.0, 1.0) / d);
    let centre = (-ray.origin * inverse);
    let half = abs(inverse);
    let enter = (centre - half);
    let leave = (centre + half);
    let t_in = max(enter.x, max(enter.y, enter.z));
    let t_out = min(leave.x, min(leave.y, leave.z));
    var result = no_hit();
    if (t_in <= t_out) {
        let from_outside = (t_in > t_min);
        let t = select(t_out, t_in, from_outside);
        let side = select(d, -d, from_outside);
        let per_axis = select(leave, enter, from_outside);
        if ((t > t_min) && (t < t_max)) {
            let x = select(0u, 1u, (side.x > 0.0));
            let y = select(2u, 3u, (side.y > 0.0));
            let z = select(4u, 5u, (side.z > 0.0));
            let face = select(select(z, y, (t == per_axis.y)), x, (t == per_axis.x));
            result = ShapeHit(t, face);
        }
    }
    return result;
}

fn intersect_frustum(
    kind: u32,
    base_radius: f32,
    top_radius: f32,
    ray: Ray,
    t_min: f32,
    t_max: f32,
) -> ShapeHit {
    var best = no_hit();
    best.t = t_max;
    let slope = (top_radius - base_radius);
    let t_mid = closest_approach(ray, vec3f(0.0, 0.0, 0.5));
    let p = (ray.origin + (ray.direction * t_mid));
    let d = ray.direction;
    let radius = (base_radius + (slope * p.z));
    let a = (((d.x * d.x) + (d.y * d.y)) - (((slope * slope) * d.z) * d.z));
    let half_b = (((p.x * d.x) + (p.y * d.y)) - ((radius * slope) * d.z));
    let c = (((p.x * p.x) + (p.y * p.y)) - (radius * radius));
    let discriminant = ((half_b * half_b) - (a * c));
    if (discriminant > 0.0) {
        let root = sqrt(discriminant);
        let q = -(half_b + select(-root, root, (half_b >= 0.0)));
        let t0 = (t_mid + (c / away_from_zero(q)));
        let t1 = (t_mid + (q / away_from_zero(a)));
        let near = min(t0, t1);
        let far = max(t0, t1);
        if ((on_lateral_surface(base_radius, top_radius, ray, near) && (near > t_min)) && (near < best.t)) {
            best.t = near;
        } else {
            if ((on_lateral_surface(base_radius, top_radius, ray, far) && (far > t_min)) && (far < best.t)) {
                best.t = far;
            }
        }
    }
    let dz = away_from_zero(d.z);
    if ((kind & FLAG_BASE_OPEN) == 0u) {
        let t = (-ray.origin.z / dz);
        if (((t > t_min) && (t < best.t)) && within_radius(ray, t, base_radius)) {
            best = ShapeHit(t, 1u);
        }
    }
    if ((kind & FLAG_TOP_OPEN) == 0u) {
        let t = ((1.0 - ray.origin.z) / dz);
        if (((t > t_min) && (t < best.t)) && within_radius(ray, t, top_radius)) {
            best = ShapeHit(t, 2u);
        }
    }
    best.t = select(NO_HIT, best.t, (best.t < t_max));
    return best;
}

fn on_lateral_surface(base_radius: f32, top_radius: f32, ray: Ray, t: f32) -> bool {
    let z = (ray.origin.z + (t * ray.direction.z));
    let radius = (base_radius + ((top_radius - base_radius) * z));
    return (((z >= 0.0) && (z <= 1.0)) && (radius >= 0.0));
}

fn within_radius(ray: Ray, t: f32, radius: f32) -> bool {
    let x = (ray.origin.x + (t * ray.direction.x));
    let y = (ray.origin.y + (t * ray.direction.y));
    return (((x * x) + (y * y)) <= (radius * radius));
}

fn intersect_flat(
    features: u32,
    flags: u32,
    object_from_world: Affine,
    ray: Ray,
    t_min: f32,
    t_max: f32,
) -> ShapeHit {
    let m = object_from_world;
    let kind = (flags & SHAPE_MASK);
    var across = m.row1;
    let is_plane = (((features & (1u << SHAPE_PLANE)) != 0u) && (kind == SHAPE_PLANE));
    if is_plane {
        across = m.row2;
    }
    let slope = turn_row(across, ray.direction);
    let t = (-transform_row(across, ray.origin) / away_from_zero(slope));
    var result = no_hit();
    if ((t > t_min) && (t < t_max)) {
        let x = (transform_row(m.row0, ray.origin) + (t * turn_row(m.row0, ray.direction)));
        let z = (transform_row(m.row2, ray.origin) + (t * turn_row(m.row2, ray.direction)));
        var inside = (is_plane || (((abs(x) <= 1.0) && (z >= 0.0)) && (z <= 1.0)));
        if (((features & (1u << SHAPE_TRIANGLE)) != 0u) && (kind == SHAPE_TRIANGLE)) {
            let far = (abs(ray.origin) + (abs(ray.direction) * abs(t)));
            let margin_x = (ROUNDING * transform_row(abs(m.row0), far));
            let margin_z = (ROUNDING * transform_row(abs(m.row2), far));
            let hidden = select(FLAG_BACK_HIDDEN, FLAG_FRONT_HIDDEN, (slope < 0.0));
            inside = ((((x >= -margin_x) && (z >= -margin_z)) && ((x + z) <= ((1.0 + margin_x) + margin_z))) && ((flags & hidden) == 0u));
        }
        result.t = select(NO_HIT, t, inside);
    }
    return result;
}

fn intersect_shape(
    features: u32,
    shape: ShapeRecord,
    ray_world: Ray,
    t_min: f32,
    t_max: f32,
) -> ShapeHit {
    let object_from_world = shape.object_from_world;
    let flags = shape.kind;
    let kind = (flags & SHAPE_MASK);
    var result = no_hit();
    if (kind >= SHAPE_PLANE) {
        result = intersect_flat(features, flags, object_from_world, ray_world, t_min, t_max);
    } else {
        let ray = transform_ray(object_from_world, ray_world);
        if (((features & (1u << SHAPE_FRUSTUM)) != 0u) && (kind == SHAPE_FRUSTUM)) {
            result = intersect_frustum(flags, shape.base_radius, shape.top_radius, ray, t_min, t_max);
        } else if (((features & (1u << SHAPE_SPHERE)) != 0u) && (kind == SHAPE_SPHERE)) {
            result = intersect_sphere(ray, t_min, t_max);
        } else if ((features & (1u << SHAPE_BOX)) != 0u) {
            result = intersect_box(ray, t_min, t_max);
        }
    }
    return result;
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

fn surface_point(
    shape: ShapeRecord,
    v_scale: f32,
    object_from_world: Affine,
    world_from_object: Affine,
    ray: Ray,
    hit: ShapeHit,
) -> SurfacePoint {
    let local = transform_ray(object_from_world, ray);
    let p = snap_to_surface(shape, hit.face, (local.origin + (local.direction * hit.t)));
    let position = transform_point(world_from_object, p);
    let normal = normalize(transform_transposed(object_from_world, object_normal(shape, hit.face, p)));
    let error_world = transform_magnitude(world_from_object, p);
    let error_object = transform_magnitude(object_from_world, position);
    let m = world_from_object;
    let e = vec4f(error_object.x, error_object.y, error_object.z, 0.0);
    let carried = vec3f(dot(abs(m.row0), e), dot(abs(m.row1), e), dot(abs(m.row2), e));
    let error = (ROUNDING * dot(abs(normal), (error_world + carried)));
    return SurfacePoint(position, error, normal, texture_coordinates(shape, v_scale, hit.face, p), normal);
}

fn offset_origin(point: SurfacePoint, direction: vec3f) -> vec3f {
    let side = select(-1.0, 1.0, (dot(direction, point.normal) >= 0.0));
    return (point.position + (point.normal * (side * point.error)));
}

const BLOCK_LEVELS: u32 = 4u;

fn mix_bits(bits: u32) -> u32 {
    var x = bits;
    x = (x ^ (x >> 16u));
    x *= 2246822507u;
    x = (x ^ (x >> 13u));
    x *= 3266489909u;
    return (x ^ (x >> 16u));
}

fn permute_upwards(bits: u32, seed: u32) -> u32 {
    var x = bits;
    x = (x ^ (x * 1025551850u));
    x += seed;
    x *= ((seed >> 16u) | 1u);
    x = (x ^ (x * 89287766u));
    return (x ^ (x * 1403136100u));
}

fn nested_uniform_scramble(bits: u32, seed: u32) -> u32 {
    return reverseBits(permute_upwards(reverseBits(bits), seed));
}

fn pascal(index: u32) -> u32 {
    var y = index;
    y = (y ^ ((y >> 1u) & 1431655765u));
    y = (y ^ ((y >> 2u) & 858993459u));
    y = (y ^ ((y >> 4u) & 252645135u));
    y = (y ^ ((y >> 8u) & 16711935u));
    return (y ^ (y >> 16u));
}

fn times_w(digits: u32) -> u32 {
    return ((((digits >> 1u) & 1431655765u) ^ ((digits << 1u) & 2863311530u)) ^ (digits & 2863311530u));
}

fn pascal_of_four(index: u32) -> u32 {
    var z = index;
    z = (z ^ times_w(((z >> 2u) & 858993459u)));
    let second = ((z >> 4u) & 252645135u);
    z = ((z ^ second) ^ times_w(second));
    z = (z ^ times_w(((z >> 8u) & 16711935u)));
    let fourth = (z >> 16u);
    return ((z ^ fourth) ^ times_w(fourth));
}

fn sobol4(index: u32) -> vec4u {
    let second = pascal_of_four(index);
    return vec4u(index, pascal(index), second, pascal(second));
}
const GROUPS: u32 = 4u;

fn index_of_group(index: u32, group: u32) -> u32 {
    let odd = ((group & 1u) != 0u);
    let upper = ((group & 2u) != 0u);
    let first = select(select(0u, 4241183679u, odd), select(2996896550u, 1302306305u, odd), upper);
    let second = select(select(0u, 218215217u, odd), select(2491290171u, 3829150337u, odd), upper);
    let third = select(select(0u, 3555275105u, odd), select(4093891526u, 1183952838u, odd), upper);
    return reordered(index, vec3u(first, second, third));
}

fn reordered(index: u32, masks: vec3u) -> u32 {
    var z = index;
    z = (z ^ ((z >> 4u) & masks.x));
    z = (z ^ ((z >> 2u) & masks.y));
    return (z ^ ((z >> 1u) & masks.z));
}

fn scrambled_sobol4(index: u32, seeds: vec4u) -> vec4u {
    let point = sobol4(index);
    return vec4u(reverseBits(permute_upwards(point.x, seeds.x)), reverseBits(permute_upwards(point.y, seeds.y)), reverseBits(permute_upwards(point.z, seeds.z)), reverseBits(permute_upwards(point.w, seeds.w)));
}

fn z_order(x: u32, y: u32, seed: u32) -> u32 {
    var place: u32 = 0u;
    for (var i = 0u; i < BLOCK_LEVELS; i++) {
        let level = ((BLOCK_LEVELS - 1u) - i);
        let right = ((x >> level) & 1u);
        let down = ((y >> level) & 1u);
        let random = mix_bits((seed ^ (((1u << (2u * i)) | place) * 2654435769u)));
        let first = (1u + ((random >> 8u) % 3u));
        let second = (1u + ((first + ((random >> 4u) & 1u)) % 3u));
        let quadrant = (((right * first) ^ (down * second)) ^ (random & 3u));
        place = ((place << 2u) | quadrant);
    }
    return place;
}

const SAMPLER_INDEPENDENT: u32 = 0u;
const SAMPLER_SOBOL: u32 = 1u;

struct SampleKey {
    pixel: u32,
    sample: u32,
    seed: u32,
    index_mask: u32,
    start: u32,
    index: u32,
    scramble: u32
}
const DIMENSION_PIXEL: u32 = 0u;
const DIMENSION_LENS: u32 = 536870912u;
const DIMENSION_FIRST_SURFACE: u32 = 1u;
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

fn independent_key(pixel: u32, sample: u32, seed: u32) -> SampleKey {
    return SampleKey(pixel, sample, seed, 0u, 0u, 0u, 0u);
}

fn sample_key(settings: LaunchSettings, x: u32, y: u32, sample: u32) -> SampleKey {
    var key = independent_key(((y * settings.width) + x), sample, settings.seed);
    if (settings.sampler == SAMPLER_SOBOL) {
        let bits = settings.sequence_bits;
        let repetition = (sample >> bits);
        let block = pcg4d(vec4u((x >> BLOCK_LEVELS), (y >> BLOCK_LEVELS), (repetition ^ 2779096485u), settings.seed));
        let edge_mask = ((1u << BLOCK_LEVELS) - 1u);
        let place = z_order((x & edge_mask), (y & edge_mask), block.x);
        key.index_mask = ((1u << (bits + (2u * BLOCK_LEVELS))) - 1u);
        key.start = (place << bits);
        key.scramble = block.y;
        key.index = shuffled_index(key, bits, sample);
    }
    return key;
}

fn shuffled_index(key: SampleKey, bits: u32, sample: u32) -> u32 {
    let place = (key.start | (sample & ((1u << bits) - 1u)));
    return (nested_uniform_scramble(place, key.scramble) & key.index_mask);
}

fn key_of_sample(
    settings: LaunchSettings,
    x: u32,
    y: u32,
    other: SampleKey,
    sample: u32,
) -> SampleKey {
    let bits = settings.sequence_bits;
    if ((settings.sampler == SAMPLER_SOBOL) && ((sample >> bits) != (other.sample >> bits))) {
        return sample_key(settings, x, y, sample);
    }
    var key = other;
    key.sample = sample;
    if (settings.sampler == SAMPLER_SOBOL) {
        key.index = shuffled_index(key, bits, sample);
    }
    return key;
}

fn independent_number(key: SampleKey, dimension: u32) -> f32 {
    return unit_float(pcg4d(vec4u(key.pixel, key.sample, (dimension ^ 2654435769u), key.seed)).x);
}

fn random4(key: SampleKey, dimension: u32) -> vec4f {
    let sobol = (key.index_mask != 0u);
    let first = select(key.pixel, key.scramble, sobol);
    let second = select(key.sample, 3141592653u, sobol);
    var bits = pcg4d(vec4u(first, second, dimension, key.seed));
    if sobol {
        var index = key.index;
        let ensemble = (dimension / GROUPS);
        if (ensemble != 0u) {
            let order = mix_bits((key.scramble ^ (ensemble * 2654435769u)));
            index = (nested_uniform_scramble(index, order) & key.index_mask);
        }
        bits = scrambled_sobol4(index_of_group(index, (dimension % GROUPS)), bits);
    }
    return vec4f(unit_float(bits.x), unit_float(bits.y), unit_float(bits.z), unit_float(bits.w));
}

fn camera_numbers(key: SampleKey, grid: u32) -> vec4f {
    let jitter = random4(key, DIMENSION_PIXEL);
    if (key.index_mask != 0u) {
        return jitter;
    }
    let cells = (grid * grid);
    let round = (key.sample / cells);
    let start = pcg4d(vec4u(key.pixel, round, 3735928559u, key.seed)).x;
    let cell = (((key.sample % cells) + (start % cells)) % cells);
    let column = (cell % grid);
    let row = (cell / grid);
    return vec4f(((f32(column) + jitter.x) / f32(grid)), ((f32(row) + jitter.y) / f32(grid)), jitter.z, jitter.w);
}

fn pixel_position(key: SampleKey, grid: u32) -> vec2f {
    let numbers = camera_numbers(key, grid);
    return vec2f(numbers.x, numbers.y);
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
    if ((!has_Buffers(scene, (1u << SHAPE_TRIANGLE)) || ((shape.kind & SHAPE_MASK) != SHAPE_TRIANGLE)) || (surface.attributes == NONE)) {
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
    if (!has_Buffers(scene, (1u << SHAPE_TRIANGLE)) || ((shape.kind & SHAPE_MASK) != SHAPE_TRIANGLE)) {
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

struct TexturePoint {
    uv: vec2f,
    local: vec3f,
    world: vec3f
}

struct Tangents {
    du: vec3f,
    dv: vec3f
}

fn uv_point(uv: vec2f) -> TexturePoint {
    return TexturePoint(uv, vec3f(0.0, 0.0, 0.0), vec3f(0.0, 0.0, 0.0));
}

fn box_tangents(face: u32) -> Tangents {
    var du = vec3f(8.0, 0.0, 0.0);
    var dv = vec3f(0.0, 6.0, 0.0);
    if (face == 0u) {
        du = vec3f(0.0, 0.0, 8.0);
    }
    if (face == 1u) {
        du = vec3f(0.0, 0.0, -8.0);
    }
    if (face == 2u) {
        dv = vec3f(0.0, 0.0, 6.0);
    }
    if (face == 3u) {
        dv = vec3f(0.0, 0.0, -6.0);
    }
    if (face == 4u) {
        du = vec3f(-8.0, 0.0, 0.0);
    }
    return Tangents(du, dv);
}

fn shape_tangents(shape: ShapeRecord, v_factor: f32, face: u32, p: vec3f) -> Tangents {
    let kind = (shape.kind & SHAPE_MASK);
    let v_scale = away_from_zero(v_factor);
    if (kind == SHAPE_PARALLELOGRAM) {
        return Tangents(vec3f(2.0, 0.0, 0.0), vec3f(0.0, 0.0, (1.0 / v_scale)));
    }
    if (kind == SHAPE_PLANE) {
        return Tangents(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0));
    }
    if (kind == SHAPE_BOX) {
        return box_tangents(face);
    }
    let round = (vec3f(-p.y, p.x, 0.0) * TWO_PI);
    let radial = max(sqrt(((p.x * p.x) + (p.y * p.y))), 1.0e-6);
    if (kind == SHAPE_SPHERE) {
        let up = vec3f(((-p.z * p.x) / radial), ((-p.z * p.y) / radial), radial);
        return Tangents(round, (up * (0.5 * TWO_PI)));
    }
    if (face == 0u) {
        let slope = (shape.top_radius - shape.base_radius);
        let up = vec3f(((slope * p.x) / radial), ((slope * p.y) / radial), 1.0);
        return Tangents(round, (up * (1.0 / v_scale)));
    }
    let diameter = (2.0 * select(shape.top_radius, shape.base_radius, (face == 1u)));
    let dv = vec3f(0.0, select(diameter, -diameter, (face == 1u)), 0.0);
    return Tangents(vec3f(diameter, 0.0, 0.0), dv);
}

fn transform_tangents(matrix: Affine, tangents: Tangents) -> Tangents {
    return Tangents(transform_vector(matrix, tangents.du), transform_vector(matrix, tangents.dv));
}

fn local_from_unit_Buffers(scene: Buffers, shape: ShapeRecord, surface: SurfaceRecord) -> Affine {
    let corners = select(0u, 4u, ((shape.kind & SHAPE_MASK) == SHAPE_TRIANGLE));
    let first = (surface.attributes + corners);
    return Affine(Buffers_attribute(scene, first), Buffers_attribute(scene, (first + 1u)), Buffers_attribute(scene, (first + 2u)));
}

fn texture_point_Buffers(
    scene: Buffers,
    instance: u32,
    shape: ShapeRecord,
    surface: SurfaceRecord,
    material: MaterialRecord,
    p: vec3f,
    uv: vec2f,
) -> TexturePoint {
    var at = uv_point(uv);
    if ((material.flags & MATERIAL_USES_POSITION) != 0u) {
        at.local = transform_point(local_from_unit_Buffers(scene, shape, surface), p);
        at.world = transform_point(world_from_unit_Buffers(scene, instance, surface), p);
    }
    return at;
}

fn triangle_tangents_Buffers(scene: Buffers, surface: SurfaceRecord) -> Tangents {
    let zero = vec3f(0.0, 0.0, 0.0);
    var tangents = Tangents(zero, zero);
    if (surface.attributes == NONE) {
        return tangents;
    }
    let a = Buffers_attribute(scene, surface.attributes);
    let b = Buffers_attribute(scene, (surface.attributes + 1u));
    let c = Buffers_attribute(scene, (surface.attributes + 2u));
    let v = Buffers_attribute(scene, (surface.attributes + 3u));
    let u1 = (b.w - a.w);
    let u2 = (c.w - a.w);
    let v1 = (v.y - v.x);
    let v2 = (v.z - v.x);
    let determinant = ((u1 * v2) - (u2 * v1));
    if (abs(determinant) < 1.0e-20) {
        return tangents;
    }
    tangents.du = (vec3f(v2, 0.0, -v1) * (1.0 / determinant));
    tangents.dv = (vec3f(-u2, 0.0, u1) * (1.0 / determinant));
    return tangents;
}

fn unit_tangents_Buffers(
    scene: Buffers,
    shape: ShapeRecord,
    surface: SurfaceRecord,
    face: u32,
    p: vec3f,
) -> Tangents {
    if ((shape.kind & SHAPE_MASK) == SHAPE_TRIANGLE) {
        return triangle_tangents_Buffers(scene, surface);
    }
    return shape_tangents(shape, surface.v_scale, face, p);
}

fn world_from_unit_Buffers(scene: Buffers, instance: u32, surface: SurfaceRecord) -> Affine {
    if (instance == NONE) {
        return surface.world_from_object;
    }
    return compose(Buffers_surface(scene, instance).world_from_object, surface.world_from_object);
}

fn unpack_bytes(word: u32) -> vec4f {
    return vec4f(f32((word & 255u)), f32(((word >> 8u) & 255u)), f32(((word >> 16u) & 255u)), f32((word >> 24u)));
}
const FURTHER: f32 = 1.0000008;

fn cell_edge(exponent: u32) -> f32 {
    return bitcast<f32>((exponent << 23u));
}

fn reached_of_four(
    near: vec3u,
    far: vec3u,
    edge: vec3f,
    start: vec3f,
    t_max: f32,
) -> u32 {
    let one = vec4f(1.0, 1.0, 1.0, 1.0);
    let zero = vec4f(0.0, 0.0, 0.0, 0.0);
    let in_x = ((unpack_bytes(near.x) * edge.x) + (one * start.x));
    let in_y = ((unpack_bytes(near.y) * edge.y) + (one * start.y));
    let in_z = ((unpack_bytes(near.z) * edge.z) + (one * start.z));
    let out_x = ((unpack_bytes(far.x) * edge.x) + (one * start.x));
    let out_y = ((unpack_bytes(far.y) * edge.y) + (one * start.y));
    let out_z = ((unpack_bytes(far.z) * edge.z) + (one * start.z));
    let t_in = max(max(in_x, in_y), max(in_z, zero));
    let t_out = (min(min(out_x, out_y), min(out_z, (one * t_max))) * FURTHER);
    return (((select(0u, 1u, (t_in.x <= t_out.x)) | select(0u, 2u, (t_in.y <= t_out.y))) | select(0u, 4u, (t_in.z <= t_out.z))) | select(0u, 8u, (t_in.w <= t_out.w)));
}

fn reached_boxes(node: BvhNode, origin: vec3f, inverse: vec3f, t_max: f32) -> u32 {
    let edge = (vec3f(cell_edge((node.exponents & 255u)), cell_edge(((node.exponents >> 8u) & 255u)), cell_edge(((node.exponents >> 16u) & 255u))) * inverse);
    let start = ((node.origin - origin) * inverse);
    let low_x = vec2u(node.low_xy.x, node.low_xy.y);
    let low_y = vec2u(node.low_xy.z, node.low_xy.w);
    let low_z = vec2u(node.low_z_high_x.x, node.low_z_high_x.y);
    let high_x = vec2u(node.low_z_high_x.z, node.low_z_high_x.w);
    let high_y = vec2u(node.high_yz.x, node.high_yz.y);
    let high_z = vec2u(node.high_yz.z, node.high_yz.w);
    let near_x = select(high_x, low_x, (inverse.x >= 0.0));
    let near_y = select(high_y, low_y, (inverse.y >= 0.0));
    let near_z = select(high_z, low_z, (inverse.z >= 0.0));
    let far_x = select(low_x, high_x, (inverse.x >= 0.0));
    let far_y = select(low_y, high_y, (inverse.y >= 0.0));
    let far_z = select(low_z, high_z, (inverse.z >= 0.0));
    let near0 = vec3u(near_x.x, near_y.x, near_z.x);
    let far0 = vec3u(far_x.x, far_y.x, far_z.x);
    let near1 = vec3u(near_x.y, near_y.y, near_z.y);
    let far1 = vec3u(far_x.y, far_y.y, far_z.y);
    return (reached_of_four(near0, far0, edge, start, t_max) | (reached_of_four(near1, far1, edge, start, t_max) << 4u));
}

fn visiting_order(inverse: vec3f) -> u32 {
    return ((select(0u, 1u, (inverse.x < 0.0)) | select(0u, 2u, (inverse.y < 0.0))) | select(0u, 4u, (inverse.z < 0.0)));
}

fn in_order(children: u32, order: u32) -> u32 {
    var bits = children;
    if ((order & 1u) != 0u) {
        bits = (((bits & 85u) << 1u) | ((bits >> 1u) & 85u));
    }
    if ((order & 2u) != 0u) {
        bits = (((bits & 51u) << 2u) | ((bits >> 2u) & 51u));
    }
    if ((order & 4u) != 0u) {
        bits = (((bits & 15u) << 4u) | (bits >> 4u));
    }
    return bits;
}

fn children_before(children: u32, child: u32) -> u32 {
    return countOneBits((children & ((1u << child) - 1u)));
}

fn waiting_children(node: BvhNode, reached: u32, order: u32) -> vec2u {
    let nodes = (node.exponents >> 24u);
    return vec2u(node.first_node, (in_order((reached & nodes), order) | (nodes << 8u)));
}

fn waiting_root(root: u32) -> vec2u {
    return vec2u(root, 1u);
}

fn any_waits(children: vec2u) -> bool {
    return ((children.y & 255u) != 0u);
}

fn next_node(children: vec2u, order: u32) -> u32 {
    let child = (countTrailingZeros(children.y) ^ order);
    return (children.x + children_before((children.y >> 8u), child));
}

fn without_next(children: vec2u) -> vec2u {
    return vec2u(children.x, (children.y & (children.y - 1u)));
}

struct Media {
    indices: vec4f,
    bodies: vec4u
}

fn empty_space() -> Media {
    return Media(vec4f(1.0, 1.0, 1.0, 1.0), vec4u(NONE, NONE, NONE, NONE));
}

fn enter_medium(media: Media, body: u32, index: f32) -> Media {
    let i = media.indices;
    let b = media.bodies;
    return Media(vec4f(index, i.x, i.y, i.z), vec4u(body, b.x, b.y, b.z));
}

fn leave_medium(media: Media, body: u32) -> Media {
    let i = media.indices;
    let b = media.bodies;
    if (b.x == body) {
        return Media(vec4f(i.y, i.z, i.w, 1.0), vec4u(b.y, b.z, b.w, NONE));
    }
    if (b.y == body) {
        return Media(vec4f(i.x, i.z, i.w, 1.0), vec4u(b.x, b.z, b.w, NONE));
    }
    if (b.z == body) {
        return Media(vec4f(i.x, i.y, i.w, 1.0), vec4u(b.x, b.y, b.w, NONE));
    }
    if (b.w == body) {
        return Media(vec4f(i.x, i.y, i.z, 1.0), vec4u(b.x, b.y, b.z, NONE));
    }
    return media;
}

fn refracted_cosine_squared(eta: f32, cosine: f32) -> f32 {
    return (1.0 - ((eta * eta) * (1.0 - (cosine * cosine))));
}

fn fresnel_reflectance(eta: f32, cosine: f32) -> f32 {
    if (eta == 1.0) {
        return 0.0;
    }
    let squared = refracted_cosine_squared(eta, cosine);
    if (squared <= 0.0) {
        return 1.0;
    }
    let behind = sqrt(squared);
    let across = ((behind - (eta * cosine)) / (behind + (eta * cosine)));
    let along = ((cosine - (eta * behind)) / (cosine + (eta * behind)));
    return (0.5 * ((across * across) + (along * along)));
}

fn refracted_direction(eta: f32, normal: vec3f, wo: vec3f) -> vec3f {
    let cosine = dot(normal, wo);
    let squared = refracted_cosine_squared(eta, cosine);
    if ((eta == 1.0) || (squared <= 0.0)) {
        return -wo;
    }
    return normalize(((-wo * eta) + (normal * ((eta * cosine) - sqrt(squared)))));
}

const WAVE_ABS: u32 = 0u;
const WAVE_ACOS: u32 = 1u;
const WAVE_ASIN: u32 = 2u;
const WAVE_ATAN: u32 = 3u;
const WAVE_CEIL: u32 = 4u;
const WAVE_FLOOR: u32 = 5u;
const WAVE_COS: u32 = 6u;
const WAVE_SIN: u32 = 7u;
const WAVE_TAN: u32 = 8u;
const WAVE_COSH: u32 = 9u;
const WAVE_SINH: u32 = 10u;
const WAVE_TANH: u32 = 11u;
const WAVE_EXP: u32 = 12u;
const WAVE_EXP2: u32 = 13u;
const WAVE_EXPM1: u32 = 14u;
const WAVE_LOG: u32 = 15u;
const WAVE_LOG10: u32 = 16u;
const WAVE_SQR: u32 = 17u;
const WAVE_SQRT: u32 = 18u;
const WAVE_RAMP: u32 = 19u;
const WAVE_TRIANGLE: u32 = 20u;
const WAVE_CUBIC: u32 = 21u;
const WAVE_SCALLOP: u32 = 22u;
const WAVE_SIN01: u32 = 23u;
const WAVE_LARGEST_EXPONENT: f32 = 40.0;

fn in_odd_cube(p: vec3f) -> bool {
    let fields = ((floor(p.x) + floor(p.y)) + floor(p.z));
    return ((fields - (2.0 * floor((0.5 * fields)))) >= 0.5);
}

fn leopard(p: vec3f) -> f32 {
    let mean = (((sin(p.x) + sin(p.y)) + sin(p.z)) / 3.0);
    return (mean * mean);
}

fn fractal_coordinate(x: f32) -> f32 {
    if (x > 0.0) {
        return ((4.0 * (x - trunc(x))) - 2.0);
    }
    return ((4.0 * ((x + 1.0) + trunc(-x))) - 2.0);
}

fn fractal(z: vec2f, c: vec2f, iterations: u32) -> f32 {
    var a = z.x;
    var b = z.y;
    var steps: u32 = 0u;
    var inside = true;
    while (inside && (steps < iterations)) {
        let squares = ((a * a) - (b * b));
        b = (((2.0 * a) * b) + c.y);
        a = (squares + c.x);
        inside = (((a * a) + (b * b)) <= 4.0);
        if inside {
            steps += 1u;
        }
    }
    return (((2.0 * f32(steps)) - f32(iterations)) / f32(iterations));
}

fn periodic_wave(form: u32, f: f32) -> f32 {
    if (form == WAVE_RAMP) {
        return ((2.0 * f) - 1.0);
    }
    if (form == WAVE_TRIANGLE) {
        if (f < 0.25) {
            return (4.0 * f);
        }
        if (f < 0.75) {
            return (2.0 - (4.0 * f));
        }
        return ((4.0 * f) - 4.0);
    }
    if (form == WAVE_CUBIC) {
        return (((f * f) * (6.0 - (4.0 * f))) - 1.0);
    }
    if (form == WAVE_SCALLOP) {
        return ((2.0 * sin(((0.5 * TWO_PI) * f))) - 1.0);
    }
    return sin((TWO_PI * f));
}

fn wave_form(form: u32, v: f32) -> f32 {
    if (form >= WAVE_RAMP) {
        return periodic_wave(form, (v - floor(v)));
    }
    if ((form >= WAVE_COSH) && (form <= WAVE_EXPM1)) {
        let e = clamp(v, -WAVE_LARGEST_EXPONENT, WAVE_LARGEST_EXPONENT);
        if (form == WAVE_EXP2) {
            return exp2(e);
        }
        if (form == WAVE_EXP) {
            return exp(e);
        }
        if (form == WAVE_EXPM1) {
            return (exp(e) - 1.0);
        }
        let up = exp(e);
        let down = exp(-e);
        if (form == WAVE_COSH) {
            return (0.5 * (up + down));
        }
        if (form == WAVE_SINH) {
            return (0.5 * (up - down));
        }
        return ((up - down) / (up + down));
    }
    if (form == WAVE_ABS) {
        return abs(v);
    }
    if (form == WAVE_ACOS) {
        return acos(clamp(v, -1.0, 1.0));
    }
    if (form == WAVE_ASIN) {
        return asin(clamp(v, -1.0, 1.0));
    }
    if (form == WAVE_ATAN) {
        return atan(v);
    }
    if (form == WAVE_CEIL) {
        return ceil(v);
    }
    if (form == WAVE_FLOOR) {
        return floor(v);
    }
    if (form == WAVE_COS) {
        return cos(v);
    }
    if (form == WAVE_SIN) {
        return sin(v);
    }
    if (form == WAVE_TAN) {
        return tan(v);
    }
    if (form == WAVE_LOG) {
        return log(max(v, 1.0e-30));
    }
    if (form == WAVE_LOG10) {
        return (log(max(v, 1.0e-30)) * 0.4342944819);
    }
    if (form == WAVE_SQR) {
        return (v * v);
    }
    return sqrt(max(v, 0.0));
}

fn srgb_encode(linear: f32) -> f32 {
    if (linear >= 1.0) {
        return 1.0;
    }
    let x = max(linear, 0.0);
    if (x <= 0.0031308) {
        return (12.92 * x);
    }
    return ((1.055 * pow(x, (1.0 / 2.4))) - 0.055);
}

fn srgb_decode(encoded: f32) -> f32 {
    if (encoded <= 0.04045) {
        return (encoded / 12.92);
    }
    return pow(((encoded + 0.055) / 1.055), 2.4);
}

fn tone_map(radiance: vec3f, exposure: f32) -> vec3f {
    let exposed = (radiance * exp2(exposure));
    return vec3f(srgb_encode(exposed.x), srgb_encode(exposed.y), srgb_encode(exposed.z));
}

fn unpack_texel(texel: u32) -> vec4f {
    return (unpack_bytes(texel) * (1.0 / 255.0));
}

fn in_odd_field(uv: vec2f) -> bool {
    let fields = (floor((2.0 * uv.x)) + floor((2.0 * uv.y)));
    return ((fields - (2.0 * floor((0.5 * fields)))) >= 0.5);
}

fn fetch_texel_Buffers(scene: Buffers, channel: ChannelRecord, column: u32, row: u32) -> vec4f {
    let width = (channel.size & 65535u);
    let height = (channel.size >> 16u);
    let x = (column % width);
    let y = ((height - 1u) - (row % height));
    let color = unpack_texel(Buffers_texel(scene, ((channel.first + (y * width)) + x)));
    if ((channel.mode & 2u) == 0u) {
        return color;
    }
    return vec4f(srgb_decode(color.x), srgb_decode(color.y), srgb_decode(color.z), color.w);
}

fn image_color_Buffers(scene: Buffers, channel: ChannelRecord, uv: vec2f) -> vec4f {
    let width = f32((channel.size & 65535u));
    let height = f32((channel.size >> 16u));
    let x = ((uv.x - floor(uv.x)) * width);
    let y = ((uv.y - floor(uv.y)) * height);
    let column = u32(x);
    let row = u32(y);
    let wx = (x - floor(x));
    let wy = (y - floor(y));
    let corners = select(1u, 4u, ((channel.mode & 1u) != 0u));
    var color = vec4f(0.0, 0.0, 0.0, 0.0);
    for (var corner = 0u; corner < corners; corner++) {
        let right = (corner & 1u);
        let up = (corner >> 1u);
        let texel = fetch_texel_Buffers(scene, channel, (column + right), (row + up));
        let weight = (select((1.0 - wx), wx, (right == 1u)) * select((1.0 - wy), wy, (up == 1u)));
        color += (texel * select(1.0, weight, (corners == 4u)));
    }
    return color;
}

const NOISE_PERMUTATION: u32 = 65536u;
const NOISE_VALUES: u32 = 512u;
const NOISE_TABLE_SIZE: u32 = 66048u;
const NOISE_SCALAR: u32 = 0u;
const NOISE_VECTOR: u32 = 1u;
const NOISE_GRANITE: u32 = 2u;

fn corner_value_Buffers(scene: Buffers, table: u32, m: u32, offset: vec3f) -> f32 {
    let factors = vec4f(0.5, offset.x, offset.y, offset.z);
    var sum: f32 = 0.0;
    for (var k = 0; k < 4; k++) {
        let value = bitcast<f32>(Buffers_texel(scene, ((table + NOISE_PERMUTATION) + ((m + u32(k)) & 511u))));
        var factor = factors.x;
        if (k == 1) {
            factor = factors.y;
        }
        if (k == 2) {
            factor = factors.z;
        }
        if (k == 3) {
            factor = factors.w;
        }
        sum += (value * factor);
    }
    return sum;
}

fn lattice_noise_Buffers(scene: Buffers, table: u32, point: vec3f, components: u32) -> vec3f {
    let limit = vec3f(1.0e9, 1.0e9, 1.0e9);
    let p = clamp(point, -limit, limit);
    let cell = floor(p);
    let d = (p - cell);
    let s = ((d * d) * (vec3f(3.0, 3.0, 3.0) - (d * 2.0)));
    let ix = bitcast<u32>(i32(cell.x));
    let iy = bitcast<u32>(i32(cell.y));
    let iz = bitcast<u32>(i32(cell.z));
    var sum = vec3f(0.0, 0.0, 0.0);
    for (var corner = 0; corner < 8; corner++) {
        let cx = (u32(corner) & 1u);
        let cy = ((u32(corner) >> 1u) & 1u);
        let cz = (u32(corner) >> 2u);
        let weight = ((select((1.0 - s.x), s.x, (cx == 1u)) * select((1.0 - s.y), s.y, (cy == 1u))) * select((1.0 - s.z), s.z, (cz == 1u)));
        let a = Buffers_texel(scene, (table + ((ix + cx) & 65535u)));
        let b = Buffers_texel(scene, (table + (a ^ ((iy + cy) & 65535u))));
        let m = Buffers_texel(scene, (table + (b ^ ((iz + cz) & 65535u))));
        let offset = (d - vec3f(f32(cx), f32(cy), f32(cz)));
        for (var component = 0u; component < components; component++) {
            let value = (weight * corner_value_Buffers(scene, table, (m + (8u * component)), offset));
            let axis = vec3f(select(0.0, 1.0, (component == 0u)), select(0.0, 1.0, (component == 1u)), select(0.0, 1.0, (component == 2u)));
            sum += (axis * value);
        }
    }
    return sum;
}

fn octaves_of_noise_Buffers(
    scene: Buffers,
    table: u32,
    point: vec3f,
    octaves: u32,
    frequency_ratio: f32,
    noise_ratio: f32,
    kind: u32,
) -> vec3f {
    var p = point;
    var amplitude: f32 = 1.0;
    var sum = vec3f(0.0, 0.0, 0.0);
    for (var _octave = 0u; _octave < octaves; _octave++) {
        let values = lattice_noise_Buffers(scene, table, p, select(1u, 3u, (kind == NOISE_VECTOR)));
        if (kind == NOISE_VECTOR) {
            sum += (values * amplitude);
        } else {
            let noise = clamp((2.0 * values.x), -1.0, 1.0);
            let folded = select((-0.5 - noise), (noise - 0.5), (noise > 0.0));
            sum.x += (amplitude * select(noise, folded, (kind == NOISE_GRANITE)));
        }
        p *= frequency_ratio;
        amplitude *= noise_ratio;
    }
    return sum;
}

const MAX_PENDING: u32 = 8u;

struct ChannelRegisters {
    uvw: vec3f,
    xyz: vec3f,
    number: f32,
    next: u32
}

fn start_registers(at: TexturePoint, shift: vec3f, start: u32) -> ChannelRegisters {
    return ChannelRegisters((vec3f(at.uv.x, at.uv.y, 0.0) + shift), (at.local + shift), 0.0, start);
}

fn filter_neighbour(count: u32, number: u32) -> vec4f {
    if (count == 27u) {
        let x = (f32((number % 3u)) - 1.0);
        let y = (f32(((number / 3u) % 3u)) - 1.0);
        let z = (f32((number / 9u)) - 1.0);
        return vec4f(x, y, z, (1.0 / 27.0));
    }
    if (number == 0u) {
        return vec4f(0.0, 0.0, 0.0, 0.5);
    }
    let axis = ((number - 1u) / 2u);
    let side = ((f32((number & 1u)) * 2.0) - 1.0);
    return vec4f(select(0.0, side, (axis == 0u)), select(0.0, side, (axis == 1u)), select(0.0, side, (axis == 2u)), (-1.0 / 12.0));
}

fn change_coordinates_Buffers(scene: Buffers, record: ChannelRecord, world: vec3f, before: ChannelRegisters) -> ChannelRegisters {
    var after = before;
    let v = record.value;
    let uvw = before.uvw;
    if (record.operation == CHANNEL_MOVE_UV) {
        after.uvw = vec3f((uvw.x + v.x), (uvw.y + v.y), uvw.z);
    }
    if (record.operation == CHANNEL_LINEAR_UV) {
        after.uvw = vec3f(((v.x * uvw.x) + (v.y * uvw.y)), ((v.z * uvw.x) + (v.w * uvw.y)), uvw.z);
    }
    if (record.operation == CHANNEL_AFFINE_XYZ) {
        let row1 = Buffers_channel(scene, before.next);
        let row2 = Buffers_channel(scene, (before.next + 1u));
        let rows = Affine(v, row1.value, row2.value);
        var p = before.xyz;
        if (record.first == 1u) {
            p = world;
        }
        after.xyz = transform_point(rows, p);
        after.next = (before.next + 2u);
    }
    return after;
}

fn channel_value_Buffers(scene: Buffers, index: u32, at: TexturePoint, missing: vec4f) -> vec4f {
    if (index == NONE) {
        return missing;
    }
    let channel = Buffers_channel(scene, index);
    if (has_Buffers(scene, FEATURE_IMAGES) && (channel.operation == CHANNEL_IMAGE)) {
        return image_color_Buffers(scene, channel, at.uv);
    }
    if (has_Buffers(scene, FEATURE_PROGRAMS) && (channel.operation != CHANNEL_CONSTANT)) {
        return run_channel_Buffers(scene, index, at);
    }
    return channel.value;
}

fn compute_number_Buffers(scene: Buffers, record: ChannelRecord, before: ChannelRegisters) -> ChannelRegisters {
    var after = before;
    let op = record.operation;
    let v = record.value;
    let p = before.xyz;
    if ((op == CHANNEL_TURBULENCE) || (op == CHANNEL_NOISE)) {
        let ratios = Buffers_channel(scene, before.next);
        after.next = (before.next + 1u);
        var q = (p * v.x);
        var kind = record.mode;
        if (op == CHANNEL_TURBULENCE) {
            kind = NOISE_VECTOR;
            q = p;
            if (record.mode == 1u) {
                q = before.uvw;
            }
        }
        let noise = octaves_of_noise_Buffers(scene, record.first, q, record.size, ratios.value.x, ratios.value.y, kind);
        let moved = (q + (vec3f(v.x, v.y, v.z) * noise));
        if (op == CHANNEL_NOISE) {
            after.number = noise.x;
        } else if (record.mode == 1u) {
            after.uvw = moved;
        } else {
            after.xyz = moved;
        }
    }
    if (op == CHANNEL_GRADIENT) {
        after.number = dot(p, vec3f(v.x, v.y, v.z));
    }
    if (op == CHANNEL_WOOD) {
        after.number = sqrt(((p.x * p.x) + (p.y * p.y)));
    }
    if (op == CHANNEL_LEOPARD) {
        after.number = leopard(p);
    }
    if (op == CHANNEL_FRACTAL) {
        let z = vec2f(fractal_coordinate(p.x), fractal_coordinate(p.y));
        var c = z;
        if (record.first == 1u) {
            c = vec2f(v.x, v.y);
        }
        after.number = fractal(z, c, record.size);
    }
    if (op == CHANNEL_WAVES) {
        after.number = (cos(((TWO_PI * v.x) * before.uvw.x)) * cos(((TWO_PI * v.y) * before.uvw.y)));
    }
    if (op == CHANNEL_LINEAR) {
        after.number = ((before.number * v.x) + v.y);
    }
    if (op == CHANNEL_WAVE_FORM) {
        after.number = wave_form(record.first, before.number);
    }
    return after;
}

fn first_item_behind_Buffers(scene: Buffers, first: u32, count: u32, t: f32) -> u32 {
    var item: u32 = 0u;
    var searching = true;
    while (searching && (item < count)) {
        let record = Buffers_channel(scene, (first + item));
        searching = (record.value.x <= t);
        if searching {
            item += 1u;
        }
    }
    return item;
}

fn run_channel_Buffers(scene: Buffers, start: u32, at: TexturePoint) -> vec4f {
    let zero = vec4f(0.0, 0.0, 0.0, 0.0);
    var shifts: array<vec4f, 8> = array(zero, zero, zero, zero, zero, zero, zero, zero);
    var sums: array<vec4f, 8> = array(zero, zero, zero, zero, zero, zero, zero, zero);
    var alphas: array<f32, 8> = array<f32, 8>();
    var origins: array<u32, 8> = array<u32, 8>();
    var counts: array<u32, 8> = array<u32, 8>();
    var pending: u32 = 0u;
    var sum = zero;
    var shift = vec3f(0.0, 0.0, 0.0);
    var weight: f32 = 1.0;
    var alpha_weight: f32 = 1.0;
    var registers = start_registers(at, shift, start);
    var running = true;
    while running {
        let record_index = registers.next;
        let record = Buffers_channel(scene, record_index);
        let op = record.operation;
        registers.next = (record_index + 1u);
        var ended = ((op <= CHANNEL_IMAGE) || (op == CHANNEL_GREY));
        if ended {
            var color = record.value;
            if (op == CHANNEL_IMAGE) {
                color = image_color_Buffers(scene, record, vec2f(registers.uvw.x, registers.uvw.y));
            }
            if (op == CHANNEL_GREY) {
                color = vec4f(registers.number, registers.number, registers.number, 1.0);
            }
            sum += (color * vec4f(weight, weight, weight, alpha_weight));
        } else if ((op == CHANNEL_CHECKER) || (op == CHANNEL_VOLUME_CHECKER)) {
            var odd = in_odd_field(vec2f(registers.uvw.x, registers.uvw.y));
            if (op == CHANNEL_VOLUME_CHECKER) {
                odd = in_odd_cube(registers.xyz);
            }
            registers = start_registers(at, shift, select(record.size, record.first, odd));
        } else if (op == CHANNEL_CALL) {
            shifts[u32(pending)] = vec4f(shift.x, shift.y, shift.z, weight);
            sums[u32(pending)] = sum;
            alphas[u32(pending)] = alpha_weight;
            origins[u32(pending)] = record_index;
            pending += 1u;
            sum = zero;
            weight = 1.0;
            registers = start_registers(at, shift, record.first);
        } else if (op == CHANNEL_BLEND) {
            let t = registers.xyz.x;
            let items = (record_index + 1u);
            let behind = first_item_behind_Buffers(scene, items, record.size, t);
            let upper = Buffers_channel(scene, (items + min(behind, (record.size - 1u))));
            var lower = upper;
            if ((behind > 0u) && (behind < record.size)) {
                lower = Buffers_channel(scene, ((items + behind) - 1u));
                let share = ((t - lower.value.x) / (upper.value.x - lower.value.x));
                shifts[u32(pending)] = vec4f(shift.x, shift.y, shift.z, (weight * share));
                alphas[u32(pending)] = (alpha_weight * share);
                origins[u32(pending)] = (items + behind);
                pending += 1u;
                weight *= (1.0 - share);
                alpha_weight *= (1.0 - share);
            }
            registers = start_registers(at, shift, lower.first);
        } else if (op == CHANNEL_FILTER) {
            sum.w += alpha_weight;
            shifts[u32(pending)] = vec4f(shift.x, shift.y, shift.z, weight);
            alphas[u32(pending)] = 0.0;
            origins[u32(pending)] = record_index;
            counts[u32(pending)] = 0u;
            pending += 1u;
            ended = true;
        } else if (op < CHANNEL_TURBULENCE) {
            registers = change_coordinates_Buffers(scene, record, at.world, registers);
        } else {
            registers = compute_number_Buffers(scene, record, registers);
        }
        if (ended && (pending == 0u)) {
            running = false;
        } else if ended {
            let top = (pending - 1u);
            let origin_index = origins[u32(top)];
            let origin = Buffers_channel(scene, origin_index);
            let aside = shifts[u32(top)];
            shift = vec3f(aside.x, aside.y, aside.z);
            weight = aside.w;
            alpha_weight = alphas[u32(top)];
            if (origin.operation == CHANNEL_CALL) {
                let found = vec3f(sum.x, sum.y, sum.z);
                registers.uvw = found;
                registers.xyz = found;
                registers.next = (origin_index + 1u);
                sum = sums[u32(top)];
                pending = top;
            } else {
                let number = counts[u32(top)];
                if ((origin.operation == CHANNEL_FILTER) && ((number + 1u) < origin.size)) {
                    counts[u32(top)] = (number + 1u);
                } else {
                    pending = top;
                }
                if (origin.operation == CHANNEL_FILTER) {
                    let neighbour = filter_neighbour(origin.size, number);
                    let step = vec3f(origin.value.x, origin.value.y, origin.value.z);
                    shift += (step * vec3f(neighbour.x, neighbour.y, neighbour.z));
                    weight *= neighbour.w;
                }
                registers = start_registers(at, shift, origin.first);
            }
        }
    }
    return sum;
}

struct Bsdf {
    diffuse: vec3f,
    diffuse_transmission: vec3f,
    glossy: vec3f,
    exponent: f32,
    glossy_transmission: vec3f,
    transmission_exponent: f32,
    straight: vec3f,
    emissive: vec3f,
    eta: f32
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

fn clear_transmission(material: MaterialRecord, transparency: vec4f, alpha: f32) -> vec3f {
    let cover = (alpha * material.opacity);
    let tau = clamp(vec3f(transparency.x, transparency.y, transparency.z), vec3f(0.0, 0.0, 0.0), vec3f(1.0, 1.0, 1.0));
    return (vec3f((1.0 - cover), (1.0 - cover), (1.0 - cover)) + (tau * cover));
}
const MATERIAL_CHANNELS: u32 = 7u;
const PASSING_CHANNELS: u32 = 2u;

fn material_channel(material: MaterialRecord, number: u32) -> u32 {
    if (number == 0u) {
        return material.diffuse;
    }
    if (number == 1u) {
        return material.transparency;
    }
    if (number == 2u) {
        return material.specular;
    }
    if (number == 3u) {
        return material.diffuse_transparency;
    }
    if (number == 4u) {
        return material.emissive;
    }
    if (number == 5u) {
        return material.shininess;
    }
    return material.transparency_shininess;
}

fn missing_channel(number: u32) -> vec4f {
    if (number == 0u) {
        return vec4f(0.5, 0.5, 0.5, 1.0);
    }
    return vec4f(0.0, 0.0, 0.0, 1.0);
}

fn undisturbed_part(material: MaterialRecord, tau: vec3f, alpha: f32) -> vec3f {
    if (material.transparency_shininess != NONE) {
        let clear = clamp((1.0 - (alpha * material.opacity)), 0.0, 1.0);
        return vec3f(clear, clear, clear);
    }
    return clamp(tau, vec3f(0.0, 0.0, 0.0), vec3f(1.0, 1.0, 1.0));
}

fn lambertian_bsdf(reflected: vec3f, transmitted: vec3f) -> Bsdf {
    let zero = vec3f(0.0, 0.0, 0.0);
    let diffuse = max(reflected, zero);
    let diffuse_transmission = max(transmitted, zero);
    let scale = (1.0 / max(largest((diffuse + diffuse_transmission)), 1.0));
    return Bsdf((diffuse * scale), (diffuse_transmission * scale), zero, MIRROR_EXPONENT, zero, MIRROR_EXPONENT, zero, zero, 1.0);
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
        let along = dot(refracted_direction(bsdf.eta, normal, wo), wi);
        value += (bsdf.glossy_transmission * glossy_value(along, bsdf.transmission_exponent, -cos_i, cos_o));
    }
    return (value * (bsdf.eta * bsdf.eta));
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
        let along = dot(refracted_direction(bsdf.eta, normal, wo), wi);
        pdf += (chance.w * power_cosine_pdf(along, bsdf.transmission_exponent));
    }
    return pdf;
}

fn transmits(bsdf: Bsdf) -> bool {
    let blurred = (bsdf.transmission_exponent < MIRROR_EXPONENT);
    return ((largest(bsdf.diffuse_transmission) > 0.0) || (blurred && (largest(bsdf.glossy_transmission) > 0.0)));
}

fn sample_bsdf(bsdf: Bsdf, normal: vec3f, wo: vec3f, u: vec2f) -> BsdfSample {
    let chance = lobe_probabilities(bsdf);
    var sample = BsdfSample(normal, vec3f(0.0, 0.0, 0.0), 0.0, EVENT_ABSORBED);
    let up_to_glossy = (chance.x + chance.y);
    let up_to_diffuse_transmission = (up_to_glossy + chance.z);
    let up_to_glossy_transmission = (up_to_diffuse_transmission + chance.w);
    if (u.x < chance.x) {
        let within = vec2f(stretched(u.x, 0.0, chance.x), u.y);
        sample.direction = around_axis(normal, cosine_hemisphere(within));
    } else if (u.x < up_to_glossy) {
        let mirrored = reflect(-wo, normal);
        if (bsdf.exponent >= MIRROR_EXPONENT) {
            sample.direction = mirrored;
            sample.weight = (bsdf.glossy * (1.0 / chance.y));
            sample.event = EVENT_MIRRORED;
            return sample;
        }
        let within = vec2f(stretched(u.x, chance.x, chance.y), u.y);
        sample.direction = around_axis(mirrored, power_cosine(within, bsdf.exponent));
        if (dot(sample.direction, normal) <= 0.0) {
            return sample;
        }
    } else if (u.x < up_to_diffuse_transmission) {
        let within = vec2f(stretched(u.x, up_to_glossy, chance.z), u.y);
        sample.direction = around_axis(-normal, cosine_hemisphere(within));
    } else if (u.x < up_to_glossy_transmission) {
        let onwards = refracted_direction(bsdf.eta, normal, wo);
        if (bsdf.transmission_exponent >= MIRROR_EXPONENT) {
            sample.direction = onwards;
            sample.weight = (bsdf.glossy_transmission * ((bsdf.eta * bsdf.eta) / chance.w));
            sample.event = EVENT_MIRRORED;
            return sample;
        }
        let within = vec2f(stretched(u.x, up_to_diffuse_transmission, chance.w), u.y);
        sample.direction = around_axis(onwards, power_cosine(within, bsdf.transmission_exponent));
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

fn is_lambertian_Buffers(scene: Buffers, material: MaterialRecord) -> bool {
    return (!has_Buffers(scene, FEATURE_LOBES) || ((material.flags & MATERIAL_LAMBERTIAN) != 0u));
}

fn material_bsdf_Buffers(
    scene: Buffers,
    material: MaterialRecord,
    at: TexturePoint,
    eta: f32,
    cosine: f32,
) -> Bsdf {
    if ((material.flags & MATERIAL_UNIFORM) != 0u) {
        return lambertian_bsdf(material.diffuse_color, material.transmitted_color);
    }
    let none = vec4f(0.0, 0.0, 0.0, 0.0);
    var values: array<vec4f, 7> = array(none, none, none, none, none, none, none);
    let lambertian = is_lambertian_Buffers(scene, material);
    let step = select(1u, 3u, lambertian);
    for (var i = 0u; i < select(MATERIAL_CHANNELS, 2u, lambertian); i++) {
        let number = (i * step);
        let channel = material_channel(material, number);
        values[u32(number)] = channel_value_Buffers(scene, channel, at, missing_channel(number));
    }
    let c_d = values[0];
    if lambertian {
        let transmitted = vec3f(values[3].x, values[3].y, values[3].z);
        return lambertian_bsdf(vec3f(c_d.x, c_d.y, c_d.z), transmitted);
    }
    let tau = clear_transmission(material, values[1], c_d.w);
    let c_s = values[2];
    let c_dt = values[3];
    let emissive = values[4];
    let one = vec3f(1.0, 1.0, 1.0);
    let zero = vec3f(0.0, 0.0, 0.0);
    let interpolated = ((material.flags & MATERIAL_INTERPOLATED) != 0u);
    var diffuse = max(vec3f(c_d.x, c_d.y, c_d.z), zero);
    var glossy = max(vec3f(c_s.x, c_s.y, c_s.z), zero);
    var exponent = select(shininess_exponent(values[5].x), 4.0, (material.shininess == NONE));
    var transmission_exponent = shininess_exponent(values[6].x);
    let diffuse_transmission = max(vec3f(c_dt.x, c_dt.y, c_dt.z), zero);
    if interpolated {
        diffuse *= (one - tau);
        glossy *= (one - tau);
    }
    var straight = zero;
    var blurred = zero;
    if (material.refractive_index > 0.0) {
        let reflected = fresnel_reflectance(eta, cosine);
        let clear = clamp(tau, zero, one);
        blurred = (clear * (1.0 - reflected));
        if ((material.flags & MATERIAL_MIRRORS) != 0u) {
            glossy = (clear * reflected);
            exponent = MIRROR_EXPONENT;
        }
        if (material.specular != NONE) {
            glossy += (clear * reflected);
        }
        if (material.transparency_shininess == NONE) {
            transmission_exponent = MIRROR_EXPONENT;
        }
    } else {
        let opacity = max((1.0 - smallest(undisturbed_part(material, tau, c_d.w))), 1.0e-6);
        if (material.transparency_shininess == NONE) {
            let passed = smallest(tau);
            straight = max((tau - vec3f(passed, passed, passed)), zero);
        } else {
            let cut = (1.0 - clamp((c_d.w * material.opacity), 0.0, 1.0));
            blurred = max((tau - vec3f(cut, cut, cut)), zero);
        }
        if interpolated {
            diffuse *= (1.0 / opacity);
            glossy *= (1.0 / opacity);
        }
        straight *= (1.0 / opacity);
        blurred *= (1.0 / opacity);
    }
    let total = largest(((((diffuse + glossy) + diffuse_transmission) + straight) + blurred));
    let scale = (1.0 / max(total, 1.0));
    return Bsdf((diffuse * scale), (diffuse_transmission * scale), (glossy * scale), exponent, (blurred * scale), transmission_exponent, (straight * scale), max(vec3f(emissive.x, emissive.y, emissive.z), zero), eta);
}

fn passing_channels_Buffers(scene: Buffers, material: MaterialRecord) -> u32 {
    return select(PASSING_CHANNELS, 1u, is_lambertian_Buffers(scene, material));
}

fn sided_material_Buffers(scene: Buffers, index: u32, front: bool) -> MaterialRecord {
    let material = Buffers_material(scene, index);
    if ((!has_Buffers(scene, FEATURE_BACKS) || front) || (material.back == NONE)) {
        return material;
    }
    return Buffers_material(scene, material.back);
}

fn surface_transmittance_Buffers(scene: Buffers, material: MaterialRecord, at: TexturePoint, through_bodies: bool) -> vec3f {
    if ((has_Buffers(scene, FEATURE_MEDIA) && (material.refractive_index > 0.0)) && !through_bodies) {
        return vec3f(0.0, 0.0, 0.0);
    }
    let zero = vec4f(0.0, 0.0, 0.0, 0.0);
    var values: array<vec4f, 2> = array(zero, zero);
    for (var i = 0u; i < passing_channels_Buffers(scene, material); i++) {
        let channel = material_channel(material, i);
        values[u32(i)] = channel_value_Buffers(scene, channel, at, missing_channel(i));
    }
    let alpha = values[0].w;
    return undisturbed_part(material, clear_transmission(material, values[1], alpha), alpha);
}

struct Hit {
    shape: ShapeHit,
    object: u32,
    instance: u32
}
const MAX_BVH_DEPTH: u32 = 24u;
const MAX_HITS_PER_OBJECT: u32 = 4u;
const EVERY_SURFACE: u32 = 4294967295u;

fn inverse_direction(d: vec3f) -> vec3f {
    return vec3f((1.0 / away_from_zero(d.x)), (1.0 / away_from_zero(d.y)), (1.0 / away_from_zero(d.z)));
}
const SEARCH_HIT: u32 = 0u;
const SEARCH_LIGHT: u32 = 1u;
const SEARCH_LIGHT_THROUGH_BODIES: u32 = 2u;

struct Quest {
    purpose: u32,
    key: SampleKey,
    segment: u32
}

fn light_quest(purpose: u32) -> Quest {
    return Quest(purpose, independent_key(0u, 0u, 0u), 0u);
}

struct Found {
    hit: Hit,
    passed: vec3f
}

fn is_dark(color: vec3f) -> bool {
    return (((color.x <= 0.0) && (color.y <= 0.0)) && (color.z <= 0.0));
}

fn is_met(
    quest: Quest,
    attempt: u32,
    instance: u32,
    source: u32,
    triangle: u32,
    opacity: f32,
) -> bool {
    if (((opacity >= 1.0) || (opacity <= 0.0)) || (quest.segment == EVERY_SURFACE)) {
        return (opacity > 0.0);
    }
    let bits = pcg4d(vec4u(quest.key.pixel, quest.key.sample, (DIMENSION_OPACITY + source), (((quest.key.seed ^ (((quest.segment * MAX_HITS_PER_OBJECT) + attempt) * 2654435769u)) ^ (triangle * 2246822519u)) ^ ((instance + 1u) * 3266489917u))));
    return (unit_float(bits.x) < opacity);
}

fn closest_hit_Buffers(scene: Buffers, ray: Ray, key: SampleKey, segment: u32) -> Hit {
    return search_Buffers(scene, ray, NO_HIT, Quest(SEARCH_HIT, key, segment)).hit;
}

fn hit_texture_point_Buffers(
    scene: Buffers,
    instance: u32,
    index: u32,
    shape: ShapeRecord,
    material: MaterialRecord,
    ray: Ray,
    hit: ShapeHit,
) -> TexturePoint {
    let p = hit_point(shape, ray, hit);
    let surface = Buffers_surface(scene, index);
    let weights = texture_coordinates(shape, surface.v_scale, hit.face, p);
    let uv = attribute_uv_Buffers(scene, shape, surface, weights);
    return texture_point_Buffers(scene, instance, shape, surface, material, p, uv);
}

fn material_hit_Buffers(scene: Buffers, shape: ShapeRecord, ray: Ray, hit: ShapeHit) -> MaterialRecord {
    let material = Buffers_material(scene, shape.material);
    if (!has_Buffers(scene, FEATURE_BACKS) || (material.back == NONE)) {
        return material;
    }
    let outward = object_normal(shape, hit.face, hit_point(shape, ray, hit));
    let onwards = transform_vector(shape.object_from_world, ray.direction);
    if (dot(outward, onwards) <= 0.0) {
        return material;
    }
    return Buffers_material(scene, material.back);
}

fn meet_object_Buffers(
    scene: Buffers,
    instance: u32,
    index: u32,
    ray: Ray,
    quest: Quest,
    before: Found,
) -> Found {
    let shape = Buffers_shape(scene, index);
    var found = before;
    var t_min: f32 = 0.0;
    var attempt: u32 = 0u;
    while (attempt < MAX_HITS_PER_OBJECT) {
        let hit = intersect_shape(Buffers_features(scene), shape, ray, t_min, found.hit.shape.t);
        var goes_on = (hit.t < NO_HIT);
        if goes_on {
            var passes = vec3f(0.0, 0.0, 0.0);
            if (has_Buffers(scene, FEATURE_HOLES) && ((shape.kind & FLAG_NOT_OPAQUE) != 0u)) {
                let material = material_hit_Buffers(scene, shape, ray, hit);
                let at = hit_texture_point_Buffers(scene, instance, index, shape, material, ray, hit);
                let through_bodies = (quest.purpose == SEARCH_LIGHT_THROUGH_BODIES);
                passes = surface_transmittance_Buffers(scene, material, at, through_bodies);
                if (quest.purpose == SEARCH_HIT) {
                    let source = Buffers_surface(scene, index).source;
                    let opacity = (1.0 - smallest(passes));
                    let triangle = u32(shape.top_radius);
                    let met = is_met(quest, attempt, instance, source, triangle, opacity);
                    passes = select(vec3f(1.0, 1.0, 1.0), vec3f(0.0, 0.0, 0.0), met);
                }
            }
            goes_on = !is_dark(passes);
            if (quest.purpose != SEARCH_HIT) {
                found.passed *= passes;
            } else if !goes_on {
                found.hit = Hit(hit, index, instance);
            }
            t_min = hit.t;
        }
        attempt = select(MAX_HITS_PER_OBJECT, (attempt + 1u), goes_on);
    }
    return found;
}

fn search_Buffers(scene: Buffers, ray: Ray, t_max: f32, quest: Quest) -> Found {
    let header = Buffers_header(scene);
    let nothing = Hit(ShapeHit(t_max, 0u), NONE, NONE);
    var found = Found(nothing, vec3f(1.0, 1.0, 1.0));
    var instance = NONE;
    var local = ray;
    var inverse = inverse_direction(ray.direction);
    var order = visiting_order(inverse);
    var outside: u32 = 0u;
    var stacked: u32 = 0u;
    var children = vec2u(0u, 0u);
    if (header.nodes > 0u) {
        children = waiting_root(0u);
    }
    var unbounded: u32 = 0u;
    var searching = true;
    while searching {
        var objects: u32 = 0u;
        var leaves: u32 = 0u;
        var first_object: u32 = 0u;
        if any_waits(children) {
            var index = next_node(children, order);
            children = without_next(children);
            if any_waits(children) {
                stack_first[u32(stacked)] = children.x;
                stack_bits[u32(stacked)] = children.y;
                stacked += 1u;
            }
            if (has_Buffers(scene, (1u << SHAPE_INSTANCE)) && (Buffers_node(scene, index).exponents == NODE_INSTANCE)) {
                let entrance = Buffers_node(scene, index);
                instance = entrance.first_object;
                local = transform_ray(Buffers_shape(scene, instance).object_from_world, ray);
                inverse = inverse_direction(local.direction);
                order = visiting_order(inverse);
                outside = stacked;
                index = entrance.first_node;
            }
            let node = Buffers_node(scene, index);
            let reached = Buffers__1reached_children(scene, index, local.origin, inverse, found.hit.shape.t);
            children = waiting_children(node, reached, order);
            first_object = node.first_object;
            leaves = node.leaves;
            objects = (reached & leaves);
        }
        while ((objects != 0u) || (unbounded < header.unbounded_objects)) {
            var index = unbounded;
            if (unbounded < header.unbounded_objects) {
                unbounded += 1u;
            } else {
                index = (first_object + children_before(leaves, countTrailingZeros(objects)));
                objects &= (objects - 1u);
            }
            found = meet_object_Buffers(scene, instance, index, local, quest, found);
            if is_dark(found.passed) {
                objects = 0u;
                unbounded = header.unbounded_objects;
                children = vec2u(0u, 0u);
                stacked = 0u;
            }
        }
        if !any_waits(children) {
            if ((has_Buffers(scene, (1u << SHAPE_INSTANCE)) && (instance != NONE)) && (stacked == outside)) {
                instance = NONE;
                local = ray;
                inverse = inverse_direction(ray.direction);
                order = visiting_order(inverse);
            }
            if (stacked > 0u) {
                stacked -= 1u;
                children = vec2u(stack_first[u32(stacked)], stack_bits[u32(stacked)]);
            } else {
                searching = false;
            }
        }
    }
    return found;
}

fn shadow_transmittance_Buffers(scene: Buffers, ray: Ray, t_max: f32, through_bodies: bool) -> vec3f {
    let purpose = select(SEARCH_LIGHT, SEARCH_LIGHT_THROUGH_BODIES, through_bodies);
    return search_Buffers(scene, ray, t_max, light_quest(purpose)).passed;
}

struct SkyDirection {
    direction: vec3f,
    pdf: f32
}

fn to_light_axes(light: LightRecord, direction: vec3f) -> vec3f {
    return vec3f(dot(light.edge_u, direction), dot(light.edge_v, direction), dot(light.axis, direction));
}

fn out_of_light_axes(light: LightRecord, local: vec3f) -> vec3f {
    return normalize((((light.edge_u * local.x) + (light.edge_v * local.y)) + (light.axis * local.z)));
}

fn perez(a_to_d: vec4f, e: f32, over_cos: f32, gamma: f32) -> f32 {
    let cos_gamma = cos(gamma);
    return ((1.0 + (a_to_d.x * exp((a_to_d.y * over_cos)))) * ((1.0 + (a_to_d.z * exp((a_to_d.w * gamma)))) + ((e * cos_gamma) * cos_gamma)));
}

fn rgb_from_xyz(xyz: vec3f) -> vec3f {
    let rgb = vec3f((((3.2404542 * xyz.x) - (1.5371385 * xyz.y)) - (0.4985314 * xyz.z)), (((-0.9692660 * xyz.x) + (1.8760108 * xyz.y)) + (0.0415560 * xyz.z)), (((0.0556434 * xyz.x) - (0.2040259 * xyz.y)) + (1.0572252 * xyz.z)));
    let lack = max(0.0, -smallest(rgb));
    return (rgb + vec3f(lack, lack, lack));
}

fn is_in_sun(light: LightRecord, direction: vec3f) -> bool {
    let chord = (direction + light.axis);
    return (dot(chord, chord) <= (2.0 * light.cos_inner));
}

fn is_sky(kind: u32) -> bool {
    return (((kind == LIGHT_SKY) || (kind == LIGHT_SKY_MAP)) || (kind == LIGHT_DAYLIGHT));
}

fn uniform_sky_pdf(normal: vec3f, direction: vec3f, both_sides: bool) -> f32 {
    let cosine = dot(normal, direction);
    if both_sides {
        return ((0.5 * abs(cosine)) * INVERSE_PI);
    }
    return cosine_hemisphere_pdf(cosine);
}

fn sample_uniform_sky(normal: vec3f, both_sides: bool, u: vec2f) -> SkyDirection {
    var side = 1.0;
    var first = u.x;
    if both_sides {
        let behind = (first >= 0.5);
        first = stretched(first, select(0.0, 0.5, behind), 0.5);
        side = select(1.0, -1.0, behind);
    }
    let direction = around_axis((normal * side), cosine_hemisphere(vec2f(first, u.y)));
    return SkyDirection(direction, uniform_sky_pdf(normal, direction, both_sides));
}

fn sun_pdf(light: LightRecord) -> f32 {
    return (1.0 / (TWO_PI * light.cos_inner));
}

fn sample_sun(light: LightRecord, u: vec2f) -> SkyDirection {
    let versine = (u.x * light.cos_inner);
    let sine = sqrt((versine * (2.0 - versine)));
    let turned = on_circle(u.y);
    let local = vec3f((turned.x * sine), (turned.y * sine), (1.0 - versine));
    return SkyDirection(around_axis(-light.axis, local), sun_pdf(light));
}

fn background_radiance_Buffers(scene: Buffers, background: vec3f) -> vec3f {
    let lights = Buffers_header(scene).distant_lights;
    var radiance = background;
    for (var i = 0u; i < lights; i++) {
        if is_sky(Buffers_light(scene, i).kind) {
            radiance = vec3f(0.0, 0.0, 0.0);
        }
    }
    return radiance;
}

fn daylight_radiance_Buffers(scene: Buffers, program: u32, local: vec3f) -> vec3f {
    if (local.z < 0.0) {
        return vec3f(0.0, 0.0, 0.0);
    }
    let sun = Buffers_attribute(scene, program);
    let e = Buffers_attribute(scene, (program + 4u));
    let zenith = Buffers_attribute(scene, (program + 5u));
    let gamma = acos(clamp(dot(vec3f(sun.x, sun.y, sun.z), local), -1.0, 1.0));
    let over_cos = (1.0 / max(local.z, 0.001));
    let luminance = (zenith.x * perez(Buffers_attribute(scene, (program + 1u)), e.x, over_cos, gamma));
    let x = (zenith.y * perez(Buffers_attribute(scene, (program + 2u)), e.y, over_cos, gamma));
    let y = (zenith.z * perez(Buffers_attribute(scene, (program + 3u)), e.z, over_cos, gamma));
    let scale = (max(luminance, 0.0) / max(y, 1.0e-3));
    return rgb_from_xyz(vec3f((x * scale), max(luminance, 0.0), (((1.0 - x) - y) * scale)));
}

fn distant_radiance_Buffers(scene: Buffers, light: LightRecord, direction: vec3f) -> vec3f {
    if (light.kind == LIGHT_SKY) {
        return light.emission;
    }
    if (light.kind == LIGHT_SUN) {
        if is_in_sun(light, direction) {
            return light.emission;
        }
        return vec3f(0.0, 0.0, 0.0);
    }
    let tables = has_Buffers(scene, FEATURE_LIGHT_TABLES);
    if (tables && ((light.kind == LIGHT_SKY_MAP) || (light.kind == LIGHT_DAYLIGHT))) {
        let local = to_light_axes(light, direction);
        if (light.kind == LIGHT_DAYLIGHT) {
            return daylight_radiance_Buffers(scene, light.program, local);
        }
        let uv = vec2f(turn_fraction(local), (acos(clamp(-local.z, -1.0, 1.0)) * INVERSE_PI));
        let at = TexturePoint(uv, local, direction);
        let color = channel_value_Buffers(scene, light.program, at, vec4f(0.0, 0.0, 0.0, 1.0));
        return (light.emission * max(vec3f(color.x, color.y, color.z), vec3f(0.0, 0.0, 0.0)));
    }
    return vec3f(0.0, 0.0, 0.0);
}

fn find_interval_Buffers(scene: Buffers, first: u32, count: u32, u: f32) -> u32 {
    var low: u32 = 0u;
    var high = (count - 1u);
    while (low < high) {
        let middle = ((low + high) / 2u);
        if (Buffers_attribute(scene, (first + middle)).y > u) {
            high = middle;
        } else {
            low = (middle + 1u);
        }
    }
    return low;
}

fn sample_table_Buffers(scene: Buffers, light: LightRecord, u: vec2f) -> SkyDirection {
    let columns = (light.count & 65535u);
    let rows = (light.count >> 16u);
    let row = find_interval_Buffers(scene, light.first, rows, u.x);
    let band = Buffers_attribute(scene, (light.first + row));
    let cells = ((light.first + rows) + (row * columns));
    let column = find_interval_Buffers(scene, cells, columns, u.y);
    let cell = Buffers_attribute(scene, (cells + column));
    let down = clamp(((u.x - band.x) / max((band.y - band.x), 1.0e-20)), 0.0, 1.0);
    let along = clamp(((u.y - cell.x) / max((cell.y - cell.x), 1.0e-20)), 0.0, 1.0);
    let z = (1.0 - ((2.0 * (f32(row) + down)) / f32(rows)));
    let local = polar_direction(clamp(z, -1.0, 1.0), ((f32(column) + along) / f32(columns)));
    return SkyDirection(out_of_light_axes(light, local), cell.z);
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
    let shape = Buffers_shape(scene, hit.object);
    let surface = Buffers_surface(scene, hit.object);
    let v_scale = surface.v_scale;
    if (!has_Buffers(scene, (1u << SHAPE_INSTANCE)) || (hit.instance == NONE)) {
        let object_from_world = shape.object_from_world;
        let world_from_object = surface.world_from_object;
        let flat_point = surface_point(shape, v_scale, object_from_world, world_from_object, ray, hit.shape);
        let normal = attribute_normal_Buffers(scene, shape, surface, flat_point);
        return with_attributes_Buffers(scene, shape, surface, flat_point, normal);
    }
    let group_from_world = Buffers_shape(scene, hit.instance).object_from_world;
    let world_from_group = Buffers_surface(scene, hit.instance).world_from_object;
    let object_from_world = compose(shape.object_from_world, group_from_world);
    let world_from_object = compose(world_from_group, surface.world_from_object);
    var flat_point = surface_point(shape, v_scale, object_from_world, world_from_object, ray, hit.shape);
    flat_point.error = ((2.0 * flat_point.error) + placement_error(group_from_world, world_from_group, flat_point));
    let normal = transform_transposed(group_from_world, attribute_normal_Buffers(scene, shape, surface, flat_point));
    return with_attributes_Buffers(scene, shape, surface, flat_point, normal);
}

fn hit_unit_point_Buffers(scene: Buffers, ray: Ray, hit: Hit) -> vec3f {
    var local = ray;
    if (has_Buffers(scene, (1u << SHAPE_INSTANCE)) && (hit.instance != NONE)) {
        local = transform_ray(Buffers_shape(scene, hit.instance).object_from_world, ray);
    }
    return hit_point(Buffers_shape(scene, hit.object), local, hit.shape);
}

fn normal_map_covers(normal_map: ChannelRecord, uv: vec2f) -> bool {
    let on_box_top = ((((uv.x >= 0.25) && (uv.x <= 0.5)) && (uv.y >= 0.33333333)) && (uv.y <= 0.66666667));
    return ((normal_map.size == 0u) || on_box_top);
}

fn height_slopes_Buffers(
    scene: Buffers,
    normal_map: ChannelRecord,
    at: TexturePoint,
    local: Tangents,
    world: Tangents,
) -> vec2f {
    var slopes = vec2f(0.0, 0.0);
    for (var k = 0; k < 4; k++) {
        let along_u = (k < 2);
        let forward = select(-1.0, 1.0, ((k % 2) == 0));
        var step = (forward * normal_map.value.z);
        var shifted = at;
        if along_u {
            step = (forward * normal_map.value.y);
            shifted.uv = vec2f((at.uv.x + step), at.uv.y);
            shifted.local = (at.local + (local.du * step));
            shifted.world = (at.world + (world.du * step));
        } else {
            shifted.uv = vec2f(at.uv.x, (at.uv.y + step));
            shifted.local = (at.local + (local.dv * step));
            shifted.world = (at.world + (world.dv * step));
        }
        let height = channel_value_Buffers(scene, normal_map.first, shifted, vec4f(0.0, 0.0, 0.0, 1.0));
        let part = (height.x / (2.0 * step));
        slopes += select(vec2f(0.0, part), vec2f(part, 0.0), vec2<bool>(along_u, along_u));
    }
    return slopes;
}

fn with_normal_maps_Buffers(
    scene: Buffers,
    hit: Hit,
    material: MaterialRecord,
    p: vec3f,
    at: TexturePoint,
    point: SurfacePoint,
) -> SurfacePoint {
    if (material.normal_map == NONE) {
        return point;
    }
    let shape = Buffers_shape(scene, hit.object);
    let surface = Buffers_surface(scene, hit.object);
    let unit = unit_tangents_Buffers(scene, shape, surface, hit.shape.face, p);
    let world = transform_tangents(world_from_unit_Buffers(scene, hit.instance, surface), unit);
    var local = unit;
    if ((material.flags & MATERIAL_USES_POSITION) != 0u) {
        local = transform_tangents(local_from_unit_Buffers(scene, shape, surface), unit);
    }
    var normal = point.shading_normal;
    var du = world.du;
    var dv = world.dv;
    var index = material.normal_map;
    while (index != NONE) {
        let normal_map = Buffers_channel(scene, index);
        index = normal_map.mode;
        if normal_map_covers(normal_map, at.uv) {
            let slopes = (height_slopes_Buffers(scene, normal_map, at, local, world) * normal_map.value.x);
            du += (normal * (slopes.x - dot(du, normal)));
            dv += (normal * (slopes.y - dot(dv, normal)));
            let bent = cross(du, dv);
            let squared = dot(bent, bent);
            if (squared > 0.0) {
                let outward = select(-1.0, 1.0, (dot(bent, normal) >= 0.0));
                normal = (bent * (outward / sqrt(squared)));
            }
        }
    }
    var result = point;
    if (dot(normal, point.normal) > 0.0) {
        result.shading_normal = normal;
    }
    return result;
}

struct ShadingPoint {
    point: SurfacePoint,
    material: MaterialRecord,
    at: TexturePoint,
    normal: vec3f,
    cos_front: f32,
    body: u32
}

fn shading_point_Buffers(scene: Buffers, ray: Ray, hit: Hit) -> ShadingPoint {
    let shape = Buffers_shape(scene, hit.object);
    let surface = Buffers_surface(scene, hit.object);
    var point = hit_surface_Buffers(scene, ray, hit);
    let wo = -ray.direction;
    let cos_front = dot(point.normal, wo);
    let material = sided_material_Buffers(scene, shape.material, (cos_front >= 0.0));
    var at = uv_point(point.uv);
    let looks_at_position = (((material.flags & MATERIAL_USES_POSITION) != 0u) || (material.normal_map != NONE));
    if (has_Buffers(scene, FEATURE_POSITIONS) && looks_at_position) {
        let p = hit_unit_point_Buffers(scene, ray, hit);
        at = texture_point_Buffers(scene, hit.instance, shape, surface, material, p, point.uv);
        point = with_normal_maps_Buffers(scene, hit, material, p, at, point);
    }
    let normal = facing_normal(point, wo);
    let body = (surface.source ^ ((hit.instance + 1u) * 2654435769u));
    return ShadingPoint(point, material, at, normal, cos_front, body);
}

struct LightSample {
    direction: vec3f,
    distance: f32,
    weight: vec3f,
    pdf: f32
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

fn area_pdf(light: LightRecord, squared_distance: f32, cos_light: f32) -> f32 {
    return (squared_distance / max((abs(cos_light) * light.cos_outer), 1.0e-20));
}

fn no_light() -> LightSample {
    return LightSample(vec3f(0.0, 0.0, 1.0), 0.0, vec3f(0.0, 0.0, 0.0), 0.0);
}

fn sample_plain_light(
    light: LightRecord,
    point: vec3f,
    normal: vec3f,
    both_sides: bool,
    u: vec2f,
) -> LightSample {
    if (light.kind == LIGHT_DIRECTIONAL) {
        return LightSample(-light.axis, NO_HIT, light.emission, 0.0);
    }
    if ((light.kind == LIGHT_SKY) || (light.kind == LIGHT_SUN)) {
        var sky = sample_sun(light, u);
        if (light.kind == LIGHT_SKY) {
            sky = sample_uniform_sky(normal, both_sides, u);
        }
        return from_sky(sky, light.emission);
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

fn from_sky(sky: SkyDirection, radiance: vec3f) -> LightSample {
    if (sky.pdf <= 0.0) {
        return no_light();
    }
    return LightSample(sky.direction, NO_HIT, (radiance * (1.0 / sky.pdf)), sky.pdf);
}

fn distribution_density_Buffers(scene: Buffers, light: LightRecord, direction: vec3f) -> f32 {
    let columns = (light.count & 65535u);
    let rows = (light.count >> 16u);
    let local = to_light_axes(light, direction);
    let x = ((acos(clamp(local.z, -1.0, 1.0)) * INVERSE_PI) * f32(columns));
    let turn = (turn_fraction(local) + 0.5);
    let y = ((turn - floor(turn)) * f32(rows));
    let column = min(u32(x), (columns - 1u));
    let row = min(u32(y), (rows - 1u));
    let wx = clamp((x - f32(column)), 0.0, 1.0);
    let wy = clamp((y - f32(row)), 0.0, 1.0);
    let corners = Buffers_attribute(scene, ((light.first + (row * columns)) + column));
    let near = ((corners.x * (1.0 - wx)) + (corners.y * wx));
    let far = ((corners.z * (1.0 - wx)) + (corners.w * wx));
    return ((near * (1.0 - wy)) + (far * wy));
}

fn sample_light_Buffers(
    scene: Buffers,
    light: LightRecord,
    point: vec3f,
    normal: vec3f,
    both_sides: bool,
    u: vec2f,
) -> LightSample {
    let tables = has_Buffers(scene, FEATURE_LIGHT_TABLES);
    if (tables && ((light.kind == LIGHT_SKY_MAP) || (light.kind == LIGHT_DAYLIGHT))) {
        let sky = sample_table_Buffers(scene, light, u);
        return from_sky(sky, distant_radiance_Buffers(scene, light, sky.direction));
    }
    var sample = sample_plain_light(light, point, normal, both_sides, u);
    if (tables && (light.kind == LIGHT_PHYSICAL)) {
        sample.weight *= distribution_density_Buffers(scene, light, -sample.direction);
    }
    return sample;
}

struct TracedLight {
    radiance: vec3f,
    rays: u32
}

struct LocalMaterial {
    emissive: vec3f,
    ambient: vec3f,
    diffuse: vec3f,
    diffuse_transmission: vec3f,
    specular: vec3f,
    exponent: f32,
    mirrored: vec3f,
    passed: vec3f
}

struct ViewedPoint {
    point: SurfacePoint,
    normal: vec3f,
    wo: vec3f
}
const LOCAL_CHANNELS: u32 = 8u;
const DIMENSION_SHADOW: u32 = 1073741824u;
const LAMP_END: f32 = 0.9999;

fn lambert(material: LocalMaterial, normal: vec3f, direction: vec3f) -> vec3f {
    let cosine = dot(normal, direction);
    if (cosine >= 0.0) {
        return (material.diffuse * cosine);
    }
    return (material.diffuse_transmission * (-cosine));
}

fn local_illumination(material: LocalMaterial, normal: vec3f, wo: vec3f, direction: vec3f) -> vec3f {
    let value = lambert(material, normal, direction);
    if ((dot(normal, direction) <= 0.0) || (material.exponent >= MIRROR_EXPONENT)) {
        return value;
    }
    let across = (wo + direction);
    let along = (dot(normal, across) / sqrt(max(dot(across, across), 1.0e-20)));
    return (value + (material.specular * pow(clamp(along, 1.0e-6, 1.0), material.exponent)));
}

fn attenuation(exponent: f32, reference: f32, distance: f32) -> f32 {
    if ((exponent <= 0.0) || (reference <= 0.0)) {
        return 1.0;
    }
    return (2.0 / (1.0 + pow((distance / reference), exponent)));
}

fn spread_point(i: u32, count: u32, shift: vec2f) -> vec2f {
    let u = ((f32(i) / f32(count)) + shift.x);
    let v = (unit_float((i * 2654435769u)) + shift.y);
    return vec2f(min((u - floor(u)), 0.99999994), min((v - floor(v)), 0.99999994));
}

fn lamp_light_Buffers(scene: Buffers, light: LightRecord, point: vec3f) -> LightSample {
    if ((light.kind == LIGHT_DIRECTIONAL) || (light.kind == LIGHT_SUN)) {
        let solid_angle = select(1.0, (TWO_PI * light.cos_inner), (light.kind == LIGHT_SUN));
        return LightSample(-light.axis, NO_HIT, (light.emission * (solid_angle * INVERSE_PI)), 0.0);
    }
    let is_area = (light.kind == LIGHT_AREA);
    let to_lamp = ((light.position + (light.edge_v * select(0.0, 0.5, is_area))) - point);
    let distance = sqrt(dot(to_lamp, to_lamp));
    if (distance < 1.0e-10) {
        return no_light();
    }
    let direction = (to_lamp * (1.0 / distance));
    let cos_light = -dot(direction, light.axis);
    var intensity = light.emission;
    var fading = vec2f(light.edge_u.x, light.edge_u.y);
    if is_area {
        intensity = (area_radiance(light, cos_light) * (max(cos_light, 0.0) * light.cos_outer));
        fading = vec2f(0.0, 0.0);
    } else if (light.kind == LIGHT_SPOT) {
        intensity *= spot_profile(cos_light, light.cos_inner, light.cos_outer);
    } else if (light.kind == LIGHT_PHYSICAL) {
        intensity *= distribution_density_Buffers(scene, light, -direction);
        fading = vec2f(light.cos_inner, light.cos_outer);
    }
    let weight = (intensity * (attenuation(fading.x, fading.y, distance) * INVERSE_PI));
    return LightSample(direction, distance, weight, 0.0);
}

fn lit_radiance_Buffers(
    scene: Buffers,
    settings: LaunchSettings,
    key: SampleKey,
    step: u32,
    viewed: ViewedPoint,
    material: LocalMaterial,
) -> TracedLight {
    let point = viewed.point;
    let normal = viewed.normal;
    let wo = viewed.wo;
    var result = TracedLight(vec3f(0.0, 0.0, 0.0), 0u);
    let transmits_light = (largest(material.diffuse_transmission) > 0.0);
    let lights = Buffers_header(scene).all_lights;
    for (var index = 0u; index < lights; index++) {
        let light = Buffers_light(scene, index);
        if ((light.kind != LIGHT_GROUP) && (light.importance > 0.0)) {
            let sky = is_sky(light.kind);
            let has_shadow = (light.shadowless == 0u);
            let soft = (sky || (has_shadow && (light.kind == LIGHT_AREA)));
            var lamp = no_light();
            var scattered = vec3f(0.0, 0.0, 0.0);
            var rays: u32 = 1u;
            if soft {
                rays = settings.shadow_samples;
            }
            if !sky {
                lamp = lamp_light_Buffers(scene, light, point.position);
                scattered = (local_illumination(material, normal, wo, lamp.direction) * lamp.weight);
                if is_dark(scattered) {
                    rays = 0u;
                }
            }
            var shift = vec4f(0.0, 0.0, 0.0, 0.0);
            if (soft && (rays > 0u)) {
                shift = random4(key, ((DIMENSION_SHADOW + (step << 16u)) + index));
            }
            var arrived = vec3f(0.0, 0.0, 0.0);
            for (var i = 0u; i < rays; i++) {
                var direction = lamp.direction;
                var distance = lamp.distance;
                var share = scattered;
                if soft {
                    let u = spread_point(i, rays, vec2f(shift.x, shift.y));
                    let sample = sample_light_Buffers(scene, light, point.position, normal, transmits_light, u);
                    direction = sample.direction;
                    distance = sample.distance;
                    if sky {
                        share = ((lambert(material, normal, direction) * sample.weight) * INVERSE_PI);
                    } else if ((dot(normal, direction) * dot(normal, lamp.direction)) <= 0.0) {
                        share = vec3f(0.0, 0.0, 0.0);
                    }
                }
                if (!is_dark(share) && same_side(point, normal, wo, direction)) {
                    var open = vec3f(1.0, 1.0, 1.0);
                    if has_shadow {
                        let ray = Ray(offset_origin(point, direction), direction);
                        let end = select(NO_HIT, (distance * LAMP_END), (distance < NO_HIT));
                        open = shadow_transmittance_Buffers(scene, ray, end, true);
                        result.rays += 1u;
                    }
                    arrived += (share * open);
                }
            }
            if (rays > 0u) {
                result.radiance += (arrived * (1.0 / f32(rays)));
            }
        }
    }
    return result;
}

fn local_material_Buffers(
    scene: Buffers,
    material: MaterialRecord,
    at: TexturePoint,
    eta: f32,
    cosine: f32,
) -> LocalMaterial {
    let none = vec4f(0.0, 0.0, 0.0, 0.0);
    var values: array<vec4f, 8> = array(none, none, none, none, none, none, none, none);
    for (var i = 0u; i < LOCAL_CHANNELS; i++) {
        var channel = material.ambient;
        if (i < MATERIAL_CHANNELS) {
            channel = material_channel(material, i);
        }
        values[u32(i)] = channel_value_Buffers(scene, channel, at, missing_channel(i));
    }
    let c_d = values[0];
    let c_s = values[2];
    let c_dt = values[3];
    let c_e = values[4];
    let c_a = values[7];
    let zero = vec3f(0.0, 0.0, 0.0);
    let one = vec3f(1.0, 1.0, 1.0);
    let tau = clamp(clear_transmission(material, values[1], c_d.w), zero, one);
    var met: f32 = 1.0;
    var passed = tau;
    var fresnel = zero;
    if (material.refractive_index > 0.0) {
        let reflected = fresnel_reflectance(eta, cosine);
        passed = (tau * (1.0 - reflected));
        if (((material.flags & MATERIAL_MIRRORS) != 0u) || (material.specular != NONE)) {
            fresnel = (tau * reflected);
        }
    } else {
        met = (1.0 - smallest(undisturbed_part(material, tau, c_d.w)));
    }
    var kept = vec3f(met, met, met);
    if ((material.flags & MATERIAL_INTERPOLATED) != 0u) {
        kept = (one - tau);
    }
    let specular = (max(vec3f(c_s.x, c_s.y, c_s.z), zero) * kept);
    return LocalMaterial((max(vec3f(c_e.x, c_e.y, c_e.z), zero) * met), (max(vec3f(c_a.x, c_a.y, c_a.z), zero) * met), (max(vec3f(c_d.x, c_d.y, c_d.z), zero) * kept), (max(vec3f(c_dt.x, c_dt.y, c_dt.z), zero) * met), specular, select(shininess_exponent(values[5].x), 4.0, (material.shininess == NONE)), (specular + fresnel), passed);
}

struct PendingRay {
    origin: vec3f,
    direction: vec3f,
    weight: vec3f,
    touched: u32,
    media: Media
}
const MOST_PENDING: u32 = 12u;
const LEAST_WEIGHT: f32 = 0.00390625;
const MOST_RAYS: u32 = 512u;

fn beyond_radiance_Buffers(scene: Buffers, background: vec3f, direction: vec3f) -> vec3f {
    let lights = Buffers_header(scene).distant_lights;
    var sum = background_radiance_Buffers(scene, background);
    for (var i = 0u; i < lights; i++) {
        sum += distant_radiance_Buffers(scene, Buffers_light(scene, i), direction);
    }
    return sum;
}

fn trace_rays_Buffers(scene: Buffers, settings: LaunchSettings, key: SampleKey, first: Ray) -> TracedLight {
    let header = Buffers_header(scene);
    let zero = vec3f(0.0, 0.0, 0.0);
    var result = TracedLight(zero, 0u);
    let none = PendingRay(zero, zero, zero, 0u, empty_space());
    var pending: array<PendingRay, 12> = array(none, none, none, none, none, none, none, none, none, none, none, none);
    var waiting: u32 = 0u;
    var current = none;
    current.origin = first.origin;
    current.direction = first.direction;
    current.weight = vec3f(1.0, 1.0, 1.0);
    for (var step = 0u; step < MOST_RAYS; step++) {
        let ray = Ray(current.origin, current.direction);
        let hit = closest_hit_Buffers(scene, ray, key, EVERY_SURFACE);
        result.rays += 1u;
        var mirrored = none;
        var passed = none;
        if (hit.object == NONE) {
            result.radiance += (current.weight * beyond_radiance_Buffers(scene, settings.background, ray.direction));
        } else {
            let surface = Buffers_surface(scene, hit.object);
            let met = shading_point_Buffers(scene, ray, hit);
            let point = met.point;
            let record = met.material;
            let normal = met.normal;
            let wo = -ray.direction;
            let front = (met.cos_front >= 0.0);
            let refracts = (record.refractive_index > 0.0);
            let outside = leave_medium(current.media, met.body);
            var eta: f32 = 1.0;
            if refracts {
                let inside = record.refractive_index;
                eta = select((inside / outside.indices.x), (outside.indices.x / inside), front);
            }
            let material = local_material_Buffers(scene, record, met.at, eta, dot(normal, wo));
            var seen = material.emissive;
            if (surface.light != NONE) {
                seen += area_radiance(Buffers_light(scene, surface.light), met.cos_front);
            }
            let goes_on = (current.touched < settings.depth);
            if goes_on {
                seen += ((material.ambient * header.ambient) * INVERSE_PI);
                let viewed = ViewedPoint(point, normal, wo);
                let lit = lit_radiance_Buffers(scene, settings, key, step, viewed, material);
                seen += lit.radiance;
                result.rays += lit.rays;
                let direction = reflect(-wo, normal);
                if same_side(point, normal, wo, direction) {
                    mirrored = PendingRay(offset_origin(point, direction), direction, (current.weight * material.mirrored), (current.touched + 1u), current.media);
                }
            }
            result.radiance += (current.weight * seen);
            if !refracts {
                passed = current;
                passed.weight = (current.weight * material.passed);
                passed.origin = offset_origin(point, ray.direction);
            } else if goes_on {
                let direction = refracted_direction(eta, normal, wo);
                var media = outside;
                if front {
                    media = enter_medium(current.media, met.body, record.refractive_index);
                }
                passed = PendingRay(offset_origin(point, direction), direction, (current.weight * material.passed), (current.touched + 1u), media);
            }
        }
        let mirrored_weight = largest(mirrored.weight);
        let passed_weight = largest(passed.weight);
        var weaker = passed;
        if (mirrored_weight >= passed_weight) {
            current = mirrored;
        } else {
            current = passed;
            weaker = mirrored;
        }
        let weaker_weight = min(mirrored_weight, passed_weight);
        if (weaker_weight >= LEAST_WEIGHT) {
            var place = waiting;
            if (waiting < MOST_PENDING) {
                waiting += 1u;
            } else {
                var least = weaker_weight;
                for (var i = 0u; i < MOST_PENDING; i++) {
                    let weight = largest(pending[u32(i)].weight);
                    if (weight < least) {
                        least = weight;
                        place = i;
                    }
                }
            }
            if (place < MOST_PENDING) {
                pending[u32(place)] = weaker;
            }
        }
        if (max(mirrored_weight, passed_weight) < LEAST_WEIGHT) {
            if (waiting == 0u) {
                return result;
            }
            waiting -= 1u;
            current = pending[u32(waiting)];
        }
    }
    return result;
}

struct LightChoice {
    index: u32,
    probability: f32,
    left: f32
}

fn group_importance(group: LightRecord, point: vec3f) -> f32 {
    let way = (point - group.position);
    let squared = dot(way, way);
    if ((group.cos_outer < 3.1) && (squared > group.cos_inner)) {
        let distance = sqrt(squared);
        let angle = acos(clamp((dot(way, group.axis) / distance), -1.0, 1.0));
        let spread = asin(clamp((sqrt(group.cos_inner) / distance), 0.0, 1.0));
        if ((angle - spread) > group.cos_outer) {
            return 0.0;
        }
    }
    return (group.importance / max(max(squared, (0.25 * group.cos_inner)), 1.0e-20));
}

fn light_importance(light: LightRecord, point: vec3f) -> f32 {
    if (light.kind == LIGHT_GROUP) {
        return group_importance(light, point);
    }
    if (light.kind == LIGHT_AREA) {
        let from_light = (point - (light.position + (light.edge_v * 0.5)));
        if (dot(from_light, light.axis) <= 0.0) {
            return 0.0;
        }
        return (light.importance / (dot(from_light, from_light) + light.cos_outer));
    }
    if (((light.kind == LIGHT_POINT) || (light.kind == LIGHT_SPOT)) || (light.kind == LIGHT_PHYSICAL)) {
        let from_light = (point - light.position);
        let squared = max(dot(from_light, from_light), 1.0e-20);
        if ((light.kind == LIGHT_SPOT) && (dot(from_light, light.axis) <= (light.cos_outer * sqrt(squared)))) {
            return 0.0;
        }
        return (light.importance / squared);
    }
    return light.importance;
}

const FILTER_BOX: u32 = 0u;
const FILTER_TENT: u32 = 1u;
const FILTER_GAUSSIAN: u32 = 2u;
const FILTER_BLACKMAN_HARRIS: u32 = 3u;
const GAUSSIAN_SIGMA: f32 = 0.5;
const GAUSSIAN_SHARE: f32 = 0.9973002;
const BLACKMAN_HARRIS_RADIUS: f32 = 1.5;

fn inverse_erf(y: f32) -> f32 {
    let w = -log(((1.0 - y) * (1.0 + y)));
    if (w < 5.0) {
        let t = (w - 2.5);
        var p: f32 = 0.0000000281022636;
        p = (0.000000343273939 + (p * t));
        p = (-0.0000035233877 + (p * t));
        p = (-0.00000439150654 + (p * t));
        p = (0.00021858087 + (p * t));
        p = (-0.00125372503 + (p * t));
        p = (-0.00417768164 + (p * t));
        p = (0.246640727 + (p * t));
        return ((1.50140941 + (p * t)) * y);
    }
    let t = (sqrt(w) - 3.0);
    var p: f32 = -0.000200214257;
    p = (0.000100950558 + (p * t));
    p = (0.00134934322 + (p * t));
    p = (-0.00367342844 + (p * t));
    p = (0.00573950773 + (p * t));
    p = (-0.0076224613 + (p * t));
    p = (0.00943887047 + (p * t));
    p = (1.00167406 + (p * t));
    return ((2.83297682 + (p * t)) * y);
}

fn blackman_harris_pdf(x: f32) -> f32 {
    let angle = (3.14159265358979 * x);
    return (0.5 + ((((0.48829 * cos(angle)) + (0.14128 * cos((2.0 * angle)))) + (0.01168 * cos((3.0 * angle)))) / 0.7175));
}

fn blackman_harris_cdf(x: f32) -> f32 {
    let angle = (3.14159265358979 * x);
    let waves = (((0.48829 * sin(angle)) + (0.07064 * sin((2.0 * angle)))) + (0.00389333 * sin((3.0 * angle))));
    return ((0.5 + (0.5 * x)) + (waves / (3.14159265358979 * 0.7175)));
}

fn inverse_blackman_harris(u: f32) -> f32 {
    var low: f32 = -1.0;
    var high: f32 = 1.0;
    var x = clamp((0.3917 * inverse_erf((((2.0 * u) - 1.0) * 0.9999))), -0.95, 0.95);
    for (var _step = 0; _step < 8; _step++) {
        let error = (blackman_harris_cdf(x) - u);
        if (error > 0.0) {
            high = x;
        } else {
            low = x;
        }
        let next = (x - (error / max(blackman_harris_pdf(x), 0.0001)));
        x = select((0.5 * (low + high)), next, ((next >= low) && (next <= high)));
    }
    return x;
}

fn filter_offset(kind: u32, u: f32) -> f32 {
    if (kind == FILTER_TENT) {
        if (u < 0.5) {
            return (sqrt((2.0 * u)) - 1.0);
        }
        return (1.0 - sqrt((2.0 - (2.0 * u))));
    }
    if (kind == FILTER_GAUSSIAN) {
        return ((1.41421356 * GAUSSIAN_SIGMA) * inverse_erf((((2.0 * u) - 1.0) * GAUSSIAN_SHARE)));
    }
    if (kind == FILTER_BLACKMAN_HARRIS) {
        return (BLACKMAN_HARRIS_RADIUS * inverse_blackman_harris(u));
    }
    return (u - 0.5);
}

fn filter_position(kind: u32, u: vec2f) -> vec2f {
    if (kind == FILTER_BOX) {
        return u;
    }
    return vec2f((0.5 + filter_offset(kind, u.x)), (0.5 + filter_offset(kind, u.y)));
}

fn camera_ray(header: SceneHeader, settings: LaunchSettings, x: f32, y: f32) -> Ray {
    return lens_ray(header, settings, x, y, vec2f(0.0, 0.0));
}

fn lens_ray(
    header: SceneHeader,
    settings: LaunchSettings,
    x: f32,
    y: f32,
    lens: vec2f,
) -> Ray {
    let width = f32(settings.width);
    let image_x = ((((2.0 * x) - width) / width) * header.view_scale_x);
    let image_y = (((f32(settings.height) - (2.0 * y)) / width) * header.view_scale_y);
    let shift = (lens * header.lens_radius);
    let slope = (shift * header.vergence);
    if (header.camera == CAMERA_PARALLEL) {
        let start = (shift + (slope * header.start_distance));
        return Ray(transform_point(header.world_from_view, vec3f((image_x + start.x), (image_y + start.y), header.start_distance)), normalize(transform_vector(header.world_from_view, vec3f(-slope.x, -slope.y, -1.0))));
    }
    let direction = vec3f((image_x - slope.x), (image_y - slope.y), -1.0);
    return Ray(transform_point(header.world_from_view, vec3f(shift.x, shift.y, 0.0)), normalize(transform_vector(header.world_from_view, direction)));
}

fn concentric_disc(u: vec2f) -> vec2f {
    let a = ((2.0 * u.x) - 1.0);
    let b = ((2.0 * u.y) - 1.0);
    if ((a == 0.0) && (b == 0.0)) {
        return vec2f(0.0, 0.0);
    }
    let quarter_pi: f32 = 0.785398163397448;
    if (abs(a) > abs(b)) {
        let angle = (quarter_pi * (b / a));
        return vec2f((a * cos(angle)), (a * sin(angle)));
    }
    let angle = (quarter_pi * (a / b));
    return vec2f((b * sin(angle)), (b * cos(angle)));
}

struct CameraSample {
    ray: Ray,
    light_numbers: vec2f
}

fn sample_camera(
    header: SceneHeader,
    settings: LaunchSettings,
    key: SampleKey,
    x: u32,
    y: u32,
) -> CameraSample {
    let numbers = camera_numbers(key, settings.grid);
    let position = filter_position(settings.reconstruction, vec2f(numbers.x, numbers.y));
    var lens = vec2f(0.0, 0.0);
    if (header.lens_radius > 0.0) {
        let u = random4(key, DIMENSION_LENS);
        lens = concentric_disc(vec2f(u.x, u.y));
    }
    return CameraSample(lens_ray(header, settings, (f32(x) + position.x), (f32(y) + position.y), lens), vec2f(numbers.z, numbers.w));
}

struct PathVertex {
    position: vec3f,
    normal: vec3f,
    both_sides: bool,
    pdf: f32,
    importance: f32
}
const ROULETTE_START: u32 = 3u;
const ROULETTE_CAUTION: f32 = 3.0;
const MAX_SEGMENTS: u32 = 512u;
const SHADOW_END: f32 = 0.9999;

fn found_light_weight(previous: PathVertex, light_pdf: f32) -> f32 {
    if (previous.pdf <= 0.0) {
        return 1.0;
    }
    return power_heuristic(previous.pdf, light_pdf);
}

struct DirectLight {
    radiance: vec3f,
    end: f32,
    ray: Ray
}

struct PathState {
    radiance: vec3f,
    rays: u32,
    throughput: vec3f,
    touched: u32,
    ray: Ray,
    follows: bool,
    segment: u32,
    light_numbers: vec2f,
    media: Media,
    previous: PathVertex,
    event: u32,
    direct: vec3f,
    shadow: Ray,
    shadow_end: f32,
    shadow_light: vec3f,
    goes_on: bool
}
const EVENT_ESCAPED: u32 = 4u;
const EVENT_STOPPED: u32 = 5u;
const EVENT_STARTED: u32 = 6u;

fn start_path(start: CameraSample) -> PathState {
    let first = start.ray;
    return PathState(vec3f(0.0, 0.0, 0.0), 0u, vec3f(1.0, 1.0, 1.0), 0u, first, true, 0u, start.light_numbers, empty_space(), PathVertex(first.origin, first.direction, false, 0.0, 0.0), EVENT_STARTED, vec3f(0.0, 0.0, 0.0), first, 0.0, vec3f(0.0, 0.0, 0.0), true);
}

struct RayQuery {
    ray: Ray,
    t_max: f32,
    quest: Quest
}

fn next_query(key: SampleKey, path: PathState) -> RayQuery {
    let is_shadow = (path.shadow_end > 0.0);
    var ray = path.ray;
    var t_max = NO_HIT;
    if is_shadow {
        ray = path.shadow;
        t_max = path.shadow_end;
    }
    let purpose = select(SEARCH_HIT, SEARCH_LIGHT, is_shadow);
    return RayQuery(ray, t_max, Quest(purpose, key, path.segment));
}

fn receive_light(before: PathState, passed: vec3f) -> PathState {
    var path = before;
    path.rays += 1u;
    path.direct = (path.shadow_light * passed);
    path.radiance += path.direct;
    path.shadow_end = 0.0;
    path.goes_on = path.follows;
    return path;
}

struct PathSample {
    radiance: vec3f,
    rays: u32
}

struct StartedPath {
    key: SampleKey,
    path: PathState
}

fn start_sample(
    header: SceneHeader,
    settings: LaunchSettings,
    x: u32,
    y: u32,
    other: SampleKey,
    sample: u32,
) -> StartedPath {
    let key = key_of_sample(settings, x, y, other, sample);
    return StartedPath(key, start_path(sample_camera(header, settings, key, x, y)));
}

fn add_sample(before: FilmPixel, radiance: vec3f, rays: u32) -> FilmPixel {
    var film = before;
    film.radiance += radiance;
    film.squares += (radiance * radiance);
    film.rays += rays;
    return film;
}

fn add_samples_Buffers(
    scene: Buffers,
    settings: LaunchSettings,
    x: u32,
    y: u32,
    count: u32,
    before: FilmPixel,
) -> FilmPixel {
    let header = Buffers_header(scene);
    var film = before;
    for (var i = 0u; i < count; i++) {
        let key = sample_key(settings, x, y, (settings.first_sample + i));
        let ray = sample_camera(header, settings, key, x, y).ray;
        let traced = trace_rays_Buffers(scene, settings, key, ray);
        film = add_sample(film, traced.radiance, traced.rays);
    }
    return film;
}

fn render_pixel_Buffers(
    scene: Buffers,
    settings: LaunchSettings,
    x: u32,
    y: u32,
    before: FilmPixel,
) -> FilmPixel {
    let count = launched_samples(settings, before.samples);
    var film = add_samples_Buffers(scene, settings, x, y, count, before);
    if (settings.counted == 0u) {
        film.samples += count;
    }
    return film;
}

fn bsdf_albedo(bsdf: Bsdf) -> vec3f {
    return ((((bsdf.diffuse + bsdf.diffuse_transmission) + bsdf.glossy) + bsdf.glossy_transmission) + bsdf.straight);
}

fn view_depth(header: SceneHeader, position: vec3f) -> f32 {
    let eye = transform_point(header.world_from_view, vec3f(0.0, 0.0, 0.0));
    let forward = normalize(transform_vector(header.world_from_view, vec3f(0.0, 0.0, -1.0)));
    return dot((position - eye), forward);
}

fn add_first_hit_Buffers(scene: Buffers, key: SampleKey, ray: Ray, before: LayerPixel) -> LayerPixel {
    var layers = before;
    layers.samples += 1u;
    let hit = closest_hit_Buffers(scene, ray, key, 0u);
    if (hit.object == NONE) {
        return layers;
    }
    let shape = Buffers_shape(scene, hit.object);
    let surface = Buffers_surface(scene, hit.object);
    let met = shading_point_Buffers(scene, ray, hit);
    let material = met.material;
    var eta: f32 = 1.0;
    if (material.refractive_index > 0.0) {
        eta = select(material.refractive_index, (1.0 / material.refractive_index), (met.cos_front >= 0.0));
    }
    let bsdf = material_bsdf_Buffers(scene, material, met.at, eta, dot(met.normal, -ray.direction));
    layers.albedo += bsdf_albedo(bsdf);
    layers.normal += met.normal;
    layers.position += met.point.position;
    layers.depth += view_depth(Buffers_header(scene), met.point.position);
    layers.hits += 1u;
    if (layers.object == 0u) {
        var source = surface.source;
        if (hit.instance != NONE) {
            let placed = Buffers_surface(scene, hit.instance).source;
            source = select(source, placed, (source == NONE));
            layers.instance = (placed + 1u);
        }
        layers.object = (source + 1u);
        layers.material = (shape.material + 1u);
    }
    return layers;
}

fn layers_of_pixel_Buffers(
    scene: Buffers,
    settings: LaunchSettings,
    x: u32,
    y: u32,
    before: LayerPixel,
) -> LayerPixel {
    let header = Buffers_header(scene);
    var layers = before;
    for (var i = 0u; i < settings.samples; i++) {
        let key = sample_key(settings, x, y, (settings.first_sample + i));
        let ray = sample_camera(header, settings, key, x, y).ray;
        layers = add_first_hit_Buffers(scene, key, ray, layers);
    }
    return layers;
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
@group(0) @binding(9) var<storage, read_write> LAYERS: array<LayerPixel>;

struct Buffers {
    unused: u32
}
const FEATURES: u32 = 262143u;

fn Buffers_features(_scene: Buffers) -> u32 {
    return FEATURES;
}

fn Buffers_header(_scene: Buffers) -> SceneHeader {
    return HEADER;
}

fn Buffers_node(_scene: Buffers, index: u32) -> BvhNode {
    return NODES[u32(index)];
}

fn Buffers__1reached_children(
    _scene: Buffers,
    index: u32,
    origin: vec3f,
    inverse: vec3f,
    t_max: f32,
) -> u32 {
    return reached_boxes(NODES[u32(index)], origin, inverse, t_max);
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

@compute @workgroup_size(8, 8) fn render_layers(@builtin(global_invocation_id) id: vec3u) {
    let settings = SETTINGS;
    if ((id.x < settings.tile_width) && (id.y < settings.tile_height)) {
        let index = ((id.y * settings.tile_width) + id.x);
        let before = LAYERS[u32(index)];
        let after = layers_of_pixel_Buffers(Buffers(0u), settings, (settings.tile_x + id.x), (settings.tile_y + id.y), before);
        LAYERS[u32(index)] = after;
    }
}

