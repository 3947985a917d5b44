//! What the interpolator is doing, as one state machine: [`Task::step`] is the only way from one state to the
//! next, and says what the axes are told meanwhile.
//!
//! | from | event | to | axes |
//! |---|---|---|---|
//! | Enabling | every drive holds its axis | Starting | hold |
//! | Starting | every axis streams | Ready | stream |
//! | Ready | a move is next, and goes | as Moving | stream |
//! | Ready | a dwell, an input to wait for or a pause of the program is next | Dwelling, Awaiting, Paused | stream |
//! | Ready | a pass is next, spindle at speed, axes at its start and in position | Arming | **arm** |
//! | Ready | the program ends, or the operator ends it | Ending | stream |
//! | Moving | the axes stand, and a fault waited for that | Fault | stream, then as Fault |
//! | Moving | the axes stand, and the operator ends the program | Ending | stream |
//! | Moving | the axes stand at the end of the chain | Ready, or Returning to a pass | stream |
//! | Awaiting | the input is not what is waited for | Awaiting | stream |
//! | Ready | a tool is to be put in by hand, axes and spindle stand | ChangingTool | stream |
//! | Ready | the next block by hand is wanted | ByHand | stream |
//! | Ready | a reference run has found its place | Referencing | stream |
//! | Referencing | the measurement has the offset of the axis | Ready | **reference** |
//! | Moving | the jog key was let go, and the axes stand | Ready | stream |
//! | Dwelling, Awaiting, Paused, ChangingTool, ByHand | over, or the operator ends the program | Ready | stream |
//! | Arming | every axis is armed two ticks later | Armed | hold |
//! | Arming | one is not: a fault | Leaving for it | **call off**; **leave** once an axis moves |
//! | Armed | the operator holds or ends the program | CallingOff | **call off** |
//! | Armed | an axis has seen the index | Cutting | hold |
//! | CallingOff | two ticks later the law of the pass leads an axis all the same | Cutting | hold |
//! | CallingOff | every axis streams at the start of the pass | Ready | hold |
//! | Armed, CallingOff, Cutting | every axis streams at the end of the pass | Ready | hold |
//! | Armed, CallingOff, Cutting | an axis leaves the pass | Leaving | **leave** |
//! | Leaving, held | every axis rests | Returning; Ready at the end of the pass | hold |
//! | Leaving, stopped | every axis rests | Ending | hold |
//! | Leaving, for a fault | every axis that lives rests | Fault | hold |
//! | Returning | the tool is clear: a move to the start of the pass goes | as Moving | stream |
//! | Returning | released, every axis at the start of the pass | Ready | stream |
//! | Returning | the operator ends the program | Ending | stream |
//! | Ending | the spindle stands | Ended | stream |
//! | Arming, Armed, CallingOff | fault | Leaving for it | **call off**; **leave** once an axis moves |
//! | Cutting | fault | Leaving for it | **leave** |
//! | Moving | fault that leaves every axis able to move | Moving, brakes on its path | stream |
//! | any but Fault and Ended | fault | Fault | as below |
//!
//! In Fault the axes are told: to stop at once if one of them cannot
//! be led any more; to hold otherwise. The first fault is the one that stays, but a cause takes the place of
//! its consequence.
//!
//! An axis that leaves a pass by itself, for the panel or a fault, tells so; the interpolator tells the
//! others, which know as well. A pass that was left by a hold stays in hand: it is armed again from its
//! start, on the same groove. Whether a pass is over is judged by where the axes rest: its start and its end
//! are different places, so a pass that has been cut cannot be taken for one that was called off.

mod event;
mod order;

use protocol::{Axis, Cycle, Fault, MachineState, Position};

pub(crate) use event::{Await, Back, Event, InHand, Moved, Trouble, Wait, Way, Why};
pub(crate) use order::Order;

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
        /// It leads back to a pass that was left.
        back: Option<Back>,
    },
    /// Waits so many ticks.
    Dwelling {
        /// Ticks left.
        left: u64,
    },
    /// Waits for an input.
    Awaiting(Await),
    /// Waits for cycle start because the program says so.
    Paused {
        /// How often it had been pressed before.
        cycle_starts: u32,
    },
    /// Waits for cycle start, which says that the tool is in.
    ChangingTool {
        /// How often it had been pressed before.
        cycle_starts: u32,
    },
    /// Waits for the next block by hand.
    ByHand,
    /// A drive takes an offset that makes the position of its axis true.
    Referencing {
        /// The axis.
        axis: Axis,
        /// The offset.
        home_offset: Position,
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
    /// The regulators lead the tool out of a pass.
    Leaving {
        /// The pass.
        pass: InHand,
        /// Why.
        why: Why,
        /// How.
        way: Way,
    },
    /// A pass was left, is still in hand, and is to be entered again; the axes rest, the tool is clear.
    Returning {
        /// What it waits for.
        back: Back,
        /// The other axes are at its start, and nothing but that is missing.
        waits: bool,
    },
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
            (_, Task::Fault { order: Order::Stop, .. }) => Order::Stop,
            (Task::Moving { .. } | Task::Ready { .. } | Task::Returning { .. }, _) => Order::Stream,
            (_, Task::Fault { order, .. }) => *order,
            (_, Task::CallingOff { .. } | Task::Leaving { way: Way::CallOff, .. }) => Order::CallOff,
            (_, Task::Leaving { way: Way::Leave(at), .. }) => Order::Leave(*at),
            (Task::Referencing { axis, home_offset }, _) => Order::Reference(*axis, *home_offset),
            (Task::Enabling, _) => Order::Hold,
            // The setpoint of a tick in which a pass ends is of the time before it.
            (task, _) | (_, task) if task.pass().is_some() => Order::Hold,
            _ => Order::Stream,
        }
    }

    /// The state after an event; nothing if it stays as it is.
    fn next(&self, event: &Event) -> Option<Task> {
        let next = match (self, event) {
            (Task::Fault { .. } | Task::Ended { .. }, _) => return None,
            (_, Event::Fault(trouble)) => self.after_fault(trouble),
            (Task::Enabling, Event::Enabled) => Task::Starting,
            (Task::Starting, Event::Streaming) => Task::Ready { wait: Wait::No },
            (Task::Ready { wait: before }, Event::Waits(wait)) if before != wait => {
                Task::Ready { wait: *wait }
            }
            (Task::Ready { .. }, Event::Dwells(left)) => Task::Dwelling { left: *left },
            (Task::Ready { .. }, Event::Awaits(input)) => Task::Awaiting(*input),
            (Task::Awaiting(before), Event::Awaits(input)) if before != input => Task::Awaiting(*input),
            (Task::Ready { .. }, Event::Pauses(cycle_starts)) => Task::Paused { cycle_starts: *cycle_starts },
            (Task::Ready { .. }, Event::ChangesTool(cycle_starts)) => {
                Task::ChangingTool { cycle_starts: *cycle_starts }
            }
            (Task::Ready { .. }, Event::ByHand) => Task::ByHand,
            (Task::Ready { .. }, Event::Sets(axis, home_offset)) => {
                Task::Referencing { axis: *axis, home_offset: *home_offset }
            }
            (Task::Referencing { .. }, Event::IsSet) => Task::Ready { wait: Wait::No },
            (Task::Ready { .. }, Event::Pass(pass, sent)) => Task::Arming { pass: *pass, sent: *sent },
            (Task::Ready { .. }, Event::Ends(stopped)) => Task::Ending { stopped: *stopped },
            (Task::Ready { .. } | Task::Returning { .. }, Event::Moved(moved)) => moved.task(None),
            (Task::Moving { wait, fault, back }, Event::Moved(moved)) => {
                let same = (*wait, *back) == (moved.wait, moved.back);
                let as_before = !moved.stands && same && moved.fault.is_none();
                return (!as_before).then(|| moved.task(*fault));
            }
            (Task::Dwelling { left }, Event::Nothing) => Task::Dwelling { left: left.saturating_sub(1) },
            (
                Task::Dwelling { .. }
                | Task::Awaiting(_)
                | Task::Paused { .. }
                | Task::ChangingTool { .. }
                | Task::ByHand,
                Event::Over(wait),
            ) => Task::Ready { wait: *wait },
            (Task::Arming { pass, .. }, Event::Armed) => Task::Armed(*pass),
            (Task::Armed(pass), Event::TakenBack(sent)) => Task::CallingOff { pass: *pass, sent: *sent },
            (Task::Armed(pass) | Task::CallingOff { pass, .. }, Event::Begun) => Task::Cutting(*pass),
            (Task::CallingOff { .. }, Event::CalledOff) => Task::Ready { wait: Wait::No },
            (
                Task::Armed(_) | Task::CallingOff { .. } | Task::Cutting(_) | Task::Leaving { .. },
                Event::Cut(_) | Event::Leaves(..) | Event::Waiting(_) | Event::Left,
            ) => return self.out_of_pass(event),
            (Task::Returning { back: before, waits }, Event::Waiting(back)) if before != back || !waits => {
                Task::Returning { back: *back, waits: true }
            }
            (Task::Returning { .. }, Event::Returned) => Task::Ready { wait: Wait::No },
            (Task::Returning { .. }, Event::Ends(stopped)) => Task::Ending { stopped: *stopped },
            (Task::Ending { stopped }, Event::Stands) => Task::Ended { stopped: *stopped },
            _ => return None,
        };
        Some(next)
    }

    /// What follows a pass that has begun.
    fn out_of_pass(&self, event: &Event) -> Option<Task> {
        let next = match (self, event) {
            (Task::Leaving { pass, why, way: Way::CallOff }, Event::Leaves(_, at)) => {
                Task::Leaving { pass: *pass, why: *why, way: Way::Leave(*at) }
            }
            (Task::Leaving { pass, why: Why::Held(_), way }, Event::Waiting(back)) => {
                Task::Leaving { pass: *pass, why: Why::Held(*back), way: *way }
            }
            (Task::Leaving { why: Why::Held(back), .. }, Event::Left) => {
                Task::Returning { back: *back, waits: false }
            }
            (Task::Leaving { why: Why::Held(_), .. }, Event::Cut(wait)) => Task::Ready { wait: *wait },
            (Task::Leaving { why: Why::Stopped, .. }, Event::Left | Event::Cut(_)) => {
                Task::Ending { stopped: true }
            }
            (Task::Leaving { why: Why::Fault(fault), .. }, Event::Left | Event::Cut(_)) => {
                Task::Fault { fault: *fault, order: Order::Hold }
            }
            (Task::Leaving { .. }, _) => return None,
            (task, Event::Leaves(why, at)) => {
                Task::Leaving { pass: *task.pass()?, why: *why, way: Way::Leave(*at) }
            }
            (_, Event::Cut(wait)) => Task::Ready { wait: *wait },
            _ => return None,
        };
        Some(next)
    }

    /// The state after a fault. The first one stays, unless it was the consequence of this one.
    fn after_fault(&self, trouble: &Trouble) -> Task {
        let Trouble { fault, at_once, way, .. } = *trouble;
        match *self {
            Task::Moving { fault: before, .. } if at_once => {
                Task::Fault { fault: before.unwrap_or(fault), order: Order::Stop }
            }
            Task::Moving { wait, fault: before, back } => {
                Task::Moving { wait, fault: before.or(Some(fault)), back }
            }
            Task::Arming { pass, .. } | Task::Armed(pass) | Task::CallingOff { pass, .. } => {
                Task::Leaving { pass, why: Why::Fault(fault), way: Way::CallOff }
            }
            Task::Cutting(pass) => Task::Leaving { pass, why: Why::Fault(fault), way },
            Task::Leaving { pass, why, way: before } => {
                let first = match why {
                    Why::Fault(first) if first != Fault::AxisFault => first,
                    _ => fault,
                };
                Task::Leaving { pass, why: Why::Fault(first), way: before }
            }
            _ => Task::Fault { fault, order: if at_once { Order::Stop } else { Order::Hold } },
        }
    }

    /// The state as others see it.
    pub(crate) fn public(&self) -> MachineState {
        match self {
            Task::Enabling | Task::Starting => MachineState::Starting,
            Task::Ready { wait: Wait::No }
            | Task::Returning { back: Back::Goes, .. }
            | Task::Returning { waits: false, .. } => MachineState::Ready,
            Task::Moving { wait: Wait::No, .. } => MachineState::Moving,
            Task::Ready { .. } | Task::Moving { .. } | Task::Paused { .. } | Task::Returning { .. } => {
                MachineState::Paused
            }
            Task::ChangingTool { .. } => MachineState::ToolChange,
            Task::ByHand => MachineState::ByHand,
            Task::Dwelling { .. } | Task::Awaiting(_) | Task::Ending { .. } | Task::Referencing { .. } => {
                MachineState::Waiting
            }
            Task::Arming { .. }
            | Task::Armed(_)
            | Task::CallingOff { .. }
            | Task::Cutting(_)
            | Task::Leaving { .. } => MachineState::Threading,
            Task::Ended { .. } => MachineState::Ended,
            Task::Fault { .. } => MachineState::Fault,
        }
    }

    /// How often cycle start had been pressed when a wait for it began.
    pub(crate) fn waits_since(&self) -> Option<u32> {
        match self {
            Task::Paused { cycle_starts } | Task::ChangingTool { cycle_starts } => Some(*cycle_starts),
            _ => None,
        }
    }

    /// The pass in hand.
    pub(crate) fn pass(&self) -> Option<&InHand> {
        match self {
            Task::Arming { pass, .. }
            | Task::Armed(pass)
            | Task::CallingOff { pass, .. }
            | Task::Cutting(pass)
            | Task::Leaving { pass, .. } => Some(pass),
            _ => None,
        }
    }

    /// The fault that is latched.
    pub(crate) fn fault(&self) -> Option<Fault> {
        match self {
            Task::Fault { fault, .. } | Task::Leaving { why: Why::Fault(fault), .. } => Some(*fault),
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

#[cfg(test)]
mod tests;
