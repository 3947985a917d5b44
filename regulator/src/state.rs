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
//! | RunIn … RunOut of a tap | C back at the start, the spindle turned round | Streaming, at rest there |
//! | WaitingForC0 … RunOut | something makes the axes leave | Leaving |
//! | Streaming | a fault, a stop, emergency stop, a stream that runs dry | Leaving |
//! | Leaving | at rest, no fault | Streaming, at rest where it stands |
//! | Leaving | at rest, with a fault | Fault |
//! | Idle, Armed | a fault, a stop | Fault |
//! | any but Fault | the axis cannot be led any more | Fault |
//!
//! A pass is called off on every axis or on none: until when is an angle that all of them know, counted
//! without an estimate, and before it no axis moves; an axis without an approach may already be at depth
//! then. How an axis leaves is the matter of `leave.rs`.
//!
//! Fault is latched. A pass goes forward only; if the spindle turns back, the axis follows its law backwards
//! in the state it is in. A pass that returns (a tap) goes back as well: its state is that of its place.

use motion::{PassLaw, Sample};
use protocol::{AxisCommand, AxisLaw, AxisState, ControlWord, Cycle, Fault, Returning, WayOut};

use crate::leave::{Cause, Leaving, Way};
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
    /// Of one that returns: the spindle has turned round.
    pub turned: bool,
    /// The way out of it.
    pub out: WayOut,
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
    /// On its way out.
    Leaving(Leaving),
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
pub struct Event<'a> {
    /// The cycle.
    pub cycle: Cycle,
    /// The drive is in operation.
    pub enabled: bool,
    /// Something ends what the axis does.
    pub cause: Option<Cause>,
    /// The way out from here, if there is a cause to leave.
    pub way: Option<Way>,
    /// The axis that lifts the tool is out of the groove, and this one can brake so.
    pub brake: Option<Way>,
    /// The timed way, or what is left of the stream, is over.
    pub rests: bool,
    /// The tool is in the groove yet, and the axis that lifts it is on its way: who is done waits with
    /// torque.
    pub waits: bool,
    /// The stream holds setpoints for the present.
    pub stream_begun: bool,
    /// The axis rests where a pass that arrives would start.
    pub rests_at_start: bool,
    /// The command of this cycle, if it has one.
    pub command: Option<&'a AxisCommand>,
    /// The last index.
    pub index: Option<Index>,
    /// C of the pass in hand (its last value while there is no index), degrees.
    pub angle_deg: f64,
    /// The spindle has not turned too far since the index for the pass in hand to be called off.
    pub may_call_off: bool,
    /// The spindle turns against the direction of the pass in hand.
    pub turns_back: bool,
}

impl Pass {
    /// Whether this axis lifts the tool off. None does in a pass that returns.
    pub fn lifts(&self, axis: usize) -> bool {
        self.out.axis as usize == axis && !self.returns()
    }

    /// Whether it is a tap.
    pub fn returns(&self) -> bool {
        self.out.on(WayOut::RETURNS)
    }

    /// Where the law has the axis at an angle since the index, mm.
    pub fn place(&self, angle_deg: f64) -> f64 {
        self.law.start.mm() + self.motion.at(angle_deg).s
    }

    /// Largest acceleration of the stroke of a stage, or the one that follows it, at a speed of the spindle,
    /// degrees/s: 2π L/t² (M2), mm/s².
    pub(crate) fn hardest(&self, stage: Stage, speed: f64) -> f64 {
        let law = &self.law;
        let (mm, deg) = match stage {
            Stage::Armed | Stage::WaitingForC0 | Stage::RunIn => (law.stroke_mm, law.stroke_dc_deg),
            Stage::Locked | Stage::RunOut => (law.retract_mm, law.retract_dc_deg),
        };
        if mm == 0.0 { 0.0 } else { core::f64::consts::TAU * mm.abs() * (speed / deg).powi(2) }
    }

    /// How far the axis goes for each degree at an angle since the index, mm.
    pub fn mm_per_degree(&self, angle_deg: f64) -> f64 {
        self.motion.at(angle_deg).v / self.programmed_deg_s
    }
}

impl State {
    /// Goes on to the state after an event; whether a pass was refused. Mostly little changes in a cycle, and
    /// a state holds a whole pass: it is changed where it lies.
    pub fn step(&mut self, event: &Event) -> bool {
        let stopped = matches!(event.command, Some(AxisCommand::Stop));
        let cause = event.cause.or(stopped.then_some(Cause::Leave(Some(Fault::Stopped))));
        if let Some(cause) = cause {
            *self = self.ended(cause, event);
        }
        let called_off = matches!(event.command, Some(AxisCommand::CallOff));
        let next = match self {
            State::Idle => (event.enabled && event.stream_begun).then_some(State::Streaming),
            State::Streaming => arm(event),
            State::InPass { stage: Stage::Armed, .. } if called_off => Some(State::Streaming),
            State::InPass { .. } if called_off && event.may_call_off => Some(State::Streaming),
            State::InPass { pass, stage } => in_pass(pass, stage, event),
            State::Leaving(leaving) => leaving.step(event),
            State::Fault(_) => None,
        };
        let arms = matches!(next, Some(State::InPass { .. }));
        if let Some(next) = next {
            *self = next;
        }
        !arms && matches!(event.command, Some(AxisCommand::Arm { .. }))
    }

    /// What becomes of a state that something ends. What ended it first stays its fault.
    fn ended(&self, cause: Cause, event: &Event) -> State {
        match (*self, cause) {
            (State::Fault(_), _) => *self,
            (State::Leaving(leaving), Cause::Lost(fault)) => State::Fault(leaving.fault.unwrap_or(fault)),
            (_, Cause::Lost(fault)) => State::Fault(fault),
            (State::Leaving(leaving), Cause::Leave(fault)) => {
                State::Leaving(Leaving { fault: leaving.fault.or(fault), ..leaving })
            }
            (State::Idle | State::InPass { stage: Stage::Armed, .. }, Cause::Leave(Some(fault))) => {
                State::Fault(fault)
            }
            (State::Streaming, Cause::Leave(fault @ Some(_))) => {
                State::Leaving(Leaving { pass: None, way: Way::Dry, fault })
            }
            (State::InPass { pass, stage }, Cause::Leave(fault)) if stage != Stage::Armed => {
                let way = event.way.unwrap_or(Way::Along(stage));
                State::Leaving(Leaving { pass: Some(pass), way, fault })
            }
            // It is told to, and nothing has moved.
            (State::InPass { .. }, Cause::Leave(None)) => State::Streaming,
            (unchanged, Cause::Leave(_)) => unchanged,
        }
    }

    /// The pass in hand.
    pub fn pass(&self) -> Option<&Pass> {
        match self {
            State::InPass { pass, .. } => Some(pass),
            State::Leaving(leaving) => leaving.pass.as_ref(),
            State::Idle | State::Streaming | State::Fault(_) => None,
        }
    }

    /// The fault that is latched, or will be once the axis has left.
    pub fn fault(&self) -> Option<Fault> {
        match self {
            State::Fault(fault) => Some(*fault),
            State::Leaving(leaving) => leaving.fault,
            State::Idle | State::Streaming | State::InPass { .. } => None,
        }
    }

    /// What a fault asks of the drive. Stop category 1: without mains and with the emergency stop it goes off
    /// once the axes rest.
    pub fn stops(&self) -> Option<ControlWord> {
        match self {
            State::Fault(Fault::EmergencyStop | Fault::PowerLost) => Some(ControlWord::DisableVoltage),
            State::Fault(_) => Some(ControlWord::QuickStop),
            _ => None,
        }
    }

    /// The state as others see it.
    pub fn public(&self) -> AxisState {
        match self {
            State::Idle => AxisState::Idle,
            State::Streaming => AxisState::Streaming,
            State::InPass { stage, .. } => stage.public(),
            State::Leaving(_) => AxisState::Leaving,
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
fn in_pass(pass: &mut Pass, stage: &mut Stage, event: &Event) -> Option<State> {
    if *stage == Stage::Armed {
        // The first index at or after `not_before` is the origin of C: the same one on every axis.
        if let Some(index) = event.index.filter(|index| index.cycle >= pass.not_before) {
            pass.index_count = index.count;
            *stage = Stage::WaitingForC0;
        }
        return None;
    }
    pass.turned |= event.turns_back;
    match stage.next(pass, event.angle_deg) {
        Some(next) => *stage = next,
        None => return Some(State::Streaming),
    }
    None
}

impl Stage {
    /// The stage at an angle; nothing once the law is over.
    fn next(self, pass: &Pass, c: f64) -> Option<Stage> {
        let law = &pass.law;
        if pass.returns() {
            return self.returning(law.returning(c, pass.turned), pass.turned);
        }
        Some(match self {
            Stage::WaitingForC0 if c >= law.begins_deg() => Stage::RunIn,
            Stage::RunIn if c >= law.locked_deg() => Stage::Locked,
            Stage::Locked if c >= law.leaves_deg() => Stage::RunOut,
            Stage::RunOut if c >= law.done_deg() => return None,
            unchanged => unchanged,
        })
    }

    /// The same of a pass that returns, by the place that it is at.
    fn returning(self, place: Returning, turned: bool) -> Option<Stage> {
        match place {
            Returning::AtStart if turned && self != Stage::WaitingForC0 => None,
            Returning::AtStart => Some(self),
            Returning::RunsIn => Some(Stage::RunIn),
            Returning::OnHelix => Some(Stage::Locked),
            Returning::Beyond | Returning::RunsOut => Some(Stage::RunOut),
        }
    }
}

impl Leaving {
    /// Goes on for a cycle on the way; the state behind it, if it is over.
    fn step(&mut self, event: &Event) -> Option<State> {
        let along = match (self.way, &mut self.pass) {
            (Way::Along(stage), Some(pass)) => {
                pass.turned |= event.turns_back;
                stage.next(pass, event.angle_deg).map(Way::Along)
            }
            _ => (!event.rests).then_some(self.way),
        };
        let way = match along {
            Some(Way::Along(_)) => event.brake.or(along),
            None if event.waits => Some(self.way),
            other => other,
        };
        match (way, self.fault) {
            (Some(way), _) => self.way = way,
            (None, Some(fault)) => return Some(State::Fault(fault)),
            (None, None) => return Some(State::Streaming),
        }
        None
    }
}

/// An axis that streams takes a pass in hand, if one arrives that it can cut.
fn arm(event: &Event) -> Option<State> {
    let Some(AxisCommand::Arm { pass, s_rpm, direction, not_before, out, law, changes }) = event.command
    else {
        return None;
    };
    if event.cycle > *not_before || !event.rests_at_start {
        return None;
    }
    let pass = Pass {
        number: *pass,
        programmed_deg_s: 6.0 * s_rpm,
        direction: *direction,
        not_before: *not_before,
        index_count: 0,
        turned: false,
        out: *out,
        law: *law,
        motion: law.changing(*s_rpm, changes),
    };
    Some(State::InPass { pass, stage: Stage::Armed })
}

/// Whether the commanded axis rests where the pass in `command` starts. One count of the wire is allowed for
/// the rounding of setpoints.
pub(crate) fn rests_at(now: &Sample, command: Option<&AxisCommand>) -> bool {
    let Some(AxisCommand::Arm { law, .. }) = command else { return false };
    now.v == 0.0 && now.a == 0.0 && (now.s - law.start.mm()).abs() < 2e-9
}
