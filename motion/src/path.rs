//! A path as a function of its length: line, arc or helix, and what motion along it asks of N axes (M55–M58).
//! In: a displacement, or radius vectors, turns and drift, mm; a law s(t) in mm/sⁿ. Out: samples of every axis, the
//! limits that s(t) has to keep, the box that holds the path, what jumps where two paths meet.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | s(t) | mm | way along the path; s′ … its derivatives by time |
//! | p(s) | mm | position of the axes from the start of the path; p₁ … p₄ its derivatives by s |
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
//! p′ = p₁ s′,  p″ = p₁ s″ + p₂ s′²,  p‴ = p₁ s‴ + 3 p₂ s′ s″ + p₃ s′³
//! p⁗ = p₁ s⁗ + p₂ (4 s′ s‴ + 3 s″²) + 6 p₃ s′² s″ + p₄ s′⁴                                       (M55)
//! p = r e(φ) − r0 u + d s,  e(φ) = u cos φ + w sin φ,  φ = s/R,  r = r0 + ρ φ,  R² = rm² + ρ² + k²
//! pₙ = (n ρ e(φ + (n−1) π/2) + r e(φ + n π/2)) / Rⁿ,  and d in p₁                                (M56)
//! in the plane |pₙ| ≤ q c^(n−1),  q² = (rm² + ρ²)/R²,  c² = (rm² + 16 ρ²)/((rm² + ρ²) R²);
//! beside it |p₁| = |d|, the others 0. A circle has q = 1, c = 1/R, and
//! p″ = s″ t + c s′² n,  p‴ = (s‴ − c² s′³) t + 3 c s′ s″ n,
//! p⁗ = (s⁗ − 6 c² s′² s″) t + (4 c s′ s‴ + 3 c s″² − c³ s′⁴) n      t along, n to the centre     (M57)
//! ```
//!
//! The limits of an arc share every bound of its plane, divided by q, out among the terms of M57, whatever their
//! directions (M58):
//!
//! | bound | terms and their shares | gives |
//! |---|---|---|
//! | V | v: 1 | v ≤ V |
//! | A | a: ½, c v²: ½ | a ≤ A/2, v² ≤ A/2c |
//! | J | j: ½, 3 c v a: ¼, c² v³: ¼ | j ≤ J/2, a ≤ J/12cv, v³ ≤ J/4c² |
//! | D | d: ½, 4 c v j, 3 c a², 6 c² v² a, c³ v⁴: ⅛ each | d ≤ D/2, j ≤ D/32cv, a² ≤ D/24c, a ≤ D/48c²v², v⁴ ≤ D/8c³ |
//!
//! Axes that drift bound v, a, j, d by their constant share alone, and so do all of a line.
//!
//! Length is that of the *metric* axes, in mm: those that are linear. A rotary axis goes along, in degrees; if no
//! metric axis moves, the length of a line is that of all, so a rotary axis alone has its way in degrees.
//!
//! Source: chain rule and Frenet's formulas of the plane.

use core::f64::consts::TAU;

use crate::limits::Limits;
use crate::sample::Sample;

/// An arc shorter than this counts as a whole turn, mm: the rounding of its ends must not decide between both.
const CLOSED_MM: f64 = 1e-6;

/// A line, an arc or a helix in the space of N axes.
///
/// ```
/// use motion::{Path, Sample};
/// // A quarter of a circle of 10 mm in the plane of the axes 0 and 1, from (10, 0) to (0, 10) as seen from its centre.
/// let arc = Path::arc([0, 1], [10.0, 0.0], [0.0, 10.0], 1, [0.0; 2], &[true; 2]).expect("it has a radius");
/// assert!((arc.length() - 5.0 * std::f64::consts::PI).abs() < 1e-12);
/// let [x, y] = arc.follow(&Sample::uniform(0.0, 2.0));
/// assert_eq!((x.v, y.v, x.a), (0.0, 2.0, -0.4)); // tangent, and v²/R towards the centre
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path<const N: usize> {
    length: f64,
    shape: Shape<N>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape<const N: usize> {
    Line { direction: [f64; N] },
    Arc(Arc<N>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Arc<const N: usize> {
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

impl<const N: usize> Path<N> {
    /// A straight line; `None` if it has no length. `displacement` in mm, of rotary axes in degrees; `metric` says
    /// which axes make the length. The share of one that is not metric may exceed 1.
    #[must_use]
    pub fn line(displacement: [f64; N], metric: &[bool; N]) -> Option<Path<N>> {
        let length = match norm(&displacement, metric) {
            0.0 => norm(&displacement, &[true; N]),
            length => length,
        };
        let direction = displacement.map(|d| d / length);
        let usable = length > 0.0 && length.is_finite() && direction.iter().all(|d| d.is_finite());
        usable.then_some(Path { length, shape: Shape::Line { direction } })
    }

    /// An arc in the plane of two axes, from `start` to `end`, both seen from the centre, mm. It turns from the first
    /// axis of the plane towards the second if `turns` is positive, the other way if negative; ±1 is at most one whole
    /// turn, each one more a whole turn more. Start and end at one place make a whole turn.
    ///
    /// If the radii differ, the radius changes evenly with the angle. So do the axes outside of the plane: `drift` is
    /// their way over the whole arc, in mm or degrees, 0 inside the plane. Those that are `metric` make a helix of the
    /// arc and count in its length.
    ///
    /// `None` if an end lies at the centre, something is not finite, `turns` is 0, `plane` names no two axes, or one of
    /// them drifts.
    #[must_use]
    pub fn arc(
        plane: [usize; 2],
        start: [f64; 2],
        end: [f64; 2],
        turns: i32,
        drift: [f64; N],
        metric: &[bool; N],
    ) -> Option<Path<N>> {
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
        let arc = Arc { u, w, r0, r1, rho, drift: drift.map(|way| way / length), per_radian };
        Some(Path { length, shape: Shape::Arc(arc) })
    }

    /// Length, mm: the largest s.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// p and p₁ … p₄ at `s` (M56): position from the start and its derivatives by s, mm … 1/mm³.
    #[must_use]
    pub fn at(&self, s: f64) -> [[f64; N]; 5] {
        match &self.shape {
            Shape::Line { direction } => {
                [direction.map(|share| share * s), *direction, [0.0; N], [0.0; N], [0.0; N]]
            }
            Shape::Arc(arc) => arc.at(s),
        }
    }

    /// The motion of every axis, from the start of the path, when `along` is that of s (M55).
    #[must_use]
    pub fn follow(&self, along: &Sample) -> [Sample; N] {
        if let Shape::Line { direction } = &self.shape {
            return direction.map(|share| *along * share);
        }
        along.along(&self.at(along.s))
    }

    /// Limits of s within which no axis exceeds its own (M57, M58). An axis that does not move bounds nothing.
    #[must_use]
    pub fn limits(&self, axes: &[Limits; N]) -> Limits {
        match &self.shape {
            Shape::Line { direction } => tightest(axes, |i| direction[i].abs()),
            Shape::Arc(arc) => {
                let beside = tightest(axes, |i| arc.drift[i].abs());
                let mut plane = tightest(axes, |i| arc.share(i));
                plane.v = plane.v.min(beside.v);
                shared_out(&plane, arc.bend()).min(&beside)
            }
        }
    }

    /// Largest |p₁| of every axis: its share in the way, in mm or degrees by mm.
    #[must_use]
    pub fn shares(&self) -> [f64; N] {
        match &self.shape {
            Shape::Line { direction } => direction.map(f64::abs),
            Shape::Arc(arc) => core::array::from_fn(|i| arc.share(i) + arc.drift[i].abs()),
        }
    }

    /// Bounds of |p₂|, |p₃|, |p₄| of every axis over the whole path, 1/mm … 1/mm³ (M56); 0 for a line.
    #[must_use]
    pub fn bend(&self) -> [[f64; N]; 3] {
        match &self.shape {
            Shape::Line { .. } => [[0.0; N]; 3],
            Shape::Arc(arc) => [2, 3, 4].map(|n| core::array::from_fn(|i| arc.most(n) * arc.inside(i))),
        }
    }

    /// Whether it is a straight line.
    #[must_use]
    pub fn is_line(&self) -> bool {
        matches!(self.shape, Shape::Line { .. })
    }

    /// By how much p₁, p₂, p₃ jump where `next` begins at the end of this path, mm⁰ … 1/mm².
    #[must_use]
    pub fn jumps(&self, next: &Path<N>) -> [[f64; N]; 3] {
        let less = |next: [f64; N], own: [f64; N]| core::array::from_fn(|i| next[i] - own[i]);
        if let (Shape::Line { direction: own }, Shape::Line { direction: next }) = (&self.shape, &next.shape)
        {
            return [less(*next, *own), [0.0; N], [0.0; N]];
        }
        let ([_, p1, p2, p3, _], [_, q1, q2, q3, _]) = (self.at(self.length), next.at(0.0));
        [less(q1, p1), less(q2, p2), less(q3, p3)]
    }

    /// The box that holds the path, from its start, mm: lowest and highest of every axis, points between the ends at
    /// which an axis turns back included.
    #[must_use]
    pub fn bounds(&self) -> [[f64; N]; 2] {
        let [end, ..] = self.at(self.length);
        let (mut low, mut high) = (end.map(|p| p.min(0.0)), end.map(|p| p.max(0.0)));
        if let Shape::Arc(arc) = &self.shape {
            for i in 0..N {
                let top = libm::atan2(arc.w[i], arc.u[i]);
                let reach = arc.inside(i) * arc.flat();
                if arc.passes(top, self.length) {
                    high[i] = high[i].max(reach - arc.r0 * arc.u[i]);
                }
                if arc.passes(top + TAU / 2.0, self.length) {
                    low[i] = low[i].min(-reach - arc.r0 * arc.u[i]);
                }
            }
        }
        [low, high]
    }
}

impl<const N: usize> Arc<N> {
    fn at(&self, s: f64) -> [[f64; N]; 5] {
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
    fn bend(&self) -> f64 {
        libm::hypot(self.r0.max(self.r1), 4.0 * self.rho) / (self.flat() * self.per_radian)
    }

    /// Whether an angle, but for whole turns, lies on an arc of this length. Where the radius changes an axis turns
    /// back a little beside its quadrant, at most ρ/r away.
    fn passes(&self, angle: f64, length: f64) -> bool {
        let aside = (self.rho / self.r0.min(self.r1)).abs();
        let angle = if angle < 0.0 { angle + TAU } else { angle };
        angle <= length / self.per_radian + aside || angle >= TAU - aside
    }
}

/// Euclidean length of the metric parts.
fn norm<const N: usize>(way: &[f64; N], metric: &[bool; N]) -> f64 {
    way.iter().zip(metric).filter(|(_, metric)| **metric).map(|(d, _)| d * d).sum::<f64>().sqrt()
}

/// Angle from `start` to `end` about the centre in the sense of ±1, rad, over 0 up to a whole turn; ends that lie at
/// one place at this radius, mm, make a whole turn.
fn swept(start: [f64; 2], end: [f64; 2], sense: f64, radius: f64) -> f64 {
    let cross = sense * (start[0] * end[1] - start[1] * end[0]);
    let within = libm::atan2(cross, start[0] * end[0] + start[1] * end[1]);
    let within = if within < 0.0 { within + TAU } else { within };
    if within * radius < CLOSED_MM { within + TAU } else { within }
}

/// What the axes leave for the way if each has a constant share in it.
fn tightest<const N: usize>(axes: &[Limits; N], share: impl Fn(usize) -> f64) -> Limits {
    let mut tightest = Limits::NONE;
    for (i, Limits { v, a, j, dj }) in axes.iter().enumerate() {
        let share = share(i);
        if share > 0.0 {
            let axis = Limits { v: v / share, a: a / share, j: j / share, dj: dj / share };
            tightest = tightest.min(&axis);
        }
    }
    tightest
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
