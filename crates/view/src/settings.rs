//! What can be set in the window; every setting has its name on the command line.

use render::{DeviceChoice, RenderSettings, ToneCurve};
use scene::SunPosition;

/// Everything that can be set besides the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewSettings {
    /// What to compute; width and height are those of the picture that is saved.
    pub render: RenderSettings,
    /// Whether the picture has the size of its part of the window.
    pub follows_window: bool,
    /// Brightness in stops; `None` chooses it from the picture.
    pub exposure: Option<f32>,
    /// What becomes of bright parts.
    pub tone_curve: ToneCurve,
    /// What computes.
    pub device: DeviceChoice,
    /// Where the sun stands instead of where the project has it, if there is a sky with a sun.
    pub sun: Option<SunPosition>,
    /// Haziness of the air instead of that of the project.
    pub turbidity: Option<f64>,
    /// Layers of GroIMP that are drawn, layer n as bit n, instead of those of the project.
    pub visible_layers: Option<u16>,
}

impl Default for ViewSettings {
    fn default() -> Self {
        ViewSettings {
            render: RenderSettings::default(),
            follows_window: true,
            exposure: None,
            tone_curve: ToneCurve::default(),
            device: DeviceChoice::Auto,
            sun: None,
            turbidity: None,
            visible_layers: None,
        }
    }
}

/// Longest edge of a picture in pixels, as on the command line.
pub const LONGEST_EDGE: u32 = 65536;

impl ViewSettings {
    /// Size in pixels of the picture within a part of the window: all of it, or the largest rectangle in it that is
    /// shaped as the picture that is saved.
    pub fn shown_size(&self, (width, height): (u32, u32)) -> (u32, u32) {
        let (width, height) = (width.max(1), height.max(1));
        if self.follows_window {
            return (width, height);
        }
        let (own_width, own_height) =
            (u64::from(self.render.width.max(1)), u64::from(self.render.height.max(1)));
        // Neither product exceeds 2^48.
        let by_width = (u64::from(width) * own_height / own_width).max(1);
        if by_width <= u64::from(height) {
            (width, by_width as u32)
        } else {
            ((u64::from(height) * own_width / own_height).max(1) as u32, height)
        }
    }

    /// The settings for a picture of a size in the window.
    pub fn shown(&self, (width, height): (u32, u32)) -> RenderSettings {
        RenderSettings { width, height, crop: None, ..self.render.clone() }
    }

    /// Takes note of the size of the picture's part of the window.
    pub fn follow(&mut self, (width, height): (u32, u32)) {
        if self.follows_window {
            self.render.width = width.clamp(1, LONGEST_EDGE);
            self.render.height = height.clamp(1, LONGEST_EDGE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_fills_its_part_of_the_window_or_keeps_its_shape() {
        let mut settings = ViewSettings::default();
        assert_eq!(settings.shown_size((900, 700)), (900, 700));
        settings.follow((900, 700));
        assert_eq!((settings.render.width, settings.render.height), (900, 700));
        settings.follows_window = false;
        settings.follow((100, 100));
        (settings.render.width, settings.render.height) = (4000, 1000);
        assert_eq!(settings.shown_size((800, 800)), (800, 200));
        assert_eq!(settings.shown_size((800, 100)), (400, 100));
        (settings.render.width, settings.render.height) = (1, 65536);
        assert_eq!(settings.shown_size((800, 800)), (1, 800));
    }
}
