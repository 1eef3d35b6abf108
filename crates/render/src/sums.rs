//! Sums of samples that come out the same however the samples are divided.
//!
//! Adding floating-point numbers in another order gives another result in the last digits. So the order is fixed by
//! the numbers of the samples alone: 64 of them, from a multiple of 64 on, are a block, summed one after the other by
//! the device; blocks are the leaves of a binary tree, and a node is the sum of its left and its right half. Whoever
//! has all samples of a node has its sum, bit for bit: in one run, in several after each other, or in shares of
//! different machines. What is left at the end, one node for each binary digit of the number of blocks, is added from
//! the left. (Such sums in pairs are also more exact than one long sum: Higham, The accuracy of floating point
//! summation, 1993.)
//!
//! Up to 64 samples there is one block: nothing is added here.

use crate::{Batch, DeviceError, LoadedScene, Progress, RenderSettings};
use bytemuck::Zeroable;
use kernels::records::kernel::FilmPixel;
use kernels::sums::kernel::joined_pixels;
use rayon::prelude::*;
use std::ops::Range;

/// Samples of a pixel that a device adds up by itself. Part of the format of film files: another number gives other
/// pictures, in their last digits.
pub const BLOCK_SAMPLES: u32 = 64;

/// Sums of the pixels for some samples.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    /// Numbers of the samples: a node of the tree, or the beginning of a block.
    pub samples: Range<u32>,
    pub pixels: Vec<FilmPixel>,
}

/// Whether samples are a node of the tree, or the beginning of a block.
pub(crate) fn is_node(samples: &Range<u32>) -> bool {
    let count = samples.end.saturating_sub(samples.start);
    if count < BLOCK_SAMPLES {
        return count > 0 && samples.start.is_multiple_of(BLOCK_SAMPLES);
    }
    count.is_multiple_of(BLOCK_SAMPLES) && count.is_power_of_two() && samples.start.is_multiple_of(count)
}

/// What pixels have collected of a range of samples, or of several.
#[derive(Clone, Debug)]
pub struct FilmSums {
    pixels: usize,
    /// Where the first sample is added if there is none.
    first: u32,
    /// In the order of their samples, without overlaps; no two of them are halves of the same node.
    parts: Vec<Part>,
    /// Memory of a part that was joined to another, for the next one.
    spare: Vec<FilmPixel>,
}

/// Why two films cannot be joined.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("both hold samples {} to {}", .0.start, .0.end)]
pub struct Overlap(pub Range<u32>);

impl FilmSums {
    /// Nothing yet; samples are counted from `first`, a multiple of [`BLOCK_SAMPLES`].
    ///
    /// # Panics
    /// If it is none.
    pub fn new(pixels: usize, first: u32) -> Self {
        assert!(first.is_multiple_of(BLOCK_SAMPLES), "samples begin with a block");
        FilmSums { pixels, first, parts: Vec::new(), spare: Vec::new() }
    }

    /// Of parts that are nodes, in the order of their samples; `None` if they are not or overlap.
    pub(crate) fn of_parts(pixels: usize, parts: Vec<Part>) -> Option<Self> {
        let nodes = parts.iter().all(|part| is_node(&part.samples) && part.pixels.len() == pixels);
        let ordered = parts.windows(2).all(|two| two[0].samples.end <= two[1].samples.start);
        let first = parts.first().map_or(0, |part| part.samples.start);
        (nodes && ordered).then(|| {
            let mut sums = FilmSums { pixels, first, parts, spare: Vec::new() };
            sums.join_halves();
            sums
        })
    }

    pub(crate) fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.pixels
    }

    /// Samples per pixel that are in it.
    pub fn samples(&self) -> u32 {
        self.parts.iter().map(|part| part.samples.end - part.samples.start).sum()
    }

    /// Where the next sample is added.
    pub fn end(&self) -> u32 {
        self.parts.last().map_or(self.first, |part| part.samples.end)
    }

    /// The samples that are in it, neighbouring ranges joined.
    pub fn ranges(&self) -> Vec<Range<u32>> {
        let mut ranges: Vec<Range<u32>> = Vec::new();
        for part in &self.parts {
            match ranges.last_mut() {
                Some(last) if last.end == part.samples.start => last.end = part.samples.end,
                _ => ranges.push(part.samples.clone()),
            }
        }
        ranges
    }

    /// Parts of `wanted` that are not in it.
    pub fn missing(&self, wanted: Range<u32>) -> Vec<Range<u32>> {
        let mut missing = Vec::new();
        let mut next = wanted.start;
        for range in self.ranges() {
            if range.start.min(wanted.end) > next {
                missing.push(next..range.start.min(wanted.end));
            }
            next = next.max(range.end);
        }
        if next < wanted.end {
            missing.push(next..wanted.end);
        }
        missing
    }

    /// Most films that sums of so many samples, one after the other, are made of at a time.
    pub fn most_films(samples: u32) -> u32 {
        u32::BITS - samples.div_ceil(BLOCK_SAMPLES).max(1).leading_zeros()
    }

    /// How many of the `wanted` next samples can be added at once: the largest node of the tree that begins with them, or
    /// what the last block still takes.
    pub fn room(&self, wanted: u32) -> u32 {
        match self.begun() {
            0 => largest_node(self.end(), wanted),
            begun => wanted.min(BLOCK_SAMPLES - begun),
        }
    }

    /// As [`FilmSums::room`] if what there is of the last block may be rendered again with the next samples: in a node
    /// that begins with it, if there is one larger than a block.
    pub fn room_anew(&self, wanted: u32) -> u32 {
        let begun = self.begun();
        match largest_node(self.end() - begun, wanted.saturating_add(begun)) {
            node if begun > 0 && node > BLOCK_SAMPLES => node - begun,
            _ => self.room(wanted),
        }
    }

    /// Samples in the last block if it is not full.
    pub fn begun(&self) -> u32 {
        self.end() % BLOCK_SAMPLES
    }

    /// Adds the next `samples` of rows of a picture, at most [`FilmSums::room`]; or exactly [`FilmSums::room_anew`] of
    /// them. After an error all is as before.
    ///
    /// # Errors
    /// As [`LoadedScene::add_samples`].
    pub fn add<S: LoadedScene + ?Sized>(
        &mut self,
        scene: &S,
        settings: &RenderSettings,
        rows: &Batch,
        samples: u32,
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        let samples = if samples == self.room_anew(samples) { samples } else { self.room(samples) };
        let (begun, end) = (self.begun(), self.end() + samples);
        let continues = begun > 0 && begun + samples <= BLOCK_SAMPLES;
        let first_sample = if continues { self.end() } else { self.end() - begun };
        let batch = Batch { first_sample, samples: end - first_sample, counted: false, ..*rows };
        let mut pixels = std::mem::take(&mut self.spare);
        let added = match self.parts.last().filter(|_| continues) {
            Some(part) => {
                // In a copy: a device that fails leaves some tiles with the new samples and some without.
                pixels.clear();
                pixels.extend_from_slice(&part.pixels);
                scene.add_samples(settings, &batch, &mut pixels, progress)
            }
            None => {
                pixels.resize(self.pixels, FilmPixel::zeroed());
                let again = self.pixels as u64 * u64::from(begun);
                let report = |done: u64| progress(done.saturating_sub(again));
                scene.sum_node(settings, &batch, &mut pixels, &report)
            }
        };
        if let Err(error) = added {
            self.spare = pixels;
            return Err(error);
        }
        let mut start = first_sample;
        if begun > 0
            && let Some(replaced) = self.parts.pop()
        {
            start = replaced.samples.start;
            self.spare = replaced.pixels;
        }
        self.parts.push(Part { samples: start..end, pixels });
        self.join_last();
        Ok(())
    }

    /// Adds all samples of the settings to rows of a picture.
    pub(crate) fn add_all<S: LoadedScene + ?Sized>(
        &mut self,
        scene: &S,
        settings: &RenderSettings,
        rows: &Batch,
        progress: &Progress<'_>,
    ) -> Result<(), DeviceError> {
        while self.end() < settings.samples {
            let done = self.pixels as u64 * u64::from(self.samples());
            let left = settings.samples - self.end();
            self.add(scene, settings, rows, left, &|more| progress(done + more))?;
        }
        Ok(())
    }

    /// Takes over the samples of another film of the same picture.
    ///
    /// # Errors
    /// If some samples are in both; then nothing is taken over.
    ///
    /// # Panics
    /// If the number of pixels is another.
    pub fn merge(&mut self, other: FilmSums) -> Result<(), Overlap> {
        assert_eq!(self.pixels, other.pixels, "pixels of films that are joined");
        for theirs in &other.parts {
            for ours in &self.parts {
                let common =
                    ours.samples.start.max(theirs.samples.start)..ours.samples.end.min(theirs.samples.end);
                if !common.is_empty() {
                    return Err(Overlap(common));
                }
            }
        }
        self.parts.extend(other.parts);
        self.parts.sort_by_key(|part| part.samples.start);
        self.join_halves();
        Ok(())
    }

    /// The sums of all samples.
    pub fn into_total(self) -> Vec<FilmPixel> {
        let pixels = self.pixels;
        let mut parts = self.parts.into_iter().map(|part| part.pixels);
        let Some(mut total) = parts.next() else { return vec![FilmPixel::zeroed(); pixels] };
        parts.for_each(|part| add_pixels(&mut total, &part));
        total
    }

    /// The sums of all samples, which stay.
    pub fn total(&self) -> Vec<FilmPixel> {
        let Some((first, others)) = self.parts.split_first() else {
            return vec![FilmPixel::zeroed(); self.pixels];
        };
        let mut total = first.pixels.clone();
        others.iter().for_each(|part| add_pixels(&mut total, &part.pixels));
        total
    }

    /// Joins the last parts as long as they are halves.
    fn join_last(&mut self) {
        while let [.., left, right] = &self.parts[..]
            && are_halves(&left.samples, &right.samples)
        {
            let Some(right) = self.parts.pop() else { return };
            let Some(left) = self.parts.last_mut() else { return };
            add_pixels(&mut left.pixels, &right.pixels);
            left.samples.end = right.samples.end;
            self.spare = right.pixels;
        }
    }

    /// Joins all halves.
    fn join_halves(&mut self) {
        let parts = std::mem::take(&mut self.parts);
        for part in parts {
            self.parts.push(part);
            self.join_last();
        }
    }
}

/// Whether two parts are the halves of a node.
pub(crate) fn are_halves(left: &Range<u32>, right: &Range<u32>) -> bool {
    // A block that is not full has no halves.
    let is_full = |samples: &Range<u32>| (samples.end - samples.start).is_multiple_of(BLOCK_SAMPLES);
    left.end == right.start
        && is_full(left)
        && is_full(right)
        && is_node(&(left.start..right.end))
        && left.end - left.start == right.end - right.start
}

/// Samples of the largest node from `first` on, the beginning of a block, with at most `wanted` samples; or `wanted` if
/// they are no block.
fn largest_node(first: u32, wanted: u32) -> u32 {
    let Some(most) = (wanted / BLOCK_SAMPLES).checked_ilog2() else { return wanted };
    // Of 0 there are more than enough.
    let aligned = (first / BLOCK_SAMPLES).trailing_zeros();
    BLOCK_SAMPLES << most.min(aligned)
}

/// Sums the samples of a batch, which are a node of the tree, from smaller nodes: `sum_part` overwrites pixels with the
/// sums of a node of `part_samples`, a power of two of blocks.
pub(crate) fn sum_of_parts(
    batch: &Batch,
    part_samples: u32,
    pixels: &mut [FilmPixel],
    progress: &Progress<'_>,
    sum_part: impl Fn(&Batch, &mut [FilmPixel], &Progress<'_>) -> Result<(), DeviceError>,
) -> Result<(), DeviceError> {
    let count = pixels.len() as u64;
    // Left halves whose right ones are still to come, after the first, which is in `pixels`.
    let mut waiting: Vec<Vec<FilmPixel>> = Vec::new();
    let mut spare: Vec<Vec<FilmPixel>> = Vec::new();
    for number in 0..batch.samples.div_ceil(part_samples) {
        let before = number * part_samples;
        let samples = part_samples.min(batch.samples - before);
        let part = Batch { first_sample: batch.first_sample + before, samples, ..*batch };
        let report = |more: u64| progress(count * u64::from(before) + more);
        if number == 0 {
            sum_part(&part, pixels, &report)?;
            continue;
        }
        let mut sums = spare.pop().unwrap_or_default();
        sums.resize(pixels.len(), FilmPixel::zeroed());
        sum_part(&part, &mut sums, &report)?;
        for _ in 0..(number + 1).trailing_zeros() {
            match waiting.pop() {
                Some(mut left) => {
                    add_pixels(&mut left, &sums);
                    spare.push(std::mem::replace(&mut sums, left));
                }
                None => add_pixels(pixels, &sums),
            }
        }
        if (number + 1).is_power_of_two() {
            spare.push(sums);
        } else {
            waiting.push(sums);
        }
    }
    Ok(())
}

/// Adds samples to those that come before.
pub(crate) fn add_pixels(left: &mut [FilmPixel], right: &[FilmPixel]) {
    /// Pixels that one thread takes at a time.
    const PIECE: usize = 1 << 14;
    left.par_chunks_mut(PIECE).zip(right.par_chunks(PIECE)).for_each(|(left, right)| {
        for (left, right) in left.iter_mut().zip(right) {
            *left = joined_pixels(*left, *right);
        }
    });
}

#[cfg(test)]
#[allow(clippy::single_range_in_vec_init, reason = "ranges of samples are meant")]
mod tests {
    use super::*;

    /// A part whose sums are those of the samples 0.1, 1.1, 2.1 and so on, one after the other within a block.
    fn part(samples: Range<u32>) -> Part {
        let mut pixel = FilmPixel::zeroed();
        for sample in samples.clone() {
            let value = (sample % 97) as f32 + 0.1;
            pixel.radiance += wgsl_rs::std::vec3f(value, value, value);
            pixel.squares += wgsl_rs::std::vec3f(value * value, value * value, value * value);
            pixel.samples += 1;
        }
        Part { samples, pixels: vec![pixel; 3] }
    }

    /// As if a device had rendered the samples block by block.
    fn rendered(samples: Range<u32>) -> FilmSums {
        let mut sums = FilmSums::new(3, samples.start);
        for start in samples.clone().step_by(BLOCK_SAMPLES as usize) {
            sums.parts.push(part(start..samples.end.min(start + BLOCK_SAMPLES)));
            sums.join_last();
        }
        sums
    }

    fn bits(sums: &FilmSums) -> Vec<u8> {
        bytemuck::cast_slice(&sums.total()).to_vec()
    }

    #[test]
    fn any_division_into_shares_in_any_order_gives_the_same_bits() {
        let whole = rendered(0..1000);
        assert_eq!(whole.total()[0].samples, 1000);
        for bounds in
            [&[0, 64, 128, 192, 960, 1000][..], &[0, 512, 1000], &[0, 448, 640, 1000], &[0, 64, 832, 1000]]
        {
            let shares: Vec<_> = bounds.windows(2).map(|ends| rendered(ends[0]..ends[1])).collect();
            // Forwards, backwards, and every second one first.
            let count = shares.len();
            let forwards: Vec<usize> = (0..count).collect();
            let backwards: Vec<usize> = (0..count).rev().collect();
            let mixed: Vec<usize> = (1..count).step_by(2).chain((0..count).step_by(2)).collect();
            for order in [forwards, backwards, mixed] {
                let mut joined = FilmSums::new(3, 0);
                for share in order {
                    joined.merge(shares[share].clone()).unwrap();
                }
                assert_eq!(joined.ranges(), [0..1000]);
                assert!(bits(&joined) == bits(&whole), "{bounds:?}");
                assert_eq!(bytemuck::cast_slice::<_, u8>(&joined.into_total()), bits(&whole));
            }
        }
    }

    #[test]
    fn memory_grows_with_the_digits_of_the_number_of_blocks() {
        let mut most = 0;
        let mut sums = FilmSums::new(3, 0);
        for block in 0..64 {
            sums.parts.push(part(block * 64..(block + 1) * 64));
            most = most.max(sums.parts.len());
            sums.join_last();
            assert_eq!(sums.parts.len() as u32, (block + 1).count_ones());
            assert!(most as u32 <= FilmSums::most_films((block + 1) * 64));
        }
        assert_eq!(sums.parts.len(), 1);
        assert_eq!([1, 64, 65, 128, 256, 4096].map(FilmSums::most_films), [1, 1, 2, 2, 3, 7]);
    }

    #[test]
    fn the_largest_node_that_is_wanted_is_added_at_once() {
        let begun = |samples: Range<u32>| {
            let mut sums = FilmSums::new(3, samples.start);
            for start in samples.clone().step_by(BLOCK_SAMPLES as usize) {
                sums.parts.push(part(start..samples.end.min(start + BLOCK_SAMPLES)));
                sums.join_last();
            }
            sums
        };
        let none = FilmSums::new(3, 0);
        assert_eq!([1, 63, 64, 127, 128, 1000].map(|wanted| none.room(wanted)), [1, 63, 64, 64, 128, 512]);
        assert_eq!([10, 1000].map(|wanted| begun(0..64).room(wanted)), [10, 64]);
        assert_eq!([100, 1000].map(|wanted| begun(0..128).room(wanted)), [64, 128]);
        assert_eq!([64, u32::MAX].map(|wanted| FilmSums::new(3, 192).room(wanted)), [64, 64]);
        // A block that was begun is filled, or rendered again.
        assert_eq!([10, 1000].map(|wanted| begun(0..40).room(wanted)), [10, 24]);
        assert_eq!([60, 123, 124, 252].map(|wanted| begun(0..4).room_anew(wanted)), [60, 60, 124, 252]);
        assert_eq!(begun(0..68).room_anew(1000), 60);
        assert_eq!([10, 1000].map(|wanted| begun(0..64).room_anew(wanted)), [10, 64]);
        assert_eq!([1, 1000].map(|wanted| none.room_anew(wanted)), [1, 512]);
    }

    #[test]
    fn what_is_there_twice_or_missing_is_told() {
        let mut sums = rendered(0..128);
        assert_eq!(sums.merge(rendered(64..256)), Err(Overlap(64..128)));
        assert_eq!(sums.ranges(), [0..128]);
        sums.merge(rendered(320..384)).unwrap();
        assert_eq!(sums.ranges(), [0..128, 320..384]);
        assert_eq!(sums.missing(0..400), [128..320, 384..400]);
        assert_eq!(sums.missing(64..100), []);
        assert_eq!(FilmSums::new(1, 0).missing(0..7), [0..7]);
    }

    #[test]
    fn only_nodes_of_the_tree_are_accepted() {
        for samples in [0..64, 64..128, 0..4096, 128..256, 64..65, 4032..4095] {
            assert!(is_node(&samples), "{samples:?}");
        }
        #[allow(clippy::reversed_empty_ranges)]
        for samples in [0..0, 64..64, 32..64, 64..192, 0..192, 0..65, 128..64, 1..2] {
            assert!(!is_node(&samples), "{samples:?}");
        }
        assert!(FilmSums::of_parts(3, vec![part(0..64), part(0..64)]).is_none());
        assert!(FilmSums::of_parts(2, vec![part(0..64)]).is_none());
        let sums = FilmSums::of_parts(3, vec![part(0..64), part(64..128), part(128..130)]).unwrap();
        assert!(bits(&sums) == bits(&rendered(0..130)));
    }
}
