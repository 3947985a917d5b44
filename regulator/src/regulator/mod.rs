//! The regulator of one axis: receive, decide, evaluate, command, report.

mod answer;
mod referenced;

use machine::Machine;
use motion::{Limits, Sample};
use protocol::{
    Axis, AxisCommand, AxisFrame, AxisStatus, Cycle, DriveCommand, DriveState, Measurement, PerAxis,
    Position, Refused, WayOut, frame::SETPOINT_LEAD, units::AXES,
};

use crate::{
    compensation::Compensation,
    elastic::Elastic,
    jumps::Jumps,
    leave::{self, Cause},
    lift::Lift,
    loops::Loops,
    reference::{Motor, Reference},
    spindle::Spindle,
    state::{Event, State, rests_at},
    stream::Stream,
    watch::{Known, Watch},
};

/// A measurement that is more cycles ahead than this is damaged, unless the next one is as far ahead.
const MOST_MISSED: u64 = 50;
/// Control cycles from a call until the axis that heard it calls too.
const HEARS: u64 = 3;
/// An axis that leaves is led for so many control cycles at least: a drive that braked by itself at once
/// would brake from the speed of an encoder that has just jumped.
const LED: u64 = 10;
/// Two places are the same, mm.
const SAME_MM: f64 = 0.001;

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
    elastic: Elastic,
    compensation: Option<Compensation>,
    cycle_s: f64,
    /// How old a measurement is, s.
    input_s: f64,
    limits: Limits,
    in_position_mm: f64,
    /// How far from where it is led it may stand when it begins, mm.
    takes_over_mm: f64,
    watch: Watch,
    /// Which of the measured positions is that of an axis: by its scale, or by its motor.
    scales: [bool; AXES],
    /// The way out of the pass in hand, or of the last one until the tool is free: who is done with it may
    /// have to wait for who is not.
    out: Option<WayOut>,
    /// Where each axis is that may lift.
    lifting: PerAxis<Jumps>,
    /// The cycle in which the interpolator wants the pass in hand to be left.
    leave_at: Option<Cycle>,
    /// Cycle of the last measurement.
    heard: Option<Cycle>,
    /// A cycle that lay far ahead.
    ahead: Option<Cycle>,
    /// A frame that came with an old measurement.
    held: Option<AxisFrame>,
    frame_due: Option<Cycle>,
    /// When its state changed last.
    state_since: Cycle,
    tick: u64,
    /// How far into a pass it can be called off, s at programmed speed.
    call_off_s: f64,
    line: u32,
    refused: u32,
    last: Sample,
    /// The offset that the drive is told, and the one that was taken from a measurement; none before a
    /// reference run.
    home_offset: Option<Position>,
    taken_offset: Option<Position>,
    answered: Out,
}

impl Regulator {
    /// A regulator for an axis that the machine has.
    ///
    /// # Panics
    /// If the machine has no such axis: look before.
    pub fn new(machine: &Machine, axis: Axis) -> Regulator {
        let config = &machine.axis[&axis];
        let cycle_s = machine.general.cycle_s;
        let loops = Loops::new(config, &machine.bus, cycle_s);
        let input_s = machine.bus.input_s(cycle_s);
        let of = |index: usize| machine.axis.get(&Axis::ALL[index]);
        Regulator {
            axis: axis.index(),
            state: State::Idle,
            stream: Stream::new(cycle_s),
            spindle: Spindle::new(machine, config.mode_hz.unwrap_or(config.velocity_bandwidth_hz)),
            elastic: Elastic::of(config),
            compensation: Compensation::of(config, loops.reach_s(input_s), cycle_s),
            loops,
            cycle_s,
            input_s,
            limits: config.limits(),
            in_position_mm: config.in_position_mm,
            takes_over_mm: config.thread_error_mm.max(config.in_position_mm),
            watch: Watch::new(machine, axis, config),
            scales: std::array::from_fn(|i| of(i).is_some_and(|axis| axis.scale_step_mm.is_some())),
            out: None,
            lifting: std::array::from_fn(|i| of(i).map_or(Jumps::default(), |axis| Jumps::of(axis, cycle_s))),
            leave_at: None,
            heard: None,
            ahead: None,
            held: None,
            frame_due: None,
            state_since: Cycle(0),
            tick: machine.cycles_per_tick(),
            call_off_s: machine.call_off_s(),
            line: 0,
            refused: 0,
            last: Sample::default(),
            home_offset: None,
            taken_offset: None,
            answered: Out::default(),
        }
    }

    /// One control cycle. A measurement that is not newer than the one before, or far ahead, brings nothing:
    /// the answer stays what it was, and the drive sees by its cycle that it is old.
    pub fn tick(&mut self, input: &In) -> &Out {
        let measurement = input.measurement;
        let before = self.heard;
        if before.is_some_and(|before| !measurement.cycle.follows(before, MOST_MISSED, &mut self.ahead)) {
            self.held = input.frame.copied().or(self.held);
            return &self.answered;
        }
        let missed = before.map_or(0, |before| measurement.cycle.0 - before.0 - 1);
        self.heard = Some(measurement.cycle);
        if let Some(compensation) = &mut self.compensation {
            compensation.step();
        }
        self.spindle.update(measurement, missed, self.state.pass());
        self.take_offset(measurement);
        let idle = matches!(self.state, State::Idle | State::Fault(_));
        let measured_mm = self.watch.position(self.measured_mm(measurement), missed, !idle);
        // Nearly always there is none, and nothing is copied.
        let held = if self.held.is_some() { self.held.take() } else { None };
        let command = self.take(input.frame.or(held.as_ref()), measurement.cycle);
        self.advance(measurement, command.as_ref(), missed, measured_mm);
        let idle = matches!(self.state, State::Idle | State::Fault(_));
        let Regulator { state, stream, spindle, compensation, loops, cycle_s, .. } = self;
        let (cycle, cycle_s) = (measurement.cycle, *cycle_s);
        let reference = Reference { state, stream, spindle, cycle, cycle_s, measured_mm };
        let angle_deg = reference.angle_deg();
        match compensation {
            Some(compensation) if idle => compensation.rest(),
            Some(compensation) => compensation.watch(reference.count_mm(), |lead_s| reference.axis(lead_s)),
            None => {}
        }
        let now = reference.now();
        let sampled = if self.input_s > 0.0 { reference.ago(self.input_s) } else { now };
        let ahead_mm = if self.scales[self.axis] { 0.0 } else { self.elastic.ahead_mm(&sampled) };
        let (elastic, sampled_mm) = (self.elastic, sampled.s + ahead_mm);
        let measured = &measurement.axes[self.axis];
        let motor = Motor { reference, sampled_mm, elastic, compensation: compensation.as_ref() };
        let command = if idle { loops.rest() } else { loops.tick(&motor, measured_mm, measured) };
        self.last = now;
        self.answered = self.answer(measurement, angle_deg, &command, sampled_mm - measured_mm);
        &self.answered
    }

    fn reference(&self, cycle: Cycle, measured_mm: f64) -> Reference<'_> {
        let Regulator { state, stream, spindle, cycle_s, .. } = self;
        Reference { state, stream, spindle, cycle, cycle_s: *cycle_s, measured_mm }
    }

    /// Where the axis is: by its scale, or by its motor, whose compensation is taken off.
    fn measured_mm(&self, measurement: &Measurement) -> f64 {
        let measured = &measurement.axes[self.axis];
        if self.scales[self.axis] {
            return measured.scale.mm();
        }
        let motor_mm = measured.position.mm();
        self.compensation
            .as_ref()
            .map_or(motor_mm, |compensation| compensation.axis_mm(motor_mm, self.input_s))
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
        if command == AxisCommand::Stream && !matches!(self.state, State::Leaving(_) | State::Fault(_)) {
            if ahead > SETPOINT_LEAD * self.tick {
                return Err(Refused::OutOfRange("setpoint cycle"));
            }
            let last = self.stream.last();
            let late = self.stream.begun() && last.cycle < cycle;
            // Behind a pass frames are missing for a while, and the first setpoint is where the pass ended.
            let missing = late && frame.setpoint.position.mm_from(last.position).abs() > SAME_MM;
            if missing && matches!(self.state, State::Streaming) {
                self.stream.rest_until(cycle);
            }
            let follows = !matches!(self.state, State::Idle);
            if let Err(refused) = self.stream.check(&frame.setpoint, frame.stop_s, &self.limits, follows) {
                if late {
                    self.stream.tear();
                }
                return Err(refused);
            }
            if !self.stream.push(frame.setpoint, frame.stop_s) {
                return Err(Refused::OutOfRange("setpoint cycle"));
            }
        }
        self.frame_due = Some(frame.cycle.after(self.tick));
        match command {
            AxisCommand::Reference { home_offset } if !self.is_referenced(home_offset) => {
                Err(Refused::OutOfRange("reference of an axis that does not rest"))
            }
            command => Ok(command),
        }
    }

    fn advance(
        &mut self,
        measurement: &Measurement,
        command: Option<&AxisCommand>,
        missed: u64,
        measured_mm: f64,
    ) {
        let cycle = measurement.cycle;
        if let Some(AxisCommand::Leave { at }) = command {
            self.leave_at = Some(self.leave_at.map_or(*at, |before| before.min(*at)));
        }
        let lift = self.lift(measurement, missed);
        let young =
            |cycles| !matches!(self.state, State::Leaving(_)) || cycle < self.state_since.after(cycles);
        let known = Known {
            state: &self.state,
            measurement,
            missed,
            spindle: &self.spindle,
            stream: &self.stream,
            begins: matches!(command, Some(AxisCommand::Stream | AxisCommand::Arm { .. })),
            frame_due: self.frame_due.map(|due| due.max(self.state_since)),
            leave_at: self.leave_at,
            last: &self.last,
            measured_mm,
        };
        let cause = self.watch.cause(&known);
        let reference = self.reference(cycle, measured_mm);
        let leaves = matches!(command, Some(AxisCommand::Stop)) || matches!(cause, Some(Cause::Leave(_)));
        let mut event = Event {
            cycle,
            enabled: measurement.axes[self.axis].drive().state() == Some(DriveState::OperationEnabled),
            cause,
            way: None,
            brake: None,
            rests: leave::is_over(&reference),
            waits: young(LED) || lift.is_on_its_way(self.axis, young(HEARS)),
            stream_begun: matches!(self.state, State::Idle)
                && self.stream.begun()
                && (self.stream.at(cycle, 0.0).s - measured_mm).abs() <= self.takes_over_mm,
            rests_at_start: rests_at(&self.last, command),
            command,
            index: self.spindle.index(),
            angle_deg: self.state.pass().map_or(0.0, |pass| self.spindle.since(pass, 0.0).angle),
            may_call_off: self.state.pass().is_some_and(|pass| {
                self.spindle.counted_since(pass) < pass.programmed_deg_s * self.call_off_s
            }),
            turns_back: self.state.pass().is_some_and(|pass| self.spindle.turns_back(pass)),
        };
        if leaves {
            event.way = leave::way_out(&reference, self.axis, lift.mm, &self.limits);
        }
        if matches!(self.state, State::Leaving(_)) {
            event.brake = leave::brake(&reference, &self.last, self.axis, lift.is_free, young, &self.limits);
        }
        let (rest, public) = (leave::rest_of(&self.state), self.state.public());
        let refused = self.state.step(&event);
        self.refused += u32::from(refused);
        if let (Some(rest), State::Streaming) = (rest, &self.state) {
            self.stream.rest_at(rest, cycle);
        }
        self.remember(lift.is_free);
        if self.state.public() != public {
            self.state_since = cycle;
        }
    }

    /// The way out of a pass is kept until the tool is free.
    fn remember(&mut self, is_free: bool) {
        if let State::InPass { pass, .. } = &self.state {
            if self.out.replace(pass.out).is_none() {
                self.lifting[pass.out.axis as usize].forget();
            }
            return;
        }
        self.leave_at = None;
        if is_free && matches!(self.state, State::Streaming) {
            self.out = None;
        }
    }

    /// The axis that lifts the tool out of the pass in hand, or of the last one.
    fn lift(&mut self, measurement: &Measurement, missed: u64) -> Lift {
        let Some(out) = &self.out else { return Lift::NONE };
        let lifting = out.axis as usize;
        let measured = &measurement.axes[lifting];
        let place = if self.scales[lifting] { measured.scale } else { measured.position };
        Lift::of(out, measured, self.lifting[lifting].position(place.mm(), missed, true))
    }
}
