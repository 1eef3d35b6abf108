//! Films that are added on the graphics card.

use super::Gpu;
use crate::DeviceError;
use wgsl_rs::wgsl;

// Rust never calls the entry point; the graphics card does. Validated below.
#[allow(dead_code)]
#[wgsl(skip_validation)]
mod kernel {
    use kernels::records::kernel::*;
    use kernels::sums::kernel::*;
    use wgsl_rs::std::*;

    uniform!(group(0), binding(0), SETTINGS: LaunchSettings);
    storage!(group(0), binding(1), read_write, FIRST: RuntimeArray<FilmPixel>);
    storage!(group(0), binding(2), SECOND: RuntimeArray<FilmPixel>);

    /// One invocation adds a pixel of the second film of a tile to that of the first.
    #[compute]
    #[workgroup_size(256)]
    pub fn join_films(#[builtin(global_invocation_id)] id: Vec3u) {
        let settings = load!(SETTINGS);
        if id.x < settings.tile_width * settings.tile_height {
            let joined = joined_pixels(get!(FIRST)[id.x as usize], get!(SECOND)[id.x as usize]);
            get_mut!(FIRST)[id.x as usize] = joined;
        }
    }
}

/// Invocations of a work group in the kernel.
const WORKGROUP: u32 = 256;

/// The program that adds films.
pub(super) struct Joiner {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// Its text.
///
/// # Errors
/// If it cannot be written in WGSL; the tests exclude it.
pub(super) fn source() -> Result<String, String> {
    kernel::WGSL_SOURCE.wgsl_source().map_err(|error| error.to_string())
}

impl Joiner {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, DeviceError> {
        const LABEL: Option<&str> = Some("join films");
        let source = source().map_err(|reason| gpu.failed("preparing the kernels", reason))?;
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: LABEL,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let entries = [
            wgpu::BufferBindingType::Uniform,
            wgpu::BufferBindingType::Storage { read_only: false },
            wgpu::BufferBindingType::Storage { read_only: true },
        ];
        let entries: Vec<_> = (0..)
            .zip(entries)
            .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                count: None,
            })
            .collect();
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: LABEL, entries: &entries });
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: LABEL,
            bind_group_layouts: &[Some(&layout)],
            ..Default::default()
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: LABEL,
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("join_films"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        gpu.check("compiling the kernels")?;
        Ok(Joiner { pipeline, layout })
    }

    /// The program bound to settings, whose tile's size counts, and two films.
    pub(super) fn bind(
        &self,
        gpu: &Gpu,
        settings: &wgpu::Buffer,
        first: &wgpu::Buffer,
        second: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip([settings, first, second])
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("films to join"),
            layout: &self.layout,
            entries: &entries,
        })
    }

    /// Adds the films of so many pixels.
    pub(super) fn join(&self, encoder: &mut wgpu::CommandEncoder, films: &wgpu::BindGroup, pixels: u32) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("join films"),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, films, &[]);
        pass.dispatch_workgroups(pixels.div_ceil(WORKGROUP), 1, 1);
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_text_is_valid() {
        let module = wgpu::naga::front::wgsl::parse_str(&super::source().unwrap()).unwrap();
        wgpu::naga::valid::Validator::new(
            wgpu::naga::valid::ValidationFlags::all(),
            wgpu::naga::valid::Capabilities::empty(),
        )
        .validate(&module)
        .unwrap();
    }
}
