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
