//! What a rendering took, for other programs to read.

use crate::failure::Failure;
use render::{BandStatistics, RenderSettings};
use serde::Serialize;
use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// The content of the file that `--stats` writes.
#[derive(Debug, Serialize)]
pub struct Statistics {
    /// Version of the program.
    pub version: &'static str,
    /// What computed.
    pub device: String,
    /// Which renderer.
    pub renderer: &'static str,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Number of surfaces that a light path may touch.
    pub depth: u32,
    /// Start of the random numbers.
    pub seed: u32,
    /// Samples per pixel that were taken on average.
    pub samples_per_pixel: f64,
    /// Estimated relative error of the picture, where it was looked at; before it was denoised.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
    /// Samples taken for the whole picture.
    pub samples: u64,
    /// Rays traced for the whole picture, shadow rays included.
    pub rays: u64,
    /// Objects of the scene, those of groups counted as often as they are placed.
    pub objects: u64,
    /// Triangles of the scene.
    pub triangles: usize,
    /// What removed the noise that was left.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub denoiser: Option<String>,
    /// Stops that the picture was brightened by; missing for formats that keep the radiance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f32>,
    /// Wall-clock times.
    pub seconds: Seconds,
    /// What the device's own clock says of the samples that were taken now, in seconds; missing where it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device_seconds: Option<f64>,
    /// Most memory that the program had at any time; missing where the system does not tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_memory_bytes: Option<u64>,
}

impl Statistics {
    /// Takes over what settings and rendering tell; the rest is for the caller to fill in.
    pub fn new(settings: &RenderSettings, rendered: &BandStatistics) -> Self {
        let window = settings.window();
        let pixels = u64::from(window.width) * u64::from(window.height);
        Statistics {
            version: env!("CARGO_PKG_VERSION"),
            device: String::new(),
            renderer: settings.renderer.name(),
            width: window.width,
            height: window.height,
            depth: settings.depth,
            seed: settings.seed,
            samples_per_pixel: rendered.samples as f64 / pixels.max(1) as f64,
            noise: rendered.noise,
            samples: rendered.samples,
            rays: rendered.rays,
            objects: 0,
            triangles: 0,
            denoiser: None,
            exposure: None,
            seconds: Seconds::default(),
            device_seconds: None,
            peak_memory_bytes: peak_memory_bytes(),
        }
    }

    /// Writes the file, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        render::write_whole_file(path, |file| {
            serde_json::to_writer_pretty(&mut *file, self).map_err(io::Error::from)?;
            file.write_all(b"\n")
        })
        .map_err(|source| Failure::Statistics { path: path.to_owned(), source })
    }
}

/// Wall-clock seconds of the steps.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Seconds {
    /// Opening the device.
    pub open: f64,
    /// From the scene file to the scene description.
    pub read: f64,
    /// From the scene description to what devices take.
    pub compile: f64,
    /// Bringing it to the device.
    pub upload: f64,
    /// Rendering.
    pub render: f64,
    /// Removing noise.
    pub denoise: f64,
    /// Writing the picture.
    pub write: f64,
}

/// Does a step and notes the seconds that it took.
pub fn timed<T>(seconds: &mut f64, step: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = step();
    *seconds = start.elapsed().as_secs_f64();
    result
}

/// A duration as people say it: `0.52 s`, `3 min 07 s`, `2 h 05 min`.
pub fn duration_text(seconds: f64) -> String {
    let whole = Duration::try_from_secs_f64(seconds.max(0.0)).unwrap_or(Duration::MAX).as_secs();
    match whole {
        0..10 => format!("{seconds:.2} s"),
        10..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}

/// A large number with a word for its thousands: `950`, `12.3 thousand`, `4.56 million`.
pub fn count_text(count: f64) -> String {
    match count {
        c if c >= 1e9 => format!("{:.2} billion", c / 1e9),
        c if c >= 1e6 => format!("{:.2} million", c / 1e6),
        c if c >= 1e4 => format!("{:.1} thousand", c / 1e3),
        c => format!("{c:.0}"),
    }
}

/// The kernel's high-water mark of resident memory.
pub fn peak_memory_bytes() -> Option<u64> {
    // The file exists on Linux alone; elsewhere nothing is said rather than something else.
    high_water_mark(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn high_water_mark(status: &str) -> Option<u64> {
    let value = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_read_in_bytes() {
        assert_eq!(
            high_water_mark("Name:\tsunshine\nVmHWM:\t   2048 kB\nVmRSS:\t 1 kB\n"),
            Some(2 * 1024 * 1024)
        );
        assert_eq!(high_water_mark("Name:\tsunshine\n"), None);
        assert_eq!(high_water_mark("VmHWM:\tmuch\n"), None);
    }

    #[test]
    fn durations_and_counts_read_well() {
        assert_eq!(duration_text(0.523), "0.52 s");
        assert_eq!(duration_text(59.96), "60.0 s");
        assert_eq!(duration_text(187.2), "3 min 07 s");
        assert_eq!(duration_text(7500.0), "2 h 05 min");
        assert_eq!(count_text(950.4), "950");
        assert_eq!(count_text(12_345.0), "12.3 thousand");
        assert_eq!(count_text(4.56e6), "4.56 million");
    }

    #[test]
    fn what_is_unknown_is_left_out() {
        let mut statistics = Statistics::new(
            &RenderSettings { width: 4, ..RenderSettings::default() },
            &BandStatistics::default(),
        );
        statistics.peak_memory_bytes = None;
        let json = serde_json::to_value(&statistics).unwrap();
        assert!(json.get("device_seconds").is_none());
        assert!(json.get("peak_memory_bytes").is_none() && json.get("exposure").is_none());
        assert_eq!((json["width"].as_u64(), json["samples"].as_u64()), (Some(4), Some(0)));
        for step in ["read", "compile", "upload", "render", "denoise", "write"] {
            assert!(json["seconds"][step].is_number(), "{step}");
        }
    }
}
