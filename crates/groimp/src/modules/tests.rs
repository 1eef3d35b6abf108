use super::*;

fn sources(files: &[(&str, &str)]) -> Sources {
    let file = |(path, text): &(&str, &str)| SourceFile { path: (*path).into(), text: (*text).into() };
    Sources::parse(&files.iter().map(file).collect::<Vec<_>>())
}

fn resolve(text: &str, name: &str) -> ResolvedModule {
    let sources = sources(&[("test.rgg", text)]);
    assert_eq!(sources.problems(), [], "{text}");
    sources.resolve(&format!("test${name}")).expect(name)
}

fn number(value: f64) -> StaticValue {
    StaticValue::Number(value)
}

fn predefined(index: u32) -> StaticValue {
    StaticValue::Shader(StaticShader::Predefined(index))
}

fn named(name: &str) -> StaticValue {
    StaticValue::Shader(StaticShader::Named(name.into()))
}

fn rgba(r: f64, g: f64, b: f64) -> StaticValue {
    StaticValue::Shader(StaticShader::Rgba([r, g, b, 1.0]))
}

const RED: u32 = 26;
const GREEN: u32 = 21;
const BLACK: u32 = 16;

#[track_caller]
fn check(text: &str, name: &str, base: &str, defaults: &[(&str, StaticValue)]) {
    let module = resolve(text, name);
    check_module(&module, base, defaults);
    assert_eq!(module.unresolved, [""; 0], "{text}");
}

#[track_caller]
fn check_module(module: &ResolvedModule, base: &str, defaults: &[(&str, StaticValue)]) {
    assert_eq!(module.base.rsplit('.').next(), Some(base));
    let actual: Vec<_> = module.defaults.iter().map(|d| (d.field.as_str(), d.value.clone())).collect();
    assert_eq!(actual, defaults);
}

/// Parses the declarations and checks the value of a field of the last one, `X`.
#[track_caller]
fn value(text: &str, field: &str) -> StaticValue {
    let module = resolve(text, "X");
    assert_eq!(module.unresolved, [""; 0], "{text}");
    let found = module.defaults.into_iter().find(|d| d.field == field);
    found.expect(field).value
}

#[track_caller]
fn shader(expression: &str) -> StaticShader {
    let text = format!("const Shader s = {expression}; module X extends Sphere {{{{ setShader(s); }}}}");
    match value(&text, "shader") {
        StaticValue::Shader(shader) => shader,
        other => panic!("{other:?}"),
    }
}

#[track_caller]
fn evaluate(expression: &str) -> f64 {
    match value(&format!("module X extends Sphere({expression});"), "radius") {
        StaticValue::Number(number) => number,
        other => panic!("{other:?}"),
    }
}

#[test]
fn example_projects() {
    check(
        "module Bud extends Sphere(0.1)\n{\n {setShader(RED);}\n}",
        "Bud",
        "Sphere",
        &[("radius", number(0.1)), ("shader", predefined(RED))],
    );
    check(
        "module Bud(int order) extends Sphere(0.0001) {{setShader(RED); setRadius(0.2);}}",
        "Bud",
        "Sphere",
        &[("radius", number(0.2)), ("shader", predefined(RED))],
    );
    let text = "module Bud(int time, int phyllo, int order) extends Sphere(0.1)\n{\n\t{setShader(nodemat);}\n}\n
        module Node extends Sphere(0.07)\n{\n\t{setShader(GREEN);}\n}\n
        const ShaderRef leafmat = new ShaderRef(\"Lambert\");
        const ShaderRef internodemat = new ShaderRef(\"Lambert 3\");
        const ShaderRef nodemat = new ShaderRef(\"Lambert 4\");
        module Leaf (super.length, super.width, float al, int age, float as)
            extends Box(length,width,0.01).(setShader(new AlgorithmSwitchShader(new RGBAShader(0,1,0), GREEN )));
        module NiceLeaf (float al) extends Parallelogram(2,2).(setShader(leafmat));
        module NiceNode extends Sphere(0.07)\n{{setShader(nodemat);}}
        module Internode(super.length, int age) extends F(length,0.1,7);
        //module NiceInternode extends Cylinder(1,0.08).(setShader(internodemat));
        module NiceInternode extends Cylinder(1,0.08).(setShader(new RGBAShader(1,0.5,0.1)));
        module Flower ==>
        RU(180) Cone(0.3,0.3).(setColor(0x82B417)) M(-0.25) RL(90)
        [ for (int i=1; i<=5; i++) ([RU(i*360/5) RL(20) Parallelogram(2,1).(setColor(0xFF00FF))])];
        module Tile(float len, float wid) extends Parallelogram(len,wid)\n{\n\tfloat al;\n};\n";
    check(text, "Bud", "Sphere", &[("shader", named("Lambert 4"))]);
    check(text, "Node", "Sphere", &[("radius", number(0.07)), ("shader", predefined(GREEN))]);
    check(text, "NiceNode", "Sphere", &[("radius", number(0.07)), ("shader", named("Lambert 4"))]);
    check(text, "NiceLeaf", "Parallelogram", &[("shader", named("Lambert"))]);
    check(text, "Internode", "F", &[]);
    check(
        text,
        "NiceInternode",
        "Cylinder",
        &[("length", number(1.0)), ("radius", number(0.08)), ("shader", rgba(1.0, 0.5, 0.1))],
    );
    let switch = StaticShader::AlgorithmSwitch {
        gui: Some(Box::new(StaticShader::Rgba([0.0, 1.0, 0.0, 1.0]))),
        raytracer: None,
        radiation: Some(Box::new(StaticShader::Predefined(GREEN))),
    };
    check(text, "Leaf", "Box", &[("shader", StaticValue::Shader(switch))]);
    check(text, "Tile", "Parallelogram", &[]);
    let flower = resolve(text, "Flower");
    assert!(flower.has_body);
    assert_eq!(flower.base, "de.grogra.graph.impl.Node");
    assert!(!resolve(text, "Tile").has_body);
}

#[test]
fn light_and_shader_tests() {
    let text = "\r\nconst Shader wallShader = shader(\"wallTexture\");\r\n
        const float beacon_range = 10; // range\r\n const float beacon_spread = 20;  // cone half angle\r\n
        const Shader beaconShader = shader(\"BeaconLight\");\r\n
        module Ground extends Plane() {\r\n\t{setShader(GREEN);}\r\n}\r\n
        module Pot() extends Frustum(1.3, 0.75, 1) {\r\n\t{setShader(RED);}\r\n}\r\n
        module Wall ==> [\r\n\tTranslate(0, 5, 2.5) \r\n\tRL(90) b:Box(10, 0.7, 5) {\r\n
        \t\t{b.setShader(wallShader);}\r\n\t}\r\n];\r\n
        module Post extends F(10, 0.15) {\r\n\t{setShader(EGA_3);}\r\n}\r\n
        module Dummy(super.angle) extends RL(angle);\r\n
        module Facet(float angle) extends SensorNode {\r\n float absorbed;\r\n {\r\n setRadius(0.1);\r\n
        // setTwoSided(false);\r\n setLayer(13);\r\n }  \r\n}\r\n
        module ST(int number) {};
        module BeaconLamp extends Cone(beacon_range, beacon_range * Math.sin(beacon_spread * Math.PI /180)) {
        {\n setShader(beaconShader);\n }\n }
        module LowerC extends Cylinder(0.5,0.45).(setShader(BLACK), setTopOpen(true));
        module UpperC extends Cylinder(0.5,0.45).(setShader(BLACK), setBaseOpen(true));";
    check(text, "Ground", "Plane", &[("shader", predefined(GREEN))]);
    check(
        text,
        "Pot",
        "Frustum",
        &[
            ("baseRadius", number(0.75)),
            ("length", number(1.3)),
            ("shader", predefined(RED)),
            ("topRadius", number(1.0)),
        ],
    );
    let wall = resolve(text, "Wall");
    assert!(wall.has_body && wall.unresolved.is_empty());
    check(
        text,
        "Post",
        "F",
        &[("diameter", number(0.15)), ("length", number(10.0)), ("shader", predefined(3))],
    );
    check(text, "Dummy", "RL", &[]);
    check(text, "Facet", "SensorNode", &[("layer", number(13.0)), ("radius", number(0.1))]);
    check(text, "ST", "Node", &[]);
    check(
        text,
        "BeaconLamp",
        "Cone",
        &[
            ("length", number(10.0)),
            ("radius", number(10.0 * (20.0 * std::f64::consts::PI / 180.0).sin())),
            ("shader", named("BeaconLight")),
        ],
    );
    for (name, open) in [("LowerC", "topOpen"), ("UpperC", "baseOpen")] {
        let mut fields = vec![
            ("length", number(0.5)),
            ("radius", number(0.45)),
            ("shader", predefined(BLACK)),
            (open, StaticValue::Bool(true)),
        ];
        fields.sort_by_key(|(name, _)| *name);
        check(text, name, "Cylinder", &fields);
    }
    let frame = "module Frame(float opening) ==>
        [         RU(90) M(0.25) RU(-90) Box(0.001,0.5-opening,1).(setShader(BLACK)) ]
        [ RH( 90) RU(90) M(0.25) RU(-90) Box(0.001,0.5-opening,1).(setShader(BLACK)) ]
        ;
        module TestShader ==> {
            Phong myShader = new Phong();
            myShader.setDiffuse(new RGBColor (0,1,0));
        } Box(0.001,0.06,0.06).(setShader(myShader));";
    assert!(resolve(frame, "Frame").has_body && resolve(frame, "TestShader").has_body);
}

#[test]
fn class_of_a_plugin() {
    let text = "import uk.ac.soton.grophysics.FlexNode; const float stem_r = 0.1;
        module Stem(String name, super.length, super.mass, int age) extends FlexNode(length, stem_r, mass) {
            {
                setName(name);
                setShader(YELLOW);
                setStiffness(0.7);
            }
            void setStiffness(float stiff) { if (enabled) { setStiffnessX(stiff); } }
        }";
    let module = resolve(text, "Stem");
    check_module(&module, "FlexNode", &[("shader", predefined(27))]);
    assert_eq!(module.unresolved.len(), 2, "{:?}", module.unresolved);
    assert!(module.unresolved[0].contains("'FlexNode', which is not a known class"));
}

#[test]
fn plant_projects() {
    let text = "module Shoot(float len) extends F(len, 0.2);
        module Bud(float strength) extends Sphere(0.2)
        {{setShader(RED); setTransform(0,0,0.3);}};
        const Shader leafMat = shader(\"Leaf\");
        module Leaf(float len, float width) extends Parallelogram(len, width)

        // the shader gets assigned a texture instead of a colour
        {{setShader(leafMat);}};
        module Petiole(float len) extends F(len, 0.01);
        module Meristem(int age) extends Sphere(0.0005)
        {{ setShader(RED);}};
        module Wing(int age) extends Scale()
        {{
           scaleX = 0.01;
           scaleY = 0.01;
           scaleZ = 0.01;
        }};
        module Blade extends Parallelogram()
        {{setShader(leafMat);}};
        module Blade38(int age) extends Parallelogram(1.0, 1.0/1.3);
        module Blade37(int age, float x, float z) extends Parallelogram(1, 1)
        {
           public float getXExtension()
           {
           TMatrix4d mymatrix = (TMatrix4d) this.getTransform();
           return mymatrix.m00;
           }
        };
        module Internode(int age, int lnfb) extends F(0.01, 0.0005)
        {
           float pspool = 0.0;
           {setShader(GREEN);}
        };
        module Tree(int age, float pspool) extends Sphere(0.01);";
    check(text, "Shoot", "F", &[]);
    check(
        text,
        "Bud",
        "Sphere",
        &[("shader", predefined(RED)), ("transform", StaticValue::Vector([0.0, 0.0, 0.3]))],
    );
    check(text, "Leaf", "Parallelogram", &[("shader", named("Leaf"))]);
    check(text, "Petiole", "F", &[]);
    check(text, "Meristem", "Sphere", &[("shader", predefined(RED))]);
    check(
        text,
        "Wing",
        "Scale",
        &[("scaleX", number(0.01)), ("scaleY", number(0.01)), ("scaleZ", number(0.01))],
    );
    check(text, "Blade", "Parallelogram", &[("shader", named("Leaf"))]);
    check(text, "Blade38", "Parallelogram", &[]);
    check(text, "Blade37", "Parallelogram", &[]);
    check(text, "Internode", "F", &[("pspool", number(0.0)), ("shader", predefined(GREEN))]);
    check(text, "Tree", "Sphere", &[]);
}

#[test]
fn root_project() {
    let text = "module Root(int rank, int order, super.length, super.diameter, super.shader) extends F(length, diameter).(setShader(shader));
        module RootMeristem(int rank, int order, float length, float diameter) ==> Sphere(0.01);
        // a water source
        module WaterSource(float level) ==>
            Sphere().(setLayer(2), setRadius(0.0045+level*0.006), setShader(new RGBAShader(1-level, 0, level)));";
    check(text, "Root", "F", &[]);
    check(text, "RootMeristem", "Node", &[]);
    assert!(resolve(text, "WaterSource").has_body);
}

#[test]
fn mangrove() {
    let text = "module Node(String nID, String nCode) extends Sphere(1)
        {
            {
                //setShader(RED);
                setShader(EGA_6);
            }
        }
        module Internode(int id2, super.length, super.baseRadius, super.topRadius,
            @Range(min=-0.9999999, max=0.9999999) double sx,
            @Range(min=-0.9999999, max=0.9999999) double sz) extends Frustum(length, baseRadius, topRadius)
        {
            Matrix4d ltr;
            double sxo = 0.0;
            boolean apBud = false;
            String part = null; // internode type
            double[] distanceLeafPair;
            {
                setShader(EGA_6);
                setTransform(new TMatrix4d());
            }
            public void setLocation(Point3d location)
            {
                ((TMatrix4d) this[transform])[m03] = location.x;
            }
        }
        module LeafTexture(super.length, float width) extends Parallelogram(length, width)
        {
            { setShader(leafShader); }
        }
        module MeshNodeCustom extends MeshNode { double abs; }
        module RefTile(double len, double wid)
        {
            double abs;
            double getArea() { return len*wid; }
        }
        ==> RL(-90)
        Parallelogram(len, wid).(setShader(mangroveShader));
        static String csv_path = \"C:\\\\Users\\\\x\\\\TF_05.csv\";
        const ShaderRef leafShader = shader(\"leaf2\");	// options: leaf, leaf2
        static Phong mangroveShader = new Phong()
            .(setDiffuse(new Graytone(0.15)))				// 15% reflected
            .(setDiffuseTransparency(new Graytone(0.09)));	// 9% transmitted
        static AlgorithmSwitchShader mangroveShaderAS = new AlgorithmSwitchShader(GREEN, GREEN, mangroveShader);
        module X extends Sphere {{ setShader(mangroveShaderAS); }}";
    check(text, "Node", "Sphere", &[("shader", predefined(6))]);
    check(
        text,
        "Internode",
        "Frustum",
        &[
            ("apBud", StaticValue::Bool(false)),
            ("part", StaticValue::Null),
            ("shader", predefined(6)),
            ("sxo", number(0.0)),
            ("transform", StaticValue::Null),
        ],
    );
    check(text, "LeafTexture", "Parallelogram", &[("shader", named("leaf2"))]);
    check(text, "MeshNodeCustom", "MeshNode", &[]);
    assert!(resolve(text, "RefTile").has_body);
    let phong = StaticShader::Phong {
        channels: vec![
            ("diffuse".into(), StaticChannel::Gray(0.15)),
            ("diffuseTransparency".into(), StaticChannel::Gray(0.09)),
        ],
    };
    let green = || Some(Box::new(StaticShader::Predefined(GREEN)));
    let switch =
        StaticShader::AlgorithmSwitch { gui: green(), raytracer: green(), radiation: Some(Box::new(phong)) };
    assert_eq!(value(text, "shader"), StaticValue::Shader(switch));

    let light = "module SingleLight(double power) extends LightNode().(setLayer(15), setLight(new DirectionalLight()
        .(setPowerDensity(power), setVisualize(seeRays), getColor().set(new RGBColor(1,1,1)))))\n//==> Sphere(0.1)\n;
        module DirectLight { float[] power = new float[n]; void update() { for (int j=0; j <= n-1; j++) {} } }
        ==> AdjustLU RL(90) RU(90*mod)
        [for (int j=0; j <= n-1; j++) ([RU(azimuth[j]) SingleLight(power[j])] /* {println( power[j]);} */  ) ]
        ;
        module Other;";
    check(light, "SingleLight", "LightNode", &[("layer", number(15.0))]);
    assert!(resolve(light, "DirectLight").has_body);
    check(light, "Other", "Node", &[]);
}

#[test]
fn arguments_pass_through_modules() {
    let text = "module A(float len, super.diameter) extends F(len * 2, diameter) {{ setLayer(3); }}
        module B extends A(1.5, 0.25) { { layer = 4; } }
        module C(int n) extends B;
        module D(float f) extends A(f, f);
        abstract module E extends D(1f) {}";
    check(text, "A", "F", &[("layer", number(3.0))]);
    let passed = |len: f64, diameter: f64| {
        [
            ("diameter", number(diameter)),
            ("layer", number(4.0)),
            ("len", number(len)),
            ("length", number(2.0 * len)),
        ]
    };
    check(text, "B", "F", &passed(1.5, 0.25));
    check(text, "C", "F", &passed(1.5, 0.25));
    check(text, "D", "F", &[("layer", number(3.0))]);
    check(
        text,
        "E",
        "F",
        &[
            ("diameter", number(1.0)),
            ("f", number(1.0)),
            ("layer", number(3.0)),
            ("len", number(1.0)),
            ("length", number(2.0)),
        ],
    );
}

#[test]
fn java_classes() {
    let text = "public class A extends Sphere {
            static final double R = 0.5;
            A() { super(R / 2); setShader(RED); }
            A(int x) { super(x); }
            static class B extends Box { { length = 2; this.width = 3; this[height] = 4; } }
            module C extends B;
        }
        module D extends A.B;
        module E extends Sphere(A.R);";
    check(text, "A", "Sphere", &[("radius", number(0.25)), ("shader", predefined(RED))]);
    let sizes = [("height", number(4.0)), ("length", number(2.0)), ("width", number(3.0))];
    check(text, "A$B", "Box", &sizes);
    check(text, "A$C", "Box", &sizes);
    check(text, "D", "Box", &sizes);
    check(text, "E", "Sphere", &[("radius", number(0.5))]);
}

#[test]
fn constructor_arguments() {
    for (declaration, field, expected) in [
        ("Parallelogram(2, 3)", "axis", StaticValue::Vector([1.5, 0.0, 0.0])),
        ("Parallelogram(2, 3)", "length", number(2.0)),
        ("Null(1, 2, 3)", "transform", StaticValue::Vector([1.0, 2.0, 3.0])),
        ("Null().(setX(1), z = 2)", "transform", StaticValue::Vector([1.0, 0.0, 2.0])),
        ("Sphere().(setTranslation(1, 2, 3))", "transform", StaticValue::Vector([1.0, 2.0, 3.0])),
        ("Line(0, 1, 2)", "axis", StaticValue::Vector([0.0, 1.0, 2.0])),
        ("Line().(setColor(1, 0.5, 0))", "color", StaticValue::Vector([1.0, 0.5, 0.0])),
        ("RD(new Vector3d(0, 0, -1), 0.5)", "direction", StaticValue::Vector([0.0, 0.0, -1.0])),
        ("Scale(0.5)", "scaleY", number(0.5)),
        ("Scale(1, 2, 3)", "scaleZ", number(3.0)),
        ("Scale().(setScale(2))", "scaleX", number(2.0)),
        ("Rotate(1, 2, 3)", "rotateZ", number(3.0)),
        ("Minus(30)", "angle", number(-30.0)),
        ("RV(-0.1)", "argument", number(-0.1)),
        ("M(-10)", "length", number(-10.0)),
        ("DlMul(2)", "argument", number(2.0)),
        ("P(4)", "shader", predefined(4)),
        ("P(0xFF0000)", "argument", number(-1.0)),
        ("P(0xFF0000)", "shader", rgba(1.0, 0.0, 0.0)),
        ("P(RED)", "shader", predefined(RED)),
        ("F(1, 2, 7)", "color", number(7.0)),
        ("F(1).(setColor(0x00FF00))", "shader", rgba(0.0, 1.0, 0.0)),
        ("F(1).(setColor(12))", "color", number(12.0)),
        ("Box.(setColor(0.25, 0.5, 1))", "shader", rgba(0.25, 0.5, 1.0)),
        ("Cylinder(1, 2).(setOpen(true))", "topOpen", StaticValue::Bool(true)),
        ("Cone(1, 2).(setOpen(true))", "open", StaticValue::Bool(true)),
        ("de.grogra.imp3d.objects.Sphere(2)", "radius", number(2.0)),
        ("Sphere(2).(setShader(null))", "shader", StaticValue::Null),
        ("Sphere().(setScale(0.1))", "scale", number(0.1)),
    ] {
        assert_eq!(value(&format!("module X extends {declaration};"), field), expected, "{declaration}");
    }
}

#[test]
fn arithmetic() {
    for (expression, expected) in [
        ("1 + 2 * 3 - -4", 11.0),
        ("(1 + 2) * 3", 9.0),
        ("7 / 2", 3.0),
        ("-7 / 2", -3.0),
        ("7 / 2.0", 3.5),
        ("7 / 2f", 3.5),
        ("(float) 7 / 2", 3.5),
        ("(int) 7.9", 7.0),
        ("7 % 4 + 0x10", 19.0),
        ("Math.toRadians(180) / Math.PI", 1.0),
        ("Math.max(1, 2) + Math.pow(2, 3)", 10.0),
        ("(((2)))", 2.0),
        ("- - -2", -2.0),
    ] {
        assert_eq!(evaluate(expression), expected, "{expression}");
    }
    let text = "const int A = 7; const float B = 7; final static double C = A / 2, D = B / 2;
        module X extends Parallelogram(C, D * 2);";
    check(
        text,
        "X",
        "Parallelogram",
        &[("axis", StaticValue::Vector([3.5, 0.0, 0.0])), ("length", number(3.0))],
    );
}

#[test]
fn shaders() {
    let phong = |name: &str, channel| StaticShader::Phong { channels: vec![(name.into(), channel)] };
    for (expression, expected) in [
        ("EGA_12", StaticShader::Predefined(12)),
        ("RGBAShader.WHITE", StaticShader::Predefined(28)),
        ("shader(\"a b\")", StaticShader::Named("a b".into())),
        ("new MaterialRef(\"m\")", StaticShader::Named("m".into())),
        ("new RGBAShader()", StaticShader::Rgba([0.5, 0.5, 0.5, 1.0])),
        ("new RGBAShader(1, 0, 0.5, 0.25)", StaticShader::Rgba([1.0, 0.0, 0.5, 0.25])),
        ("new RGBAShader(0x00FF00FF)", StaticShader::Rgba([1.0, 0.0, 1.0, 0.0])),
        ("new RGBAShader(0xFFFF0000)", StaticShader::Rgba([1.0, 0.0, 0.0, 1.0])),
        ("new Phong()", StaticShader::Phong { channels: vec![] }),
        (
            "new Phong().(setDiffuse(new RGBColor(0, 1, 0)))",
            phong("diffuse", StaticChannel::Rgb([0.0, 1.0, 0.0])),
        ),
        ("new Phong().(diffuse = RGBColor.RED)", phong("diffuse", StaticChannel::Rgb([1.0, 0.0, 0.0]))),
        (
            "new Phong().(setDiffuse(new ImageMap().(setImage(image(\"leaf\")))))",
            phong("diffuse", StaticChannel::Image("leaf".into())),
        ),
        (
            "(Shader) new de.grogra.imp3d.shading.Phong().(setShininess(new Graytone(0.5)))",
            phong("shininess", StaticChannel::Gray(0.5)),
        ),
        (
            "new AlgorithmSwitchShader(null, RED)",
            StaticShader::AlgorithmSwitch {
                gui: None,
                raytracer: None,
                radiation: Some(Box::new(StaticShader::Predefined(RED))),
            },
        ),
    ] {
        assert_eq!(shader(expression), expected, "{expression}");
    }
    let local = "module X extends Sphere {{
        Phong p = new Phong(); p.setDiffuse(new Graytone(0.25)); float r = 2; { setRadius(r / 4); }
        setShader(p); }}";
    assert_eq!(value(local, "shader"), StaticValue::Shader(phong("diffuse", StaticChannel::Gray(0.25))));
    assert_eq!(value(local, "radius"), number(0.5));
}

#[test]
fn what_is_not_static_is_reported() {
    for (text, expected) in [
        ("module X extends Sphere(random(0, 1));", "test.rgg:1: the value of a constructor argument"),
        ("module X extends Sphere(r);", "'r' is not a known constant"),
        ("static float r = 1; module X extends Sphere(r);", "may change"),
        (
            "module X extends Sphere {\n{ if (a) { setRadius(2); } else setRadius(3); } }",
            "test.rgg:2: a statement",
        ),
        ("module X extends Sphere {{ grow(); }}", "'grow'"),
        ("module X extends Sphere {{ radius += 2; }}", "'radius'"),
        ("module X extends Sphere {{ setShader(get().shader); }}", "'shader'"),
        ("module X extends Plane(1);", "'Plane'"),
        ("const float A = B; const float B = A; module X extends Sphere(A);", "refers to itself"),
        ("module X extends Sphere(1/0);", "divides by zero"),
        ("module X extends X;", "extends itself"),
        ("module X extends Y; module Y extends Z; module Z extends X;", "extends itself"),
        ("module X(float r) extends Sphere { { setRadius(radius); } }", "'radius'"),
    ] {
        let module = resolve(text, "X");
        assert_eq!(module.unresolved.len(), 1, "{text}: {:?}", module.unresolved);
        assert!(module.unresolved[0].contains(expected), "{text}: {:?}", module.unresolved);
    }
    // The rest of the module is used nevertheless.
    let text = "module X extends Sphere(0.5) {{ while (a) { b(); } setLayer(2); setRadius(c()); }}";
    let module = resolve(text, "X");
    check_module(&module, "Sphere", &[("layer", number(2.0)), ("radius", number(0.5))]);
    assert_eq!(resolve("module X extends X;", "X").base, builtins::NODE);
}

#[test]
fn names_are_looked_up_in_other_files() {
    let sources = sources(&[
        (
            "main/Model.rgg",
            "import static Parts.*; import other.Cone;
            module A extends Base {{ setShader(mat); }} module Box extends Sphere(SIZE);
            module B extends Box; module C extends Parts.Thing; module D extends Cone(1, 2);
            module E extends Cylinder(2, 3); module F extends Far;",
        ),
        (
            "main/Parts.rgg",
            "const Shader mat = shader(\"m\"); const double SIZE = 2; module Base extends Plane;
            module Thing extends Box(1, 1, 1);",
        ),
        ("Far.rgg", "module Far extends Sphere; module Cylinder; const Shader mat = RED;"),
        ("lib/Lib.xl", "package a.b; public class Organ extends Sphere {}"),
    ]);
    assert_eq!(sources.problems(), []);
    let get = |name: &str| sources.resolve(name).expect(name);
    check_module(&get("Model$A"), "Plane", &[("shader", named("m"))]);
    check_module(&get("Model$B"), "Sphere", &[("radius", number(2.0))]);
    check_module(
        &get("Parts$Thing"),
        "Box",
        &[("height", number(1.0)), ("length", number(1.0)), ("width", number(1.0))],
    );
    assert_eq!(get("Model$C").base, get("Parts$Thing").base);
    check_module(&get("Model$D"), "Cone", &[]);
    assert_eq!(get("Model$D").base, "Cone");
    // A class of the same name in a file that is not imported does not count.
    assert_eq!(get("Model$E").base, "de.grogra.imp3d.objects.Cylinder");
    assert_eq!(get("Model$F").base, "de.grogra.imp3d.objects.Sphere");
    assert_eq!(get("Model$B").declared_at, ("main/Model.rgg".to_owned(), 3));
    assert_eq!(get("a.b.Organ").base, "de.grogra.imp3d.objects.Sphere");
    assert!(sources.resolve("Model").is_none());
    assert!(sources.resolve("Model$Z").is_none());
    assert!(sources.resolve("").is_none());
}

#[test]
fn initialisers_of_parameterised_modules() {
    // Parameters are 0 in an instance that is made without arguments.
    check(
        "module X(float a) extends Sphere {{ setRadius(a + 1); }}",
        "X",
        "Sphere",
        &[("radius", number(1.0))],
    );
    // The file holds what a with-block derives from parameters.
    let text = "module X(float a) extends Sphere.(setRadius(a + 1), setLayer(2));";
    check(text, "X", "Sphere", &[("layer", number(2.0))]);
    // Own fields hide those of the base class.
    check(
        "module X(float x) extends Sphere { float radius = 3; { x = 2; } }",
        "X",
        "Sphere",
        &[("x", number(2.0))],
    );
}

#[test]
fn hostile_sources_end() {
    let many = 50_000;
    let mut doubling = String::from("const double A0 = 1; const Shader S0 = RED;");
    for i in 1..100 {
        let j = i - 1;
        doubling += &format!("const double A{i} = A{j} + A{j};");
        doubling += &format!("const Shader S{i} = new AlgorithmSwitchShader(S{j}, S{j});");
    }
    doubling += "module X extends Sphere(A50).(setShader(S50));";
    let locals = "s = new AlgorithmSwitchShader(s, s);".repeat(1000);
    let longest: String = (0..many).map(|i| format!("module M{} extends M{i};", i + 1)).collect();
    for text in [
        doubling,
        format!("module X extends Sphere {{{{ Shader s = RED; {locals} setShader(s); }}}}"),
        format!("{longest} module X extends M{many};"),
        format!("module X extends Sphere({}1{});", "(".repeat(many), ")".repeat(many)),
        format!("module X extends Sphere({}1);", "-".repeat(many)),
        format!("module X extends Sphere({}1);", "(int)".repeat(many)),
        format!("module X extends Sphere({}1);", "1+".repeat(many)),
        format!("module X extends Sphere({}1{});", "f(".repeat(many), ")".repeat(many)),
        format!("module X extends Sphere(1){};", ".(a = 1)".repeat(many)),
        format!("module X extends Sphere {{{} a = 1; {}}}", "{".repeat(many), "}".repeat(many)),
        format!("module X extends Sphere {{{{{}}}}}", "if (a) ".repeat(many)),
        format!("module X extends Sphere {{{{{}}}}}", "if (a) b; else ".repeat(many)),
        format!("module X extends Sphere {{{{{}}}}}", "a.".repeat(many)),
        format!("module X extends Sphere {{{{{}}}}}", "List<".repeat(many)),
        format!("module X({}) extends Sphere;", "float a,".repeat(many)),
        format!("module X extends Sphere({});", "1,".repeat(many)),
    ] {
        let sources = sources(&[("test.rgg", &text)]);
        assert!(sources.resolve("test$X").is_some());
    }
}

#[test]
fn broken_sources_do_no_harm() {
    // Every beginning of a source, and every source with one character left out.
    let text = "import a.*; const Shader s = new Phong().(setDiffuse(new Graytone(0.5)));\n\
        @A(1) module X(super.length, int b) extends F(length, 1e-1).(setShader(s), x = 'a') {\n\
        float c = 0x1F, d; { if (c > 1) { setLayer(2); } else e(); this[f] = \"g\\\"\"; } int h() { return 1; } }\n\
        ==> [ RL(90) X(1, 2) ] /* i */; class Y extends X { Y() { super(1); } }";
    for at in 0..text.len() {
        let start = &text[..at];
        for text in [start.to_owned(), format!("{start}{}", &text[at + 1..])] {
            let sources = sources(&[("test.rgg", &text)]);
            for name in ["test$X", "test$Y"] {
                let _ = sources.resolve(name);
            }
        }
    }
}
