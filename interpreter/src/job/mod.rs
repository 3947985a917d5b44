//! Jobs: work that is given as formulas instead of points. In: the text of a job (TOML), a machine, the zero
//! of the formulas, the feed in force. Out: moves to where it begins, formulas, traces, moves away; or what
//! is wrong, by key.
//!
//! | module | kind of job |
//! |---|---|
//! | `surface` | Z = ψ(X, Y) under a tool; `grid` looks at all of the surface, `walk` goes along all of its paths |
//! | `contour` | Y = f(X) beside a tool |
//! | `feed` | the highest feed that the axes allow on a path |
//! | `seam` | a seam under the beam of a positioner |
//! | `text` | the text: keys, and where they stand in it |
//! | `row` | arrays of as many values as there must be |
//! | `run` | where a job stands in a program, or as a program of its own |

mod contour;
mod feed;
mod grid;
mod row;
mod run;
mod seam;
mod surface;
mod text;
mod walk;

use machine::Machine;
use protocol::{Axis, Feed, PerAxis, Position, Shape, Work};
use serde::Deserialize;
use shape::{Correction, Formula};

use row::Row;
pub(crate) use run::{InForce, Jobs, Setup};

/// What a job is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Kind {
    /// A plane contour.
    Contour,
    /// A surface.
    Surface,
    /// A seam.
    Seam,
}

/// Keys that every kind of job has.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Header {
    /// What it is.
    pub(crate) kind: Kind,
    /// Feed along the path of the tool, or of the beam on the part, mm/min.
    pub(crate) feed_mm_min: Option<f64>,
    /// Largest chord error of an interpolator cycle, mm; without it that of the machine.
    pub(crate) chord_mm: Option<f64>,
    /// How followers are led.
    #[serde(default)]
    pub(crate) correction: Correction,
    /// Of a job file alone: its name, for people.
    pub(crate) name: Option<String>,
    /// Machine position of the zero of the formulas, mm.
    pub(crate) origin_mm: Option<Row<f64, 3>>,
    /// Speed of the spindle, 1/min; negative turns counterclockwise.
    pub(crate) spindle_rpm: Option<f64>,
    /// Number of the tool.
    pub(crate) tool_number: Option<u32>,
    /// Coolant.
    pub(crate) coolant: Option<Coolant>,
}

/// What cools.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Coolant {
    /// Nothing.
    Off,
    /// M7.
    Mist,
    /// M8.
    Flood,
}

/// What every kind of job is planned with.
pub(crate) struct Job<'a> {
    /// The machine.
    pub(crate) machine: &'a Machine,
    /// It is a file of its own, which says where its zero is.
    pub(crate) is_file: bool,
    /// Machine position of the zero of the formulas, mm.
    pub(crate) origin_mm: [f64; 3],
    /// Feed, mm/min: that of the job, else F.
    pub(crate) feed_mm_min: f64,
    /// Largest chord error, mm.
    pub(crate) chord_mm: f64,
    /// How followers are led.
    pub(crate) correction: Correction,
    /// Where the axes rest.
    pub(crate) rest: PerAxis<Position>,
}

impl Job<'_> {
    /// The trace of some work.
    pub(crate) fn trace(&self, work: Shape) -> Work {
        let Job { origin_mm, feed_mm_min, chord_mm, correction, .. } = *self;
        Work { shape: work, origin: origin_mm.map(Position::from_mm), feed_mm_min, chord_mm, correction }
    }

    /// Where the axes stand if some of them are at places seen from the zero of the formulas, mm, and the
    /// others rest.
    pub(crate) fn at<const N: usize>(&self, axes: [Axis; N], from_zero: [f64; N]) -> PerAxis<Position> {
        let mut at = self.rest;
        for (axis, mm) in axes.into_iter().zip(from_zero) {
            at[axis.index()] = Position::from_mm(self.zero(axis)).moved(mm);
        }
        at
    }

    /// Machine position of the zero of the formulas on an axis, mm.
    pub(crate) fn zero(&self, axis: Axis) -> f64 {
        let place = [Axis::X, Axis::Y, Axis::Z].iter().position(|one| *one == axis);
        place.and_then(|n| self.origin_mm.get(n).copied()).unwrap_or(0.0)
    }

    /// Refuses a box that is not within the travel; its corners as seen from the zero of the formulas, mm.
    /// `keys`: what says how far it goes on each axis.
    pub(crate) fn reaches<const N: usize>(
        &self,
        axes: [Axis; N],
        [low, high]: [[f64; N]; 2],
        keys: [&str; N],
    ) -> Result<(), Fault> {
        for (n, axis) in axes.into_iter().enumerate() {
            let Some(config) = self.machine.axis.get(&axis) else {
                let message = format!("{} has no axis {axis}", self.machine.general.name);
                return Err(Fault::new("kind", message, "choose the machine file of another machine"));
            };
            let [from, to] = [low[n], high[n]].map(|at| at + self.zero(axis));
            let [lowest, highest] = config.travel_mm;
            if !(lowest <= from && to <= highest) {
                let message = format!(
                    "{axis} would go from {from:.3} to {to:.3} mm, and axis.{}.travel_mm = [{lowest}, {highest}]",
                    axis.name()
                );
                let (key, help) = self.remedy(axis, [lowest - low[n], highest - high[n]], keys[n]);
                return Err(Fault::new(key, message, help));
            }
        }
        Ok(())
    }

    /// The key to blame for a way beyond the travel, and what to do; the zero of the formulas may lie from
    /// low to high, mm.
    fn remedy<'k>(&self, axis: Axis, [low, high]: [f64; 2], key: &'k str) -> (&'k str, String) {
        let [low, high] = [(low * 1e3).ceil() / 1e3, (high * 1e3).floor() / 1e3];
        if low > high {
            return (key, format!("that is {:.3} mm more than {axis} can travel: change {key}", low - high));
        }
        let lower = if key == CLEARANCE { "lower clearance_mm, or " } else { "" };
        match self.is_file {
            true if key != CLEARANCE => {
                ("origin_mm", format!("give origin_mm {low} to {high} for {axis}, or make the part smaller"))
            }
            true => (key, format!("{lower}give origin_mm {low} to {high} for {axis}")),
            false => {
                (key, format!("{lower}put the zero of {axis} (G54, G92) at {low} to {high} of the machine"))
            }
        }
    }

    /// Moves to where the work begins: with the axis `across` to `clear` first, then the others, then down at
    /// feed. `sign` says on which side of the part it is clear.
    pub(crate) fn approach(
        &self,
        across: Axis,
        clear: Position,
        sign: f64,
        start: &PerAxis<Position>,
    ) -> Vec<Move> {
        let across = across.index();
        let is_clear = sign * self.rest[across].mm_from(clear) >= 0.0;
        let height = if is_clear { self.rest[across] } else { clear };
        let above = |mut at: PerAxis<Position>, height| {
            at[across] = height;
            Move { to: at, feed: Feed::Rapid }
        };
        let down = Move { to: *start, feed: Feed::PerMinute(self.feed_mm_min) };
        let moves = [above(self.rest, height), above(*start, height), above(*start, clear), down];
        let mut at = self.rest;
        moves.into_iter().filter(|step| std::mem::replace(&mut at, step.to) != step.to).collect()
    }
}

/// A move before or behind the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Move {
    /// Where to.
    pub(crate) to: PerAxis<Position>,
    /// How fast.
    pub(crate) feed: Feed,
}

/// A job that can be done.
#[derive(Clone, Debug)]
pub(crate) struct Planned {
    /// From where the axes rest to where the work begins.
    pub(crate) approach: Vec<Move>,
    /// Its formulas, by number.
    pub(crate) formulas: Vec<Formula>,
    /// The work, one trace behind the other.
    pub(crate) traces: Vec<Work>,
    /// Where the axes rest behind it.
    pub(crate) end: PerAxis<Position>,
    /// Moves away from there.
    pub(crate) retract: Vec<Move>,
    /// What the user should know.
    pub(crate) warnings: Vec<Fault>,
    /// What it is, in words and figures: for `check`.
    pub(crate) facts: Vec<(&'static str, String)>,
}

/// What is wrong with a job.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    /// What kind of fault it is.
    pub(crate) code: &'static str,
    /// Path of the key to blame, such as `tool.diameter_mm`; empty: the whole job.
    pub(crate) key: String,
    /// Bytes of the value of the key, where not all of it is to blame: those of a formula.
    pub(crate) part: Option<std::ops::Range<usize>>,
    /// What is wrong.
    pub(crate) message: String,
    /// What to do about it.
    pub(crate) help: String,
}

impl Fault {
    /// A fault of a key.
    pub(crate) fn new(key: &str, message: impl Into<String>, help: impl Into<String>) -> Fault {
        Fault { code: "job", key: key.into(), part: None, message: message.into(), help: help.into() }
    }
}

/// A note on a job for people: what `pitchlock check` prints.
#[derive(Clone, Debug, PartialEq)]
pub struct JobNote {
    /// Line of the program where it begins.
    pub line: u32,
    /// What it is, in words and figures.
    pub facts: Vec<(&'static str, String)>,
}

/// Refuses a number that does not lie within a range.
pub(crate) fn within(key: &str, value: f64, [low, high]: [f64; 2], unit: &str) -> Result<f64, Fault> {
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    // Bounds that were computed have no more digits than people want to read.
    let digits = |bound: f64| format!("{bound:.5e}").parse().unwrap_or(bound);
    let [low, high]: [f64; 2] = [low, high].map(digits);
    let message = format!("{key} = {value} is not between {low} and {high} {unit}").trim_end().to_owned();
    Err(Fault::new(key, message, format!("give {low} to {high}")))
}

/// Reads a formula of a key.
pub(crate) fn formula(key: &str, text: &str, variables: &[&str]) -> Result<Formula, Fault> {
    crate::formula::parse(text, variables).map_err(|misread| Fault {
        code: "job",
        key: key.into(),
        part: Some(misread.span),
        message: format!("{key}: {}", misread.message),
        help: misread.help,
    })
}

/// The key of the way from the part to where the tool moves freely.
pub(crate) const CLEARANCE: &str = "clearance_mm";

/// Farthest place of a domain, mm or units of a parameter.
const FAR: f64 = 1e5;

/// Reads a domain: from low to high.
pub(crate) fn domain(key: &str, [low, high]: [f64; 2]) -> Result<[f64; 2], Fault> {
    if low.abs() <= FAR && high.abs() <= FAR && high - low >= 1e-3 {
        return Ok([low, high]);
    }
    let message = format!("{key} = [{low}, {high}] is not a domain");
    Err(Fault::new(key, message, format!("give the lowest and the highest {key}, in mm, within ±{FAR}")))
}

/// Reads a range of a parameter, which may fall.
pub(crate) fn parameter(key: &str, [from, to]: [f64; 2]) -> Result<[f64; 2], Fault> {
    if from.abs() <= FAR && to.abs() <= FAR && (to - from).abs() >= 1e-6 {
        return Ok([from, to]);
    }
    let message = format!("{key} = [{from}, {to}] is not a range");
    Err(Fault::new(key, message, format!("give {key} at the start and at the end, within ±{FAR}")))
}
