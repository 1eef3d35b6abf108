//! The panel beside the picture: what is computed, by what, and how to get it again.

use crate::actions::Action;
use crate::command_line::{device_name, filter_name, sampler_name};
use crate::session::Session;
use crate::settings::LONGEST_EDGE;
use crate::shown::Shown;
use crate::sight_line::Extent;
use crate::style::{DIM, WARNING};
use egui::{
    Align, Button, Checkbox, CollapsingHeader, ComboBox, DragValue, Frame, Grid, Label, Layout, Panel,
    ProgressBar, RichText, ScrollArea, Slider, SliderClamping, TextEdit, Ui,
};
use render::{DeviceChoice, Filter, Renderer, Sampler, ToneCurve};
use scene::{Sky, SunPosition};
use std::ops::RangeInclusive;

/// Width of the column of names in points.
const NAMES: f32 = 104.0;

/// Draws the panel; returns what the user wants.
pub fn panel(ui: &mut Ui, session: &mut Session, time: f64) -> Vec<Action> {
    let mut actions = Vec::new();
    // Saving and the command line are always in reach, however long the rest is.
    Panel::bottom("save").resizable(false).frame(Frame::new()).show(ui, |ui| {
        save(ui, session, &mut actions);
        ui.add_space(10.0);
    });
    header(ui, session);
    ui.add_space(6.0);
    shown(ui, session);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        section(ui, "Picture", true, |ui| picture_settings(ui, session));
        let sky = session.scene.as_ref().and_then(|scene| scene.scene.sky.as_ref());
        if let Some(daylight) = sky.and_then(Sky::daylight) {
            section(ui, "Daylight", true, |ui| daylight_settings(ui, session, daylight));
        }
        section(ui, "Layers", false, |ui| layers(ui, session));
        section(ui, "Camera", true, |ui| camera(ui, session, &mut actions, time));
        remarks(ui, session);
        ui.add_space(8.0);
    });
    actions
}

fn section(ui: &mut Ui, title: &str, is_open: bool, contents: impl FnOnce(&mut Ui)) {
    ui.add_space(4.0);
    let title = RichText::new(title).strong();
    CollapsingHeader::new(title).default_open(is_open).show_unindented(ui, |ui| {
        ui.add_space(2.0);
        contents(ui);
    });
}

/// Names at the left, values at the right.
fn grid(ui: &mut Ui, name: &str, rows: impl FnOnce(&mut Ui)) {
    Grid::new(name).num_columns(2).min_col_width(NAMES).spacing([8.0, 5.0]).show(ui, rows);
}

fn header(ui: &mut Ui, session: &Session) {
    ui.add_space(8.0);
    let name = session.project.file_stem().unwrap_or(session.project.as_os_str()).to_string_lossy();
    ui.add(Label::new(RichText::new(name).heading().strong()).truncate());
    let size = session.scene.as_ref().map_or("reading ...".to_owned(), |scene| {
        let triangles = scene.compiled.triangles();
        let objects = counted(scene.scene.drawn_objects(), "object");
        if triangles > 0 { format!("{objects}, {}", counted(triangles as u64, "triangle")) } else { objects }
    });
    ui.label(RichText::new(size).color(DIM));
    ui.add_space(6.0);
    let (share, text) = match &session.frame {
        None => (0.0, String::new()),
        Some(frame) => {
            let share =
                if frame.is_sharp { frame.samples as f32 / frame.most_samples.max(1) as f32 } else { 0.0 };
            let now = if frame.is_sharp { frame.samples } else { 0 };
            (share, format!("{now} of {} samples", frame.most_samples))
        }
    };
    ui.add(ProgressBar::new(share).desired_height(16.0).text(RichText::new(text).small()));
    ui.add_space(2.0);
    let facts = session.frame.as_ref().map_or(String::new(), |frame| {
        let noise = frame.noise.map_or(String::new(), |noise| format!("   noise {:.1} %", noise * 100.0));
        let rays = if frame.rays_per_second > 0.0 {
            format!("   {} rays/s", short(frame.rays_per_second))
        } else {
            String::new()
        };
        format!("{:.1} s{noise}{rays}", frame.seconds)
    });
    ui.label(RichText::new(facts).color(DIM));
    let stands_in = if session.stands_in { " - until the graphics card is ready" } else { "" };
    ui.add(Label::new(RichText::new(format!("{}{stands_in}", session.device)).color(DIM)).wrap());
}

fn shown(ui: &mut Ui, session: &mut Session) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 1.0;
        ui.spacing_mut().button_padding.x = 5.0;
        for shown in Shown::ALL {
            ui.selectable_value(&mut session.shown, shown, shown.name()).on_hover_text(shown.explanation());
        }
    });
}

fn picture_settings(ui: &mut Ui, session: &mut Session) {
    let gpus = &session.gpus;
    let exposed = session.frame.as_ref().map_or(0.0, |frame| frame.exposure);
    let settings = &mut session.settings;
    let render = &mut settings.render;
    grid(ui, "picture", |ui| {
        ui.label("renderer")
            .on_hover_text("pathtracer: all light, with noise. raytracer: direct light, as GroIMP's own");
        ui.horizontal(|ui| {
            for renderer in Renderer::ALL {
                ui.selectable_value(&mut render.renderer, renderer, renderer.name());
            }
        });
        ui.end_row();

        ui.label("samples").on_hover_text("Light paths per pixel; four times as many halve the noise");
        ui.add(DragValue::new(&mut render.samples).range(1..=1 << 20).speed(0.5));
        ui.end_row();

        ui.label("depth").on_hover_text("Surfaces that a path of light may touch; 1 is direct light only");
        ui.add(Slider::new(&mut render.depth, 1..=1000).logarithmic(true).integer());
        ui.end_row();

        if render.renderer == Renderer::RayTracer {
            ui.label("shadow-samples").on_hover_text("Shadow rays to every area light and sky");
            ui.add(Slider::new(&mut render.shadow_samples, 1..=1024).logarithmic(true).integer());
            ui.end_row();
        }

        ui.label("exposure").on_hover_text("Brightness in stops; the radiance itself is never changed");
        ui.horizontal(|ui| {
            let mut is_automatic = settings.exposure.is_none();
            if ui.add(Checkbox::new(&mut is_automatic, "auto")).changed() {
                settings.exposure = (!is_automatic).then_some((exposed * 20.0).round() / 20.0);
            }
            let mut stops = settings.exposure.unwrap_or(exposed);
            let value =
                DragValue::new(&mut stops).speed(0.05).range(-30.0..=30.0).fixed_decimals(2).suffix(" EV");
            if ui.add(value).changed() {
                settings.exposure = Some((stops * 20.0).round() / 20.0);
            }
        });
        ui.end_row();

        ui.label("tone-curve")
            .on_hover_text("Bright parts: srgb cuts off what is brighter than white, reinhard bends it down");
        ui.horizontal(|ui| {
            for curve in ToneCurve::ALL {
                ui.selectable_value(&mut settings.tone_curve, curve, curve.name());
            }
        });
        ui.end_row();

        ui.label("device").on_hover_text("What computes");
        let device_text = |choice: DeviceChoice| match choice {
            DeviceChoice::Gpu(number) => {
                let name = gpus.get(number.unwrap_or(0)).map_or("", String::as_str);
                format!("{}  {name}", device_name(choice))
            }
            other => device_name(other),
        };
        ComboBox::from_id_salt("device")
            .width(150.0)
            .truncate()
            .selected_text(device_text(settings.device))
            .show_ui(ui, |ui| {
                let cards = (0..gpus.len()).map(|number| DeviceChoice::Gpu(Some(number)));
                let together = [(2, DeviceChoice::AllGpus), (1, DeviceChoice::All)];
                let together = together.into_iter().filter(|(fewest, _)| gpus.len() >= *fewest);
                let cards = cards.chain(together.map(|(_, choice)| choice));
                for choice in [DeviceChoice::Auto, DeviceChoice::Cpu].into_iter().chain(cards) {
                    ui.selectable_value(&mut settings.device, choice, device_text(choice));
                }
            });
        ui.end_row();
    });
    CollapsingHeader::new(RichText::new("sampling").color(DIM)).show_unindented(ui, |ui| {
        grid(ui, "sampling", |ui| {
            ui.label("sampler").on_hover_text("How samples are spread");
            ui.horizontal(|ui| {
                for sampler in [Sampler::Sobol, Sampler::Independent] {
                    ui.selectable_value(&mut render.sampler, sampler, sampler_name(sampler));
                }
            });
            ui.end_row();
            ui.label("grid").on_hover_text("Cells of a pixel for the independent sampler");
            ui.add_enabled(
                render.sampler == Sampler::Independent,
                Slider::new(&mut render.grid, 1..=64).integer(),
            );
            ui.end_row();
            ui.label("filter").on_hover_text("How light around the middle of a pixel is weighted");
            ComboBox::from_id_salt("filter").selected_text(filter_name(render.filter)).show_ui(ui, |ui| {
                for filter in [Filter::Box, Filter::Tent, Filter::Gaussian, Filter::BlackmanHarris] {
                    ui.selectable_value(&mut render.filter, filter, filter_name(filter));
                }
            });
            ui.end_row();
            ui.label("seed").on_hover_text("Another number gives independent noise");
            ui.add(DragValue::new(&mut render.seed).speed(0.1));
            ui.end_row();
            ui.label("background").on_hover_text("Radiance behind a scene without a sky; it lights nothing");
            ui.horizontal(|ui| {
                for channel in &mut render.background {
                    ui.add(DragValue::new(channel).speed(0.01).range(0.0..=1e6).max_decimals(2));
                }
            });
            ui.end_row();
        });
    });
}

fn daylight_settings(ui: &mut Ui, session: &mut Session, (now, haze): (SunPosition, f64)) {
    let settings = &mut session.settings;
    let own = SunPosition { azimuth: now.azimuth, elevation: now.elevation };
    let mut sun = settings.sun.unwrap_or(own);
    let mut turbidity = settings.turbidity.unwrap_or(haze);
    grid(ui, "daylight", |ui| {
        ui.label("sun azimuth").on_hover_text("From the x axis towards the y axis");
        let azimuth = ui.add(slider(&mut sun.azimuth, -180.0..=180.0).suffix("°")).changed();
        ui.end_row();
        ui.label("sun elevation").on_hover_text("Above the horizon");
        let elevation = ui.add(slider(&mut sun.elevation, 0.0..=90.0).suffix("°")).changed();
        ui.end_row();
        if azimuth || elevation {
            settings.sun =
                Some(SunPosition { azimuth: tenths(sun.azimuth), elevation: tenths(sun.elevation) });
        }
        ui.label("turbidity").on_hover_text("Haziness of the air: 2 is very clear, 10 is hazy");
        if ui.add(slider(&mut turbidity, 1.7..=10.0)).changed() {
            settings.turbidity = Some(tenths(turbidity));
        }
        ui.end_row();
    });
    if (settings.sun.is_some() || settings.turbidity.is_some()) && ui.button("as in the project").clicked() {
        (settings.sun, settings.turbidity) = (None, None);
    }
}

/// A slider that changes its value only if the user does: by itself it would round it, and push it into its range.
fn slider(value: &mut f64, range: RangeInclusive<f64>) -> Slider<'_> {
    Slider::new(value, range).clamping(SliderClamping::Edits).fixed_decimals(1)
}

fn tenths(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// GroIMP's layers.
fn layers(ui: &mut Ui, session: &mut Session) {
    let Some(scene) = &session.scene else { return };
    let shown = session.settings.visible_layers.unwrap_or(scene.visible_layers);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for layer in 0..u16::BITS {
            let bit = 1 << layer;
            if ui.selectable_label(shown & bit != 0, layer.to_string()).clicked() {
                // Nothing at all is no picture.
                session.settings.visible_layers = Some(shown ^ bit).filter(|shown| *shown != 0);
            }
        }
    });
    if session.settings.visible_layers.is_some() && ui.button("as in the project").clicked() {
        session.settings.visible_layers = None;
    }
}

fn camera(ui: &mut Ui, session: &mut Session, actions: &mut Vec<Action>, time: f64) {
    let (undo, redo) = session.navigation.undoable();
    ui.horizontal(|ui| {
        for (name, hint, is_possible, action) in [
            ("frame all", "F", true, Action::FrameAll),
            ("home", "The camera of the project (Home)", true, Action::Home),
            ("undo", "Ctrl Z", undo, Action::Undo),
            ("redo", "Ctrl Y", redo, Action::Redo),
        ] {
            if ui.add_enabled(is_possible, Button::new(name)).on_hover_text(hint).clicked() {
                actions.push(action);
            }
        }
    });
    let line = session.navigation.line();
    grid(ui, "camera", |ui| {
        for (name, point) in [("position", line.eye), ("target", line.middle)] {
            ui.label(name);
            let text = format!("{:.3}, {:.3}, {:.3}", point.x, point.y, point.z);
            ui.label(RichText::new(text).monospace());
            ui.end_row();
        }
        let mut extent = line.extent;
        let is_changed = match &mut extent {
            Extent::Degrees(degrees) => {
                ui.label("fov").on_hover_text("Horizontal opening angle");
                let is_changed = ui.add(slider(degrees, 5.0..=150.0).suffix("°")).changed();
                *degrees = tenths(*degrees);
                is_changed
            }
            Extent::Metres(width) => {
                ui.label("parallel").on_hover_text("Width of the picture in metres");
                ui.add(DragValue::new(width).range(1e-6..=1e6).speed(0.01).suffix(" m")).changed()
            }
        };
        ui.end_row();
        if is_changed {
            session.act(Action::Widen(extent), time);
        }
    });
    let mut forgotten = None;
    let mut is_renamed = false;
    for (place, view) in session.views.views.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            let key = if place < 9 { format!("{}", place + 1) } else { "-".to_owned() };
            if ui.button(key).on_hover_text("Go to this view").clicked() {
                actions.push(Action::Recall(place));
            }
            is_renamed |= ui.add(TextEdit::singleline(&mut view.name).desired_width(150.0)).lost_focus();
            if ui.small_button("keep").on_hover_text("Put the camera of now in its place").clicked() {
                actions.push(Action::Store(place));
            }
            if ui.small_button("x").on_hover_text("Forget this view").clicked() {
                forgotten = Some(place);
            }
        });
    }
    if let Some(place) = forgotten {
        let gone = session.views.views.remove(place);
        session.write_views(format!("{} is forgotten", gone.name), time);
    }
    if is_renamed {
        session.write_views("the names of the views are saved".to_owned(), time);
    }
    if ui.button("keep this view").on_hover_text("In a small file beside the project; Ctrl 1 to 9").clicked()
    {
        actions.push(Action::Store(session.views.views.len()));
    }
}

fn save(ui: &mut Ui, session: &mut Session, actions: &mut Vec<Action>) {
    ui.add_space(8.0);
    grid(ui, "save", |ui| {
        ui.label("size").on_hover_text("Width and height of the saved picture in pixels");
        ui.horizontal(|ui| {
            let settings = &mut session.settings;
            let edge = |value| DragValue::new(value).range(1..=LONGEST_EDGE).speed(1.0);
            let changed = ui.add(edge(&mut settings.render.width)).changed();
            ui.label("x");
            let changed = changed | ui.add(edge(&mut settings.render.height)).changed();
            if changed {
                settings.follows_window = false;
            }
            ui.checkbox(&mut settings.follows_window, "window");
        });
        ui.end_row();
        ui.label("output").on_hover_text(".png to look at, .exr to measure in");
        ui.add(TextEdit::singleline(&mut session.output).desired_width(f32::INFINITY));
        ui.end_row();
    });
    ui.add_space(2.0);
    match &session.saving {
        Some((path, share)) => {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            ui.add(ProgressBar::new(*share).desired_height(16.0).text(RichText::new(name).small()));
        }
        None => {
            let text = RichText::new("save picture").strong();
            if ui
                .add(Button::new(text).min_size([ui.available_width(), 26.0].into()))
                .on_hover_text("Ctrl S")
                .clicked()
            {
                actions.push(Action::Save);
            }
        }
    }
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        ui.label(RichText::new("this picture from the command line").color(DIM));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.small_button("copy").on_hover_text("Ctrl C").clicked() {
                actions.push(Action::Copy);
            }
        });
    });
    let text = RichText::new(session.command_line()).monospace().size(11.0);
    Frame::new().fill(ui.visuals().extreme_bg_color).inner_margin(6.0).corner_radius(3.0).show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        ui.add(Label::new(text).wrap().selectable(true));
    });
}

/// What the reader left out or was unsure of.
fn remarks(ui: &mut Ui, session: &Session) {
    let Some(scene) = session.scene.as_ref().filter(|scene| !scene.warnings.is_empty()) else { return };
    let title = RichText::new(counted(scene.warnings.len() as u64, "remark")).color(WARNING);
    ui.add_space(4.0);
    CollapsingHeader::new(title).id_salt("remarks").show_unindented(ui, |ui| {
        for warning in scene.warnings.iter().take(200) {
            ui.add(Label::new(RichText::new(warning).small()).wrap());
        }
    });
}

fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A large number in few letters.
fn short(value: f64) -> String {
    match value {
        v if v >= 1e9 => format!("{:.2} G", v / 1e9),
        v if v >= 1e6 => format!("{:.1} M", v / 1e6),
        v if v >= 1e3 => format!("{:.0} k", v / 1e3),
        v => format!("{v:.0} "),
    }
}

#[cfg(test)]
mod tests;
