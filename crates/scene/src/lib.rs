//! What a picture is made of.
//!
//! A [`Scene`] is a plain description: objects with analytic shapes, materials as data, lights in watts, a
//! camera. It knows no file format and no device. Readers produce it, the renderer compiles it.
//!
//! Conventions: right-handed world, z up, metres, radians, watts; colours are linear Rec. 709 RGB. Matrices act
//! on column vectors and are named `to_from`: `world_from_object * point_object = point_world`.

mod camera;
mod channel;
mod distribution;
mod effort;
mod image;
mod instance;
mod java_random;
mod light;
mod material;
mod mesh;
mod object;
mod shape;
mod sun;
mod volume;

pub use camera::{Camera, Lens, Projection};
pub use channel::{BlendItem, Channel, ChannelId, CoordinateMap, NeighbourFilter, NormalMap};
pub use distribution::Distribution;
pub use effort::Effort;
pub use glam::{DAffine3, DMat2, DMat3, DVec2, DVec3};
pub use image::Image;
pub use instance::{Group, GroupId, Instance, transformed_box};
pub use java_random::JavaRandom;
pub use light::{Attenuation, Daylight, Light, LightKind, Sky, SkyRadiance};
pub use material::{Material, Phong};
pub use mesh::{Mesh, VisibleSides};
pub use object::{Emission, Interior, Object, Origin};
pub use shape::Shape;
pub use sun::SunPosition;
pub use volume::{VolumeFunction, WaveForm, WaveStep};

/// A linear Rec. 709 colour or a power, irradiance or radiance in three channels.
pub type Rgb = [f64; 3];

/// Declares an index type, so that an image index can never be used as a material index.
macro_rules! index_type {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);

        impl $name {
            /// The position in the table that this index refers to.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}
pub(crate) use index_type;

index_type!(
    /// Position in [`Scene::materials`].
    MaterialId
);
index_type!(
    /// Position in [`Scene::images`].
    ImageId
);
index_type!(
    /// Position in [`Scene::meshes`].
    MeshId
);
index_type!(
    /// Position in [`Scene::type_names`].
    TypeNameId
);

/// Everything that is needed to make a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// What can be hit by a ray.
    pub objects: Vec<Object>,
    /// Groups of objects that are placed besides.
    pub instances: Vec<Instance>,
    /// What instances place.
    pub groups: Vec<Group>,
    /// Surface descriptions, referred to by [`Object::material`].
    pub materials: Vec<Material>,
    /// Nodes of the channel trees that materials refer to. A node only refers to nodes before it, so that
    /// trees of any depth can be compiled front to back without recursion.
    pub channels: Vec<Channel>,
    /// Pictures used by channels.
    pub images: Vec<Image>,
    /// Triangle meshes used by [`Shape::Mesh`].
    pub meshes: Vec<Mesh>,
    /// Lights without a visible body. Bodies that shine are objects with an [`Emission`].
    pub lights: Vec<Light>,
    /// What a ray sees that hits nothing; black when missing.
    pub sky: Option<Sky>,
    /// Light that is the same everywhere and comes from nowhere, the sum of all ambient lights. It acts in the
    /// ray tracer only; the path tracer computes real ambient light.
    pub ambient: Rgb,
    /// Where the picture is taken from.
    pub camera: Camera,
    /// Names of the types that the objects had in the file they come from; see [`Origin`].
    pub type_names: Vec<String>,
}

impl Scene {
    /// Adds a channel node and returns its index.
    pub fn add_channel(&mut self, channel: Channel) -> ChannelId {
        let id = ChannelId(table_index(self.channels.len()));
        self.channels.push(channel);
        id
    }

    /// Adds a material and returns its index.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        let id = MaterialId(table_index(self.materials.len()));
        self.materials.push(material);
        id
    }

    /// Adds an image and returns its index.
    pub fn add_image(&mut self, image: Image) -> ImageId {
        let id = ImageId(table_index(self.images.len()));
        self.images.push(image);
        id
    }

    /// Adds a mesh and returns its index.
    pub fn add_mesh(&mut self, mesh: Mesh) -> MeshId {
        let id = MeshId(table_index(self.meshes.len()));
        self.meshes.push(mesh);
        id
    }

    /// Adds a group and returns its index.
    pub fn add_group(&mut self, group: Group) -> GroupId {
        let id = GroupId(table_index(self.groups.len()));
        self.groups.push(group);
        id
    }

    /// Number of objects, those of groups counted as often as they are placed.
    pub fn drawn_objects(&self) -> u64 {
        let sizes = instance::group_sizes(&self.groups);
        let placed = self.instances.iter().filter_map(|instance| sizes.get(instance.group.index()));
        placed.fold(self.objects.len() as u64, |all, size| all.saturating_add(*size))
    }

    /// The axis-parallel box round all finite objects in world space as (minimum, maximum), or `None` when
    /// nothing finite is there. Infinite planes are left out.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let groups = instance::group_bounds(&self.groups, &self.meshes);
        let mut bounds = None;
        for object in &self.objects {
            bounds = instance::joined(bounds, object.bounds(&self.meshes));
        }
        for placed in &self.instances {
            let group = groups.get(placed.group.index()).copied().flatten();
            let placed = group.map(|group| transformed_box(group, &placed.world_from_group));
            bounds = instance::joined(bounds, placed);
        }
        bounds
    }
}

/// Tables are indexed with 32 bits, as on the graphics card.
///
/// # Panics
/// If a table would hold more than 2^32 - 1 entries, which no memory of today's machines admits.
fn table_index(len: usize) -> u32 {
    u32::try_from(len).expect("a scene table holds fewer than 2^32 entries")
}
