//! Which line comes next: O words, M98 and M99.
//!
//! In: the O word of a line that is executed. Out: the place where the program goes on.
//!
//! | file | what it does |
//! |---|---|
//! | `files.rs` | the program and its subroutine files |
//! | `labels.rs`, `control.rs` | reads O words; labels become numbers |
//! | `branches.rs` | if, while, do, repeat, break, continue |
//! | `calls.rs` | sub, call, return, M98, M99 |
//! | `skip.rs` | finds the end of what is not executed |
//! | `again.rs` | remembers the lines of loops and subroutines |
//!
//! What is open (an if, a loop) lies on one stack, what was called on another. After the first error nothing is
//! repeated any more: every line is still looked at once, and the program comes to its end.

mod again;
mod branches;
mod calls;
mod control;
mod files;
mod labels;
mod skip;

pub(crate) use files::Files;

use again::Again;
use branches::Open;
use calls::Frame;
use control::{Control, Keyword};
use labels::Labels;
use skip::Jumps;

use crate::execute::Output;
use crate::problem::Problem;
use crate::source::{Line, Mark};
use crate::state::State;
use crate::words::memory::ARGUMENTS;
use crate::words::{Cursor, Reader, head};

type Done = Result<(), Box<Problem>>;

/// Where a program is.
pub(crate) struct Flow {
    pub(crate) files: Files,
    labels: Labels,
    opens: Vec<Open>,
    frames: Vec<Frame>,
    jumps: Jumps,
    again: Again,
    /// How far each file was searched for subroutines.
    searched: Vec<Mark>,
    block_delete: bool,
    deepest: u32,
    /// Of the call that is being made.
    arguments: [f64; ARGUMENTS],
    /// Loops go back: nothing was wrong so far.
    pub(crate) repeats: bool,
}

/// An O word with its values.
pub(crate) struct Order {
    control: Control,
    /// Where its line begins.
    at: Mark,
    /// Condition, number of turns or value that is returned.
    value: Option<f64>,
}

impl Flow {
    /// At the beginning of a program. `deepest`: calls inside each other.
    pub(crate) fn new(files: Files, block_delete: bool, deepest: u32) -> Flow {
        Flow {
            files,
            labels: Labels::default(),
            opens: Vec::new(),
            frames: Vec::new(),
            jumps: Jumps::new(),
            again: Again::new(),
            searched: Vec::new(),
            block_delete,
            deepest,
            arguments: [0.0; ARGUMENTS],
            repeats: true,
        }
    }

    /// Executes the O word of the line that was read last.
    ///
    /// # Errors
    /// It stands where it cannot.
    pub(crate) fn control(
        &mut self,
        order: &Order,
        reader: &mut Reader,
        state: &mut State,
        out: &mut Output,
    ) -> Done {
        let Order { control, at, value } = *order;
        let label = control.label;
        let truth = value.is_some_and(|value| value != 0.0);
        match control.keyword {
            Keyword::If => self.begin_if(label, truth, at, reader, state),
            Keyword::ElseIf => self.else_if(Keyword::ElseIf, label, truth, at, reader, state),
            Keyword::Else => self.else_if(Keyword::Else, label, true, at, reader, state),
            Keyword::EndIf => self.end_if(label),
            Keyword::While => self.condition(label, truth, at, reader, state),
            Keyword::EndWhile => self.end_while(label),
            Keyword::Do => self.begin_do(label, at),
            Keyword::Repeat => self.begin_repeat(label, value.unwrap_or(0.0), at, reader, state),
            Keyword::EndRepeat => self.end_repeat(label),
            Keyword::Break => self.leave_loop(label, at, reader, state),
            Keyword::Continue => self.next_turn(label, at, reader, state),
            Keyword::Sub => self.pass_over(label, at, reader, state),
            Keyword::Call => {
                let arguments = self.arguments;
                self.call(label, &arguments, reader, state)
            }
            Keyword::Return | Keyword::EndSub => self.end_sub(control, value, state, out),
            Keyword::Program => Ok(()),
        }
    }

    /// Reads the O word of the line that was taken last.
    ///
    /// # Errors
    /// It is misspelled, or its values cannot be computed.
    pub(crate) fn read(
        &mut self,
        line: &Line,
        reader: &mut Reader,
        state: &State,
    ) -> Result<Order, Box<Problem>> {
        let mut cursor = Cursor::new(self.files.bytes(line));
        let head = head(&mut cursor)?;
        let control = control::read(&mut cursor, &mut self.labels, reader, state)?;
        reader.notes.forget_label();
        let mut order = Order { control, at: line.mark, value: None };
        if self.is_passed(control) {
            return Ok(order);
        }
        match control.keyword {
            Keyword::If | Keyword::ElseIf | Keyword::While | Keyword::Repeat => {
                match control::value(control.keyword, &mut cursor, reader, state) {
                    Ok(value) => order.value = Some(value),
                    Err(problem) => {
                        self.assume(control, line.mark);
                        return Err(problem);
                    }
                }
            }
            Keyword::Return | Keyword::EndSub if cursor.peek() == Some(b'[') => {
                order.value = Some(reader.values(state).bracket(&mut cursor)?);
            }
            Keyword::Call => self.arguments = control::arguments(&mut cursor, reader, state)?,
            _ => {}
        }
        control::comments(&mut cursor, reader, false)?;
        self.remember(line, head, Some(control), reader);
        Ok(order)
    }

    /// Whether it is a branch that cannot be taken any more; its condition is not evaluated.
    fn is_passed(&self, control: Control) -> bool {
        control.keyword == Keyword::ElseIf && self.open().is_some_and(|open| open.is_taken(control.label))
    }

    /// What was begun last in the subroutine that is executed.
    fn open(&self) -> Option<&Open> {
        let base = self.frames.last().map_or(0, |frame| frame.opens);
        self.opens.get(base..)?.last()
    }
}
