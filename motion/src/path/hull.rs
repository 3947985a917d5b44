//! A polynomial on 0 … 1 by its control points, and bounds of it: the hull of its control points holds it
//! (M85).
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | u | – | 0 at the start, 1 at the end |
//! | b₀ … b_m | mm | control points of a polynomial of degree m: its coefficients in C(m, k) uᵏ (1 − u)^(m−k) |
//!
//! ```text
//! derivative by u: m (b₁ − b₀) … m (b_m − b_(m−1))
//! min b ≤ p(u) ≤ max b;  b₀ and b_m are reached                                                  (M85)
//! ```
//! Halving a polynomial (de Casteljau) brings the hull nearer by a factor of four.
//!
//! Source: Bernstein's form of polynomials.

/// Degree of a piece.
pub(super) const DEGREE: usize = 7;

/// A bound of a magnitude that is higher than a value which is reached by less than this, relative, is good
/// enough.
const TIGHT: f64 = 1e-3;
/// Halvings of a polynomial for the sake of such a bound: the hull of a part is nearer by a factor of a
/// thousand then.
const HALVINGS: u32 = 5;

/// Control points; those beyond the degree are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hull {
    points: [f64; DEGREE + 1],
    degree: usize,
}

impl Hull {
    /// A polynomial of degree 7.
    pub(super) fn new(points: [f64; DEGREE + 1]) -> Hull {
        Hull { points, degree: DEGREE }
    }

    /// Its derivative by u.
    pub(super) fn derivative(&self) -> Hull {
        let degree = self.degree.saturating_sub(1);
        let mut points = [0.0; DEGREE + 1];
        for (point, pair) in points.iter_mut().zip(self.used().windows(2)) {
            *point = self.degree as f64 * (pair[1] - pair[0]);
        }
        Hull { points, degree }
    }

    /// A bound of the magnitude.
    pub(super) fn most(&self) -> f64 {
        self.most_or(0.0, HALVINGS)
    }

    /// Bounds of the value: reached within `tolerance`, unless it turns back more often than it can be
    /// halved.
    pub(super) fn range(&self, tolerance: f64, halvings: u32) -> [f64; 2] {
        self.range_or([f64::INFINITY, f64::NEG_INFINITY], tolerance, halvings)
    }

    /// The wider of such bounds and those of the parts before: what lies within these is not looked at.
    fn range_or(&self, before: [f64; 2], tolerance: f64, halvings: u32) -> [f64; 2] {
        let ([low, high], [least, most]) = (self.ends(), self.hull());
        if before[0] <= least && most <= before[1] {
            return before;
        }
        if halvings == 0 || low - least <= tolerance && most - high <= tolerance {
            return [least.min(before[0]), most.max(before[1])];
        }
        self.halves().iter().fold(before, |before, half| half.range_or(before, tolerance, halvings - 1))
    }

    /// The larger of such a bound and that of the parts before.
    fn most_or(&self, before: f64, halvings: u32) -> f64 {
        let magnitude = |[low, high]: [f64; 2]| high.max(-low);
        let bound = magnitude(self.hull());
        if bound <= before {
            return before;
        }
        if halvings == 0 || bound <= magnitude(self.ends()) * (1.0 + TIGHT) {
            return bound;
        }
        let mut halves = self.halves();
        // The half with the larger bound first: most of the time it covers the other one.
        if magnitude(halves[0].hull()) < magnitude(halves[1].hull()) {
            halves.reverse();
        }
        halves.iter().fold(before, |before, half| half.most_or(before, halvings - 1))
    }

    fn used(&self) -> &[f64] {
        &self.points[..=self.degree]
    }

    /// Lower and higher end.
    fn ends(&self) -> [f64; 2] {
        let (first, last) = (self.points[0], self.points[self.degree]);
        [first.min(last), first.max(last)]
    }

    /// Lowest and highest control point.
    fn hull(&self) -> [f64; 2] {
        self.used().iter().fold(self.ends(), |[low, high], point| [low.min(*point), high.max(*point)])
    }

    /// Over 0 … ½ and ½ … 1 (de Casteljau).
    fn halves(&self) -> [Hull; 2] {
        let (mut first, mut second) = (*self, *self);
        for level in 1..=self.degree {
            for k in 0..=self.degree - level {
                second.points[k] = 0.5 * (second.points[k] + second.points[k + 1]);
            }
            first.points[level] = second.points[0];
        }
        [first, second]
    }
}

#[cfg(test)]
mod tests {
    use super::Hull;

    /// By its control points.
    fn at(points: [f64; 8], u: f64) -> f64 {
        let binomials = [1.0, 7.0, 21.0, 35.0, 35.0, 21.0, 7.0, 1.0];
        let term = |k: usize| binomials[k] * points[k] * u.powi(k as i32) * (1.0 - u).powi(7 - k as i32);
        (0..8).map(term).sum()
    }

    const POINTS: [f64; 8] = [0.0, 1.0, -2.0, 4.0, 3.0, -5.0, 0.5, 2.0];

    #[test]
    fn m85_halves_are_the_polynomial() {
        for (half, from) in Hull::new(POINTS).halves().into_iter().zip([0.0, 0.5]) {
            for k in 0..=10 {
                let u = f64::from(k) / 10.0;
                assert!((at(half.points, u) - at(POINTS, from + 0.5 * u)).abs() < 1e-14, "{u} from {from}");
            }
        }
    }

    #[test]
    fn m85_bounds_hold_and_are_nearly_reached() {
        let values: Vec<f64> = (0..=10_000).map(|k| at(POINTS, f64::from(k) / 1e4)).collect();
        let (low, high) = values.iter().fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(*v), h.max(*v)));
        let [least, most] = Hull::new(POINTS).range(1e-9, 20);
        assert!(least <= low && low - least < 1e-7 && most >= high && most - high < 1e-7);
        let bound = Hull::new(POINTS).most();
        assert!(bound >= high.max(-low) && bound < 1.01 * high.max(-low), "{bound}, {low}, {high}");
        let (h, slope) = (1e-6, Hull::new(POINTS).derivative());
        let steepest =
            (0..10_000).map(|k| f64::from(k) / 1e4).map(|u| (at(POINTS, u + h) - at(POINTS, u)) / h);
        let steepest = steepest.fold(0.0_f64, |most, slope| most.max(slope.abs()));
        assert!((slope.most() / steepest - 1.0).abs() < 0.01, "{}, {steepest}", slope.most());
    }
}
