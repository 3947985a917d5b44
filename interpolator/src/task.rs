//! What the interpolator is doing, as one enum.
//!
//! | from | when | to |
//! |---|---|---|
//! | Starting | every axis streams | Ready |
//! | Ready | a line, an arc or a trace is next (and the spindle at speed, for a feed) | Moving |
//! | Ready | a dwell is next | Dwelling |
//! | Ready | a pause is next | Paused |
//! | Ready | a pass is next, spindle at speed, axes at its start and in position | Arming |
//! | Ready | the program ends, or the operator stops it | Ending |
//! | Moving | the end of the chain of moves | Ready |
//! | Moving | stop or abort, and the axes stand on their path | Ending |
//! | Moving | a move that cannot be made, and the axes stand before it | Fault |
//! | Dwelling | time over | Ready |
//! | Paused | cycle start, or stop | Ready |
//! | Arming | every axis armed two ticks later | Threading |
//! | Arming | one is not | Fault (called off on every axis before anything moves) |
//! | Threading | every axis streams again | Ready |
//! | Ending | the spindle stands | Ended |
//! | any | an axis faults, bad machine code, a wait without end | Fault |

use protocol::{Cycle, Fault, MachineState, ThreadPass};

/// What the interpolator is doing.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // there is one of it, and it must not allocate
pub(crate) enum Task {
    /// Waits for the drives.
    Starting,
    /// At rest, the next item may begin.
    Ready,
    /// A chain of moves is under way.
    Moving,
    /// Waits so many ticks.
    Dwelling {
        /// Ticks left.
        left: u64,
    },
    /// Waits for cycle start.
    Paused {
        /// How often it had been pressed before.
        cycle_starts: u32,
    },
    /// A pass was sent at tick `sent`.
    Arming {
        /// The pass.
        pass: ThreadPass,
        /// The tick that sent it.
        sent: Cycle,
    },
    /// The regulators cut a pass.
    Threading {
        /// The pass.
        pass: ThreadPass,
    },
    /// The program is over, the spindle runs down.
    Ending,
    /// All is at rest.
    Ended,
    /// Latched; the spindle runs down.
    Fault {
        /// Why.
        fault: Fault,
        /// Axes are in a pass: those that can follow their laws while the spindle runs down.
        threading: bool,
    },
}

impl Task {
    /// The state as others see it.
    pub(crate) fn public(&self) -> MachineState {
        match self {
            Task::Starting => MachineState::Starting,
            Task::Ready => MachineState::Ready,
            Task::Moving => MachineState::Moving,
            Task::Dwelling { .. } => MachineState::Waiting,
            Task::Paused { .. } => MachineState::Paused,
            Task::Arming { .. } | Task::Threading { .. } => MachineState::Threading,
            Task::Ending => MachineState::Waiting,
            Task::Ended => MachineState::Ended,
            Task::Fault { .. } => MachineState::Fault,
        }
    }

    /// The pass in hand.
    pub(crate) fn pass(&self) -> Option<&ThreadPass> {
        match self {
            Task::Arming { pass, .. } | Task::Threading { pass } => Some(pass),
            _ => None,
        }
    }
}
