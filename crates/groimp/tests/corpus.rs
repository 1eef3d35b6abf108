//! Real projects: how many objects they must yield and where these stand.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

use glam::{DVec2, DVec3};
use scene::{Camera, Projection};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The folder with the projects; without it the tests have nothing to do, except where all must run.
fn corpus() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/corpus");
    let root = std::env::var_os("SUNSHINE_CORPUS").map_or(beside, PathBuf::from);
    if root.is_dir() {
        return Some(root);
    }
    assert!(std::env::var_os("CI").is_none(), "no corpus at {}", root.display());
    println!("skipped: no corpus at {}; set SUNSHINE_CORPUS", root.display());
    None
}

/// Object counts by type name, lights, images and skipped nodes.
struct Expected {
    project: &'static str,
    objects: &'static [(&'static str, usize)],
    images: usize,
    /// Lights in the file; without one the default light is added.
    lights: usize,
    skipped: &'static [(&'static str, usize)],
    /// Instances whose bodies are not drawn.
    bodies: usize,
}

/// Counted in the graph files with `grep -c 'type="..."'`, and what bodies make in the sources.
const EXPECTED: &[Expected] = &[
    Expected {
        project: "Example07.gsz",
        objects: &[
            ("test$Bud", 93),
            ("test$Internode", 92),
            ("test$Leaf", 92),
            ("test$NiceInternode", 92),
            ("test$NiceNode", 92),
            ("test$Tile", 1600),
        ],
        images: 1,
        lights: 1,
        skipped: &[],
        bodies: 0,
    },
    Expected {
        project: "LightTest.gsz",
        objects: &[("Components$Ground", 1), ("Components$Wall", 1), ("Model$Seed", 6)],
        images: 1,
        lights: 1,
        skipped: &[],
        bodies: 0,
    },
    Expected {
        project: "Mangrove",
        objects: &[("Model$RefTile", 1)],
        images: 0,
        // light$DirectLight makes 24, one for each element of its stored arrays; light$DiffuseLight 6 x 12.
        lights: 96,
        skipped: &[],
        bodies: 0,
    },
    Expected {
        project: "SensorGridDemo",
        objects: &[("de.grogra.imp3d.objects.Plane", 1)],
        images: 0,
        lights: 1,
        skipped: &[
            ("de.grogra.imp3d.objects.SensorNodeGrid", 1),
            ("de.grogra.imp3d.objects.SensorAreaGrid", 1),
        ],
        bodies: 0,
    },
    Expected {
        project: "ShaderTest.gsz",
        objects: &[("Model$Frame", 4), ("Model$LowerC", 1), ("Model$TestShader", 1), ("Model$UpperC", 1)],
        images: 0,
        lights: 1,
        skipped: &[],
        bodies: 0,
    },
    Expected {
        project: "simple005 root.gsz",
        objects: &[
            ("de.grogra.turtle.F", 1),
            ("root$RootMeristem", 1),
            ("root$SoilParticle", 1000),
            ("root$WaterSource", 1500),
        ],
        images: 0,
        lights: 0,
        skipped: &[],
        bodies: 0,
    },
    Expected {
        project: "sm09_e10.gsz",
        objects: &[
            ("sm09_e10$Bud", 32),
            ("sm09_e10$Leaf", 62),
            ("sm09_e10$Petiole", 62),
            ("sm09_e10$Shoot", 31),
        ],
        images: 1,
        lights: 0,
        skipped: &[],
        bodies: 0,
    },
    Expected {
        project: "sm09_e17.gsz",
        objects: &[
            ("sm09_e17$Blade", 6),
            ("sm09_e17$Internode", 6),
            ("sm09_e17$Meristem", 1),
            ("sm09_e17$Petiole", 6),
        ],
        images: 1,
        lights: 0,
        skipped: &[],
        bodies: 0,
    },
    Expected {
        project: "sm09_e37.gsz",
        objects: &[
            ("sm09_e37$Blade", 5),
            ("sm09_e37$Internode", 5),
            ("sm09_e37$Meristem", 1),
            ("sm09_e37$Petiole", 5),
        ],
        images: 1,
        lights: 0,
        skipped: &[],
        bodies: 0,
    },
    Expected {
        project: "sm09_e38.gsz",
        objects: &[
            ("sm09_e38$Blade", 9),
            ("sm09_e38$Internode", 9),
            ("sm09_e38$Meristem", 1),
            ("sm09_e38$Petiole", 9),
        ],
        images: 1,
        lights: 0,
        skipped: &[],
        bodies: 0,
    },
    Expected {
        project: "sm09_e45.gsz",
        objects: &[
            ("sm09_e45$Blade", 22),
            ("sm09_e45$Internode", 22),
            ("sm09_e45$Meristem", 1),
            ("sm09_e45$Petiole", 22),
            ("sm09_e45$Tree", 1),
        ],
        images: 1,
        lights: 0,
        skipped: &[],
        bodies: 0,
    },
];

#[test]
fn object_counts() {
    let Some(corpus) = corpus() else { return };
    for expected in EXPECTED {
        let name = expected.project;
        let project = groimp::read(&corpus.join(name)).unwrap();
        let scene = &project.scene;
        let mut objects = BTreeMap::<_, usize>::new();
        for object in &scene.objects {
            *objects.entry(scene.type_names[object.origin.type_name.index()].as_str()).or_default() += 1;
        }
        assert_eq!(objects.into_iter().collect::<Vec<_>>(), expected.objects, "{name}");
        assert_eq!(scene.images.len(), expected.images, "{name}");
        assert_eq!(scene.lights.len(), expected.lights.max(1), "{name}");
        let skipped: Vec<_> =
            project.report.skipped.iter().map(|s| (s.type_name.as_str(), s.count)).collect();
        assert_eq!(skipped, expected.skipped, "{name}");
        let warned = |text| -> usize {
            let about = project.report.warnings.iter().filter(|w| w.message.contains(text));
            about.map(|w| w.count).sum()
        };
        assert_eq!(warned("no light"), usize::from(expected.lights == 0), "{name}");
        assert_eq!(warned("==>"), expected.bodies, "{name}");
    }
}

/// Box of the frames' origins, and range of the image coordinates in the saved view.
struct Figures {
    project: &'static str,
    points: usize,
    min: [f64; 3],
    max: [f64; 3],
    x: [f64; 2],
    y: [f64; 2],
}

const FIGURES: &[Figures] = &[
    Figures {
        project: "sm09_e10.gsz",
        points: 374,
        min: [-12.667, -9.606, 0.0],
        max: [13.444, 8.824, 19.739],
        x: [-0.85, 0.86],
        y: [-0.65, 0.65],
    },
    Figures {
        project: "sm09_e17.gsz",
        points: 38,
        min: [-0.190, -0.107, 0.0],
        max: [0.034, 0.208, 0.943],
        x: [-0.03, 0.16],
        y: [-0.28, 0.34],
    },
    Figures {
        project: "sm09_e37.gsz",
        points: 32,
        min: [-0.123, -0.120, 0.0],
        max: [0.081, 0.099, 0.203],
        x: [-0.15, 0.10],
        y: [-0.04, 0.20],
    },
    Figures {
        project: "sm09_e38.gsz",
        points: 56,
        min: [-0.135, -0.147, 0.0],
        max: [0.141, 0.139, 0.365],
        x: [-0.21, 0.18],
        y: [-0.39, 0.09],
    },
    Figures {
        project: "sm09_e45.gsz",
        // 134 without the small sphere of the one sm09_e45$Tree, which stands at the origin.
        points: 136,
        min: [-0.112, -0.098, 0.0],
        max: [0.095, 0.123, 0.422],
        x: [-0.12, 0.16],
        y: [-0.49, 0.08],
    },
    Figures {
        project: "Example07.gsz",
        points: 4122,
        min: [-8.114, -12.082, -0.110],
        max: [6.728, 7.579, 16.467],
        x: [-0.22, 0.20],
        y: [-0.27, 0.20],
    },
];

fn image_point(camera: &Camera, world: DVec3) -> DVec2 {
    let view = camera.view_from_world.transform_point3(world);
    match camera.projection {
        Projection::Perspective { fov_x, .. } => view.truncate() / (-view.z * (fov_x / 2.0).tan()),
        Projection::Parallel { width, .. } => view.truncate() / (width / 2.0),
    }
}

#[test]
fn whole_scene_figures() {
    let Some(corpus) = corpus() else { return };
    for figures in FIGURES {
        let name = figures.project;
        let path = corpus.join(name);
        let camera = groimp::read(&path).unwrap().scene.camera;
        let frames = groimp::drawn_frames(&path).unwrap();
        let points: Vec<_> = frames.iter().flat_map(|f| [f.own_origin, f.post_origin]).collect();
        assert_eq!(points.len(), figures.points, "{name}");
        let min = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let max = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        // Half a unit of the last digit given, and the angles' single precision.
        let near = |found: f64, expected: f64, unit: f64| (found - expected).abs() < 0.51 * unit + 1e-6;
        for i in 0..3 {
            assert!(near(min[i], figures.min[i], 1e-3), "{name}: minimum {min}");
            assert!(near(max[i], figures.max[i], 1e-3), "{name}: maximum {max}");
        }
        let images: Vec<_> = points.iter().map(|p| image_point(&camera, *p)).collect();
        let low = images.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = images.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        assert!(near(low.x, figures.x[0], 0.01) && near(high.x, figures.x[1], 0.01), "{name}: {low} {high}");
        assert!(near(low.y, figures.y[0], 0.01) && near(high.y, figures.y[1], 0.01), "{name}: {low} {high}");
    }
}

#[test]
fn leaves_get_the_shader_that_only_their_source_names() {
    let Some(corpus) = corpus() else { return };
    let scene = groimp::read(&corpus.join("sm09_e10.gsz")).unwrap().scene;
    let leaf = scene.objects.iter().find(|o| scene.type_names[o.origin.type_name.index()] == "sm09_e10$Leaf");
    let scene::Material::Phong(phong) = &scene.materials[leaf.unwrap().material.index()] else {
        panic!("the leaf has no Phong")
    };
    let scene::Channel::ImageMap { image, bilinear: true, .. } =
        scene.channels[phong.diffuse.unwrap().index()]
    else {
        panic!("the leaf has no picture")
    };
    assert_eq!(scene.images[image.index()].name, "images/BlattOben1_alpha.png");
    // sm09_e10$Bud: the radius is set by an initialiser and not in the file.
    let bud = scene.objects.iter().find(|o| scene.type_names[o.origin.type_name.index()] == "sm09_e10$Bud");
    assert_eq!(bud.unwrap().shape, scene::Shape::Sphere { radius: 0.2 });
}

#[test]
fn bodies_use_the_fields_of_their_instances() {
    let Some(corpus) = corpus() else { return };
    let read = |name: &str| groimp::read(&corpus.join(name)).unwrap().scene;
    let of = |scene: &scene::Scene, name: &str| -> Vec<scene::Object> {
        let objects = scene.objects.iter();
        objects.filter(|o| scene.type_names[o.origin.type_name.index()] == name).cloned().collect()
    };
    let roots = read("simple005 root.gsz");
    // radius 0.5 in the file, radius / 50 in the body.
    let soil = of(&roots, "root$SoilParticle");
    assert_eq!(soil[0].shape, scene::Shape::Sphere { radius: 0.01 });
    // level 1: 0.0045 + 1 * 0.006, and RGBAShader(1 - level, 0, level).
    let water = of(&roots, "root$WaterSource");
    let scene::Shape::Sphere { radius } = water[0].shape else { panic!("{:?}", water[0]) };
    assert!((radius - 0.0105).abs() < 1e-9, "{radius}");
    let blue = scene::Material::Rgba { color: [0.0, 0.0, 1.0], opacity: 1.0 };
    assert_eq!(roots.materials[water[0].material.index()], blue);
    let shaders = read("ShaderTest.gsz");
    // opening 0.05: four boxes of width 0.45, a quarter away from the axis on all sides.
    let frame = of(&shaders, "Model$Frame");
    for (object, [x, y]) in frame.iter().zip([[0.25, 0.0], [0.0, 0.25], [-0.25, 0.0], [0.0, -0.25]]) {
        let scene::Shape::Box { width, height, length } = object.shape else { panic!("{object:?}") };
        assert!((width - 0.45).abs() < 1e-6 && height == 1.0 && length == 0.001);
        let centre = object.world_from_object.translation.truncate();
        assert!((centre - DVec2::new(x, y)).length() < 1e-9, "{centre}");
    }
    let [test] = &of(&shaders, "Model$TestShader")[..] else { panic!("not one TestShader") };
    let scene::Material::Phong(phong) = &shaders.materials[test.material.index()] else { panic!("no Phong") };
    let diffuse = &shaders.channels[phong.diffuse.unwrap().index()];
    assert_eq!(diffuse, &scene::Channel::Constant([0.0, 1.0, 0.0]));
}
