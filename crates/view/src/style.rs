//! Colours and sizes. Dark and without colour of its own, so that the eye judges the picture and not the window.

use egui::{Color32, Context, CornerRadius, Stroke, Theme, Visuals};

/// Of what matters.
pub const ACCENT: Color32 = Color32::from_rgb(240, 196, 100);
/// Of what matters less.
pub const DIM: Color32 = Color32::from_rgb(150, 150, 150);
/// Of what is odd.
pub const WARNING: Color32 = Color32::from_rgb(235, 160, 80);
/// Of what went wrong, behind the text.
pub const ERROR: Color32 = Color32::from_rgb(120, 36, 30);
/// Behind the panel.
pub const PANEL: Color32 = Color32::from_rgb(36, 36, 38);
/// Beside the picture, as a [`Canvas`](crate::canvas::Canvas) has it.
pub const SURROUND: u32 = 0x0018_1818;

/// Sets them.
pub fn apply(context: &Context) {
    context.set_theme(Theme::Dark);
    let mut visuals = Visuals::dark();
    visuals.panel_fill = PANEL;
    visuals.extreme_bg_color = Color32::from_rgb(24, 24, 25);
    visuals.selection.bg_fill = Color32::from_rgb(112, 84, 28);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(255, 232, 180));
    visuals.override_text_color = Some(Color32::from_rgb(222, 222, 222));
    for widget in [
        &mut visuals.widgets.inactive,
        &mut visuals.widgets.hovered,
        &mut visuals.widgets.active,
        &mut visuals.widgets.open,
        &mut visuals.widgets.noninteractive,
    ] {
        widget.corner_radius = CornerRadius::same(3);
    }
    context.set_visuals_of(Theme::Dark, visuals);
    context.all_styles_mut(|style| {
        style.spacing.slider_width = 96.0;
        style.spacing.item_spacing = [6.0, 4.0].into();
        // Nothing moves but the picture; animations would only make it wait.
        style.animation_time = 0.0;
    });
}
