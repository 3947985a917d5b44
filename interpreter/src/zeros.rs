//! Where zero of a program lies from its beginning to its end. In: what is in force, as calls change it, and
//! parameters of coordinate systems, as blocks set them. Out: a note wherever something has changed; mm of
//! the machine, X of a lathe as a radius.

/// What holds from here on, up to the next note.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ZeroNote {
    /// Steps of progress ([`protocol::Item::steps`]) before it.
    pub after: u64,
    /// X and Z of the machine at which X 0 and Z 0 of the program lie, tool and offsets included, mm. `None`
    /// where that is not known: the zero of a job file is its own, and of notes without end only so many are
    /// kept.
    pub origin_mm: Option<[f64; 2]>,
    /// Number of the coordinate system in force: 1 (G54) to 9, 9 + P for G54.1 P of FANUC.
    pub system: u8,
    /// The tool that the program has called for, 0 for none.
    pub tool: u32,
    /// Whether a feed or a pass is made with it.
    pub cuts: bool,
    /// Parameters of coordinate systems that are others from here on, in machine units.
    pub set: Vec<(u32, f64)>,
}

/// So many notes are kept: a loop may change its zero in each turn.
const MOST: usize = 10_000;

/// The notes so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Zeros {
    notes: Vec<ZeroNote>,
    /// Something was made since the last note.
    made: bool,
}

impl Zeros {
    /// What is known so far.
    pub(crate) fn notes(&self) -> &[ZeroNote] {
        &self.notes
    }

    /// Where this note is in the program has become known.
    pub(crate) fn lies_behind(&mut self, note: usize, after: u64) {
        self.notes[note].after = after;
    }

    /// Something is made.
    pub(crate) fn makes(&mut self) {
        self.made = true;
    }

    /// Whether this is no change.
    pub(crate) fn holds(&self, origin_mm: Option<[f64; 2]>, system: u8, tool: u32) -> bool {
        self.notes
            .last()
            .is_some_and(|last| (last.origin_mm, last.system, last.tool) == (origin_mm, system, tool))
    }

    /// Something changes: the number of its note, if that is a new one. Between two of one place nothing is
    /// made, and of too many none is.
    pub(crate) fn change(&mut self, change: impl FnOnce(&mut ZeroNote)) -> Option<usize> {
        let new = std::mem::take(&mut self.made) || self.notes.is_empty();
        if self.notes.len() > MOST {
            return None;
        }
        if new {
            let before = self.notes.last().cloned().unwrap_or_default();
            self.notes.push(ZeroNote { cuts: false, set: Vec::new(), ..before });
        }
        let (number, note) = (self.notes.len() - 1, self.notes.last_mut()?);
        change(note);
        if number == MOST {
            note.origin_mm = None;
        }
        new.then_some(number)
    }

    /// A feed or a pass is made where zero of the program lies here.
    pub(crate) fn cuts(&mut self, origin_mm: [f64; 2]) {
        let here = |note: &&mut ZeroNote| note.origin_mm == Some(origin_mm);
        self.notes.iter_mut().rev().take(2).find(here).into_iter().for_each(|note| note.cuts = true);
    }
}

#[cfg(test)]
mod tests {
    use machine::Machine;
    use protocol::Item;

    use super::*;

    #[test]
    fn zero_is_known_in_every_block_with_its_system_and_what_was_set() {
        let text = "G7 G18 G21 G90 G94\nG10 L2 P2 Z-50\nG54\nG0 X50 Z10\nG55\nM0\nG0 Z12\nG1 Z5 F500\nG1 X48\n\
                    G54 G92 Z100\nG1 X52\nG0 X54\nM2\n";
        let check = crate::check("zero.ngc", text, &Machine::default());
        assert!(check.is_good(), "{:?}", check.diagnostics);
        let at = |line: u32| {
            let place = check.items.iter().position(|item| item.line == line).expect("there is such a line");
            let before: u64 = check.items[..place].iter().map(Item::steps).sum();
            let many = check.zeros.partition_point(|note| note.after <= before);
            let last = check.zeros[..many].last().expect("there is one at the beginning");
            let set = check.zeros[..many].iter().flat_map(|note| note.set.clone()).collect::<Vec<_>>();
            (last.system, last.origin_mm.expect("it is known")[1], last.cuts, set)
        };
        let set = vec![(5243, -50.0)];
        assert_eq!(at(4), (1, 0.0, false, set.clone()));
        assert_eq!(at(6), (2, -50.0, true, set.clone()), "at the pause behind G55");
        assert_eq!(at(8), (2, -50.0, true, set.clone()));
        // At Z 5 of G55, which G92 calls 100.
        assert_eq!(at(11), (1, -145.0, true, set.clone()));
        assert_eq!(at(12), (1, -145.0, true, set));
    }

    #[test]
    fn of_a_zero_that_changes_without_end_so_many_notes_are_kept_and_then_it_is_not_known() {
        let mut zeros = Zeros::default();
        for turn in 0..2 * MOST {
            zeros.makes();
            zeros.change(|note| note.origin_mm = Some([turn as f64, 0.0]));
        }
        let notes = zeros.notes();
        assert_eq!((notes.len(), notes[MOST - 1].origin_mm.is_some()), (MOST + 1, true));
        assert_eq!(notes[MOST].origin_mm, None);
    }
}
