//! `sunshine bench run`: scenes on devices with numbers of samples.

use super::machine::{MachineRecord, now};
use super::record::{Measured, Record, Row, StepSeconds};
use crate::bench_arguments::MatrixArguments;
use crate::failure::Failure;
use crate::progress::Messages;
use crate::render_command::scene_name;
use crate::statistics::{peak_memory_bytes, timed};
use render::{
    CompiledScene, ControlFlow, Device, DeviceChoice, Film, LoadedScene, RenderSettings, automatic_gpu,
    list_gpus, open_device,
};
use scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thesis::{BUILT_IN, BuiltIn};

/// Measures everything and returns the table.
pub fn run(arguments: &MatrixArguments) -> Result<String, Failure> {
    let messages = Messages { quiet: arguments.quiet };
    // Before hours of work rather than after.
    if let Some(path) = &arguments.output {
        render::check_writable(path).map_err(|source| Failure::NotWritable { path: path.clone(), source })?;
    }
    let sources = sources(&arguments.scenes)?;
    let devices = open_devices(arguments)?;
    let with_cards = devices.iter().any(|device| device.key != "cpu");
    let mut record = Record {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: env!("SUNSHINE_COMMIT").to_owned(),
        date: now(),
        machine: MachineRecord::this(arguments.threads, with_cards),
        rows: Vec::new(),
    };
    messages.line(&record.to_string());
    for source in &sources {
        messages.line(&format!("{} ...", source.name));
        let scene = MeasuredScene::read(source, arguments.repeat, messages)?;
        for device in &devices {
            record.rows.extend(device.measure(&source.name, &scene, arguments)?);
        }
        // What is there stays if a later scene fails.
        if let Some(path) = &arguments.output {
            record.write(path)?;
        }
    }
    let mut text = format!("{record}\n");
    let (size, depth) = (arguments.size, arguments.depth);
    text += &format!("{size} pixels, depth {depth}, best of {}\n\n{}", arguments.repeat, record.table());
    if let Some(path) = &arguments.output {
        text += &format!("\nwrote {}\n", path.display());
    }
    Ok(text)
}

/// Where a scene comes from.
struct Source {
    name: String,
    /// `None` if it is built in.
    path: Option<PathBuf>,
}

/// The scenes that were asked for, under names that differ.
fn sources(asked: &[PathBuf]) -> Result<Vec<Source>, Failure> {
    if asked.is_empty() {
        let usual = BUILT_IN.iter().filter(|scene| !scene.is_huge);
        return Ok(usual.map(|scene| Source { name: scene.name.to_owned(), path: None }).collect());
    }
    let mut sources: Vec<Source> = Vec::new();
    for path in asked {
        let is_known = |name: &str| sources.iter().any(|source| source.name == name);
        if let Some(built_in) = path.to_str().and_then(BuiltIn::named) {
            if !is_known(built_in.name) {
                sources.push(Source { name: built_in.name.to_owned(), path: None });
            }
            continue;
        }
        // Told before another scene is measured for an hour.
        std::fs::metadata(path).map_err(|source| Failure::Unreadable { path: path.clone(), source })?;
        let whole = path.display().to_string();
        let short = scene_name(path).map(|name| name.to_string_lossy().into_owned());
        let name = short.filter(|name| !is_known(name) && BuiltIn::named(name).is_none()).unwrap_or(whole);
        sources.push(Source { name, path: Some(path.clone()) });
    }
    Ok(sources)
}

/// A device under the name that it was asked for by.
struct OpenDevice {
    key: String,
    device: Box<dyn Device>,
    /// Seconds that opening it took.
    open: f64,
}

fn open_devices(arguments: &MatrixArguments) -> Result<Vec<OpenDevice>, Failure> {
    let card = || automatic_gpu(&list_gpus()).map(|number| DeviceChoice::Gpu(Some(number)));
    let choices = match &arguments.device[..] {
        [] => [DeviceChoice::Cpu].into_iter().chain(card()).collect(),
        asked => asked.to_vec(),
    };
    let threads = arguments.threads.map(|threads| threads as usize);
    let mut devices: Vec<OpenDevice> = Vec::new();
    for choice in choices {
        let choice = match choice {
            DeviceChoice::Auto => card().unwrap_or(DeviceChoice::Cpu),
            other => other,
        };
        let key = match choice {
            DeviceChoice::Auto | DeviceChoice::Cpu => "cpu".to_owned(),
            DeviceChoice::Gpu(None | Some(0)) => "gpu".to_owned(),
            DeviceChoice::Gpu(Some(number)) => format!("gpu:{number}"),
            DeviceChoice::AllGpus => "gpu:all".to_owned(),
            DeviceChoice::All => "all".to_owned(),
        };
        if devices.iter().all(|known| known.key != key) {
            let mut open = 0.0;
            let device = timed(&mut open, || open_device(choice, threads))?;
            devices.push(OpenDevice { key, device, open });
        }
    }
    Ok(devices)
}

/// A scene that is ready to be brought to devices, with what it took to come so far.
struct MeasuredScene {
    compiled: Arc<CompiledScene>,
    objects: u64,
    read: Measured,
    compile: Measured,
    /// Most memory that was used meanwhile.
    peak: Option<u64>,
}

impl MeasuredScene {
    fn read(source: &Source, repeats: u32, messages: Messages) -> Result<Self, Failure> {
        let (mut read, mut compile) = (Vec::new(), Vec::new());
        let mut ready = None;
        let mut peak = None;
        forget_peak_memory();
        for repeat in 0..repeats.max(1) {
            // Two scenes at a time might not fit into memory.
            drop(ready.take());
            let (mut reading, mut compiling) = (0.0, 0.0);
            let scene = timed(&mut reading, || match &source.path {
                Some(path) => {
                    read_project(path, if repeat == 0 { messages } else { Messages { quiet: true } })
                }
                None => Ok(BuiltIn::named(&source.name).map(BuiltIn::build).unwrap_or_default()),
            })?;
            let compiled = Arc::new(timed(&mut compiling, || render::compile(&scene))?);
            read.push(reading);
            compile.push(compiling);
            peak = peak.or_else(peak_memory_bytes);
            ready = Some((compiled, scene.drawn_objects()));
        }
        // The loop runs at least once.
        let (compiled, objects) = ready.ok_or_else(|| Failure::Usage("nothing was measured".to_owned()))?;
        Ok(MeasuredScene {
            compiled,
            objects,
            read: Measured::of(&read),
            compile: Measured::of(&compile),
            peak,
        })
    }
}

fn read_project(path: &Path, messages: Messages) -> Result<Scene, Failure> {
    let project = groimp::read(path).map_err(Failure::reading(path))?;
    messages.report(&project.report);
    Ok(project.scene)
}

impl OpenDevice {
    /// A row for every number of samples.
    fn measure(
        &self,
        name: &str,
        scene: &MeasuredScene,
        arguments: &MatrixArguments,
    ) -> Result<Vec<Row>, Failure> {
        let settings = RenderSettings {
            width: arguments.size.width,
            height: arguments.size.height,
            depth: arguments.depth,
            ..RenderSettings::default()
        };
        forget_peak_memory();
        let (mut upload, mut first) = (0.0, 0.0);
        let loaded = timed(&mut upload, || {
            let loaded = self.device.load(Arc::clone(&scene.compiled))?;
            loaded.prepare(settings.renderer).map(|()| loaded)
        })?;
        // Drivers use it to finish compiling.
        timed(&mut first, || picture(loaded.as_ref(), &RenderSettings { samples: 1, ..settings.clone() }))?;
        let mut rows: Vec<Row> = Vec::new();
        for &samples in &arguments.samples {
            if rows.iter().any(|row| row.samples == samples) {
                continue;
            }
            let settings = RenderSettings { samples, ..settings.clone() };
            let rendered = Rendered::measure(loaded.as_ref(), &settings, arguments.repeat)?;
            // A clock that did not move between two looks must not give infinity.
            let per_second = |count: u64| count as f64 / rendered.seconds.best.max(1e-9);
            rows.push(Row {
                scene: name.to_owned(),
                objects: scene.objects,
                triangles: scene.compiled.triangles() as u64,
                device: self.key.clone(),
                device_name: self.device.name(),
                width: settings.width,
                height: settings.height,
                depth: settings.depth,
                samples,
                repeats: arguments.repeat,
                seconds: StepSeconds {
                    open: self.open,
                    read: scene.read,
                    compile: scene.compile,
                    upload,
                    first,
                    render: rendered.seconds,
                },
                cpu_seconds: rendered.cpu_seconds,
                device_seconds: rendered.device_seconds,
                samples_per_second: per_second(rendered.samples),
                rays_per_second: per_second(rendered.rays),
                scene_bytes: table_bytes(&scene.compiled),
                peak_memory_bytes: scene.peak.max(peak_memory_bytes()),
            });
        }
        Ok(rows)
    }
}

/// The same picture, rendered again and again.
struct Rendered {
    seconds: Measured,
    /// Of the shortest rendering.
    cpu_seconds: Option<f64>,
    /// Likewise, by the clock of the device.
    device_seconds: Option<f64>,
    samples: u64,
    rays: u64,
}

impl Rendered {
    fn measure(scene: &dyn LoadedScene, settings: &RenderSettings, repeats: u32) -> Result<Self, Failure> {
        let mut times: Vec<f64> = Vec::new();
        let mut shortest = Rendered {
            seconds: Measured::of(&[]),
            cpu_seconds: None,
            device_seconds: None,
            samples: 0,
            rays: 0,
        };
        for _ in 0..repeats.max(1) {
            let (before, device_before) = (ticks_so_far(), scene.device_seconds());
            let mut time = 0.0;
            let film = timed(&mut time, || picture(scene, settings))?;
            if times.iter().all(|known| time < *known) {
                let ticks = before.zip(ticks_so_far()).and_then(|(before, after)| after.checked_sub(before));
                shortest.cpu_seconds = ticks.map(|ticks| ticks as f64 / TICKS_PER_SECOND);
                let device = device_before.zip(scene.device_seconds());
                shortest.device_seconds = device.map(|(before, after)| after - before);
                (shortest.samples, shortest.rays) = (film.samples(), film.rays());
            }
            times.push(time);
        }
        Ok(Rendered { seconds: Measured::of(&times), ..shortest })
    }
}

fn picture(scene: &dyn LoadedScene, settings: &RenderSettings) -> Result<Film, Failure> {
    Ok(scene.render(settings, &|_| ControlFlow::Continue(()))?)
}

/// Bytes of all that a device is given.
fn table_bytes(scene: &CompiledScene) -> u64 {
    let tables = [
        size_of_val(&scene.header),
        size_of_val(&scene.nodes[..]),
        size_of_val(&scene.objects[..]),
        size_of_val(&scene.materials[..]),
        size_of_val(&scene.channels[..]),
        size_of_val(&scene.texels[..]),
        size_of_val(&scene.lights[..]),
        size_of_val(&scene.attributes[..]),
    ];
    tables.iter().map(|bytes| *bytes as u64).sum()
}

/// Begins a new high-water mark of memory. Where the system has no such file the mark is that of the whole run.
fn forget_peak_memory() {
    if cfg!(target_os = "linux") {
        let _ = std::fs::write("/proc/self/clear_refs", "5");
    }
}

/// Processor time of all threads so far, where the system tells.
fn ticks_so_far() -> Option<u64> {
    processor_ticks(&std::fs::read_to_string("/proc/self/stat").ok()?)
}

/// Of Linux on all of today's architectures (`man 5 proc`, `sysconf(_SC_CLK_TCK)`).
const TICKS_PER_SECOND: f64 = 100.0;

/// Fields 14 and 15: ticks in the program and, on its behalf, in the kernel.
fn processor_ticks(stat: &str) -> Option<u64> {
    // Field 2 is the program's name in brackets, with spaces and brackets in it if it likes.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let user: u64 = fields.next()?.parse().ok()?;
    let system: u64 = fields.next()?.parse().ok()?;
    user.checked_add(system)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processor_time_is_found_behind_any_name() {
        let stat = "7 (a ) b) R 1 2 3 4 5 6 7 8 9 10 200 34 0 0 20 0";
        assert_eq!(processor_ticks(stat), Some(234));
        assert_eq!(processor_ticks("7 (a"), None);
    }

    #[test]
    fn scenes_have_names_of_their_own() {
        let directory = tempfile::tempdir().unwrap();
        let paths = ["a/oak.gsz", "b/oak.gsz"].map(|part| directory.path().join(part));
        for path in &paths {
            std::fs::create_dir(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        let asked = [paths[0].clone(), paths[1].clone(), "canopy".into(), "canopy".into()];
        let names: Vec<String> = sources(&asked).unwrap().into_iter().map(|source| source.name).collect();
        assert_eq!(names, ["oak", &paths[1].display().to_string(), "canopy"]);
        assert_eq!(sources(&[]).unwrap().len(), 8);
        assert!(matches!(sources(&["missing.gsz".into()]), Err(Failure::Unreadable { .. })));
    }
}
