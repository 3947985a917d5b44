//! How a tool of a lathe gets to a place of its program. In: the moves of the program before it. Out: a way
//! over nothing but what the program itself has led that tool over.
//!
//! | what it goes over | how |
//! |---|---|
//! | a rapid, either way, from any place on it to any other | rapid |
//! | a feed, an arc, a piece of a curve, either way | at 400 mm/min: what was to be cut there has been cut |
//! | from the start of a thread to where its tool has come out | straight out, along the thread, in: rapid |
//!
//! Of the ways that there are it is the fastest (Dijkstra 1959), a millimetre by feed counting as many by
//! rapid.

use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use machine::Machine;
use protocol::{Arc, Axis, Code, Curve, Feed, Item, PerAxis, Position, ThreadPass};
use route::{
    approach::{BACK, Way, places},
    in_force::{LINEAR, apart_mm},
};

use super::NoEntry;

/// So many moves of a tool are looked at.
const MOST: usize = 4096;
/// A place lies on a way within this, mm.
const ON_MM: f64 = 1e-6;
/// What a millimetre by feed counts as, mm by rapid.
const FEED_COSTS: f64 = 20.0;

/// Something that a tool was led over.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    from: PerAxis<Position>,
    to: PerAxis<Position>,
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Straight(Feed),
    Arc(Arc),
    Curve(Curve),
}

/// Where a program leads the tool in place.
#[derive(Clone, Debug)]
pub(super) struct Ways {
    home: PerAxis<Position>,
    /// Where the tool was put in.
    put_in: PerAxis<Position>,
    stretches: Vec<Stretch>,
    /// Ends of those that are known, with whether they are rapids.
    known: BTreeSet<(PerAxis<Position>, PerAxis<Position>, bool)>,
    too_many: bool,
}

impl Ways {
    /// A tool that is in place from the beginning.
    pub(super) fn new(machine: &Machine) -> Ways {
        let home = machine.home();
        Ways { home, put_in: home, stretches: Vec::new(), known: BTreeSet::new(), too_many: false }
    }

    /// Another tool is put in here.
    pub(super) fn puts_in(&mut self, at: PerAxis<Position>) {
        *self = Ways { put_in: at, stretches: Vec::new(), known: BTreeSet::new(), too_many: false, ..*self };
    }

    /// The program leads the tool along an item, from a place.
    pub(super) fn take(&mut self, item: &Item, from: PerAxis<Position>) {
        match item.code {
            Code::Line { target, feed } => {
                let feed = if feed == Feed::Rapid { feed } else { BACK };
                self.leads(from, target, Shape::Straight(feed));
            }
            Code::Arc { arc, .. } => self.leads(from, arc.target, Shape::Arc(arc)),
            Code::Curve { curve, .. } => self.leads(from, curve.target, Shape::Curve(curve)),
            Code::Pass(pass) if !pass.returns() => self.passes(&pass),
            _ => {}
        }
    }

    fn leads(&mut self, from: PerAxis<Position>, to: PerAxis<Position>, shape: Shape) {
        let rapid = matches!(shape, Shape::Straight(Feed::Rapid));
        if from == to && matches!(shape, Shape::Straight(_)) || !self.known.insert((from, to, rapid)) {
            return;
        }
        self.too_many |= self.stretches.len() == MOST;
        if !self.too_many {
            self.stretches.push(Stretch { from, to, shape });
        }
    }

    /// From the start of a pass to where its tool is clear, beside the thread.
    fn passes(&mut self, pass: &ThreadPass) {
        let across = pass.out.axis as usize;
        let [start, end] = [pass.axes.map(|law| law.start), pass.axes.map(|law| law.end)];
        let out = if pass.out.clear >= pass.out.free { 1.0 } else { -1.0 };
        let farther = if out * end[across].mm_from(start[across]) > 0.0 { end } else { start };
        let [mut before, mut behind] = [start, end];
        (before[across], behind[across]) = (farther[across], farther[across]);
        for (from, to) in [(start, before), (before, behind), (behind, end)] {
            self.leads(from, to, Shape::Straight(Feed::Rapid));
        }
    }

    /// The moves from home to a place, for the program at a line.
    ///
    /// # Errors
    /// There are none that are known to be free.
    pub(super) fn to(&self, place: PerAxis<Position>, line: u32) -> Result<Vec<Item>, NoEntry> {
        let mut way = Way { items: Vec::new(), at: self.home, line };
        self.to_where_it_was_put_in(&mut way);
        if place == self.put_in {
            return Ok(way.items);
        }
        if self.too_many {
            return Err(NoEntry::TooLong { line, most: MOST });
        }
        let net = Net::new(&self.stretches, self.put_in);
        let legs = net.fastest(place).ok_or(NoEntry::NoWay { line })?;
        legs.into_iter().for_each(|leg| leg.go(&mut way));
        way.items = straightened(self.home, way.items);
        Ok(way.items)
    }

    /// A tool is changed where there is room for it: in from outside, along X last.
    fn to_where_it_was_put_in(&self, way: &mut Way) {
        const X: usize = Axis::X as usize;
        let farther =
            if self.home[X].mm().abs() >= self.put_in[X].mm().abs() { self.home } else { self.put_in };
        let [mut out, mut beside] = [self.home, self.put_in];
        (out[X], beside[X]) = (farther[X], farther[X]);
        [out, beside, self.put_in].into_iter().for_each(|place| way.go(place, Feed::Rapid));
    }
}

/// A stretch, or a part of it, one way.
#[derive(Clone, Copy, Debug)]
struct Leg {
    from: PerAxis<Position>,
    to: PerAxis<Position>,
    shape: Shape,
    /// As the program went.
    forward: bool,
}

impl Leg {
    fn go(&self, way: &mut Way) {
        match &self.shape {
            Shape::Straight(feed) => way.go(self.to, *feed),
            Shape::Arc(arc) if self.forward => {
                way.items.push(Item { line: way.line, code: Code::Arc { arc: *arc, feed: BACK } });
                way.at = self.to;
            }
            Shape::Arc(arc) => way.back_on(arc, &self.to),
            Shape::Curve(curve) => {
                let begins = if self.forward { self.from } else { self.to };
                let mut over = places(&begins, curve);
                if !self.forward {
                    over.reverse();
                }
                over.into_iter().for_each(|place| way.go(place, BACK));
                way.go(self.to, BACK);
            }
        }
    }

    fn cost(&self) -> f64 {
        match &self.shape {
            Shape::Straight(Feed::Rapid) => apart_mm(&self.from, &self.to),
            Shape::Straight(_) => FEED_COSTS * apart_mm(&self.from, &self.to),
            // Longer than the chord; never shorter than it costs.
            Shape::Arc(_) => FEED_COSTS * 2.0 * apart_mm(&self.from, &self.to).max(1.0),
            Shape::Curve(curve) => FEED_COSTS * curve.length_mm,
        }
    }
}

/// Places, and legs between them.
struct Net {
    places: Vec<PerAxis<Position>>,
    numbers: BTreeMap<PerAxis<Position>, usize>,
    /// From each place: where to, and how.
    legs: Vec<Vec<(usize, Leg)>>,
}

impl Net {
    /// Number 0 is where the way begins.
    fn new(stretches: &[Stretch], begins: PerAxis<Position>) -> Net {
        let mut net = Net { places: Vec::new(), numbers: BTreeMap::new(), legs: Vec::new() };
        net.number(begins);
        for stretch in stretches {
            net.number(stretch.from);
            net.number(stretch.to);
        }
        for stretch in stretches {
            let on = match stretch.shape {
                Shape::Straight(_) => net.on(stretch),
                _ => vec![net.number(stretch.from), net.number(stretch.to)],
            };
            for pair in on.windows(2) {
                let leg = |from: usize, to: usize, forward| {
                    let (from, to) = (net.places[from], net.places[to]);
                    Leg { from, to, shape: stretch.shape, forward }
                };
                let (there, back) = (leg(pair[0], pair[1], true), leg(pair[1], pair[0], false));
                net.legs[pair[0]].push((pair[1], there));
                net.legs[pair[1]].push((pair[0], back));
            }
        }
        net
    }

    fn number(&mut self, place: PerAxis<Position>) -> usize {
        let next = self.places.len();
        let number = *self.numbers.entry(place).or_insert(next);
        if number == next {
            self.places.push(place);
            self.legs.push(Vec::new());
        }
        number
    }

    /// The places on a straight stretch, in the order in which it leads over them.
    fn on(&self, stretch: &Stretch) -> Vec<usize> {
        let seen = |place: &PerAxis<Position>| {
            LINEAR.map(|axis| place[axis.index()].mm_from(stretch.from[axis.index()]))
        };
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let to = seen(&stretch.to);
        let length = libm::sqrt(dot(to, to));
        let turns = |place: &PerAxis<Position>, other: &PerAxis<Position>| {
            Axis::ALL.into_iter().any(|axis| axis.is_rotary() && place[axis.index()] != other[axis.index()])
        };
        let turning = turns(&stretch.from, &stretch.to);
        let along = |(number, place): (usize, &PerAxis<Position>)| {
            if *place == stretch.from || *place == stretch.to {
                return Some((if *place == stretch.from { 0.0 } else { length }, number));
            }
            let place_mm = seen(place);
            let at = dot(place_mm, to) / length;
            let off = std::array::from_fn(|i| place_mm[i] - at * to[i] / length);
            let on = (0.0..=length).contains(&at) && libm::sqrt(dot(off, off)) < ON_MM;
            (on && !turning && !turns(place, &stretch.from)).then_some((at, number))
        };
        let mut on: Vec<_> = self.places.iter().enumerate().filter_map(along).collect();
        on.sort_by(|one, other| one.0.total_cmp(&other.0));
        on.into_iter().map(|(_, number)| number).collect()
    }

    /// The legs of the fastest way from place 0.
    fn fastest(&self, place: PerAxis<Position>) -> Option<Vec<Leg>> {
        let goal = *self.numbers.get(&place)?;
        let mut costs = vec![f64::INFINITY; self.places.len()];
        let mut by: Vec<Option<(usize, Leg)>> = vec![None; self.places.len()];
        // Costs are positive, so their bits are in their order.
        let mut next = BinaryHeap::from([std::cmp::Reverse((0.0_f64.to_bits(), 0))]);
        costs[0] = 0.0;
        while let Some(std::cmp::Reverse((bits, here))) = next.pop() {
            let cost = f64::from_bits(bits);
            if cost > costs[here] {
                continue;
            }
            if here == goal {
                break;
            }
            for (to, leg) in &self.legs[here] {
                let cost = cost + leg.cost();
                if cost < costs[*to] {
                    (costs[*to], by[*to]) = (cost, Some((here, *leg)));
                    next.push(std::cmp::Reverse((cost.to_bits(), *to)));
                }
            }
        }
        let (mut legs, mut here) = (Vec::new(), goal);
        while let Some((from, leg)) = by[here] {
            legs.push(leg);
            here = from;
        }
        legs.reverse();
        (here == 0).then_some(legs)
    }
}

/// Moves that go on in one line become one.
fn straightened(mut from: PerAxis<Position>, items: Vec<Item>) -> Vec<Item> {
    let mut straight: Vec<Item> = Vec::new();
    let mut begins = from;
    for item in items {
        let to = item.code.target().copied().unwrap_or(from);
        let joined = straight.last_mut().filter(|last| goes_on(&begins, last, &item));
        match joined {
            Some(last) => *last = item,
            None => {
                begins = from;
                straight.push(item);
            }
        }
        from = to;
    }
    straight
}

/// Whether a line goes on in the direction of the one before, which comes from `begins`.
fn goes_on(begins: &PerAxis<Position>, before: &Item, item: &Item) -> bool {
    let (Code::Line { target: middle, feed: was }, Code::Line { target, feed }) = (before.code, item.code)
    else {
        return false;
    };
    let [whole, first, second] =
        [apart_mm(begins, &target), apart_mm(begins, &middle), apart_mm(&middle, &target)];
    was == feed && first + second - whole < 1e-9
}
