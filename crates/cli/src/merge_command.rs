//! `sunshine merge`: shares of a picture become the picture.

use crate::arguments::MergeArguments;
use crate::failure::Failure;
use crate::progress::Messages;
use render::{
    Band, Film, FilmFile, Layers, Origins, PictureFormat, PictureTarget, Provenance, check_writable,
    stream_picture,
};
use std::ops::Range;
use std::path::Path;

/// Joins the films and writes the picture, or a film of all.
pub fn run(arguments: &MergeArguments) -> Result<String, Failure> {
    let messages = Messages { quiet: arguments.quiet };
    let output = &arguments.output;
    let makes_film = output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("film"));
    if !makes_film {
        PictureFormat::from_path(output)?;
    }
    check_writable(output).map_err(|source| Failure::NotWritable { path: output.clone(), source })?;

    let mut joined: Option<FilmFile> = None;
    for path in &arguments.films {
        let film = FilmFile::read(path).map_err(|source| Failure::Film { path: path.clone(), source })?;
        tracing::info!("read {}: samples {}", path.display(), ranges_text(&film.sums.ranges()));
        match &mut joined {
            None => joined = Some(film),
            Some(joined) => join(joined, film, path)?,
        }
    }
    // At least one is demanded by the command line.
    let Some(mut film) = joined else { return Err(Failure::Usage("there is nothing to merge".to_owned())) };
    film.provenance.samples = film.sums.samples();
    if film.provenance.device.contains(DEVICES) {
        messages.line(&format!(
            "warning: the films are of different devices ({}): the picture is right, but not to the last digit that of \
             one device",
            film.provenance.device
        ));
    }
    let planned = film.provenance.setting("samples").and_then(|samples| samples.parse().ok());
    let missing = film.sums.missing(0..planned.unwrap_or(0));
    let samples = film.sums.samples();
    if makes_film {
        film.write(output).map_err(|source| Failure::NotWritable { path: output.clone(), source })?;
        let rest = match &missing[..] {
            [] => "the picture is complete".to_owned(),
            missing => format!("samples {} are still missing", ranges_text(missing)),
        };
        return Ok(said(
            arguments,
            format!("{samples} samples per pixel; {rest}\nwrote {}\n", output.display()),
        ));
    }
    if samples == 0 {
        return Err(Failure::Usage("the films hold no samples yet".to_owned()));
    }
    if !missing.is_empty() && !arguments.unfinished {
        return Err(Failure::Missing { missing: ranges_text(&missing) });
    }
    let exposure = write_picture(arguments, film)?;
    let exposure = match PictureFormat::from_path(output)?.is_exposed() {
        true => format!("exposure {exposure:+.2} EV\n"),
        false => String::new(),
    };
    Ok(said(arguments, format!("{exposure}{samples} samples per pixel\nwrote {}\n", output.display())))
}

/// Stands between the names of different devices.
const DEVICES: &str = " and ";

fn join(joined: &mut FilmFile, film: FilmFile, path: &Path) -> Result<(), Failure> {
    if let Some(difference) = film.provenance.difference(&joined.provenance) {
        return Err(Failure::OtherPicture { path: path.to_owned(), difference });
    }
    if (film.width, film.height) != (joined.width, joined.height) {
        let source = render::FilmFileError::Inconsistent("its size is not that of its settings");
        return Err(Failure::Film { path: path.to_owned(), source });
    }
    let Provenance { device, .. } = &mut joined.provenance;
    for other in film.provenance.device.split(DEVICES) {
        if !device.split(DEVICES).any(|known| known == other) {
            *device = format!("{device}{DEVICES}{other}");
        }
    }
    joined.sums.merge(film.sums).map_err(|overlap| Failure::Overlap { path: path.to_owned(), overlap })
}

fn write_picture(arguments: &MergeArguments, file: FilmFile) -> Result<f32, Failure> {
    let provenance = file.provenance.clone();
    let film: Film = file.into_film();
    let target = PictureTarget {
        path: &arguments.output,
        width: film.width,
        height: film.height,
        exposure: arguments.exposure,
        tone_curve: arguments.tone_curve,
        layers: &Layers::default(),
        origins: &Origins::default(),
        provenance: Some(&provenance),
    };
    let band = Band { first_row: 0, width: film.width, pixels: &film.pixels, layers: &[], denoised: &[] };
    Ok(stream_picture(&target, |sink| sink(&band))?)
}

fn ranges_text(ranges: &[Range<u32>]) -> String {
    let texts: Vec<_> = ranges.iter().map(|range| format!("{}..{}", range.start, range.end)).collect();
    texts.join(", ")
}

fn said(arguments: &MergeArguments, text: String) -> String {
    if arguments.quiet { String::new() } else { text }
}
