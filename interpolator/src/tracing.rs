//! A trace in hand: its pieces go into the chain as it makes room, ahead of the axes.
//!
//! A trace may take several chains: where the tool leaves a surface another override acts. It is one block of the program
//! all the same: single block waits at its end, and it counts as one move.
//!
//! Where a correction leads the followers (M36–M43), a setpoint is the exact one of the tick before and the step of the
//! ratios. What they leave of the step (less than the chord error, as a rule) does not add up; speeds and accelerations are
//! those of the path. At rest there is no step, so a trace ends where it should.

use motion::chain::Block;
use protocol::{
    Fault, Leg, Panel, PerAxis, Position, Route, Trace, Traced, Tracer, Untraceable, units::AXES,
};
use shape::{Correction, Plan};

use crate::Interpolator;

/// Most pieces that one tick draws: the most that a chain leaves behind in a tick is more, but no piece that follows a
/// curve at its feed is over in a quarter of a tick.
const PIECES_PER_TICK: usize = 4;

/// A trace in hand, or none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tracing {
    /// Its number: traces begun so far.
    number: u32,
    /// What of it is to be drawn yet.
    tracer: Option<Tracer>,
    /// A block that was drawn and begins the next chain.
    ahead: Option<Block<AXES, Leg>>,
    /// Share of it that is done; nothing if no trace is in hand.
    done: Option<f64>,
    /// The number of the trace, if the setpoints of this tick cut; else 0.
    pub(crate) cutting: u32,
    /// A trace whose followers are led by ratios,
    led: Option<Trace>,
    /// and where it was cut in the tick before: exact positions, and the parameter of the leg.
    before: Option<(PerAxis<Position>, Plan, f64)>,
}

impl Tracing {
    /// Whether a trace is in hand.
    pub(crate) fn in_hand(&self) -> bool {
        self.done.is_some()
    }

    /// Whether there is more of it than the chain holds.
    pub(crate) fn more(&self) -> bool {
        self.tracer.is_some()
    }

    /// Steps of progress that are left of the trace in hand.
    pub(crate) fn left(&self) -> Option<u64> {
        self.done.map(|done| Trace::STEPS - ((done * Trace::STEPS as f64) as u64).min(Trace::STEPS))
    }

    /// The setpoints of this tick lie in a block.
    pub(crate) fn step(&mut self, leg: &Leg) {
        if let Some(stretch) = leg.trace {
            self.done = Some(stretch.share);
            self.cutting = if stretch.cut.is_some() { self.number } else { 0 };
        }
    }

    /// Where the axes are led in this tick: with ratios, from where they should have been in the tick before. `exact` is
    /// where they should be now, `s` mm along a block.
    pub(crate) fn lead(
        &mut self,
        route: &Route,
        leg: &Leg,
        s: f64,
        exact: PerAxis<Position>,
    ) -> PerAxis<Position> {
        let before = self.before.take();
        let (Some(trace), Some(cut)) = (self.led, leg.trace.and_then(|stretch| stretch.cut)) else {
            return exact;
        };
        self.before = Some((exact, cut.plan, cut.clock.parameter(s)));
        before.map_or(exact, |(from, plan, t)| trace.led(route, (&plan, t), &from, &exact))
    }

    /// Forgets the trace in hand.
    pub(crate) fn end(&mut self) {
        (self.tracer, self.ahead, self.done) = (None, None, None);
        (self.led, self.before) = (None, None);
    }
}

impl Interpolator {
    /// A trace is next, or goes on behind a chain; false if it cannot begin.
    pub(crate) fn begin_trace(&mut self, trace: &Trace) -> bool {
        if self.travel.tracing.in_hand() {
            return true;
        }
        match Tracer::new(&self.travel.route, self.line, trace, &self.here) {
            Ok(tracer) => {
                let number = self.travel.tracing.number + 1;
                let led = (trace.correction != Correction::Exact).then_some(*trace);
                self.travel.tracing =
                    Tracing { number, tracer: Some(tracer), done: Some(0.0), led, ..Tracing::default() };
                true
            }
            Err(reason) => {
                self.enter_fault(fault(&reason));
                false
            }
        }
    }

    /// Takes pieces of the trace in hand for as long as they belong to the chain.
    pub(crate) fn take_pieces(&mut self) {
        for _ in 0..PIECES_PER_TICK {
            if !self.travel.has_room() {
                return;
            }
            let Some(block) = self.draw() else { continue };
            if !self.travel.push(block) {
                self.travel.tracing.ahead = Some(block);
                return;
            }
        }
    }

    /// The next block of the trace, if there is one. Behind its last one, and before one that cannot be, the chain ends.
    fn draw(&mut self) -> Option<Block<AXES, Leg>> {
        let tracing = &mut self.travel.tracing;
        if let Some(block) = tracing.ahead.take() {
            return Some(block);
        }
        match tracing.tracer.as_mut()?.next(&self.travel.route) {
            Ok(Traced::Block(block)) => return Some(block),
            Ok(Traced::Nowhere) => {}
            Ok(Traced::Over) => {
                (tracing.tracer, self.next) = (None, None);
                self.travel.close();
            }
            Err(reason) => {
                self.refuse(fault(&reason));
                self.travel.close();
            }
        }
        None
    }

    /// A chain is over: whether the trace in hand is, too.
    pub(crate) fn end_trace(&mut self, panel: &Panel) {
        let tracing = &mut self.travel.tracing;
        if tracing.in_hand() && !tracing.more() && tracing.ahead.is_none() {
            tracing.end();
            self.travel.moves += 1;
            if panel.pressed(Panel::SINGLE_BLOCK) {
                self.travel.waits = Some(panel.cycle_starts);
            }
        }
    }
}

/// The fault that a reason becomes.
fn fault(reason: &Untraceable) -> Fault {
    match reason {
        Untraceable::BeyondTravel(..) => Fault::TravelLimit,
        _ => Fault::BadMachineCode,
    }
}
