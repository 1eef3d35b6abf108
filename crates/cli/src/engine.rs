//! The one place where the program touches the reader and the renderer: the commands know only the names below.

pub use placeholder::{
    CompileError, DeviceChoice, GpuInfo, ReadError, Report, compile, list_gpus, open_device, read,
};
pub use render::{
    CompiledScene, Device, DeviceError, Film, PictureError, PictureFormat, RenderSettings,
    automatic_exposure, check_writable, write_picture, write_whole_file,
};

/// Number of triangles of a compiled scene.
pub fn triangles(scene: &CompiledScene) -> usize {
    // PLACEHOLDER: scene.triangles()
    let CompiledScene = scene;
    0
}

/// What `--device` says, as a value or as a sentence about what would have been accepted.
pub fn parse_device_choice(text: &str) -> Result<DeviceChoice, String> {
    text.parse::<DeviceChoice>().map_err(|error| error.to_string())
}

/// The index of the graphics card that `--device auto` takes: a real one, never a program that imitates one,
/// since that is slower than the CPU device itself. A card of its own is preferred to one inside the processor.
pub fn automatic_gpu(gpus: &[GpuInfo]) -> Option<usize> {
    let rank = |gpu: &GpuInfo| match gpu.kind.as_str() {
        "discrete" => 0,
        "integrated" => 1,
        _ => 2,
    };
    gpus.iter().filter(|gpu| !gpu.is_software).min_by_key(|gpu| rank(gpu)).map(|gpu| gpu.index)
}

/// PLACEHOLDER until `groimp::read`, `render::compile` and the devices are there. Delete the module and name
/// theirs instead.
mod placeholder {
    use super::{CompiledScene, Device, DeviceError};
    use render::LoadedScene;
    use std::path::Path;
    use std::str::FromStr;
    use std::sync::Arc;

    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum DeviceChoice {
        Auto,
        Cpu,
        Gpu(Option<usize>),
    }

    impl FromStr for DeviceChoice {
        type Err = String;

        fn from_str(text: &str) -> Result<Self, String> {
            let number = |n: &str| n.parse().map(|n| DeviceChoice::Gpu(Some(n))).ok();
            match text {
                "auto" => Some(DeviceChoice::Auto),
                "cpu" => Some(DeviceChoice::Cpu),
                "gpu" => Some(DeviceChoice::Gpu(None)),
                _ => text.strip_prefix("gpu:").and_then(number),
            }
            .ok_or_else(|| "expected auto, cpu, gpu or gpu:N, for example gpu:1".to_owned())
        }
    }

    #[allow(dead_code)]
    #[derive(Clone, Debug)]
    pub struct GpuInfo {
        pub index: usize,
        pub name: String,
        pub backend: String,
        pub driver: String,
        pub kind: String,
        pub is_software: bool,
    }

    pub fn list_gpus() -> Vec<GpuInfo> {
        Vec::new()
    }

    pub fn open_device(_: DeviceChoice, _: Option<usize>) -> Result<Box<dyn Device>, DeviceError> {
        Ok(Box::new(NoDevice))
    }

    struct NoDevice;

    impl Device for NoDevice {
        fn name(&self) -> String {
            "nothing".to_owned()
        }

        fn load(&self, _: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError> {
            Err(DeviceError::Threads { reason: "this build holds no renderer yet".to_owned() })
        }
    }

    #[derive(Debug, thiserror::Error)]
    #[error("this build cannot compile scenes yet")]
    pub struct CompileError;

    pub fn compile(_: &scene::Scene) -> Result<CompiledScene, CompileError> {
        Err(CompileError)
    }

    #[derive(Debug, thiserror::Error)]
    pub enum ReadError {
        #[error("cannot read {}", path.display())]
        Io { path: std::path::PathBuf, source: std::io::Error },
        #[error("this build cannot read scenes yet")]
        Missing,
    }

    pub struct Project {
        pub scene: scene::Scene,
        pub report: Report,
    }

    #[derive(Default)]
    pub struct Report {
        pub skipped: Vec<Skipped>,
        pub warnings: Vec<Warning>,
    }

    pub struct Skipped {
        pub type_name: String,
        pub count: usize,
        pub reason: String,
    }

    impl std::fmt::Display for Skipped {
        fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            write!(f, "{} x {}: {}", self.count, self.type_name, self.reason)
        }
    }

    pub struct Warning {
        pub message: String,
    }

    impl std::fmt::Display for Warning {
        fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str(&self.message)
        }
    }

    pub fn read(path: &Path) -> Result<Project, ReadError> {
        std::fs::metadata(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
        Err(ReadError::Missing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gpu(index: usize, kind: &str) -> GpuInfo {
        GpuInfo {
            index,
            name: format!("card {index}"),
            backend: "Vulkan".to_owned(),
            driver: String::new(),
            kind: kind.to_owned(),
            is_software: kind == "software",
        }
    }

    #[test]
    fn auto_prefers_a_card_of_its_own_and_never_takes_software() {
        assert_eq!(automatic_gpu(&[]), None);
        assert_eq!(automatic_gpu(&[gpu(0, "software")]), None);
        assert_eq!(automatic_gpu(&[gpu(0, "software"), gpu(1, "virtual")]), Some(1));
        let all = [gpu(0, "other"), gpu(1, "integrated"), gpu(2, "discrete"), gpu(3, "discrete")];
        assert_eq!(automatic_gpu(&all), Some(2));
    }

    #[test]
    fn device_choices() {
        assert_eq!(parse_device_choice("auto"), Ok(DeviceChoice::Auto));
        assert_eq!(parse_device_choice("cpu"), Ok(DeviceChoice::Cpu));
        assert_eq!(parse_device_choice("gpu"), Ok(DeviceChoice::Gpu(None)));
        assert_eq!(parse_device_choice("gpu:12"), Ok(DeviceChoice::Gpu(Some(12))));
        for wrong in ["", "gpu:", "gpu:-1", "gpu:x", "cuda", "cpu:0"] {
            assert!(parse_device_choice(wrong).is_err(), "{wrong}");
        }
    }
}
