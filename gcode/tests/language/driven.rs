//! Runs programs to their ends.

use gcode::{Diagnostic, Program, Sink, Step};

/// What came of a program.
pub(crate) struct Driven<S> {
    pub(crate) sink: S,
    pub(crate) errors: Vec<Diagnostic>,
    pub(crate) warnings: Vec<Diagnostic>,
    pub(crate) program: Program,
}

/// Runs a program to its end, whatever is wrong with it.
pub(crate) fn driven<S: Sink>(mut program: Program, mut sink: S) -> Driven<S> {
    let mut errors = Vec::new();
    loop {
        match program.step(&mut sink) {
            Ok(Step::More) => {}
            Ok(Step::Ended) => break,
            Err(error) => errors.push(*error),
        }
    }
    let warnings = program.take_warnings();
    Driven { sink, errors, warnings, program }
}
