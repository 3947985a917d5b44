//! Lines of a file that grows until its writer is killed, so that a torn or damaged one is told and not taken
//! for another one. In: lines. Out: bytes; and back, as far as all of it is whole.
//!
//! Each line is written as `hash number line`, twice, with an empty line between: the hash is the first 32
//! bits of the BLAKE3 of `number line`, numbers count from 0. Wherever one bit turns over, one of the two is
//! whole; what is written of a line when the power goes is none, or this one.

use std::fmt::Write as _;

/// Digits of a hash.
const DIGITS: usize = 8;

fn hash(text: &[u8]) -> [u8; DIGITS] {
    let hex = blake3::hash(text).to_hex();
    std::array::from_fn(|at| hex.as_bytes()[at])
}

/// Lines as they are written, numbered from `first`.
pub(super) fn sealed(first: usize, lines: &str) -> String {
    let mut text = String::new();
    for (number, line) in (first..).zip(lines.lines()) {
        let numbered = format!("{number} {line}");
        let hash = hash(numbered.as_bytes());
        let hash = hash.map(char::from).iter().collect::<String>();
        let _ = write!(text, "{hash} {numbered}\n\n{hash} {numbered}\n");
    }
    text
}

/// The lines before the first that is not whole in either place, and whether there was such a one.
pub(super) fn unsealed(bytes: &[u8]) -> (Vec<String>, bool) {
    let (mut lines, mut damaged, mut once_more) = (Vec::<String>::new(), false, false);
    for piece in bytes.split(|byte| *byte == b'\n').filter(|piece| !piece.is_empty()) {
        match one(piece) {
            Some((number, line)) if number == lines.len() => {
                lines.push(line.into());
                (damaged, once_more) = (false, true);
            }
            Some((number, _)) if number + 1 == lines.len() => once_more = false,
            Some(_) => return (lines, true),
            // The second of a line that is there, or one that may still be found in its second.
            None => damaged |= !std::mem::take(&mut once_more),
        }
    }
    (lines, damaged)
}

/// A line with its number, if it is whole.
fn one(piece: &[u8]) -> Option<(usize, &str)> {
    let (told, numbered) = piece.split_first_chunk::<DIGITS>()?;
    let numbered = numbered.strip_prefix(b" ")?;
    if hash(numbered) != *told {
        return None;
    }
    let (number, line) = std::str::from_utf8(numbered).ok()?.split_once(' ')?;
    Some((number.parse().ok()?, line))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINES: [&str; 5] = ["a title 1", "seed 7", "8 drive-command/z 6", "9 drive-command/z due", "9 x"];

    fn written() -> Vec<u8> {
        (sealed(0, "a title 1\nseed 7\n") + &sealed(2, &LINES[2..].join("\n"))).into_bytes()
    }

    #[test]
    fn a_bit_that_turns_over_costs_no_line() {
        let bytes = written();
        assert_eq!(unsealed(&bytes), (LINES.map(String::from).into(), false));
        for bit in 0..8 * bytes.len() {
            let mut bytes = bytes.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(unsealed(&bytes).0, LINES, "bit {bit}");
        }
    }

    #[test]
    fn what_is_torn_or_damaged_is_told_and_not_taken_for_another_line() {
        let bytes = written();
        for length in 0..=bytes.len() {
            let (lines, damaged) = unsealed(&bytes[..length]);
            assert_eq!(lines, LINES[..lines.len()], "of {length} bytes");
            let told = damaged || sealed(0, &lines.join("\n")).len() >= length;
            assert!(told, "{length} bytes are more than {lines:?}");
        }
        // Both of one line are spoilt: what stands behind it counts no more.
        let text = String::from_utf8(bytes).expect("text");
        let (lines, damaged) = unsealed(text.replace("/z 6", "/z 5").as_bytes());
        assert_eq!((&lines[..], damaged), (&LINES.map(String::from)[..2], true));
        assert_eq!(unsealed(b"pitchlock\n"), (Vec::new(), true));
        assert_eq!(unsealed(b""), (Vec::new(), false));
    }
}
