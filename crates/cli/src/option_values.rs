//! What is said after an option: sizes, numbers, times, parts of pictures. Every parser says what it accepts.

use clap::builder::{PathBufValueParser, TypedValueParser};
use render::{Acceleration, CropWindow, PictureFormat, RenderSettings};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Width and height of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
}

impl Size {
    /// Longest edge in pixels.
    const MAXIMUM: u32 = 65536;

    /// That of the picture.
    pub fn of(settings: &RenderSettings) -> Self {
        Size { width: settings.width, height: settings.height }
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text
            .split_once(['x', 'X', '×'])
            .ok_or("expected width, x and height in pixels, for example 1920x1080")?;
        let edge = whole_number(1..=Self::MAXIMUM);
        Ok(Size {
            width: edge(width).map_err(|error| format!("width: {error}"))?,
            height: edge(height).map_err(|error| format!("height: {error}"))?,
        })
    }
}

/// A pixel of a picture and how many of its paths are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel {
    /// Column, from the left.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// Number of paths.
    pub samples: u32,
}

impl FromStr for Pixel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<u32>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[x, y]) => Ok(Pixel { x, y, samples: 4 }),
            Ok(&[x, y, samples]) => Ok(Pixel { x, y, samples }),
            _ => Err("expected column and row of a pixel, for example 320,240, or 320,240,16".to_owned()),
        }
    }
}

/// A parser of whole numbers that says what is accepted.
pub fn whole_number(range: RangeInclusive<u32>) -> impl Fn(&str) -> Result<u32, String> + Clone {
    move |text| {
        let accepted = text.trim().parse().ok().filter(|number| range.contains(number));
        accepted.ok_or_else(|| match (range.start(), range.end()) {
            (low, &u32::MAX) => format!("expected a whole number, at least {low}"),
            (low, high) => format!("expected a whole number from {low} to {high}"),
        })
    }
}

/// A brightness in stops.
pub fn parse_exposure(text: &str) -> Result<f32, String> {
    // Beyond this every picture is black or white; it also keeps infinities and NaN out.
    const LIMIT: f32 = 100.0;
    let stops = text.trim().parse().ok().filter(|stops: &f32| stops.abs() <= LIMIT);
    stops.ok_or_else(|| format!("expected a number of stops from -{LIMIT} to {LIMIT}, for example -1.5"))
}

/// A time such as `90`, `90s`, `10m` or `1h30m`; a number without a unit is in seconds.
pub fn parse_time(text: &str) -> Result<Duration, String> {
    let wrong = || "expected a time, for example 90, 90s, 10m or 1h30m".to_owned();
    let mut rest = text.trim();
    let mut seconds = 0.0;
    let mut last_unit = f64::INFINITY;
    while !rest.is_empty() {
        let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let number: f64 = rest[..end].parse().map_err(|_| wrong())?;
        let mut after = rest[end..].chars();
        let unit = match after.next() {
            Some('h') => 3600.0,
            Some('m') => 60.0,
            Some('s') => 1.0,
            None if seconds == 0.0 => 1.0,
            _ => return Err(wrong()),
        };
        // Hours, then minutes, then seconds.
        if unit >= last_unit {
            return Err(wrong());
        }
        last_unit = unit;
        seconds += number * unit;
        rest = after.as_str();
    }
    Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero()).ok_or_else(wrong)
}

/// A relative error, as a number or in percent.
pub fn parse_noise(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    let level = number.trim().parse().ok().map(|number: f64| number * unit);
    level
        .filter(|level| (1e-6..=1.0).contains(level))
        .ok_or_else(|| "expected a relative error up to 1, for example 0.02 or 2%".to_owned())
}

/// How objects are found along a ray.
pub fn parse_acceleration(text: &str) -> Result<Acceleration, String> {
    match text {
        "bvh" => Ok(Acceleration::Bvh),
        "none" => Ok(Acceleration::None),
        _ => Err("expected bvh or none".to_owned()),
    }
}

/// Three numbers, none of them negative.
pub fn parse_background(text: &str) -> Result<[f32; 3], String> {
    // Far beyond the sun; sums of it stay finite.
    const LIMIT: f32 = 1e12;
    let numbers: Vec<f32> = text.split(',').map_while(|number| number.trim().parse().ok()).collect();
    <[f32; 3]>::try_from(numbers)
        .ok()
        .filter(|numbers| {
            text.split(',').count() == 3 && numbers.iter().all(|number| (0.0..=LIMIT).contains(number))
        })
        .ok_or_else(|| "expected three numbers from 0 to 1e12, for example 0.2,0.3,0.5".to_owned())
}

/// A bound on what a project may contain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedLimit {
    /// One of the names of [`groimp::Limits`].
    pub name: String,
    /// The most that is accepted.
    pub value: u64,
}

/// A limit as `image-pixels=1000000`.
pub fn parse_limit(text: &str) -> Result<NamedLimit, String> {
    let (name, value) =
        text.split_once('=').ok_or("expected a name and a number, for example total-bytes=8000000000")?;
    let mut limits = groimp::Limits::default();
    if !limits.set(name, 0) {
        let names: Vec<_> = limits.list().into_iter().map(|(name, _)| name).collect();
        return Err(format!("`{name}` is no limit; there are {}", names.join(", ")));
    }
    let value = value.trim().parse().map_err(|_| format!("expected a whole number after {name}="))?;
    Ok(NamedLimit { name: name.to_owned(), value })
}

/// Samples of every pixel, from the first to before the last.
pub type SampleRange = std::ops::Range<u32>;

/// Samples as `64..128`.
pub fn parse_sample_range(text: &str) -> Result<SampleRange, String> {
    let wrong = || "expected two numbers of samples, for example 0..256 or 256..512".to_owned();
    let (first, end) = text.split_once("..").ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    let (first, end) = (number(first)?, number(end)?);
    if first >= end {
        return Err("the second number must be greater than the first".to_owned());
    }
    Ok(first..end)
}

/// Layers of GroIMP, layer n as bit n.
pub fn parse_visible_layers(text: &str) -> Result<u16, String> {
    let layer = |number: &str| number.trim().parse::<u32>().ok().filter(|layer| *layer < u16::BITS);
    let bits = text.split(',').map(|number| Some(1u16 << layer(number)?));
    bits.reduce(|all, bit| Some(all? | bit?))
        .flatten()
        .ok_or_else(|| "expected numbers of layers from 0 to 15, for example 0,2,3".to_owned())
}

/// Layers of GroIMP as [`parse_visible_layers`] reads them.
pub fn visible_layers_text(layers: u16) -> String {
    let numbers = (0..u16::BITS).filter(|layer| layers >> layer & 1 != 0);
    numbers.map(|layer| layer.to_string()).collect::<Vec<_>>().join(",")
}

/// Part of a picture.
pub fn parse_crop(text: &str) -> Result<CropWindow, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, width, height]) if width > 0 && height > 0 => Ok(CropWindow { x, y, width, height }),
        _ => Err("expected column, row, width and height in pixels, for example 320,240,64,64".to_owned()),
    }
}

/// A distance in metres, from a micrometre up.
pub fn parse_flatness(text: &str) -> Result<f64, String> {
    let metres = text.trim().parse().ok().filter(|metres: &f64| metres.is_finite() && *metres >= 1e-6);
    metres.ok_or_else(|| "expected a distance in metres, at least 0.000001, for example 0.001".to_owned())
}

/// A parser of file names that takes pictures alone.
pub fn picture_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| PictureFormat::from_path(&path).map(|_| path))
}
