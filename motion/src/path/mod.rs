//! A path as a function of its length: line, arc, helix or a piece of a curve, and what motion along it asks
//! of N axes (M55). In: a displacement, radius vectors, or derivatives at both ends, mm; a law s(t) in mm/sⁿ.
//! Out: samples of every axis, the limits that s(t) has to keep, the box that holds the path, what jumps
//! where two paths meet.
//!
//! | part | holds |
//! |---|---|
//! | `path/arc.rs` | arcs and helices (M56–M58) |
//! | `path/piece.rs` | pieces of curves (M84) |
//! | `path/hull.rs` | bounds of polynomials (M85) |
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | s(t) | mm | way along the path; s′ … its derivatives by time |
//! | p(s) | mm | position of the axes from the start of the path; p₁ … p₄ its derivatives by s |
//!
//! ```text
//! p′ = p₁ s′,  p″ = p₁ s″ + p₂ s′²,  p‴ = p₁ s‴ + 3 p₂ s′ s″ + p₃ s′³
//! p⁗ = p₁ s⁗ + p₂ (4 s′ s‴ + 3 s″²) + 6 p₃ s′² s″ + p₄ s′⁴                                       (M55)
//! ```
//! Along a line axes bound v, a, j, d by their constant share alone.
//!
//! Length is that of the *metric* axes, in mm: those that are linear. A rotary axis goes along, in degrees;
//! if no metric axis moves, the length of a line is that of all, so a rotary axis alone has its way in
//! degrees. What makes the length of a piece says whoever makes it.
//!
//! Source: chain rule.

mod arc;
mod hull;
mod piece;

use crate::chain::Bend;
use crate::limits::Limits;
use crate::sample::Sample;
use arc::Arc;
use piece::Piece;

/// Faster than anything goes, mm/s; its fourth power is finite.
const FASTEST: f64 = 1e12;

/// A line, an arc, a helix or a piece of a curve in the space of N axes.
///
/// ```
/// use motion::{Path, Sample};
/// // A quarter of a circle of 10 mm in the plane of the axes 0 and 1, from (10, 0) to (0, 10), seen from its
/// // centre.
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

/// Ways of metric axes below this, mm and as a share of the whole, are rounding beside a turn.
const BESIDE: f64 = 1e-4;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape<const N: usize> {
    Line { direction: [f64; N] },
    Arc(Arc<N>),
    Piece(Piece<N>),
}

impl<const N: usize> Path<N> {
    /// A straight line; `None` if it has no length. `displacement` in mm, of rotary axes in degrees; `metric`
    /// says which axes make the length, unless all they do is to go where they already are but for the
    /// rounding of an encoder: a turn by degrees would have no length then. The share of one that is not
    /// metric may exceed 1.
    #[must_use]
    pub fn line(displacement: [f64; N], metric: &[bool; N]) -> Option<Path<N>> {
        let (length, all) = (norm(&displacement, metric), norm(&displacement, &[true; N]));
        let length = if length < BESIDE.min(BESIDE * all) { all } else { length };
        let direction = displacement.map(|d| d / length);
        let usable = length > 0.0 && length.is_finite() && direction.iter().all(|d| d.is_finite());
        usable.then_some(Path { length, shape: Shape::Line { direction } })
    }

    /// An arc in the plane of two axes, from `start` to `end`, both seen from the centre, mm. It turns from
    /// the first axis of the plane towards the second if `turns` is positive, the other way if negative; ±1
    /// is at most one whole turn, each one more a whole turn more. Start and end at one place make a whole
    /// turn.
    ///
    /// If the radii differ, the radius changes evenly with the angle. So do the axes outside of the plane:
    /// `drift` is their way over the whole arc, in mm or degrees, 0 inside the plane. Those that are `metric`
    /// make a helix of the arc and count in its length.
    ///
    /// `None` if an end lies at the centre, something is not finite, `turns` is 0, `plane` names no two axes,
    /// or one of them drifts.
    #[must_use]
    pub fn arc(
        plane: [usize; 2],
        start: [f64; 2],
        end: [f64; 2],
        turns: i32,
        drift: [f64; N],
        metric: &[bool; N],
    ) -> Option<Path<N>> {
        let (arc, length) = Arc::new(plane, start, end, turns, drift, metric)?;
        Some(Path { length, shape: Shape::Arc(arc) })
    }

    /// A piece of a curve of `length` mm from `start` to `end`: position of every axis and its derivatives 1
    /// … 3 by s there, mm (degrees) … 1/mm², of one that stands still 0. In between it is a polynomial of
    /// degree 7 (M84). Pieces of one curve join without a jump of these derivatives.
    ///
    /// `None` if something is not finite, or there is no length.
    ///
    /// ```
    /// use motion::Path;
    /// // Half a radian of a circle of 1 mm about (0, 0): its end and its middle are those of the circle.
    /// let at = |phi: f64| {
    ///     let (s, c) = libm::sincos(phi);
    ///     [[c, s], [-s, c], [-c, -s], [s, -c]]
    /// };
    /// let piece = Path::piece(&at(0.0), &at(0.5), 0.5).expect("it has a length");
    /// let [[x, y], ..] = piece.at(0.25);
    /// assert!((x + 1.0 - libm::cos(0.25)).abs() < 1e-9 && (y - libm::sin(0.25)).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn piece(start: &[[f64; N]; 4], end: &[[f64; N]; 4], length: f64) -> Option<Path<N>> {
        let piece = Piece::new(start, end, length)?;
        Some(Path { length, shape: Shape::Piece(piece) })
    }

    /// Length, mm: the largest s.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// p and p₁ … p₄ at `s` (M56, M84): position from the start and its derivatives by s, mm … 1/mm³.
    #[must_use]
    pub fn at(&self, s: f64) -> [[f64; N]; 5] {
        match &self.shape {
            Shape::Line { direction } => {
                [direction.map(|share| share * s), *direction, [0.0; N], [0.0; N], [0.0; N]]
            }
            Shape::Arc(arc) => arc.at(s),
            Shape::Piece(piece) => piece.at(s, self.length),
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

    /// Limits of s within which no axis exceeds its own (M57, M58; of a piece M66). An axis that does not
    /// move bounds nothing.
    #[must_use]
    pub fn limits(&self, axes: &[Limits; N]) -> Limits {
        match &self.shape {
            Shape::Line { direction } => tightest(axes, |i| direction[i].abs()),
            Shape::Arc(arc) => arc.limits(axes),
            Shape::Piece(_) => Bend::of(self).limits(axes, FASTEST, f64::INFINITY),
        }
    }

    /// Bounds of |p₁| of every axis: its share in the way, in mm or degrees by mm. Those of lines and circles
    /// are reached.
    #[must_use]
    pub fn shares(&self) -> [f64; N] {
        match &self.shape {
            Shape::Line { direction } => direction.map(f64::abs),
            Shape::Arc(arc) => arc.shares(),
            Shape::Piece(piece) => piece.most(self.length)[0],
        }
    }

    /// Bounds of |p₂|, |p₃|, |p₄| of every axis over the whole path, 1/mm … 1/mm³ (M56, M85); 0 for a line.
    #[must_use]
    pub fn bend(&self) -> [[f64; N]; 3] {
        match &self.shape {
            Shape::Line { .. } => [[0.0; N]; 3],
            Shape::Arc(arc) => arc.bend(),
            Shape::Piece(piece) => {
                let [_, bend @ ..] = piece.most(self.length);
                bend
            }
        }
    }

    /// Bounds of |p₁| … |p₄|: [`Path::shares`] and [`Path::bend`] at once.
    pub(crate) fn most(&self) -> [[f64; N]; 4] {
        if let Shape::Piece(piece) = &self.shape {
            return piece.most(self.length);
        }
        let [second, third, fourth] = self.bend();
        [self.shares(), second, third, fourth]
    }

    /// Whether it is a straight line.
    #[must_use]
    pub fn is_line(&self) -> bool {
        matches!(self.shape, Shape::Line { .. })
    }

    /// Whether it is a piece of a curve.
    #[must_use]
    pub fn is_piece(&self) -> bool {
        matches!(self.shape, Shape::Piece(_))
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

    /// The box that holds the path, from its start, mm: lowest and highest of every axis, points between the
    /// ends at which an axis turns back included.
    #[must_use]
    pub fn bounds(&self) -> [[f64; N]; 2] {
        let [end, ..] = self.at(self.length);
        let mut bounds = [end.map(|p| p.min(0.0)), end.map(|p| p.max(0.0))];
        match &self.shape {
            Shape::Line { .. } => {}
            Shape::Arc(arc) => arc.widen(self.length, &mut bounds),
            Shape::Piece(piece) => return piece.bounds(),
        }
        bounds
    }
}

/// Euclidean length of the metric parts.
fn norm<const N: usize>(way: &[f64; N], metric: &[bool; N]) -> f64 {
    way.iter().zip(metric).filter(|(_, metric)| **metric).map(|(d, _)| d * d).sum::<f64>().sqrt()
}

/// What the axes leave for the way if each has a constant share in it.
pub(crate) fn tightest<const N: usize>(axes: &[Limits; N], share: impl Fn(usize) -> f64) -> Limits {
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
