//! From the characters of a line to its words: letters, values, comments, assignments of parameters.

mod cursor;
mod expression;
mod line;
mod parameters;

pub(crate) use line::{Line, Word, read_line};
pub(crate) use parameters::Parameters;
