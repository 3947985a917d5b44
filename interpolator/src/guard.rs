//! The guard of a thread: where an axis comes near its limits on the helix, the spindle is slowed; if that
//! does not help, the axes leave. In: what the axes measure and say in a tick, speeds in 1/min. Out: the
//! share of the override that is left, and whether the pass is to be left.

use machine::{AxisConfig, Machine};
use protocol::{AxisState, AxisStatus, Measurement};

use crate::axes::Axes;

/// What of thread_error_mm and of the torque limit is too near.
const ERROR_SHARE: f64 = 0.5;
const TORQUE_SHARE: f64 = 0.85;
/// Torque that is too high for so long counts, s.
const TORQUE_S: f64 = 0.02;
/// The least that is left of the override, the largest step down in a tick,
const LEAST: f64 = 0.5;
const STEP: f64 = 0.1;
/// and what is given back in a second, once a turn was good.
const BACK_PER_S: f64 = 0.1;
/// Turns in which slowing down has to help.
const HELPS_TURNS: f64 = 3.0;

/// The guard.
#[derive(Clone, Debug)]
pub(crate) struct Guard {
    share: f64,
    /// Time for which the torque of an axis has been too high, s.
    forced_s: f64,
    /// Turns since it became bad, and turns since it was good again.
    bad_turns: f64,
    good_turns: f64,
}

impl Guard {
    pub(crate) fn new() -> Guard {
        Guard { share: 1.0, forced_s: 0.0, bad_turns: 0.0, good_turns: 0.0 }
    }

    /// What is left of the override.
    pub(crate) fn share(&self) -> f64 {
        self.share
    }

    /// Whether slowing down does not help.
    pub(crate) fn in_vain(&self) -> bool {
        self.bad_turns > HELPS_TURNS
    }

    /// One tick in which a pass is cut, the spindle at `observed`, without the guard at `asked`.
    pub(crate) fn tick(
        &mut self,
        machine: &Machine,
        axes: &Axes,
        measurement: &Measurement,
        [observed, asked]: [f64; 2],
    ) {
        let tick_s = machine.general.interpolator_cycle_s;
        let turns = observed.abs() / 60.0 * tick_s;
        let (mut strays, mut forced) = (false, false);
        for (axis, config) in machine.axes() {
            let status = axes.status(axis);
            let on_helix = status.state() == AxisState::Locked;
            strays |= on_helix && strayed(status, config);
            let torque = measurement.axes[axis.index()].torque_nm.abs();
            forced |= on_helix && torque > TORQUE_SHARE * config.torque_limit_nm;
        }
        self.forced_s = if forced { self.forced_s + tick_s } else { 0.0 };
        if strays || self.forced_s >= TORQUE_S {
            let ramp = machine.spindle.ramp_rpm_s * tick_s / asked.abs().max(1e-9);
            self.share = (self.share - STEP.min(ramp)).max(LEAST);
            (self.bad_turns, self.good_turns) = (self.bad_turns + turns, 0.0);
        } else if self.share < 1.0 || self.bad_turns > 0.0 {
            // A cut that pushes once a turn has to be looked at for a whole one.
            self.good_turns += turns;
            self.bad_turns += if self.good_turns < 1.0 { turns } else { -self.bad_turns };
            if self.good_turns >= 1.0 {
                self.share = (self.share + BACK_PER_S * tick_s).min(1.0);
            }
        }
    }
}

fn strayed(status: &AxisStatus, config: &AxisConfig) -> bool {
    status.servo_error_mm.abs() > ERROR_SHARE * config.thread_error_mm
}
