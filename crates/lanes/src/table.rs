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
}
