//! The GPU device: the kernels as WGSL on any adapter that wgpu finds (Vulkan, Metal, DirectX 12).

mod adapters;
mod assemble;
mod scene;
mod shader;
mod tile;

pub use adapters::{GpuInfo, list_gpus};

use crate::{CompiledScene, Device, DeviceError, LoadedScene};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A graphics card.
pub struct Gpu {
    name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    module: wgpu::ShaderModule,
    /// What the kernels are bound to, the same for all pipelines: header, settings, tables, film.
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    /// Compiled when it is first needed: most pictures have no layers.
    layers_pipeline: OnceLock<wgpu::ComputePipeline>,
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
    /// If there is no such adapter or it refuses to run the kernels.
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

        let source = shader::source().map_err(|reason| failed("preparing the kernels", reason))?;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("kernels"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let layout = bind_group_layout(&device);
        let pipeline = compute_pipeline(&device, &layout, &module, "path tracer", "render_tile");
        if let Some(reason) = errors.take() {
            return Err(failed("compiling the kernels", reason));
        }
        Ok(Gpu {
            name: format!("{} ({})", info.name, info.backend),
            device,
            queue,
            module,
            layout,
            pipeline,
            layers_pipeline: OnceLock::new(),
            errors,
            is_software: info.is_software,
        })
    }

    /// The pipeline of the layers.
    fn layers_pipeline(&self) -> Result<&wgpu::ComputePipeline, DeviceError> {
        let pipeline = self.layers_pipeline.get_or_init(|| {
            compute_pipeline(&self.device, &self.layout, &self.module, "layers", "render_layers")
        });
        self.check("compiling the kernels of the layers")?;
        Ok(pipeline)
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

/// The kernels as graphics cards run them: name of the file and text in WGSL.
///
/// # Errors
/// If they cannot be written in WGSL; the tests exclude it.
pub fn kernel_sources() -> Result<Vec<(&'static str, String)>, String> {
    Ok(vec![("path_tracer.wgsl", shader::source()?)])
}

/// Bindings 0 and 1 are uniforms, then seven tables that are read, then the film that is written. Explicit, because
/// a layout that is derived from an entry point leaves out what that one does not use.
fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    const BINDINGS: u32 = 10;
    let entries: Vec<_> = (0..BINDINGS)
        .map(|binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match binding {
                    0 | 1 => wgpu::BufferBindingType::Uniform,
                    _ => wgpu::BufferBindingType::Storage { read_only: binding + 1 < BINDINGS },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("scene and tile"),
        entries: &entries,
    })
}

fn compute_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    module: &wgpu::ShaderModule,
    label: &'static str,
    entry_point: &'static str,
) -> wgpu::ComputePipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("kernels"),
        bind_group_layouts: &[Some(layout)],
        ..Default::default()
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(label),
        layout: Some(&layout),
        module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

impl Device for Arc<Gpu> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn load(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError> {
        Ok(Box::new(scene::GpuScene::upload(Arc::clone(self), &scene)?))
    }
}
