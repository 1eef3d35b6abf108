use glam::{DAffine3, DMat3, DVec3};

/// Where a picture is taken from.
///
/// View space: x right, y up, the camera looks along -z (as in GroIMP and OpenGL).
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// World-to-view transformation; a rigid motion as a rule.
    pub view_from_world: DAffine3,
    /// How view space is mapped to the picture.
    pub projection: Projection,
    /// Blurs what is out of focus; `None` draws everything sharply.
    pub lens: Option<Lens>,
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of its opening in metres, at least 0.
    pub radius: f64,
    /// Distance of the plane that is drawn sharply, in metres along the view direction, positive. `None` for the
    /// surface that the middle of the picture shows.
    pub focus: Option<f64>,
}

/// How view space is mapped to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays start at the eye.
    Perspective {
        /// Horizontal opening angle in radians, in (0, pi).
        fov_x: f64,
        /// Divides the vertical scale; 1 for square pixels.
        aspect: f64,
    },
    /// All rays are parallel to the view direction.
    Parallel {
        /// Horizontal extent of the picture in metres.
        width: f64,
        /// Divides the vertical scale; 1 for square pixels.
        aspect: f64,
    },
}

impl Default for Camera {
    /// GroIMP's default view: from 45 degrees above, 8 m away, 60 degrees wide.
    fn default() -> Self {
        let c = std::f64::consts::FRAC_1_SQRT_2;
        let rows = DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, -c), DVec3::new(0.0, c, c));
        Camera {
            view_from_world: DAffine3::from_mat3_translation(rows, DVec3::new(0.0, 0.0, -8.0)),
            projection: Projection::Perspective { fov_x: std::f64::consts::FRAC_PI_3, aspect: 1.0 },
            lens: None,
        }
    }
}

impl Camera {
    /// A perspective camera at `eye` that looks at `target`; `up` fixes which way is up in the picture.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, fov_x: f64) -> Self {
        let backward = (eye - target).normalize();
        let right = up.cross(backward).normalize();
        let world_from_view =
            DAffine3::from_mat3_translation(DMat3::from_cols(right, backward.cross(right), backward), eye);
        Camera {
            view_from_world: world_from_view.inverse(),
            projection: Projection::Perspective { fov_x, aspect: 1.0 },
            lens: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_camera_sees_the_origin_eight_metres_away() {
        let point_view = Camera::default().view_from_world.transform_point3(DVec3::ZERO);
        assert!((point_view - DVec3::new(0.0, 0.0, -8.0)).length() < 1e-12);
    }

    #[test]
    fn look_at_puts_the_target_on_the_axis() {
        let camera = Camera::look_at(DVec3::new(3.0, -2.0, 1.0), DVec3::new(1.0, 1.0, 1.0), DVec3::Z, 1.0);
        let target_view = camera.view_from_world.transform_point3(DVec3::new(1.0, 1.0, 1.0));
        assert!((target_view - DVec3::new(0.0, 0.0, -(13.0f64.sqrt()))).length() < 1e-12);
        assert!(camera.view_from_world.transform_vector3(DVec3::Z).y > 0.99);
    }
}
