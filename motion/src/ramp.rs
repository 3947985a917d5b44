//! Change of speed in three intervals of sin² jerk: run-in, run-out, feed ramp (M9–M21). In: signed change of
//! speed in mm/s, duration in s, share of the jerk interval. Out: samples in mm/sⁿ, peaks. Sources:
//! "Формирование гладкого закона изменения рывка на участках разгона-торможения при высокоскоростной
//! обработке на оборудовании с ЧПУ", Eqs. (1)–(23), with (17), (18) corrected; for spindle synchronism
//! M9–M15.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | dv | mm/s | signed change of speed (V_Z of M9, ±dF of M16) |
//! | T | s | duration (p_acc of M10, tp of M17) |
//! | t1, t2 = T − t1 | s | end of the first, start of the last interval |
//! | lambda = t1/T | – | share of a jerk interval, in (0, 1/2] |
//! | J = 2 dv/(t1 t2) | mm/s³ | signed peak jerk (M11) |
//! | A = J t1/2 = dv/t2 | mm/s² | signed peak acceleration (M11) |
//! | DJ = π J/t1 | mm/s⁴ | signed peak jerk rate (M11) |
//!
//! ```text
//! 0 < p ≤ t1:   j = J sin²(π p/t1), the rest by integration                                     (M13)
//! t1 < p ≤ t2:  j = 0, a = A
//! p > T/2:      v(p) = dv − v(T − p),  s(p) = dv T/2 − dv (T − p) + s(T − p)       (point symmetry)
//! ```
//! With x = 2π p/t1, J sin²(π p/t1) = (J/2)(1 − cos x): FA, FV, FS of M13 are the integrals of `versine.rs`.

use crate::limits::{Limits, ROUNDING};
use crate::sample::Sample;
use crate::versine::Versine;
use core::f64::consts::PI;

/// Smooth change of speed from rest by a signed `dv` (M13), or its reversal, braking to rest (M15).
///
/// A run-in that reaches `dv` covers half the way the thread would have: after it the axis lies exactly on
/// the helix that starts `distance()` behind the start angle (M14).
///
/// ```
/// use motion::{Limits, Ramp};
/// let limits = Limits { v: 100.0, a: 500.0, j: 50_000.0, dj: 1.0e7 };
/// let run_in = Ramp::fastest(20.0, &limits);
/// assert!((run_in.duration() - 0.06).abs() < 1e-12 && (run_in.distance() - 0.6).abs() < 1e-12);
/// let thread = run_in.at(0.1);
/// assert_eq!(thread.v, 20.0);
/// assert!((thread.s - (0.6 + 20.0 * 0.04)).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    dv: f64,
    duration: f64,
    t1: f64,
    /// J/2, mm/s³.
    half_j: f64,
    /// 2π/t1, rad/s: rate of the phase in a jerk interval.
    phase_rate: f64,
    /// A, and V1, Z1 of M13: the state at t1.
    a: f64,
    v1: f64,
    s1: f64,
}

/// The bound that fixes the peak jerk of the fastest ramp (M19).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// Jmax itself.
    Jerk,
    /// Amax and DJmax together: sqrt(2 Amax DJmax/π).
    AccelerationAndJerkRate,
    /// DJmax and the small change of speed: cbrt(2 dv DJmax²/π²).
    JerkRate,
}

impl Ramp {
    /// Ramp by `dv` mm/s (signed) in `duration` seconds with jerk intervals of `lambda` × duration each
    /// (M11).
    ///
    /// # Panics
    /// If `lambda` is outside (0, 1/2], a value is not finite, or the duration is not positive; a ramp by 0
    /// mm/s may last 0 s.
    #[must_use]
    pub fn new(dv: f64, duration: f64, lambda: f64) -> Ramp {
        assert!(lambda > 0.0 && lambda <= 0.5, "share of the jerk interval {lambda} is outside (0, 1/2]");
        Ramp::with_interval(dv, duration, lambda * duration)
    }

    /// As [`Ramp::new`] with the jerk interval in seconds.
    fn with_interval(dv: f64, duration: f64, t1: f64) -> Ramp {
        assert!(dv.is_finite() && duration.is_finite(), "ramp by {dv} mm/s in {duration} s");
        assert!(
            t1 > 0.0 || (dv == 0.0 && duration == 0.0),
            "a ramp by {dv} mm/s takes time, not {duration} s"
        );
        if dv == 0.0 {
            return Ramp { dv, duration, t1, half_j: 0.0, phase_rate: 0.0, a: 0.0, v1: 0.0, s1: 0.0 };
        }
        let a = dv / (duration - t1);
        let half_j = a / t1;
        Ramp {
            dv,
            duration,
            t1,
            half_j,
            phase_rate: 2.0 * PI / t1,
            a,
            v1: 0.5 * a * t1,
            s1: a * t1 * t1 * (1.0 / 6.0 - 1.0 / (4.0 * PI * PI)),
        }
    }

    /// The ramp of least peak jerk that makes `dv` in `duration` without exceeding `a_max` (M12); `None` if
    /// the mean acceleration already does. The caller checks jerk and jerk rate with [`Ramp::peak`]. If there
    /// is none, or the peaks are too high: lengthen the run-in or lower the spindle speed.
    ///
    /// # Panics
    /// As [`Ramp::new`].
    #[must_use]
    pub fn least_jerk(dv: f64, duration: f64, a_max: f64) -> Option<Ramp> {
        let lambda = if dv == 0.0 { 0.5 } else { (1.0 - dv.abs() / (a_max * duration)).min(0.5) };
        (lambda > 0.0).then(|| Ramp::new(dv, duration, lambda))
    }

    /// The shortest ramp of the family by `dv` within a, j and dj of `limits` (M18–M20); empty if `dv` is 0.
    /// Its length is the shortest run-in. `limits.v` does not enter: it bounds a speed, not a change of
    /// speed.
    ///
    /// # Panics
    /// If a limit is not positive, jerk and jerk rate are both unbounded, or `dv` is not finite.
    #[must_use]
    pub fn fastest(dv: f64, limits: &Limits) -> Ramp {
        let (t1, duration) = Ramp::fastest_times(dv.abs(), limits);
        Ramp::with_interval(dv, duration, t1)
    }

    /// t1 and T of the fastest ramp by `dv` ≥ 0 (M20, M21); both 0 for 0.
    fn fastest_times(dv: f64, limits: &Limits) -> (f64, f64) {
        if dv == 0.0 {
            return (0.0, 0.0);
        }
        let (j_p, _) = Ramp::peak_jerk(dv, limits);
        let (t1_a, t1_f) = (2.0 * limits.a / j_p, (2.0 * dv / j_p).sqrt());
        if t1_f <= t1_a {
            (t1_f * ROUNDING, 2.0 * (t1_f * ROUNDING))
        } else {
            (t1_a * ROUNDING, (t1_a + dv / limits.a) * ROUNDING)
        }
    }

    /// Duration T(dv) in s of the fastest ramp (M21), without building it; continuous and increasing in |dv|.
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn shortest(dv: f64, limits: &Limits) -> f64 {
        Ramp::fastest_times(dv.abs(), limits).1
    }

    /// T(dv) and its derivative by dv ≥ 0, s and s²/mm (M21): T grows with the cube root, the square root, or
    /// evenly.
    pub(crate) fn shortest_and_slope(dv: f64, limits: &Limits) -> (f64, f64) {
        if dv <= 0.0 {
            return (0.0, f64::INFINITY);
        }
        let (j_p, binding) = Ramp::peak_jerk(dv, limits);
        let (t1_a, t1_f) = (2.0 * limits.a / j_p, (2.0 * dv / j_p).sqrt());
        if t1_f > t1_a {
            return ((t1_a + dv / limits.a) * ROUNDING, 1.0 / limits.a);
        }
        let duration = 2.0 * (t1_f * ROUNDING);
        let power = if binding == Binding::JerkRate { 3.0 } else { 2.0 };
        (duration, duration / (power * dv))
    }

    /// Peak jerk in mm/s³ of the fastest ramp by `dv`, and the bound that fixes it (M19).
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn peak_jerk(dv: f64, limits: &Limits) -> (f64, Binding) {
        limits.check();
        let by_a = (2.0 * limits.a * (limits.dj / PI)).sqrt();
        let cube = 2.0 * dv.abs() * (limits.dj / PI) * (limits.dj / PI);
        let within = |bound: f64| bound * bound * bound <= cube;
        if limits.j <= by_a && within(limits.j) {
            (limits.j, Binding::Jerk)
        } else if within(by_a) {
            (by_a, Binding::AccelerationAndJerkRate)
        } else {
            (libm::cbrt(cube), Binding::JerkRate)
        }
    }

    /// Sample `p` seconds after the start of the run-in: at rest at 0 for `p` ≤ 0; for `p` ≥ duration uniform
    /// motion `s = distance + dv (p − duration)` (M14).
    #[must_use]
    #[inline]
    pub fn at(&self, p: f64) -> Sample {
        if p <= 0.0 || self.dv == 0.0 {
            Sample::default()
        } else if p >= self.duration {
            Sample::uniform(self.distance() + self.dv * (p - self.duration), self.dv)
        } else if p <= 0.5 * self.duration {
            self.first_half(p)
        } else {
            let left = self.duration - p;
            let Sample { s, v, a, j, dj } = self.first_half(left);
            Sample { s: self.distance() - (self.dv * left - s), v: self.dv - v, a, j: -j, dj }
        }
    }

    /// M13 up to the middle of the ramp.
    #[inline]
    fn first_half(&self, p: f64) -> Sample {
        if p > self.t1 {
            let q = p - self.t1;
            let (a, v1) = (self.a, self.v1);
            return Sample { s: self.s1 + (v1 + 0.5 * a * q) * q, v: v1 + a * q, a, ..Sample::default() };
        }
        let (h, k) = (self.half_j, self.phase_rate);
        let phase = Versine::at(k * p);
        Sample {
            s: h * phase.third / (k * k * k),
            v: h * phase.second / (k * k),
            a: h * phase.first / k,
            j: h * phase.pulse,
            dj: h * k * phase.rate,
        }
    }

    /// Sample `p` seconds after braking from `dv` begins, the run-in reversed in time (M15): uniform motion
    /// `s = dv p` before, at rest at exactly `distance` after.
    #[must_use]
    #[inline]
    pub fn braking_at(&self, p: f64) -> Sample {
        if p <= 0.0 {
            Sample::uniform(self.dv * p, self.dv)
        } else {
            self.at(self.duration - p).reversed(self.distance())
        }
    }

    /// The first moment at or after `p` without jerk, s.
    pub(crate) fn settled(&self, p: f64) -> f64 {
        match p {
            p if p < self.t1 => self.t1,
            p if p <= self.duration - self.t1 => p,
            p => p.max(self.duration),
        }
    }

    /// Largest magnitudes (M11): |dv|, A, J, DJ.
    #[must_use]
    pub fn peak(&self) -> Limits {
        let h = self.half_j.abs();
        Limits { v: self.dv.abs(), a: self.a.abs(), j: 2.0 * h, dj: h * self.phase_rate }
    }

    /// Duration T, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Share of one jerk interval in the duration, in (0, 1/2]; 1/2 for the empty ramp.
    #[must_use]
    pub fn lambda(&self) -> f64 {
        if self.duration > 0.0 { self.t1 / self.duration } else { 0.5 }
    }

    /// Length of one jerk interval t1, s.
    #[must_use]
    pub fn jerk_interval(&self) -> f64 {
        self.t1
    }

    /// Signed change of speed, mm/s.
    #[must_use]
    pub fn dv(&self) -> f64 {
        self.dv
    }

    /// Signed way of the ramp from or to rest, dv T/2 (M10), mm.
    #[must_use]
    pub fn distance(&self) -> f64 {
        0.5 * self.dv * self.duration
    }
}
