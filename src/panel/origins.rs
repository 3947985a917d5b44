//! Where zero of a program lies as it goes on, and where its tools are drawn. In: what the check found. Out:
//! X and Z of the machine where those of the program are 0, in any block; how far a tool is drawn beside
//! where it is. All in mm, X of a lathe as a radius.
//!
//! The part is drawn in one place, where it lies with the tool of the first pass, or else of the first feed.
//! Each tool is drawn where it is at work on that: by the zero that it cuts with. On its way from where it
//! was put in, and away, another zero may be in force, or none yet.

use std::collections::BTreeMap;

use interpreter::ZeroNote;
use protocol::{Axis, Code, Feed, Item, PerAxis, Position};

use crate::program::Program;

/// Zeros of a program.
#[derive(Debug, Default)]
pub(super) struct Origins {
    notes: Vec<ZeroNote>,
    /// By which zero tools are drawn behind each of them.
    drawn: Vec<Option<[f64; 2]>>,
    by_pass: BTreeMap<u32, [f64; 2]>,
    /// Where the part is drawn.
    first: Option<[f64; 2]>,
}

impl Origins {
    /// Of a program that was checked.
    pub(super) fn of(program: &Program) -> Origins {
        let Some(check) = &program.check else { return Origins::default() };
        let first = check.passes.first().map(|note| note.origin_mm);
        let by_pass = check.passes.iter().map(|note| (note.pass, note.origin_mm)).collect();
        Origins::new(check.zeros.clone(), by_pass, first)
    }

    /// Without a pass the part lies where something is cut first.
    fn new(notes: Vec<ZeroNote>, by_pass: BTreeMap<u32, [f64; 2]>, first: Option<[f64; 2]>) -> Origins {
        let cut = notes.iter().find(|note| note.cuts).and_then(|note| note.origin_mm);
        Origins { drawn: drawn(&notes), notes, by_pass, first: first.or(cut) }
    }

    /// Where the part is drawn.
    pub(super) fn first(&self) -> Option<[f64; 2]> {
        self.first
    }

    /// What is said of the zero up to the block that begins behind so many steps of progress.
    pub(super) fn so_far(&self, steps: u64) -> &[ZeroNote] {
        &self.notes[..self.notes.partition_point(|note| note.after <= steps)]
    }

    /// In a pass, else in that block.
    pub(super) fn at(&self, pass: Option<u32>, steps: u64) -> Option<[f64; 2]> {
        let in_pass = pass.and_then(|pass| self.by_pass.get(&pass)).copied();
        in_pass.or_else(|| self.so_far(steps).last()?.origin_mm)
    }

    /// How far a tool is drawn beside where it is, in a pass, else in that block.
    pub(super) fn moved(&self, pass: Option<u32>, steps: u64) -> Option<[f64; 2]> {
        let in_pass = pass.and_then(|pass| self.by_pass.get(&pass)).copied();
        let behind = || self.drawn[..self.so_far(steps).len()].last().copied().flatten();
        let (first, now) = (self.first?, in_pass.or_else(behind)?);
        Some([first[0] - now[0], first[1] - now[1]])
    }
}

/// By which zero tools are drawn behind each note: that with which something is cut there; else the next
/// one with which that tool cuts, or the last one; before there is a tool, that of the first.
fn drawn(notes: &[ZeroNote]) -> Vec<Option<[f64; 2]>> {
    let (mut next, mut coming): (BTreeMap<u32, _>, _) = (BTreeMap::new(), None);
    let mut drawn: Vec<Option<[f64; 2]>> = vec![None; notes.len()];
    for (note, drawn) in notes.iter().zip(&mut drawn).rev() {
        if note.cuts {
            next.insert(note.tool, note.origin_mm);
            coming = note.origin_mm;
        }
        *drawn = next.get(&note.tool).copied().flatten().or(coming.filter(|_| note.tool == 0));
    }
    let mut before: BTreeMap<u32, _> = BTreeMap::new();
    for (note, drawn) in notes.iter().zip(&mut drawn) {
        if note.cuts {
            before.insert(note.tool, note.origin_mm);
        }
        *drawn = drawn.or_else(|| before.get(&note.tool).copied().flatten()).or(note.origin_mm);
    }
    drawn
}

/// By hand: the offset of the tool that cut first, X and Z. That tool is drawn where it is, and others where
/// they are at work on what it has cut: an offset is where the tip of a tool is. Zero of the coordinate
/// system moves no tool.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FirstCut(Option<[f64; 2]>);

impl FirstCut {
    /// A block is given, with this offset in force.
    pub(super) fn gives(&mut self, items: &[Item], offset: &PerAxis<Position>) {
        let cuts = |item: &Item| {
            matches!(item.code, Code::Pass(_)) || item.code.feed().is_some_and(|feed| feed != Feed::Rapid)
        };
        if items.iter().any(cuts) {
            self.0.get_or_insert(tip(offset));
        }
    }

    /// How far a tool with this offset is drawn beside where it is, X and Z, mm.
    pub(super) fn moved_mm(&self, offset: &PerAxis<Position>) -> [f64; 2] {
        let now = tip(offset);
        let first = self.0.unwrap_or(now);
        [first[0] - now[0], first[1] - now[1]]
    }
}

fn tip(offset: &PerAxis<Position>) -> [f64; 2] {
    [Axis::X, Axis::Z].map(|axis| offset[axis.index()].mm())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn note(after: u64, tool: u32, cuts: bool, origin_mm: [f64; 2]) -> ZeroNote {
        ZeroNote { after, origin_mm: Some(origin_mm), system: 1, tool, cuts, set: Vec::new() }
    }

    fn zeros() -> Origins {
        let notes = vec![
            note(0, 0, false, [0.0, 0.0]),
            note(1, 1, false, [0.0, 0.0]),
            note(2, 1, true, [10.0, 50.0]),
            note(5, 1, false, [0.0, 50.0]),
            note(6, 3, false, [0.0, 50.0]),
            note(7, 3, true, [8.65, 54.2]),
        ];
        let by_pass = BTreeMap::from([(1, [8.65, 54.2]), (2, [8.65, 55.7])]);
        Origins::new(notes, by_pass, Some([8.65, 54.2]))
    }

    #[test]
    fn the_zero_is_the_one_in_force_in_the_block_or_the_pass_in_hand() {
        let zeros = zeros();
        for (steps, wanted) in [
            (0, [0.0, 0.0]),
            (1, [0.0, 0.0]),
            (2, [10.0, 50.0]),
            (4, [10.0, 50.0]),
            (5, [0.0, 50.0]),
            (9, [8.65, 54.2]),
        ] {
            assert_eq!(zeros.at(None, steps), Some(wanted), "behind {steps}");
        }
        assert_eq!(zeros.at(Some(2), 9), Some([8.65, 55.7]));
        assert_eq!(Origins::default().at(None, 3), None);
    }

    /// Two tools with different offsets turn the same place of the part: it is drawn there for both, and each
    /// comes there, and goes, as it is at work.
    #[test]
    fn each_tool_is_drawn_where_it_is_at_work() {
        let zeros = zeros();
        let drawn = |x: f64, z: f64, pass, steps| {
            let [by_x, by_z] = zeros.moved(pass, steps).unwrap_or_default();
            [x + by_x, z + by_z].map(|mm| (1e6 * mm).round() / 1e6)
        };
        // X 9.91 and Z -14 of the program, with each of them; then in a pass whose zero lies elsewhere.
        let wanted = [18.56, 40.2];
        for steps in 0..6 {
            assert_eq!(drawn(10.0 + 9.91, 50.0 - 14.0, None, steps), wanted, "behind {steps}");
        }
        for steps in 6..9 {
            assert_eq!(drawn(8.65 + 9.91, 54.2 - 14.0, None, steps), wanted, "behind {steps}");
        }
        assert_eq!(drawn(8.65 + 9.91, 55.7 - 14.0, Some(2), 9), wanted);
        assert_eq!(Origins::default().moved(None, 3), None, "nothing is known of it");
    }

    #[test]
    fn by_hand_each_tool_is_drawn_where_it_is_at_work_on_what_was_cut_first() {
        let offset = |x: f64, z: f64| {
            let mut offset = PerAxis::default();
            offset[Axis::X.index()] = Position::from_mm(x);
            offset[Axis::Z.index()] = Position::from_mm(z);
            offset
        };
        let block = |feed| [Item { line: 1, code: Code::Line { target: PerAxis::default(), feed } }];
        let mut first = FirstCut::default();
        first.gives(&block(Feed::Rapid), &offset(7.0, 7.0));
        assert_eq!(first.moved_mm(&offset(-1.0, 4.0)), [0.0, 0.0], "nothing is cut yet");
        first.gives(&block(Feed::PerMinute(100.0)), &offset(0.0, 0.0));
        first.gives(&block(Feed::PerMinute(100.0)), &offset(-1.0, 4.0));
        assert_eq!(first.moved_mm(&offset(-1.0, 4.0)), [1.0, -4.0]);
        assert_eq!(first.moved_mm(&offset(0.0, 0.0)), [0.0, 0.0]);
    }
}
