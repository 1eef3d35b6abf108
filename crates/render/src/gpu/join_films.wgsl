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
fn joined_pixels(first: FilmPixel, second: FilmPixel) -> FilmPixel {
    var joined = first;
    joined.radiance += second.radiance;
    joined.squares += second.squares;
    joined.rays = saturating_sum(first.rays, second.rays);
    joined.samples = saturating_sum(first.samples, second.samples);
    return joined;
}

fn saturating_sum(a: u32, b: u32) -> u32 {
    return (a + min(b, (4294967295u - a)));
}
@group(0) @binding(0) var<uniform> SETTINGS: LaunchSettings;
@group(0) @binding(1) var<storage, read_write> FIRST: array<FilmPixel>;
@group(0) @binding(2) var<storage, read> SECOND: array<FilmPixel>;

@compute @workgroup_size(256) fn join_films(@builtin(global_invocation_id) id: vec3u) {
    let settings = SETTINGS;
    if (id.x < (settings.tile_width * settings.tile_height)) {
        let joined = joined_pixels(FIRST[u32(id.x)], SECOND[u32(id.x)]);
        FIRST[u32(id.x)] = joined;
    }
}
