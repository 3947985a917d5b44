//! What a regulator tells its drive, as a CiA 402 drive in cyclic synchronous velocity mode understands it.
//!
//! Objects: 0x6040 control word, 0x6041 status word, 0x60FF target velocity, 0x60B1 velocity offset,
//! 0x60B2 torque offset (IEC 61800-7-201). Velocities in mm/s at the axis, torques in N·m at the motor.

use core::mem::offset_of;

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    message::Message,
    seal::seal,
    units::{Cycle, Position},
};

/// Command of one control cycle to one drive; the answer to the measurement of the same cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct DriveCommand {
    /// The measurement this answers.
    pub cycle: Cycle,
    /// 0x6040, see [`ControlWord`].
    pub control_word: u32,
    /// The seal, see [`DriveCommand::sealed`].
    pub check: u32,
    /// 0x60FF, mm/s: the output of the position loop.
    pub target_velocity_mm_s: f64,
    /// 0x60B1, mm/s: the velocity of the law, at its lead.
    pub velocity_offset_mm_s: f64,
    /// 0x60B2, N·m: mass and friction of the law, at their lead.
    pub torque_offset_nm: f64,
    /// What the drive adds to every position that it tells: the axis is referenced by it, as by a homing on
    /// the current position (0x6098, method 37, with 0x607C). 0 since it was switched on.
    pub home_offset: Position,
}

impl DriveCommand {
    /// Bit of the control word that the standard leaves to the manufacturer (bit 11): the regulator asks the
    /// other axes to leave the thread. The drive mirrors it in [`StatusWord::CALLS`], so that they see it
    /// with their next measurement, without a message.
    pub const CALLS: u32 = 1 << 11;
    /// The word of eight bytes whose upper half is the seal.
    const SEAL: usize = offset_of!(DriveCommand, check) / 8;

    /// The same with its seal, ready to be sent.
    #[must_use]
    pub fn sealed(self) -> DriveCommand {
        DriveCommand { check: seal(self.as_bytes(), DriveCommand::SEAL), ..self }
    }

    /// Whether it has arrived as it was sent.
    pub fn is_whole(&self) -> bool {
        self.check == seal(self.as_bytes(), DriveCommand::SEAL)
    }
}

impl Message for DriveCommand {
    const NAME: &str = "pitchlock/drive-command/3";
}

/// Commands of the control word (0x6040).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum ControlWord {
    /// Take the voltage off.
    DisableVoltage = 0x00,
    /// Brake with the quick-stop ramp.
    QuickStop = 0x02,
    /// Get ready to switch on.
    Shutdown = 0x06,
    /// Switch on.
    SwitchOn = 0x07,
    /// Enable operation.
    Enable = 0x0F,
    /// Leave fault (on the rising edge).
    FaultReset = 0x80,
}

/// States of the drive's state machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum DriveState {
    NotReady,
    SwitchOnDisabled,
    ReadyToSwitchOn,
    SwitchedOn,
    OperationEnabled,
    QuickStopActive,
    FaultReaction,
    Fault,
}

/// The status word (0x6041).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StatusWord(pub u16);

impl StatusWord {
    /// Bit of the status word that the standard leaves to the manufacturer (bit 14): the regulator of this
    /// axis asks the others to leave the thread ([`DriveCommand::CALLS`]).
    pub const CALLS: u16 = 1 << 14;
    /// The other such bit (15): so many commands in a row did not come in time that the drive asks every
    /// regulator to leave the thread as long as it still has torque.
    pub const LATE: u16 = 1 << 15;

    /// Whether the regulator of this axis asks the others to leave the thread.
    pub fn calls(self) -> bool {
        self.0 & StatusWord::CALLS != 0
    }

    /// Whether the drive has been without a command for too long to go on.
    pub fn is_late(self) -> bool {
        self.0 & StatusWord::LATE != 0
    }

    /// The status word of a state, with the voltage-enabled bit.
    pub fn of(state: DriveState) -> StatusWord {
        StatusWord(match state {
            DriveState::NotReady => 0x00,
            DriveState::SwitchOnDisabled => 0x40,
            DriveState::ReadyToSwitchOn => 0x31,
            DriveState::SwitchedOn => 0x33,
            DriveState::OperationEnabled => 0x37,
            DriveState::QuickStopActive => 0x17,
            DriveState::FaultReaction => 0x1F,
            DriveState::Fault => 0x18,
        })
    }

    /// The state, by the masks 0x4F and 0x6F of the standard; `None` for a word that is no state.
    pub fn state(self) -> Option<DriveState> {
        match (self.0 & 0x4F, self.0 & 0x6F) {
            (0x00, _) => Some(DriveState::NotReady),
            (0x40, _) => Some(DriveState::SwitchOnDisabled),
            (0x0F, _) => Some(DriveState::FaultReaction),
            (0x08, _) => Some(DriveState::Fault),
            (_, 0x21) => Some(DriveState::ReadyToSwitchOn),
            (_, 0x23) => Some(DriveState::SwitchedOn),
            (_, 0x27) => Some(DriveState::OperationEnabled),
            (_, 0x07) => Some(DriveState::QuickStopActive),
            _ => None,
        }
    }

    /// The control word that leads towards operation from here; `None` in fault, which only a reset leaves.
    pub fn towards_operation(self) -> Option<ControlWord> {
        match self.state() {
            None | Some(DriveState::NotReady) => Some(ControlWord::DisableVoltage),
            Some(DriveState::SwitchOnDisabled) => Some(ControlWord::Shutdown),
            Some(DriveState::ReadyToSwitchOn) => Some(ControlWord::SwitchOn),
            Some(DriveState::SwitchedOn | DriveState::OperationEnabled | DriveState::QuickStopActive) => {
                Some(ControlWord::Enable)
            }
            Some(DriveState::FaultReaction | DriveState::Fault) => None,
        }
    }
}
