//! Runs programs and writes down what moves, threads and waits: X is a radius.

use gcode::canon::{Arc, X, Z};
use gcode::{Call, Dialect, Options, Place, Problem, Program, Sink};

use crate::driven::{Driven, driven};

/// Everything that a program asks for.
#[derive(Default)]
pub(crate) struct Record {
    /// Moves, threads, dwells, stops and path modes.
    pub(crate) moves: Vec<String>,
    /// Everything else.
    pub(crate) others: Vec<String>,
    /// The lines that the moves come from.
    pub(crate) lines: Vec<u32>,
}

fn n(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

impl Sink for Record {
    fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        let text = match call {
            Call::StraightTraverse(end) => format!("G0 {} {}", n(end[X]), n(end[Z])),
            Call::StraightFeed(end) => format!("G1 {} {}", n(end[X]), n(end[Z])),
            Call::ArcFeed(Arc { end: [z, x], center: [cz, cx], turns, .. }) => {
                format!("{} {} {} c {} {}", if turns > 0 { "G3" } else { "G2" }, n(x), n(z), n(cx), n(cz))
            }
            Call::StartSpeedFeedSynch { lead, start_deg, growth: 0.0, .. } => {
                format!("lead {} at {}", n(lead), n(start_deg))
            }
            Call::StartSpeedFeedSynch { lead, start_deg, growth, .. } => {
                format!("lead {} at {} growing by {}", n(lead), n(start_deg), n(growth))
            }
            Call::StopSpeedFeedSynch => "free".into(),
            Call::ThreadCycle(cycle) => format!("{cycle:?}"),
            Call::Dwell(seconds) => format!("dwell {}", n(seconds)),
            Call::ProgramStop => "M0".into(),
            Call::SetMotionControlMode(mode) => format!("{mode:?}"),
            other => {
                self.others.push(format!("{other:?}"));
                return Ok(());
            }
        };
        self.moves.push(text);
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

pub(crate) fn fanuc() -> Options {
    Options { dialect: Dialect::Fanuc, ..Options::default() }
}

pub(crate) fn outcome(text: &str) -> Outcome {
    run(Program::from_text("O0001.nc", text, &fanuc()))
}

/// A program without fault; `M30` is added.
pub(crate) fn sound(text: &str) -> Record {
    let outcome = outcome(&format!("{text}\nM30\n"));
    let rendered: Vec<String> = outcome.errors.iter().map(|error| error.render(false)).collect();
    assert!(rendered.is_empty(), "{}", rendered.concat());
    outcome.sink
}

/// The moves of a program without fault.
pub(crate) fn moves(text: &str) -> Vec<String> {
    sound(text).moves
}

/// The moves of a program of the other dialect: lathe, diameters, feed per revolution.
pub(crate) fn linuxcnc(text: &str) -> Vec<String> {
    let text = format!("G18 G7 G95\n{text}\nM2\n");
    let outcome = run(Program::from_text("test.ngc", text, &Options::default()));
    let rendered: Vec<String> = outcome.errors.iter().map(|error| error.render(false)).collect();
    assert!(rendered.is_empty(), "{}", rendered.concat());
    outcome.sink.moves
}

/// Line and code of every error of a program; `M30` is added.
pub(crate) fn errors(text: &str) -> Vec<(u32, &'static str)> {
    outcome(&format!("{text}\nM30\n")).errors.iter().map(|error| (error.line, error.code)).collect()
}

/// The value that an expression has.
pub(crate) fn value(expression: &str) -> f64 {
    let moves = moves(&format!("#100={expression}\nG04 U[#100+10000.]"));
    let seconds: f64 = moves[0].strip_prefix("dwell ").expect("a dwell").parse().expect("a number");
    (seconds - 10000.0).mul_add(1e4, 0.0).round() / 1e4
}
