//! What earlier passes left in the part: the deepest groove of each start, over Z. In: how far the tool
//! reaches into the material, mm, while it passes. Out: how far an earlier pass reached there.
//!
//! *Reach* is the way of X into the material with the cone taken off: into (x − slope z). It is kept at nodes
//! at most 0.02 mm apart over the travel of Z, and taken as a straight line between them. Where a pass ends
//! between two nodes, the one that it did not get to keeps the farthest reach beside it; from there the
//! groove fades to the crest. What the pass in hand leaves counts only when it is over: a tool does not find
//! its own groove. Everything is allocated at the start.

use machine::Machine;
use protocol::{Axis, Groove};

/// Grooves that are kept; one more is cut as if it were the first pass of each.
pub(crate) const GROOVES: usize = 16;
/// Widest distance of the nodes, mm, and most of them; a longer travel has them further apart.
const WIDEST_MM: f64 = 0.02;
const MOST_NODES: f64 = 50_000.0;
/// Leads and slopes closer than this are the same.
const SAME: f64 = 1e-9;
/// Where nothing was cut.
const UNCUT: f64 = f64::NEG_INFINITY;

/// The memory of the part.
#[derive(Clone, Debug)]
pub(crate) struct Grooves {
    low_mm: f64,
    step_mm: f64,
    nodes: usize,
    /// Whose reaches are kept, in the order of their first pass.
    known: [Option<Groove>; GROOVES],
    /// Reach of each of them in turn at its nodes; there is room for all.
    left: Vec<f64>,
    /// Which groove is being cut, if it is one that is kept.
    in_hand: Option<usize>,
    /// What the pass in hand reaches at each node, and at most in the intervals beside it.
    cut: Vec<f64>,
    beside: Vec<f64>,
    /// Where the tool was in the cycle before: z and reach, mm.
    before: Option<(f64, f64)>,
}

impl Grooves {
    /// The part before its first pass, as long as Z travels.
    pub(crate) fn new(machine: &Machine) -> Grooves {
        let [low_mm, high_mm] = machine.axis.get(&Axis::Z).map_or([0.0, 1.0], |z| z.travel_mm);
        let intervals = ((high_mm - low_mm) / WIDEST_MM).ceil().clamp(1.0, MOST_NODES);
        let nodes = intervals as usize + 1;
        Grooves {
            low_mm,
            step_mm: (high_mm - low_mm) / intervals,
            nodes,
            known: [None; GROOVES],
            left: Vec::with_capacity(nodes * GROOVES),
            in_hand: None,
            cut: vec![UNCUT; nodes],
            beside: vec![UNCUT; nodes],
            before: None,
        }
    }

    /// A pass begins; what it leaves is that of `groove`.
    pub(crate) fn begin(&mut self, groove: &Groove) {
        self.end();
        let same = |known: &Groove| {
            (known.start, known.into) == (groove.start, groove.into)
                && (known.lead_mm - groove.lead_mm).abs() < SAME
                && (known.slope - groove.slope).abs() < SAME
        };
        self.in_hand = self.known.iter().position(|known| known.as_ref().is_none_or(same));
        if let Some(known) = self.in_hand.and_then(|index| self.known.get_mut(index)) {
            known.get_or_insert(*groove);
        }
        let known = self.known.iter().flatten().count();
        self.left.resize(known * self.nodes, UNCUT);
    }

    /// The pass in hand is over: its groove is there from now on.
    pub(crate) fn end(&mut self) {
        let index = self.in_hand.take();
        if let Some(left) = index.and_then(|index| self.left.chunks_exact_mut(self.nodes).nth(index)) {
            for ((left, cut), beside) in left.iter_mut().zip(&self.cut).zip(&self.beside) {
                *left = left.max(if *cut > UNCUT { *cut } else { *beside });
            }
        }
        self.cut.fill(UNCUT);
        self.beside.fill(UNCUT);
        self.before = None;
    }

    /// How far earlier passes reached at a place, at least to the crest; both as reaches, mm.
    pub(crate) fn earlier_mm(&self, z_mm: f64, crest_mm: f64) -> f64 {
        let left = self.in_hand.and_then(|index| self.left.chunks_exact(self.nodes).nth(index));
        let Some(left) = left else { return crest_mm };
        let (node, share) = self.interval(z_mm);
        let at = |node: usize| left.get(node).map_or(crest_mm, |reach| reach.max(crest_mm));
        at(node) + (at(node + 1) - at(node)) * share
    }

    /// The node below a place, and how much of the way to the next one it lies above it.
    fn interval(&self, z_mm: f64) -> (usize, f64) {
        let place = ((z_mm - self.low_mm) / self.step_mm).clamp(0.0, (self.nodes - 1) as f64);
        let node = (place as usize).min(self.nodes - 2);
        (node, place - node as f64)
    }

    /// The tool passes by with this reach, both in mm.
    pub(crate) fn pass_by(&mut self, z_mm: f64, reach_mm: f64) {
        let (z_before, reach_before) = self.before.replace((z_mm, reach_mm)).unwrap_or((z_mm, reach_mm));
        let (low, high) = (z_before.min(z_mm), z_before.max(z_mm));
        let (below, _) = self.interval(z_mm);
        self.beside.iter_mut().skip(below).take(2).for_each(|beside| *beside = beside.max(reach_mm));
        let node_of = |mm: f64| ((mm - self.low_mm) / self.step_mm).ceil().max(0.0) as usize;
        // The nodes in [low, high).
        for node in node_of(low)..node_of(high).min(self.nodes) {
            let z = self.low_mm + node as f64 * self.step_mm;
            let share = ((z - z_before) / (z_mm - z_before)).clamp(0.0, 1.0);
            if let Some(cut) = self.cut.get_mut(node) {
                *cut = cut.max(reach_before + (reach_mm - reach_before) * share);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GROOVE: Groove =
        Groove { start: 0, reserved: 0, lead_mm: -2.0, crest_mm: 10.0, slope: 0.0, into: -1.0 };

    /// Goes from z to z in steps of 0.01 mm with a reach that depends on z.
    fn go(grooves: &mut Grooves, groove: &Groove, from: f64, to: f64, reach: impl Fn(f64) -> f64) {
        grooves.begin(groove);
        let steps = ((to - from).abs() / 0.01).round() as i32;
        for step in 0..=steps {
            let z = from + (to - from) * f64::from(step) / f64::from(steps);
            grooves.pass_by(z, reach(z));
        }
        grooves.end();
    }

    #[test]
    fn the_deepest_of_all_passes_is_left_and_lines_come_back_exactly() {
        let mut grooves = Grooves::new(&Machine::plain());
        go(&mut grooves, &GROOVE, 5.0, -20.0, |z| -9.0 + 0.1 * z);
        go(&mut grooves, &GROOVE, 5.0, -20.0, |_| -10.0);
        grooves.begin(&GROOVE);
        for (z, reach) in [(0.0, -9.0), (-3.123, -9.3123), (-15.0, -10.0), (-4.9, -9.49)] {
            let earlier = grooves.earlier_mm(z, -99.0);
            assert!((earlier - reach).abs() < 1e-9, "{earlier} at {z}");
        }
        assert_eq!([grooves.earlier_mm(6.0, -99.0), grooves.earlier_mm(-21.0, -99.0)], [-99.0; 2]);
        assert_eq!(grooves.earlier_mm(-3.0, -9.1), -9.1, "above the crest there is nothing to cut");
    }

    #[test]
    fn a_tool_does_not_find_its_own_groove() {
        let mut grooves = Grooves::new(&Machine::plain());
        grooves.begin(&GROOVE);
        grooves.pass_by(1.0, -9.0);
        grooves.pass_by(-1.0, -9.0);
        assert_eq!(grooves.earlier_mm(0.0, -10.0), -10.0);
        grooves.end();
        grooves.begin(&GROOVE);
        assert_eq!(grooves.earlier_mm(0.0, -10.0), -9.0);
    }

    #[test]
    fn a_groove_that_ends_between_two_nodes_is_known_to_its_end() {
        let mut grooves = Grooves::new(&Machine::plain());
        // To -10.01 and no further; the nodes beside it lie at -10 and -10.02.
        go(&mut grooves, &GROOVE, 0.0, -10.01, |_| -9.0);
        grooves.begin(&GROOVE);
        for (z, reach) in [(-10.0, -9.0), (-10.01, -9.0), (-10.019, -9.0), (-10.03, -9.5), (-10.05, -10.0)] {
            let earlier = grooves.earlier_mm(z, -10.0);
            assert!((earlier - reach).abs() < 1e-9, "{earlier} at {z}");
        }
    }

    #[test]
    fn each_start_has_its_groove_until_there_are_too_many() {
        let mut grooves = Grooves::new(&Machine::plain());
        for start in 0..20 {
            let groove = Groove { start, ..GROOVE };
            go(&mut grooves, &groove, 2.0, -2.0, |_| -9.0 + 0.01 * f64::from(start));
        }
        for start in 0..20 {
            grooves.begin(&Groove { start, crest_mm: 11.0, ..GROOVE });
            let expected = if start < 16 { -9.0 + 0.01 * f64::from(start) } else { -11.0 };
            assert_eq!(grooves.earlier_mm(0.0, -11.0), expected, "start {start}");
        }
        for other in [Groove { lead_mm: 2.0, ..GROOVE }, Groove { into: 1.0, ..GROOVE }] {
            grooves.begin(&other);
            assert_eq!(grooves.earlier_mm(0.0, -11.0), -11.0, "another thread, but no room for it");
        }
    }

    #[test]
    fn places_off_the_travel_and_numbers_that_are_none_do_no_harm() {
        let mut grooves = Grooves::new(&Machine::plain());
        for z in [1e9, -1e9, f64::NAN, f64::INFINITY, 0.0] {
            go(&mut grooves, &GROOVE, 0.0, -1.0, |_| f64::NAN);
            grooves.begin(&GROOVE);
            grooves.pass_by(z, -9.0);
            grooves.pass_by(0.0, -9.0);
            assert!(!grooves.earlier_mm(0.0, -10.0).is_nan());
        }
    }
}
