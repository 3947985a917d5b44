//! From the bytes of a line to its words: letters, values, comments, parameters.

mod comment;
mod cursor;
pub(crate) mod degrees;
mod expression;
mod line;
pub mod memory;
mod notes;
mod number;
mod operator;

pub(crate) use comment::speaks;
pub(crate) use cursor::Cursor;
pub(crate) use expression::whole;
pub(crate) use line::{Head, Reader, head, parentheses, semicolon};
pub(crate) use notes::Operation;
pub(crate) use number::number;
