//! Bounds of a motion. In: magnitudes in mm/sⁿ. Out: the bounds at another speed ratio, and the highest ratio
//! allowed.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | v, a, j, dj | mm/s … mm/s⁴ | magnitudes of speed, acceleration, jerk, jerk rate |
//! | r | – | actual spindle speed over programmed speed |

/// Durations found from limits are longer by this factor, so that rounding cannot lift a peak above its
/// limit.
pub(crate) const ROUNDING: f64 = 1.0 + 8.0 * f64::EPSILON;

/// Magnitudes of the derivatives of a motion: what an axis allows (all > 0, infinity for "no bound"), or the
/// peaks of a law (all ≥ 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Speed, mm/s.
    pub v: f64,
    /// Acceleration, mm/s².
    pub a: f64,
    /// Jerk, mm/s³.
    pub j: f64,
    /// Jerk rate, mm/s⁴.
    pub dj: f64,
}

impl Limits {
    /// No bound.
    pub const NONE: Limits =
        Limits { v: f64::INFINITY, a: f64::INFINITY, j: f64::INFINITY, dj: f64::INFINITY };

    /// The tighter of both bounds of each derivative.
    #[must_use]
    pub fn min(&self, other: &Limits) -> Limits {
        Limits {
            v: self.v.min(other.v),
            a: self.a.min(other.a),
            j: self.j.min(other.j),
            dj: self.dj.min(other.dj),
        }
    }

    /// A share of every bound.
    #[must_use]
    pub fn share(self, share: f64) -> Limits {
        Limits { v: self.v * share, a: self.a * share, j: self.j * share, dj: self.dj * share }
    }

    /// Peaks of the same law when its master runs at ratio `r`: v r, a r², j r³, dj r⁴ (M7).
    #[must_use]
    pub fn scaled(self, r: f64) -> Limits {
        let r2 = r * r;
        Limits { v: self.v * r, a: self.a * r2, j: self.j * r2 * r, dj: self.dj * r2 * r2 }
    }

    /// The greatest ratio r at which `peak` scaled by r stays within these limits (M7); infinite if `peak` is
    /// zero. For a thread take the smallest over its axes and refuse an override above it.
    ///
    /// ```
    /// use motion::{Limits, Stroke};
    /// let axis = Limits { v: 200.0, a: 4000.0, j: 4.0e5, dj: 1.0e8 };
    /// let stroke = Stroke::new(5.0, 0.2); // peaks: 50 mm/s, 1000 mm/s²
    /// assert!((axis.top_ratio(&stroke.peak()) - 2.0).abs() < 1e-12); // acceleration: sqrt(4000/1000)
    /// ```
    #[must_use]
    pub fn top_ratio(&self, peak: &Limits) -> f64 {
        let bound = |limit: f64, peak: f64, root: fn(f64) -> f64| {
            if peak > 0.0 { root(limit / peak) } else { f64::INFINITY }
        };
        bound(self.v, peak.v, |q| q)
            .min(bound(self.a, peak.a, f64::sqrt))
            .min(bound(self.j, peak.j, libm::cbrt))
            .min(bound(self.dj, peak.dj, |q| q.sqrt().sqrt()))
    }

    /// Panics unless every limit is positive; infinity is allowed.
    pub(crate) fn check(&self) {
        assert!(self.all_positive(), "limits must be positive: {self:?}");
    }

    /// Whether every limit is positive (infinity is allowed, NaN is not).
    pub(crate) fn all_positive(&self) -> bool {
        self.v > 0.0 && self.a > 0.0 && self.j > 0.0 && self.dj > 0.0
    }
}
