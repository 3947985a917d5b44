//! What is wrong with a part program, where, and what to do about it.
//!
//! In: a place in the program and words. Out: a [`Diagnostic`], rendered with its source line and a caret.
//!
//! | stage | codes |
//! |---|---|
//! | characters | `bad-character` `line-too-long` `unclosed-comment` `nested-comment` `bad-line-number` `misplaced-line-number` |
//! | values | `missing-value` `bad-number` `missing-bracket` `unknown-operator` `unknown-function` `arithmetic` `expression-too-deep` `bad-parameter` |
//! | words | `unknown-g-code` `unknown-m-code` `unknown-word` `no-such-axis` `repeated-word` `modal-group` `unused-word` `not-available` |
//! | blocks | `no-motion-mode` `missing-word` `bad-value` `no-feed` `speed-limit` `spindle-not-turning` `unknown-tool` `travel-limit` `no-program-end` |
//! | threads | `feed-in-thread` `pass-not-feasible` |
//! | warnings | `message-not-shown` `no-spindle-speed` `no-retract` |

use std::fmt;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

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

/// A stretch of one line of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Spot {
    /// Line, from 1.
    pub(crate) line: u32,
    /// Column in characters, from 1.
    pub(crate) column: u32,
    /// First byte in the line, and the byte after the last.
    pub(crate) start: usize,
    pub(crate) end: usize,
}

/// One thing that is wrong, or worth knowing, about a part program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Stable name of the kind, such as `travel-limit`.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// The words to blame, bytes of that line.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

impl Diagnostic {
    pub(crate) fn error(
        code: &'static str,
        spot: Spot,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Diagnostic {
        let (message, help) = (message.into(), help.into());
        let span = spot.start..spot.end;
        let (line, column) = (spot.line, spot.column);
        Diagnostic { code, severity: Severity::Error, line, column, span, message, help }
    }

    pub(crate) fn warning(
        code: &'static str,
        spot: Spot,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Diagnostic {
        Diagnostic { severity: Severity::Warning, ..Diagnostic::error(code, spot, message, help) }
    }

    /// The diagnostic as text of several lines: `NAME:LINE:COLUMN: error[code]: message`, the source line with a
    /// caret, and the remedy. `source` is the whole program.
    ///
    /// ```
    /// use interpreter::check;
    /// let source = "G21 G90\nG2 X10 Z0 R5\nM2\n";
    /// let check = check("part.ngc", source, &protocol::Machine::default());
    /// let text = check.diagnostics[0].render("part.ngc", source, false);
    /// assert!(text.starts_with("part.ngc:2:1: error[not-available]: G2 is not available yet"));
    /// ```
    pub fn render(&self, name: &str, source: &str, color: bool) -> String {
        let text = source.lines().nth(self.line.saturating_sub(1) as usize).unwrap_or("");
        let span = if text.get(self.span.clone()).is_some() { self.span.clone() } else { 0..text.len() };
        let level = match self.severity {
            Severity::Warning => Level::WARNING,
            Severity::Error => Level::ERROR,
        };
        let snippet = Snippet::source(text)
            .line_start(self.line as usize)
            .annotation(AnnotationKind::Primary.span(span));
        let report = [Group::with_level(level).element(snippet).element(Level::HELP.message(&self.help))];
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        format!("{}\n{}\n", self.headline(name), renderer.render(&report))
    }

    /// The first line of [`Diagnostic::render`].
    pub fn headline(&self, name: &str) -> String {
        format!("{name}:{}:{}: {}[{}]: {}", self.line, self.column, self.severity, self.code, self.message)
    }
}

/// A number as a user would write it: at most four decimals, no trailing zeros.
pub(crate) fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}
