//! Numbers: digits with at most one point, blanks between them, no sign, no exponent. In: a cursor at a digit
//! or point. Out: the f64 that is nearest to what is written.

use super::cursor::Cursor;
use crate::problem::Problem;

/// Powers of ten that an f64 holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];
/// Whole numbers up to this are also exact.
const EXACT: u64 = 1 << 53;

/// How far a number may be from a whole one that is meant.
const WHOLE: f64 = 1e-4;
/// Most digits that surely fit into a u64.
const DIGITS: usize = 19;

/// Reads a number.
///
/// # Errors
/// There are no digits, or two points.
#[inline]
pub(crate) fn number(cursor: &mut Cursor) -> Result<f64, Box<Problem>> {
    pointed_number(cursor).map(|(value, _)| value)
}

/// Reads a number, and whether it has a point.
///
/// If digits and power of ten are both exact, their quotient, rounded once, is the nearest number (W. D.
/// Clinger, "How to read floating point numbers accurately", 1990). Longer ones, and those with blanks
/// inside, go through the standard library.
///
/// # Errors
/// There are no digits, or two points.
#[inline]
pub(crate) fn pointed_number(cursor: &mut Cursor) -> Result<(f64, bool), Box<Problem>> {
    let text = cursor.rest();
    let mut digits = 0;
    let whole = take_digits(text, 0, &mut digits);
    let pointed = text.get(whole) == Some(&b'.');
    let (mut end, mut decimals) = (whole, 0);
    if pointed {
        end = take_digits(text, whole + 1, &mut digits);
        decimals = end - whole - 1;
    }
    let before = cursor.clone();
    cursor.advance(end);
    let goes_on = matches!(cursor.peek(), Some(b'0'..=b'9' | b'.'));
    match POWERS.get(decimals) {
        Some(power) if (1..=DIGITS).contains(&(whole + decimals)) && digits <= EXACT && !goes_on => {
            Ok((if decimals == 0 { digits as f64 } else { digits as f64 / power }, pointed))
        }
        _ => long_number(before, cursor),
    }
}

/// The whole number that a value is near to.
#[inline]
pub(crate) fn whole(value: f64) -> Option<i64> {
    let truncated = value as i64;
    if truncated as f64 == value {
        return Some(truncated);
    }
    let rounded = value.round();
    ((value - rounded).abs() <= WHOLE && rounded.abs() < 1e15).then_some(rounded as i64)
}

/// Appends the digits from byte `at` on to a number; returns the byte after them.
#[inline]
fn take_digits(text: &[u8], mut at: usize, number: &mut u64) -> usize {
    while let Some(byte) = text.get(at) {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        *number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    at
}

/// A number of many digits, one with blanks inside, or none.
#[cold]
fn long_number(mut from: Cursor, end: &mut Cursor) -> Result<(f64, bool), Box<Problem>> {
    let start = from.clone();
    while matches!(end.peek(), Some(b'0'..=b'9' | b'.')) {
        end.skip();
    }
    let mut text = String::new();
    while from.mark() < end.mark() {
        text.extend(from.take().map(char::from));
    }
    let value = text.parse().map_err(|_| malformed(start, end))?;
    Ok((value, text.contains('.')))
}

#[cold]
fn malformed(mut from: Cursor, end: &Cursor) -> Box<Problem> {
    let start = from.mark();
    let help = "a number has digits and at most one decimal point, as in 12, .5 or -3.25";
    end.error_from(start, "bad-number", "this is not a number", help)
}
