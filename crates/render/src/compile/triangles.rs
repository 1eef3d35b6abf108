//! Triangles of a mesh as unit shapes, with their entries in the table of attributes.

use super::count;
use super::unit_shapes::{UnitShape, flat, object_from_unit};
use kernels::records::kernel::{FLAG_BACK_HIDDEN, FLAG_FRONT_HIDDEN, SHAPE_TRIANGLE};
use scene::{DAffine3, DVec3, Mesh, VisibleSides};

/// Square of the double area in m² below which a triangle is left out. Imported meshes contain triangles without
/// area; they are invisible. The bound keeps the inverse matrices of the others within the range of 32-bit floats.
const NO_AREA: f64 = 1e-60;

/// The triangles of a mesh that have an area, one by one; what they need of attributes is appended to the table,
/// their frames included if the material looks at the position.
pub(super) fn placed_triangles<'a>(
    mesh: &'a Mesh,
    visible_sides: VisibleSides,
    local_from_object: &'a DAffine3,
    uses_position: bool,
    attributes: &'a mut Vec<[f32; 4]>,
) -> impl Iterator<Item = UnitShape> + 'a {
    let hidden = match visible_sides {
        VisibleSides::Front => FLAG_BACK_HIDDEN,
        VisibleSides::Back => FLAG_FRONT_HIDDEN,
        VisibleSides::Both => 0,
    };
    // The front stays outward when the mesh is mirrored, as with all shapes.
    let side = local_from_object.matrix3.determinant().signum();
    // Carries normals: the transposed inverse, up to a factor, which may be negative.
    let carry = local_from_object.matrix3.inverse().transpose();
    mesh.triangles.iter().enumerate().filter_map(move |(number, triangle)| {
        let [a, b, c] =
            triangle.map(|vertex| local_from_object.transform_point3(mesh.position(vertex as usize)));
        if (b - a).cross(c - a).length_squared() <= NO_AREA {
            return None;
        }
        let mut unit = flat(SHAPE_TRIANGLE, a, b - a, c - a, side);
        unit.kind |= hidden;
        unit.top_radius = number as f64;
        if uses_position || !(mesh.normals.is_empty() && mesh.uvs.is_empty()) {
            unit.attributes = count(attributes.len());
            attributes.extend(corner_attributes(mesh, *triangle, |normal| carry * normal));
        }
        if uses_position {
            attributes.extend(object_from_unit(&unit, local_from_object));
        }
        Some(unit)
    })
}

/// The entries of a triangle, as the kernels' module `mesh` describes them; `carry` takes normals to the space of
/// the compiled scene.
fn corner_attributes(mesh: &Mesh, triangle: [u32; 3], carry: impl Fn(DVec3) -> DVec3) -> [[f32; 4]; 4] {
    let uvs = triangle.map(|vertex| mesh.uvs.get(vertex as usize).copied().unwrap_or_default());
    let normals = triangle.map(|vertex| {
        let stored = mesh.normals.get(vertex as usize).copied().unwrap_or_default();
        carry(DVec3::from_array(stored.map(f64::from))).normalize_or_zero()
    });
    // One missing normal would tilt the whole triangle.
    let smooth = normals.iter().all(|normal| *normal != DVec3::ZERO);
    let corner = |i: usize| {
        let [x, y, z] = normals[i].to_array().map(|component| component as f32);
        [x, y, z, uvs[i][0]]
    };
    let last = [uvs[0][1], uvs[1][1], uvs[2][1], if smooth { 1.0 } else { 0.0 }];
    [corner(0), corner(1), corner(2), last]
}
