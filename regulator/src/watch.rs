//! What ends what an axis does. In: the measurement of a cycle, the same for every axis, and what the axis
//! knows of itself. Out: the first cause, most urgent first.
//!
//! Every regulator looks for itself, so all axes leave a pass in the same cycle and nobody has to be told.
//! What one axis alone can know (its servo error) the others see in their next measurement: its drive mirrors
//! the call ([`protocol::DriveCommand::CALLS`]), is late, or is out of operation.
//!
//! ```text
//! gap      more than two measurements in a row are missing; or more than ten, and a tenth of all
//! runaway  n > 1.15 m S + 2 % of the highest speed, in a pass; m the highest override           (M103)
//!          of a tap, whose way out may be faster, n > 1.15 times the highest speed
//!          or 2π L/t² > 7/4 A on a stroke L that takes t at n                                      (M2)
//! reversed C more than 0.36° back from its farthest, n < −5 % of S, in a pass (`spindle.rs`)    (M106)
//!          of a tap it is what shall be
//! ```

use machine::{AxisConfig, Machine, SpindleConfig};
use motion::Sample;
use protocol::{Axis, Cycle, DriveState, Fault, Measurement, Panel, WayOut, units::AXES};

use crate::jumps::Jumps;
use crate::leave::Cause;
use crate::spindle::Spindle;
use crate::state::{Stage, State};
use crate::stream::Stream;

/// Control cycles without a measurement that an axis bridges.
const BRIDGED: u64 = 2;
/// More than so many missing ones are too many, if they are more than this share of all.
const MOST_LOST: f64 = 10.0;
const LOST_SHARE: f64 = 0.1;
/// A frame that is so many ticks late tells of a sender that has died.
const SILENT_TICKS: u64 = 3;
/// A spindle that has stood for so long in a pass without an interpolator stands for good, s.
const STANDS_S: f64 = 0.3;
/// An axis at rest waits so much longer, s.
const REST_S: f64 = 1.0;

/// A spindle that turns faster than the highest override of its programmed speed, by this factor and this
/// share of its highest speed, has run away: the interpolator lets it turn on for longer, an axis on its law
/// cannot.
const FASTER: f64 = SpindleConfig::RUNAWAY[0];
const FASTER_SHARE: f64 = SpindleConfig::RUNAWAY[1];
/// And so has one that drives a stroke so many times as hard as the axis may be accelerated: the share above
/// is many times the speed of a slow thread.
const HARDEST: f64 = 1.75;

/// What an axis watches.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    axis: usize,
    others: [bool; AXES],
    following_mm: f64,
    thread_mm: f64,
    cycle_s: f64,
    /// How old a measurement is, s.
    input_s: f64,
    tick: u64,
    /// What of its programmed speed a spindle may reach, a share, and 1/min besides.
    fastest: (f64, f64),
    /// What one may reach in a tap, whose way out may be faster, 1/min.
    fastest_tap: f64,
    /// The highest acceleration that a spindle may ask of the axis on a stroke, mm/s².
    hardest: f64,
    /// Measurements that are missing, beyond that share.
    lost: f64,
    jumps: Jumps,
    /// The pass in hand is finished whatever minor fault there is; so is that of the other axes, if this one
    /// rests at the end of its own and the interpolator leads it nowhere yet.
    finishes: bool,
}

/// What an axis knows in a cycle.
pub(crate) struct Known<'a> {
    pub(crate) state: &'a State,
    pub(crate) measurement: &'a Measurement,
    /// Cycles without a measurement before this one.
    pub(crate) missed: u64,
    pub(crate) spindle: &'a Spindle,
    pub(crate) stream: &'a Stream,
    /// The interpolator begins something new: timed motion, or a pass.
    pub(crate) begins: bool,
    /// When the next frame was due; none before the first.
    pub(crate) frame_due: Option<Cycle>,
    /// The cycle in which the interpolator wants the pass to be left.
    pub(crate) leave_at: Option<Cycle>,
    /// The reference of the cycle before, and what is measured now, mm.
    pub(crate) last: &'a Sample,
    pub(crate) measured_mm: f64,
}

impl Watch {
    pub(crate) fn new(machine: &Machine, axis: Axis, config: &AxisConfig) -> Watch {
        let cycle_s = machine.general.cycle_s;
        let mut others = [false; AXES];
        machine.axes().for_each(|(other, _)| others[other.index()] = other != axis);
        Watch {
            axis: axis.index(),
            others,
            following_mm: config.following_error_mm,
            thread_mm: config.thread_error_mm,
            cycle_s,
            input_s: machine.bus.input_s(cycle_s),
            tick: machine.cycles_per_tick(),
            fastest: (
                FASTER * machine.spindle.override_max_pct / 100.0,
                FASTER_SHARE * machine.spindle.max_rpm,
            ),
            fastest_tap: FASTER * machine.spindle.max_rpm,
            hardest: HARDEST * config.limits().a,
            lost: 0.0,
            jumps: Jumps::of(config, cycle_s),
            finishes: false,
        }
    }

    /// Takes the measured position of a cycle and gives it back without the jump that was seen (M102).
    pub(crate) fn position(&mut self, measured_mm: f64, missed: u64, follows: bool) -> f64 {
        self.lost = (self.lost - LOST_SHARE).max(0.0) + missed as f64;
        self.jumps.position(measured_mm, missed, follows)
    }

    /// Positions count from elsewhere: the next one is believed.
    pub(crate) fn forget(&mut self) {
        self.jumps.forget();
    }

    /// What ends what the axis does, if anything.
    pub(crate) fn cause(&mut self, known: &Known) -> Option<Cause> {
        self.finishes = match known.state {
            State::Streaming => self.finishes && !known.begins,
            state => state.pass().is_some_and(|pass| !pass.out.on(WayOut::ON_FAULT)),
        };
        let leave = |fault: Option<Fault>| fault.map(|fault| Cause::Leave(Some(fault)));
        self.lost(known)
            .or_else(|| leave(outside(known)))
            .or_else(|| leave(self.encoders(known)))
            .or_else(|| leave(self.late(known)))
            .or_else(|| self.servo(known))
            .or_else(|| leave(self.silence(known)))
            .or_else(|| self.in_pass(known))
    }

    /// The axis has no torque.
    fn lost(&self, known: &Known) -> Option<Cause> {
        let drive = known.measurement.axes[self.axis].drive().state();
        let moving = !matches!(known.state, State::Idle | State::Fault(_));
        let dead = matches!(drive, None | Some(DriveState::Fault | DriveState::FaultReaction));
        let off = moving && drive != Some(DriveState::OperationEnabled);
        // A drive trips without commands, and without measurements there were none.
        let fault = match known.measurement.axes[self.axis].drive().is_late() {
            _ if known.missed > BRIDGED => Fault::MeasurementGap,
            true => Fault::LateAnswers,
            false => Fault::DriveFault,
        };
        (dead || off).then_some(Cause::Lost(fault))
    }

    /// A drive that has not had its commands in time, before it trips: in timed motion, too, all axes brake
    /// together.
    fn late(&self, known: &Known) -> Option<Fault> {
        let late = |axis: usize| known.measurement.axes[axis].drive().is_late();
        if late(self.axis) {
            return Some(Fault::LateAnswers);
        }
        (0..AXES).any(|other| self.others[other] && late(other)).then_some(Fault::OtherAxis)
    }

    /// What counts and positions say that cannot be.
    fn encoders(&self, known: &Known) -> Option<Fault> {
        if known.missed > BRIDGED || self.lost > MOST_LOST {
            return Some(Fault::MeasurementGap);
        }
        let spindle = known.spindle.fault().filter(|found| !(self.finishes && found.is_minor()));
        let spindle = spindle.map(|found| found.fault);
        spindle.or(self.jumps.has_jumped().then_some(Fault::AxisJump))
    }

    /// The servo error is that of the reference of the cycle before against its measurement, so it is known
    /// without evaluating twice.
    fn servo(&self, known: &Known) -> Option<Cause> {
        // One cycle of motion lies between the last reference and the present, and those missed; the
        // measurement is older.
        let since_s = self.cycle_s * (1 + known.missed) as f64 - self.input_s;
        let error = (known.last.s + known.last.v * since_s - known.measured_mm).abs();
        // An error that is not a number is beyond every limit.
        let within = |limit: f64| error.is_finite() && error <= limit;
        match known.state {
            State::Idle | State::Fault(_) | State::Leaving(_) => None,
            State::InPass { stage: Stage::Locked, .. } if !within(self.thread_mm) => {
                Some(Cause::Leave(Some(Fault::ThreadError)))
            }
            _ if within(self.following_mm) => None,
            State::InPass { stage, .. } if *stage != Stage::Armed => {
                Some(Cause::Leave(Some(Fault::FollowingError)))
            }
            _ => Some(Cause::Lost(Fault::FollowingError)),
        }
    }

    /// Nothing new from above: a pass in hand is finished first.
    fn silence(&self, known: &Known) -> Option<Fault> {
        let cycle = known.measurement.cycle;
        if !matches!(known.state, State::Streaming) {
            return None;
        }
        if known.stream.starved(cycle) {
            return Some(Fault::StreamStarved);
        }
        // At rest nothing hurries, and another axis may still be on its way out of the pass.
        let silent =
            |due: Cycle| cycle > due.after(SILENT_TICKS * self.tick + (REST_S / self.cycle_s) as u64);
        known.frame_due.filter(|due| silent(*due)).map(|_| Fault::InterpolatorSilent)
    }

    /// What makes every axis leave a pass that has begun.
    fn in_pass(&self, known: &Known) -> Option<Cause> {
        let told = known.leave_at.is_some_and(|at| known.measurement.cycle >= at);
        let fails = self.others_fail(known.measurement);
        let (pass, stage) = match known.state {
            State::InPass { stage: Stage::Armed, .. } if fails => {
                return Some(Cause::Leave(Some(Fault::OtherAxis)));
            }
            State::InPass { stage: Stage::Armed, .. } => return told.then_some(Cause::Leave(None)),
            State::InPass { pass, stage } => (pass, *stage),
            _ => return None,
        };
        let panel = &known.measurement.panel;
        let presses = |buttons: u32, policy: u32| panel.pressed(buttons) && pass.out.on(policy);
        if presses(Panel::FEED_HOLD, WayOut::ON_HOLD)
            || presses(Panel::STOP | Panel::ABORT, WayOut::ON_STOP)
            || told
        {
            return Some(Cause::Leave(None));
        }
        if fails {
            return Some(Cause::Leave(Some(Fault::OtherAxis)));
        }
        if known.spindle.turns_back(pass) && !pass.returns() {
            return Some(Cause::Leave(Some(Fault::SpindleReversed)));
        }
        // Nobody is there who would turn it on again, or could find out that its encoder is dead.
        let cycle = known.measurement.cycle;
        let alone = known.frame_due.is_some_and(|due| cycle > due.after(SILENT_TICKS * self.tick));
        if alone && known.spindle.stands_for((STANDS_S / self.cycle_s) as u64) {
            return Some(Cause::Leave(Some(Fault::EncoderStands)));
        }
        let (share, besides) = self.fastest;
        let most = match pass.returns() {
            true => self.fastest_tap,
            false => share * pass.programmed_deg_s / 6.0 + besides,
        };
        let (rpm, now_rpm) = (known.spindle.steady_rpm().abs(), known.spindle.rpm().abs());
        let drives = matches!(stage, Stage::RunIn | Stage::RunOut)
            && pass.hardest(stage, 6.0 * now_rpm) > self.hardest;
        (rpm > most || drives).then_some(Cause::Leave(Some(Fault::SpindleRunaway)))
    }

    fn others_fail(&self, measurement: &Measurement) -> bool {
        measurement.axes.iter().zip(self.others).any(|(axis, other)| {
            let drive = axis.drive();
            other && (drive.state() != Some(DriveState::OperationEnabled) || drive.calls())
        })
    }
}

/// What the panel says that ends everything.
fn outside(known: &Known) -> Option<Fault> {
    let panel = &known.measurement.panel;
    if panel.pressed(Panel::EMERGENCY_STOP) {
        return Some(Fault::EmergencyStop);
    }
    panel.pressed(Panel::POWER_LOST).then_some(Fault::PowerLost)
}
