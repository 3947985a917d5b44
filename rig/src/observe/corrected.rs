//! Counts of the spindle encoder that were lost or gained, and corrected at an index. In: every control cycle
//! the sum of those that a regulator has corrected so far. Out: one warning, however many there were.
//!
//! That sum grows at an index alone, by what was corrected there.

/// What was corrected in a run.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Corrected {
    /// All of them, either way.
    counts: i32,
    /// Indexes at which there were any, and the most at one.
    indexes: u32,
    most: i32,
    /// The cycle of the first.
    since: u64,
}

impl Corrected {
    /// Takes the sum of a control cycle; one that is not larger tells nothing new.
    pub(super) fn cycle(&mut self, cycle: u64, counts: i32) {
        let here = counts - self.counts;
        if here <= 0 {
            return;
        }
        if self.indexes == 0 {
            self.since = cycle;
        }
        self.counts = counts;
        self.indexes += 1;
        self.most = self.most.max(here);
    }

    /// Since when, and what is to be told.
    pub(super) fn told(&self) -> Option<(u64, String)> {
        let name = |counts| if counts == 1 { "1 count".into() } else { format!("{counts} counts") };
        let (counts, most) = (name(self.counts), name(self.most));
        let found = match self.indexes {
            0 => return None,
            1 => format!("{counts} too many or too few at an index, corrected there"),
            indexes => format!(
                "counts too many or too few at {indexes} indexes, corrected there: at most {most} at one, {counts} in all"
            ),
        };
        Some((self.since, format!("{found}; check the encoder, its cable and the shield")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(sums: &[i32]) -> Option<(u64, String)> {
        let mut corrected = Corrected::default();
        (100..).zip(sums).for_each(|(cycle, sum)| corrected.cycle(cycle, *sum));
        corrected.told()
    }

    #[test]
    fn one_index_is_told_by_its_counts_and_several_by_the_most_and_the_sum() {
        assert_eq!(told(&[0, 0]), None);
        let (cycle, text) = told(&[0, 0, 2, 2]).expect("a warning");
        assert!(cycle == 102 && text.starts_with("2 counts too many or too few at an index,"), "{text}");
        let (cycle, text) = told(&[0, 1, 1, 4, 0, 4, 5]).expect("a warning");
        assert!(
            cycle == 101 && text.contains("at 3 indexes, corrected there: at most 3 counts at one, 5 counts"),
            "{text}"
        );
    }
}
