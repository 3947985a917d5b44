//! What a tick finds, and what it carries.

use protocol::{Axis, Cycle, Fault, Panel, Position, ThreadPass, Until};

use super::Task;

/// A pass in hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct InHand {
    /// The pass.
    pub(crate) pass: ThreadPass,
    /// The first cycle whose index counts.
    pub(crate) not_before: Cycle,
}

/// Single block: what the next block waits for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Wait {
    /// Nothing.
    #[default]
    No,
    /// That cycle start has been pressed more often than this.
    CycleStart(u32),
}

impl Wait {
    /// What a block that is over leaves behind.
    pub(crate) fn behind_block(panel: &Panel) -> Wait {
        match panel.pressed(Panel::SINGLE_BLOCK) {
            true => Wait::CycleStart(panel.cycle_starts),
            false => Wait::No,
        }
    }

    /// What is left to wait for, now that cycle start was pressed so often.
    pub(crate) fn after(self, cycle_starts: u32) -> Wait {
        if self == Wait::CycleStart(cycle_starts) { self } else { Wait::No }
    }
}

/// An input that is waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Await {
    /// Its number.
    pub(crate) input: u8,
    /// For what.
    pub(crate) until: Until,
    /// Whether it was on in the tick before.
    pub(crate) before: bool,
    /// Ticks left.
    pub(crate) left: u64,
}

/// Why the axes leave a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Why {
    /// The operator holds: the pass is entered again.
    Held(Back),
    /// The operator ends the program.
    Stopped,
    /// Something is wrong.
    Fault(Fault),
}

/// What a pass that was left by a hold waits for before it is entered again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Back {
    /// That the hold is released.
    Held,
    /// That cycle start has been pressed more often than this: the hold was too short to be seen here.
    CycleStart(u32),
    /// Nothing.
    Goes,
}

impl Back {
    /// What is left to wait for with this panel.
    pub(crate) fn after(self, panel: &Panel) -> Back {
        match self {
            Back::Held if panel.pressed(Panel::FEED_HOLD) => Back::Held,
            Back::CycleStart(before) if panel.cycle_starts == before => self,
            _ => Back::Goes,
        }
    }

    /// Whether feed hold is pressed, and it is not the hold that led here.
    pub(crate) fn held_again(self, panel: &Panel) -> bool {
        panel.pressed(Panel::FEED_HOLD) && self != Back::Held
    }
}

/// How the axes come out of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// It has not begun: they give it up.
    CallOff,
    /// They leave it, in this cycle at the latest.
    Leave(Cycle),
}

/// Something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Trouble {
    /// What.
    pub(crate) fault: Fault,
    /// With which axis, where that has to be said.
    pub(crate) axis: Option<Axis>,
    /// An axis cannot be led any more, or emergency stop: timed motion does not brake on its path first.
    pub(crate) at_once: bool,
    /// What becomes of a pass that has begun.
    pub(crate) way: Way,
}

/// What a tick finds. One that means nothing to a state leaves it as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // lives on the stack for one tick
pub(crate) enum Event {
    /// Nothing that matters.
    Nothing,
    /// Something ends every task.
    Fault(Trouble),
    /// Every drive holds its axis.
    Enabled,
    /// Every axis follows setpoints.
    Streaming,
    /// At rest, and single block may be waiting.
    Waits(Wait),
    /// The program dwells so many ticks.
    Dwells(u64),
    /// The program waits for an input, or goes on to do so.
    Awaits(Await),
    /// The program pauses; cycle start had been pressed so often.
    Pauses(u32),
    /// A tool is to be put in by hand; cycle start had been pressed so often.
    ChangesTool(u32),
    /// The next block by hand is wanted.
    ByHand,
    /// A dwell, a wait for an input, a pause or a change of the tool is over.
    Over(Wait),
    /// One tick of timed motion.
    Moved(Moved),
    /// A pass is next, and may begin.
    Pass(InHand, Cycle),
    /// The drive of an axis is to take an offset.
    Sets(Axis, Position),
    /// It has.
    IsSet,
    /// Every axis waits for the index.
    Armed,
    /// The operator wants the machine to hold, or to end the program, in this tick.
    TakenBack(Cycle),
    /// An axis has seen the index; of a pass that is called off, its law leads an axis.
    Begun,
    /// The pass is called off, every axis rests at its start.
    CalledOff,
    /// The pass is cut, every axis rests at its end.
    Cut(Wait),
    /// An axis leaves the pass; all of them have left by this cycle.
    Leaves(Why, Cycle),
    /// What a pass that was left waits for.
    Waiting(Back),
    /// Every axis that lives has left the pass and rests.
    Left,
    /// Every axis rests at the start of a pass that was left.
    Returned,
    /// The program is over; whether the operator ended it.
    Ends(bool),
    /// The spindle stands.
    Stands,
}

impl Event {
    /// A thing of the program that cannot be: the axes rest before it.
    pub(crate) fn refused(fault: Fault, cycle: Cycle) -> Event {
        Event::Fault(Trouble { fault, axis: None, at_once: false, way: Way::Leave(cycle) })
    }
}

/// What one tick of timed motion brought.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moved {
    /// What single block waits for now.
    pub(crate) wait: Wait,
    /// A move cannot be made: the machine stops before it.
    pub(crate) fault: Option<Fault>,
    /// The operator ends the program.
    pub(crate) ends: bool,
    /// The axes stand at the end of the chain, or on their path because the program ends there.
    pub(crate) stands: bool,
    /// The move leads back to a pass that was left.
    pub(crate) back: Option<Back>,
}

impl Moved {
    /// The task after it; `fault` had waited for the axes to stand.
    pub(super) fn task(self, fault: Option<Fault>) -> Task {
        let fault = fault.or(self.fault);
        match (self.stands, fault, self.back) {
            (false, fault, back) => Task::Moving { wait: self.wait, fault, back },
            (true, Some(fault), _) => Task::Fault { fault, order: super::Order::Hold },
            (true, None, _) if self.ends => Task::Ending { stopped: true },
            (true, None, Some(back)) => Task::Returning { back, waits: false },
            (true, None, None) => Task::Ready { wait: self.wait },
        }
    }
}
