//! Timed motion: moves go from the queue into the chain that looks ahead, setpoints come out once a tick.
//!
//! A chain holds moves on which the same override acts. It ends before whatever else the program has: a dwell, the
//! spindle, a pass, a move of the other kind. It ends, too, when no more machine code comes; the machine then stops on
//! its path, the status counts it, and the next item begins a new chain.

use motion::chain::{Ask, Block, Chain, MOST_RATIO, Ratios};
use protocol::{
    Code, Cycle, Fault, Feed, Item, Leg, Machine, Panel, PerAxis, Position, Route, Routed, Setpoint, Trace,
    units::AXES,
};

use crate::{Interpolator, interpolator::ends, task::Task, tracing::Tracing};

/// Most moves that one tick takes into the chain: more than the chain can leave behind in a tick.
const MOVES_PER_TICK: usize = 32;

/// Share by which the spindle's speed must change before the feed per revolution follows: its ripple and the noise of
/// its encoder stay out of the axes.
const SPINDLE_STEP: f64 = 0.01;

/// The chain of moves, and what the operator and the spindle make of its feeds.
#[derive(Clone, Debug)]
pub(crate) struct Travel {
    chain: Chain<AXES, Leg>,
    pub(crate) route: Route,
    /// The last move in the chain.
    pub(crate) last: Option<Leg>,
    pub(crate) tracing: Tracing,
    /// Speed of the spindle that feeds per revolution follow, 1/s.
    turns: f64,
    /// How often it was short of machine code.
    pub(crate) starved: u32,
    /// Moves completed.
    pub(crate) moves: u64,
    /// Cycle starts pressed when a single block ended: the next one goes on.
    pub(crate) waits: Option<u32>,
    /// What ends the program once the machine stands.
    pub(crate) fault: Option<Fault>,
}

impl Travel {
    pub(crate) fn new(machine: &Machine) -> Travel {
        Travel {
            chain: Chain::new(Route::settings(machine)),
            route: Route::new(machine),
            last: None,
            tracing: Tracing::default(),
            turns: 0.0,
            starved: 0,
            moves: 0,
            waits: None,
            fault: None,
        }
    }

    /// Whether the machine stands, on its path or between chains.
    pub(crate) fn rests(&self) -> bool {
        self.chain.is_empty() || self.chain.rests()
    }

    /// What of the program is in hand, in steps of its progress; `next` waits for it to be over.
    pub(crate) fn pending(&self, next: Option<&Item>) -> u64 {
        let waits = match next {
            Some(Item { code: Code::Trace(_), .. }) if !self.tracing.more() => Trace::STEPS,
            _ => 0,
        };
        waits + self.tracing.left().unwrap_or(self.chain.len() as u64)
    }

    /// Forgets what is left of the chain, and of a trace. The machine stands.
    pub(crate) fn clear(&mut self) {
        self.end_chain();
        self.tracing.end();
    }

    /// Forgets what is left of the chain.
    fn end_chain(&mut self) {
        self.chain.clear();
        self.last = None;
    }

    /// Whether a block can be appended.
    pub(crate) fn has_room(&self) -> bool {
        self.chain.has_room()
    }

    /// Appends a block, if it can be one chain with those before it; else the chain ends before it.
    pub(crate) fn push(&mut self, block: Block<AXES, Leg>) -> bool {
        if self.last.is_some_and(|last| !last.joins(&block.tag)) {
            self.close();
            return false;
        }
        self.last = Some(block.tag);
        self.chain.push(block);
        true
    }

    /// Nothing follows in this chain.
    pub(crate) fn close(&mut self) {
        self.chain.close();
    }

    /// The overrides of a panel. A value that is no number asks for a stop.
    fn ratios(&mut self, panel: &Panel, rpm: f64) -> Ratios {
        let share = |pct: f64, top: f64| if pct.is_finite() { (pct / 100.0).clamp(0.0, top) } else { 0.0 };
        let turns = rpm.abs() / 60.0;
        if (turns - self.turns).abs() > SPINDLE_STEP * self.turns {
            self.turns = turns;
        }
        let feed = share(panel.feed_override_pct, MOST_RATIO);
        Ratios { rapid: share(panel.rapid_override_pct, 1.0), feed, turns: self.turns * feed }
    }

    /// Whether single block waits for cycle start.
    pub(crate) fn waits(&mut self, panel: &Panel) -> bool {
        let waits = self.waits == Some(panel.cycle_starts);
        if !waits {
            self.waits = None;
        }
        waits
    }
}

impl Interpolator {
    /// Appends a move that begins where the last one ends; false if it has to wait, or cannot be made.
    pub(crate) fn append(&mut self, line: u32, code: &Code) -> bool {
        let from = self.travel.last.map_or(self.here, |last| last.to);
        match self.travel.route.block(line, code, &from) {
            Ok(Routed::Block(block)) => self.travel.push(block),
            Ok(Routed::Nowhere) => {
                if self.travel.last.is_none()
                    && let Code::Line { target, .. } = code
                {
                    self.here = *target;
                }
                true
            }
            Ok(Routed::BeyondTravel) => self.refuse(Fault::TravelLimit),
            Err(_) => self.refuse(Fault::BadMachineCode),
        }
    }

    /// A move cannot be made: a fault once everything before it is done.
    pub(crate) fn refuse(&mut self, fault: Fault) -> bool {
        if self.travel.last.is_none() {
            self.travel.fault = Some(fault);
        }
        false
    }

    /// Takes moves out of the queue, or pieces of a trace, for as long as they belong to the chain.
    fn take_moves(&mut self, single: bool) {
        if self.travel.tracing.in_hand() {
            return self.take_pieces(single);
        }
        for _ in 0..MOVES_PER_TICK {
            if !self.travel.has_room() {
                return;
            }
            self.next = self.next.or_else(|| self.queue.pop());
            let Some(item) = self.next else { return };
            let taken = match item.code {
                Code::Line { .. } | Code::Arc { .. } => self.append(item.line, &item.code),
                Code::PathMode(mode) => {
                    self.travel.route.set_mode(mode);
                    true
                }
                _ => false,
            };
            if !taken {
                return self.travel.close();
            }
            self.next = None;
        }
    }

    /// One tick of timed motion.
    pub(crate) fn go_on(&mut self, panel: &Panel, due: Cycle) -> PerAxis<Setpoint> {
        if self.travel.fault.is_none() {
            self.take_moves(panel.pressed(Panel::SINGLE_BLOCK));
        }
        let last = ends(panel) || self.travel.fault.is_some();
        if panel.pressed(Panel::ABORT) {
            self.spindle_and_coolant_off();
        }
        let ask = Ask {
            ratios: self.travel.ratios(panel, self.spindle.observed()),
            hold: last
                || panel.pressed(Panel::FEED_HOLD)
                || self.travel.waits(panel)
                || self.travel.last.is_some_and(|leg| leg.feed != Feed::Rapid) && self.spindle.held(),
            single: panel.pressed(Panel::SINGLE_BLOCK) && !self.travel.tracing.in_hand(),
            more: self.next.is_some() || !self.queue.is_empty(),
        };
        let Some(step) = self.travel.chain.tick(&ask) else {
            self.arrive(panel);
            return self.rest(due);
        };
        let leg = step.tag;
        self.travel.moves += self.travel.tracing.step(&leg);
        if leg.trace.is_none() {
            self.travel.moves += u64::from(step.completed);
        }
        let more = self.travel.tracing.more() || !self.queue.ended();
        self.travel.starved += u32::from(step.starved && more);
        if step.rejected {
            self.travel.fault = Some(Fault::PlanRejected);
        }
        let stops_single = ask.single && step.completed > 0 && self.travel.rests();
        if !stops_single {
            self.line = leg.line;
        }
        let over = self.travel.chain.is_empty();
        let exact = std::array::from_fn(|i| if over { leg.to[i] } else { leg.from[i].moved(step.axes[i].s) });
        let led = match over {
            true => exact,
            false => self.travel.tracing.lead(&self.travel.route, &leg, step.along.s, exact),
        };
        let axis = |i: usize| {
            let sample = &step.axes[i];
            let (velocity_mm_s, acceleration_mm_s2) = if over { (0.0, 0.0) } else { (sample.v, sample.a) };
            Setpoint { cycle: due, position: led[i], velocity_mm_s, acceleration_mm_s2 }
        };
        let setpoints: PerAxis<Setpoint> = std::array::from_fn(axis);
        self.here = setpoints.map(|setpoint| setpoint.position);
        if stops_single {
            self.travel.waits = Some(panel.cycle_starts);
        }
        if over || last && self.travel.rests() {
            self.arrive(panel);
        }
        setpoints
    }

    /// The machine stands at the end of its chain, or on its path because the operator or a fault ends the program.
    fn arrive(&mut self, panel: &Panel) {
        if self.travel.chain.is_empty() {
            self.end_trace(panel);
        }
        self.travel.end_chain();
        if let Some(fault) = self.travel.fault.take() {
            self.enter_fault(fault);
        } else if ends(panel) {
            self.stopped = true;
            self.end();
        } else {
            self.task = Task::Ready;
        }
    }

    /// Whether a move may begin: a feed waits for the spindle.
    pub(crate) fn may_feed(&self, feed: Feed) -> bool {
        let least = (0.5 * self.spindle.commanded().abs()).min(1.0);
        let turns = !matches!(feed, Feed::PerRevolution(_)) || self.spindle.observed().abs() >= least;
        feed == Feed::Rapid || self.spindle.at_speed() && turns
    }

    /// Where the machine would be led from here in a straight rapid, as the first move of a chain.
    pub(crate) fn lead_to(&mut self, target: &PerAxis<Position>) {
        let code = Code::Line { target: *target, feed: Feed::Rapid };
        if self.append(self.line, &code) {
            self.travel.close();
            self.task = Task::Moving;
        } else {
            self.enter_fault(Fault::TravelLimit);
        }
    }
}
