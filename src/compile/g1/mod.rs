//! Machine code as a program of straight lines: what a control that knows no formulas would need for the same
//! path. In: items, and the machine they are for. Out: lines of RS274/NGC, one at a time, and how many bytes
//! and blocks they are.
//!
//! A trace becomes chords within its chord error: nine tenths of it for the chords, at most one for the
//! rounding of their ends. Arcs become chords within `path.chord_mm`. Corners may be rounded by as much (G64
//! P Q0): where a way bends, what is cut off at the ends of chords lies on the side to which their middles
//! stand off, so both do not add up.
//!
//! Coordinates count from the zero of the formulas. Words that stay are not repeated, zeros at the end not
//! written. A seam turns the part: its blocks have the time they take (G93), and its chord error is that of
//! the beam on the part.

mod chords;
mod header;
#[cfg(test)]
mod tests;
mod write;

use machine::{Kinematics, Machine};
use protocol::{Axis, Code, FORMULAS, Feed, Item, PathMode, PerAxis, Position, Shape, Work, units::AXES};
use route::{Advance, Course, Move, Route, Routed, positioner::geometry};
use shape::Formula;

use chords::{Chords, Measure, Piece};
pub(super) use header::About;
use write::Lines;

/// Share of a chord error that chords take.
const FOR_CHORDS: f64 = 0.9;
/// The rest is for the rounding of their ends.
const FOR_ROUNDING: f64 = 0.1;

/// How large a program is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Size {
    /// Bytes, line ends included.
    pub(crate) bytes: u64,
    /// Blocks: lines that are not only a comment.
    pub(crate) blocks: u64,
}

/// Why there is no program of lines.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum NoLines {
    /// They cannot say what stands there.
    #[error("line {line}: {reason}")]
    Unsaid {
        /// Line of the part program.
        line: u32,
        /// Why.
        reason: String,
    },
    /// The program has changed meanwhile.
    #[error("{0}")]
    Unread(String),
}

/// Says items in straight lines; each line goes to `line`, without its end. What all of them are about goes
/// before.
///
/// # Errors
/// [`NoLines`]: threads have none, nor has a trace that cannot be followed, nor what cannot be read any more.
pub(crate) fn write(
    about: &About,
    items: impl IntoIterator<Item = Result<Item, String>>,
    machine: &Machine,
    line: &mut dyn FnMut(&str),
) -> Result<Size, NoLines> {
    let mut program = Program {
        machine,
        route: Route::new(machine),
        formulas: [Formula::default(); FORMULAS],
        lines: Lines::new(about.zero, machine.axes().map(|(axis, _)| axis).collect(), line),
        at: machine.home(),
        mode: PathMode::within(machine.path.tolerance_mm),
    };
    program.lines.begin(machine.general.kinematics, program.mode);
    for item in items {
        program.item(&item.map_err(NoLines::Unread)?)?;
    }
    Ok(program.lines.size)
}

struct Program<'a> {
    machine: &'a Machine,
    route: Route,
    formulas: [Formula; FORMULAS],
    lines: Lines<'a>,
    /// Where the axes are.
    at: PerAxis<Position>,
    mode: PathMode,
}

impl Program<'_> {
    fn item(&mut self, item: &Item) -> Result<(), NoLines> {
        let refuse = |reason: String| NoLines::Unsaid { line: item.line, reason };
        match &item.code {
            Code::Line { .. } | Code::Arc { .. } | Code::Curve { .. } => self.travel(item).map_err(refuse)?,
            Code::Work(trace) => self.trace(item.line, trace).map_err(refuse)?,
            Code::Pass(_) => return Err(refuse("a pass of a thread is not said in lines".into())),
            Code::Formula { slot, formula } => {
                self.route.set_formula(*slot, *formula);
                if let Some(place) = self.formulas.get_mut(usize::from(*slot)) {
                    *place = *formula;
                }
            }
            Code::PathMode(mode) => {
                self.mode = *mode;
                self.lines.mode(*mode);
            }
            // Without passes it is about nothing.
            Code::Variation(_) => {}
            Code::Dwell { seconds } => self.lines.put(&format!("G4 P{seconds}")),
            Code::Spindle { mode, speed } => self.lines.spindle(*mode, *speed),
            Code::Tool { number } => self.lines.put(&format!("T{number} M6")),
            Code::Coolant { mist, flood } => self.lines.coolant(*mist, *flood),
            Code::Output { number, set, in_step } => self.lines.output(*number, *set, *in_step),
            Code::Await { input, until, within_s } => self.lines.wait(*input, *until, *within_s),
            Code::ByHand(_) => return Err(refuse("work by hand is no program of lines".into())),
            Code::Pause => self.lines.put("M0"),
            Code::OptionalPause => self.lines.put("M1"),
            Code::End => self.lines.put("M2"),
        }
        Ok(())
    }

    /// A move of the program itself.
    fn travel(&mut self, item: &Item) -> Result<(), String> {
        let block = match self.route.block(item.line, &item.code, &self.at) {
            Ok(Routed::Block(block)) => block,
            Ok(Routed::Nowhere) => return Ok(()),
            Ok(Routed::BeyondTravel) => return Err("a move leaves the travel of an axis".into()),
            Err(refused) => return Err(refused.to_string()),
        };
        // Where the axes of another machine stand is not known: what is clear of the part here comes first.
        let clear = if self.machine.general.kinematics == Kinematics::Lathe { Axis::X } else { Axis::Z };
        if block.tag.to[clear.index()] == self.at[clear.index()] {
            self.lines.first(clear, self.at[clear.index()], block.tag.feed);
        }
        let chord_mm = self.machine.path.chord_mm;
        let mut chords = Chords::new(FOR_CHORDS * chord_mm, Measure::Space);
        self.lines.decimals(FOR_ROUNDING * chord_mm);
        self.lines.follow(&mut chords, piece(&block.path, &block.tag), block.tag.feed);
        self.lines.finish(&mut chords, block.tag.feed);
        ends(&chords)?;
        self.at = block.tag.to;
        Ok(())
    }

    /// A trace, block by block of its legs.
    fn trace(&mut self, line: u32, trace: &Work) -> Result<(), String> {
        let mut tracer =
            Course::new(&self.route, line, trace, &self.at).map_err(|error| error.to_string())?;
        let formulas = self.formulas;
        let measure = match (&trace.shape, &self.machine.positioner) {
            (Shape::Seam(seam), Some(config)) => {
                let (positioner, beam) = (geometry(config), config.beam_mm);
                Measure::Beam { seam: seam.on(&formulas, positioner, beam), positioner, beam }
            }
            _ => Measure::Space,
        };
        let mut chords = Chords::new(FOR_CHORDS * trace.chord_mm, measure);
        self.lines.decimals(FOR_ROUNDING * trace.chord_mm);
        self.lines.mode(PathMode::Blend { tolerance_mm: FOR_CHORDS * trace.chord_mm, merge_mm: 0.0 });
        self.lines.timed(matches!(trace.shape, Shape::Seam(_)));
        let mut last = Feed::Rapid;
        loop {
            let block = match tracer.next(&self.route).map_err(|error| error.to_string())? {
                Advance::Block(block) => block,
                Advance::Nowhere => continue,
                Advance::Over => break,
            };
            if block.tag.feed != last {
                self.lines.finish(&mut chords, last);
                last = block.tag.feed;
            }
            self.lines.follow(&mut chords, piece(&block.path, &block.tag), last);
            ends(&chords)?;
            self.at = block.tag.to;
        }
        self.lines.finish(&mut chords, last);
        ends(&chords)?;
        self.lines.timed(false);
        self.lines.mode(self.mode);
        Ok(())
    }
}

/// Refuses a way of which no end is in sight.
fn ends(chords: &Chords) -> Result<(), String> {
    match chords.is_endless() {
        true => Err(format!("that would be more than {} lines: give a larger chord_mm", chords::MOST)),
        false => Ok(()),
    }
}

fn piece(path: &motion::Path<AXES>, leg: &Move) -> Piece {
    let cut = leg.work.and_then(|stretch| stretch.cut);
    Piece { path: *path, from: leg.from.map(Position::mm), clock: cut.map(|cut| cut.clock) }
}
