//! The states of an axis, and the one function that goes from one to the next.
//!
//! | from | when | to |
//! |---|---|---|
//! | Idle | drive enabled and the stream has begun | Streaming |
//! | Streaming | a pass arrives in time, the axis rests at its start | Armed |
//! | Streaming | a pass arrives too late, or starts elsewhere | Streaming (refused) |
//! | Armed | index at or after `not_before` (same-index rule) | WaitingForC0 |
//! | Armed, or as long as the spindle has not turned too far since the index | called off | Streaming |
//! | WaitingForC0 | C at its first angle | RunIn |
//! | RunIn | C at the end of approach and run-in | Locked |
//! | Locked | C where braking or retract begins | RunOut |
//! | RunOut | C where the law ends | Streaming, at rest at the end of the law |
//! | any but Fault | drive fault, encoder fault of the spindle, stop, servo error, starved stream | Fault |
//!
//! A pass is called off on every axis or on none: until when is an angle that all of them know, counted
//! without an estimate, and before it no axis moves; an axis without an approach may already be at depth
//! then.
//!
//! Fault is latched. A pass goes forward only; if the spindle turns back, the axis follows its law backwards
//! in the state it is in.

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
    /// Has a pass in hand.
    InPass {
        /// Which.
        pass: Pass,
        /// How far it is.
        stage: Stage,
    },
    /// Latched.
    Fault(Fault),
}

/// How far a pass is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Waits for the index.
    Armed,
    /// Counts C, waits for its first angle.
    WaitingForC0,
    /// Approach and run-in.
    RunIn,
    /// At depth, on the helix.
    Locked,
    /// Brakes, retracts.
    RunOut,
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
    /// The spindle has not turned too far since the index for the pass in hand to be called off.
    pub may_call_off: bool,
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
        let state = match self {
            State::Idle if event.enabled && event.stream_begun => State::Streaming,
            State::Streaming => return streaming(event, arm),
            State::InPass { stage: Stage::Armed, .. } if called_off => State::Streaming,
            State::InPass { .. } if called_off && event.may_call_off => State::Streaming,
            State::InPass { pass, stage } => in_pass(pass, stage, event),
            unchanged => unchanged,
        };
        (state, refused)
    }

    /// The pass in hand.
    pub fn pass(&self) -> Option<&Pass> {
        match self {
            State::InPass { pass, .. } => Some(pass),
            State::Idle | State::Streaming | State::Fault(_) => None,
        }
    }

    /// The state as others see it.
    pub fn public(&self) -> AxisState {
        match self {
            State::Idle => AxisState::Idle,
            State::Streaming => AxisState::Streaming,
            State::InPass { stage, .. } => stage.public(),
            State::Fault(_) => AxisState::Fault,
        }
    }
}

impl Stage {
    fn public(self) -> AxisState {
        match self {
            Stage::Armed => AxisState::Armed,
            Stage::WaitingForC0 => AxisState::WaitingForC0,
            Stage::RunIn => AxisState::RunIn,
            Stage::Locked => AxisState::Locked,
            Stage::RunOut => AxisState::RunOut,
        }
    }
}

/// A pass goes from stage to stage by its angle, and from the last one back to the stream.
fn in_pass(pass: Pass, stage: Stage, event: &Event) -> State {
    let c = event.angle_deg;
    let stage = match stage {
        Stage::Armed => return armed(pass, event.index),
        Stage::WaitingForC0 if c >= pass.law.begins_deg() => Stage::RunIn,
        Stage::RunIn if c >= pass.law.locked_deg() => Stage::Locked,
        Stage::Locked if c >= pass.law.leaves_deg() => Stage::RunOut,
        Stage::RunOut if c >= pass.law.done_deg() => return State::Streaming,
        unchanged => unchanged,
    };
    State::InPass { pass, stage }
}

fn streaming(event: &Event, arm: Option<AxisCommand>) -> (State, bool) {
    let Some(AxisCommand::Arm { pass, s_rpm, direction, not_before, law, .. }) = arm else {
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
    (State::InPass { pass, stage: Stage::Armed }, false)
}

/// The first index at or after `not_before` is the origin of C: the same one on every axis.
fn armed(mut pass: Pass, index: Option<Index>) -> State {
    match index {
        Some(index) if index.cycle >= pass.not_before => {
            pass.index_count = index.count;
            State::InPass { pass, stage: Stage::WaitingForC0 }
        }
        _ => State::InPass { pass, stage: Stage::Armed },
    }
}
