//! Transformations whose class is known by nothing but its fields: translation, rotation, scale.

use crate::ReadError;
use crate::field_errors::{number_of, wrong_value};
use crate::graph::Graph;
use crate::values::{Kind, Value, parse_numbers};
use glam::{DAffine3, DMat3, DVec3};

/// The rotation by angles in radians about x, then y, then z: `Rz * Ry * Rx`, as Null's `setRotation`.
pub(crate) fn rotation(angles: DVec3) -> DMat3 {
    DMat3::from_rotation_z(angles.z) * DMat3::from_rotation_y(angles.y) * DMat3::from_rotation_x(angles.x)
}

/// The transformation of an object all of whose fields speak for themselves: first `scale` (one factor or three),
/// then `rotation` (three angles in radians, or an `angle` about an `axis`), then `translation`; the vectors may be
/// given by their components. `None` if there is a field of another name, or none at all.
///
/// Which classes of GroIMP are stored like this, and in which order their parts act, is unverified.
pub(crate) fn transform(graph: &Graph, class: &str, value: &Value) -> Result<Option<DAffine3>, ReadError> {
    let (mut translation, mut angles, mut scale) = (DVec3::ZERO, DVec3::ZERO, DVec3::ONE);
    let mut angle = None;
    let mut axis = DVec3::Z;
    let mut any = false;
    for member in graph.values.iter(value.members) {
        let name = member.name.map_or("", |name| graph.values.name(name));
        if member.kind == Kind::Null {
            continue;
        }
        any = true;
        let number = || number_of(graph, member, class, name);
        let vector = || match parse_numbers(member.text()).as_deref() {
            Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
            Some(&[all]) if name == "scale" => Ok(DVec3::splat(all)),
            _ => Err(wrong_value(graph, member, class, name, "three numbers")),
        };
        match name {
            "translation" => translation = vector()?,
            "translationX" | "translateX" | "x" => translation.x = number()?,
            "translationY" | "translateY" | "y" => translation.y = number()?,
            "translationZ" | "translateZ" | "z" => translation.z = number()?,
            "rotation" => angles = vector()?,
            "rotationX" | "rotateX" => angles.x = number()?,
            "rotationY" | "rotateY" => angles.y = number()?,
            "rotationZ" | "rotateZ" => angles.z = number()?,
            "angle" => angle = Some(number()?),
            "axis" => axis = vector()?,
            "scale" => scale = vector()?,
            "scaleX" => scale.x = number()?,
            "scaleY" => scale.y = number()?,
            "scaleZ" => scale.z = number()?,
            _ => return Ok(None),
        }
    }
    if !any {
        return Ok(None);
    }
    let turn = match angle {
        Some(angle) => match axis.try_normalize() {
            Some(axis) => DMat3::from_axis_angle(axis, angle),
            None => return Ok(None),
        },
        None => rotation(angles),
    };
    Ok(Some(
        DAffine3::from_translation(translation) * DAffine3::from_mat3(turn) * DAffine3::from_scale(scale),
    ))
}
