//! One line, or one value, without a program around it: for tools that look at lines, and for those who throw
//! bytes at the reader to see whether it stands.

use std::fmt;

use crate::block::{Block, CommentKind};
use crate::codes::{G, M};
use crate::options::{Dialect, Options};
use crate::problem::Problem;
use crate::state::State;
use crate::text::Cursor;
use crate::{fanuc, ngc};

/// What a line says. As text it is the line in one spelling.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// N, with the count of its digits.
    pub number: Option<(u32, u8)>,
    /// G codes.
    pub g: Vec<G>,
    /// M codes.
    pub m: Vec<M>,
    /// The other words, in the order of the alphabet.
    pub words: Vec<(char, f64)>,
    /// The last comment, without its parentheses.
    pub comment: Option<String>,
}

impl From<&Block> for Line {
    fn from(block: &Block) -> Line {
        let comment = block.comment.as_ref().map(|comment| {
            let verb = match comment.kind {
                CommentKind::Plain | CommentKind::Log => "",
                CommentKind::Message => "MSG,",
                CommentKind::Debug => "DEBUG,",
                CommentKind::Print => "PRINT,",
            };
            format!("{verb}{}", comment.text)
        });
        Line {
            number: block.n.map(|n| (n, block.n_digits)),
            g: block.g_codes().collect(),
            m: block.m_codes().collect(),
            words: block.letters().filter_map(|letter| Some((letter, block.get(letter)?))).collect(),
            comment,
        }
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((number, digits)) = self.number {
            write!(f, "N{number:0width$} ", width = usize::from(digits))?;
        }
        self.g.iter().try_for_each(|code| write!(f, "{code} "))?;
        self.m.iter().try_for_each(|code| write!(f, "{code} "))?;
        self.words.iter().try_for_each(|(letter, value)| match letter {
            'c' | 'r' => write!(f, ",{}{value} ", letter.to_ascii_uppercase()),
            _ => write!(f, "{letter}{value} "),
        })?;
        match &self.comment {
            Some(comment) => write!(f, "({comment})"),
            None => Ok(()),
        }
    }
}

/// Reads a line at the start of a program: N and words, their values computed. Nothing is executed. A line
/// that directs the flow (O words, IF, GOTO, ...) says nothing but its N.
///
/// # Errors
/// What is wrong with the line; [`crate::problem::Blame`] names the bytes.
pub fn line(text: &[u8], options: &Options) -> Result<Line, Box<Problem>> {
    let mut state = State::new(options);
    let block = match options.dialect {
        Dialect::Linuxcnc => ngc::line_alone(text, &mut state, options),
        Dialect::Fanuc | Dialect::FanucMill => fanuc::line_alone(text, &state, options),
    }?;
    Ok(Line::from(&block))
}

/// Computes a value at the start of a program: a number, a parameter, a function, an expression in brackets.
/// `None` is what the dialect `fanuc` calls vacant.
///
/// # Errors
/// It is not a value, cannot be computed, or something stands after it.
pub fn value(text: &[u8], options: &Options) -> Result<Option<f64>, Box<Problem>> {
    let state = State::new(options);
    let mut cursor = Cursor::new(text);
    let value = match options.dialect {
        Dialect::Linuxcnc => ngc::value_alone(&mut cursor, &state, options).map(Some),
        Dialect::Fanuc | Dialect::FanucMill => fanuc::value_alone(&mut cursor, &state, options),
    }?;
    match cursor.peek() {
        None => Ok(value),
        Some(_) => {
            let help = "a value is a number, a parameter or an expression in brackets";
            Err(cursor.error_here("bad-character", "this stands after the value", help))
        }
    }
}
