//! From machine code to what a chain plans: the moves of a program as blocks with paths, feeds and corners.
//! In: lines and arcs to absolute points, path modes. Out: blocks from where the move before ended, or why not.
//!
//! The interpolator moves along these blocks, and the interpreter foretells how long that takes: both ask here, so that
//! they mean the same path.

use motion::Path;
use motion::chain::{self, Block, Corner, Settings};
use shape::{Clock, Formula, Plan};

use crate::track::Formulas;
use crate::{Axis, Code, Feed, Machine, PathMode, PerAxis, Position, Refused, units::AXES};

/// Where a block lies on the machine, and whence in the program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leg {
    /// Line of the part program.
    pub line: u32,
    /// Absolute start of every axis.
    pub from: PerAxis<Position>,
    /// Absolute end.
    pub to: PerAxis<Position>,
    /// How fast.
    pub feed: Feed,
    /// What it is of a trace; nothing for moves of the program.
    pub trace: Option<Stretch>,
}

/// A part of a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Number of the trace: that of its [`Tracer`](crate::Tracer).
    pub number: u32,
    /// Share of the trace that is done where it begins, 0 to 1.
    pub share: f64,
    /// What the tool cuts there, or the beam; nothing on the way from one path to the next.
    pub cut: Option<Cut>,
}

/// A piece of a leg of a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// The leg, seen from above.
    pub plan: Plan,
    /// Its parameter along the piece.
    pub clock: Clock,
}

/// What becomes of a move.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // there is one of it at a time, and it must not allocate
pub enum Routed {
    /// A block to plan.
    Block(Block<AXES, Leg>),
    /// It goes nowhere.
    Nowhere,
    /// It leaves the travel of an axis.
    BeyondTravel,
}

/// The path mode in force on a machine.
#[derive(Clone, Debug)]
pub struct Route {
    pub(crate) machine: Machine,
    mode: PathMode,
    pub(crate) formulas: Formulas,
}

impl Route {
    /// At the start of a program.
    pub fn new(machine: &Machine) -> Route {
        Route {
            machine: machine.clone(),
            mode: PathMode::within(machine.path.tolerance_mm),
            formulas: Formulas::default(),
        }
    }

    /// What a chain for this machine is laid out for.
    pub fn settings(machine: &Machine) -> Settings<AXES> {
        Settings { axes: machine.limits(), cycle_s: machine.machine.interpolator_cycle_s }
    }

    /// From the next block on.
    pub fn set_mode(&mut self, mode: PathMode) {
        self.mode = mode;
    }

    /// What traces that follow refer to by this number.
    pub fn set_formula(&mut self, slot: u8, formula: Formula) {
        self.formulas.set(usize::from(slot), formula);
    }

    /// The block of a move from `from`; its corner is that of the mode in force.
    ///
    /// # Errors
    /// The code is no move, or an arc that cannot be made from there.
    pub fn block(&self, line: u32, code: &Code, from: &PerAxis<Position>) -> Result<Routed, Refused> {
        let (to, feed, path) = match code {
            Code::Line { target, feed } => (target, *feed, self.line(from, target)),
            Code::Arc { arc, feed } => (&arc.target, *feed, Some(arc.path(from)?)),
            _ => return Err(Refused::OutOfRange("code of a move")),
        };
        let Some(path) = path else { return Ok(Routed::Nowhere) };
        let (room, _) = self.room(from, &path);
        if room < 0.0 || !self.machine.can_reach(to) {
            return Ok(Routed::BeyondTravel);
        }
        let leg = Leg { line, from: *from, to: *to, feed, trace: None };
        let (feed, corner, chord_mm) = (self.feed(feed), self.corner(), self.machine.path.chord_mm);
        Ok(Routed::Block(Block { path, feed, corner, room, chord_mm, tag: leg }))
    }

    pub(crate) fn line(&self, from: &PerAxis<Position>, to: &PerAxis<Position>) -> Option<Path<AXES>> {
        let mut displacement = [0.0; AXES];
        for (axis, _) in self.machine.axes() {
            displacement[axis.index()] = to[axis.index()].mm_from(from[axis.index()]);
        }
        Path::line(displacement, &Axis::METRIC)
    }

    /// Travel left beside a path, mm, and the axis that has it; negative beyond it. The quantum of the wire is not counted.
    pub(crate) fn room(&self, from: &PerAxis<Position>, path: &Path<AXES>) -> (f64, Axis) {
        let [low, high] = path.bounds();
        self.machine.axes().fold((f64::INFINITY, Axis::X), |narrowest, (axis, config)| {
            let (i, [lowest, highest]) = (axis.index(), config.travel_mm);
            let beside = (from[i].mm() + low[i] - lowest).min(highest - from[i].mm() - high[i]);
            let beside = if beside < 0.0 && beside > -2.0 / Position::PER_MM { 0.0 } else { beside };
            if beside < narrowest.0 { (beside, axis) } else { narrowest }
        })
    }

    fn corner(&self) -> Corner {
        match self.mode {
            PathMode::ExactStop => Corner::Stop,
            PathMode::Blend { tolerance_mm, .. } if tolerance_mm > self.machine.path.exact_mm => {
                Corner::Blend(tolerance_mm)
            }
            PathMode::ExactPath | PathMode::Blend { .. } => Corner::Exact(self.machine.path.exact_mm),
        }
    }

    /// The corner of the mode in force, rounded within so many mm at most.
    pub(crate) fn corner_within(&self, mm: f64) -> Corner {
        match self.corner() {
            Corner::Blend(tolerance_mm) => Corner::Blend(tolerance_mm.min(mm)),
            corner => corner,
        }
    }

    pub(crate) fn feed(&self, feed: Feed) -> chain::Feed {
        match feed {
            Feed::Rapid => chain::Feed::Rapid,
            Feed::PerMinute(feed) => chain::Feed::PerSecond((feed / 60.0).max(chain::LEAST_FEED)),
            Feed::PerRevolution(feed) => {
                let spindle = &self.machine.spindle;
                let turns = spindle.max_rpm / 60.0 * spindle.override_max_pct / 100.0;
                chain::Feed::PerRevolution(feed, chain::MOST_RATIO * feed * turns)
            }
        }
    }
}

impl Leg {
    /// Whether two moves can be one chain: overrides act on both alike.
    pub fn joins(&self, other: &Leg) -> bool {
        std::mem::discriminant(&self.feed) == std::mem::discriminant(&other.feed)
    }
}
