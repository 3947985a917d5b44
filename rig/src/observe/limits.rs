//! Whether timed motion keeps to the limits of the axes. In: one [`Record`] each control cycle, mm and s.
//! Out: the share of each limit that is used.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | v, a | mm/s, mm/s² | commanded speed and acceleration at a tick of the interpolator: exactly those of the planned law |
//! | h | s | interpolator cycle |
//! | V, A, J, D | mm/sⁿ | limits of the axis |
//!
//! ```text
//! |v| ≤ V,   |a| ≤ A,   |a(t) − a(t−h)| ≤ h J,   |a(t) − 2 a(t−h) + a(t−2h)| ≤ h² D
//! ```
//! The last two hold for every law with |j| ≤ J and |dj/dt| ≤ D, so they never accuse a good one. Between its
//! ticks the law is not sent; what regulators interpolate there is theirs, and is not held against it.

use std::collections::BTreeMap;

use machine::Machine;
use protocol::{Axis, AxisState, PerAxis};

use super::{AxisLimits, Record};

/// Excess that is rounding, not a violation.
const TOLERANCE: f64 = 1.0 + 1e-6;

/// Shares of the limits of speed, acceleration, jerk and jerk rate of an axis that are used; 1 is all of it.
pub(super) type Shares = [f64; 4];

/// Whether more is used of a limit than there is.
pub(super) fn beyond(used: &PerAxis<Shares>) -> bool {
    used.iter().flatten().any(|share| *share > TOLERANCE)
}

/// Commanded accelerations of one axis at the last two ticks of timed motion, the later first.
type Before = [Option<f64>; 2];

/// Holds commanded motion against the limits.
#[derive(Clone, Debug)]
pub(super) struct Limits {
    axes: BTreeMap<Axis, motion::Limits>,
    ticks: u64,
    tick_s: f64,
    before: PerAxis<Before>,
}

impl Limits {
    pub(super) fn of(machine: &Machine) -> Limits {
        Limits {
            axes: machine.axes().map(|(axis, config)| (axis, config.limits())).collect(),
            ticks: machine.cycles_per_tick(),
            tick_s: machine.general.interpolator_cycle_s,
            before: Default::default(),
        }
    }

    /// What is used of the limits in this control cycle; between the ticks nothing is known.
    pub(super) fn used(&mut self, record: &Record) -> Option<PerAxis<Shares>> {
        if !record.truth.cycle.0.is_multiple_of(self.ticks) {
            return None;
        }
        let mut used = PerAxis::<Shares>::default();
        for (axis, status) in record.axes {
            let Some(limit) = self.axes.get(axis) else { continue };
            let before = &mut self.before[axis.index()];
            if status.state() != AxisState::Streaming || status.cycle != record.truth.cycle {
                *before = [None; 2];
                continue;
            }
            let (v, a) = (status.velocity_mm_s, status.acceleration_mm_s2);
            let one = before[0].map_or(0.0, |a1| a - a1);
            let two = before[0].zip(before[1]).map_or(0.0, |(a1, a2)| a - 2.0 * a1 + a2);
            *before = [Some(a), before[0]];
            let h = self.tick_s;
            let share = |value: f64, limit: f64| value.abs() / limit;
            used[axis.index()] =
                [share(v, limit.v), share(a, limit.a), share(one, limit.j * h), share(two, limit.dj * h * h)];
        }
        Some(used)
    }
}

/// The limits as the summary has them.
pub(super) fn reported(machine: &Machine) -> BTreeMap<Axis, AxisLimits> {
    let of_axis = |(axis, config): (Axis, &machine::AxisConfig)| {
        let limits = AxisLimits {
            velocity_mm_s: config.velocity_mm_s,
            acceleration_mm_s2: config.acceleration_mm_s2,
            jerk_mm_s3: config.jerk_mm_s3,
        };
        (axis, limits)
    };
    machine.axes().map(of_axis).collect()
}
