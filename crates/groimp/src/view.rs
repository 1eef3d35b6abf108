//! The saved 3D view: the camera and the visible layers.

use crate::inline;
use crate::values::{Value, Values, parse_number, parse_numbers, tokens};
use glam::{DAffine3, DMat3, DVec3};
use scene::{Camera, Projection};

/// Number of drawing layers.
const LAYERS: usize = 16;

/// A saved or the default 3D view.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct View {
    pub camera: Camera,
    visible_layers: [bool; LAYERS],
}

impl Default for View {
    fn default() -> Self {
        View { camera: Camera::default(), visible_layers: [true; LAYERS] }
    }
}

impl View {
    /// Reads the option value; what is wrong with it is told in words, and the default stands in.
    pub fn parse(text: &str, line: usize) -> (Self, Vec<String>) {
        let mut view = View::default();
        let mut problems = Vec::new();
        let mut values = Values::default();
        let Some(all) = inline::parse_fields(&mut values, text, line) else {
            return (
                view,
                vec!["the saved view has unmatched brackets; the default view is used".to_owned()],
            );
        };
        let members = values.get(all).members;
        if let Some(layers) = values.find(members, "visibleLayers") {
            for (visible, token) in view.visible_layers.iter_mut().zip(tokens(layers.text())) {
                *visible = token != "false";
            }
        }
        match values.find(members, "camera").map(|camera| parse_camera(&values, camera)) {
            Some(Ok(camera)) => view.camera = camera,
            Some(Err(problem)) => problems.push(format!("{problem}; the default camera is used")),
            None => problems.push("the saved view has no camera; the default camera is used".to_owned()),
        }
        (view, problems)
    }

    /// Makes other layers visible, layer n as bit n.
    pub fn show_layers(&mut self, layers: u16) {
        self.visible_layers = std::array::from_fn(|layer| layers >> layer & 1 != 0);
    }

    /// The visible layers, layer n as bit n.
    pub fn shown_layers(&self) -> u16 {
        (0..LAYERS).filter(|layer| self.visible_layers[*layer]).map(|layer| 1 << layer).sum()
    }

    /// Whether objects of a layer are drawn. There are 16 layers; others do not occur and count as visible.
    pub fn shows(&self, layer: i64) -> bool {
        usize::try_from(layer).ok().and_then(|layer| self.visible_layers.get(layer).copied()).unwrap_or(true)
    }
}

fn parse_camera(values: &Values, camera: &Value) -> Result<Camera, String> {
    // A reference to a named camera has no members (unverified: not seen in any project).
    let matrix =
        values.find(camera.members, "transformation").ok_or("the saved camera has no transformation")?;
    let view_from_world = parse_numbers(matrix.text())
        .and_then(|numbers| affine(&numbers))
        .filter(|m| m.is_finite() && m.inverse().is_finite())
        .ok_or_else(|| {
            format!("the camera transformation '{}' is not an invertible 4x4 matrix", matrix.text())
        })?;
    let projection = values.find(camera.members, "projection").ok_or("the saved camera has no projection")?;
    let number = |name: &str, default: f64| match values.find(projection.members, name) {
        None => Ok(default),
        Some(value) => parse_number(value.text())
            .filter(|n| n.is_finite() && *n > 0.0)
            .ok_or_else(|| format!("the camera's {name} is '{}', expected a positive number", value.text())),
    };
    let aspect = number("aspect", 1.0)?;
    let class = values.type_of(projection).unwrap_or("");
    let projection = match class.rsplit('.').next() {
        Some("PerspectiveProjection") => {
            let fov = number("fieldOfView", std::f64::consts::FRAC_PI_3)?;
            // GroIMP clamps to a little less than pi.
            Projection::Perspective { fov_x: fov.min(std::f64::consts::PI - 1e-3), aspect }
        }
        Some("ParallelProjection") => Projection::Parallel { width: number("width", 10.0)?, aspect },
        _ => return Err(format!("the camera's projection '{class}' is neither perspective nor parallel")),
    };
    Ok(Camera { view_from_world, projection, lens: None })
}

/// The affine part of 16 numbers in row-major order.
pub(crate) fn affine(m: &[f64]) -> Option<DAffine3> {
    let &[a, b, c, x, d, e, f, y, g, h, i, z, ..] = m else { return None };
    (m.len() == 16).then(|| {
        let linear = DMat3::from_cols(DVec3::new(a, d, g), DVec3::new(b, e, h), DVec3::new(c, f, i));
        DAffine3::from_mat3_translation(linear, DVec3::new(x, y, z))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_saved_parallel_view() {
        let (view, problems) = View::parse(
            "visibleLayers={true true false true}epsilon=1.0E-6 camera=(minZ=0.1 maxZ=2000.0 \
             projection=[de.grogra.imp3d.ParallelProjection aspect=1.0 width=30.5]transformation=(1.0 0.0 0.0 \
             -0.375 0.0 0.0 1.0 -9.875 0.0 -1.0 0.0 -38.25 0.0 0.0 0.0 1.0))navigator=null",
            1,
        );
        assert_eq!(problems, Vec::<String>::new());
        assert_eq!(view.camera.projection, Projection::Parallel { width: 30.5, aspect: 1.0 });
        let point = view.camera.view_from_world.transform_point3(DVec3::new(0.0, 1.0, 10.0));
        assert_eq!(point, DVec3::new(-0.375, 0.125, -39.25));
        assert!(view.shows(1) && !view.shows(2) && view.shows(15) && view.shows(99) && view.shows(-1));
    }

    #[test]
    fn layers_are_bits() {
        let mut view = View::default();
        assert_eq!(view.shown_layers(), u16::MAX);
        view.show_layers(0b1001);
        assert!(view.shows(0) && !view.shows(1) && view.shows(3) && !view.shows(15));
        assert_eq!(view.shown_layers(), 0b1001);
    }

    #[test]
    fn nonsense_gives_the_default_and_a_reason() {
        for text in ["camera=(", "", "camera=*x:y", "camera=(transformation=(1 2 3))"] {
            let (view, problems) = View::parse(text, 1);
            assert_eq!(view, View::default());
            assert_eq!(problems.len(), 1, "{text}");
        }
    }
}
