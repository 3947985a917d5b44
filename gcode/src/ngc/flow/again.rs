//! Lines of loops and subroutines, which are read again and again. In: a line that was read, with the
//! operations that the reader noted. Out: what it holds, without its text.

use super::control::{Control, Keyword};
use super::{Flow, Order};
use crate::block::Block;
use crate::ngc::words::{Head, LineReader, Operation};
use crate::problem::Problem;
use crate::state::State;
use crate::state::memory::Arguments;
use crate::text::{Line, Mark};

/// Lines that are remembered at once. Each has the slot of its number, so that a loop of so many lines fits.
const LINES: usize = 2048;

/// A line that was read.
#[derive(Clone, Default)]
struct Known {
    file: usize,
    line: Mark,
    /// Where the line after it begins.
    next: Mark,
    head: Head,
    control: Option<Control>,
    operations: Vec<Operation>,
}

/// The lines that were read last in loops and subroutines.
pub(super) struct Again(Vec<Option<Known>>);

impl Again {
    pub(super) fn new() -> Again {
        Again(vec![None; LINES])
    }
}

impl Flow {
    /// Whether the next line is in a loop or a subroutine, so that it is worth remembering.
    #[inline]
    pub(crate) fn is_repeating(&self) -> bool {
        !self.opens.is_empty() || !self.frames.is_empty()
    }

    /// Remembers the line of words that was just read, if all of it was noted.
    pub(crate) fn remember_words(&mut self, line: &Line, head: Head, words: &mut LineReader) {
        self.remember(line, head, None, words);
    }

    /// The same of a line with an O word.
    pub(super) fn remember(
        &mut self,
        line: &Line,
        head: Head,
        control: Option<Control>,
        words: &mut LineReader,
    ) {
        let Some(operations) = words.notes.take() else { return };
        let (file, next) = (self.files.current(), self.files.mark());
        let Some(slot) = self.again.0.get_mut(line.mark.lines as usize % LINES) else { return };
        let known = slot.get_or_insert_default();
        (known.file, known.line, known.next) = (file, line.mark, next);
        (known.head, known.control) = (head, control);
        known.operations.clear();
        known.operations.extend_from_slice(operations);
    }

    /// Does what reading the next line does, if it is known: fills the block, sets parameters, goes on after
    /// it. The answer is its O word. `None`: it has to be read.
    ///
    /// # Errors
    /// The file cannot be gone through.
    pub(crate) fn read_again(
        &mut self,
        words: &mut LineReader,
        state: &mut State,
        block: &mut Block,
    ) -> Option<Result<Option<Order>, Box<Problem>>> {
        let (file, line) = (self.files.current(), self.files.mark());
        let known = self.again.0.get(line.lines as usize % LINES)?.as_ref()?;
        if (known.file, known.line) != (file, line) {
            return None;
        }
        block.begin(file as u16, line.lines + 1, known.head.number);
        state.progress.line = block.line;
        let order = match known.control {
            Some(control) if self.is_passed(control) => Some(Order { control, at: line, value: None }),
            control => {
                words.replay(&known.operations, state, block)?;
                control.map(|control| Order { control, at: line, value: words.stack.last().copied() })
            }
        };
        let next = known.next;
        if known.control.is_some_and(|control| control.keyword == Keyword::Call) {
            self.arguments = Arguments::NONE;
            for value in &words.stack {
                self.arguments.push(*value);
            }
        }
        Some(self.files.go(file, next).map(|()| order))
    }
}
