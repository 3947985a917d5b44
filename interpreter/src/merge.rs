//! Lines become one where their ends lie near it (G64 Q). In: items. Out: items, lines fewer.
//!
//! Without Q the same is done with short lines, as a CAM system puts them out: rounded to a thousandth they
//! have angles and lengths that no curve has, and that would be felt in the axes.
//!
//! Lines from S over P1, P2, … to E are one line from S to E if every P lies within Q of it and further along
//! it than the one before, the feed is the same, and no rotary axis moves. Nothing else may lie between them.
//! Rapids are left alone.

use std::collections::VecDeque;

use protocol::{Axis, Code, Feed, Item, PathMode, PerAxis, Position, units::AXES};

use crate::path_mode::PathAsked;

/// Lines shorter than this are merged without Q, mm.
const SHORT_MM: f64 = 1.0;
/// Most lines that become one.
const MOST: usize = 100;

/// A line that others may yet lengthen waits here.
#[derive(Clone, Debug, Default)]
pub(crate) struct Merger {
    waiting: Option<Merged>,
}

impl Merger {
    /// Whether a line waits for more.
    pub(crate) fn holds(&self) -> bool {
        self.waiting.is_some()
    }

    /// Takes the next item; `rest` is where the axes are before it. What cannot change any more goes to
    /// `items`.
    pub(crate) fn add(
        &mut self,
        item: Item,
        rest: PerAxis<Position>,
        path: &PathAsked,
        items: &mut VecDeque<Item>,
    ) {
        let within_mm = match path.mode {
            PathMode::Blend { merge_mm, .. } => merge_mm,
            PathMode::ExactStop | PathMode::ExactPath => 0.0,
        };
        if self.waiting.as_mut().is_some_and(|line| line.take(&item, within_mm)) {
            return;
        }
        items.extend(self.waiting.take().map(|line| line.item()));
        let longest = if path.merges_all { f64::INFINITY } else { SHORT_MM };
        self.waiting = Merged::new(rest, &item, longest).filter(|_| within_mm > 0.0);
        if self.waiting.is_none() {
            items.push_back(item);
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
    /// Longest line that is merged, mm.
    longest: f64,
}

impl Merged {
    /// A first line, if it is one that others may follow.
    fn new(from: PerAxis<Position>, item: &Item, longest: f64) -> Option<Merged> {
        let Code::Line { target, feed } = item.code else { return None };
        let turns = |axis: Axis| axis.is_rotary() && from[axis.index()] != target[axis.index()];
        let square = (0..AXES).map(|axis| target[axis].mm_from(from[axis])).map(|way| way * way).sum::<f64>();
        let mergeable = feed != Feed::Rapid && !Axis::ALL.into_iter().any(turns) && square.sqrt() <= longest;
        mergeable.then_some(Merged { from, over: Vec::new(), to: target, feed, line: item.line, longest })
    }

    /// Takes a line in, if all of them stay within `within_mm` of one; false if it stays out.
    fn take(&mut self, item: &Item, within_mm: f64) -> bool {
        let Some(next) = Merged::new(self.to, item, self.longest) else { return false };
        if next.feed != self.feed || self.over.len() + 2 > MOST || !self.leads_to(&next.to, within_mm) {
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

    /// Whether every end so far lies near the line to `end`, each further along than the one before.
    fn leads_to(&self, end: &PerAxis<Position>, within_mm: f64) -> bool {
        let seen = |point: &PerAxis<Position>| -> [f64; AXES] {
            std::array::from_fn(|axis| point[axis].mm_from(self.from[axis]))
        };
        let dot = |a: &[f64; AXES], b: &[f64; AXES]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let way = seen(end);
        let length = dot(&way, &way).sqrt();
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
