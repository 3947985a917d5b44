//! The program at rest: what is executed without motion, and what takes time next.

use machine::Machine;
use protocol::{
    ByHand, Code, Feed, Item, MachineStatus, Panel, SpindleMode, SpindleSpeed, ThreadPass, Until, Variation,
    Work, frame::SETPOINT_LEAD,
};
use route::Route;

use crate::{outputs::Outputs, queue::Queue, spindle::Spindle};

/// Items without motion that one tick may work off.
const ITEMS_PER_TICK: usize = 8;

/// The machine code, how far it has been executed, and what it has switched on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Program {
    /// What waits, and what is in hand.
    pub(crate) queue: Queue,
    /// Line of the part program that is executed.
    pub(crate) line: u32,
    /// Number of the tool that was selected last; 0 for none.
    pub(crate) tool: u32,
    /// Somebody puts it in.
    tool_by_hand: bool,
    /// Bits of [`MachineStatus::coolant`].
    pub(crate) coolant: u8,
    /// How the speed of the spindle is varied in the passes that follow.
    pub(crate) variation: Option<Variation>,
    /// What it has switched.
    pub(crate) outputs: Outputs,
    /// The axes have had time to come to where the last motion leads, for the output in hand.
    settled: bool,
    /// That time, s.
    settles_s: f64,
}

/// What of a program takes time next. A dwell, a pause and a wait for an input are done with that; all others
/// stay in hand.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // lives on the stack for one tick
pub(crate) enum Next {
    /// Nothing is at hand yet.
    Nothing,
    /// Motion is next, and the operator holds it.
    Held,
    /// A line or an arc.
    Move(Feed),
    /// A contour, a surface or a seam.
    Work(Work),
    /// A pass of a thread.
    Pass(ThreadPass),
    /// So many seconds of rest.
    Dwell(f64),
    /// An input is waited for, so many seconds at most.
    Await { input: u8, until: Until, within_s: f64 },
    /// Cycle start is wanted.
    Pause,
    /// Somebody is to put the tool in.
    ToolChange,
    /// A block by hand is wanted, or begins.
    ByHand(ByHand),
    /// An output, or a change of the tool, waits for axes and spindle to stand.
    Standstill,
    /// An output that needs standstill, or the tool, is to change while something turns.
    Impossible,
    /// The program is over.
    End,
}

impl Program {
    /// A program that has not begun.
    pub(crate) fn new(machine: &Machine) -> Program {
        let settles_s = SETPOINT_LEAD as f64 * machine.general.interpolator_cycle_s;
        let tool_by_hand = !machine.general.tool_change.is_automatic();
        Program { outputs: Outputs::new(machine), tool_by_hand, settles_s, ..Program::default() }
    }

    /// Executes what needs no time, as far as one tick goes, and says what is next. So many blocks of motion
    /// have been appended so far, and whether axes and spindle stand.
    pub(crate) fn next(
        &mut self,
        panel: &Panel,
        spindle: &mut Spindle,
        route: &mut Route,
        (blocks, stands): (u64, bool),
    ) -> Next {
        let held = panel.pressed(Panel::FEED_HOLD);
        for _ in 0..ITEMS_PER_TICK {
            let Some(item) = self.queue.head() else { return Next::Nothing };
            if held && (item.is_move() || matches!(item.code, Code::Pass(_))) {
                return Next::Held;
            }
            self.line = item.line;
            match item.code {
                Code::Line { feed, .. } | Code::Arc { feed, .. } | Code::Curve { feed, .. } => {
                    return Next::Move(feed);
                }
                Code::Work(work) => return Next::Work(work),
                Code::Pass(pass) => return Next::Pass(pass),
                Code::End => return Next::End,
                Code::Dwell { seconds } => {
                    self.queue.done();
                    return Next::Dwell(seconds);
                }
                Code::OptionalPause if panel.pressed(Panel::PASSES_M1) => {}
                Code::Pause | Code::OptionalPause => {
                    self.queue.done();
                    return Next::Pause;
                }
                Code::ByHand(by_hand) => {
                    self.queue.done();
                    return Next::ByHand(by_hand);
                }
                Code::PathMode(mode) => route.set_mode(mode),
                Code::Spindle { mode, speed } => spindle.program(mode, speed),
                Code::Variation(variation) => self.variation = variation,
                Code::Tool { number } if self.tool_by_hand => return self.asks_for(number, spindle, stands),
                Code::Tool { number } => self.tool = number,
                Code::Coolant { mist, flood } => self.coolant = MachineStatus::coolant(mist, flood),
                Code::Output { number, set, in_step } if self.outputs.needs_standstill(number, set) => {
                    if let Some(next) = at_rest(in_step || spindle.programmed() != 0.0, stands) {
                        return next;
                    }
                    self.outputs.set(number, set);
                }
                Code::Output { number, set, in_step: true } => self.outputs.set_with(blocks, number, set),
                Code::Output { .. } | Code::Await { .. } if !self.settled => {
                    self.settled = true;
                    return Next::Dwell(self.settles_s);
                }
                Code::Output { number, set, in_step: false } => {
                    self.outputs.set(number, set);
                    // The next one waits as well: a pulse is seen.
                    self.settled = false;
                }
                Code::Await { input, until, within_s } => {
                    self.settled = false;
                    self.queue.done();
                    return Next::Await { input, until, within_s };
                }
                Code::Formula { slot, formula } => route.set_formula(slot, formula),
            }
            self.queue.done();
        }
        Next::Nothing
    }

    /// A tool that somebody puts in, once axes and spindle stand.
    fn asks_for(&mut self, number: u32, spindle: &Spindle, stands: bool) -> Next {
        at_rest(spindle.programmed() != 0.0, stands).unwrap_or_else(|| {
            self.tool = number;
            self.queue.done();
            Next::ToolChange
        })
    }

    /// Spindle and coolant off, whatever the program said.
    pub(crate) fn switch_off(&mut self, spindle: &mut Spindle) {
        spindle.program(SpindleMode::Stop, SpindleSpeed::Rpm(0.0));
        self.coolant = 0;
    }

    /// Whether nothing is left although the program has not ended, and nothing more can come.
    pub(crate) fn is_broken_off(&self) -> bool {
        self.queue.is_dry() && self.queue.failed()
    }

    /// Whether the axes have time to come to where they are led: no block of the program.
    pub(crate) fn settles(&self) -> bool {
        self.settled
    }

    /// Whether an output is in hand.
    pub(crate) fn sets_output(&self) -> bool {
        matches!(self.queue.in_hand(), Some(Item { code: Code::Output { .. }, .. }))
    }

    /// The pass in hand.
    pub(crate) fn pass(&self) -> Option<&ThreadPass> {
        match &self.queue.in_hand()?.code {
            Code::Pass(pass) => Some(pass),
            _ => None,
        }
    }
}

/// What is next before something that needs standstill: nothing if all stands.
fn at_rest(moves: bool, stands: bool) -> Option<Next> {
    match (moves, stands) {
        (true, _) => Some(Next::Impossible),
        (false, false) => Some(Next::Standstill),
        (false, true) => None,
    }
}
