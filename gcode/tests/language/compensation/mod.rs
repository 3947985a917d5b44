//! Compensation of the tool radius: calls of whole programs, properties of random contours.

mod contours;
mod programs;

use gcode::canon::{Call, Place, Sink};
use gcode::{Diagnostic, Options, Problem, Program, Step};

/// Moves of a program with their lines.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Move {
    Traverse([f64; 6]),
    Feed([f64; 6]),
    Arc(gcode::canon::Arc),
}

impl Move {
    /// Its end in the XY plane.
    fn end(&self) -> [f64; 2] {
        match self {
            Move::Traverse(to) | Move::Feed(to) => [to[0], to[1]],
            Move::Arc(arc) => arc.end,
        }
    }
}

/// Keeps the moves, and every call as text.
#[derive(Default)]
struct Record {
    moves: Vec<(u32, Move)>,
    calls: Vec<String>,
}

impl Sink for Record {
    fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        self.calls.push(format!("{call:?}"));
        let made = match call {
            Call::StraightTraverse(to) => Move::Traverse(to),
            Call::StraightFeed(to) => Move::Feed(to),
            Call::ArcFeed(arc) => Move::Arc(arc),
            _ => return Ok(()),
        };
        self.moves.push((place.line, made));
        Ok(())
    }
}

/// What a program sends until its end or its first error.
fn run(text: &str) -> (Record, Option<Diagnostic>) {
    let mut record = Record::default();
    let mut program = Program::from_text("test.ngc", text, &Options::default());
    loop {
        match program.step(&mut record) {
            Ok(Step::More) => {}
            Ok(Step::Ended) => return (record, None),
            Err(diagnostic) => return (record, Some(*diagnostic)),
        }
    }
}
