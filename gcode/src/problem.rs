//! What is wrong with a part program, where, and what to do about it.
//!
//! Inside the interpreter a [`Problem`] names the word to blame; the program, which knows the text, makes a
//! [`Diagnostic`] of it: file, line, column, the source line with a caret, the remedy.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::canon::Place;
use crate::codes::{G, M};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The program can be run; the user should know.
    Warning,
    /// The program must not be run.
    Error,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Severity::Warning => "warning",
            Severity::Error => "error",
        })
    }
}

/// Bytes of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// Byte after the last.
    pub end: u32,
}

/// What of a block is to blame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blame {
    /// All of it.
    Block,
    /// The word of a letter; all of it if there is none.
    Word(char),
    /// A G code.
    G(G),
    /// An M code.
    M(M),
    /// These bytes of the line.
    Span(Span),
    /// All of another line of the same file: the block was read before.
    Line(u32),
    /// All of a line that was read before, in whichever file.
    At(Place),
    /// These bytes of such a line.
    Part(Place, Span),
}

/// What is wrong, before it is known where that stands in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Stable name of the kind, such as `no-feed`; the list is in `docs/diagnostics.md`.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What to point at.
    pub blame: Blame,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

impl Problem {
    /// An error.
    pub fn error(
        code: &'static str,
        blame: Blame,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<Problem> {
        let (message, help) = (message.into(), help.into());
        Box::new(Problem { code, severity: Severity::Error, blame, message, help })
    }

    /// A warning.
    pub fn warning(
        code: &'static str,
        blame: Blame,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<Problem> {
        let mut problem = Problem::error(code, blame, message, help);
        problem.severity = Severity::Warning;
        problem
    }
}

/// One thing that is wrong, or worth knowing, about a part program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Name of the file.
    pub file: Arc<str>,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// The line itself.
    pub text: String,
    /// The words to blame, bytes of `text`.
    pub span: Range<usize>,
    /// Stable name of the kind, such as `travel-limit`.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

impl Diagnostic {
    /// Puts a problem at its place: `text` is line `line` of `file`, `span` the bytes to blame.
    pub fn new(problem: Problem, file: &Arc<str>, line: u32, text: &str, span: Span) -> Diagnostic {
        let Problem { code, severity, message, help, .. } = problem;
        let range = span.start as usize..(span.end as usize).min(text.len());
        let span = if text.get(range.clone()).is_some() { range } else { 0..text.len() };
        let column = text[..span.start].chars().count() as u32 + 1;
        let (file, text) = (Arc::clone(file), text.to_owned());
        let line = line.max(1);
        Diagnostic { file, line, column, text, span, code, severity, message, help }
    }

    /// The diagnostic as text of several lines: `FILE:LINE:COLUMN: error[code]: message`, the source line
    /// with a caret, and the remedy.
    pub fn render(&self, color: bool) -> String {
        let level = match self.severity {
            Severity::Warning => Level::WARNING,
            Severity::Error => Level::ERROR,
        };
        let snippet = Snippet::source(self.text.as_str())
            .line_start(self.line as usize)
            .annotation(AnnotationKind::Primary.span(self.span.clone()));
        let report = [Group::with_level(level).element(snippet).element(Level::HELP.message(&self.help))];
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        format!("{}\n{}\n", self.headline(), renderer.render(&report))
    }

    /// The first line of [`Diagnostic::render`].
    pub fn headline(&self) -> String {
        let Diagnostic { file, line, column, severity, code, message, .. } = self;
        format!("{file}:{line}:{column}: {severity}[{code}]: {message}")
    }
}

/// A number as a user would write it: at most four decimals, no trailing zeros.
pub fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// An M code that no dialect has, and that the machine file does not declare. `number`: it, if it is one.
#[cold]
pub(crate) fn undeclared(number: Option<u16>, value: f64, span: Span) -> Box<Problem> {
    let message = format!("there is no code M{}", short(value));
    let help = match number {
        Some(number) => format!(
            "correct the number, or say in the machine file what this machine does with it: [m_codes] and below it \
             {number} = \"ignore\", or \"wait\", or {{ does = \"output\", number = 3, value = true }}"
        ),
        None => "M codes are whole numbers up to 999".into(),
    };
    Problem::error("unknown-m-code", Blame::Span(span), message, help)
}
