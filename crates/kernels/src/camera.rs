//! Rays from the camera into the scene.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::random::kernel::*;
    use crate::reconstruction::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use wgsl_rs::std::*;

    /// The ray through a point of the picture and the middle of the lens; `x` and `y` in pixels from the top left.
    pub fn camera_ray(header: SceneHeader, settings: LaunchSettings, x: f32, y: f32) -> Ray {
        lens_ray(header, settings, x, y, vec2f(0.0, 0.0))
    }

    /// The ray through a point of the picture and a point of the lens, whose radius is 1 here.
    ///
    /// Thin lens: all rays of a point of the picture meet in the plane of focus, which is perpendicular to the
    /// view. Parallel projection: so do bundles whose middle rays are parallel (a telecentric lens).
    pub fn lens_ray(header: SceneHeader, settings: LaunchSettings, x: f32, y: f32, lens: Vec2f) -> Ray {
        let width = f32(settings.width);
        let image_x = (2.0 * x - width) / width * header.view_scale_x;
        let image_y = (f32(settings.height) - 2.0 * y) / width * header.view_scale_y;
        let shift = lens * header.lens_radius;
        // By how much the shifted rays converge per metre.
        let slope = shift * header.vergence;
        if header.camera == CAMERA_PARALLEL {
            let start = shift + slope * header.start_distance;
            return Ray {
                origin: transform_point(
                    header.world_from_view,
                    vec3f(image_x + start.x, image_y + start.y, header.start_distance),
                ),
                direction: normalize(transform_vector(
                    header.world_from_view,
                    vec3f(-slope.x, -slope.y, -1.0),
                )),
            };
        }
        let direction = vec3f(image_x - slope.x, image_y - slope.y, -1.0);
        Ray {
            origin: transform_point(header.world_from_view, vec3f(shift.x, shift.y, 0.0)),
            direction: normalize(transform_vector(header.world_from_view, direction)),
        }
    }

    /// A point of the unit disc, uniformly distributed; squares around the middle become discs, so that strata stay
    /// compact (Shirley and Chiu, "A Low Distortion Map Between Disk and Square", 1997).
    pub fn concentric_disc(u: Vec2f) -> Vec2f {
        let a = 2.0 * u.x - 1.0;
        let b = 2.0 * u.y - 1.0;
        if a == 0.0 && b == 0.0 {
            return vec2f(0.0, 0.0);
        }
        let quarter_pi: f32 = 0.785398163397448;
        if abs(a) > abs(b) {
            let angle = quarter_pi * (b / a);
            return vec2f(a * cos(angle), a * sin(angle));
        }
        let angle = quarter_pi * (a / b);
        vec2f(b * sin(angle), b * cos(angle))
    }

    /// Where a path starts.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct CameraSample {
        pub ray: Ray,
        /// Two numbers in [0, 1) that are well distributed together with the place in the pixel: for the light at the
        /// first surface, because shadows in a pixel depend on both.
        pub light_numbers: Vec2f,
    }

    /// Where the path of a sample starts: its ray goes through a point around the middle of its pixel, drawn with the
    /// reconstruction filter as density, and a point of the lens. `x` and `y` are the pixel's, from the top left of the whole picture.
    pub fn sample_camera(
        header: SceneHeader,
        settings: LaunchSettings,
        key: SampleKey,
        x: u32,
        y: u32,
    ) -> CameraSample {
        let numbers = camera_numbers(key, settings.grid);
        let position = filter_position(settings.reconstruction, vec2f(numbers.x, numbers.y));
        let mut lens = vec2f(0.0, 0.0);
        if header.lens_radius > 0.0 {
            let u = random4(key, DIMENSION_LENS);
            lens = concentric_disc(vec2f(u.x, u.y));
        }
        CameraSample {
            ray: lens_ray(header, settings, f32(x) + position.x, f32(y) + position.y, lens),
            light_numbers: vec2f(numbers.z, numbers.w),
        }
    }
}
