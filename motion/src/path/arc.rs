//! An arc or a helix: a radius that turns about its centre, and drift beside its plane (M56–M58). In: radius
//! vectors at both ends, turns and drift, mm. Out: position and derivatives by the way s, bounds of them, the
//! limits that s(t) has to keep.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | u, w | – | unit vectors at the start of an arc: from the centre outwards, and the way it turns |
//! | φ, Φ | rad | angle gone, and all of it |
//! | r, r0, rm | mm | radius at φ, at the start, the larger of both ends |
//! | ρ | mm/rad | dr/dφ, even; 0 for a circle. Ends that were rounded have not quite one radius |
//! | d, k | 1, mm/rad | way of the axes outside the plane by s, even; of those that make the length, by φ |
//! | R | mm | s per radian; the radius of a circle |
//! | q | – | share of the plane in the way; 1 without drift |
//! | V, A, J, D | mm/sⁿ | limits of the axes, each divided by the largest share the axis has in the direction |
//! | v, a, j, d | mm/sⁿ | limits of s′, s″, s‴, s⁗ |
//!
//! ```text
//! p = r e(φ) − r0 u + d s,  e(φ) = u cos φ + w sin φ,  φ = s/R,  r = r0 + ρ φ,  R² = rm² + ρ² + k²
//! pₙ = (n ρ e(φ + (n−1) π/2) + r e(φ + n π/2)) / Rⁿ,  and d in p₁                                (M56)
//! in the plane |pₙ| ≤ q c^(n−1),  q² = (rm² + ρ²)/R²,  c² = (rm² + 16 ρ²)/((rm² + ρ²) R²);
//! beside it |p₁| = |d|, the others 0. A circle has q = 1, c = 1/R, and
//! p″ = s″ t + c s′² n,  p‴ = (s‴ − c² s′³) t + 3 c s′ s″ n,
//! p⁗ = (s⁗ − 6 c² s′² s″) t + (4 c s′ s‴ + 3 c s″² − c³ s′⁴) n      t along, n to the centre     (M57)
//! ```
//!
//! The limits of an arc share every bound of its plane, divided by q, out among the terms of M57, whatever
//! their directions (M58):
//!
//! | bound | terms and their shares | gives |
//! |---|---|---|
//! | V | v: 1 | v ≤ V |
//! | A | a: ½, c v²: ½ | a ≤ A/2, v² ≤ A/2c |
//! | J | j: ½, 3 c v a: ¼, c² v³: ¼ | j ≤ J/2, a ≤ J/12cv, v³ ≤ J/4c² |
//! | D | d: ½, 4 c v j, 3 c a², 6 c² v² a, c³ v⁴: ⅛ each | d ≤ D/2, j ≤ D/32cv, a² ≤ D/24c, a ≤ D/48c²v², v⁴ ≤ D/8c³ |
//!
//! Axes that drift bound v, a, j, d by their constant share alone.
//!
//! Source: chain rule and Frenet's formulas of the plane.

use core::f64::consts::TAU;

use super::{norm, tightest};
use crate::limits::Limits;

/// An arc shorter than this counts as a whole turn, mm: the rounding of its ends must not decide between
/// both.
const CLOSED_MM: f64 = 1e-6;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc<const N: usize> {
    u: [f64; N],
    w: [f64; N],
    r0: f64,
    r1: f64,
    rho: f64,
    /// d.
    drift: [f64; N],
    /// R.
    per_radian: f64,
}

impl<const N: usize> Arc<N> {
    /// As `Path::arc`: the arc and its length.
    pub(super) fn new(
        plane: [usize; 2],
        start: [f64; 2],
        end: [f64; 2],
        turns: i32,
        drift: [f64; N],
        metric: &[bool; N],
    ) -> Option<(Arc<N>, f64)> {
        let [first, second] = plane;
        let (r0, r1) = (libm::hypot(start[0], start[1]), libm::hypot(end[0], end[1]));
        let usable = |r: f64| r > 0.0 && r.is_finite();
        if !usable(r0) || !usable(r1) || turns == 0 || first == second || first.max(second) >= N {
            return None;
        }
        if drift[first] != 0.0 || drift[second] != 0.0 || !drift.iter().all(|d| d.is_finite()) {
            return None;
        }
        let sense = f64::from(turns.signum());
        let sweep = swept(start, end, sense, r0.max(r1)) + TAU * f64::from(turns.unsigned_abs() - 1);

        let (mut u, mut w) = ([0.0; N], [0.0; N]);
        (u[first], u[second]) = (start[0] / r0, start[1] / r0);
        (w[first], w[second]) = (-sense * u[second], sense * u[first]);
        let rho = (r1 - r0) / sweep;
        let flat = libm::hypot(r0.max(r1), rho);
        let per_radian = libm::hypot(flat, norm(&drift, metric) / sweep);
        let length = sweep * per_radian;
        Some((Arc { u, w, r0, r1, rho, drift: drift.map(|way| way / length), per_radian }, length))
    }

    /// M58.
    pub(super) fn limits(&self, axes: &[Limits; N]) -> Limits {
        let beside = tightest(axes, |i| self.drift[i].abs());
        let mut plane = tightest(axes, |i| self.share(i));
        plane.v = plane.v.min(beside.v);
        shared_out(&plane, self.sharpness()).min(&beside)
    }

    /// As `Path::shares`.
    pub(super) fn shares(&self) -> [f64; N] {
        core::array::from_fn(|i| self.share(i) + self.drift[i].abs())
    }

    /// As `Path::bend`.
    pub(super) fn bend(&self) -> [[f64; N]; 3] {
        [2, 3, 4].map(|n| core::array::from_fn(|i| self.most(n) * self.inside(i)))
    }

    /// Widens a box around both ends by the points at which an axis turns back.
    pub(super) fn widen(&self, length: f64, [low, high]: &mut [[f64; N]; 2]) {
        for i in 0..N {
            let top = libm::atan2(self.w[i], self.u[i]);
            let reach = self.inside(i) * self.flat();
            if self.passes(top, length) {
                high[i] = high[i].max(reach - self.r0 * self.u[i]);
            }
            if self.passes(top + TAU / 2.0, length) {
                low[i] = low[i].min(-reach - self.r0 * self.u[i]);
            }
        }
    }

    /// As `Path::at`.
    pub(super) fn at(&self, s: f64) -> [[f64; N]; 5] {
        let phi = s / self.per_radian;
        // 1 − cos φ by the half angle: what is near the start is not lost in the size of the radius.
        let (sin_half, cos_half) = libm::sincos(0.5 * phi);
        let (versine, sin) = (2.0 * sin_half * sin_half, 2.0 * sin_half * cos_half);
        let cos = 1.0 - versine;
        let outwards: [f64; N] = core::array::from_fn(|i| cos * self.u[i] + sin * self.w[i]);
        let onwards: [f64; N] = core::array::from_fn(|i| cos * self.w[i] - sin * self.u[i]);
        let (rho, r) = (self.rho, self.r0 + self.rho * phi);
        let derivative = |out: f64, on: f64, n: i32| {
            let scale = (0..n).fold(1.0, |scale, _| scale / self.per_radian);
            core::array::from_fn(|i| (out * outwards[i] + on * onwards[i]) * scale)
        };
        let first: [f64; N] = derivative(rho, r, 1);
        [
            core::array::from_fn(|i| {
                self.r0 * (sin * self.w[i] - versine * self.u[i])
                    + rho * phi * outwards[i]
                    + self.drift[i] * s
            }),
            core::array::from_fn(|i| first[i] + self.drift[i]),
            derivative(-r, 2.0 * rho, 2),
            derivative(-3.0 * rho, -r, 3),
            derivative(r, -4.0 * rho, 4),
        ]
    }

    /// Largest share of an axis in a direction of the plane.
    fn inside(&self, i: usize) -> f64 {
        libm::hypot(self.u[i], self.w[i])
    }

    /// Way in the plane by radian at the larger radius, mm.
    fn flat(&self) -> f64 {
        libm::hypot(self.r0.max(self.r1), self.rho)
    }

    /// Largest |pₙ| in the plane.
    fn most(&self, n: i32) -> f64 {
        let wide = libm::hypot(self.r0.max(self.r1), f64::from(n) * self.rho);
        (0..n).fold(wide, |most, _| most / self.per_radian)
    }

    /// Largest |p₁| of an axis by what goes on in the plane: q, or the part of it the axis has.
    fn share(&self, i: usize) -> f64 {
        self.inside(i) * (self.flat() / self.per_radian)
    }

    /// c of M57, 1/mm.
    fn sharpness(&self) -> f64 {
        libm::hypot(self.r0.max(self.r1), 4.0 * self.rho) / (self.flat() * self.per_radian)
    }

    /// Whether an angle, but for whole turns, lies on an arc of this length. Where the radius changes an axis
    /// turns back a little beside its quadrant, at most ρ/r away.
    fn passes(&self, angle: f64, length: f64) -> bool {
        let aside = (self.rho / self.r0.min(self.r1)).abs();
        let angle = if angle < 0.0 { angle + TAU } else { angle };
        angle <= length / self.per_radian + aside || angle >= TAU - aside
    }
}

/// Angle from `start` to `end` about the centre in the sense of ±1, rad, over 0 up to a whole turn; ends that
/// lie at one place at this radius, mm, make a whole turn.
fn swept(start: [f64; 2], end: [f64; 2], sense: f64, radius: f64) -> f64 {
    let cross = sense * (start[0] * end[1] - start[1] * end[0]);
    let within = libm::atan2(cross, start[0] * end[0] + start[1] * end[1]);
    let within = if within < 0.0 { within + TAU } else { within };
    if within * radius < CLOSED_MM { within + TAU } else { within }
}

/// The shares of M58.
fn shared_out(axes: &Limits, c: f64) -> Limits {
    let quartic_root = |x: f64| x.sqrt().sqrt();
    let v = axes
        .v
        .min((axes.a / (2.0 * c)).sqrt())
        .min(libm::cbrt(axes.j / (4.0 * c * c)))
        .min(quartic_root(axes.dj / (8.0 * c * c * c)));
    let turning = c * v;
    let a = (axes.a / 2.0)
        .min(axes.j / (12.0 * turning))
        .min((axes.dj / (24.0 * c)).sqrt())
        .min(axes.dj / (48.0 * turning * turning));
    let j = (axes.j / 2.0).min(axes.dj / (32.0 * turning));
    Limits { v, a, j, dj: axes.dj / 2.0 }
}
