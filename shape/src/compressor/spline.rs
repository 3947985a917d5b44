//! A spline of degree 5 on knots that need not be even, clamped at both ends: rows of its basis, and its
//! derivatives. In: knots, control points in mm. Out: rows by which control points count at a place; points
//! and their derivatives by the parameter.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | u | mm | parameter: the way along the lines that the spline follows |
//! | tᵢ | mm | knots, the first and the last of them six times |
//! | cᵢ, cᵢ⁽ʳ⁾ | mm^(1−r) | control points, and those of the r-th derivative |
//! | Bᵢd | – | basis of degree d, 0 outside of tᵢ … tᵢ₊d₊₁ |
//!
//! ```text
//! Bᵢd(u) = (u − tᵢ)/(tᵢ₊d − tᵢ) Bᵢ,d₋₁(u) + (tᵢ₊d₊₁ − u)/(tᵢ₊d₊₁ − tᵢ₊₁) Bᵢ₊₁,d₋₁(u)
//! x⁽ʳ⁾ = Σ cᵢ⁽ʳ⁾ Bᵢ,₅₋ᵣ,  cᵢ⁽ʳ⁺¹⁾ = (5 − r) (cᵢ⁽ʳ⁾ − cᵢ₋₁⁽ʳ⁾)/(tᵢ₊₅₋ᵣ − tᵢ)                           (M185)
//! ```
//! x⁗ goes straight from knot to knot. Its derivatives up to the fourth have no jumps.
//!
//! Source: the recursion of de Boor and Cox.

/// Degree of the spline.
pub(super) const DEGREE: usize = 5;

/// X, Y, Z, mm, or a derivative of them.
pub(super) type Vector = [f64; 3];

/// By how much each of the control points of an interval counts.
pub(super) type Row = [f64; DEGREE + 1];

/// The knots.
#[derive(Clone, Debug)]
pub(super) struct Knots(Vec<f64>);

impl Knots {
    /// Knots at these places, which grow; the ends count six times.
    pub(super) fn new(places: &[f64]) -> Knots {
        let ends = [places[0], places[places.len() - 1]];
        let [first, last] = ends.map(|end| [end; DEGREE]);
        Knots(first.iter().chain(places).chain(&last).copied().collect())
    }

    /// How many intervals there are.
    pub(super) fn intervals(&self) -> usize {
        self.0.len() - 2 * DEGREE - 1
    }

    /// How many control points there are; those of interval k are k … k + 5.
    pub(super) fn controls(&self) -> usize {
        self.intervals() + DEGREE
    }

    /// Where an interval begins and ends.
    pub(super) fn interval(&self, k: usize) -> [f64; 2] {
        [self.0[k + DEGREE], self.0[k + DEGREE + 1]]
    }

    /// Length of an interval.
    pub(super) fn width(&self, k: usize) -> f64 {
        let [begin, end] = self.interval(k);
        end - begin
    }

    /// The interval that holds a place; of two the later one.
    pub(super) fn holding(&self, u: f64) -> usize {
        let inner = &self.0[DEGREE..self.0.len() - DEGREE];
        inner.partition_point(|t| *t <= u).clamp(1, self.intervals()) - 1
    }

    /// Values of the bases of degrees 0 … 5 at `u` in interval `k`; of each the first degree + 1 of its row.
    fn bases(&self, k: usize, u: f64) -> [Row; DEGREE + 1] {
        let (t, i) = (&self.0[k..=k + 2 * DEGREE + 1], DEGREE);
        let mut rows = [[0.0; DEGREE + 1]; DEGREE + 1];
        rows[0][0] = 1.0;
        for d in 1..=DEGREE {
            let (lower, mut saved) = (rows[d - 1], 0.0);
            for r in 0..d {
                let (after, before) = (t[i + r + 1] - u, u - t[i + 1 + r - d]);
                let part = lower[r] / (after + before);
                rows[d][r] = saved + after * part;
                saved = before * part;
            }
            rows[d][d] = saved;
        }
        rows
    }

    /// By how much the control points of interval `k` count at `u` in it.
    pub(super) fn values(&self, k: usize, u: f64) -> Row {
        self.bases(k, u)[DEGREE]
    }

    /// x at `u` in interval `k`.
    pub(super) fn point(&self, k: usize, u: f64, controls: &[Vector]) -> Vector {
        weighted(&self.values(k, u), &controls[k..=k + DEGREE])
    }

    /// What the next difference of neighbours is multiplied by: `degree` over the way that both share, up to
    /// control point `m` of interval `k`.
    fn steepness(&self, k: usize, m: usize, degree: usize) -> f64 {
        degree as f64 / (self.0[k + m + degree] - self.0[k + m])
    }

    /// By how much the control points of interval `k` count in x⁗ at its start, and at its end.
    pub(super) fn fourth(&self, k: usize) -> [Row; 2] {
        let mut rows: [Row; DEGREE + 1] =
            core::array::from_fn(|m| core::array::from_fn(|n| f64::from(m == n)));
        for r in 0..4 {
            for m in (r + 1..=DEGREE).rev() {
                let factor = self.steepness(k, m, DEGREE - r);
                let before = rows[m - 1];
                rows[m].iter_mut().zip(before).for_each(|(own, before)| *own = factor * (*own - before));
            }
        }
        [rows[DEGREE - 1], rows[DEGREE]]
    }

    /// Control points of x″ in interval `k`: x″ is within their hull there.
    pub(super) fn second(&self, k: usize, controls: &[Vector]) -> [Vector; DEGREE - 1] {
        let mut points = self.of_interval(k, controls);
        (0..2).for_each(|r| self.differ(k, r, &mut points));
        core::array::from_fn(|m| points[m + 2])
    }

    /// x and its derivatives 1 … 4 at `u` in interval `k`.
    pub(super) fn at(&self, k: usize, u: f64, controls: &[Vector]) -> [Vector; DEGREE] {
        let (mut points, bases) = (self.of_interval(k, controls), self.bases(k, u));
        core::array::from_fn(|r| {
            let sum = weighted(&bases[DEGREE - r][..=DEGREE - r], &points[r..]);
            self.differ(k, r, &mut points);
            sum
        })
    }

    fn of_interval(&self, k: usize, controls: &[Vector]) -> [Vector; DEGREE + 1] {
        core::array::from_fn(|m| controls[k + m])
    }

    /// From the control points of the r-th derivative to those of the next, which begin one later.
    fn differ(&self, k: usize, r: usize, points: &mut [Vector; DEGREE + 1]) {
        for m in (r + 1..=DEGREE).rev() {
            let factor = self.steepness(k, m, DEGREE - r);
            points[m] = core::array::from_fn(|i| factor * (points[m][i] - points[m - 1][i]));
        }
    }

    /// The first five control points of a spline that begins with these derivatives 0 … 4.
    pub(super) fn beginning(&self, derivatives: &[Vector; DEGREE]) -> [Vector; DEGREE] {
        // The last r + 1 differences of the first control points are the derivatives; they are summed back.
        let mut points = *derivatives;
        for r in (0..DEGREE - 1).rev() {
            for m in r + 1..DEGREE {
                let factor = self.steepness(0, m, DEGREE - r);
                points[m] = core::array::from_fn(|i| points[m - 1][i] + points[m][i] / factor);
            }
        }
        points
    }
}

/// Σ of points by their shares.
pub(super) fn weighted(row: &[f64], points: &[Vector]) -> Vector {
    let mut sum = [0.0; 3];
    for (share, point) in row.iter().zip(points) {
        sum.iter_mut().zip(point).for_each(|(sum, point)| *sum += share * point);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{DEGREE, Knots, Row, Vector, weighted};

    const PLACES: [f64; 7] = [0.0, 0.3, 1.0, 1.2, 2.9, 3.0, 4.5];

    fn controls(knots: &Knots) -> Vec<Vector> {
        (0..knots.controls()).map(|i| [0.7, 1.3, 2.9].map(|k| libm::sin(k * i as f64))).collect()
    }

    fn near(a: f64, b: f64, within: f64) -> bool {
        (a - b).abs() <= within * (1.0 + a.abs().max(b.abs()))
    }

    #[test]
    fn the_basis_sums_to_one_and_is_that_of_every_interval_that_meets() {
        let knots = Knots::new(&PLACES);
        let controls = controls(&knots);
        for k in 0..knots.intervals() {
            let [begin, end] = knots.interval(k);
            for share in [0.0, 0.3, 1.0] {
                let row = knots.values(k, begin + share * (end - begin));
                assert!(near(row.iter().sum(), 1.0, 1e-14) && row.iter().all(|b| *b >= -1e-15), "{row:?}");
            }
            if k + 1 < knots.intervals() {
                let (left, right) = (knots.at(k, end, &controls), knots.at(k + 1, end, &controls));
                let alike =
                    left.iter().flatten().zip(right.iter().flatten()).all(|(a, b)| near(*a, *b, 1e-9));
                assert!(alike, "{left:?} {right:?}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_differences_and_x_iv_goes_straight() {
        let knots = Knots::new(&PLACES);
        let controls = controls(&knots);
        for k in 0..knots.intervals() {
            let [begin, end] = knots.interval(k);
            let (u, h) = (0.6 * begin + 0.4 * end, 1e-5 * (end - begin));
            let here = knots.at(k, u, &controls);
            let [back, on] = [-h, h].map(|h| knots.at(k, u + h, &controls));
            for (r, derivative) in here.iter().enumerate().skip(1) {
                for i in 0..3 {
                    let slope = (on[r - 1][i] - back[r - 1][i]) / (2.0 * h);
                    assert!(near(slope, derivative[i], 1e-4), "{k} {r}: {slope} {}", derivative[i]);
                }
            }
            let ends = knots.fourth(k).map(|row: Row| weighted(&row, &controls[k..]));
            for i in 0..3 {
                assert!(
                    near(0.6 * ends[0][i] + 0.4 * ends[1][i], here[4][i], 1e-9),
                    "{k}: {ends:?} {here:?}"
                );
            }
            let hull = knots.second(k, &controls);
            assert!(
                (0..3)
                    .all(|i| hull.iter().any(|c| c[i] <= here[2][i])
                        && hull.iter().any(|c| c[i] >= here[2][i]))
            );
        }
    }

    #[test]
    fn it_begins_with_what_it_was_given() {
        let knots = Knots::new(&PLACES);
        let mut controls = controls(&knots);
        let asked: [Vector; DEGREE] = core::array::from_fn(|r| [0.5 + r as f64, -2.0 * r as f64, 3.0]);
        controls[..DEGREE].copy_from_slice(&knots.beginning(&asked));
        let got = knots.at(0, 0.0, &controls);
        assert!(asked.iter().flatten().zip(got.iter().flatten()).all(|(a, b)| near(*a, *b, 1e-9)), "{got:?}");
        assert_eq!(knots.holding(1.1), 2);
        assert_eq!((knots.holding(-1.0), knots.holding(4.5), knots.holding(1.0)), (0, 5, 2));
    }
}
