//! All that the window knows, without the window: what actions and events do to it.

use crate::actions::Action;
use crate::canvas::Area;
use crate::command_line::{GivenWords, render_words, shell_line};
use crate::desk::Request;
use crate::events::{Event, Frame, SceneNews};
use crate::messages::Messages;
use crate::named_views::NamedViews;
use crate::navigation::{Movement, Navigation, Sight};
use crate::preparing::{Errand, Wanted};
use crate::saving::SaveOrder;
use crate::settings::{LONGEST_EDGE, ViewSettings};
use crate::shown::Shown;
use crate::sight_line::SightLine;
use egui::{Pos2, Vec2};
use render::{DeviceChoice, Picked, PictureFormat, pick};
use scene::{Camera, DVec3, Material, Projection};
use std::path::{Path, PathBuf};

/// What the session knows of the scene.
pub type KnownScene = SceneNews;

/// What was picked, with its material in words.
#[derive(Clone, Debug, PartialEq)]
pub struct PickedObject {
    /// Where and what.
    pub what: Picked,
    /// Its material in words.
    pub material: String,
}

/// All that the window knows.
pub struct Session {
    /// The project.
    pub project: PathBuf,
    /// What was given when the window was opened.
    pub given: GivenWords,
    /// What can be set.
    pub settings: ViewSettings,
    /// What the picture shows.
    pub shown: Shown,
    /// Where the camera is and was; with the camera of the scene once there is one.
    pub navigation: Navigation,
    /// Views to come back to.
    pub views: NamedViews,
    /// The scene, once it is read.
    pub scene: Option<KnownScene>,
    /// What was picked last.
    pub picked: Option<PickedObject>,
    /// The last picture.
    pub frame: Option<Box<Frame>>,
    /// What renders.
    pub device: String,
    /// Whether that only stands in for the chosen device.
    pub stands_in: bool,
    /// Names of the graphics cards in the order of their numbers.
    pub gpus: Vec<String>,
    /// What there is to say.
    pub messages: Messages,
    /// File name for pictures.
    pub output: String,
    /// The picture that is being saved, and how much of it is done.
    pub saving: Option<(PathBuf, f32)>,
    /// Whether the panel is there.
    pub has_panel: bool,
    /// Whether the list of keys is there.
    pub has_help: bool,
    /// The part of the window that the picture has, in pixels of the screen.
    pub area: Area,
    /// Pixels of the screen per point.
    pub scale: f32,
    /// Whether nobody sees the window.
    pub is_hidden: bool,
    /// When the camera was moved last.
    moved: Option<f64>,
    /// What the other thread was asked to prepare.
    prepared: Option<Wanted>,
    errands: Vec<Errand>,
    /// Text for the clipboard.
    copied: Option<String>,
    views_path: PathBuf,
}

/// A camera rests when it was not moved for this time, in seconds.
const AT_REST: f64 = 0.15;
/// Radians per point of a drag.
const TURN: f64 = 0.008;
/// Share of the distance to the middle that is flown in a second.
const SPEED: f64 = 0.8;

impl Session {
    /// Begins before the scene is read.
    pub fn new(project: &Path, given: GivenWords, settings: ViewSettings, output: String) -> Self {
        let views_path = NamedViews::path(project);
        let mut messages = Messages::default();
        let views = NamedViews::read(&views_path).unwrap_or_else(|problem| {
            messages.error(problem, 0.0);
            NamedViews::default()
        });
        Session {
            project: project.to_owned(),
            given,
            settings,
            shown: Shown::default(),
            navigation: Navigation::new(Camera::default(), None),
            views,
            scene: None,
            picked: None,
            frame: None,
            device: String::new(),
            stands_in: false,
            gpus: Vec::new(),
            messages,
            output,
            saving: None,
            has_panel: true,
            has_help: false,
            area: Area::default(),
            scale: 1.0,
            is_hidden: false,
            moved: None,
            prepared: None,
            errands: Vec::new(),
            copied: None,
            views_path,
        }
    }

    /// Takes note of what happened.
    pub fn hear(&mut self, event: Event, time: f64) {
        match event {
            Event::Frame(frame) => {
                if self.frame.is_none() {
                    self.messages.note(format!("first picture after {time:.2} s"));
                }
                let was_done = self.frame.as_ref().is_some_and(|old| old.is_done);
                if frame.is_done && !was_done {
                    let per_pixel = frame.samples;
                    self.messages
                        .note(format!("complete: {per_pixel} samples per pixel in {:.1} s", frame.seconds));
                }
                self.frame = Some(frame);
            }
            Event::SceneRead(news) => {
                let bounds = news.scene.bounds();
                let camera = news.scene.camera.clone();
                match &self.scene {
                    None => self.navigation = Navigation::new(camera, bounds),
                    Some(_) => self.navigation.set_scene(camera, bounds),
                }
                let objects = news.scene.drawn_objects();
                self.messages.note(format!("read {objects} objects in {:.2} s", news.seconds));
                if !news.warnings.is_empty() && self.scene.is_none() {
                    let count = news.warnings.len();
                    self.messages.info(format!("{count} remarks about the project: see the panel"), time);
                } else if news.is_reread {
                    self.messages.info("the scene was read again".to_owned(), time);
                }
                self.scene = Some(news);
                self.picked = None;
            }
            Event::NothingNew => {
                self.messages.info("the project was saved; its scene is the same".to_owned(), time)
            }
            Event::ProjectChanged => {
                if let Some(wanted) = self.prepared.clone() {
                    self.errands.push(Errand::Prepare { wanted, reread: true });
                }
            }
            Event::SceneFailed(reason) => {
                let still =
                    if self.scene.is_some() { "; the picture is that of the last good one" } else { "" };
                self.messages.error(format!("the scene cannot be read{still}: {reason}"), time);
            }
            Event::DeviceReady { name, stands_in } => {
                if !stands_in {
                    self.messages.note(format!("renders on {name}"));
                }
                self.device = name;
                self.stands_in = stands_in;
            }
            Event::DeviceFailed(reason) => {
                self.stands_in = false;
                // So that the command line tells the truth, and a card that comes back is opened anew.
                self.settings.device = DeviceChoice::Cpu;
                self.messages.error(format!("the processor goes on, because {reason}"), time);
            }
            Event::Gpus(names) => self.gpus = names,
            Event::Refused(reason) => self.messages.error(reason, time),
            Event::Saving { path, share } => self.saving = Some((path, share)),
            Event::Saved { path, seconds } => {
                self.saving = None;
                self.messages.info(format!("saved {} in {seconds:.1} s", path.display()), time);
            }
            Event::SaveFailed { path, reason } => {
                self.saving = None;
                self.messages.error(format!("{} cannot be saved: {reason}", path.display()), time);
            }
        }
    }

    /// Does what the user wants, at a time in seconds.
    pub fn act(&mut self, action: Action, time: f64) {
        let line = self.navigation.line();
        let turn = |drag: Vec2| (f64::from(drag.x) * TURN, f64::from(drag.y) * TURN);
        match action {
            Action::Orbit(drag) => {
                let (yaw, pitch) = turn(drag);
                self.go(Movement::Orbit, line.orbited(yaw, -pitch), time);
            }
            Action::Look(drag) => {
                let (yaw, pitch) = turn(drag);
                self.go(Movement::Look, line.looked(yaw, -pitch), time);
            }
            Action::Pan(drag) => {
                let width = f64::from(self.picture_area().width.max(1) as f32 / self.scale);
                let share = |points: f32| f64::from(points) / width;
                self.go(Movement::Pan, line.panned(-share(drag.x), share(drag.y)), time);
            }
            Action::Zoom(factor) => self.go(Movement::Zoom, line.zoomed(f64::from(factor)), time),
            Action::Widen(extent) => {
                self.go(Movement::Widen, SightLine { extent, ..line }, time);
            }
            Action::Fly(way) => {
                let [right, up, forward] = way.map(|share| f64::from(share) * SPEED);
                self.go(Movement::Fly, line.flown(right, up, forward), time);
            }
            Action::FrameAll => {
                let Area { width, height, .. } = self.picture_area();
                self.navigation.frame_all(time, height as f64 / width.max(1) as f64);
                self.moved = Some(time);
            }
            Action::Home => self.navigation.go_home(time),
            Action::Undo => {
                if !self.navigation.undo() {
                    self.messages.info("there is nothing to undo".to_owned(), time);
                }
            }
            Action::Redo => {
                self.navigation.redo();
            }
            Action::Recall(place) => self.recall(place, time),
            Action::Store(place) => self.store(place, time),
            Action::Pick(at) => self.pick(at, false, time),
            Action::Centre(at) => self.pick(at, true, time),
            Action::Unpick => {
                self.picked = None;
                self.has_help = false;
            }
            Action::Depth(by) => {
                let depth = &mut self.settings.render.depth;
                *depth = depth.saturating_add_signed(by).clamp(1, 1000);
                self.messages.info(format!("depth {depth}"), time);
            }
            Action::Samples(by) => {
                let samples = &mut self.settings.render.samples;
                *samples = if by > 0 { samples.saturating_mul(2) } else { (*samples / 2).max(1) };
                self.messages.info(format!("samples {samples}"), time);
            }
            Action::Expose(stops) => {
                let now =
                    self.settings.exposure.or(self.frame.as_ref().map(|frame| frame.exposure)).unwrap_or(0.0);
                // In steps that read well.
                let next = (((now + stops) / 0.25).round() * 0.25).clamp(-100.0, 100.0);
                self.settings.exposure = Some(next);
            }
            Action::Show(by) => {
                let count = Shown::ALL.len() as i32;
                let now = Shown::ALL.iter().position(|shown| *shown == self.shown).unwrap_or(0) as i32;
                self.shown = Shown::ALL[(now + by).rem_euclid(count) as usize];
            }
            Action::Save => self.save(time),
            Action::Copy => {
                let line = self.command_line();
                self.messages.note(format!("command: {line}"));
                self.copied = Some(line);
                self.messages.info("the command line was copied".to_owned(), time);
            }
            Action::TogglePanel => self.has_panel = !self.has_panel,
            Action::ToggleHelp => self.has_help = !self.has_help,
        }
    }

    fn go(&mut self, movement: Movement, to: SightLine, time: f64) {
        if self.scene.is_some() {
            self.navigation.go(movement, time, to);
            self.moved = Some(time);
        }
    }

    /// Goes to a view of the list.
    fn recall(&mut self, place: usize, time: f64) {
        let Some(view) = self.views.views.get(place) else {
            let text = format!("there is no view {}; Ctrl {} keeps this one", place + 1, place + 1);
            return self.messages.info(text, time);
        };
        match view.line(&self.navigation.line()) {
            Some(line) => {
                self.messages.info(view.name.clone(), time);
                self.navigation.go(Movement::Jump, time, line);
            }
            None => {
                self.messages.error(format!("{} cannot be used: its numbers make no view", view.name), time)
            }
        }
    }

    fn store(&mut self, place: usize, time: f64) {
        let line = self.navigation.line();
        if let Some(name) = self.views.put(place, &line).map(str::to_owned) {
            self.write_views(format!("this is {name} now"), time);
        }
    }

    /// Writes the list of views.
    pub fn write_views(&mut self, done: String, time: f64) {
        match self.views.write(&self.views_path) {
            Ok(()) => self.messages.info(done, time),
            Err(problem) => self.messages.error(problem, time),
        }
    }

    fn pick(&mut self, at: Pos2, centre: bool, time: f64) {
        let area = self.picture_area();
        let pixel = |point: f32, first: usize| f64::from(point * self.scale) - first as f64;
        let (x, y) = (pixel(at.x, area.x), pixel(at.y, area.y));
        let Some(scene) = &self.scene else { return };
        let Ok(view) = scene.compiled.view(&self.navigation.camera()) else { return };
        let size = (area.width.max(1) as u32, area.height.max(1) as u32);
        let found = pick(&scene.compiled, &view, size, (x, y));
        self.picked = found.map(|what| {
            let material = scene.scene.materials.get(what.material as usize).map(material_name);
            let kind = material.unwrap_or("of a refracting body");
            let material = format!("{} ({kind})", what.material + 1);
            PickedObject { what, material }
        });
        match &self.picked {
            None => self.messages.note("picked nothing".to_owned()),
            Some(PickedObject { what, material }) => {
                let [x, y, z] = what.position.to_array();
                let node = what.origin.node;
                self.messages.note(format!(
                    "picked {} node {node} material {material} at {x:.4},{y:.4},{z:.4}",
                    what.type_name
                ));
                if centre {
                    let line = self.navigation.line().centred(what.position);
                    self.navigation.go(Movement::Jump, time, line);
                }
            }
        }
    }

    fn save(&mut self, time: f64) {
        let path = PathBuf::from(self.output.trim());
        if let Err(error) = PictureFormat::from_path(&path) {
            return self.messages.error(error.to_string(), time);
        }
        if self.saving.is_some() {
            return self.messages.info("one picture after the other, please".to_owned(), time);
        }
        self.messages.note(format!("command: {}", self.command_line()));
        self.saving = Some((path.clone(), 0.0));
        let order = SaveOrder {
            path,
            settings: self.settings.render.clone(),
            camera: self.navigation.camera(),
            exposure: self.settings.exposure,
            tone_curve: self.settings.tone_curve,
            words: self.command(),
        };
        self.errands.push(Errand::Save(Box::new(order)));
    }

    /// The command that makes the picture.
    pub fn command_line(&self) -> String {
        shell_line(&self.command())
    }

    fn command(&self) -> Vec<String> {
        let output = Some(self.output.trim()).filter(|output| !output.is_empty());
        let sight: &Sight = self.navigation.sight();
        render_words(&self.given, &self.settings, sight, output)
    }

    /// The part of the window, in pixels, that the picture covers.
    pub fn picture_area(&self) -> Area {
        let Area { x, y, width, height } = self.area;
        let edge = |pixels: usize| pixels.min(LONGEST_EDGE as usize) as u32;
        let (own_width, own_height) = self.settings.shown_size((edge(width), edge(height)));
        let (own_width, own_height) = (own_width as usize, own_height as usize);
        Area {
            x: x + width.saturating_sub(own_width) / 2,
            y: y + height.saturating_sub(own_height) / 2,
            width: own_width,
            height: own_height,
        }
    }

    /// Where in the window, in points, the picture shows a position of the world; `None` behind the camera.
    pub fn on_screen(&self, position: DVec3) -> Option<Pos2> {
        let camera = self.navigation.camera();
        let seen = camera.view_from_world.transform_point3(position);
        let (half_width, aspect) = match camera.projection {
            Projection::Perspective { fov_x, aspect } if seen.z < 0.0 => {
                (-seen.z * (0.5 * fov_x).tan(), aspect)
            }
            Projection::Perspective { .. } => return None,
            Projection::Parallel { width, aspect } => (0.5 * width, aspect),
        };
        let area = self.picture_area();
        let pixels = 0.5 * area.width as f64 / half_width;
        let x = area.x as f64 + 0.5 * area.width as f64 + seen.x * pixels;
        let y = area.y as f64 + 0.5 * area.height as f64 - seen.y * pixels / aspect;
        Some(Pos2::new(x as f32, y as f32) / self.scale)
    }

    /// Whether the camera is in motion at a time.
    pub fn is_moving(&self, time: f64) -> bool {
        self.moved.is_some_and(|moved| (0.0..AT_REST).contains(&(time - moved)))
    }

    /// What the window wants to show now; `None` before there is a scene.
    pub fn request(&mut self, time: f64) -> Option<Request> {
        self.settings.follow((self.area.width as u32, self.area.height as u32));
        self.scene.as_ref()?;
        let Area { width, height, .. } = self.picture_area();
        Some(Request {
            camera: self.navigation.camera(),
            settings: self.settings.shown((width as u32, height as u32)),
            shown: self.shown,
            exposure: self.settings.exposure,
            tone_curve: self.settings.tone_curve,
            is_moving: self.is_moving(time),
            is_hidden: self.is_hidden,
        })
    }

    /// What the other thread has to do now.
    pub fn errands(&mut self) -> Vec<Errand> {
        let wanted = Wanted {
            sun: self.settings.sun,
            turbidity: self.settings.turbidity,
            visible_layers: self.settings.visible_layers,
            device: self.settings.device,
            renderer: self.settings.render.renderer,
        };
        // Another renderer alone is compiled when it is needed.
        let same = |old: &Wanted| Wanted { renderer: wanted.renderer, ..old.clone() } == wanted;
        if !self.prepared.as_ref().is_some_and(same) {
            self.prepared = Some(wanted.clone());
            self.errands.push(Errand::Prepare { wanted, reread: false });
        }
        std::mem::take(&mut self.errands)
    }

    /// Text for the clipboard, once.
    pub fn take_copied(&mut self) -> Option<String> {
        self.copied.take()
    }
}

/// A kind of material in words.
fn material_name(material: &Material) -> &'static str {
    match material {
        Material::Rgba { .. } => "RGBA",
        Material::Phong(_) => "Phong",
        Material::SideSwitch { .. } => "two-sided",
    }
}

#[cfg(test)]
mod tests;
