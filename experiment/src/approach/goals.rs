//! What is asked of the structures, and whether it is held. In: what was measured. Out: a line a goal.

use machine::Feedforward;

use super::{Chance, Done, micrometres};
use report::table::Column;

/// One goal: a figure and the range it has to lie in, µm.
pub(super) struct Goal {
    pub(super) what: &'static str,
    asked: [f64; 2],
    pub(super) measured: f64,
}

impl Goal {
    pub(super) fn is_held(&self) -> bool {
        (self.asked[0]..=self.asked[1]).contains(&self.measured)
    }
}

/// Columns of the table of goals.
pub(super) const COLUMNS: [Column<Goal>; 4] = [
    Column { name: "figure", unit: "", cell: |goal| goal.what.into() },
    Column {
        name: "asked for",
        unit: "± µm",
        cell: |goal| match goal.asked {
            [0.0, most] => format!("at most {}", micrometres(most)),
            [least, f64::INFINITY] => format!("at least {}", micrometres(least)),
            [least, most] => format!("{} to {}", micrometres(least), micrometres(most)),
        },
    },
    Column { name: "measured", unit: "± µm", cell: |goal| micrometres(goal.measured) },
    Column {
        name: "",
        unit: "",
        cell: |goal| if goal.is_held() { "held".into() } else { "not held".into() },
    },
];

/// Largest magnitude of an interval.
fn most([least, most]: [f64; 2]) -> f64 {
    most.max(-least)
}

/// Every goal: of the structure that is used over all overrides and seeds, of the others at 100 %.
pub(super) fn all(done: &[Done], chance: &[Chance]) -> Vec<Goal> {
    let over = |tuned: bool, of: fn(&Chance) -> f64| {
        chance.iter().filter(|row| row.tuned == tuned).map(of).fold(0.0, f64::max)
    };
    let at_100 = |structure: Feedforward| {
        let rows = done.iter().map(|done| &done.row);
        let row =
            rows.filter(|row| row.structure == structure && row.override_pct == 100.0).find(|row| !row.tuned);
        row.map_or(f64::NAN, |row| most([row.approach_min_um, row.approach_max_um]))
    };
    let goal = |what, asked, measured| Goal { what, asked, measured };
    vec![
        goal("full: approach", [0.0, 2.0], over(false, |row| most(row.approach))),
        goal("full: end", [0.0, 0.5], over(false, |row| most(row.end))),
        goal("full: thread from its beginning", [0.0, 0.2], over(false, |row| row.at_depth)),
        goal("full: thread from one turn on", [0.0, 0.2], over(false, |row| row.thread)),
        goal("full, tuned: approach", [0.0, 1.5], over(true, |row| most(row.approach))),
        goal("full, tuned: end", [0.0, 0.3], over(true, |row| most(row.end))),
        goal("full, tuned: thread from its beginning", [0.0, 0.1], over(true, |row| row.at_depth)),
        goal("full, tuned: thread from one turn on", [0.0, 0.1], over(true, |row| row.thread)),
        goal("difference-v at 100 %: approach", [5.0, 12.0], at_100(Feedforward::DifferenceV)),
        goal("difference-va at 100 %: approach", [5.0, 12.0], at_100(Feedforward::DifferenceVa)),
        goal("none at 100 %: approach", [100.0, f64::INFINITY], at_100(Feedforward::None)),
    ]
}
