//! What is asked of the machine when one of its modules has died, and when the rest of it may be ended.
//!
//! In: who has died, an emergency stop by the operator, and every control cycle a [`Record`]. Out: what to do
//! at the panel, and the [`End`]. No clock: every wait is bounded in control cycles, and a pass by the angle
//! of the spindle.
//!
//! | dead | then |
//! |---|---|
//! | interpreter | what was sent is executed; the interpolator faults if that was not the whole program |
//! | interpolator | a pass in hand is cut to its end by the regulators; then emergency stop; in a tap at once, dead or silent for four ticks: nobody else turns the spindle round |
//! | interpolator, dead or silent for four ticks, and an axis is in fault | emergency stop at once: nobody else stops the spindle |
//! | nobody, but for a second the plant does not hear that the run is over, or the emergency stop that a spindle needs that does not stop | emergency stop at the panel |
//! | regulator | emergency stop at once: its drive brakes by its own watchdog, the other axes leave the thread |
//! | plant | the end: there is nothing left to look after |
//!
//! After an emergency stop the machine is at rest when no axis and no spindle has moved for [`REST_CYCLES`].
//! It may take as long as the spindle goes on slowing down: each time it has lost a hundredth of its highest
//! speed the wait begins anew. A wait that is longer than three times the ramp of the spindle and the slowest
//! stop of an axis ends with [`End::NoRest`].

use std::collections::{BTreeMap, BTreeSet};

use machine::{AxisConfig, Machine, SpindleConfig};
use protocol::{
    Axis, AxisState, Code, DriveState, Fault, Item, MachineState, Module, Panel, ThreadPass,
    operator::Request, units::AXES,
};

use crate::observe::Record;

/// So many control cycles in a row without motion are rest.
pub const REST_CYCLES: u64 = 200;
/// An axis that is slower than this stands, mm/s.
const AXIS_STANDS_MM_S: f64 = 0.1;
/// And has not moved farther than this since it began to stand, mm: a loop at rest hunts by some counts.
const STANDS_MM: f64 = 0.0005;
/// A machine may need that many times its ramps to come to rest.
const RAMPS: f64 = 3.0;
/// And this for what is no ramp: brakes, drives, messages, s.
const SETTLING_S: f64 = 1.0;
/// An interpolator that has said nothing for so many ticks is silent.
const SILENT_TICKS: u64 = 4;
/// So long the last wish of an interpolator may take to come true, s.
const UNHEARD_S: f64 = 1.0;
/// Turns that a pass may take more than its laws: the index it waits for, and a spindle that is uneven.
const MORE_TURNS: f64 = 2.0;

/// How it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// No axis moves, the spindle stands.
    Rest,
    /// This has not come to rest in the time that it can take.
    NoRest(Moving),
    /// The plant is gone: nothing is known any more.
    PlantGone,
}

/// What has not come to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moving {
    /// An axis, mm/s.
    Axis(Axis, f64),
    /// The spindle, 1/min.
    Spindle(f64),
}

impl core::fmt::Display for Moving {
    fn fmt(&self, f: &mut core::fmt::Formatter) -> core::fmt::Result {
        match self {
            Moving::Axis(axis, mm_s) => write!(f, "{axis} still moves at {mm_s:.2} mm/s"),
            Moving::Spindle(rpm) => write!(f, "the spindle still turns at {rpm:.0} 1/min"),
        }
    }
}

/// What it waits for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// Nobody is missing whom the machine needs.
    Watching,
    /// A pass is cut to its end, since this cycle. `left_deg`: what the spindle may still turn for it, once
    /// the pass is known; `stood`: cycles for which it has not turned.
    Finishing { from: u64, left_deg: Option<f64>, stood: u64 },
    /// The emergency stop was asked for. `waited`: cycles since the spindle was first as slow as `rpm`;
    /// `rests`: cycles at rest.
    Stopping { waited: u64, rpm: f64, rests: u64 },
    /// Done.
    Over(End),
}

/// Whether an axis is in fault, or its drive, of which a regulator that measures nothing says nothing. One
/// that is on its way out is left alone: a spindle that was stopped meanwhile would not turn any more as it
/// is taken to by who does not believe its encoder.
fn faults(record: &Record) -> bool {
    record.axes.iter().any(|(axis, status)| {
        let drive = record.truth.measurement.axes[axis.index()].drive().state();
        let tripped = matches!(drive, Some(DriveState::Fault | DriveState::FaultReaction));
        status.state() == AxisState::Fault || tripped
    })
}

/// Whether the plant goes on although the run is over, or does not open although the spindle does not stop.
fn is_unheard(record: &Record) -> bool {
    let opened = record.truth.measurement.panel.pressed(Panel::EMERGENCY_STOP);
    let opens = record.machine.fault == Fault::SpindleDoesNotStop as u32;
    record.machine.state() == MachineState::Ended || opens && !opened
}

/// Watches over one run.
#[derive(Clone, Debug)]
pub struct Supervisor {
    axes: Vec<Axis>,
    dead: Vec<Module>,
    phase: Phase,
    /// Angle at which each pass is over, degrees since its index.
    passes: BTreeMap<u32, f64>,
    /// The taps among them: nobody but the interpolator takes them out.
    taps: BTreeSet<u32>,
    longest_wait: u64,
    /// An interpolator that has said nothing for so many control cycles is silent.
    silent: u64,
    /// Cycles for which the plant has not done what the interpolator asks of it last; so many are too many.
    unheard: u64,
    deaf: u64,
    /// A hundredth of the highest speed of the spindle, 1/min.
    sign_rpm: f64,
    spindle_deg: f64,
    /// Where the axes began to stand, mm.
    stood: [f64; AXES],
}

impl Supervisor {
    /// A supervisor of a machine and of the passes of its program; other items may be left out.
    pub fn new(machine: &Machine, items: &[Item]) -> Supervisor {
        let pass = |item: &Item| match &item.code {
            Code::Pass(pass) => Some((pass.pass, over_deg(pass))),
            _ => None,
        };
        let tap = |item: &Item| match &item.code {
            Code::Pass(pass) if pass.returns() => Some(pass.pass),
            _ => None,
        };
        let stops = machine.axes().map(|(_, axis)| slowest_stop_s(axis));
        let ramp_s = machine.spindle.max_rpm / machine.spindle.ramp_rpm_s;
        let wait_s = RAMPS * (ramp_s + stops.fold(0.0, f64::max)) + SETTLING_S;
        Supervisor {
            axes: machine.axes().map(|(axis, _)| axis).collect(),
            dead: Vec::new(),
            phase: Phase::Watching,
            passes: items.iter().filter_map(pass).collect(),
            taps: items.iter().filter_map(tap).collect(),
            longest_wait: (wait_s / machine.general.cycle_s).ceil() as u64,
            silent: SILENT_TICKS * machine.cycles_per_tick(),
            unheard: 0,
            deaf: (UNHEARD_S / machine.general.cycle_s).ceil() as u64,
            sign_rpm: 0.01 * machine.spindle.max_rpm,
            spindle_deg: 0.0,
            stood: [f64::NAN; AXES],
        }
    }

    /// A module has died in a control cycle, or hangs and was killed. What this gives is to be done at the
    /// panel, before anybody hears of the death. Records of cycles before may still come.
    pub fn died(&mut self, module: Module, cycle: u64) -> Option<Request> {
        self.dead.push(module);
        match (module, self.phase) {
            (Module::Regulator(_), _) => return self.emergency_stop(),
            (Module::Interpolator, Phase::Watching) => {
                self.phase = Phase::Finishing { from: cycle, left_deg: None, stood: 0 };
            }
            _ => {}
        }
        None
    }

    /// The plant has died.
    pub fn plant_died(&mut self) {
        self.phase = Phase::Over(End::PlantGone);
    }

    /// An emergency stop is wanted; it is asked for once. What this gives is to be done at the panel.
    pub fn emergency_stop(&mut self) -> Option<Request> {
        if matches!(self.phase, Phase::Stopping { .. } | Phase::Over(_)) {
            return None;
        }
        self.phase = Phase::Stopping { waited: 0, rpm: f64::INFINITY, rests: 0 };
        Some(Request::EmergencyStop)
    }

    /// One control cycle; every one, in order. What it gives is to be done at the panel.
    pub fn cycle(&mut self, record: &Record) -> Option<Request> {
        let turned = (record.truth.spindle_deg - self.spindle_deg).abs();
        self.spindle_deg = record.truth.spindle_deg;
        self.unheard = if is_unheard(record) { self.unheard + 1 } else { 0 };
        match self.phase {
            Phase::Watching if self.is_silent(record) && (faults(record) || self.is_tapping(record)) => {
                return self.emergency_stop();
            }
            Phase::Watching if self.unheard > self.deaf => return self.emergency_stop(),
            Phase::Watching | Phase::Over(_) => {}
            Phase::Finishing { from, .. } if record.truth.cycle.0 < from => {}
            Phase::Finishing { from, left_deg, stood } => {
                match self.finish(record, turned, left_deg, stood) {
                    Some((left, stood)) => {
                        self.phase = Phase::Finishing { from, left_deg: Some(left), stood }
                    }
                    None => return self.emergency_stop(),
                }
            }
            Phase::Stopping { waited, rpm, rests } => self.phase = self.stop(record, waited, rpm, rests),
        }
        None
    }

    /// Whether everything may be ended, and how it stands.
    pub fn end(&self) -> Option<End> {
        match self.phase {
            Phase::Over(end) => Some(end),
            _ => None,
        }
    }

    /// Whether nothing is wrong, as far as this knows.
    pub fn is_watching(&self) -> bool {
        self.phase == Phase::Watching
    }

    fn is_silent(&self, record: &Record) -> bool {
        record.truth.cycle.0 > record.machine.cycle.0.saturating_add(self.silent)
    }

    /// Whether an axis is in a tap.
    fn is_tapping(&self, record: &Record) -> bool {
        record.axes.iter().any(|(_, status)| status.state().is_in_pass() && self.taps.contains(&status.pass))
    }

    /// Regulators cut a pass to its end without anybody above: what the spindle may still turn for it, and
    /// for how many cycles it has stood. `None` when that is over, or cannot be.
    fn finish(&self, record: &Record, turned: f64, left_deg: Option<f64>, stood: u64) -> Option<(f64, u64)> {
        let living = |axis: &Axis| !self.dead.contains(&Module::Regulator(*axis));
        let mut axes = record.axes.iter().filter(|(axis, _)| living(axis));
        if faults(record) || self.is_tapping(record) {
            return None;
        }
        let (_, cutting) = axes.find(|(_, status)| status.state().is_in_pass())?;
        let whole_deg = || self.passes.get(&cutting.pass).map_or(0.0, |over| over + 360.0 * MORE_TURNS);
        let left_deg = left_deg.unwrap_or_else(whole_deg) - turned;
        let stands = record.truth.spindle_rpm.abs() < SpindleConfig::STANDSTILL_RPM;
        let stood = if stands { stood + 1 } else { 0 };
        let goes_on = left_deg >= 0.0 && stood <= self.longest_wait;
        goes_on.then_some((left_deg, stood))
    }

    /// The machine comes to rest.
    fn stop(&mut self, record: &Record, waited: u64, rpm: f64, rests: u64) -> Phase {
        let Some(moving) = self.moving(record) else {
            let rests = rests + 1;
            return match rests >= REST_CYCLES {
                true => Phase::Over(End::Rest),
                false => Phase::Stopping { waited, rpm, rests },
            };
        };
        let now_rpm = record.truth.spindle_rpm.abs();
        if now_rpm <= rpm - self.sign_rpm {
            return Phase::Stopping { waited: 0, rpm: now_rpm, rests: 0 };
        }
        match waited >= self.longest_wait {
            true => Phase::Over(End::NoRest(moving)),
            false => Phase::Stopping { waited: waited + 1, rpm, rests: 0 },
        }
    }

    fn moving(&mut self, record: &Record) -> Option<Moving> {
        let truth = record.truth;
        let stood = std::mem::replace(&mut self.stood, truth.axes.map(|axis| axis.motor_mm));
        let speed = |axis: &Axis| (*axis, truth.axes[axis.index()].velocity_mm_s);
        let mut axes = self.axes.iter().map(speed);
        let turns = !stands(truth.spindle_rpm, SpindleConfig::STANDSTILL_RPM);
        let moves = |(axis, mm_s): &(Axis, f64)| {
            let way_mm = truth.axes[axis.index()].motor_mm - stood[axis.index()];
            !(stands(*mm_s, AXIS_STANDS_MM_S) && stands(way_mm, STANDS_MM))
        };
        if let Some((axis, mm_s)) = axes.find(moves) {
            return Some(Moving::Axis(axis, mm_s));
        }
        if turns {
            return Some(Moving::Spindle(truth.spindle_rpm));
        }
        // They have stood where they stood before.
        self.stood = stood;
        None
    }
}

/// What is not a number does not stand.
fn stands(speed: f64, limit: f64) -> bool {
    speed.abs() < limit
}

/// Angle at which the last axis of a pass is at rest.
fn over_deg(pass: &ThreadPass) -> f64 {
    pass.axes.iter().map(|law| law.done_deg()).fold(0.0, f64::max)
}

/// From the highest speed to rest at the highest acceleration and jerk.
fn slowest_stop_s(axis: &AxisConfig) -> f64 {
    axis.velocity_mm_s / axis.acceleration_mm_s2 + axis.acceleration_mm_s2 / axis.jerk_mm_s3
}
