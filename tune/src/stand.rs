//! Drives one axis through test moves. In: a law of motion and a torque offset over time. Out: what was
//! measured and commanded in each control cycle of the move; or a refusal, if the axis does not do what it
//! should.
//!
//! The axis runs on its drive's velocity loop and a position loop as configured, with the speed of the law
//! fed forward. Mass and friction are not, so what is believed of them does not colour what is measured.
//!
//! What is measured is `input_cycles` old when it comes, what is commanded acts `output_cycles` later. A row
//! holds what belongs together in the drive: a measurement, and the command that was in force then.

use std::collections::VecDeque;

use machine::{AxisConfig, Bus};
use motion::Sample;
use protocol::{Axis, ControlWord, DriveCommand, DriveState, Measurement, PerAxis};

use crate::{cogging, drive_loop::DriveLoop, margins::Timing, refusal::Refusal};

/// Longest time in which a drive comes into operation, or an axis to rest, s.
const PATIENCE_S: f64 = 2.0;
/// Share of the torque limit that counts as being at it.
const AT_LIMIT: f64 = 0.98;
/// Part of the way that an axis must make to count as moving.
const MOVING: f64 = 0.2;

/// A machine of which one axis is free to move: its measurements, and its drives.
pub trait Bench {
    /// What is measured in the present control cycle.
    fn measurement(&self) -> &Measurement;
    /// Gives the drives the answer to the present measurement, and goes on to the next control cycle.
    fn tick(&mut self, drives: &PerAxis<DriveCommand>);
}

/// One control cycle of a test move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Position by the encoder of the motor and by the scale, mm from the start of the test.
    pub(crate) motor_mm: f64,
    pub(crate) scale_mm: f64,
    /// Measured torque, N·m.
    pub(crate) torque_nm: f64,
    /// Torque that the drive commands in this cycle, N·m.
    pub(crate) command_nm: f64,
    /// Torque that cogging takes there as far as it was found, N·m.
    pub(crate) cogging_nm: f64,
    /// Of the command, what is left to drive the axis when it acts, N·m.
    pub(crate) driving_nm: f64,
}

/// What a drive is told in a cycle.
#[derive(Clone, Copy)]
struct Told {
    word: ControlWord,
    velocity_mm_s: f64,
    offset_nm: f64,
}

/// An axis under test. Its zero is where it stood at the start.
pub(crate) struct Stand<'a, B: Bench> {
    bench: &'a mut B,
    axis: Axis,
    config: &'a AxisConfig,
    cycle_s: f64,
    bus: Bus,
    drive: DriveLoop,
    /// What was told and is not in force yet in what was measured.
    under_way: VecDeque<Told>,
    /// Cogging as far as it was found: times a turn, N·m, degrees.
    cogging: Vec<[f64; 3]>,
    start: Start,
    motor_before_mm: f64,
    /// What the drive was last made to command, N·m.
    commanded_nm: f64,
    elapsed: u64,
}

#[derive(Clone, Copy)]
struct Start {
    motor: protocol::Position,
    scale: protocol::Position,
}

impl<'a, B: Bench> Stand<'a, B> {
    /// Enables the drive of an axis that stands still.
    pub(crate) fn enable(
        bench: &'a mut B,
        axis: Axis,
        config: &'a AxisConfig,
        cycle_s: f64,
        bus: Bus,
    ) -> Result<Stand<'a, B>, Refusal> {
        let seen = bench.measurement().axes[axis.index()];
        let start = Start { motor: seen.position, scale: seen.scale };
        let drive = DriveLoop::new(config, cycle_s);
        let mut stand = Stand {
            bench,
            axis,
            config,
            cycle_s,
            bus,
            drive,
            under_way: VecDeque::new(),
            cogging: Vec::new(),
            start,
            motor_before_mm: 0.0,
            commanded_nm: 0.0,
            elapsed: 0,
        };
        while stand.state() != Some(DriveState::OperationEnabled) {
            let word = stand.seen().drive().towards_operation();
            let (Some(word), true) = (word, stand.time_s() < PATIENCE_S) else {
                let refusal = stand.drive_refusal();
                stand.release();
                return Err(refusal);
            };
            stand.command(word, 0.0, 0.0, 0.0);
        }
        Ok(stand)
    }

    /// Follows a law from the present reference for a time, with a torque offset in N·m by cycle. Samples of
    /// the law are mm from the start of the test.
    pub(crate) fn follow(
        &mut self,
        duration_s: f64,
        law: impl Fn(f64) -> Sample,
        offset_nm: impl Fn(usize) -> f64,
    ) -> Result<Vec<Row>, Refusal> {
        let cycles = (duration_s / self.cycle_s).ceil() as usize;
        let mut rows = Vec::with_capacity(cycles);
        let from = law(0.0).s;
        let (input_s, output_s) = (self.bus.input_s(self.cycle_s), self.bus.output_s(self.cycle_s));
        for cycle in 0..cycles {
            let t = cycle as f64 * self.cycle_s;
            // Where it should have been when it was measured, how fast it shall be when the drive is told.
            let now = law((t - input_s).max(0.0));
            let ahead = law(t + self.config.velocity_lead_s + output_s);
            let seen = self.seen();
            let motor_mm = seen.position.mm_from(self.start.motor);
            self.supervise(now.s - from, now.s - motor_mm, seen.torque_nm)?;
            let target = self.config.position_gain_1_s * (now.s - motor_mm);
            let command_nm = self.command(ControlWord::Enable, target, ahead.v, offset_nm(cycle));
            rows.push(Row {
                motor_mm,
                scale_mm: seen.scale.mm_from(self.start.scale),
                torque_nm: seen.torque_nm,
                command_nm,
                cogging_nm: self.cogging_nm(motor_mm),
                driving_nm: command_nm,
            });
        }
        self.drive_only(&mut rows);
        Ok(rows)
    }

    /// Stays at a place, mm from the start of the test.
    pub(crate) fn rest(&mut self, at_mm: f64, duration_s: f64) -> Result<Vec<Row>, Refusal> {
        self.follow(duration_s, |_| Sample { s: at_mm, ..Sample::default() }, |_| 0.0)
    }

    /// Brings the axis to rest, whatever it does, and takes the power off.
    pub(crate) fn release(mut self) {
        let since = self.time_s();
        let mut still = 0;
        while still < 20 && self.time_s() < since + PATIENCE_S {
            let before = self.motor_before_mm;
            self.command(ControlWord::QuickStop, 0.0, 0.0, 0.0);
            let slow = (self.motor_before_mm - before).abs() < 0.1 * self.cycle_s;
            still = if slow { still + 1 } else { 0 };
        }
        self.command(ControlWord::DisableVoltage, 0.0, 0.0, 0.0);
    }

    /// Takes off the commands what cogging takes when they act, `acceleration_lead_s` later.
    fn drive_only(&self, rows: &mut [Row]) {
        let later = (self.config.acceleration_lead_s / self.cycle_s).max(0.0);
        let (whole, part) = (later as usize, later.fract());
        for i in 0..rows.len() {
            let cogging_nm = |later: usize| rows[(i + later).min(rows.len() - 1)].cogging_nm;
            let taken_nm = cogging_nm(whole) + part * (cogging_nm(whole + 1) - cogging_nm(whole));
            rows[i].driving_nm -= taken_nm;
        }
    }

    /// From now on this cogging is known: rows of times a turn, N·m, degrees.
    pub(crate) fn knows(&mut self, cogging: Vec<[f64; 3]>) {
        self.cogging = cogging;
    }

    /// Known cogging at a place, mm from the start of the test.
    fn cogging_nm(&self, motor_mm: f64) -> f64 {
        cogging::torque_nm(&self.cogging, (self.start_mm() + motor_mm) / self.config.screw_lead_mm)
    }

    /// Where the motor stood at the start of the test, mm.
    pub(crate) fn start_mm(&self) -> f64 {
        self.start.motor.mm()
    }

    /// Sends a command, and gives the torque that the drive makes of the one that was in force when this was
    /// measured.
    fn command(&mut self, word: ControlWord, target: f64, velocity_offset: f64, offset_nm: f64) -> f64 {
        let motor_mm = self.seen().position.mm_from(self.start.motor);
        let v = (motor_mm - self.motor_before_mm) / self.cycle_s;
        self.motor_before_mm = motor_mm;
        let runs = matches!(
            self.state(),
            Some(DriveState::SwitchedOn | DriveState::OperationEnabled | DriveState::QuickStopActive)
        );
        self.under_way.push_back(Told { word, velocity_mm_s: target + velocity_offset, offset_nm });
        let late = (self.bus.input_cycles + self.bus.output_cycles) as usize;
        let in_force = if self.under_way.len() > late { self.under_way.pop_front() } else { None };
        let torque_nm = match in_force {
            Some(Told { word: ControlWord::Enable, velocity_mm_s, offset_nm }) if runs => {
                self.drive.torque(velocity_mm_s - v, offset_nm)
            }
            _ => 0.0,
        };
        let mut drives = PerAxis::<DriveCommand>::default();
        drives[self.axis.index()] = DriveCommand {
            cycle: self.bench.measurement().cycle,
            control_word: word as u32,
            target_velocity_mm_s: target,
            velocity_offset_mm_s: velocity_offset,
            torque_offset_nm: offset_nm,
            ..DriveCommand::default()
        };
        self.bench.tick(&drives);
        self.elapsed += 1;
        self.commanded_nm = torque_nm;
        torque_nm
    }

    /// Ends a test that does harm or says nothing.
    fn supervise(&self, gone_mm: f64, error_mm: f64, torque_nm: f64) -> Result<(), Refusal> {
        if self.state() != Some(DriveState::OperationEnabled) {
            return Err(self.drive_refusal());
        }
        let limit = self.config.torque_limit_nm;
        let lost = error_mm.is_nan() || error_mm.abs() > self.config.following_error_mm;
        let moves = (gone_mm - error_mm).abs() >= MOVING * gone_mm.abs();
        if lost && !moves {
            return Err(Refusal::DidNotMove(self.axis, gone_mm, gone_mm - error_mm));
        }
        // A drive cuts a command at its limit, so its loop is no longer the one that is reckoned with.
        let cut = moves && self.commanded_nm.abs() >= limit;
        if cut || torque_nm.is_nan() || torque_nm.abs() >= AT_LIMIT * limit {
            return Err(Refusal::TorqueLimited(self.axis, limit));
        }
        if lost { Err(Refusal::Lost(self.axis, error_mm.abs())) } else { Ok(()) }
    }

    fn seen(&self) -> protocol::AxisMeasurement {
        self.bench.measurement().axes[self.axis.index()]
    }

    fn state(&self) -> Option<DriveState> {
        self.seen().drive().state()
    }

    fn time_s(&self) -> f64 {
        self.elapsed as f64 * self.cycle_s
    }

    fn drive_refusal(&self) -> Refusal {
        Refusal::Drive(self.axis, self.state(), self.time_s())
    }

    /// The axis under test.
    pub(crate) fn axis(&self) -> Axis {
        self.axis
    }

    /// When the loops of the axis are closed.
    pub(crate) fn timing(&self) -> Timing {
        let bus_s = self.bus.input_s(self.cycle_s) + self.bus.output_s(self.cycle_s);
        Timing { cycle_s: self.cycle_s, bus_s }
    }

    /// Control cycle, s.
    pub(crate) fn cycle_s(&self) -> f64 {
        self.cycle_s
    }
}
