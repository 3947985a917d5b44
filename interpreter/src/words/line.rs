//! One line as words. In: the text of a line and the parameters. Out: its words with their values and places, and
//! the assignments, which take effect once the line has been read.

use super::cursor::Cursor;
use super::expression::{read_index, read_value};
use super::parameters::Parameters;
use crate::diagnostic::{Diagnostic, Spot};

/// Longest line, characters.
const LONGEST: usize = 256;
/// Largest number of an N word.
const LAST_N: u64 = 99_999;

/// A letter with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Word {
    /// Upper-case letter.
    pub(crate) letter: char,
    pub(crate) value: f64,
    pub(crate) spot: Spot,
}

/// What a line holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Line {
    pub(crate) words: Vec<Word>,
    /// Parameters to set when the line has been read.
    pub(crate) assignments: Vec<(u32, f64)>,
    /// Comments that speak to the operator, `(MSG, ...)` and the like.
    pub(crate) messages: Vec<Spot>,
}

impl Line {
    /// A line of comments only, or nothing at all.
    pub(crate) fn is_empty(&self) -> bool {
        self.words.is_empty() && self.assignments.is_empty()
    }
}

/// Reads a line. The switch for optional lines is off: a leading `/` changes nothing.
pub(crate) fn read_line(number: u32, text: &str, parameters: &Parameters) -> Result<Line, Diagnostic> {
    let mut cursor = Cursor::new(number, text);
    if text.chars().count() > LONGEST {
        let message = format!("the line has more than {LONGEST} characters");
        return Err(cursor.error_here("line-too-long", message, "divide it into several lines"));
    }
    let mut line = Line::default();
    cursor.take_if('/');
    if cursor.peek() == Some('n') {
        line_number(&mut cursor)?;
    }
    while let Some(c) = cursor.peek() {
        let start = cursor.mark();
        match c {
            ';' => {
                cursor.take();
                cursor.take_rest();
            }
            '(' => comment(&mut cursor, &mut line)?,
            '#' => {
                cursor.take();
                let assignment = assignment(&mut cursor, parameters, start)?;
                line.assignments.push(assignment);
            }
            'n' => {
                let help = "a line number comes first in its line";
                return Err(cursor.error_here("misplaced-line-number", "N inside a line", help));
            }
            'o' => return Err(o_word(&mut cursor)),
            c if c.is_ascii_alphabetic() => {
                cursor.take();
                let value = read_value(&mut cursor, parameters)?;
                line.words.push(Word { letter: c.to_ascii_uppercase(), value, spot: cursor.spot(start) });
            }
            c => return Err(bad_character(&mut cursor, c)),
        }
    }
    Ok(line)
}

fn bad_character(cursor: &mut Cursor, c: char) -> Diagnostic {
    let help = match c {
        '%' => "a % stands alone on the first and the last line of a program",
        '/' => "a / that marks an optional line comes first in it",
        '$' => "this machine has one spindle: leave $ out",
        ')' => "a comment begins with (",
        '\u{feff}' => "save the file without a byte order mark",
        _ => "a block is made of words such as G1 or X-2.5; put remarks in parentheses or after ;",
    };
    cursor.error_here("bad-character", format!("{c:?} cannot begin a word"), help)
}

fn line_number(cursor: &mut Cursor) -> Result<(), Diagnostic> {
    let start = cursor.mark();
    cursor.take();
    let mut digits = String::new();
    while let Some(c) = cursor.peek().filter(char::is_ascii_digit) {
        digits.push(c);
        cursor.take();
    }
    if digits.parse::<u64>().is_ok_and(|n| n <= LAST_N) {
        return Ok(());
    }
    let help = format!("a line number is a whole number from 0 to {LAST_N}, or left out");
    Err(Diagnostic::error("bad-line-number", cursor.spot(start), "N without a usable number", help))
}

fn comment(cursor: &mut Cursor, line: &mut Line) -> Result<(), Diagnostic> {
    let start = cursor.mark();
    cursor.take();
    let Some(text) = cursor.take_comment() else {
        cursor.take_rest();
        let spot = cursor.spot(start);
        return Err(Diagnostic::error("unclosed-comment", spot, "the comment is not closed", "add a )"));
    };
    let spot = cursor.spot(start);
    if text.contains('(') {
        let help = "close the first comment before opening another, or use brackets [ ] in the text";
        return Err(Diagnostic::error("nested-comment", spot, "a comment inside a comment", help));
    }
    let verb = text.split(',').next().unwrap_or("").trim();
    let speaks = ["msg", "debug", "print", "log", "logopen", "probeopen"];
    if text.contains(',') && speaks.iter().any(|name| verb.eq_ignore_ascii_case(name)) {
        line.messages.push(spot);
    }
    Ok(())
}

fn assignment(cursor: &mut Cursor, parameters: &Parameters, start: usize) -> Result<(u32, f64), Diagnostic> {
    let index = read_index(cursor, parameters, start)?;
    if !cursor.take_if('=') {
        let help =
            "a line may set a parameter, as in #1=2.5; to use one, write a letter before it, as in X#1";
        return Err(cursor.error_here("missing-value", "= is missing here", help));
    }
    Ok((index, read_value(cursor, parameters)?))
}

fn o_word(cursor: &mut Cursor) -> Diagnostic {
    let start = cursor.mark();
    cursor.take_rest();
    let help = "write the blocks out one after the other, without sub, if, while or repeat";
    Diagnostic::error("not-available", cursor.spot(start), "O words are not available yet", help)
}
