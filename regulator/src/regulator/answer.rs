//! What a regulator answers: a command to its drive, a status to everybody. In: what its loops command, mm/s
//! and N·m, and its servo error, mm.

use protocol::{AxisStatus, ControlWord, DriveCommand, Measurement};

use super::{Out, Regulator};
use crate::{compensation::Compensation, loops::Command, state::State};

impl Regulator {
    pub(super) fn answer(
        &self,
        measurement: &Measurement,
        angle_deg: f64,
        command: &Command,
        error: f64,
    ) -> Out {
        let (cycle, now) = (measurement.cycle, &self.last);
        let control_word = self.control_word(measurement);
        let drive = DriveCommand {
            cycle,
            control_word: control_word as u32 | self.calls(),
            check: 0,
            target_velocity_mm_s: command.target_velocity_mm_s,
            velocity_offset_mm_s: command.velocity_offset_mm_s,
            torque_offset_nm: command.torque_offset_nm,
            home_offset: self.home_offset.unwrap_or_default(),
        };
        let turning = self.compensation.as_ref().is_some_and(Compensation::is_turning);
        let still = now.v == 0.0 && now.a == 0.0 && !turning;
        let streaming = matches!(self.state, State::Streaming);
        let status = AxisStatus {
            cycle,
            state: self.state.public() as u32,
            fault: self.state.fault().map_or(0, |fault| fault as u32),
            pass: self.state.pass().map_or(0, |pass| pass.number),
            line: self.line,
            in_position: u32::from(streaming && still && error.abs() <= self.in_position_mm),
            refused: self.refused,
            commanded_mm: now.s,
            velocity_mm_s: now.v,
            acceleration_mm_s2: now.a,
            jerk_mm_s3: now.j,
            servo_error_mm: error,
            angle_deg,
            spindle_rpm: self.spindle.rpm(),
            control_word: drive.control_word,
            encoder_counts: self.encoder_counts(),
            target_velocity_mm_s: drive.target_velocity_mm_s,
            velocity_offset_mm_s: drive.velocity_offset_mm_s,
            torque_offset_nm: drive.torque_offset_nm,
        };
        Out { drive: drive.sealed(), status }
    }

    /// The counts of the encoder's fault that is latched; else those that were corrected.
    fn encoder_counts(&self) -> i32 {
        let counts = match (self.state.fault(), self.spindle.fault()) {
            (Some(fault), Some(found)) if found.fault == fault => found.counts,
            _ => self.spindle.corrected().into(),
        };
        counts.clamp(i32::MIN.into(), i32::MAX.into()) as i32
    }

    /// An axis that leaves while the tool is in a groove asks the others to.
    fn calls(&self) -> u32 {
        let leaves = matches!(self.state, State::Leaving(_)) && self.out.is_some();
        if leaves { DriveCommand::CALLS } else { 0 }
    }

    fn control_word(&self, measurement: &Measurement) -> ControlWord {
        let towards_operation = || measurement.axes[self.axis].drive().towards_operation();
        self.state.stops().or_else(towards_operation).unwrap_or(ControlWord::DisableVoltage)
    }
}
