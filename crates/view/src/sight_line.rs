//! A camera as one moves it: an eye, the point that it looks at, and how it turns round that point.

use scene::{Camera, DVec3, Lens, Projection};

/// Where the camera stands and what it looks at. All numbers are such that they print short: a camera that is read
/// back from the printed numbers is exactly this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SightLine {
    /// Where the camera stands, in the world in metres.
    pub eye: DVec3,
    /// The point in the middle of the picture; what the camera turns round.
    pub middle: DVec3,
    /// The direction that is upwards in the picture.
    pub up: DVec3,
    /// How much is seen.
    pub extent: Extent,
    /// Divides the vertical scale; 1 for square pixels.
    pub aspect: f64,
    /// Radius of the lens in metres, and the distance in focus; `None` for that of `middle`.
    pub lens: Option<(f64, Option<f64>)>,
}

/// How much a camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Perspective: the horizontal opening angle in degrees.
    Degrees(f64),
    /// Parallel projection: the width of the picture in metres.
    Metres(f64),
}

/// A box round a scene: its lowest and highest corner, in metres.
pub type Bounds = (DVec3, DVec3);

/// Opening angles in degrees that the command line takes.
const ANGLES: (f64, f64) = (0.001, 179.0);
/// Lengths in metres that the command line takes.
const LENGTHS: (f64, f64) = (1e-9, 1e9);
/// Nearest to a pole that orbits come, in radians: there the picture would turn upside down.
const POLE: f64 = 0.002;
/// Digits of coordinates, counted from the first one of the distance to the middle.
const DIGITS: i32 = 5;

impl SightLine {
    /// That of a camera. The camera has no point that it looks at, so the one of its line of sight that is nearest
    /// to the middle of the scene stands in.
    pub fn of(camera: &Camera, bounds: Option<Bounds>) -> Self {
        let world_from_view = camera.view_from_world.inverse();
        let eye = world_from_view.translation;
        let forward = -world_from_view.matrix3.z_axis.normalize_or(DVec3::NEG_Z);
        let upwards = world_from_view.matrix3.y_axis.normalize_or(DVec3::Y);
        let right = world_from_view.matrix3.x_axis.normalize_or(DVec3::X);
        let distance = bounds
            .map(|(low, high)| (0.5 * (low + high) - eye).dot(forward))
            .filter(|distance| distance.is_finite() && *distance > 0.0)
            .unwrap_or(1.0);
        // Cameras that are not rolled go on with the z axis upwards, as GroIMP's do.
        let level = right.z.abs() < 1e-3 && upwards.z > 0.0 && forward.cross(DVec3::Z).length() > POLE;
        let (extent, aspect) = match camera.projection {
            Projection::Perspective { fov_x, aspect } => {
                (Extent::Degrees(printable(fov_x.to_degrees(), 4).clamp(ANGLES.0, ANGLES.1)), aspect)
            }
            Projection::Parallel { width, aspect } => (Extent::Metres(width), aspect),
        };
        SightLine {
            eye,
            middle: eye + forward * distance,
            up: if level { DVec3::Z } else { upwards },
            extent,
            aspect,
            lens: camera.lens.map(|lens| (lens.radius, lens.focus)),
        }
        .rounded()
    }

    /// The camera, in the way in which `sunshine render` makes it of position, target and up.
    pub fn camera(&self) -> Camera {
        let projection = match self.extent {
            Extent::Degrees(degrees) => {
                Projection::Perspective { fov_x: degrees.to_radians(), aspect: self.aspect }
            }
            Extent::Metres(width) => Projection::Parallel { width, aspect: self.aspect },
        };
        // The angle of the constructor is replaced.
        let mut camera = Camera { projection, ..Camera::look_at(self.eye, self.middle, self.up, 1.0) };
        camera.lens = self.lens.map(|(radius, focus)| {
            let to_middle = (-camera.view_from_world.transform_point3(self.middle).z).max(1e-6);
            Lens { radius, focus: Some(focus.unwrap_or(to_middle)) }
        });
        camera
    }

    /// From the eye to the middle, in metres.
    pub fn distance(&self) -> f64 {
        (self.middle - self.eye).length()
    }

    /// Turns round the middle: to the right by `yaw` and upwards by `pitch`, in radians. The eye stops before the
    /// poles.
    pub fn orbited(&self, yaw: f64, pitch: f64) -> Self {
        let (forward, distance) = self.turned(-yaw, pitch);
        SightLine { eye: self.middle - forward * distance, ..*self }.rounded()
    }

    /// Turns on the spot, as a head does.
    pub fn looked(&self, yaw: f64, pitch: f64) -> Self {
        let (forward, distance) = self.turned(-yaw, pitch);
        SightLine { middle: self.eye + forward * distance, ..*self }.rounded()
    }

    /// The direction of view after a turn round the upward direction and one up or down, and the distance.
    fn turned(&self, yaw: f64, pitch: f64) -> (DVec3, f64) {
        let distance = self.distance();
        let forward = (self.middle - self.eye) / distance;
        let up = self.up.normalize_or(DVec3::Z);
        let right = forward.cross(up).normalize_or(up.any_orthonormal_vector());
        let level = up.cross(right);
        let elevation = forward.dot(up).clamp(-1.0, 1.0).asin();
        let most = std::f64::consts::FRAC_PI_2 - POLE;
        let elevation = (elevation + pitch).clamp(-most, most);
        let level = level * yaw.cos() + up.cross(level) * yaw.sin();
        (level * elevation.cos() + up * elevation.sin(), distance)
    }

    /// Shifts eye and middle within the picture, so that what is `x` to the right and `y` above, as shares of the
    /// width of the picture, comes to the middle.
    pub fn panned(&self, x: f64, y: f64) -> Self {
        let width = self.width_at_middle();
        let forward = (self.middle - self.eye).normalize_or(DVec3::NEG_Z);
        let right = forward.cross(self.up).normalize_or(DVec3::X);
        let shift = (right * x + right.cross(forward) * y) * width;
        self.shifted(shift)
    }

    /// Flies: shares of the distance to the middle to the right, upwards and forward.
    pub fn flown(&self, right: f64, up: f64, forward: f64) -> Self {
        let ahead = (self.middle - self.eye).normalize_or(DVec3::NEG_Z);
        let side = ahead.cross(self.up).normalize_or(DVec3::X);
        let upwards = self.up.normalize_or(DVec3::Z);
        self.shifted((side * right + upwards * up + ahead * forward) * self.distance())
    }

    fn shifted(&self, shift: DVec3) -> Self {
        SightLine { eye: self.eye + shift, middle: self.middle + shift, ..*self }.rounded()
    }

    /// Goes nearer to the middle, or farther away for a factor above 1.
    pub fn zoomed(&self, factor: f64) -> Self {
        let eye = self.middle + (self.eye - self.middle) * factor;
        let extent = match self.extent {
            Extent::Metres(width) => Extent::Metres(width * factor),
            angle => angle,
        };
        let far = SightLine { eye, extent, ..*self };
        // Beyond this neither numbers nor the picture make sense.
        if (1e-6..=1e8).contains(&far.distance()) { far.rounded() } else { *self }
    }

    /// Looks at a point from the same side and distance.
    pub fn centred(&self, point: DVec3) -> Self {
        self.shifted(point - self.middle)
    }

    /// The same direction, from where all of a box is seen in a picture whose height is `height` of its width.
    pub fn framed(&self, (low, high): Bounds, height: f64) -> Self {
        let middle = 0.5 * (low + high);
        let radius = (0.5 * (high - low).length()).max(1e-6);
        let backward = (self.eye - self.middle).normalize_or(DVec3::NEG_Y);
        let narrow = (height * self.aspect).min(1.0);
        let (distance, extent) = match self.extent {
            Extent::Degrees(degrees) => {
                let half_width = (0.5 * degrees.to_radians()).tan();
                (radius / (half_width * narrow).atan().sin(), self.extent)
            }
            Extent::Metres(_) => (3.0 * radius, Extent::Metres(2.0 * radius / narrow)),
        };
        SightLine { middle, eye: middle + backward * distance, extent, ..*self }.rounded()
    }

    /// Width in metres of what the picture shows at the distance of the middle.
    fn width_at_middle(&self) -> f64 {
        match self.extent {
            Extent::Degrees(degrees) => 2.0 * self.distance() * (0.5 * degrees.to_radians()).tan(),
            Extent::Metres(width) => width,
        }
    }

    /// With numbers of a few digits: fewer would show, and more nobody wants to read.
    fn rounded(self) -> Self {
        let distance = self.distance();
        if !(distance.is_finite() && distance > 0.0) {
            return self;
        }
        let digits = DIGITS - distance.log10().floor() as i32;
        let point = |point: DVec3| DVec3::from(point.to_array().map(|value| printable(value, digits)));
        let extent = match self.extent {
            Extent::Degrees(degrees) => Extent::Degrees(printable(degrees, 4).clamp(ANGLES.0, ANGLES.1)),
            Extent::Metres(width) => {
                let digits = DIGITS - width.max(1e-12).log10().floor() as i32;
                Extent::Metres(printable(width, digits).clamp(LENGTHS.0, LENGTHS.1))
            }
        };
        let up = DVec3::from(self.up.to_array().map(|value| printable(value, DIGITS)));
        SightLine { eye: point(self.eye), middle: point(self.middle), up, extent, ..self }
    }
}

/// The number with so many digits behind the point.
fn printable(value: f64, digits: i32) -> f64 {
    let digits = digits.clamp(0, 15) as usize;
    // Adding 0 makes 0 of -0.
    format!("{value:.digits$}").parse().unwrap_or(value) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn front() -> SightLine {
        let camera = Camera::look_at(DVec3::new(0.0, -4.0, 1.0), DVec3::Z, DVec3::Z, 1.0);
        SightLine::of(&camera, Some((DVec3::splat(-1.0), DVec3::splat(1.0))))
    }

    fn close(a: DVec3, b: DVec3) -> bool {
        (a - b).length() < 1e-3
    }

    #[test]
    fn a_saved_camera_looks_at_the_middle_of_the_scene() {
        let line = front();
        assert_eq!((line.eye, line.middle, line.up), (DVec3::new(0.0, -4.0, 1.0), DVec3::Z, DVec3::Z));
        assert_eq!(line.extent, Extent::Degrees(57.2958));
    }

    #[test]
    fn a_rolled_camera_and_one_that_looks_down_keep_their_upward_direction() {
        let rolled = Camera::look_at(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO, DVec3::X, 1.0);
        assert!(close(SightLine::of(&rolled, None).up, DVec3::X));
        let down = Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, 1.0);
        assert!(close(SightLine::of(&down, None).up, DVec3::Y));
    }

    #[test]
    fn orbits_keep_the_middle_and_the_distance_and_stop_at_the_poles() {
        let quarter = front().orbited(std::f64::consts::FRAC_PI_2, 0.0);
        assert!(close(quarter.middle, DVec3::Z));
        assert!(close(quarter.eye, DVec3::new(-4.0, 0.0, 1.0)), "{:?}", quarter.eye);
        // Dragging downwards (pitch < 0) lifts the eye.
        let above = front().orbited(0.0, -100.0);
        assert!((above.distance() - 4.0).abs() < 1e-3 && above.eye.z > 4.9, "{above:?}");
        assert!(above.camera().view_from_world.is_finite());
        let mut line = front();
        for _ in 0..1000 {
            line = line.orbited(0.37, 0.11);
        }
        assert!((line.distance() - 4.0).abs() < 0.05, "{}", line.distance());
    }

    #[test]
    fn pans_move_by_shares_of_the_picture() {
        let line = front();
        let panned = line.panned(0.5, 0.0);
        // What was at the right edge is in the middle now.
        assert!(close(panned.middle, DVec3::new(4.0 * 0.5f64.tan(), 0.0, 1.0)), "{:?}", panned.middle);
        assert!(close(line.panned(0.0, 0.5).middle, DVec3::new(0.0, 0.0, 1.0 + 4.0 * 0.5f64.tan())));
    }

    #[test]
    fn zooms_end_before_numbers_do() {
        let near = front().zoomed(0.5);
        assert!(close(near.eye, DVec3::new(0.0, -2.0, 1.0)));
        let mut line = front();
        for _ in 0..10_000 {
            line = line.zoomed(0.9);
        }
        assert!(line.distance() > 0.0 && line.camera().view_from_world.is_finite());
        let parallel = SightLine { extent: Extent::Metres(2.0), ..front() };
        assert_eq!(parallel.zoomed(2.0).extent, Extent::Metres(4.0));
    }

    #[test]
    fn flying_and_looking_move_eye_or_middle() {
        let flown = front().flown(0.0, 0.25, 0.5);
        assert!(
            close(flown.eye, DVec3::new(0.0, -2.0, 2.0)) && close(flown.middle, DVec3::new(0.0, 2.0, 2.0))
        );
        let looked = front().looked(std::f64::consts::FRAC_PI_2, 0.0);
        assert!(
            close(looked.eye, front().eye) && close(looked.middle, DVec3::new(4.0, -4.0, 1.0)),
            "{looked:?}"
        );
    }

    #[test]
    fn framing_shows_the_whole_box_in_pictures_of_any_shape() {
        let bounds = (DVec3::new(2.0, 3.0, 0.0), DVec3::new(3.0, 4.5, 7.0));
        for height in [0.3, 1.0, 2.0] {
            for extent in [Extent::Degrees(40.0), Extent::Metres(1.0)] {
                let line = SightLine { extent, ..front() }.framed(bounds, height);
                let camera = line.camera();
                for corner in 0..8 {
                    let pick = |axis: usize| {
                        if corner >> axis & 1 == 0 { bounds.0[axis] } else { bounds.1[axis] }
                    };
                    let seen = camera.view_from_world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
                    let half = match line.extent {
                        Extent::Degrees(degrees) => -seen.z * (0.5 * degrees.to_radians()).tan(),
                        Extent::Metres(width) => 0.5 * width,
                    };
                    assert!(
                        seen.z < 0.0 && seen.x.abs() <= half && seen.y.abs() <= half * height,
                        "{seen:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn all_numbers_are_short() {
        let line = front().orbited(0.123, 0.456).panned(0.1, 0.017).zoomed(0.77);
        for value in line.eye.to_array().into_iter().chain(line.middle.to_array()) {
            assert!(format!("{value}").len() <= 9, "{value}");
        }
    }
}
