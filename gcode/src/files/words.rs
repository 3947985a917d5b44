//! Letters with numbers on a line of a file, and the place to blame when they are wrong.

use std::sync::Arc;

use crate::problem::{Blame, Diagnostic, Problem, Span};

/// A line that is read word by word, up to its semicolon.
pub(super) struct Words<'a> {
    name: &'a Arc<str>,
    line: u32,
    text: &'a str,
    /// The words, and what stands after the semicolon.
    words: &'a str,
    comment: &'a str,
    /// Where the word being read begins, and how far reading has come.
    start: usize,
    at: usize,
    blank: bool,
}

impl<'a> Words<'a> {
    pub(super) fn new(name: &'a Arc<str>, line: u32, text: &'a str) -> Words<'a> {
        let (words, comment) = text.split_once(';').unwrap_or((text, ""));
        Words { name, line, text, words, comment, start: 0, at: 0, blank: true }
    }

    /// The letter of the next word, as a capital; `None` at the end of the line.
    pub(super) fn next_letter(&mut self) -> Result<Option<char>, Box<Diagnostic>> {
        self.skip_blanks();
        self.start = self.at;
        let Some(letter) = self.rest().chars().next() else { return Ok(None) };
        self.blank = false;
        self.at += letter.len_utf8();
        if letter.is_ascii_alphabetic() {
            return Ok(Some(letter.to_ascii_uppercase()));
        }
        Err(self
            .wrong(format!("`{letter}` where a word begins"), "a word is a letter and a number, as Z-12.5"))
    }

    /// The number of the word.
    pub(super) fn number(&mut self) -> Result<f64, Box<Diagnostic>> {
        let text = self.digits();
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.wrong(
                format!("`{}` is not a word", self.word()),
                "write a decimal number after the letter, as Z-12.5",
            )),
        }
    }

    /// The number of the word, which is whole and within bounds.
    pub(super) fn whole(&mut self, least: i32, most: i32) -> Result<i32, Box<Diagnostic>> {
        let text = self.digits();
        // Other tools write whole numbers with a point, as in Q2.0.
        let (whole, point) = text.split_once('.').unwrap_or((text, ""));
        match whole.parse::<i32>() {
            Ok(value) if point.bytes().all(|digit| digit == b'0') && (least..=most).contains(&value) => {
                Ok(value)
            }
            _ => Err(self.wrong(
                format!("`{}` is not possible here", self.word()),
                format!("write a whole number of {least} to {most} after the letter"),
            )),
        }
    }

    /// Whether there was no word at all.
    pub(super) fn is_blank(&self) -> bool {
        self.blank
    }

    /// What stands after the semicolon.
    pub(super) fn comment(&self) -> &'a str {
        self.comment.trim_end()
    }

    /// A diagnostic at the word that was read last.
    pub(super) fn wrong(&self, message: impl Into<String>, help: impl Into<String>) -> Box<Diagnostic> {
        let span = Span { start: self.start as u32, end: self.at as u32 };
        let problem = Problem::error("bad-file", Blame::Span(span), message, help);
        Box::new(Diagnostic::new(*problem, self.name, self.line, self.text, span))
    }

    fn rest(&self) -> &'a str {
        self.words.get(self.at..).unwrap_or("")
    }

    fn word(&self) -> &'a str {
        self.words.get(self.start..self.at).unwrap_or("")
    }

    fn skip_blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    /// What stands up to the next blank or letter; blanks between letter and number are allowed.
    fn digits(&mut self) -> &'a str {
        self.skip_blanks();
        let rest = self.rest();
        let length = rest.find(|c: char| c.is_whitespace() || c.is_ascii_alphabetic()).unwrap_or(rest.len());
        self.at += length;
        rest.get(..length).unwrap_or("")
    }
}
