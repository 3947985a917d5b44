//! Every way in which a row of the table of faults is brought about here. Out: cases.

mod axes;
mod messages;
mod spindle;

use testing::Seed;

use super::case::Case;
use super::course::{Course, Stage};

/// The places of the axes in a [`Moment`](super::course::Moment).
const X: usize = 0;
const Z: usize = 1;

const EVERYWHERE: &[Stage] = &[Stage::Timed, Stage::RunIn, Stage::Thread, Stage::RunOut, Stage::Dwell];
const IN_PASS: &[Stage] = &[Stage::RunIn, Stage::Thread, Stage::RunOut];

/// A thread of 24 turns at 600 1/min, timed motion of both axes before and behind it, and dwells.
const WHOLE: &str = "M3 S600\nG4 P1.2\nG0 X20 Z20\nG1 X14 Z8 F2000\nG4 P0.2\nG0 X9.5\nG33 Z-40 K2\nG0 X12\n\
    G0 Z10\nG1 X20 Z40 F3000\nG4 P1.2\nM5\nM2\n";

/// All the cases.
pub(super) fn cases() -> Vec<Case> {
    [axes::cases(), messages::cases(), spindle::cases()].into_iter().flatten().collect()
}

fn event(at: u64, action: &str) -> String {
    format!("[[event]]\nat = {{ cycle = {at} }}\n{action}\n")
}

fn always(action: &'static str) -> impl Fn(&mut Seed, u64) -> String {
    move |_, at| event(at, action)
}

fn one_of(actions: &'static [&'static str]) -> impl Fn(&mut Seed, u64) -> String {
    move |seed, at| event(at, seed.of(actions))
}

/// The first cycle from that of the event on of which something is true: of the run, of the same run without
/// the event.
fn when(is: impl Fn(&Course, &Course, usize) -> bool) -> impl Fn(&Course, &Course, usize) -> Option<usize> {
    move |course, twin, at| (at.max(1)..course.len()).find(|n| is(course, twin, *n))
}

/// So many cycles behind the event.
fn later(cycles: usize) -> impl Fn(&Course, &Course, usize) -> Option<usize> {
    move |_, _, at| Some(at + cycles)
}

/// A message that was due in the cycle of the event has not come.
const MISSING: usize = 1;
