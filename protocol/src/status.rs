//! What regulators and the interpolator say of themselves, and the spindle command.

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    code::ANALOG_OUTPUTS,
    groove::Groove,
    message::Message,
    refused::{Refused, finite},
    units::{Axis, Cycle},
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

/// One regulator in one control cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct AxisStatus {
    /// The measurement this belongs to.
    pub cycle: Cycle,
    /// Code of the [`AxisState`].
    pub state: u32,
    /// Code of the latched [`Fault`](crate::Fault), 0 for none.
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
    /// At rest, for whoever works by hand: waits for the next block.
    ByHand = 8,
    /// At rest, waits for cycle start: [`MachineStatus::tool`] is to be put in by hand.
    ToolChange = 9,
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
            8 => MachineState::ByHand,
            9 => MachineState::ToolChange,
            other => return Err(Refused::UnknownCode { field: "machine state", code: other }),
        })
    }

    /// Whether nothing goes on until somebody presses cycle start.
    pub fn waits_for_start(self) -> bool {
        matches!(self, MachineState::Paused | MachineState::ToolChange)
    }
}

/// How the setpoint of a tick moves the axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Motion {
    /// Not at all; and in a pass, of which the axes tell by their state.
    #[default]
    None = 0,
    /// In rapid motion.
    Rapid = 1,
    /// At a feed.
    Feed = 2,
}

impl Motion {
    /// Every kind in the order of its code.
    pub const ALL: [Motion; 3] = [Motion::None, Motion::Rapid, Motion::Feed];

    /// The kind of a code.
    ///
    /// # Errors
    /// [`Refused::UnknownCode`].
    pub fn from_code(code: u32) -> Result<Motion, Refused> {
        Motion::ALL.get(code as usize).copied().ok_or(Refused::UnknownCode { field: "motion", code })
    }

    /// The name used in traces.
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 3] = ["none", "rapid", "feed"];
        NAMES[self as usize]
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
    /// Code of the latched [`Fault`](crate::Fault), 0 for none.
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
    pub stopped: u8,
    /// The axis that the fault is about: its index and one more; 0 where none is known.
    pub fault_axis: u8,
    /// What cools: sum of [`MachineStatus::MIST`] and [`MachineStatus::FLOOD`].
    pub coolant: u8,
    /// The axes whose reference run is still to be made: bit n is axis n in the order of the wire.
    pub unreferenced: u8,
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
    /// Number of the tool that is in the spindle or the holder, or in [`MachineState::ToolChange`] of the one
    /// that is to be put in; 0 if none was selected, or none is to be in it.
    pub tool: u32,
    /// Code of the [`Motion`] of the setpoint of this tick. A feed hold on the way changes nothing.
    pub motion: u32,
    /// The digital outputs that are on: bit n is output n.
    pub outputs: u64,
    /// The analog outputs, by number, in the units of the machine file.
    pub analog: [f64; ANALOG_OUTPUTS as usize],
}

impl Message for MachineStatus {
    const NAME: &str = "pitchlock/machine-status/9";
}

impl MachineStatus {
    /// The state; a code that nobody knows is a fault.
    pub fn state(&self) -> MachineState {
        MachineState::from_code(self.state).unwrap_or(MachineState::Fault)
    }

    /// The motion; a code that nobody knows is none.
    pub fn motion(&self) -> Motion {
        Motion::from_code(self.motion).unwrap_or_default()
    }
}

impl MachineStatus {
    /// Mist is on (M7).
    pub const MIST: u8 = 1;
    /// Flood is on (M8).
    pub const FLOOD: u8 = 2;

    /// What cools as a sum of bits.
    pub fn coolant(mist: bool, flood: bool) -> u8 {
        u8::from(mist) * MachineStatus::MIST + u8::from(flood) * MachineStatus::FLOOD
    }

    /// Whether the reference run of an axis is still to be made.
    pub fn is_unreferenced(&self, axis: Axis) -> bool {
        self.unreferenced >> axis.index() & 1 != 0
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
    /// [`SpindleCommand::FINISHED`] once the program is over and all is at rest: the machine may be switched
    /// off. [`SpindleCommand::EMERGENCY_STOP`] once the spindle does not obey. Anything else says nothing, so
    /// that no single damaged bit ends a run.
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
    /// Says that the machine may be switched off.
    pub const FINISHED: u32 = 0x4F56_4552;
    /// Opens the emergency stop chain: as the button at the panel.
    pub const EMERGENCY_STOP: u32 = 0x5354_4F50;

    /// Whether the machine may be switched off: the program is over, nothing turns, no pass is in hand.
    pub fn is_last(&self) -> bool {
        self.finished == SpindleCommand::FINISHED && self.rpm == 0.0 && self.pass == 0
    }

    /// Refuses a speed that is not finite, and a groove that is none.
    ///
    /// # Errors
    /// [`Refused::NotFinite`], and what [`Groove::check`] refuses.
    pub fn check(&self) -> Result<(), Refused> {
        finite(self.rpm, "spindle speed")?;
        self.groove.check()
    }
}
