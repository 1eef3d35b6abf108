use crate::{MaterialId, Mesh, Rgb, Shape, TypeNameId};
use glam::{DAffine3, DVec3};

/// Something that a ray can hit.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Geometry in object space.
    pub shape: Shape,
    /// Placement. Mirroring and shearing are allowed; normals stay outward.
    pub world_from_object: DAffine3,
    /// How its surface looks.
    pub material: MaterialId,
    /// Set when the body is a lamp.
    pub emission: Option<Emission>,
    /// What the body is filled with; `None` if its surface does not bound a medium, as that of a leaf.
    pub interior: Option<Interior>,
    /// Where it comes from.
    pub origin: Origin,
}

/// Light that leaves the front side of a body.
///
/// Radiance at the angle t from the normal: `power / area * (exponent + 2) / (2 pi) * cos(t)^exponent`
/// (GroIMP's `AreaLight`; exponent 0 is Lambertian).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Emitted power in W per channel.
    pub power: Rgb,
    /// Concentration round the normal, at least 0.
    pub exponent: f64,
    /// Lights everything, also what stands behind something else.
    pub shadowless: bool,
}

/// What a body is filled with, GroIMP's `IOR`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// Refractive index, positive; 1 like empty space.
    pub refractive_index: f64,
}

/// Where an object comes from, so that pictures and measurements can name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Origin {
    /// Id of the node in the file; for GroIMP the `id` of the graph node.
    pub node: i64,
    /// The type it had there.
    pub type_name: TypeNameId,
}

impl Object {
    /// The axis-parallel box round the object in world space as (minimum, maximum); `None` if it is infinite
    /// or empty.
    pub fn bounds(&self, meshes: &[Mesh]) -> Option<(DVec3, DVec3)> {
        if let Shape::Mesh { mesh: id, .. } = self.shape {
            // The box of the vertices is tighter than the box of the transformed box.
            return meshes.get(id.index())?.bounds(&self.world_from_object);
        }
        Some(crate::transformed_box(self.shape.bounds()?, &self.world_from_object))
    }
}
