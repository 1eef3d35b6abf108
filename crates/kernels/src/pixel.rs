//! The samples of a pixel, by either renderer.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::camera::kernel::*;
    use crate::path::kernel::*;
    use crate::random::kernel::*;
    use crate::raytrace::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use wgsl_rs::std::*;

    /// What one path brings home.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct PathSample {
        /// In W/(m² sr) per channel.
        pub radiance: Vec3f,
        /// Rays traced, shadow rays included.
        pub rays: u32,
    }

    /// A sample of the renderer of the settings that starts at the camera.
    pub fn trace_sample<S: SceneAccess + Copy>(
        scene: S,
        settings: LaunchSettings,
        key: SampleKey,
        start: CameraSample,
    ) -> PathSample {
        if settings.renderer == RENDERER_RAY_TRACER {
            let traced = trace_rays::<S>(scene, settings, key, start.ray);
            return PathSample { radiance: traced.radiance, rays: traced.rays };
        }
        let mut path = start_path(start);
        while path.goes_on {
            path = extend_path::<S>(scene, key, settings.depth, settings.background, path);
        }
        PathSample { radiance: path.radiance, rays: path.rays }
    }

    /// A path that has just started, and the key of its sample.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct StartedPath {
        pub key: SampleKey,
        pub path: PathState,
    }

    /// The path of a sample of a pixel, given the key of another sample of that pixel.
    pub fn start_sample(
        header: SceneHeader,
        settings: LaunchSettings,
        x: u32,
        y: u32,
        other: SampleKey,
        sample: u32,
    ) -> StartedPath {
        let key = key_of_sample(settings, x, y, other, sample);
        StartedPath { key, path: start_path(sample_camera(header, settings, key, x, y)) }
    }

    /// The sum of a pixel with one sample more.
    pub fn add_sample(before: FilmPixel, radiance: Vec3f, rays: u32) -> FilmPixel {
        let mut film = before;
        film.radiance += radiance;
        film.squares += radiance * radiance;
        film.rays += rays;
        film
    }

    /// Adds samples of the path tracer to a pixel.
    ///
    /// One loop over the segments of all paths: where a path ends the next one starts, so that neighbouring
    /// threads of a graphics card, whose paths have other lengths, do not wait for each other.
    pub fn add_path_samples<S: SceneAccess + Copy>(
        scene: S,
        settings: LaunchSettings,
        x: u32,
        y: u32,
        count: u32,
        before: FilmPixel,
    ) -> FilmPixel {
        let header = S::header(scene);
        let mut film = before;
        let mut started: u32 = 0;
        let mut key = sample_key(settings, x, y, settings.first_sample);
        let nowhere = Ray { origin: vec3f(0.0, 0.0, 0.0), direction: vec3f(0.0, 0.0, 1.0) };
        let mut path = start_path(CameraSample { ray: nowhere, light_numbers: vec2f(0.0, 0.0) });
        path.goes_on = false;
        while started < count || path.goes_on {
            if !path.goes_on {
                let start = start_sample(header, settings, x, y, key, settings.first_sample + started);
                key = start.key;
                path = start.path;
                started += 1;
            }
            path = extend_path::<S>(scene, key, settings.depth, settings.background, path);
            if !path.goes_on {
                film = add_sample(film, path.radiance, path.rays);
            }
        }
        film
    }

    /// Adds samples of the ray tracer to a pixel.
    pub fn add_ray_samples<S: SceneAccess + Copy>(
        scene: S,
        settings: LaunchSettings,
        x: u32,
        y: u32,
        count: u32,
        before: FilmPixel,
    ) -> FilmPixel {
        let header = S::header(scene);
        let mut film = before;
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..count {
            let key = sample_key(settings, x, y, settings.first_sample + i);
            let ray = sample_camera(header, settings, key, x, y).ray;
            let traced = trace_rays::<S>(scene, settings, key, ray);
            film = add_sample(film, traced.radiance, traced.rays);
        }
        film
    }

    /// Adds samples of the renderer of the settings. Graphics cards have a program for each renderer, in which one
    /// of the two functions above stands in for this one.
    pub fn add_samples<S: SceneAccess + Copy>(
        scene: S,
        settings: LaunchSettings,
        x: u32,
        y: u32,
        count: u32,
        before: FilmPixel,
    ) -> FilmPixel {
        if settings.renderer == RENDERER_RAY_TRACER {
            return add_ray_samples::<S>(scene, settings, x, y, count, before);
        }
        add_path_samples::<S>(scene, settings, x, y, count, before)
    }

    /// Adds samples to a pixel of the picture; `x` and `y` count from the top left.
    pub fn render_pixel<S: SceneAccess + Copy>(
        scene: S,
        settings: LaunchSettings,
        x: u32,
        y: u32,
        before: FilmPixel,
    ) -> FilmPixel {
        let count = launched_samples(settings, before.samples);
        let mut film = add_samples::<S>(scene, settings, x, y, count, before);
        if settings.counted == 0u32 {
            film.samples += count;
        }
        film
    }
}
