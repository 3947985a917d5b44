//! Changes of lead in the middle of a pass: threads that follow each other, and leads that grow. In: by how
//! much speed and acceleration change at a corner, mm/s and mm/s² at programmed speed; the time that the
//! change takes, s. Out: samples in mm/sⁿ, peaks, the least time.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | p | s | time at programmed speed since the window begins |
//! | T | s | duration of the window; the corner lies in its middle |
//! | q = p − T/2 | s | time since the corner |
//! | dv | mm/s | by how much the speed jumps at the corner |
//! | da | mm/s² | by how much the acceleration does: it stays until another change takes it back |
//!
//! ```text
//! p ≤ 0:      nothing
//! 0 < p < T:  dv: a ramp (M13) with λ = 1/2
//!             da: j = (2 da/T) sin²(π p/T), the rest by integration
//!             and a stroke (M2) by −da T² (1/24 − 1/(4π²)), which takes back what that runs ahead   (M215)
//! p ≥ T:      s = dv q + da q²/2, v = dv + da q, a = da: exactly what the corner would have given   (M214)
//! peaks       v: max(|dv|, |dv + da T/2|, 0) + 2 l/T,  a: |da| + 2 |dv|/T + 8 l/T²,
//!             j: 8 |dv|/T² + 2 |da|/T + 16π l/T³,
//!             dj: 16π |dv|/T³ + 2π |da|/T² + 64π² l/T⁴,   l = |da| T² (1/24 − 1/(4π²))              (M216)
//! ```

use core::f64::consts::PI;

use crate::limits::{Limits, ROUNDING};
use crate::ramp::Ramp;
use crate::sample::Sample;
use crate::stroke::Stroke;
use crate::versine::Versine;

/// What the acceleration alone runs ahead of the corner, a share of da T² (M215).
const AHEAD: f64 = 1.0 / 24.0 - 1.0 / (4.0 * PI * PI);

/// A change of speed and acceleration at a corner, rounded over a window about it.
///
/// ```
/// use motion::LeadChange;
/// let change = LeadChange::new(3.0, 2.0, 0.1);
/// assert_eq!(change.at(0.0).s, 0.0);
/// let behind = change.at(1.05); // one second behind the corner
/// assert!((behind.s - (3.0 + 0.5 * 2.0)).abs() < 1e-12 && (behind.v - 5.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeadChange {
    dv: f64,
    da: f64,
    duration: f64,
}

impl LeadChange {
    /// A change by `dv` mm/s and `da` mm/s² (signed) over `duration` seconds.
    ///
    /// # Panics
    /// If a value is not finite, or the duration not positive.
    #[must_use]
    pub fn new(dv: f64, da: f64, duration: f64) -> LeadChange {
        assert!(dv.is_finite() && da.is_finite(), "a change by {dv} mm/s and {da} mm/s²");
        assert!(duration > 0.0 && duration.is_finite(), "a change of lead takes time, not {duration} s");
        LeadChange { dv, da, duration }
    }

    /// The shortest duration in s of such a change within a, j and dj of `limits` (M216); infinite if the
    /// acceleration alone is beyond them.
    ///
    /// # Panics
    /// If a limit is not positive.
    #[must_use]
    pub fn shortest(dv: f64, da: f64, limits: &Limits) -> f64 {
        limits.check();
        let (dv, da) = (dv.abs(), da.abs());
        let left = limits.a - da * (1.0 + 8.0 * AHEAD);
        if left <= 0.0 {
            return f64::INFINITY;
        }
        // Each of two terms gets its share where both occur; roots of one term are exact.
        let part = if dv > 0.0 && da > 0.0 { 0.5 } else { 1.0 };
        let of_jump = (2.0 * dv / left)
            .max((8.0 * dv / (part * limits.j)).sqrt())
            .max(libm::cbrt(16.0 * PI * dv / (part * limits.dj)));
        let of_growth = ((2.0 + 16.0 * PI * AHEAD) * da / (part * limits.j))
            .max(((2.0 * PI + 64.0 * PI * PI * AHEAD) * da / (part * limits.dj)).sqrt());
        of_jump.max(of_growth) * ROUNDING
    }

    /// Sample `p` seconds after the window begins (M214, M215).
    #[must_use]
    #[inline]
    pub fn at(&self, p: f64) -> Sample {
        let LeadChange { dv, da, duration } = *self;
        if p <= 0.0 {
            return Sample::default();
        }
        if p >= duration {
            let q = p - 0.5 * duration;
            return Sample { s: (dv + 0.5 * da * q) * q, v: dv + da * q, a: da, ..Sample::default() };
        }
        self.within(p)
    }

    fn within(&self, p: f64) -> Sample {
        let LeadChange { dv, da, duration } = *self;
        let jump = Ramp::new(dv, duration, 0.5).at(p);
        if da == 0.0 {
            return jump;
        }
        let (h, k) = (da / duration, 2.0 * PI / duration);
        let phase = Versine::at(k * p);
        let grows = Sample {
            s: h * phase.third / (k * k * k),
            v: h * phase.second / (k * k),
            a: h * phase.first / k,
            j: h * phase.pulse,
            dj: h * k * phase.rate,
        };
        jump + grows + Stroke::new(-da * duration * duration * AHEAD, duration).at(p)
    }

    /// Largest magnitudes of what it adds up to the end of its window (M216).
    #[must_use]
    pub fn peak(&self) -> Limits {
        let LeadChange { dv, da, duration } = *self;
        let stroke = Stroke::new(da * duration * duration * AHEAD, duration).peak();
        let (v, a) = (dv.abs(), da.abs());
        let (t2, t3) = (duration * duration, duration * duration * duration);
        Limits {
            v: v.max((dv + 0.5 * da * duration).abs()) + stroke.v,
            a: a + 2.0 * v / duration + stroke.a,
            j: 8.0 * v / t2 + 2.0 * a / duration + stroke.j,
            dj: 16.0 * PI * v / t3 + 2.0 * PI * a / t2 + stroke.dj,
        }
    }

    /// By how much the speed jumps at the corner, mm/s.
    #[must_use]
    pub fn dv(&self) -> f64 {
        self.dv
    }

    /// By how much the acceleration changes, mm/s².
    #[must_use]
    pub fn da(&self) -> f64 {
        self.da
    }

    /// Duration T, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }
}
