//! A place in a name, and what can be read from there. In: text. Out: numbers, letters, refusals with their
//! place.

use std::{fmt, ops::Range};

/// Why a name was not understood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misread {
    /// Where, in bytes of the text.
    pub span: Range<usize>,
    /// What is wrong there.
    pub message: String,
    /// What would be right.
    pub help: String,
}

impl fmt::Display for Misread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.message, self.help)
    }
}

impl std::error::Error for Misread {}

/// A refusal of a part of the text.
pub(super) fn wrong_at(span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Misread {
    Misread { span, message: message.into(), help: help.into() }
}

/// A place in a text.
#[derive(Clone)]
pub(super) struct Cursor<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(text: &'a str) -> Cursor<'a> {
        Cursor { text, at: 0 }
    }

    /// Where it is.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// What is left.
    pub(super) fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    /// The next letter.
    pub(super) fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Passes over spaces. True if there is something behind them.
    pub(super) fn spaces(&mut self) -> bool {
        self.at += self.rest().len() - self.rest().trim_start().len();
        !self.rest().is_empty()
    }

    /// Passes over one of these letters.
    pub(super) fn one_of(&mut self, letters: &str) -> Option<char> {
        let found = self.peek().filter(|letter| letters.contains(*letter))?;
        self.at += found.len_utf8();
        Some(found)
    }

    /// Passes over a word, in capitals or not.
    pub(super) fn word(&mut self, word: &str) -> bool {
        let found = self.rest().get(..word.len()).is_some_and(|found| found.eq_ignore_ascii_case(word));
        self.at += if found { word.len() } else { 0 };
        found
    }

    /// Passes over letters of the alphabet.
    pub(super) fn letters(&mut self) -> &'a str {
        let rest = self.rest();
        let end = rest.find(|letter: char| !letter.is_ascii_alphabetic()).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    /// Passes over a number with a point or a comma, at most twelve digits long.
    pub(super) fn number(&mut self) -> Option<f64> {
        let (rest, start) = (self.rest(), self.at);
        let digits = |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let whole = digits(rest);
        let fraction = rest[whole..].strip_prefix(['.', ',']).map_or(0, digits);
        let length = if fraction == 0 { whole } else { whole + 1 + fraction };
        self.at += length;
        let value = rest[..length].replace(',', ".").parse().ok().filter(|_| (1..=12).contains(&length));
        if value.is_none() {
            self.at = start;
        }
        value
    }

    /// Passes over a whole number.
    pub(super) fn whole(&mut self) -> Option<u32> {
        let mut ahead = self.clone();
        let value = ahead.number().filter(|value| value.fract() == 0.0 && *value < 1e6)?;
        if self.text[self.at..ahead.at].contains(['.', ',']) {
            return None;
        }
        *self = ahead;
        Some(value as u32)
    }

    /// Passes over what may stand before a class, if a class stands there: a digit.
    pub(super) fn class(&mut self) -> bool {
        let mut ahead = self.clone();
        ahead.spaces();
        ahead.one_of("-");
        ahead.spaces();
        let found = ahead.peek().is_some_and(|letter| letter.is_ascii_digit());
        if found {
            *self = ahead;
        }
        found
    }

    /// A refusal of what lies between a place and here; of what follows if that is nothing.
    pub(super) fn wrong(&self, from: usize, message: impl Into<String>, help: impl Into<String>) -> Misread {
        let end = if from < self.at { self.at } else { self.text.len() };
        wrong_at(from..end, message, help)
    }
}
