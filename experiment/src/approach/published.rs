//! What was published, beside what was measured here. In: measured passes. Out: tables.
//!
//! The paper gives a band: servo errors of X within ±8 µm in the approach, 0 … −1 µm at its end, at 100, 80
//! and 60 % of override. The figures of the reference simulation are those of `experiment reference`.

use machine::Feedforward;

use super::{Done, Row, label, micrometres, span, text};
use report::table::{Column, Table};

/// Positions of the override knob for which there are published figures, per cent.
pub(super) const OVERRIDES: [f64; 3] = [100.0, 80.0, 60.0];

/// Largest servo error of the paper in the approach, µm, and its range at the end.
pub(super) const BAND_UM: f64 = 8.0;
pub(super) const END_UM: [f64; 2] = [-1.0, 0.0];

/// The structure that is like the published one, and the one that is used, beside the band of the paper.
pub(super) fn beside_the_paper(done: &[Done]) -> Table {
    let shown = [Feedforward::DifferenceVa, Feedforward::Full];
    let rows: Vec<&Row> = done
        .iter()
        .map(|done| &done.row)
        .filter(|row| shown.contains(&row.structure) && OVERRIDES.contains(&row.override_pct))
        .filter(|row| !row.tuned)
        .collect();
    let columns: [Column<&Row>; 6] = [
        Column { name: "structure", unit: "", cell: |row| label(row) },
        Column { name: "override", unit: "%", cell: |row| format!("{:.0}", row.override_pct) },
        Column { name: "paper: approach", unit: "µm", cell: |_| span([-BAND_UM, BAND_UM]) },
        Column {
            name: "here: approach",
            unit: "µm",
            cell: |row| span([row.approach_min_um, row.approach_max_um]),
        },
        Column { name: "paper: end", unit: "µm", cell: |_| span(END_UM) },
        Column { name: "here: end", unit: "µm", cell: |row| micrometres(row.end_um) },
    ];
    Table::of("Beside the published experiment", &columns, &rows).with_caption(text::beside_the_paper())
}
