//! How fast path time runs: live overrides and feed hold, each change itself smooth.
//!
//! A planned profile is a function of path time τ. An override makes dτ/dt = r. Changes of r follow a sin² law (M2)
//! over a time long enough that r′v and 3rr′a + r″v (M8) stay within the share of the limits that plans leave free.

use motion::{Limits, Stroke};

/// Share of acceleration, jerk and jerk rate that a plan may use; the rest is for changes of pace.
pub const PLAN_SHARE: f64 = 0.8;

/// Shortest time of a change, s.
const SHORTEST_S: f64 = 0.05;

/// The pace of one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    from: f64,
    change: Option<Change>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Change {
    law: Stroke,
    elapsed: f64,
}

/// Path time gained in a step, and the pace at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Gain of path time, s.
    pub tau: f64,
    /// r at the end of the step.
    pub ratio: f64,
    /// dr/dt at the end of the step, 1/s.
    pub ratio_rate: f64,
}

impl Pace {
    /// A constant pace.
    pub fn constant(ratio: f64) -> Pace {
        Pace { from: ratio, change: None }
    }

    /// Asks for another pace. A change in progress is finished first; ask again each tick. `peak` are the greatest
    /// derivatives of the plan at r = 1, `limits` those of the path.
    pub fn turn_to(&mut self, ratio: f64, peak: &Limits, limits: &Limits) {
        if self.change.is_some() || ratio == self.from {
            return;
        }
        let step = (ratio - self.from).abs();
        let fastest = ratio.max(self.from);
        let spare = 1.0 - PLAN_SHARE;
        let acceleration = 2.0 * step * peak.v / (spare * limits.a);
        let jerk_of_rate = (16.0 * step * peak.v / (spare * limits.j)).sqrt();
        let jerk_of_product = 12.0 * step * fastest * peak.a / (spare * limits.j);
        let duration = acceleration.max(jerk_of_rate).max(jerk_of_product).max(SHORTEST_S);
        self.change = Some(Change { law: Stroke::new(ratio - self.from, duration), elapsed: 0.0 });
    }

    /// Goes on by `dt` seconds.
    pub fn advance(&mut self, dt: f64) -> Step {
        let Some(change) = &mut self.change else {
            return Step { tau: self.from * dt, ratio: self.from, ratio_rate: 0.0 };
        };
        let at = |t: f64| change.law.at(t);
        let (begin, middle) = (at(change.elapsed).s, at(change.elapsed + 0.5 * dt).s);
        change.elapsed += dt;
        let end = change.law.at(change.elapsed);
        let simpson = (begin + 4.0 * middle + end.s) / 6.0;
        let step = Step {
            tau: ((self.from + simpson) * dt).max(0.0),
            ratio: (self.from + end.s).max(0.0),
            ratio_rate: end.v,
        };
        if change.elapsed >= change.law.duration() {
            self.from = (self.from + change.law.length()).max(0.0);
            self.change = None;
        }
        step
    }

    /// Whether the pace is zero and stays so.
    pub fn holds(&self) -> bool {
        self.from == 0.0 && self.change.is_none()
    }
}
