//! Numbers as text with a fixed count of decimals, digit for digit what C's `%.4f` and `%.6f` print.
//!
//! In: a finite double. Out: bytes at the end of a buffer. The double is `m 2^e` with whole `m < 2^53`; the
//! digits are those of `m 10^D 2^e` rounded to the nearest whole number, ties to the even one. For `|value| <
//! 10^12` that is a product below 2^73 and a shift, all exact in 128 bits; other values go through the
//! standard formatter, which rounds the same way.

use std::io::Write;

/// Beyond this the standard formatter is used.
const LARGE: f64 = 1e12;

/// The numbers 00 to 99.
const PAIRS: [[u8; 2]; 100] = pairs();

const fn pairs() -> [[u8; 2]; 100] {
    let mut table = [[b'0'; 2]; 100];
    let mut n = 0;
    while n < 100 {
        table[n] = [b'0' + (n / 10) as u8, b'0' + (n % 10) as u8];
        n += 1;
    }
    table
}

fn pair(n: u64) -> [u8; 2] {
    PAIRS[(n % 100) as usize]
}

/// Appends `value` with four decimals.
pub(crate) fn four(out: &mut Vec<u8>, value: f64) {
    if value.to_bits() == 0 {
        return out.extend_from_slice(b"0.0000");
    }
    let Some(scaled) = scaled(value, 10_000) else {
        let _ = write!(out, "{value:.4}"); // a buffer in memory takes everything
        return;
    };
    sign(out, value);
    whole(out, scaled / 10_000);
    let [a, b] = pair(scaled / 100);
    let [c, d] = pair(scaled);
    out.extend_from_slice(&[b'.', a, b, c, d]);
}

/// Appends `value` with six decimals.
pub(crate) fn six(out: &mut Vec<u8>, value: f64) {
    let Some(scaled) = scaled(value, 1_000_000) else {
        let _ = write!(out, "{value:.6}");
        return;
    };
    sign(out, value);
    whole(out, scaled / 1_000_000);
    let [a, b] = pair(scaled / 10_000);
    let [c, d] = pair(scaled / 100);
    let [e, f] = pair(scaled);
    out.extend_from_slice(&[b'.', a, b, c, d, e, f]);
}

/// Appends a whole number.
pub(crate) fn integer(out: &mut Vec<u8>, value: i64) {
    if value < 0 {
        out.push(b'-');
    }
    whole(out, value.unsigned_abs());
}

fn sign(out: &mut Vec<u8>, value: f64) {
    if value.is_sign_negative() {
        out.push(b'-');
    }
}

/// `|value| power` rounded to the nearest whole number, ties to even; `None` if it is too large or not
/// finite.
fn scaled(value: f64, power: u64) -> Option<u64> {
    let magnitude = value.abs();
    if magnitude.is_nan() || magnitude >= LARGE {
        return None;
    }
    let bits = magnitude.to_bits();
    let exponent = (bits >> 52) as i32;
    let fraction = bits & ((1 << 52) - 1);
    // Below 10^12 < 2^40 the exponent of the last bit is negative, so `shift` is at least 12.
    let (m, shift) =
        if exponent == 0 { (fraction, 1074) } else { (fraction | 1 << 52, (1075 - exponent) as u32) };
    if shift > 100 {
        return Some(0);
    }
    let product = u128::from(m) * u128::from(power);
    let half = 1_u128 << (shift - 1);
    let floor = (product >> shift) as u64;
    let rest = product & ((half << 1) - 1);
    let up = rest > half || (rest == half && floor & 1 == 1);
    Some(floor + u64::from(up))
}

/// Appends a number of any count of digits.
fn whole(out: &mut Vec<u8>, value: u64) {
    match value {
        0..10 => out.push(b'0' + value as u8),
        10..100 => out.extend_from_slice(&pair(value)),
        100..1_000 => {
            let [b, c] = pair(value);
            out.extend_from_slice(&[b'0' + (value / 100) as u8, b, c]);
        }
        1_000..10_000 => {
            let ([a, b], [c, d]) = (pair(value / 100), pair(value));
            out.extend_from_slice(&[a, b, c, d]);
        }
        _ => {
            whole(out, value / 10_000);
            let ([a, b], [c, d]) = (pair(value / 100), pair(value));
            out.extend_from_slice(&[a, b, c, d]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(append: impl Fn(&mut Vec<u8>, f64), value: f64) -> String {
        let mut out = Vec::new();
        append(&mut out, value);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn ties_go_to_the_even_digit_and_zero_keeps_its_sign() {
        // Exact ties: odd multiples of 1/32 have five decimals that end in 5.
        for n in -100_000..100_000 {
            let value = f64::from(n) / 32.0;
            assert_eq!(text(four, value), format!("{value:.4}"));
            let value = f64::from(n) / 128.0;
            assert_eq!(text(six, value), format!("{value:.6}"));
        }
        assert_eq!(text(four, 0.03125), "0.0312");
        assert_eq!(text(four, 0.09375), "0.0938");
        assert_eq!(text(four, -0.0), "-0.0000");
        assert_eq!(text(four, -1e-9), "-0.0000");
        assert_eq!(text(four, 5e-324), "0.0000");
        assert_eq!(text(four, 999_999.999_95), "999999.9999");
        assert_eq!(text(four, 9.999_96), "10.0000");
        assert_eq!(text(four, 1e30), "1000000000000000019884624838656.0000");
    }

    #[test]
    fn the_limit_of_the_exact_way_is_seamless() {
        for value in [LARGE, LARGE.next_down(), LARGE.next_up(), -LARGE.next_down()] {
            assert_eq!(text(four, value), format!("{value:.4}"));
            assert_eq!(text(six, value), format!("{value:.6}"));
        }
    }

    proptest! {
        #[test]
        fn every_double_prints_as_the_standard_formatter_does(bits: u64) {
            let value = f64::from_bits(bits);
            prop_assert_eq!(text(four, value), format!("{value:.4}"));
            prop_assert_eq!(text(six, value), format!("{value:.6}"));
        }

        #[test]
        fn lengths_print_as_the_standard_formatter_does(value in -1e6..1e6_f64) {
            prop_assert_eq!(text(four, value), format!("{value:.4}"));
            prop_assert_eq!(text(six, value), format!("{value:.6}"));
        }

        #[test]
        fn whole_numbers_print_as_the_standard_formatter_does(value: i64) {
            prop_assert_eq!(text(|out, _| integer(out, value), 0.0), value.to_string());
        }
    }
}
