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
    let constants = "const float[] a = {1, 2.5, -4}; static final int[] b = new int[] {7, 8};";
    let text = format!("module X(int n, float f) ==> {body}; {constants}");
    let nodes = nodes(&text, &[("n", 3.0), ("f", 0.5)]);
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
fn commas_begin_again() {
    for (body, expected) in [
        ("M(1), M(2)", "-:M(length=1) -:M(length=2)"),
        ("M(1) M(2), M(3) M(4)", "-:M(length=1) 0:M(length=2) -:M(length=3) 2:M(length=4)"),
        ("M(1) [M(2), M(3)] M(4)", "-:M(length=1) 0:M(length=2) 0:M(length=3) 0:M(length=4)"),
        ("M(1) (M(2), M(3)) M(4)", "-:M(length=1) 0:M(length=2) 0:M(length=3) 2:M(length=4)"),
    ] {
        assert_eq!(tree(body), expected, "{body}");
    }
}

#[test]
fn arrays_and_choices() {
    for (body, expected) in [
        ("M(a[0]) M(a[n - 1])", "-:M(length=1) 0:M(length=-4)"),
        ("for (int i = 0; i < b.length; i++) [M(b[i])]", "-:M(length=7) -:M(length=8)"),
        ("for (0:1) for (int i : (0:1)) [M(a[i] * b[i])]", &["-:M(length=7) -:M(length=20)"; 2].join(" ")),
        ("M(b[1] / 3)", "-:M(length=2)"),
        ("{ float[] c = new float[4]; int[] d = {n, 2}; } M(c[3] + d[1] / 2)", "-:M(length=1)"),
        ("M(n > 2 ? f : 7)", "-:M(length=0.5)"),
        ("M(n < 2 ? 1 : n == 3 ? 2 : 3) M(f)", "-:M(length=2) 0:M(length=0.5)"),
        ("M(n == 3 ? n < 1 ? 1 : 2 : random(0, 1))", "-:M(length=2)"),
    ] {
        assert_eq!(tree(body), expected, "{body}");
    }
}

#[test]
fn lights_and_transformations() {
    let spot = "LightNode().(setLight(new SpotLight().(setPower(2 * n), innerAngle = f, getColor().set(new \
                RGBColor(1, 0, 0)))))";
    let found = nodes(&format!("module X(int n, float f) ==> {spot};"), &[("n", 3.0), ("f", 0.5)]);
    let found = found.expect("a body");
    let Some(StaticValue::Light(light)) = found[0].fields.get("light") else { panic!("{found:?}") };
    assert_eq!(light.class, "de.grogra.imp3d.objects.SpotLight");
    let expected = [
        ("color", StaticValue::Vector([1.0, 0.0, 0.0])),
        ("innerAngle", StaticValue::Number(0.5)),
        ("power", StaticValue::Number(6.0)),
    ];
    assert!(light.properties.iter().map(|(name, value)| (name.as_str(), value.clone())).eq(expected));
    assert_eq!(
        tree("Null().(setRotation(1, f, 0), setScale(1, 2, n), setTranslation(4, 5, 6))"),
        "-:Null(scale=Vector([1.0, 2.0, 3.0]),setRotation=Vector([1.0, 0.5, 0.0]),transform=Vector([4.0, 5.0, 6.0]))"
    );
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
        ("LightNode().(setLight(new SpotLight(3)))", "'new SpotLight(...)' is not evaluated"),
        ("LightNode().(setLight(new SpotLight().(setPower(time))))", "'time' is not a known constant"),
        ("Sphere().(setRotation(1, 2))", "'setRotation' is not understood"),
        ("F(1).(setRotation(1, 2, 3))", "'setRotation' is not understood"),
        ("Phong", "no known class of a node"),
        ("while (true) (M(1))", "'while' is not evaluated"),
        ("if (n) M(1)", "no truth value"),
        ("M(1) = M(2)", "this part of the body"),
        ("M(a[3])", "not a whole number below 3"),
        ("M(a[n])", "not a whole number below 3"),
        ("M(new float[2][2])", "array"),
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
        format!("M({}1{})", "{".repeat(deep), "}".repeat(deep)),
        format!("M({}1{})", "a[".repeat(deep), "]".repeat(deep)),
        format!("M({}1{})", "true ? ".repeat(deep), ": 1".repeat(deep)),
        format!("M(a{})", ".length".repeat(deep)),
        "M(new float[2000000000][0])".to_owned(),
        "for (1:1000000) (M((new float[99999])[0]))".to_owned(),
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
