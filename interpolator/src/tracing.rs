//! A trace in hand: its pieces go into the chain as it makes room, ahead of the axes.
//!
//! A trace may take several chains: where the tool leaves a surface another override acts. It is one block of the program
//! all the same: single block waits at its end, and it counts as one move. Seams that follow each other where they meet are
//! one path, without a stop between them, unless single block is on when the end of the first is drawn.
//!
//! Where a correction leads the followers (M36–M43), a setpoint is the exact one of the tick before and the step of the
//! ratios. What they leave of the step does not add up, and the steps are so short that it stays within the
//! chord error (M44); speeds and accelerations are those of the path. At rest there is no step, so a trace ends where it should.

use motion::chain::Block;
use protocol::{
    Code, Fault, Item, Leg, Panel, PerAxis, Position, Route, Stretch, Trace, Traced, Tracer, Untraceable,
    units::AXES,
};
use shape::{Correction, Plan};

use crate::Interpolator;

/// Most tries of pieces in one tick, each of at most five evaluations of the curve: that bounds the work of the tick. As a
/// rule a try is a piece. It is about as long as a third of the radius of its curve (M84), and the axes need more than a
/// tick for so small a part of a bend that they can follow: so the pieces keep ahead of them. Where they do not, the axes
/// stop on the path and set off again.
const TRIES_PER_TICK: usize = 6;

/// The trace in hand, or none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tracing {
    /// Traces that were begun to be drawn so far.
    drawn: u32,
    /// What of the last of them is to be drawn yet.
    tracer: Option<Tracer>,
    /// A block that was drawn and begins the next chain.
    ahead: Option<Block<AXES, Leg>>,
    /// Number of the trace in which the axes are, and the share of it that is done; nothing if no trace is in hand.
    here: Option<(u32, f64)>,
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
        self.here.is_some()
    }

    /// Whether there is more of it than the chain holds.
    pub(crate) fn more(&self) -> bool {
        self.tracer.is_some()
    }

    /// Steps of progress that are left of the traces in hand.
    pub(crate) fn left(&self) -> Option<u64> {
        let (number, done) = self.here?;
        let behind = u64::from(self.drawn.saturating_sub(number));
        Some((behind + 1) * Trace::STEPS - ((done * Trace::STEPS as f64) as u64).min(Trace::STEPS))
    }

    /// The setpoints of this tick lie in a block; how many traces that completes.
    pub(crate) fn step(&mut self, leg: &Leg) -> u64 {
        let Some(Stretch { number, share, cut }) = leg.trace else { return 0 };
        let (before, _) = self.here.replace((number, share)).unwrap_or((number, 0.0));
        self.cutting = if cut.is_some() { number } else { 0 };
        u64::from(number.saturating_sub(before))
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
        (self.tracer, self.ahead, self.here) = (None, None, None);
        (self.led, self.before) = (None, None);
    }
}

impl Interpolator {
    /// A trace is next, or goes on behind a chain; false if it cannot begin.
    pub(crate) fn begin_trace(&mut self, trace: &Trace) -> bool {
        if self.travel.tracing.in_hand() {
            return true;
        }
        let number = self.travel.tracing.drawn + 1;
        match Tracer::new(&self.travel.route, self.line, trace, &self.here) {
            Ok(tracer) => {
                let led = (trace.correction != Correction::Exact).then_some(*trace);
                let (tracer, here) = (Some(tracer.numbered(number)), Some((number, 0.0)));
                self.travel.tracing = Tracing { drawn: number, tracer, here, led, ..Tracing::default() };
                true
            }
            Err(reason) => {
                self.enter_fault(fault(&reason));
                false
            }
        }
    }

    /// Takes pieces of the trace in hand for as long as they belong to the chain; with `single` block it ends with the trace.
    pub(crate) fn take_pieces(&mut self, single: bool) {
        for _ in 0..TRIES_PER_TICK {
            if !self.travel.has_room() {
                return;
            }
            let Some(block) = self.draw(single) else { continue };
            if !self.travel.push(block) {
                self.travel.tracing.ahead = Some(block);
                return;
            }
        }
    }

    /// The next block of the trace, if there is one. Behind its last one, and before one that cannot be, the chain ends.
    fn draw(&mut self, single: bool) -> Option<Block<AXES, Leg>> {
        let tracing = &mut self.travel.tracing;
        if let Some(block) = tracing.ahead.take() {
            return Some(block);
        }
        match tracing.tracer.as_mut()?.next(&self.travel.route) {
            Ok(Traced::Block(block)) => return Some(block),
            Ok(Traced::Nowhere) => {}
            Ok(Traced::Over) => self.draw_next(single),
            Err(reason) => {
                self.refuse(fault(&reason));
                self.travel.close();
            }
        }
        None
    }

    /// A trace has been drawn: the next item goes on as its own, or ends the chain.
    fn draw_next(&mut self, single: bool) {
        self.next = self.queue.pop();
        let tracing = &mut self.travel.tracing;
        let before = tracing.tracer.take();
        if let (Some(Item { line, code: Code::Trace(trace) }), Some(before), Some(last)) =
            (&self.next, before, self.travel.last)
            && !single
            && let Ok(tracer) = Tracer::new(&self.travel.route, *line, trace, &last.to)
            && tracer.goes_on(before.trace())
        {
            (tracing.drawn, tracing.tracer) = (tracing.drawn + 1, Some(tracer.numbered(tracing.drawn + 1)));
        } else {
            self.travel.close();
        }
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
