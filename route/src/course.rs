//! From a work to blocks: its legs one after the other, each of them piece by piece. In: a work, where the
//! axes rest, the route with the formulas. Out: a block at each call, or why there is none, and where.
//!
//! | stage | leads | how |
//! |---|---|---|
//! | `Enter` | from where the axes rest to the start, if they are not quite there | straight, at feed |
//! | `Cut` | along a leg | pieces of its curve |
//! | `Lift`, `Cross`, `Plunge` | off the surface, to the start of the next leg | straight: rapid, rapid, at feed |
//!
//! Every piece begins and ends where its curve is in coordinates of the machine, so nothing adds up. A call
//! tries one piece and allocates nothing. The formulas are those of the [`Route`], which do not change while
//! axes move.

use motion::Path;
use motion::chain::{Block, Corner};
use protocol::{Axis, Feed, PerAxis, Position, Shape, Work, units::AXES};
use shape::{Curve, Piece, PieceError, Plan, Walked, Walker};

use crate::{
    legs::Legs,
    route::Route,
    terms::{Cut, Move, Spot, Stretch, Unworkable},
};

/// Farthest the axes may be from the start of a work and still be led there, mm.
pub const START_REACH_MM: f64 = 0.01;
/// Nearer than this they are there: two ways to one number may differ by so much, mm.
const THERE_MM: f64 = 1e-8;

/// What a call of [`Course::next`] brought.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // there is one of it at a time, and it must not allocate
pub enum Advance {
    /// A block to plan.
    Block(Block<AXES, Move>),
    /// Nothing yet: a stage that leads nowhere, or a piece that has to be shorter.
    Nowhere,
    /// The work is over.
    Over,
}

/// A work on its way to blocks.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    number: u32,
    line: u32,
    work: Work,
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

impl Course {
    /// A work from where the axes rest. Its number is 0.
    ///
    /// # Errors
    /// [`Unworkable`], if it cannot begin there.
    pub fn new(
        route: &Route,
        line: u32,
        work: &Work,
        from: &PerAxis<Position>,
    ) -> Result<Course, Unworkable> {
        if let Some(axis) = work.axes().iter().find(|axis| !route.machine.axis.contains_key(axis)) {
            return Err(Unworkable::NoAxis(*axis));
        }
        let legs = work.legs();
        let mut tracer =
            Course { number: 0, line, work: *work, leg: 0, legs, stage: Stage::Enter, at: *from };
        let start = tracer.start(route)?;
        let off = |axis: &Axis| (*axis, start[axis.index()].mm_from(from[axis.index()]).abs());
        let farthest = work.axes().iter().map(off).max_by(|a, b| a.1.total_cmp(&b.1));
        let (axis, mm) = farthest.unwrap_or((Axis::X, 0.0));
        if mm > START_REACH_MM {
            return Err(Unworkable::NotAtStart { axis, mm });
        }
        if mm <= THERE_MM {
            (tracer.at, tracer.stage) = (start, tracer.stage_of_leg());
        }
        Ok(tracer)
    }

    /// The same by a number, which its blocks carry.
    #[must_use]
    pub fn numbered(self, number: u32) -> Course {
        Course { number, ..self }
    }

    /// Whether it goes on where a work before it ends, without a stop: seams do, which begin there.
    pub fn goes_on(&self, before: &Work) -> bool {
        let seams = matches!((&before.shape, &self.work.shape), (Shape::Seam(_), Shape::Seam(_)));
        seams && matches!(self.stage, Stage::Cut(..))
    }

    /// Where the work ends. Only its last leg is followed: the others do not change that.
    ///
    /// # Errors
    /// [`Unworkable`], on that leg.
    pub fn end(mut self, route: &Route) -> Result<PerAxis<Position>, Unworkable> {
        self.leg = self.legs.saturating_sub(1);
        (self.at, self.stage) = (self.start(route)?, self.stage_of_leg());
        while !matches!(self.next(route)?, Advance::Over) {}
        Ok(self.at)
    }

    /// What it follows.
    pub fn work(&self) -> &Work {
        &self.work
    }

    /// The next block, if one try brings it: at most five evaluations of the curve. After an error it is the
    /// same again.
    ///
    /// # Errors
    /// [`Unworkable`].
    pub fn next(&mut self, route: &Route) -> Result<Advance, Unworkable> {
        let mut next = *self;
        let traced = next.go_on(route)?;
        *self = next;
        Ok(traced)
    }

    fn go_on(&mut self, route: &Route) -> Result<Advance, Unworkable> {
        let z = Axis::Z.index();
        match self.stage {
            Stage::Over => Ok(Advance::Over),
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
                self.straight(route, start, Feed::PerMinute(self.work.feed_mm_min))
            }
        }
    }

    /// Machine Z at which the tool crosses from one leg to the next; it has to be above both.
    fn clear(&self, route: &Route) -> Result<Position, Unworkable> {
        let z = Axis::Z.index();
        let next = Course { leg: self.leg + 1, ..*self };
        let (from, to) = (self.at[z], next.start(route)?[z]);
        let clear = self.work.clear().unwrap_or(from);
        for (leg, end, at) in [(self.leg.saturating_sub(1), 1, from), (next.leg, 0, to)] {
            let mm = at.mm_from(clear);
            if mm > 0.0 {
                return Err(Unworkable::TooLow { spot: self.spot(leg, end), mm });
            }
        }
        Ok(clear)
    }

    /// Where a leg that cuts starts (0) or ends (1).
    fn spot(&self, leg: u32, end: usize) -> Spot {
        self.plan(leg).map_or(Spot::Parameter(0.0), |plan| self.work.spot(&plan, plan.t()[end.min(1)]))
    }

    /// A straight block, or none if it leads nowhere.
    fn straight(&mut self, route: &Route, to: PerAxis<Position>, feed: Feed) -> Result<Advance, Unworkable> {
        let Some(path) = route.line(&self.at, &to) else { return Ok(Advance::Nowhere) };
        let stretch = Stretch { number: self.number, share: self.share(0.0), cut: None };
        self.block(route, path, to, (feed, Corner::Stop), stretch, self.spot(self.leg, 0))
    }

    /// One try of the next piece of the leg in hand; none behind its last.
    fn piece(&mut self, route: &Route, plan: Plan, mut walker: Walker<AXES>) -> Result<Advance, Unworkable> {
        let work = self.work;
        let no_path = |error: PieceError| Unworkable::NoPath { error, spot: work.spot(&plan, error.t()) };
        let curve = work.curve(plan, &route.formulas, &route.machine)?;
        let walked = walker.attempt(&curve).map_err(no_path)?;
        self.stage = Stage::Cut(plan, walker);
        let Piece { path, t: [t, next], to, clock, .. } = match walked {
            Walked::Piece(piece) => piece,
            Walked::Shorter => return Ok(Advance::Nowhere),
            Walked::Over => {
                self.leg += 1;
                self.stage = self.stage_of_leg();
                return Ok(Advance::Nowhere);
            }
        };
        let [begin, end] = plan.t();
        let corner = if next == end { self.joint(route) } else { Corner::Exact(route.machine.path.exact_mm) };
        let stretch = Stretch {
            number: self.number,
            share: self.share((t - begin) / (end - begin)),
            cut: Some(Cut { plan, clock }),
        };
        let (to, how) = (work.placed(&to, self.at), (Feed::PerMinute(work.feed_mm_min), corner));
        self.block(route, path, to, how, stretch, work.spot(&plan, t))
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
    ) -> Result<Advance, Unworkable> {
        let (room, axis) = route.room(&self.at, &path);
        if room < 0.0 {
            return Err(Unworkable::BeyondTravel { axis, spot });
        }
        let tag = Move { line: self.line, from: self.at, to, feed, work: Some(stretch) };
        self.at = to;
        let chord_mm = self.work.chord_of_steps();
        Ok(Advance::Block(Block { path, feed: route.feed(feed), corner, room, chord_mm, tag }))
    }

    /// How the leg in hand begins.
    fn stage_of_leg(&self) -> Stage {
        match self.work.leg(self.leg) {
            None => Stage::Over,
            Some(shape::Leg::Cut(plan)) => {
                Stage::Cut(plan, Walker::new(plan.t()).standing(self.at.map(Position::mm)))
            }
            Some(shape::Leg::Air { .. }) => Stage::Lift,
        }
    }

    /// What becomes of the end of the leg in hand: legs that meet on the surface do so within the chord
    /// error, and so do seams.
    fn joint(&self, route: &Route) -> Corner {
        match self.plan(self.leg + 1) {
            Some(_) => route.corner_within(self.work.chord_mm),
            None if matches!(self.work.shape, Shape::Seam(_)) => route.corner_within(self.work.chord_mm),
            None => Corner::Stop,
        }
    }

    /// A leg that cuts.
    fn plan(&self, leg: u32) -> Option<Plan> {
        match self.work.leg(leg) {
            Some(shape::Leg::Cut(plan)) => Some(plan),
            _ => None,
        }
    }

    /// Start of the leg in hand, by the turns of rotary axes that are nearest to where they are.
    fn start(&self, route: &Route) -> Result<PerAxis<Position>, Unworkable> {
        let Some(plan) = self.plan(self.leg) else { return Ok(self.at) };
        let [t, _] = plan.t();
        let curve = self.work.curve(plan, &route.formulas, &route.machine)?;
        let axes = curve.near(t, &self.at.map(Position::mm)).axes.map(|axis| axis.value());
        if !axes.iter().all(|axis| axis.is_finite()) {
            return Err(Unworkable::NoPath {
                error: PieceError::NotFinite { t },
                spot: self.work.spot(&plan, t),
            });
        }
        Ok(self.work.placed(&axes, self.at))
    }

    /// The share of the work that is done where `part` of the leg in hand is.
    fn share(&self, part: f64) -> f64 {
        (f64::from(self.leg) + part) / f64::from(self.legs.max(1))
    }
}
