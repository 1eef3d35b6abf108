//! The records that a compiled scene consists of, declared once for both devices, and the trait through which
//! the kernels read them.
//!
//! Layout rule: every `Vec3f` is followed by a four-byte field and every struct is a multiple of 16 bytes long.
//! Then Rust (`repr(C)`, alignment 4) and WGSL (alignment 16) agree on all offsets; a test asserts it.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use wgsl_rs::std::*;

    /// Three rows of an affine matrix acting on column vectors.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct Affine {
        pub row0: Vec4f,
        pub row1: Vec4f,
        pub row2: Vec4f,
    }

    /// Node of a bounding volume hierarchy with up to eight children, whose boxes stand on a grid (Ylitie, Karras and
    /// Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017): 80 bytes.
    ///
    /// A child is another node, an object, or nothing. The bits of the number of a child tell on which side of
    /// the node it rather lies: 1, 2 and 4 stand for larger x, y and z; see the module `bvh`.
    ///
    /// A node with `NODE_INSTANCE` in `exponents` is an instance instead: `first_object` is its record and
    /// `first_node` the root of its group.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct BvhNode {
        /// Lower corner of the grid.
        pub origin: Vec3f,
        /// Binary exponents of the edges of its cells along x, y, z, biased as in floats, in the lowest three bytes.
        /// The highest byte has a bit for each child that is a node.
        pub exponents: u32,
        /// The first child that is a node; the others follow.
        pub first_node: u32,
        /// The first child that is an object; the others follow.
        pub first_object: u32,
        /// A bit for each child that is an object.
        pub leaves: u32,
        pub unused: u32,
        /// Lower ends of the boxes in cells, a byte for each child: x of 0 to 3, x of 4 to 7, y, y.
        pub low_xy: Vec4u,
        /// Lower ends in z, upper ends in x.
        pub low_z_high_x: Vec4u,
        /// Upper ends in y and z.
        pub high_yz: Vec4u,
    }

    /// In place of the exponents: the node is an instance.
    pub const NODE_INSTANCE: u32 = 4294967295;

    /// Unit sphere.
    pub const SHAPE_SPHERE: u32 = 0;
    /// The cube [-1, 1]³.
    pub const SHAPE_BOX: u32 = 1;
    /// Round body along z in [0, 1] whose radius runs from `base_radius` to `top_radius`: cylinder, cone, frustum.
    pub const SHAPE_FRUSTUM: u32 = 2;
    /// The plane z = 0.
    pub const SHAPE_PLANE: u32 = 3;
    /// x in [-1, 1], z in [0, 1], y = 0; front side +y.
    pub const SHAPE_PARALLELOGRAM: u32 = 4;
    /// x, z >= 0, x + z <= 1, y = 0; front side +y.
    pub const SHAPE_TRIANGLE: u32 = 5;
    /// A group of objects with a hierarchy of its own, found through a node with `NODE_INSTANCE`. The matrices lead
    /// to the space of the group.
    pub const SHAPE_INSTANCE: u32 = 6;

    /// Part of `ShapeRecord::kind` that holds the shape.
    pub const SHAPE_MASK: u32 = 255;
    /// No cap at z = 0.
    pub const FLAG_BASE_OPEN: u32 = 256;
    /// No cap at z = 1.
    pub const FLAG_TOP_OPEN: u32 = 512;
    /// The material lets rays pass somewhere: its opacity must be evaluated at every hit.
    pub const FLAG_NOT_OPAQUE: u32 = 1024;
    /// Triangle: rays that meet its front pass it. The front is where the corners run counter-clockwise.
    pub const FLAG_FRONT_HIDDEN: u32 = 2048;
    /// Triangle: rays that meet its back pass it.
    pub const FLAG_BACK_HIDDEN: u32 = 4096;

    /// What intersection needs of an object: 64 bytes.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct ShapeRecord {
        pub object_from_world: Affine,
        /// Shape in the lowest byte, flags above.
        pub kind: u32,
        /// Instance: number of its group.
        pub material: u32,
        pub base_radius: f32,
        /// Triangle: its number in the mesh, which tells it apart from the others in random choices.
        pub top_radius: f32,
    }

    /// What shading needs of an object besides: 64 bytes.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct SurfaceRecord {
        pub world_from_object: Affine,
        /// Factor on v; 1 unless the shape scales v with its length.
        pub v_scale: f32,
        /// Index of the light that this body is, or `NONE`.
        pub light: u32,
        /// Number of what it comes from in the scene description.
        pub source: u32,
        /// Triangle: first of its entries in the attribute table, or `NONE`; see the module `mesh`.
        pub attributes: u32,
    }

    /// An object of the scene. Its two parts take a line of a processor's cache each.
    #[repr(C, align(64))]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct ObjectRecord {
        pub shape: ShapeRecord,
        pub surface: SurfaceRecord,
    }

    /// An index that refers to nothing.
    pub const NONE: u32 = 4294967295;

    /// Transparency takes away from diffuse and glossy reflection.
    pub const MATERIAL_INTERPOLATED: u32 = 1;
    /// What a refracting surface reflects of the light that it lets pass is reflected as by a mirror.
    pub const MATERIAL_MIRRORS: u32 = 2;
    /// A channel looks at the position, see the module `coordinates`.
    pub const MATERIAL_USES_POSITION: u32 = 4;
    /// Nothing but Lambertian reflection and transmission, and the alpha of the diffuse channel.
    pub const MATERIAL_LAMBERTIAN: u32 = 8;
    /// Lambertian, and the same everywhere: `diffuse_color` and `transmitted_color` say how.
    pub const MATERIAL_UNIFORM: u32 = 16;

    /// Coefficients of a material as indices of channels, or `NONE`.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct MaterialRecord {
        pub diffuse: u32,
        pub specular: u32,
        pub shininess: u32,
        pub transparency: u32,
        pub transparency_shininess: u32,
        pub diffuse_transparency: u32,
        pub ambient: u32,
        pub emissive: u32,
        /// `MATERIAL_INTERPOLATED` and the others.
        pub flags: u32,
        /// Share of light that meets the surface, on top of what the channels say.
        pub opacity: f32,
        /// Material of the back, or `NONE` if it is the same.
        pub back: u32,
        /// Refractive index inside of the body, or 0 if the surface does not bound a medium.
        pub refractive_index: f32,
        /// First of its normal maps among the channels, or `NONE`.
        pub normal_map: u32,
        pub reserved0: u32,
        pub reserved1: u32,
        pub reserved2: u32,
        /// Uniform: value of the channel `diffuse`.
        pub diffuse_color: Vec3f,
        pub reserved3: u32,
        /// Uniform: value of the channel `diffuse_transparency`.
        pub transmitted_color: Vec3f,
        pub reserved4: u32,
    }

    /// The value of `ChannelRecord` is the result.
    pub const CHANNEL_CONSTANT: u32 = 0;
    /// The result is read from an image.
    pub const CHANNEL_IMAGE: u32 = 1;
    /// Goes on at record `first` or `size`, by the parity of the field of a checkerboard, with the coordinates
    /// of the surface.
    pub const CHANNEL_CHECKER: u32 = 2;
    /// Moves u and v by `value.xy`; goes on at the next record.
    pub const CHANNEL_MOVE_UV: u32 = 3;
    /// Multiplies u and v with the matrix whose rows are `value.xy` and `value.zw`; goes on at the next record.
    pub const CHANNEL_LINEAR_UV: u32 = 4;
    /// As `CHANNEL_CHECKER`, by the parity of the cube of (x, y, z).
    pub const CHANNEL_VOLUME_CHECKER: u32 = 5;
    /// Carries (x, y, z), or the position in the world if `first` is 1, by the affine matrix whose rows are the
    /// values of this and the next two records.
    pub const CHANNEL_AFFINE_XYZ: u32 = 6;
    /// Moves (x, y, z) or, if `mode` is 1, (u, v, w) by `value.xyz` times `size` octaves of noise with the
    /// table at texel `first`. `value.xy` of the next record are the frequency and the noise ratio.
    pub const CHANNEL_TURBULENCE: u32 = 7;
    /// The number becomes noise of (x, y, z) times `value.x`; of the kind `mode`, else as above.
    pub const CHANNEL_NOISE: u32 = 8;
    /// The number becomes the product of (x, y, z) with `value.xyz`.
    pub const CHANNEL_GRADIENT: u32 = 9;
    /// The number becomes the distance from the z axis.
    pub const CHANNEL_WOOD: u32 = 10;
    /// The number becomes that of the function `leopard`.
    pub const CHANNEL_LEOPARD: u32 = 11;
    /// The number becomes that of the function `fractal` with `size` iterations; if `first` is 1 the constant is
    /// `value.xy`.
    pub const CHANNEL_FRACTAL: u32 = 12;
    /// The number becomes the height of waves, `value.xy` per unit of u and v.
    pub const CHANNEL_WAVES: u32 = 13;
    /// The number is multiplied by `value.x`, then `value.y` is added.
    pub const CHANNEL_LINEAR: u32 = 14;
    /// The number becomes that of the wave form `first`.
    pub const CHANNEL_WAVE_FORM: u32 = 15;
    /// The number, as a grey with alpha 1, is the result.
    pub const CHANNEL_GREY: u32 = 16;
    /// The result of the program at `first` becomes (x, y, z) and (u, v, w); goes on at the next record.
    pub const CHANNEL_CALL: u32 = 17;
    /// Mixes, by x, two of the `size` items in the records that follow.
    pub const CHANNEL_BLEND: u32 = 18;
    /// At x = `value.x` the result of the program at `first` is seen.
    pub const CHANNEL_ITEM: u32 = 19;
    /// Sums up the program at `first` at `size` neighbours in distances `value.xyz`: 27 with the same weight, or 7.
    pub const CHANNEL_FILTER: u32 = 20;
    /// No instruction: belongs to the record before.
    pub const CHANNEL_OPERAND: u32 = 21;
    /// No instruction: a normal map of a material. `first` is the program of the height, of which one unit is
    /// `value.x` metres and whose slope is measured over `value.yz` in u and v; only on the top of boxes if `size`
    /// is 1; `mode` is the next normal map or `NONE`.
    pub const CHANNEL_NORMAL_MAP: u32 = 22;

    /// An instruction of a channel's program; see the module `channel`.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct ChannelRecord {
        pub value: Vec4f,
        pub operation: u32,
        /// Image: first texel in the texel table. Checker: record of the odd fields. Else see the operation.
        pub first: u32,
        /// Image: width in the lower, height in the upper 16 bits. Checker: record of the even fields. Else see
        /// the operation.
        pub size: u32,
        /// Image: 1 to interpolate between texels, plus 2 for colours in sRGB. Else see the operation.
        pub mode: u32,
    }

    pub const LIGHT_POINT: u32 = 0;
    pub const LIGHT_SPOT: u32 = 1;
    pub const LIGHT_DIRECTIONAL: u32 = 2;
    pub const LIGHT_AREA: u32 = 3;
    /// A sky with the same radiance everywhere.
    pub const LIGHT_SKY: u32 = 4;
    /// A sky whose radiance is a channel.
    pub const LIGHT_SKY_MAP: u32 = 5;
    /// A clear sky without its sun.
    pub const LIGHT_DAYLIGHT: u32 = 6;
    /// The disc of the sun.
    pub const LIGHT_SUN: u32 = 7;
    /// A point with a table of intensities.
    pub const LIGHT_PHYSICAL: u32 = 8;
    /// No light itself, but all those that stand below it in the tree of lights.
    pub const LIGHT_GROUP: u32 = 9;

    /// A light source, or a group of them: 96 bytes.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct LightRecord {
        /// Where it stands; for a parallelogram the middle of its base edge, for a group its centre.
        pub position: Vec3f,
        pub kind: u32,
        /// Unit axis along which it shines. Skies: their local z axis. Group: the mean axis of its lights.
        pub axis: Vec3f,
        /// 1 if nothing throws a shadow in its light.
        pub shadowless: u32,
        /// Point: intensity in W/sr. Spot: intensity of the core in W/sr. Directional: irradiance in W/m².
        /// Area: radiance along the axis in W/(m² sr). Sky, sun: radiance in W/(m² sr). Sky map: radiance of the
        /// colour 1. Physical: power in W.
        pub emission: Vec3f,
        /// Spot: cosine of the inner angle. Area: exponent. Physical: attenuation exponent. Sun: 1 minus the cosine of half its angular size.
        /// Group: squared radius of a sphere that holds its lights.
        pub cos_inner: f32,
        /// Area: half of the base edge. Skies, physical: local x axis. Point, spot: attenuation exponent and
        /// distance in metres, in x and y.
        pub edge_u: Vec3f,
        /// Spot: cosine of the outer angle. Area: its area in m². Physical: attenuation distance in metres. Group: no light reaches points at a larger
        /// angle from the axis, in radians.
        pub cos_outer: f32,
        /// Area: the edge from base to far end. Skies, physical: local y axis.
        pub edge_v: Vec3f,
        /// Expected irradiance at unit distance (point, spot, area, physical, group) or anywhere (the others), for
        /// the choice between lights.
        pub importance: f32,
        /// Sky map, daylight, physical: where its table starts among the attributes. Group: its first child among
        /// the lights.
        pub first: u32,
        /// Sky map, daylight, physical: columns of the table in the lower, rows in the upper 16 bits. Group: number
        /// of its children.
        pub count: u32,
        /// The group to which it belongs, or `NONE`.
        pub parent: u32,
        /// Sky map: its channel. Daylight: where its coefficients start among the attributes.
        pub program: u32,
    }

    pub const CAMERA_PERSPECTIVE: u32 = 0;
    pub const CAMERA_PARALLEL: u32 = 1;

    /// What is the same for the whole scene; a uniform on the GPU.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct SceneHeader {
        pub world_from_view: Affine,
        /// Horizontal and vertical half extent of the picture at distance 1 (perspective) or anywhere
        /// (parallel), per unit of half the picture's width.
        pub view_scale_x: f32,
        pub view_scale_y: f32,
        /// Parallel projection: distance behind the view plane at which rays start.
        pub start_distance: f32,
        pub camera: u32,
        /// Objects with no bounds stand at the front of the object table.
        pub unbounded_objects: u32,
        pub nodes: u32,
        /// Number of lights and groups of lights that belong to no group; they stand at the front of the light
        /// table.
        pub lights: u32,
        /// Number of lights infinitely far away, which come first.
        pub distant_lights: u32,
        /// Ray tracer: irradiance from everywhere in W/m², as the colours of ambient lights say.
        pub ambient: Vec3f,
        /// Number of all lights and groups of lights.
        pub all_lights: u32,
        /// Radius of the lens in metres; 0 draws everything sharply.
        pub lens_radius: f32,
        /// Reciprocal of the distance of the plane that is drawn sharply, in 1/m; 0 for infinity.
        pub vergence: f32,
        pub reserved0: u32,
        pub reserved1: u32,
    }

    /// The unbiased solution of the rendering equation.
    pub const RENDERER_PATH_TRACER: u32 = 0;
    /// Local illumination with ideal reflection and refraction.
    pub const RENDERER_RAY_TRACER: u32 = 1;

    /// What is the same for one launch; a uniform on the GPU.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct LaunchSettings {
        /// Size of the whole picture in pixels.
        pub width: u32,
        pub height: u32,
        /// The tile to render, in pixels from the top left.
        pub tile_x: u32,
        pub tile_y: u32,
        pub tile_width: u32,
        pub tile_height: u32,
        pub first_sample: u32,
        pub samples: u32,
        pub seed: u32,
        /// The pixel is divided into grid x grid strata.
        pub grid: u32,
        /// Number of surfaces that a path may touch.
        pub depth: u32,
        /// `RENDERER_PATH_TRACER` or the other.
        pub renderer: u32,
        /// Radiance where a ray hits nothing and there is no sky, in W/(m² sr).
        pub background: Vec3f,
        /// Ray tracer: shadow rays to every area light and sky, at least 1.
        pub shadow_samples: u32,
        /// `SAMPLER_INDEPENDENT` or `SAMPLER_SOBOL`.
        pub sampler: u32,
        /// Sobol: binary logarithm of the planned number of samples per pixel, rounded up; at most
        /// `MAX_SEQUENCE_BITS`.
        pub sequence_bits: u32,
        /// Reconstruction filter, `FILTER_BOX` and so on.
        pub reconstruction: u32,
        /// 1 if every pixel says how many samples it is to have; see `launched_samples`.
        pub counted: u32,
    }

    /// Together with the bits of a block's pixels this leaves indices below 2^32.
    pub const MAX_SEQUENCE_BITS: u32 = 20;

    /// What is collected for a pixel.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct FilmPixel {
        /// Sum of the radiance of all samples.
        pub radiance: Vec3f,
        /// Number of rays that were traced.
        pub rays: u32,
        /// Sum of the squares of the radiance, per channel.
        pub squares: Vec3f,
        pub samples: u32,
    }

    /// What is collected for a pixel of where its rays meet the scene first; sums over its samples.
    #[repr(C)]
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct LayerPixel {
        /// Share of light per channel that the surface reflects and transmits; 0 where nothing is met.
        pub albedo: Vec3f,
        /// Number of samples.
        pub samples: u32,
        /// Shading normal on the side of the camera, in the world.
        pub normal: Vec3f,
        /// Number of samples that met something.
        pub hits: u32,
        /// Where, in metres, relative to the origin of the compiled scene.
        pub position: Vec3f,
        /// Distance from the plane of the camera along the direction of view, in metres.
        pub depth: f32,
        /// `SurfaceRecord::source` of what the first sample that meets anything meets, plus 1; 0 if there is nothing.
        pub object: u32,
        /// The same of the instance that it is part of; 0 if it is part of none.
        pub instance: u32,
        /// Index of its material, plus 1.
        pub material: u32,
        pub reserved: u32,
    }

    /// Samples of a pixel in this launch. In a counted launch the pixel's number of samples is set beforehand to
    /// what it is to have in the end, and the launch takes those that are still missing.
    pub fn launched_samples(settings: LaunchSettings, pixel_samples: u32) -> u32 {
        if settings.counted == 0u32 {
            return settings.samples;
        }
        min(settings.samples, max(pixel_samples, settings.first_sample) - settings.first_sample)
    }

    /// What a scene may contain. The lowest bits stand for the shapes, 1 << `SHAPE_SPHERE` and so on. Kernels ask
    /// before they do what a scene may not need, so that a program for a scene without it need not hold the code.
    ///
    /// A material that is more than `MATERIAL_LAMBERTIAN`.
    pub const FEATURE_LOBES: u32 = 256;
    /// A body with a refractive index.
    pub const FEATURE_MEDIA: u32 = 512;
    /// A channel that is read from an image.
    pub const FEATURE_IMAGES: u32 = 1024;
    /// A channel that is neither a constant nor an image.
    pub const FEATURE_PROGRAMS: u32 = 2048;
    /// A material that looks at the position or has normal maps.
    pub const FEATURE_POSITIONS: u32 = 4096;
    /// A material with another one at its back.
    pub const FEATURE_BACKS: u32 = 8192;
    /// An object with `FLAG_NOT_OPAQUE`.
    pub const FEATURE_HOLES: u32 = 16384;
    /// A light that needs a table: sky maps, daylight, physical lights.
    pub const FEATURE_LIGHT_TABLES: u32 = 32768;
    /// Lights in groups.
    pub const FEATURE_LIGHT_GROUPS: u32 = 65536;
    /// Hierarchies of more than `MANY_NODES` nodes.
    pub const FEATURE_MANY_NODES: u32 = 131072;
    /// Everything.
    pub const ALL_FEATURES: u32 = 262143;

    /// With more nodes than this the search for hits takes most of the time; measured.
    pub const MANY_NODES: u32 = 2;

    /// How kernels read a compiled scene. The CPU implements it over slices, the GPU over storage buffers.
    pub trait SceneAccess {
        /// What the scene may contain, `FEATURE_LOBES` and so on.
        fn features(scene: Self) -> u32;
        fn header(scene: Self) -> SceneHeader;
        fn node(scene: Self, index: u32) -> BvhNode;
        /// Children of a node, as bits, whose boxes a ray reaches up to the parameter `t_max`; see the module `bvh`.
        fn reached_children(scene: Self, index: u32, origin: Vec3f, inverse: Vec3f, t_max: f32) -> u32;
        fn shape(scene: Self, index: u32) -> ShapeRecord;
        fn surface(scene: Self, index: u32) -> SurfaceRecord;
        fn material(scene: Self, index: u32) -> MaterialRecord;
        fn channel(scene: Self, index: u32) -> ChannelRecord;
        fn texel(scene: Self, index: u32) -> u32;
        fn light(scene: Self, index: u32) -> LightRecord;
        fn attribute(scene: Self, index: u32) -> Vec4f;
    }

    /// Whether the scene may contain something.
    pub fn has<S: SceneAccess + Copy>(scene: S, feature: u32) -> bool {
        (S::features(scene) & feature) != 0u32
    }

    /// `matrix * (point, 1)`.
    pub fn transform_point(matrix: Affine, point: Vec3f) -> Vec3f {
        vec3f(
            transform_row(matrix.row0, point),
            transform_row(matrix.row1, point),
            transform_row(matrix.row2, point),
        )
    }

    /// One component of `matrix * (point, 1)`, from the row of the matrix.
    pub fn transform_row(row: Vec4f, point: Vec3f) -> f32 {
        row.x * point.x + row.y * point.y + row.z * point.z + row.w
    }

    /// One component of `matrix * (direction, 0)`, from the row of the matrix.
    pub fn turn_row(row: Vec4f, direction: Vec3f) -> f32 {
        row.x * direction.x + row.y * direction.y + row.z * direction.z
    }

    /// A row of the product of two matrices, given that row of the first.
    pub fn compose_row(row: Vec4f, second: Affine) -> Vec4f {
        second.row0 * row.x + second.row1 * row.y + second.row2 * row.z + vec4f(0.0, 0.0, 0.0, row.w)
    }

    /// The matrix that applies `second` and then `first`.
    pub fn compose(first: Affine, second: Affine) -> Affine {
        Affine {
            row0: compose_row(first.row0, second),
            row1: compose_row(first.row1, second),
            row2: compose_row(first.row2, second),
        }
    }

    /// `matrix * (direction, 0)`.
    pub fn transform_vector(matrix: Affine, direction: Vec3f) -> Vec3f {
        vec3f(
            turn_row(matrix.row0, direction),
            turn_row(matrix.row1, direction),
            turn_row(matrix.row2, direction),
        )
    }

    /// The transpose of the linear part times `normal`. With the inverse matrix this carries normals.
    pub fn transform_transposed(matrix: Affine, normal: Vec3f) -> Vec3f {
        vec3f(
            matrix.row0.x * normal.x + matrix.row1.x * normal.y + matrix.row2.x * normal.z,
            matrix.row0.y * normal.x + matrix.row1.y * normal.y + matrix.row2.y * normal.z,
            matrix.row0.z * normal.x + matrix.row1.z * normal.y + matrix.row2.z * normal.z,
        )
    }

    /// Magnitude of the rounding errors when `matrix` is applied to `point`, per component, in units of the
    /// last place.
    pub fn transform_magnitude(matrix: Affine, point: Vec3f) -> Vec3f {
        let p = vec4f(abs(point.x), abs(point.y), abs(point.z), 1.0);
        vec3f(dot(abs(matrix.row0), p), dot(abs(matrix.row1), p), dot(abs(matrix.row2), p))
    }
}

use kernel::*;

/// Allows the record types to be copied to the graphics card as bytes.
///
/// `unsafe` because the compiler cannot see that the vector types of `wgsl-rs` are plain `repr(C)` structs of
/// 32-bit numbers without padding; the test below checks the sizes and so the absence of padding.
macro_rules! plain_old_data {
    ($($name:ty: $words:expr),* $(,)?) => {
        $(
            // SAFETY: repr(C), all fields are u32 or f32 (or arrays of them), no padding (see the size test).
            unsafe impl bytemuck::Zeroable for $name {}
            // SAFETY: as above; every bit pattern is a valid u32 or f32.
            unsafe impl bytemuck::Pod for $name {}
        )*

        #[cfg(test)]
        #[test]
        fn records_have_no_padding() {
            $(
                assert_eq!(size_of::<$name>(), 4 * $words, stringify!($name));
                assert_eq!(size_of::<$name>() % 16, 0, stringify!($name));
            )*
        }
    };
}

plain_old_data! {
    Affine: 12,
    BvhNode: 20,
    ShapeRecord: 16,
    SurfaceRecord: 16,
    ObjectRecord: 32,
    MaterialRecord: 24,
    ChannelRecord: 8,
    LightRecord: 24,
    SceneHeader: 28,
    LaunchSettings: 20,
    FilmPixel: 8,
    LayerPixel: 16,
}
