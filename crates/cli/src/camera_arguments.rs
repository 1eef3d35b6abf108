//! Options that change the saved view.

use crate::failure::Failure;
use clap::Args;
use scene::{Camera, DVec3, Lens, Projection, Scene};

/// Camera options of `sunshine render`; what is not given stays as it was saved.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Camera")]
pub struct CameraArguments {
    /// Where the camera stands, in metres; it goes on looking at the same point. In parallel projection any point
    /// of the line of sight
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_point)]
    pub camera_position: Option<DVec3>,

    /// The point in the middle of the picture, in metres; a saved view has none, so the point of its line of sight
    /// nearest to the middle of the scene stands in
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_point)]
    pub camera_target: Option<DVec3>,

    /// The direction that is upwards in the picture [default: 0,0,1 if the camera is moved or turned]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_point)]
    pub camera_up: Option<DVec3>,

    /// Horizontal opening angle of the picture in degrees, in perspective
    #[arg(long, value_name = "DEGREES", value_parser = parse_angle, conflicts_with = "parallel")]
    pub fov: Option<f64>,

    /// Parallel projection with a picture that is this many metres wide
    #[arg(long, value_name = "METRES", value_parser = parse_length)]
    pub parallel: Option<f64>,

    /// Radius of the lens in metres: the larger, the more is blurred what is not in focus
    #[arg(long, value_name = "METRES", value_parser = parse_length)]
    pub aperture: Option<f64>,

    /// Distance from the camera that is in focus, in metres [default: that of --camera-target, else of what the
    /// middle of the picture shows]
    #[arg(long, value_name = "METRES", value_parser = parse_length, requires = "aperture")]
    pub focus: Option<f64>,
}

impl CameraArguments {
    /// What gives this camera, whatever the saved one is; `target` is a point that it looks at.
    pub fn placing(camera: &Camera, target: DVec3) -> Self {
        let world = camera.view_from_world.inverse();
        let (fov, parallel) = match camera.projection {
            Projection::Perspective { fov_x, .. } => (Some(fov_x.to_degrees()), None),
            Projection::Parallel { width, .. } => (None, Some(width)),
        };
        CameraArguments {
            camera_position: Some(world.translation),
            camera_target: Some(target),
            camera_up: Some(world.matrix3.y_axis),
            fov,
            parallel,
            aperture: camera.lens.map(|lens| lens.radius),
            focus: camera.lens.and_then(|lens| lens.focus),
        }
    }

    /// The options as they were given.
    #[cfg(feature = "view")]
    pub fn words(&self) -> Vec<String> {
        self.options().into_iter().flat_map(|(name, value)| [format!("--{name}"), value]).collect()
    }

    /// Changes the camera of a scene.
    ///
    /// # Errors
    /// If position, target and up do not make a view.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), Failure> {
        let moved = self.camera_position.or(self.camera_target).or(self.camera_up).is_some();
        if moved {
            let (eye, target) = self.line_of_sight(scene);
            self.turn(&mut scene.camera, eye, target)?;
        }
        let projection = &mut scene.camera.projection;
        let (Projection::Perspective { aspect, .. } | Projection::Parallel { aspect, .. }) = *projection;
        if let Some(degrees) = self.fov {
            *projection = Projection::Perspective { fov_x: degrees.to_radians(), aspect };
        }
        if let Some(width) = self.parallel {
            *projection = Projection::Parallel { width, aspect };
        }
        if let Some(radius) = self.aperture {
            let to_target = self.camera_target.map(|target| distance_along_view(&scene.camera, target));
            scene.camera.lens = Some(Lens { radius, focus: self.focus.or(to_target) });
        }
        Ok(())
    }

    /// What is given, as options without dashes and their values.
    pub fn options(&self) -> Vec<(&'static str, String)> {
        let CameraArguments { camera_position, camera_target, camera_up, fov, parallel, aperture, focus } =
            self;
        let points = [
            ("camera-position", camera_position),
            ("camera-target", camera_target),
            ("camera-up", camera_up),
        ];
        let numbers = [("fov", fov), ("parallel", parallel), ("aperture", aperture), ("focus", focus)];
        let points = points.into_iter().filter_map(|(name, point)| {
            (*point).map(|point| (name, format!("{},{},{}", point.x, point.y, point.z)))
        });
        let numbers = numbers.into_iter().filter_map(|(name, number)| Some((name, (*number)?.to_string())));
        points.chain(numbers).collect()
    }

    /// Where the camera will stand and at what it will look.
    pub fn line_of_sight(&self, scene: &Scene) -> (DVec3, DVec3) {
        let saved = scene.camera.view_from_world.inverse();
        let eye = saved.translation;
        let forward = -saved.matrix3.z_axis.normalize_or(DVec3::NEG_Z);
        let saved_target = || {
            let middle = scene.bounds().map(|(low, high)| 0.5 * (low + high));
            let distance =
                middle.map(|middle| (middle - eye).dot(forward)).filter(|distance| *distance > 0.0);
            eye + forward * distance.unwrap_or(1.0)
        };
        (self.camera_position.unwrap_or(eye), self.camera_target.unwrap_or_else(saved_target))
    }

    fn turn(&self, camera: &mut Camera, eye: DVec3, target: DVec3) -> Result<(), Failure> {
        let forward = (target - eye).try_normalize().ok_or_else(|| {
            usage("the camera stands where it looks at; give --camera-target or --camera-position")
        })?;
        let saved_up = camera.view_from_world.inverse().matrix3.y_axis;
        let candidates = match self.camera_up {
            Some(up) => vec![up],
            // Upwards as in GroIMP; straight up and down the saved view tells.
            None => vec![DVec3::Z, saved_up, DVec3::Y],
        };
        let up = candidates
            .into_iter()
            .find(|up| forward.cross(up.normalize_or_zero()).length() > 1e-6)
            .ok_or_else(|| usage("--camera-up must not be zero or point along the line of sight"))?;
        // The angle does not matter: the projection stays.
        camera.view_from_world = Camera::look_at(eye, target, up, 1.0).view_from_world;
        Ok(())
    }
}

fn usage(message: &str) -> Failure {
    Failure::Usage(message.to_owned())
}

/// Distance of a point in front of the camera, or of the camera's plane if it lies behind.
fn distance_along_view(camera: &Camera, point: DVec3) -> f64 {
    (-camera.view_from_world.transform_point3(point).z).max(1e-6)
}

fn parse_point(text: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let point = match numbers.as_deref() {
        Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
        _ => None,
    };
    // Larger numbers are no metres, and their squares overflow in 32 bits.
    point
        .filter(|point| point.is_finite() && point.abs().max_element() <= 1e9)
        .ok_or_else(|| "expected three numbers with commas between, for example 0,-2.5,1".to_owned())
}

fn parse_angle(text: &str) -> Result<f64, String> {
    let degrees = text.trim().parse().ok().filter(|degrees: &f64| *degrees >= 0.001 && *degrees <= 179.0);
    degrees.ok_or_else(|| "expected an angle in degrees from 0.001 to 179".to_owned())
}

fn parse_length(text: &str) -> Result<f64, String> {
    let metres = text.trim().parse().ok().filter(|metres: &f64| *metres >= 1e-9 && *metres <= 1e9);
    metres.ok_or_else(|| "expected a length in metres, greater than 0, for example 0.01".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE: DVec3 = DVec3::new(0.0, -5.0, 1.0);

    fn changed(arguments: &CameraArguments) -> Camera {
        let mut scene = Scene { camera: Camera::look_at(EYE, DVec3::Z, DVec3::Z, 1.0), ..Scene::default() };
        arguments.apply(&mut scene).unwrap();
        scene.camera
    }

    /// Where a point lies in view space.
    fn seen(camera: &Camera, point: DVec3) -> DVec3 {
        camera.view_from_world.transform_point3(point)
    }

    #[test]
    fn nothing_given_changes_nothing() {
        assert_eq!(changed(&CameraArguments::default()), Camera::look_at(EYE, DVec3::Z, DVec3::Z, 1.0));
    }

    #[test]
    fn a_position_alone_keeps_the_target_and_a_target_alone_the_position() {
        // An empty scene has no middle: the target is 1 m ahead, at (0, -4, 1).
        let position = Some(DVec3::new(3.0, -4.0, 1.0));
        let camera = changed(&CameraArguments { camera_position: position, ..Default::default() });
        assert!((seen(&camera, DVec3::new(0.0, -4.0, 1.0)) - DVec3::new(0.0, 0.0, -3.0)).length() < 1e-12);
        assert!((camera.view_from_world.transform_vector3(DVec3::Z) - DVec3::Y).length() < 1e-12);

        let target = DVec3::new(2.0, -5.0, 1.0);
        let camera = changed(&CameraArguments { camera_target: Some(target), ..Default::default() });
        assert!(seen(&camera, EYE).length() < 1e-12);
        assert!((seen(&camera, target) - DVec3::new(0.0, 0.0, -2.0)).length() < 1e-12);
        assert_eq!(camera.projection, Projection::Perspective { fov_x: 1.0, aspect: 1.0 });
    }

    #[test]
    fn looking_straight_down_and_turning_the_picture_are_possible() {
        let down = CameraArguments {
            camera_position: Some(DVec3::new(0.0, 0.0, 9.0)),
            camera_target: Some(DVec3::ZERO),
            ..Default::default()
        };
        // Upwards in the saved view was the z axis too: the y axis stands in.
        assert!((seen(&changed(&down), DVec3::Y) - DVec3::new(0.0, 1.0, -9.0)).length() < 1e-12);
        let turned = CameraArguments { camera_up: Some(DVec3::X), ..down };
        assert!((seen(&changed(&turned), DVec3::X) - DVec3::new(0.0, 1.0, -9.0)).length() < 1e-12);
        for wrong in [DVec3::ZERO, DVec3::NEG_Z] {
            let arguments = CameraArguments { camera_up: Some(wrong), ..turned.clone() };
            assert!(matches!(arguments.apply(&mut Scene::default()), Err(Failure::Usage(_))));
        }
        let nowhere = CameraArguments { camera_target: Some(EYE), camera_position: Some(EYE), ..down };
        assert!(matches!(nowhere.apply(&mut Scene::default()), Err(Failure::Usage(_))));
    }

    #[test]
    fn projections_replace_each_other() {
        let camera = changed(&CameraArguments { parallel: Some(2.5), ..Default::default() });
        assert_eq!(camera.projection, Projection::Parallel { width: 2.5, aspect: 1.0 });
        let camera = changed(&CameraArguments { fov: Some(90.0), ..Default::default() });
        let fov_x = std::f64::consts::FRAC_PI_2;
        assert_eq!(camera.projection, Projection::Perspective { fov_x, aspect: 1.0 });
    }

    #[test]
    fn the_lens_is_focused_on_the_target_unless_told_otherwise() {
        let aperture = CameraArguments { aperture: Some(0.1), ..Default::default() };
        assert_eq!(changed(&aperture).lens, Some(Lens { radius: 0.1, focus: None }));
        let target = CameraArguments { camera_target: Some(DVec3::new(0.0, -1.0, 1.0)), ..aperture.clone() };
        assert_eq!(changed(&target).lens, Some(Lens { radius: 0.1, focus: Some(4.0) }));
        let given = CameraArguments { focus: Some(3.0), ..target };
        assert_eq!(changed(&given).lens, Some(Lens { radius: 0.1, focus: Some(3.0) }));
    }

    #[test]
    fn points() {
        assert_eq!(parse_point("-1, 2.5,3e2"), Ok(DVec3::new(-1.0, 2.5, 300.0)));
        for wrong in ["", "1,2", "1,2,3,4", "a,b,c", "1,2,nan", "1,2,inf", "1,2,1e10"] {
            assert!(parse_point(wrong).is_err(), "{wrong}");
        }
    }
}
