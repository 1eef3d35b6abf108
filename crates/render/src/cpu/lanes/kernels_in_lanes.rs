//! What all kernels with lanes have in common: how they are included, how pixels are brought to them, and what they call.

/// Defines the kernels of a processor for all kinds of scenes, given the module of its lanes, what it must have, and the
/// files of the kernels; and `render_pixels`, which executes them.
macro_rules! kernels_of_processor {
    ($lanes:path, $processor:literal, $small:literal, $large:literal, $general:literal) => {
        /// For small scenes of plain materials: every lane searches on its own.
        mod small {
            kernels_in_lanes!($lanes, $processor, PLAIN_FEATURES, $small);
            pixels_in_groups!($processor);
        }

        /// For large scenes of plain materials: rays take turns.
        mod large {
            kernels_in_lanes!($lanes, $processor, PLAIN_FEATURES, $large);
            pixels_in_turns!($processor);
        }

        /// For all scenes: rays take turns.
        mod general {
            kernels_in_lanes!($lanes, $processor, ALL_FEATURES, $general);
            pixels_in_turns!($processor);
        }

        use super::Kind;
        use crate::cpu::CpuScene;
        use ::kernels::records::kernel::{FilmPixel, LaunchSettings};

        /// Adds the samples of a launch to some pixels, given where they are.
        #[target_feature(enable = $processor)]
        pub(super) fn render_pixels(
            scene: &CpuScene,
            kind: Kind,
            launch: LaunchSettings,
            places: &[(u32, u32)],
            pixels: &mut [FilmPixel],
        ) {
            let nodes = &scene.lane_nodes;
            match kind {
                Kind::Small => small::render_pixels(scene.slices(), launch, places, pixels),
                Kind::Large => large::render_pixels(scene.slices(), nodes, launch, places, pixels),
                Kind::General => general::render_pixels(scene.slices(), nodes, launch, places, pixels),
            }
        }
    };
}

/// Defines `render_pixels`, which takes one group of pixels after another.
macro_rules! pixels_in_groups {
    ($processor:literal) => {
        /// Adds the samples of a launch to some pixels, given where they are.
        #[target_feature(enable = $processor)]
        pub(super) fn render_pixels(
            slices: Slices<'_, FEATURES>,
            launch: LaunchSettings,
            places: &[(u32, u32)],
            pixels: &mut [FilmPixel],
        ) {
            use wgsl_rs::std::vec3f;
            let own = kernel::Own::new();
            let globals = globals(slices, launch, &own);
            let settings = globals.SETTINGS;
            for (places, pixels) in places.chunks(unit::LANES).zip(pixels.chunks_mut(unit::LANES)) {
                let float = |value: fn(&FilmPixel) -> f32| {
                    let mut lanes = [0.0; unit::LANES];
                    lanes.iter_mut().zip(pixels.iter()).for_each(|(lane, pixel)| *lane = value(pixel));
                    unit::F32::from_array(lanes)
                };
                let integer = |value: fn(&FilmPixel) -> u32| {
                    let mut lanes = [0; unit::LANES];
                    lanes.iter_mut().zip(pixels.iter()).for_each(|(lane, pixel)| *lane = value(pixel));
                    unit::U32::from_array(lanes)
                };
                let before = kernel::FilmPixel {
                    radiance: V3 {
                        x: float(|pixel| pixel.radiance.x),
                        y: float(|pixel| pixel.radiance.y),
                        z: float(|pixel| pixel.radiance.z),
                    },
                    rays: integer(|pixel| pixel.rays),
                    squares: V3 {
                        x: float(|pixel| pixel.squares.x),
                        y: float(|pixel| pixel.squares.y),
                        z: float(|pixel| pixel.squares.z),
                    },
                    samples: integer(|pixel| pixel.samples),
                };
                let (mut x, mut y) = ([0; unit::LANES], [0; unit::LANES]);
                for ((x, y), place) in x.iter_mut().zip(&mut y).zip(places) {
                    (*x, *y) = *place;
                }
                let after = kernel::render_pixel_Buffers(
                    &globals,
                    unit::Mask::first(pixels.len()),
                    kernel::UniformBuffers { unused: 0 },
                    settings,
                    unit::U32::from_array(x),
                    unit::U32::from_array(y),
                    before,
                );
                let three = |v: V3<unit::F32>| [v.x.to_array(), v.y.to_array(), v.z.to_array()];
                let (radiance, squares) = (three(after.radiance), three(after.squares));
                let (rays, samples) = (after.rays.to_array(), after.samples.to_array());
                for (i, pixel) in pixels.iter_mut().enumerate() {
                    *pixel = FilmPixel {
                        radiance: vec3f(radiance[0][i], radiance[1][i], radiance[2][i]),
                        rays: rays[i],
                        squares: vec3f(squares[0][i], squares[1][i], squares[2][i]),
                        samples: samples[i],
                    };
                }
            }
        }
    };
}

/// Defines `render_pixels`, which follows several groups of paths.
macro_rules! pixels_in_turns {
    ($processor:literal) => {
        use crate::cpu::lanes::LaneNode;

        mod in_turns {
            include!("in_turns.rs");
        }
        mod pixels_in_turns {
            include!("pixels_in_turns.rs");
        }

        /// Adds the samples of a launch to some pixels, given where they are.
        #[target_feature(enable = $processor)]
        pub(super) fn render_pixels(
            slices: Slices<'_, FEATURES>,
            nodes: &[LaneNode],
            launch: LaunchSettings,
            places: &[(u32, u32)],
            pixels: &mut [FilmPixel],
        ) {
            let own = kernel::Own::new();
            let globals = globals(slices, launch, &own);
            // SAFETY: this function has what the kernels are compiled for.
            unsafe { pixels_in_turns::render_pixels(&globals, slices, nodes, launch, places, pixels) };
        }
    };
}

/// Defines the module `kernel` with the kernels of a file, and `globals`, which makes what they know.
macro_rules! kernels_in_lanes {
    ($lanes:path, $processor:literal, $scene:ident, $file:literal) => {
        #[allow(unused_imports)]
        use crate::cpu::slices::{PLAIN_FEATURES, Slices};
        #[allow(unused_imports)]
        use ::kernels::records::kernel::{
            ALL_FEATURES, FEATURE_MANY_NODES, FilmPixel, LaunchSettings, SceneAccess,
        };
        use bytemuck::cast_slice;
        use lanes::{Table, V3};
        #[allow(unused_imports)]
        use std::cell::RefCell;
        use $lanes as unit;

        /// What scenes of this kind may have.
        const FEATURES: u32 = $scene;

        #[allow(
            non_snake_case,
            unused_assignments,
            unused_braces,
            unused_imports,
            unused_labels,
            unused_mut,
            unused_parens,
            unused_variables,
            unreachable_code,
            dead_code,
            clippy::all
        )]
        pub(super) mod kernel {
            use super::*;
            use lanes::vector::*;
            use lanes::*;
            use $lanes::*;
            include!(concat!(env!("OUT_DIR"), $file));
        }

        // `build.rs` and the list of what plain scenes lack must not part.
        const _: () = assert!((kernel::FEATURES ^ FEATURES) & !FEATURE_MANY_NODES == 0);

        /// What kernels know about a scene and a launch.
        #[target_feature(enable = $processor)]
        fn globals<'a>(
            slices: Slices<'a, FEATURES>,
            launch: LaunchSettings,
            own: &'a kernel::Own,
        ) -> kernel::Globals<'a> {
            let scene = slices.scene();
            let (header, launch) = ([SceneAccess::header(slices)], [launch]);
            kernel::Globals {
                own,
                ATTRIBUTES: Table::new(cast_slice(&scene.attributes)),
                OBJECTS: Table::new(cast_slice(&scene.objects)),
                TEXELS: Table::new(&scene.texels),
                CHANNELS: Table::new(cast_slice(&scene.channels)),
                MATERIALS: Table::new(cast_slice(&scene.materials)),
                NODES: Table::new(cast_slice(&scene.nodes)),
                LIGHTS: Table::new(cast_slice(&scene.lights)),
                HEADER: kernel::read_HEADER(Table::new(cast_slice(&header))),
                SETTINGS: kernel::read_SETTINGS(Table::new(cast_slice(&launch))),
            }
        }
    };
}
