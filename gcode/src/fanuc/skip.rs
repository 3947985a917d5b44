//! What of a line is left out: `/` to `/9` with their switch on, and what stands behind the end of a tape.

use crate::block::Block;
use crate::codes::{M, m_group};
use crate::options::Skips;
use crate::text::Cursor;

/// `/`, which is `/1`, to `/9` at the cursor: whether its switch is on and the rest of the line is left out.
pub(super) fn is_left_out(skips: Skips, cursor: &mut Cursor) -> bool {
    if !cursor.take_if(b'/') {
        return false;
    }
    let switch = match cursor.peek() {
        Some(digit @ b'1'..=b'9') => {
            cursor.skip();
            digit - b'0'
        }
        _ => 1,
    };
    skips.is_on(switch)
}

/// `M30%`: the last line of a tape lost its end.
pub(super) fn is_end_of_tape(block: &Block, cursor: &mut Cursor) -> bool {
    let mut ahead = cursor.clone();
    ahead.skip();
    let ends = matches!(block.m(m_group::STOP), Some(M(2 | 30))) || block.m(m_group::CALL) == Some(M(99));
    let is_last = ends && ahead.peek().is_none();
    if is_last {
        *cursor = ahead;
    }
    is_last
}
