//! What lies over the picture: messages, the list of keys, and a word where there is no picture yet.

use crate::actions::{Action, KEYS};
use crate::session::{PickedObject, Session};
use crate::style::{ACCENT, DIM, ERROR};
use egui::{Align2, Area, Color32, Frame, Grid, Id, Label, Rect, RichText, Stroke, Ui, Vec2};

/// Draws it over the picture's part of the window.
pub fn overlay(ui: &Ui, session: &mut Session, picture: Rect, time: f64) -> Vec<Action> {
    let mut actions = Vec::new();
    if session.frame.is_none() {
        let text = if session.scene.is_some() { "rendering ..." } else { "reading the scene ..." };
        let painter = ui.painter();
        painter.text(picture.center(), Align2::CENTER_CENTER, text, egui::FontId::proportional(18.0), DIM);
    }
    messages(ui, session, picture, time);
    picked(ui, session, picture);
    if session.has_help && help(ui, picture) {
        actions.push(Action::ToggleHelp);
    }
    if !session.has_help {
        let painter = ui.painter();
        let at = picture.right_bottom() - Vec2::new(10.0, 8.0);
        let faint = Color32::from_white_alpha(110);
        painter.text(at, Align2::RIGHT_BOTTOM, "F1  keys", egui::FontId::proportional(12.0), faint);
    }
    actions
}

fn messages(ui: &Ui, session: &mut Session, picture: Rect, time: f64) {
    let shown = session.messages.shown(time).to_vec();
    if shown.is_empty() {
        return;
    }
    let mut closed = None;
    Area::new(Id::unique("messages"))
        .fixed_pos(picture.left_bottom() + Vec2::new(12.0, -12.0))
        .pivot(Align2::LEFT_BOTTOM)
        .show(ui.ctx(), |ui| {
            ui.set_max_width((picture.width() - 24.0).clamp(120.0, 640.0));
            for message in &shown {
                let fill = if message.is_error { ERROR } else { Color32::from_black_alpha(190) };
                Frame::new().fill(fill).inner_margin(8.0).corner_radius(4.0).show(ui, |ui| {
                    ui.horizontal(|ui| {
                        ui.add(Label::new(RichText::new(&message.text).color(Color32::WHITE)).wrap());
                        if message.is_error && ui.small_button("x").clicked() {
                            closed = Some(message.text.clone());
                        }
                    });
                });
            }
        });
    if let Some(text) = closed {
        session.messages.close(&text);
    }
}

/// What was picked.
fn picked(ui: &Ui, session: &Session, picture: Rect) {
    let Some(PickedObject { what, material }) = &session.picked else { return };
    if let Some(at) = session.on_screen(what.position).filter(|at| picture.contains(*at)) {
        ui.painter().circle_stroke(at, 5.0, Stroke::new(3.0, Color32::from_black_alpha(160)));
        ui.painter().circle_stroke(at, 5.0, Stroke::new(1.5, ACCENT));
    }
    Area::new(Id::unique("picked")).fixed_pos(picture.left_top() + Vec2::new(12.0, 12.0)).show(
        ui.ctx(),
        |ui| {
            Frame::new().fill(Color32::from_black_alpha(200)).inner_margin(10.0).corner_radius(5.0).show(
                ui,
                |ui| {
                    let (package, class) = what.type_name.rsplit_once('.').unwrap_or(("", &what.type_name));
                    ui.label(RichText::new(class).size(16.0).strong().color(ACCENT));
                    if !package.is_empty() {
                        ui.label(RichText::new(package).small().color(DIM));
                    }
                    ui.add_space(4.0);
                    Grid::new("picked").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
                        let mut row = |name: &str, value: String| {
                            ui.label(RichText::new(name).color(DIM));
                            ui.label(RichText::new(value).color(Color32::WHITE));
                            ui.end_row();
                        };
                        row("node", what.origin.node.to_string());
                        if let Some((instance, name)) = &what.instance {
                            row("part of", format!("{name} (node {})", instance.node));
                        }
                        row("material", material.clone());
                        let [x, y, z] = what.position.to_array();
                        row("position", format!("{x:.3}, {y:.3}, {z:.3} m"));
                        let [x, y, z] = what.normal.to_array();
                        row("normal", format!("{x:.2}, {y:.2}, {z:.2}"));
                        row("distance", format!("{:.3} m", what.distance));
                    });
                },
            );
        },
    );
}

/// The list of keys; `true` to close it.
fn help(ui: &Ui, picture: Rect) -> bool {
    let mut is_closed = false;
    Area::new(Id::unique("keys")).fixed_pos(picture.center()).pivot(Align2::CENTER_CENTER).show(
        ui.ctx(),
        |ui| {
            Frame::new().fill(Color32::from_black_alpha(225)).inner_margin(16.0).corner_radius(6.0).show(
                ui,
                |ui| {
                    Grid::new("list of keys").num_columns(2).spacing([18.0, 4.0]).show(ui, |ui| {
                        for (key, meaning) in KEYS {
                            ui.label(RichText::new(key).color(ACCENT));
                            ui.label(RichText::new(meaning).color(Color32::WHITE));
                            ui.end_row();
                        }
                    });
                    is_closed = ui.button("close").clicked();
                },
            );
        },
    );
    is_closed
}
