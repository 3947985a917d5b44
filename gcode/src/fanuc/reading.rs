//! One line of a program. In: its bytes, the variables, the state. Out: a [`Statement`]; the words of a block
//! are in a [`Line`].
//!
//! ```text
//! /  N10  words  (comment)                       a block
//! O1000   :1000                                  the beginning of a program
//! #100=[#101+2.5]*SIN[30]                        an assignment
//! IF [c] GOTO 20 · IF [c] THEN #1=2 · GOTO 20 · WHILE [c] DO 1 · DO 1 · END 1
//! ```

use super::expression::Values;
use super::labels::{self, loop_number, program_number, sequence_number};
use super::line::{Idle, Kind, Line, Statement};
use super::variables::Variables;
use super::{codes, mill, simulator, skip};
use crate::block::{Comment, CommentKind};
use crate::bounds::LAST_NUMBER;
use crate::canon::Units;
use crate::codes::{G, M, m_group};
use crate::execute::Done;
use crate::options::{MachineCode, Skips};
use crate::problem::{Blame, Problem, Span};
use crate::state::State;
use crate::text::{Cursor, Depth, parentheses, pointed_number, whole};

/// Reads a line.
pub(super) struct Reading<'a> {
    pub(super) text: &'a [u8],
    pub(super) variables: &'a mut Variables,
    pub(super) state: &'a State,
    /// Switches for `/` that are on.
    pub(super) skips: Skips,
    pub(super) deepest: u32,
}

#[derive(Clone, Copy)]
enum Keyword {
    If,
    While,
    Do,
    End,
    Goto,
}

const KEYWORDS: [(&str, Keyword); 5] = [
    ("if", Keyword::If),
    ("while", Keyword::While),
    ("do", Keyword::Do),
    ("end", Keyword::End),
    ("goto", Keyword::Goto),
];

impl Reading<'_> {
    /// Reads the line into `line`.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn statement(
        &mut self,
        file: u16,
        number: u32,
        line: &mut Line,
    ) -> Result<Statement, Box<Problem>> {
        line.clear(file, number, self.state.units.program());
        let mut cursor = Cursor::new(self.text);
        if labels::leader(number, &mut cursor) {
            let program = program_number(&mut cursor)?;
            if cursor.peek() != Some(b'(') {
                cursor.take_rest();
            }
            self.end(&mut cursor, line)?;
            return Ok(Statement::Program(program));
        }
        let mut optional = skip::is_left_out(self.skips, &mut cursor)?;
        if cursor.peek() == Some(b'n') {
            let (number, digits) = sequence_number(&mut cursor)?;
            (line.block.n, line.block.n_digits) = (Some(number), digits);
            optional |= skip::is_left_out(self.skips, &mut cursor)?;
        }
        if optional {
            return Ok(Statement::Nothing);
        }
        let statement = match cursor.take_name(&KEYWORDS) {
            Some(keyword) => self.keyword(keyword, &mut cursor)?,
            None => match cursor.peek() {
                Some(b'o' | b':') => Statement::Program(program_number(&mut cursor)?),
                Some(b'#') => self.assignments(&mut cursor)?,
                Some(b'[') => return Ok(Statement::Simulator(simulator::line(&mut cursor))),
                _ => return self.block(&mut cursor, line),
            },
        };
        self.end(&mut cursor, line)?;
        Ok(statement)
    }

    fn keyword(&mut self, keyword: Keyword, cursor: &mut Cursor) -> Result<Statement, Box<Problem>> {
        match keyword {
            Keyword::If => self.branch(cursor),
            Keyword::Goto => self.goto(cursor),
            Keyword::End => loop_number(cursor).map(Statement::End),
            Keyword::Do => Ok(Statement::While(loop_number(cursor)?, true)),
            Keyword::While => {
                let holds = self.condition(cursor)?;
                if cursor.take_name(&[("do", ())]).is_none() {
                    let help = "write WHILE [condition] DO 1, and END 1 after the last block of the loop";
                    return Err(cursor.error_here("bad-loop", "DO is missing here", help));
                }
                Ok(Statement::While(loop_number(cursor)?, holds))
            }
        }
    }

    fn branch(&mut self, cursor: &mut Cursor) -> Result<Statement, Box<Problem>> {
        let holds = self.condition(cursor)?;
        let statement = match cursor.take_name(&[("goto", Keyword::Goto), ("then", Keyword::If)]) {
            Some(Keyword::Goto) if holds => return self.goto(cursor),
            Some(_) if holds => return self.assignments(cursor),
            Some(_) => Statement::Nothing,
            None => {
                let help = "write IF [condition] GOTO 20, or IF [condition] THEN #1=2";
                return Err(cursor.error_here("bad-branch", "GOTO or THEN is missing here", help));
            }
        };
        // What is not executed is not evaluated; its comment may stay.
        cursor.take_rest();
        Ok(statement)
    }

    fn condition(&mut self, cursor: &mut Cursor) -> Result<bool, Box<Problem>> {
        Ok(self.values().bracket(cursor)?.is_some_and(|value| value != 0.0))
    }

    fn goto(&mut self, cursor: &mut Cursor) -> Result<Statement, Box<Problem>> {
        let start = cursor.mark();
        match self.values().value(cursor)?.and_then(whole) {
            Some(label) if (1..=i64::from(LAST_NUMBER)).contains(&label) => Ok(Statement::Goto(label as u32)),
            _ => {
                let help = format!("give the N of a block, 1 to {LAST_NUMBER}");
                Err(cursor.error_from(start, "bad-value", "GOTO needs the number of a block", help))
            }
        }
    }

    /// `#1=2 #[#1]=3`; #3000 and #3006 act.
    fn assignments(&mut self, cursor: &mut Cursor) -> Result<Statement, Box<Problem>> {
        let mut statement = Statement::Nothing;
        while cursor.peek() == Some(b'#') {
            let start = cursor.mark();
            cursor.skip();
            let index = self.values().index(start, cursor)?;
            let span = cursor.span(start);
            if !cursor.take_if(b'=') {
                let help = "a line may set a variable, as in #1=2.5; to use one, write a letter before it, as in X#1";
                return Err(cursor.error_here("missing-value", "= is missing here", help));
            }
            let value = self.values().expression(cursor)?;
            match index {
                3000 => statement = Statement::Alarm(value.unwrap_or(0.0)),
                3006 => statement = Statement::Message,
                _ => self.variables.set(index, value, self.state, Blame::Span(span))?,
            }
        }
        Ok(statement)
    }

    fn values(&self) -> Values<'_> {
        Values { variables: self.variables, state: self.state, depth: Depth::new(self.deepest) }
    }

    fn block(&mut self, cursor: &mut Cursor, line: &mut Line) -> Result<Statement, Box<Problem>> {
        let mut refused = None;
        let done = self.words(cursor, line, &mut refused);
        match refused {
            Some(problem) => Err(problem),
            None => done.map(|()| of_block(line)),
        }
    }

    /// The words of a block. The first code that is `refused` does not keep the others from being read: F of
    /// the block may be that of blocks after it.
    fn words(
        &mut self,
        cursor: &mut Cursor,
        line: &mut Line,
        refused: &mut Option<Box<Problem>>,
    ) -> Result<(), Box<Problem>> {
        let mut last = None;
        while let Some(first) = cursor.peek() {
            match first {
                b'n' if line.block.n.is_none() && !line.block.is_empty() => labels::behind(cursor, line)?,
                b'n' | b'o' => return Err(misplaced(cursor)),
                b'/' => skip::rest(self.skips, cursor)?,
                b'%' if skip::is_end_of_tape(&line.block, cursor) => return Ok(()),
                b'a'..=b'z' if line.arguments.is_some() && !matches!(first, b'g' | b'p' | b'l') => {
                    last = self.argument(first, last, cursor, line)?;
                }
                b'g' | b'm' => {
                    let code =
                        if first == b'g' { self.g_code(cursor, line) } else { self.m_code(cursor, line) };
                    if let Err(problem) = code {
                        refused.get_or_insert(problem);
                    }
                }
                b'a'..=b'z' | b',' => {
                    let at = cursor.mark();
                    match self.word(first, cursor, line) {
                        Err(problem) if problem.code == "repeated-word" && cursor.mark() > at => {
                            refused.get_or_insert(problem);
                        }
                        done => done?,
                    }
                }
                b'(' => comment(cursor, line)?,
                b';' => return self.end(cursor, line),
                _ => return Err(bad_character(cursor)),
            }
        }
        Ok(())
    }

    /// The end of a line: comments, `;`.
    fn end(&mut self, cursor: &mut Cursor, line: &mut Line) -> Done {
        while cursor.peek() == Some(b'(') {
            comment(cursor, line)?;
        }
        let ended = cursor.take_if(b';');
        match cursor.peek() {
            None => Ok(()),
            Some(_) if ended => skip::behind_end(cursor, line),
            Some(_) => {
                let help = "only a comment may follow on this line: write words in a block of their own";
                Err(cursor.error_here("unused-word", "nothing uses this", help))
            }
        }
    }

    /// A letter and its value; `,C` and `,R` are `c` and `r`.
    fn word(&mut self, first: u8, cursor: &mut Cursor, line: &mut Line) -> Done {
        let start = cursor.mark();
        cursor.skip();
        let letter = match first {
            b',' => match cursor.take() {
                Some(letter @ (b'c' | b'r')) => char::from(letter),
                Some(b'a') => 'A',
                _ => {
                    let help = ",C cuts the corner after a move, ,R rounds it, ,A is the angle of a line";
                    let message = "only A, C and R may follow a comma";
                    return Err(cursor.error_from(start, "not-available", message, help));
                }
            },
            letter => char::from(letter.to_ascii_uppercase()),
        };
        let Some(written) = self.written(cursor)? else { return Ok(()) };
        line.add(letter, written, cursor.span(start))
    }

    /// A value and how it is written; `None` if it is vacant.
    fn written(&mut self, cursor: &mut Cursor) -> Result<Option<(f64, Kind)>, Box<Problem>> {
        let before = cursor.clone();
        let negative = cursor.take_if(b'-');
        if !negative {
            cursor.take_if(b'+');
        }
        if !matches!(cursor.peek(), Some(b'0'..=b'9' | b'.')) {
            *cursor = before;
            return Ok(self.values().value(cursor)?.map(|value| (value, Kind::Computed)));
        }
        let (value, pointed) = pointed_number(cursor)?;
        let kind = if pointed { Kind::Pointed } else { Kind::Bare };
        Ok(Some((if negative { -value } else { value }, kind)))
    }

    fn g_code(&mut self, cursor: &mut Cursor, line: &mut Line) -> Done {
        let (value, span) = self.code(cursor)?;
        let code = whole(10.0 * value).and_then(|code| u16::try_from(code).ok()).map(G);
        let Some(code) = code else { return Err(codes::unknown(value, span, codes::SYSTEM_A)) };
        let Some(code) = line.of_system_a(code, self.text, span)? else { return Ok(()) };
        if let Some((why, words)) = codes::does_nothing(code, line.mill) {
            let message = format!("{code} does nothing here: {why}");
            line.idle = Some(Idle { span, message, words });
            return Ok(());
        }
        let group = match line.mill {
            true => mill::codes::g_group(code, span)?,
            false => Some(codes::g_group(code, span)?),
        };
        let Some(group) = group else { return Ok(()) };
        line.block.add_g(group, code, span)?;
        match code {
            G(200) => line.units = Some(Units::Inch),
            G(210) => line.units = Some(Units::Millimetre),
            G(650 | 660) => line.arguments = Some(Box::new([None; 34])),
            _ => {}
        }
        Ok(())
    }

    fn m_code(&mut self, cursor: &mut Cursor, line: &mut Line) -> Done {
        let (value, span) = self.code(cursor)?;
        let known = (value.fract() == 0.0 && (0.0..65_536.0).contains(&value)).then_some(M(value as u16));
        let group = |code: M| match code {
            M(19) if line.mill => Some(m_group::SPINDLE),
            code => codes::m_group(code),
        };
        match known.and_then(|code| Some((group(code)?, code))) {
            Some((group, code)) => line.block.add_m(group, code, span),
            None => match (self.state.machine_code(value, span), known) {
                (Ok(MachineCode::Ignore), _) => Ok(()),
                (Ok(MachineCode::Wait), _) => line.block.add_m(m_group::STOP, M(0), span),
                (Ok(MachineCode::Output { .. } | MachineCode::Input { .. }), _) => {
                    line.block.add_m(m_group::MACHINE, M(value as u16), span)
                }
                (Err(_), Some(gear)) if codes::GEARS.contains(&gear.0) => {
                    let message = format!("{gear} chooses a gear, and the spindle of this machine has one");
                    line.idle = Some(Idle { span, message, words: 0 });
                    Ok(())
                }
                (Err(_), Some(M(29))) => {
                    line.rigid = true;
                    Ok(())
                }
                (Err(problem), _) => Err(problem),
            },
        }
    }

    /// The number of a G or M code.
    fn code(&mut self, cursor: &mut Cursor) -> Result<(f64, Span), Box<Problem>> {
        let start = cursor.mark();
        cursor.skip();
        match self.written(cursor)? {
            Some((value, _)) => Ok((value, cursor.span(start))),
            None => {
                let help = "set the variable first, or write the number of the code";
                Err(cursor.error_from(start, "bad-value", "the number of this code is vacant", help))
            }
        }
    }

    /// A letter of G65: argument assignment I (each letter is a variable) or II (I J K again and again).
    /// `last` is the variable that I, J or K set before.
    fn argument(
        &mut self,
        letter: u8,
        last: Option<usize>,
        cursor: &mut Cursor,
        line: &mut Line,
    ) -> Result<Option<usize>, Box<Problem>> {
        let start = cursor.mark();
        cursor.skip();
        let written = self.written(cursor)?;
        let (index, last) = match letter {
            b'i'..=b'k' => {
                let mut index = 4 + usize::from(letter - b'i');
                while last.is_some_and(|last| index <= last) {
                    index += 3;
                }
                (index, Some(index))
            }
            _ => (codes::argument(letter), last),
        };
        let steps = match letter {
            b'd' | b'e' | b'f' | b'h' | b'm' | b's' | b't' => 1.0,
            _ => line.argument_steps(),
        };
        let Some(slot) = line.arguments.as_mut().and_then(|locals| locals.get_mut(index)) else {
            let help = "I, J and K may stand ten times each in G65";
            return Err(cursor.error_from(start, "repeated-word", "too many arguments", help));
        };
        *slot = written.map(|(value, kind)| if kind == Kind::Bare { value / steps } else { value });
        Ok(last)
    }
}

fn comment(cursor: &mut Cursor, line: &mut Line) -> Done {
    let (text, _) = parentheses(cursor)?;
    line.block.comment = Some(Comment { kind: CommentKind::Plain, text: text.into() });
    Ok(())
}

/// A remark alone does nothing: O of the program may follow it.
fn of_block(line: &Line) -> Statement {
    let empty = !line.block.has_words() && line.arguments.is_none() && line.idle.is_none();
    if empty { Statement::Nothing } else { Statement::Block }
}

fn misplaced(cursor: &mut Cursor) -> Box<Problem> {
    let help = "N and O come first in their line; in a number write the digit 0";
    cursor.error_here("misplaced-line-number", "this cannot stand inside a block", help)
}

fn bad_character(cursor: &mut Cursor) -> Box<Problem> {
    let what = cursor.character().map_or("this byte".into(), |c| format!("{c:?}"));
    let help = match cursor.character() {
        Some(',') => "a number has a decimal point: X20.5",
        _ => "a block is made of words such as G01 or X-2.5; put remarks in parentheses",
    };
    cursor.error_here("bad-character", format!("{what} cannot begin a word"), help)
}
