//! What the bends of a stretch leave to changes of feed, by the speed at which they are passed. In: limits of
//! s at some speeds, mm/sⁿ. Out: limits up to any speed; how far a speed can change on a way.
//!
//! A bend takes k₂v² of the acceleration, k₃v³ of the jerk and k₄v⁴ of its rate (M55): at a lower speed much
//! less. So a stretch has limits of its own (M66) at each of a row of speeds Gₖ:
//!
//! ```text
//! Gₖ = 2^(k/4) mm/s;  L(v): those of M66 at the least Gₖ ≥ v, or at the top speed of the stretch      (M179)
//! reach(F) = max over k of the speed up to Gₖ that a way can join with F within L(Gₖ)                 (M180)
//! from F₀ to F₁: one ramp within L(max F), or two: between the lower one and a Gₖ within L(Gₖ), and between
//!     this and the higher one; whichever law over the way takes least time                            (M184)
//! ```
//! Limits fall as the speed rises, so those at the highest speed of a ramp hold all along it. Every row has
//! the same speeds; stretches joined to one have the lower of both limits at each of them. Where (M184) takes
//! two ramps the law in hand ends between them, without acceleration.

use crate::feed::{FeedBlock, junction_distance};
use crate::limits::Limits;
use crate::ramp::Ramp;
use crate::reach::reach;

/// Ways that differ by less are one, mm.
pub(super) const SAME: f64 = 1e-9;
/// Speeds in a row: from the top speed down to 0.6 of it, where bends take a third at most.
const SPEEDS: usize = 4;
/// Speeds of the row from one to its double: 2^(k/4).
const OCTAVE: [f64; 4] = [1.0, 1.189_207_115_002_721, core::f64::consts::SQRT_2, 1.681_792_830_507_429];
/// By this share a ramp that is left for later has a longer way than it takes, so that rounding does no harm.
const SHORT: f64 = 1e-9;
/// A law that leaves a ramp for later takes less time by this factor, with the ramp.
const LEAST_GAIN: f64 = 1.0 - 1e-4;
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

    /// The place of a speed; the last one below the row, the first one above it. What rounding makes of a Gₖ
    /// is at its place.
    fn place(&self, v: f64) -> usize {
        let below = if v > 0.0 { self.top.saturating_sub(index(v * (1.0 - SHORT))) } else { i32::MAX };
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
    /// `from` if that is higher. A speed that can be joined within the limits at it leaves room for every
    /// lower one, so the row is halved.
    pub(super) fn reach(&self, from: f64, cap: f64, length: f64) -> f64 {
        if cap <= from {
            return from;
        }
        // On a short way the first of these is not reached, and no faster one is.
        let (top, first) = (self.place(cap), self.place(from));
        let limits = self.at(first);
        let most = cap.min(limits.v);
        let slow = reach(from, most, length, &limits);
        if slow < most || first == top {
            return slow;
        }
        let (mut above, mut below) = (top, first);
        while above < below {
            let k = (above + below) / 2;
            let limits = self.at(k);
            if junction_distance(from, cap.min(limits.v), &limits) <= length {
                below = k;
            } else {
                above = k + 1;
            }
        }
        let reached = cap.min(self.at(below).v);
        if below == top {
            return reached;
        }
        let limits = self.at(below - 1);
        reached.max(reach(from, cap.min(limits.v), length, &limits))
    }

    /// The fastest law over `length` mm from the speed `start` to `end` with `cap` at most (M23), and the
    /// limits that it keeps: those of its highest speed. `None` if there is none.
    ///
    /// It may end before `length`: where the way of a ramp from a lower speed to `end` is left, or behind a
    /// ramp from `start` to a lower speed than its highest; that ramp has the limits of this speed (M184).
    /// Laws take `least_s` at least then, s.
    pub(super) fn block(
        &self,
        length: f64,
        [start, cap, end]: [f64; 3],
        least_s: f64,
    ) -> Option<(FeedBlock, Limits)> {
        let one = self.quickest(length, start, cap, end);
        let (mut least, peak) = one.map_or((f64::INFINITY, start.max(end)), |law| (law.time, law.peak));
        let mut best = one.map(|law| (length, end, law));
        let lower = (self.place(peak) + 1..SPEEDS).map(|k| self.at(k).v);
        for v in core::iter::once(start).chain(lower.clone()).filter(|v| end < *v && *v < peak) {
            let limits = self.up_to(v);
            let (way, time) = ramp(v, end, &limits);
            let rest = length - way * (1.0 + SHORT) - SAME;
            if rest < start.max(v) * least_s {
                continue;
            }
            let Some(first) = self.quickest(rest, start, cap, v) else { continue };
            if first.time >= least_s && first.time + time < least * LEAST_GAIN {
                (least, best) = (first.time + time, Some((rest, v, first)));
            }
        }
        for v in lower.filter(|v| start < *v && *v < peak) {
            let limits = Limits { v, ..self.up_to(v) };
            let (way, time) = ramp(start, v, &limits);
            let way = way * (1.0 + SHORT) + SAME;
            if time < least_s || way > length {
                continue;
            }
            let Some(second) = self.quickest(length - way, v, cap, end) else { continue };
            if second.time + time < least * LEAST_GAIN {
                let first = Quickest { time, peak: v, limits, block: None };
                (least, best) = (second.time + time, Some((way, v, first)));
            }
        }
        let (length, end, Quickest { limits, block, .. }) = best?;
        let block = match block {
            Some(block) => block,
            None => FeedBlock::fitting(length, start, cap, end, &limits)?,
        };
        Some((block, limits))
    }

    /// Time of the fastest law over `length` mm from the speed `start` to `end` with `cap` at most, or with
    /// these two, s. `None` if there is none.
    pub(super) fn time(&self, length: f64, [start, cap, end]: [f64; 3]) -> Option<f64> {
        self.quickest(length, start, cap.max(start).max(end), end).map(|law| law.time)
    }

    /// The fastest law to the end of a way with the limits of its highest speed.
    fn quickest(&self, length: f64, start: f64, cap: f64, end: f64) -> Option<Quickest> {
        let least = start.max(end);
        let mut best: Option<Quickest> = None;
        for k in (0..=self.place(least)).rev() {
            let mut limits = self.at(k);
            limits.v = limits.v.max(least);
            let peak = cap.min(limits.v);
            let [(up, rise), (down, fall)] = [start, end].map(|v| ramp(v, peak, &limits));
            let fits = up + down <= length;
            let now = if fits {
                Quickest { time: rise + fall + (length - up - down) / peak, peak, limits, block: None }
            } else {
                let Some(block) = FeedBlock::fitting(length, start, cap, end, &limits) else { break };
                Quickest { time: block.duration(), peak: block.peak_feed(), limits, block: Some(block) }
            };
            if best.as_ref().is_some_and(|best| best.time <= now.time) {
                break;
            }
            best = Some(now);
            if !fits || limits.v >= cap {
                break;
            }
        }
        best
    }
}

/// What is known of the fastest law over a way: its time, s, its highest speed, mm/s, the limits that it
/// keeps; itself, where its time did not follow from these.
#[derive(Clone, Copy)]
struct Quickest {
    time: f64,
    peak: f64,
    limits: Limits,
    block: Option<FeedBlock>,
}

/// Way and time of the fastest ramp between two speeds (M21, M22), mm and s.
fn ramp(a: f64, b: f64, limits: &Limits) -> (f64, f64) {
    let time = Ramp::shortest(a - b, limits);
    (0.5 * (a + b) * time, time)
}

#[cfg(test)]
mod tests {
    use super::{Allowance, SAME, SPEEDS, index, speed};
    use crate::limits::Limits;

    #[test]
    fn m179_a_speed_has_the_least_of_the_row_that_is_not_below_it() {
        for k in -80..80 {
            let at = speed(k);
            assert!((libm::exp2(f64::from(k) / 4.0) / at - 1.0).abs() < 1e-15, "{k}: {at}");
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
            let (block, limits) =
                stretch.block(length, [5.0, 80.0, speed], 0.002).expect("it can be reached");
            assert!(block.peak_feed() <= limits.v && limits.a <= stretch.up_to(block.peak_feed()).a);
            last = speed;
        }
        assert_eq!(last, 80.0);
        assert_eq!(stretch.place(0.0), SPEEDS - 1);
        // A law that was to end at a speed of the row may do so an ulp above it.
        for k in 1..SPEEDS {
            assert_eq!([stretch.place(stretch.at(k).v), stretch.place(stretch.at(k).v.next_up())], [k, k]);
        }
    }
    /// A law with a ramp that is left for later, and then that ramp, take less time than any one law, and
    /// together they keep the limits at each speed and make the whole way.
    #[test]
    fn m184_two_ramps_are_as_fast_as_one_at_least() {
        let stretch = falling(80.0, 20.0);
        let mut two = 0;
        for length in [2.0, 4.0, 8.0, 12.0, 20.0, 100.0] {
            for (start, end) in [(0.0, 0.0), (5.0, 0.0), (60.0, 0.0), (0.0, 60.0), (40.0, 10.0), (70.0, 70.0)]
            {
                let Some(one) = stretch.quickest(length, start, 80.0, end) else { continue };
                let (mut way, mut time, mut speed, mut laws) = (0.0, 0.0, start, 0);
                while length - way > SAME {
                    let (law, limits) =
                        stretch.block(length - way, [speed, 80.0, end], 0.002).expect("it goes on");
                    let peak = law.peak();
                    assert!(peak.a <= limits.a && peak.j <= limits.j && peak.dj <= limits.dj);
                    assert!(
                        limits.a <= stretch.up_to(law.peak_feed()).a,
                        "{limits:?} at {}",
                        law.peak_feed()
                    );
                    (way, time, speed) = (way + law.length(), time + law.duration(), law.end_feed());
                    laws += 1;
                    assert!(laws < 20, "{start} to {end} on {length}");
                }
                assert!((speed - end).abs() < 1e-6 && time <= one.time * (1.0 + 1e-6), "{time} {}", one.time);
                two += u32::from(laws > 1 && time < 0.99 * one.time);
            }
        }
        assert!(two > 5, "{two} are faster by a hundredth");
    }
}
