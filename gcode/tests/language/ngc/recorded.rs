//! A sink that writes down what it is sent.

use crate::driven::{Driven, driven};
use gcode::{Call, Options, Place, Problem, Program, Sink};

/// Calls as text, with the lines they come from.
#[derive(Default)]
pub(crate) struct Record {
    pub(crate) calls: Vec<String>,
    pub(crate) lines: Vec<u32>,
}

impl Sink for Record {
    fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        self.calls.push(format!("{call:?}"));
        self.lines.push(place.line);
        Ok(())
    }
}

/// What came of a program.
pub(crate) type Outcome = Driven<Record>;

/// Runs a program to its end, whatever is wrong with it.
pub(crate) fn run(program: Program) -> Outcome {
    driven(program, Record::default())
}

/// Runs a text with the default options.
pub(crate) fn outcome(text: &str) -> Outcome {
    run(Program::from_text("test.ngc", text, &Options::default()))
}

/// The calls of a program without fault, those of start and end left out: `M2` is added.
pub(crate) fn calls(text: &str) -> Vec<String> {
    let outcome = outcome(&format!("{text}\nM2\n"));
    let rendered: Vec<String> = outcome.errors.iter().map(|error| error.render(false)).collect();
    assert!(rendered.is_empty(), "{}", rendered.concat());
    let calls = outcome.sink.calls;
    let start = calls.iter().position(|call| call == "OnReset").map_or(0, |at| at + 1);
    let last_line = text.split('\n').count() as u32 + 1;
    let end = outcome.sink.lines.iter().position(|line| *line == last_line).unwrap_or(calls.len());
    calls[start..end.max(start)].to_vec()
}

/// The texts of the messages of a program without fault.
pub(crate) fn messages(text: &str) -> Vec<String> {
    let quoted = |call: &String| Some(call.strip_prefix("Message(\"")?.strip_suffix("\")")?.to_owned());
    calls(text).iter().filter_map(quoted).collect()
}

/// The value that an expression has, as `(DEBUG,...)` shows it.
pub(crate) fn value(expression: &str) -> String {
    messages(&format!("#100={expression}\n(debug,#100)")).concat()
}

/// Line and code of every error.
pub(crate) fn errors(text: &str) -> Vec<(u32, &'static str)> {
    outcome(text).errors.iter().map(|error| (error.line, error.code)).collect()
}

/// Line, code and the bytes that are blamed for the first error.
pub(crate) fn blamed(text: &str) -> (u32, &'static str, String) {
    let outcome = outcome(text);
    let error = outcome.errors.first().expect("an error");
    (error.line, error.code, error.text[error.span.clone()].to_owned())
}
