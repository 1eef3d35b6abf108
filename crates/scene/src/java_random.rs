/// The generator of `java.util.Random`: a linear congruential generator of 48 bits, as Java's documentation
/// prescribes it. GroIMP's noise and synthetic textures are defined by its sequence.
#[derive(Clone, Debug)]
pub struct JavaRandom {
    state: u64,
}

const FACTOR: u64 = 0x5_DEEC_E66D;
const MASK: u64 = (1 << 48) - 1;

impl JavaRandom {
    /// `new Random(seed)`.
    pub fn new(seed: i64) -> Self {
        JavaRandom { state: (seed as u64 ^ FACTOR) & MASK }
    }

    /// The upper `bits` of the next state, at most 32.
    fn next(&mut self, bits: u32) -> u32 {
        self.state = self.state.wrapping_mul(FACTOR).wrapping_add(0xB) & MASK;
        // Lossless: 48 - (48 - bits) bits are left.
        (self.state >> (48 - bits)) as u32
    }

    /// `nextInt(1 << bits)`, for `bits` from 0 to 30.
    pub fn next_bits(&mut self, bits: u32) -> u32 {
        self.next(31) >> (31 - bits)
    }

    /// `nextFloat()`: in [0, 1), a multiple of 2⁻²⁴.
    pub fn next_float(&mut self) -> f32 {
        self.next(24) as f32 / (1 << 24) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documented_sequence_for_seed_0() {
        let mut random = JavaRandom::new(0);
        // new Random(0).nextInt() is -1155484576, the first of the well-known sequence.
        assert_eq!(random.next(32).cast_signed(), -1_155_484_576);
        assert_eq!(random.next(32).cast_signed(), -723_955_400);
    }
}
