//! A batch shared out by rows, as they are asked for.

use super::job::{Job, Work};
use super::member::{Effort, Member, Standing};
use super::{Division, lock};
use crate::{Batch, DeviceError};
use bytemuck::Pod;
use std::ops::Range;
use std::sync::Mutex;

/// Fewest rows that a device gets at a time.
const FEWEST_ROWS: u32 = 16;

/// Rows that are still to be rendered.
struct Queue {
    /// From where nothing was given out yet.
    next: u32,
    rows: u32,
    /// What a device gave back.
    returned: Vec<Range<u32>>,
}

impl Queue {
    /// Rows for a device that does this share of the work of all. Half of what it would do of the rest, so that the
    /// devices end at nearly the same time.
    fn take(&mut self, share: f64) -> Option<Range<u32>> {
        if let Some(rows) = self.returned.pop() {
            return Some(rows);
        }
        let left = self.rows - self.next;
        if left == 0 {
            return None;
        }
        // The conversion saturates. A device that is alone gets all.
        let wanted = if share >= 1.0 { left } else { (f64::from(left) * share * 0.5) as u32 };
        let count = wanted.max(FEWEST_ROWS).min(left);
        self.next += count;
        Some(self.next - count..self.next)
    }
}

/// A batch whose rows are shared out, all samples of each.
pub(super) struct Rows<'a, P> {
    job: &'a Job<'a>,
    batch: Batch,
    /// Whether the work does not look at what the pixels are beforehand.
    overwrites: bool,
    work: &'a Work<'a, P>,
    queue: Mutex<Queue>,
    pixels: Mutex<&'a mut [P]>,
}

impl<'a, P: Pod + Send> Rows<'a, P> {
    pub fn new(
        job: &'a Job<'a>,
        batch: &Batch,
        overwrites: bool,
        work: &'a Work<'a, P>,
        pixels: &'a mut [P],
    ) -> Self {
        let queue = Mutex::new(Queue { next: 0, rows: batch.rows, returned: Vec::new() });
        Rows { job, batch: *batch, overwrites, work, queue, pixels: Mutex::new(pixels) }
    }

    /// Rows for a device that does this share of all of them.
    pub fn take_share(&self, share: f64) -> Option<Range<u32>> {
        lock(&self.queue).take(share)
    }

    /// Renders some rows in a copy, which takes their place only when it is complete; or in their place if that is all
    /// of them and what they were is of no interest. After an error they are to be done again.
    pub fn compute(&self, member: &Member, rows: Range<u32>) -> Result<Effort, DeviceError> {
        let result = self.compute_in_place(member, &rows);
        if result.is_err() {
            lock(&self.queue).returned.push(rows);
        }
        result
    }

    fn compute_in_place(&self, member: &Member, rows: &Range<u32>) -> Result<Effort, DeviceError> {
        let count = rows.end - rows.start;
        let piece = Batch { first_row: self.batch.first_row + rows.start, rows: count, ..self.batch };
        let width = self.job.width();
        let place = rows.start as usize * width..rows.end as usize * width;
        let mut all = lock(&self.pixels);
        if self.overwrites && place.len() == all.len() {
            // Nobody else has rows meanwhile.
            return self.job.compute(member, &piece, &mut all, self.work);
        }
        let mut copy = all[place.clone()].to_vec();
        drop(all);
        let effort = self.job.compute(member, &piece, &mut copy, self.work)?;
        lock(&self.pixels)[place].copy_from_slice(&copy);
        Ok(effort)
    }
}

impl<P: Pod + Send> Division for Rows<'_, P> {
    type Piece = Range<u32>;

    fn take(&self, standing: &Standing) -> Option<Range<u32>> {
        self.take_share(standing.share)
    }

    fn render(&self, member: &Member, _: &Standing, rows: Range<u32>) -> Result<(), DeviceError> {
        member.learn(self.compute(member, rows)?);
        Ok(())
    }

    fn is_complete(&self) -> bool {
        let queue = lock(&self.queue);
        queue.next == queue.rows && queue.returned.is_empty()
    }
}
