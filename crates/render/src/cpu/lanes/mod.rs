//! The path tracer in the lanes of vector units: as many pixels at a time as there are lanes.
//!
//! The kernels are written by `build.rs` from the WGSL that graphics cards run, for every kind of processor and of scenes.
//! Pictures are those of the kernels without lanes, bit for bit.

#[macro_use]
mod kernels_in_lanes;
mod avx2;
mod avx512;
mod nodes;

pub(super) use nodes::LaneNode;

use super::{CpuScene, Lanes, is_plain};
use crate::{CompiledScene, Renderer};
use ::kernels::records::kernel::{FilmPixel, LaunchSettings};

/// Nodes of the largest scenes in which every lane searches on its own: measured, see docs/performance.md.
const NODES_IN_LANES: u32 = 100;

/// Kinds of scenes with kernels of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Few nodes and plain materials.
    Small,
    /// Many nodes and plain materials.
    Large,
    /// All others.
    General,
}

impl Kind {
    fn of(scene: &CompiledScene) -> Self {
        match is_plain(scene) {
            true if scene.header.nodes <= NODES_IN_LANES => Kind::Small,
            true => Kind::Large,
            false => Kind::General,
        }
    }
}

/// The nodes of a scene for searches in turns, if rays take turns in it.
pub(super) fn lane_nodes(scene: &CompiledScene, allowed: Lanes) -> Vec<LaneNode> {
    let in_turns = allowed.min(Lanes::supported()) != Lanes::One && Kind::of(scene) != Kind::Small;
    if in_turns { nodes::lane_nodes(scene) } else { Vec::new() }
}

impl Lanes {
    /// The most that this processor has.
    fn supported() -> Self {
        if avx512::is_supported() {
            Lanes::Sixteen
        } else if avx2::is_supported() {
            Lanes::Eight
        } else {
            Lanes::One
        }
    }
}

/// A scene and a launch for kernels with lanes, which this processor is able to execute.
#[derive(Clone, Copy)]
pub(super) struct LaneScene<'a> {
    scene: &'a CpuScene,
    kind: Kind,
    launch: LaunchSettings,
    /// Eight or sixteen.
    lanes: Lanes,
}

impl<'a> LaneScene<'a> {
    /// Nothing if there are no kernels with lanes for the renderer or this processor.
    pub(super) fn new(
        scene: &'a CpuScene,
        launch: LaunchSettings,
        renderer: Renderer,
        allowed: Lanes,
    ) -> Option<Self> {
        let kind = Kind::of(&scene.scene);
        let lanes = allowed.min(Lanes::supported());
        let exists = renderer == Renderer::PathTracer && lanes != Lanes::One;
        exists.then_some(LaneScene { scene, kind, launch, lanes })
    }

    /// Adds the samples of the launch to some pixels, given where they are.
    pub(super) fn render_pixels(&self, places: &[(u32, u32)], pixels: &mut [FilmPixel]) {
        let &LaneScene { scene, kind, launch, lanes } = self;
        // SAFETY: the constructor has asked for the features that the kernels are compiled for.
        unsafe {
            match lanes {
                Lanes::Sixteen => avx512::render_pixels(scene, kind, launch, places, pixels),
                Lanes::Eight => avx2::render_pixels(scene, kind, launch, places, pixels),
                Lanes::One => unreachable!("the constructor excludes it"),
            }
        }
    }
}
