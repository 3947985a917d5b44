//! O words: what stands in a line that begins with O. In: a cursor at the O. Out: a [`Control`].

use super::labels::{Label, Labels};
use crate::ngc::words::{LineReader, speaks};
use crate::problem::Problem;
use crate::state::State;
use crate::state::memory::{ARGUMENTS, Arguments};
use crate::text::{Cursor, parentheses, semicolon, whole};

/// What an O word does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    Sub,
    EndSub,
    Return,
    Call,
    If,
    ElseIf,
    Else,
    EndIf,
    While,
    EndWhile,
    Do,
    Repeat,
    EndRepeat,
    Break,
    Continue,
    /// A bare `o100`: the beginning of a program that M98 calls.
    Program,
}

/// Longest first where one begins with another.
const KEYWORDS: [(&str, Keyword); 15] = [
    ("while", Keyword::While),
    ("endwhile", Keyword::EndWhile),
    ("if", Keyword::If),
    ("endif", Keyword::EndIf),
    ("elseif", Keyword::ElseIf),
    ("else", Keyword::Else),
    ("call", Keyword::Call),
    ("sub", Keyword::Sub),
    ("endsub", Keyword::EndSub),
    ("return", Keyword::Return),
    ("repeat", Keyword::Repeat),
    ("endrepeat", Keyword::EndRepeat),
    ("do", Keyword::Do),
    ("break", Keyword::Break),
    ("continue", Keyword::Continue),
];

impl Keyword {
    /// How it is written.
    pub(super) fn text(self) -> &'static str {
        KEYWORDS.iter().find(|(_, keyword)| *keyword == self).map_or("program", |(text, _)| text)
    }
}

/// An O word: its label and what it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Control {
    pub(super) label: Label,
    pub(super) keyword: Keyword,
}

/// Reads label and keyword, from the O on.
///
/// # Errors
/// One of them is missing.
pub(super) fn read(
    cursor: &mut Cursor,
    labels: &mut Labels,
    reader: &mut LineReader,
    state: &State,
) -> Result<Control, Box<Problem>> {
    let start = cursor.mark();
    cursor.skip();
    let label = if cursor.peek() == Some(b'<') {
        reader.values(state).read_name(start, cursor)?;
        labels.name(&reader.name)
    } else {
        let value = reader.values(state).value(cursor)?;
        let number = whole(value).and_then(|number| u32::try_from(number).ok());
        let Some(number) = number else {
            let help = "a label is a whole number or a name, as in o100 or o<drill>";
            return Err(cursor.error_from(
                start,
                "bad-label",
                "the label of the O word is not a whole number",
                help,
            ));
        };
        labels.number(number)
    };
    let keyword = match cursor.take_name(&KEYWORDS) {
        Some(keyword) => keyword,
        None if matches!(cursor.peek(), None | Some(b'(' | b';')) => Keyword::Program,
        None => {
            let message = "there is no O word with this keyword";
            let help = "sub endsub call return · if elseif else endif · while endwhile do repeat endrepeat · break continue";
            return Err(cursor.error_here("unknown-o-word", message, help));
        }
    };
    Ok(Control { label, keyword })
}

/// The condition or number of turns that stands after a keyword.
///
/// # Errors
/// It is missing or cannot be computed; something else stands after it.
pub(super) fn value(
    keyword: Keyword,
    cursor: &mut Cursor,
    reader: &mut LineReader,
    state: &State,
) -> Result<f64, Box<Problem>> {
    if cursor.peek() != Some(b'[') {
        let message = format!("{} needs an expression in brackets", keyword.text());
        let help = format!("write it after the keyword, as in {} [#1 LT 5]", keyword.text());
        return Err(cursor.error_here("missing-value", message, help));
    }
    reader.values(state).bracket(cursor)
}

/// The arguments of a call; those that are not given are 0.
///
/// # Errors
/// One of them cannot be computed, or there are too many.
pub(super) fn arguments(
    cursor: &mut Cursor,
    reader: &mut LineReader,
    state: &State,
) -> Result<Arguments, Box<Problem>> {
    let mut arguments = Arguments::NONE;
    loop {
        match cursor.peek() {
            Some(b'[') if arguments.given == ARGUMENTS => {
                let message = format!("a call has at most {ARGUMENTS} arguments");
                let help = "pass what goes beyond in global parameters such as #<_depth>";
                return Err(cursor.error_here("bad-value", message, help));
            }
            Some(b'[') => {
                arguments.push(reader.values(state).bracket(cursor)?);
            }
            Some(b'(') => comments(cursor, reader, true)?,
            _ => return Ok(arguments),
        }
    }
}

/// The end of the line, where only comments may stand; `one`: only the next of them.
///
/// # Errors
/// Something else stands there.
pub(super) fn comments(cursor: &mut Cursor, reader: &mut LineReader, one: bool) -> Result<(), Box<Problem>> {
    loop {
        match cursor.peek() {
            None => return Ok(()),
            Some(b';') => {
                semicolon(cursor)?;
            }
            Some(b'(') => {
                let (text, span) = parentheses(cursor)?;
                if speaks(text) {
                    let message = "this message is not shown: it stands in the line of an O word";
                    reader.warn_message_not_shown(message, span);
                }
                if one {
                    return Ok(());
                }
            }
            Some(_) => {
                let help = "put words in a line of their own; only comments may follow an O word";
                return Err(cursor.error_here("unused-word", "this stands after an O word", help));
            }
        }
    }
}
