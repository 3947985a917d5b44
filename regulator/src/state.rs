//! The states of an axis, and the one function that goes from one to the next.
//!
//! | from | when | to |
//! |---|---|---|
//! | Idle | drive enabled and the stream has begun | Streaming |
//! | Streaming | a pass arrives in time, the axis rests at its start | Armed |
//! | Streaming | a pass arrives too late, or starts elsewhere | Streaming (refused) |
//! | Armed | index at or after `not_before` (same-index rule) | WaitingForC0 |
//! | Armed, WaitingForC0 | called off | Streaming |
//! | WaitingForC0 | C at its first angle | RunIn |
//! | RunIn | C at the end of approach and run-in | Locked |
//! | Locked | C where braking or retract begins | RunOut |
//! | RunOut | C where the law ends | Streaming, at rest at the end of the law |
//! | any but Fault | drive fault, encoder fault of the spindle, stop, servo error, starved stream | Fault |
//!
//! Fault is latched. A pass goes forward only; if the spindle turns back, the axis follows its law backwards in the
//! state it is in.

use motion::PassLaw;
use protocol::{AxisCommand, AxisLaw, AxisState, Cycle, Fault};

use crate::spindle::Index;

/// A pass as this axis cuts it. Angles in degrees since the index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Its number in the program.
    pub number: u32,
    /// 6 S: degrees per second at programmed speed.
    pub programmed_deg_s: f64,
    /// Direction in which C grows, ±1.
    pub direction: f64,
    /// First cycle whose index counts.
    pub not_before: Cycle,
    /// Count of the index C is counted from; valid from WaitingForC0 on.
    pub index_count: i64,
    /// The law as it came.
    pub law: AxisLaw,
    /// The law to evaluate.
    pub motion: PassLaw,
}

/// State of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // there is one of it, and it must not allocate
pub enum State {
    /// The drive is not enabled; commanded follows measured.
    Idle,
    /// Follows the setpoints of timed motion.
    Streaming,
    /// Waits for the index.
    Armed(Pass),
    /// Counts C, waits for its first angle.
    WaitingForC0(Pass),
    /// Approach and run-in.
    RunIn(Pass),
    /// At depth, on the helix.
    Locked(Pass),
    /// Brakes, retracts.
    RunOut(Pass),
    /// Latched.
    Fault(Fault),
}

/// What a transition depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// The cycle.
    pub cycle: Cycle,
    /// The drive is in operation.
    pub enabled: bool,
    /// Something is wrong that ends every state.
    pub fault: Option<Fault>,
    /// The stream holds setpoints for the present.
    pub stream_begun: bool,
    /// The axis rests where a pass that arrives would start.
    pub rests_at_start: bool,
    /// The command of this cycle, if it has one.
    pub command: Option<AxisCommand>,
    /// The last index.
    pub index: Option<Index>,
    /// C of the pass in hand (its last value while there is no index), degrees.
    pub angle_deg: f64,
}

impl Pass {
    /// How far the axis goes for each degree at an angle since the index, mm.
    pub fn mm_per_degree(&self, angle_deg: f64) -> f64 {
        self.motion.at(angle_deg).v / self.programmed_deg_s
    }
}

impl State {
    /// The state after an event, and whether a pass was refused.
    pub fn next(self, event: &Event) -> (State, bool) {
        if let (Some(fault), false) = (event.fault, matches!(self, State::Fault(_))) {
            return (State::Fault(fault), false);
        }
        if let (Some(AxisCommand::Stop), false) = (event.command, matches!(self, State::Fault(_))) {
            return (State::Fault(Fault::Stopped), false);
        }
        let arm = match event.command {
            Some(AxisCommand::Arm { .. }) => event.command,
            _ => None,
        };
        let refused = arm.is_some() && !matches!(self, State::Streaming);
        let called_off = matches!(event.command, Some(AxisCommand::CallOff));
        let c = event.angle_deg;
        let state = match self {
            State::Idle if event.enabled && event.stream_begun => State::Streaming,
            State::Streaming => return streaming(event, arm),
            State::Armed(_) | State::WaitingForC0(_) if called_off => State::Streaming,
            State::Armed(pass) => armed(pass, event.index),
            State::WaitingForC0(pass) if c >= pass.law.begins_deg() => State::RunIn(pass),
            State::RunIn(pass) if c >= pass.law.locked_deg() => State::Locked(pass),
            State::Locked(pass) if c >= pass.law.leaves_deg() => State::RunOut(pass),
            State::RunOut(pass) if c >= pass.law.done_deg() => State::Streaming,
            unchanged => unchanged,
        };
        (state, refused)
    }

    /// The pass in hand.
    pub fn pass(&self) -> Option<&Pass> {
        match self {
            State::Armed(pass)
            | State::WaitingForC0(pass)
            | State::RunIn(pass)
            | State::Locked(pass)
            | State::RunOut(pass) => Some(pass),
            State::Idle | State::Streaming | State::Fault(_) => None,
        }
    }

    /// The state as others see it.
    pub fn public(&self) -> AxisState {
        match self {
            State::Idle => AxisState::Idle,
            State::Streaming => AxisState::Streaming,
            State::Armed(_) => AxisState::Armed,
            State::WaitingForC0(_) => AxisState::WaitingForC0,
            State::RunIn(_) => AxisState::RunIn,
            State::Locked(_) => AxisState::Locked,
            State::RunOut(_) => AxisState::RunOut,
            State::Fault(_) => AxisState::Fault,
        }
    }
}

fn streaming(event: &Event, arm: Option<AxisCommand>) -> (State, bool) {
    let Some(AxisCommand::Arm { pass, s_rpm, direction, not_before, law }) = arm else {
        return (State::Streaming, false);
    };
    if event.cycle > not_before || !event.rests_at_start {
        return (State::Streaming, true);
    }
    let pass = Pass {
        number: pass,
        programmed_deg_s: 6.0 * s_rpm,
        direction,
        not_before,
        index_count: 0,
        law,
        motion: law.law(s_rpm),
    };
    (State::Armed(pass), false)
}

/// The first index at or after `not_before` is the origin of C: the same one on every axis.
fn armed(mut pass: Pass, index: Option<Index>) -> State {
    match index {
        Some(index) if index.cycle >= pass.not_before => {
            pass.index_count = index.count;
            State::WaitingForC0(pass)
        }
        _ => State::Armed(pass),
    }
}
