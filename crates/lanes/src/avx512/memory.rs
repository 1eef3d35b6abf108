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
    let mask = mask.0;
    // Most rays of a picture look at the same records: then one load does.
    let first = vector!(_mm512_cvtsi512_si32(_mm512_maskz_compress_epi32(mask, places.0))).cast_unsigned();
    let same = vector!(_mm512_mask_cmpneq_epu32_mask(mask, places.0, _mm512_set1_epi32(first.cast_signed())));
    if same == 0 {
        return table.word(first).widen();
    }
    let length = u32::try_from(table.slice.len()).unwrap_or(u32::MAX).min(1 << 31);
    vector!({
        let inside = _mm512_mask_cmplt_epu32_mask(mask, places.0, _mm512_set1_epi32(length.cast_signed()));
        // Every lane that is read lies inside of the table, and its place is below 2^31.
        U32(_mm512_mask_i32gather_epi32::<4>(
            _mm512_setzero_si512(),
            inside,
            places.0,
            table.slice.as_ptr().cast(),
        ))
    })
}
