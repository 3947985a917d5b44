//! What regulators and the interpolator say of themselves, and the spindle command.

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    groove::Groove,
    message::Message,
    refused::{Refused, finite},
    units::Cycle,
};

/// State of a regulator, as others see it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum AxisState {
    /// The drive is not enabled yet.
    #[default]
    Idle = 0,
    /// Follows setpoints of timed motion.
    Streaming = 1,
    /// Has a pass, waits for the index.
    Armed = 2,
    /// Counts C from the index, waits for its first angle.
    WaitingForC0 = 3,
    /// Approach or run-in.
    RunIn = 4,
    /// On the helix.
    Locked = 5,
    /// Braking or retracting.
    RunOut = 6,
    /// Latched.
    Fault = 7,
    /// On its way out of a pass that is not finished, or braking because nothing more arrives.
    Leaving = 8,
}

impl AxisState {
    /// Whether the axis belongs to a pass, armed or on its way.
    pub fn is_in_pass(self) -> bool {
        self == AxisState::Armed || self.has_begun()
    }

    /// Whether the axis has seen the index of its pass, and not left the pass.
    pub fn has_begun(self) -> bool {
        use AxisState::{Leaving, Locked, RunIn, RunOut, WaitingForC0};
        matches!(self, WaitingForC0 | RunIn | Locked | RunOut | Leaving)
    }

    /// Every state in the order of its code.
    pub const ALL: [AxisState; 9] = [
        AxisState::Idle,
        AxisState::Streaming,
        AxisState::Armed,
        AxisState::WaitingForC0,
        AxisState::RunIn,
        AxisState::Locked,
        AxisState::RunOut,
        AxisState::Fault,
        AxisState::Leaving,
    ];

    /// The state of a code.
    ///
    /// # Errors
    /// [`Refused::UnknownCode`].
    pub fn from_code(code: u32) -> Result<AxisState, Refused> {
        AxisState::ALL.get(code as usize).copied().ok_or(Refused::UnknownCode { field: "axis state", code })
    }

    /// The name used in traces.
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 9] = [
            "idle",
            "streaming",
            "armed",
            "waiting-for-c0",
            "run-in",
            "locked",
            "run-out",
            "fault",
            "leaving",
        ];
        NAMES[self as usize]
    }
}

/// Why a module latched a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
#[allow(missing_docs)]
pub enum Fault {
    FollowingError = 1,
    ThreadError = 2,
    StreamStarved = 3,
    DriveFault = 4,
    Stopped = 5,
    SpindleNotAtSpeed = 6,
    AxisNotInPosition = 7,
    AxisFault = 8,
    PassCalledOff = 9,
    PassNotFeasible = 10,
    BadMachineCode = 11,
    IndexNotSeen = 12,
    TravelLimit = 13,
    MeasurementGap = 14,
    EncoderPlausibility = 15,
    PlanRejected = 16,
    EncoderPulsesLost = 17,
    EncoderPulsesGained = 18,
    EncoderGlitch = 19,
    EncoderIndexMissing = 20,
    EmergencyStop = 21,
    PowerLost = 22,
    RegulatorSilent = 23,
    SpindleReversed = 24,
    SpindleRunaway = 25,
    SpindleDoesNotStop = 26,
    EncoderStands = 27,
    AxisJump = 28,
    OtherAxis = 29,
    InterpolatorSilent = 30,
    ForceTooHigh = 31,
}

impl Fault {
    /// Every fault in the order of its code, which starts at 1.
    pub const ALL: [Fault; 31] = [
        Fault::FollowingError,
        Fault::ThreadError,
        Fault::StreamStarved,
        Fault::DriveFault,
        Fault::Stopped,
        Fault::SpindleNotAtSpeed,
        Fault::AxisNotInPosition,
        Fault::AxisFault,
        Fault::PassCalledOff,
        Fault::PassNotFeasible,
        Fault::BadMachineCode,
        Fault::IndexNotSeen,
        Fault::TravelLimit,
        Fault::MeasurementGap,
        Fault::EncoderPlausibility,
        Fault::PlanRejected,
        Fault::EncoderPulsesLost,
        Fault::EncoderPulsesGained,
        Fault::EncoderGlitch,
        Fault::EncoderIndexMissing,
        Fault::EmergencyStop,
        Fault::PowerLost,
        Fault::RegulatorSilent,
        Fault::SpindleReversed,
        Fault::SpindleRunaway,
        Fault::SpindleDoesNotStop,
        Fault::EncoderStands,
        Fault::AxisJump,
        Fault::OtherAxis,
        Fault::InterpolatorSilent,
        Fault::ForceTooHigh,
    ];

    /// The fault of a code; `None` for 0 and for what this version does not know.
    pub fn from_code(code: u32) -> Option<Fault> {
        Fault::ALL.get((code as usize).checked_sub(1)?).copied()
    }

    /// The stable name, as `summary.json` and traces print it.
    pub fn code(self) -> &'static str {
        match self {
            Fault::FollowingError => "following-error",
            Fault::ThreadError => "thread-error",
            Fault::StreamStarved => "stream-starved",
            Fault::DriveFault => "drive-fault",
            Fault::Stopped => "stopped",
            Fault::SpindleNotAtSpeed => "spindle-not-at-speed",
            Fault::AxisNotInPosition => "axis-not-in-position",
            Fault::AxisFault => "axis-fault",
            Fault::PassCalledOff => "pass-called-off",
            Fault::PassNotFeasible => "pass-not-feasible",
            Fault::BadMachineCode => "bad-machine-code",
            Fault::IndexNotSeen => "index-not-seen",
            Fault::TravelLimit => "travel-limit",
            Fault::MeasurementGap => "measurement-gap",
            Fault::EncoderPlausibility => "encoder-plausibility",
            Fault::PlanRejected => "plan-rejected",
            Fault::EncoderPulsesLost => "encoder-pulses-lost",
            Fault::EncoderPulsesGained => "encoder-pulses-gained",
            Fault::EncoderGlitch => "encoder-glitch",
            Fault::EncoderIndexMissing => "encoder-index-missing",
            Fault::EmergencyStop => "emergency-stop",
            Fault::PowerLost => "power-lost",
            Fault::RegulatorSilent => "regulator-silent",
            Fault::SpindleReversed => "spindle-reversed",
            Fault::SpindleRunaway => "spindle-runaway",
            Fault::SpindleDoesNotStop => "spindle-does-not-stop",
            Fault::EncoderStands => "encoder-stands",
            Fault::AxisJump => "axis-jump",
            Fault::OtherAxis => "other-axis",
            Fault::InterpolatorSilent => "interpolator-silent",
            Fault::ForceTooHigh => "force-too-high",
        }
    }

    /// What happened and what to look at.
    pub fn text(self) -> &'static str {
        match self {
            Fault::FollowingError => "the axis left its commanded position by more than following_error_mm",
            Fault::ThreadError => "the axis left the thread by more than thread_error_mm",
            Fault::StreamStarved => "no axis command arrived in time",
            Fault::DriveFault => "the drive reports a fault",
            Fault::Stopped => "a stop was commanded",
            Fault::SpindleNotAtSpeed => {
                "the spindle did not reach its speed; check load, encoder, ramp_rpm_s and override"
            }
            Fault::AxisNotInPosition => "an axis did not settle within in_position_mm",
            Fault::AxisFault => "a regulator reports a fault",
            Fault::PassCalledOff => {
                "a regulator did not arm in time; the pass was called off before it moved"
            }
            Fault::PassNotFeasible => "the axes cannot follow this pass at its programmed speed",
            Fault::BadMachineCode => "an item of the machine code was damaged or out of order",
            Fault::IndexNotSeen => "the spindle turns, but no index came; check the encoder",
            Fault::TravelLimit => "a target lies outside the travel of its axis",
            Fault::MeasurementGap => "a measurement is missing or out of order",
            Fault::EncoderPlausibility => {
                "the spindle turned back and did not meet its index where it had been; check the encoder and its cable"
            }
            Fault::PlanRejected => {
                "a planned motion did not keep its limits or its target when it was checked; the machine stopped"
            }
            Fault::EncoderPulsesLost => {
                "fewer counts than 4 encoder_lines between two indexes of the spindle; check that key, the encoder and its cable"
            }
            Fault::EncoderPulsesGained => {
                "more counts than 4 encoder_lines between two indexes of the spindle; check that key, the cable and its shield"
            }
            Fault::EncoderGlitch => {
                "the spindle encoder's count jumped by more than a spindle can turn; check the encoder, its cable and the shield"
            }
            Fault::EncoderIndexMissing => {
                "the spindle turned more than once without an index; check encoder_lines, the encoder's index and its cable"
            }
            Fault::EmergencyStop => "the emergency stop was pressed",
            Fault::PowerLost => "the mains have failed",
            Fault::RegulatorSilent => {
                "a regulator says nothing new: it has died, hangs, or its channel is cut"
            }
            Fault::SpindleReversed => {
                "the spindle turns the wrong way in a pass; check the wiring and direction of its drive"
            }
            Fault::SpindleRunaway => "the spindle turns faster than it was told to; check its drive",
            Fault::SpindleDoesNotStop => {
                "the spindle was told to stop and goes on turning; check its drive and brake"
            }
            Fault::EncoderStands => {
                "the spindle encoder stands although its drive is told to turn: the encoder or its cable is dead, or the spindle is jammed"
            }
            Fault::AxisJump => {
                "the position of the axis jumped by more than it can move; check its encoder, its scale and the cable"
            }
            Fault::OtherAxis => "another axis of the pass has failed: this one left the thread",
            Fault::InterpolatorSilent => {
                "the interpolator says nothing new: it has died, hangs, or its channel is cut"
            }
            Fault::ForceTooHigh => {
                "the axis needs more torque than it has although the spindle was slowed down; check depth of cut and tool"
            }
        }
    }
}

/// One regulator in one control cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct AxisStatus {
    /// The measurement this belongs to.
    pub cycle: Cycle,
    /// Code of the [`AxisState`].
    pub state: u32,
    /// Code of the latched [`Fault`], 0 for none.
    pub fault: u32,
    /// Pass being cut, 0 in timed motion; it stays until the next setpoint is followed.
    pub pass: u32,
    /// Line of the part program.
    pub line: u32,
    /// 1 if commanded still and within in_position_mm.
    pub in_position: u32,
    /// Packets refused so far.
    pub refused: u32,
    /// Commanded position at the sample instant, mm.
    pub commanded_mm: f64,
    /// Commanded speed at the sample instant (M8), mm/s.
    pub velocity_mm_s: f64,
    /// Commanded acceleration (M8), mm/s².
    pub acceleration_mm_s2: f64,
    /// Commanded jerk (M8), mm/s³.
    pub jerk_mm_s3: f64,
    /// Commanded minus measured position at the sample instant, mm.
    pub servo_error_mm: f64,
    /// Spindle angle since the index of the pass as observed, degrees.
    pub angle_deg: f64,
    /// Observed spindle speed, 1/min, signed by the spindle's direction.
    pub spindle_rpm: f64,
    /// 0x6040 as sent.
    pub control_word: u32,
    /// Counts of the spindle encoder too many, or too few (negative): with a fault of the encoder those it
    /// found, where they are known; else all that were corrected so far.
    pub encoder_counts: i32,
    /// 0x60FF as sent, mm/s.
    pub target_velocity_mm_s: f64,
    /// 0x60B1 as sent, mm/s.
    pub velocity_offset_mm_s: f64,
    /// 0x60B2 as sent, N·m.
    pub torque_offset_nm: f64,
}

impl Message for AxisStatus {
    const NAME: &str = "pitchlock/axis-status/2";
}

impl AxisStatus {
    /// The state; a code that nobody knows is a fault.
    pub fn state(&self) -> AxisState {
        AxisState::from_code(self.state).unwrap_or(AxisState::Fault)
    }
}

/// State of the interpolator, as others see it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum MachineState {
    /// Waits for the drives.
    #[default]
    Starting = 0,
    /// Between two items.
    Ready = 1,
    /// Timed motion.
    Moving = 2,
    /// Dwells, or waits for the spindle.
    Waiting = 3,
    /// Cuts a pass.
    Threading = 4,
    /// The program is over.
    Ended = 5,
    /// Latched.
    Fault = 6,
    /// Waits for cycle start.
    Paused = 7,
}

impl MachineState {
    /// The state of a code.
    ///
    /// # Errors
    /// [`Refused::UnknownCode`].
    pub fn from_code(code: u32) -> Result<MachineState, Refused> {
        Ok(match code {
            0 => MachineState::Starting,
            1 => MachineState::Ready,
            2 => MachineState::Moving,
            3 => MachineState::Waiting,
            4 => MachineState::Threading,
            5 => MachineState::Ended,
            6 => MachineState::Fault,
            7 => MachineState::Paused,
            other => return Err(Refused::UnknownCode { field: "machine state", code: other }),
        })
    }
}

/// The interpolator after one of its ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct MachineStatus {
    /// The tick.
    pub cycle: Cycle,
    /// Code of the [`MachineState`].
    pub state: u32,
    /// Code of the latched [`Fault`], 0 for none.
    pub fault: u32,
    /// Line of the part program being executed.
    pub line: u32,
    /// Pass being cut or cut last.
    pub pass: u32,
    /// Timed moves completed.
    pub moves: u64,
    /// Machine-code items taken and done, in steps of progress ([`Item::steps`](crate::Item::steps)).
    pub taken: u64,
    /// Overrides that were clamped so far.
    pub overrides_clamped: u32,
    /// 1 if the program was ended by the operator.
    pub stopped: u16,
    /// What cools: sum of [`MachineStatus::MIST`] and [`MachineStatus::FLOOD`].
    pub coolant: u16,
    /// Spindle speed commanded to the drive, 1/min, signed.
    pub spindle_rpm: f64,
    /// Spindle override in force, per cent.
    pub spindle_override_pct: f64,
    /// Feed override in force, per cent.
    pub feed_override_pct: f64,
    /// Depth of the pass in hand, mm.
    pub depth_mm: f64,
    /// How often the look-ahead ran dry while machine code was still to come: the machine stopped on its
    /// path, and went on when it was fed again.
    pub starved: u32,
    /// Which work of the program, from 1, the setpoint of this tick cuts; 0 if none, as on approaches and
    /// retracts. A feed hold on the way changes nothing.
    pub work: u32,
}

impl Message for MachineStatus {
    const NAME: &str = "pitchlock/machine-status/4";
}

impl MachineStatus {
    /// The state; a code that nobody knows is a fault.
    pub fn state(&self) -> MachineState {
        MachineState::from_code(self.state).unwrap_or(MachineState::Fault)
    }
}

impl MachineStatus {
    /// Mist is on (M7).
    pub const MIST: u16 = 1;
    /// Flood is on (M8).
    pub const FLOOD: u16 = 2;

    /// What cools as a sum of bits.
    pub fn coolant(mist: bool, flood: bool) -> u16 {
        u16::from(mist) * MachineStatus::MIST + u16::from(flood) * MachineStatus::FLOOD
    }
}

/// What the spindle drive shall do; the interpolator sends one each tick, the plant acts on it one
/// interpolator cycle later.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct SpindleCommand {
    /// The tick that made it.
    pub cycle: Cycle,
    /// Commanded speed, 1/min, signed: positive clockwise (M3).
    pub rpm: f64,
    /// Nonzero once the program is over and all is at rest: the machine may be switched off.
    pub finished: u32,
    /// Line of the part program being executed (scenarios are triggered by it).
    pub line: u32,
    /// Pass in hand from arming to its end; 0 without one, and in fault.
    pub pass: u32,
    /// Nonzero while the program waits for cycle start: somebody at the panel is wanted.
    pub paused: u32,
    /// First cycle whose index counts for the pass in hand.
    pub index_not_before: Cycle,
    /// Direction in which C grows in the pass in hand, ±1, else 0.
    pub direction: f64,
    /// The groove that the pass in hand cuts.
    pub groove: Groove,
}

impl Message for SpindleCommand {
    const NAME: &str = "pitchlock/spindle-command/3";
}

impl SpindleCommand {
    /// Refuses a speed that is not finite, and a groove that is none.
    ///
    /// # Errors
    /// [`Refused::NotFinite`], and what [`Groove::check`] refuses.
    pub fn check(&self) -> Result<(), Refused> {
        finite(self.rpm, "spindle speed")?;
        self.groove.check()
    }
}
