//! Where the camera is and was.

use crate::sight_line::{Bounds, SightLine};
use scene::Camera;

/// What the camera is.
#[derive(Clone, Debug, PartialEq)]
pub enum Sight {
    /// As the project has it, changed by the options of the command line.
    Given,
    /// Where the user moved it.
    Moved(SightLine),
}

/// Kinds of movement; movements of one kind in short succession are undone together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Movement {
    /// Round the middle of the picture.
    Orbit,
    /// Within the plane of the picture.
    Pan,
    /// Towards the middle or away from it.
    Zoom,
    /// By a wider or narrower angle.
    Widen,
    /// With the keys.
    Fly,
    /// On the spot.
    Look,
    /// To another place at once; never joined with the one before.
    Jump,
}

/// Movements of one kind with less than this time between them, in seconds, are one.
const TOGETHER: f64 = 0.7;
/// Most movements that can be undone.
const MOST_UNDONE: usize = 500;

/// The camera, and the movements that led to it.
#[derive(Clone, Debug)]
pub struct Navigation {
    given: Camera,
    bounds: Option<Bounds>,
    sight: Sight,
    before: Vec<Sight>,
    after: Vec<Sight>,
    last: Option<(Movement, f64)>,
}

impl Navigation {
    /// Begins with the camera of a scene with the given box.
    pub fn new(given: Camera, bounds: Option<Bounds>) -> Self {
        Navigation { given, bounds, sight: Sight::Given, before: Vec::new(), after: Vec::new(), last: None }
    }

    /// The scene was read again; a camera that was moved stays where it is.
    pub fn set_scene(&mut self, given: Camera, bounds: Option<Bounds>) {
        self.given = given;
        self.bounds = bounds;
    }

    /// What the camera is.
    pub fn sight(&self) -> &Sight {
        &self.sight
    }

    /// The camera for the renderer.
    pub fn camera(&self) -> Camera {
        match &self.sight {
            Sight::Given => self.given.clone(),
            Sight::Moved(line) => line.camera(),
        }
    }

    /// The camera as one moves it.
    pub fn line(&self) -> SightLine {
        match &self.sight {
            Sight::Given => SightLine::of(&self.given, self.bounds),
            Sight::Moved(line) => *line,
        }
    }

    /// Moves the camera at a time in seconds.
    pub fn go(&mut self, movement: Movement, time: f64, to: SightLine) {
        self.go_to(movement, time, Sight::Moved(to));
    }

    /// Back to the camera of the project.
    pub fn go_home(&mut self, time: f64) {
        self.go_to(Movement::Jump, time, Sight::Given);
    }

    /// Shows the whole scene in a picture whose height is `height` of its width.
    pub fn frame_all(&mut self, time: f64, height: f64) {
        if let Some(bounds) = self.bounds {
            self.go(Movement::Jump, time, self.line().framed(bounds, height));
        }
    }

    fn go_to(&mut self, movement: Movement, time: f64, sight: Sight) {
        if sight == self.sight {
            return;
        }
        let joined = self.last.is_some_and(|(last, when)| {
            last == movement && movement != Movement::Jump && (0.0..TOGETHER).contains(&(time - when))
        });
        if !joined {
            self.before.push(self.sight.clone());
            if self.before.len() > MOST_UNDONE {
                self.before.remove(0);
            }
        }
        self.after.clear();
        self.last = Some((movement, time));
        self.sight = sight;
    }

    /// Takes back the last movement; `false` if there is none.
    pub fn undo(&mut self) -> bool {
        Self::step(&mut self.sight, &mut self.before, &mut self.after, &mut self.last)
    }

    /// Takes back the last undoing.
    pub fn redo(&mut self) -> bool {
        Self::step(&mut self.sight, &mut self.after, &mut self.before, &mut self.last)
    }

    fn step(
        sight: &mut Sight,
        from: &mut Vec<Sight>,
        to: &mut Vec<Sight>,
        last: &mut Option<(Movement, f64)>,
    ) -> bool {
        let Some(other) = from.pop() else { return false };
        to.push(std::mem::replace(sight, other));
        *last = None;
        true
    }

    /// Whether there is something to undo, and something to redo.
    pub fn undoable(&self) -> (bool, bool) {
        (!self.before.is_empty(), !self.after.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::DVec3;

    fn navigation() -> Navigation {
        Navigation::new(Camera::default(), Some((DVec3::splat(-1.0), DVec3::splat(1.0))))
    }

    #[test]
    fn a_drag_is_one_movement_and_another_drag_another() {
        let mut at = navigation();
        for step in 0..10 {
            at.go(Movement::Orbit, f64::from(step) * 0.05, at.line().orbited(0.1, 0.0));
        }
        let first = at.line();
        at.go(Movement::Orbit, 5.0, at.line().orbited(0.1, 0.0));
        at.go(Movement::Pan, 5.1, at.line().panned(0.1, 0.0));
        assert!(at.undo() && at.undo());
        assert_eq!(at.line(), first);
        assert!(at.undo());
        assert_eq!(at.sight(), &Sight::Given);
        assert_eq!(at.camera(), Camera::default());
        assert!(!at.undo());
        assert!(at.redo());
        assert_eq!(at.line(), first);
    }

    #[test]
    fn a_new_movement_forgets_what_was_undone() {
        let mut at = navigation();
        at.go(Movement::Zoom, 0.0, at.line().zoomed(0.5));
        at.undo();
        at.go(Movement::Zoom, 0.1, at.line().zoomed(2.0));
        assert_eq!(at.undoable(), (true, false));
        assert!(!at.redo());
    }

    #[test]
    fn jumps_are_undone_one_by_one_and_nothing_is_no_movement() {
        let mut at = navigation();
        at.frame_all(0.0, 0.75);
        let framed = at.line();
        at.frame_all(0.1, 0.75);
        at.go_home(0.2);
        assert!(at.undo());
        assert_eq!(at.line(), framed);
        assert!(at.undo() && !at.undo());
    }

    #[test]
    fn the_camera_stays_when_the_scene_is_read_again() {
        let mut at = navigation();
        at.go(Movement::Orbit, 0.0, at.line().orbited(0.5, 0.0));
        let moved = at.camera();
        let other = Camera::look_at(DVec3::X, DVec3::ZERO, DVec3::Z, 1.0);
        at.set_scene(other.clone(), None);
        assert_eq!(at.camera(), moved);
        at.undo();
        assert_eq!(at.camera(), other);
    }

    #[test]
    fn the_list_of_movements_is_bounded() {
        let mut at = navigation();
        for step in 0..2 * MOST_UNDONE {
            at.go(Movement::Jump, 0.0, at.line().orbited(0.1 + step as f64 * 1e-3, 0.0));
        }
        assert_eq!(at.before.len(), MOST_UNDONE);
    }
}
