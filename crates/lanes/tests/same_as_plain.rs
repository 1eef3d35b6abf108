//! Numbers in lanes give what plain numbers give, in every lane, bit for bit.
#![cfg(target_arch = "x86_64")]

use lanes::*;

/// Numbers that matter: zeros, ones, halves, large, small, negative, and many between.
fn floats() -> Vec<f32> {
    let mut values = vec![
        0.0,
        1.0,
        -1.0,
        0.5,
        -0.5,
        1.5,
        2.5,
        -2.5,
        1e-30,
        1e30,
        -1e30,
        65535.0,
        65536.5,
        16_777_217.0,
        2_147_483_500.0,
        2_147_483_648.0,
        4_294_967_000.0,
        4_294_967_296.0,
        1e20,
        -3.7,
        0.1,
        123.456,
    ];
    let mut state = 1u32;
    values.extend((0..74).map(|_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 65536.0 - 100.0
    }));
    values
}

fn integers() -> Vec<u32> {
    let mut values = vec![
        0,
        1,
        2,
        3,
        31,
        32,
        33,
        255,
        65535,
        65536,
        1 << 24,
        (1 << 24) + 1,
        1 << 31,
        u32::MAX - 1,
        u32::MAX,
    ];
    let mut state = 7u32;
    values.extend((0..81).map(|_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state
    }));
    values
}

macro_rules! same_as_plain {
    ($name:ident, $unit:ident) => {
        #[test]
        fn $name() {
            use lanes::$unit::*;
            if !is_supported() {
                eprintln!("skipped: this processor has no {}", stringify!($unit));
                return;
            }
            let float = |values: &[f32]| F32::from_array(std::array::from_fn(|i| values[i]));
            let integer = |values: &[u32]| U32::from_array(std::array::from_fn(|i| values[i]));
            let all = |condition: Mask| condition.bits() == Mask::ALL.bits();
            // The same value for floats of which one may be a zero with another sign.
            let same = |a: F32, b: [f32; LANES]| {
                let b = F32::from_array(b);
                all(or(equal(a, b), equal(a.to_bits_of_lanes(), b.to_bits_of_lanes())))
            };
            let (values, numbers) = (floats(), integers());
            for shift in 0..11 {
                for (a, n) in values.chunks_exact(LANES).zip(numbers.chunks_exact(LANES)) {
                    let b: Vec<f32> =
                        (0..LANES).map(|i| values[(i * 7 + shift * 5) % values.len()]).collect();
                    let m: Vec<u32> =
                        (0..LANES).map(|i| numbers[(i * 5 + shift * 3) % numbers.len()]).collect();
                    let of = |f: &dyn Fn(f32, f32) -> f32| -> [f32; LANES] {
                        std::array::from_fn(|i| f(a[i], b[i]))
                    };
                    let (x, y) = (float(a), float(&b));
                    assert!(same(add(x, y), of(&|a, b| a + b)));
                    assert!(same(subtract(x, y), of(&|a, b| a - b)));
                    assert!(same(multiply(x, y), of(&|a, b| a * b)));
                    assert!(same(negate(x), of(&|a, _| -a)));
                    assert!(same(min(x, y), of(&f32::min)));
                    assert!(same(max(x, y), of(&f32::max)));
                    assert!(same(floor(x), of(&|a, _| a.floor())));
                    assert!(same(ceil(x), of(&|a, _| a.ceil())));
                    assert!(same(trunc(x), of(&|a, _| a.trunc())));
                    assert!(same(abs(x), of(&|a, _| a.abs())));
                    assert!(same(sqrt(abs(x)), of(&|a, _| a.abs().sqrt())));
                    assert!(same(sin(Mask::ALL, x), of(&|a, _| a.sin())));
                    assert!(same(pow(Mask::ALL, abs(x), y), of(&|a, b| a.abs().powf(b))));
                    if b.iter().all(|b| *b != 0.0) {
                        assert!(same(divide(x, y), of(&|a, b| a / b)));
                    }
                    let truths = |f: &dyn Fn(f32, f32) -> bool| -> u32 {
                        (0..LANES).map(|i| u32::from(f(a[i], b[i])) << i).sum()
                    };
                    assert_eq!(less(x, y).bits(), truths(&|a, b| a < b));
                    assert_eq!(less_equal(x, y).bits(), truths(&|a, b| a <= b));
                    assert_eq!(greater(x, y).bits(), truths(&|a, b| a > b));
                    assert_eq!(greater_equal(x, y).bits(), truths(&|a, b| a >= b));
                    assert_eq!(equal(x, y).bits(), truths(&|a, b| a == b));
                    assert_eq!(not_equal(x, y).bits(), truths(&|a, b| a != b));
                    let to_u32: U32 = x.convert();
                    assert_eq!(to_u32.to_array(), std::array::from_fn(|i| a[i] as u32));
                    let to_i32: I32 = x.convert();
                    let back: U32 = to_i32.convert();
                    assert_eq!(back.to_array(), std::array::from_fn(|i| (a[i] as i32).cast_unsigned()));

                    let of = |f: &dyn Fn(u32, u32) -> u32| -> [u32; LANES] {
                        std::array::from_fn(|i| f(n[i], m[i]))
                    };
                    let (x, y) = (integer(n), integer(&m));
                    assert_eq!(add(x, y).to_array(), of(&u32::wrapping_add));
                    assert_eq!(subtract(x, y).to_array(), of(&u32::wrapping_sub));
                    assert_eq!(multiply(x, y).to_array(), of(&u32::wrapping_mul));
                    assert_eq!(divide(x, y).to_array(), of(&|a, b| a.checked_div(b).unwrap_or(a)));
                    assert_eq!(modulo(x, y).to_array(), of(&|a, b| a.checked_rem(b).unwrap_or(0)));
                    assert_eq!(and(x, y).to_array(), of(&|a, b| a & b));
                    assert_eq!(or(x, y).to_array(), of(&|a, b| a | b));
                    assert_eq!(xor(x, y).to_array(), of(&|a, b| a ^ b));
                    assert_eq!(not(x).to_array(), of(&|a, _| !a));
                    assert_eq!(shift_left(x, y).to_array(), of(&|a, b| a.wrapping_shl(b)));
                    assert_eq!(shift_right(x, y).to_array(), of(&|a, b| a.wrapping_shr(b)));
                    assert_eq!(reverse_bits(x).to_array(), of(&|a, _| a.reverse_bits()));
                    assert_eq!(count_one_bits(x).to_array(), of(&|a, _| a.count_ones()));
                    assert_eq!(count_trailing_zeros(x).to_array(), of(&|a, _| a.trailing_zeros()));
                    assert_eq!(min(x, y).to_array(), of(&std::cmp::Ord::min));
                    assert_eq!(max(x, y).to_array(), of(&std::cmp::Ord::max));
                    let truths = |f: &dyn Fn(u32, u32) -> bool| -> u32 {
                        (0..LANES).map(|i| u32::from(f(n[i], m[i])) << i).sum()
                    };
                    assert_eq!(less(x, y).bits(), truths(&|a, b| a < b));
                    assert_eq!(less_equal(x, y).bits(), truths(&|a, b| a <= b));
                    assert_eq!(equal(x, y).bits(), truths(&|a, b| a == b));
                    assert_eq!(not_equal(x, y).bits(), truths(&|a, b| a != b));
                    let to_float: F32 = x.convert();
                    assert!(same(to_float, std::array::from_fn(|i| n[i] as f32)));
                    let which = Mask::from_bits(n[0]);
                    let blended = blend(which, x, y).to_array();
                    assert_eq!(
                        blended,
                        std::array::from_fn(|i| if n[0] >> i & 1 != 0 { n[i] } else { m[i] })
                    );
                }
            }

            // Tables: places inside and outside, the same and different ones, lanes that are left out.
            let numbered: Vec<u32> = (0..100).map(|i| i * 3 + 1).collect();
            let table = Table::new(&numbered);
            let places = std::array::from_fn(|i| [5, 99, 100, u32::MAX - 1][i % 4] + (i as u32 / 4) % 2);
            let expected = |mask: u32| -> [u32; LANES] {
                std::array::from_fn(|i| {
                    let word = numbered.get(places[i] as usize).copied().unwrap_or(0);
                    if mask >> i & 1 != 0 { word } else { 0 }
                })
            };
            for mask in [Mask::ALL, Mask::from_bits(0b1010_0110), Mask::from_bits(0b1001_0100_0101_1001)] {
                let fetched = words(table, mask, U32::from_array(places)).to_array();
                let bits = mask.bits();
                assert_eq!(std::array::from_fn(|i| fetched[i] * (bits >> i & 1)), expected(bits));
            }
            // Blocks of words: inside, across the end, behind it.
            let starts = std::array::from_fn(|i| [5, 96, 97, 98, 99, u32::MAX - 1][i % 6]);
            for (mask, starts) in [
                (Mask::ALL, starts),
                (Mask::from_bits(0b1010_0110), starts),
                (Mask::from_bits(0b110), [96; LANES]),
                (Mask::from_bits(0b110), [97; LANES]),
            ] {
                let parts = block::<4>(table, mask, U32::from_array(starts)).map(|part| part.to_array());
                for lane in (0..LANES).filter(|lane| mask.bits() >> lane & 1 != 0) {
                    let found = parts.map(|part| part[lane]);
                    let whole = numbered.get(starts[lane] as usize..).and_then(|rest| rest.first_chunk());
                    assert_eq!(found, whole.copied().unwrap_or([0; 4]));
                    assert_eq!(found, table.block(starts[lane]));
                }
            }
            let same_place = words(table, Mask::from_bits(0b100), U32::from_array([7; LANES])).to_array();
            assert_eq!(same_place[2], 22);

            // Arrays in lanes, short and long.
            let mut long = [U32::zero(); 48];
            let places: [u32; LANES] = std::array::from_fn(|i| (i as u32 * 13) % 50);
            let values: [u32; LANES] = std::array::from_fn(|i| 1000 + i as u32);
            put_far(Mask::ALL, &mut long, U32::from_array(places), U32::from_array(values));
            let read = choose_far(Mask::ALL, &long, U32::from_array(places)).to_array();
            assert_eq!(read, std::array::from_fn(|i| if places[i] < 48 { values[i] } else { 0 }));
            let mut short = [F32::zero(); 3];
            let places: [u32; LANES] = std::array::from_fn(|i| i as u32 % 3);
            let numbers: [f32; LANES] = std::array::from_fn(|i| i as f32);
            put(Mask::from_bits(0b1011), &mut short, U32::from_array(places), F32::from_array(numbers));
            let read = choose(short, U32::from_array(places)).to_array();
            assert_eq!(read, std::array::from_fn(|i| if 0b1011 >> i & 1 != 0 { i as f32 } else { 0.0 }));
        }
    };
}

/// The bits of floats, also of those that are no numbers.
trait BitsOfLanes<U> {
    fn to_bits_of_lanes(self) -> U;
}

impl<F: Reinterpret<U>, U> BitsOfLanes<U> for F {
    fn to_bits_of_lanes(self) -> U {
        self.reinterpret()
    }
}

same_as_plain!(eight_lanes_give_what_plain_numbers_give, avx2);
same_as_plain!(sixteen_lanes_give_what_plain_numbers_give, avx512);
