//! Geometry of nodes that are drawn.

use crate::ReadError;
use crate::classes::AxisShape;
use crate::fields::Fields;
use glam::{DAffine3, DVec3};
use scene::Shape;

/// A shape and where it lies in the node's own frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Geometry {
    pub shape: Shape,
    pub own_from_object: DAffine3,
}

impl Geometry {
    fn in_place(shape: Shape) -> Self {
        Geometry { shape, own_from_object: DAffine3::IDENTITY }
    }
}

/// A sphere, `None` if it has no extent. A negative radius counts as positive.
pub(crate) fn sphere(fields: &Fields<'_>) -> Result<Option<Geometry>, ReadError> {
    let radius = fields.number("radius", 1.0)?.abs();
    Ok(extended(&[radius]).then(|| Geometry::in_place(Shape::Sphere { radius })))
}

/// The cylinder of a turtle shoot.
pub(crate) fn shoot(length: f64, diameter: f64) -> Option<Geometry> {
    cylinder(length, 0.5 * diameter, [false; 3])
}

/// A shape with a length, `None` if it has no extent.
pub(crate) fn axis_shape(shape: AxisShape, fields: &Fields<'_>) -> Result<Option<Geometry>, ReadError> {
    let length = fields.number("length", 1.0)?;
    let flag = |name| fields.flag(name, false);
    let scale_v = if shape == AxisShape::Box { false } else { flag("scaleV")? };
    Ok(match shape {
        AxisShape::Box => {
            let (width, height) = (fields.number("width", 1.0)?.abs(), fields.number("height", 1.0)?.abs());
            extended(&[width, height, length])
                .then(|| mirrored(length, |length| Shape::Box { width, height, length }))
        }
        AxisShape::Cylinder => {
            cylinder(length, fields.number("radius", 1.0)?, [flag("baseOpen")?, flag("topOpen")?, scale_v])
        }
        AxisShape::Cone => {
            let radius = fields.number("radius", 1.0)?.abs();
            let open = flag("open")?;
            extended(&[radius, length])
                .then(|| mirrored(length, |length| Shape::Cone { radius, length, open, scale_v }))
        }
        AxisShape::Frustum => {
            let base_radius = fields.number("baseRadius", 1.0)?.abs();
            let top_radius = fields.number("topRadius", 0.5)?.abs();
            let (base_open, top_open) = (flag("baseOpen")?, flag("topOpen")?);
            let finite = base_radius.is_finite() && top_radius.is_finite();
            (finite && extended(&[base_radius.max(top_radius), length])).then(|| {
                mirrored(length, |length| Shape::Frustum {
                    base_radius,
                    top_radius,
                    length,
                    base_open,
                    top_open,
                    scale_v,
                })
            })
        }
        AxisShape::Parallelogram => parallelogram(length, fields.vector("axis", DVec3::X)?, scale_v),
    })
}

fn cylinder(length: f64, radius: f64, [base_open, top_open, scale_v]: [bool; 3]) -> Option<Geometry> {
    let radius = radius.abs();
    extended(&[radius, length])
        .then(|| mirrored(length, |length| Shape::Cylinder { radius, length, base_open, top_open, scale_v }))
}

fn parallelogram(length: f64, axis: DVec3, scale_v: bool) -> Option<Geometry> {
    if !extended(&[length, axis.x.hypot(axis.y)]) || !axis.z.is_finite() {
        return None;
    }
    if length > 0.0 {
        return Some(Geometry::in_place(Shape::Parallelogram { length, axis, scale_v }));
    }
    // A half turn about x makes the length positive and, unlike mirroring, swaps front and back, as
    // z × axis does when z changes its sign.
    let half_turn = DVec3::new(1.0, -1.0, -1.0);
    let shape = Shape::Parallelogram { length: -length, axis: axis * half_turn, scale_v };
    Some(Geometry { shape, own_from_object: DAffine3::from_scale(half_turn) })
}

/// That a negative length draws the shape between `length` and 0 is unverified.
fn mirrored(length: f64, shape: impl FnOnce(f64) -> Shape) -> Geometry {
    let flip = DVec3::new(1.0, 1.0, length.signum());
    Geometry { shape: shape(length.abs()), own_from_object: DAffine3::from_scale(flip) }
}

/// Whether all sizes are numbers other than 0.
fn extended(sizes: &[f64]) -> bool {
    sizes.iter().all(|size| size.is_finite() && *size != 0.0)
}

/// Whether a frame keeps volume: nothing flattened, nothing beyond the range of numbers.
pub(crate) fn is_invertible(frame: &DAffine3) -> bool {
    let m = frame.matrix3;
    // Uniform scaling must not matter, so compare with the volume of an upright box of the same edges.
    let volume = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    frame.is_finite() && volume > 0.0 && m.determinant().abs() > 1e-12 * volume && frame.inverse().is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_length_covers_the_same_points() {
        let down = cylinder(-2.0, -0.5, [false; 3]).unwrap();
        assert!(matches!(down.shape, Shape::Cylinder { radius: 0.5, length: 2.0, .. }));
        assert_eq!(
            down.own_from_object.transform_point3(DVec3::new(0.0, 0.0, 2.0)),
            DVec3::new(0.0, 0.0, -2.0)
        );
        let axis = DVec3::new(1.0, 0.5, 0.25);
        let leaf = parallelogram(-2.0, axis, false).unwrap();
        let Shape::Parallelogram { length, axis: turned, .. } = leaf.shape else { panic!("{leaf:?}") };
        let own = |p| leaf.own_from_object.transform_vector3(p);
        assert_eq!((own(turned), own(DVec3::Z * length)), (axis, DVec3::Z * -2.0));
        // Front side: z × axis with the length as stored.
        assert_eq!(own((DVec3::Z * length).cross(turned)), (DVec3::Z * -2.0).cross(axis));
    }

    #[test]
    fn flat_things_are_recognised() {
        assert!(cylinder(1.0, 0.0, [false; 3]).is_none());
        assert!(cylinder(f64::NAN, 1.0, [false; 3]).is_none());
        assert!(parallelogram(1.0, DVec3::Z, false).is_none());
        assert!(is_invertible(&DAffine3::from_scale(DVec3::splat(1e-6))));
        assert!(!is_invertible(&DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))));
        assert!(!is_invertible(&DAffine3::from_translation(DVec3::splat(f64::NAN))));
    }
}
