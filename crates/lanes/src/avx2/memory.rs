//! Every lane has its own place in an array or a table.

use super::*;

/// The element of an array that every lane asks for; the last one beyond the end.
#[inline(always)]
pub fn choose<T: Blend<Mask = Mask>, const N: usize>(all: [T; N], index: U32) -> T {
    let mut chosen = all[N - 1];
    for (i, element) in (0u32..).zip(all).take(N - 1) {
        chosen = T::blend(index.is_equal(i.widen()), element, chosen);
    }
    chosen
}

/// Replaces the element of an array that every lane of the mask names, if there is one.
#[inline(always)]
pub fn put<T: Blend<Mask = Mask>, const N: usize>(mask: Mask, all: &mut [T; N], index: U32, value: T) {
    for (i, element) in (0u32..).zip(all) {
        *element = T::blend(mask.both(index.is_equal(i.widen())), value, *element);
    }
}

/// As [`choose`] for long arrays, from memory; zero in lanes that the mask leaves out or that ask for too much.
#[inline(always)]
pub fn choose_far<const N: usize>(mask: Mask, all: &[U32; N], index: U32) -> U32 {
    // SAFETY of the access: an array of registers lies in memory as `8 N` words.
    vector!({
        let inside = mask.both(index.is_less((N as u32).widen()));
        let words = own_words(index.0);
        U32(_mm256_mask_i32gather_epi32::<4>(_mm256_setzero_si256(), all.as_ptr().cast(), words, inside.0))
    })
}

/// As [`put`] for long arrays, in memory.
#[inline(always)]
pub fn put_far<const N: usize>(mask: Mask, all: &mut [U32; N], index: U32, value: U32) {
    let (places, values) = (index.to_array(), value.to_array());
    let mut rest = mask.bits();
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize % LANES;
        rest &= rest - 1;
        if let Some(register) = all.get_mut(places[lane] as usize) {
            let mut words = register.to_array();
            words[lane] = values[lane];
            *register = U32::from_array(words);
        }
    }
}

/// The words of an array of registers that belong to each lane, by the number of the register.
#[inline(always)]
fn own_words(index: __m256i) -> __m256i {
    vector!(_mm256_add_epi32(_mm256_slli_epi32::<3>(index), _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0)))
}

/// The words at the places of all lanes of the mask; zero in the others.
#[inline(always)]
pub fn words(table: Table<'_>, mask: Mask, places: U32) -> U32 {
    let [word] = block::<1>(table, mask, places);
    word
}

/// So many words from the places of all lanes of the mask on; zeros in the others, and where not all of them lie inside.
///
/// Loops, not iterators: what closures call does not become vector instructions.
#[inline(always)]
pub fn block<const N: usize>(table: Table<'_>, mask: Mask, places: U32) -> [U32; N] {
    let mut words = [U32::zero(); N];
    // Most rays of a picture look at the same records: then one load does.
    let lane = (mask.bits() | 1 << (LANES - 1)).trailing_zeros();
    let number = vector!(_mm256_set1_epi32(lane.cast_signed()));
    let first = vector!(_mm256_cvtsi256_si32(_mm256_permutevar8x32_epi32(places.0, number))).cast_unsigned();
    if mask.both(places.is_unequal(first.widen())).none() {
        let one = table.block::<N>(first);
        for i in 0..N {
            words[i] = one[i].widen();
        }
        return words;
    }
    let ends = table.ends_of_blocks::<N>();
    let inside = mask.both(places.is_less(ends.widen()));
    if ends == 0 {
        return words;
    }
    let start = table.slice.as_ptr();
    // The others read from the beginning of the table, whose block lies inside, and forget it.
    let safe = U32(vector!(_mm256_and_si256(places.0, inside.0))).to_array();
    let rows = N / 4 * 4;
    for first in (0..rows).step_by(4) {
        let four = four_words(start.wrapping_add(first), &safe);
        for i in 0..4 {
            words[first + i] = U32(vector!(_mm256_and_si256(four[i], inside.0)));
        }
    }
    for (i, word) in words.iter_mut().enumerate().skip(rows) {
        // Every lane that is read lies inside of the table, and its place is below 2^31.
        *word = vector!(U32(_mm256_mask_i32gather_epi32::<4>(
            _mm256_setzero_si256(),
            start.wrapping_add(i).cast(),
            places.0,
            inside.0
        )));
    }
    words
}

/// Four words from the place of every lane on: a load for each lane, turned about, which is faster than a gather for each
/// word. All lanes must lie inside of what `start` points to.
#[inline(always)]
fn four_words(start: *const u32, places: &[u32; 8]) -> [__m256i; 4] {
    vector!({
        // Lane i and i + 4 side by side.
        let mut rows = [_mm256_setzero_si256(); 4];
        for i in 0..4 {
            let low = _mm_loadu_si128(start.wrapping_add(places[i] as usize).cast());
            let high = _mm_loadu_si128(start.wrapping_add(places[i + 4] as usize).cast());
            rows[i] = _mm256_set_m128i(high, low);
        }
        let low01 = _mm256_unpacklo_epi32(rows[0], rows[1]);
        let high01 = _mm256_unpackhi_epi32(rows[0], rows[1]);
        let low23 = _mm256_unpacklo_epi32(rows[2], rows[3]);
        let high23 = _mm256_unpackhi_epi32(rows[2], rows[3]);
        [
            _mm256_unpacklo_epi64(low01, low23),
            _mm256_unpackhi_epi64(low01, low23),
            _mm256_unpacklo_epi64(high01, high23),
            _mm256_unpackhi_epi64(high01, high23),
        ]
    })
}
