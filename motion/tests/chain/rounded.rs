//! Where a chain must lead, by the rules of path modes alone: no plan, no time. In: a program. Out: the
//! position of the axes after any way on any block, mm; how far a point is from the programmed path, mm.
//!
//! A junction is rounded over an equal way on both sides. Between lines that is at most the shorter one, or
//! their common length; beside an arc at most half of either element, with half the tolerance and not beyond
//! the room that is left.

use crate::programs::{Line, N};
use crate::stand::Seen;
use motion::chain::{Corner, Feed};
use motion::{Blend, Path};

/// A program with the blend at the end of every block.
pub(crate) struct Rounded<'a> {
    blocks: &'a [Line],
    blends: Vec<Blend<N>>,
}

impl<'a> Rounded<'a> {
    pub(crate) fn new(blocks: &'a [Line]) -> Rounded<'a> {
        let junction = |pair: &[Line]| blend(&pair[0], &pair[1]).unwrap_or(Blend::NONE);
        Rounded { blocks, blends: blocks.windows(2).map(junction).collect() }
    }

    /// The position after `s` mm on a block, in the coordinates of the program.
    pub(crate) fn at(&self, number: usize, s: f64) -> [f64; N] {
        let Line { path, tag, .. } = &self.blocks[number];
        let mut p = path.at(s);
        if number > 0 {
            self.blends[number - 1].add(s, &mut p);
        }
        if let Some(end) = self.blends.get(number) {
            end.add(s - path.length(), &mut p);
        }
        std::array::from_fn(|i| tag.start[i] + p[0][i])
    }

    /// The axes are where the way on their block says, within 1e-9 mm.
    pub(crate) fn holds(&self, seen: &Seen) {
        let right = self.at(seen.step.tag.number, seen.step.along.s);
        let off = distance(&right, &seen.axes.map(|axis| axis.s));
        assert!(off <= 1e-9, "{off} mm beside the path: {seen:?}");
    }
}

fn same_kind(a: Feed, b: Feed) -> bool {
    std::mem::discriminant(&a) == std::mem::discriminant(&b)
}

fn blend(last: &Line, next: &Line) -> Option<Blend<N>> {
    let jumps = last.path.jumps(&next.path);
    let turn = distance(&jumps[0], &[0.0; N]);
    let tolerance = match last.corner {
        Corner::Exact(tolerance) if turn <= 1e-3 => tolerance,
        Corner::Blend(tolerance) => tolerance,
        Corner::Exact(_) | Corner::Stop => return None,
    };
    // The chord of 120°.
    if turn > 3_f64.sqrt() || !same_kind(last.feed, next.feed) {
        return None;
    }
    let (a, b) = (last.path.length(), next.path.length());
    let (tolerance, cap) = match last.path.is_line() && next.path.is_line() {
        true if (a - b).abs() <= 1e-3 * a.min(b) => (tolerance, a.max(b)),
        true => (tolerance, a.min(b)),
        false => ((0.5 * tolerance).min(last.room).min(next.room), 0.5 * a.min(b)),
    };
    // Pieces of one curve join but for rounding.
    let [_, direction, ..] = next.path.at(0.0);
    let none = |n: usize| 1e-10 * distance(&direction, &[0.0; N]) * a.min(b).powi(-(n as i32));
    if (0..3).all(|n| distance(&jumps[n], &[0.0; N]) <= none(n)) {
        return Some(Blend::NONE);
    }
    let half = Blend::half_within(&jumps, tolerance, cap);
    (half >= cap.min(1e-6)).then(|| Blend::new(jumps, half))
}

pub(crate) fn distance(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Distance of a point, seen from the start of a path, from the nearest point of the path near `s`: never
/// less than the true distance, because it is that of a point of the path.
pub(crate) fn nearest(path: &Path<N>, point: &[f64; N], s: f64) -> f64 {
    let clamped = |s: f64| s.clamp(0.0, path.length());
    let mut s = clamped(s);
    for _ in 0..8 {
        // Newton's step to the foot of the perpendicular: (p − x)·p₁ = 0.
        let [p, p1, p2, ..] = path.at(s);
        let dot = |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let off: [f64; N] = std::array::from_fn(|i| p[i] - point[i]);
        let slope = (dot(&p1, &p1) + dot(&off, &p2)).max(0.5);
        s = clamped(s - dot(&off, &p1) / slope);
    }
    distance(&path.at(s)[0], point)
}
