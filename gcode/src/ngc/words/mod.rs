//! From the bytes of a line to its words: letters, values, comments, parameters.

mod comment;
mod expression;
mod line;
mod notes;
mod operator;
mod told;

pub(crate) use comment::speaks;
pub(crate) use line::{Head, LineReader, head};
pub(crate) use notes::Operation;
