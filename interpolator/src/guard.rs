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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axes::Heard;
    use protocol::{Axis, Cycle, units::AXES};

    /// 600 1/min.
    const RPM: [f64; 2] = [600.0; 2];

    /// One tick with X on the helix, at a share of its error and of its torque.
    fn tick(guard: &mut Guard, machine: &Machine, error: f64, torque: f64) -> f64 {
        let config = &machine.axis[&Axis::X];
        let mut statuses = [AxisStatus::default(); AXES];
        statuses[Axis::X.index()] = AxisStatus {
            cycle: Cycle(3),
            state: AxisState::Locked as u32,
            servo_error_mm: -error * config.thread_error_mm,
            ..AxisStatus::default()
        };
        let mut heard = Heard::new();
        heard.take(machine, &statuses, Cycle(4));
        let mut measurement = Measurement { cycle: Cycle(4), ..Measurement::default() };
        measurement.axes[Axis::X.index()].torque_nm = -torque * config.torque_limit_nm;
        guard.tick(machine, &Axes::new(machine, &heard, Cycle(4)), &measurement, RPM);
        guard.share()
    }

    #[test]
    fn an_error_beyond_half_slows_down_and_a_good_turn_gives_back() {
        let (machine, mut guard) = (Machine::plain(), Guard::new());
        assert_eq!(tick(&mut guard, &machine, 0.49, 0.84), 1.0);
        let mut before = 1.0;
        for _ in 0..40 {
            let share = tick(&mut guard, &machine, 0.51, 0.0);
            assert!(share <= before && before - share <= STEP + 1e-12, "{before} → {share}");
            before = share;
        }
        assert!((LEAST..1.0).contains(&before), "{before}");
        // A turn takes 0.1 s: until then nothing is given back.
        for _ in 0..49 {
            assert_eq!(tick(&mut guard, &machine, 0.0, 0.0), before);
        }
        (0..3).for_each(|_| before = tick(&mut guard, &machine, 0.0, 0.0).max(before));
        assert!(guard.share() == before && before > LEAST, "{before}");
        for _ in 0..5000 {
            tick(&mut guard, &machine, 0.0, 0.0);
        }
        assert!(guard.share() == 1.0 && !guard.in_vain());
    }

    #[test]
    fn slowing_down_is_in_vain_after_three_turns() {
        let (machine, mut guard) = (Machine::plain(), Guard::new());
        for tick_number in 0..149 {
            tick(&mut guard, &machine, 0.6, 0.0);
            assert!(!guard.in_vain(), "tick {tick_number}");
        }
        (0..3).for_each(|_| assert!(tick(&mut guard, &machine, 0.6, 0.0) < 1.0));
        assert!(guard.in_vain());
    }

    #[test]
    fn torque_counts_after_twenty_milliseconds() {
        let (machine, mut guard) = (Machine::plain(), Guard::new());
        for _ in 0..5 {
            (0..9).for_each(|_| assert_eq!(tick(&mut guard, &machine, 0.0, 0.9), 1.0));
            assert_eq!(tick(&mut guard, &machine, 0.0, 0.8), 1.0, "a peak");
        }
        (0..11).for_each(|_| assert!(tick(&mut guard, &machine, 0.0, 0.9) <= 1.0));
        assert!(guard.share() < 1.0);
    }
}
