//! A work in hand: its pieces go into the chain as it makes room, ahead of the axes.
//!
//! A work may take several chains: where the tool leaves a surface another override acts. It is one block of
//! the program all the same: single block waits at its end, and it counts as one move. Seams that follow each
//! other where they meet are one path, without a stop between them, unless single block is on when the end of
//! the first is drawn.
//!
//! Where a correction leads the followers (M36–M43), a setpoint is the exact one of the tick before and the
//! step of the ratios. What they leave of the step does not add up, and the steps are so short that it stays
//! within the chord error (M44); speeds and accelerations are those of the path. At rest there is no step, so
//! a work ends where it should.

use motion::chain::Block;
use protocol::{Code, Fault, Item, PerAxis, Position, Work, units::AXES};
use route::{Advance, Course, Move, Route, Stretch, Unworkable};
use shape::{Correction, Plan};

use crate::{queue::Queue, run::Run};

/// Most tries of pieces in one tick, each of at most five evaluations of the curve: that bounds the work of
/// the tick. As a rule a try is a piece. It is about as long as a third of the radius of its curve (M84), and
/// the axes need more than a tick for so small a part of a bend that they can follow: so the pieces keep
/// ahead of them. Where they do not, the axes stop on the path and set off again.
const TRIES_PER_TICK: usize = 6;

/// The work in hand, or none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Working {
    /// Works that were begun to be drawn so far.
    drawn: u32,
    /// What of the last of them is to be drawn yet.
    course: Option<Course>,
    /// A block that was drawn and begins the next run.
    ahead: Option<Block<AXES, Move>>,
    /// Number of the work in which the axes are, and the share of it that is done; nothing if no work is in
    /// hand.
    here: Option<(u32, f64)>,
    /// The number of the work, if the setpoints of this tick cut; else 0.
    cutting: u32,
    /// A work whose followers are led by ratios,
    led: Option<Work>,
    /// and where it was cut in the tick before: exact positions, and the parameter of the leg.
    before: Option<(PerAxis<Position>, Plan, f64)>,
}

impl Working {
    /// A work is next, or goes on behind a run.
    ///
    /// # Errors
    /// The fault, if it cannot begin at `here`.
    pub(crate) fn begin(
        &mut self,
        route: &Route,
        line: u32,
        work: &Work,
        here: &PerAxis<Position>,
    ) -> Result<(), Fault> {
        if self.in_hand() {
            return Ok(());
        }
        let number = self.drawn + 1;
        let course = Course::new(route, line, work, here).map_err(|reason| fault(&reason))?;
        let led = (work.correction != Correction::Exact).then_some(*work);
        let (course, here) = (Some(course.numbered(number)), Some((number, 0.0)));
        *self = Working { drawn: number, course, here, led, ..Working::default() };
        Ok(())
    }

    /// Whether a work is in hand.
    pub(crate) fn in_hand(&self) -> bool {
        self.here.is_some()
    }

    /// Whether there is more of it than the run holds.
    pub(crate) fn more(&self) -> bool {
        self.course.is_some()
    }

    /// The number of the work that the setpoints of this tick cut, or 0.
    pub(crate) fn cutting(&self) -> u32 {
        self.cutting
    }

    /// A tick begins: nothing is cut in it yet.
    pub(crate) fn idle(&mut self) {
        self.cutting = 0;
    }

    /// Steps of progress that are left of the works in hand.
    pub(crate) fn left(&self) -> Option<u64> {
        let (number, done) = self.here?;
        let behind = u64::from(self.drawn.saturating_sub(number));
        Some((behind + 1) * Work::STEPS - ((done * Work::STEPS as f64) as u64).min(Work::STEPS))
    }

    /// The setpoints of this tick lie in a block; how many works that completes.
    pub(crate) fn step(&mut self, leg: &Move) -> u64 {
        let Some(Stretch { number, share, cut }) = leg.work else { return 0 };
        let (before, _) = self.here.replace((number, share)).unwrap_or((number, 0.0));
        self.cutting = if cut.is_some() { number } else { 0 };
        u64::from(number.saturating_sub(before))
    }

    /// Where the axes are led in this tick: with ratios, from where they should have been in the tick before.
    /// `exact` is where they should be now, `s` mm along a block.
    pub(crate) fn lead(
        &mut self,
        route: &Route,
        leg: &Move,
        s: f64,
        exact: PerAxis<Position>,
    ) -> PerAxis<Position> {
        let before = self.before.take();
        let (Some(work), Some(cut)) = (self.led, leg.work.and_then(|stretch| stretch.cut)) else {
            return exact;
        };
        self.before = Some((exact, cut.plan, cut.clock.parameter(s)));
        before.map_or(exact, |(from, plan, t)| route.led(&work, (&plan, t), &from, &exact))
    }

    /// Takes pieces for as long as they belong to the run; with `single` block it ends with the work.
    ///
    /// # Errors
    /// The fault, if the path cannot go on and no move is left that leads there.
    pub(crate) fn fill(
        &mut self,
        run: &mut Run,
        route: &Route,
        queue: &mut Queue,
        single: bool,
    ) -> Result<(), Fault> {
        for _ in 0..TRIES_PER_TICK {
            if !run.has_room() {
                return Ok(());
            }
            let Some(block) = self.draw(run, route, queue, single)? else { continue };
            if !run.push(block) {
                self.ahead = Some(block);
                return Ok(());
            }
        }
        Ok(())
    }

    /// The next block of the work, if there is one. Behind its last one, and before one that cannot be, the
    /// run ends.
    fn draw(
        &mut self,
        run: &mut Run,
        route: &Route,
        queue: &mut Queue,
        single: bool,
    ) -> Result<Option<Block<AXES, Move>>, Fault> {
        if let Some(block) = self.ahead.take() {
            return Ok(Some(block));
        }
        let Some(course) = &mut self.course else { return Ok(None) };
        match course.next(route) {
            Ok(Advance::Block(block)) => return Ok(Some(block)),
            Ok(Advance::Nowhere) => {}
            Ok(Advance::Over) => self.draw_next(run, route, queue, single),
            Err(reason) if run.is_new() => return Err(fault(&reason)),
            Err(_) => run.close(),
        }
        Ok(None)
    }

    /// A work has been drawn: the next item goes on as its own, or ends the run.
    fn draw_next(&mut self, run: &mut Run, route: &Route, queue: &mut Queue, single: bool) {
        queue.done();
        let next = queue.head();
        let before = self.course.take();
        if let (Some(Item { line, code: Code::Work(work) }), Some(before), Some(last)) =
            (&next, before, run.last())
            && !single
            && let Ok(course) = Course::new(route, *line, work, &last.to)
            && course.goes_on(before.work())
        {
            (self.drawn, self.course) = (self.drawn + 1, Some(course.numbered(self.drawn + 1)));
        } else {
            run.close();
        }
    }

    /// A run is over: whether that ends the work in hand.
    pub(crate) fn end_if_drawn(&mut self) -> bool {
        let drawn = self.in_hand() && !self.more() && self.ahead.is_none();
        if drawn {
            self.end();
        }
        drawn
    }

    /// Forgets the work in hand.
    pub(crate) fn end(&mut self) {
        (self.course, self.ahead, self.here) = (None, None, None);
        (self.led, self.before) = (None, None);
    }
}

/// The fault that a reason becomes.
fn fault(reason: &Unworkable) -> Fault {
    match reason {
        Unworkable::BeyondTravel { .. } => Fault::TravelLimit,
        _ => Fault::BadMachineCode,
    }
}
