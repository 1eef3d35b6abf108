//! Rays from the camera into the scene.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use wgsl_rs::std::*;

    /// The ray through a point of the picture; `x` and `y` in pixels from the top left.
    pub fn camera_ray(header: SceneHeader, settings: LaunchSettings, x: f32, y: f32) -> Ray {
        let width = f32(settings.width);
        let image_x = (2.0 * x - width) / width * header.view_scale_x;
        let image_y = (f32(settings.height) - 2.0 * y) / width * header.view_scale_y;
        if header.camera == CAMERA_PARALLEL {
            let start = vec3f(image_x, image_y, header.start_distance);
            return Ray {
                origin: transform_point(header.world_from_view, start),
                direction: normalize(transform_vector(header.world_from_view, vec3f(0.0, 0.0, -1.0))),
            };
        }
        let direction = vec3f(image_x, image_y, -1.0);
        Ray {
            origin: transform_point(header.world_from_view, vec3f(0.0, 0.0, 0.0)),
            direction: normalize(transform_vector(header.world_from_view, direction)),
        }
    }
}
