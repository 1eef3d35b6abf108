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
    // Most rays of a picture look at the same records: then one load does.
    let lane = (mask.bits() | 1 << (LANES - 1)).trailing_zeros();
    let first = vector!(_mm256_cvtsi256_si32(_mm256_permutevar8x32_epi32(
        places.0,
        _mm256_set1_epi32(lane.cast_signed())
    )))
    .cast_unsigned();
    if mask.both(places.is_unequal(first.widen())).none() {
        return table.word(first).widen();
    }
    let length = u32::try_from(table.slice.len()).unwrap_or(u32::MAX).min(1 << 31);
    // Every lane that is read lies inside of the table, and its place is below 2^31.
    let inside = mask.both(places.is_less(length.widen()));
    vector!(U32(_mm256_mask_i32gather_epi32::<4>(
        _mm256_setzero_si256(),
        table.slice.as_ptr().cast(),
        places.0,
        inside.0
    )))
}
