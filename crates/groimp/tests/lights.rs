//! Lights and skies as projects hold them.
#![allow(clippy::unwrap_used)] // In tests a panic is the failure report.

mod common;

use common::{data, directory, graph};
use glam::DVec3;
use groimp::Project;
use scene::{Attenuation, Channel, Daylight, LightKind, SkyRadiance};
use std::f64::consts::PI;

const LIGHT_NODE: &str = "de.grogra.imp3d.objects.LightNode";
const SKY: &str = "de.grogra.imp3d.objects.Sky";

const REGISTRY: &str = r#"<project xmlns="http://grogra.de/registry" graph="graph.xml"><registry>
<ref name="project"><ref name="objects">
 <ref name="images"><de.grogra.pf.ui.registry.FileObjectItem mimeType="image/png" name="clouds"
  systemId="pfs:images/clouds.png" type="de.grogra.imp.objects.FixedImageAdapter"/></ref>
 <ref name="lights"><de.grogra.pf.ui.registry.FileObjectItem name="lamp" systemId="pfs:lamp.ies"/>
  <de.grogra.pf.ui.registry.FileObjectItem name="broken" systemId="pfs:broken.ies"/></ref>
</ref></ref></registry></project>"#;

/// Twice as bright down as up.
const LAMP: &str = "IESNA91\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 20\n0 180\n0\n200 100\n";

fn read(test: &str, nodes: &str) -> Project {
    let text = graph(nodes);
    let mut png = Vec::new();
    image::RgbaImage::from_pixel(2, 2, image::Rgba([255, 128, 0, 255]))
        .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
        .unwrap();
    let root = directory(
        test,
        &[
            ("project.gs", REGISTRY.as_bytes()),
            ("graph.xml", text.as_bytes()),
            ("images/clouds.png", &png),
            ("lamp.ies", LAMP.as_bytes()),
            ("broken.ies", b"TILT=NONE\n1 2 3 x"),
        ],
    );
    groimp::read(&root).unwrap()
}

fn node(id: i64, type_name: &str, fields: &str) -> String {
    format!("<node id=\"{id}\" type=\"{type_name}\" edges=\"+\">{fields}</node>\n")
}

fn object(name: &str, class: &str, fields: &str) -> String {
    format!("<object gx:name=\"{name}\" gx:type=\"de.grogra.imp3d.{class}\">{fields}</object>")
}

fn light(id: i64, class: &str, fields: &str) -> String {
    node(id, LIGHT_NODE, &object("light", class, fields))
}

fn daylight(project: &Project) -> Daylight {
    match project.scene.sky.as_ref().unwrap().radiance {
        SkyRadiance::Daylight(daylight) => daylight,
        SkyRadiance::Uniform(_) | SkyRadiance::Channel { .. } => panic!("not a clear sky"),
    }
}

#[test]
fn a_sky_may_have_a_sun() {
    let sun = "<object gx:name=\"sun\" gx:value=\"0.5 0.0 1.0\"/>";
    let fields = sun.to_owned() + &data("turbidity", 3.0) + &data("disableSun", true);
    let turned = "<object gx:name=\"transform\" gx:type=\"de.grogra.math.TMatrix4d\" \
                  gx:value=\"0 -1 0 5  1 0 0 0  0 0 1 0  0 0 0 1\"/>";
    let project =
        read("sun", &node(1, SKY, &(turned.to_owned() + &object("shader", "shading.SunSkyLight", &fields))));
    assert_eq!(
        daylight(&project),
        Daylight {
            sun: DVec3::new(0.5, 0.0, 1.0),
            turbidity: 3.0,
            factor: 1.0,
            shines: true,
            has_sun: false
        }
    );
    let sky = project.scene.sky.as_ref().unwrap();
    assert_eq!(sky.world_from_sky.transform_vector3(DVec3::X), DVec3::Y);
    // It is a light, so there is no default one.
    assert!(project.scene.lights.is_empty());
    assert!(project.report.is_empty(), "{}", project.report);
}

#[test]
fn a_light_node_may_hold_the_sky_and_fields_may_be_missing() {
    let project = read("light_sky", &light(1, "shading.SunSkyLight", ""));
    let default = daylight(&project);
    assert_eq!((default.sun, default.turbidity, default.shines), (DVec3::new(0.0, 1.0, 0.4), 6.0, true));
    assert!(project.report.is_empty(), "{}", project.report);

    // A node elsewhere in the file, and a sky that is only seen.
    let shader = "<ref gx:name=\"shader\" gx:value=\"7\"/>";
    let shared = "<node id=\"7\" type=\"de.grogra.imp3d.shading.SunSkyLight\">".to_owned()
        + &data("disableLight", true)
        + "</node>";
    let project = read("ref_sky", &(node(1, SKY, shader) + &shared));
    assert!(!daylight(&project).shines);
    assert!(project.report.to_string().contains("default light"), "{}", project.report);
}

#[test]
fn the_first_of_several_skies_counts() {
    let project = read("skies", &(node(1, SKY, "") + &light(2, "shading.SunSkyLight", "")));
    assert!(matches!(project.scene.sky.unwrap().radiance, SkyRadiance::Uniform(_)));
    assert_eq!(project.report.skipped[0].reason, "there is another sky before it");
}

#[test]
fn a_sky_may_be_a_picture() {
    let image = "<object gx:name=\"diffuse\" gx:type=\"de.grogra.imp3d.shading.ImageMap\">\
                 <shared gx:name=\"image\" gx:value=\"/:&quot;/project/objects/images/clouds&quot;\"/></object>";
    let fields = object("shader", "shading.Phong", image) + &data("powerDensity", 24.0);
    let project = read("picture", &node(1, SKY, &fields));
    let SkyRadiance::Channel { channel, factor } = project.scene.sky.unwrap().radiance else { panic!() };
    assert!((factor - 2.0 / PI).abs() < 1e-12);
    assert!(matches!(project.scene.channels[channel.index()], Channel::ImageMap { .. }));
    assert!(project.report.is_empty(), "{}", project.report);
}

#[test]
fn ambient_light_is_kept_for_the_ray_tracer() {
    let dim = "<object gx:name=\"color\" gx:value=\"false 0.25 0.5 0.0\"/>";
    let class = "objects.AmbientLight";
    let project = read(
        "ambient",
        &(light(1, class, dim) + &light(2, class, dim) + &light(3, "objects.PointLight", "")),
    );
    assert_eq!(project.scene.ambient, [0.5, 1.0, 0.0]);
    assert_eq!(project.scene.lights.len(), 1);
    assert_eq!(
        project.report.to_string(),
        "warning: an AmbientLight acts in the ray tracer only (2 times)\n"
    );
}

#[test]
fn physical_lights_have_distributions() {
    let class = "objects.PhysicalLight";
    let table = object(
        "distribution",
        "objects.LightDistribution",
        &(data("width", 2)
            + &data("height", 1)
            + "<array gx:name=\"data\"><data gx:value=\"3.0\"/><data gx:value=\"1.0\"/></array>"),
    );
    let file = |name: &str| {
        format!(
            "<shared gx:name=\"distribution\" gx:value=\"/:&quot;/project/objects/lights/{name}&quot;\"/>"
        )
    };
    let power = data("power", 30.0);
    let nodes = light(1, class, &(power.clone() + &table))
        + &light(2, class, &file("lamp"))
        + &light(3, class, &file("lamp"))
        + &light(4, class, &file("broken"))
        + &light(5, class, "");
    let project = read("physical", &nodes);
    let lights = &project.scene.lights;
    let LightKind::Physical { power, distribution } = &lights[0].kind else { panic!("{lights:?}") };
    assert_eq!(*power, [10.0; 3]);
    assert_eq!((distribution.columns(), distribution.rows()), (2, 1));
    assert!((distribution.density(0, 0) / distribution.density(1, 0) - 3.0).abs() < 1e-12);
    let LightKind::Physical { distribution: lamp, .. } = &lights[1].kind else { panic!("{lights:?}") };
    assert!((lamp.density(0, 0) / lamp.density(90, 0) - 4.0 / 3.0).abs() < 1e-9);
    // Read once, shared by both.
    assert!(
        matches!(&lights[2].kind, LightKind::Physical { distribution, .. } if std::sync::Arc::ptr_eq(distribution, lamp))
    );
    assert!(matches!(lights[3].kind, LightKind::Point { .. }));
    assert!(matches!(lights[4].kind, LightKind::Point { .. }));
    let report = project.report.to_string();
    assert!(report.contains("'broken.ies' cannot be used: it ends early"), "{report}");
    assert_eq!(project.report.warnings.len(), 1);
}

#[test]
fn spectral_lights_are_the_light_in_them() {
    let spot = object("light", "objects.SpotLight", &(data("power", 1.0) + &data("innerAngle", 0.1)));
    let class = "spectral.SpectralLight";
    let project = read("spectral", &(light(1, class, &(data("power", 60.0) + &spot)) + &light(2, class, "")));
    let [spot, point] = &project.scene.lights[..] else { panic!("{:?}", project.scene.lights) };
    assert!(
        matches!(spot.kind, LightKind::Spot { power, inner_angle, .. } if power == [20.0; 3] && inner_angle == 0.1)
    );
    assert_eq!(point.kind, LightKind::Point { power: [100.0 / 3.0; 3] });
    assert!(project.report.to_string().contains("taken as white"));
}

#[test]
fn hostile_skies_and_distributions_are_reported() {
    let sky = "shading.SunSkyLight";
    let zero = "<object gx:name=\"sun\" gx:value=\"0 0 0\"/>";
    let cycle = "<node id=\"50\" type=\"de.grogra.graph.impl.SharedObjectNode\"><ref gx:name=\"object\" \
                 gx:value=\"50\"/></node><node id=\"51\" type=\"de.grogra.spectral.SpectralLight\"><ref \
                 gx:name=\"light\" gx:value=\"51\"/></node>";
    let size = |width: &str| {
        let fields = data("width", width) + &data("height", 1000000) + &data("data", "1 2 3");
        light(6, "objects.PhysicalLight", &object("distribution", "objects.LightDistribution", &fields))
    };
    let nodes = light(1, sky, zero)
        + &light(2, sky, &data("radianceFactor", -1))
        + &light(3, sky, &data("turbidity", "NaN"))
        + &node(4, LIGHT_NODE, "<ref gx:name=\"light\" gx:value=\"50\"/>")
        + &node(5, LIGHT_NODE, "<ref gx:name=\"light\" gx:value=\"51\"/>")
        + &size("1000000000")
        + cycle;
    let project = read("hostile", &nodes);
    assert!(project.scene.sky.is_none());
    assert_eq!(project.report.skipped.iter().map(|s| s.count).sum::<usize>(), 5, "{}", project.report);
    assert_eq!(project.scene.lights.len(), 1);
    let hazy = read("hazy", &light(1, sky, &data("turbidity", 40)));
    assert_eq!(daylight(&hazy).turbidity, 10.0);
    assert!(hazy.report.to_string().contains("turbidity 40"), "{}", hazy.report);
}

#[test]
fn attenuation_is_kept_for_the_ray_tracer() {
    let fades =
        |exponent, distance| data("attenuationExponent", exponent) + &data("attenuationDistance", distance);
    let (point, spot) = ("objects.PointLight", "objects.SpotLight");
    let lights = light(1, point, "")
        + &light(2, spot, &fades(2.0, 5.0))
        + &light(3, point, &fades(0.0, 5.0))
        + &light(4, point, &fades(2.0, -1.0));
    let project = read("attenuation", &lights);
    let read: Vec<_> = project.scene.lights.iter().map(|light| light.attenuation).collect();
    let none = Attenuation::default();
    assert_eq!(read, [none, Attenuation { exponent: 2.0, distance: 5.0 }, none, none]);
}
