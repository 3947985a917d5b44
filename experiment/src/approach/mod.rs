//! Experiment `approach`: X moves to depth in step with the spindle, 5 mm in one turn at 300 1/min, and the
//! spindle override stands at 120, 100, 80, 60 or 40 %. In: a machine. Out: servo error and torque of X for
//! each structure of feedforward, beside what was published. Source: "Smooth acceleration of transverse axis
//! movements in CNC threading machining"; its law is M1–M8.
//!
//! | figure | is taken |
//! |---|---|
//! | approach | while X is under its stroke |
//! | end | in the first control cycle after the stroke |
//! | thread | from one turn later, when the approach has died away, to the end of the thread |
//!
//! The servo error is the analytic reference minus the measurement of the same instant.

mod figures;
mod goals;
mod measure;
mod published;
mod text;

use machine::{Feedforward, Machine};
use protocol::Axis;
use serde::Serialize;
use sim_plant::Belief;

use report::table::{Column, Place, Table};

use super::{Findings, stand::Stand};
use crate::ExperimentError;
use measure::{Measured, measure};

/// Every structure, from the barest to the one that is used.
pub(super) const STRUCTURES: [Feedforward; 6] = [
    Feedforward::None,
    Feedforward::DifferenceV,
    Feedforward::DifferenceVa,
    Feedforward::AnalyticV,
    Feedforward::AnalyticVaNoLead,
    Feedforward::Full,
];

/// Positions of the override knob, per cent.
pub(super) const OVERRIDES: [f64; 5] = [120.0, 100.0, 80.0, 60.0, 40.0];

/// Seeds over which chance is looked at, beginning with that of the experiment.
const SEEDS: u64 = 10;

/// Errors beyond which a machine is stopped, mm: wide enough for structures that are made only to be compared
/// with.
const WIDE_MM: f64 = 10.0;

/// Inputs and figures of one case.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    structure: Feedforward,
    override_pct: f64,
    tuned: bool,
    approach_min_um: f64,
    approach_max_um: f64,
    end_um: f64,
    thread_max_abs_um: f64,
    torque_peak_nm: f64,
    /// Largest magnitude from the end of the approach on.
    at_depth_max_abs_um: f64,
    torque_noise_nm: f64,
}

/// One pass to be run.
#[derive(Debug)]
struct Case {
    structure: Feedforward,
    override_pct: f64,
    tuned: bool,
    machine: Machine,
    seed: u64,
}

/// The pass and what was measured of it.
struct Done {
    row: Row,
    measured: Measured,
}

impl Case {
    fn run(&self) -> Result<Done, ExperimentError> {
        let measured = measure(&self.machine, self.override_pct, self.seed)?;
        let error = &measured.error;
        let row = Row {
            structure: self.structure,
            override_pct: self.override_pct,
            tuned: self.tuned,
            approach_min_um: error.approach_min_um,
            approach_max_um: error.approach_max_um,
            end_um: error.end_um,
            thread_max_abs_um: error.settled_max_abs_um,
            torque_peak_nm: measured.torque_peak_nm,
            at_depth_max_abs_um: error.thread_max_abs_um,
            torque_noise_nm: measured.torque_noise_nm,
        };
        Ok(Done { row, measured })
    }
}

/// A machine whose X is fed forward by a structure.
fn with_structure(machine: &Machine, structure: Feedforward) -> Machine {
    let mut machine = machine.clone();
    if let Some(x) = machine.axis.get_mut(&Axis::X) {
        x.feedforward = structure;
        if structure != Feedforward::Full {
            (x.following_error_mm, x.thread_error_mm) = (WIDE_MM, WIDE_MM);
        }
    }
    machine
}

/// What a controller of X would know that knew everything.
fn truth(machine: &Machine) -> Result<Belief, ExperimentError> {
    Belief::of_truth(machine, Axis::X).map_err(|error| ExperimentError::Input(error.to_string()))
}

/// Every structure at each of the overrides on a machine.
fn cases(machine: &Machine, overrides: &[f64], seed: u64) -> Vec<Case> {
    let each = |structure| {
        let machine = with_structure(machine, structure);
        let case = move |&override_pct: &f64| Case {
            structure,
            override_pct,
            tuned: false,
            machine: machine.clone(),
            seed,
        };
        overrides.iter().map(case)
    };
    STRUCTURES.into_iter().flat_map(each).collect()
}

/// The structure that is used, at every override.
fn of_full(machine: &Machine, tuned: bool, seed: u64) -> impl Iterator<Item = Case> {
    let machine = with_structure(machine, Feedforward::Full);
    OVERRIDES.into_iter().map(move |override_pct| Case {
        structure: Feedforward::Full,
        override_pct,
        tuned,
        machine: machine.clone(),
        seed,
    })
}

/// The name of a structure, as machine files spell it.
fn name(structure: Feedforward) -> &'static str {
    match structure {
        Feedforward::None => "none",
        Feedforward::DifferenceV => "difference-v",
        Feedforward::DifferenceVa => "difference-va",
        Feedforward::AnalyticV => "analytic-v",
        Feedforward::AnalyticVaNoLead => "analytic-va-no-lead",
        Feedforward::Full => "full",
    }
}

/// Runs every case.
///
/// # Errors
/// As [`Stand::run`]; the machine cannot be tuned.
pub(super) fn findings(stand: &Stand) -> Result<Findings<Row>, ExperimentError> {
    let (machine, seed) = (&stand.machine, stand.seed);
    let tuned =
        rig::bench::tuned(machine, seed).map_err(|error| ExperimentError::Machine(error.to_string()))?;
    let truth = truth(machine)?;
    let seeds = |n: u64| (0..n).map(move |more| seed.wrapping_add(more));
    let shown = cases(machine, &OVERRIDES, seed).into_iter().chain(of_full(&tuned, true, seed));
    let chance =
        seeds(SEEDS).flat_map(|seed| of_full(machine, false, seed).chain(of_full(&tuned, true, seed)));

    let done = stand.each(&shown.collect::<Vec<_>>(), Case::run)?;
    let chance = Chance::all(&stand.each(&chance.collect::<Vec<_>>(), Case::run)?);
    let goals = goals::all(&done, &chance);
    let tables = vec![
        condensed(&done),
        Table::of("Structure full over ten seeds", &CHANCE, &chance).with_caption(text::chance()),
        Table::of("What is asked for", &goals::COLUMNS, &goals),
        published::beside_the_paper(&done),
        Table::of("Every case", &FULL, &done).with_caption(text::full()).at(Place::Details),
    ];
    Ok(Findings {
        title: "Approach of X in step with the spindle",
        short: text::short(&done, &goals),
        done: text::done(machine, &truth),
        tables,
        notes: Vec::new(),
        figures: figures::all(&done),
        text: text::meaning(machine),
        rows: done.into_iter().map(|done| done.row).collect(),
    })
}

/// The least intervals that hold what several seeds gave, µm.
struct Chance {
    tuned: bool,
    override_pct: f64,
    approach: [f64; 2],
    end: [f64; 2],
    at_depth: f64,
    thread: f64,
}

impl Chance {
    /// Before and after tuning, at every override.
    fn all(done: &[Done]) -> Vec<Chance> {
        let each = |tuned| OVERRIDES.map(|override_pct| Chance::of(tuned, override_pct, done));
        [false, true].into_iter().flat_map(each).collect()
    }

    fn of(tuned: bool, override_pct: f64, done: &[Done]) -> Chance {
        let rows = || {
            let rows = done.iter().map(|done| &done.row);
            rows.filter(move |row| row.tuned == tuned && row.override_pct == override_pct)
        };
        let least = |of: fn(&Row) -> f64| rows().map(of).fold(f64::INFINITY, f64::min);
        let most = |of: fn(&Row) -> f64| rows().map(of).fold(f64::NEG_INFINITY, f64::max);
        Chance {
            tuned,
            override_pct,
            approach: [least(|row| row.approach_min_um), most(|row| row.approach_max_um)],
            end: [least(|row| row.end_um), most(|row| row.end_um)],
            at_depth: most(|row| row.at_depth_max_abs_um),
            thread: most(|row| row.thread_max_abs_um),
        }
    }
}

const CHANCE: [Column<Chance>; 6] = [
    Column {
        name: "machine",
        unit: "",
        cell: |row| if row.tuned { "tuned".into() } else { "as its file says".into() },
    },
    Column { name: "override", unit: "%", cell: |row| format!("{:.0}", row.override_pct) },
    Column { name: "approach", unit: "µm", cell: |row| span(row.approach) },
    Column { name: "end", unit: "µm", cell: |row| span(row.end) },
    Column { name: "at depth", unit: "± µm", cell: |row| micrometres(row.at_depth) },
    Column { name: "thread", unit: "± µm", cell: |row| micrometres(row.thread) },
];

const FULL: [Column<Done>; 9] = [
    Column { name: "structure", unit: "", cell: |done| label(&done.row) },
    Column { name: "override", unit: "%", cell: |done| format!("{:.0}", done.row.override_pct) },
    Column { name: "approach, least", unit: "µm", cell: |done| micrometres(done.row.approach_min_um) },
    Column { name: "largest", unit: "µm", cell: |done| micrometres(done.row.approach_max_um) },
    Column { name: "end", unit: "µm", cell: |done| micrometres(done.row.end_um) },
    Column { name: "at depth", unit: "± µm", cell: |done| micrometres(done.row.at_depth_max_abs_um) },
    Column { name: "thread", unit: "± µm", cell: |done| micrometres(done.row.thread_max_abs_um) },
    Column { name: "torque, peak", unit: "N·m", cell: |done| format!("{:.2}", done.row.torque_peak_nm) },
    Column { name: "torque, noise", unit: "N·m", cell: |done| format!("{:.3}", done.row.torque_noise_nm) },
];

fn label(row: &Row) -> String {
    format!("{}{}", name(row.structure), if row.tuned { ", tuned" } else { "" })
}

/// An error in two digits behind the point below 10 µm, one below 100 µm, else none.
fn micrometres(um: f64) -> String {
    let digits = if um.abs() < 9.995 { 2 } else { usize::from(um.abs() < 99.95) };
    let text = format!("{um:.digits$}");
    // What rounds to nothing has no sign.
    if text.trim_start_matches(['-', '0', '.']).is_empty() { text.replace('-', "") } else { text }
}

fn span([least, most]: [f64; 2]) -> String {
    format!("{} … {}", micrometres(least), micrometres(most))
}

/// A line a structure, an override a column: approach, then the end.
fn condensed(done: &[Done]) -> Table {
    let mut head = vec![["structure".into(), String::new()]];
    head.extend(OVERRIDES.map(|pct| [format!("override {pct:.0} %"), "µm".into()]));
    let lines = done.chunk_by(|a, b| label(&a.row) == label(&b.row)).map(|group| {
        let cell = |done: &Done| {
            let row = &done.row;
            format!("{} / {}", span([row.approach_min_um, row.approach_max_um]), micrometres(row.end_um))
        };
        group.iter().take(1).map(|done| label(&done.row)).chain(group.iter().map(cell)).collect()
    });
    Table {
        title: "Servo error of X: least … largest in the approach / at its end".into(),
        caption: text::condensed(),
        rows: lines.collect(),
        head,
        place: Place::Everywhere,
    }
}
