//! What the camera meets first: values that are known beforehand, on both devices and in files.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use bytemuck::Zeroable;
use common::garden::garden;
use common::*;
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};
use kernels::records::kernel::LayerPixel;
use render::{
    Batch, Device, DeviceChoice, Layers, Origins, PictureTarget, RenderSettings, Sampling, ToneCurve,
    compile, open_device, pixel_events, render_bands, stream_picture,
};
use scene::{DVec3, LightKind, Origin, Scene, Shape, TypeNameId};
use std::collections::HashMap;
use std::sync::Arc;

/// A ball over the ground, seen straight from above, far from the origin of coordinates.
fn scene() -> Scene {
    let mut b = Builder::new();
    b.scene.type_names = vec!["Plane".to_owned(), "Sphere".to_owned()];
    let ground = b.diffuse([0.5, 0.4, 0.3]);
    let red = b.diffuse([0.8, 0.2, 0.1]);
    b.rectangle(DVec3::new(100.0, 0.0, 0.0), (4.0, 1.5), true, ground).origin =
        Origin { node: 41, type_name: TypeNameId(0) };
    b.object(Shape::Sphere { radius: 0.5 }, at(100.0, 0.0, 0.5), red).origin =
        Origin { node: 42, type_name: TypeNameId(1) };
    b.light(LightKind::Point { power: [50.0; 3] }, at(100.0, 0.0, 3.0));
    b.look(DVec3::new(100.0, 0.0, 6.0), DVec3::new(100.0, 0.0, 0.0), DVec3::Y, 40.0);
    b.scene
}

const SIZE: usize = 33;

fn layer_pixels(device: &dyn Device, scene: &Scene, settings: &RenderSettings) -> Vec<LayerPixel> {
    let loaded = device.load(Arc::new(compile(scene).unwrap())).unwrap();
    let batch = Batch::whole(settings);
    let mut pixels = vec![LayerPixel::zeroed(); (settings.width * settings.height) as usize];
    loaded.add_layers(settings, &batch, &mut pixels, &go_on).unwrap();
    pixels
}

/// Channels of the file by name.
fn read_channels(path: &std::path::Path) -> (HashMap<String, FlatSamples>, Option<String>) {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .unwrap();
    let manifest = image.layer_data.attributes.other.iter().find_map(|(name, value)| {
        (name == &exr::prelude::Text::from("objectTypes")).then(|| match value {
            exr::meta::attribute::AttributeValue::Text(text) => text.to_string(),
            other => panic!("{other:?}"),
        })
    });
    let channels = image.layer_data.channel_data.list;
    (channels.into_iter().map(|channel| (channel.name.to_string(), channel.sample_data)).collect(), manifest)
}

fn float(samples: &FlatSamples, x: usize, y: usize) -> f32 {
    match samples {
        FlatSamples::F32(values) => values[y * SIZE + x],
        other => panic!("{other:?}"),
    }
}

fn whole(samples: &FlatSamples, x: usize, y: usize) -> u32 {
    match samples {
        FlatSamples::U32(values) => values[y * SIZE + x],
        other => panic!("{other:?}"),
    }
}

#[test]
fn layers_of_a_file_hold_what_is_there() {
    let scene = Arc::new(compile(&scene()).unwrap());
    let loaded = open_device(DeviceChoice::Cpu, None).unwrap().load(Arc::clone(&scene)).unwrap();
    let settings = settings(SIZE as u32, SIZE as u32, 8, 2);
    let layers: Layers = "all".parse().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    let target = PictureTarget {
        path: &path,
        width: settings.width,
        height: settings.height,
        exposure: None,
        tone_curve: ToneCurve::default(),
        layers: &layers,
        origins: &Origins::of(&scene),
        provenance: None,
    };
    stream_picture(&target, |sink| {
        render_bands(&*loaded, &settings, Sampling::Uniform, true, 1, &go_on, sink).map(|_| ())
    })
    .unwrap();
    let (channels, manifest) = read_channels(&path);
    assert_eq!(channels.len(), 20);
    assert_eq!(manifest.as_deref(), Some("41 Plane\n42 Sphere\n"));
    let film = loaded.render(&settings, &go_on).unwrap();
    let middle = SIZE / 2;

    // The top of the ball: a metre above the ground and five below the camera. A pixel is 0.11 m wide there.
    let close = |name: &str, x: usize, y: usize, expected: f32, tolerance: f32| {
        let value = float(&channels[name], x, y);
        assert!((value - expected).abs() < tolerance, "{name} at {x},{y}: {value}, expected {expected}");
    };
    close("Z", middle, middle, 5.0, 0.02);
    close("P.X", middle, middle, 100.0, 0.06);
    close("P.Z", middle, middle, 1.0, 0.02);
    close("N.Z", middle, middle, 1.0, 0.02);
    for (name, expected) in [("albedo.R", 0.8), ("albedo.G", 0.2), ("albedo.B", 0.1)] {
        close(name, middle, middle, expected, 1e-5);
    }
    assert_eq!(whole(&channels["objectId"], middle, middle), 42);
    assert_eq!(whole(&channels["instanceId"], middle, middle), 0);

    // The ground right of the ball: exact, because it is flat.
    let right = middle + 10;
    close("Z", right, middle, 6.0, 1e-4);
    close("P.Z", right, middle, 0.0, 1e-4);
    close("N.Z", right, middle, 1.0, 1e-5);
    close("albedo.R", right, middle, 0.5, 1e-5);
    assert_eq!(whole(&channels["objectId"], right, middle), 41);
    let materials = [right, middle].map(|x| whole(&channels["materialId"], x, middle));
    assert!(materials[0] != materials[1] && materials.iter().all(|&id| id > 0), "{materials:?}");

    // Above the ground's edge there is nothing.
    close("P.X", middle, 0, 0.0, 1e-9);
    close("albedo.R", middle, 0, 0.0, 1e-9);
    assert_eq!(float(&channels["Z"], middle, 0), f32::INFINITY);
    assert_eq!(whole(&channels["objectId"], middle, 0), 0);

    for (x, y) in [(middle, middle), (right, 3), (middle, 0)] {
        assert_eq!(whole(&channels["samples"], x, y), 8);
        assert_eq!(float(&channels["R"], x, y), film.radiance(x as u32, y as u32)[0]);
        assert_eq!(float(&channels["variance.B"], x, y), film.variance_of_mean(x as u32, y as u32)[2]);
    }
}

#[test]
fn both_devices_see_the_same_layers() {
    let Some(gpu) = gpu() else { return };
    let scene = garden();
    let settings = settings(40, 30, 4, 1);
    let cpu = layer_pixels(&*open_device(DeviceChoice::Cpu, None).unwrap(), &scene, &settings);
    let gpu = layer_pixels(&gpu, &scene, &settings);
    let close = |a: f32, b: f32| (a - b).abs() <= 1e-3 * (1.0 + a.abs());
    let same = |a: &LayerPixel, b: &LayerPixel| {
        let triples = [(a.albedo, b.albedo), (a.normal, b.normal), (a.position, b.position)];
        let numbers = |p: &LayerPixel| (p.samples, p.hits, p.object, p.instance, p.material);
        numbers(a) == numbers(b)
            && close(a.depth, b.depth)
            && triples.iter().all(|(a, b)| (0..3).all(|c| close(a.to_array()[c], b.to_array()[c])))
    };
    let different = cpu.iter().zip(&gpu).filter(|(a, b)| !same(a, b)).count();
    // Rays that graze an edge may see what is behind it.
    assert!(different * 50 <= cpu.len(), "{different} of {} pixels differ", cpu.len());
    assert!(cpu.iter().any(|pixel| pixel.hits == 4) && cpu.iter().all(|pixel| pixel.samples == 4));
}

#[test]
fn the_events_of_a_pixel_add_up_to_its_radiance() {
    let scene = scene();
    let compiled = compile(&scene).unwrap();
    let settings = settings(SIZE as u32, SIZE as u32, 1, 3);
    let middle = (SIZE / 2) as u32;
    let text = pixel_events(&compiled, &settings, (middle, middle), 2);
    for part in [
        "sample 0",
        "sample 1",
        "ray 0 from (100.000000 0.000000 6.000000)",
        "meets the front of Sphere (node 42)",
        "by a light that was chosen",
    ] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
    // The last line of the first path is what the picture's only sample brought.
    let film = render(&scene, &settings);
    let [r, g, b] = film.radiance(middle, middle);
    assert!(text.contains(&format!("radiance ({r:.6} {g:.6} {b:.6})")), "{r} {g} {b}\n{text}");
}
