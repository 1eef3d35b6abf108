//! Which of GroIMP's classes a node type is.

use crate::turtle_state::StateCommand;

/// What a node does to its frame, to the turtle and to the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// Neither draws nor moves: Node, Axiom, ...
    Plain,
    /// Start of the model: sets the turtle state.
    RggRoot,
    /// Null, ShadedNull.
    Null,
    Sphere,
    Plane,
    LightNode,
    Sky,
    /// MeshNode.
    Mesh,
    Axis(AxisShape),
    /// Turtle command that draws a cylinder.
    Shoot(Amount),
    /// Turtle command that moves along the head.
    Move(Amount),
    Rotation(Axis),
    /// Rotate about x, y, z one after another.
    RotateXyz,
    Scale,
    Translate,
    AdjustLu,
    /// RV and its relatives.
    Gravity(Amount),
    /// RG.
    HeadDown,
    /// RD.
    Directional,
    /// RP.
    TowardsPoint,
    /// RO.
    Orthogonal,
    State(StateCommand),
    Line,
    /// Instance3D.
    Instance,
    /// GridClonerNode.
    GridCloner,
    /// Known and placed like Null, but not drawn.
    Skipped(Skip),
    /// Turns or moves the turtle in a way that is not known here.
    UnknownTurn,
}

/// Shapes with a length along z, at whose end their children start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AxisShape {
    Box,
    Cylinder,
    Cone,
    Frustum,
    Parallelogram,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

/// How a turtle command gets its amount.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Amount {
    /// Its own field.
    Field,
    /// The turtle state.
    State,
    /// State plus field.
    Add,
    /// State times field.
    Mul,
    /// Back or forth to a fraction of the last shoot.
    Relative,
}

/// Why a known class is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Skip {
    /// Drawn in the editor only.
    NotVisible,
    /// Visible, but not read yet. The flag tells whether its layer is 1 by default.
    NotYet { layer_one: bool },
}

impl Skip {
    pub fn reason(self) -> &'static str {
        match self {
            Skip::NotVisible => "not visible in a picture",
            Skip::NotYet { .. } => "not supported yet",
        }
    }
}

impl Class {
    /// Layer of a node that names none.
    pub fn default_layer(self) -> f64 {
        match self {
            Class::Mesh | Class::Skipped(Skip::NotYet { layer_one: true }) => 1.0,
            _ => 0.0,
        }
    }

    /// Whether nodes of the class may carry a shader, for themselves and everything below.
    pub fn has_shader(self) -> bool {
        matches!(
            self,
            Class::Null
                | Class::Sphere
                | Class::Plane
                | Class::LightNode
                | Class::Sky
                | Class::Mesh
                | Class::Axis(_)
                | Class::Instance
                | Class::Skipped(_)
        )
    }

    /// The class of a full type name; `None` if it is not one of GroIMP's.
    pub fn of(type_name: &str) -> Option<Class> {
        let (package, name) = type_name.rsplit_once('.')?;
        match package {
            // Old files have the turtle commands in another package.
            "de.grogra.turtle" | "de.grogra.lsystem" => turtle(name),
            "de.grogra.imp3d.objects" => object(name),
            "de.grogra.graph.impl" => matches!(name, "Node" | "SharedObjectNode").then_some(Class::Plain),
            "de.grogra.rgg" => match name {
                "RGGRoot" => Some(Class::RggRoot),
                "Axiom" | "SRoot" => Some(Class::Plain),
                "Surface" => object("NURBSSurface"),
                _ => None,
            },
            "de.grogra.rgg.multiscale" => Some(Class::Plain),
            _ => None,
        }
    }
}

fn object(name: &str) -> Option<Class> {
    Some(match name {
        "Null" | "ShadedNull" | "NullWithShader" => Class::Null,
        "Sphere" => Class::Sphere,
        "Plane" => Class::Plane,
        "LightNode" => Class::LightNode,
        "Sky" => Class::Sky,
        "Box" => Class::Axis(AxisShape::Box),
        "Cylinder" => Class::Axis(AxisShape::Cylinder),
        "Cone" => Class::Axis(AxisShape::Cone),
        "Frustum" => Class::Axis(AxisShape::Frustum),
        "Parallelogram" => Class::Axis(AxisShape::Parallelogram),
        "Line" => Class::Line,
        "Point" | "PointCloud" | "TextLabel" | "NURBSCurve" | "SensorNode" | "SensorNodeGrid"
        | "SensorAreaGrid" => Class::Skipped(Skip::NotVisible),
        "Instance3D" => Class::Instance,
        "GridClonerNode" => Class::GridCloner,
        "MeshNode" => Class::Mesh,
        "NURBSSurface" | "Patch" | "Polygon" => Class::Skipped(Skip::NotYet { layer_one: true }),
        "SphereSegmentSolid" | "Supershape" | "Lamella" => Class::Skipped(Skip::NotYet { layer_one: false }),
        _ => return None,
    })
}

fn turtle(name: &str) -> Option<Class> {
    Some(match name {
        "F" => Class::Shoot(Amount::Field),
        "F0" => Class::Shoot(Amount::State),
        "FAdd" => Class::Shoot(Amount::Add),
        "FMul" => Class::Shoot(Amount::Mul),
        "M" => Class::Move(Amount::Field),
        "M0" => Class::Move(Amount::State),
        "MAdd" => Class::Move(Amount::Add),
        "MMul" => Class::Move(Amount::Mul),
        "MRel" => Class::Move(Amount::Relative),
        "RL" => Class::Rotation(Axis::X),
        // The constructor of Minus has negated the angle already.
        "RU" | "Plus" | "Minus" => Class::Rotation(Axis::Y),
        "RH" => Class::Rotation(Axis::Z),
        "Rotate" => Class::RotateXyz,
        "Scale" => Class::Scale,
        "Translate" => Class::Translate,
        "AdjustLU" => Class::AdjustLu,
        "RV" => Class::Gravity(Amount::Field),
        "RV0" => Class::Gravity(Amount::State),
        "RVAdd" => Class::Gravity(Amount::Add),
        "RVMul" => Class::Gravity(Amount::Mul),
        "RG" => Class::HeadDown,
        "RD" => Class::Directional,
        "RP" => Class::TowardsPoint,
        "RO" => Class::Orthogonal,
        // The axes of these aliases are unverified; RN points to a node.
        "RN" | "Left" | "Right" | "Up" | "Down" => Class::UnknownTurn,
        "OR" => Class::Plain,
        _ => return StateCommand::named(name).map(Class::State),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_names_are_known() {
        assert_eq!(Class::of("de.grogra.lsystem.F"), Class::of("de.grogra.turtle.F"));
        assert_eq!(Class::of("de.grogra.imp3d.objects.NullWithShader"), Some(Class::Null));
        assert_eq!(Class::of("test$Node"), None);
        assert_eq!(Class::of("de.grogra.turtle.Quux"), None);
    }
}
