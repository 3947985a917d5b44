//! What lines are found by: N of a block, O of a program, the number of a loop. In: the beginning of a line.
//! Out: the numbers.

use super::line::{Idle, Line};
use crate::bounds::LAST_NUMBER;
use crate::problem::Problem;
use crate::text::{Cursor, number};

/// What a line is looked for by.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Wanted {
    /// N.
    Label(u32),
    /// END.
    End(u8),
    /// O.
    Program(u32),
}

/// What a line can be found by.
#[derive(Default)]
pub(super) struct Heading {
    label: Option<u32>,
    pub(super) program: Option<u32>,
    end: Option<u8>,
}

impl Heading {
    pub(super) fn of(text: &[u8]) -> Heading {
        let mut cursor = Cursor::new(text);
        let mut heading = Heading::default();
        if cursor.take_if(b'/') && matches!(cursor.peek(), Some(b'1'..=b'9')) {
            cursor.skip();
        }
        if cursor.take_if(b'n') {
            heading.label = number(&mut cursor).ok().map(|label| label as u32);
        }
        if matches!(cursor.peek(), Some(b'o' | b':')) {
            cursor.skip();
            heading.program = number(&mut cursor).ok().map(|program| program as u32);
        } else if cursor.take_name(&[("end", ())]).is_some() {
            heading.end = cursor.peek().filter(u8::is_ascii_digit).map(|digit| digit - b'0');
        }
        heading
    }

    pub(super) fn is(&self, wanted: Wanted) -> bool {
        match wanted {
            Wanted::Label(label) => self.label == Some(label),
            Wanted::Program(program) => self.program == Some(program),
            Wanted::End(number) => self.end == Some(number),
        }
    }
}

/// `%O1200 SHAFT`: some controls write the sign that begins a tape in front of the number of the program,
/// and a name behind it. Whether it is there; the cursor is at O then.
pub(super) fn leader(line: u32, cursor: &mut Cursor) -> bool {
    let mut ahead = cursor.clone();
    let is_there = line == 1 && ahead.take_if(b'%') && matches!(ahead.peek(), Some(b'o' | b':'));
    if is_there {
        cursor.skip();
    }
    is_there
}

/// N and its digits; the cursor is at N.
pub(super) fn sequence_number(cursor: &mut Cursor) -> Result<(u32, u8), Box<Problem>> {
    let start = cursor.mark();
    cursor.skip();
    let digits = cursor.digits_here();
    let value = if matches!(cursor.peek(), Some(b'0'..=b'9')) { number(cursor)? } else { -1.0 };
    if value.fract() != 0.0 || !(0.0..=f64::from(LAST_NUMBER)).contains(&value) {
        let help = "a sequence number has up to eight digits, or is left out";
        return Err(cursor.error_from(start, "bad-line-number", "N without a usable number", help));
    }
    Ok((value as u32, digits))
}

/// N behind other words, where a line break was lost: it numbers the block, and no GOTO finds it.
pub(super) fn behind(cursor: &mut Cursor, line: &mut Line) -> Result<(), Box<Problem>> {
    let start = cursor.mark();
    let (number, digits) = sequence_number(cursor)?;
    (line.block.n, line.block.n_digits) = (Some(number), digits);
    let message = format!("N{number} stands behind other words: nothing finds this block by its number");
    line.idle = Some(Idle { span: cursor.span(start), message, words: 0 });
    Ok(())
}

pub(super) fn program_number(cursor: &mut Cursor) -> Result<u32, Box<Problem>> {
    let start = cursor.mark();
    cursor.skip();
    let value = if matches!(cursor.peek(), Some(b'0'..=b'9')) { number(cursor)? } else { -1.0 };
    if value.fract() != 0.0 || !(0.0..=f64::from(LAST_NUMBER)).contains(&value) {
        let help = format!("a program number is 0 to {LAST_NUMBER}, as in O1000");
        return Err(cursor.error_from(start, "bad-label", "O without a usable number", help));
    }
    Ok(value as u32)
}

pub(super) fn loop_number(cursor: &mut Cursor) -> Result<u8, Box<Problem>> {
    match cursor.peek() {
        Some(digit @ b'1'..=b'3') => {
            cursor.skip();
            Ok(digit - b'0')
        }
        _ => {
            let help = "loops are numbered 1, 2 and 3, as in DO 1 ... END 1";
            Err(cursor.error_here("bad-loop", "the number of the loop is missing here", help))
        }
    }
}
