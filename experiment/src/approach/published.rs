//! What was published, beside what was measured here. In: measured passes. Out: tables.
//!
//! The paper gives a band: servo errors of X within ±8 µm in the approach, 0 … −1 µm at its end, at 100, 80
//! and 60 % of override. The reference simulation gives figures for each structure; its loops, encoder and
//! observer are set for the comparison (`as_in_reference`), its plant is that of the built-in machine.

use machine::Feedforward;

use super::{Done, Row, label, micrometres, name, span, text};
use report::table::{Column, Place, Table};

/// Positions of the override knob for which there are published figures, per cent.
pub(super) const OVERRIDES: [f64; 3] = [100.0, 80.0, 60.0];

/// Largest servo error of the paper in the approach, µm, and its range at the end.
pub(super) const BAND_UM: f64 = 8.0;
pub(super) const END_UM: [f64; 2] = [-1.0, 0.0];

/// Figures of the reference simulation for a structure at each of the overrides: least and largest error in
/// the approach, error at its end, µm.
const REFERENCE: [(Feedforward, [[f64; 3]; 3]); 6] = [
    (Feedforward::None, [[0.0, 796.0, 77.0], [0.0, 649.0, 39.0], [0.0, 494.0, 16.0]]),
    (Feedforward::DifferenceV, [[-19.0, 19.0, 6.7], [-11.0, 12.0, 4.0], [-6.3, 6.4, 1.7]]),
    (Feedforward::DifferenceVa, [[-6.6, 8.0, -2.7], [-5.1, 6.1, -2.1], [-4.0, 3.8, -1.1]]),
    (Feedforward::AnalyticV, [[-12.0, 13.0, 9.4], [-6.9, 7.7, 5.3], [-3.5, 4.3, 2.4]]),
    (Feedforward::AnalyticVaNoLead, [[-3.8, 3.8, 0.9], [-2.6, 2.4, 0.5], [-1.7, 1.7, 0.3]]),
    (Feedforward::Full, [[-1.3, 1.1, 0.3], [-1.0, 1.1, 0.3], [-0.9, 1.1, 0.2]]),
];

/// A structure at an override: least and largest error in the approach and at its end, µm, in the reference
/// and here.
struct Pair {
    name: String,
    override_pct: f64,
    reference: [f64; 3],
    approach: [f64; 2],
    end: [f64; 2],
}

impl Pair {
    /// The case, over all seeds that were run.
    fn of(structure: Feedforward, override_pct: f64, reference: [f64; 3], done: &[Done]) -> Pair {
        let rows = || {
            let rows = done.iter().map(|done| &done.row);
            rows.filter(move |row| row.structure == structure && row.override_pct == override_pct)
        };
        let least = |of: fn(&Row) -> f64| rows().map(of).fold(f64::INFINITY, f64::min);
        let most = |of: fn(&Row) -> f64| rows().map(of).fold(f64::NEG_INFINITY, f64::max);
        Pair {
            name: name(structure).into(),
            override_pct,
            reference,
            approach: [least(|row| row.approach_min_um), most(|row| row.approach_max_um)],
            end: [least(|row| row.end_um), most(|row| row.end_um)],
        }
    }

    /// Width of the span of errors in the approach here, over that of the reference.
    fn ratio(&self) -> f64 {
        let [least, largest, _] = self.reference;
        (self.approach[1] - self.approach[0]) / (largest - least)
    }
}

const PAIRS: [Column<Pair>; 7] = [
    Column { name: "structure", unit: "", cell: |pair| pair.name.clone() },
    Column { name: "override", unit: "%", cell: |pair| format!("{:.0}", pair.override_pct) },
    Column {
        name: "reference: approach",
        unit: "µm",
        cell: |pair| span([pair.reference[0], pair.reference[1]]),
    },
    Column { name: "here: approach", unit: "µm", cell: |pair| span(pair.approach) },
    Column { name: "here / reference", unit: "width", cell: |pair| format!("{:.2}", pair.ratio()) },
    Column { name: "reference: end", unit: "µm", cell: |pair| micrometres(pair.reference[2]) },
    Column { name: "here: end", unit: "µm", cell: |pair| span(pair.end) },
];

/// Every structure under the conditions of the reference simulation.
pub(super) fn beside_the_reference(done: &[Done]) -> Table {
    let pairs = REFERENCE.into_iter().flat_map(|(structure, figures)| {
        OVERRIDES.into_iter().zip(figures).map(move |(pct, figures)| Pair::of(structure, pct, figures, done))
    });
    Table::of("Beside the reference simulation, under its conditions", &PAIRS, &pairs.collect::<Vec<_>>())
        .with_caption(text::beside_the_reference())
        .at(Place::Page)
}

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
