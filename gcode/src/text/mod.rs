//! What programs of both dialects are made of: files, lines, characters, numbers, comments.

mod comment;
mod cursor;
pub(crate) mod degrees;
mod depth;
mod encoding;
mod ends;
mod files;
pub(crate) mod job;
mod number;
mod operator;
mod source;
mod tape;

pub(crate) use comment::{parentheses, semicolon};
pub(crate) use cursor::Cursor;
pub(crate) use depth::Depth;
pub(crate) use files::Files;
pub use job::job_line;
pub(crate) use number::{number, pointed_number, whole};
pub(crate) use operator::Operator;
pub(crate) use source::{Line, Mark, Source};
pub(crate) use tape::is_text;

/// The text of a program for people, line by line as it is read: from UTF-8, UTF-16 or CP1252.
#[must_use]
pub fn readable(program: &[u8]) -> String {
    Source::whole(program)
}
