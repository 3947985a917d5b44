//! The newest control cycles, every one of them. In: rows of numbers in the order of the columns of a trace.
//! Out: columns, by row. A run that begins empties it.

use std::{collections::VecDeque, ops::Range};

use protocol::AxisState;

use super::picture::extremes;

/// What a ring holds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ring {
    /// Names of the columns.
    columns: Vec<String>,
    /// Their values, the oldest first.
    values: Vec<VecDeque<f64>>,
    /// Most rows.
    most: usize,
    cycle_s: f64,
    /// Rows that were put in and are gone: the number of the oldest row that is there.
    gone: u64,
    /// How often it was emptied.
    begun: u64,
    cycle: usize,
    angle: Option<usize>,
    pass: Option<usize>,
    states: Vec<usize>,
}

impl Ring {
    /// Begins anew with these columns, for so many rows.
    pub(crate) fn begin(&mut self, columns: Vec<String>, cycle_s: f64, most: usize) {
        let place = |wanted: &str| columns.iter().position(|name| name == wanted);
        let states = columns.iter().enumerate().filter(|(_, name)| name.ends_with("_state"));
        *self = Ring {
            values: vec![VecDeque::new(); columns.len()],
            most: most.max(1),
            // A file may say anything.
            cycle_s: if cycle_s > 0.0 && cycle_s.is_finite() { cycle_s } else { 1.0 },
            gone: 0,
            begun: self.begun + 1,
            cycle: place("cycle").unwrap_or(0),
            angle: place("spindle_true_deg"),
            pass: place("pass"),
            states: states.map(|(place, _)| place).collect(),
            columns,
        };
    }

    /// Takes rows, one behind the other; what is not a whole row is left out.
    pub(crate) fn take(&mut self, numbers: &[f64]) {
        if self.columns.is_empty() {
            return;
        }
        for row in numbers.chunks_exact(self.columns.len()) {
            if self.rows() == self.most {
                for column in &mut self.values {
                    column.pop_front();
                }
                self.gone += 1;
            }
            self.values.iter_mut().zip(row).for_each(|(column, value)| column.push_back(*value));
        }
    }

    /// How many rows there are.
    pub(crate) fn rows(&self) -> usize {
        self.values.first().map_or(0, VecDeque::len)
    }

    /// The number of the oldest row, counted from the first that was ever put in.
    pub(crate) fn oldest(&self) -> u64 {
        self.gone
    }

    /// How often it was emptied.
    pub(crate) fn begun(&self) -> u64 {
        self.begun
    }

    /// Names of the columns.
    pub(crate) fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Seconds of a control cycle.
    pub(crate) fn cycle_s(&self) -> f64 {
        self.cycle_s
    }

    /// The column of a name.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|known| known == name)
    }

    /// A value.
    pub(crate) fn value(&self, column: usize, row: usize) -> f64 {
        self.values.get(column).and_then(|values| values.get(row)).copied().unwrap_or(f64::NAN)
    }

    /// The lowest and the highest value of a column in some of the rows that there are.
    pub(crate) fn extremes(&self, column: usize, rows: Range<usize>) -> [f64; 2] {
        let Some(values) = self.values.get(column) else { return [f64::NAN; 2] };
        let (older, newer) = values.as_slices();
        let part = |values: &'_ [f64], first: usize| {
            let at = |row: usize| row.saturating_sub(first).min(values.len());
            at(rows.start)..at(rows.end)
        };
        extremes([&older[part(older, 0)], &newer[part(newer, older.len())]])
    }

    /// The control cycles of some of the rows that there are.
    pub(crate) fn cycles(&self, rows: Range<usize>) -> impl ExactSizeIterator<Item = f64> {
        self.values.get(self.cycle).map(|cycles| cycles.range(rows)).unwrap_or_default().copied()
    }

    /// The control cycle of a row.
    pub(crate) fn cycle(&self, row: usize) -> u64 {
        self.value(self.cycle, row) as u64
    }

    /// Rows from a cycle on to before another one.
    pub(crate) fn between(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let Some(cycles) = self.values.get(self.cycle) else { return 0..0 };
        let first = cycles.partition_point(|cycle| *cycle < from);
        first..cycles.partition_point(|cycle| *cycle < to).max(first)
    }

    /// Angle of the spindle, degrees, unwrapped.
    pub(crate) fn angle_deg(&self, row: usize) -> f64 {
        self.angle.map_or(0.0, |column| self.value(column, row))
    }

    /// The pass in which an axis has begun, 0 of none.
    pub(crate) fn pass(&self, row: usize) -> u64 {
        let pass = self.pass.map_or(0, |column| self.value(column, row) as u64);
        let begun = |state: AxisState| state.has_begun();
        if pass > 0 && self.any_state(row, begun) { pass } else { 0 }
    }

    /// Whether any axis is in a state of this kind.
    pub(crate) fn any_state(&self, row: usize, is: impl Fn(AxisState) -> bool) -> bool {
        let state = |column: &usize| AxisState::from_code(self.value(*column, row) as u32);
        self.states.iter().any(|column| state(column).is_ok_and(&is))
    }

    /// All columns of some rows, one row behind the other.
    pub(crate) fn part(&self, rows: Range<usize>) -> Vec<f64> {
        let row =
            |row: usize| self.values.iter().map(move |column| column.get(row).copied().unwrap_or(f64::NAN));
        rows.flat_map(row).collect()
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A spindle that turns by 3 degrees in each cycle, two passes of 400 cycles, an axis that goes on.
    pub(crate) fn filled(cycles: std::ops::Range<u64>, most: usize) -> Ring {
        let mut ring = Ring::default();
        let columns = ["cycle", "t_s", "spindle_true_deg", "pass", "z_state", "z_error"];
        ring.begin(columns.map(str::to_owned).to_vec(), 5e-4, most);
        for cycle in cycles {
            ring.take(&row(cycle));
        }
        ring
    }

    /// The row of a cycle: pass 1 armed at 1000, begun at the index of cycle 1080 (3240 degrees), over at
    /// 1500; pass 2 the same 1200 cycles later.
    pub(crate) fn row(cycle: u64) -> [f64; 6] {
        let pass = [1, 2].into_iter().find(|pass| (1000..1500).contains(&(cycle as i64 - 1200 * (pass - 1))));
        let since = cycle as i64 - 1200 * (pass.unwrap_or(1) - 1);
        let state = match (pass, since) {
            (None, _) => AxisState::Streaming,
            (_, ..1080) => AxisState::Armed,
            (_, ..1180) => AxisState::RunIn,
            (_, ..1400) => AxisState::Locked,
            _ => AxisState::RunOut,
        };
        let error = f64::from(pass.unwrap_or(0) as i32) + 1e-5 * (37 * cycle % 101) as f64;
        let pass = pass.unwrap_or(0) as f64;
        [cycle as f64, cycle as f64 * 5e-4, 3.0 * cycle as f64, pass, f64::from(state as u32), error]
    }

    /// Wherever the oldest row lies in the ring, and whatever is no number.
    #[test]
    fn lowest_and_highest_are_those_of_the_numbers_in_the_rows() {
        for most in [700, 993, 1024] {
            let mut ring = filled(0..1990, most);
            let first = ring.rows() - 3;
            for value in [f64::NAN, f64::NAN, f64::NAN] {
                ring.take(&[1.0, 1.0, 1.0, 0.0, 0.0, value]);
            }
            let column = ring.column("z_error").expect("it is there");
            for rows in [0..1, 5..60, 100..101, 3..650, 640..699, 0..ring.rows()] {
                let values = rows.clone().map(|row| ring.value(column, row)).filter(|value| !value.is_nan());
                let wanted =
                    values.fold([f64::MAX, f64::MIN], |[low, high], one| [low.min(one), high.max(one)]);
                assert_eq!(ring.extremes(column, rows.clone()), wanted, "{rows:?} of {most}");
            }
            assert!(ring.extremes(column, first..ring.rows()).iter().all(|value| value.is_nan()));
            assert!(ring.extremes(99, 0..5).iter().all(|value| value.is_nan()));
        }
    }

    #[test]
    fn the_newest_rows_are_kept_every_one() {
        let ring = filled(0..5000, 1200);
        assert_eq!((ring.rows(), ring.oldest(), ring.cycle(0), ring.cycle(1199)), (1200, 3800, 3800, 4999));
        assert_eq!((ring.between(4000.0, 4010.0), ring.between(0.0, 9e9)), (200..210, 0..1200));
        assert_eq!(ring.part(5..7), [row(3805), row(3806)].concat());
        assert_eq!(ring.between(9e9, 0.0), 1200..1200);
        let mut ring = ring;
        ring.begin(vec!["cycle".into()], 5e-4, 10);
        assert_eq!((ring.rows(), ring.begun(), ring.oldest()), (0, 2, 0));
        // What came behind the names of another run, or is half a row.
        let mut two = filled(0..1, 10);
        two.take(&[1.0; 8]);
        assert_eq!(two.rows(), 2);
        Ring::default().take(&[1.0; 8]);
    }
}
