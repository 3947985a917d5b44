//! What may stand above the `%` that begins a tape, and behind the `;` that ends a block: text, and not
//! blocks that somebody wants to have executed. In: a line. Out: whether it can be text.

/// So many lines are looked through for it.
pub(super) const LONGEST: u32 = 100;

/// Whether a line is text: outside of comments it has no letter, or two of them side by side, as no block
/// has.
pub(crate) fn is_text(line: &[u8]) -> bool {
    let outside: Vec<u8> = outside(line).collect();
    let letter = |byte: &u8| byte.is_ascii_alphabetic();
    !outside.iter().any(letter) || outside.windows(2).any(|pair| pair.iter().all(letter))
}

/// Whether it is a comment, or comments, and nothing else.
pub(super) fn is_remark(line: &[u8]) -> bool {
    outside(line).all(|byte| byte.is_ascii_whitespace())
}

/// What stands outside of comments.
fn outside(line: &[u8]) -> impl Iterator<Item = u8> + '_ {
    let mut depth = 0_u32;
    let bytes = line.iter().filter(move |byte| {
        match byte {
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            _ => return depth == 0,
        }
        false
    });
    bytes.take_while(|byte| **byte != b';').copied()
}

#[cfg(test)]
mod tests {
    use super::is_text;

    #[test]
    fn text_is_told_from_blocks() {
        for text in ["PROGRAM SHAFT", "(G1 X2)", "12.03.2026", "Drawing 44, G1", "; G1", "----"] {
            assert!(is_text(text.as_bytes()), "{text}");
        }
        for block in ["G1 X2", "O1000 (SHAFT)", "N10", "M30", "g0x1z2 (go)", "X1"] {
            assert!(!is_text(block.as_bytes()), "{block}");
        }
    }
}
