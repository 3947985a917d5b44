//! The way of a tool to where a program begins in its middle. In: what is in force there, where the tool is.
//! Out: items that are executed before the rest of the program.

use protocol::{Arc, Axis, Code, Curve, Feed, Item, PathMode, PerAxis, Position, Set, ThreadPass};

use crate::in_force::{Modal, apart_mm};

/// Over what has been cut the tool goes at this feed, in mm/min.
pub const BACK: Feed = Feed::PerMinute(400.0);
/// So many lines stand for a piece of a curve.
const PLACES: u32 = 32;
/// An arc shorter than this is left on a line: its angle would not be known, mm.
const SHORT_MM: f64 = 0.1;
const Z: usize = Axis::Z as usize;

/// A way that is being found.
pub struct Way {
    /// Its moves so far.
    pub items: Vec<Item>,
    /// Where it has come to.
    pub at: PerAxis<Position>,
    /// The line of the program that its moves are of.
    pub line: u32,
}

impl Way {
    /// Straight to a place, unless it is there.
    pub fn go(&mut self, target: PerAxis<Position>, feed: Feed) {
        if target != self.at {
            self.items.push(Item { line: self.line, code: Code::Line { target, feed } });
            self.at = target;
        }
    }

    /// Straight out of the groove of a pass, along the thread, to a place.
    pub fn out_of(&mut self, pass: &ThreadPass, to: PerAxis<Position>) {
        let across = pass.out.axis as usize;
        let out = if pass.out.clear >= pass.out.free { 1.0 } else { -1.0 };
        if out * pass.out.clear.mm_from(self.at[across]) > 0.0 {
            let mut clear = self.at;
            clear[across] = pass.out.clear;
            self.go(clear, Feed::Rapid);
        }
        let mut before = to;
        before[across] = self.at[across];
        self.go(before, Feed::Rapid);
        self.go(to, Feed::Rapid);
    }

    /// Back on an arc to where it begins.
    pub fn back_on(&mut self, arc: &Arc, from: &PerAxis<Position>) {
        if apart_mm(&self.at, from) < SHORT_MM {
            return self.go(*from, BACK);
        }
        let arc = Arc { target: *from, turns: -arc.turns.signum(), ..*arc };
        self.items.push(Item { line: self.line, code: Code::Arc { arc, feed: BACK } });
        self.at = *from;
    }
}

/// Places on a piece of a curve, so near to each other that lines between them are the piece.
pub fn places(from: &PerAxis<Position>, curve: &Curve) -> Vec<PerAxis<Position>> {
    let Ok(path) = curve.path(from) else { return Vec::new() };
    let share = |step: u32| f64::from(step) / f64::from(PLACES);
    let place = |step: u32| {
        let [gone, ..] = path.at(share(step) * path.length());
        std::array::from_fn(|axis| from[axis].moved(gone[axis]))
    };
    (0..=PLACES).map(place).collect()
}

/// Straight up, over a place, down to it.
pub fn over(here: &PerAxis<Position>, top: Position, to: PerAxis<Position>, line: u32) -> Vec<Item> {
    let mut way = Way { items: Vec::new(), at: *here, line };
    let top = top.max(to[Z]);
    let [mut up, mut over] = [*here, to];
    (up[Z], over[Z]) = (top, top);
    way.go(up, Feed::Rapid);
    way.go(over, Feed::Rapid);
    way.go(to, BACK);
    way.items
}

/// Takes the move down to the part off the end of a way, if it has one.
pub fn down(way: &mut Vec<Item>) -> Option<Item> {
    way.pop_if(|item| matches!(item.code, Code::Line { feed: BACK, .. }))
}

/// What is executed before the rest of a program. A tool that is changed behind the way there `arrives` by
/// moves of its own. Spindle and coolant go on before what goes by feed: down to the part of a mill.
pub fn before(modal: &Modal, way: &[Item], arrives: &[Item], lifts: bool, line: u32) -> Vec<Item> {
    let item = |code| Item { line, code };
    let tool = || modal.tool.map(|number| item(Code::Tool { number }));
    let (mut way, mut arrives, mut lowers) = (way.to_vec(), arrives.to_vec(), None);
    let is_new = !arrives.is_empty();
    if lifts {
        lowers = down(if is_new { &mut arrives } else { &mut way });
    }
    let mut before = vec![item(Code::PathMode(PathMode::ExactStop))];
    // Until another tool is put in, the one that was is in place.
    before.extend(tool().filter(|_| !is_new));
    let output = |(number, set): &(u8, Set)| Code::Output { number: *number, set: *set, in_step: false };
    before.extend(modal.outputs.iter().map(output).map(item));
    before.extend(way);
    before.extend(tool().filter(|_| is_new));
    before.extend(arrives);
    before.extend(modal.spindle.into_iter().chain(modal.coolant).map(item));
    before.extend(lowers);
    before.push(item(Code::PathMode(modal.path)));
    before.extend(modal.variation.map(item));
    before.extend(modal.formulas.values().copied().map(item));
    before
}
