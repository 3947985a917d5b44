//! What is to come of a program. In: its machine code, how far a run has come. Out: where the block in hand
//! leads, the way that is still to be gone, seconds that are left. Positions in mm of the machine, X of a
//! lathe as a radius.

use ::panel::Point;
use machine::Machine;
use protocol::{Axis, ByHand, Code, Item, PerAxis, Position, units::AXES};

/// Items of machine code that are looked at; of what is behind them nothing is foretold.
const MOST_ITEMS: usize = 50_000;
/// Places of the way that are shown.
const MOST_PLACES: usize = 4_096;
/// Places of an arc, and of a pass.
const PLACES: u32 = 16;
/// A block that was done ahead of others lies so far before the one that the count shows at most.
const AROUND: usize = 32;
/// Places that are nearer than this are one, mm.
const SAME_MM: f64 = 1e-3;

/// An item of machine code.
#[derive(Clone, Copy, Debug)]
struct Stop {
    line: u32,
    /// Progress of the program when it is done.
    steps: u64,
    /// Time of the machine when it begins, and when it is done, s.
    begins_s: f64,
    time_s: f64,
    /// Where the axes are then, mm.
    at: PerAxis<f64>,
    /// The axis of which it is the reference run.
    references: Option<Axis>,
}

/// What is to come.
#[derive(Debug, Default)]
pub(crate) struct Plan {
    stops: Vec<Stop>,
    /// It is what somebody has given by hand.
    pub(super) by_hand: bool,
    /// There is more than was looked at.
    open: bool,
    /// How long the whole program takes, s.
    time_s: f64,
    /// Progress at the last look, and since when it has been that, s.
    since: (u64, f64),
}

impl Plan {
    /// Looks at the machine code of a program that takes so long. `drawn` moves a place of the machine to
    /// where it is drawn, in a pass, else behind so many steps of progress.
    pub(crate) fn of(
        items: impl Iterator<Item = Item>,
        machine: &Machine,
        time_s: f64,
        drawn: impl Fn(&mut PerAxis<f64>, Option<u32>, u64),
    ) -> (Plan, Vec<Point>) {
        let axes: Vec<Axis> = machine.axes().map(|(axis, _)| axis).collect();
        let (mut plan, mut at, mut steps) = (Plan { time_s, ..Plan::default() }, machine.home(), 0);
        let here = |at: &PerAxis<Position>, pass, steps| {
            let mut place = at.map(Position::mm);
            drawn(&mut place, pass, steps);
            place
        };
        let mut ends = here(&at, None, 0);
        let (mut way, mut left) = (vec![point(&axes, &ends, 0)], MOST_ITEMS);
        let items = items.take_while(|_| {
            left = left.saturating_sub(1);
            left > 0
        });
        interpreter::with_times(items, machine, |item, [begins_s, time_s]| {
            let pass = if let Code::Pass(pass) = &item.code { Some(pass.pass) } else { None };
            // Another tool begins where it is drawn.
            let begins = here(&at, pass, steps);
            let mut jumps = (0..AXES).any(|axis| (begins[axis] - ends[axis]).abs() > SAME_MM);
            places(item, &at, |place, kind| {
                if std::mem::take(&mut jumps) {
                    way.push(point(&axes, &begins, 0));
                }
                ends = *place;
                drawn(&mut ends, pass, steps);
                way.push(point(&axes, &ends, kind));
            });
            at = end(item, &at);
            steps += item.steps();
            plan.by_hand |= plan.stops.is_empty() && matches!(item.code, Code::ByHand(_));
            let references = match item.code {
                Code::ByHand(ByHand::References(axis)) => Some(axis),
                _ => None,
            };
            let at = at.map(Position::mm);
            plan.stops.push(Stop { line: item.line, steps, begins_s, time_s, at, references });
        });
        plan.open = left == 0;
        spread(&mut plan.stops, if plan.open { None } else { Some(time_s) });
        while way.len() > MOST_PLACES {
            let mut keep = false;
            way.retain(|_| {
                keep = !keep;
                keep
            });
        }
        (plan, way)
    }

    /// The block in hand, if it is known: its place among the stops.
    fn in_hand(&self, done: u64, line: u32) -> Option<usize> {
        let next = self.stops.partition_point(|stop| stop.steps <= done);
        let near = self.stops.get(next.saturating_sub(AROUND)..(next + 1).min(self.stops.len()))?;
        let first = next.saturating_sub(AROUND);
        near.iter().rposition(|stop| stop.line == line).map(|place| first + place)
    }

    /// Steps of progress that are over when the block in hand begins.
    pub(crate) fn before(&self, done: u64, line: u32) -> u64 {
        match self.in_hand(done, line) {
            Some(0) => 0,
            Some(place) => self.stops[place - 1].steps,
            None => done.saturating_sub(1),
        }
    }

    /// Where the block in hand leads each axis, mm.
    pub(crate) fn target_mm(&self, done: u64, line: u32) -> Option<PerAxis<f64>> {
        self.in_hand(done, line).map(|place| self.stops[place].at)
    }

    /// The axis of which the block in hand is the reference run.
    pub(super) fn references(&self, done: u64) -> Option<Axis> {
        let next = self.stops.partition_point(|stop| stop.steps <= done);
        self.stops.get(next).and_then(|stop| stop.references)
    }

    /// Something goes on that is no part of the program: its time begins anew.
    pub(super) fn waits(&mut self, done: u64, now_s: f64) {
        self.since = (done, now_s);
    }

    /// How long the rest takes at 100 %, s: what is foretold behind the last block that is done, less what
    /// has gone by since, as long as the block in hand is not longer.
    pub(crate) fn left_s(&mut self, done: u64, now_s: f64) -> Option<f64> {
        if self.since.0 != done {
            self.since = (done, now_s);
        }
        let next = self.stops.partition_point(|stop| stop.steps <= done);
        if self.open && next == self.stops.len() {
            return None;
        }
        let before = if next == 0 { 0.0 } else { self.stops[next - 1].time_s };
        let after = self.stops.get(next).map_or(self.time_s, |stop| stop.time_s).max(before);
        let there = (before + now_s - self.since.1).min(after);
        Some((self.time_s - there).max(0.0))
    }
}

/// Items of one chain have one time, that of its beginning: they share what the chain takes.
fn spread(stops: &mut [Stop], end_s: Option<f64>) {
    let mut first = 0;
    while first < stops.len() {
        let from_s = stops[first].begins_s;
        let waits = |stop: &&Stop| stop.begins_s == from_s && stop.time_s == from_s;
        let many = stops[first..].iter().take_while(waits).count();
        let to_s = stops.get(first + many).map(|stop| stop.begins_s).or(end_s).unwrap_or(from_s);
        for (place, stop) in (1..).zip(&mut stops[first..first + many]) {
            stop.time_s = from_s + (to_s - from_s) * f64::from(place) / many as f64;
        }
        first += many.max(1);
    }
}

/// Where an item that begins at `at` ends.
pub(super) fn end(item: &Item, at: &PerAxis<Position>) -> PerAxis<Position> {
    match &item.code {
        code if code.target().is_some() => code.target().copied().unwrap_or(*at),
        Code::Pass(pass) => std::array::from_fn(|axis| pass.axes[axis].end),
        Code::ByHand(ByHand::Begins { at, .. }) => *at,
        _ => *at,
    }
}

/// The places that it goes through, mm, and how: as in a [`Point`].
fn places(item: &Item, at: &PerAxis<Position>, mut go: impl FnMut(&PerAxis<f64>, u8)) {
    let share = |step: u32| f64::from(step) / f64::from(PLACES);
    match &item.code {
        Code::Line { target, feed } => {
            go(&target.map(Position::mm), u8::from(*feed != protocol::Feed::Rapid));
        }
        Code::Arc { .. } | Code::Curve { .. } => {
            let path = match &item.code {
                Code::Arc { arc, .. } => arc.path(at),
                Code::Curve { curve, .. } => curve.path(at),
                _ => return,
            };
            let Ok(path) = path else { return };
            for step in 1..=PLACES {
                let [gone, ..] = path.at(share(step) * path.length());
                go(&std::array::from_fn(|axis| at[axis].mm() + gone[axis]), 1);
            }
        }
        Code::Pass(pass) => {
            for step in 0..=PLACES {
                let angle_deg = share(step) * pass.done_deg();
                let law = |axis: Axis| pass.axis(axis).start.mm() + pass.law(axis).at(angle_deg).s;
                let mut place = at.map(Position::mm);
                Axis::ALL.iter().for_each(|axis| place[axis.index()] = law(*axis));
                go(&place, 2);
            }
        }
        _ => {}
    }
}

fn point(axes: &[Axis], place: &PerAxis<f64>, kind: u8) -> Point {
    (axes.iter().map(|axis| place[axis.index()] as f32).collect(), kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program that the plan is asked about: rapid, two feeds of one chain, a dwell, a rapid.
    fn plan() -> (Plan, Vec<Point>, f64) {
        let machine = Machine::default();
        let text = "G21 G90 G94\nG0 X20 Z2\nG1 Z-10 F600\nX30\nG4 P2\nG0 Z5\nM2\n";
        let check = interpreter::check("plan.ngc", text, &machine);
        let (plan, way) = Plan::of(check.items.iter().copied(), &machine, check.time_s, |_, _, _| {});
        (plan, way, check.time_s)
    }

    #[test]
    fn a_block_in_hand_leads_where_the_program_says() {
        let (plan, way, _) = plan();
        let x_z = |line: u32, done: u64| {
            let at = plan.target_mm(done, line)?;
            Some([at[Axis::X.index()], at[Axis::Z.index()]])
        };
        let of = |line: u32| plan.stops.iter().find(|stop| stop.line == line).map(|stop| stop.steps - 1);
        for (line, at) in [(2, [20.0, 2.0]), (3, [20.0, -10.0]), (4, [30.0, -10.0]), (6, [30.0, 5.0])] {
            let told = x_z(line, of(line).expect("there is such a line"));
            assert_eq!(told, Some(at), "line {line}");
        }
        // The way has every corner, with how it is gone to.
        let kinds: Vec<_> = way.iter().map(|(_, kind)| *kind).collect();
        assert_eq!(kinds, [0, 0, 1, 1, 0]);
        assert_eq!(x_z(77, 3), None, "a line that is not near");
    }

    #[test]
    fn the_way_of_another_tool_begins_where_that_is_drawn() {
        let machine = Machine::default();
        let check =
            interpreter::check("plan.ngc", "G21 G90 G94\nG0 X20 Z2\nG1 Z-10 F600\nG0 X30\nM2\n", &machine);
        let last = check.items.iter().take_while(|item| item.line < 4).map(Item::steps).sum();
        let drawn = |place: &mut PerAxis<f64>, _, steps: u64| {
            if steps >= last {
                place[Axis::X.index()] += 5.0;
            }
        };
        let (_, way) = Plan::of(check.items.iter().copied(), &machine, check.time_s, drawn);
        let x: Vec<_> = way.iter().map(|(at, kind)| (at[0], *kind)).collect();
        assert!(x.ends_with(&[(20.0, 1), (25.0, 0), (35.0, 0)]), "{x:?}");
    }

    /// 12 mm and 10 mm at 10 mm/s and a dwell of 2 s: what is left goes down, by what each takes.
    #[test]
    fn what_is_left_goes_down_to_nothing() {
        let (mut plan, _, time_s) = plan();
        let dwell = plan.stops.iter().find(|stop| stop.line == 5).expect("the dwell").steps;
        assert_eq!(plan.left_s(0, 0.0), Some(time_s));
        let before = plan.left_s(dwell - 1, 7.0).expect("it is known");
        let half = plan.left_s(dwell - 1, 8.0).expect("it is known");
        let longer = plan.left_s(dwell - 1, 20.0).expect("it is known");
        assert!((before - half - 1.0).abs() < 1e-9, "a second has gone by: {before}, {half}");
        assert!((before - longer - 2.0).abs() < 1e-9, "no more than the dwell takes: {before}, {longer}");
        assert!(time_s - before > 2.2 && before < time_s, "{before} of {time_s}");
        let all = plan.stops.last().expect("there are stops").steps;
        assert!(plan.left_s(all, 30.0).is_some_and(|left| left < 1e-9));
    }
}
