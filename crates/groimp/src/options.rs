//! What a caller can choose about reading.

use crate::Limits;

/// How a project is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Bounds on what a file can make the reader do.
    pub limits: Limits,
    /// How far the triangles of curved surfaces may be away from them.
    pub flatness: Flatness,
    /// Colours of images are sRGB and not linear. GroIMP takes them for linear, and so does the default.
    pub srgb_textures: bool,
    /// Layers that are drawn, layer n as bit n, instead of those of the saved view.
    pub visible_layers: Option<u16>,
}

/// The largest distance between a curved surface and the triangles that are drawn instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flatness {
    /// In diagonals of the box round the surface.
    Relative(f64),
    /// In metres of the surface's own frame; a surface that is placed enlarged is drawn coarser by that.
    Metres(f64),
}

impl Default for Flatness {
    /// 1/2000 of the diagonal: half a pixel where the surface fills a picture of a thousand pixels.
    fn default() -> Self {
        Flatness::Relative(5e-4)
    }
}

impl Flatness {
    /// Finer than this, 32-bit positions make steps of their own.
    const FINEST: f64 = 1e-6;

    /// The tolerance in metres for a surface whose box has that diagonal; always positive.
    pub(crate) fn tolerance(self, diagonal: f64) -> f64 {
        let tolerance = match self {
            Flatness::Relative(part) => part * diagonal,
            Flatness::Metres(metres) => metres,
        };
        // Also where the caller gives a number that is none.
        tolerance.max(Self::FINEST * diagonal).max(f64::MIN_POSITIVE)
    }
}
