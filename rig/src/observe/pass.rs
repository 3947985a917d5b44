//! Measures one pass while it is cut. In: the true state and the statuses of every control cycle, mm and
//! degrees. Out: a [`PassReport`], µm.
//!
//! | window | cycles |
//! |---|---|
//! | approach of an axis | its state is `run-in` |
//! | end of the approach | its first `locked` sample after `run-in`; the last of `run-in` if it never locks |
//! | thread of an axis (servo error, slide error) | its state is `locked` |
//! | settled thread of an axis | the same, from one turn after its law reached the helix |
//! | thread of the pass (helix) | every axis is `locked`: Z on its lead, X at depth, before the first run-out |
//! | contact of the tool | what `tool` says |
//! | the pass (speed, override, limits, setpoints) | an axis is in `run-in`, `locked` or `run-out` |

use std::mem::{offset_of, size_of};

use machine::Machine;
use motion::PassLaw;
use protocol::{
    Axis, AxisFrame, AxisLaw, AxisState, AxisStatus, AxisTruth, Changes, LeadChange, ThreadPass, Truth,
};

use super::Record;
use super::cutting::CuttingReport;
use super::helix::{Helix, LineFit};
use super::planned::Planned;
use super::span::Span;
use super::summary::{PassEnd, PassReport, ServoError};
use super::tap::Tapped;
use super::tool::{Finish, Tool};
use super::used::{LimitsUsed, Used, limits_of};

/// What one axis frame carries because of a pass: number, S, direction, the first cycle that counts, the law.
const PASS_BYTES: usize = size_of::<AxisFrame>() - offset_of!(AxisFrame, pass) - size_of::<Changes>();

/// Two ways of computing one position differ by less, mm.
const SAME_MM: f64 = 1e-6;

/// One error of an axis over its pass, mm.
#[derive(Clone, Copy, Debug, Default)]
struct ErrorTrack {
    approach: Span,
    end_mm: f64,
    thread_max_abs_mm: f64,
    settled_max_abs_mm: f64,
}

impl ErrorTrack {
    /// Takes the error of a cycle in a state, that of the cycle before, and whether the run-in has died away.
    fn add(&mut self, before: AxisState, state: AxisState, settled: bool, error_mm: f64) {
        match state {
            AxisState::RunIn => {
                self.approach.add(error_mm);
                self.end_mm = error_mm;
            }
            AxisState::Locked => {
                if before == AxisState::RunIn {
                    self.end_mm = error_mm;
                }
                self.thread_max_abs_mm = self.thread_max_abs_mm.max(error_mm.abs());
                if settled {
                    self.settled_max_abs_mm = self.settled_max_abs_mm.max(error_mm.abs());
                }
            }
            _ => {}
        }
    }

    fn report(&self) -> ServoError {
        let (low, high) = self.approach.ends();
        ServoError {
            approach_min_um: 1e3 * low,
            approach_max_um: 1e3 * high,
            end_um: 1e3 * self.end_mm,
            thread_max_abs_um: 1e3 * self.thread_max_abs_mm,
            settled_max_abs_um: 1e3 * self.settled_max_abs_mm,
        }
    }
}

/// One axis of the pass.
#[derive(Clone)]
struct AxisTrack {
    axis: Axis,
    law: PassLaw,
    start_mm: f64,
    /// Limits of speed, acceleration and jerk, mm/sⁿ, and the largest share of each that its law asks for.
    limits: [f64; 3],
    asked: [f64; 3],
    /// What its nut uses of them.
    used: Used,
    state: AxisState,
    /// True angle of the index this axis started from, degrees.
    index_deg: Option<f64>,
    /// Commanded minus measured, and commanded minus true slide.
    servo: ErrorTrack,
    slide: ErrorTrack,
    /// Angle from which the run-in counts as died away, degrees.
    settled_deg: f64,
    /// It came to rest at the end of its law.
    done: bool,
    /// It left the pass.
    left: bool,
    /// Where its law ends, mm.
    end_mm: f64,
}

impl AxisTrack {
    /// Takes the status of a cycle and where the axis truly stands; whether the law moves the axis in it.
    fn cycle(&mut self, pass: u32, status: &AxisStatus, truth: &AxisTruth, index_deg: f64) -> bool {
        self.used.cycle(truth.motor_mm);
        let state = state_in(pass, status);
        let before = std::mem::replace(&mut self.state, state);
        self.left |= state == AxisState::Leaving;
        if self.index_deg.is_none() && (AxisState::WaitingForC0..=AxisState::RunOut).contains(&state) {
            self.index_deg = Some(index_deg);
        }
        if !(AxisState::RunIn..=AxisState::RunOut).contains(&state) {
            use AxisState::{Leaving, Locked, RunOut};
            let was_under_law = matches!(before, Locked | RunOut | Leaving);
            let at_end = (status.commanded_mm - self.end_mm).abs() < SAME_MM;
            self.done |= was_under_law && state == AxisState::Streaming && (at_end || before != Leaving);
            return state == Leaving;
        }
        let settled = status.angle_deg >= self.settled_deg;
        self.servo.add(before, state, settled, status.servo_error_mm);
        self.slide.add(before, state, settled, status.commanded_mm - truth.slide_mm);
        let moves = [status.velocity_mm_s, status.acceleration_mm_s2, status.jerk_mm_s3];
        for ((asked, value), limit) in self.asked.iter_mut().zip(moves).zip(self.limits) {
            *asked = asked.max(value.abs() / limit);
        }
        true
    }
}

/// The state of an axis as far as a pass is concerned; another pass, or none, is timed motion to it.
pub(super) fn state_in(pass: u32, status: &AxisStatus) -> AxisState {
    match status.state() {
        AxisState::Fault => AxisState::Fault,
        state if status.pass == pass => state,
        _ => AxisState::Streaming,
    }
}

/// Measures one pass.
#[derive(Clone)]
pub(super) struct PassObserver {
    pass: ThreadPass,
    line: u32,
    tool_number: u32,
    origin_mm: Option<[f64; 2]>,
    depth_mm: f64,
    axes: Vec<AxisTrack>,
    /// The axis along the thread.
    along: Axis,
    helix: Helix,
    motor: LineFit,
    slide: LineFit,
    tool: Tool,
    tap: Option<Tapped>,
    cutting: Option<CuttingReport>,
    rpm: Span,
    override_pct: Span,
    ticks: u64,
    armed_cycle: u64,
    begin_cycle: u64,
    end_cycle: u64,
    thread_cycles: u64,
    /// Its law has moved an axis.
    moved: bool,
}

impl PassObserver {
    /// A pass that was armed just now.
    pub(super) fn new(machine: &Machine, planned: &Planned, armed_cycle: u64) -> PassObserver {
        let pass = &planned.pass;
        let track = |(axis, config): (Axis, &machine::AxisConfig)| AxisTrack {
            axis,
            law: pass.law(axis),
            start_mm: pass.axis(axis).start.mm(),
            limits: limits_of(config),
            asked: [0.0; 3],
            used: Used::new(machine, config),
            state: AxisState::Armed,
            index_deg: None,
            servo: ErrorTrack::default(),
            slide: ErrorTrack::default(),
            settled_deg: pass.axis(axis).locked_deg() + 360.0,
            done: false,
            left: false,
            end_mm: pass.axis(axis).end.mm(),
        };
        let along = pass.along();
        PassObserver {
            pass: *pass,
            line: planned.line,
            tool_number: planned.tool,
            origin_mm: planned.origin_mm,
            depth_mm: planned.depth_mm,
            axes: machine.axes().map(track).collect(),
            along,
            helix: Helix::of(pass, along),
            motor: LineFit::default(),
            slide: LineFit::default(),
            tool: Tool::new(machine, planned, along),
            tap: Tapped::of(pass),
            cutting: None,
            rpm: Span::default(),
            override_pct: Span::default(),
            ticks: 0,
            armed_cycle,
            begin_cycle: 0,
            end_cycle: 0,
            thread_cycles: 0,
            moved: false,
        }
    }

    /// The pass as it was told.
    pub(super) fn pass(&self) -> &ThreadPass {
        &self.pass
    }

    /// Takes a control cycle. `index_deg` is the true angle of the index that measurements show. Whether the
    /// pass goes on.
    pub(super) fn cycle(&mut self, record: &Record, index_deg: f64, is_tick: bool) -> bool {
        let had_index = self.index_deg().is_some();
        let (mut moving, mut waiting) = (false, false);
        for (axis, status) in record.axes {
            if let Some(track) = self.axes.iter_mut().find(|track| track.axis == *axis) {
                let place = &record.truth.axes[axis.index()];
                let led = track.cycle(self.pass.pass, status, place, index_deg);
                self.moved |= led && status.velocity_mm_s != 0.0;
                moving |= led;
                waiting |= track.state.is_in_pass();
            }
        }
        let truth = record.truth;
        CuttingReport::take(&mut self.cutting, truth);
        if !had_index && self.index_deg().is_some() {
            self.begin_cycle = truth.cycle.0;
        }
        if moving {
            self.rpm.add(truth.spindle_rpm * self.pass.direction);
            self.override_pct.add(truth.measurement.panel.spindle_override_pct);
            self.ticks += u64::from(is_tick);
            self.end_cycle = truth.cycle.0;
        }
        if self.axes.iter().all(|track| track.state == AxisState::Locked) {
            let c = self.angle_deg(self.along, truth.spindle_deg);
            let place = &truth.axes[self.along.index()];
            self.motor.add(c, self.helix.error_um(c, place.motor_mm));
            self.slide.add(c, self.helix.error_um(c, place.slide_mm));
            self.thread_cycles += 1;
        }
        if self.track(self.along).is_some_and(|track| track.index_deg.is_some()) {
            let led = !self.axes.iter().any(|track| track.left || track.state == AxisState::Fault);
            let c_deg = self.angle_deg(self.along, truth.spindle_deg);
            self.tool.cycle(c_deg, truth, led);
            self.tap.iter_mut().for_each(|tap| tap.cycle(c_deg, truth));
        }
        waiting
    }

    /// Where zero of the program lies on the machine, if it is known: X, Z, mm.
    pub(super) fn origin_mm(&self) -> Option<[f64; 2]> {
        self.origin_mm
    }

    /// How deep the tool is below the crest, mm, and how far off the helix of the pass, µm; `None` if it cuts
    /// nothing, or the pass has no index yet.
    pub(super) fn off_helix(&self, truth: &Truth) -> Option<[f64; 2]> {
        self.index_deg()?;
        self.tool.off_helix(self.angle_deg(self.along, truth.spindle_deg), truth)
    }

    /// How deep the pass goes, if its tool was in the material.
    pub(super) fn depth(&self) -> Option<Finish> {
        self.tool.finish()
    }

    /// True angle since the index that an axis took, in the direction of the pass, degrees; 0 before it took
    /// one.
    fn angle_deg(&self, axis: Axis, spindle_deg: f64) -> f64 {
        let index = self.track(axis).and_then(|track| track.index_deg);
        index.map_or(0.0, |index| self.pass.direction * (spindle_deg - index))
    }

    /// Where the pass wants an axis at the true spindle angle, mm; `None` while it does not belong to the
    /// pass.
    pub(super) fn programmed_mm(&self, axis: Axis, spindle_deg: f64) -> Option<f64> {
        let track = self.track(axis).filter(|track| track.state.is_in_pass())?;
        Some(track.start_mm + track.law.at(self.angle_deg(axis, spindle_deg)).s)
    }

    fn index_deg(&self) -> Option<f64> {
        self.axes.iter().find_map(|track| track.index_deg)
    }

    /// The measures of the pass; `None` if its law moved no axis: it was called off, and is not a pass.
    pub(super) fn finish(&self) -> Option<PassReport> {
        let index_deg = self.index_deg().filter(|_| self.moved)?;
        let ThreadPass { pass, start, s_rpm, direction, thread_end_deg, max_ratio, .. } = self.pass;
        let (run_in, x) = (self.pass.axis(self.along), self.pass.axis(Axis::X));
        let (rpm_min, rpm_max) = self.rpm.ends();
        let (override_min_pct, override_max_pct) = self.override_pct.ends();
        let axes = self.axes.len();
        Some(PassReport {
            pass,
            line: self.line,
            tool_number: self.tool_number,
            origin_mm: self.origin_mm,
            start,
            on_face: self.along == Axis::X,
            lead_mm: self.pass.lead_mm,
            programmed_rpm: s_rpm,
            rpm_min,
            rpm_max,
            override_min_pct,
            override_max_pct,
            max_feasible_override_pct: 100.0 * max_ratio,
            c0_deg: run_in.run_in_c0_deg,
            delta_c_deg: run_in.run_in_dc_deg,
            delta_z_mm: run_in.lead_mm * run_in.run_in_dc_deg / 720.0,
            delta_x_mm: x.stroke_mm,
            thread_end_deg,
            packet_bytes: ((PASS_BYTES + size_of::<LeadChange>() * self.pass.corners().count()) * axes)
                as u64,
            setpoints_saved: self.ticks * axes as u64,
            x: self.error(Axis::X, |track| &track.servo),
            z: self.error(Axis::Z, |track| &track.servo),
            x_slide: self.error(Axis::X, |track| &track.slide),
            z_slide: self.error(Axis::Z, |track| &track.slide),
            helix_max_abs_um: self.motor.max_abs(),
            phase_um: self.motor.mean(),
            lead_error_um_per_rev: self.motor.slope(),
            limits_used_pct: self.limits(|track| track.used.shares()),
            limits_asked_pct: self.limits(|track| track.asked),
            slide_helix_max_abs_um: self.slide.max_abs(),
            slide_phase_um: self.slide.mean(),
            tool: self.tool.report(),
            tap: self.tap.as_ref().map(Tapped::report),
            cutting: self.cutting,
            direction,
            index_deg,
            same_index: self.axes.iter().all(|track| track.index_deg == Some(index_deg)),
            depth_mm: self.depth_mm,
            x_moments_deg: moments(x),
            z_moments_deg: moments(self.pass.axis(Axis::Z)),
            helix_at_index_mm: self.helix.at_index_mm(),
            lead_changes: self.pass.changes(self.along).iter().map(told).collect(),
            armed_cycle: self.armed_cycle,
            begin_cycle: self.begin_cycle,
            end_cycle: self.end_cycle,
            thread_cycles: self.thread_cycles,
            complete: self.end() == PassEnd::Complete,
            end: self.end(),
        })
    }

    /// How the pass ended.
    fn end(&self) -> PassEnd {
        let at_depth = self.tap.as_ref().is_none_or(Tapped::was_at_depth);
        if at_depth && self.axes.iter().all(|track| track.done) {
            return PassEnd::Complete;
        }
        let rests = |track: &AxisTrack| track.done || track.left && track.state != AxisState::Leaving;
        if self.axes.iter().all(rests) { PassEnd::Left } else { PassEnd::CutOff }
    }

    fn track(&self, axis: Axis) -> Option<&AxisTrack> {
        self.axes.iter().find(|track| track.axis == axis)
    }

    fn error(&self, axis: Axis, of: fn(&AxisTrack) -> &ErrorTrack) -> ServoError {
        self.track(axis).map(|track| of(track).report()).unwrap_or_default()
    }

    fn limits(&self, of: fn(&AxisTrack) -> [f64; 3]) -> LimitsUsed {
        LimitsUsed::of([Axis::X, Axis::Z].map(|axis| self.track(axis).map_or([0.0; 3], of)))
    }
}

/// A change of lead as a summary tells it.
fn told(change: &LeadChange) -> [f64; 4] {
    [change.c_deg, change.dc_deg, change.lead_mm, change.growth_mm]
}

/// The angles between which a law runs in, is locked, and runs out.
fn moments(law: &AxisLaw) -> [f64; 4] {
    [law.begins_deg(), law.locked_deg(), law.leaves_deg(), law.done_deg()]
}
