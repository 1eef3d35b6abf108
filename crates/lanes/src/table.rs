//! Tables of a scene as words of 32 bits, from which every lane takes its own.

/// A table in main memory, all of whose fields are 32 bits wide. What lies behind its end reads as zero.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a> {
    pub(crate) slice: &'a [u32],
}

impl<'a> Table<'a> {
    pub fn new(words: &'a [u32]) -> Self {
        Table { slice: words }
    }

    /// The word at a place that is the same for all lanes.
    #[inline(always)]
    pub fn word(self, place: u32) -> u32 {
        self.slice.get(place as usize).copied().unwrap_or(0)
    }

    /// The words from a place on that is the same for all lanes; zeros if not all of them lie inside.
    #[inline(always)]
    pub fn block<const N: usize>(self, place: u32) -> [u32; N] {
        let rest = self.slice.get(place as usize..).unwrap_or_default();
        rest.first_chunk().copied().unwrap_or([0; N])
    }

    /// Places below this one have so many words behind them; at most 2^31.
    #[inline(always)]
    pub(crate) fn ends_of_blocks<const N: usize>(self) -> u32 {
        let places = (self.slice.len() + 1).saturating_sub(N);
        u32::try_from(places).unwrap_or(u32::MAX).min(1 << 31)
    }
}
