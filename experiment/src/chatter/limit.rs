//! The limit that the plant's own model has, at an even and at a varied speed. In: mode, cutting stiffness,
//! speed, variation. Out: the widest chip at which a swing dies away, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | w_1, w_2 | mm | root of the mean square of p beside its place at rest, over the second and the last third of the time |
//! | T | turn | that third: [`TURNS`] at least, of a periodic variation a whole number of periods |
//!
//! ```text
//! stable if w_2 < w_1                                                                              (M237)
//! ```
//! The cut has been going on, and the tool is kicked a little: what is asked is whether that small swing
//! grows. The limit is the end of the first range of widths that are stable, counted from below on a ladder
//! of sixths.

use core::f64::consts::TAU;

use machine::SpeedLaw;
use protocol::Variation;
use sim_plant::{Chatter, ChatterMode, Chip};

/// Control cycle of the simulation, s.
const CYCLE_S: f64 = 0.000_5;
/// Fewest turns of a third of the time, and shortest time of it, periods of the mode over the damping.
const TURNS: f64 = 24.0;
const DECAYS: f64 = 12.0;
/// The swing that the cut begins with, mm; one that has grown or died away by so much goes on doing so. The
/// chip is 1 mm thick: the tool never leaves it meanwhile.
const BEGINS_MM: f64 = 1e-6;
const GROWN: f64 = 1e5;
const GONE: f64 = 1e-5;
/// Where the limit is searched, by the least of the lobes, and how closely.
const RANGE: [f64; 2] = [0.3, 60.0];
const CLOSE: f64 = 0.01;

/// What is cut, and how fast.
#[derive(Clone, Copy, Debug)]
pub(super) struct Case {
    pub(super) mode: ChatterMode,
    /// K, N/mm².
    pub(super) stiffness_n_mm2: f64,
    pub(super) rpm: f64,
    pub(super) variation: Option<Variation>,
    /// By which random levels are drawn.
    pub(super) seed: u64,
}

impl Case {
    /// Turns of a third of the time.
    fn turns(&self) -> f64 {
        let decays = DECAYS / (self.mode.hz * self.mode.damping) * self.rpm / 60.0;
        let least = TURNS.max(decays);
        let period = self.variation.map_or(1.0, |variation| variation.revolutions);
        period * (least / period).ceil()
    }

    /// Whether a swing dies away at a width of the chip, mm (M237).
    pub(super) fn is_stable(&self, width_mm: f64) -> bool {
        let chip = Chip { stiffness_n_mm: self.stiffness_n_mm2 * width_mm, thickness_mm: 1.0 };
        let rest = -chip.stiffness_n_mm * chip.thickness_mm / self.mode.stiffness_n_mm;
        let law = self.variation.map(|variation| SpeedLaw::new(variation, self.seed));
        let (third, mut chatter) = (self.turns(), Chatter::new(self.mode, CYCLE_S));
        chatter.settle(&chip);
        chatter.kick(BEGINS_MM * TAU * self.mode.hz);
        let (mut turns, mut sums) = (0.0, [(0.0, 0.0); 3]);
        while turns < 3.0 * third {
            let share = law.map_or(1.0, |law| law.share(turns));
            let turned = self.rpm * share / 60.0 * CYCLE_S;
            let (sum, count) = &mut sums[((turns / third) as usize).min(2)];
            let mut most = 0.0_f64;
            chatter.advance(&chip, turned, |p| {
                let off = p - rest;
                (*sum, *count, most) = (*sum + off * off, *count + 1.0, most.max(off.abs()));
            });
            turns += turned;
            if most > GROWN * BEGINS_MM || turns > third && most < GONE * BEGINS_MM {
                return most < BEGINS_MM;
            }
        }
        let [_, before, after] = sums.map(|(sum, count)| sum / f64::max(count, 1.0));
        after < before
    }

    /// The limit, mm; nothing if it lies beyond what is searched. `least_mm`: that of the lobes.
    pub(super) fn limit_mm(&self, least_mm: f64) -> Option<f64> {
        let [mut low, mut high] = RANGE.map(|share| share * least_mm);
        // From below: the first width that is not stable, on a ladder of sixths.
        let mut rung = low;
        while self.is_stable(rung) {
            low = rung;
            rung *= 7.0 / 6.0;
            if rung > high {
                return None;
            }
        }
        high = rung;
        while high - low > CLOSE * low {
            let middle = 0.5 * (low + high);
            if self.is_stable(middle) { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }
}
