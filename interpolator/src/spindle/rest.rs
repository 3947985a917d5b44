//! Whether a spindle rests. In: once a tick its count. Out: whether its mean angle has stood for a while, and
//! it is still there.
//!
//! ```text
//! rests    the mean angle of 0.1 s moves by no more than half a count and 1 1/min, three times in a row,
//!          and no count is farther from the mean before than twice what the noise was
//! ```
//!
//! The speed of a tick would not do: noise of an encoder of a few counts looks like some 20 1/min, for good;
//! and a spindle that is stopped hard swings through zero.

use machine::{Machine, SpindleConfig};

/// A mean is over so long, s; so many in a row have to say so.
const MEAN_S: f64 = 0.1;
const MEANS: u32 = 3;

/// Whether a spindle rests, whatever the noise of its encoder.
#[derive(Clone, Debug)]
pub(super) struct Rest {
    ticks: u32,
    /// How far a mean may move, count.
    most: f64,
    /// Sum over the ticks of this mean, and how many they are; from the count at which it began.
    sum: (f64, u32),
    last: Option<f64>,
    /// Means in a row that did not move.
    still: u32,
    /// How far the count was from the mean before at most: in the last mean, in this one; and how far it is
    /// now.
    flicker: f64,
    seen: f64,
    off: f64,
}

impl Rest {
    pub(super) fn new(machine: &Machine) -> Rest {
        let ticks = (MEAN_S / machine.general.interpolator_cycle_s).ceil().max(1.0);
        let s = ticks * machine.general.interpolator_cycle_s;
        let most = 0.5 + SpindleConfig::STANDSTILL_RPM / 60.0 * s * machine.spindle_counts();
        Rest {
            ticks: ticks as u32,
            most,
            sum: (0.0, 0),
            last: None,
            still: 0,
            flicker: 0.0,
            seen: 0.0,
            off: 0.0,
        }
    }

    pub(super) fn update(&mut self, count: i64) {
        self.sum = (self.sum.0 + count as f64, self.sum.1 + 1);
        self.off = (count as f64 - self.last.unwrap_or(count as f64)).abs();
        self.seen = self.seen.max(self.off);
        if self.sum.1 < self.ticks {
            return;
        }
        let mean = self.sum.0 / f64::from(self.ticks);
        let calm = self.still == 0 || self.seen <= self.flickers();
        let stands = calm && self.last.is_some_and(|last| (mean - last).abs() <= self.most);
        (self.sum, self.last) = ((0.0, 0), Some(mean));
        (self.flicker, self.seen) = (self.seen, 0.0);
        self.still = if stands { self.still.saturating_add(1) } else { 0 };
    }

    /// Twice the noise of the mean before.
    fn flickers(&self) -> f64 {
        2.0 * self.flicker.max(self.most)
    }

    /// Whether it rests: long enough, and now.
    pub(super) fn holds(&self) -> bool {
        self.still >= MEANS && self.off <= self.flickers()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lets the angle go with the time in s, in counts, under noise of so many counts; whether it ever
    /// rests, and whether it does in the end.
    fn go(rest: &mut Rest, s: f64, noise: i64, angle: impl Fn(f64) -> f64) -> (bool, bool) {
        let (tick_s, mut random, mut ever) = (0.002, 7_u64, false);
        for tick in 0..(s / tick_s) as u64 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let off = (random >> 33) as i64 % (2 * noise + 1) - noise;
            rest.update(angle(tick as f64 * tick_s).floor() as i64 + off);
            ever |= rest.holds();
        }
        (ever, rest.holds())
    }

    fn rest() -> (Rest, f64) {
        let machine = Machine::plain();
        (Rest::new(&machine), machine.spindle_counts())
    }

    #[test]
    fn noise_at_rest_rests_and_a_slow_turn_does_not() {
        for noise in [0, 1, 4] {
            let (mut rest, turn) = rest();
            assert_eq!(go(&mut rest, 2.0, noise, |_| 100.5), (true, true), "noise of {noise}");
            // From rest it is let go again: within a tenth of a second or two it does not rest any more.
            go(&mut rest, 0.3, noise, |s| 100.5 + 20.0 / 60.0 * turn * s);
            assert!(!rest.holds(), "noise of {noise}, let go");
        }
        for noise in [0, 1] {
            let (mut rest, turn) = rest();
            assert_eq!(go(&mut rest, 5.0, noise, |s| 2.0 / 60.0 * turn * s), (false, false), "{noise}");
        }
    }

    #[test]
    fn one_that_swings_rests_once_it_has_calmed_down() {
        let (mut rest, turn) = rest();
        let swings = |s: f64| 0.02 * turn * libm::exp(-s) * libm::sin(std::f64::consts::TAU * 7.3 * s);
        let (ever, _) = go(&mut rest, 1.0, 1, swings);
        assert!(!ever, "it swings by some degrees");
        let (_, now) = go(&mut rest, 8.0, 1, |s| swings(s + 1.0));
        assert!(now, "it has calmed down");
    }
}
