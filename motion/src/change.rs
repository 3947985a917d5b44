//! Change of speed from any acceleration: what a hold or an override asks for in the middle of a ramp.
//! In: speeds in mm/s, the acceleration at the start in mm/s², limits in mm/sⁿ. Out: samples, mm/sⁿ.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | v0, a0 | mm/s, mm/s² | speed and acceleration at the start; the jerk is zero there |
//! | v1 | mm/s | speed at the end, with neither acceleration nor jerk |
//! | ap | mm/s² | acceleration between both pulses |
//! | τ(Δ) | s | shortest sin² pulse of jerk that changes the acceleration by Δ |
//!
//! ```text
//! τ(Δ) = max( 2 |Δ|/J, sqrt(2π |Δ|/DJ) )                        peak jerk 2Δ/τ, peak jerk rate 2πΔ/τ²  (M63)
//! v1 − v0 = (a0 + ap)/2 τ₁ + ap tc + ap/2 τ(ap)                                                        (M64)
//! τ₁ = τ(ap − a0), but τ(ap) where ap is more of what a0 is                                           (M182)
//! ```
//! Limits may count on it that peaks of acceleration and jerk do not come together (M181). So a pulse that
//! raises an acceleration takes as long as the whole of it from none would: then it is a mean of a constant
//! acceleration and that pulse, and within all limits within which both are.
//!
//! For a0 = 0 this is the fastest ramp of M19, M20. The right side of M64 grows with ap on either side of the
//! release of a0 (ap = 0 below, ap = a0 above it), so the root is unique.

use core::f64::consts::PI;

use crate::limits::{Limits, ROUNDING};
use crate::sample::Sample;
use crate::search;
use crate::versine::Versine;

/// The fastest change of speed from a given acceleration to none.
///
/// ```
/// use motion::{Limits, SpeedChange};
/// let limits = Limits { v: 500.0, a: 2000.0, j: 80_000.0, dj: 8.0e6 };
/// // In the middle of an acceleration the operator presses feed hold.
/// let hold = SpeedChange::plan(100.0, 2000.0, 0.0, &limits);
/// let end = hold.at(hold.duration());
/// assert_eq!((end.v, end.a, end.j), (0.0, 0.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedChange {
    phases: [Phase; 3],
    v1: f64,
    duration: f64,
    distance: f64,
}

/// An acceleration that changes by `da` in a sin² pulse of jerk; 0 for a constant one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Phase {
    duration: f64,
    v: f64,
    a: f64,
    da: f64,
}

/// Shortest pulse that changes the acceleration by `da` (M63), s.
fn pulse(da: f64, limits: &Limits) -> f64 {
    let da = da.abs();
    (2.0 * da / limits.j).max((2.0 * PI * da / limits.dj).sqrt()) * ROUNDING
}

impl SpeedChange {
    /// The change from speed `v0` and acceleration `a0` to speed `v1` and none within a, j and dj of
    /// `limits`. An `a0` beyond the limit is not lessened before its time.
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn plan(v0: f64, a0: f64, v1: f64, limits: &Limits) -> SpeedChange {
        limits.check();
        let dv = v1 - v0;
        let release = 0.5 * a0 * pulse(a0, limits);
        // Mirrored so that the change asked for lies above what a release of a0 makes.
        let sign = if dv >= release { 1.0 } else { -1.0 };
        let (a0, dv) = (sign * a0, sign * dv);
        let low = a0.max(0.0);
        let first = |ap: f64| {
            let raised = if a0 > 0.0 && ap > a0 { a0 } else { 0.0 };
            pulse(ap - a0 + raised, limits)
        };
        let gained = |ap: f64| 0.5 * (a0 + ap) * first(ap) + 0.5 * ap * pulse(ap, limits);
        let top = (limits.a - low).max(0.0);
        let ap = low + search::largest(top, dv, |more| gained(low + more));
        let cruise = if ap > 0.0 { ((dv - gained(ap)) / ap).max(0.0) } else { 0.0 };
        let durations = [first(ap), cruise, pulse(ap, limits)];
        let changes = [(a0, ap - a0), (ap, 0.0), (ap, -ap)];
        let mut change = SpeedChange { phases: [Phase::default(); 3], v1, duration: 0.0, distance: 0.0 };
        let mut v = v0;
        for ((phase, duration), (a, da)) in change.phases.iter_mut().zip(durations).zip(changes) {
            *phase = Phase { duration, v, a: sign * a, da: sign * da };
            let end = phase.at(duration);
            (v, change.duration) = (end.v, change.duration + duration);
            change.distance += end.s;
        }
        change
    }

    /// Sample `t` seconds after the start; from the end on uniform motion.
    #[must_use]
    pub fn at(&self, t: f64) -> Sample {
        if t >= self.duration {
            return Sample::uniform(self.distance + self.v1 * (t - self.duration), self.v1);
        }
        let (mut gone, mut left) = (0.0, t.max(0.0));
        for phase in &self.phases {
            if left < phase.duration {
                let sample = phase.at(left);
                return Sample { s: gone + sample.s, ..sample };
            }
            gone += phase.at(phase.duration).s;
            left -= phase.duration;
        }
        Sample::uniform(self.distance, self.v1)
    }

    /// The first moment at or after `t` without jerk, s.
    #[must_use]
    pub fn settled(&self, t: f64) -> f64 {
        let [first, middle, _] = self.phases.map(|phase| phase.duration);
        match t {
            t if t < first => first,
            t if t <= first + middle => t,
            t => t.max(self.duration),
        }
    }

    /// Total time, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Way made, mm.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Speed at the end, mm/s.
    #[must_use]
    pub fn end_speed(&self) -> f64 {
        self.v1
    }

    /// When the speed is highest, s: while an acceleration at the start is led back, it still rises.
    #[must_use]
    pub fn top(&self) -> f64 {
        let Phase { duration, a, da, .. } = self.phases[0];
        if a > 0.0 && a + da < 0.0 {
            return search::largest(duration, 0.0, |t| -self.phases[0].at(t).a);
        }
        if self.v1 > self.phases[0].v { self.duration } else { 0.0 }
    }

    /// No less than the speed after a way of `s` mm, and hardly more.
    pub(crate) fn most_at(&self, s: f64) -> f64 {
        let (mut before, mut behind) = (self.top(), self.duration());
        for _ in 0..10 {
            let middle = 0.5 * (before + behind);
            let half = if self.at(middle).s <= s { &mut before } else { &mut behind };
            *half = middle;
        }
        self.at(before).v
    }

    /// Speed after a way of `s` mm.
    pub(crate) fn speed_at(&self, s: f64) -> f64 {
        self.at(search::largest(self.duration(), s, |t| self.at(t).s)).v
    }

    /// Ends of the phases, s from the start.
    pub(crate) fn ends(&self) -> [f64; 3] {
        let [first, middle, last] = self.phases.map(|phase| phase.duration);
        [first, first + middle, first + middle + last]
    }

    /// Largest magnitudes.
    #[must_use]
    pub fn peak(&self) -> Limits {
        let top = self.at(self.top()).v.abs();
        self.phases.iter().fold(Limits { v: top, a: 0.0, j: 0.0, dj: 0.0 }, |peak, phase| {
            let own = phase.peak();
            Limits {
                v: peak.v.max(own.v),
                a: peak.a.max(own.a),
                j: peak.j.max(own.j),
                dj: peak.dj.max(own.dj),
            }
        })
    }
}

impl Phase {
    fn at(&self, t: f64) -> Sample {
        let Phase { v, a, da, duration } = *self;
        let steady = Sample { s: (v + 0.5 * a * t) * t, v: v + a * t, a, ..Sample::default() };
        if da == 0.0 || duration <= 0.0 {
            return steady;
        }
        let k = 2.0 * PI / duration;
        let phase = Versine::at(k * t);
        let h = da / duration;
        steady
            + Sample {
                s: h * phase.third / (k * k * k),
                v: h * phase.second / (k * k),
                a: h * phase.first / k,
                j: h * phase.pulse,
                dj: h * k * phase.rate,
            }
    }

    fn peak(&self) -> Limits {
        let Phase { v, a, da, duration } = *self;
        let jerk = if da == 0.0 { 0.0 } else { (da / duration).abs() };
        let rate = if da == 0.0 { 0.0 } else { 2.0 * PI / duration };
        Limits { v: v.abs(), a: a.abs().max((a + da).abs()), j: 2.0 * jerk, dj: jerk * rate }
    }
}
