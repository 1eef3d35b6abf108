//! Pictures of all formats, stored once and with what their colours mean.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{directory, graph};
use groimp::{Project, ReadOptions};
use image::{DynamicImage, GrayAlphaImage, ImageFormat, RgbImage, RgbaImage};
use std::io::Cursor;
use std::path::PathBuf;

fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A project with a sphere for each picture, which is its diffuse channel.
fn project(test: &str, pictures: &[(&str, Vec<u8>)]) -> PathBuf {
    let mut items = String::new();
    let mut nodes = String::new();
    for (id, (name, _)) in (1..).zip(pictures) {
        items +=
            &format!("<de.grogra.pf.ui.registry.FileObjectItem name=\"{name}\" systemId=\"pfs:{name}\"/>");
        nodes += &format!(
            "<node id=\"{id}\" type=\"de.grogra.imp3d.objects.Sphere\" edges=\"+\"><object gx:name=\"shader\" \
             gx:type=\"de.grogra.imp3d.shading.Phong\"><object gx:name=\"diffuse\" \
             gx:type=\"de.grogra.imp3d.shading.ImageMap\"><shared gx:name=\"image\" \
             gx:value=\"/:&quot;/project/objects/images/{name}&quot;\"/></object></object></node>"
        );
    }
    let registry = format!(
        "<project graph=\"graph.xml\"><registry><ref name=\"project\"><ref name=\"objects\"><ref \
         name=\"images\">{items}</ref></ref></ref></registry></project>"
    );
    let graph = graph(&nodes);
    let mut files = vec![("project.gs", registry.as_bytes()), ("graph.xml", graph.as_bytes())];
    files.extend(pictures.iter().map(|(name, bytes)| (*name, &bytes[..])));
    directory(test, &files)
}

fn read(test: &str, pictures: &[(&str, Vec<u8>)]) -> Project {
    let project = groimp::read(&project(test, pictures)).unwrap();
    assert!(project.report.skipped.is_empty(), "{}", project.report);
    project
}

/// A palette picture of 1 bit per pixel, written out: white, black / black, white, padded to four bytes a row.
fn one_bit_bmp() -> Vec<u8> {
    let mut bmp = b"BM".to_vec();
    let (colors, pixels) = ([0u8, 0, 0, 0, 255, 255, 255, 0], [0b0100_0000u8, 0, 0, 0, 0b1000_0000, 0, 0, 0]);
    bmp.extend((14 + 40 + colors.len() as u32 + pixels.len() as u32).to_le_bytes());
    bmp.extend(0u32.to_le_bytes());
    bmp.extend((14 + 40 + colors.len() as u32).to_le_bytes());
    bmp.extend(40u32.to_le_bytes());
    bmp.extend(2i32.to_le_bytes());
    bmp.extend(2i32.to_le_bytes());
    bmp.extend(1u16.to_le_bytes());
    bmp.extend(1u16.to_le_bytes());
    for number in [0u32, pixels.len() as u32, 2835, 2835, 2, 0] {
        bmp.extend(number.to_le_bytes());
    }
    bmp.extend(colors);
    bmp.extend(pixels);
    bmp
}

#[test]
fn formats_and_depths() {
    let rgb = RgbImage::from_fn(3, 2, |x, y| image::Rgb([80 * x as u8, 200 * y as u8, 17]));
    let rgba =
        RgbaImage::from_fn(2, 2, |x, y| image::Rgba([255 * x as u8, 0, 255 * y as u8, 85 * (x + y) as u8]));
    let words = image::ImageBuffer::<image::Luma<u16>, _>::from_vec(2, 1, vec![0x8080u16, 0xFFFF]).unwrap();
    let gray_alpha = GrayAlphaImage::from_vec(2, 1, vec![10, 20, 30, 40]).unwrap();
    // A GIF has opaque and transparent pixels only.
    let stencil = RgbaImage::from_fn(2, 1, |x, _| image::Rgba([255, 255, 255, 255 * x as u8]));
    let pictures = [
        ("a.png", encoded(rgba.clone(), ImageFormat::Png)),
        ("b.tif", encoded(rgb.clone(), ImageFormat::Tiff)),
        ("c.bmp", encoded(rgb.clone(), ImageFormat::Bmp)),
        ("d.png", encoded(words, ImageFormat::Png)),
        ("e.png", encoded(gray_alpha, ImageFormat::Png)),
        ("f.gif", encoded(stencil, ImageFormat::Gif)),
        ("g.bmp", one_bit_bmp()),
        ("h.jpg", encoded(RgbImage::from_pixel(16, 8, image::Rgb([200, 100, 50])), ImageFormat::Jpeg)),
    ];
    let project = read("image_formats", &pictures);
    let image = |name: &str| project.scene.images.iter().find(|image| image.name == name);
    let pixels =
        |name: &str| image(name).unwrap_or_else(|| panic!("{name}: {}", project.report)).pixels.to_vec();
    assert_eq!(pixels("a.png"), rgba.pixels().map(|p| p.0).collect::<Vec<_>>());
    let opaque: Vec<_> = rgb.pixels().map(|p| [p[0], p[1], p[2], 255]).collect();
    assert_eq!(pixels("b.tif"), opaque);
    // The bitmap has the pixels of the TIFF, so it is the same image.
    assert!(image("c.bmp").is_none());
    assert_eq!(pixels("d.png"), [[128, 128, 128, 255], [255; 4]]);
    assert_eq!(pixels("e.png"), [[10, 10, 10, 20], [30, 30, 30, 40]]);
    assert_eq!(pixels("f.gif").iter().map(|p| p[3]).collect::<Vec<_>>(), [0, 255]);
    // Rows of a bitmap go upwards.
    assert_eq!(pixels("g.bmp").iter().map(|p| p[0]).collect::<Vec<_>>(), [255, 0, 0, 255]);
    let jpeg = image("h.jpg").unwrap();
    assert_eq!((jpeg.width, jpeg.height), (16, 8));
    assert!(jpeg.pixels[0].iter().zip([200u8, 100, 50, 255]).all(|(a, b)| a.abs_diff(b) <= 3));
}

#[test]
fn equal_pictures_and_materials_are_stored_once() {
    let picture = |shade: u8| encoded(RgbImage::from_pixel(4, 4, image::Rgb([shade; 3])), ImageFormat::Png);
    let pictures = [("a.png", picture(9)), ("b.png", picture(9)), ("c.png", picture(10))];
    let scene = read("image_once", &pictures).scene;
    assert_eq!(scene.images.iter().map(|image| image.name.as_str()).collect::<Vec<_>>(), ["a.png", "c.png"]);
    let materials: Vec<_> = scene.objects.iter().map(|object| object.material).collect();
    assert_eq!(materials[0], materials[1]);
    assert_ne!(materials[0], materials[2]);
}

#[test]
fn the_caller_says_whether_colours_are_srgb() {
    let picture = encoded(RgbaImage::from_pixel(1, 1, image::Rgba([128, 128, 128, 128])), ImageFormat::Png);
    let path = project("image_srgb", &[("a.png", picture)]);
    let image = |srgb_textures| {
        let options = ReadOptions { srgb_textures, ..ReadOptions::default() };
        groimp::read_with(&path, &options).unwrap().scene.images[0].clone()
    };
    assert!(!image(false).srgb && image(true).srgb);
    let [gray, .., alpha] = image(true).mean();
    assert!((gray - 0.2159).abs() < 1e-3 && alpha == 128.0 / 255.0, "{gray}");
    assert_eq!(image(false).mean(), [128.0 / 255.0; 4]);
}
