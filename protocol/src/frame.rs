//! Axis commands: one frame per interpolator cycle to each regulator, always. It carries a setpoint of timed
//! motion, and, when a pass is to be cut, the law of the axis.

use core::mem::offset_of;

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    message::Message,
    pass::{AxisLaw, Changes, WayOut, check_speed},
    refused::{Refused, finite},
    seal::seal,
    units::{Cycle, Position},
};

/// Where an axis shall be at one control cycle of timed motion, and how it moves there.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Setpoint {
    /// When this is true.
    pub cycle: Cycle,
    /// Commanded position.
    pub position: Position,
    /// Commanded speed, mm/s.
    pub velocity_mm_s: f64,
    /// Commanded acceleration, mm/s².
    pub acceleration_mm_s2: f64,
}

/// What a frame asks of the regulator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // lives on the stack for one tick
pub enum AxisCommand {
    /// Follow the stream: the frame carries its next setpoint.
    Stream,
    /// Nothing new: hold, or go on with the pass in hand. The setpoint of the frame does not count.
    Hold,
    /// Cut a pass: take the first index at or after `not_before` (same-index rule).
    Arm {
        /// Number of the pass.
        pass: u32,
        /// S, 1/min.
        s_rpm: f64,
        /// +1 or -1: direction in which C grows.
        direction: f64,
        /// First cycle whose index counts.
        not_before: Cycle,
        /// How the tool leaves before the end.
        out: WayOut,
        /// The law of this axis.
        law: AxisLaw,
        /// Where its lead changes.
        changes: Changes,
    },
    /// Leave the pass in hand in the cycle `at`, the same one on every axis; repeated until they do, so that
    /// a lost frame does no harm. Without a pass it is [`AxisCommand::Hold`].
    Leave {
        /// When.
        at: Cycle,
    },
    /// Give up a pass that has not begun to move.
    CallOff,
    /// Come to rest at once within the limits of the drive, and stay in fault.
    Stop,
    /// The axis is referenced: at rest its drive takes this offset, and where the axis is led goes with it.
    /// Repeated until the measurement shows it. On the wire it is the position of the setpoint.
    Reference {
        /// As in [`DriveCommand::home_offset`](crate::DriveCommand).
        home_offset: Position,
    },
}

/// One frame from the interpolator to one regulator.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct AxisFrame {
    /// Interpolator tick that made it. Regulators act on it one interpolator cycle later.
    pub cycle: Cycle,
    /// Code of the [`AxisCommand`].
    pub command: u32,
    /// Line of the part program that is being executed.
    pub line: u32,
    /// The next node of timed motion, [`SETPOINT_LEAD`] interpolator cycles ahead.
    pub setpoint: Setpoint,
    /// Time in which every axis brakes to rest from the setpoint of this frame if no other follows, s: the
    /// same for all axes, so that they stay on the tangent of their path.
    pub stop_s: f64,
    /// Pass to arm.
    pub pass: u32,
    /// Checksum over all the rest ([`AxisFrame::sealed`]).
    pub check: u32,
    /// S of the pass, 1/min.
    pub s_rpm: f64,
    /// Direction of the spindle, ±1.
    pub direction: f64,
    /// First cycle whose index counts; the cycle in which to leave.
    pub not_before: Cycle,
    /// The way out of the pass.
    pub out: WayOut,
    /// The law of the axis.
    pub law: AxisLaw,
    /// Where its lead changes.
    pub changes: Changes,
}

impl Message for AxisFrame {
    const NAME: &str = "pitchlock/axis-frame/7";
}

/// How many interpolator cycles a setpoint lies ahead of the tick that sends it: one for the way, one that
/// the regulators interpolate in, and one for the leads of feedforward (M54), which look beyond the present.
pub const SETPOINT_LEAD: u64 = 3;

/// Nothing takes longer to brake, s.
const LONGEST_STOP_S: f64 = 1e3;

const STREAM: u32 = 0;
const ARM: u32 = 1;
const CALL_OFF: u32 = 2;
const STOP: u32 = 3;
const HOLD: u32 = 4;
const LEAVE: u32 = 5;
const REFERENCE: u32 = 6;

impl AxisFrame {
    /// Puts a command on the wire. `stop_s` is the time in which every axis brakes from the setpoint.
    pub fn pack(
        cycle: Cycle,
        line: u32,
        setpoint: Setpoint,
        stop_s: f64,
        command: &AxisCommand,
    ) -> AxisFrame {
        let mut frame = AxisFrame { cycle, line, setpoint, stop_s, ..AxisFrame::default() };
        match *command {
            AxisCommand::Stream => frame.command = STREAM,
            AxisCommand::Hold => frame.command = HOLD,
            AxisCommand::Arm { pass, s_rpm, direction, not_before, out, law, changes } => {
                frame.command = ARM;
                (frame.pass, frame.s_rpm, frame.direction) = (pass, s_rpm, direction);
                (frame.not_before, frame.out) = (not_before, out);
                (frame.law, frame.changes) = (law, changes);
            }
            AxisCommand::Leave { at } => (frame.command, frame.not_before) = (LEAVE, at),
            AxisCommand::CallOff => frame.command = CALL_OFF,
            AxisCommand::Stop => frame.command = STOP,
            AxisCommand::Reference { home_offset } => {
                (frame.command, frame.setpoint.position) = (REFERENCE, home_offset);
            }
        }
        frame.sealed()
    }

    /// The same with its checksum: a bit of a law that is turned over would lead the tool elsewhere, by as
    /// little as nobody sees.
    #[must_use]
    pub fn sealed(self) -> AxisFrame {
        AxisFrame { check: self.sum(), ..self }
    }

    fn sum(&self) -> u32 {
        seal(self.as_bytes(), offset_of!(AxisFrame, check) / 8)
    }

    /// Takes a command off the wire. A wrong sequence of frames is the caller's to see, by `cycle`.
    ///
    /// # Errors
    /// The frame is damaged. Else names the field that is not finite, out of range or unknown.
    pub fn unpack(&self) -> Result<AxisCommand, Refused> {
        if self.check != self.sum() {
            return Err(Refused::Unreadable("an axis frame"));
        }
        finite(self.setpoint.velocity_mm_s, "setpoint velocity")?;
        finite(self.setpoint.acceleration_mm_s2, "setpoint acceleration")?;
        if !(0.0..=LONGEST_STOP_S).contains(&finite(self.stop_s, "braking time")?) {
            return Err(Refused::OutOfRange("braking time"));
        }
        Ok(match self.command {
            STREAM => AxisCommand::Stream,
            HOLD => AxisCommand::Hold,
            ARM => {
                check_speed(self.s_rpm)?;
                if self.direction.abs() != 1.0 {
                    return Err(Refused::OutOfRange("spindle direction"));
                }
                self.out.check()?;
                self.law.check()?;
                self.changes.check(&self.law)?;
                AxisCommand::Arm {
                    pass: self.pass,
                    s_rpm: self.s_rpm,
                    direction: self.direction,
                    not_before: self.not_before,
                    out: self.out,
                    law: self.law,
                    changes: self.changes,
                }
            }
            LEAVE => AxisCommand::Leave { at: self.not_before },
            CALL_OFF => AxisCommand::CallOff,
            STOP => AxisCommand::Stop,
            REFERENCE => AxisCommand::Reference { home_offset: self.setpoint.position },
            other => return Err(Refused::UnknownCode { field: "axis command", code: other }),
        })
    }
}
