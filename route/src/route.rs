//! The moves of a program as blocks with paths, feeds and corners. In: lines, arcs, curves to absolute
//! points, path modes. Out: blocks from where the move before ended, or why not.

use machine::Machine;
use motion::Path;
use motion::chain::{self, Block, Corner, Settings};
use protocol::{Axis, Code, Feed, PathMode, PerAxis, Position, Refused, Work, units::AXES};
use shape::{Formula, Plan};

use crate::{
    legs::Legs,
    terms::{Formulas, Move},
};

/// More room than any axis has, mm.
const FARTHEST_MM: f64 = 1e6;

/// What becomes of a move.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // there is one of it at a time, and it must not allocate
pub enum Routed {
    /// A block to plan.
    Block(Block<AXES, Move>),
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
    /// Bit n: nobody knows where axis n is.
    unreferenced: u8,
}

impl Route {
    /// At the start of a program.
    pub fn new(machine: &Machine) -> Route {
        Route {
            machine: machine.clone(),
            mode: PathMode::within(machine.path.tolerance_mm),
            formulas: Formulas::default(),
            unreferenced: 0,
        }
    }

    /// What a chain for this machine is laid out for.
    pub fn settings(machine: &Machine) -> Settings<AXES> {
        Settings { axes: machine.limits(), cycle_s: machine.general.interpolator_cycle_s }
    }

    /// From the next block on.
    pub fn set_mode(&mut self, mode: PathMode) {
        self.mode = mode;
    }

    /// The axes of which nobody knows where they are (bit n: axis n): their travel bounds nothing.
    pub fn set_unreferenced(&mut self, axes: u8) {
        self.unreferenced = axes;
    }

    fn is_known(&self, axis: Axis) -> bool {
        self.unreferenced >> axis.index() & 1 == 0
    }

    /// Whether a point lies within the travel of every axis that is referenced.
    fn can_reach(&self, point: &PerAxis<Position>) -> bool {
        self.machine.axes().all(|(axis, config)| {
            let [low, high] = config.travel_mm;
            !self.is_known(axis) || (low..=high).contains(&point[axis.index()].mm())
        })
    }

    /// What works that follow refer to by this number.
    pub fn set_formula(&mut self, slot: u8, formula: Formula) {
        self.formulas.set(usize::from(slot), formula);
    }

    /// The block of a move from `from`; its corner is that of the mode in force.
    ///
    /// # Errors
    /// The code is no move, or an arc or a curve that cannot be made from there.
    pub fn block(&self, line: u32, code: &Code, from: &PerAxis<Position>) -> Result<Routed, Refused> {
        let (to, feed, path) = match code {
            Code::Line { target, feed } => (target, *feed, self.line(from, target)),
            Code::Arc { arc, feed } => (&arc.target, *feed, Some(arc.path(from)?)),
            Code::Curve { curve, feed } => (&curve.target, *feed, Some(curve.path(from)?)),
            _ => return Err(Refused::OutOfRange("code of a move")),
        };
        let Some(path) = path else { return Ok(Routed::Nowhere) };
        let (room, _) = self.room(from, &path);
        if room < 0.0 || !self.can_reach(to) {
            return Ok(Routed::BeyondTravel);
        }
        let leg = Move { line, from: *from, to: *to, feed, work: None };
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

    /// Travel left beside a path, mm, and the axis that has it; negative beyond it. The quantum of the wire
    /// is not counted, nor what an axis stands beyond its travel already, by a count or because it has sagged
    /// when its brake let go: it may come back.
    pub(crate) fn room(&self, from: &PerAxis<Position>, path: &Path<AXES>) -> (f64, Axis) {
        let [low, high] = path.bounds();
        let known = self.machine.axes().filter(|(axis, _)| self.is_known(*axis));
        known.fold((FARTHEST_MM, Axis::X), |narrowest, (axis, config)| {
            let (i, [lowest, highest]) = (axis.index(), config.travel_mm);
            let here = from[i].mm();
            let (lowest, highest) = (lowest.min(here), highest.max(here));
            let beside = (here + low[i] - lowest).min(highest - here - high[i]);
            let beside = if beside < 0.0 && beside > -2.0 / Position::PER_MM { 0.0 } else { beside };
            if beside < narrowest.0 { (beside, axis) } else { narrowest }
        })
    }

    /// Where the axes are led in a step whose exact end is `to`: the one of the largest way goes there, the
    /// others follow in the ratios of the correction (M36–M43) from the exact start `from`, at the parameter
    /// `t` of a plan. Exactly, where the start is not on the path itself: in a corner that is rounded.
    pub fn led(
        &self,
        work: &Work,
        (plan, t): (&Plan, f64),
        from: &PerAxis<Position>,
        to: &PerAxis<Position>,
    ) -> PerAxis<Position> {
        let Some(step) = work.step((plan, t), &self.formulas, &self.machine, from, to) else { return *to };
        let mut led = *to;
        for (axis, way) in work.axes().iter().zip(step) {
            led[axis.index()] = from[axis.index()].moved(way);
        }
        led
    }

    fn corner(&self) -> Corner {
        match self.mode {
            PathMode::ExactStop => Corner::Stop,
            PathMode::Blend { tolerance_mm, merge_mm } if tolerance_mm > self.machine.path.exact_mm => {
                let flat = tolerance_mm + merge_mm - self.mode.merges_within_mm();
                Corner::Curve { corner: tolerance_mm, flat, tip: merge_mm }
            }
            PathMode::ExactPath | PathMode::Blend { .. } => Corner::Exact(self.machine.path.exact_mm),
        }
    }

    /// The corner of the mode in force, rounded within so many mm at most.
    pub(crate) fn corner_within(&self, mm: f64) -> Corner {
        self.corner().at_most(mm)
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
