//! One line as words. In: its bytes, the state. Out: a [`Block`], and the parameters that the line sets: they
//! take effect when all of it has been read, before the block is executed.

use super::comment::{comment, speaks};
use super::expression::Values;
use super::notes::{Notes, Operation, replay};
use super::told;
use crate::block::Block;
use crate::bounds::LAST_NUMBER;
use crate::codes::{G, M, g_group, m_group};
use crate::options::MachineCode;
use crate::problem::{Blame, Problem, Span, short};
use crate::state::State;
use crate::state::memory::Name;
use crate::text::job::is_nearly;
use crate::text::{Cursor, Depth, number, parentheses, semicolon, whole};

type Done = Result<(), Box<Problem>>;

/// What stands on the left of `=`.
pub(super) enum Target {
    Number(u32),
    Name(Name),
}

/// A parameter and its new value.
pub(super) type Assignment = (Target, f64);

/// Fills blocks. What it needs on the way is kept, so that a line allocates nothing.
pub(crate) struct LineReader {
    /// Brackets, signs and `#` that may stand inside each other.
    deepest: u32,
    /// The name of a parameter that is being read.
    pub(crate) name: String,
    assignments: Vec<Assignment>,
    /// Notes what is done.
    pub(crate) notes: Notes,
    /// Values that are left when a line is done again.
    pub(crate) stack: Vec<f64>,
    /// Notes on the line read last.
    pub(crate) warnings: Vec<Problem>,
}

impl LineReader {
    /// A reader for values of at most `deepest` brackets, signs and `#` inside each other.
    pub(crate) fn new(deepest: u32) -> LineReader {
        LineReader {
            deepest,
            name: String::new(),
            assignments: Vec::new(),
            notes: Notes::default(),
            stack: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Reads values with the parameters of a state.
    #[inline]
    pub(crate) fn values<'a>(&'a mut self, state: &'a State) -> Values<'a> {
        Values { state, depth: Depth::new(self.deepest), name: &mut self.name, notes: &mut self.notes }
    }

    /// Reads the words of a line from the cursor to its end, and sets the parameters that it sets.
    ///
    /// # Errors
    /// The first thing that is wrong. No parameter is set then.
    pub(crate) fn words(&mut self, cursor: &mut Cursor, state: &mut State, block: &mut Block) -> Done {
        self.assignments.clear();
        let mut last = None;
        // The first word that is refused does not keep the others from being read.
        let mut refused = None;
        while let Some(first) = cursor.peek() {
            match first {
                b'g' => {
                    let (value, span) = self.word(cursor, state)?;
                    keep_first(add_g(value, span, block), &mut refused);
                    self.notes.note(Operation::G(span));
                }
                b'm' => {
                    let (value, span) = self.word(cursor, state)?;
                    keep_first(add_m(value, span, state, block), &mut refused);
                    self.notes.note(Operation::M(span));
                }
                b'n' | b'o' => return Err(misplaced(first, cursor)),
                b'$' if is_of_a_sender(cursor) => return Err(of_a_sender(cursor)),
                b'a'..=b'z' | b'@' | b'^' | b'$' => {
                    let (value, span) = self.word(cursor, state)?;
                    let letter = first.to_ascii_uppercase();
                    keep_first(block.add(char::from(letter), value, span), &mut refused);
                    self.notes.note(Operation::Word(letter, span));
                }
                b'(' => {
                    self.notes.spoil();
                    let hidden = last.replace(parentheses(cursor)?);
                    self.warn_if_speaking(hidden);
                }
                b';' => self.warn_if_nearly_job(semicolon(cursor)?),
                b'#' => self.assignment(cursor, state)?,
                _ => return Err(bad_character(cursor)),
            }
        }
        self.assign(state);
        if let Some((text, span)) = last {
            block.comment = comment(text, span, state)?;
        }
        refused.map_or(Ok(()), Err)
    }

    /// Takes a letter and the value after it.
    #[inline]
    fn word(&mut self, cursor: &mut Cursor, state: &State) -> Result<(f64, Span), Box<Problem>> {
        let start = cursor.mark();
        cursor.skip();
        let value = self.values(state).value(cursor)?;
        Ok((value, cursor.span(start)))
    }

    /// Does a line again. `None`: it has to be read; nothing happened but to the block.
    pub(crate) fn replay(
        &mut self,
        operations: &[Operation],
        state: &mut State,
        block: &mut Block,
    ) -> Option<()> {
        self.stack.clear();
        self.assignments.clear();
        replay(operations, state, block, &mut self.stack, &mut self.assignments)?;
        self.assign(state);
        Some(())
    }

    /// `#1=..` and `#<name>=..`.
    fn assignment(&mut self, cursor: &mut Cursor, state: &mut State) -> Done {
        let start = cursor.mark();
        cursor.skip();
        let mut values = self.values(state);
        let target = if cursor.peek() == Some(b'<') {
            values.read_name(start, cursor)?;
            writable_name(values.name, cursor.span(start), state)?;
            Target::Name(state.memory.note(&self.name))
        } else {
            let index = values.index(start, cursor)?;
            if told::is_read_only(index, state) {
                return Err(read_only(&format!("#{index}"), cursor.span(start)));
            }
            Target::Number(index)
        };
        if !cursor.take_if(b'=') {
            let help =
                "a line may set a parameter, as in #1=2.5; to use one, write a letter before it, as in X#1";
            return Err(cursor.error_here("missing-value", "= is missing here", help));
        }
        let value = self.values(state).value(cursor)?;
        self.notes.note(match target {
            Target::Number(_) => Operation::SetNumbered,
            Target::Name(name) => Operation::SetNamed(name),
        });
        self.assignments.push((target, value));
        Ok(())
    }

    /// Sets the parameters that the line sets.
    fn assign(&mut self, state: &mut State) {
        for (target, value) in &self.assignments {
            match target {
                Target::Number(index) => state.memory.set_numbered(*index, *value),
                Target::Name(name) => state.memory.set_at(*name, *value),
            }
        }
    }

    fn warn_if_speaking(&mut self, hidden: Option<(&str, Span)>) {
        if let Some((_, span)) = hidden.filter(|(text, _)| speaks(text)) {
            let message = "this message is not shown: only the last comment of a line counts";
            self.warn_message_not_shown(message, span);
        }
    }

    fn warn_if_nearly_job(&mut self, (text, span): (&str, Span)) {
        if is_nearly(text) {
            let message = "this is a comment, not a line of a job";
            let help = "a line of a job begins with ;@ and has nothing else before it";
            self.warnings.push(*Problem::warning("job", Blame::Span(span), message, help));
        }
    }

    /// Notes a comment whose message is not shown.
    #[cold]
    pub(crate) fn warn_message_not_shown(&mut self, message: &str, span: Span) {
        let help = "put it in a line of its own";
        self.warnings.push(*Problem::warning("message-not-shown", Blame::Span(span), message, help));
    }
}

/// What comes before the words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Head {
    /// `/`: the line is left out if optional lines are.
    pub(crate) optional: bool,
    /// N with the number of its digits, see [`crate::Place`].
    pub(crate) number: Option<(u32, u8)>,
}

/// Reads what comes before the words.
///
/// # Errors
/// N has no usable number.
#[inline]
pub(crate) fn head(cursor: &mut Cursor) -> Result<Head, Box<Problem>> {
    let optional = cursor.take_if(b'/');
    let number = if cursor.peek() == Some(b'n') { Some(line_number(cursor)?) } else { None };
    Ok(Head { optional, number })
}

fn line_number(cursor: &mut Cursor) -> Result<(u32, u8), Box<Problem>> {
    let start = cursor.mark();
    cursor.skip();
    let (text, digits) = (cursor.rest(), cursor.digits_here());
    let value = match cursor.peek() {
        Some(b'0'..=b'9' | b'.') => number(cursor)?,
        _ => -1.0,
    };
    if (0.0..=f64::from(LAST_NUMBER)).contains(&value) {
        // Of `N1 016` LinuxCNC shows what stands before the blank.
        let shown = text.iter().take(usize::from(digits));
        let n = shown.fold(0, |n: u32, digit| n.wrapping_mul(10).wrapping_add(u32::from(digit - b'0')));
        return Ok((n, digits));
    }
    let help = format!("a line number is a number from 0 to {LAST_NUMBER}, or left out");
    Err(cursor.error_from(start, "bad-line-number", "N without a usable number", help))
}

/// Notes the first of several problems.
#[inline]
fn keep_first(done: Done, first: &mut Option<Box<Problem>>) {
    if let Err(problem) = done {
        first.get_or_insert(problem);
    }
}

pub(super) fn add_g(value: f64, span: Span, block: &mut Block) -> Done {
    let code = whole(10.0 * value).and_then(|code| u16::try_from(code).ok()).map(G);
    match code.and_then(|code| Some((g_group(code)?, code))) {
        Some((group, code)) => block.add_g(group, code, span),
        None => Err(unknown_g_code(value, span)),
    }
}

/// M99 returns to the caller; in no call it is M2 (as in LinuxCNC without its endless programs).
pub(super) fn add_m(value: f64, span: Span, state: &State, block: &mut Block) -> Done {
    let called = state.progress.call_level > 0;
    let code = whole(value).and_then(|code| u16::try_from(code).ok()).map(M);
    let code = code.map(|code| if code == M(99) && !called { M(2) } else { code });
    match code.and_then(|code| Some((m_group(code)?, code))) {
        Some((group, code)) => block.add_m(group, code, span),
        None => match state.machine_code(value, span)? {
            MachineCode::Ignore => Ok(()),
            MachineCode::Wait => block.add_m(m_group::STOP, M(0), span),
            MachineCode::Output { .. } | MachineCode::Input { .. } => {
                block.add_m(m_group::MACHINE, M(value as u16), span)
            }
        },
    }
}

#[cold]
fn unknown_g_code(value: f64, span: Span) -> Box<Problem> {
    let message = format!("there is no code G{}", short(value));
    // Threads of FANUC that LinuxCNC does not have.
    let help = match value {
        34.0 => {
            "LinuxCNC has none: write a lead that grows as a chain of short G33, or the program for FANUC"
        }
        _ => "check the number; the G codes are listed in the manual",
    };
    Problem::error("unknown-g-code", Blame::Span(span), message, help)
}

/// Refuses names that tell the state, or what a subroutine returned.
fn writable_name(name: &str, span: Span, state: &State) -> Done {
    let told = match name {
        "_value" | "_value_returned" => true,
        _ => {
            name.starts_with("_ini[")
                || name.starts_with('_')
                    && state.memory.named(name).is_none()
                    && told::named(name, state).is_some()
        }
    };
    if told { Err(read_only(&format!("#<{name}>"), span)) } else { Ok(()) }
}

#[cold]
fn read_only(name: &str, span: Span) -> Box<Problem> {
    let message = format!("{name} tells the state of the control and cannot be set");
    Problem::error("bad-parameter", Blame::Span(span), message, "use another parameter")
}

#[cold]
fn misplaced(letter: u8, cursor: &mut Cursor) -> Box<Problem> {
    if letter == b'n' {
        let help = "a line number comes first in its line";
        return cursor.error_here("misplaced-line-number", "N inside a line", help);
    }
    let help = "an O word comes first in its line; only N may stand before it; in a number write the digit 0";
    cursor.error_here("misplaced-o-word", "O inside a line", help)
}

/// `$H`, `$10=1`, `$J=..`: what Grbl is told beside programs. `$0` picks a spindle.
fn is_of_a_sender(cursor: &Cursor) -> bool {
    let mut ahead = cursor.clone();
    ahead.skip();
    match ahead.peek() {
        None | Some(b'$') => true,
        Some(first @ (b'a'..=b'z' | b'0'..=b'9')) => {
            let is_name = first.is_ascii_alphabetic();
            let belongs =
                |byte: u8| if is_name { byte.is_ascii_alphanumeric() } else { byte.is_ascii_digit() };
            while ahead.peek().is_some_and(belongs) {
                ahead.skip();
            }
            ahead.peek() == Some(b'=') || is_name && ahead.peek().is_none()
        }
        _ => false,
    }
}

#[cold]
fn of_a_sender(cursor: &mut Cursor) -> Box<Problem> {
    let help = "leave the line out; $0 here means the spindle of S, M3 and G96";
    cursor.error_here("bad-character", "$ begins a command to Grbl, which is no part of a program", help)
}

#[cold]
fn bad_character(cursor: &mut Cursor) -> Box<Problem> {
    let Some(c) = cursor.character() else {
        let help = "save the program as UTF-8 (or plain ASCII) text";
        return cursor.error_here("bad-character", "this byte is not UTF-8", help);
    };
    let help = match c {
        '%' => "a % stands alone on the first and the last line of a program",
        '/' => "a / that marks an optional line comes first in it",
        ')' => "a comment begins with (",
        ',' => "a number has a decimal point: X20.5",
        '\u{feff}' => "save the file without a byte order mark",
        _ => "a block is made of words such as G1 or X-2.5; put remarks in parentheses or after ;",
    };
    cursor.error_here("bad-character", format!("{c:?} cannot begin a word"), help)
}
