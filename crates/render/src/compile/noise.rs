//! The random numbers of GroIMP's lattice noise.

use kernels::noise::kernel::{NOISE_PERMUTATION, NOISE_VALUES};
use scene::JavaRandom;

/// The seed of GroIMP's tables.
const SEED: i64 = 123_456_789;

/// The table as the kernels' module `noise` describes it: from `java.util.Random`, first a permutation made by
/// swapping every index with a random one, then floats in [-1, 1) (materials-and-lights.md 2.7).
pub(super) fn noise_table() -> impl Iterator<Item = u32> {
    let mut random = JavaRandom::new(SEED);
    let mut permutation: Vec<u32> = (0..NOISE_PERMUTATION).collect();
    for index in 0..permutation.len() {
        permutation.swap(index, random.next_bits(NOISE_PERMUTATION.ilog2()) as usize);
    }
    let values = (0..NOISE_VALUES).map(move |_| (2.0 * random.next_float() - 1.0).to_bits());
    permutation.into_iter().chain(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::noise::kernel::NOISE_TABLE_SIZE;

    /// `java.util.Random` as its documentation describes it, independent of the crate's.
    fn next(state: &mut u128, bits: u32) -> u32 {
        *state = (*state * 25_214_903_917 + 11) % (1 << 48);
        u32::try_from(*state >> (48 - bits)).unwrap()
    }

    #[test]
    fn the_table_is_a_permutation_and_values_in_range() {
        let table: Vec<u32> = noise_table().collect();
        assert_eq!(table.len(), NOISE_TABLE_SIZE as usize);
        let mut state: u128 = 123_456_789 ^ 25_214_903_917;
        let mut expected: Vec<u32> = (0..65536).collect();
        for index in 0..65536 {
            // nextInt of a power of two takes the upper bits: 65536 * next(31) / 2^31.
            let other = u64::from(next(&mut state, 31)) * 65536 / (1 << 31);
            expected.swap(index, usize::try_from(other).unwrap());
        }
        assert_eq!(table[..65536], expected);
        for bits in &table[65536..] {
            let float = f64::from(next(&mut state, 24)) / f64::from(1 << 24);
            assert_eq!(f64::from(f32::from_bits(*bits)), 2.0 * float - 1.0);
        }
        expected.sort_unstable();
        assert!(expected.iter().zip(0..).all(|(found, index)| *found == index));
    }
}
