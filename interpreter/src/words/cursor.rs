//! A reading position in one line. In: the text of the line. Out: its characters in lower case, without the blanks
//! and tabs that may stand anywhere between (and within) words.

use crate::diagnostic::{Diagnostic, Spot};

/// Reading position in a line.
pub(crate) struct Cursor<'a> {
    line: u32,
    text: &'a str,
    /// Byte of the next character.
    at: usize,
    /// Byte after the last character taken.
    taken: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(line: u32, text: &'a str) -> Cursor<'a> {
        Cursor { line, text, at: 0, taken: 0 }
    }

    /// The next character in lower case, not taken.
    pub(crate) fn peek(&mut self) -> Option<char> {
        let rest = self.text[self.at..].trim_start_matches([' ', '\t']);
        self.at = self.text.len() - rest.len();
        rest.chars().next().map(|c| c.to_ascii_lowercase())
    }

    /// Takes the next character.
    pub(crate) fn take(&mut self) -> Option<char> {
        let c = self.peek()?;
        self.at += self.text[self.at..].chars().next().map_or(0, char::len_utf8);
        self.taken = self.at;
        Some(c)
    }

    /// Takes the next character if it is `expected`.
    pub(crate) fn take_if(&mut self, expected: char) -> bool {
        let is = self.peek() == Some(expected);
        if is {
            self.take();
        }
        is
    }

    /// Takes the letters that come next.
    pub(crate) fn take_letters(&mut self) -> String {
        let mut name = String::new();
        while let Some(c) = self.peek().filter(char::is_ascii_alphabetic) {
            name.push(c);
            self.take();
        }
        name
    }

    /// Takes one of `names` (lower case, longest first where one begins with another).
    pub(crate) fn take_name<T: Copy>(&mut self, names: &[(&str, T)]) -> Option<T> {
        let (at, taken) = (self.at, self.taken);
        for (name, value) in names {
            if name.chars().all(|c| self.take_if(c)) {
                return Some(*value);
            }
            (self.at, self.taken) = (at, taken);
        }
        None
    }

    /// Takes a comment in parentheses, the opening one taken already; returns its text, or `None` if it is not closed.
    pub(crate) fn take_comment(&mut self) -> Option<&'a str> {
        let start = self.at;
        let length = self.text[start..].find(')')?;
        self.at = start + length + 1;
        self.taken = self.at;
        Some(&self.text[start..start + length])
    }

    /// Takes everything to the end of the line.
    pub(crate) fn take_rest(&mut self) -> &'a str {
        let rest = &self.text[self.at..];
        (self.at, self.taken) = (self.text.len(), self.text.len());
        rest
    }

    /// Byte at which the next character stands.
    pub(crate) fn mark(&mut self) -> usize {
        self.peek();
        self.at
    }

    /// The place from byte `start` to the last character taken.
    pub(crate) fn spot(&self, start: usize) -> Spot {
        let column = self.text[..start].chars().count() as u32 + 1;
        Spot { line: self.line, column, start, end: self.taken.max(start) }
    }

    /// The place of the next character, or of the end of the line.
    pub(crate) fn here(&mut self) -> Spot {
        let start = self.mark();
        let width = self.text[start..].chars().next().map_or(0, char::len_utf8);
        Spot { end: start + width, ..self.spot(start) }
    }

    /// An error at the next character.
    pub(crate) fn error_here(
        &mut self,
        code: &'static str,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Diagnostic {
        let spot = self.here();
        Diagnostic::error(code, spot, message, help)
    }
}
