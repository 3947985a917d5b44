//! Experiment `observer`: how well the spindle's angle is known from its encoder, and what that makes of a
//! helix. In: a machine. Out: a row for each encoder, bandwidth and case, error of the helix in µm at a lead
//! of 5 mm; beside the figures of the reference.
//!
//! | case | the spindle |
//! |---|---|
//! | constant | 500 1/min |
//! | override-ramp | from 500 to 300 1/min within 0.3 s |
//! | dip | loses 3 % of 500 1/min within 15 ms |
//! | slow | 0.2 1/min |
//! | force | 500 1/min, while a force of 200 N on Z comes on within 10 ms |

mod alone;
mod figures;
mod goals;
mod machine;
#[cfg(test)]
mod tests;
mod text;

use ::machine::Machine;
use serde::Serialize;

use report::table::{Column, Place, Table, six};

use super::{Findings, stand::Stand};
use crate::ExperimentError;
use alone::Kind;
use goals::Goal;

/// Lead of the helix, mm.
const LEAD_MM: f64 = 5.0;
/// Lines of the encoders.
const LINES: [u32; 9] = [25, 100, 512, 1024, 2500, 5000, 10_000, 25_000, 250_000];
/// Bandwidths of the observer, Hz.
const BANDWIDTHS_HZ: [f64; 3] = [20.0, 30.0, 40.0];
/// Encoders that are also looked at with the bandwidth of the machine file.
const AT_OWN_BANDWIDTH: [u32; 3] = [1024, 2500, 5000];
/// Encoder for which there are goals.
const ASKED_LINES: u32 = 2500;
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
    Force,
}

impl Case {
    const ALL: [Case; 5] = [Case::Constant, Case::OverrideRamp, Case::Dip, Case::Slow, Case::Force];
    /// Those in which the spindle alone says what happens.
    const ALONE: [Case; 4] = [Case::Constant, Case::OverrideRamp, Case::Dip, Case::Slow];

    fn name(self) -> &'static str {
        ["constant", "override-ramp", "dip", "slow", "force"][self as usize]
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
    /// True Z beside the true helix in a pass on the whole machine, largest of some seeds; null where none
    /// was cut.
    helix_max_abs_um: Option<f64>,
    /// The regulator's observer alone at 1 kHz, median over where the counts lie; and the largest of any
    /// place.
    observer_max_abs_um: f64,
    observer_worst_um: f64,
    /// The same median for the observer of the reference.
    m53_max_abs_um: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    printed_um: Option<f64>,
}

impl Row {
    fn of(&(lines, bandwidth_hz, case): &(u32, f64, Case)) -> Row {
        let used = alone::errors(Kind::Used, lines, bandwidth_hz, case);
        let printed = PRINTED.iter().find(|row| (row.0, row.1) == (lines, bandwidth_hz));
        Row {
            lines,
            bandwidth_hz,
            lead_mm: LEAD_MM,
            case,
            helix_max_abs_um: None,
            observer_max_abs_um: used.typical_um,
            observer_worst_um: used.worst_um,
            m53_max_abs_um: alone::errors(Kind::Plain, lines, bandwidth_hz, case).typical_um,
            printed_um: printed.and_then(|row| row.2.get(case as usize)).copied(),
        }
    }

    fn is_of(&self, lines: u32, bandwidth_hz: f64, case: Case) -> bool {
        (self.lines, self.bandwidth_hz, self.case) == (lines, bandwidth_hz, case)
    }
}

/// Every case: each encoder with each bandwidth; those of the machine and those that are asked for among
/// them.
fn cases(machine: &Machine) -> Vec<(u32, f64, Case)> {
    let (own_lines, own_hz) = (machine.spindle.encoder_lines, machine.spindle.observer_hz);
    let mut pairs: Vec<(u32, f64)> =
        LINES.into_iter().flat_map(|lines| BANDWIDTHS_HZ.map(|bandwidth_hz| (lines, bandwidth_hz))).collect();
    for lines in AT_OWN_BANDWIDTH.into_iter().chain([ASKED_LINES, own_lines]) {
        if !pairs.contains(&(lines, own_hz)) {
            pairs.push((lines, own_hz));
        }
    }
    pairs.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let of_pair = |(lines, bandwidth_hz)| Case::ALL.map(|case| (lines, bandwidth_hz, case));
    pairs.into_iter().flat_map(of_pair).collect()
}

/// Cuts the passes of every row, and puts in what was found. Gives a note for each encoder with which the
/// machine does not come to the end of a pass.
///
/// A turn of the slow case takes five minutes on the machine: it is cut with the machine's own bandwidth, at
/// one seed.
fn cut(stand: &Stand, rows: &mut [Row]) -> Result<Vec<String>, ExperimentError> {
    let own_hz = stand.machine.spindle.observer_hz;
    let seeds = |row: &Row| match row.case {
        Case::Slow if row.bandwidth_hz == own_hz => 1,
        Case::Slow => 0,
        _ => SEEDS,
    };
    let passes: Vec<(usize, u64)> = rows
        .iter()
        .enumerate()
        .flat_map(|(index, row)| (0..seeds(row)).map(move |n| (index, stand.seed.wrapping_add(n))))
        .collect();
    let shown: &[Row] = rows;
    let reports = stand.each(&passes, |&(index, seed)| match shown.get(index) {
        Some(row) => machine::pass(&stand.machine, row.lines, row.bandwidth_hz, row.case, seed),
        None => Ok(Err(String::new())),
    })?;
    let mut notes: Vec<(u32, String)> = Vec::new();
    for (index, row) in rows.iter_mut().enumerate() {
        let of_row =
            || passes.iter().zip(&reports).filter(|(pass, _)| pass.0 == index).map(|(_, report)| report);
        match of_row().find_map(|report| report.as_ref().err()) {
            Some(fault) if notes.iter().all(|(lines, _)| *lines != row.lines) => {
                let (lines, case) = (row.lines, row.case.name());
                notes.push((lines, format!("{lines} lines, {case}: the machine stops in the pass: {fault}")));
            }
            Some(_) => {}
            None => {
                let helix = of_row().flatten().map(|report| report.helix_max_abs_um);
                row.helix_max_abs_um = helix.reduce(f64::max);
            }
        }
    }
    Ok(notes.into_iter().map(|(_, note)| note).collect())
}

/// Makes the experiment.
///
/// # Errors
/// The machine cannot cut the passes.
pub(super) fn findings(stand: &Stand) -> Result<Findings<Row>, ExperimentError> {
    let mut rows = stand.each(&cases(&stand.machine), |case| Ok(Row::of(case)))?;
    let notes = cut(stand, &mut rows)?;
    let own_hz = stand.machine.spindle.observer_hz;
    let goals = goals::all(&rows, own_hz);
    Ok(Findings {
        title: "The spindle's angle from its encoder",
        short: text::short(&goals, own_hz),
        done: text::done(stand),
        tables: tables(&rows, &goals, own_hz),
        notes,
        figures: figures::all(),
        text: text::meaning(&rows),
        rows,
    })
}

fn um(value: Option<f64>) -> String {
    value.map_or("–".into(), |value| if value < 10.0 { format!("{value:.2}") } else { format!("{value:.0}") })
}

/// The cases of one encoder and bandwidth, side by side.
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

    fn beside(line: &Line, case: Case) -> String {
        let printed = line.cell(case, |row| row.printed_um);
        format!("{} ({printed})", line.cell(case, |row| Some(row.m53_max_abs_um)))
    }
}

/// A table of lines: what stands in the cell of a case.
fn side_by_side(title: &str, cases: &[Case], lines: &[Line], cell: fn(&Line, Case) -> String) -> Table {
    let head = [["lines", ""], ["bandwidth_hz", "Hz"]].map(|words| words.map(str::to_owned));
    let names = cases.iter().map(|case| [case.name().to_owned(), "µm".to_owned()]);
    let row = |line: &Line| {
        let inputs = [line.text(|row| row.lines.to_string()), line.text(|row| six(row.bandwidth_hz))];
        inputs.into_iter().chain(cases.iter().map(|case| cell(line, *case))).collect()
    };
    Table {
        title: title.into(),
        caption: String::new(),
        head: head.into_iter().chain(names).collect(),
        rows: lines.iter().map(row).collect(),
        place: Place::Everywhere,
    }
}

const COLUMNS: [Column<Row>; 8] = [
    Column { name: "lines", unit: "", cell: |row| row.lines.to_string() },
    Column { name: "bandwidth_hz", unit: "Hz", cell: |row| six(row.bandwidth_hz) },
    Column { name: "case", unit: "", cell: |row| row.case.name().into() },
    Column { name: "helix_max_abs_um", unit: "µm", cell: |row| um(row.helix_max_abs_um) },
    Column { name: "observer_max_abs_um", unit: "µm", cell: |row| um(Some(row.observer_max_abs_um)) },
    Column { name: "observer_worst_um", unit: "µm", cell: |row| um(Some(row.observer_worst_um)) },
    Column { name: "m53_max_abs_um", unit: "µm", cell: |row| um(Some(row.m53_max_abs_um)) },
    Column { name: "printed_um", unit: "µm", cell: |row| um(row.printed_um) },
];

fn tables(rows: &[Row], goals: &[Goal], own_hz: f64) -> Vec<Table> {
    let lines = Line::all(rows);
    let printed: Vec<Line> = Line::all(rows)
        .into_iter()
        .filter(|line| line.0.iter().any(|row| row.printed_um.is_some()))
        .collect();
    vec![
        Table::of("What is asked for", &goals::COLUMNS, goals).with_caption(format!(
            "Largest error of true Z against the true helix on the whole machine, {ASKED_LINES} lines, {} Hz, lead {LEAD_MM} \
             mm; worst of {SEEDS} seeds, slow: of one.",
            six(own_hz)
        )),
        side_by_side("The whole machine", &Case::ALL, &lines, |line, case| {
            line.cell(case, |row| row.helix_max_abs_um)
        })
        .with_caption("The same for every encoder and bandwidth. –: no pass was cut, or the machine stopped in it."),
        side_by_side(
            "The observer of the reference alone at 1 kHz, and the reference in brackets",
            &Case::ALONE,
            &printed,
            Line::beside,
        )
        .with_caption("Largest error of the helix, median over nine places of the counts."),
        side_by_side("The observer of the regulator alone at 1 kHz", &Case::ALONE, &lines, |line, case| {
            line.cell(case, |row| Some(row.observer_max_abs_um))
        })
        .with_caption("Largest error of the helix, median over nine places of the counts.")
        .at(Place::Page),
        Table::of("Every row", &COLUMNS, rows).at(Place::Details),
    ]
}
