//! A reading position in one line. In: its bytes. Out: its characters in lower case, without the blanks and
//! tabs that may stand anywhere between (and within) words.

use crate::problem::{Blame, Problem, Span};

/// Reading position in a line.
#[derive(Clone)]
pub(crate) struct Cursor<'a> {
    text: &'a [u8],
    /// The next byte.
    at: usize,
    /// The byte after the last one taken.
    taken: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(text: &'a [u8]) -> Cursor<'a> {
        Cursor { text, at: 0, taken: 0 }
    }

    /// The next byte that is not blank, in lower case; it is not taken.
    #[inline]
    pub(crate) fn peek(&mut self) -> Option<u8> {
        loop {
            match *self.text.get(self.at)? {
                b' ' | b'\t' => self.at += 1,
                byte => return Some(byte.to_ascii_lowercase()),
            }
        }
    }

    /// Takes the byte that was peeked at.
    #[inline]
    pub(crate) fn skip(&mut self) {
        self.at += 1;
        self.taken = self.at;
    }

    /// Takes the next byte.
    #[inline]
    pub(crate) fn take(&mut self) -> Option<u8> {
        let byte = self.peek()?;
        self.skip();
        Some(byte)
    }

    /// Takes the next byte if it is `expected`.
    #[inline]
    pub(crate) fn take_if(&mut self, expected: u8) -> bool {
        let is = self.peek() == Some(expected);
        if is {
            self.skip();
        }
        is
    }

    /// The bytes that are not taken yet, blanks included.
    #[inline]
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.text.get(self.at..).unwrap_or(&[])
    }

    /// Takes so many bytes.
    #[inline]
    pub(crate) fn advance(&mut self, bytes: usize) {
        self.at += bytes;
        self.taken = self.at;
    }

    /// How many digits come next, without a blank before or between them.
    pub(crate) fn digits_here(&self) -> u8 {
        let rest = self.rest();
        rest.iter().take_while(|byte| byte.is_ascii_digit()).count().min(255) as u8
    }

    /// Takes one of `names` (lower case, longest first where one begins with another).
    pub(crate) fn take_name<T: Copy>(&mut self, names: &[(&str, T)]) -> Option<T> {
        let first = self.peek()?;
        let before = (self.at, self.taken);
        for (name, value) in names {
            if name.as_bytes().first() == Some(&first) && name.bytes().all(|byte| self.take_if(byte)) {
                return Some(*value);
            }
            (self.at, self.taken) = before;
        }
        None
    }

    /// Takes everything up to `end`, and `end` itself; `None` if it does not come.
    pub(crate) fn take_until(&mut self, end: u8) -> Option<&'a [u8]> {
        let rest = self.text.get(self.at..)?;
        let length = rest.iter().position(|byte| *byte == end)?;
        self.at += length + 1;
        self.taken = self.at;
        rest.get(..length)
    }

    /// Takes everything to the end of the line.
    pub(crate) fn take_rest(&mut self) -> &'a [u8] {
        let rest = self.rest();
        (self.at, self.taken) = (self.text.len(), self.text.len());
        rest
    }

    /// The byte at which the next character stands.
    #[inline]
    pub(crate) fn mark(&mut self) -> u32 {
        self.peek();
        self.at as u32
    }

    /// The bytes from `start` to the last one taken.
    #[inline]
    pub(crate) fn span(&self, start: u32) -> Span {
        Span { start, end: (self.taken as u32).max(start) }
    }

    /// The next character, or the end of the line.
    pub(crate) fn here(&mut self) -> Blame {
        let start = self.mark();
        let rest = self.rest();
        let width = match rest.utf8_chunks().next() {
            Some(chunk) => chunk.valid().chars().next().map_or(1, char::len_utf8),
            None => 0,
        };
        Blame::Span(Span { start, end: start + width as u32 })
    }

    /// The next character as it stands in the line, if it is one.
    pub(crate) fn character(&mut self) -> Option<char> {
        self.peek();
        self.text.get(self.at..)?.utf8_chunks().next()?.valid().chars().next()
    }

    /// An error at the next character.
    pub(crate) fn error_here(
        &mut self,
        code: &'static str,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<Problem> {
        Problem::error(code, self.here(), message, help)
    }

    /// An error from byte `start` to the last one taken.
    pub(crate) fn error_from(
        &self,
        start: u32,
        code: &'static str,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<Problem> {
        Problem::error(code, Blame::Span(self.span(start)), message, help)
    }
}
