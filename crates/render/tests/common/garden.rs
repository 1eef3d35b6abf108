//! A scene in which everything occurs.

use super::{Builder, at, grey};
use scene::{DAffine3, DVec3, Image, LightKind, Phong, Scene, Shape};

/// A heap of every shape on the ground, with leaves that are cut out by the alpha of a picture.
pub fn garden() -> Scene {
    let mut b = Builder::new();
    let ground = b.diffuse([0.4, 0.35, 0.3]);
    let red = b.diffuse([0.7, 0.2, 0.1]);
    let veil = b.scene.add_material(scene::Material::Rgba { color: [0.2, 0.3, 0.8], opacity: 0.5 });
    let pixels = (0..64 * 64u32)
        .map(|i| {
            let (x, y) = (i % 64, i / 64);
            let inside = (x as i32 - 32).pow(2) + (y as i32 - 32).pow(2) < 900;
            [60, 160, 40, if inside { 255 } else { 0 }]
        })
        .collect::<Vec<_>>();
    let image = b.scene.add_image(Image {
        name: "leaf".into(),
        width: 64,
        height: 64,
        pixels: pixels.into(),
        srgb: false,
    });
    let leaf = b.phong(|s| Phong {
        diffuse: Some(s.add_channel(scene::Channel::ImageMap { image, bilinear: true, coordinates: vec![] })),
        diffuse_transparency: grey(s, 0.2),
        ..Phong::default()
    });
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    for i in 0..60 {
        let t = f64::from(i);
        let place = DAffine3::from_translation(DVec3::new(
            (t * 0.7).sin() * 1.5,
            (t * 1.1).cos() * 1.5,
            0.1 + t * 0.02,
        )) * DAffine3::from_rotation_z(t)
            * DAffine3::from_rotation_x(t * 0.37);
        let (shape, material) = match i % 6 {
            0 => (Shape::Sphere { radius: 0.15 }, red),
            1 => (Shape::Box { width: 0.2, height: 0.3, length: 0.1 }, red),
            2 => (
                Shape::Cylinder {
                    radius: 0.05,
                    length: 0.6,
                    base_open: true,
                    top_open: false,
                    scale_v: false,
                },
                veil,
            ),
            3 => (Shape::Cone { radius: 0.15, length: 0.3, open: false, scale_v: false }, red),
            4 => (
                Shape::Frustum {
                    base_radius: 0.05,
                    top_radius: 0.15,
                    length: 0.2,
                    base_open: false,
                    top_open: true,
                    scale_v: false,
                },
                veil,
            ),
            _ => {
                (Shape::Parallelogram { length: 0.5, axis: DVec3::new(0.2, 0.0, 0.0), scale_v: false }, leaf)
            }
        };
        b.object(shape, place, material);
    }
    b.light(LightKind::Point { power: [200.0; 3] }, at(2.0, -2.0, 4.0));
    b.sky([0.3, 0.4, 0.5]);
    b.look(DVec3::new(0.0, -5.0, 3.0), DVec3::new(0.0, 0.0, 0.4), DVec3::Z, 40.0);
    b.scene
}
