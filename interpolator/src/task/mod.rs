//! What the interpolator is doing, as one state machine: [`Task::step`] is the only way from one state to the
//! next, and says what the axes are told meanwhile.
//!
//! | from | event | to | axes |
//! |---|---|---|---|
//! | Enabling | every drive holds its axis | Starting | hold |
//! | Starting | every axis streams | Ready | stream |
//! | Ready | a move is next, and goes | as Moving | stream |
//! | Ready | a dwell or a pause of the program is next | Dwelling, Paused | stream |
//! | Ready | a pass is next, spindle at speed, axes at its start and in position | Arming | **arm** |
//! | Ready | the program ends, or the operator ends it | Ending | stream |
//! | Moving | the axes stand, and a fault waited for that | Fault | stream, then as Fault |
//! | Moving | the axes stand, and the operator ends the program | Ending | stream |
//! | Moving | the axes stand at the end of the chain | Ready | stream |
//! | Dwelling, Paused | over, or the operator ends the program | Ready | stream |
//! | Arming | every axis is armed two ticks later | Armed | hold |
//! | Arming | one is not | Fault | **call off** |
//! | Armed | the operator holds or ends the program | CallingOff | **call off** |
//! | Armed | an axis has seen the index | Cutting | hold |
//! | CallingOff | two ticks later the law of the pass leads an axis all the same | Cutting | hold |
//! | CallingOff | every axis streams at the start of the pass | Ready | stream |
//! | Armed, Cutting | every axis streams at the end of the pass | Ready | hold |
//! | CallingOff | the same | Ready | stream |
//! | Ending | the spindle stands | Ended | stream |
//! | any but Fault and Ended | fault | Fault; Moving brakes on its path first, unless an axis has faulted | as below |
//!
//! In Fault the axes are told: to call off a pass that has not begun; to hold, that is to follow their laws,
//! in one that has; to stop at once if one of them faulted in timed motion; to hold otherwise.
//!
//! Once a pass has begun nothing takes it back. Whether it is over is judged by where the axes rest: its
//! start and its end are different places, so a pass that has been cut cannot be taken for one that was
//! called off.

use protocol::{Cycle, Fault, MachineState, ThreadPass};

/// What the interpolator is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // there is one of it, and it must not allocate
pub(crate) enum Task {
    /// Waits for the drives; commanded follows measured.
    Enabling,
    /// Waits for every axis to follow setpoints.
    Starting,
    /// At rest, the next item may begin.
    Ready {
        /// What single block waits for.
        wait: Wait,
    },
    /// A chain of moves is under way.
    Moving {
        /// What single block waits for.
        wait: Wait,
        /// What ends the program as soon as the axes stand.
        fault: Option<Fault>,
    },
    /// Waits so many ticks.
    Dwelling {
        /// Ticks left.
        left: u64,
    },
    /// Waits for cycle start because the program says so.
    Paused {
        /// How often it had been pressed before.
        cycle_starts: u32,
    },
    /// A pass was sent at tick `sent`.
    Arming {
        /// The pass.
        pass: InHand,
        /// The tick that sent it.
        sent: Cycle,
    },
    /// Every axis waits for the index of a pass.
    Armed(InHand),
    /// A pass is taken back before its index; tick `sent` was the first to say so.
    CallingOff {
        /// The pass.
        pass: InHand,
        /// The tick.
        sent: Cycle,
    },
    /// The regulators cut a pass.
    Cutting(InHand),
    /// The program is over, the spindle runs down.
    Ending {
        /// The operator ended it.
        stopped: bool,
    },
    /// All is at rest.
    Ended {
        /// The operator ended the program.
        stopped: bool,
    },
    /// Latched; the spindle runs down.
    Fault {
        /// Why.
        fault: Fault,
        /// What the axes are told.
        order: Order,
    },
}

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
    /// What is left to wait for, now that cycle start was pressed so often.
    pub(crate) fn after(self, cycle_starts: u32) -> Wait {
        if self == Wait::CycleStart(cycle_starts) { self } else { Wait::No }
    }
}

/// What every axis is told in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // lives on the stack for one tick
pub(crate) enum Order {
    /// Follow the setpoint of the frame.
    Stream,
    /// Hold, or go on with the pass in hand.
    Hold,
    /// Cut this pass.
    Arm(InHand),
    /// Give up a pass that has not begun to move.
    CallOff,
    /// Come to rest at once.
    Stop,
}

/// What a tick finds. One that means nothing to a state leaves it as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // lives on the stack for one tick
pub(crate) enum Event {
    /// Nothing that matters.
    Nothing,
    /// Something ends every task.
    Fault(Fault),
    /// Every drive holds its axis.
    Enabled,
    /// Every axis follows setpoints.
    Streaming,
    /// At rest, and single block may be waiting.
    Waits(Wait),
    /// The program dwells so many ticks.
    Dwells(u64),
    /// The program pauses; cycle start had been pressed so often.
    Pauses(u32),
    /// A dwell or a pause is over.
    Over,
    /// One tick of timed motion.
    Moved(Moved),
    /// A pass is next, and may begin.
    Pass(InHand, Cycle),
    /// Every axis waits for the index.
    Armed,
    /// The operator wants the machine to hold, or to end the program, in this tick.
    TakenBack(Cycle),
    /// An axis has seen the index; of a pass that is called off, its law leads an axis.
    Begun,
    /// The pass is called off, every axis rests at its start.
    CalledOff,
    /// The pass is cut, every axis rests at its end.
    Cut,
    /// The program is over; whether the operator ended it.
    Ends(bool),
    /// The spindle stands.
    Stands,
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
}

impl Task {
    /// Goes on to the state after an event, and says what the axes are told in this tick.
    pub(crate) fn step(&mut self, event: &Event) -> Order {
        let Some(next) = self.next(event) else { return self.order_towards(self) };
        let order = self.order_towards(&next);
        *self = next;
        order
    }

    fn order_towards(&self, next: &Task) -> Order {
        match (self, next) {
            (Task::Ready { .. }, Task::Arming { pass, .. }) => Order::Arm(*pass),
            (Task::Moving { .. } | Task::Ready { .. }, _) => Order::Stream,
            (_, Task::Fault { order, .. }) => *order,
            (_, Task::CallingOff { .. }) => Order::CallOff,
            (Task::Enabling | Task::Arming { .. } | Task::Armed(_) | Task::Cutting(_), _) => Order::Hold,
            (_, Task::Cutting(_)) => Order::Hold,
            _ => Order::Stream,
        }
    }

    /// The state after an event; nothing if it stays as it is.
    fn next(&self, event: &Event) -> Option<Task> {
        let next = match (self, event) {
            (Task::Fault { .. } | Task::Ended { .. }, _) => return None,
            (Task::Moving { wait, fault }, Event::Fault(new)) if *new != Fault::AxisFault => {
                Task::Moving { wait: *wait, fault: fault.or(Some(*new)) }
            }
            (_, Event::Fault(fault)) => Task::Fault { fault: *fault, order: self.order_in(*fault) },
            (Task::Enabling, Event::Enabled) => Task::Starting,
            (Task::Starting, Event::Streaming) => Task::Ready { wait: Wait::No },
            (Task::Ready { wait: before }, Event::Waits(wait)) if before != wait => {
                Task::Ready { wait: *wait }
            }
            (Task::Ready { .. }, Event::Dwells(left)) => Task::Dwelling { left: *left },
            (Task::Ready { .. }, Event::Pauses(cycle_starts)) => Task::Paused { cycle_starts: *cycle_starts },
            (Task::Ready { .. }, Event::Pass(pass, sent)) => Task::Arming { pass: *pass, sent: *sent },
            (Task::Ready { .. }, Event::Ends(stopped)) => Task::Ending { stopped: *stopped },
            (Task::Ready { .. }, Event::Moved(moved)) => moved.task(None),
            (Task::Moving { wait, fault }, Event::Moved(moved)) => {
                let as_before = !moved.stands && moved.wait == *wait && moved.fault.is_none();
                return (!as_before).then(|| moved.task(*fault));
            }
            (Task::Dwelling { left }, Event::Nothing) => Task::Dwelling { left: left.saturating_sub(1) },
            (Task::Dwelling { .. } | Task::Paused { .. }, Event::Over) => Task::Ready { wait: Wait::No },
            (Task::Arming { pass, .. }, Event::Armed) => Task::Armed(*pass),
            (Task::Armed(pass), Event::TakenBack(sent)) => Task::CallingOff { pass: *pass, sent: *sent },
            (Task::Armed(pass) | Task::CallingOff { pass, .. }, Event::Begun) => Task::Cutting(*pass),
            (Task::CallingOff { .. }, Event::CalledOff) => Task::Ready { wait: Wait::No },
            (Task::Armed(_) | Task::CallingOff { .. } | Task::Cutting(_), Event::Cut) => {
                Task::Ready { wait: Wait::No }
            }
            (Task::Ending { stopped }, Event::Stands) => Task::Ended { stopped: *stopped },
            _ => return None,
        };
        Some(next)
    }

    /// What the axes are told once a fault has ended this task.
    fn order_in(&self, fault: Fault) -> Order {
        match (self, fault) {
            (Task::Arming { .. } | Task::Armed(_) | Task::CallingOff { .. }, _) => Order::CallOff,
            (Task::Cutting(_), _) => Order::Hold,
            (_, Fault::AxisFault) => Order::Stop,
            _ => Order::Hold,
        }
    }

    /// The state as others see it.
    pub(crate) fn public(&self) -> MachineState {
        match self {
            Task::Enabling | Task::Starting => MachineState::Starting,
            Task::Ready { wait: Wait::No } => MachineState::Ready,
            Task::Moving { wait: Wait::No, .. } => MachineState::Moving,
            Task::Ready { .. } | Task::Moving { .. } | Task::Paused { .. } => MachineState::Paused,
            Task::Dwelling { .. } | Task::Ending { .. } => MachineState::Waiting,
            Task::Arming { .. } | Task::Armed(_) | Task::CallingOff { .. } | Task::Cutting(_) => {
                MachineState::Threading
            }
            Task::Ended { .. } => MachineState::Ended,
            Task::Fault { .. } => MachineState::Fault,
        }
    }

    /// The pass in hand.
    pub(crate) fn pass(&self) -> Option<&InHand> {
        match self {
            Task::Arming { pass, .. }
            | Task::Armed(pass)
            | Task::CallingOff { pass, .. }
            | Task::Cutting(pass) => Some(pass),
            _ => None,
        }
    }

    /// The fault that is latched.
    pub(crate) fn fault(&self) -> Option<Fault> {
        match self {
            Task::Fault { fault, .. } => Some(*fault),
            _ => None,
        }
    }

    /// Whether the operator has ended the program.
    pub(crate) fn stopped(&self) -> bool {
        matches!(self, Task::Ending { stopped: true } | Task::Ended { stopped: true })
    }

    /// Whether nothing begins any more: the spindle runs down, or stands.
    pub(crate) fn is_over(&self) -> bool {
        matches!(self, Task::Ending { .. } | Task::Ended { .. } | Task::Fault { .. })
    }
}

impl Moved {
    /// The task after it; `fault` had waited for the axes to stand.
    fn task(self, fault: Option<Fault>) -> Task {
        let fault = fault.or(self.fault);
        match (self.stands, fault) {
            (false, fault) => Task::Moving { wait: self.wait, fault },
            (true, Some(fault)) => Task::Fault { fault, order: Order::Hold },
            (true, None) if self.ends => Task::Ending { stopped: true },
            (true, None) => Task::Ready { wait: self.wait },
        }
    }
}

#[cfg(test)]
mod tests;
