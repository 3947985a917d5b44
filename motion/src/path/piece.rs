//! A piece of a curve: every axis a polynomial of degree 7 in the way, from what the curve is at both ends
//! (M84). In: position and derivatives 1 … 3 of every axis at both ends, mm (degrees) … 1/mm²; the length,
//! mm. Out: position and derivatives by the way s, bounds of them, the box that holds the piece.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | L | mm | length of the piece; u = s/L |
//! | b₀ … b₇ | mm | control points of an axis, from the start of the piece |
//! | hₙ, gₙ | mm | Lⁿ pₙ at the start, at the end |
//! | Δⁿ | mm | n-th difference of neighbouring control points |
//!
//! ```text
//! p(s) = Σ b_k C(7, k) uᵏ (1 − u)^(7−k),  pₙ = 7!/(7−n)! Δⁿ(u)/Lⁿ
//! b₀ = 0,           b₁ = h₁/7,           b₂ = 2 h₁/7 + h₂/42,           b₃ = 3 h₁/7 + h₂/14 + h₃/210
//! b₇ = p(L) − p(0), b₆ = b₇ − g₁/7,      b₅ = b₇ − 2 g₁/7 + g₂/42,  b₄ = b₇ − 3 g₁/7 + g₂/14 − g₃/210  (M84)
//! ```
//! Δⁿ(u) is that of the first n + 1 points after 7 − n steps of de Casteljau. Pieces of a curve that share
//! their ends agree in p … p₃ there, so no blend is needed between them; p₄ jumps, and jerk rate is only
//! bounded.
//!
//! Beside the curve a piece lies max |p₈| L⁸/(8! 2⁸) at most (Hermite's remainder); of a circle of 10 mm,
//! 1e-10 mm at 3.2 mm.
//!
//! Source: two-point Hermite interpolation in Bernstein's form.

use super::hull::{DEGREE, Hull};

/// The box of a piece is wider by less, mm.
const BOX_MM: f64 = 1e-10;
/// Halvings for it: each brings the hull nearer by a factor of four.
const BOX_HALVINGS: u32 = 20;

/// Control points b₀ … b₇ of every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece<const N: usize>([[f64; DEGREE + 1]; N]);

impl<const N: usize> Piece<N> {
    /// As `Path::piece`.
    pub(super) fn new(start: &[[f64; N]; 4], end: &[[f64; N]; 4], length: f64) -> Option<Piece<N>> {
        let points = core::array::from_fn(|i| {
            let scaled = |p: &[[f64; N]; 4]| {
                [p[1][i] * length, p[2][i] * length * length, p[3][i] * length * length * length]
            };
            let (way, [h1, h2, h3], [g1, g2, g3]) = (end[0][i] - start[0][i], scaled(start), scaled(end));
            [
                0.0,
                h1 / 7.0,
                2.0 / 7.0 * h1 + h2 / 42.0,
                3.0 / 7.0 * h1 + h2 / 14.0 + h3 / 210.0,
                way - 3.0 / 7.0 * g1 + g2 / 14.0 - g3 / 210.0,
                way - 2.0 / 7.0 * g1 + g2 / 42.0,
                way - g1 / 7.0,
                way,
            ]
        });
        let usable = length > 0.0 && length.is_finite() && points.iter().flatten().all(|b| b.is_finite());
        usable.then_some(Piece(points))
    }

    /// p … p₄ at `s` (M84).
    pub(super) fn at(&self, s: f64, length: f64) -> [[f64; N]; 5] {
        let mut p = [[0.0; N]; 5];
        let u = s / length;
        for (i, points) in self.0.iter().enumerate().filter(|(_, points)| moves(points)) {
            let mut b = *points;
            for left in (0..=DEGREE).rev() {
                // Only `left` + 1 points are left: the triangle of de Casteljau down to its tip.
                if let Some(derivative) = p.get_mut(left) {
                    derivative[i] = difference(&b, left);
                }
                for k in 0..left {
                    b[k] += u * (b[k + 1] - b[k]);
                }
            }
        }
        let mut scale = 1.0;
        for (n, derivative) in p.iter_mut().enumerate() {
            derivative.iter_mut().for_each(|p| *p *= scale);
            scale *= (DEGREE - n) as f64 / length;
        }
        p
    }

    /// Bounds of |p₁| … |p₄| of every axis (M85).
    pub(super) fn most(&self, length: f64) -> [[f64; N]; 4] {
        let mut most = [[0.0; N]; 4];
        for (i, points) in self.0.iter().enumerate().filter(|(_, points)| moves(points)) {
            let mut hull = Hull::new(*points);
            for (n, most) in most.iter_mut().enumerate() {
                hull = hull.derivative();
                most[i] = (0..=n).fold(hull.most(), |most, _| most / length);
            }
        }
        most
    }

    /// As `Path::bounds`.
    pub(super) fn bounds(&self) -> [[f64; N]; 2] {
        let ranges = self.0.map(|points| Hull::new(points).range(BOX_MM, BOX_HALVINGS));
        [ranges.map(|[low, _]| low), ranges.map(|[_, high]| high)]
    }
}

fn moves(points: &[f64; DEGREE + 1]) -> bool {
    points.iter().any(|point| *point != 0.0)
}

/// Δⁿ of the first points, n up to 4.
fn difference(b: &[f64; DEGREE + 1], n: usize) -> f64 {
    match n {
        0 => b[0],
        1 => b[1] - b[0],
        2 => (b[2] - b[1]) - (b[1] - b[0]),
        3 => (b[3] - b[0]) - 3.0 * (b[2] - b[1]),
        _ => (b[4] + b[0]) - 4.0 * (b[3] + b[1]) + 6.0 * b[2],
    }
}
