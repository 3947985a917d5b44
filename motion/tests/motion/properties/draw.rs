//! Random limits and lengths, and what every law must satisfy along its way. Units mm, s.

use motion::{Limits, Sample};
use proptest::prelude::*;

/// A magnitude between `low` and `high`, even on the logarithmic scale: every decade is as likely as the
/// next.
pub(crate) fn magnitude(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (libm::log(low)..libm::log(high)).prop_map(libm::exp)
}

/// Limits over several decades, so that each of them binds in some cases.
pub(crate) fn limits() -> impl Strategy<Value = Limits> {
    (magnitude(1.0, 1e3), magnitude(10.0, 2e4), magnitude(1e2, 1e6), magnitude(1e4, 1e9))
        .prop_map(|(v, a, j, dj)| Limits { v, a, j, dj })
}

/// A signed magnitude.
pub(crate) fn signed(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (magnitude(low, high), any::<bool>()).prop_map(|(x, back)| if back { -x } else { x })
}

/// Whether `peak` keeps `limits` up to rounding.
pub(crate) fn keeps(peak: &Limits, limits: &Limits) -> bool {
    let rounding = 1.0 + 1e-12;
    peak.v <= limits.v * rounding
        && peak.a <= limits.a * rounding
        && peak.j <= limits.j * rounding
        && peak.dj <= limits.dj * rounding
}

/// Magnitudes of one sample.
pub(crate) fn magnitudes(x: Sample) -> Limits {
    Limits { v: x.v.abs(), a: x.a.abs(), j: x.j.abs(), dj: x.dj.abs() }
}

/// `points + 1` times from 0 to `duration`, both included.
pub(crate) fn times(duration: f64, points: u32) -> impl Iterator<Item = f64> {
    (0..=points).map(move |i| duration * f64::from(i) / f64::from(points))
}

/// Every derivative is the derivative of the one above it: between neighbouring times each of s, v, a, j
/// changes by no more than its rate allows (`peak`), which also forbids jumps at the joints; and s, v, a
/// follow the trapezium of their rates to second order, which ties the values to each other.
pub(crate) fn smooth(duration: f64, peak: &Limits, law: impl Fn(f64) -> Sample) -> Result<(), TestCaseError> {
    const POINTS: u32 = 400;
    let step = duration / f64::from(POINTS);
    let before_and_after = -0.1 * duration;
    let mut before = law(before_and_after);
    let mut at = before_and_after;
    for p in times(1.2 * duration, POINTS * 6 / 5).map(|p| p + before_and_after) {
        let now = law(p);
        let dp = p - at;
        let pairs = [
            (now.s, before.s, 0.5 * (now.v + before.v), peak.v, peak.j),
            (now.v, before.v, 0.5 * (now.a + before.a), peak.a, peak.dj),
        ];
        for (value, was, rate, bound, curvature) in pairs {
            let change = value - was;
            let rounding = 1e-9 * bound * step + 8.0 * f64::EPSILON * value.abs().max(was.abs());
            prop_assert!(change.abs() <= bound * dp + rounding, "jump of {change} at {p}");
            let error = (change - rate * dp).abs();
            prop_assert!(error <= curvature * dp * dp * dp / 6.0 + rounding, "{error} at {p}");
        }
        prop_assert!((now.a - before.a).abs() <= peak.j * dp + 1e-9 * peak.a, "acceleration jumps at {p}");
        prop_assert!((now.j - before.j).abs() <= peak.dj * dp + 1e-9 * peak.j, "jerk jumps at {p}");
        (before, at) = (now, p);
    }
    Ok(())
}
