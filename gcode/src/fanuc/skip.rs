//! What of a line is left out: `/` to `/9` with their switch on, remarks behind `;`, and what stands behind
//! the end of a tape.

use super::line::{Idle, Line};
use crate::block::Block;
use crate::codes::{M, m_group};
use crate::execute::Done;
use crate::options::Skips;
use crate::problem::Problem;
use crate::text::{Cursor, is_text};

/// What begins a line that is no text though its letters stand side by side.
const FLOW: [(&str, ()); 5] = [("if", ()), ("goto", ()), ("while", ()), ("do", ()), ("end", ())];

/// `/`, which is `/1`, to `/9` at the cursor: whether its switch is on and the rest of the line is left out.
/// It stands at the head of a block, before or behind its number.
///
/// # Errors
/// No switch has the number.
pub(super) fn is_left_out(skips: Skips, cursor: &mut Cursor) -> Result<bool, Box<Problem>> {
    let start = cursor.mark();
    if !cursor.take_if(b'/') {
        return Ok(false);
    }
    let switch = match cursor.peek() {
        Some(digit @ b'0'..=b'9') => {
            cursor.skip();
            digit - b'0'
        }
        _ => 1,
    };
    if switch == 0 || matches!(cursor.peek(), Some(b'0'..=b'9')) {
        let help = "the switches of block delete are / (which is /1) to /9";
        return Err(cursor.error_from(start, "bad-value", "no switch of block delete has this number", help));
    }
    Ok(skips.is_on(switch))
}

/// `G01 X10. /2 M08`: in the middle of a block the switch leaves out what follows.
///
/// # Errors
/// No switch has the number; nothing follows that could be left out.
pub(super) fn rest(skips: Skips, cursor: &mut Cursor) -> Result<(), Box<Problem>> {
    let start = cursor.mark();
    let optional = is_left_out(skips, cursor)?;
    if matches!(cursor.peek(), None | Some(b'(' | b';')) {
        let help = "/ leaves out what follows it in the block; a division needs brackets, as in X[10/2]";
        return Err(cursor.error_from(start, "bad-character", "nothing follows this /", help));
    }
    if optional {
        cursor.take_rest();
    }
    Ok(())
}

/// `G00 X10.; Tool 1`: `;` ends a block, and only text may stand behind it, with a warning.
///
/// # Errors
/// It may be another block.
pub(super) fn behind_end(cursor: &mut Cursor, line: &mut Line) -> Done {
    let start = cursor.mark();
    let flows = cursor.peek() == Some(b'#') || cursor.clone().take_name(&FLOW).is_some();
    if flows || !is_text(cursor.clone().take_rest()) {
        let help = "; ends a block; write the next block on a line of its own";
        return Err(cursor.error_here("bad-character", "this stands after the end of the block", help));
    }
    cursor.take_rest();
    // A line of its own is a remark in most programs that have any: it may stand above O, too.
    if line.idle.is_none() && line.block.has_words() {
        let message = "what stands behind ; is taken for a remark, as no block can be".into();
        line.idle = Some(Idle { span: cursor.span(start), message, words: 0 });
    }
    Ok(())
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
