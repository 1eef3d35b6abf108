//! `sunshine info`: what a scene holds.

use crate::arguments::InfoArguments;
use crate::failure::Failure;
use groimp::Report;
use scene::{Camera, DVec3, Projection, Scene};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::{self, Display};
use std::io;

/// Reads the scene and describes it.
pub fn run(arguments: &InfoArguments) -> Result<String, Failure> {
    let project = groimp::read_within(&arguments.scene, arguments.limits.limits())
        .map_err(Failure::reading(&arguments.scene))?;
    let info = Info::new(&project.scene, &project.report);
    if arguments.json {
        Ok(serde_json::to_string_pretty(&info).map_err(io::Error::from)? + "\n")
    } else {
        Ok(info.to_string())
    }
}

/// What a scene holds.
#[derive(Debug, Serialize)]
struct Info {
    /// As many as are drawn, through instances, too.
    objects: u64,
    /// As many as are stored: members of groups count once.
    shapes: BTreeMap<&'static str, usize>,
    groups: usize,
    instances: usize,
    materials: usize,
    images: usize,
    lights: usize,
    bounds: Option<Bounds>,
    camera: CameraInfo,
    skipped: Vec<SkippedInfo>,
    warnings: Vec<String>,
}

/// The box round everything finite, in metres.
#[derive(Debug, Serialize)]
struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

/// Where the picture is taken from, in metres.
#[derive(Debug, Serialize)]
struct CameraInfo {
    projection: &'static str,
    position: [f64; 3],
    direction: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    field_of_view_degrees: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<f64>,
}

/// Nodes that are not drawn.
#[derive(Debug, Serialize)]
struct SkippedInfo {
    #[serde(rename = "type")]
    type_name: String,
    count: usize,
    reason: String,
}

impl Info {
    fn new(scene: &Scene, report: &Report) -> Self {
        let mut shapes = BTreeMap::new();
        for object in scene.objects.iter().chain(scene.groups.iter().flat_map(|group| &group.objects)) {
            *shapes.entry(object.shape.name()).or_default() += 1;
        }
        let lamps = scene.objects.iter().filter(|object| object.emission.is_some()).count();
        Info {
            objects: scene.drawn_objects(),
            shapes,
            groups: scene.groups.len(),
            instances: scene.instances.len()
                + scene.groups.iter().map(|group| group.instances.len()).sum::<usize>(),
            materials: scene.materials.len(),
            images: scene.images.len(),
            lights: scene.lights.len() + lamps + usize::from(scene.sky.is_some()),
            bounds: scene.bounds().map(|(min, max)| Bounds { min: plain(min), max: plain(max) }),
            camera: CameraInfo::new(&scene.camera),
            skipped: report
                .skipped
                .iter()
                .map(|skipped| SkippedInfo {
                    type_name: skipped.type_name.clone(),
                    count: skipped.count,
                    reason: skipped.reason.clone(),
                })
                .collect(),
            warnings: report.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

impl CameraInfo {
    fn new(camera: &Camera) -> Self {
        let world_from_view = camera.view_from_world.inverse();
        let (projection, field_of_view_degrees, width) = match camera.projection {
            Projection::Perspective { fov_x, .. } => ("perspective", Some(fov_x.to_degrees()), None),
            Projection::Parallel { width, .. } => ("parallel", None, Some(width)),
        };
        CameraInfo {
            projection,
            position: plain(world_from_view.translation),
            // The camera looks along -z.
            direction: plain((-world_from_view.matrix3.z_axis).normalize_or_zero()),
            field_of_view_degrees,
            width,
        }
    }
}

/// Adding zero turns -0 into 0, which nobody wants to read.
fn plain(v: DVec3) -> [f64; 3] {
    v.to_array().map(|x| x + 0.0)
}

/// The table for people.
impl Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        row(f, "objects", self.objects)?;
        for (shape, count) in &self.shapes {
            row(f, &format!("  {shape}"), count)?;
        }
        if self.instances > 0 {
            let groups = if self.groups == 1 { "group" } else { "groups" };
            row(f, "instances", format_args!("{} of {} {groups}", self.instances, self.groups))?;
        }
        row(f, "materials", self.materials)?;
        row(f, "images", self.images)?;
        row(f, "lights", self.lights)?;
        match &self.bounds {
            Some(Bounds { min, max }) => {
                row(f, "extent", format_args!("{} to {} m", point(min), point(max)))?;
            }
            None => row(f, "extent", "nothing finite to see")?,
        }
        let camera = &self.camera;
        let opening = match (camera.field_of_view_degrees, camera.width) {
            (Some(degrees), _) => format!("{}, {} degrees wide", camera.projection, number(degrees)),
            (None, Some(width)) => format!("{}, {} m wide", camera.projection, number(width)),
            (None, None) => camera.projection.to_owned(),
        };
        row(f, "camera", opening)?;
        row(f, "  position", format_args!("{} m", point(&camera.position)))?;
        row(f, "  direction", point(&camera.direction))?;
        if !self.skipped.is_empty() {
            writeln!(f, "\nnot drawn:")?;
            for SkippedInfo { type_name, count, reason } in &self.skipped {
                writeln!(f, "  {count} x {type_name}: {reason}")?;
            }
        }
        if !self.warnings.is_empty() {
            writeln!(f, "\nwarnings:")?;
            for warning in &self.warnings {
                writeln!(f, "  {warning}")?;
            }
        }
        Ok(())
    }
}

fn row(f: &mut fmt::Formatter<'_>, name: &str, value: impl Display) -> fmt::Result {
    writeln!(f, "{name:<18}{value}")
}

fn point(p: &[f64; 3]) -> String {
    format!("({}, {}, {})", number(p[0]), number(p[1]), number(p[2]))
}

/// Four significant digits: enough to find one's way, for millimetres as for kilometres.
fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-6..9).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    let decimals = usize::try_from(3 - magnitude).unwrap_or(0);
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{DAffine3, Emission, Material, Object, Origin, Shape, Sky, TypeNameId};

    fn scene() -> Scene {
        let mut scene = Scene::default();
        let material = scene.add_material(Material::Rgba { color: [0.5; 3], opacity: 1.0 });
        let origin = Origin { node: 7, type_name: TypeNameId(0) };
        let lamp = Emission { power: [10.0; 3], exponent: 0.0, shadowless: false };
        let shapes =
            [(Shape::Sphere { radius: 2.0 }, Some(lamp)), (Shape::Plane, None), (Shape::Plane, None)];
        for (shape, emission) in shapes {
            let world_from_object = DAffine3::IDENTITY;
            let interior = None;
            scene.objects.push(Object { shape, world_from_object, material, emission, interior, origin });
        }
        scene.sky = Some(Sky::uniform([1.0; 3], origin));
        scene
    }

    #[test]
    fn json_counts_everything() {
        let json = serde_json::to_value(Info::new(&scene(), &Report::default())).unwrap();
        assert_eq!(json["objects"], 3);
        assert_eq!(json["shapes"], serde_json::json!({ "Plane": 2, "Sphere": 1 }));
        assert_eq!((&json["materials"], &json["images"]), (&1.into(), &0.into()));
        assert_eq!(json["lights"], 2);
        assert_eq!(json["bounds"]["max"], serde_json::json!([2.0, 2.0, 2.0]));
        assert_eq!(json["camera"]["projection"], "perspective");
        assert!((json["camera"]["field_of_view_degrees"].as_f64().unwrap() - 60.0).abs() < 1e-9);
        assert!(json["camera"].get("width").is_none());
        assert_eq!((&json["skipped"], &json["warnings"]), (&serde_json::json!([]), &serde_json::json!([])));
    }

    #[test]
    fn an_empty_scene_has_no_bounds() {
        let info = Info::new(&Scene::default(), &Report::default());
        assert!(serde_json::to_value(&info).unwrap()["bounds"].is_null());
        assert!(info.to_string().contains("nothing finite"));
    }

    #[test]
    fn the_camera_is_where_it_was_put() {
        let eye = DVec3::new(0.0, -13.8, 2.6);
        let info = CameraInfo::new(&Camera::look_at(eye, DVec3::new(0.0, 0.0, 2.6), DVec3::Z, 0.7));
        for (found, expected) in info.position.into_iter().zip([0.0, -13.8, 2.6]) {
            assert!((found - expected).abs() < 1e-12);
        }
        for (found, expected) in info.direction.into_iter().zip([0.0, 1.0, 0.0]) {
            assert!((found - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn the_table_is_for_people() {
        let text = Info::new(&scene(), &Report::default()).to_string();
        assert!(
            text.starts_with("objects           3\n  Plane           2\n  Sphere          1\n"),
            "{text}"
        );
        assert!(text.contains("camera            perspective, 60 degrees wide\n"), "{text}");
        assert!(!text.contains("warnings"), "{text}");
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (60.000000000000001, "60"),
            (5.6568542, "5.657"),
            (-0.00123456, "-0.001235"),
            (123456.7, "123457"),
            (1e-9, "1.000e-9"),
            (1e12, "1.000e12"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
