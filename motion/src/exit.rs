//! The way out: from any state to rest, at a place or wherever the axis comes to stand. In: position, speed,
//! acceleration and jerk of an axis in mm and s; limits. Out: a law of time, in mm and s.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | T | s | duration |
//! | u | – | t/T |
//! | s0, v0, a0, j0 | mm … mm/s³ | state in which it begins |
//!
//! ```text
//! to a place   s(u) of degree 7: s, s′, s″, s‴ as they are at u = 0, at rest there at u = 1            (M99)
//! to rest      v(u) of degree 5: v, v′, v″ as they are at u = 0, all 0 at u = 1                       (M100)
//! on a tangent v(u) = v0 (1 − u)³ (1 + 3u) + a0 T u (1 − u)³                                          (M101)
//! ```
//! Unlike the strokes of a pass (M2) they begin anywhere: on the way in, on a cone, in a retract. From rest
//! (M99) asks for 2.19 L/T, 7.51 L/T² and 52.5 L/T³, within 10 % of a stroke. T is the shortest of a row of
//! durations at which sampled speed, acceleration and jerk keep their limits. A state that already exceeds a
//! limit, or is about to, takes the duration that exceeds it least.

use crate::limits::Limits;
use crate::sample::Sample;

/// Each duration tried is longer by this factor than the one before.
const LONGER: f64 = 1.12;
/// How many are tried.
const TRIES: u32 = 24;
/// How often a duration is looked at.
const LOOKS: u32 = 24;
/// What is left of the limits for peaks between two looks, a share.
const BETWEEN: f64 = 0.99;
/// The first duration tried is so much longer than one that uses a limit to the full.
const FIRST: f64 = 1.02;
/// A shorter time is none, s.
const SHORTEST_S: f64 = 1e-9;
/// Peaks of (M99) from rest, by L/T, L/T², L/T³.
const PLACE: [f64; 3] = [2.1875, 7.5132, 52.5];
/// Peaks of (M100) from a speed, by v/T, v/T².
const REST: [f64; 2] = [1.875, 5.7735];

/// A law of time that ends at rest.
///
/// ```
/// use motion::{Exit, Limits, Sample};
/// let limits = Limits { v: 150.0, a: 2000.0, j: 80_000.0, dj: 8.0e6 };
/// let cutting = Sample { s: 10.0, v: -20.0, ..Sample::default() };
/// let exit = Exit::to(&cutting, 12.0, &limits);
/// assert_eq!((exit.at(0.0).s, exit.at(0.0).v), (10.0, -20.0));
/// assert_eq!(exit.at(exit.duration()), Sample { s: 12.0, ..Sample::default() });
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exit {
    /// Coefficients of s(u), mm.
    c: [f64; 8],
    duration: f64,
    end: f64,
}

impl Exit {
    /// The way to rest at a place within v, a and j of `limits` (M99).
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn to(from: &Sample, end: f64, limits: &Limits) -> Exit {
        limits.check();
        let way = (end - from.s).abs();
        let resting = from.v == 0.0 && from.a == 0.0 && from.j == 0.0;
        if way == 0.0 && resting {
            return Exit { c: [end, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], duration: 0.0, end };
        }
        let [v, a, j] = PLACE;
        let shortest =
            (v * way / limits.v).max((a * way / limits.a).sqrt()).max(libm::cbrt(j * way / limits.j));
        Exit::shortest(shortest.max(least(from, limits)), limits, |duration| Exit::place(from, end, duration))
    }

    /// The way to rest, wherever that is, within v, a and j of `limits` (M100).
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn stop(from: &Sample, limits: &Limits) -> Exit {
        let speed = from.v.abs() + 0.5 * from.a * from.a / limits.j;
        let [by_a, by_j] = REST;
        let duration = (by_a * speed / limits.a).max((by_j * speed / limits.j).sqrt());
        Exit::shortest(duration.max(least(from, limits)), limits, |duration| Exit::rest(from, duration))
    }

    fn rest(from: &Sample, duration: f64) -> Exit {
        let t = duration;
        let (c0, c1, c2) = (from.v, from.a * t, 0.5 * from.j * t * t);
        let (d, v, a) = (-(c0 + c1 + c2), -(c1 + 2.0 * c2), -2.0 * c2);
        let c3 = 10.0 * d - 4.0 * v + 0.5 * a;
        let c4 = -15.0 * d + 7.0 * v - a;
        let c5 = 6.0 * d - 3.0 * v + 0.5 * a;
        let c = [from.s, c0 * t, c1 * t / 2.0, c2 * t / 3.0, c3 * t / 4.0, c4 * t / 5.0, c5 * t / 6.0, 0.0];
        Exit { c, duration, end: c.iter().sum() }
    }

    /// The way to rest in a given time (M101), the same for several axes, so that they stay in the plane of
    /// their speed and acceleration; one of (nearly) 0 s stands where it begins. It takes over speed and
    /// acceleration; its jerk begins at once, and is at most twice the limit if the duration is at least
    /// [`stop_s`](Exit::stop_s).
    #[must_use]
    pub fn stop_in(from: &Sample, duration: f64) -> Exit {
        if duration < SHORTEST_S {
            return Exit { c: [from.s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], duration: 0.0, end: from.s };
        }
        let (t, v, at) = (duration, from.v, from.a * duration);
        // v(u) by powers of u, integrated.
        let [c0, c1, c2, c3, c4] = [v, at, -6.0 * v - 3.0 * at, 8.0 * v + 3.0 * at, -3.0 * v - at];
        let c = [from.s, c0 * t, c1 * t / 2.0, c2 * t / 3.0, c3 * t / 4.0, c4 * t / 5.0, 0.0, 0.0];
        Exit { c, duration, end: c.iter().sum() }
    }

    /// Time in which (M101) brakes from a speed and an acceleration within v and a of `limits`, s; 0 at rest.
    #[must_use]
    pub fn stop_s(v: f64, a: f64, limits: &Limits) -> f64 {
        let rising = (a * v.signum()).clamp(0.0, limits.a);
        let by_a = 2.0 * v.abs() / (limits.a - 0.15 * rising);
        // 12 v/T² + 6 a/T, the jerk in which it begins, is twice the limit.
        let root = (36.0 * rising * rising + 96.0 * limits.j * v.abs()).sqrt();
        by_a.max((6.0 * rising + root) / (4.0 * limits.j)).max(3.0 * a.abs() / limits.j)
    }

    fn place(from: &Sample, end: f64, t: f64) -> Exit {
        let (c0, c1, c2, c3) = (from.s, from.v * t, 0.5 * from.a * t * t, from.j * t * t * t / 6.0);
        let (d, v) = (end - (c0 + c1 + c2 + c3), -(c1 + 2.0 * c2 + 3.0 * c3));
        let (a, j) = (-(2.0 * c2 + 6.0 * c3), -6.0 * c3);
        let c4 = 35.0 * d - 15.0 * v + 2.5 * a - j / 6.0;
        let c5 = -84.0 * d + 39.0 * v - 7.0 * a + 0.5 * j;
        let c6 = 70.0 * d - 34.0 * v + 6.5 * a - 0.5 * j;
        let c7 = -20.0 * d + 10.0 * v - 2.0 * a + j / 6.0;
        Exit { c: [c0, c1, c2, c3, c4, c5, c6, c7], duration: t, end }
    }

    /// The first of a row of durations that keeps the limits, else the one that exceeds them least.
    fn shortest(first: f64, limits: &Limits, make: impl Fn(f64) -> Exit) -> Exit {
        let mut duration = FIRST * first.max(1e-6);
        let mut best = (f64::INFINITY, make(duration));
        for _ in 0..TRIES {
            let exit = make(duration);
            let used = exit.used(limits);
            if used <= BETWEEN {
                return exit;
            }
            if used < best.0 {
                best = (used, exit);
            }
            duration *= LONGER;
        }
        best.1
    }

    /// Largest share of v, a and j that is used.
    fn used(&self, limits: &Limits) -> f64 {
        (0..=LOOKS).fold(0.0, |used: f64, look| {
            let at = self.polynomial(f64::from(look) / f64::from(LOOKS));
            used.max(at.v.abs() / limits.v).max(at.a.abs() / limits.a).max(at.j.abs() / limits.j)
        })
    }

    /// Sample `t` seconds after the beginning; at rest from the end on. Before the beginning it is the
    /// motion of constant jerk from which it began: feedforward looks back a little.
    #[must_use]
    pub fn at(&self, t: f64) -> Sample {
        if t >= self.duration || self.duration == 0.0 {
            return Sample { s: self.end, ..Sample::default() };
        }
        if t < 0.0 {
            let [c0, c1, c2, c3, ..] = self.c;
            let before = Exit { c: [c0, c1, c2, c3, 0.0, 0.0, 0.0, 0.0], ..*self };
            return before.polynomial(t / self.duration);
        }
        self.polynomial(t / self.duration)
    }

    fn polynomial(&self, u: f64) -> Sample {
        let [c0, c1, c2, c3, c4, c5, c6, c7] = self.c;
        let f = 1.0 / self.duration;
        let s = c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * (c5 + u * (c6 + u * c7))))));
        let (d2, d3, d4) = (2.0 * c2, 3.0 * c3, 4.0 * c4);
        let v = c1 + u * (d2 + u * (d3 + u * (d4 + u * (5.0 * c5 + u * (6.0 * c6 + u * 7.0 * c7)))));
        let a = d2 + u * (2.0 * d3 + u * (3.0 * d4 + u * (20.0 * c5 + u * (30.0 * c6 + u * 42.0 * c7))));
        let j = 2.0 * d3 + u * (6.0 * d4 + u * (60.0 * c5 + u * (120.0 * c6 + u * 210.0 * c7)));
        let dj = 6.0 * d4 + u * (120.0 * c5 + u * (360.0 * c6 + u * 840.0 * c7));
        Sample { s, v: v * f, a: a * f * f, j: j * f * f * f, dj: dj * f * f * f * f }
    }

    /// How far it goes at most in a direction (positive or negative), mm: looked at as often as the limits.
    #[must_use]
    pub fn farthest(&self, direction: f64) -> f64 {
        let places = (0..=LOOKS).map(|look| self.polynomial_or_end(f64::from(look) / f64::from(LOOKS)));
        let ahead = |a: f64, b: f64| if (b - a) * direction > 0.0 { b } else { a };
        places.fold(self.end, ahead)
    }

    fn polynomial_or_end(&self, u: f64) -> f64 {
        if self.duration == 0.0 { self.end } else { self.polynomial(u).s }
    }

    /// Duration, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Where it ends, mm.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }
}

/// Time that the state alone asks for: its speed and its acceleration have to be undone.
fn least(from: &Sample, limits: &Limits) -> f64 {
    (from.v.abs() / limits.a).max((from.v.abs() / limits.j).sqrt()).max(from.a.abs() / limits.j)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PassLaw, Window};

    const LIMITS: Limits = Limits { v: 150.0, a: 2000.0, j: 80_000.0, dj: 8.0e6 };

    /// Every state of a pass at its design speed, and at less.
    fn states() -> impl Iterator<Item = Sample> {
        let helix = |lead| {
            let run_in = Window { c: 200.0, dc: 250.0, lambda: 0.5 };
            let brake = Window { c: 2000.0, dc: 250.0, lambda: 0.5 };
            PassLaw::new(300.0).with_lead(lead, run_in, brake)
        };
        let stroke = |law: PassLaw| law.with_approach(-3.0, 200.0, 260.0).with_retract(3.0, 2000.0, 260.0);
        let laws = [PassLaw::new(300.0), helix(-0.3)].map(stroke);
        let ratios = [0.1, 0.5, 1.0, 1.1];
        laws.into_iter().flat_map(move |law| {
            ratios.into_iter().flat_map(move |r| (0..2400).map(move |c| law.at(f64::from(c)).driven(r, 0.0)))
        })
    }

    #[test]
    fn a_way_out_begins_as_the_axis_moves_and_ends_at_rest() {
        for from in states() {
            for exit in [Exit::to(&from, 1.0, &LIMITS), Exit::stop(&from, &LIMITS)] {
                let (first, last) = (exit.at(0.0), exit.at(exit.duration() * (1.0 - 1e-12)));
                let close = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-9 * scale;
                assert!(close(first.s, from.s, 1.0) && close(first.v, from.v, 1e2), "{from:?}: {first:?}");
                assert!(close(first.a, from.a, 1e4), "{from:?}: {first:?}");
                assert!(close(last.s, exit.end(), 10.0) && close(last.v, 0.0, 1e3), "{from:?}: {last:?}");
                assert!(close(last.a, 0.0, 1e5), "{from:?}: {last:?}");
            }
        }
    }

    #[test]
    fn a_way_out_of_any_moment_of_a_pass_keeps_the_limits() {
        let mut longest = 0.0f64;
        for from in states() {
            for exit in [Exit::to(&from, 1.0, &LIMITS), Exit::stop(&from, &LIMITS)] {
                longest = longest.max(exit.duration());
                for look in 0..=997 {
                    let at = exit.at(exit.duration() * f64::from(look) / 997.0);
                    assert!(at.v.abs() <= LIMITS.v && at.a.abs() <= LIMITS.a * 1.001, "{from:?}: {at:?}");
                    assert!(at.j.abs() <= LIMITS.j.max(from.j.abs()) * 1.01, "{from:?}: {at:?}");
                }
            }
        }
        assert!(longest < 0.25, "{longest} s");
    }

    #[test]
    fn from_rest_it_is_hardly_longer_than_a_stroke() {
        for mm in [0.01, 0.5, 2.0, 20.0] {
            let exit = Exit::to(&Sample::default(), mm, &LIMITS);
            let stroke = crate::Stroke::shortest(mm, &Limits { dj: f64::INFINITY, ..LIMITS });
            assert!(
                exit.duration() <= 1.06 * stroke.max(2.0 * mm / 150.0 * 1.1),
                "{mm} mm: {} s against {stroke} s",
                exit.duration()
            );
        }
    }

    #[test]
    fn on_the_tangent_speed_and_acceleration_keep_their_limits() {
        // Every state from which a motion within the limits can be: braked as hard as may be, it stops short
        // of the highest speed.
        for v in -30..=30 {
            for a in -20..=20 {
                let (v, a) = (5.0 * f64::from(v), 100.0 * f64::from(a));
                if (v + 0.5 * a * a.abs() / LIMITS.j).abs() > LIMITS.v {
                    continue;
                }
                let from = Sample { v, a, ..Sample::default() };
                let exit = Exit::stop_in(&from, 1.1 * Exit::stop_s(v, a, &LIMITS));
                for look in 0..=500 {
                    let at = exit.at(exit.duration() * f64::from(look) / 500.0);
                    assert!(at.v.abs() <= 1.02 * LIMITS.v, "{from:?}: {at:?}");
                    assert!(at.a.abs() <= LIMITS.a.max(a.abs()) * 1.001, "{from:?}: {at:?}");
                    assert!(at.j.abs() <= 2.0 * LIMITS.j, "{from:?}: {at:?}");
                }
            }
        }
    }

    #[test]
    fn who_is_there_already_stays() {
        let exit = Exit::to(&Sample { s: 3.0, ..Sample::default() }, 3.0, &LIMITS);
        assert_eq!((exit.duration(), exit.at(0.0).s), (0.0, 3.0));
        let stop = Exit::stop_in(&Sample { s: 3.0, ..Sample::default() }, 0.0);
        assert_eq!((stop.end(), stop.at(0.1).s), (3.0, 3.0));
    }
}
