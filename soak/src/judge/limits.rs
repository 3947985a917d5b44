//! The limits of the axes, in every cycle and every state of a regulator that lives. In: what each says of
//! itself. Out: the first step of a commanded position beyond V T, or change of a commanded speed beyond A T.

use machine::Machine;
use protocol::{AxisState, AxisStatus};

use super::Broken;

/// Positions are whole counts of 1e-9 mm, and a ripple of the spindle passes through (M8).
const MORE: f64 = 1.02;
const ROUNDING: f64 = 1e-6;

/// The statuses of the cycle before.
#[derive(Clone, Debug, Default)]
pub(crate) struct Limits {
    before: Vec<AxisStatus>,
}

impl Limits {
    pub(crate) fn cycle(&mut self, machine: &Machine, axes: &[(protocol::Axis, AxisStatus)]) -> Option<Broken> {
        let cycle_s = machine.general.cycle_s;
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
            let (most, fastest) = (limits.v * cycle_s * MORE + ROUNDING, limits.a * cycle_s * MORE + ROUNDING);
            let state = now.state().name();
            if step.is_nan() || step > most {
                found.get_or_insert(Broken::new(
                    "position-step",
                    now.cycle.0,
                    format!("{axis} ({state}): {:.6} to {:.6} mm, {most:.6} allowed", before.commanded_mm, now.commanded_mm),
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
