//! From a trace to blocks: its legs one after the other, each of them piece by piece.
//! In: a trace, where the axes rest, the route with the formulas. Out: a block at each call, or why there is none, and where.
//!
//! | stage | leads | how |
//! |---|---|---|
//! | `Enter` | from where the axes rest to the start, if they are not quite there | straight, at feed |
//! | `Cut` | along a leg | pieces of its curve |
//! | `Lift`, `Cross`, `Plunge` | off the surface, to the start of the next leg | straight: rapid, rapid, at feed |
//!
//! Every piece begins and ends where its curve is in coordinates of the machine, so nothing adds up. A call tries one piece
//! and allocates nothing. The formulas are those of the [`Route`], which do not change while axes move.

use motion::Path;
use motion::chain::{Block, Corner};
use shape::{Curve, Plan, Span, SpanError, Walked, Walker};

use crate::{Axis, Cut, Feed, Leg, PerAxis, Position, Route, Spot, Stretch, Trace, Work, units::AXES};

/// Farthest the axes may be from the start of a trace and still be led there, mm.
const START_REACH_MM: f64 = 0.01;
/// Nearer than this they are there: two ways to one number may differ by so much, mm.
const THERE_MM: f64 = 1e-8;

/// Why a trace cannot be followed, and where.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Untraceable {
    /// A formula that it refers to was not given.
    #[error("formula {0} is missing: it has to come before the trace")]
    NoFormula(usize),
    /// The machine lacks an axis.
    #[error("the machine has no axis {0}: choose a machine that has it, or a plane without it")]
    NoAxis(Axis),
    /// The machine is no positioner.
    #[error("the machine is not a positioner: choose a machine file with kinematics = \"positioner\"")]
    NoPositioner,
    /// The axes stand elsewhere.
    #[error("{axis} stands {mm:.6} from the start of the path: move the axes there first")]
    NotAtStart {
        /// The farthest axis.
        axis: Axis,
        /// How far, mm or degrees.
        mm: f64,
    },
    /// The path is not defined there, or not smooth.
    #[error("{1}: {0}")]
    NoPath(SpanError, Spot),
    /// A piece that begins there leaves the travel of an axis.
    #[error(
        "the path leaves the travel of {0} near {1}: move the zero of the workpiece, or end the path earlier"
    )]
    BeyondTravel(Axis, Spot),
    /// A retract would end below the tool, or below the start of the next leg.
    #[error("the clearance is {mm:.4} mm below the path at {spot}: raise it above the surface")]
    TooLow {
        /// The end of the leg, or the start of the next one.
        spot: Spot,
        /// How far, mm.
        mm: f64,
    },
}

/// What a call of [`Tracer::next`] brought.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // there is one of it at a time, and it must not allocate
pub enum Traced {
    /// A block to plan.
    Block(Block<AXES, Leg>),
    /// Nothing yet: a stage that leads nowhere, or a piece that has to be shorter.
    Nowhere,
    /// The trace is over.
    Over,
}

/// A trace on its way to blocks.
#[derive(Clone, Copy, Debug)]
pub struct Tracer {
    number: u32,
    line: u32,
    trace: Trace,
    /// The leg in hand, from 0, and how many there are.
    leg: u32,
    legs: u32,
    stage: Stage,
    /// End of the last block.
    at: PerAxis<Position>,
}

#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // there is one of it, and it must not allocate
enum Stage {
    Enter,
    Cut(Plan, Walker<AXES>),
    Lift,
    Cross,
    Plunge,
    Over,
}

impl Tracer {
    /// A trace from where the axes rest. Its number is 0.
    ///
    /// # Errors
    /// [`Untraceable`], if it cannot begin there.
    pub fn new(
        route: &Route,
        line: u32,
        trace: &Trace,
        from: &PerAxis<Position>,
    ) -> Result<Tracer, Untraceable> {
        if let Some(axis) = trace.axes().iter().find(|axis| !route.machine.axis.contains_key(axis)) {
            return Err(Untraceable::NoAxis(*axis));
        }
        let legs = trace.legs();
        let mut tracer =
            Tracer { number: 0, line, trace: *trace, leg: 0, legs, stage: Stage::Enter, at: *from };
        let start = tracer.start(route)?;
        let off = |axis: &Axis| (*axis, start[axis.index()].mm_from(from[axis.index()]).abs());
        let farthest = trace.axes().iter().map(off).max_by(|a, b| a.1.total_cmp(&b.1));
        let (axis, mm) = farthest.unwrap_or((Axis::X, 0.0));
        if mm > START_REACH_MM {
            return Err(Untraceable::NotAtStart { axis, mm });
        }
        if mm <= THERE_MM {
            (tracer.at, tracer.stage) = (start, tracer.stage_of_leg());
        }
        Ok(tracer)
    }

    /// The same by a number, which its blocks carry.
    #[must_use]
    pub fn numbered(self, number: u32) -> Tracer {
        Tracer { number, ..self }
    }

    /// Whether it goes on where a trace before it ends, without a stop: seams do, which begin there.
    pub fn goes_on(&self, before: &Trace) -> bool {
        let seams = matches!((&before.work, &self.trace.work), (Work::Seam(_), Work::Seam(_)));
        seams && matches!(self.stage, Stage::Cut(..))
    }

    /// Where the trace ends. Only its last leg is followed: the others do not change that.
    ///
    /// # Errors
    /// [`Untraceable`], on that leg.
    pub fn end(mut self, route: &Route) -> Result<PerAxis<Position>, Untraceable> {
        self.leg = self.legs.saturating_sub(1);
        (self.at, self.stage) = (self.start(route)?, self.stage_of_leg());
        while !matches!(self.next(route)?, Traced::Over) {}
        Ok(self.at)
    }

    /// What it follows.
    pub fn trace(&self) -> &Trace {
        &self.trace
    }

    /// The next block, if one try brings it: at most five evaluations of the curve. After an error it is the same again.
    ///
    /// # Errors
    /// [`Untraceable`].
    pub fn next(&mut self, route: &Route) -> Result<Traced, Untraceable> {
        let mut next = *self;
        let traced = next.go_on(route)?;
        *self = next;
        Ok(traced)
    }

    fn go_on(&mut self, route: &Route) -> Result<Traced, Untraceable> {
        let z = Axis::Z.index();
        match self.stage {
            Stage::Over => Ok(Traced::Over),
            Stage::Cut(plan, walker) => self.piece(route, plan, walker),
            Stage::Lift => {
                let mut above = self.at;
                above[z] = self.clear(route)?;
                self.stage = Stage::Cross;
                self.straight(route, above, Feed::Rapid)
            }
            Stage::Cross => {
                // The leg behind this one is where the tool goes.
                self.leg += 1;
                let mut above = self.start(route)?;
                above[z] = self.at[z];
                self.stage = Stage::Plunge;
                self.straight(route, above, Feed::Rapid)
            }
            Stage::Enter | Stage::Plunge => {
                let start = self.start(route)?;
                self.stage = self.stage_of_leg();
                self.straight(route, start, Feed::PerMinute(self.trace.feed_mm_min))
            }
        }
    }

    /// Machine Z at which the tool crosses from one leg to the next; it has to be above both.
    fn clear(&self, route: &Route) -> Result<Position, Untraceable> {
        let z = Axis::Z.index();
        let next = Tracer { leg: self.leg + 1, ..*self };
        let (from, to) = (self.at[z], next.start(route)?[z]);
        let clear = self.trace.clear().unwrap_or(from);
        for (leg, end, at) in [(self.leg.saturating_sub(1), 1, from), (next.leg, 0, to)] {
            let mm = at.mm_from(clear);
            if mm > 0.0 {
                return Err(Untraceable::TooLow { spot: self.spot(leg, end), mm });
            }
        }
        Ok(clear)
    }

    /// Where a leg that cuts starts (0) or ends (1).
    fn spot(&self, leg: u32, end: usize) -> Spot {
        self.plan(leg).map_or(Spot::Parameter(0.0), |plan| self.trace.spot(&plan, plan.t()[end.min(1)]))
    }

    /// A straight block, or none if it leads nowhere.
    fn straight(&mut self, route: &Route, to: PerAxis<Position>, feed: Feed) -> Result<Traced, Untraceable> {
        let Some(path) = route.line(&self.at, &to) else { return Ok(Traced::Nowhere) };
        let stretch = Stretch { number: self.number, share: self.share(0.0), cut: None };
        self.block(route, path, to, (feed, Corner::Stop), stretch, self.spot(self.leg, 0))
    }

    /// One try of the next piece of the leg in hand; none behind its last.
    fn piece(&mut self, route: &Route, plan: Plan, mut walker: Walker<AXES>) -> Result<Traced, Untraceable> {
        let trace = self.trace;
        let no_path = |error: SpanError| Untraceable::NoPath(error, trace.spot(&plan, error.t()));
        let track = trace.track(plan, &route.formulas, &route.machine)?;
        let walked = walker.attempt(&track).map_err(no_path)?;
        self.stage = Stage::Cut(plan, walker);
        let Span { path, t: [t, next], to, clock, .. } = match walked {
            Walked::Piece(span) => span,
            Walked::Shorter => return Ok(Traced::Nowhere),
            Walked::Over => {
                self.leg += 1;
                self.stage = self.stage_of_leg();
                return Ok(Traced::Nowhere);
            }
        };
        let [begin, end] = plan.t();
        let corner = if next == end { self.joint(route) } else { Corner::Exact(route.machine.path.exact_mm) };
        let stretch = Stretch {
            number: self.number,
            share: self.share((t - begin) / (end - begin)),
            cut: Some(Cut { plan, clock }),
        };
        let (to, how) = (trace.placed(&to, self.at), (Feed::PerMinute(trace.feed_mm_min), corner));
        self.block(route, path, to, how, stretch, trace.spot(&plan, t))
    }

    /// A block from the end of the last one.
    fn block(
        &mut self,
        route: &Route,
        path: Path<AXES>,
        to: PerAxis<Position>,
        (feed, corner): (Feed, Corner),
        stretch: Stretch,
        spot: Spot,
    ) -> Result<Traced, Untraceable> {
        let (room, axis) = route.room(&self.at, &path);
        if room < 0.0 {
            return Err(Untraceable::BeyondTravel(axis, spot));
        }
        let tag = Leg { line: self.line, from: self.at, to, feed, trace: Some(stretch) };
        self.at = to;
        let chord_mm = self.trace.chord_of_steps();
        Ok(Traced::Block(Block { path, feed: route.feed(feed), corner, room, chord_mm, tag }))
    }

    /// How the leg in hand begins.
    fn stage_of_leg(&self) -> Stage {
        match self.trace.leg(self.leg) {
            None => Stage::Over,
            Some(shape::Leg::Cut(plan)) => {
                Stage::Cut(plan, Walker::new(plan.t()).standing(self.at.map(Position::mm)))
            }
            Some(shape::Leg::Air { .. }) => Stage::Lift,
        }
    }

    /// What becomes of the end of the leg in hand: legs that meet on the surface do so within the chord error, and
    /// so do seams.
    fn joint(&self, route: &Route) -> Corner {
        match self.plan(self.leg + 1) {
            Some(_) => route.corner_within(self.trace.chord_mm),
            None if matches!(self.trace.work, Work::Seam(_)) => route.corner_within(self.trace.chord_mm),
            None => Corner::Stop,
        }
    }

    /// A leg that cuts.
    fn plan(&self, leg: u32) -> Option<Plan> {
        match self.trace.leg(leg) {
            Some(shape::Leg::Cut(plan)) => Some(plan),
            _ => None,
        }
    }

    /// Start of the leg in hand, by the turns of rotary axes that are nearest to where they are.
    fn start(&self, route: &Route) -> Result<PerAxis<Position>, Untraceable> {
        let Some(plan) = self.plan(self.leg) else { return Ok(self.at) };
        let [t, _] = plan.t();
        let track = self.trace.track(plan, &route.formulas, &route.machine)?;
        let axes = track.near(t, &self.at.map(Position::mm)).axes.map(|axis| axis.value());
        if !axes.iter().all(|axis| axis.is_finite()) {
            return Err(Untraceable::NoPath(SpanError::NotFinite { t }, self.trace.spot(&plan, t)));
        }
        Ok(self.trace.placed(&axes, self.at))
    }

    /// The share of the trace that is done where `part` of the leg in hand is.
    fn share(&self, part: f64) -> f64 {
        (f64::from(self.leg) + part) / f64::from(self.legs.max(1))
    }
}
