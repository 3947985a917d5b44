//! A tool that was changed before a program is gone on with. In: a plan by the tool table of before, the
//! program by that table and by a new one. Out: the plan by the new one, or why there is none.
//!
//! The old tool goes out on the way on which it came in; where the program begins again the new one is put
//! in, and goes to where it has to be there. Lengths may differ, X and Z: then every move is the same one
//! elsewhere, so all that is known of the program stays true, and the thread lies where it lay. What changes
//! the moves themselves (a radius, an orientation) is refused.

use std::collections::BTreeSet;

use machine::Machine;
use protocol::{Axis, Code, Curve, Feed, Item, PerAxis, Position, ThreadPass};

use route::{approach::before, in_force::Modal};

use super::{Plan, Refusal, Stands, lifted::arrival};

const Y: usize = Axis::Y as usize;

/// A tool may be longer or shorter by so much, mm: further nobody knows what stands between the old and the
/// new one.
const MOST_MM: f64 = 5.0;
/// Numbers that came about by another sum are the same within so much, mm and degrees.
const SAME: f64 = 1e-5;
/// Derivatives of a curve that is fitted elsewhere are the same to this, relative.
const ALIKE: f64 = 1e-6;

/// How a tool differs from the one before: X (a radius) and Z of where the axes carry it, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Changed {
    /// The tool in place where the program begins again.
    pub by_mm: [f64; 2],
    /// The tool of the passes from there on.
    pub in_passes_mm: [f64; 2],
}

impl Plan {
    /// The same by another tool table: `was` is the program by the one of before, `is` by the new one. If
    /// nothing differs it stays as it is.
    ///
    /// # Errors
    /// [`Refusal`] names the line from which on the program is another one.
    pub fn retooled(
        self,
        machine: &Machine,
        was: impl Iterator<Item = Item>,
        is: impl Iterator<Item = Item>,
    ) -> Result<Plan, Refusal> {
        let mut both = Both::new(machine);
        let (mut was, mut is, mut begin) = (was.fuse(), is.fuse(), None);
        let mut passes: Option<[f64; 2]> = None;
        loop {
            if both.was.items == self.modal.items {
                begin = Some((both.is.clone(), both.apart_mm()));
            }
            let (was, is) = match (was.next(), is.next()) {
                (Some(was), Some(is)) => (was, is),
                (None, None) => break,
                (Some(Item { line, .. }), None) | (None, Some(Item { line, .. })) => {
                    return Err(Refusal::OtherPath { line });
                }
            };
            both.take(&was, &is)?;
            if let (Code::Pass(was), Code::Pass(is), true) = (was.code, is.code, begin.is_some()) {
                let by_mm = shift_mm(&was.axes.map(|law| law.start), &is.axes.map(|law| law.start));
                let differs = |other: [f64; 2]| (0..2).any(|at| (other[at] - by_mm[at]).abs() > SAME);
                if differs(*passes.get_or_insert(by_mm)) {
                    return Err(Refusal::TwoTools);
                }
            }
        }
        let Some((modal, by_mm)) = begin.filter(|_| both.differs) else { return Ok(self) };
        if by_mm.iter().any(|mm| mm.abs() > MOST_MM) {
            return Err(Refusal::AnotherTool { x_mm: by_mm[0], z_mm: by_mm[1] });
        }
        let in_passes_mm = passes.unwrap_or(by_mm);
        let target = modal.at;
        let line = self.line;
        if (self.modal.at[Y].mm_from(target[Y])).abs() > SAME {
            return Err(Refusal::OtherPath { line });
        }
        let mut way = self.way;
        let arrives = match self.stands {
            _ if target == self.modal.at => Vec::new(),
            Stands::AtRest => Vec::new(),
            _ if self.lifts => arrival(machine, &mut way, self.modal.at, target),
            _ => vec![Item { line, code: Code::Line { target, feed: Feed::Rapid } }],
        };
        let changed = Some(Changed { by_mm, in_passes_mm });
        let first = self.before.first().map_or(line, |item| item.line);
        let before = before(&modal, &way, &arrives, self.lifts, first);
        way.extend(arrives);
        Ok(Plan { modal, way, before, changed, ..self })
    }
}

/// One program by two tables.
struct Both {
    was: Modal,
    is: Modal,
    differs: bool,
    /// What the places of an axis differ by, and the tools there were: one of its own for each at most.
    apart: PerAxis<Vec<f64>>,
    tools: BTreeSet<u32>,
}

impl Both {
    fn new(machine: &Machine) -> Both {
        let (was, is) = (Modal::new(machine), Modal::new(machine));
        Both { was, is, differs: false, apart: PerAxis::default(), tools: BTreeSet::from([0]) }
    }

    fn apart_mm(&self) -> [f64; 2] {
        shift_mm(&self.was.at, &self.is.at)
    }

    /// One item more of each; they have to be the same one, perhaps elsewhere.
    fn take(&mut self, was: &Item, is: &Item) -> Result<(), Refusal> {
        if was.line != is.line || !is_alike(&was.code, &is.code) {
            return Err(Refusal::OtherPath { line: was.line });
        }
        self.differs |= was != is;
        self.was.take(was);
        self.is.take(is);
        self.tools.extend(self.is.tool);
        for (apart, (from, to)) in self.apart.iter_mut().zip(self.was.at.iter().zip(&self.is.at)) {
            let mm = to.mm_from(*from);
            if !apart.iter().any(|known| (known - mm).abs() <= SAME) {
                apart.push(mm);
            }
        }
        // Moves in coordinates of the machine are where they were.
        match self.apart.iter().all(|apart| apart.len() <= 1 + self.tools.len()) {
            true => Ok(()),
            false => Err(Refusal::OtherPath { line: was.line }),
        }
    }
}

fn shift_mm(was: &PerAxis<Position>, is: &PerAxis<Position>) -> [f64; 2] {
    [Axis::X, Axis::Z].map(|axis| is[axis.index()].mm_from(was[axis.index()]))
}

fn is_alike(was: &Code, is: &Code) -> bool {
    match (was, is) {
        (Code::Line { feed: was, .. }, Code::Line { feed: is, .. }) => was == is,
        (Code::Arc { arc: was, feed: was_feed }, Code::Arc { arc: is, feed: is_feed }) => {
            let [first, second] = was.plane.axes().map(Axis::index);
            let apart = |at: usize, which: usize| {
                is.target[at].mm_from(was.target[at]) - is.center[which].mm_from(was.center[which])
            };
            let with_it = apart(first, 0).abs() <= SAME && apart(second, 1).abs() <= SAME;
            with_it && (was.plane, was.turns) == (is.plane, is.turns) && was_feed == is_feed
        }
        (Code::Curve { curve: was, feed: was_feed }, Code::Curve { curve: is, feed: is_feed }) => {
            let values =
                |curve: &Curve| [curve.start, curve.end].into_iter().flatten().flatten().chain(curve.way);
            let near = |(was, is): (f64, f64)| (is - was).abs() <= ALIKE * (1.0 + was.abs());
            values(was).zip(values(is)).all(near) && was_feed == is_feed
        }
        (Code::Pass(was), Code::Pass(is)) => is_same_pass(was, is),
        // A surface speed counts from the axis, which lies elsewhere for another tool.
        (Code::Spindle { mode: was, .. }, Code::Spindle { mode: is, .. }) => was == is,
        _ => was == is,
    }
}

/// Whether two passes follow the same laws, perhaps elsewhere.
fn is_same_pass(was: &ThreadPass, is: &ThreadPass) -> bool {
    let figures = |pass: &ThreadPass| {
        let ThreadPass { s_rpm, direction, start_angle_deg, lead_mm, thread_end_deg, depth_mm, .. } = *pass;
        [s_rpm, direction, start_angle_deg, lead_mm, thread_end_deg, depth_mm]
    };
    let same = |was: &[f64], is: &[f64]| was.iter().zip(is).all(|(was, is)| (was - is).abs() <= SAME);
    let axes = was.axes.iter().zip(&is.axes).all(|(was, is)| {
        let figures = |law: &protocol::AxisLaw| {
            let way_mm = law.end.mm_from(law.start);
            [way_mm, law.stroke_mm, law.retract_mm, law.lead_mm, law.run_in_c0_deg, law.run_in_dc_deg]
        };
        same(&figures(was), &figures(is))
    });
    (was.pass, was.start) == (is.pass, is.start) && same(&figures(was), &figures(is)) && axes
}
