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
    // SAFETY of the access: an array of registers lies in memory as `16 N` words.
    vector!({
        let inside = _mm512_mask_cmplt_epu32_mask(mask.0, index.0, _mm512_set1_epi32(N as i32));
        U32(_mm512_mask_i32gather_epi32::<4>(
            _mm512_setzero_si512(),
            inside,
            own_words(index.0),
            all.as_ptr().cast(),
        ))
    })
}

/// As [`put`] for long arrays, in memory.
#[inline(always)]
pub fn put_far<const N: usize>(mask: Mask, all: &mut [U32; N], index: U32, value: U32) {
    // SAFETY of the access: as above.
    vector!({
        let inside = _mm512_mask_cmplt_epu32_mask(mask.0, index.0, _mm512_set1_epi32(N as i32));
        _mm512_mask_i32scatter_epi32::<4>(all.as_mut_ptr().cast(), inside, own_words(index.0), value.0);
    });
}

/// The words of an array of registers that belong to each lane, by the number of the register.
#[inline(always)]
fn own_words(index: __m512i) -> __m512i {
    vector!(_mm512_add_epi32(
        _mm512_slli_epi32::<4>(index),
        _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0)
    ))
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
    let mask = mask.0;
    let first = vector!(_mm512_cvtsi512_si32(_mm512_maskz_compress_epi32(mask, places.0))).cast_unsigned();
    let same = vector!(_mm512_mask_cmpneq_epu32_mask(mask, places.0, _mm512_set1_epi32(first.cast_signed())));
    if same == 0 {
        let one = table.block::<N>(first);
        for i in 0..N {
            words[i] = one[i].widen();
        }
        return words;
    }
    let ends = table.ends_of_blocks::<N>();
    let inside = vector!(_mm512_mask_cmplt_epu32_mask(mask, places.0, _mm512_set1_epi32(ends.cast_signed())));
    if ends == 0 {
        return words;
    }
    let start = table.slice.as_ptr();
    // The others read from the beginning of the table, whose block lies inside, and forget it.
    let safe = U32(vector!(_mm512_maskz_mov_epi32(inside, places.0))).to_array();
    let rows = N / 4 * 4;
    for first in (0..rows).step_by(4) {
        let four = four_words(start.wrapping_add(first), &safe);
        for i in 0..4 {
            words[first + i] = U32(vector!(_mm512_maskz_mov_epi32(inside, four[i])));
        }
    }
    for (i, word) in words.iter_mut().enumerate().skip(rows) {
        // Every lane that is read lies inside of the table, and its place is below 2^31.
        *word = vector!(U32(_mm512_mask_i32gather_epi32::<4>(
            _mm512_setzero_si512(),
            inside,
            places.0,
            start.wrapping_add(i).cast(),
        )));
    }
    words
}

/// Four words from the place of every lane on: a load for each lane, turned about, which is faster than a gather for each
/// word. All lanes must lie inside of what `start` points to.
#[inline(always)]
fn four_words(start: *const u32, places: &[u32; 16]) -> [__m512i; 4] {
    vector!({
        macro_rules! row {
            ($lane:expr) => {
                _mm_loadu_si128(start.wrapping_add(places[$lane] as usize).cast())
            };
        }
        // Lane i, i + 4, i + 8 and i + 12 side by side.
        let mut rows = [_mm512_setzero_si512(); 4];
        for i in 0..4 {
            let mut all = _mm512_castsi128_si512(row!(i));
            all = _mm512_mask_broadcast_i32x4(all, 0x00f0, row!(i + 4));
            all = _mm512_mask_broadcast_i32x4(all, 0x0f00, row!(i + 8));
            rows[i] = _mm512_mask_broadcast_i32x4(all, 0xf000, row!(i + 12));
        }
        let low01 = _mm512_unpacklo_epi32(rows[0], rows[1]);
        let high01 = _mm512_unpackhi_epi32(rows[0], rows[1]);
        let low23 = _mm512_unpacklo_epi32(rows[2], rows[3]);
        let high23 = _mm512_unpackhi_epi32(rows[2], rows[3]);
        [
            _mm512_unpacklo_epi64(low01, low23),
            _mm512_unpackhi_epi64(low01, low23),
            _mm512_unpacklo_epi64(high01, high23),
            _mm512_unpackhi_epi64(high01, high23),
        ]
    })
}
