//! Searches the matrices that keep groups of dimensions even together (`sobol::kernel::index_of_group`):
//!
//! ```text
//! cargo run --release -p sunshine-kernels --example groups_of_dimensions -- [SEED [MINUTES]]
//! ```
//!
//! prints the masks of the best matrices found so far and, for 4 to 1024 samples, the variance that they leave to products
//! of functions of successive groups, relative to independent numbers. It changes masks bit by bit as long as that helps,
//! and begins anew at random.
//!
//! A function is taken apart into Walsh functions, gathered by how many digits of each dimension they look at. Owen's
//! scrambling makes the variance of an integral the sum, over these gatherings, of the function's variance in each times a
//! gain (Owen, "Monte Carlo Variance of Scrambled Net Quadrature", 1997): 1 for independent numbers, 0 where the points
//! are even. For digital points it follows from the ranks of the rows of their matrices. Finer digits are taken to matter
//! less, as they do for functions with edges.

use kernels::sobol::kernel::{GROUPS, reordered, sobol4};
use std::time::{Duration, Instant};
use wgsl_rs::std::vec3u;

/// Binary logarithm of the largest number of samples that is looked at.
const DIGITS: usize = 10;
/// Share of a function's variance in digit k + 1 of a dimension, by that in digit k.
const FALL: f64 = 0.435;

/// The rows of a dimension's matrix: which digits of the index make up its digits.
type Rows = [u32; DIGITS];
/// The masks of one group.
type Masks = [u32; 3];

fn rows(masks: Masks) -> [Rows; 4] {
    let [x, y, z] = masks;
    let mut rows = [[0; DIGITS]; 4];
    for column in 0..DIGITS {
        let point = sobol4(reordered(1 << column, vec3u(x, y, z))).to_array();
        for (rows, digits) in rows.iter_mut().zip(point) {
            for (number, row) in rows.iter_mut().enumerate() {
                *row |= (digits >> number & 1) << column;
            }
        }
    }
    rows
}

/// What a vector of binary digits leaves when those of a basis, each with a leading digit of its own, are taken away.
fn rest(basis: &[u32; DIGITS], mut vector: u32) -> u32 {
    while let Some(leading) = vector.checked_ilog2() {
        match basis[leading as usize] {
            0 => return vector,
            known => vector ^= known,
        }
    }
    0
}

/// The gain of functions that look at so many digits of each dimension and depend on the last of them, for 2^m points.
fn gain(dimensions: &[&Rows], digits: &[usize], m: usize) -> f64 {
    let seen = (1 << m) - 1;
    let (mut basis, mut rank, mut last) = ([0; DIGITS], 0, 0);
    for (rows, &count) in dimensions.iter().zip(digits).filter(|(_, count)| **count > 0) {
        last ^= rows[count - 1] & seen;
        for row in &rows[..count - 1] {
            let new = rest(&basis, row & seen);
            if let Some(leading) = new.checked_ilog2() {
                basis[leading as usize] = new;
                rank += 1;
            }
        }
    }
    if rest(&basis, last) != 0 { 0.0 } else { f64::from(1u32 << (m - rank)) }
}

/// Sums over all functions that depend on every pair of dimensions and look at up to `most` digits of each: of their
/// variance times their gain to a power, and of their variance.
fn product(pairs: &[[&Rows; 2]], most: usize, m: usize, power: f64) -> (f64, f64) {
    let dimensions: Vec<&Rows> = pairs.concat();
    let (mut sum, mut all) = (0.0, 0.0);
    for code in 0..(most + 1).pow(dimensions.len() as u32) {
        let digits: Vec<usize> =
            (0..dimensions.len()).map(|d| code / (most + 1).pow(d as u32) % (most + 1)).collect();
        let total: usize = digits.iter().sum();
        if total <= 7 && digits.chunks(2).all(|pair| pair != [0, 0]) {
            let variance = FALL.powi(total as i32);
            sum += variance * gain(&dimensions, &digits, m).powf(power);
            all += variance;
        }
    }
    (sum, all)
}

/// The variance of products over all pairs of groups for 2^m points: gains to a power, relative to gains of 1.
fn variance(groups: &[[Rows; 4]], m: usize, power: f64) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for (one, first) in groups.iter().enumerate() {
        for (other, second) in groups.iter().enumerate().skip(one + 1) {
            // Within a pixel less changes than between directions; distant surfaces of a path have less to do with each other.
            let near = [1.0, 0.4, 0.2][other - one - 1] * if one == 0 { 0.4 } else { 1.0 };
            let (start, direction, light) =
                ([&first[0], &first[1]], [&second[0], &second[1]], [&second[2], &second[3]]);
            let mut add = |weight: f64, (gained, independent): (f64, f64)| {
                sum += weight * gained;
                all += weight * independent;
            };
            add(near, product(&[start, direction], 5, m, power));
            add(near, product(&[start, light], 5, m, power));
            if other == one + 1 {
                add(1.5 * near, product(&[start, direction, light], 2, m, power));
            }
        }
    }
    sum / all
}

/// Large gains count more than their share: no product is to be much worse than with independent numbers.
fn unevenness(groups: &[[Rows; 4]]) -> f64 {
    let weight = |m| [0.3, 0.6, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.7][m - 2];
    (2..=DIGITS).map(|m| weight(m) * variance(groups, m, 1.5)).sum()
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let mut number =
        |default| arguments.next().map_or(default, |number| number.expect("a number is expected"));
    let (mut state, minutes) = (number(1), number(5));
    // SplitMix64.
    let mut random = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) as u32
    };
    let end = Instant::now() + Duration::from_secs(60 * minutes);
    let mut best = f64::INFINITY;
    while Instant::now() < end {
        let mut masks: Vec<Masks> = (0..GROUPS)
            .map(|group| if group == 0 { [0; 3] } else { std::array::from_fn(|_| random()) })
            .collect();
        let mut groups: Vec<_> = masks.iter().map(|&masks| rows(masks)).collect();
        let (mut least, mut failures) = (unevenness(&groups), 0);
        while failures < 400 && Instant::now() < end {
            let group = 1 + random() as usize % (masks.len() - 1);
            let before = masks[group];
            for _ in 0..1 + random() % 3 {
                masks[group][random() as usize % 3] ^= 1 << (random() as usize % DIGITS);
            }
            groups[group] = rows(masks[group]);
            let now = unevenness(&groups);
            failures += 1;
            if now < least {
                (least, failures) = (now, 0);
            } else {
                masks[group] = before;
                groups[group] = rows(before);
            }
        }
        if least < best {
            best = least;
            println!("{best:.4} {masks:?}");
            for m in 2..=DIGITS {
                println!("    {:4} samples: {:.2}", 1 << m, variance(&groups, m, 1.0));
            }
        }
    }
}
