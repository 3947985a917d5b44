//! Lines that are not executed. In: a label and what to look for. Out: the line that has it; what lies
//! between is not evaluated. Where a search ended is remembered, so that a loop searches once.

use super::control::{self, Control, Keyword};
use super::labels::{Definition, Label, Style};
use super::{Flow, Here, Run};
use crate::ngc::words::head;
use crate::problem::{Blame, Problem};
use crate::text::{Cursor, Line, Mark};

/// What is looked for, all of one label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Goal {
    /// The next elseif, else or endif.
    Branch,
    EndIf,
    EndWhile,
    /// The while at the end of a do.
    DoWhile,
    EndRepeat,
    EndSub,
}

impl Goal {
    fn is(self, keyword: Keyword) -> bool {
        match self {
            Goal::Branch => matches!(keyword, Keyword::ElseIf | Keyword::Else | Keyword::EndIf),
            Goal::EndIf => keyword == Keyword::EndIf,
            Goal::EndWhile => keyword == Keyword::EndWhile,
            Goal::DoWhile => keyword == Keyword::While,
            Goal::EndRepeat => keyword == Keyword::EndRepeat,
            Goal::EndSub => keyword == Keyword::EndSub,
        }
    }

    fn text(self) -> &'static str {
        match self {
            Goal::Branch | Goal::EndIf => "endif",
            Goal::EndWhile => "endwhile",
            Goal::DoWhile => "while",
            Goal::EndRepeat => "endrepeat",
            Goal::EndSub => "endsub",
        }
    }
}

/// A line that was found: where it begins, and the line after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Found {
    pub(super) line: Mark,
    pub(super) next: Mark,
}

/// A search that was done before.
#[derive(Clone, Copy)]
struct Jump {
    file: usize,
    from: u64,
    label: Label,
    goal: Goal,
    found: Found,
}

/// The last searches; one that has the slot of another replaces it.
pub(super) struct Jumps(Vec<Option<Jump>>);

impl Jumps {
    pub(super) fn new() -> Jumps {
        Jumps(vec![None; 1024])
    }

    fn slot(&mut self, from: u64) -> Option<&mut Option<Jump>> {
        let index = from as usize % self.0.len();
        self.0.get_mut(index)
    }
}

impl Flow {
    /// Looks for `goal` of a label after the line that it stands in, which was just taken. The next line
    /// stays the next line.
    ///
    /// # Errors
    /// The file ends before.
    pub(super) fn find(&mut self, here: Here, goal: Goal, run: &mut Run) -> Result<Found, Box<Problem>> {
        let (label, from) = (here.label, here.at);
        let file = self.files.current();
        if let Some(Some(jump)) = self.jumps.slot(from.offset)
            && (jump.file, jump.from, jump.label, jump.goal) == (file, from.offset, label, goal)
        {
            return Ok(jump.found);
        }
        let next = self.files.mark();
        let found = self.search(label, goal, run);
        self.files.go(file, next)?;
        let found = found?;
        if let Some(slot) = self.jumps.slot(from.offset) {
            *slot = Some(Jump { file, from: from.offset, label, goal, found });
        }
        Ok(found)
    }

    fn search(&mut self, label: Label, goal: Goal, run: &mut Run) -> Result<Found, Box<Problem>> {
        while let Some(line) = self.files.take()? {
            match self.control_of(&line, run) {
                Some(control) if control.label == label && goal.is(control.keyword) => {
                    return Ok(Found { line: line.mark, next: self.files.mark() });
                }
                _ => {}
            }
        }
        let label = self.labels.text(label);
        let message = format!("the {} of {label} is missing", goal.text());
        let help = format!("add {label} {} where it ends", goal.text());
        Err(Problem::error("missing-end", Blame::Block, message, help))
    }

    /// Notes the subroutines that are defined in the rest of the current file, so far as it was not searched
    /// before, or those up to `last`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(super) fn search_definitions(
        &mut self,
        last: Option<Label>,
        run: &mut Run,
    ) -> Result<(), Box<Problem>> {
        let (file, back) = (self.files.current(), self.files.mark());
        if self.searched.len() <= file {
            self.searched.resize(file + 1, Mark::default());
        }
        if let Some(searched) = self.searched.get(file).filter(|searched| searched.offset > back.offset) {
            self.files.go(file, *searched)?;
        }
        while let Some(line) = self.files.take()? {
            let control = self.control_of(&line, run);
            let style = match control.map(|control| control.keyword) {
                Some(Keyword::Sub) => Style::Sub,
                Some(Keyword::Program) => Style::Program,
                _ => continue,
            };
            if let Some(Control { label, .. }) = control {
                let body = self.files.mark();
                self.labels.define(label, Definition { style, file, line: line.number(), body });
                if last == Some(label) {
                    break;
                }
            }
        }
        let end = self.files.mark();
        if let Some(searched) = self.searched.get_mut(file) {
            *searched = end;
        }
        self.files.go(file, back)
    }

    /// The O word of a line, if it has one that can be read.
    fn control_of(&mut self, line: &Line, run: &mut Run) -> Option<Control> {
        let mut cursor = Cursor::new(self.files.bytes(line));
        if !matches!(cursor.peek(), Some(b'o' | b'n' | b'/')) {
            return None;
        }
        let head = head(&mut cursor).ok()?;
        if head.optional && self.block_delete || cursor.peek() != Some(b'o') {
            return None;
        }
        control::read(&mut cursor, &mut self.labels, run.words, run.state).ok()
    }
}
