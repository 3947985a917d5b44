//! How much of the limits of an axis its true motion uses in a pass: speed, acceleration and jerk of the nut
//! by differences over one interpolator cycle. In: its true position in every control cycle, mm. Out: shares
//! of the limits.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | p₀, p₁, p₂, p₃ | mm | true position now, and one, two, three interpolator cycles ago |
//! | h | s | interpolator cycle |
//!
//! ```text
//! (M124) v = (p₀ − p₁)/h,   a = (p₀ − 2p₁ + p₂)/h²,   j = (p₀ − 3p₁ + 3p₂ − p₃)/h³
//! ```
//! They are taken in every control cycle. What the axis does between them, above 1/2h, does not show.

use std::collections::VecDeque;

use machine::{AxisConfig, Machine};
use serde::{Deserialize, Serialize};

/// Speed, acceleration and jerk of a pass in per cent of the limits of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // axis and derivative, as the name says
pub struct LimitsUsed {
    pub x_v: f64,
    pub x_a: f64,
    pub x_j: f64,
    pub z_v: f64,
    pub z_a: f64,
    pub z_j: f64,
}

impl LimitsUsed {
    /// Of shares of the limits of X and Z.
    pub(super) fn of([x, z]: [[f64; 3]; 2]) -> LimitsUsed {
        let ([x_v, x_a, x_j], [z_v, z_a, z_j]) = (x.map(|share| 100.0 * share), z.map(|share| 100.0 * share));
        LimitsUsed { x_v, x_a, x_j, z_v, z_a, z_j }
    }

    /// The largest of them.
    pub fn most(&self) -> f64 {
        [self.x_v, self.x_a, self.x_j, self.z_v, self.z_a, self.z_j].into_iter().fold(0.0, f64::max)
    }
}

/// Limits of speed, acceleration and jerk of an axis, mm/sⁿ.
pub(super) fn limits_of(config: &AxisConfig) -> [f64; 3] {
    [config.velocity_mm_s, config.acceleration_mm_s2, config.jerk_mm_s3]
}

/// Watches the nut of one axis.
#[derive(Clone, Debug)]
pub(super) struct Used {
    limits: [f64; 3],
    h_s: f64,
    /// Control cycles in h.
    step: usize,
    /// Positions of the last three h, the latest first.
    seen: VecDeque<f64>,
    shares: [f64; 3],
}

impl Used {
    pub(super) fn new(machine: &Machine, config: &AxisConfig) -> Used {
        let step = machine.cycles_per_tick() as usize;
        Used {
            limits: limits_of(config),
            h_s: machine.general.interpolator_cycle_s,
            step,
            seen: VecDeque::with_capacity(3 * step + 2),
            shares: [0.0; 3],
        }
    }

    /// Takes the true position in a control cycle, mm.
    pub(super) fn cycle(&mut self, nut_mm: f64) {
        self.seen.push_front(nut_mm);
        self.seen.truncate(3 * self.step + 1);
        let ago = |ticks: usize| self.seen.get(ticks * self.step).map(|before| nut_mm - before);
        let differences = [
            ago(1),
            ago(2).zip(ago(1)).map(|(two, one)| 2.0 * one - two),
            ago(3).zip(ago(2)).zip(ago(1)).map(|((three, two), one)| 3.0 * one - 3.0 * two + three),
        ];
        let mut h = 1.0;
        for ((share, limit), difference) in self.shares.iter_mut().zip(self.limits).zip(differences) {
            h *= self.h_s;
            *share = share.max(difference.map_or(0.0, |difference| difference.abs() / (h * limit)));
        }
    }

    /// The largest shares so far.
    pub(super) fn shares(&self) -> [f64; 3] {
        self.shares
    }
}

#[cfg(test)]
mod tests {
    use protocol::Axis;

    use super::*;

    #[test]
    fn m124_a_polynomial_has_its_own_differences() {
        let machine = Machine::plain();
        let config = &machine.axis[&Axis::Z];
        let [v, a, j] = limits_of(config);
        // Up to s = 0.05 s: speed from 10 to 13 mm/s, acceleration from 40 to 80 mm/s², jerk 800 mm/s³.
        let at = |s: f64| 10.0 * s + 20.0 * s * s + 800.0 / 6.0 * s * s * s;
        let mut used = Used::new(&machine, config);
        (0..=100).for_each(|cycle| used.cycle(at(f64::from(cycle) * machine.general.cycle_s)));
        let [speed, acceleration, jerk] = used.shares();
        let h = machine.general.interpolator_cycle_s;
        assert!((speed * v - (at(0.05) - at(0.05 - h)) / h).abs() < 1e-9, "{}", speed * v);
        // The mean over two cycles is that of their middle.
        assert!((acceleration * a - (40.0 + 800.0 * (0.05 - h))).abs() < 1e-6, "{}", acceleration * a);
        assert!((jerk * j - 800.0).abs() < 1e-3, "{}", jerk * j);
    }

    #[test]
    fn an_axis_that_rests_uses_nothing() {
        let machine = Machine::plain();
        let mut used = Used::new(&machine, &machine.axis[&Axis::X]);
        (0..100).for_each(|_| used.cycle(12.0));
        assert_eq!(used.shares(), [0.0; 3]);
    }
}
