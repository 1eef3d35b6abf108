//! Choosing a device.

use crate::cpu::Cpu;
use crate::gpu::{Gpu, GpuInfo, list_gpus};
use crate::several::Several;
use crate::{CompiledScene, Device, DeviceError, LoadedScene, Renderer};
use std::str::FromStr;
use std::sync::Arc;

/// What the user asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum DeviceChoice {
    /// A hardware graphics card if there is one, else the CPU.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// A graphics card: by its number, or the first one.
    Gpu(Option<usize>),
    /// All graphics cards together, those in software only if there are no others.
    AllGpus,
    /// All graphics cards and the CPU.
    All,
}

impl FromStr for DeviceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(DeviceChoice::Auto),
            "cpu" => Ok(DeviceChoice::Cpu),
            "gpu" => Ok(DeviceChoice::Gpu(None)),
            "gpu:all" => Ok(DeviceChoice::AllGpus),
            "all" => Ok(DeviceChoice::All),
            _ => match text.strip_prefix("gpu:").map(str::parse) {
                Some(Ok(number)) => Ok(DeviceChoice::Gpu(Some(number))),
                _ => Err(format!("`{text}` is no device; use auto, cpu, gpu, gpu:N, gpu:all or all")),
            },
        }
    }
}

/// Number of the graphics card that [`DeviceChoice::Auto`] takes: a real one, never a rasteriser in software, which
/// would only run the kernels on the CPU with a detour.
pub fn automatic_gpu(gpus: &[GpuInfo]) -> Option<usize> {
    // They are listed with the fastest kind first.
    gpus.iter().find(|gpu| !gpu.is_software).map(|gpu| gpu.index)
}

/// Opens a device; `threads` limits the CPU device.
///
/// # Errors
/// If it is not there or refuses to work. `Auto` falls back to the CPU instead.
pub fn open_device(choice: DeviceChoice, threads: Option<usize>) -> Result<Box<dyn Device>, DeviceError> {
    match choice {
        DeviceChoice::Cpu => Ok(Box::new(Cpu::new(threads)?)),
        DeviceChoice::Gpu(number) => Ok(Box::new(Arc::new(Gpu::open(number.unwrap_or(0))?))),
        DeviceChoice::AllGpus => open_all(None),
        DeviceChoice::All => open_all(Some(Cpu::new(threads)?)),
        DeviceChoice::Auto => match Gpu::open_automatic() {
            Some(Ok(gpu)) => Ok(Box::new(Arc::new(gpu))),
            Some(Err(error)) => Ok(Box::new(instead_of_gpu(&error, threads)?)),
            None => Ok(Box::new(Cpu::new(threads)?)),
        },
    }
}

/// The CPU in the place of a graphics card that was not asked for by name and does not work: with a warning, because the
/// picture takes longer.
fn instead_of_gpu(error: &DeviceError, threads: Option<usize>) -> Result<Cpu, DeviceError> {
    tracing::warn!("the processor renders in the place of the graphics card: {error}");
    Cpu::new(threads)
}

/// All graphics cards that can be opened, and the CPU.
fn open_all(cpu: Option<Cpu>) -> Result<Box<dyn Device>, DeviceError> {
    let infos = list_gpus();
    let has_hardware = infos.iter().any(|gpu| !gpu.is_software);
    let mut devices: Vec<Box<dyn Device>> = Vec::new();
    let mut failure = None;
    for gpu in infos.iter().filter(|gpu| !has_hardware || !gpu.is_software) {
        match Gpu::open(gpu.index) {
            Ok(gpu) => devices.push(Box::new(Arc::new(gpu))),
            Err(error) => {
                tracing::warn!("{} is left out: {error}", gpu.name);
                failure = Some(error);
            }
        }
    }
    if let Some(cpu) = cpu {
        devices.push(Box::new(cpu));
    }
    match failure {
        _ if !devices.is_empty() => Ok(Box::new(Together(devices))),
        Some(error) => Err(error),
        // Says that there is none.
        None => Gpu::open(0).map(|gpu| Box::new(Arc::new(gpu)) as Box<dyn Device>),
    }
}

/// Devices that work on the same picture.
struct Together(Vec<Box<dyn Device>>);

impl Together {
    /// Each different text once, in order.
    fn joined(&self, text: impl Fn(&dyn Device) -> String) -> String {
        let mut texts: Vec<String> = self.0.iter().map(|device| text(device.as_ref())).collect();
        texts.sort();
        texts.dedup();
        texts.join(" and ")
    }
}

impl Device for Together {
    fn name(&self) -> String {
        let names: Vec<String> = self.0.iter().map(|device| device.name()).collect();
        names.join(" and ")
    }

    fn kind(&self) -> String {
        self.joined(|device| device.kind())
    }

    fn load(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError> {
        let mut loaded = Vec::new();
        let mut failure = None;
        for device in &self.0 {
            match device.load(Arc::clone(&scene)) {
                Ok(scene) => loaded.push((device.name(), scene)),
                Err(error) => {
                    tracing::warn!("{} is left out: {error}", device.name());
                    failure = Some(error);
                }
            }
        }
        match failure {
            Some(error) if loaded.is_empty() => Err(error),
            _ => Ok(Box::new(Several::new(loaded, None))),
        }
    }
}

/// A device with a scene that it is ready to render.
pub struct ReadyDevice {
    /// The device, which `Auto` may have replaced.
    pub device: Box<dyn Device>,
    /// The scene in its memory.
    pub scene: Box<dyn LoadedScene>,
}

/// Loads a scene into a device from [`open_device`] and prepares it for a renderer: graphics cards compile their
/// program for it. Should a graphics card fail later, smaller pieces of work are tried, then the CPU goes on;
/// [`LoadedScene::failures`] tells.
///
/// # Errors
/// If the device refuses. `Auto` falls back to the CPU instead.
pub fn load_for(
    device: Box<dyn Device>,
    choice: DeviceChoice,
    threads: Option<usize>,
    scene: &Arc<CompiledScene>,
    renderer: Renderer,
) -> Result<ReadyDevice, DeviceError> {
    let load = |device: Box<dyn Device>| {
        let loaded = device.load(Arc::clone(scene))?;
        loaded.prepare(renderer)?;
        Ok(ReadyDevice { device, scene: loaded })
    };
    let replaceable = choice == DeviceChoice::Auto && device.kind() != Cpu::KIND;
    let ready = match load(device) {
        Err(error) if replaceable => load(Box::new(instead_of_gpu(&error, threads)?)),
        result => result,
    }?;
    // Nothing stands in for the CPU.
    if ready.device.kind() == Cpu::KIND {
        return Ok(ready);
    }
    let scene = Arc::clone(scene);
    let spare = move || {
        let cpu = Cpu::new(threads)?;
        Ok((cpu.name(), cpu.load(Arc::clone(&scene))?))
    };
    let several = Several::new(vec![(ready.device.name(), ready.scene)], Some(Box::new(spare)));
    Ok(ReadyDevice { device: ready.device, scene: Box::new(several) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_takes_the_first_card_that_is_none_in_software() {
        let gpu = |index: usize, is_software: bool| GpuInfo {
            index,
            name: format!("card {index}"),
            backend: "Vulkan".to_owned(),
            driver: String::new(),
            kind: if is_software { "software" } else { "discrete" }.to_owned(),
            is_software,
        };
        assert_eq!(automatic_gpu(&[]), None);
        assert_eq!(automatic_gpu(&[gpu(0, true)]), None);
        assert_eq!(automatic_gpu(&[gpu(0, false), gpu(1, false), gpu(2, true)]), Some(0));
    }

    /// A graphics card that opens and then has no memory for anything.
    struct Full;

    impl Device for Full {
        fn name(&self) -> String {
            "full card".to_owned()
        }

        fn kind(&self) -> String {
            "gpu".to_owned()
        }

        fn load(&self, _: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError> {
            Err(DeviceError::OutOfMemory { device: self.name(), what: "the scene", needed: 1_000_000 })
        }
    }

    #[test]
    fn the_cpu_stands_in_for_a_card_that_was_not_asked_for_by_name() {
        let scene = Arc::new(crate::compile(&scene::Scene::default()).unwrap());
        let load = |choice| load_for(Box::new(Full), choice, Some(1), &scene, Renderer::PathTracer);
        assert_eq!(load(DeviceChoice::Auto).unwrap().device.kind(), Cpu::KIND);
        let Err(error) = load(DeviceChoice::Gpu(None)) else {
            panic!("the card that was asked for has to fail")
        };
        assert!(error.to_string().contains("full card has no memory left for the scene, 1.0 MB"), "{error}");
    }

    #[test]
    fn device_names_are_understood() {
        assert_eq!("auto".parse(), Ok(DeviceChoice::Auto));
        assert_eq!("gpu".parse(), Ok(DeviceChoice::Gpu(None)));
        assert_eq!("gpu:all".parse(), Ok(DeviceChoice::AllGpus));
        assert_eq!("all".parse(), Ok(DeviceChoice::All));
        assert_eq!("gpu:2".parse(), Ok(DeviceChoice::Gpu(Some(2))));
        for wrong in ["", "gpu:", "gpu:-1", "gpu:x", "cuda"] {
            assert!(wrong.parse::<DeviceChoice>().is_err(), "{wrong}");
        }
    }
}
