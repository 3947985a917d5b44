//! The regulator of one axis: receive, decide, evaluate, command, report.

use machine::Machine;
use motion::Sample;
use protocol::{
    Axis, AxisCommand, AxisFrame, AxisStatus, ControlWord, Cycle, DriveCommand, DriveState, Fault,
    Measurement, Refused, frame::SETPOINT_LEAD,
};

use crate::{
    compensation::Compensation,
    loops::{Command, Loops},
    reference::{Motor, Reference},
    spindle::Spindle,
    state::{Event, Stage, State},
    stream::Stream,
};

/// What one control cycle brings.
#[derive(Clone, Copy, Debug)]
pub struct In<'a> {
    /// The measurement.
    pub measurement: &'a Measurement,
    /// The frame that takes effect in this cycle, at interpolator ticks.
    pub frame: Option<&'a AxisFrame>,
}

/// What the regulator answers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Out {
    /// To the drive.
    pub drive: DriveCommand,
    /// To the interpolator and the observer.
    pub status: AxisStatus,
}

/// The regulator of one axis. It holds no clock and allocates nothing after `new`.
#[derive(Clone, Debug)]
pub struct Regulator {
    axis: usize,
    state: State,
    stream: Stream,
    spindle: Spindle,
    loops: Loops,
    compensation: Option<Compensation>,
    /// The position loop closes over the linear scale.
    scale: bool,
    cycle_s: f64,
    limits: Supervision,
    expected: Option<Cycle>,
    frame_due: Option<Cycle>,
    tick: u64,
    /// How far into a pass it can be called off, s at programmed speed.
    call_off_s: f64,
    line: u32,
    refused: u32,
    last: Sample,
}

/// Errors beyond which an axis faults, mm.
#[derive(Clone, Copy, Debug)]
struct Supervision {
    following: f64,
    thread: f64,
    in_position: f64,
}

impl Regulator {
    /// A regulator for an axis that the machine has.
    ///
    /// # Panics
    /// If the machine has no such axis: look before.
    pub fn new(machine: &Machine, axis: Axis) -> Regulator {
        let config = &machine.axis[&axis];
        let cycle_s = machine.general.cycle_s;
        let loops = Loops::new(config, cycle_s);
        Regulator {
            axis: axis.index(),
            state: State::Idle,
            stream: Stream::new(cycle_s),
            spindle: Spindle::new(machine),
            compensation: Compensation::of(config, loops.reach_s(), cycle_s),
            loops,
            scale: config.scale_step_mm.is_some(),
            cycle_s,
            limits: Supervision {
                following: config.following_error_mm,
                thread: config.thread_error_mm,
                in_position: config.in_position_mm,
            },
            expected: None,
            frame_due: None,
            tick: machine.cycles_per_tick(),
            call_off_s: machine.call_off_s(),
            line: 0,
            refused: 0,
            last: Sample::default(),
        }
    }

    /// One control cycle.
    pub fn tick(&mut self, input: &In) -> Out {
        let measurement = input.measurement;
        if let Some(compensation) = &mut self.compensation {
            compensation.step();
        }
        let measured_mm = self.measured_mm(measurement);
        let gap = self.expected.is_some_and(|cycle| cycle != measurement.cycle);
        self.expected = Some(measurement.cycle.after(1));
        self.spindle.update(measurement);
        let command = self.take(input.frame, measurement.cycle);
        self.advance(measurement, command, gap, measured_mm);
        let idle = matches!(self.state, State::Idle | State::Fault(_));
        let reference = Reference {
            state: &self.state,
            stream: &self.stream,
            spindle: &self.spindle,
            cycle: measurement.cycle,
            cycle_s: self.cycle_s,
            measured_mm,
        };
        let angle_deg = reference.angle_deg();
        match &mut self.compensation {
            Some(compensation) if idle => compensation.rest(),
            Some(compensation) => compensation.watch(reference.count_mm(), |lead_s| reference.axis(lead_s)),
            None => {}
        }
        let motor = Motor { reference, compensation: self.compensation.as_ref() };
        let command = if idle { self.loops.rest() } else { self.loops.tick(&motor, measured_mm) };
        self.last = reference.now();
        self.answer(measurement, angle_deg, &command, measured_mm)
    }

    /// Where the axis is: by its scale, or by its motor, whose compensation is taken off.
    fn measured_mm(&self, measurement: &Measurement) -> f64 {
        let measured = &measurement.axes[self.axis];
        if self.scale {
            return measured.scale.mm();
        }
        let motor_mm = measured.position.mm();
        self.compensation.as_ref().map_or(motor_mm, |compensation| compensation.axis_mm(motor_mm))
    }

    /// Takes a frame and its setpoint; what cannot be used is counted and changes nothing.
    fn take(&mut self, frame: Option<&AxisFrame>, cycle: Cycle) -> Option<AxisCommand> {
        let frame = frame?;
        match self.accept(frame, cycle) {
            Ok(command) => {
                self.line = frame.line;
                Some(command)
            }
            Err(_) => {
                self.refused += 1;
                None
            }
        }
    }

    /// Takes a frame, or refuses it.
    fn accept(&mut self, frame: &AxisFrame, cycle: Cycle) -> Result<AxisCommand, Refused> {
        let command = frame.unpack()?;
        if let Some(due) = self.frame_due
            && frame.cycle < due
        {
            return Err(Refused::OutOfOrder { what: "axis frame", expected: due.0, received: frame.cycle.0 });
        }
        if frame.cycle > cycle {
            return Err(Refused::OutOfRange("axis frame cycle"));
        }
        let ahead = frame.setpoint.cycle.0.saturating_sub(frame.cycle.0);
        let streams = command == AxisCommand::Stream;
        if streams && (ahead > SETPOINT_LEAD * self.tick || !self.stream.push(frame.setpoint)) {
            return Err(Refused::OutOfRange("setpoint cycle"));
        }
        self.frame_due = Some(frame.cycle.after(self.tick));
        Ok(command)
    }

    fn advance(
        &mut self,
        measurement: &Measurement,
        command: Option<AxisCommand>,
        gap: bool,
        measured_mm: f64,
    ) {
        let cycle = measurement.cycle;
        let drive = measurement.axes[self.axis].drive().state();
        let event = Event {
            cycle,
            enabled: drive == Some(DriveState::OperationEnabled),
            fault: self.fault(cycle, drive, gap, measured_mm),
            stream_begun: self.stream.begun()
                && (self.stream.at(cycle, 0.0).s - measured_mm).abs() <= self.limits.in_position,
            rests_at_start: rests_at(&self.last, command.as_ref()),
            command,
            index: self.spindle.index(),
            angle_deg: self.state.pass().map_or(0.0, |pass| self.spindle.since(pass, 0.0).angle),
            may_call_off: self.state.pass().is_some_and(|pass| {
                self.spindle.counted_since(pass) < pass.programmed_deg_s * self.call_off_s
            }),
        };
        let before = self.state;
        let (state, refused) = before.next(&event);
        self.refused += u32::from(refused);
        if let (State::InPass { pass, stage: Stage::RunOut }, State::Streaming) = (&before, &state) {
            self.stream.rest_at(pass.law.end, cycle);
        }
        self.state = state;
    }

    /// What ends every state, most urgent first. The servo error is that of the reference of the cycle before
    /// against its measurement, so it is known here without evaluating twice.
    fn fault(&self, cycle: Cycle, drive: Option<DriveState>, gap: bool, measured_mm: f64) -> Option<Fault> {
        let moving = !matches!(self.state, State::Idle | State::Fault(_));
        if gap {
            return Some(Fault::MeasurementGap);
        }
        if let Some(found) = self.spindle.fault() {
            return Some(found.fault);
        }
        if moving && drive != Some(DriveState::OperationEnabled)
            || matches!(drive, None | Some(DriveState::Fault | DriveState::FaultReaction))
        {
            return Some(Fault::DriveFault);
        }
        if !moving {
            return None;
        }
        if matches!(self.state, State::Streaming) && self.stream.starved(cycle) {
            return Some(Fault::StreamStarved);
        }
        // One cycle of motion lies between the last reference and this measurement.
        let slip = self.last.v * self.cycle_s;
        let error = (self.last.s + slip - measured_mm).abs();
        // An error that is not a number is beyond every limit.
        let within = |limit: f64| error.is_finite() && error <= limit;
        match self.state {
            State::InPass { stage: Stage::Locked, .. } if !within(self.limits.thread) => {
                Some(Fault::ThreadError)
            }
            _ if !within(self.limits.following) => Some(Fault::FollowingError),
            _ => None,
        }
    }

    fn answer(&self, measurement: &Measurement, angle_deg: f64, command: &Command, measured_mm: f64) -> Out {
        let (cycle, now) = (measurement.cycle, &self.last);
        let control_word = self.control_word(measurement);
        let drive = DriveCommand {
            cycle,
            control_word: control_word as u32,
            reserved: 0,
            target_velocity_mm_s: command.target_velocity_mm_s,
            velocity_offset_mm_s: command.velocity_offset_mm_s,
            torque_offset_nm: command.torque_offset_nm,
        };
        let error = now.s - measured_mm;
        let turning = self.compensation.as_ref().is_some_and(Compensation::is_turning);
        let still = now.v == 0.0 && now.a == 0.0 && !turning;
        let streaming = matches!(self.state, State::Streaming);
        let status = AxisStatus {
            cycle,
            state: self.state.public() as u32,
            fault: if let State::Fault(fault) = self.state { fault as u32 } else { 0 },
            pass: self.state.pass().map_or(0, |pass| pass.number),
            line: self.line,
            in_position: u32::from(streaming && still && error.abs() <= self.limits.in_position),
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
        Out { drive, status }
    }

    /// The counts of the encoder's fault that is latched.
    fn encoder_counts(&self) -> i32 {
        match (self.state, self.spindle.fault()) {
            (State::Fault(fault), Some(found)) if found.fault == fault => {
                found.counts.clamp(i32::MIN.into(), i32::MAX.into()) as i32
            }
            _ => 0,
        }
    }

    fn control_word(&self, measurement: &Measurement) -> ControlWord {
        if matches!(self.state, State::Fault(_)) {
            return ControlWord::QuickStop;
        }
        measurement.axes[self.axis].drive().towards_operation().unwrap_or(ControlWord::DisableVoltage)
    }
}

/// Whether the commanded axis rests where the pass in `command` starts. One count of the wire is allowed for
/// the rounding of setpoints.
fn rests_at(now: &Sample, command: Option<&AxisCommand>) -> bool {
    let Some(AxisCommand::Arm { law, .. }) = command else { return false };
    now.v == 0.0 && now.a == 0.0 && (now.s - law.start.mm()).abs() < 2e-9
}
