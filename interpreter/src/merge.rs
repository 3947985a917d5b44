//! Very short lines become one where their ends lie near it. In: items. Out: items, lines fewer.
//!
//! A blend reaches over so many lines at most; where those are shorter than the rounding of a program
//! deserves, that is not far enough. Lines of a tenth of a millimetre are.
//!
//! Lines from S over P1, P2, … to E are one line from S to E if that is short, every P lies within a
//! tolerance of it and further along it than the one before, the feed is the same, and no rotary axis moves.
//! Nothing else may lie between them. Rapids are left alone.
//!
//! A longer line takes in a very short one that goes on as straight as rounding lets it, at either end:
//! beside a corner the blends of both would have no room.

use protocol::{Axis, Code, Feed, Item, PathMode, PerAxis, Position, units::AXES};

/// Longest line that others become, mm.
const LONGEST_MM: f64 = 0.2;
/// Points of a straight line, rounded to a thousandth, lie so near to it, mm: half of one on each of two
/// axes.
const ROUNDED_MM: f64 = 0.75e-3;
/// A longer line takes in one that is so many times shorter: among lines alike, all of them stay.
const SHORTER: f64 = 5.0;
/// Most lines that become one.
const MOST: usize = 100;

/// A line that others may yet lengthen waits here.
#[derive(Clone, Debug, Default)]
pub(crate) struct Merger {
    waiting: Option<Merged>,
}

impl Merger {
    /// Takes the next item; `rest` is where the axes are before it. `out` takes what cannot change any more,
    /// each with where the axes are before it.
    pub(crate) fn add(
        &mut self,
        item: Item,
        rest: PerAxis<Position>,
        mode: PathMode,
        out: &mut impl FnMut(Item, PerAxis<Position>),
    ) {
        let within_mm = mode.merges_within_mm();
        if self.waiting.as_mut().is_some_and(|line| line.take(&item, within_mm)) {
            return;
        }
        self.finish(out);
        self.waiting = Merged::new(rest, &item).filter(|_| within_mm > 0.0);
        if self.waiting.is_none() {
            out(item, rest);
        }
    }

    /// What waits leaves.
    pub(crate) fn finish(&mut self, out: &mut impl FnMut(Item, PerAxis<Position>)) {
        if let Some(line) = self.waiting.take() {
            out(line.item(), line.from);
        }
    }
}

/// Lines that are one so far.
#[derive(Clone, Debug)]
struct Merged {
    from: PerAxis<Position>,
    /// Ends of all lines but the last.
    over: Vec<PerAxis<Position>>,
    to: PerAxis<Position>,
    feed: Feed,
    line: u32,
}

impl Merged {
    /// A first line, if it is one that others may follow.
    fn new(from: PerAxis<Position>, item: &Item) -> Option<Merged> {
        let Code::Line { target, feed } = item.code else { return None };
        let turns = |axis: Axis| axis.is_rotary() && from[axis.index()] != target[axis.index()];
        let mergeable = feed != Feed::Rapid && !Axis::ALL.into_iter().any(turns);
        mergeable.then_some(Merged { from, over: Vec::new(), to: target, feed, line: item.line })
    }

    /// Takes a line in, if all of them stay within `within_mm` of one; false if it stays out.
    fn take(&mut self, item: &Item, within_mm: f64) -> bool {
        let Some(next) = Merged::new(self.to, item) else { return false };
        let [so_far, further, all] = [(&self.from, &self.to), (&self.to, &next.to), (&self.from, &next.to)]
            .map(|(a, b)| length(&way(a, b)));
        let within_mm = if all <= LONGEST_MM { within_mm } else { within_mm.min(ROUNDED_MM) };
        let (less, more) = (so_far.min(further), so_far.max(further));
        let near = all <= LONGEST_MM || less <= LONGEST_MM && more > LONGEST_MM.max(SHORTER * less);
        let leads = || self.leads_to(&next.to, all, within_mm);
        if next.feed != self.feed || self.over.len() + 2 > MOST || !near || !leads() {
            return false;
        }
        self.over.push(self.to);
        (self.to, self.line) = (next.to, next.line);
        true
    }

    /// The one line.
    fn item(&self) -> Item {
        Item { line: self.line, code: Code::Line { target: self.to, feed: self.feed } }
    }

    /// Whether every end so far lies near the line to `end`, `length` mm away, each further along than the
    /// one before.
    fn leads_to(&self, end: &PerAxis<Position>, length: f64, within_mm: f64) -> bool {
        let seen = |point: &PerAxis<Position>| way(&self.from, point);
        let dot = |a: &[f64; AXES], b: &[f64; AXES]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let way = seen(end);
        let mut before = 0.0;
        self.over.iter().chain([&self.to]).all(|point| {
            let point = seen(point);
            let along = dot(&point, &way) / length;
            let aside: [f64; AXES] = std::array::from_fn(|axis| point[axis] - way[axis] * along / length);
            let onwards = along > before && along < length;
            before = along;
            onwards && dot(&aside, &aside).sqrt() <= within_mm
        })
    }
}

fn way(from: &PerAxis<Position>, to: &PerAxis<Position>) -> [f64; AXES] {
    std::array::from_fn(|axis| to[axis].mm_from(from[axis]))
}

fn length(way: &[f64; AXES]) -> f64 {
    way.iter().map(|way| way * way).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use protocol::{Axis, Code, Feed, Item, PathMode, PerAxis, Position};

    use super::Merger;

    /// Which of these lines between points stay, by the numbers of their last ones.
    fn merged(points: &[[f64; 2]]) -> Vec<u32> {
        let at = |[x, z]: [f64; 2]| {
            let mut at = PerAxis::default();
            (at[Axis::X.index()], at[Axis::Z.index()]) = (Position::from_mm(x), Position::from_mm(z));
            at
        };
        let mode = PathMode::Blend { tolerance_mm: 0.02, merge_mm: 0.01 };
        let (mut merger, mut lines) = (Merger::default(), Vec::new());
        let mut out = |item: Item, _| lines.push(item.line);
        for (k, pair) in points.windows(2).enumerate() {
            let code = Code::Line { target: at(pair[1]), feed: Feed::PerMinute(100.0) };
            merger.add(Item { line: k as u32, code }, at(pair[0]), mode, &mut out);
        }
        merger.finish(&mut out);
        lines
    }

    #[test]
    fn a_longer_line_takes_in_what_goes_on_straight_for_hardly_a_way() {
        // Points of a line at 0.3 rad, rounded to a thousandth.
        let at = |mm: f64| [libm::cos(0.3) * mm, libm::sin(0.3) * mm].map(|mm| (1e3 * mm).round() / 1e3);
        let straight = |ways: &[f64]| ways.iter().map(|mm| at(*mm)).collect::<Vec<_>>();
        assert_eq!(merged(&straight(&[0.0, 10.0, 10.01])), [1], "behind it");
        assert_eq!(merged(&straight(&[0.0, 0.01, 10.0])), [1], "before it");
        assert_eq!(merged(&straight(&[0.0, 0.02, 5.0, 5.15, 10.0])), [2, 3], "at both ends");
        assert_eq!(merged(&straight(&[0.0, 0.5, 1.0, 1.19])), [0, 1, 2], "lines alike stay");
        assert_eq!(merged(&straight(&[0.0, 10.0, 10.3])), [0, 1], "what is longer stays");
        let mut turned = straight(&[0.0, 10.0]);
        turned.push([turned[1][0] + 0.1, turned[1][1] + 0.02]);
        assert_eq!(merged(&turned), [0, 1], "a turn stays");
    }

    proptest! {
        /// Every programmed end lies within half of Q of the lines that are left, and the last one is kept
        /// exactly.
        #[test]
        fn no_end_is_farther_away_than_half_of_q(
            steps in prop::collection::vec((-0.02..0.02_f64, 0.005..0.08_f64), 2..60)
        ) {
            let mode = PathMode::Blend { tolerance_mm: 0.02, merge_mm: 0.01 };
            let at = |[x, z]: [f64; 2]| {
                let mut at = PerAxis::default();
                (at[Axis::X.index()], at[Axis::Z.index()]) = (Position::from_mm(x), Position::from_mm(z));
                at
            };
            let (mut merger, mut ends, mut points) = (Merger::default(), Vec::new(), vec![[10.0, 0.0]]);
            let mut out = |item: Item, _| ends.push((item.line as usize, *item.code.target().expect("a line")));
            for (dx, dz) in steps {
                let from = points[points.len() - 1];
                let to = [from[0] + dx, from[1] - dz].map(|mm: f64| (mm * 1e4).round() / 1e4);
                let code = Code::Line { target: at(to), feed: Feed::PerMinute(100.0) };
                merger.add(Item { line: points.len() as u32, code }, at(from), mode, &mut out);
                points.push(to);
            }
            merger.finish(&mut out);
            prop_assert_eq!(ends.last().map(|(_, end)| *end), points.last().map(|point| at(*point)));
            let mut from = 0;
            for (to, end) in ends {
                let (a, b) = (points[from], [Axis::X, Axis::Z].map(|axis| end[axis.index()].mm()));
                let length = libm::hypot(b[0] - a[0], b[1] - a[1]);
                for p in &points[from..=to] {
                    let aside = ((p[0] - a[0]) * (b[1] - a[1]) - (p[1] - a[1]) * (b[0] - a[0])) / length;
                    prop_assert!(aside.abs() <= 0.005 + 1e-9, "{} in line {}", aside, to);
                }
                from = to;
            }
        }
    }
}
