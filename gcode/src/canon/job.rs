//! Jobs: work that is described by a formula instead of blocks. In: lines of a program that begin with `;@`,
//! or a file that is nothing but a job. Out: its text, for the receiver of calls, which knows the machine.
//!
//! Whatever a job says, it says in mm and in the coordinates in force. Nothing in this crate reads it: keys
//! and values are the business of the receiver, which also says where the tool is after it
//! ([`Sink::job`](crate::Sink::job)).

use crate::problem::{Problem, Span};

/// A job as it stands in the program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Job {
    /// Its text: line by line that of the program, with blanks for `;@`, so that columns are the same.
    pub text: String,
    /// The line of the program where it begins, from 1.
    pub line: u32,
    /// It is a file of its own, not part of a program.
    pub is_file: bool,
}

impl Job {
    /// Its lines without blanks at their ends, those left out that say nothing.
    pub fn lines(&self) -> impl Iterator<Item = &str> {
        self.text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'))
    }

    /// What a control makes of it that knows no jobs: a comment a line, each with its number.
    ///
    /// # Errors
    /// That of `each`.
    pub fn comments(
        &self,
        mut each: impl FnMut(u32, &str) -> Result<(), Box<Problem>>,
    ) -> Result<(), Box<Problem>> {
        (self.line..)
            .zip(self.text.lines())
            .try_for_each(|(line, text)| each(line, &format!("@ {}", text.trim())))
    }

    /// Where bytes of the text stand in the program: the line, and the bytes of the first line they are on.
    pub fn place(&self, start: usize, end: usize) -> (u32, Span) {
        let before = self.text.get(..start).unwrap_or(&self.text);
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        let line_end = self.text[line_start..].find('\n').map_or(self.text.len(), |at| line_start + at);
        let line = self.line + before.matches('\n').count() as u32;
        let column = |at: usize| at.clamp(line_start, line_end).saturating_sub(line_start) as u32;
        (line, Span { start: column(start), end: column(end).max(column(start)) })
    }
}
