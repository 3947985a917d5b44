//! if, while, do, repeat, break, continue. In: the O word with its condition. Out: the line that comes next.

use super::control::{Control, Keyword};
use super::labels::Label;
use super::skip::Goal;
use super::{Done, Flow, Here, Run};
use crate::problem::{Blame, Problem, short};
use crate::text::{Mark, whole};

/// What was begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// One of its branches was executed, or is.
    If {
        taken: bool,
    },
    While,
    Do,
    /// With the turns that are left.
    Repeat {
        left: u64,
    },
}

impl Kind {
    fn text(self) -> &'static str {
        match self {
            Kind::If { .. } => "if",
            Kind::While => "while",
            Kind::Do => "do",
            Kind::Repeat { .. } => "repeat",
        }
    }

    /// What ends it.
    fn goal(self) -> Goal {
        match self {
            Kind::If { .. } => Goal::EndIf,
            Kind::While => Goal::EndWhile,
            Kind::Do => Goal::DoWhile,
            Kind::Repeat { .. } => Goal::EndRepeat,
        }
    }
}

/// An if or a loop whose end has not come yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Open {
    kind: Kind,
    label: Label,
    /// Its first line, and the line to go back to.
    line: Mark,
    back: Mark,
}

impl Open {
    /// Whether it is executed again and again.
    pub(super) fn is_loop(&self) -> bool {
        !matches!(self.kind, Kind::If { .. })
    }

    /// Whether it is the if of this label and one of its branches was executed, so that no other can be.
    pub(super) fn is_taken(&self, label: Label) -> bool {
        self.label == label && self.kind == Kind::If { taken: true }
    }
}

impl Flow {
    /// What was begun last in the subroutine that is executed, if it has this label.
    fn innermost(&mut self, label: Label) -> Option<&mut Open> {
        let base = self.frames.last().map_or(0, |frame| frame.opens);
        self.opens.get_mut(base..)?.last_mut().filter(|open| open.label == label)
    }

    /// Keeps beginnings and ends in balance where a condition cannot be computed: it is taken for true, once.
    pub(super) fn assume(&mut self, control: Control, line: Mark) {
        let Control { label, keyword } = control;
        let open = self.innermost(label).map(|open| (open.kind, open.line));
        let kind = match (keyword, open) {
            (Keyword::While, Some((Kind::Do, _))) => {
                self.opens.pop();
                return;
            }
            (Keyword::While, Some((Kind::While, begun))) if begun == line => return,
            (Keyword::While, _) => Kind::While,
            (Keyword::Repeat, _) => Kind::Repeat { left: 0 },
            (Keyword::If, _) => Kind::If { taken: true },
            _ => return,
        };
        self.opens.push(Open { kind, label, line, back: line });
    }

    pub(super) fn begin_if(&mut self, here: Here, truth: bool, run: &mut Run) -> Done {
        let Here { label, at } = here;
        self.opens.push(Open { kind: Kind::If { taken: truth }, label, line: at, back: at });
        if truth { Ok(()) } else { self.next_branch(here, run) }
    }

    /// elseif and else.
    pub(super) fn else_if(&mut self, keyword: Keyword, here: Here, truth: bool, run: &mut Run) -> Done {
        match self.innermost(here.label).map(|open| &mut open.kind) {
            Some(Kind::If { taken: true }) => {
                self.opens.pop();
                let end = self.find(here, Goal::EndIf, run)?;
                self.files.go(self.files.current(), end.next)
            }
            Some(Kind::If { taken }) => {
                *taken = truth;
                if truth { Ok(()) } else { self.next_branch(here, run) }
            }
            _ => Err(self.unmatched(here.label, keyword, "if")),
        }
    }

    fn next_branch(&mut self, here: Here, run: &mut Run) -> Done {
        let branch = self.find(here, Goal::Branch, run)?;
        self.files.go(self.files.current(), branch.line)
    }

    pub(super) fn end_if(&mut self, label: Label) -> Done {
        match self.innermost(label).map(|open| open.kind) {
            Some(Kind::If { .. }) => {
                self.opens.pop();
                Ok(())
            }
            _ => Err(self.unmatched(label, Keyword::EndIf, "if")),
        }
    }

    /// while: the first line of a loop, or the last one of a do.
    pub(super) fn condition(&mut self, here: Here, truth: bool, run: &mut Run) -> Done {
        let Here { label, at } = here;
        match self.innermost(label).copied() {
            Some(Open { kind: Kind::Do, back, .. }) => {
                if truth && self.repeats {
                    return self.files.go(self.files.current(), back);
                }
                self.opens.pop();
                return Ok(());
            }
            Some(Open { kind: Kind::While, line, .. }) if line == at => {
                if truth {
                    return Ok(());
                }
                self.opens.pop();
            }
            _ if truth => {
                self.opens.push(Open { kind: Kind::While, label, line: at, back: at });
                return Ok(());
            }
            _ => {}
        }
        let end = self.find(here, Goal::EndWhile, run)?;
        self.files.go(self.files.current(), end.next)
    }

    pub(super) fn end_while(&mut self, label: Label) -> Done {
        match self.innermost(label) {
            Some(Open { kind: Kind::While, back, .. }) => {
                let back = *back;
                if self.repeats {
                    return self.files.go(self.files.current(), back);
                }
                self.opens.pop();
                Ok(())
            }
            _ => Err(self.unmatched(label, Keyword::EndWhile, "while")),
        }
    }

    pub(super) fn begin_do(&mut self, here: Here) -> Done {
        self.opens.push(Open { kind: Kind::Do, label: here.label, line: here.at, back: self.files.mark() });
        Ok(())
    }

    pub(super) fn begin_repeat(&mut self, here: Here, turns: f64, run: &mut Run) -> Done {
        let Here { label, at } = here;
        let Some(turns) = whole(turns).and_then(|turns| u64::try_from(turns).ok()) else {
            self.assume(Control { label, keyword: Keyword::Repeat }, at);
            let message = format!("nothing can be repeated {} times", short(turns));
            let help = "give a whole number that is not negative; ROUND, FIX and FUP make one";
            return Err(Problem::error("bad-value", Blame::Block, message, help));
        };
        if let Some(left) = turns.checked_sub(1) {
            let back = self.files.mark();
            self.opens.push(Open { kind: Kind::Repeat { left }, label, line: at, back });
            return Ok(());
        }
        let end = self.find(here, Goal::EndRepeat, run)?;
        self.files.go(self.files.current(), end.next)
    }

    pub(super) fn end_repeat(&mut self, label: Label) -> Done {
        let repeats = self.repeats;
        match self.innermost(label) {
            Some(Open { kind: Kind::Repeat { left }, back, .. }) => {
                if let Some(fewer) = left.checked_sub(1).filter(|_| repeats) {
                    *left = fewer;
                    let back = *back;
                    return self.files.go(self.files.current(), back);
                }
                self.opens.pop();
                Ok(())
            }
            _ => Err(self.unmatched(label, Keyword::EndRepeat, "repeat")),
        }
    }

    /// break: goes on after the loop.
    pub(super) fn leave_loop(&mut self, here: Here, run: &mut Run) -> Done {
        let open = self.loop_of(here.label, Keyword::Break)?;
        self.opens.pop();
        let end = self.find(here, open.kind.goal(), run)?;
        self.files.go(self.files.current(), end.next)
    }

    /// continue: goes to the condition of the loop.
    pub(super) fn next_turn(&mut self, here: Here, run: &mut Run) -> Done {
        let open = self.loop_of(here.label, Keyword::Continue)?;
        if open.kind == Kind::While && self.repeats {
            return self.files.go(self.files.current(), open.back);
        }
        let end = self.find(here, open.kind.goal(), run)?;
        self.files.go(self.files.current(), end.line)
    }

    /// The while or do of this label; what was begun in it is given up.
    fn loop_of(&mut self, label: Label, keyword: Keyword) -> Result<Open, Box<Problem>> {
        let base = self.frames.last().map_or(0, |frame| frame.opens);
        let opens = self.opens.get(base..).unwrap_or(&[]);
        let index = opens.iter().rposition(|open| open.label == label);
        match index.and_then(|index| Some((base + index, *opens.get(index)?))) {
            Some((index, open)) if matches!(open.kind, Kind::While | Kind::Do) => {
                self.opens.truncate(index + 1);
                Ok(open)
            }
            _ => Err(self.unmatched(label, keyword, "while or do")),
        }
    }

    #[cold]
    fn unmatched(&self, label: Label, keyword: Keyword, beginning: &str) -> Box<Problem> {
        let (text, keyword) = (self.labels.text(label), keyword.text());
        let (message, help) = match self.open() {
            Some(open) => {
                let other = format!("{} {}", self.labels.text(open.label), open.kind.text());
                let line = open.line.lines + 1;
                let message =
                    format!("{text} {keyword} has no {beginning}: {other} in line {line} is open here");
                (message, format!("end {other} first, or correct the label"))
            }
            None => {
                let message = format!("{text} {keyword} has no {beginning} before it");
                (message, format!("add {text} {beginning} where it begins, or correct the label"))
            }
        };
        Problem::error("unmatched", Blame::Block, message, help)
    }

    /// The program was ended (M2) within an if, a loop or a subroutine: its end must stand further on, or it
    /// was forgotten.
    ///
    /// # Errors
    /// It is nowhere.
    pub(crate) fn check_ends_exist(&mut self, run: &mut Run) -> Done {
        let Some(open) = self.open().copied() else { return Ok(()) };
        let from = self.files.mark();
        let found = self.find(Here { label: open.label, at: from }, open.kind.goal(), run);
        found.map(|_| ()).map_err(|mut problem| {
            problem.blame = Blame::Line(open.line.lines + 1);
            problem
        })
    }

    /// An error for what the subroutine (or the program) has begun and not ended; it is given up.
    pub(super) fn check_closed(&mut self) -> Done {
        let base = self.frames.last().map_or(0, |frame| frame.opens);
        let Some(open) = self.open().copied() else { return Ok(()) };
        self.opens.truncate(base);
        let what = format!("{} {}", self.labels.text(open.label), open.kind.text());
        let message = format!("{what} is not ended");
        let help = "add its end, with the same label";
        Err(Problem::error("missing-end", Blame::Line(open.line.lines + 1), message, help))
    }
}
