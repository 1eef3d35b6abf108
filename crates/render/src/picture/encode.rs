//! The bytes of the two image formats, written while bands arrive from top to bottom.

use super::layers::block_bytes;
use super::stream::PictureTarget;
use crate::bands::Band;
use crate::{Provenance, ToneCurve};
use exr::block::chunk::Chunk;
use exr::block::writer::{ChunksWriter, write_chunks_with};
use exr::block::{BlockIndex, UncompressedBlock};
use exr::meta::BlockDescription;
use exr::meta::attribute::{AttributeValue, ChannelDescription, LineOrder};
use exr::meta::header::Header;
use exr::prelude::{Compression, Text, Vec2};
use rayon::prelude::*;
use std::io::{self, Seek, Write};

/// Takes bands.
pub(super) type Sink<'a> = dyn FnMut(&Band<'_>) -> io::Result<()> + 'a;

/// Writes 8-bit sRGB; `produce` shows the radiance of all pixels row by row. Of the layers, for which there is no
/// place, only the name of the denoiser is kept.
pub(super) fn png(
    to: &PictureTarget<'_>,
    exposure: f32,
    file: impl Write,
    produce: impl FnOnce(&mut dyn FnMut([f32; 3]) -> io::Result<()>) -> io::Result<()>,
) -> io::Result<()> {
    let mut encoder = png::Encoder::new(file, to.width, to.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    if let Some(provenance) = to.provenance {
        encoder.add_text_chunk("Software".to_owned(), software(provenance))?;
        // In Unicode, as names of scenes are.
        let mut record = format!("{provenance}exposure: {exposure:+.3} stops\n");
        // Without the usual one, pictures are byte for byte as they were before there was another.
        if to.tone_curve != ToneCurve::default() {
            record += &format!("tone curve: {}\n", to.tone_curve);
        }
        encoder.add_itxt_chunk(RECORD.to_owned(), record)?;
    }
    if let Some(denoiser) = to.layers.denoiser() {
        encoder.add_text_chunk("Comment".to_owned(), format!("denoised by {denoiser}"))?;
    }
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    produce(&mut |radiance| stream.write_all(&shown_colour(radiance, exposure, to.tone_curve)))?;
    stream.finish()?;
    writer.finish()?;
    Ok(())
}

/// The 8-bit sRGB colour of a radiance in W/(m² sr), brightened by `exposure` stops, as PNGs have it.
pub fn shown_colour(radiance: [f32; 3], exposure: f32, curve: ToneCurve) -> [u8; 3] {
    // The conversion saturates, and takes NaN to 0.
    curve.encode(radiance, exposure).map(|value| (value * 255.0).round() as u8)
}

/// Shows the radiance of a band's pixels.
pub(super) fn radiances(band: &Band<'_>, see: &mut dyn FnMut([f32; 3]) -> io::Result<()>) -> io::Result<()> {
    (0..band.pixels.len()).try_for_each(|pixel| see(band.radiance(pixel)))
}

/// Scan lines of a compressed block.
const BLOCK_ROWS: usize = 16;

/// Writes linear 32-bit floats in the channels R, G and B, and the layers; zip-compressed scan lines are what every
/// program that knows EXR reads. All bands but the last must have a multiple of 16 rows.
pub(super) fn exr(
    to: &PictureTarget<'_>,
    file: impl Write + Seek,
    produce: impl FnOnce(&mut Sink<'_>) -> io::Result<()>,
) -> io::Result<()> {
    let PictureTarget { layers, origins, .. } = *to;
    let size = (to.width, to.height);
    let channels = layers.channels();
    let descriptions =
        channels.iter().map(|(name, quantity)| ChannelDescription::named(*name, quantity.sample_type()));
    let mut header =
        Header::new(Text::from("picture"), (size.0 as usize, size.1 as usize), descriptions.collect())
            .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing);
    // A single image needs no name.
    header.own_attributes.layer_name = None;
    if !layers.is_empty()
        && let Some(manifest) = origins.manifest()
    {
        header.own_attributes.other.insert(Text::from("objectTypes"), AttributeValue::Text(manifest));
    }
    if let Some(denoiser) = layers.denoiser().and_then(Text::new_or_none) {
        header.own_attributes.other.insert(Text::from("denoised"), AttributeValue::Text(denoiser));
    }
    if let Some(provenance) = to.provenance {
        header.own_attributes.software_name = Text::new_or_none(software(provenance));
        header.own_attributes.comments = Text::new_or_none(one_byte_each(&provenance.to_string()));
    }
    let mut failure = None;
    let written = write_chunks_with(file, [header].into_iter().collect(), true, |meta, chunks| {
        let mut block = 0;
        let produced = produce(&mut |band| {
            let rows = band.pixels.len() / (band.width as usize).max(1);
            let starts: Vec<usize> = (0..rows).step_by(BLOCK_ROWS).collect();
            let compressed: Vec<exr::error::Result<Chunk>> = starts
                .into_par_iter()
                .map(|start| {
                    let lines = BLOCK_ROWS.min(rows - start);
                    let index = BlockIndex {
                        layer: 0,
                        pixel_position: Vec2(0, band.first_row as usize + start),
                        pixel_size: Vec2(band.width as usize, lines),
                        level: Vec2(0, 0),
                    };
                    let data = block_bytes(band, start..start + lines, &channels, origins);
                    UncompressedBlock { index, data }.compress_to_chunk(&meta.headers)
                })
                .collect();
            for chunk in compressed {
                chunks.write_chunk(block, chunk.map_err(io_error)?).map_err(io_error)?;
                block += 1;
            }
            Ok(())
        });
        produced.map_err(|error| {
            failure = Some(error);
            exr::error::Error::Aborted
        })
    });
    match (failure, written) {
        (Some(error), _) => Err(error),
        (None, written) => written.map_err(io_error),
    }
}

/// Keyword of the text in a PNG that tells how the picture came about. An EXR has it in its attribute `comments`.
pub(super) const RECORD: &str = "Sunshine";

fn software(provenance: &Provenance) -> String {
    format!("{RECORD} {}", provenance.version)
}

/// Text as EXR holds it, with a question mark for what has no place in a byte.
fn one_byte_each(text: &str) -> String {
    text.chars().map(|c| if u32::from(c) < 256 { c } else { '?' }).collect()
}

fn io_error(error: exr::error::Error) -> io::Error {
    match error {
        exr::error::Error::Io(error) => error,
        other => io::Error::other(other),
    }
}
