//! A node of the tree of samples shared out by its sub-nodes, for pictures that are too small to be divided.
//!
//! A graphics card needs hundreds of thousands of pixels at a time, so part of a small picture does not fill it. Fast
//! devices take sub-nodes, each for all pixels they are responsible for; the order of additions is that of the tree,
//! so the sums are those of one device. A device that is much slower, as the processor beside graphics cards, would be
//! waited for: it gets some rows at the lower edge for the whole node, as many as its share of the speed allows.

use super::job::{Job, Work};
use super::member::{Member, Standing};
use super::rows::Rows;
use super::tree::Tree;
use super::{Division, lock};
use crate::sums::{Part, is_node};
use crate::{BLOCK_SAMPLES, Batch, DeviceError, LoadedScene};
use kernels::records::kernel::FilmPixel;
use std::ops::Range;
use std::sync::Mutex;

/// So many sub-nodes for a fast device, or more: few, so that they are large, but enough for the devices to end at
/// nearly the same time.
const NODES_PER_DEVICE: u32 = 4;
/// So many pixels for each fast device fill it also if they are shared out: the largest tile of a graphics card. Then no
/// further films are needed.
const PIXELS_THAT_FILL: usize = 1 << 20;
/// The part of the memory for films that those of sub-nodes may take. What [`crate::check_kept`] accepts leaves as
/// much as a third of it free beside the picture's own, and at any time this is a share of what is free then.
const MEMORY_SHARE: u64 = 4;

/// How a node is shared out by sub-nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan {
    /// Sub-nodes: a power of two.
    nodes: u32,
    /// Rows at the lower edge for slow devices.
    strip_rows: u32,
    /// What slow devices do of the work of all.
    slow_share: f64,
}

impl Plan {
    /// For devices with these speeds; 0 stands for an unknown one. `film_limit` tells the bytes that films may take.
    /// `None` if rows are better or nothing is known.
    pub fn new(speeds: &[f64], batch: &Batch, width: usize, film_limit: &dyn Fn() -> u64) -> Option<Self> {
        let samples = batch.first_sample..batch.first_sample + batch.samples;
        let blocks = batch.samples / BLOCK_SAMPLES;
        let is_known = speeds.iter().all(|speed| *speed > 0.0);
        if speeds.len() < 2 || !is_known || blocks < 2 || !is_node(&samples) {
            return None;
        }
        let standings: Vec<Standing> = (0..speeds.len()).map(|number| Standing::of(speeds, number)).collect();
        let fast = standings.iter().filter(|standing| !standing.is_slow()).count();
        let pixels = width * batch.rows as usize;
        if pixels / fast.max(1) >= PIXELS_THAT_FILL {
            return None;
        }
        let slow = standings.iter().filter(|standing| standing.is_slow());
        let slow_share: f64 = slow.map(|standing| standing.share).sum();
        // Saturates.
        let strip_rows = (f64::from(batch.rows) * slow_share).round() as u32;
        let strip_rows = strip_rows.min(batch.rows.saturating_sub(1));
        // One device alone has nobody to share with.
        let wanted = if fast < 2 { 1 } else { (fast as u32 * NODES_PER_DEVICE).next_power_of_two() };
        let plan = Plan { nodes: wanted.min(blocks), strip_rows, slow_share };
        (plan.bytes(speeds.len(), batch, width) <= film_limit() / MEMORY_SHARE).then_some(plan)
    }

    /// Bytes of all films, beside that of the result: those of [`Tree::most_films`] without the strip, and what is
    /// being rendered of that.
    fn bytes(&self, devices: usize, batch: &Batch, width: usize) -> u64 {
        let films = Tree::most_films(devices, self.nodes);
        let rows = films * u64::from(batch.rows - self.strip_rows) + u64::from(self.strip_rows);
        rows * width as u64 * size_of::<FilmPixel>() as u64
    }
}

/// A node whose sub-nodes are shared out.
pub(super) struct Nodes<'a> {
    job: &'a Job<'a>,
    /// All but the strip.
    batch: Batch,
    tree: Tree,
    pixels: Mutex<&'a mut [FilmPixel]>,
    strip: Rows<'a, FilmPixel>,
    slow_share: f64,
}

/// What a device takes at a time.
pub(super) enum Piece {
    /// Of the strip.
    Rows(Range<u32>),
    /// Of all other rows.
    Node(Part),
}

const SUM: &Work<'static, FilmPixel> = &<dyn LoadedScene>::sum_node;

impl<'a> Nodes<'a> {
    pub fn new(job: &'a Job<'a>, batch: &Batch, plan: &Plan, pixels: &'a mut [FilmPixel]) -> Self {
        let rows = batch.rows - plan.strip_rows;
        let (upper, lower) = pixels.split_at_mut(rows as usize * job.width());
        let strip = Batch { first_row: batch.first_row + rows, rows: plan.strip_rows, ..*batch };
        let samples = batch.first_sample..batch.first_sample + batch.samples;
        Nodes {
            job,
            batch: Batch { rows, ..*batch },
            tree: Tree::new(samples, plan.nodes, upper.len()),
            pixels: Mutex::new(upper),
            strip: Rows::new(job, &strip, true, SUM, lower),
            slow_share: plan.slow_share,
        }
    }

    fn take_rows(&self, standing: &Standing) -> Option<Piece> {
        let share = match standing.share {
            alone if alone >= 1.0 => 1.0,
            // Of those that the strip is for.
            share => (share / self.slow_share).min(0.99),
        };
        self.strip.take_share(share).map(Piece::Rows)
    }
}

impl Division for Nodes<'_> {
    type Piece = Piece;

    fn take(&self, standing: &Standing) -> Option<Piece> {
        if standing.is_slow() {
            return self.take_rows(standing);
        }
        let node = self.tree.take(|left| standing.ends_in_time(left));
        // Then what others are late with.
        node.map(Piece::Node).or_else(|| self.take_rows(standing))
    }

    fn render(&self, member: &Member, standing: &Standing, piece: Piece) -> Result<(), DeviceError> {
        let mut part = match piece {
            Piece::Rows(rows) => {
                let effort = self.strip.compute(member, rows)?;
                // So few pixels say nothing about a fast device.
                if standing.is_slow() {
                    member.learn(effort);
                }
                return Ok(());
            }
            Piece::Node(part) => part,
        };
        let samples = part.samples.end - part.samples.start;
        let batch = Batch { first_sample: part.samples.start, samples, ..self.batch };
        match self.job.compute(member, &batch, &mut part.pixels, SUM) {
            Ok(effort) => member.learn(effort),
            Err(error) => {
                self.tree.give_back(part);
                return Err(error);
            }
        }
        if let Some(whole) = self.tree.finish(part) {
            lock(&self.pixels).copy_from_slice(&whole);
        }
        Ok(())
    }

    fn is_complete(&self) -> bool {
        self.tree.is_complete() && self.strip.is_complete()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(speeds: &[f64], rows: u32, samples: u32, limit: u64) -> Option<(u32, u32)> {
        let batch = Batch { first_row: 0, rows, first_sample: 0, samples, counted: false };
        Plan::new(speeds, &batch, 640, &|| limit).map(|plan| (plan.nodes, plan.strip_rows))
    }

    #[test]
    fn nodes_are_shared_where_rows_would_not_fill_the_devices() {
        let of = |speeds: &[f64], samples| plan(speeds, 480, samples, u64::MAX);
        assert_eq!(of(&[5.0, 5.0], 4096), Some((8, 0)));
        assert_eq!(of(&[5.0, 5.0, 5.0], 4096), Some((16, 0)));
        assert_eq!(of(&[5.0, 2.0], 256), Some((4, 0)));
        assert_eq!(of(&[5.0, 5.0], 64), None);
        assert_eq!(of(&[5.0, 5.0], 40), None);
        assert_eq!(of(&[5.0], 4096), None);
        assert_eq!(of(&[5.0, 0.0], 4096), None);
        // What is no node.
        assert_eq!(of(&[5.0, 5.0], 192), None);
    }

    #[test]
    fn slow_devices_get_a_strip_of_their_share() {
        assert_eq!(plan(&[10.0, 8.0, 2.0], 480, 4096, u64::MAX), Some((8, 48)));
        // One card beside the processor: all samples at once.
        assert_eq!(plan(&[19.0, 1.0], 480, 4096, u64::MAX), Some((1, 24)));
        assert_eq!(plan(&[1999.0, 1.0], 480, 4096, u64::MAX), Some((1, 0)));
        assert_eq!(plan(&[10.0, 2.0, 2.0, 2.0, 2.0, 2.0], 1, 4096, u64::MAX), Some((1, 0)));
    }

    #[test]
    fn large_pictures_and_little_memory_are_for_rows() {
        assert_eq!(plan(&[5.0, 5.0], 3276, 4096, u64::MAX), Some((8, 0)));
        assert_eq!(plan(&[5.0, 5.0], 3277, 4096, u64::MAX), None);
        // Six films.
        let film = 640 * 480 * 32;
        assert_eq!(plan(&[5.0, 5.0], 480, 4096, 4 * 6 * film), Some((8, 0)));
        assert_eq!(plan(&[5.0, 5.0], 480, 4096, 4 * 6 * film - 1), None);
        assert_eq!(plan(&[9.0, 1.0], 480, 4096, 4 * film), Some((1, 48)));
    }
}
