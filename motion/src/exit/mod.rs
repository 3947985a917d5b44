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
//! to a speed   v(u) of degree 5: v, v′, v″ as they are at u = 0, v1, 0, 0 at u = 1; to rest: v1 = 0   (M100)
//! on a tangent v(u) = v0 (1 − u)³ (1 + 3u) + a0 T u (1 − u)³                                         (M101)
//! ```
//! Unlike the strokes of a pass (M2) they begin anywhere: on the way in, on a cone, in a retract. From rest
//! (M99) asks for 2.19 L/T, 7.51 L/T² and 52.5 L/T³, within 10 % of a stroke. T is the shortest of a row of
//! durations at which sampled speed, acceleration and jerk keep their limits.
//!
//! On a long way T is long, and what is left of a small a0 or j0 grows with T² and T³: (M99) would then reach
//! several times the highest speed. Then the way has two legs: (M100) to the speed at which a0 ends if it is
//! undone at once, or, where that keeps no limit either, to rest; and (M99) from there. A state that already
//! exceeds a limit takes what exceeds it least. An axis on its way to rest that brakes harder than its jerk
//! can undo in time, such as one on the helix of a spindle that stops, does not turn round to spare its jerk.

mod leg;

use crate::limits::Limits;
use crate::sample::Sample;

use leg::{BETWEEN, Leg};

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
    /// One behind the other; the second takes no time if there is only one.
    legs: [Leg; 2],
}

impl Exit {
    /// The way to rest at a place within v, a and j of `limits` (M99), if need be behind (M100).
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn to(from: &Sample, end: f64, limits: &Limits) -> Exit {
        limits.check();
        let (leg, used) = Leg::to(from, end, limits);
        if used <= BETWEEN {
            return Exit::of(leg);
        }
        let v = from.v + 0.5 * from.a * from.a.abs() / limits.j;
        let steady = Exit::by_speed(from, v.clamp(-limits.v, limits.v), end, limits);
        let by_rest = Exit::by_rest(from, end, limits);
        let better = |best: (Exit, f64), way: Exit| match way.used(limits) {
            used if best.1 > BETWEEN && used < best.1 => (way, used),
            _ => best,
        };
        [steady, by_rest].into_iter().fold((Exit::of(leg), used), better).0
    }

    /// The way to rest where that is soonest (M100), and from there to a place (M99). It never goes farther
    /// away from that place than it takes to come to rest.
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn by_rest(from: &Sample, end: f64, limits: &Limits) -> Exit {
        Exit::by_speed(from, 0.0, end, limits)
    }

    /// The same, where the jerk of it is no object (M101): from a state that no axis comes to by itself, on
    /// the law of a spindle that jams, undoing its acceleration within the limit of its jerk would take it
    /// back by millimetres.
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn by_sudden_rest(from: &Sample, end: f64, limits: &Limits) -> Exit {
        let first = Leg::sudden(from, limits);
        let then = Sample { s: first.end, ..Sample::default() };
        Exit { legs: [first, Leg::to(&then, end, limits).0] }
    }

    /// The way to a speed (M100), and from there to rest at a place (M99), mm/s and mm.
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn by_speed(from: &Sample, v: f64, end: f64, limits: &Limits) -> Exit {
        let (first, _) = Leg::change(from, v, limits);
        let then = Sample { s: first.end, v, ..Sample::default() };
        Exit { legs: [first, Leg::to(&then, end, limits).0] }
    }

    /// The way to rest, wherever that is, within v, a and j of `limits` (M100).
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn stop(from: &Sample, limits: &Limits) -> Exit {
        Exit::of(Leg::change(from, 0.0, limits).0)
    }

    /// The way to rest in a given time (M101), the same for several axes, so that they stay in the plane of
    /// their speed and acceleration; one of (nearly) 0 s stands where it begins. It takes over speed and
    /// acceleration; its jerk begins at once, and is at most twice the limit if the duration is at least
    /// [`stop_s`](Exit::stop_s).
    #[must_use]
    pub fn stop_in(from: &Sample, duration: f64) -> Exit {
        Exit::of(Leg::tangent(from, duration))
    }

    fn of(leg: Leg) -> Exit {
        Exit { legs: [leg, Leg::still(leg.end)] }
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

    /// Largest share of v, a and j that is used.
    fn used(&self, limits: &Limits) -> f64 {
        self.legs.iter().fold(0.0, |used: f64, leg| used.max(leg.used(limits)))
    }

    /// Sample `t` seconds after the beginning; at rest from the end on. Before the beginning it is the
    /// motion of constant jerk from which it began: feedforward looks back a little.
    #[must_use]
    pub fn at(&self, t: f64) -> Sample {
        let [first, second] = &self.legs;
        let begun = first.duration > 0.0;
        if begun && t < first.duration { first.at(t) } else { second.at(t - first.duration) }
    }

    /// How far it goes at most in a direction (positive or negative), mm: looked at as often as the limits.
    #[must_use]
    pub fn farthest(&self, direction: f64) -> f64 {
        let ahead = |a: f64, b: f64| if (b - a) * direction > 0.0 { b } else { a };
        self.legs.iter().flat_map(Leg::looks).map(|at| at.s).fold(self.end(), ahead)
    }

    /// Duration, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.legs[0].duration + self.legs[1].duration
    }

    /// Where it ends, mm.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.legs[1].end
    }
}

#[cfg(test)]
mod tests;
