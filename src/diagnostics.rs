//! Diagnostics as one JSON document, for editors: `pitchlock check --json`.
//!
//! ```json
//! { "version": 1, "program": "part.ngc", "dialect": "linuxcnc", "errors": 1, "warnings": 0, "moves": 12,
//!   "time_s": null, "gauge": null,
//!   "diagnostics": [
//!   { "file": "part.ngc", "line": 2, "column": 8, "end_column": 10, "severity": "error",
//!     "code": "unused-word", "message": "no code of this block uses Q", "help": "leave it out" } ] }
//! ```
//! `gauge` is the name of the thread that a gauge will judge, null without one. `time_s` is the time the
//! program takes at 100 % override; null where an error keeps it from running. Lines
//! and columns count from 1, columns in characters; `end_column` is that of the character behind the last.

use gcode::{Diagnostic, Severity};
use serde::Serialize;

/// The document.
#[derive(Debug, Serialize)]
pub(crate) struct Document<'a> {
    version: u32,
    program: &'a str,
    dialect: &'a str,
    errors: usize,
    warnings: usize,
    moves: u64,
    time_s: Option<f64>,
    gauge: Option<&'a str>,
    diagnostics: Vec<Entry<'a>>,
}

#[derive(Debug, Serialize)]
struct Entry<'a> {
    file: &'a str,
    line: u32,
    column: u32,
    end_column: u32,
    severity: String,
    code: &'a str,
    message: &'a str,
    help: &'a str,
}

impl<'a> Document<'a> {
    /// The document of everything that was found in a program.
    pub(crate) fn new(
        program: &'a str,
        dialect: &'a str,
        diagnostics: &'a [Diagnostic],
        moves: u64,
        time_s: Option<f64>,
        gauge: Option<&'a str>,
    ) -> Document<'a> {
        let count = |severity| diagnostics.iter().filter(|one| one.severity == severity).count();
        Document {
            version: 1,
            program,
            dialect,
            errors: count(Severity::Error),
            warnings: count(Severity::Warning),
            moves,
            time_s,
            gauge,
            diagnostics: diagnostics.iter().map(Entry::from).collect(),
        }
    }
}

impl<'a> From<&'a Diagnostic> for Entry<'a> {
    fn from(diagnostic: &'a Diagnostic) -> Entry<'a> {
        let Diagnostic { file, line, column, text, span, code, severity, message, help } = diagnostic;
        let length = text.get(span.clone()).map_or(0, |blamed| blamed.chars().count() as u32);
        Entry {
            file,
            line: *line,
            column: *column,
            end_column: column + length,
            severity: severity.to_string(),
            code,
            message,
            help,
        }
    }
}
