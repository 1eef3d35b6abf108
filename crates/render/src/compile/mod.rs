//! Flattens a scene description into the records that the kernels read.

mod binary;
mod bvh;
mod camera;
mod channels;
mod collapse;
mod daylight;
mod environment;
mod features;
mod instances;
mod light_tree;
mod lights;
mod materials;
mod node_encoding;
mod noise;
mod objects;
mod outline;
mod scene_hash;
mod texels;
mod triangles;
mod unit_shapes;

pub use camera::View;

use crate::compile::materials::Materials;
use crate::compile::objects::Objects;
use kernels::records::kernel::{
    BvhNode, ChannelRecord, LightRecord, MaterialRecord, ObjectRecord, SceneHeader,
};
use scene::{DAffine3, DVec3, LightKind, Origin, Scene};

/// A scene in the form that devices take: flat tables of records, in 32-bit numbers, relative to an origin near
/// the middle of the scene, so that a scene far from the origin of its coordinates renders as sharply as one
/// around it.
#[derive(Clone, Debug)]
pub struct CompiledScene {
    /// What is the same for the whole scene.
    pub header: SceneHeader,
    /// Bounding volume hierarchy over the bounded objects, with the root as node 0; then those of the groups.
    pub nodes: Vec<BvhNode>,
    /// Unbounded objects, then the bounded ones in the order of the hierarchy's leaves, then those of groups.
    pub objects: Vec<ObjectRecord>,
    /// Indexed by `ShapeRecord::material`.
    pub materials: Vec<MaterialRecord>,
    /// Indexed by the fields of materials.
    pub channels: Vec<ChannelRecord>,
    /// Red, green, blue, alpha of all images, red in the lowest byte.
    pub texels: Vec<u32>,
    /// All light sources, the sky and the groups of the light tree included.
    pub lights: Vec<LightRecord>,
    /// Normals and texture coordinates of triangles and frames for channels that look at the position, found through
    /// `SurfaceRecord::attributes`, and the tables of lights, found through `LightRecord::first` and
    /// `LightRecord::program`.
    pub attributes: Vec<[f32; 4]>,
    /// What objects and instances come from, by `SurfaceRecord::source`.
    pub origins: Vec<Origin>,
    /// Names of the types of origins.
    pub type_names: Vec<String>,
    /// What positions in the tables are relative to, in the world.
    pub origin: DVec3,
    /// What the tables contain: `FEATURE_LOBES` and the others of the kernels.
    pub features: u32,
    triangles: usize,
    /// Corners of the box round all bounded objects, relative to the origin.
    local_bounds: Option<(DVec3, DVec3)>,
}

/// How objects are found along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Acceleration {
    /// By a bounding volume hierarchy.
    #[default]
    Bvh,
    /// By testing every object: slow, and the plainest statement of what the result should be.
    None,
}

/// Why a scene cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum CompileError {
    /// An object has no extent or numbers that are not finite.
    #[error(
        "{type_name} (node {node}) cannot be drawn: its size or placement is zero or not a number; \
         leave it out or give it an extent"
    )]
    DegenerateObject {
        /// GroIMP class or module.
        type_name: String,
        /// Id of the node in the project.
        node: i64,
    },
    /// An image is too large for the texture tables.
    #[error("image {name} is {width} x {height} pixels; at most 65535 x 65535 can be used as a texture")]
    ImageTooLarge {
        /// Name of the image.
        name: String,
        /// Its width in pixels.
        width: u32,
        /// Its height in pixels.
        height: u32,
    },
    /// All images together are too large.
    #[error("all images together have {texels} pixels; at most 4294967295 fit")]
    TooManyTexels {
        /// Their number of pixels.
        texels: usize,
    },
    /// A channel refers to one that does not come before it.
    #[error("channel {channel} of the scene refers to a channel that does not come before it")]
    ChannelOrder {
        /// Position of the channel.
        channel: usize,
    },
    /// A light's table is too large.
    #[error("the intensity table of a light is {columns} x {rows}; at most 65535 x 65535 can be used")]
    DistributionTooLarge {
        /// Its polar angles.
        columns: usize,
        /// Its azimuths.
        rows: usize,
    },
    /// A channel nests too many blends and filters.
    #[error(
        "channel {channel} of the scene combines so many blends and filters that a point would take more than \
         {} steps or {} pending tasks",
        scene::Effort::MAX_STEPS,
        scene::Effort::MAX_PENDING
    )]
    ChannelTooComplex {
        /// Position of the channel.
        channel: usize,
    },
    /// Instances within instances multiply to more than can be stored.
    #[error("the scene has more than {most} instances, counted through nested ones; use fewer of them")]
    TooManyInstances {
        /// What is accepted.
        most: usize,
    },
    /// A group contains itself, or nearly so.
    #[error("instances are nested more than {deepest} deep, or a group contains itself")]
    NestedInstances {
        /// What is accepted.
        deepest: usize,
    },
    /// The camera's numbers make no picture.
    #[error("the camera cannot be used: its placement or opening angle is zero or not a number")]
    DegenerateCamera,
    /// The lens's numbers make no picture.
    #[error("the camera's lens cannot be used: its radius or its focus is negative or not a number")]
    DegenerateLens,
}

impl CompiledScene {
    /// Number of triangles of all meshes, counted as often as they are drawn.
    pub fn triangles(&self) -> usize {
        self.triangles
    }
}

/// Compiles a scene with a bounding volume hierarchy.
///
/// # Errors
/// If something in it has no extent or is too large for the tables.
pub fn compile(scene: &Scene) -> Result<CompiledScene, CompileError> {
    compile_with(scene, Acceleration::Bvh)
}

/// Compiles a scene; see [`compile`].
///
/// # Errors
/// As [`compile`].
pub fn compile_with(scene: &Scene, acceleration: Acceleration) -> Result<CompiledScene, CompileError> {
    let placements = instances::placements(scene)?;
    let scene = &*instances::with_raised_members(scene, &placements);
    let bounds = scene.bounds();
    let world_from_camera = scene.camera.view_from_world.inverse();
    let origin = match bounds {
        Some((low, high)) => 0.5 * (low + high),
        None => world_from_camera.translation,
    };
    let local_from_world = DAffine3::from_translation(-origin);

    check_distributions(scene)?;
    let materials = materials::compile_materials(scene, origin)?;
    let mut lights = lights::compile_lights(scene, &local_from_world, &materials.channel_starts);
    let Objects { scene: primitives, groups, mut attributes, origins, triangles } = objects::compile_objects(
        scene,
        &placements,
        &local_from_world,
        &materials,
        &lights.of_object,
        acceleration,
    )?;
    lights.append_tables(&mut attributes);
    let hierarchy = bvh::arrange(primitives, groups, acceleration);

    let Materials { records: materials, channels, texels, .. } = materials;
    let local_bounds = bounds.map(|(low, high)| (low - origin, high - origin));
    let mut header = camera::compile_camera(&scene.camera, &local_from_world, local_bounds)?;
    header.unbounded_objects = count(hierarchy.unbounded);
    header.nodes = count(hierarchy.nodes.len());
    header.lights = lights.top;
    header.distant_lights = lights.distant;
    header.all_lights = count(lights.records.len());
    header.ambient = vector(DVec3::from(scene.ambient));

    let mut compiled = CompiledScene {
        header,
        nodes: hierarchy.nodes,
        objects: hierarchy.objects,
        materials,
        channels,
        texels,
        lights: lights.records,
        attributes,
        origins,
        type_names: scene.type_names.clone(),
        origin,
        features: 0,
        triangles,
        local_bounds,
    };
    compiled.features = features::features(&compiled);
    environment::add_sky_densities(&mut compiled);
    if scene.camera.lens.is_some_and(|lens| lens.focus.is_none()) {
        compiled.header.vergence = camera::middle_vergence(&compiled, &compiled.header);
    }
    Ok(compiled)
}

fn check_distributions(scene: &Scene) -> Result<(), CompileError> {
    for light in &scene.lights {
        if let LightKind::Physical { distribution, .. } = &light.kind {
            let (columns, rows) = (distribution.columns(), distribution.rows());
            if columns.max(rows) > usize::from(u16::MAX) {
                return Err(CompileError::DistributionTooLarge { columns, rows });
            }
        }
    }
    Ok(())
}

/// A table length as the kernels count it.
///
/// # Panics
/// If a table had 2^32 entries; they would need hundreds of gigabytes.
fn count(len: usize) -> u32 {
    u32::try_from(len).expect("tables hold fewer than 2^32 records")
}

/// Rows of a matrix in 32 bits.
fn affine(matrix: &DAffine3) -> kernels::records::kernel::Affine {
    let m = matrix.matrix3;
    let t = matrix.translation;
    let row = |x: f64, y: f64, z: f64, w: f64| wgsl_rs::std::vec4f(x as f32, y as f32, z as f32, w as f32);
    kernels::records::kernel::Affine {
        row0: row(m.x_axis.x, m.y_axis.x, m.z_axis.x, t.x),
        row1: row(m.x_axis.y, m.y_axis.y, m.z_axis.y, t.y),
        row2: row(m.x_axis.z, m.y_axis.z, m.z_axis.z, t.z),
    }
}

/// A vector in 32 bits.
fn vector(v: DVec3) -> wgsl_rs::std::Vec3f {
    wgsl_rs::std::vec3f(v.x as f32, v.y as f32, v.z as f32)
}
