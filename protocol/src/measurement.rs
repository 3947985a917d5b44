//! What the machine measures in one control cycle: spindle and axis encoders, drives, operator panel.

use core::mem::offset_of;

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    drive::StatusWord,
    message::Message,
    seal::seal,
    units::{Cycle, PerAxis, Position},
};

/// One axis as its encoder and drive see it.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct AxisMeasurement {
    /// Measured position: encoder counts, scaled by the drive (middle of the count).
    pub position: Position,
    /// Position by the linear scale at the slide (middle of its step); the same as `position` on an axis
    /// without one.
    pub scale: Position,
    /// Actual torque of the motor, N·m.
    pub torque_nm: f64,
    /// CiA 402 status word (object 0x6041).
    pub status_word: u32,
    /// [`AxisMeasurement::SWITCH`], and above it the indexes that the motor has passed, in either direction.
    pub signals: u32,
}

/// What a reference run asks of an axis; zero on one without a reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct AxisReference {
    /// [`DriveCommand::home_offset`](crate::DriveCommand) as it is in every position of this measurement.
    pub home_offset: Position,
    /// Position of the axis (of its scale, if it has one) when the switch went on last (0x60BA).
    pub switched_at: Position,
    /// The same when the motor passed its index last.
    pub indexed_at: Position,
}

impl AxisMeasurement {
    /// Bit of `signals`: the reference switch is on.
    pub const SWITCH: u32 = 1;

    /// The word of a switch and of so many indexes.
    pub fn signals(switch: bool, indexes: u32) -> u32 {
        indexes << 1 | u32::from(switch)
    }

    /// Whether the reference switch is on.
    pub fn is_switched(&self) -> bool {
        self.signals & AxisMeasurement::SWITCH != 0
    }

    /// How many indexes the motor has passed, from 0 again after 2³¹.
    pub fn indexes(&self) -> u32 {
        self.signals >> 1
    }

    /// What the drive says of itself.
    pub fn drive(&self) -> StatusWord {
        StatusWord(self.status_word as u16)
    }
}

/// The operator's panel, sampled with the encoders: an action takes effect in the cycle it was sampled in.
#[derive(Clone, Copy, Debug, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Panel {
    /// Spindle override, per cent of S, 0 to 200.
    pub spindle_override_pct: f64,
    /// Feed override, per cent of F, 0 to 200.
    pub feed_override_pct: f64,
    /// Rapid override, per cent, 0 to 100.
    pub rapid_override_pct: f64,
    /// Sum of [`Panel::FEED_HOLD`], [`Panel::STOP`], [`Panel::SINGLE_BLOCK`], [`Panel::ABORT`],
    /// [`Panel::EMERGENCY_STOP`], [`Panel::POWER_LOST`], [`Panel::JOG`], [`Panel::BLOCK`] and
    /// [`Panel::PASSES_M1`].
    pub buttons: u32,
    /// How often cycle start was pressed. A count, so that no press is lost between two looks at the panel.
    pub cycle_starts: u32,
}

impl Panel {
    /// Feed hold is on: timed motion comes to rest, a thread goes on to its end.
    pub const FEED_HOLD: u32 = 1;
    /// Motion stops on its path, then the program ends; a thread is left, or cut to its end first. It stays
    /// pressed.
    pub const STOP: u32 = 2;
    /// Single block is on: after each move the program waits for cycle start.
    pub const SINGLE_BLOCK: u32 = 4;
    /// The program is to be ended at once: motion stops on its path, spindle and coolant go off.
    pub const ABORT: u32 = 8;
    /// Emergency stop, stop category 1: the tool leaves a thread while the spindle runs down, axes in timed
    /// motion brake, then the drives go off. It stays pressed.
    pub const EMERGENCY_STOP: u32 = 16;
    /// The mains have failed: the drives have torque for as long as their link holds. It stays.
    pub const POWER_LOST: u32 = 32;
    /// The jog key is pressed: a move by hand that asks for it goes on. The panel lets go of it by itself
    /// when nobody has confirmed it for [`Panel::JOG_SILENT_S`].
    pub const JOG: u32 = 64;
    /// Whether the number of blocks that were given by hand is odd: it changes when one is there to be begun.
    pub const BLOCK: u32 = 128;
    /// The optional stop is off: the program does not wait at an M1 that it comes to.
    pub const PASSES_M1: u32 = 256;
    /// So long the jog key stays pressed with nobody to confirm it, s on the machine.
    pub const JOG_SILENT_S: f64 = 0.08;

    /// Whether a button is pressed.
    pub fn pressed(&self, button: u32) -> bool {
        self.buttons & button != 0
    }

    /// Presses a button, or releases it.
    pub fn press(&mut self, button: u32, on: bool) {
        if on { self.buttons |= button } else { self.buttons &= !button }
    }

    /// Presses cycle start, which also releases feed hold.
    pub fn start_cycle(&mut self) {
        self.press(Panel::FEED_HOLD, false);
        self.cycle_starts = self.cycle_starts.wrapping_add(1);
    }
}

impl Default for Panel {
    fn default() -> Self {
        Panel {
            spindle_override_pct: 100.0,
            feed_override_pct: 100.0,
            rapid_override_pct: 100.0,
            buttons: 0,
            cycle_starts: 0,
        }
    }
}

/// What was true at one control cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Measurement {
    /// When it was true.
    pub cycle: Cycle,
    /// Spindle encoder, unwrapped counts (4 per line), growing clockwise (M3).
    pub spindle_count: i64,
    /// Count latched at the last index.
    pub index_count: i64,
    /// Indexes seen since the start of the machine; 0 means that `index_count` is not valid yet.
    pub index_number: u64,
    /// First cycle whose measurement shows that index.
    pub index_cycle: Cycle,
    /// Nonzero in the last measurement of the run: everybody answers it and ends.
    pub last: u32,
    /// The seal, see [`Measurement::sealed`].
    pub check: u32,
    /// The axes.
    pub axes: PerAxis<AxisMeasurement>,
    /// The operator's panel.
    pub panel: Panel,
    /// The digital inputs that are on: bit n is input n.
    pub inputs: u64,
    /// What reference runs ask.
    pub references: PerAxis<AxisReference>,
}

impl Measurement {
    /// The word of eight bytes whose upper half is the seal.
    const SEAL: usize = offset_of!(Measurement, check) / 8;

    /// The same with its seal, ready to be sent.
    #[must_use]
    pub fn sealed(self) -> Measurement {
        Measurement { check: seal(self.as_bytes(), Measurement::SEAL), ..self }
    }

    /// Whether it has arrived as it was sent.
    pub fn is_whole(&self) -> bool {
        self.check == seal(self.as_bytes(), Measurement::SEAL)
    }
}

impl Message for Measurement {
    const NAME: &str = "pitchlock/measurement/7";
}

/// Where the spindle stands on average while its encoder shows a count: in the middle of it, counts.
pub fn middle_of(count: i64) -> f64 {
    count as f64 + 0.5
}
