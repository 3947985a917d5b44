//! A curve of G5: a rational B-spline in a plane, and the arcs that follow it.
//!
//! In: control points with weights, in the order of the axes of the plane. Out: the curve, or arcs that keep
//! within a distance of it and have its tangents wherever it is cut. Lengths in one unit.
//!
//! | symbol | meaning |
//! |---|---|
//! | k | order: degree and one |
//! | P, w | control point and its weight, > 0 |
//! | t | knots, not falling; the first k are equal, and so are the last k |
//! | P0, T0, P1, T1 | ends of a piece of the curve and the unit tangents there |
//! | v, d | P1 − P0; how far from each end the tangents of both arcs meet |
//! | n | tangent turned to the left by a quarter |
//!
//! ```text
//! C(u) = Σ w P N / Σ w N                       by de Boor, in (w x, w y, w)                (N1)
//! C'(u) ∥ (w x)' w − w x w'                                                                (N2)
//! v·v − 2 d v·(T0 + T1) − 2 d² (1 − T0·T1) = 0,   d > 0                                    (N3)
//! joint = (P0 + P1 + d (T0 − T1)) / 2                                                      (N4)
//! centre = P + n |c|² / (2 n·c),   c the chord of an arc from its end P                    (N5)
//! ```
//! Both arcs of N3 to N5 touch at the joint. A piece whose arcs leave the curve by more than the distance is
//! cut in two; so arcs are as long as the curvature changes slowly.

use crate::plane::{Point, add, cross, dot, length, scale, sub};

/// Samples of a piece that are compared with its arcs.
const SAMPLES: u32 = 8;
/// A piece is cut in two at most this often.
const DEEPEST: u32 = 40;
/// Chords shorter than this, relative to the curve, are nothing.
const NOTHING: f64 = 1e-12;

/// A rational B-spline.
#[derive(Clone, Debug, PartialEq)]
pub struct Nurbs {
    /// k, from 2; no more than there are points.
    pub order: usize,
    /// P and w: first and second axis of the plane, weight.
    pub points: Vec<[f64; 3]>,
    /// t, as many as points and order together.
    pub knots: Vec<f64>,
    /// The program says its knots (G6.2).
    pub named: bool,
}

/// A piece of the way along a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follows {
    /// Its end.
    pub end: Point,
    /// Centre, and whether it turns counterclockwise; `None` for a line.
    pub arc: Option<(Point, bool)>,
}

/// A point of the curve and the unit tangent there.
#[derive(Clone, Copy)]
struct Place {
    u: f64,
    at: Point,
    tangent: Point,
}

impl Nurbs {
    /// The curve with knots at whole numbers that begins and ends at its first and last point. `points` are
    /// at least `order`, and `order` is at least 2.
    pub fn uniform(order: usize, points: Vec<[f64; 3]>) -> Nurbs {
        let spans = (points.len() + 1).saturating_sub(order).max(1);
        let inner = (1..spans).map(|knot| knot as f64);
        let ends = |knot: f64| std::iter::repeat_n(knot, order);
        let knots = ends(0.0).chain(inner).chain(ends(spans as f64)).collect();
        Nurbs { order, points, knots, named: false }
    }

    /// Lines and arcs, of radii up to `largest`, that follow the curve within a distance. `None` if more than
    /// `most` are needed.
    pub fn follow(&self, within: f64, largest: f64, most: usize) -> Option<Vec<Follows>> {
        let mut way = Vec::new();
        let degree = self.order.saturating_sub(1);
        for span in degree..self.points.len() {
            let (from, to) = (*self.knots.get(span)?, *self.knots.get(span + 1)?);
            if to > from {
                let ends = [self.place(span, from, to)?, self.place(span, to, from)?];
                self.piece(span, ends, (within, largest), (0, most), &mut way)?;
            }
        }
        Some(way)
    }

    /// Follows a piece of a span.
    fn piece(
        &self,
        span: usize,
        [from, to]: [Place; 2],
        (within, largest): (f64, f64),
        (depth, most): (u32, usize),
        way: &mut Vec<Follows>,
    ) -> Option<()> {
        let chord = length(sub(to.at, from.at));
        let sample = |n: u32| from.u + (to.u - from.u) * f64::from(n) / f64::from(SAMPLES);
        let is_a_point = || {
            let close = |at| length(sub(at, from.at)) <= within;
            (1..=SAMPLES).all(|n| self.point(span, sample(n)).is_some_and(close))
        };
        let arcs = biarc(&from, &to, largest);
        let near = |arcs: &[Follows; 2]| {
            (1..SAMPLES)
                .all(|n| self.point(span, sample(n)).is_some_and(|at| distance(at, from.at, arcs) <= within))
        };
        match arcs.filter(near) {
            Some(arcs) => {
                let mut at = from.at;
                for follows in arcs.into_iter().filter(|_| chord > NOTHING * within.max(1.0)) {
                    if length(sub(follows.end, at)) > NOTHING {
                        way.push(follows);
                    }
                    at = follows.end;
                }
                (way.len() <= most).then_some(())
            }
            // a cusp: the tangent turns in a place that is smaller than what counts
            None if is_a_point() => {
                way.push(Follows { end: to.at, arc: None });
                Some(())
            }
            None if depth == DEEPEST => None,
            None => {
                let middle = self.place(span, from.u + (to.u - from.u) / 2.0, to.u)?;
                self.piece(span, [from, middle], (within, largest), (depth + 1, most), way)?;
                self.piece(span, [middle, to], (within, largest), (depth + 1, most), way)
            }
        }
    }

    /// The point at u, and the tangent there; where the curve has none (control points that coincide), that
    /// of the way a little towards `inwards`.
    fn place(&self, span: usize, u: f64, inwards: f64) -> Option<Place> {
        let (at, along) = self.point_and_direction(span, u)?;
        if let Some(tangent) = unit(along) {
            return Some(Place { u, at, tangent });
        }
        let beside = self.point(span, u + (inwards - u) * 1e-4)?;
        let forward = if inwards >= u { 1.0 } else { -1.0 };
        let tangent = unit(scale(forward, sub(beside, at))).unwrap_or([1.0, 0.0]);
        Some(Place { u, at, tangent })
    }

    fn point(&self, span: usize, u: f64) -> Option<Point> {
        Some(self.point_and_direction(span, u)?.0)
    }

    /// N1 and N2 with the polynomials of a span.
    fn point_and_direction(&self, span: usize, u: f64) -> Option<(Point, Point)> {
        let degree = self.order - 1;
        let points = self.points.get(span - degree..=span)?;
        let mut d: Vec<[f64; 3]> = points.iter().map(|[x, y, w]| [x * w, y * w, *w]).collect();
        let mut slope = [0.0; 3];
        for level in 1..=degree {
            for j in (level..=degree).rev() {
                let (low, high) =
                    (*self.knots.get(span + j - degree)?, *self.knots.get(span + 1 + j - level)?);
                let part = if high > low { (u - low) / (high - low) } else { 0.0 };
                let (before, here) = (*d.get(j - 1)?, *d.get(j)?);
                if level == degree {
                    slope = std::array::from_fn(|n| here[n] - before[n]);
                }
                *d.get_mut(j)? = std::array::from_fn(|n| (1.0 - part) * before[n] + part * here[n]);
            }
        }
        let [x, y, w] = *d.last()?;
        let [dx, dy, dw] = slope;
        Some(([x / w, y / w], [dx * w - x * dw, dy * w - y * dw]))
    }
}

/// Two arcs with the tangents of the ends: N3 to N5. `None` where the curve turns by a quarter or more.
fn biarc(from: &Place, to: &Place, largest: f64) -> Option<[Follows; 2]> {
    let v = sub(to.at, from.at);
    let (along, cosine) = (dot(v, add(from.tangent, to.tangent)), dot(from.tangent, to.tangent));
    if cosine <= 0.0 || along <= 0.0 {
        return None;
    }
    // the root of N3 in the form that does not cancel
    let root = libm::sqrt(along * along + 2.0 * (1.0 - cosine).max(0.0) * dot(v, v));
    let d = dot(v, v) / (along + root);
    let joint = scale(0.5, add(add(from.at, to.at), scale(d, sub(from.tangent, to.tangent))));
    let first = Follows { end: joint, arc: arc(from.at, from.tangent, sub(joint, from.at), largest) };
    let second = Follows { end: to.at, arc: arc(to.at, scale(-1.0, to.tangent), sub(joint, to.at), largest) };
    // the second was made from its end: its sense is the other one
    let second = Follows { arc: second.arc.map(|(center, ccw)| (center, !ccw)), ..second };
    Some([first, second])
}

/// N5: the circle through `at` along `tangent`, whose chord from there is `chord`, and its sense. `None`
/// where its radius is larger than `largest`: a line.
fn arc(at: Point, tangent: Point, chord: Point, largest: f64) -> Option<(Point, bool)> {
    let n = [-tangent[1], tangent[0]];
    let (across, square) = (dot(n, chord), dot(chord, chord));
    if across.abs() * 2.0 * largest <= square {
        return None;
    }
    Some((add(at, scale(square / (2.0 * across), n)), across > 0.0))
}

/// How far a point is off two arcs that begin at `start`.
fn distance(at: Point, start: Point, arcs: &[Follows; 2]) -> f64 {
    let [first, second] = arcs;
    let one = |from: Point, follows: &Follows| match follows.arc {
        Some((center, _)) => (length(sub(at, center)) - length(sub(follows.end, center))).abs(),
        None => {
            let way = sub(follows.end, from);
            let square = length(way);
            if square > 0.0 { cross(sub(at, from), way).abs() / square } else { length(sub(at, from)) }
        }
    };
    // the nearer end tells which arc the point belongs to
    let before = length(sub(at, start)) <= length(sub(at, second.end));
    let by_joint = [one(start, first), one(first.end, second)];
    let near_joint = length(sub(at, first.end)) < 0.2 * length(sub(second.end, start));
    match (near_joint, before) {
        (true, _) => by_joint[0].min(by_joint[1]),
        (false, true) => by_joint[0],
        (false, false) => by_joint[1],
    }
}

fn unit(a: Point) -> Option<Point> {
    let length = length(a);
    (length > 1e-300).then(|| scale(1.0 / length, a))
}
