//! The GPU device: the kernels as WGSL on any adapter that wgpu finds (Vulkan, Metal, DirectX 12).

mod adapters;
mod assemble;
mod scene;
mod shader;

pub use adapters::{GpuInfo, list_gpus};

use crate::{CompiledScene, Device, DeviceError, LoadedScene, Renderer};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A graphics card.
pub struct Gpu {
    name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// A program for each renderer, compiled when it is first used.
    pipelines: [OnceLock<wgpu::ComputePipeline>; 2],
    /// What went wrong since the last look; filled by the driver at any time.
    errors: Arc<ErrorLog>,
    /// A rasteriser in software is slow and must be given small pieces of work.
    is_software: bool,
}

/// Errors that the driver reported outside of any call.
#[derive(Default)]
struct ErrorLog(Mutex<Option<String>>);

impl ErrorLog {
    fn put(&self, message: String) {
        // The first error is the cause, the others follow from it.
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(message);
    }

    fn take(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl Gpu {
    /// Opens an adapter by its number in [`list_gpus`].
    ///
    /// # Errors
    /// If there is no such adapter or it refuses to work.
    pub fn open(index: usize) -> Result<Self, DeviceError> {
        let adapters = adapters::all();
        match adapters.get(index) {
            Some((adapter, info)) => Self::start(adapter, info),
            None => Err(DeviceError::NoSuchGpu { wanted: index, found: adapters::summary(&adapters) }),
        }
    }

    /// Opens the adapter that [`crate::automatic_gpu`] chooses; `None` if there is none to choose.
    pub(crate) fn open_automatic() -> Option<Result<Self, DeviceError>> {
        let adapters = adapters::all();
        let infos: Vec<GpuInfo> = adapters.iter().map(|(_, info)| info.clone()).collect();
        let (adapter, info) = adapters.get(crate::automatic_gpu(&infos)?)?;
        Some(Self::start(adapter, info))
    }

    fn start(adapter: &wgpu::Adapter, info: &GpuInfo) -> Result<Self, DeviceError> {
        let failed = |doing: &'static str, reason: String| DeviceError::Gpu {
            device: info.name.clone(),
            doing,
            reason,
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("sunshine"),
            // What the adapter offers, so that large scenes fit where they can.
            required_limits: adapter.limits(),
            ..Default::default()
        }))
        .map_err(|error| failed("opening it", error.to_string()))?;

        let errors = Arc::new(ErrorLog::default());
        let log = Arc::clone(&errors);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| log.put(error.to_string())));
        let log = Arc::clone(&errors);
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                log.put(format!("the device was lost: {message}"));
            }
        });

        Ok(Gpu {
            name: format!("{} ({})", info.name, info.backend),
            device,
            queue,
            pipelines: Default::default(),
            errors,
            is_software: info.is_software,
        })
    }

    /// The program of a renderer.
    pub(crate) fn pipeline(&self, renderer: Renderer) -> Result<&wgpu::ComputePipeline, DeviceError> {
        let known = &self.pipelines[renderer.index()];
        if let Some(pipeline) = known.get() {
            return Ok(pipeline);
        }
        let source =
            shader::source(renderer).map_err(|reason| self.failed("preparing the kernels", reason))?;
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(renderer.name()),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(renderer.name()),
            layout: None,
            module: &module,
            entry_point: Some("render_tile"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        self.check("compiling the kernels")?;
        Ok(known.get_or_init(|| pipeline))
    }

    fn check(&self, doing: &'static str) -> Result<(), DeviceError> {
        match self.errors.take() {
            None => Ok(()),
            Some(reason) => Err(self.failed(doing, reason)),
        }
    }

    fn failed(&self, doing: &'static str, reason: String) -> DeviceError {
        DeviceError::Gpu { device: self.name.clone(), doing, reason }
    }
}

impl Device for Arc<Gpu> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn load(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError> {
        Ok(Box::new(scene::GpuScene::upload(Arc::clone(self), &scene)?))
    }
}
