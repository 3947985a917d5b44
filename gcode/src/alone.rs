//! One line, or one value, without a program around it: for tools that look at lines, and for those who throw bytes at
//! the reader to see whether it stands.

use crate::block::Block;
use crate::fanuc;
use crate::options::{Dialect, Options};
use crate::problem::Problem;
use crate::state::State;
use crate::words::{Cursor, Reader, head};

/// Reads a line at the start of a program: N and words, their values computed. Nothing is executed. The block of a line
/// that directs the flow (O words, IF, GOTO, ...) has no words.
///
/// # Errors
/// What is wrong with the line; [`crate::problem::Blame`] names the bytes.
pub fn line(text: &[u8], options: &Options) -> Result<Block, Box<Problem>> {
    let mut state = State::new(options);
    if options.dialect == Dialect::Fanuc {
        return fanuc::line_alone(text, &state, options);
    }
    let mut block = Block::default();
    block.clear(0, 1);
    let mut cursor = Cursor::new(text);
    let head = head(&mut cursor)?;
    if let Some((number, digits)) = head.number {
        (block.n, block.n_digits) = (Some(number), digits);
    }
    if cursor.peek() != Some(b'o') {
        Reader::new(options.limits.expression_depth).words(&mut cursor, &mut state, &mut block)?;
    }
    Ok(block)
}

/// Computes a value at the start of a program: a number, a parameter, a function, an expression in brackets. `None` is
/// what the dialect `fanuc` calls vacant.
///
/// # Errors
/// It is none, cannot be computed, or something stands behind it.
pub fn value(text: &[u8], options: &Options) -> Result<Option<f64>, Box<Problem>> {
    let state = State::new(options);
    let mut cursor = Cursor::new(text);
    let value = match options.dialect {
        Dialect::Linuxcnc => {
            Reader::new(options.limits.expression_depth).values(&state).value(&mut cursor).map(Some)
        }
        Dialect::Fanuc => fanuc::value_alone(&mut cursor, &state, options),
    }?;
    match cursor.peek() {
        None => Ok(value),
        Some(_) => {
            let help = "a value is a number, a parameter or an expression in brackets";
            Err(cursor.error_here("bad-character", "this stands behind the value", help))
        }
    }
}
