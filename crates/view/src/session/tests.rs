use super::*;
use render::compile;
use scene::{MaterialId, Object, Origin, Scene, Shape, TypeNameId};
use std::sync::Arc;

/// A session on a box of 2 m with node id 7, seen from 10 m in front, in a window of 400 x 300 pixels.
fn session() -> Session {
    let project = std::env::temp_dir().join("no such project.gsz");
    let mut session =
        Session::new(&project, GivenWords::default(), ViewSettings::default(), "a.png".to_owned());
    session.area = Area { x: 0, y: 0, width: 400, height: 300 };
    let mut scene = Scene::default();
    scene.materials.push(Material::Rgba { color: [0.5; 3], opacity: 1.0 });
    scene.type_names.push("Box".to_owned());
    scene.objects.push(Object {
        shape: Shape::Box { width: 1.0, height: 1.0, length: 1.0 },
        world_from_object: scene::DAffine3::from_scale(DVec3::splat(2.0)),
        material: MaterialId(0),
        emission: None,
        interior: None,
        origin: Origin { node: 7, type_name: TypeNameId(0) },
    });
    scene.camera = Camera::look_at(DVec3::new(0.0, -10.0, 0.0), DVec3::ZERO, DVec3::Z, 0.8);
    session.hear(read(scene, false), 0.0);
    session
}

fn read(scene: Scene, is_reread: bool) -> Event {
    let compiled = Arc::new(compile(&scene).unwrap());
    let scene = Arc::new(scene);
    let warnings = Vec::new();
    Event::SceneRead(SceneNews { scene, compiled, warnings, visible_layers: 1, is_reread, seconds: 0.0 })
}

#[test]
fn what_is_picked_is_where_it_is_shown() {
    let mut session = session();
    let (low, high) = session.scene.as_ref().unwrap().scene.bounds().unwrap();
    let at = session.on_screen(0.5 * (low + high)).unwrap();
    session.act(Action::Pick(at), 1.0);
    let picked = session.picked.clone().unwrap();
    assert_eq!((picked.what.origin.node, picked.what.type_name.as_str()), (7, "Box"));
    assert_eq!(picked.material, "1 (RGBA)");
    let back = session.on_screen(picked.what.position).unwrap();
    assert!((back - at).length() < 0.1, "{at} {back}");
    session.act(Action::Pick(Pos2::new(1.0, 1.0)), 1.0);
    assert_eq!(session.picked, None);
}

#[test]
fn a_camera_in_motion_comes_to_rest() {
    let mut session = session();
    assert!(!session.request(0.0).unwrap().is_moving);
    let before = session.request(0.0).unwrap().camera;
    session.act(Action::Orbit(Vec2::new(30.0, 0.0)), 1.0);
    let moving = session.request(1.0).unwrap();
    assert!(moving.is_moving && moving.camera != before);
    assert!(!session.request(1.3).unwrap().is_moving);
    session.act(Action::Undo, 2.0);
    assert_eq!(session.request(2.0).unwrap().camera, before);
}

#[test]
fn settings_become_requests_and_errands() {
    let mut session = session();
    assert!(matches!(&session.errands()[..], [Errand::Prepare { reread: false, .. }]));
    assert!(session.errands().is_empty());
    session.act(Action::Depth(1), 0.0);
    assert_eq!(session.request(0.0).unwrap().settings.depth, 6);
    assert!(session.errands().is_empty() && session.command_line().contains("--depth 6"));
    session.settings.turbidity = Some(3.0);
    assert!(matches!(&session.errands()[..], [Errand::Prepare { .. }]));
    session.hear(Event::ProjectChanged, 0.0);
    assert!(matches!(&session.errands()[..], [Errand::Prepare { reread: true, .. }]));
    session.act(Action::Save, 0.0);
    let errands = session.errands();
    let [Errand::Save(order)] = &errands[..] else { panic!("no picture") };
    assert_eq!((order.settings.width, order.settings.depth), (400, 6));
    // One after the other.
    session.act(Action::Save, 0.0);
    assert!(session.errands().is_empty());
    session.hear(Event::Saved { path: "a.png".into(), seconds: 1.0 }, 1.0);
    session.output = "a.jpg".to_owned();
    session.act(Action::Save, 1.0);
    assert!(
        session.errands().is_empty() && session.messages.shown(1.0).iter().any(|message| message.is_error)
    );
}

#[test]
fn a_scene_that_is_read_again_keeps_the_camera_and_a_broken_one_the_scene() {
    let mut session = session();
    session.act(Action::Zoom(0.5), 0.0);
    let camera = session.request(0.0).unwrap().camera;
    session.hear(Event::SceneFailed("line 3".to_owned()), 1.0);
    assert!(session.scene.is_some() && session.messages.shown(1.0)[0].text.contains("line 3"));
    session.hear(read(Scene::default(), true), 2.0);
    assert_eq!(session.request(2.0).unwrap().camera, camera);
}

#[test]
fn a_lost_card_is_told_and_the_command_line_says_so() {
    let mut session = session();
    session.settings.device = DeviceChoice::Gpu(Some(0));
    session.hear(Event::DeviceFailed("the card was lost".to_owned()), 0.0);
    assert_eq!(session.settings.device, DeviceChoice::Cpu);
    assert!(session.command_line().contains("--device cpu"));
    assert!(session.messages.shown(1e6)[0].is_error);
}
