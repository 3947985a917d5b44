//! The limits of the axes, in every cycle and every state of a regulator that lives. In: what each says of
//! itself, and the true speed of the spindle. Out: the first step of a commanded position beyond V T, or
//! change of a commanded speed beyond A T.
//!
//! In a pass an axis follows the spindle. What a ripple or a load does to its speed between two cycles, times
//! the lead, comes on top: an axis that did not follow would cut a flank.

use protocol::{AxisState, AxisStatus};
use rig::observe::Record;

use super::{Broken, Known};

/// Positions are whole counts of 1e-9 mm, laws are integrated.
const MORE: f64 = 1.02;
const ROUNDING: f64 = 1e-6;
/// The loop of a spindle swings over by this.
const SWING: f64 = 1.06;
/// The observer that leads a stroke is slow: it swings over by this.
const OVERSHOOT: f64 = 1.5;
/// A stroke by the angle of a spindle slower than this is as good as standing, 1/min.
const SLOW_RPM: f64 = 20.0;
/// What the spindle has done is followed within this, s.
const FOLLOWED_S: f64 = 0.1;

/// The statuses of the cycle before.
#[derive(Clone, Debug, Default)]
pub(crate) struct Limits {
    before: Vec<AxisStatus>,
    rpm: Option<f64>,
    /// Largest change of the spindle's speed in a cycle, 1/min, fading away.
    uneven: f64,
}

impl Limits {
    pub(crate) fn cycle(&mut self, known: &Known, record: &Record) -> Option<Broken> {
        let (machine, axes) = (known.machine, record.axes);
        let cycle_s = machine.general.cycle_s;
        let rpm = record.truth.spindle_rpm;
        let change_rpm = (rpm - self.rpm.replace(rpm).unwrap_or(rpm)).abs();
        self.uneven = (self.uneven * (1.0 - cycle_s / FOLLOWED_S)).max(change_rpm);
        let mut found = None;
        for ((axis, now), before) in axes.iter().zip(&self.before) {
            // Before an axis follows anything, and after it was latched, commanded is where it is measured.
            let free = |status: &AxisStatus| matches!(status.state(), AxisState::Idle | AxisState::Fault);
            if now.cycle.0 != before.cycle.0 + 1 || free(now) || free(before) {
                continue;
            }
            let Some(config) = machine.axis.get(axis) else { continue };
            let limits = config.limits();
            let step = (now.commanded_mm - before.commanded_mm).abs();
            let change = (now.velocity_mm_s - before.velocity_mm_s).abs();
            let pass = if now.state().is_in_pass() { known.passes.get(&now.pass) } else { None };
            // Its lead, and what it strokes by the angle.
            let follows = pass.map_or(0.0, |(pass, _)| {
                let stroke = before.velocity_mm_s.abs() / rpm.abs().max(SLOW_RPM);
                (pass.axis(*axis).lead_mm.abs() / 60.0).max(OVERSHOOT * stroke) * self.uneven
            });
            // As fast as the spindle is in truth, as long as that is what the pass was released for.
            let released = pass.map_or(f64::INFINITY, |(pass, _)| {
                pass.max_ratio.min(machine.spindle.override_max_pct / 100.0) * pass.s_rpm
            });
            let turned = pass.map_or(0.0, |(pass, _)| {
                pass.axis(*axis).lead_mm.abs() * rpm.abs().min(SWING * released) / 60.0
            });
            // A law by the angle of a spindle that runs away is as much faster.
            let runs_away = (rpm.abs() / released).max(1.0);
            let most = limits.v.max(turned) * cycle_s * MORE + ROUNDING;
            let fastest = limits.a * runs_away * runs_away * cycle_s * MORE + ROUNDING + follows;
            let state = now.state().name();
            if step.is_nan() || step > most {
                found.get_or_insert(Broken::new(
                    "position-step",
                    now.cycle.0,
                    format!(
                        "{axis} ({state}): {:.6} to {:.6} mm, {most:.6} allowed",
                        before.commanded_mm, now.commanded_mm
                    ),
                ));
            }
            if change.is_nan() || change > fastest {
                found.get_or_insert(Broken::new(
                    "speed-change",
                    now.cycle.0,
                    format!(
                        "{axis} ({state}): {:.4} to {:.4} mm/s, {fastest:.4} allowed",
                        before.velocity_mm_s, now.velocity_mm_s
                    ),
                ));
            }
        }
        self.before.clear();
        self.before.extend(axes.iter().map(|(_, status)| *status));
        found
    }
}
