use super::bodies::{BodyNode, Stored};
use super::*;

const STEPS: usize = 100_000;

/// The nodes of the body of the module `X`, whose instance stores these fields.
fn nodes(text: &str, fields: &[(&str, f64)]) -> Result<Vec<BodyNode>, String> {
    let file = SourceFile { path: "test.rgg".into(), text: text.into() };
    let sources = Sources::parse(&[file]);
    let stored = |name: &str| {
        let found = fields.iter().find(|(field, _)| *field == name);
        found.map_or(Stored::Missing, |(_, value)| Stored::Value(StaticValue::Number(*value)))
    };
    let place = sources.place("test$X").expect("module X");
    let nodes = sources.instantiate(place, &stored, 1000, STEPS).nodes;
    nodes.map_err(|problem| format!("{}:{}: {}", problem.file, problem.line, problem.message))
}

/// The nodes as `parent:Class(field=value, ...)` with simple names.
fn tree(body: &str) -> String {
    let nodes = nodes(&format!("module X(int n, float f) ==> {body};"), &[("n", 3.0), ("f", 0.5)]);
    let text = |node: &BodyNode| {
        let fields = node.fields.iter().map(|(name, value)| match value {
            StaticValue::Number(value) => format!("{name}={value}"),
            StaticValue::Shader(StaticShader::Predefined(index)) => format!("{name}=#{index}"),
            value => format!("{name}={value:?}"),
        });
        let fields = fields.collect::<Vec<_>>().join(",");
        let parent = node.parent.map_or("-".into(), |parent| parent.to_string());
        format!("{parent}:{}({fields})", builtins::simple_name(&node.class))
    };
    nodes.map_or_else(|problem| problem, |nodes| nodes.iter().map(text).collect::<Vec<_>>().join(" "))
}

#[test]
fn chains_branches_and_arguments() {
    for (body, expected) in [
        ("", ""),
        ("RL(90) Sphere(f * 2)", "-:RL(angle=90) 0:Sphere(radius=1)"),
        ("[M(1) M(2)] [M(n / 2)] M(4)", "-:M(length=1) 0:M(length=2) -:M(length=1) -:M(length=4)"),
        ("Null [M(1)] M(2)", "-:Null() 0:M(length=1) 0:M(length=2)"),
        ("(M(1) (M(2))) M(3)", "-:M(length=1) 0:M(length=2) 1:M(length=3)"),
        ("Sphere().(setRadius(f), layer = n)", "-:Sphere(layer=3,radius=0.5)"),
        ("Cone(1, f).(setLayer(1)).(setShader(RED))", "-:Cone(layer=1,length=1,radius=0.5,shader=#26)"),
        ("b:Sphere(1) {{ b.setShader(RED); }} M(f)", "-:Sphere(radius=1,shader=#26) 0:M(length=0.5)"),
        ("Sphere(1) { setRadius(3); }", "-:Sphere(radius=3)"),
        ("{ float r = f * 4; Shader s = GREEN; } Sphere(r).(setShader(s))", "-:Sphere(radius=2,shader=#21)"),
        ("AdjustLU F(1, 2)", "-:AdjustLU() 0:F(diameter=2,length=1)"),
    ] {
        assert_eq!(tree(body), expected, "{body}");
    }
}

#[test]
fn loops_and_conditions() {
    let three = "-:M(length=0) 0:M(length=1) 1:M(length=2)";
    for (body, expected) in [
        ("for (int i = 0; i < n; i++) (M(i))", three),
        ("for (int i = 0; i <= 4; i += 2) (M(i / 2))", three),
        ("for (int i : (0:2)) (M(i))", three),
        ("for (int i : 0:n - 1) M(i)", three),
        ("for (1:3) ([M(1)])", "-:M(length=1) -:M(length=1) -:M(length=1)"),
        ("for (int i = 2; i > 0; --i) for (1:i) ([M(i)])", "-:M(length=2) -:M(length=2) -:M(length=1)"),
        ("for (3:1) (M(1)) M(2)", "-:M(length=2)"),
        ("if (n == 3) (M(1)) else (M(2)) M(3)", "-:M(length=1) 0:M(length=3)"),
        ("if (n < 3 || f > 1) (M(1)) else if (n >= 3 && !(f != 0.5)) M(2) else M(4)", "-:M(length=2)"),
        ("if (n == 0) M(1)", ""),
        ("if (n == 0) if (n == 1) M(1) else M(2)", ""),
    ] {
        assert_eq!(tree(body), expected, "{body}");
    }
}

#[test]
fn modules_in_bodies() {
    let text = "module Leaf(float len, super.width) extends Box(len * 2, width, 0.5) {{ setShader(GREEN); }}
        module Tip ==> Sphere(1);
        module Y(float f) ==> M(f) Leaf(f, 1).(setLayer(2)) Tip;
        module X extends Y { int k = 7; }";
    let nodes = nodes(text, &[("f", 0.25)]).expect("a body");
    let number = |index: usize, field: &str| nodes[index].fields.get(field).cloned();
    assert_eq!(number(0, "length"), Some(StaticValue::Number(0.25)));
    for (field, value) in [("length", 0.5), ("width", 1.0), ("height", 0.5), ("layer", 2.0), ("len", 0.25)] {
        assert_eq!(number(1, field), Some(StaticValue::Number(value)), "{field}");
    }
    assert!(nodes[0].module.is_none() && nodes[1].module.is_none() && nodes[2].module.is_some());
}

#[test]
fn what_needs_a_model_is_told_with_its_place() {
    for (body, expected) in [
        ("\nM(random(0, 1))", "test.rgg:2: "),
        ("\n\nif (time == 0) (Sphere(1))", "test.rgg:3: 'time' is not a known constant"),
        ("Foo", "'Foo' is not a known class"),
        ("M(grow())", "'grow(...)'"),
        ("Sphere().(grow())", "the call of 'grow' is not evaluated"),
        ("{ setShader(RED); } Sphere", "the call of 'setShader'"),
        ("LightNode().(setLight(new SpotLight()))", "'new SpotLight(...)' is not evaluated"),
        ("Sphere().(setRotation(1, 2, 3))", "'setRotation'"),
        ("Phong", "no known class of a node"),
        ("while (true) (M(1))", "'while' is not evaluated"),
        ("if (n) M(1)", "no truth value"),
        ("M(1), M(2)", "this part of the body"),
        ("for (X x : list()) (M(1))", "range of numbers"),
        ("for (;;) (M(1))", "without a condition"),
        ("for", "'for' is not evaluated"),
        ("b:", "the name of a class is missing"),
    ] {
        let found = tree(body);
        assert!(found.contains(expected), "{body}: {found}");
    }
}

#[test]
fn hostile_bodies_end() {
    let deep = 20_000;
    for body in [
        "for (int i = 0; true; i++) ()".to_owned(),
        "for (int i = 0; i < 1; i = 0) {}".to_owned(),
        "for (0:2000000000) (for (0:2000000000) ())".to_owned(),
        "for (1:5000) (M(1))".to_owned(),
        format!("{}M({})", "if (true) ".repeat(deep), "(".repeat(deep)),
    ] {
        let found = tree(&body);
        assert!(["too many", "too involved", "not"].iter().any(|part| found.contains(part)), "{found}");
    }
    for open in ["[", "(", "{", "for (1:2) (", "if (true) (", "M(1) [", "a:", "M.(", "M{"] {
        for close in ["", "]", ")", "}"] {
            let _ = tree(&(open.repeat(deep) + &close.repeat(deep)));
        }
    }
    assert_eq!(tree(&("[".repeat(deep) + "M(1)" + &"]".repeat(deep))), "-:M(length=1)");
    let _ = tree(&"if (false) M(1) else ".repeat(deep));
    let _ = tree(&format!("M({}1{})", "-(".repeat(deep), ")".repeat(deep)));
}
