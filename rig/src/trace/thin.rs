//! Keeps the trace of a long run small. In: a row of every control cycle. Out: which of them are kept, in
//! order.
//!
//! Everything is kept of the first [`FULL`] cycles and of passes, from where an axis is armed to where the
//! last one rests. Of what comes after, of every [`STRIDE`] cycles: the first, and the one that is farthest
//! from where it was commanded to be. Where the tool, how it moves, or what is cut changes, the rows on both
//! sides are kept.

use super::Row;

/// Cycles that are kept whatever they are: two minutes of 0.5 ms.
pub const FULL: u64 = 240_000;
/// Rows that belong together are at most so many cycles apart.
pub const STRIDE: u64 = 20;

/// Which rows are kept.
#[derive(Default)]
pub(super) struct Thin {
    stride: Option<Stride>,
}

/// The cycles between two rows that are kept in any case.
struct Stride {
    first: Row,
    /// The farthest of those after it, and how far, mm.
    farthest: Option<(f64, Row)>,
    last: Row,
}

impl Thin {
    /// Takes the next row, and hands out those that are kept and were not yet.
    pub(super) fn row<E>(&mut self, row: &Row, mut put: impl FnMut(&Row) -> Result<(), E>) -> Result<(), E> {
        if row.cycle < FULL || row.pass > 0 {
            self.finish(&mut put)?;
            return put(row);
        }
        let same = |row: &Row| (row.led, row.traced.trace);
        match &mut self.stride {
            Some(stride) if same(&stride.last) == same(row) && row.cycle < stride.first.cycle + STRIDE => {
                let off = row.off_mm();
                if stride.farthest.as_ref().is_none_or(|(most, _)| off > *most) {
                    stride.farthest = Some((off, row.clone()));
                }
                stride.last = row.clone();
            }
            stride => {
                let goes_on = stride.as_ref().is_some_and(|stride| same(&stride.last) == same(row));
                let begun = Stride { first: row.clone(), farthest: None, last: row.clone() };
                if let Some(over) = stride.replace(begun) {
                    over.hand_out(!goes_on, &mut put)?;
                }
            }
        }
        Ok(())
    }

    /// Hands out what is left.
    pub(super) fn finish<E>(&mut self, mut put: impl FnMut(&Row) -> Result<(), E>) -> Result<(), E> {
        self.stride.take().map_or(Ok(()), |stride| stride.hand_out(true, &mut put))
    }
}

impl Stride {
    fn hand_out<E>(self, ends: bool, put: &mut impl FnMut(&Row) -> Result<(), E>) -> Result<(), E> {
        put(&self.first)?;
        let mut kept = self.first.cycle;
        if let Some((_, farthest)) = &self.farthest {
            put(farthest)?;
            kept = farthest.cycle;
        }
        if ends && self.last.cycle > kept { put(&self.last) } else { Ok(()) }
    }
}
