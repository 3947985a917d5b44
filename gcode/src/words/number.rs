//! Numbers: digits with at most one point, blanks between them, no sign, no exponent. In: a cursor at a digit or
//! point. Out: the f64 that is nearest to what is written.

use super::cursor::Cursor;
use crate::problem::Problem;

/// Powers of ten that an f64 holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19,
    1e20, 1e21, 1e22,
];
/// Whole numbers up to this are exact, too.
const EXACT: u64 = 1 << 53;

/// Reads a number.
///
/// If digits and power of ten are both exact, their quotient, rounded once, is the nearest number (W. D. Clinger,
/// "How to read floating point numbers accurately", 1990). Longer ones go through the standard library.
///
/// # Errors
/// There are no digits, or two points.
#[inline]
pub(crate) fn number(cursor: &mut Cursor) -> Result<f64, Box<Problem>> {
    let before = cursor.clone();
    let (mut digits, mut count, mut decimals, mut points) = (0u64, 0u32, 0usize, 0u32);
    while let Some(byte) = cursor.peek() {
        match byte {
            b'0'..=b'9' => {
                digits = digits.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
                count += 1;
                decimals += points as usize;
            }
            b'.' if points == 0 => points = 1,
            _ => break,
        }
        cursor.skip();
    }
    match POWERS.get(decimals) {
        Some(power) if (1..=19).contains(&count) && digits <= EXACT => {
            if cursor.peek() == Some(b'.') {
                return Err(malformed(before, cursor));
            }
            Ok(digits as f64 / power)
        }
        _ => long_number(before, cursor),
    }
}

/// A number of many digits, or none.
#[cold]
fn long_number(mut from: Cursor, end: &mut Cursor) -> Result<f64, Box<Problem>> {
    let start = from.clone();
    let mut text = String::new();
    while from.mark() < end.mark() {
        text.extend(from.take().map(char::from));
    }
    if end.peek() == Some(b'.') {
        return Err(malformed(start, end));
    }
    text.parse().map_err(|_| malformed(start, end))
}

#[cold]
fn malformed(mut from: Cursor, end: &mut Cursor) -> Box<Problem> {
    while matches!(end.peek(), Some(b'0'..=b'9' | b'.')) {
        end.skip();
    }
    let start = from.mark();
    let help = "a number has digits and at most one decimal point, as in 12, .5 or -3.25";
    end.error_from(start, "bad-number", "this is not a number", help)
}
