//! Radiance along rays of the caller's choice, for measurements that no picture makes.

use crate::cpu::{Cpu, Slices};
use crate::{CompiledScene, RenderSettings};
use kernels::camera::kernel::CameraSample;
use kernels::pixel::kernel::trace_sample;
use kernels::random::kernel::{DIMENSION_PIXEL, random4, sample_key};
use kernels::records::kernel::LaunchSettings;
use kernels::shape::kernel::Ray;
use rayon::prelude::*;
use scene::{DVec3, Rgb};

/// A line of sight: light that arrives at its origin against its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldRay {
    /// In the world, in metres. On a surface it must be a little before it, else the ray may meet that surface.
    pub origin: DVec3,
    /// In the world; any length but 0.
    pub direction: DVec3,
}

/// Rays are numbered row by row as the pixels of a picture of this width.
const WIDTH: u32 = 1 << 16;

impl Cpu {
    /// Radiance in W/(m² sr) that arrives at the origin of every ray from where it points: the mean of
    /// [`RenderSettings::samples`] independent estimates, by the renderer and at the depth of the settings. Size,
    /// crop window and filter are of no account. The result depends on the scene, the settings and the ray's
    /// position in the list alone.
    ///
    /// A ray sees what a camera would see: lamps with a body and the sky, but no lights without a body. What those
    /// shed on surfaces is part of the surfaces' radiance.
    pub fn radiance_along(
        &self,
        scene: &CompiledScene,
        settings: &RenderSettings,
        rays: &[WorldRay],
    ) -> Vec<Rgb> {
        let slices = Slices::of(scene);
        let launch = LaunchSettings { width: WIDTH, ..settings.launch() };
        let along = |(number, ray): (usize, &WorldRay)| {
            // More rays than 32 bits can count repeat the random numbers of the first ones.
            let number = (number % (1 << 32)) as u32;
            let [x, y, z] = (ray.origin - scene.origin).to_array().map(|value| value as f32);
            let [dx, dy, dz] = ray.direction.normalize_or_zero().to_array().map(|value| value as f32);
            let first =
                Ray { origin: wgsl_rs::std::vec3f(x, y, z), direction: wgsl_rs::std::vec3f(dx, dy, dz) };
            let mut sum = [0.0; 3];
            for sample in 0..settings.samples {
                let key = sample_key(launch, number % WIDTH, number / WIDTH, sample);
                let u = random4(key, DIMENSION_PIXEL);
                let start = CameraSample { ray: first, light_numbers: wgsl_rs::std::vec2f(u.z, u.w) };
                let radiance = trace_sample(slices, launch, key, start).radiance.to_array();
                for (sum, value) in sum.iter_mut().zip(radiance) {
                    *sum += f64::from(value);
                }
            }
            sum.map(|sum| sum / f64::from(settings.samples.max(1)))
        };
        self.threads.install(|| rays.par_iter().enumerate().map(along).collect())
    }
}
