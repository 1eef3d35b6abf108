//! Which graphics cards there are.

/// A graphics card, or a program that plays one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GpuInfo {
    /// Its number for `--device gpu:N`.
    pub index: usize,
    /// Name that the driver gives it.
    pub name: String,
    /// Interface through which it is reached: Vulkan, Metal or DirectX 12.
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// discrete, integrated, virtual, software or other.
    pub kind: String,
    /// True if it computes on the CPU; then the CPU device is the better choice.
    pub is_software: bool,
}

/// All adapters of this machine, in the order of their numbers.
pub fn list_gpus() -> Vec<GpuInfo> {
    all().into_iter().map(|(_, info)| info).collect()
}

/// The adapters in a fixed order: hardware before software, otherwise as the system lists them.
pub(super) fn all() -> Vec<(wgpu::Adapter, GpuInfo)> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY;
    let instance = wgpu::Instance::new(descriptor);
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    // Without compute shaders there is nothing to run the kernels.
    adapters.retain(|adapter| {
        adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
    });
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
        .into_iter()
        .enumerate()
        .map(|(index, adapter)| {
            let info = describe(index, &adapter.get_info());
            (adapter, info)
        })
        .collect()
}

fn describe(index: usize, info: &wgpu::AdapterInfo) -> GpuInfo {
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "discrete",
        wgpu::DeviceType::IntegratedGpu => "integrated",
        wgpu::DeviceType::VirtualGpu => "virtual",
        wgpu::DeviceType::Cpu => "software",
        wgpu::DeviceType::Other => "other",
    };
    let backend = match info.backend {
        wgpu::Backend::Vulkan => "Vulkan",
        wgpu::Backend::Metal => "Metal",
        wgpu::Backend::Dx12 => "DirectX 12",
        wgpu::Backend::Gl => "OpenGL",
        wgpu::Backend::BrowserWebGpu => "WebGPU",
        wgpu::Backend::Noop => "none",
    };
    GpuInfo {
        index,
        name: info.name.clone(),
        backend: backend.to_owned(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        kind: kind.to_owned(),
        is_software: info.device_type == wgpu::DeviceType::Cpu,
    }
}

/// All adapters in one line, for messages.
pub(super) fn summary(adapters: &[(wgpu::Adapter, GpuInfo)]) -> String {
    if adapters.is_empty() {
        return "none".to_owned();
    }
    adapters
        .iter()
        .map(|(_, gpu)| format!("{} {} ({})", gpu.index, gpu.name, gpu.backend))
        .collect::<Vec<_>>()
        .join(", ")
}
