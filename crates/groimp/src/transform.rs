//! The two frames of a node: its own, in which its geometry lives, and the one from which its children start.

use crate::ReadError;
use crate::classes::{Amount, Axis, AxisShape, Class};
use crate::fields::Fields;
use crate::turtle_state::TurtleState;
use glam::{DAffine3, DMat3, DVec3};

/// Frames of a node in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frames {
    /// Frame of the geometry.
    pub own: DAffine3,
    /// Frame of the children.
    pub post: DAffine3,
}

/// Something about a transformation that could not be honoured.
pub(crate) type Oddity = Option<String>;

/// Length of a shoot or a move along the head.
pub(crate) fn turtle_length(
    fields: &Fields<'_>,
    amount: Amount,
    state: &TurtleState,
) -> Result<f64, ReadError> {
    let last = state.length.local;
    Ok(match amount {
        Amount::Field => fields.number("length", 1.0)?,
        // Which of the two values M0 takes is unverified.
        Amount::State => last,
        // Add and Mul are unverified.
        Amount::Add => last + fields.number("argument", fields.number("length", 0.0)?)?,
        Amount::Mul => last * fields.number("argument", fields.number("length", 1.0)?)?,
        // Name and default of the field are unverified.
        Amount::Relative => last * (fields.number("argument", fields.number("x", 1.0)?)? - 1.0),
    })
}

/// The frames of a node below the frame `parent`.
pub(crate) fn frames(
    class: Class,
    fields: &Fields<'_>,
    parent: DAffine3,
    state: &TurtleState,
) -> Result<(Frames, Oddity), ReadError> {
    let after = |post: DAffine3| Ok((Frames { own: parent, post }, None));
    let angle = |name: &str| Ok::<f64, ReadError>(fields.number(name, 0.0)?.to_radians());
    match class {
        Class::Plain | Class::RggRoot | Class::State(_) => after(parent),
        Class::UnknownTurn => {
            let oddity = "its rotation is not known and left out".to_owned();
            Ok((Frames { own: parent, post: parent }, Some(oddity)))
        }
        Class::Null
        | Class::Sphere
        | Class::Plane
        | Class::LightNode
        | Class::Sky
        | Class::Mesh
        | Class::Axis(_)
        | Class::Line
        | Class::Instance
        | Class::GridCloner
        | Class::Skipped(_) => placed(class, fields, parent),
        Class::Shoot(amount) | Class::Move(amount) => {
            after(parent * along_z(turtle_length(fields, amount, state)?))
        }
        Class::Rotation(Axis::X) => after(parent * DAffine3::from_rotation_x(angle("angle")?)),
        Class::Rotation(Axis::Y) => after(parent * DAffine3::from_rotation_y(angle("angle")?)),
        Class::Rotation(Axis::Z) => after(parent * DAffine3::from_rotation_z(angle("angle")?)),
        Class::RotateXyz => after(
            parent
                * DAffine3::from_rotation_x(angle("rotateX")?)
                * DAffine3::from_rotation_y(angle("rotateY")?)
                * DAffine3::from_rotation_z(angle("rotateZ")?),
        ),
        Class::Scale => {
            let scale = xyz(fields, ["scaleX", "scaleY", "scaleZ"], 1.0)?;
            after(parent * DAffine3::from_scale(scale))
        }
        Class::Translate => {
            let offset = xyz(fields, ["translateX", "translateY", "translateZ"], 0.0)?;
            let own = parent * DAffine3::from_translation(offset);
            Ok((Frames { own, post: own }, None))
        }
        Class::AdjustLu => {
            let m = parent.matrix3;
            after(parent * DAffine3::from_rotation_z((-m.x_axis.z).atan2(m.y_axis.z)))
        }
        Class::Gravity(amount) => {
            let tropism = state.tropism.local;
            let strength = match amount {
                Amount::Field => fields.number("argument", 0.0)?,
                Amount::State => tropism,
                // Unverified.
                Amount::Add => tropism + fields.number("argument", 0.0)?,
                Amount::Mul | Amount::Relative => tropism * fields.number("argument", 1.0)?,
            };
            after(turned(parent, gravity(head(&parent), strength)))
        }
        Class::HeadDown => after(turned(parent, gravity(head(&parent), 1e10))),
        Class::Directional => {
            let direction = fields.vector("direction", DVec3::ZERO)?;
            after(turned(parent, towards(head(&parent), direction, fields.number("strength", 0.01)?)))
        }
        Class::TowardsPoint => {
            let target = fields.vector("target", DVec3::ZERO)?;
            let direction = (target - parent.translation).normalize_or_zero();
            after(turned(parent, towards(head(&parent), direction, fields.number("strength", 0.01)?)))
        }
        Class::Orthogonal => {
            let direction = fields.vector("direction", DVec3::ZERO)?;
            let head = head(&parent);
            let angle = -fields.number("strength", 0.01)? * head.dot(direction);
            after(turned(parent, about(head.cross(direction), angle)))
        }
    }
}

/// Frames of nodes with the field `transform`.
fn placed(class: Class, fields: &Fields<'_>, parent: DAffine3) -> Result<(Frames, Oddity), ReadError> {
    let (transform, unknown) = fields.transform()?;
    let transforming = fields.flag("transforming", class != Class::Line)?;
    let mut own = parent * transform;
    let mut end = DAffine3::IDENTITY;
    if let Class::Axis(shape) = class {
        let length = fields.number("length", 1.0)?;
        let start = fields.number("startPosition", 0.0)?;
        let pivot = if shape == AxisShape::Box && fields.flag("shiftPivot", false)? {
            0.5 * fields.number("width", 1.0)?
        } else {
            0.0
        };
        own *= along_z(start * length - pivot);
        end = along_z((fields.number("endPosition", 1.0)? - start) * length + pivot);
    } else if class == Class::Line {
        end = DAffine3::from_translation(fields.vector("axis", DVec3::Z)?);
    }
    let post = if transforming { own * end } else { parent };
    let oddity = unknown.map(|class| format!("its transform of class '{class}' is not known and left out"));
    Ok((Frames { own, post }, oddity))
}

fn along_z(distance: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(0.0, 0.0, distance))
}

fn xyz(fields: &Fields<'_>, names: [&str; 3], default: f64) -> Result<DVec3, ReadError> {
    let [x, y, z] = names;
    Ok(DVec3::new(fields.number(x, default)?, fields.number(y, default)?, fields.number(z, default)?))
}

/// Global direction of the turtle's head.
fn head(frame: &DAffine3) -> DVec3 {
    frame.matrix3.z_axis.normalize_or_zero()
}

/// The frame with its linear part turned in world space; its position stays.
fn turned(frame: DAffine3, rotation: DMat3) -> DAffine3 {
    DAffine3 { matrix3: rotation * frame.matrix3, translation: frame.translation }
}

/// Gravitropism: bends the head `v` towards `v - strength * z`. The formula is unverified.
fn gravity(v: DVec3, strength: f64) -> DMat3 {
    if v.x * v.x + v.y * v.y < 1e-10 || v.z * v.z > 0.99999 {
        let flips = v.z * (v.z - strength) < 0.0;
        return if flips { DMat3::from_rotation_x(std::f64::consts::PI) } else { DMat3::IDENTITY };
    }
    let w = (v - DVec3::new(0.0, 0.0, strength)).normalize_or_zero();
    // The cosine loses small angles, so take both.
    about(v.cross(w), v.cross(w).length().atan2(v.dot(w)))
}

/// Tropism towards a direction, which counts with its length.
fn towards(v: DVec3, direction: DVec3, strength: f64) -> DMat3 {
    let axis = v.cross(direction);
    about(axis, strength * axis.length())
}

/// Rotation about an axis of any length; none if the axis is too short to have a direction.
fn about(axis: DVec3, angle: f64) -> DMat3 {
    if axis.length() < 1e-10 || !axis.is_finite() || !angle.is_finite() {
        return DMat3::IDENTITY;
    }
    DMat3::from_axis_angle(axis.normalize(), angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: DVec3, b: DVec3) {
        assert!((a - b).length() < 1e-9, "{a} is not {b}");
    }

    #[test]
    fn positive_gravity_bends_down_and_negative_up() {
        let v = DVec3::X;
        near(gravity(v, 1.0) * v, DVec3::new(1.0, 0.0, -1.0).normalize());
        near(gravity(v, -0.1) * v, DVec3::new(1.0, 0.0, 0.1).normalize());
        near(gravity(v, 1e10) * v, -DVec3::Z);
        assert_eq!(gravity(DVec3::Z, 0.5), DMat3::IDENTITY);
        near(gravity(DVec3::Z, 2.0) * DVec3::Z, -DVec3::Z);
    }

    #[test]
    fn directional_tropism_turns_by_the_sine() {
        let turned = towards(DVec3::Z, DVec3::X, 0.5) * DVec3::Z;
        near(turned, DVec3::new(0.5f64.sin(), 0.0, 0.5f64.cos()));
        assert_eq!(towards(DVec3::Z, DVec3::Z, 0.5), DMat3::IDENTITY);
    }
}
