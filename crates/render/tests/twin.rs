//! CPU and GPU agree: function by function on random inputs, and in whole pictures.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

mod common;

use common::garden::garden;
use common::*;
use kernels::records::kernel::FilmPixel;
use render::RenderSettings;
use scene::{DVec3, LightKind, Shape};
use wgpu::util::DeviceExt;
use wgsl_rs::wgsl;

/// Every kernel function of interest, as one function of (probe, index of the random input). It runs natively
/// and on the graphics card.
// Rust never calls the entry point; the graphics card does.
#[allow(dead_code)]
#[wgsl]
pub mod probes {
    use kernels::bsdf::kernel::*;
    use kernels::bvh::kernel::*;
    use kernels::light::kernel::*;
    use kernels::light_tree::kernel::*;
    use kernels::random::kernel::*;
    use kernels::records::kernel::*;
    use kernels::shape::kernel::*;
    use kernels::sky::kernel::*;
    use kernels::tone::kernel::*;
    use kernels::traversal::kernel::*;
    use kernels::warp::kernel::*;
    use wgsl_rs::std::*;

    storage!(group(0), binding(0), read_write, RESULTS: RuntimeArray<Vec4f>);

    pub const PROBES: u32 = 19;
    pub const INPUTS: u32 = 4096;

    /// A random point of the cube [-2, 2]³.
    pub fn random_point(index: u32, dimension: u32) -> Vec3f {
        let r = random4(independent_key(index, 1, 11), dimension);
        vec3f(r.x, r.y, r.z) * 4.0 - vec3f(2.0, 2.0, 2.0)
    }

    pub fn random_direction(index: u32, dimension: u32) -> Vec3f {
        let r = random4(independent_key(index, 2, 11), dimension);
        polar_direction(2.0 * r.x - 1.0, r.y)
    }

    /// A rotated, stretched and moved unit shape of the given kind.
    pub fn random_shape(index: u32, kind: u32) -> ShapeRecord {
        let a = random_direction(index, 20);
        let b = normalize(cross(a, random_direction(index, 21)));
        let c = cross(a, b);
        let t = random_point(index, 22) * 0.25;
        let r = random4(independent_key(index, 3, 11), 23);
        let s = vec3f(0.5, 0.5, 0.5) + vec3f(r.x, r.y, r.z);
        ShapeRecord {
            object_from_world: Affine {
                row0: vec4f(a.x * s.x, a.y * s.x, a.z * s.x, t.x),
                row1: vec4f(b.x * s.y, b.y * s.y, b.z * s.y, t.y),
                row2: vec4f(c.x * s.z, c.y * s.z, c.z * s.z, t.z),
            },
            kind,
            material: 0,
            base_radius: 1.0,
            top_radius: r.w,
        }
    }

    pub fn random_bsdf(index: u32) -> Bsdf {
        let r = random4(independent_key(index, 4, 11), 24);
        Bsdf {
            diffuse: vec3f(0.3, 0.2, 0.1) * r.x,
            diffuse_transmission: vec3f(0.1, 0.2, 0.1) * r.y,
            glossy: vec3f(0.2, 0.2, 0.3) * r.z,
            exponent: shininess_exponent(r.w),
            glossy_transmission: vec3f(0.1, 0.1, 0.1) * r.x,
            transmission_exponent: shininess_exponent(r.x),
            straight: vec3f(0.1, 0.0, 0.1) * r.y,
            emissive: vec3f(0.0, 0.0, 0.0),
            eta: 0.7 + 0.6 * r.w,
        }
    }

    pub fn random_light(index: u32, kind: u32) -> LightRecord {
        let u = random_direction(index, 25);
        let v = normalize(cross(u, random_direction(index, 26)));
        LightRecord {
            position: random_point(index, 27),
            kind,
            axis: cross(u, v),
            shadowless: 0,
            emission: vec3f(3.0, 2.0, 1.0),
            cos_inner: 0.7,
            edge_u: u,
            cos_outer: 0.2,
            edge_v: v,
            importance: 1.0,
            first: 0,
            count: 0,
            parent: NONE,
            program: NONE,
        }
    }

    pub fn spread(v: Vec3f, w: f32) -> Vec4f {
        vec4f(v.x, v.y, v.z, w)
    }

    /// Rays against shapes, 0 to 5.
    pub fn probe_shape(kind: u32, index: u32) -> Vec4f {
        let shape = random_shape(index, kind);
        let ray = Ray { origin: random_point(index, 1), direction: random_direction(index, 2) };
        let hit = intersect_shape(ALL_FEATURES, shape, ray, 0.0, NO_HIT);
        if hit.t >= NO_HIT {
            return vec4f(-1.0, 0.0, 0.0, 0.0);
        }
        let p = snap_to_surface(
            shape,
            hit.face,
            transform_point(shape.object_from_world, ray.origin + ray.direction * hit.t),
        );
        let uv = texture_coordinates(shape, 1.0, hit.face, p);
        let n = object_normal(shape, hit.face, p);
        vec4f(hit.t, uv.x, uv.y, n.x + 2.0 * n.y + 3.0 * n.z + f32(hit.face))
    }

    /// Lights, 0 to 4.
    pub fn probe_light(kind: u32, index: u32) -> Vec4f {
        let light = random_light(index, kind);
        let r = random4(independent_key(index, 5, 11), 28);
        let point = random_point(index, 29);
        let normal = random_direction(index, 30);
        let sample = sample_plain_light(light, point, normal, r.z < 0.5, vec2f(r.x, r.y));
        let w = sample.weight.x + sample.weight.y + light_importance(light, point) + sample.pdf;
        spread(sample.direction, w)
    }

    pub fn probe(which: u32, index: u32) -> Vec4f {
        let key = independent_key(index, 6, 11);
        let r = random4(key, 31);
        if which < 6u32 {
            return probe_shape(which, index);
        }
        if which < 11u32 {
            return probe_light(which - 6u32, index);
        }
        let normal = random_direction(index, 32);
        let mut wo = random_direction(index, 33);
        if dot(wo, normal) < 0.0 {
            wo = -wo;
        }
        if which == 11u32 {
            let sample = sample_bsdf(random_bsdf(index), normal, wo, vec2f(r.x, r.y));
            return spread(sample.direction, f32(sample.event));
        }
        if which == 12u32 {
            let wi = random_direction(index, 34);
            let bsdf = random_bsdf(index);
            return spread(evaluate_bsdf(bsdf, normal, wo, wi), bsdf_pdf(bsdf, normal, wo, wi));
        }
        if which == 13u32 {
            return spread(
                tone_map(vec3f(r.x, r.y, r.z) * 1.2, r.w - 0.5),
                unit_float(pcg4d(vec4u(index, 1, 2, 3)).x),
            );
        }
        if which == 14u32 {
            let p = pixel_position(key, 3);
            return vec4f(p.x, p.y, power_heuristic(r.x, r.y), spot_profile(r.z, 0.8, 0.3));
        }
        if which == 15u32 {
            // A cell of 1/64, boxes anywhere on the grid.
            let a = pcg4d(vec4u(index, 35, 0, 0));
            let b = pcg4d(vec4u(index, 36, 0, 0));
            let c = pcg4d(vec4u(index, 37, 0, 0));
            let node = BvhNode {
                origin: random_point(index, 38),
                exponents: 7960953u32 | (a.x & 4278190080u32),
                first_node: 100,
                first_object: 200,
                leaves: 0,
                unused: 0,
                low_xy: a & vec4u(2139062143, 2139062143, 2139062143, 2139062143),
                low_z_high_x: b | vec4u(0, 0, 2155905152, 2155905152),
                high_yz: c | vec4u(2155905152, 2155905152, 2155905152, 2155905152),
            };
            let inverse = inverse_direction(normal);
            let order = visiting_order(inverse);
            let reached = reached_boxes(node, random_point(index, 39), inverse, 3.0 * r.x);
            let waiting = waiting_children(node, reached, order);
            return vec4f(
                f32(reached),
                f32(waiting.y & 255u32),
                f32(next_node(waiting, order)),
                inverse.x * normal.x,
            );
        }
        if which == 16u32 {
            return probe_light(LIGHT_SUN, index);
        }
        if which == 17u32 {
            let light = random_light(index, LIGHT_GROUP);
            let a_to_d = vec4f(-1.0 - r.x, -0.3 - r.y, 5.0 * r.z, -2.5);
            let sky = perez(a_to_d, r.w, 1.0 / (0.1 + r.x), 3.0 * r.y);
            let color = rgb_from_xyz(vec3f(r.x, r.y, r.z));
            return vec4f(light_importance(light, random_point(index, 29)), sky, color.x, color.z);
        }
        spread(power_cosine(vec2f(r.x, r.y), r.z * 100.0), power_cosine_pdf(r.w, r.z * 100.0))
    }

    #[compute]
    #[workgroup_size(64)]
    pub fn run_probes(#[builtin(global_invocation_id)] id: Vec3u) {
        get_mut!(RESULTS)[(id.y * INPUTS + id.x) as usize] = probe(id.y, id.x);
    }
}

#[test]
fn every_function_gives_the_same_on_both_devices() {
    use probes::{INPUTS, PROBES};
    let Some((device, queue)) = any_wgpu_device() else { return };
    let source = probes::WGSL_SOURCE.wgsl_source().unwrap();
    let results = run_wgsl(&device, &queue, &source, "run_probes", (INPUTS / 64, PROBES), PROBES * INPUTS);
    for which in 0..PROBES {
        let different = (0..INPUTS)
            .filter(|&index| {
                let cpu = probes::probe(which, index).to_array();
                let gpu = results[(which * INPUTS + index) as usize];
                // Functions of several operations; the two libraries round sin, pow and so on differently.
                (0..4).any(|c| (cpu[c] - gpu[c]).abs() > 1e-3 * (1.0 + cpu[c].abs()))
            })
            .count();
        // Inputs at a threshold may take the other branch.
        assert!(different * 500 <= INPUTS as usize, "probe {which}: {different} of {INPUTS} differ");
    }
}

/// As `probes`, for samplers and filters.
// Rust never calls the entry point; the graphics card does.
#[allow(dead_code)]
#[wgsl]
pub mod sampling_probes {
    use kernels::camera::kernel::*;
    use kernels::random::kernel::*;
    use kernels::reconstruction::kernel::*;
    use kernels::records::kernel::*;
    use kernels::sobol::kernel::*;
    use wgsl_rs::std::*;

    storage!(group(0), binding(0), read_write, RESULTS: RuntimeArray<Vec4f>);

    /// Integers alone: equal to the last bit.
    pub const EXACT_PROBES: u32 = 5;
    pub const PROBES: u32 = 9;
    pub const INPUTS: u32 = 4096;

    pub fn random_settings(index: u32, sampler: u32) -> LaunchSettings {
        let bits = pcg4d(vec4u(index, 5, 6, 7));
        LaunchSettings {
            width: 1u32 + (bits.x >> 16u32),
            height: 1000,
            tile_x: 0,
            tile_y: 0,
            tile_width: 1,
            tile_height: 1,
            first_sample: 0,
            samples: 1,
            seed: bits.y,
            grid: 1,
            depth: 1,
            renderer: RENDERER_PATH_TRACER,
            background: vec3f(0.0, 0.0, 0.0),
            shadow_samples: 1,
            sampler,
            sequence_bits: bits.z % (MAX_SEQUENCE_BITS + 1u32),
            reconstruction: 0,
            counted: 0,
        }
    }

    /// Numbers of 32 bits do not fit into floats.
    pub fn halves(a: u32, b: u32) -> Vec4f {
        vec4f(f32(a >> 16u32), f32(a & 65535u32), f32(b >> 16u32), f32(b & 65535u32))
    }

    pub fn probe(which: u32, index: u32) -> Vec4f {
        let bits = pcg4d(vec4u(index, 1, 2, 3));
        let key = sample_key(
            random_settings(index, SAMPLER_SOBOL),
            bits.x % 5000u32,
            bits.y % 5000u32,
            bits.z >> (bits.w % 32u32),
        );
        if which == 0u32 {
            return halves(key.index, key.index_mask);
        }
        if which == 1u32 {
            return halves(key.scramble, z_order(bits.x & 15u32, bits.y & 15u32, bits.z));
        }
        if which == 2u32 {
            let point = scrambled_sobol4(bits.x, bits);
            return halves(point.y ^ point.x, point.z ^ point.w);
        }
        if which == 3u32 {
            return random4(key, bits.w % 100u32);
        }
        if which == 4u32 {
            return random4(independent_key(bits.x, bits.y, bits.z), bits.w);
        }
        let u = vec2f(unit_float(bits.x), unit_float(bits.y));
        if which < 8u32 {
            let p = filter_position(which - 4u32, u);
            return vec4f(p.x, p.y, 0.0, 0.0);
        }
        let p = concentric_disc(u);
        vec4f(p.x, p.y, dot(p, p), 0.0)
    }

    #[compute]
    #[workgroup_size(64)]
    pub fn run_probes(#[builtin(global_invocation_id)] id: Vec3u) {
        get_mut!(RESULTS)[(id.y * INPUTS + id.x) as usize] = probe(id.y, id.x);
    }
}

#[test]
fn samplers_are_the_same_bit_for_bit_on_both_devices_and_filters_nearly() {
    use sampling_probes::{EXACT_PROBES, INPUTS, PROBES};
    let Some((device, queue)) = any_wgpu_device() else { return };
    let source = sampling_probes::WGSL_SOURCE.wgsl_source().unwrap();
    let results = run_wgsl(&device, &queue, &source, "run_probes", (INPUTS / 64, PROBES), PROBES * INPUTS);
    for which in 0..PROBES {
        for index in 0..INPUTS {
            let cpu = sampling_probes::probe(which, index).to_array();
            let gpu = results[(which * INPUTS + index) as usize];
            if which < EXACT_PROBES {
                assert_eq!(cpu, gpu, "probe {which} of {index}");
            }
            // In the tails of the window a rounding error of its integral is far in place, but rarely.
            let far = (0..4).any(|c| (cpu[c] - gpu[c]).abs() > 2e-3);
            assert!(!far, "probe {which} of {index}: {cpu:?} {gpu:?}");
        }
    }
}

fn any_wgpu_device() -> Option<(wgpu::Device, wgpu::Queue)> {
    gpu()?;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter =
        pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).unwrap();
    Some(pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).unwrap())
}

/// Runs a compute entry point that fills one storage buffer of `count` vectors.
fn run_wgsl(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &str,
    entry_point: &str,
    workgroups: (u32, u32),
    count: u32,
) -> Vec<[f32; 4]> {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some(entry_point),
        compilation_options: Default::default(),
        cache: None,
    });
    let size = u64::from(count) * 16;
    let results = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: &vec![0; size as usize],
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
    });
    let readback = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: results.as_entire_binding() }],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bindings, &[]);
        pass.dispatch_workgroups(workgroups.0, workgroups.1, 1);
    }
    encoder.copy_buffer_to_buffer(&results, 0, &readback, 0, size);
    queue.submit([encoder.finish()]);
    readback.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let view = readback.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&view[..])
}

/// Renders on both devices and compares pixel by pixel and in the mean.
fn assert_same_picture(scene: &scene::Scene, settings: &RenderSettings) {
    let Some(gpu) = gpu() else { return };
    let cpu = render(scene, settings);
    let gpu = render_on(&gpu, scene, settings);
    assert_eq!(cpu.samples(), gpu.samples());
    // The same random numbers: most pixels agree to rounding, some paths take another turn.
    let far = |a: &FilmPixel, b: &FilmPixel| {
        (a.radiance.x - b.radiance.x).abs() > 1e-3 * (a.radiance.x.abs() + 1e-3)
    };
    let different = cpu.pixels.iter().zip(&gpu.pixels).filter(|(a, b)| far(a, b)).count();
    assert!(different * 10 < cpu.pixels.len(), "{different} of {} pixels differ", cpu.pixels.len());
    // And the means agree within the noise that both predict.
    let ((mean_cpu, error_cpu), (mean_gpu, error_gpu)) = (mean_and_error(&cpu), mean_and_error(&gpu));
    for c in 0..3 {
        let error = error_cpu[c].hypot(error_gpu[c]);
        assert!((mean_cpu[c] - mean_gpu[c]).abs() < 5.0 * error, "{mean_cpu:?} {mean_gpu:?}");
    }
}

#[test]
fn a_garden_of_all_shapes_and_cut_out_leaves_is_the_same_picture() {
    assert_same_picture(&garden(), &settings(80, 60, 16, 4));
}

#[test]
fn many_lights_are_the_same_picture() {
    let mut b = Builder::new();
    let ground = b.diffuse([0.5, 0.4, 0.3]);
    let red = b.diffuse([0.8, 0.2, 0.2]);
    let black = b.diffuse([0.0; 3]);
    b.object(Shape::Plane, at(0.0, 0.0, 0.0), ground);
    for i in 0..12 {
        let x = f64::from(i % 4) - 1.5;
        let y = f64::from(i / 4) - 1.0;
        b.object(Shape::Sphere { radius: 0.3 }, at(x, y, 0.3), red);
    }
    b.rectangle(DVec3::new(0.0, 0.0, 4.0), (1.0, 1.0), false, black).emission =
        Some(scene::Emission { power: [60.0; 3], exponent: 1.0, shadowless: false });
    b.light(LightKind::Point { power: [50.0; 3] }, at(2.0, -2.0, 3.0));
    b.sky([0.1, 0.15, 0.2]);
    b.look(DVec3::new(0.0, -5.0, 3.0), DVec3::ZERO, DVec3::Z, 50.0);

    // 200 pixels wide, so that the software adapter needs more than one tile.
    assert_same_picture(&b.scene, &settings(200, 72, 16, 4));
}
