//! What a user can do with mouse and keys.

use crate::sight_line::Extent;
use egui::{Key, Modifiers, PointerButton, Pos2, Response, Ui, Vec2};

/// Something that the user wants; positions and lengths are in points of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Turn round the middle of the picture by a drag.
    Orbit(Vec2),
    /// Shift the picture by a drag.
    Pan(Vec2),
    /// Turn the head by a drag.
    Look(Vec2),
    /// Go nearer for factors below 1, or farther away.
    Zoom(f32),
    /// See more or less from the same place.
    Widen(Extent),
    /// Fly to the right, upwards, forward; in units of what the keys are held.
    Fly([f32; 3]),
    /// Show all.
    FrameAll,
    /// Back to the camera of the project.
    Home,
    /// Take back the last movement.
    Undo,
    /// Take back the last undoing.
    Redo,
    /// Go to a named view, counted from 0.
    Recall(usize),
    /// Keep the camera as a named view, counted from 0.
    Store(usize),
    /// Tell what is at a point of the window.
    Pick(Pos2),
    /// Tell what is there, and turn round it from now on.
    Centre(Pos2),
    /// Forget what was picked.
    Unpick,
    /// One more or one less surface on every path of light.
    Depth(i32),
    /// Twice or half as many samples, as a power of two.
    Samples(i32),
    /// Brighter or darker by so many stops.
    Expose(f32),
    /// Show the next layer, or the one before.
    Show(i32),
    /// Save the picture.
    Save,
    /// Copy the command line.
    Copy,
    /// Show or hide the panel.
    TogglePanel,
    /// Show or hide the list of keys.
    ToggleHelp,
}

/// All keys with what they do, for the list of keys and the manual.
pub const KEYS: [(&str, &str); 20] = [
    ("left drag", "turn round the middle of the picture"),
    ("right or Shift drag", "shift the picture"),
    ("middle or Ctrl drag", "turn the head"),
    ("wheel", "go nearer, go away"),
    ("click", "what is this?"),
    ("double click", "turn round this point"),
    ("W A S D", "fly forward, left, back, right"),
    ("Q E", "fly down, up"),
    ("F", "show the whole scene"),
    ("Home", "the camera of the project"),
    ("Ctrl Z, Ctrl Y", "undo, redo camera moves"),
    ("1 to 9", "go to a named view"),
    ("Ctrl 1 to 9", "keep this view"),
    ("[ ]", "depth"),
    (", .", "half, twice the samples"),
    ("- +", "darker, brighter"),
    ("L, Shift L", "next layer: albedo, normal, ..."),
    ("Ctrl S, Ctrl C", "save the picture, copy the command"),
    ("H", "hide the panel"),
    ("F1, Esc", "these keys, close"),
];

const DIGITS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

/// Keys that are pressed, together with Ctrl (Cmd on a Mac) or alone. None while something is written.
pub fn key_actions(ui: &Ui) -> Vec<Action> {
    if ui.ctx().text_edit_focused() {
        return Vec::new();
    }
    ui.input_mut(|input| {
        let mut actions = Vec::new();
        let mut on = |modifiers: Modifiers, key: Key, action: Action| {
            if input.consume_key(modifiers, key) {
                actions.push(action);
            }
        };
        let (alone, command) = (Modifiers::NONE, Modifiers::COMMAND);
        for (place, key) in DIGITS.into_iter().enumerate() {
            on(command, key, Action::Store(place));
            on(alone, key, Action::Recall(place));
        }
        on(command | Modifiers::SHIFT, Key::Z, Action::Redo);
        on(command, Key::Z, Action::Undo);
        on(command, Key::Y, Action::Redo);
        on(command, Key::S, Action::Save);
        on(alone, Key::F, Action::FrameAll);
        on(alone, Key::Home, Action::Home);
        on(alone, Key::OpenBracket, Action::Depth(-1));
        on(alone, Key::CloseBracket, Action::Depth(1));
        on(alone, Key::Comma, Action::Samples(-1));
        on(alone, Key::Period, Action::Samples(1));
        on(alone, Key::Minus, Action::Expose(-0.25));
        on(alone, Key::Plus, Action::Expose(0.25));
        on(alone, Key::Equals, Action::Expose(0.25));
        on(Modifiers::SHIFT, Key::L, Action::Show(-1));
        on(alone, Key::L, Action::Show(1));
        on(alone, Key::H, Action::TogglePanel);
        on(alone, Key::F1, Action::ToggleHelp);
        on(alone, Key::Escape, Action::Unpick);
        // What Ctrl C becomes before it arrives here.
        let copied = input.events.iter().any(|event| matches!(event, egui::Event::Copy));
        if copied {
            actions.push(Action::Copy);
        }
        actions
    })
}

/// Keys that are held down: how far they fly in the time since the last look.
pub fn flying(ui: &Ui) -> Option<Action> {
    if ui.ctx().text_edit_focused() {
        return None;
    }
    ui.input(|input| {
        if input.modifiers.command || input.modifiers.ctrl || input.modifiers.alt {
            return None;
        }
        let axis = |back: Key, forth: Key| f32::from(input.key_down(forth)) - f32::from(input.key_down(back));
        let way = [axis(Key::A, Key::D), axis(Key::Q, Key::E), axis(Key::S, Key::W)];
        // A key that was pressed and let go between two looks counts a little.
        let time = input.stable_dt.clamp(0.01, 0.1);
        (way != [0.0; 3]).then(|| Action::Fly(way.map(|share| share * time)))
    })
}

/// What the mouse does with the picture.
pub fn mouse_actions(ui: &Ui, picture: &Response) -> Vec<Action> {
    let mut actions = Vec::new();
    let modifiers = ui.input(|input| input.modifiers);
    let drag = picture.drag_delta();
    if drag != Vec2::ZERO {
        let left = picture.dragged_by(PointerButton::Primary);
        if picture.dragged_by(PointerButton::Middle) || left && modifiers.command {
            actions.push(Action::Look(drag));
        } else if picture.dragged_by(PointerButton::Secondary) || left && modifiers.shift {
            actions.push(Action::Pan(drag));
        } else if left {
            actions.push(Action::Orbit(drag));
        }
    }
    if picture.contains_pointer() {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        if scroll != 0.0 {
            actions.push(Action::Zoom((-scroll * 0.005).exp()));
        }
        if pinch != 1.0 {
            actions.push(Action::Zoom(1.0 / pinch.max(0.01)));
        }
    }
    if let Some(at) = picture.interact_pointer_pos() {
        if picture.double_clicked() {
            actions.push(Action::Centre(at));
        } else if picture.clicked() {
            actions.push(Action::Pick(at));
        }
    }
    actions
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Context, Event, RawInput};

    fn pressed(key: Key, modifiers: Modifiers) -> Vec<Action> {
        let event = Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
        let input = RawInput { events: vec![event], focused: true, ..RawInput::default() };
        let mut actions = Vec::new();
        let mut output = Context::default().run_ui(input, |ui| actions = key_actions(ui));
        output.textures_delta.clear();
        actions
    }

    #[test]
    fn keys_alone_and_with_control_are_told_apart() {
        assert_eq!(pressed(Key::Num3, Modifiers::NONE), [Action::Recall(2)]);
        assert_eq!(pressed(Key::Num3, Modifiers::CTRL | Modifiers::COMMAND), [Action::Store(2)]);
        assert_eq!(pressed(Key::Z, Modifiers::CTRL | Modifiers::COMMAND), [Action::Undo]);
        assert_eq!(pressed(Key::Z, Modifiers::CTRL | Modifiers::COMMAND | Modifiers::SHIFT), [Action::Redo]);
        assert_eq!(pressed(Key::CloseBracket, Modifiers::NONE), [Action::Depth(1)]);
        assert_eq!(pressed(Key::X, Modifiers::NONE), []);
    }
}
