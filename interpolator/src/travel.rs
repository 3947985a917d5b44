//! Timed motion: moves go from the queue into a run that looks ahead, setpoints come out once a tick.
//!
//! A run ends before whatever else the program has: a dwell, the spindle, a pass, a move of the other kind.
//! It ends also when no more machine code comes; the machine then stops on its path, the status counts it,
//! and the next item begins a new run.

use machine::Machine;
use motion::chain::{Ask, MOST_RATIO, Ratios, Step};
use protocol::{
    Code, Cycle, Fault, Feed, Item, Motion, Panel, PerAxis, Position, Setpoint, Work, units::AXES,
};
use route::{Move, Route, Routed};

use crate::{
    hand::Jog,
    outputs::Outputs,
    program::Program,
    queue::Queue,
    run::Run,
    spindle::Spindle,
    task::{Back, Moved, Wait},
    working::Working,
};

/// Most moves that one tick takes into the run: more than the run can leave behind in a tick, which is 16.
/// Where a run fills they are most of what a tick costs.
const MOVES_PER_TICK: usize = 17;

/// Share by which the spindle's speed must change before the feed per revolution follows: its ripple and the
/// noise of its encoder stay out of the axes.
const SPINDLE_STEP: f64 = 0.01;

/// Where the axes are led, and along what.
#[derive(Clone, Debug)]
pub(crate) struct Travel {
    route: Route,
    run: Run,
    working: Working,
    /// Commanded position of every axis at the last tick.
    here: PerAxis<Position>,
    /// The cycle from which on each axis has been led nowhere else.
    since: PerAxis<Cycle>,
    /// Speed of the spindle that feeds per revolution follow, 1/s.
    turns: f64,
    /// How the setpoints of the last tick of motion move the axes.
    motion: Motion,
    /// How often it was short of machine code.
    starved: u32,
    /// Moves completed.
    moves: u64,
}

/// What acts on the motion of a tick besides the program.
#[derive(Clone, Copy)]
pub(crate) struct Hands<'a> {
    /// The operator's panel.
    pub(crate) panel: &'a Panel,
    /// The spindle.
    pub(crate) spindle: &'a Spindle,
    /// What single block waits for.
    pub(crate) wait: Wait,
    /// A fault waits for the axes to stand.
    pub(crate) stops: bool,
    /// The motion leads back to a pass that was left: no move of the program, and the hold that led there
    /// does not hold it.
    pub(crate) back: Option<Back>,
    /// Whether it is a jog, and its key let go.
    pub(crate) jog: Jog,
    /// It is a way of a reference run: nothing of the program goes with it.
    pub(crate) alone: bool,
}

impl Hands<'_> {
    fn holds(&self) -> bool {
        match self.back {
            Some(back) => back.held_again(self.panel),
            None => self.panel.pressed(Panel::FEED_HOLD),
        }
    }
}

impl Travel {
    pub(crate) fn new(machine: &Machine) -> Travel {
        Travel {
            route: Route::new(machine),
            run: Run::new(machine),
            working: Working::default(),
            here: [Position(0); AXES],
            since: [Cycle(0); AXES],
            turns: 0.0,
            motion: Motion::None,
            starved: 0,
            moves: 0,
        }
    }

    /// Commanded position of every axis.
    pub(crate) fn here(&self) -> &PerAxis<Position> {
        &self.here
    }

    /// Where the run in hand leads, or where the axes rest.
    pub(crate) fn end(&self) -> PerAxis<Position> {
        self.run.end(&self.here)
    }

    /// The cycle from which on each axis has been led nowhere else: a later status tells that it is there.
    pub(crate) fn since(&self) -> &PerAxis<Cycle> {
        &self.since
    }

    /// Whether the axes of a machine rest here.
    pub(crate) fn rests_at(&self, machine: &Machine, at: &PerAxis<Position>) -> bool {
        machine.axes().all(|(axis, _)| at[axis.index()] == self.here[axis.index()])
    }

    /// The axes rest here, as others found or led them.
    pub(crate) fn rest_at(&mut self, here: PerAxis<Position>) {
        self.here = here;
    }

    /// Setpoints that keep the axes where they are.
    pub(crate) fn rest(&self, due: Cycle) -> PerAxis<Setpoint> {
        std::array::from_fn(|axis| Setpoint { cycle: due, position: self.here[axis], ..Setpoint::default() })
    }

    /// What path modes and formulas are given to.
    pub(crate) fn route(&mut self) -> &mut Route {
        &mut self.route
    }

    /// Blocks of motion appended so far.
    pub(crate) fn blocks(&self) -> u64 {
        self.run.pushed()
    }

    /// What of the program is in hand, in steps of its progress; `head` waits for it to be over.
    pub(crate) fn pending(&self, head: Option<&Item>) -> u64 {
        let waits = match head {
            Some(Item { code: Code::Work(_), .. }) if !self.working.more() => Work::STEPS,
            _ => 0,
        };
        waits + self.working.left().unwrap_or(self.run.len() as u64)
    }

    /// Moves completed so far.
    pub(crate) fn moves(&self) -> u64 {
        self.moves
    }

    /// How often machine code came too late.
    pub(crate) fn starved(&self) -> u32 {
        self.starved
    }

    /// Number of the work that the setpoints of the last tick of motion cut, or 0.
    pub(crate) fn cutting(&self) -> u32 {
        self.working.cutting()
    }

    /// How the setpoints of the last tick of motion move the axes.
    pub(crate) fn motion(&self) -> Motion {
        self.motion
    }

    /// A tick without motion of its own.
    pub(crate) fn idle(&mut self) {
        self.motion = Motion::None;
        self.working.idle();
    }

    /// Forgets what is left of the run and of a work. The machine stands.
    pub(crate) fn clear(&mut self) {
        self.run.clear();
        self.working.end();
    }

    /// A work is next, or goes on behind a run.
    ///
    /// # Errors
    /// The fault, if it cannot begin here.
    pub(crate) fn begin_work(&mut self, line: u32, work: &Work) -> Result<(), Fault> {
        self.working.begin(&self.route, line, work, &self.here)
    }

    /// A straight line from here, as a run of its own.
    ///
    /// # Errors
    /// The fault, if it cannot be made.
    pub(crate) fn lead_to(&mut self, line: u32, target: &PerAxis<Position>, feed: Feed) -> Result<(), Fault> {
        let code = Code::Line { target: *target, feed };
        self.append(line, &code)?;
        self.run.close();
        Ok(())
    }

    /// One tick of timed motion: the setpoints for `due`, what came of it, and the line that is executed if
    /// it is another.
    pub(crate) fn tick(
        &mut self,
        program: &mut Program,
        hands: &Hands,
        due: Cycle,
    ) -> (PerAxis<Setpoint>, Moved, Option<u32>) {
        let (queue, outputs, panel) = (&mut program.queue, &mut program.outputs, hands.panel);
        let ends = panel.pressed(Panel::STOP) || panel.pressed(Panel::ABORT);
        let single = panel.pressed(Panel::SINGLE_BLOCK) && hands.jog == Jog::No;
        let taken = if hands.stops || hands.alone { Ok(()) } else { self.take(queue, outputs, single) };
        let mut moved = Moved { wait: hands.wait, fault: taken.err(), ends, stands: false, back: hands.back };
        let last = ends || hands.stops || hands.jog == Jog::LetGo || moved.fault.is_some();
        let feeds = self.run.last().is_some_and(|leg| leg.feed != Feed::Rapid);
        let mut ratios = self.ratios(panel, hands.spindle.observed());
        if hands.jog != Jog::No {
            // So that it comes to rest as soon as it is said to.
            ratios.feed = ratios.feed.min(1.0);
        }
        let ask = Ask {
            ratios,
            hold: last || hands.holds() || hands.wait != Wait::No || feeds && hands.spindle.held(),
            single: single && !self.working.in_hand() && hands.back.is_none(),
            more: !queue.is_dry(),
        };
        let Some(step) = self.run.tick(&ask) else {
            self.arrive(panel, &mut moved);
            return (self.rest(due), moved, None);
        };
        outputs.begun(self.run.begun(&step), due);
        self.motion = if step.tag.feed == Feed::Rapid { Motion::Rapid } else { Motion::Feed };
        if hands.back.is_none() && !hands.alone {
            self.count(&step, queue);
        }
        if step.rejected {
            moved.fault = moved.fault.or(Some(Fault::PlanRejected));
        }
        let stops_single = ask.single && step.completed > 0 && self.run.rests();
        if stops_single {
            moved.wait = Wait::CycleStart(panel.cycle_starts);
        }
        let setpoints = self.setpoints(&step, due);
        for (i, setpoint) in setpoints.iter().enumerate() {
            if self.here[i] != setpoint.position {
                self.since[i] = due;
            }
        }
        self.here = setpoints.map(|setpoint| setpoint.position);
        if self.run.is_over() || last && self.run.rests() {
            self.arrive(panel, &mut moved);
        }
        let line = step.last.unwrap_or(step.tag).line;
        (setpoints, moved, (!stops_single).then_some(line))
    }

    /// What a step completed.
    fn count(&mut self, step: &Step<AXES, Move>, queue: &Queue) {
        self.moves += self.working.step(&step.tag);
        if step.tag.work.is_none() {
            self.moves += u64::from(step.completed);
        }
        let more = self.working.more() || !queue.ended();
        self.starved += u32::from(step.starved && more);
    }

    /// Where the axes shall be at the end of a step.
    fn setpoints(&mut self, step: &Step<AXES, Move>, due: Cycle) -> PerAxis<Setpoint> {
        let leg = &step.tag;
        let over = self.run.is_over();
        let exact = std::array::from_fn(|i| if over { leg.to[i] } else { leg.from[i].moved(step.axes[i].s) });
        let led = match over {
            true => exact,
            false => self.working.lead(&self.route, leg, step.along.s, exact),
        };
        std::array::from_fn(|i| {
            let sample = &step.axes[i];
            let (velocity_mm_s, acceleration_mm_s2) = if over { (0.0, 0.0) } else { (sample.v, sample.a) };
            Setpoint { cycle: due, position: led[i], velocity_mm_s, acceleration_mm_s2 }
        })
    }

    /// The machine stands at the end of its run, or on its path because the operator or a fault ends the
    /// program.
    fn arrive(&mut self, panel: &Panel, moved: &mut Moved) {
        if self.run.is_over() && self.working.end_if_drawn() {
            self.moves += 1;
            if panel.pressed(Panel::SINGLE_BLOCK) {
                moved.wait = Wait::behind_block(panel);
            }
        }
        self.run.clear();
        moved.stands = true;
    }

    /// Takes moves out of the queue, or pieces of a work, for as long as they belong to the run.
    fn take(&mut self, queue: &mut Queue, outputs: &mut Outputs, single: bool) -> Result<(), Fault> {
        if self.working.in_hand() {
            return self.working.fill(&mut self.run, &self.route, queue, single);
        }
        let mut moves = 0;
        while moves < MOVES_PER_TICK && self.run.has_room() {
            // What stands between the moves costs next to nothing, and the queue is short.
            let Some(item) = queue.head() else { return Ok(()) };
            moves += usize::from(item.is_move());
            let taken = match &item.code {
                code @ (Code::Line { .. } | Code::Arc { .. } | Code::Curve { .. }) => {
                    self.append(item.line, code)?
                }
                Code::PathMode(mode) => {
                    self.route.set_mode(*mode);
                    true
                }
                Code::Output { number, set, in_step: true } if !outputs.needs_standstill(*number, *set) => {
                    outputs.set_with(self.run.pushed(), *number, *set);
                    true
                }
                _ => false,
            };
            if !taken {
                self.run.close();
                return Ok(());
            }
            queue.done();
        }
        Ok(())
    }

    /// Appends a move that begins where the last one ends; false if it has to wait for the end of the run.
    ///
    /// # Errors
    /// The fault of a move that cannot be made. In the middle of a run it waits; at its beginning it is said.
    fn append(&mut self, line: u32, code: &Code) -> Result<bool, Fault> {
        let from = self.run.end(&self.here);
        let fault = match self.route.block(line, code, &from) {
            Ok(Routed::Block(block)) => return Ok(self.run.push(block)),
            Ok(Routed::Nowhere) => {
                if let (true, Code::Line { target, .. }) = (self.run.is_new(), code) {
                    self.here = *target;
                }
                return Ok(true);
            }
            Ok(Routed::BeyondTravel) => Fault::TravelLimit,
            Err(_) => Fault::BadMachineCode,
        };
        if self.run.is_new() { Err(fault) } else { Ok(false) }
    }

    /// The overrides of a panel. A value that is not a number asks for a stop.
    fn ratios(&mut self, panel: &Panel, rpm: f64) -> Ratios {
        let share = |pct: f64, top: f64| if pct.is_finite() { (pct / 100.0).clamp(0.0, top) } else { 0.0 };
        let turns = rpm.abs() / 60.0;
        if (turns - self.turns).abs() > SPINDLE_STEP * self.turns {
            self.turns = turns;
        }
        let feed = share(panel.feed_override_pct, MOST_RATIO);
        Ratios { rapid: share(panel.rapid_override_pct, 1.0), feed, turns: self.turns * feed }
    }
}
