//! The unit shapes of the kernels that stand for the shapes of a scene, and their boxes.

use super::affine;
use kernels::records::kernel::{
    FLAG_BASE_OPEN, FLAG_TOP_OPEN, NONE, SHAPE_BOX, SHAPE_FRUSTUM, SHAPE_PARALLELOGRAM, SHAPE_PLANE,
    SHAPE_SPHERE, SHAPE_TRIANGLE,
};
use scene::{DAffine3, DMat3, DVec3, Object, Shape};

/// A unit shape of the kernels and its placement.
pub(super) struct UnitShape {
    pub kind: u32,
    pub local_from_unit: DAffine3,
    pub base_radius: f64,
    pub top_radius: f64,
    pub v_scale: f64,
    /// First entry in the table of attributes, or `NONE`; see the kernels' modules `mesh` and `coordinates`.
    pub attributes: u32,
}

/// A frustum whose radii differ by less than this fraction is a cylinder (scene-format.md 4.1).
const NEAR_CYLINDER: f64 = 1e-3;
/// A frustum whose smaller radius is less than this fraction of the other is a cone.
const NEAR_CONE: f64 = 1e-3;

/// Rows of the matrix from a unit shape to the frame of its object, for channels that look at the position.
pub(super) fn object_from_unit(unit: &UnitShape, local_from_object: &DAffine3) -> [[f32; 4]; 3] {
    let rows = affine(&(local_from_object.inverse() * unit.local_from_unit));
    [rows.row0, rows.row1, rows.row2].map(|row| [row.x, row.y, row.z, row.w])
}

/// The unit shape of an analytic object.
///
/// # Panics
/// For meshes, which consist of many.
pub(super) fn unit_shape(object: &Object, local_from_object: &DAffine3) -> UnitShape {
    let scaled = |kind: u32, scale: DVec3, z: f64| UnitShape {
        kind,
        local_from_unit: *local_from_object
            * DAffine3::from_translation(DVec3::new(0.0, 0.0, z))
            * DAffine3::from_scale(scale),
        base_radius: 1.0,
        top_radius: 1.0,
        v_scale: 1.0,
        attributes: NONE,
    };
    let round = |base: f64, top: f64, length: f64, base_open: bool, top_open: bool, scale_v: bool| {
        let radius = base.max(top);
        let flags = if base_open { FLAG_BASE_OPEN } else { 0 } | if top_open { FLAG_TOP_OPEN } else { 0 };
        let (base, top) = regular_radii(base / radius, top / radius);
        UnitShape {
            base_radius: base,
            top_radius: top,
            v_scale: if scale_v { length } else { 1.0 },
            ..scaled(SHAPE_FRUSTUM | flags, DVec3::new(radius, radius, length), 0.0)
        }
    };
    match object.shape {
        Shape::Sphere { radius } => scaled(SHAPE_SPHERE, DVec3::splat(radius), 0.0),
        Shape::Box { width, height, length } => {
            scaled(SHAPE_BOX, 0.5 * DVec3::new(width, height, length), 0.5 * length)
        }
        Shape::Cylinder { radius, length, base_open, top_open, scale_v } => {
            round(radius, radius, length, base_open, top_open, scale_v)
        }
        // A cone has no surface at its apex.
        Shape::Cone { radius, length, open, scale_v } => round(radius, 0.0, length, open, true, scale_v),
        Shape::Frustum { base_radius, top_radius, length, base_open, top_open, scale_v } => {
            round(base_radius, top_radius, length, base_open, top_open, scale_v)
        }
        Shape::Plane => scaled(SHAPE_PLANE, DVec3::ONE, 0.0),
        Shape::Parallelogram { length, axis, scale_v } => {
            let u = local_from_object.transform_vector3(axis);
            let v = local_from_object.transform_vector3(DVec3::new(0.0, 0.0, length));
            let mut unit = flat(
                SHAPE_PARALLELOGRAM,
                local_from_object.translation,
                u,
                v,
                local_from_object.matrix3.determinant().signum() * length.signum(),
            );
            unit.v_scale = if scale_v { length } else { 1.0 };
            unit
        }
        Shape::Mesh { .. } => unreachable!("meshes are compiled triangle by triangle"),
    }
}

fn regular_radii(base: f64, top: f64) -> (f64, f64) {
    if (base - top).abs() <= NEAR_CYLINDER {
        return (1.0, 1.0);
    }
    let regular = |radius: f64| if radius < NEAR_CONE { 0.0 } else { radius };
    (regular(base), regular(top))
}

/// A flat shape spanned by `u` along unit x and `v` along unit z. Unit y is the unit normal, so that distances
/// from the plane are in metres; it points to v × u, or the other way for `side` -1.
pub(super) fn flat(kind: u32, origin: DVec3, u: DVec3, v: DVec3, side: f64) -> UnitShape {
    // A triangle a, b, c is counter-clockwise round (b - a) × (c - a), a parallelogram's front is z × axis.
    let normal = if kind == SHAPE_TRIANGLE { u.cross(v) } else { v.cross(u) };
    UnitShape {
        kind,
        local_from_unit: DAffine3::from_mat3_translation(
            DMat3::from_cols(u, normal.normalize_or_zero() * side, v),
            origin,
        ),
        base_radius: 1.0,
        top_radius: 1.0,
        v_scale: 1.0,
        attributes: NONE,
    }
}

/// Tight box of a placed unit shape as (minimum, maximum); `None` if it is infinite.
pub(super) fn unit_bounds(unit: &UnitShape) -> Option<(DVec3, DVec3)> {
    let m = unit.local_from_unit.matrix3;
    let centre = unit.local_from_unit.translation;
    match unit.kind & kernels::records::kernel::SHAPE_MASK {
        SHAPE_SPHERE => {
            // Extent of an ellipsoid along an axis: the length of that row of the matrix.
            let rows = m.transpose();
            let extent = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
            Some((centre - extent, centre + extent))
        }
        SHAPE_BOX => {
            let extent = m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs();
            Some((centre - extent, centre + extent))
        }
        SHAPE_FRUSTUM => {
            // Hull of the two end discs.
            let disc = |middle: DVec3, radius: f64| {
                let x = m.x_axis * radius;
                let y = m.y_axis * radius;
                let extent = DVec3::new(x.x.hypot(y.x), x.y.hypot(y.y), x.z.hypot(y.z));
                (middle - extent, middle + extent)
            };
            let base = disc(centre, unit.base_radius);
            let top = disc(centre + m.z_axis, unit.top_radius);
            Some((base.0.min(top.0), base.1.max(top.1)))
        }
        SHAPE_PARALLELOGRAM => Some(hull([
            centre - m.x_axis,
            centre + m.x_axis,
            centre + m.x_axis + m.z_axis,
            centre - m.x_axis + m.z_axis,
        ])),
        SHAPE_TRIANGLE => Some(hull([centre, centre + m.x_axis, centre + m.z_axis, centre])),
        _ => None,
    }
}

fn hull(corners: [DVec3; 4]) -> (DVec3, DVec3) {
    let low = corners.into_iter().fold(corners[0], DVec3::min);
    let high = corners.into_iter().fold(corners[0], DVec3::max);
    (low, high)
}
