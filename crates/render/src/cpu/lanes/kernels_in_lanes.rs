//! What all kernels with lanes have in common: how they are included, how pixels are brought to them, and what they call.

/// Defines the kernels of a processor for all kinds of scenes, given the module of its lanes, what it must have, and the
/// files of the kernels; `render_pixels`, which executes them, and `Workspaces`.
macro_rules! kernels_of_processor {
    ($lanes:path, $processor:literal, $small:literal, $large:literal, $general:literal) => {
        /// For small scenes of plain materials: every lane searches on its own.
        mod small {
            kernels_in_lanes!($lanes, $processor, PLAIN_FEATURES, $small);
            pub(super) type Workspace = ();
        }

        /// For large scenes of plain materials: rays take turns.
        mod large {
            kernels_in_lanes!($lanes, $processor, PLAIN_FEATURES, $large);
            search_in_turns!($processor);
        }

        /// For all scenes: rays take turns.
        mod general {
            kernels_in_lanes!($lanes, $processor, ALL_FEATURES, $general);
            search_in_turns!($processor);
        }

        use super::Kind;
        use crate::cpu::CpuScene;
        use ::kernels::records::kernel::{FilmPixel, LaunchSettings};
        use std::cell::RefCell;

        /// What a thread uses again for every group of pixels.
        #[derive(Default)]
        pub(super) struct Workspaces {
            small: RefCell<small::Workspace>,
            large: RefCell<large::Workspace>,
            general: RefCell<general::Workspace>,
        }

        /// Adds the samples of a launch to some pixels, given where they are.
        #[target_feature(enable = $processor)]
        pub(super) fn render_pixels(
            scene: &CpuScene,
            kind: Kind,
            launch: LaunchSettings,
            workspaces: &Workspaces,
            places: &[(u32, u32)],
            pixels: &mut [FilmPixel],
        ) {
            let Workspaces { small, large, general } = workspaces;
            let nodes = &scene.lane_nodes;
            match kind {
                Kind::Small => small::render_pixels(scene.slices(), nodes, launch, small, places, pixels),
                Kind::Large => large::render_pixels(scene.slices(), nodes, launch, large, places, pixels),
                Kind::General => {
                    general::render_pixels(scene.slices(), nodes, launch, general, places, pixels)
                }
            }
        }
    };
}

/// Defines what kernels call for their searches, and what they need for it again and again.
macro_rules! search_in_turns {
    ($processor:literal) => {
        mod hooks {
            use super::kernel::{Found, Globals, Quest, Ray, UniformBuffers};
            use super::unit::{F32, Mask};

            #[allow(non_snake_case)]
            #[target_feature(enable = $processor)]
            pub(super) fn search_Buffers(
                globals: &Globals<'_>,
                live: Mask,
                scene: UniformBuffers,
                ray: Ray,
                t_max: F32,
                quest: Quest,
            ) -> Found {
                super::in_turns::search(globals, live, scene, ray, t_max, quest)
            }
        }

        mod in_turns {
            include!("in_turns.rs");
        }

        pub(super) type Workspace = in_turns::Travellers;
    };
}

/// Defines the module `kernel` with the kernels of a file, and `render_pixels`, which executes them.
macro_rules! kernels_in_lanes {
    ($lanes:path, $processor:literal, $scene:ident, $file:literal) => {
        use crate::cpu::lanes::LaneNode;
        #[allow(unused_imports)]
        use crate::cpu::slices::{PLAIN_FEATURES, Slices};
        #[allow(unused_imports)]
        use ::kernels::records::kernel::{
            ALL_FEATURES, FEATURE_MANY_NODES, FilmPixel, LaunchSettings, SceneAccess,
        };
        use bytemuck::cast_slice;
        use lanes::{Table, V3};
        use std::cell::RefCell;
        use wgsl_rs::std::vec3f;
        use $lanes as unit;

        /// What hooks are given, if there are any.
        #[derive(Clone, Copy)]
        #[allow(dead_code)]
        pub(super) struct Host<'a> {
            pub slices: Slices<'a, $scene>,
            /// Those of the scene, unless every lane searches on its own.
            pub nodes: &'a [LaneNode],
            pub workspace: &'a RefCell<Workspace>,
        }

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
        const _: () = assert!((kernel::FEATURES ^ $scene) & !FEATURE_MANY_NODES == 0);

        /// Adds the samples of a launch to some pixels, given where they are.
        #[target_feature(enable = $processor)]
        pub(super) fn render_pixels(
            slices: Slices<'_, $scene>,
            nodes: &[LaneNode],
            launch: LaunchSettings,
            workspace: &RefCell<Workspace>,
            places: &[(u32, u32)],
            pixels: &mut [FilmPixel],
        ) {
            let scene = slices.scene();
            let (header, launch) = ([SceneAccess::header(slices)], [launch]);
            let settings = kernel::read_SETTINGS(Table::new(cast_slice(&launch)));
            let own = kernel::Own::new();
            let globals = kernel::Globals {
                own: &own,
                host: Host { slices, nodes, workspace },
                ATTRIBUTES: Table::new(cast_slice(&scene.attributes)),
                OBJECTS: Table::new(cast_slice(&scene.objects)),
                TEXELS: Table::new(&scene.texels),
                CHANNELS: Table::new(cast_slice(&scene.channels)),
                MATERIALS: Table::new(cast_slice(&scene.materials)),
                NODES: Table::new(cast_slice(&scene.nodes)),
                LIGHTS: Table::new(cast_slice(&scene.lights)),
                HEADER: kernel::read_HEADER(Table::new(cast_slice(&header))),
                SETTINGS: settings,
            };
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
