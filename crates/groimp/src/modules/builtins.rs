//! The classes, constructors, setters and shader names that models use without declaring them.

/// What a constructor argument sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Target {
    Field(&'static str),
    /// One component of a vector field.
    Component(&'static str, usize),
    /// Half of the argument is the x component of `axis` (the width of a parallelogram).
    HalfAxis,
    /// The field gets the negative value.
    Negated(&'static str),
    /// `scaleX`, `scaleY` and `scaleZ`.
    AllScales,
    /// `argument` and `shader` of the colour commands.
    Colour,
    /// No field that decides about the picture.
    Nothing,
}

use Target::{AllScales, Colour, Component, Field, HalfAxis, Negated, Nothing};

const OBJECTS: &str = "de.grogra.imp3d.objects.";
const TURTLE: &str = "de.grogra.turtle.";
const SHADING: &str = "de.grogra.imp3d.shading.";

/// The class of a module without `extends`.
pub(super) const NODE: &str = "de.grogra.graph.impl.Node";

const OBJECT_CLASSES: [&str; 31] = [
    "Null",
    "ShadedNull",
    "ColoredNull",
    "Sphere",
    "Box",
    "Cylinder",
    "Cone",
    "Frustum",
    "Plane",
    "Parallelogram",
    "SphereSegmentSolid",
    "Supershape",
    "Lamella",
    "MeshNode",
    "Patch",
    "Polygon",
    "NURBSSurface",
    "NURBSCurve",
    "Point",
    "PointCloud",
    "Line",
    "TextLabel",
    "SensorNode",
    "SensorNodeGrid",
    "SensorAreaGrid",
    "Sky",
    "Instance3D",
    "GridClonerNode",
    "LightNode",
    "ImageHeightField",
    "PolygonMesh",
];

const LIGHT_CLASSES: [&str; 5] = ["PointLight", "SpotLight", "DirectionalLight", "AmbientLight", "AreaLight"];

const TURTLE_CLASSES: [&str; 32] = [
    "F",
    "F0",
    "FAdd",
    "FMul",
    "M",
    "M0",
    "MAdd",
    "MMul",
    "MRel",
    "RL",
    "RU",
    "RH",
    "Plus",
    "Minus",
    "Left",
    "Right",
    "Up",
    "Down",
    "AdjustLU",
    "Translate",
    "Scale",
    "Rotate",
    "RV",
    "RV0",
    "RVAdd",
    "RVMul",
    "RG",
    "RD",
    "RP",
    "RN",
    "RO",
    "OR",
];

const OTHER_CLASSES: [(&str, &str); 9] = [
    ("Node", NODE),
    ("SharedObjectNode", "de.grogra.graph.impl.SharedObjectNode"),
    ("RGGRoot", "de.grogra.rgg.RGGRoot"),
    ("Axiom", "de.grogra.rgg.Axiom"),
    ("Phong", "de.grogra.imp3d.shading.Phong"),
    ("RGBAShader", "de.grogra.imp3d.shading.RGBAShader"),
    ("AlgorithmSwitchShader", "de.grogra.imp3d.shading.AlgorithmSwitchShader"),
    ("SideSwitchShader", "de.grogra.imp3d.shading.SideSwitchShader"),
    ("SunSkyLight", "de.grogra.imp3d.shading.SunSkyLight"),
];

const RENAMED: [(&str, &str); 7] = [
    ("de.grogra.imp3d.shading.Lambert", "de.grogra.imp3d.shading.Phong"),
    ("de.grogra.imp3d.shading.MappedShader", "de.grogra.imp3d.shading.SideSwitchShader"),
    ("de.grogra.imp3d.shading.Graytone", "de.grogra.math.Graytone"),
    ("de.grogra.imp3d.shading.RGBColor", "de.grogra.math.RGBColor"),
    ("de.grogra.imp3d.objects.NullWithShader", "de.grogra.imp3d.objects.ShadedNull"),
    ("de.grogra.rgg.Surface", "de.grogra.imp3d.objects.NURBSSurface"),
    ("de.grogra.lsystem.DTDShoot", "de.grogra.grogra.DTGShoot"),
];

/// The full name of a built-in class that is given by its simple or full name.
pub(super) fn class(name: &str) -> Option<String> {
    let Some((package, simple)) = name.rsplit_once('.') else { return simple_class(name) };
    if let Some((_, new)) = RENAMED.iter().find(|(old, _)| *old == name) {
        return Some((*new).to_owned());
    }
    let full = simple_class(simple)?;
    let old_turtle = package == "de.grogra.lsystem" && full.starts_with(TURTLE);
    (full == name || old_turtle).then_some(full)
}

fn simple_class(name: &str) -> Option<String> {
    if OBJECT_CLASSES.contains(&name) || LIGHT_CLASSES.contains(&name) {
        Some(format!("{OBJECTS}{name}"))
    } else if name == "NullWithShader" {
        Some(format!("{OBJECTS}ShadedNull"))
    } else if TURTLE_CLASSES.contains(&name) || is_state_command(name) {
        Some(format!("{TURTLE}{name}"))
    } else {
        OTHER_CLASSES.iter().find(|(simple, _)| *simple == name).map(|(_, full)| (*full).to_owned())
    }
}

/// The commands that set an attribute of the turtle: `L`, `LAdd`, `LlMul`, `D0`, ...
fn is_state_command(name: &str) -> bool {
    let form = name.strip_prefix(['L', 'D', 'V', 'N', 'C', 'H', 'U', 'P']);
    form.is_some_and(|form| matches!(form, "" | "Add" | "Mul" | "0" | "l" | "lAdd" | "lMul"))
}

/// The constructors: what the arguments set. Of several with the same name the first with enough
/// parameters counts, so that `Scale(s)` differs from `Scale(x, y, z)`.
const CONSTRUCTORS: [(&str, &[Target]); 60] = [
    ("Sphere", &[Field("radius")]),
    ("Box", &[Field("length"), Field("width"), Field("height")]),
    ("Cylinder", &[Field("length"), Field("radius")]),
    ("Cone", &[Field("length"), Field("radius")]),
    ("Frustum", &[Field("length"), Field("baseRadius"), Field("topRadius")]),
    ("Parallelogram", &[Field("length"), HalfAxis]),
    (
        "Supershape",
        &[
            Field("a"),
            Field("b"),
            Field("m1"),
            Field("n11"),
            Field("n12"),
            Field("n13"),
            Field("m2"),
            Field("n21"),
            Field("n22"),
            Field("n23"),
        ],
    ),
    ("Null", &[Component("transform", 0), Component("transform", 1), Component("transform", 2)]),
    ("ShadedNull", &[Component("transform", 0), Component("transform", 1), Component("transform", 2)]),
    ("Point", &[Component("transform", 0), Component("transform", 1), Component("transform", 2)]),
    ("Line", &[Component("axis", 0), Component("axis", 1), Component("axis", 2)]),
    // The order of the arguments of these two is unverified: that of the fields.
    ("SphereSegmentSolid", &[Field("radius"), Field("theta1"), Field("theta2"), Field("phi")]),
    ("Lamella", &[Field("width"), Field("height"), Field("a"), Field("b")]),
    ("TextLabel", &[Nothing]),
    ("LightNode", &[Field("light")]),
    ("MeshNode", &[Field("polygons")]),
    ("Patch", &[Field("grid")]),
    ("Polygon", &[Field("vertices")]),
    ("NURBSSurface", &[Field("surface")]),
    ("NURBSCurve", &[Field("curve")]),
    ("GridClonerNode", &[Field("xCount"), Field("xDistance"), Field("yCount"), Field("yDistance")]),
    ("F", &[Field("length"), Field("diameter"), Field("color")]),
    ("F0", &[Field("diameter"), Field("color")]),
    ("FAdd", &[Field("argument"), Field("diameter"), Field("color")]),
    ("FMul", &[Field("argument"), Field("diameter"), Field("color")]),
    ("M", &[Field("length")]),
    ("MAdd", &[Field("argument")]),
    ("MMul", &[Field("argument")]),
    ("MRel", &[Field("x")]),
    ("RL", &[Field("angle")]),
    ("RU", &[Field("angle")]),
    ("RH", &[Field("angle")]),
    ("Plus", &[Field("angle")]),
    ("Minus", &[Negated("angle")]),
    ("Left", &[Field("angle")]),
    // Unverified, see the reader's table of classes.
    ("Right", &[Negated("angle")]),
    ("Up", &[Negated("angle")]),
    ("Down", &[Field("angle")]),
    ("Translate", &[Field("translateX"), Field("translateY"), Field("translateZ")]),
    ("Scale", &[AllScales]),
    ("Scale", &[Field("scaleX"), Field("scaleY"), Field("scaleZ")]),
    ("Rotate", &[Field("rotateX"), Field("rotateY"), Field("rotateZ")]),
    ("RV", &[Field("argument")]),
    ("RVAdd", &[Field("argument")]),
    ("RVMul", &[Field("argument")]),
    ("RD", &[Field("direction"), Field("strength")]),
    ("RP", &[Field("target"), Field("strength")]),
    ("RN", &[Field("target"), Field("strength")]),
    ("RO", &[Field("direction"), Field("strength")]),
    ("OR", &[Field("argument")]),
    ("P", &[Colour]),
    ("Pl", &[Colour]),
    ("L", &[Field("argument")]),
    ("D", &[Field("argument")]),
    ("V", &[Field("argument")]),
    ("N", &[Field("argument")]),
    ("C", &[Field("argument")]),
    ("H", &[Field("argument")]),
    ("U", &[Field("argument")]),
    // Stands for the other state commands.
    ("LAdd", &[Field("argument")]),
];

/// What the arguments of a constructor set; None if no such constructor is known.
pub(super) fn constructor(class: &str, arguments: usize) -> Option<&'static [Target]> {
    if arguments == 0 {
        return Some(&[]);
    }
    let simple = simple_name(class);
    let known =
        |name: &str| CONSTRUCTORS.iter().find(|(c, targets)| *c == name && targets.len() >= arguments);
    let found = known(simple).or_else(|| is_state_command(simple).then(|| known("LAdd"))?);
    found.map(|(_, targets)| *targets)
}

pub(super) fn simple_name(class: &str) -> &str {
    class.rsplit(['.', '$']).next().unwrap_or(class)
}

/// Whether the class has a `transform` with the aliases `x`, `y`, `z` and `scale`.
pub(super) fn has_transform(class: &str) -> bool {
    class.strip_prefix(OBJECTS).is_some_and(|simple| !LIGHT_CLASSES.contains(&simple))
}

/// Whether `setColor` sets the field `color` to an RGB value; for all others it sets the shader.
pub(super) fn has_rgb_colour(class: &str) -> bool {
    let coloured = ["ColoredNull", "Point", "PointCloud", "Line", "TextLabel", "SensorNode"];
    class.strip_prefix(OBJECTS).is_some_and(|simple| coloured.contains(&simple))
}

/// Whether `setColor` with a small number sets the index of a palette colour.
pub(super) fn has_indexed_colour(class: &str) -> bool {
    class.strip_prefix(TURTLE).is_some_and(|simple| matches!(simple, "F" | "F0" | "FAdd" | "FMul"))
}

/// Whether a built-in class has a field of that name that decides about the picture. A field of the same
/// name in a module is another field, although files cannot tell the two apart.
pub(super) fn is_builtin_field(class: &str, name: &str) -> bool {
    const MORE: [&str; 16] = [
        "shader",
        "layer",
        "transform",
        "transforming",
        "axis",
        "startPosition",
        "endPosition",
        "baseOpen",
        "topOpen",
        "open",
        "scaleV",
        "shiftPivot",
        "visibleSides",
        "scaleX",
        "scaleY",
        "scaleZ",
    ];
    let sets = |t: &Target| matches!(t, Field(f) | Component(f, _) | Negated(f) if *f == name);
    let mut constructors = CONSTRUCTORS.iter().filter(|(c, _)| *c == simple_name(class));
    MORE.contains(&name) || constructors.any(|(_, targets)| targets.iter().any(sets))
}

/// Names and colours of the predefined shaders from index 16 on.
const SHADERS: [(&str, u32); 13] = [
    ("BLACK", 0x000000),
    ("BLUE", 0x0000FF),
    ("CYAN", 0x00FFFF),
    ("DARK_GRAY", 0x404040),
    ("GRAY", 0x808080),
    ("GREEN", 0x00FF00),
    ("LIGHT_GRAY", 0xC0C0C0),
    ("MAGENTA", 0xFF00FF),
    ("ORANGE", 0xFFC800),
    ("PINK", 0xFFAFAF),
    ("RED", 0xFF0000),
    ("YELLOW", 0xFFFF00),
    ("WHITE", 0xFFFFFF),
];

/// The index of a predefined shader, by its name.
pub(super) fn predefined_shader(name: &str) -> Option<u32> {
    if let Some(number) = name.strip_prefix("EGA_") {
        return number.parse().ok().filter(|n| *n < 16 && !number.starts_with('+'));
    }
    SHADERS.iter().zip(16..).find(|((shader, _), _)| *shader == name).map(|(_, index)| index)
}

/// The colour of a predefined shader.
pub(super) fn predefined_colour(index: u32) -> Option<[f64; 3]> {
    if index >= 16 {
        return SHADERS.get(index as usize - 16).map(|(_, rgb)| colour(*rgb));
    }
    // The bits are red, green, blue and brightness; number 6 is brown instead of dark yellow.
    let level =
        |bit: u32| (if index & bit != 0 { 0xAA } else { 0 }) + (if index & 8 != 0 { 0x55 } else { 0 });
    let rgb = (level(4) << 16) | (level(2) << 8) | level(1);
    Some(colour(if index == 6 { 0xAA5500 } else { rgb }))
}

/// The components of 0xRRGGBB.
pub(super) fn colour(rgb: u32) -> [f64; 3] {
    [16, 8, 0].map(|shift| f64::from((rgb >> shift) & 0xFF) / 255.0)
}

/// The simple name of a class that expressions may create; sources may write the full name as well.
pub(super) fn value_class(name: &str) -> &str {
    let packages = [SHADING, "de.grogra.math.", "javax.vecmath.", OBJECTS, "de.grogra.imp.objects."];
    packages.iter().find_map(|package| name.strip_prefix(package)).unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes() {
        for (name, full) in [
            ("Sphere", Some("de.grogra.imp3d.objects.Sphere")),
            ("Node", Some(NODE)),
            ("RL", Some("de.grogra.turtle.RL")),
            ("LlMul", Some("de.grogra.turtle.LlMul")),
            ("P", Some("de.grogra.turtle.P")),
            ("de.grogra.imp3d.objects.Box", Some("de.grogra.imp3d.objects.Box")),
            ("de.grogra.lsystem.F", Some("de.grogra.turtle.F")),
            ("de.grogra.imp3d.objects.NullWithShader", Some("de.grogra.imp3d.objects.ShadedNull")),
            ("other.Box", None),
            ("FlexNode", None),
            ("", None),
            ("LXyz", None),
        ] {
            assert_eq!(class(name).as_deref(), full, "{name}");
        }
    }

    #[test]
    fn constructors() {
        assert_eq!(constructor("de.grogra.turtle.Scale", 1), Some(&[AllScales][..]));
        assert_eq!(constructor("de.grogra.turtle.Scale", 3).map(<[_]>::len), Some(3));
        assert_eq!(constructor("de.grogra.turtle.VlAdd", 1), Some(&[Field("argument")][..]));
        assert_eq!(constructor("de.grogra.imp3d.objects.Plane", 0), Some(&[][..]));
        assert_eq!(constructor("de.grogra.imp3d.objects.Plane", 1), None);
        // Every class of the table exists.
        for (name, _) in CONSTRUCTORS {
            assert!(class(name).is_some(), "{name}");
        }
    }

    #[test]
    fn shaders() {
        assert_eq!(predefined_shader("EGA_15"), Some(15));
        assert_eq!(predefined_shader("EGA_16"), None);
        assert_eq!(predefined_shader("RED"), Some(26));
        assert_eq!(predefined_shader("GRAY"), Some(20));
        assert_eq!(predefined_shader("WHITE"), Some(28));
        assert_eq!(predefined_colour(14), Some([1.0, 1.0, 0x55 as f64 / 255.0]));
        assert_eq!(predefined_colour(6), Some(colour(0xAA5500)));
        assert_eq!(predefined_colour(1), Some(colour(0x0000AA)));
        assert_eq!(predefined_colour(27), Some([1.0, 1.0, 0.0]));
        assert_eq!(predefined_colour(29), None);
    }
}
