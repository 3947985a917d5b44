//! Comments that speak: MSG, DEBUG, PRINT, LOG, LOGOPEN, LOGAPPEND, LOGCLOSE, ABORT. In: the text between the
//! parentheses and the state. Out: a [`Comment`] with the values of its parameters put in.

use std::fmt::Write;

use super::expression::named;
use crate::block::{Comment, CommentKind};
use crate::problem::{Blame, Problem, Span};
use crate::state::State;
use crate::state::memory::{DEBUG_SHOWN, LAST};

/// What stands for a parameter that is not set.
const UNKNOWN: &str = "######";
/// What is smaller is written as 0, without a sign (LinuxCNC 2.10).
const ZERO: f64 = 1e-6;
/// Numbers that would be longer than this are not written.
const LONGEST_NUMBER: usize = 29;

/// What begins a comment that speaks; `(ABORT,...)` and Python are not [`CommentKind`]s.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Verb {
    Say(CommentKind),
    Log(&'static str),
    Abort,
    Python,
}

const VERBS: [(&str, Verb); 10] = [
    ("msg", Verb::Say(CommentKind::Message)),
    ("debug", Verb::Say(CommentKind::Debug)),
    ("print", Verb::Say(CommentKind::Print)),
    ("log", Verb::Log("LOG")),
    ("logopen", Verb::Log("LOGOPEN")),
    ("logappend", Verb::Log("LOGAPPEND")),
    ("abort", Verb::Abort),
    ("py", Verb::Python),
    ("pyrun", Verb::Python),
    ("logclose", Verb::Log("LOGCLOSE")),
];

/// Whether a comment does more than explain.
pub(crate) fn speaks(text: &str) -> bool {
    verb(text).is_some()
}

fn verb(text: &str) -> Option<(Verb, &str)> {
    if text.trim().eq_ignore_ascii_case("logclose") {
        return Some((Verb::Log("LOGCLOSE"), ""));
    }
    let (name, rest) = text.split_once(',')?;
    let name = name.trim();
    let verb = VERBS.iter().find(|(known, _)| name.eq_ignore_ascii_case(known))?.1;
    Some((verb, rest))
}

/// What the text of a comment says; `None` if it is switched off.
///
/// # Errors
/// A name is not closed; the comment ends the program, or asks for Python.
pub(super) fn comment(text: &str, span: Span, state: &State) -> Result<Option<Comment>, Box<Problem>> {
    let Some((verb, rest)) = verb(text) else {
        let text = text.trim_start().to_owned();
        return Ok(Some(Comment { kind: CommentKind::Plain, text }));
    };
    let comment = match verb {
        Verb::Say(CommentKind::Debug) if state.memory.numbered(DEBUG_SHOWN) <= 0.0 => return Ok(None),
        Verb::Say(kind @ CommentKind::Message) => Comment { kind, text: rest.to_owned() },
        Verb::Say(kind) => Comment { kind, text: expanded(rest, span, state)? },
        Verb::Log(verb @ "LOG") => logged(verb, &expanded(rest, span, state)?),
        Verb::Log(verb) => logged(verb, rest),
        Verb::Abort => {
            let message = expanded(rest, span, state)?;
            let help = "the program ends itself by (ABORT,...): see what leads there";
            return Err(Problem::error("abort", Blame::Span(span), message, help));
        }
        Verb::Python => {
            let help = "write what it does in G-code";
            return Err(Problem::error("not-available", Blame::Span(span), "Python is not available", help));
        }
    };
    Ok(Some(comment))
}

fn logged(verb: &str, text: &str) -> Comment {
    Comment { kind: CommentKind::Log, text: format!("{verb},{text}") }
}

/// The text with the values of `#n` and `#<name>`, and without `%d`, `%f` and `%.Nf`, which say how many
/// decimals those after them have.
fn expanded(text: &str, span: Span, state: &State) -> Result<String, Box<Problem>> {
    let mut out = String::with_capacity(text.len() + 16);
    let (mut rest, mut decimals) = (text, 6);
    while let Some(at) = rest.find(['#', '%']) {
        out.push_str(rest.get(..at).unwrap_or(""));
        let (mark, behind) = rest.split_at(at).1.split_at(1);
        rest = if mark == "%" {
            match format_of(behind) {
                Some((digits, behind)) => {
                    decimals = digits;
                    behind
                }
                None => {
                    // LinuxCNC prints `.` for the `%.` of an unfinished format.
                    out.push_str(if behind.starts_with('.') { "" } else { "%" });
                    behind
                }
            }
        } else {
            parameter(behind, decimals, span, state, &mut out)?
        };
    }
    out.push_str(rest);
    Ok(out)
}

/// The decimals that the text after a `%` asks for, and what comes after that.
fn format_of(text: &str) -> Option<(usize, &str)> {
    if let Some(behind) = text.strip_prefix('d') {
        return Some((0, behind));
    }
    if let Some(behind) = text.strip_prefix('f') {
        return Some((4, behind));
    }
    let (digit, behind) = text.strip_prefix('.')?.split_at_checked(1)?;
    Some((digit.parse().ok()?, behind.strip_prefix('f')?))
}

/// Writes the value of the parameter that stands after a `#`; returns what comes after that.
fn parameter<'a>(
    text: &'a str,
    decimals: usize,
    span: Span,
    state: &State,
    out: &mut String,
) -> Result<&'a str, Box<Problem>> {
    let (value, behind) = if let Some(name) = text.strip_prefix('<') {
        let Some((name, behind)) = name.split_once('>') else {
            let help = "names stand in < >, as in #<depth>";
            let message = "the closing > of a name in the comment is missing";
            return Err(Problem::error("missing-bracket", Blame::Span(span), message, help));
        };
        let blank = |c: &char| !c.is_ascii_whitespace();
        let name: String = name.chars().filter(blank).map(|c| c.to_ascii_lowercase()).collect();
        (named(&name, state), behind)
    } else {
        let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
        let (digits, behind) = text.split_at(end);
        if digits.is_empty() {
            out.push('#');
            return Ok(text);
        }
        let index = digits.parse().ok().filter(|index| *index <= LAST);
        (index.map(|index| super::expression::numbered(index, state)), behind)
    };
    write_value(value, decimals, out);
    Ok(behind)
}

fn write_value(value: Option<f64>, decimals: usize, out: &mut String) {
    let before = out.len();
    let Some(value) = value else { return out.push_str(UNKNOWN) };
    let value = if value.abs() < ZERO { 0.0 } else { value };
    // A text in memory takes everything.
    let _ = write!(out, "{value:.decimals$}");
    if out.len() - before > LONGEST_NUMBER {
        out.truncate(before);
        out.push_str(UNKNOWN);
    }
}
