//! What the bends of a stretch leave to changes of feed, by the speed at which they are passed. In: limits of
//! s at some speeds, mm/sⁿ. Out: limits up to any speed; how far a speed can change on a way.
//!
//! A bend takes k₂v² of the acceleration, k₃v³ of the jerk and k₄v⁴ of its rate (M55): at a lower speed much
//! less. So a stretch has limits of its own (M66) at each of a row of speeds Gₖ:
//!
//! ```text
//! Gₖ = 2^(k/8) mm/s;  L(v): those of M66 at the least Gₖ ≥ v, or at the top speed of the stretch      (M179)
//! reach(F) = max over k of the speed up to Gₖ that a way can join with F within L(Gₖ)                 (M180)
//! ```
//! Limits fall as the speed rises, so those at the highest speed of a ramp hold all along it. Every row has
//! the same speeds; stretches joined to one have the lower of both limits at each of them.

use crate::feed::{FeedBlock, junction_distance};
use crate::limits::Limits;
use crate::reach::reach;

/// Speeds in a row: from the top speed down to 0.55 of it, where bends take a third at most.
const SPEEDS: usize = 8;
/// Speeds of the row from one to its double: 2^(k/8).
const OCTAVE: [f64; 8] = [
    1.0,
    1.090_507_732_665_257_7,
    1.189_207_115_002_721,
    1.296_839_554_651_009_6,
    core::f64::consts::SQRT_2,
    1.542_210_825_407_940_7,
    1.681_792_830_507_429,
    1.834_008_086_409_342_4,
];
/// Bits of a double below its exponent, and what that is counted from.
const MANTISSA: u32 = 52;
const BIAS: i32 = 1023;

/// Gₖ: the same double for the same k, mm/s.
fn speed(k: i32) -> f64 {
    let count = OCTAVE.len() as i32;
    let power = (BIAS + k.div_euclid(count)).clamp(1, 2 * BIAS);
    OCTAVE[k.rem_euclid(count) as usize] * f64::from_bits((power as u64) << MANTISSA)
}

/// The least k with Gₖ ≥ `v`, of a positive finite `v`.
fn index(v: f64) -> i32 {
    let bits = v.to_bits();
    let power = (bits >> MANTISSA) as i32 - BIAS;
    let share = f64::from_bits(bits & ((1 << MANTISSA) - 1) | (BIAS as u64) << MANTISSA);
    let within = OCTAVE.iter().position(|speed| share <= *speed).unwrap_or(OCTAVE.len());
    power * OCTAVE.len() as i32 + within as i32
}

/// Limits of s over a stretch, by speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowance {
    /// Highest speed, mm/s.
    pub(super) v: f64,
    /// k of the top of the row: the least Gₖ that is not below the highest speed.
    top: i32,
    /// Acceleration, jerk and jerk rate at the highest speed, then at Gₖ below it.
    row: [[f64; 3]; SPEEDS],
}

impl Allowance {
    /// Up to the speed `v`, mm/s; `limits` has those at a speed, which fall as it rises.
    pub(super) fn new(v: f64, limits: impl Fn(f64) -> Limits) -> Allowance {
        let top = index(v);
        let at = |k: usize| {
            let Limits { a, j, dj, .. } = limits(speed(top - k as i32).min(v));
            [a, j, dj]
        };
        Allowance { v, top, row: core::array::from_fn(at) }
    }

    /// The same at every speed up to that of `limits`.
    pub(super) fn flat(limits: &Limits) -> Allowance {
        Allowance { v: limits.v, top: index(limits.v), row: [[limits.a, limits.j, limits.dj]; SPEEDS] }
    }

    /// The limits of a place of the row, and its speed.
    fn at(&self, k: usize) -> Limits {
        let [a, j, dj] = self.row[k];
        Limits { v: speed(self.top - k as i32).min(self.v), a, j, dj }
    }

    /// The place of a speed; the last one below the row, the first one above it.
    fn place(&self, v: f64) -> usize {
        let below = if v > 0.0 { self.top.saturating_sub(index(v)) } else { i32::MAX };
        below.clamp(0, SPEEDS as i32 - 1) as usize
    }

    /// Limits of laws that get as fast as `v`, mm/s.
    pub(super) fn up_to(&self, v: f64) -> Limits {
        Limits { v: self.v, ..self.at(self.place(v)) }
    }

    /// The lower of both at each speed.
    pub(super) fn min(&self, other: &Allowance) -> Allowance {
        let (low, high) = if self.v <= other.v { (self, other) } else { (other, self) };
        let above = (high.top - low.top) as usize;
        let mut both = *low;
        for (k, limits) in both.row.iter_mut().enumerate() {
            let other = &high.row[(k + above).min(SPEEDS - 1)];
            limits.iter_mut().zip(other).for_each(|(limit, other)| *limit = limit.min(*other));
        }
        both
    }

    /// Way of a ramp between two speeds, mm.
    pub(super) fn way(&self, a: f64, b: f64) -> f64 {
        junction_distance(a, b, &self.up_to(a.max(b)))
    }

    /// Highest speed up to `cap` that a way of `length` mm can join with the speed `from` (M180), mm/s;
    /// `from` if that is higher.
    pub(super) fn reach(&self, from: f64, cap: f64, length: f64) -> f64 {
        let mut best = from;
        for k in (0..=self.place(from)).rev() {
            let limits = self.at(k);
            let most = if k == 0 { cap } else { cap.min(limits.v) };
            let speed = reach(from, most, length, &limits);
            best = best.max(speed);
            if speed < most || most >= cap {
                break;
            }
        }
        best
    }

    /// The fastest law over `length` mm from the speed `start` to `end` with `cap` at most (M23), and the
    /// limits that it keeps: those of its highest speed. `None` if there is none.
    pub(super) fn block(&self, length: f64, start: f64, cap: f64, end: f64) -> Option<(FeedBlock, Limits)> {
        let least = start.max(end);
        let mut best: Option<(FeedBlock, Limits)> = None;
        for k in (0..=self.place(least)).rev() {
            let mut limits = self.at(k);
            limits.v = limits.v.max(least);
            let Ok(block) = FeedBlock::plan(length, start, cap, end, &limits) else { break };
            if best.as_ref().is_some_and(|(best, _)| best.duration() <= block.duration()) {
                break;
            }
            let fits = block.reaches_feed();
            best = Some((block, limits));
            if !fits || limits.v >= cap {
                break;
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::{Allowance, SPEEDS, index, speed};
    use crate::limits::Limits;

    #[test]
    fn m179_a_speed_has_the_least_of_the_row_that_is_not_below_it() {
        for k in -80..80 {
            let at = speed(k);
            assert!((libm::exp2(f64::from(k) / 8.0) / at - 1.0).abs() < 1e-15, "{k}: {at}");
            assert_eq!([index(at.next_down()), index(at), index(at.next_up())], [k, k, k + 1]);
        }
    }

    /// Limits that fall as the fourth power of a speed, and none beyond `v`.
    fn falling(v: f64, most: f64) -> Allowance {
        Allowance::new(v, |speed| {
            let left = most * (1.0 - 0.7 * (speed / v) * (speed / v) * (speed / v) * (speed / v));
            Limits { v, a: 100.0 * left, j: 4e3 * left, dj: 4e5 * left }
        })
    }

    #[test]
    fn m179_joined_stretches_have_at_each_speed_what_both_allow() {
        for (v, other) in [(80.0, 80.0), (80.0, 95.0), (30.0, 200.0), (31.0, 31.5)] {
            let (a, b) = (falling(v, 20.0), falling(other, 14.0));
            for both in [a.min(&b), b.min(&a)] {
                assert_eq!(both.v, v.min(other));
                for speed in [0.0, 0.2 * v, 0.6 * v, 0.8 * v, 0.99 * v, both.v] {
                    let (one, two, both) = (a.up_to(speed), b.up_to(speed), both.up_to(speed));
                    assert!(both.a <= one.a.min(two.a) && both.dj <= one.dj.min(two.dj), "{speed} of {v}");
                }
            }
        }
    }

    #[test]
    fn m180_a_speed_that_is_reached_is_reached_within_the_limits_at_it() {
        let stretch = falling(80.0, 20.0);
        let mut last = 0.0;
        for length in [1e-3, 0.01, 0.1, 0.5, 1.0, 2.0, 4.0, 8.0, 20.0, 100.0] {
            let speed = stretch.reach(5.0, 80.0, length);
            assert!(speed >= last && stretch.way(5.0, speed) <= length * (1.0 + 1e-12), "{length}: {speed}");
            // What limits at the top speed alone allow is no more.
            assert!(speed >= crate::reachable_feed(5.0, 80.0, length, &stretch.at(0)) * (1.0 - 1e-9));
            let (block, limits) = stretch.block(length, 5.0, 80.0, speed).expect("it can be reached");
            assert!(block.peak_feed() <= limits.v && limits.a <= stretch.up_to(block.peak_feed()).a);
            last = speed;
        }
        assert_eq!(last, 80.0);
        assert_eq!(stretch.place(0.0), SPEEDS - 1);
    }
}
