//! What programs of both dialects are made of: files, lines, characters, numbers, comments.

mod comment;
mod cursor;
pub(crate) mod degrees;
mod depth;
mod files;
pub(crate) mod job;
mod number;
mod operator;
mod source;

pub(crate) use comment::{parentheses, semicolon};
pub(crate) use cursor::Cursor;
pub(crate) use depth::Depth;
pub(crate) use files::Files;
pub(crate) use number::{number, whole};
pub(crate) use operator::Operator;
pub(crate) use source::{Line, Mark, Source};
