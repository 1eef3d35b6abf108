//! The GPU device: the kernels as WGSL on any adapter that wgpu finds (Vulkan, Metal, DirectX 12).

mod adapters;
mod assemble;
mod clock;
mod joining;
mod launches;
#[cfg(test)]
mod memory_tests;
mod scene;
mod shader;
mod tile;
mod tile_memory;

pub use adapters::{GpuInfo, list_gpus};

use crate::{CompiledScene, Device, DeviceError, LoadedScene, Renderer};
use joining::Joiner;
use kernels::records::kernel::ALL_FEATURES;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, mpsc};

/// A graphics card.
pub struct Gpu {
    name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// The programs that were needed so far.
    pipelines: Mutex<HashMap<Program, wgpu::ComputePipeline>>,
    /// Adds films; compiled when it is first needed.
    joiner: OnceLock<Joiner>,
    /// What the kernels are bound to, the same for all pipelines: header, settings, tables, film.
    layout: wgpu::BindGroupLayout,
    /// What went wrong since the last look; filled by the driver at any time.
    errors: Arc<ErrorLog>,
    /// A rasteriser in software is slow and must be given small pieces of work.
    is_software: bool,
    /// Bytes that may be taken at a time, in tests of what happens when there are no more.
    #[cfg(test)]
    memory: u64,
}

/// A program of the graphics card.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Program {
    renderer: Renderer,
    entry_point: &'static str,
    /// What the scenes have that it can render.
    features: u32,
}

impl Program {
    /// The samples of a renderer.
    fn samples(renderer: Renderer, features: u32) -> Self {
        Program { renderer, entry_point: "render_tile", features }
    }

    /// The layers, which are the same for all renderers.
    fn layers(features: u32) -> Self {
        Program { renderer: Renderer::PathTracer, entry_point: "render_layers", features }
    }
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
            Some((adapter, info)) => Self::start(adapter, info, adapter.limits()),
            None => Err(DeviceError::NoSuchGpu { wanted: index, found: adapters::summary(&adapters) }),
        }
    }

    /// Opens the adapter that [`crate::automatic_gpu`] chooses; `None` if there is none to choose.
    pub(crate) fn open_automatic() -> Option<Result<Self, DeviceError>> {
        let adapters = adapters::all();
        let infos: Vec<GpuInfo> = adapters.iter().map(|(_, info)| info.clone()).collect();
        let (adapter, info) = adapters.get(crate::automatic_gpu(&infos)?)?;
        Some(Self::start(adapter, info, adapter.limits()))
    }

    fn start(
        adapter: &wgpu::Adapter,
        info: &GpuInfo,
        required_limits: wgpu::Limits,
    ) -> Result<Self, DeviceError> {
        let failed = |doing: &'static str, reason: String| DeviceError::Gpu {
            device: info.name.clone(),
            doing,
            reason,
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("sunshine"),
            // To tell how long it worked.
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            // As a rule what the adapter offers, so that large scenes fit where they can.
            required_limits,
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

        let layout = bind_group_layout(&device);
        Ok(Gpu {
            name: format!("{} ({})", info.name, info.backend),
            device,
            queue,
            pipelines: Mutex::default(),
            joiner: OnceLock::new(),
            layout,
            errors,
            is_software: info.is_software,
            #[cfg(test)]
            memory: u64::MAX,
        })
    }

    /// A program, compiled when it is first needed.
    fn pipeline(&self, program: Program) -> Result<wgpu::ComputePipeline, DeviceError> {
        let mut pipelines = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = pipelines.get(&program) {
            return Ok(pipeline.clone());
        }
        let pipeline = self.compile(program)?;
        Ok(pipelines.entry(program).or_insert(pipeline).clone())
    }

    fn compile(&self, program: Program) -> Result<wgpu::ComputePipeline, DeviceError> {
        let label = program.renderer.name();
        let source = shader::source(program.renderer, program.features)
            .map_err(|reason| self.failed("preparing the kernels", reason))?;
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        };
        // SAFETY: no index of these kernels depends on what is not checked before: those in the tables come from the
        // compiler of scenes, the stack holds as many levels as its hierarchies may have (tested there), pixels are
        // compared with the size of the tile, and all loops end for the reasons given beside them. Measured: checks
        // cost 5 to 30 %, most in scenes with many objects.
        let module = unsafe {
            self.device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
        };
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&self.layout)],
            ..Default::default()
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(program.entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        self.check("compiling the kernels")?;
        Ok(pipeline)
    }

    /// The program that adds films.
    fn joiner(&self) -> Result<&Joiner, DeviceError> {
        if let Some(joiner) = self.joiner.get() {
            return Ok(joiner);
        }
        let joiner = Joiner::new(self)?;
        Ok(self.joiner.get_or_init(|| joiner))
    }

    /// What `make` makes of so many bytes of the card's memory, for `what`.
    ///
    /// # Errors
    /// If there are not so many.
    fn allocated<T>(
        &self,
        what: &'static str,
        needed: u64,
        make: impl FnOnce() -> T,
    ) -> Result<T, DeviceError> {
        let short = || DeviceError::OutOfMemory { device: self.name.clone(), what, needed };
        #[cfg(test)]
        if needed > self.memory {
            return Err(short());
        }
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let made = make();
        if pollster::block_on(scope.pop()).is_some() {
            // What follows from it, as that a binding is invalid, is of no interest.
            self.errors.take();
            return Err(short());
        }
        self.check("taking memory")?;
        Ok(made)
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

/// What `look` sees in the first bytes of a buffer when all that was submitted is done.
fn read<T>(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    size: u64,
    doing: &'static str,
    look: impl FnOnce(&[u8]) -> T,
) -> Result<T, DeviceError> {
    let (sender, receiver) = mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, 0..size, move |result| {
        // The receiver is gone only if the wait below failed, which is reported there.
        let _ = sender.send(result);
    });
    scene::wait(gpu, doing)?;
    match receiver.recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(gpu.failed(doing, error.to_string())),
        Err(error) => return Err(gpu.failed(doing, error.to_string())),
    }
    let view = buffer.get_mapped_range(0..size).map_err(|error| gpu.failed(doing, error.to_string()))?;
    let seen = look(&view);
    drop(view);
    buffer.unmap();
    Ok(seen)
}

fn encoder(gpu: &Gpu, label: &'static str) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
}

/// The kernels as graphics cards run them: name of the file and text in WGSL.
///
/// # Errors
/// If they cannot be written in WGSL; the tests exclude it.
pub fn kernel_sources() -> Result<Vec<(&'static str, String)>, String> {
    Ok(vec![
        ("path_tracer.wgsl", shader::source(Renderer::PathTracer, ALL_FEATURES)?),
        ("ray_tracer.wgsl", shader::source(Renderer::RayTracer, ALL_FEATURES)?),
        ("join_films.wgsl", joining::source()?),
    ])
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

impl Device for Arc<Gpu> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn load(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError> {
        Ok(Box::new(scene::GpuScene::upload(Arc::clone(self), &scene)?))
    }
}
