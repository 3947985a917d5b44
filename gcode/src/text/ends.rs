//! Where lines end, and what is said of those that cannot be read.

use std::io;

use crate::problem::{Blame, Problem, Span};

/// Place of the first byte `ends`: eight bytes at a time, a byte of `word` is zero where there is one.
pub(super) fn line_end(text: &[u8], ends: u8) -> Option<usize> {
    const ONES: u64 = 0x0101_0101_0101_0101;
    let (chunks, rest) = text.as_chunks::<8>();
    for (index, chunk) in chunks.iter().enumerate() {
        let word = u64::from_le_bytes(*chunk) ^ (ONES * u64::from(ends));
        let zero = word.wrapping_sub(ONES) & !word & (ONES << 7);
        if zero != 0 {
            return Some(8 * index + zero.trailing_zeros() as usize / 8);
        }
    }
    let searched = text.len() - rest.len();
    rest.iter().position(|byte| *byte == ends).map(|at| searched + at)
}

pub(super) fn too_long(number: u32, longest: usize) -> Box<Problem> {
    let message = format!("line {number} has more than {longest} bytes, the limit line_length");
    let start = longest as u32;
    let blame = Blame::Span(Span { start, end: start + 1 });
    Problem::error("line-too-long", blame, message, "divide it into several lines")
}

pub(super) fn unreadable(number: u32, error: &io::Error) -> Box<Problem> {
    let help = "copy the program to a disk that can be read";
    Problem::error("unreadable", Blame::Line(number), format!("the file cannot be read here: {error}"), help)
}
