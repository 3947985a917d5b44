//! Runs of lines become pieces of a smooth curve before they leave: the compressor on machine code. In:
//! items, with where the axes are before them and what the path may do. Out: items; lines that are smoothed
//! are pieces of a curve now.
//!
//! | smoothed | stays |
//! |---|---|
//! | four lines or more, end to end, at G64 | rapids, arcs, a line alone |
//! | X, Y, Z | lines on which another axis moves |
//! | with F in mm/min, or all in mm/rev | lines nearer to the end of travel than they may be left, and all with Q0 |
//!
//! A piece has the line of the program at its end. Where F changes, and where the operator is told something,
//! or zero of the program changes, a piece ends; one along lines of several feeds has the lowest.

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
    /// Marks whose place in the items is known.
    met: Vec<Met>,
}

/// What is to be known of its place: a message, a note of the zero, each by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    Message(usize),
    Zero(usize),
}

/// A mark, and how many items there are before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Met {
    pub(crate) mark: Mark,
    pub(crate) items: usize,
}

/// A line that waits.
#[derive(Clone, Debug)]
struct Waiting {
    item: Item,
    number: u64,
    /// Something is told before it, or zero of the program changes.
    marked: bool,
}

#[derive(Clone, Debug)]
struct Run {
    compressor: Compressor<Waiting>,
    door: Door,
    mode: PathMode,
    /// Where the axes are at the end of what waits.
    end: PerAxis<Position>,
    feed: Feed,
    /// Lines that were added.
    lines: u64,
}

/// Through which what a run has become leaves.
#[derive(Clone, Debug)]
struct Door {
    /// Where the run begins. Curves are fitted from there, so that the same lines elsewhere become the same
    /// curve.
    origin: PerAxis<Position>,
    /// Where the axes are at the end of what has left.
    left: PerAxis<Position>,
    /// Marks before lines that wait, with the numbers of these.
    marks: VecDeque<(u64, Mark)>,
}

impl Smoother {
    /// For a machine.
    pub(crate) fn new(machine: &Machine) -> Smoother {
        let travel = LED.map(|axis| {
            let config = machine.axes().find(|(other, _)| *other == axis);
            config.map_or([0.0; 2], |(_, config)| config.travel_mm)
        });
        Smoother { travel, exact_mm: machine.path.exact_mm, run: None, met: Vec::new() }
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
        let alike = |run: &Run| core::mem::discriminant(&run.feed) == core::mem::discriminant(&feed);
        let goes_on = self.run.as_ref().is_some_and(|run| run.mode == mode && run.end == rest && alike(run));
        if !goes_on {
            self.finish(items);
        }
        let run = self.run.get_or_insert_with(|| Run::new(rest, mode, feed));
        let Some(target) = item.code.target().copied() else { return };
        run.end = target;
        let Run { compressor, door, lines, .. } = run;
        let marked = door.marks.back().is_some_and(|(number, _)| number == lines);
        let line = Waiting { item, number: *lines, marked };
        *lines += 1;
        let place = seen(&target, &door.origin);
        compressor.add(place, line, &mut |course| door.leave(&course, &mut self.met, items));
    }

    /// A mark before the next line, if lines wait: else its place is known.
    pub(crate) fn mark(&mut self, mark: Mark) {
        if let Some(run) = &mut self.run {
            run.door.marks.push_back((run.lines, mark));
        }
    }

    /// Marks whose place has become known.
    pub(crate) fn met(&mut self) -> impl Iterator<Item = Met> + '_ {
        self.met.drain(..)
    }

    /// What waits leaves.
    pub(crate) fn finish(&mut self, items: &mut VecDeque<Item>) {
        if let Some(Run { mut compressor, mut door, .. }) = self.run.take() {
            compressor.finish(&mut |course| door.leave(&course, &mut self.met, items));
            self.met.extend(door.marks.iter().map(|(_, mark)| Met { mark: *mark, items: items.len() }));
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
        let apart = |a: &Waiting, b: &Waiting| b.marked || a.item.code.feed() != b.item.code.feed();
        let compressor = Compressor::new([0.0; 3], leeway, apart);
        let door = Door { origin: from, left: from, marks: VecDeque::new() };
        Run { compressor, door, mode, end: from, feed, lines: 0 }
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

impl Door {
    /// A line or a piece of a curve leaves as an item. Marks before it are met.
    fn leave(&mut self, course: &Course<'_, Waiting>, met: &mut Vec<Met>, items: &mut VecDeque<Item>) {
        let (item, number) = match course {
            Course::Line(line) => (line.item, line.number),
            Course::Bow { bow, over } => {
                let last = &over[over.len() - 1];
                let feeds = over.iter().filter_map(|line| line.item.code.feed());
                let feed = feeds.reduce(slower).unwrap_or_default();
                let code = Code::Curve { curve: curve(bow, &self.origin, &self.left), feed };
                (Item { line: last.item.line, code }, last.number)
            }
        };
        while let Some((_, mark)) = self.marks.pop_front_if(|(first, _)| *first <= number) {
            met.push(Met { mark, items: items.len() });
        }
        self.left = item.code.target().copied().unwrap_or(self.left);
        items.push_back(item);
    }
}

/// The lower of two feeds of a kind.
fn slower(a: Feed, b: Feed) -> Feed {
    match (a, b) {
        (Feed::PerMinute(x), Feed::PerMinute(y)) => Feed::PerMinute(x.min(y)),
        (Feed::PerRevolution(x), Feed::PerRevolution(y)) => Feed::PerRevolution(x.min(y)),
        _ => a,
    }
}

fn curve(bow: &Bow, origin: &PerAxis<Position>, left: &PerAxis<Position>) -> Curve {
    let [[from, start @ ..], [to, end @ ..]] = [bow.start, bow.end];
    let mut target = *left;
    for (axis, mm) in LED.into_iter().zip(to) {
        target[axis.index()] = origin[axis.index()].moved(mm);
    }
    Curve { target, way: core::array::from_fn(|i| to[i] - from[i]), start, end, length_mm: bow.length }
}
