//! Which line comes next: O words, M98 and M99.
//!
//! In: the O word of a line that is executed. Out: the place where the program goes on.
//!
//! | file | what it does |
//! |---|---|
//! | `labels.rs`, `control.rs` | reads O words; labels become numbers |
//! | `branches.rs` | if, while, do, repeat, break, continue |
//! | `calls.rs` | sub, call, return, M98, M99 |
//! | `skip.rs` | finds the end of what is not executed |
//! | `again.rs` | remembers the lines of loops and subroutines |
//!
//! What is open (an if, a loop) lies on one stack, what was called on another. After the first error nothing
//! is repeated any more: every line is still looked at once, and the program comes to its end.

mod again;
mod branches;
mod calls;
mod control;
mod labels;
mod skip;

use crate::execute::Output;
use crate::ngc::words::{LineReader, head};
use crate::problem::Problem;
use crate::state::State;
use crate::state::memory::Arguments;
use crate::text::{Cursor, Files, Line, Mark};
use again::Again;
use branches::Open;
use calls::Frame;
use control::{Control, Keyword};
use labels::{Label, Labels};
use skip::Jumps;

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
    arguments: Arguments,
    /// Loops go back: nothing was wrong so far.
    pub(crate) repeats: bool,
    /// A block with words was executed.
    pub(crate) begun: bool,
}

/// What O words act on.
pub(crate) struct Run<'a, 'b> {
    pub(crate) words: &'a mut LineReader,
    pub(crate) state: &'a mut State,
    pub(crate) out: &'a mut Output<'b>,
}

/// The label of an O word, and where its line begins.
#[derive(Clone, Copy)]
struct Here {
    label: Label,
    at: Mark,
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
            arguments: Arguments::NONE,
            repeats: true,
            begun: false,
        }
    }

    /// Executes the O word of the line that was read last.
    ///
    /// # Errors
    /// It stands where it cannot.
    pub(crate) fn control(&mut self, order: &Order, run: &mut Run) -> Done {
        let Order { control: Control { keyword, label }, at, value } = *order;
        let here = Here { label, at };
        let truth = value.is_some_and(|value| value != 0.0);
        match keyword {
            Keyword::If => self.begin_if(here, truth, run),
            Keyword::ElseIf => self.else_if(Keyword::ElseIf, here, truth, run),
            Keyword::Else => self.else_if(Keyword::Else, here, true, run),
            Keyword::EndIf => self.end_if(label),
            Keyword::While => self.condition(here, truth, run),
            Keyword::EndWhile => self.end_while(label),
            Keyword::Do => self.begin_do(here),
            Keyword::Repeat => self.begin_repeat(here, value.unwrap_or(0.0), run),
            Keyword::EndRepeat => self.end_repeat(label),
            Keyword::Break => self.leave_loop(here, run),
            Keyword::Continue => self.next_turn(here, run),
            Keyword::Sub => self.pass_over(here, run),
            Keyword::Call => {
                let arguments = self.arguments;
                self.call(label, &arguments, run)
            }
            Keyword::Return | Keyword::EndSub => self.end_sub(order.control, value, run),
            Keyword::Program => {
                self.warn_of_a_bare_label(label, run);
                Ok(())
            }
        }
    }

    /// Reads the O word of the line that was taken last.
    ///
    /// # Errors
    /// It is misspelled, or its values cannot be computed.
    pub(crate) fn read(
        &mut self,
        line: &Line,
        words: &mut LineReader,
        state: &State,
    ) -> Result<Order, Box<Problem>> {
        let mut cursor = Cursor::new(self.files.bytes(line));
        let head = head(&mut cursor)?;
        let control = control::read(&mut cursor, &mut self.labels, words, state)?;
        words.notes.forget_label();
        let mut order = Order { control, at: line.mark, value: None };
        if self.is_passed(control) {
            return Ok(order);
        }
        match control.keyword {
            Keyword::If | Keyword::ElseIf | Keyword::While | Keyword::Repeat => {
                match control::value(control.keyword, &mut cursor, words, state) {
                    Ok(value) => order.value = Some(value),
                    Err(problem) => {
                        self.assume(control, line.mark);
                        return Err(problem);
                    }
                }
            }
            Keyword::Return | Keyword::EndSub if cursor.peek() == Some(b'[') => {
                order.value = Some(words.values(state).bracket(&mut cursor)?);
            }
            Keyword::Call => self.arguments = control::arguments(&mut cursor, words, state)?,
            _ => {}
        }
        control::comments(&mut cursor, words, false)?;
        self.remember(line, head, Some(control), words);
        Ok(order)
    }

    /// Whether it is a branch that cannot be taken any more; its condition is not evaluated.
    fn is_passed(&self, control: Control) -> bool {
        control.keyword == Keyword::ElseIf && self.open().is_some_and(|open| open.is_taken(control.label))
    }

    /// How many subroutines have been called that have not returned.
    pub(crate) fn depth(&self) -> usize {
        self.frames.len()
    }

    /// Whether a loop is open.
    pub(crate) fn is_in_loop(&self) -> bool {
        self.opens.iter().any(Open::is_loop)
    }

    /// What was begun last in the subroutine that is executed.
    fn open(&self) -> Option<&Open> {
        let base = self.frames.last().map_or(0, |frame| frame.opens);
        self.opens.get(base..)?.last()
    }
}
