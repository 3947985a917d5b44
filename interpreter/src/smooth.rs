//! Runs of lines become pieces of a smooth curve before they leave: the compressor on machine code. In:
//! items, with where the axes are before them and what the path may do. Out: items; lines that are smoothed
//! are pieces of a curve now.
//!
//! | smoothed | stays |
//! |---|---|
//! | four lines or more, end to end, at G64 | rapids, arcs, a line alone |
//! | X, Y, Z | lines on which another axis moves |
//! | with one F | another F, which begins another run |
//! | | lines nearer to the end of travel than they may be left, and all with Q0 |
//!
//! A piece has the line of the program at its end.

use std::collections::VecDeque;

use machine::Machine;
use protocol::{Axis, Code, Curve, Feed, Item, PathMode, PerAxis, Position};
use shape::{Bow, Compressor, Course, Leeway};

/// Axes that a curve leads.
const LED: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// Lines wait here for those that follow.
#[derive(Clone, Debug)]
pub(crate) struct Smoother {
    /// Lowest and highest position of X, Y, Z, mm.
    travel: [[f64; 2]; 3],
    exact_mm: f64,
    run: Option<Run>,
}

#[derive(Clone, Debug)]
struct Run {
    compressor: Compressor<Item>,
    mode: PathMode,
    /// Where it begins. Curves are fitted from there, so that the same lines elsewhere become the same curve.
    origin: PerAxis<Position>,
    /// Where the axes are at the end of what has left, and of what waits.
    left: PerAxis<Position>,
    end: PerAxis<Position>,
    feed: Feed,
}

impl Smoother {
    /// For a machine.
    pub(crate) fn new(machine: &Machine) -> Smoother {
        let travel = LED.map(|axis| {
            let config = machine.axes().find(|(other, _)| *other == axis);
            config.map_or([0.0; 2], |(_, config)| config.travel_mm)
        });
        Smoother { travel, exact_mm: machine.path.exact_mm, run: None }
    }

    /// Takes the next item; `rest` is where the axes are before it. What cannot change any more goes to
    /// `items`.
    pub(crate) fn add(
        &mut self,
        item: Item,
        rest: PerAxis<Position>,
        mode: PathMode,
        items: &mut VecDeque<Item>,
    ) {
        let Some(feed) = self.smoothable(&item, &rest, mode) else {
            self.finish(items);
            items.push_back(item);
            return;
        };
        let goes_on =
            self.run.as_ref().is_some_and(|run| run.mode == mode && run.end == rest && run.feed == feed);
        if !goes_on {
            self.finish(items);
        }
        let run = self.run.get_or_insert_with(|| Run::new(rest, mode, feed));
        let Some(target) = item.code.target().copied() else { return };
        run.end = target;
        let Run { compressor, origin, left, .. } = run;
        let mut out = |course: Course<'_, Item>| items.push_back(leave(course, origin, left));
        compressor.add(seen(&target, origin), item, &mut out);
    }

    /// What waits leaves.
    pub(crate) fn finish(&mut self, items: &mut VecDeque<Item>) {
        if let Some(Run { mut compressor, origin, mut left, .. }) = self.run.take() {
            compressor.finish(&mut |course| items.push_back(leave(course, &origin, &mut left)));
        }
    }

    /// Its feed, if it is a line that may be left by the tolerance of the mode.
    fn smoothable(&self, item: &Item, rest: &PerAxis<Position>, mode: PathMode) -> Option<Feed> {
        let leeway = leeway(mode).filter(|leeway| leeway.corner > self.exact_mm)?;
        let Code::Line { target, feed } = &item.code else { return None };
        let stand = |axis: Axis| LED.contains(&axis) || target[axis.index()] == rest[axis.index()];
        let inside = |(mm, [low, high]): (&f64, &[f64; 2])| {
            (low + leeway.flat..=high - leeway.flat).contains(mm) || low == high
        };
        let free = [rest, target].iter().all(|place| led(place).iter().zip(&self.travel).all(inside));
        let moves = led(rest) != led(target);
        (*feed != Feed::Rapid && moves && free && Axis::ALL.into_iter().all(stand)).then_some(*feed)
    }
}

impl Run {
    fn new(from: PerAxis<Position>, mode: PathMode, feed: Feed) -> Run {
        let leeway = leeway(mode).unwrap_or(Leeway { corner: 0.0, flat: 0.0, tip: 0.0 });
        let compressor = Compressor::new([0.0; 3], leeway);
        Run { compressor, mode, origin: from, left: from, end: from, feed }
    }
}

/// What a mode leaves to the path; nothing where every line stays one.
fn leeway(mode: PathMode) -> Option<Leeway> {
    match mode {
        PathMode::Blend { tolerance_mm, merge_mm } if merge_mm > 0.0 => {
            let flat = tolerance_mm + merge_mm - mode.merges_within_mm();
            Some(Leeway { corner: tolerance_mm, flat, tip: merge_mm })
        }
        _ => None,
    }
}

fn led(place: &PerAxis<Position>) -> [f64; 3] {
    LED.map(|axis| place[axis.index()].mm())
}

/// X, Y, Z from the begin of a run, mm.
fn seen(place: &PerAxis<Position>, origin: &PerAxis<Position>) -> [f64; 3] {
    LED.map(|axis| place[axis.index()].mm_from(origin[axis.index()]))
}

/// The item of a line, or of a piece of a curve, of a run that begins at `origin`; the axes are at `left`.
fn leave(course: Course<'_, Item>, origin: &PerAxis<Position>, left: &mut PerAxis<Position>) -> Item {
    let item = match course {
        Course::Line(item) => *item,
        Course::Bow { bow, over } => {
            let last = over[over.len() - 1];
            let feed = last.code.feed().unwrap_or_default();
            Item { line: last.line, code: Code::Curve { curve: curve(&bow, origin, left), feed } }
        }
    };
    *left = item.code.target().copied().unwrap_or(*left);
    item
}

fn curve(bow: &Bow, origin: &PerAxis<Position>, left: &PerAxis<Position>) -> Curve {
    let [[from, start @ ..], [to, end @ ..]] = [bow.start, bow.end];
    let mut target = *left;
    for (axis, mm) in LED.into_iter().zip(to) {
        target[axis.index()] = origin[axis.index()].moved(mm);
    }
    Curve { target, way: core::array::from_fn(|i| to[i] - from[i]), start, end, length_mm: bow.length }
}
