//! The rows beside those of the reference simulation, under its conditions. In: a stand. Out: tables.
//!
//! Its conditions: the loops of the built-in machine, spindle encoder of 2500 lines, observer of 15 Hz, a
//! controller that knows the axis, positions held for 1 ms. It does not say by how much the leads are longer
//! because of the hold. A hold of two control cycles delays by half a cycle more than one of one cycle, on
//! average: 0.25 ms. Three values are tried.

use protocol::Axis;
use sim_plant::Belief;

use super::{Row, Series, nm, quantum, series, span, um};
use crate::{ExperimentError, stand::Stand};
use report::table::{Column, Place, Table};

/// What the reference gives for a quantum: least and largest error in the approach and that at its end in µm,
/// torque noise in N·m.
pub(super) struct Printed {
    pub(super) quantum_mm: Option<f64>,
    pub(super) approach_um: [f64; 2],
    pub(super) end_um: f64,
    pub(super) noise_nm: f64,
}

const fn printed(quantum_mm: Option<f64>, approach_um: [f64; 2], end_um: f64, noise_nm: f64) -> Printed {
    Printed { quantum_mm, approach_um, end_um, noise_nm }
}

pub(super) const PRINTED: [Printed; 7] = [
    printed(Some(1e-2), [-18.0, 29.0], 3.5, 16.0),
    printed(Some(1e-3), [-5.2, 6.9], -0.2, 2.3),
    printed(Some(3e-4), [-3.4, 3.2], 0.4, 0.76),
    printed(Some(1e-4), [-3.1, 2.6], 0.5, 0.18),
    printed(Some(1e-5), [-2.6, 2.4], 0.5, 0.05),
    printed(Some(1e-6), [-2.7, 2.4], 0.5, 0.05),
    printed(None, [-0.5, 1.0], 0.1, 0.05),
];

/// How much longer the leads are than those of the machine file, s.
pub(super) const LONGER_S: [f64; 3] = [0.0, 0.25e-3, 0.5e-3];

/// Every quantum of the reference, with leads that are so much longer.
pub(super) struct Beside {
    pub(super) longer_s: f64,
    pub(super) rows: Vec<Row>,
}

/// Runs the quanta of the reference under its conditions.
pub(super) fn beside(stand: &Stand) -> Result<Vec<Beside>, ExperimentError> {
    let mut machine = stand.machine.clone();
    let spindle = &mut machine.spindle;
    (spindle.encoder_lines, spindle.observer_hz, spindle.stroke_observer_hz) = (2500, 15.0, 15.0);
    let truth =
        Belief::of_truth(&machine, Axis::X).map_err(|error| ExperimentError::Input(error.to_string()))?;
    if let Some(x) = machine.axis.get_mut(&Axis::X) {
        (x.position_gain_1_s, x.velocity_bandwidth_hz, x.velocity_integral_s) = (100.0, 80.0, 0.008);
        truth.put_into(x);
    }
    let quanta: Vec<f64> = PRINTED.iter().filter_map(|printed| printed.quantum_mm).collect();
    let with_leads = |longer_s| {
        let Series { rows, .. } = series(stand, &machine, &quanta, longer_s)?;
        Ok(Beside { longer_s, rows })
    };
    LONGER_S.into_iter().map(with_leads).collect()
}

/// The rows with the leads that give the figures of the reference.
pub(super) fn as_there(beside: &[Beside]) -> &[Row] {
    beside.last().map_or(&[], |beside| &beside.rows)
}

pub(super) fn table(beside: &[Beside]) -> Table {
    let pairs: Vec<(&Printed, &Row)> = PRINTED.iter().zip(as_there(beside)).collect();
    let columns: [Column<(&Printed, &Row)>; 8] = [
        Column { name: "quantum", unit: "mm", cell: |(_, row)| quantum(row) },
        Column {
            name: "reference: approach",
            unit: "µm",
            cell: |(printed, _)| span(printed.approach_um[0], printed.approach_um[1]),
        },
        Column {
            name: "here: approach",
            unit: "µm",
            cell: |(_, row)| span(row.approach_min_um, row.approach_max_um),
        },
        Column {
            name: "of any seed",
            unit: "µm",
            cell: |(_, row)| span(row.approach_lowest_um, row.approach_highest_um),
        },
        Column { name: "reference: end", unit: "µm", cell: |(printed, _)| um(printed.end_um) },
        Column { name: "here: end", unit: "µm", cell: |(_, row)| um(row.end_um) },
        Column { name: "reference: noise", unit: "N·m", cell: |(printed, _)| printed.noise_nm.to_string() },
        Column { name: "here: noise", unit: "N·m", cell: |(_, row)| nm(row.torque_noise_nm) },
    ];
    Table::of("Beside the reference simulation, under its conditions", &columns, &pairs)
        .with_caption(
            "2500 lines, observer of 15 Hz, mass and friction known, leads 0.5 ms longer than those of the law itself. \
             The reference shows one pass, which may lie anywhere between those of any seed.",
        )
        .at(Place::Page)
}

pub(super) fn leads(beside: &[Beside]) -> Table {
    let rows: Vec<(f64, &Row)> = beside
        .iter()
        .flat_map(|beside| {
            let shown = |row: &&Row| [Some(1e-3), Some(1e-6), None].contains(&row.quantum_mm);
            beside.rows.iter().filter(shown).map(|row| (beside.longer_s, row))
        })
        .filter(|(longer_s, row)| row.quantum_mm.is_some() || *longer_s == 0.0)
        .collect();
    let columns: [Column<(f64, &Row)>; 4] = [
        Column { name: "quantum", unit: "mm", cell: |(_, row)| quantum(row) },
        Column {
            name: "leads longer by",
            unit: "ms",
            cell: |(longer_s, _)| format!("{:.2}", 1e3 * longer_s),
        },
        Column {
            name: "approach",
            unit: "µm",
            cell: |(_, row)| span(row.approach_min_um, row.approach_max_um),
        },
        Column { name: "end", unit: "µm", cell: |(_, row)| um(row.end_um) },
    ];
    Table::of("What the leads have to make up for", &columns, &rows).with_caption(
        "Under the same conditions. Holding a position for two control cycles delays by a quarter of a millisecond \
         more than a new one every cycle. Leads that are longer by that make the error smallest.",
    )
}
