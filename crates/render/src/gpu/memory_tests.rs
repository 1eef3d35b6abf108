//! Cards with less memory than is asked for. Memory is short here because the test says so, not the driver.

use super::{Gpu, adapters};
use crate::{CompiledScene, ControlFlow, Device, DeviceError, Film, LoadedScene, RenderSettings, compile};
use scene::{DAffine3, DVec3, Light, LightKind, Material, Object, Origin, Scene, Shape, Sky, TypeNameId};
use std::sync::Arc;

/// Bytes of a pixel of the film.
const PIXEL: u64 = 32;

/// The first adapter with other limits and with some memory for buffers that are made together.
fn gpu(change: impl Fn(&mut wgpu::Limits), memory: u64) -> Option<Arc<Gpu>> {
    let adapters = adapters::all();
    let Some((adapter, info)) = adapters.first() else {
        assert!(std::env::var_os("SUNSHINE_REQUIRE_GPU").is_none(), "no GPU adapter was found");
        return None;
    };
    let mut limits = adapter.limits();
    change(&mut limits);
    let gpu = Gpu::start(adapter, info, limits).unwrap();
    Some(Arc::new(Gpu { memory, ..gpu }))
}

/// Lit spheres under a sky.
fn spheres(count: u32) -> Arc<CompiledScene> {
    let mut scene = Scene { type_names: vec!["test".to_owned()], ..Scene::default() };
    let origin = Origin { node: 1, type_name: TypeNameId(0) };
    let material = scene.add_material(Material::Rgba { color: [0.7; 3], opacity: 1.0 });
    for number in 0..count {
        scene.objects.push(Object {
            shape: Shape::Sphere { radius: 0.4 },
            world_from_object: DAffine3::from_translation(DVec3::new(f64::from(number), 0.0, 0.0)),
            material,
            emission: None,
            interior: None,
            origin,
        });
    }
    scene.lights.push(Light {
        kind: LightKind::Point { power: [50.0; 3] },
        world_from_light: DAffine3::from_translation(DVec3::new(0.0, -2.0, 3.0)),
        attenuation: Default::default(),
        shadowless: false,
        origin,
    });
    scene.sky = Some(Sky::uniform([0.2; 3], origin));
    Arc::new(compile(&scene).unwrap())
}

fn settings() -> RenderSettings {
    RenderSettings {
        width: 96,
        height: 80,
        samples: 2,
        depth: 2,
        tile: Some(4096),
        ..RenderSettings::default()
    }
}

fn film(scene: &dyn LoadedScene) -> Result<Film, DeviceError> {
    scene.render(&settings(), &|_| ControlFlow::Continue(()))
}

fn bytes(film: &Film) -> &[u8] {
    bytemuck::cast_slice(&film.pixels)
}

#[test]
fn a_table_that_is_too_large_is_refused_with_the_figure() {
    // 128 bytes an object.
    let scene = spheres(1000);
    let least = |limits: &mut wgpu::Limits| limits.max_storage_buffer_binding_size = 1 << 16;
    let Some(gpu) = gpu(least, u64::MAX) else { return };
    let error = gpu.load(Arc::clone(&scene)).map(|_| ()).unwrap_err();
    let DeviceError::TooLarge { table, needed, limit, .. } = error else { panic!("{error}") };
    assert_eq!((table, needed, limit), ("objects", 128_000, 1 << 16));
}

#[test]
fn a_scene_that_does_not_fit_is_refused_with_the_figure() {
    let scene = spheres(1000);
    let Some(gpu) = gpu(|_| {}, 100_000) else { return };
    let error = gpu.load(scene).map(|_| ()).unwrap_err();
    let DeviceError::OutOfMemory { what, needed, .. } = &error else { panic!("{error}") };
    assert!(*what == "the scene" && *needed > 128_000, "{error}");
    assert!(error.to_string().contains(" MB; "), "{error}");
}

#[test]
fn tiles_become_smaller_when_memory_is_short_and_the_picture_stays() {
    let scene = spheres(3);
    let Some(roomy) = gpu(|_| {}, u64::MAX) else { return };
    let expected = film(&*roomy.load(Arc::clone(&scene)).unwrap()).unwrap();
    // A tile and its way back: half of the picture does not fit, a tile of 64 x 64 pixels does.
    let Some(small) = gpu(|_| {}, 2 * 64 * 64 * PIXEL) else { return };
    let loaded = small.load(Arc::clone(&scene)).unwrap();
    assert!(bytes(&film(&*loaded).unwrap()) == bytes(&expected));
    // Likewise if one binding takes no more than that.
    let least = |limits: &mut wgpu::Limits| limits.max_buffer_size = 64 * 64 * PIXEL;
    let Some(narrow) = gpu(least, u64::MAX) else { return };
    assert!(bytes(&film(&*narrow.load(Arc::clone(&scene)).unwrap()).unwrap()) == bytes(&expected));
}

#[test]
fn without_memory_for_the_smallest_tile_the_processor_goes_on_with_what_there_is() {
    let scene = spheres(3);
    let Some(poor) = gpu(|_| {}, 2 * 64 * 64 * PIXEL - 1) else { return };
    let loaded = poor.load(Arc::clone(&scene)).unwrap();
    let error = film(&*loaded).unwrap_err();
    assert!(
        matches!(error, DeviceError::OutOfMemory { needed, .. } if needed == 2 * 64 * 64 * PIXEL),
        "{error}"
    );
    let cpu = crate::open_device(crate::DeviceChoice::Cpu, Some(1)).unwrap();
    let expected = film(&*cpu.load(Arc::clone(&scene)).unwrap()).unwrap();
    // As every rendering on a card has it.
    let spare = move || Ok((cpu.name(), cpu.load(Arc::clone(&scene))?));
    let devices = vec![("the card".to_owned(), loaded)];
    let several = crate::several::Several::new(devices, Some(Box::new(spare)));
    assert!(bytes(&film(&several).unwrap()) == bytes(&expected));
    let told = several.failures().join("\n");
    assert!(told.contains("no memory left for a tile") && told.contains("goes on"), "{told}");
}
