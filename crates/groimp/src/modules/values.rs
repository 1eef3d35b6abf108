//! The values of expressions, and the constructors and functions that make values.

use super::builtins;
use super::{StaticChannel, StaticLight, StaticShader, StaticValue};
use std::rc::Rc;

/// The value of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Number {
        value: f64,
        integer: bool,
    },
    Bool(bool),
    Null,
    Text(String),
    Vector([f64; 3]),
    Shader(StaticShader),
    Channel(StaticChannel),
    Light(StaticLight),
    Array(Rc<[Value]>),
    /// An image map that got no image yet.
    EmptyMap,
    /// A local variable whose value could not be determined.
    Unknown,
    /// A module parameter where its value is not defined.
    Parameter,
}

impl Value {
    pub fn real(value: f64) -> Value {
        Value::Number { value, integer: false }
    }

    pub fn number(&self) -> Option<f64> {
        match self {
            Value::Number { value, .. } => Some(*value),
            _ => None,
        }
    }

    /// The value as that of a variable of the given type.
    pub fn converted(self, kind: &str) -> Value {
        match (self, kind) {
            (Value::Array(values), _) if kind.ends_with("[]") => {
                let kind = kind.strip_suffix("[]").unwrap_or(kind);
                // Only whole numbers change, to the type of the elements.
                let converts = |value: &Value| matches!(value, Value::Number { .. } | Value::Array(_));
                if !values.iter().any(converts) {
                    return Value::Array(values);
                }
                Value::Array(values.iter().map(|value| value.clone().converted(kind)).collect())
            }
            (Value::Number { value, .. }, "float" | "double") => Value::real(value),
            (Value::Number { value, .. }, "int" | "long" | "short" | "byte") => {
                Value::Number { value: value.trunc(), integer: true }
            }
            (value, _) => value,
        }
    }

    /// What a field of the given type holds before anything is assigned.
    pub fn initial(kind: &str) -> Value {
        match kind {
            "boolean" => Value::Bool(false),
            "int" | "long" | "short" | "byte" | "char" => Value::Number { value: 0.0, integer: true },
            "float" | "double" => Value::real(0.0),
            _ => Value::Null,
        }
    }

    pub fn into_static(self) -> Option<StaticValue> {
        Some(match self {
            Value::Number { value, .. } => StaticValue::Number(value),
            Value::Bool(value) => StaticValue::Bool(value),
            Value::Null => StaticValue::Null,
            Value::Vector(value) | Value::Channel(StaticChannel::Rgb(value)) => StaticValue::Vector(value),
            Value::Shader(shader) => StaticValue::Shader(shader),
            Value::Light(light) => StaticValue::Light(light),
            _ => return None,
        })
    }

    /// How much copying the value costs, for the budget.
    pub fn weight(&self) -> usize {
        fn of_shader(shader: &StaticShader) -> usize {
            match shader {
                StaticShader::Predefined(_) | StaticShader::Rgba(_) => 1,
                StaticShader::Named(name) => 1 + name.len() / 32,
                StaticShader::Phong { channels } => 1 + channels.len(),
                StaticShader::AlgorithmSwitch { gui, raytracer, radiation } => {
                    1 + [gui, raytracer, radiation].into_iter().flatten().map(|s| of_shader(s)).sum::<usize>()
                }
            }
        }
        match self {
            Value::Text(text) => 1 + text.len() / 32,
            Value::Shader(shader) => of_shader(shader),
            Value::Light(light) => 1 + light.properties.len(),
            _ => 1,
        }
    }
}

/// Why an expression has no static value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Failure {
    /// It uses a module parameter; files hold all values that depend on one.
    Parameter,
    /// A half-sentence for the user.
    Unknown(String),
}

pub(super) type Evaluated = Result<Value, Failure>;

/// A failure with a reason.
pub(super) fn unknown<T>(reason: impl Into<String>) -> Result<T, Failure> {
    Err(Failure::Unknown(reason.into()))
}

/// Sets a property of a shader, a channel map or the like, as `setName(value)` or `name = value` does.
pub(super) fn set_property(object: &mut Value, name: &str, value: Value) -> Result<(), Failure> {
    let shader = |value: Value| match value {
        Value::Shader(shader) => Ok(Some(Box::new(shader))),
        Value::Null => Ok(None),
        _ => unknown(format!("'{name}' is not a shader")),
    };
    match (object, name) {
        (Value::Light(light), _) => match value.into_static() {
            Some(value) => {
                light.properties.insert(name.to_owned(), value);
            }
            None => return unknown(format!("the value of '{name}' is not a number or a colour")),
        },
        (Value::Shader(StaticShader::Phong { .. }), "interpolatedTransparency") => {}
        (Value::Shader(StaticShader::Phong { channels }), _) => {
            channels.retain(|(field, _)| field != name);
            let channel = match value {
                Value::Channel(channel) => channel,
                Value::Null => return Ok(()),
                Value::Vector(rgb) => StaticChannel::Rgb(rgb),
                Value::Number { value, integer: false } => StaticChannel::Gray(value),
                Value::Shader(StaticShader::Predefined(index)) => match builtins::predefined_colour(index) {
                    Some(rgb) => StaticChannel::Rgb(rgb),
                    None => return unknown(format!("the colour of '{name}' is not known")),
                },
                Value::Shader(StaticShader::Rgba([r, g, b, _])) => StaticChannel::Rgb([r, g, b]),
                _ => return unknown(format!("the value of '{name}' is not a constant colour or image")),
            };
            channels.push((name.to_owned(), channel));
        }
        (Value::Shader(StaticShader::AlgorithmSwitch { gui, .. }), "guiShader") => *gui = shader(value)?,
        (Value::Shader(StaticShader::AlgorithmSwitch { raytracer, .. }), "raytracerShader") => {
            *raytracer = shader(value)?;
        }
        (Value::Shader(StaticShader::AlgorithmSwitch { radiation, .. }), "radiationShader") => {
            *radiation = shader(value)?;
        }
        (map @ Value::EmptyMap, "image") => match value {
            Value::Channel(image @ StaticChannel::Image(_)) => *map = Value::Channel(image),
            _ => return unknown("the image of a texture is not a named image"),
        },
        (Value::EmptyMap | Value::Channel(StaticChannel::Image(_)), "bilinearFiltering") => {}
        _ => return unknown(format!("'{name}' is not a known property")),
    }
    Ok(())
}

/// `getName` to `name`.
pub(super) fn property_of_getter(method: &str) -> Option<String> {
    property(method.strip_prefix("get")?)
}

/// `setName` to `name`.
pub(super) fn property_of_setter(method: &str) -> Option<String> {
    property(method.strip_prefix("set")?)
}

fn property(rest: &str) -> Option<String> {
    let first = rest.chars().next().filter(|c| c.is_uppercase())?;
    Some(first.to_lowercase().chain(rest.chars().skip(1)).collect())
}

/// `left operator right`, where integers are divided like integers.
pub(super) fn arithmetic(left: &Value, right: &Value, operator: char) -> Evaluated {
    let (Value::Number { value: a, integer: first }, Value::Number { value: b, integer: second }) =
        (left, right)
    else {
        return unknown(format!("the operands of '{operator}' are no numbers"));
    };
    let integer = *first && *second;
    if integer && *b == 0.0 && matches!(operator, '/' | '%') {
        return unknown("it divides by zero");
    }
    let value = match operator {
        '+' => a + b,
        '-' => a - b,
        '*' => a * b,
        '/' if integer => (a / b).trunc(),
        '/' => a / b,
        _ => a % b,
    };
    Ok(Value::Number { value, integer })
}

/// `left operator right` for comparisons of numbers, and whether truth values are equal.
pub(super) fn compare(left: &Value, right: &Value, operator: &str) -> Evaluated {
    let result = match (left, right, operator) {
        (Value::Bool(a), Value::Bool(b), "==") => a == b,
        (Value::Bool(a), Value::Bool(b), "!=") => a != b,
        (Value::Number { value: a, .. }, Value::Number { value: b, .. }, _) => match operator {
            "<" => a < b,
            "<=" => a <= b,
            ">" => a > b,
            ">=" => a >= b,
            "==" => a == b,
            _ => a != b,
        },
        _ => return unknown(format!("the operands of '{operator}' are no numbers")),
    };
    Ok(Value::Bool(result))
}

/// A connection of two truth values.
pub(super) fn logic(left: &Value, right: &Value, connect: fn(bool, bool) -> bool) -> Evaluated {
    match (left, right) {
        (Value::Bool(a), Value::Bool(b)) => Ok(Value::Bool(connect(*a, *b))),
        _ => unknown("a condition is no truth value"),
    }
}

fn numbers<const N: usize>(values: &[Value]) -> Option<[f64; N]> {
    let values: Vec<f64> = values.iter().map(Value::number).collect::<Option<_>>()?;
    values.try_into().ok()
}

/// `new name(values)`
pub(super) fn create(name: &str, values: &[Value]) -> Evaluated {
    let simple = builtins::value_class(name);
    let one = || numbers::<1>(values).map(|[v]| v);
    let three = || numbers::<3>(values);
    let value = match (simple, values) {
        ("RGBAShader", []) => Some(Value::Shader(StaticShader::Rgba([0.5, 0.5, 0.5, 1.0]))),
        ("RGBAShader", [Value::Number { value, integer: true }]) => {
            let argb = *value as i64 as u32;
            let [r, g, b] = builtins::colour(argb);
            Some(Value::Shader(StaticShader::Rgba([r, g, b, f64::from(argb >> 24) / 255.0])))
        }
        ("RGBAShader", [Value::Channel(StaticChannel::Rgb([r, g, b])) | Value::Vector([r, g, b])]) => {
            Some(Value::Shader(StaticShader::Rgba([*r, *g, *b, 1.0])))
        }
        ("RGBAShader", _) => {
            let rgba = three().map(|[r, g, b]| [r, g, b, 1.0]).or_else(|| numbers::<4>(values));
            rgba.map(|rgba| Value::Shader(StaticShader::Rgba(rgba)))
        }
        ("ShaderRef" | "MaterialRef", [Value::Text(name)]) => {
            Some(Value::Shader(StaticShader::Named(name.clone())))
        }
        ("Phong" | "Lambert", []) => Some(Value::Shader(StaticShader::Phong { channels: Vec::new() })),
        ("AlgorithmSwitchShader", _) => return algorithm_switch(values),
        ("Graytone", []) => Some(Value::Channel(StaticChannel::Gray(0.5))),
        ("Graytone", _) => one().map(|v| Value::Channel(StaticChannel::Gray(v))),
        ("RGBColor", []) => Some(Value::Channel(StaticChannel::Rgb([0.5; 3]))),
        ("RGBColor" | "Color3f" | "Color3d", [Value::Number { value, integer: true }]) => {
            Some(Value::Channel(StaticChannel::Rgb(builtins::colour(*value as i64 as u32))))
        }
        ("RGBColor" | "Color3f" | "Color3d", _) => three().map(|rgb| Value::Channel(StaticChannel::Rgb(rgb))),
        ("ImageRef", [Value::Text(name)]) => Some(Value::Channel(StaticChannel::Image(name.clone()))),
        ("ImageMap", []) => Some(Value::EmptyMap),
        ("ImageMap", [Value::Channel(image @ StaticChannel::Image(_))]) => {
            Some(Value::Channel(image.clone()))
        }
        ("PointLight" | "SpotLight" | "DirectionalLight" | "AmbientLight" | "AreaLight", []) => {
            let class = format!("de.grogra.imp3d.objects.{simple}");
            Some(Value::Light(StaticLight { class, properties: std::collections::BTreeMap::new() }))
        }
        // The identity leaves everything where it is, as no transformation does.
        ("TMatrix4d", []) => Some(Value::Null),
        (
            "Vector3d" | "Vector3f" | "Point3d" | "Point3f" | "TVector3d" | "Tuple3d" | "Tuple3f",
            [] | [_, _, _],
        ) => {
            if values.is_empty() {
                Some(Value::Vector([0.0; 3]))
            } else {
                three().map(Value::Vector)
            }
        }
        _ => None,
    };
    value.map_or_else(|| unknown(format!("'new {name}(...)' is not evaluated")), Ok)
}

fn algorithm_switch(values: &[Value]) -> Evaluated {
    let mut members = Vec::new();
    for value in values {
        members.push(match value {
            Value::Shader(shader) => Some(Box::new(shader.clone())),
            Value::Null => None,
            _ => return unknown("a member of an AlgorithmSwitchShader is no shader"),
        });
    }
    let mut members = members.into_iter();
    let mut next = || members.next().flatten();
    let shader = match values.len() {
        0 => StaticShader::AlgorithmSwitch { gui: None, raytracer: None, radiation: None },
        2 => StaticShader::AlgorithmSwitch { gui: next(), raytracer: None, radiation: next() },
        3 => StaticShader::AlgorithmSwitch { gui: next(), raytracer: next(), radiation: next() },
        _ => return unknown("an AlgorithmSwitchShader has two or three members"),
    };
    Ok(Value::Shader(shader))
}

/// `name(values)`
pub(super) fn call(name: &str, values: &[Value]) -> Evaluated {
    let (holder, function) = name.rsplit_once('.').unwrap_or(("", name));
    match (function, values) {
        ("shader" | "material", [Value::Text(name)]) => {
            return Ok(Value::Shader(StaticShader::Named(name.clone())));
        }
        ("image", [Value::Text(name)]) => return Ok(Value::Channel(StaticChannel::Image(name.clone()))),
        _ => {}
    }
    let value = match (holder, values) {
        ("" | "Math" | "java.lang.Math", [Value::Number { value, integer }]) => {
            function_of_one(function, *value)
                .map(|result| Value::Number { value: result, integer: *integer && function == "abs" })
        }
        ("" | "Math" | "java.lang.Math", [Value::Number { .. }, Value::Number { .. }]) => {
            function_of_two(function, &values[0], &values[1])
        }
        _ => None,
    };
    value.map_or_else(|| unknown(format!("'{name}(...)' is computed when the model runs")), Ok)
}

fn function_of_one(name: &str, x: f64) -> Option<f64> {
    Some(match name {
        "sin" => x.sin(),
        "cos" => x.cos(),
        "tan" => x.tan(),
        "asin" => x.asin(),
        "acos" => x.acos(),
        "atan" => x.atan(),
        "sqrt" => x.sqrt(),
        "exp" => x.exp(),
        "log" => x.ln(),
        "abs" => x.abs(),
        "floor" => x.floor(),
        "ceil" => x.ceil(),
        "toRadians" => x.to_radians(),
        "toDegrees" => x.to_degrees(),
        _ => return None,
    })
}

fn function_of_two(name: &str, x: &Value, y: &Value) -> Option<Value> {
    let (Value::Number { value: a, integer: first }, Value::Number { value: b, integer: second }) = (x, y)
    else {
        return None;
    };
    let integer = *first && *second;
    Some(match name {
        "min" => Value::Number { value: a.min(*b), integer },
        "max" => Value::Number { value: a.max(*b), integer },
        "pow" => Value::real(a.powf(*b)),
        "atan2" => Value::real(a.atan2(*b)),
        _ => return None,
    })
}
