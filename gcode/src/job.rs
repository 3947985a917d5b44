//! Jobs: work that is described by a formula instead of blocks. In: lines of a program that begin with `;@`, or a file that
//! is nothing but a job. Out: its text, for the receiver of calls, which knows the machine.
//!
//! Whatever a job says, it says in mm and in the coordinates in force. Nothing here reads it: keys and values are the
//! business of the receiver, which also says where the tool is behind it ([`Sink::after_job`](crate::Sink::after_job)).

use std::io;
use std::path::Path;

use crate::canon::Call;
use crate::execute::{Done, Output};
use crate::flow::Files;
use crate::options::{Dialect, Options};
use crate::problem::{Blame, Problem, Span};
use crate::program::Program;
use crate::source::Line;
use crate::state::State;

/// How a line of a job begins.
const MARK: &[u8] = b";@";
/// Most bytes of a job.
const LONGEST: usize = 512 << 10;

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
    pub fn comments(&self, mut each: impl FnMut(u32, &str) -> Done) -> Done {
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

/// Whether a line belongs to a job.
pub(crate) fn begins(line: &[u8]) -> bool {
    line.trim_ascii_start().starts_with(MARK)
}

/// Whether a comment behind a semicolon looks like a line of a job, and is none.
pub(crate) fn is_nearly(comment: &str) -> bool {
    let text = comment.trim_start_matches(';');
    text.starts_with('@') || (text.trim_start().starts_with('@') && text.contains('='))
}

/// Reads a job to its end. `first` is its first line, which has been taken.
///
/// # Errors
/// A line that is no text, a job that is too long, or a file that cannot be read.
pub(crate) fn read(files: &mut Files, first: &Line) -> Result<Job, Box<Problem>> {
    let mut job = Job { line: first.number(), ..Job::default() };
    let mut bytes = blanked(files.bytes(first));
    loop {
        job.push(&bytes)?;
        let (file, mark) = (files.current(), files.mark());
        let Some(line) = files.take()? else { return Ok(job) };
        if !begins(files.bytes(&line)) {
            files.go(file, mark)?;
            return Ok(job);
        }
        bytes = blanked(files.bytes(&line));
    }
}

/// Reads a file that is a job.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_file(files: &mut Files) -> Result<Job, Box<Problem>> {
    let mut job = Job { line: 1, is_file: true, ..Job::default() };
    while let Some(line) = files.take()? {
        let bytes = files.bytes(&line).to_vec();
        job.push(&bytes)?;
    }
    Ok(job)
}

/// Hands a job to the receiver, and takes over where the tool is then.
///
/// # Errors
/// A state in which there can be no job, or what the receiver refuses.
pub(crate) fn execute(job: &Job, state: &mut State, out: &mut Output) -> Done {
    let refuse = |message: &str, help: &str| Err(Problem::error("job", Blame::Line(job.line), message, help));
    if state.compensation.is_on() {
        return refuse("a job while G41 or G42 is on", "switch it off with G40 before: a job names its tool");
    }
    if state.recorder.is_on() {
        return refuse("a job within a contour of G70, G71 or G72", "write it behind the contour");
    }
    out.call(Call::Job(job, &state.tools))?;
    state.position = out.after_job().unwrap_or(state.position);
    state.unseen = [0.0; 6];
    Ok(())
}

impl Program {
    /// Opens a file that is a job, as [`job`](crate::job) says.
    ///
    /// # Errors
    /// It cannot be opened or read.
    pub fn open_job(path: &Path, options: &Options) -> io::Result<Program> {
        Program::open(path, &of_job(options)).map(Program::into_job)
    }

    /// Takes a text that is a job.
    pub fn from_job(name: &str, text: impl Into<Vec<u8>>, options: &Options) -> Program {
        Program::from_text(name, text, &of_job(options)).into_job()
    }
}

/// The options of a file that is a job: a line may be as long as the job, for all of its points.
fn of_job(options: &Options) -> Options {
    let mut options = Options { dialect: Dialect::Linuxcnc, ..options.clone() };
    options.limits.line_length = LONGEST;
    options
}

impl Job {
    fn push(&mut self, line: &[u8]) -> Done {
        let lines = |text: &str| text.matches('\n').count() as u32;
        let refuse = |job: &Job, message: &str, help: &str| {
            Problem::error("job", Blame::Line(job.line + lines(&job.text)), message, help)
        };
        let Ok(line) = std::str::from_utf8(line) else {
            return Err(refuse(self, "a line of a job is no UTF-8 text", "save the file as UTF-8"));
        };
        if self.text.len() + line.len() >= LONGEST {
            return Err(refuse(self, "a job has at most 512 KiB", "write it shorter"));
        }
        self.text.push_str(line.trim_end());
        self.text.push('\n');
        Ok(())
    }
}

/// A line with blanks for its mark.
fn blanked(line: &[u8]) -> Vec<u8> {
    let mut bytes = line.to_vec();
    let at = bytes.len() - bytes.trim_ascii_start().len();
    bytes.iter_mut().skip(at).take(MARK.len()).for_each(|byte| *byte = b' ');
    bytes
}
