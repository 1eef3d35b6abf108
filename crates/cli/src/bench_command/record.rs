//! What `sunshine bench run` writes and `sunshine bench compare` reads.

use super::machine::MachineRecord;
use crate::failure::Failure;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};
use std::io::{self, Read, Write};
use std::path::Path;
use thesis::{Table, seconds};

/// Larger files than this many bytes are not measurements.
const MOST_BYTES: u64 = 64 << 20;

/// All measurements of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of the program.
    pub version: String,
    /// Commit that the program was made from, or `unknown`.
    pub commit: String,
    /// When the run began, in universal time.
    pub date: String,
    /// Where.
    pub machine: MachineRecord,
    /// Scene by scene, device by device, from few samples to many if they were asked for in that order.
    pub rows: Vec<Row>,
}

/// A scene on a device with a number of samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Objects of the scene, those of groups counted as often as they are placed.
    pub objects: u64,
    /// Triangles of the scene.
    pub triangles: u64,
    /// How the device was asked for: `cpu`, `gpu`, `gpu:1`.
    pub device: String,
    /// What the device is called.
    pub device_name: String,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Number of surfaces that a light path may touch.
    pub depth: u32,
    /// Samples per pixel.
    pub samples: u32,
    /// How often it was measured.
    pub repeats: u32,
    /// Times of the steps.
    pub seconds: StepSeconds,
    /// Processor time of all threads in the shortest rendering, in seconds; missing where the system does not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_seconds: Option<f64>,
    /// What the device's own clock says of the shortest rendering, in seconds; missing where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device_seconds: Option<f64>,
    /// Samples of all pixels in a second of the shortest rendering.
    pub samples_per_second: f64,
    /// Rays, shadow rays included, in a second of the shortest rendering.
    pub rays_per_second: f64,
    /// Bytes of the tables that the device is given.
    pub scene_bytes: u64,
    /// Most memory that the program had since it began to read the scene, other devices not counted; missing where the
    /// system does not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_memory_bytes: Option<u64>,
}

/// Wall-clock seconds of the steps, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepSeconds {
    /// Opening the device, once per run.
    pub open: f64,
    /// From the scene file to the scene description; for a scene that is built in, building it.
    pub read: Measured,
    /// From the scene description to what devices take.
    pub compile: Measured,
    /// Bringing it to the device; graphics cards compile their programs, which later scenes may share.
    pub upload: f64,
    /// The first picture, with one sample per pixel.
    pub first: f64,
    /// The picture.
    pub render: Measured,
}

/// Seconds of a step that was repeated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The shortest time.
    pub best: f64,
    /// By how much the longest was longer; missing if there was one alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<f64>,
}

impl Measured {
    /// From all times, of which there is at least one.
    pub fn of(times: &[f64]) -> Self {
        let best = times.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = times.iter().copied().fold(0.0, f64::max);
        Measured { best, spread: (times.len() > 1).then_some(longest - best) }
    }

    /// Whether the times of two measurements lie apart; `None` if one of them has no spread.
    pub fn is_apart_from(&self, other: &Measured) -> Option<bool> {
        let (own, others) = (self.spread?, other.spread?);
        Some(self.best > other.best + others || other.best > self.best + own)
    }
}

impl Record {
    /// Writes the file, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        render::write_whole_file(path, |file| {
            serde_json::to_writer_pretty(&mut *file, self).map_err(io::Error::from)?;
            file.write_all(b"\n")
        })
        .map_err(|source| Failure::NotWritable { path: path.to_owned(), source })
    }

    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let unreadable = |source| Failure::Unreadable { path: path.to_owned(), source };
        let file = std::fs::File::open(path).map_err(unreadable)?;
        let mut bytes = Vec::new();
        file.take(MOST_BYTES).read_to_end(&mut bytes).map_err(unreadable)?;
        serde_json::from_slice(&bytes)
            .map_err(|source| Failure::Measurements { path: path.to_owned(), source })
    }

    /// The measurements for people.
    pub fn table(&self) -> Table {
        let mut table = Table::new([
            "scene",
            "objects",
            "device",
            "samples",
            "read s",
            "compile s",
            "upload s",
            "first s",
            "render s",
            "± %",
            "card s",
            "Msamples/s",
            "Mrays/s",
            "peak MB",
        ]);
        for row in &self.rows {
            let Row { seconds: times, .. } = row;
            let spread = times.render.spread.map(|spread| spread / times.render.best * 100.0);
            table.push([
                row.scene.clone(),
                row.objects.to_string(),
                row.device.clone(),
                row.samples.to_string(),
                seconds(times.read.best),
                seconds(times.compile.best),
                seconds(times.upload),
                seconds(times.first),
                seconds(times.render.best),
                spread.map_or("-".to_owned(), |percent| format!("{percent:.1}")),
                row.device_seconds.map_or("-".to_owned(), seconds),
                seconds(row.samples_per_second / 1e6),
                seconds(row.rays_per_second / 1e6),
                // Lossless up to petabytes.
                row.peak_memory_bytes.map_or("-".to_owned(), |bytes| format!("{:.0}", bytes as f64 / 1e6)),
            ]);
        }
        table
    }
}

/// Program and machine, as the head of a table.
impl Display for Record {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "sunshine {}, commit {}, {}, {}", self.version, self.commit, self.date, self.machine)
    }
}
