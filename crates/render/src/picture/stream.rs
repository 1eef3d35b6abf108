//! A picture file that grows band by band while the picture is rendered.

use super::encode::{self, Sink};
use super::layers::{Layers, Origins};
use super::spool::RadianceSpool;
use super::whole_file::write_whole_file;
use super::{PictureError, PictureFormat};
use crate::bands::Band;
use crate::{Provenance, RenderError, ToneCurve, film};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

/// What to write where.
#[derive(Clone, Copy, Debug)]
pub struct PictureTarget<'a> {
    /// The file; its extension chooses the format.
    pub path: &'a Path,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Brightness of a PNG in stops; chosen from the picture if missing. An EXR is never scaled.
    pub exposure: Option<f32>,
    /// What follows the exposure of a PNG.
    pub tone_curve: ToneCurve,
    /// What an EXR holds beside the picture; a PNG has no place for it.
    pub layers: &'a Layers,
    /// What the numbers in the layers stand for.
    pub origins: &'a Origins,
    /// How the picture came about, to be told in the file.
    pub provenance: Option<&'a Provenance>,
}

/// Takes the bands of a picture, from top to bottom; all but the last have a multiple of 16 rows.
pub type BandSink<'a> = dyn FnMut(&Band<'_>) -> Result<(), RenderError> + 'a;

/// Writes the bands that `produce` hands to its argument; returns the exposure in stops (0 for an EXR).
///
/// Memory does not grow with the picture. An automatic exposure is known only at the end: until then the radiance is
/// kept in a nameless temporary file beside the picture, or in memory if it is small. The file appears under its name
/// only when it is complete.
///
/// # Errors
/// What `produce` returns, or if the file cannot be written.
pub fn stream_picture(
    to: &PictureTarget<'_>,
    produce: impl FnOnce(&mut BandSink<'_>) -> Result<(), RenderError>,
) -> Result<f32, RenderError> {
    let format = PictureFormat::from_path(to.path)?;
    // Neither format has pictures without pixels.
    if to.width == 0 || to.height == 0 {
        return Err(write_error(
            to,
            io::Error::new(io::ErrorKind::InvalidInput, "the picture has no pixels"),
        ));
    }
    let whole =
        |fill: &mut dyn FnMut(&mut BufWriter<&File>) -> io::Result<()>| write_whole_file(to.path, fill);
    // A rendering error travels through functions that know of input and output only.
    let mut failed = None;
    let mut produce = Some(produce);
    let mut run = |sink: &mut Sink<'_>| -> io::Result<()> {
        let Some(produce) = produce.take() else { return Ok(()) };
        let produced = produce(&mut |band| sink(band).map_err(|error| write_error(to, error)));
        produced.map_err(|error| {
            failed = Some(error);
            io::Error::other("the rendering failed")
        })
    };
    let written = match (format, to.exposure) {
        (PictureFormat::Exr, _) => whole(&mut |file| encode::exr(to, file, &mut run)).map(|()| 0.0),
        (PictureFormat::Png, Some(stops)) => whole(&mut |file| {
            encode::png(to, stops, file, |see| run(&mut |band| encode::radiances(band, see)))
        })
        .map(|()| stops),
        (PictureFormat::Png, None) => RadianceSpool::beside(to.path).and_then(|mut spool| {
            run(&mut |band| encode::radiances(band, &mut |radiance| spool.push(radiance)))?;
            let stops = film::exposure_of(|see| {
                spool.replay(&mut |radiance| {
                    see(radiance);
                    Ok(())
                })
            })?;
            whole(&mut |file| encode::png(to, stops, file, |see| spool.replay(see)))?;
            Ok(stops)
        }),
    };
    match failed {
        Some(error) => Err(error),
        None => written.map_err(|error| write_error(to, error)),
    }
}

fn write_error(to: &PictureTarget<'_>, source: io::Error) -> RenderError {
    PictureError::Write { path: to.path.to_owned(), source }.into()
}
