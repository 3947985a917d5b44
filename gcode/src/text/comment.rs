//! Comments. In: a cursor at their beginning. Out: their text, and the bytes it stands at.

use super::cursor::Cursor;
use crate::problem::{Blame, Problem, Span};

/// Takes a comment in parentheses: its text, and the bytes it stands at.
///
/// # Errors
/// It is not closed, holds another comment, or is not text.
pub(crate) fn parentheses<'a>(cursor: &mut Cursor<'a>) -> Result<(&'a str, Span), Box<Problem>> {
    let start = cursor.mark();
    cursor.skip();
    let Some(bytes) = cursor.take_until(b')') else {
        cursor.take_rest();
        return Err(cursor.error_from(start, "unclosed-comment", "the comment is not closed", "add a )"));
    };
    if bytes.contains(&b'(') {
        let help = "close the first comment before opening another, or use brackets [ ] in the text";
        return Err(cursor.error_from(start, "nested-comment", "a comment inside a comment", help));
    }
    Ok((readable(bytes, start + 1)?, cursor.span(start)))
}

/// Takes a comment that begins with a semicolon: its text with it, and the bytes it stands at.
///
/// # Errors
/// It is not text.
pub(crate) fn semicolon<'a>(cursor: &mut Cursor<'a>) -> Result<(&'a str, Span), Box<Problem>> {
    let start = cursor.mark();
    let text = readable(cursor.take_rest(), start)?;
    Ok((text, cursor.span(start)))
}

/// Bytes as text.
///
/// # Errors
/// They are not UTF-8, or hold control characters.
fn readable(bytes: &[u8], start: u32) -> Result<&str, Box<Problem>> {
    let (at, what) = match std::str::from_utf8(bytes) {
        Err(error) => (error.valid_up_to(), "bytes that are not UTF-8"),
        Ok(text) => match bytes.iter().position(|byte| byte.is_ascii_control() && *byte != b'\t') {
            Some(at) => (at, "a control character"),
            None => return Ok(text),
        },
    };
    let start = start + at as u32;
    let blame = Blame::Span(Span { start, end: start + 1 });
    let help = "save the program as UTF-8 (or plain ASCII) text";
    Err(Problem::error("bad-character", blame, format!("the comment holds {what}"), help))
}
