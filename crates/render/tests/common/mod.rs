//! Small scenes and devices for the tests of the renderer.
#![allow(dead_code, reason = "each test file uses a part")]
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

pub mod access;
pub mod convergence;
pub mod garden;
pub mod laboratory;

use render::gpu::Gpu;
use render::{
    Acceleration, ControlFlow, Device, DeviceChoice, Film, RenderSettings, compile, compile_with, list_gpus,
    open_device,
};
use scene::{
    Camera, Channel, DAffine3, DVec3, Light, LightKind, Material, MaterialId, Object, Origin, Phong,
    Projection, Rgb, Scene, Shape, Sky, TypeNameId,
};
use std::sync::{Arc, OnceLock};

pub const ORIGIN: Origin = Origin { node: 1, type_name: TypeNameId(0) };

/// A scene under construction.
pub struct Builder {
    pub scene: Scene,
}

impl Builder {
    pub fn new() -> Self {
        let scene = Scene { type_names: vec!["test".to_owned()], ..Scene::default() };
        Builder { scene }
    }

    pub fn diffuse(&mut self, color: Rgb) -> MaterialId {
        self.scene.add_material(Material::Rgba { color, opacity: 1.0 })
    }

    pub fn phong(&mut self, build: impl FnOnce(&mut Scene) -> Phong) -> MaterialId {
        let phong = build(&mut self.scene);
        self.scene.add_material(Material::Phong(phong))
    }

    pub fn object(&mut self, shape: Shape, world_from_object: DAffine3, material: MaterialId) -> &mut Object {
        self.scene.objects.push(Object {
            shape,
            world_from_object,
            material,
            emission: None,
            interior: None,
            origin: ORIGIN,
        });
        self.scene.objects.last_mut().unwrap()
    }

    pub fn light(&mut self, kind: LightKind, world_from_light: DAffine3) {
        self.scene.lights.push(Light {
            kind,
            world_from_light,
            attenuation: Default::default(),
            shadowless: false,
            origin: ORIGIN,
        });
    }

    pub fn sky(&mut self, radiance: Rgb) {
        self.scene.sky = Some(Sky::uniform(radiance, ORIGIN));
    }

    /// A horizontal rectangle at `centre`; the front looks up or down.
    pub fn rectangle(
        &mut self,
        centre: DVec3,
        size: (f64, f64),
        front_up: bool,
        material: MaterialId,
    ) -> &mut Object {
        let shape = Shape::Parallelogram {
            length: size.1,
            axis: DVec3::new(0.5 * size.0, 0.0, 0.0) * if front_up { -1.0 } else { 1.0 },
            scale_v: false,
        };
        // Local z runs along world y; the front of axis +x is local +y, which becomes world -z.
        let turn = DAffine3::from_rotation_x(-std::f64::consts::FRAC_PI_2);
        let world = DAffine3::from_translation(centre - DVec3::new(0.0, 0.5 * size.1, 0.0)) * turn;
        self.object(shape, world, material)
    }

    pub fn look(&mut self, eye: DVec3, at: DVec3, up: DVec3, fov_degrees: f64) {
        self.scene.camera = Camera::look_at(eye, at, up, fov_degrees.to_radians());
    }
}

pub fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

pub fn settings(width: u32, height: u32, samples: u32, depth: u32) -> RenderSettings {
    RenderSettings { width, height, samples, depth, ..RenderSettings::default() }
}

pub fn go_on(_samples: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub fn render_on(device: &dyn Device, scene: &Scene, settings: &RenderSettings) -> Film {
    let compiled = Arc::new(compile(scene).unwrap());
    device.load(compiled).unwrap().render(settings, &go_on).unwrap()
}

pub fn render(scene: &Scene, settings: &RenderSettings) -> Film {
    render_on(open_device(DeviceChoice::Cpu, None).unwrap().as_ref(), scene, settings)
}

pub fn render_without_bvh(scene: &Scene, settings: &RenderSettings) -> Film {
    let compiled = Arc::new(compile_with(scene, Acceleration::None).unwrap());
    let device = open_device(DeviceChoice::Cpu, None).unwrap();
    device.load(compiled).unwrap().render(settings, &go_on).unwrap()
}

/// The first adapter, opened once for all tests of a file, or `None` with a printed reason. With the environment
/// variable `SUNSHINE_REQUIRE_GPU` a missing adapter is a failure.
pub fn gpu() -> Option<Arc<Gpu>> {
    static FIRST: OnceLock<Option<Arc<Gpu>>> = OnceLock::new();
    FIRST.get_or_init(open_first_gpu).clone()
}

fn open_first_gpu() -> Option<Arc<Gpu>> {
    if !list_gpus().is_empty() {
        return Some(Arc::new(Gpu::open(0).unwrap()));
    }
    assert!(
        std::env::var_os("SUNSHINE_REQUIRE_GPU").is_none(),
        "SUNSHINE_REQUIRE_GPU is set, but no GPU adapter was found"
    );
    eprintln!("skipped: no GPU adapter on this machine (a software one will do: mesa-vulkan-drivers)");
    None
}

/// Mean of a picture per channel and the standard error of that mean, predicted from the samples.
pub fn mean_and_error(film: &Film) -> ([f64; 3], [f64; 3]) {
    let n = (film.width * film.height) as f64;
    let mut mean = [0.0; 3];
    let mut variance = [0.0; 3];
    for y in 0..film.height {
        for x in 0..film.width {
            for c in 0..3 {
                mean[c] += f64::from(film.radiance(x, y)[c]) / n;
                variance[c] += f64::from(film.variance_of_mean(x, y)[c]) / (n * n);
            }
        }
    }
    (mean, variance.map(f64::sqrt))
}

/// Asserts that the mean of a picture is `expected`, to `sigmas` predicted standard errors plus float rounding.
pub fn assert_mean(film: &Film, expected: [f64; 3], sigmas: f64) {
    let (mean, error) = mean_and_error(film);
    for c in 0..3 {
        let tolerance = sigmas * error[c] + 2e-5 * expected[c].abs() + 1e-9;
        assert!(
            (mean[c] - expected[c]).abs() <= tolerance,
            "channel {c}: mean {} expected {} tolerance {tolerance}",
            mean[c],
            expected[c]
        );
    }
}

/// A constant channel for Phong materials.
pub fn grey(scene: &mut Scene, value: f64) -> Option<scene::ChannelId> {
    Some(scene.add_channel(Channel::Constant([value; 3])))
}

/// A camera straight above a point at height `z`, with a very narrow view.
pub fn probe_down(builder: &mut Builder, x: f64, y: f64, z: f64) {
    builder.look(DVec3::new(x, y, z), DVec3::new(x, y, 0.0), DVec3::Y, 0.05);
}

pub const PARALLEL: fn(f64) -> Projection = |width| Projection::Parallel { width, aspect: 1.0 };
