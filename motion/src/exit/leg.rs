//! One leg of a way out: a polynomial of time to rest. In: the state in which it begins, mm and s; limits.
//! Out: the leg, and the share of the limits that it uses.

use crate::limits::Limits;
use crate::sample::Sample;

/// Each duration tried is longer by this factor than the one before.
const LONGER: f64 = 1.12;
/// How many are tried.
const TRIES: u32 = 24;
/// How often a duration is looked at.
const LOOKS: u32 = 24;
/// What is left of the limits for peaks between two looks, a share.
pub(super) const BETWEEN: f64 = 0.99;
/// The first duration tried is so much longer than one that uses a limit to the full.
const FIRST: f64 = 1.02;
/// A shorter time is none, s.
const SHORTEST_S: f64 = 1e-9;
/// Peaks of (M99) from rest, by L/T, L/T², L/T³.
const PLACE: [f64; 3] = [2.1875, 7.5132, 52.5];
/// An axis that turns round for a shorter way than this on its way to rest may, mm.
const BACK_MM: f64 = 0.02;
/// On (M101) from rest an acceleration takes the axis a T² over this.
const BACK_SHARE: f64 = 20.0;
/// So many v/a are the longest time in which (M101) does not turn round.
const STRAIGHT: f64 = 4.0;
/// Peaks of (M100) from a speed to another, by Δv/T, Δv/T².
const SPEED: [f64; 2] = [1.875, 5.7735];

/// A polynomial of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Leg {
    /// Coefficients of s(u), mm.
    c: [f64; 8],
    pub(super) duration: f64,
    pub(super) end: f64,
}

impl Leg {
    /// At rest, in no time.
    pub(super) fn still(s: f64) -> Leg {
        Leg { c: [s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], duration: 0.0, end: s }
    }

    /// (M99), and the largest share of a limit that it uses.
    pub(super) fn to(from: &Sample, end: f64, limits: &Limits) -> (Leg, f64) {
        let from = &begun(from, limits);
        let way = (end - from.s).abs();
        if way == 0.0 && from.v == 0.0 && from.a == 0.0 && from.j == 0.0 {
            return (Leg::still(end), 0.0);
        }
        let [v, a, j] = PLACE;
        let shortest =
            (v * way / limits.v).max((a * way / limits.a).sqrt()).max(libm::cbrt(j * way / limits.j));
        Leg::shortest(shortest.max(least(from, limits)), limits, |duration| Leg::place(from, end, duration))
    }

    /// (M100) to a speed, and the largest share of a limit that it uses. An axis that brakes so hard that it
    /// would turn round before its jerk has undone that comes to rest by (M101), in the longest time in which
    /// it does not: v is v0 (1 − u)⁴ then, and no acceleration above the one it has.
    pub(super) fn change(from: &Sample, v: f64, limits: &Limits) -> (Leg, f64) {
        limits.check();
        let from = &begun(from, limits);
        if from.v == v && from.a == 0.0 && from.j == 0.0 {
            return (Leg::still(from.s), 0.0);
        }
        let undone = 0.5 * from.a * from.a / limits.j;
        let back_mm = undone * from.a.abs() / limits.j;
        if v == 0.0 && from.v * from.a < 0.0 && undone > 2.0 * from.v.abs() && back_mm > BACK_MM {
            let leg = Leg::tangent(from, STRAIGHT * (from.v / from.a).abs());
            return (leg, leg.used(limits));
        }
        let speed = (from.v - v).abs() + undone;
        let [by_a, by_j] = SPEED;
        let duration = (by_a * speed / limits.a).max((by_j * speed / limits.j).sqrt());
        let least = least(&Sample { v: from.v - v, ..*from }, limits);
        Leg::shortest(duration.max(least), limits, |duration| Leg::to_speed(from, v, duration))
    }

    /// (M101) in a short time: so long that the axis does not brake harder than it may, that it does not come
    /// to rest before the acceleration it has would bring it there, and that it turns round for no more than
    /// a little way.
    pub(super) fn sudden(from: &Sample, limits: &Limits) -> Leg {
        let brakes = if from.v * from.a < 0.0 { STRAIGHT * (from.v / from.a).abs() } else { 0.0 };
        let back = (BACK_SHARE * BACK_MM / from.a.abs().max(1e-3 * limits.a)).sqrt();
        Leg::tangent(from, (2.0 * from.v.abs() / limits.a).max(brakes).max(back))
    }

    fn place(from: &Sample, end: f64, t: f64) -> Leg {
        let (c0, c1, c2, c3) = (from.s, from.v * t, 0.5 * from.a * t * t, from.j * t * t * t / 6.0);
        let (d, v) = (end - (c0 + c1 + c2 + c3), -(c1 + 2.0 * c2 + 3.0 * c3));
        let (a, j) = (-(2.0 * c2 + 6.0 * c3), -6.0 * c3);
        let c4 = 35.0 * d - 15.0 * v + 2.5 * a - j / 6.0;
        let c5 = -84.0 * d + 39.0 * v - 7.0 * a + 0.5 * j;
        let c6 = 70.0 * d - 34.0 * v + 6.5 * a - 0.5 * j;
        let c7 = -20.0 * d + 10.0 * v - 2.0 * a + j / 6.0;
        Leg { c: [c0, c1, c2, c3, c4, c5, c6, c7], duration: t, end }
    }

    fn to_speed(from: &Sample, v1: f64, duration: f64) -> Leg {
        let t = duration;
        let (c0, c1, c2) = (from.v, from.a * t, 0.5 * from.j * t * t);
        let (d, v, a) = (v1 - (c0 + c1 + c2), -(c1 + 2.0 * c2), -2.0 * c2);
        let c3 = 10.0 * d - 4.0 * v + 0.5 * a;
        let c4 = -15.0 * d + 7.0 * v - a;
        let c5 = 6.0 * d - 3.0 * v + 0.5 * a;
        let c = [from.s, c0 * t, c1 * t / 2.0, c2 * t / 3.0, c3 * t / 4.0, c4 * t / 5.0, c5 * t / 6.0, 0.0];
        Leg { c, duration, end: c.iter().sum() }
    }

    /// (M101)
    pub(super) fn tangent(from: &Sample, duration: f64) -> Leg {
        if duration < SHORTEST_S {
            return Leg::still(from.s);
        }
        let (t, v, at) = (duration, from.v, from.a * duration);
        // v(u) by powers of u, integrated.
        let [c0, c1, c2, c3, c4] = [v, at, -6.0 * v - 3.0 * at, 8.0 * v + 3.0 * at, -3.0 * v - at];
        let c = [from.s, c0 * t, c1 * t / 2.0, c2 * t / 3.0, c3 * t / 4.0, c4 * t / 5.0, 0.0, 0.0];
        Leg { c, duration, end: c.iter().sum() }
    }

    /// The first of a row of durations that keeps the limits, else the one that exceeds them least; and what
    /// it uses of them.
    fn shortest(first: f64, limits: &Limits, make: impl Fn(f64) -> Leg) -> (Leg, f64) {
        let mut duration = FIRST * first.max(1e-6);
        let mut best = (make(duration), f64::INFINITY);
        for _ in 0..TRIES {
            let leg = make(duration);
            let used = leg.used(limits);
            if used < best.1 {
                best = (leg, used);
            }
            if used <= BETWEEN {
                break;
            }
            duration *= LONGER;
        }
        best
    }

    pub(super) fn looks(&self) -> impl Iterator<Item = Sample> {
        (0..=LOOKS).map(|look| self.polynomial(f64::from(look) / f64::from(LOOKS)))
    }

    pub(super) fn used(&self, limits: &Limits) -> f64 {
        self.looks().fold(0.0, |used: f64, at| {
            used.max(at.v.abs() / limits.v).max(at.a.abs() / limits.a).max(at.j.abs() / limits.j)
        })
    }

    pub(super) fn at(&self, t: f64) -> Sample {
        if t >= self.duration || self.duration == 0.0 {
            return Sample { s: self.end, ..Sample::default() };
        }
        if t < 0.0 {
            let [c0, c1, c2, c3, ..] = self.c;
            let before = Leg { c: [c0, c1, c2, c3, 0.0, 0.0, 0.0, 0.0], ..*self };
            return before.polynomial(t / self.duration);
        }
        self.polynomial(t / self.duration)
    }

    fn polynomial(&self, u: f64) -> Sample {
        if self.duration == 0.0 {
            return Sample { s: self.end, ..Sample::default() };
        }
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
}

/// The state in which a way out begins: a jerk beyond its limit ends at once, for on a long way it would
/// carry the axis far beyond every other limit.
fn begun(from: &Sample, limits: &Limits) -> Sample {
    Sample { j: from.j.clamp(-limits.j, limits.j), ..*from }
}

/// Time that the state alone asks for: its speed and its acceleration have to be undone.
fn least(from: &Sample, limits: &Limits) -> f64 {
    (from.v.abs() / limits.a).max((from.v.abs() / limits.j).sqrt()).max(from.a.abs() / limits.j)
}
