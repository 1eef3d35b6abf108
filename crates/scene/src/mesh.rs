use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// The sides of its triangles that a mesh shows. In front of a triangle its corners run counter-clockwise (that
/// GroIMP means the same by it is unverified).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum VisibleSides {
    /// Only the front.
    Front,
    /// Only the back.
    Back,
    /// Front and back.
    #[default]
    Both,
}

/// Flat triangles, which may pretend to be smooth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices in object space.
    pub positions: Arc<[[f32; 3]]>,
    /// Three vertex indices per triangle, each below `positions.len()`; counter-clockwise seen from the front.
    pub triangles: Arc<[[u32; 3]]>,
    /// Normals in object space, of any length, one per vertex; empty if every triangle looks flat.
    pub normals: Arc<[[f32; 3]]>,
    /// Texture coordinates (u, v), one per vertex; empty if they are (0, 0) everywhere.
    pub uvs: Arc<[[f32; 2]]>,
}

impl Mesh {
    /// The axis-parallel box of the transformed vertices as (minimum, maximum); `None` if there are none.
    pub fn bounds(&self, world_from_object: &DAffine3) -> Option<(DVec3, DVec3)> {
        (0..self.positions.len())
            .map(|index| world_from_object.transform_point3(self.position(index)))
            .map(|p| (p, p))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// A vertex in object space.
    pub fn position(&self, index: usize) -> DVec3 {
        let [x, y, z] = self.positions[index];
        DVec3::new(x.into(), y.into(), z.into())
    }
}
