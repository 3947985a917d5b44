//! How long the interpolator has waited in its state, and for how long the spindle has stalled. In ticks.

use crate::spindle::Spindle;

/// Longest wait for drives, spindle, rest or index before it is a fault, s; three turns of the spindle are
/// added.
const PATIENCE_S: f64 = 30.0;

/// The waits.
#[derive(Clone, Debug)]
pub(crate) struct Patience {
    tick_s: f64,
    waited: u64,
    /// Ticks for which the spindle has hardly turned although it shall.
    stalled: u64,
}

impl Patience {
    pub(crate) fn new(tick_s: f64) -> Patience {
        Patience { tick_s, waited: 0, stalled: 0 }
    }

    /// A tick begins; `counts` if somebody waits in it.
    pub(crate) fn tick(&mut self, spindle: &Spindle, counts: bool) {
        self.waited = if counts { self.waited + 1 } else { 0 };
        self.stalled = if spindle.stalls() { self.stalled + 1 } else { 0 };
    }

    /// A wait begins.
    pub(crate) fn begin(&mut self) {
        self.waited = 0;
    }

    /// Ticks since the wait began.
    pub(crate) fn waited(&self) -> u64 {
        self.waited
    }

    /// Whether the wait is too long.
    pub(crate) fn is_over(&self, spindle: &Spindle) -> bool {
        self.waited >= self.most(spindle)
    }

    /// Whether the spindle has stalled for too long.
    pub(crate) fn stalled(&self, spindle: &Spindle) -> bool {
        self.stalled >= self.most(spindle)
    }

    fn most(&self, spindle: &Spindle) -> u64 {
        let rpm = spindle.commanded().abs();
        let turn_s = if rpm != 0.0 { 60.0 / rpm } else { 0.0 };
        ((PATIENCE_S + 3.0 * turn_s) / self.tick_s) as u64
    }
}
