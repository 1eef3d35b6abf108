//! Choosing a device.

use crate::cpu::Cpu;
use crate::gpu::{Gpu, GpuInfo};
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
}

impl FromStr for DeviceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(DeviceChoice::Auto),
            "cpu" => Ok(DeviceChoice::Cpu),
            "gpu" => Ok(DeviceChoice::Gpu(None)),
            _ => match text.strip_prefix("gpu:").map(str::parse) {
                Some(Ok(number)) => Ok(DeviceChoice::Gpu(Some(number))),
                _ => Err(format!("`{text}` is no device; use auto, cpu, gpu or gpu:N")),
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
        DeviceChoice::Auto => match Gpu::open_automatic() {
            Some(Ok(gpu)) => Ok(Box::new(Arc::new(gpu))),
            Some(Err(_)) | None => Ok(Box::new(Cpu::new(threads)?)),
        },
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
/// program for it.
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
        let scene = device.load(Arc::clone(scene))?;
        scene.prepare(renderer)?;
        Ok(ReadyDevice { device, scene })
    };
    match load(device) {
        Err(_) if choice == DeviceChoice::Auto => load(Box::new(Cpu::new(threads)?)),
        result => result,
    }
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

    #[test]
    fn device_names_are_understood() {
        assert_eq!("auto".parse(), Ok(DeviceChoice::Auto));
        assert_eq!("gpu".parse(), Ok(DeviceChoice::Gpu(None)));
        assert_eq!("gpu:2".parse(), Ok(DeviceChoice::Gpu(Some(2))));
        for wrong in ["", "gpu:", "gpu:-1", "gpu:x", "cuda"] {
            assert!(wrong.parse::<DeviceChoice>().is_err(), "{wrong}");
        }
    }
}
