//! Experiment `observer`: how well the spindle's angle is known from its encoder, and what that makes of a helix. In: a
//! machine. Out: a row for each encoder, bandwidth and case, error of the helix in µm at a lead of 5 mm; beside the
//! figures of the reference.
//!
//! | case | the spindle |
//! |---|---|
//! | constant | 500 1/min |
//! | override-ramp | from 500 to 300 1/min within 0.3 s |
//! | dip | loses 3 % of 500 1/min within 15 ms |
//! | slow | 0.2 1/min |

mod alone;
mod figures;
mod machine;
#[cfg(test)]
mod tests;
mod text;

use rig::observe::PassReport;
use serde::Serialize;

use super::{
    Findings,
    stand::Stand,
    table::{Column, Place, Table, six},
};
use crate::error::CliError;

/// Lead of the helix, mm.
const LEAD_MM: f64 = 5.0;
/// Lines of the encoders.
const LINES: [u32; 9] = [25, 100, 512, 1024, 2500, 5000, 10_000, 25_000, 250_000];
/// Bandwidths of the observer, Hz.
const BANDWIDTHS_HZ: [f64; 3] = [20.0, 30.0, 40.0];
/// Encoders that are tried on the machine.
const ON_THE_MACHINE: [u32; 3] = [1024, 2500, 5000];
/// Seeds of a case on the machine; the largest error counts.
const SEEDS: u64 = 3;

/// What the spindle does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Case {
    Constant,
    OverrideRamp,
    Dip,
    Slow,
}

impl Case {
    const ALL: [Case; 4] = [Case::Constant, Case::OverrideRamp, Case::Dip, Case::Slow];

    fn name(self) -> &'static str {
        ["constant", "override-ramp", "dip", "slow"][self as usize]
    }
}

/// Largest errors of the reference: lines, bandwidth in Hz, µm in the order of the cases.
const PRINTED: [(u32, f64, [f64; 4]); 5] = [
    (1024, 30.0, [0.42, 0.59, 0.65, 0.70]),
    (2500, 20.0, [0.08, 0.84, 0.98, 0.25]),
    (2500, 30.0, [0.09, 0.42, 0.50, 0.25]),
    (5000, 30.0, [0.04, 0.29, 0.37, 0.12]),
    (5000, 40.0, [0.05, 0.18, 0.20, 0.12]),
];

/// Inputs and figures of one case.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    lines: u32,
    bandwidth_hz: f64,
    lead_mm: f64,
    case: Case,
    /// Of the observer alone at 1 kHz, median over where the counts lie.
    helix_max_abs_um: f64,
    /// Largest of any place of the counts.
    helix_worst_um: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    printed_um: Option<f64>,
    /// Of a pass on the whole machine in its own control cycle, largest of some seeds.
    #[serde(skip_serializing_if = "Option::is_none")]
    machine_helix_max_abs_um: Option<f64>,
}

impl Row {
    fn of(lines: u32, bandwidth_hz: f64, case: Case) -> Row {
        let alone = alone::errors(lines, bandwidth_hz, case);
        let printed = PRINTED.iter().find(|row| (row.0, row.1) == (lines, bandwidth_hz));
        Row {
            lines,
            bandwidth_hz,
            lead_mm: LEAD_MM,
            case,
            helix_max_abs_um: alone.typical_um,
            helix_worst_um: alone.worst_um,
            printed_um: printed.and_then(|row| row.2.get(case as usize)).copied(),
            machine_helix_max_abs_um: None,
        }
    }
}

/// One pass on the machine.
#[derive(Clone, Copy, Debug)]
struct OnMachine {
    lines: u32,
    bandwidth_hz: f64,
    case: Case,
    seed: u64,
}

impl OnMachine {
    /// Every case but the slow one, which takes minutes on the machine: that one for its own encoder and observer.
    fn all(stand: &Stand) -> Vec<OnMachine> {
        let spindle = &stand.machine.spindle;
        let slow = OnMachine {
            lines: spindle.encoder_lines,
            bandwidth_hz: spindle.observer_hz,
            case: Case::Slow,
            seed: stand.seed,
        };
        let mut all = vec![slow];
        for lines in ON_THE_MACHINE {
            for bandwidth_hz in BANDWIDTHS_HZ {
                for case in [Case::Constant, Case::OverrideRamp, Case::Dip] {
                    all.extend((0..SEEDS).map(|n| {
                        let seed = stand.seed.wrapping_add(n);
                        OnMachine { lines, bandwidth_hz, case, seed }
                    }));
                }
            }
        }
        all
    }

    fn cut(&self, stand: &Stand) -> Result<PassReport, CliError> {
        machine::pass(&stand.machine, self.lines, self.bandwidth_hz, self.case, self.seed)
    }
}

/// Makes the experiment.
///
/// # Errors
/// The machine cannot cut the passes.
pub(super) fn findings(stand: &Stand) -> Result<Findings<Row>, CliError> {
    let cases: Vec<(u32, f64, Case)> = LINES
        .into_iter()
        .flat_map(|lines| BANDWIDTHS_HZ.map(|bandwidth_hz| (lines, bandwidth_hz)))
        .flat_map(|(lines, bandwidth_hz)| Case::ALL.map(|case| (lines, bandwidth_hz, case)))
        .collect();
    let mut rows =
        stand.each(&cases, |&(lines, bandwidth_hz, case)| Ok(Row::of(lines, bandwidth_hz, case)))?;
    let passes = OnMachine::all(stand);
    let cut = stand.each(&passes, |pass| pass.cut(stand))?;
    for (pass, report) in passes.iter().zip(&cut) {
        let same = |row: &&mut Row| {
            (row.lines, row.bandwidth_hz, row.case) == (pass.lines, pass.bandwidth_hz, pass.case)
        };
        if let Some(row) = rows.iter_mut().find(same) {
            let largest = row.machine_helix_max_abs_um.unwrap_or(0.0).max(report.helix_max_abs_um);
            row.machine_helix_max_abs_um = Some(largest);
        }
    }
    Ok(Findings {
        title: "The spindle's angle from its encoder",
        short: text::short(&rows),
        done: text::done(stand),
        tables: tables(&rows),
        notes: Vec::new(),
        figures: figures::all(),
        text: text::meaning(&rows),
        rows,
    })
}

fn um(value: Option<f64>) -> String {
    value.map_or("–".into(), |value| if value < 10.0 { format!("{value:.2}") } else { format!("{value:.0}") })
}

/// The four cases of one encoder and bandwidth, side by side.
struct Line<'a>(Vec<&'a Row>);

impl Line<'_> {
    fn all(rows: &[Row]) -> Vec<Line<'_>> {
        rows.chunks(Case::ALL.len()).map(|rows| Line(rows.iter().collect())).collect()
    }

    fn text(&self, of: impl Fn(&Row) -> String) -> String {
        self.0.first().map_or_else(String::new, |row| of(row))
    }

    fn cell(&self, case: Case, of: fn(&Row) -> Option<f64>) -> String {
        um(self.0.get(case as usize).and_then(|row| of(row)))
    }

    fn beside(&self, case: Case) -> String {
        let printed = self.cell(case, |row| row.printed_um);
        format!("{} ({printed})", self.cell(case, |row| Some(row.helix_max_abs_um)))
    }
}

/// A table of lines: what stands in the cell of a case.
fn side_by_side(title: &str, lines: &[Line], cell: fn(&Line, Case) -> String) -> Table {
    let head = [["lines", ""], ["bandwidth_hz", "Hz"]].map(|words| words.map(str::to_owned));
    let cases = Case::ALL.map(|case| [case.name().to_owned(), "µm".to_owned()]);
    let row = |line: &Line| {
        let inputs = [line.text(|row| row.lines.to_string()), line.text(|row| six(row.bandwidth_hz))];
        inputs.into_iter().chain(Case::ALL.map(|case| cell(line, case))).collect()
    };
    Table {
        title: title.into(),
        caption: String::new(),
        head: head.into_iter().chain(cases).collect(),
        rows: lines.iter().map(row).collect(),
        place: Place::Everywhere,
    }
}

const COLUMNS: [Column<Row>; 7] = [
    Column { name: "lines", unit: "", cell: |row| row.lines.to_string() },
    Column { name: "bandwidth_hz", unit: "Hz", cell: |row| six(row.bandwidth_hz) },
    Column { name: "case", unit: "", cell: |row| row.case.name().into() },
    Column { name: "helix_max_abs_um", unit: "µm", cell: |row| um(Some(row.helix_max_abs_um)) },
    Column { name: "helix_worst_um", unit: "µm", cell: |row| um(Some(row.helix_worst_um)) },
    Column { name: "printed_um", unit: "µm", cell: |row| um(row.printed_um) },
    Column { name: "machine_helix_max_abs_um", unit: "µm", cell: |row| um(row.machine_helix_max_abs_um) },
];

fn tables(rows: &[Row]) -> Vec<Table> {
    let (printed, others): (Vec<Line>, Vec<Line>) =
        Line::all(rows).into_iter().partition(|line| line.0.iter().any(|row| row.printed_um.is_some()));
    let cut: Vec<Line> = Line::all(rows)
        .into_iter()
        .filter(|line| line.0.iter().any(|row| row.machine_helix_max_abs_um.is_some()))
        .collect();
    vec![
        side_by_side("The observer alone at 1 kHz, and the reference in brackets", &printed, |line, case| line.beside(case))
            .with_caption("Largest error of the helix, median over nine places of the counts."),
        side_by_side("Other encoders and bandwidths, the observer alone", &others, |line, case| {
            line.cell(case, |row| Some(row.helix_max_abs_um))
        })
        .at(Place::Page),
        side_by_side("The whole machine", &cut, |line, case| {
            line.cell(case, |row| row.machine_helix_max_abs_um)
        })
        .with_caption("Largest error of true Z against the true helix in a pass, without cutting force; worst of three seeds."),
        Table::of("Every row", &COLUMNS, rows).at(Place::Details),
    ]
}
