//! What is asked of the whole machine, and whether it is held. In: rows. Out: a line a case.

use super::{ASKED_LINES, Case, Row, um};
use report::table::Column;

/// The most that a helix may be off in a case, µm, and what was found; nothing where no pass was cut to its
/// end.
pub(super) struct Goal {
    pub(super) case: Case,
    asked_um: f64,
    pub(super) found_um: Option<f64>,
}

impl Goal {
    pub(super) fn is_held(&self) -> bool {
        self.found_um.is_some_and(|found| found <= self.asked_um)
    }
}

/// Columns of the table of goals.
pub(super) const COLUMNS: [Column<Goal>; 4] = [
    Column { name: "case", unit: "", cell: |goal| goal.case.name().into() },
    Column { name: "asked", unit: "at most µm", cell: |goal| um(Some(goal.asked_um)) },
    Column { name: "found", unit: "µm", cell: |goal| um(goal.found_um) },
    Column {
        name: "",
        unit: "",
        cell: |goal| if goal.is_held() { "held".into() } else { "not held".into() },
    },
];

/// The goals, for their encoder and a bandwidth of the observer.
pub(super) fn all(rows: &[Row], bandwidth_hz: f64) -> Vec<Goal> {
    let asked = [0.6, 1.0, 1.2, 0.5, 1.6];
    let goal = |(case, asked_um)| {
        let row = rows.iter().find(|row| row.is_of(ASKED_LINES, bandwidth_hz, case));
        Goal { case, asked_um, found_um: row.and_then(|row| row.helix_max_abs_um) }
    };
    Case::ALL.into_iter().zip(asked).map(goal).collect()
}
