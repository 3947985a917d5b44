//! Pieces of a spline by length: polynomials of degree 7 from what the spline is at both ends (M84). In: a
//! spline, one of its intervals. Out: pieces.

use super::spline::{Knots, Vector};
use crate::piece::ways;
use crate::series::{Series, length};

/// In its middle a piece lies so near to the spline, as a share of its length, or mm if that is less.
const NEAR: f64 = 1e-6;
/// Most halvings of an interval; a piece leaves as it is then.
const HALVINGS: u32 = 6;

/// A piece of a curve of X, Y, Z by its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bow {
    /// Position and derivatives 1 … 3 by s at the start, mm … 1/mm²,
    pub start: [[f64; 3]; 4],
    /// and at the end.
    pub end: [[f64; 3]; 4],
    /// Length, mm.
    pub length: f64,
}

/// What a spline is at a place: its series by the way, and its speed by the parameter.
struct Knot {
    by_way: [Vector; 4],
    speeds: [f64; 3],
}

fn knot(knots: &Knots, k: usize, u: f64, controls: &[Vector]) -> Knot {
    let [x, first, second, third, _] = knots.at(k, u, controls);
    let axes: [Series; 3] =
        core::array::from_fn(|i| Series([x[i], first[i], second[i] / 2.0, third[i] / 6.0]));
    let way = length(&axes);
    let by_way = axes.map(|axis| axis.of(way.reversed()));
    Knot {
        by_way: core::array::from_fn(|n| by_way.map(|axis| axis.derivative(n))),
        speeds: [1, 2, 3].map(|n| way.derivative(n)),
    }
}

/// The pieces of a part of an interval, with the part of the parameter that each covers.
pub(super) fn along(
    knots: &Knots,
    k: usize,
    controls: &[Vector],
    of: [f64; 2],
    out: &mut impl FnMut(Bow, [f64; 2]),
) {
    part(knots, k, controls, of, HALVINGS, out);
}

fn part(
    knots: &Knots,
    k: usize,
    controls: &[Vector],
    [begin, end]: [f64; 2],
    halvings: u32,
    out: &mut impl FnMut(Bow, [f64; 2]),
) {
    let at = |share: f64| knot(knots, k, begin + share * (end - begin), controls);
    let (first, middle, last) = (at(0.0), at(0.5), at(1.0));
    let [half, all] = ways(0.5 * (end - begin), [first.speeds, middle.speeds, last.speeds]);
    let bow = Bow { start: first.by_way, end: last.by_way, length: all };
    let near = motion::Path::piece(&bow.start, &bow.end, all).is_some_and(|path| {
        let there = path.at(half)[0];
        (0..3).all(|i| (bow.start[0][i] + there[i] - middle.by_way[0][i]).abs() <= NEAR * all.min(1.0))
    });
    if near || halvings == 0 {
        return out(bow, [begin, end]);
    }
    let between = 0.5 * (begin + end);
    part(knots, k, controls, [begin, between], halvings - 1, out);
    part(knots, k, controls, [between, end], halvings - 1, out);
}
