//! Experiment `resolution`: what rounded positions do to speed, acceleration and servo error. In: a machine.
//! Out: a row for each quantum of position, beside the reference simulation; and the figures of the published
//! method, computed. Source of these: "Investigation of the required discreteness of interpolation movement
//! parameters in cyber-physical systems"; its formulas are M28–M35, in `adviser::resolution`.
//!
//! The pass is that of `experiment approach` at 100 %. The regulator of X rounds positions to the quantum,
//! makes speed and acceleration by differences of them about the lead of each feedforward, and holds its
//! output for two control cycles (`difference-va`, centred). Every figure is the median of several seeds.

mod figures;
mod measure;
mod published;
mod reference;
#[cfg(test)]
mod tests;
mod text;

use machine::{Difference, Feedforward, Machine};
use protocol::Axis;
use serde::Serialize;

use report::table::{Column, Place, Table};

use super::{Findings, stand::Stand};
use crate::ExperimentError;
use measure::{Measured, measure};

/// Quanta of position, mm.
pub(super) const QUANTA_MM: [f64; 9] = [1e-2, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];

/// Control cycles for which a position is held.
const HOLD_CYCLES: u32 = 2;

/// Seeds of a row, beginning with that of the experiment.
const SEEDS: u64 = 10;

/// Errors beyond which X is stopped, mm: wide enough for a quantum of 1e-2 mm.
const WIDE_MM: f64 = 10.0;

/// Inputs and figures of one case, medians over the seeds.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    /// `None`: the law itself, not rounded and not held.
    quantum_mm: Option<f64>,
    approach_min_um: f64,
    approach_max_um: f64,
    end_um: f64,
    torque_noise_nm: f64,
    thread_max_abs_um: f64,
    /// Least and largest servo error in the approach of any seed.
    approach_lowest_um: f64,
    approach_highest_um: f64,
    seeds: u64,
}

/// Median of a figure.
fn median(measured: &[Measured], of: impl Fn(&Measured) -> f64) -> f64 {
    let mut values: Vec<f64> = measured.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    let middle = |index: usize| values.get(index).copied().unwrap_or_default();
    0.5 * (middle(values.len().saturating_sub(1) / 2) + middle(values.len() / 2))
}

impl Row {
    fn of(quantum_mm: Option<f64>, measured: &[Measured]) -> Row {
        let lowest = measured.iter().map(|m| m.approach_min_um).fold(0.0, f64::min);
        let highest = measured.iter().map(|m| m.approach_max_um).fold(0.0, f64::max);
        Row {
            quantum_mm,
            approach_min_um: median(measured, |m| m.approach_min_um),
            approach_max_um: median(measured, |m| m.approach_max_um),
            end_um: median(measured, |m| m.end_um),
            torque_noise_nm: median(measured, |m| m.torque_noise_nm),
            thread_max_abs_um: median(measured, |m| m.thread_max_abs_um),
            approach_lowest_um: lowest,
            approach_highest_um: highest,
            seeds: measured.len() as u64,
        }
    }

    /// Larger magnitude of the two ends of the approach, µm.
    fn approach_abs_um(&self) -> f64 {
        self.approach_max_um.max(-self.approach_min_um)
    }
}

/// A machine whose X sees positions in a quantum, or the law itself, with leads that are so much longer.
fn rounding(machine: &Machine, quantum_mm: Option<f64>, longer_s: f64) -> Machine {
    let mut machine = machine.clone();
    if let Some(x) = machine.axis.get_mut(&Axis::X) {
        (x.following_error_mm, x.thread_error_mm) = (WIDE_MM, WIDE_MM);
        x.velocity_lead_s += longer_s;
        x.acceleration_lead_s += longer_s;
        x.feedforward = Feedforward::Full;
        if let Some(quantum_mm) = quantum_mm {
            x.feedforward = Feedforward::DifferenceVa;
            x.difference = Difference { quantum_mm, cycles: HOLD_CYCLES, centred: true };
        }
    }
    machine
}

/// Quanta on a machine, and the law itself last.
struct Series {
    rows: Vec<Row>,
    /// The passes of the first seed, in the order of the rows.
    first: Vec<Measured>,
}

/// Runs every quantum and the law itself with every seed.
fn series(
    stand: &Stand,
    machine: &Machine,
    quanta: &[f64],
    longer_s: f64,
) -> Result<Series, ExperimentError> {
    let quanta: Vec<Option<f64>> = quanta.iter().copied().map(Some).chain([None]).collect();
    let with_seeds = |quantum: &Option<f64>| {
        let machine = rounding(machine, *quantum, if quantum.is_some() { longer_s } else { 0.0 });
        (0..SEEDS).map(move |n| (machine.clone(), stand.seed.wrapping_add(n)))
    };
    let cases: Vec<(Machine, u64)> = quanta.iter().flat_map(with_seeds).collect();
    let measured = stand.each(&cases, |(machine, seed)| measure(machine, *seed))?;
    let of_quantum: Vec<&[Measured]> = measured.chunks(SEEDS as usize).collect();
    Ok(Series {
        rows: quanta.iter().zip(&of_quantum).map(|(quantum, measured)| Row::of(*quantum, measured)).collect(),
        first: of_quantum.iter().filter_map(|measured| measured.first().cloned()).collect(),
    })
}

/// Makes the experiment.
///
/// # Errors
/// The machine cannot make the pass.
pub(super) fn findings(stand: &Stand) -> Result<Findings<Row>, ExperimentError> {
    let own = series(stand, &stand.machine, &QUANTA_MM, 0.0)?;
    let beside = reference::beside(stand)?;
    let tables = vec![
        table(&own.rows),
        published::required(),
        published::wire(&stand.machine).at(Place::Page),
        reference::table(&beside).at(Place::Page),
        reference::leads(&beside).at(Place::Page),
        published::feed_error().at(Place::Details),
        published::positions().at(Place::Details),
        published::internal().at(Place::Details),
        published::start_of_motion().at(Place::Details),
    ];
    Ok(Findings {
        title: "What the resolution of positions does to a motion",
        short: text::short(&own.rows),
        done: text::done(),
        tables,
        notes: Vec::new(),
        figures: figures::all(&stand.machine, &own),
        text: text::meaning(&own.rows, &beside),
        rows: own.rows.into_iter().filter(|row| row.quantum_mm.is_some()).collect(),
    })
}

/// A quantum as it is read.
fn quantum(row: &Row) -> String {
    row.quantum_mm.map_or("the law itself".into(), |mm| format!("{mm:e}"))
}

/// Micrometres with their sign.
fn um(value: f64) -> String {
    format!("{value:+.2}")
}

/// Two ends of a range, µm.
fn span(low: f64, high: f64) -> String {
    format!("{low:+.1} … {high:+.1}")
}

/// Newton metres, two significant digits.
fn nm(value: f64) -> String {
    format!("{value:.1e}").parse::<f64>().unwrap_or(value).to_string()
}

fn table(rows: &[Row]) -> Table {
    let columns: [Column<Row>; 6] = [
        Column { name: "quantum", unit: "mm", cell: quantum },
        Column { name: "approach", unit: "µm", cell: |row| span(row.approach_min_um, row.approach_max_um) },
        Column {
            name: "of any seed",
            unit: "µm",
            cell: |row| span(row.approach_lowest_um, row.approach_highest_um),
        },
        Column { name: "end", unit: "µm", cell: |row| um(row.end_um) },
        Column { name: "thread", unit: "µm", cell: |row| format!("{:.2}", row.thread_max_abs_um) },
        Column { name: "torque noise", unit: "N·m", cell: |row| nm(row.torque_noise_nm) },
    ];
    Table::of("Servo error of X with speed and acceleration by differences of rounded positions", &columns, rows)
        .with_caption(format!(
            "Medians of {SEEDS} seeds. Thread: largest magnitude from one turn after the approach on. Torque noise: \
             rms of the step of the torque that the drive asks for, from one position to the next, in the approach."
        ))
}
