//! One line, or one value, without a program around it: for tools that look at lines, and for those who throw
//! bytes at the reader to see whether it stands.

use crate::block::Block;
use crate::options::{Dialect, Options};
use crate::problem::Problem;
use crate::state::State;
use crate::text::Cursor;
use crate::{fanuc, ngc};

/// Reads a line at the start of a program: N and words, their values computed. Nothing is executed. The block
/// of a line that directs the flow (O words, IF, GOTO, ...) has no words.
///
/// # Errors
/// What is wrong with the line; [`crate::problem::Blame`] names the bytes.
pub fn line(text: &[u8], options: &Options) -> Result<Block, Box<Problem>> {
    let mut state = State::new(options);
    match options.dialect {
        Dialect::Linuxcnc => ngc::line_alone(text, &mut state, options),
        Dialect::Fanuc => fanuc::line_alone(text, &state, options),
    }
}

/// Computes a value at the start of a program: a number, a parameter, a function, an expression in brackets.
/// `None` is what the dialect `fanuc` calls vacant.
///
/// # Errors
/// It is not a value, cannot be computed, or something stands after it.
pub fn value(text: &[u8], options: &Options) -> Result<Option<f64>, Box<Problem>> {
    let state = State::new(options);
    let mut cursor = Cursor::new(text);
    let value = match options.dialect {
        Dialect::Linuxcnc => ngc::value_alone(&mut cursor, &state, options).map(Some),
        Dialect::Fanuc => fanuc::value_alone(&mut cursor, &state, options),
    }?;
    match cursor.peek() {
        None => Ok(value),
        Some(_) => {
            let help = "a value is a number, a parameter or an expression in brackets";
            Err(cursor.error_here("bad-character", "this stands after the value", help))
        }
    }
}
