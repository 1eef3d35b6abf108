use super::*;
use crate::command_line::GivenWords;
use crate::events::{Event, SceneNews};
use crate::settings::ViewSettings;
use render::compile;
use scene::{Camera, DVec3, Daylight, Origin, Scene, SkyRadiance, TypeNameId};
use std::sync::Arc;

#[test]
fn looking_at_the_panel_changes_nothing() {
    let origin = Origin { node: 1, type_name: TypeNameId(0) };
    let mut sky = Sky::uniform([1.0; 3], origin);
    let sun = DVec3::new(0.123, -0.456, -0.05);
    sky.radiance =
        SkyRadiance::Daylight(Daylight { sun, turbidity: 2.345, factor: 1.0, shines: true, has_sun: true });
    let camera = Camera::look_at(DVec3::new(0.0, -3.3, 1.0), DVec3::ZERO, DVec3::Z, 0.777);
    let scene = Arc::new(Scene { sky: Some(sky), camera, ..Scene::default() });
    let compiled = Arc::new(compile(&scene).unwrap());
    let project = std::env::temp_dir().join("no such project.gsz");
    let settings = ViewSettings { device: DeviceChoice::Cpu, ..ViewSettings::default() };
    let mut session = Session::new(&project, GivenWords::default(), settings, "a.png".to_owned());
    let warnings = vec!["odd".to_owned()];
    let news = SceneNews { scene, compiled, warnings, visible_layers: 5, is_reread: false, seconds: 0.0 };
    session.hear(Event::SceneRead(news), 0.0);
    let before = (session.settings.clone(), session.navigation.sight().clone());
    let context = egui::Context::default();
    for _ in 0..3 {
        let mut actions = Vec::new();
        let mut output = context.run_ui(egui::RawInput::default(), |ui| {
            actions.extend(panel(ui, &mut session, 0.0));
        });
        output.textures_delta.clear();
        assert!(actions.is_empty(), "{actions:?}");
    }
    assert_eq!((session.settings.clone(), session.navigation.sight().clone()), before);
}

#[test]
fn numbers_are_short() {
    assert_eq!([short(12.0), short(12_345.0), short(1.5e7), short(2e9)], ["12 ", "12 k", "15.0 M", "2.00 G"]);
    assert_eq!([counted(1, "object"), counted(2, "object")], ["1 object", "2 objects"]);
}
