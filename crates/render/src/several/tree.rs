//! The sub-nodes of a node of the tree of samples: given out from left to right, joined as soon as both halves are there.

use super::lock;
use crate::sums::{Part, add_pixels, are_halves};
use bytemuck::Zeroable;
use kernels::records::kernel::FilmPixel;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Mutex;

/// A node that is put together of equal sub-nodes.
///
/// There are never more films than [`Tree::most_films`] says: one for every sub-node that is being rendered, and those
/// that wait for their other half, each of which has one that is being rendered below the node that both will be, or
/// nothing yet to its right. With equal devices that end one after the other these are about as many as there are
/// devices and levels; more if one of them stays at its sub-node while the others go on.
pub(super) struct Tree {
    /// Numbers of the samples.
    whole: Range<u32>,
    /// Samples of a sub-node.
    part: u32,
    pixels: usize,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// First sample of the first sub-node that was not given out yet.
    next: u32,
    /// First samples of those that were given back.
    returned: BTreeSet<u32>,
    /// Without their other half.
    waiting: Vec<Part>,
    /// Memory for films.
    spare: Vec<Vec<FilmPixel>>,
    is_complete: bool,
}

impl Tree {
    /// Of the samples `whole`, a node of `parts` sub-nodes: a power of two, at most as many as it has blocks.
    pub fn new(whole: Range<u32>, parts: u32, pixels: usize) -> Self {
        let state = Mutex::new(State { next: whole.start, ..State::default() });
        Tree { part: (whole.end - whole.start) / parts, whole, pixels, state }
    }

    /// Most films at a time while so many devices work at so many sub-nodes.
    ///
    /// Below each sub-node that is being rendered nothing waits; on the way to it from the root at most one film does
    /// for each level, and ways have their beginnings in common: the sum over the levels of the number of nodes that
    /// are on such ways, and one.
    pub fn most_films(devices: usize, parts: u32) -> u64 {
        let devices = devices as u64;
        1 + (0..parts.ilog2()).map(|level| devices.min(1 << level)).sum::<u64>()
    }

    /// The leftmost sub-node that nobody has begun, with memory for its pixels, which may be anything; if
    /// `is_worth_while` says so of the number of those that are left.
    pub fn take(&self, is_worth_while: impl Fn(u32) -> bool) -> Option<Part> {
        let mut state = lock(&self.state);
        let left = (self.whole.end - state.next) / self.part + state.returned.len() as u32;
        if left == 0 || !is_worth_while(left) {
            return None;
        }
        let start = match state.returned.pop_first() {
            Some(start) => start,
            None => {
                state.next += self.part;
                state.next - self.part
            }
        };
        let mut pixels = state.spare.pop().unwrap_or_default();
        drop(state);
        pixels.resize(self.pixels, FilmPixel::zeroed());
        Some(Part { samples: start..start + self.part, pixels })
    }

    /// Takes a sub-node back that is to be done again.
    pub fn give_back(&self, part: Part) {
        let mut state = lock(&self.state);
        state.returned.insert(part.samples.start);
        state.spare.push(part.pixels);
    }

    /// Takes a finished sub-node and joins it with what there is. Gives the whole node when that was the last one.
    pub fn finish(&self, mut part: Part) -> Option<Vec<FilmPixel>> {
        loop {
            let mut state = lock(&self.state);
            if part.samples == self.whole {
                state.is_complete = true;
                return Some(part.pixels);
            }
            let is_other_half = |other: &Part| {
                are_halves(&other.samples, &part.samples) || are_halves(&part.samples, &other.samples)
            };
            let Some(place) = state.waiting.iter().position(is_other_half) else {
                state.waiting.push(part);
                return None;
            };
            let other = state.waiting.swap_remove(place);
            drop(state);
            let is_left = part.samples.start < other.samples.start;
            let (mut left, right) = if is_left { (part, other) } else { (other, part) };
            // Always in this order.
            add_pixels(&mut left.pixels, &right.pixels);
            left.samples.end = right.samples.end;
            lock(&self.state).spare.push(right.pixels);
            part = left;
        }
    }

    /// Whether the whole node was given.
    pub fn is_complete(&self) -> bool {
        lock(&self.state).is_complete
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::sum_of_parts;
    use crate::{BLOCK_SAMPLES, Batch, ControlFlow};

    const FIRST: u32 = 4096;

    /// Block by block; the sum of these samples depends on the order.
    fn sum(samples: &Range<u32>, pixels: &mut [FilmPixel]) {
        let batch = Batch {
            first_row: 0,
            rows: 1,
            first_sample: samples.start,
            samples: samples.end - samples.start,
            counted: false,
        };
        sum_of_parts(&batch, BLOCK_SAMPLES, pixels, &|_| ControlFlow::Continue(()), |block, pixels, _| {
            pixels.fill(FilmPixel::zeroed());
            for (pixel, place) in pixels.iter_mut().zip(1..) {
                for sample in block.first_sample..block.first_sample + block.samples {
                    pixel.radiance.x += ((sample * place) % 97) as f32 + 0.1;
                    pixel.samples += 1;
                }
            }
            Ok(())
        })
        .unwrap();
    }

    /// Devices that work at sub-nodes end in an order that only chance knows, and fail now and then.
    #[test]
    fn whoever_ends_first_the_node_is_the_same_and_films_are_few() {
        let mut chance = 1u32;
        let mut below = move |end: usize| {
            chance = chance.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (chance >> 8) as usize % end
        };
        for (devices, parts) in [(1, 1), (1, 8), (2, 8), (3, 16), (5, 32), (8, 32), (5, 4)] {
            let whole = FIRST..FIRST + 2 * parts * BLOCK_SAMPLES;
            let mut expected = vec![FilmPixel::zeroed(); 3];
            sum(&whole, &mut expected);
            for _ in 0..40 {
                let tree = Tree::new(whole.clone(), parts, 3);
                let mut running: Vec<Part> = Vec::new();
                let mut result = None;
                let mut most = 0;
                while result.is_none() {
                    while running.len() < devices
                        && let Some(part) = tree.take(|_| true)
                    {
                        running.push(part);
                    }
                    let state = lock(&tree.state);
                    most = most.max(running.len() + state.waiting.len() + state.spare.len());
                    drop(state);
                    let mut part = running.swap_remove(below(running.len()));
                    if below(5) == 0 {
                        tree.give_back(part);
                        continue;
                    }
                    sum(&part.samples, &mut part.pixels);
                    assert!(!tree.is_complete());
                    result = tree.finish(part);
                }
                let result = result.unwrap();
                assert_eq!(bytemuck::cast_slice::<_, u8>(&result), bytemuck::cast_slice::<_, u8>(&expected));
                assert!(most as u64 <= Tree::most_films(devices, parts), "{most}: {devices} at {parts}");
                assert!(tree.is_complete() && tree.take(|_| true).is_none());
            }
        }
    }

    #[test]
    fn the_number_of_films_is_reached_when_one_device_stays_behind() {
        assert_eq!(Tree::most_films(2, 8), 6);
        let tree = Tree::new(0..8 * BLOCK_SAMPLES, 8, 1);
        let first = tree.take(|_| true).unwrap();
        for _ in 1..7 {
            tree.finish(tree.take(|_| true).unwrap());
        }
        let _last = tree.take(|_| true).unwrap();
        // 1, 2..4, 4..6, 6 wait beside 0 and 7.
        assert_eq!(lock(&tree.state).waiting.len() + 2, 6);
        assert!(lock(&tree.state).spare.is_empty());
        tree.finish(first);
        assert_eq!(lock(&tree.state).waiting.len(), 3);
    }
}
