//! A smooth curve through points: the natural spline of degree 5. In: points of six coordinates. Out: one
//! polynomial piece from point to point, each of its own parameter 0 … 1; where pieces meet, four derivatives
//! are continuous.
//!
//! | symbol | meaning |
//! |---|---|
//! | p, m, M | a coordinate at a point, its first and second derivative by the way u from point to point |
//! | h | distance of two points, in mean distances |
//!
//! ```text
//! p‴(0) = (60 Δp − h (36 m₀ + 24 m₁) − h² (9 M₀ − 3 M₁))/h³
//! p‴(h) = (60 Δp − h (24 m₀ + 36 m₁) − h² (3 M₀ − 9 M₁))/h³
//! p⁗(0) = (−360 Δp + h (192 m₀ + 168 m₁) + h² (36 M₀ − 24 M₁))/h⁴
//! p⁗(h) = (360 Δp − h (168 m₀ + 192 m₁) − h² (24 M₀ − 36 M₁))/h⁴
//! ```
//! Equal third and fourth derivatives on both sides of a point, none at both ends: two equations a point for
//! m and M, a block tridiagonal system. Of all curves through the points this has the least ∫ p‴².
//!
//! Source: two-point Hermite interpolation of degree 5.

use nalgebra::{Matrix2, SMatrix};

/// Coordinates of a point: position and direction.
const COORDINATES: usize = 6;

/// m and M of every coordinate.
type Slopes = SMatrix<f64, 2, COORDINATES>;

/// Third and fourth derivatives at one end of a piece, as they depend on m, M at its start, at its end, and
/// on Δp.
struct End {
    start: Matrix2<f64>,
    end: Matrix2<f64>,
    rise: [f64; 2],
}

fn at_start(h: f64) -> End {
    let (h1, h2, h3) = (1.0 / h, 1.0 / (h * h), 1.0 / (h * h * h));
    End {
        start: Matrix2::new(-36.0 * h2, -9.0 * h1, 192.0 * h3, 36.0 * h2),
        end: Matrix2::new(-24.0 * h2, 3.0 * h1, 168.0 * h3, -24.0 * h2),
        rise: [60.0 * h3, -360.0 * h3 * h1],
    }
}

fn at_end(h: f64) -> End {
    let (h1, h2, h3) = (1.0 / h, 1.0 / (h * h), 1.0 / (h * h * h));
    End {
        start: Matrix2::new(-24.0 * h2, -3.0 * h1, -168.0 * h3, -24.0 * h2),
        end: Matrix2::new(-36.0 * h2, 9.0 * h1, -192.0 * h3, 36.0 * h2),
        rise: [60.0 * h3, 360.0 * h3 * h1],
    }
}

impl End {
    /// What Δp adds.
    fn known(&self, rise: &[f64; COORDINATES]) -> Slopes {
        Slopes::from_fn(|row, column| self.rise[row] * rise[column])
    }
}

/// The pieces through `points`, coefficients of u⁰ … u⁷ of every coordinate. Distances are those of the first
/// three coordinates. `None` for fewer than two points, or for neighbours that are one.
pub(super) fn through(points: &[[f64; COORDINATES]]) -> Option<Vec<[[f64; 8]; COORDINATES]>> {
    let distances: Vec<f64> = points.windows(2).map(distance).collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    if distances.is_empty() || !distances.iter().all(|h| *h > 1e-9 * mean) {
        return None;
    }
    let steps: Vec<f64> = distances.iter().map(|h| h / mean).collect();
    let rises: Vec<[f64; COORDINATES]> =
        points.windows(2).map(|pair| std::array::from_fn(|i| pair[1][i] - pair[0][i])).collect();
    let slopes = if points.len() == 2 {
        // A straight line: the least ∫ p‴² alone would leave its bend open.
        let straight = |row, i| if row == 0 { points[1][i] - points[0][i] } else { 0.0 };
        vec![Slopes::from_fn(straight); 2]
    } else {
        slopes(&steps, &rises)?
    };
    let mut pieces = Vec::with_capacity(steps.len());
    for (((from, rise), h), ends) in points.iter().zip(&rises).zip(steps).zip(slopes.windows(2)) {
        pieces.push(std::array::from_fn(|i| coefficients(from[i], rise[i], h, ends, i)));
    }
    Some(pieces)
}

fn distance(pair: &[[f64; COORDINATES]]) -> f64 {
    (0..3).map(|i| (pair[1][i] - pair[0][i]).powi(2)).sum::<f64>().sqrt()
}

/// m and M at every point: elimination from the first point to the last, and back.
fn slopes(steps: &[f64], rises: &[[f64; COORDINATES]]) -> Option<Vec<Slopes>> {
    let mut rows: Vec<(Matrix2<f64>, Slopes)> = Vec::with_capacity(steps.len() + 1);
    for point in 0..=steps.len() {
        let (mut own, mut next, mut known) = (Matrix2::zeros(), Matrix2::zeros(), Slopes::zeros());
        if let Some(((h, rise), (ratio, before))) = point
            .checked_sub(1)
            .and_then(|last| Some((steps.get(last).zip(rises.get(last))?, rows.get(last)?)))
        {
            let behind = at_end(*h);
            own += behind.end - behind.start * ratio;
            known -= behind.known(rise) + behind.start * before;
        }
        if let Some((h, rise)) = steps.get(point).zip(rises.get(point)) {
            let ahead = at_start(*h);
            own -= ahead.start;
            next = -ahead.end;
            known += ahead.known(rise);
        }
        let inverse = own.try_inverse()?;
        rows.push((inverse * next, inverse * known));
    }
    let mut slopes = Vec::with_capacity(rows.len());
    let mut after = Slopes::zeros();
    for (ratio, own) in rows.iter().rev() {
        after = own - ratio * after;
        slopes.push(after);
    }
    slopes.reverse();
    Some(slopes)
}

/// Coefficients of one coordinate on one piece.
fn coefficients(p: f64, d: f64, h: f64, ends: &[Slopes], i: usize) -> [f64; 8] {
    let at = |end: usize, row: usize| ends.get(end).map_or(0.0, |slopes| slopes[(row, i)]);
    let (m0, m1) = (h * at(0, 0), h * at(1, 0));
    let (c0, c1) = (h * h * at(0, 1), h * h * at(1, 1));
    [
        p,
        m0,
        c0 / 2.0,
        10.0 * d - 6.0 * m0 - 4.0 * m1 - 1.5 * c0 + 0.5 * c1,
        -15.0 * d + 8.0 * m0 + 7.0 * m1 + 1.5 * c0 - c1,
        6.0 * d - 3.0 * m0 - 3.0 * m1 - 0.5 * c0 + 0.5 * c1,
        0.0,
        0.0,
    ]
}
