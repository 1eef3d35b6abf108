//! The bytes of the two image formats.

use crate::Film;
use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, Vec2, WritableImage};
use kernels::tone::kernel::tone_map;
use std::io::{self, Seek, Write};

/// Writes 8-bit sRGB. Row by row, so that memory does not grow with the picture.
pub(super) fn png(film: &Film, exposure: f32, file: impl Write) -> io::Result<()> {
    let mut encoder = png::Encoder::new(file, film.width, film.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    let mut row = Vec::with_capacity(film.width as usize * 3);
    for y in 0..film.height {
        row.clear();
        for x in 0..film.width {
            let encoded = tone_map(film.radiance(x, y).into(), exposure).to_array();
            // The conversion saturates, and takes NaN to 0.
            row.extend(encoded.map(|value| (value * 255.0).round() as u8));
        }
        stream.write_all(&row)?;
    }
    stream.finish()?;
    writer.finish()?;
    Ok(())
}

/// Writes linear 32-bit floats in the channels R, G and B.
pub(super) fn exr(film: &Film, file: impl Write + Seek) -> io::Result<()> {
    let channels = SpecificChannels::rgb(|Vec2(x, y): Vec2<usize>| {
        let [r, g, b] = film.radiance(x as u32, y as u32);
        (r, g, b)
    });
    // Zip-compressed scan lines are what every program that knows EXR reads.
    let size = (film.width as usize, film.height as usize);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, channels);
    Image::from_layer(layer).write().non_parallel().to_buffered(file).map_err(|error| match error {
        exr::error::Error::Io(error) => error,
        other => io::Error::other(other),
    })
}
