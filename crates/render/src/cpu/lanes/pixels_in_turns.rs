// The loop of `kernels::pixel::add_path_samples` in lanes: groups of paths whose rays are searched for together.
//
// A lane whose pixel has its samples takes the next one, so that lanes have work until there are no pixels left.
//
// This file is included where `kernel`, `unit` and `in_turns` are.

use super::in_turns::{GROUPS, GroupQuery, Travellers, lanes_of, search};
use super::kernel::{self, Globals, PathState, SampleKey, UniformBuffers};
use super::unit::{LANES, Mask, U32};
use crate::cpu::lanes::LaneNode;
use crate::cpu::slices::Slices;
use kernels::pixel::kernel::add_sample;
use kernels::records::kernel::{FilmPixel, LaunchSettings, launched_samples};
use lanes::{Zero, assign};
use wgsl_rs::std::vec3f;

/// Paths in lanes, each of a pixel of its own.
struct Group {
    /// Lanes that have a pixel.
    occupied: Mask,
    /// Which of the pixels, and where it is in the picture.
    pixel: [usize; LANES],
    x: [u32; LANES],
    y: [u32; LANES],
    /// Samples that the pixel is given, and how many of them were started.
    count: [u32; LANES],
    started: [u32; LANES],
    key: SampleKey,
    path: PathState,
}

/// Adds the samples of a launch to some pixels, given where they are.
///
/// # Safety
/// The processor must have what the kernels are compiled for.
#[inline(always)]
pub(super) unsafe fn render_pixels(
    globals: &Globals<'_>,
    slices: Slices<'_, { super::FEATURES }>,
    nodes: &[LaneNode],
    launch: LaunchSettings,
    places: &[(u32, u32)],
    pixels: &mut [FilmPixel],
) {
    let scene = UniformBuffers { unused: 0 };
    let settings = globals.SETTINGS;
    let mut groups: [Group; GROUPS] = std::array::from_fn(|_| Group {
        occupied: Mask::NONE,
        pixel: [0; LANES],
        x: [0; LANES],
        y: [0; LANES],
        count: [0; LANES],
        started: [0; LANES],
        key: Zero::zero(),
        path: Zero::zero(),
    });
    let mut travellers = Travellers::default();
    let mut next = 0;
    loop {
        // SAFETY of all calls: the caller's promise.
        let queries = groups.each_mut().map(|group| unsafe {
            group.start_paths(globals, launch, places, pixels, &mut next);
            let live = group.occupied;
            GroupQuery { live, query: kernel::next_query(globals, live, group.key, group.path) }
        });
        if queries.iter().all(|query| query.live.none()) {
            return;
        }
        let found = unsafe { search(globals, slices, nodes, &mut travellers, &queries) };
        for (group, found) in groups.iter_mut().zip(found) {
            let live = group.occupied;
            if live.none() {
                continue;
            }
            let (key, path) = (group.key, group.path);
            let (depth, background) = (settings.depth, settings.background);
            group.path = unsafe {
                kernel::continue_path_Buffers(globals, live, scene, key, depth, background, path, found)
            };
            let ended = live.without(group.path.goes_on);
            if ended.any() {
                let [red, green, blue] = {
                    let radiance = group.path.radiance;
                    [radiance.x, radiance.y, radiance.z].map(|channel| channel.to_array())
                };
                let rays = group.path.rays.to_array();
                for lane in lanes_of(ended.bits()) {
                    let pixel = &mut pixels[group.pixel[lane]];
                    *pixel = add_sample(*pixel, vec3f(red[lane], green[lane], blue[lane]), rays[lane]);
                }
            }
        }
    }
}

impl Group {
    /// Starts paths in lanes that have none; a lane whose pixel has its samples takes the next one.
    ///
    /// # Safety
    /// The processor must have what the kernels are compiled for.
    #[inline(always)]
    unsafe fn start_paths(
        &mut self,
        globals: &Globals<'_>,
        launch: LaunchSettings,
        places: &[(u32, u32)],
        pixels: &mut [FilmPixel],
        next: &mut usize,
    ) {
        let idle = Mask::ALL.without(self.path.goes_on);
        if idle.none() {
            return;
        }
        let mut entering = 0;
        let mut starting = 0;
        for lane in lanes_of(idle.bits()) {
            while self.started[lane] == self.count[lane] && *next < places.len() {
                self.pixel[lane] = *next;
                (self.x[lane], self.y[lane]) = places[*next];
                let pixel = &mut pixels[*next];
                self.count[lane] = launched_samples(launch, pixel.samples);
                if launch.counted == 0 {
                    pixel.samples += self.count[lane];
                }
                self.started[lane] = 0;
                entering |= 1 << lane;
                *next += 1;
            }
            if self.started[lane] < self.count[lane] {
                starting |= 1 << lane;
            }
        }
        let starting = Mask::from_bits(starting);
        let entering = Mask::from_bits(entering & starting.bits());
        self.occupied = Mask::from_bits((self.occupied.bits() & !idle.bits()) | starting.bits());
        if starting.none() {
            return;
        }
        let settings = globals.SETTINGS;
        let (x, y) = (U32::from_array(self.x), U32::from_array(self.y));
        let sample = U32::from_array(self.started.map(|started| launch.first_sample + started));
        // SAFETY: the caller's promise.
        unsafe {
            if entering.any() {
                let key = kernel::sample_key(globals, entering, settings, x, y, sample);
                assign(entering, &mut self.key, key);
            }
            let start =
                kernel::start_sample(globals, starting, globals.HEADER, settings, x, y, self.key, sample);
            assign(starting, &mut self.key, start.key);
            assign(starting, &mut self.path, start.path);
        }
        for lane in lanes_of(starting.bits()) {
            self.started[lane] += 1;
        }
    }
}
