//! What threads will be, before anything is cut: `pitchlock check --certify`. In: a program that was judged
//! and is good. Out: a row for every pass, as text, JSON and a page.
//!
//! Run-in, run-out and what the axes can follow are those of the plan. Forces and errors are measured: the
//! whole program is run once, in virtual time and in this process, on the simulated machine of the machine
//! file. Somebody stands there who goes on after every pause of the program.

mod page;
mod taps;

use std::{collections::BTreeMap, fmt::Write as _, path::Path};

use interpreter::{Language, PassNote};
use machine::Machine;
use protocol::operator::Request;
use report::table::{Column, Table};
use rig::{
    Rig,
    observe::{Outcome, PartVerdict, PassReport, Summary},
};
use serde::Serialize;

use crate::{error::CliError, program::Program, varied, words::Phase};

use taps::Tap;

pub(crate) use page::html;

/// A program that takes so much longer than was foretold waits for something that does not come.
const PATIENCE: f64 = 2.0;
const PATIENCE_S: f64 = 60.0;
/// Control cycles between two looks at a pause.
const LOOK_EVERY: u64 = 64;

/// What was found out about the threads of a program.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Certificate {
    /// Of everything random about the simulated machine.
    seed: u64,
    /// How the run ended.
    outcome: Outcome,
    /// What the part is, as `summary.json` of a run says it.
    verdict: PartVerdict,
    reasons: Vec<String>,
    /// The sentence of the gauge.
    gauge: Option<String>,
    /// What somebody should know before cutting.
    notes: Vec<String>,
    passes: Vec<Row>,
    taps: Vec<Tap>,
}

/// A pass. Lengths in mm, X a radius; `None`: nobody knows, or the tool touches nothing.
#[derive(Clone, Debug, Serialize)]
struct Row {
    pass: u32,
    line: u32,
    /// Programmed speed, 1/min.
    rpm: f64,
    /// Way along the thread while the lead is reached, and while it is left.
    run_in_mm: f64,
    run_out_mm: f64,
    /// The highest speed that the axes can follow, 1/min, and per cent of the programmed one.
    highest_rpm: f64,
    highest_override_pct: f64,
    /// How much deeper than the last pass of its start, and its chip thickness (M208).
    deeper_mm: Option<f64>,
    chip_mm: Option<f64>,
    /// The largest of each.
    force_n: Option<f64>,
    torque_nm: Option<f64>,
    power_kw: Option<f64>,
    /// At the tool: helix error about its mean, and error of depth, largest magnitude.
    helix_um: Option<f64>,
    depth_um: Option<f64>,
}

/// Cuts a program that has no errors on the simulated machine; nothing of one without a thread.
///
/// # Errors
/// The program cannot be read again, or the plant of the machine file cannot be.
pub(crate) fn certify(
    program: &Program,
    path: &Path,
    language: &Language,
    machine: &Machine,
    seed: u64,
) -> Result<Option<Certificate>, CliError> {
    let notes = program.check.as_ref().map_or(&[][..], |check| &check.passes);
    if program.passes() == 0 {
        return Ok(None);
    }
    let (summary, waits) = cut(program, path, language, machine, seed)?;
    let passes = rows(&summary, notes, machine, &program.chips_mm);
    let mut remarks = Vec::new();
    if waits {
        remarks.push(
            "the program did not end: it waits for an input, or for the operator; certified is what came before"
                .into(),
        );
    }
    remarks.extend(varied::lines(notes));
    remarks.extend(summary.faults.iter().map(|fault| format!("fault {}: {}", fault.code, fault.text)));
    let taps = taps::rows(&summary);
    if !taps.is_empty() {
        remarks.push("no torque of a tap: the simulated machine has none".into());
    }
    if !passes.is_empty() && passes.iter().all(|row| row.force_n.is_none()) {
        let text = "no forces: the tool cuts air (plant.cutting.specific_force_n_mm2 is about 2000 for steel), or the \
                    program does not tell the depth of a single pass (G33, or G32 and G92 of FANUC)";
        remarks.push(text.into());
    }
    let rubs = program.diagnostics().iter().filter(|one| one.code == "thin-chip");
    remarks.extend(rubs.map(|one| format!("line {}: {}; {}", one.line, one.message, one.help)));
    Ok(Some(Certificate {
        seed,
        outcome: summary.outcome,
        verdict: summary.part.verdict,
        reasons: summary.part.reasons.clone(),
        gauge: judges(&summary),
        notes: remarks,
        passes,
        taps,
    }))
}

/// What the gauge and the drawing of the groove say, if there is one of them.
fn judges(summary: &Summary) -> Option<String> {
    let gauge = summary.gauged().iter().map(|gauge| gauge.sentence());
    let groove = summary.groove.iter().map(|groove| format!("groove {}", groove.sentence()));
    gauge.chain(groove).reduce(|all, more| format!("{all}; {more}"))
}

/// The run; and whether it had to be broken off.
fn cut(
    program: &Program,
    path: &Path,
    language: &Language,
    machine: &Machine,
    seed: u64,
) -> Result<(Summary, bool), CliError> {
    let _shown = Phase::begin("cutting it on the simulated machine");
    let mut unread = None;
    let items = program.items(path, language, machine)?;
    // What stands behind an error is not cut.
    let items = items.map_while(|item| item.map_err(|text| unread = Some(text)).ok()).fuse();
    let scenario = sim_plant::Scenario::default();
    let mut rig =
        Rig::new(machine, items, scenario, seed).map_err(|error| CliError::Input(error.to_string()))?;
    let mut observer = program.observer(machine);
    let most = ((program.time_s * PATIENCE + PATIENCE_S) / machine.general.cycle_s) as u64;
    let (mut asked, mut goes_on) = (None, true);
    for cycle in 0..most {
        goes_on = rig.cycle(asked.take(), |record| {
            observer.cycle(record);
            Phase::at(record.machine.line);
            let pauses = cycle % LOOK_EVERY == 0 && record.machine.state().waits_for_start();
            asked = pauses.then_some(Request::CycleStart);
        });
        if !goes_on {
            break;
        }
    }
    drop(rig);
    // It was good when it was checked: it has changed since.
    if let Some(text) = unread {
        return Err(CliError::file(path, text));
    }
    Ok((observer.finish().summary(&path.display().to_string(), "virtual"), goes_on))
}

/// A row for every pass that was turned, each by its last attempt.
fn rows(summary: &Summary, notes: &[PassNote], machine: &Machine, chips_mm: &BTreeMap<u32, f64>) -> Vec<Row> {
    let of_pass: BTreeMap<u32, &PassNote> = notes.iter().map(|note| (note.pass, note)).collect();
    let row = |report: &PassReport| {
        let note = of_pass.get(&report.pass);
        let touched = report.tool.contact_deg > 0.0;
        let cutting = report.cutting.as_ref();
        // Where the speed is varied, that of its mean, as `check` tells it.
        let pct = note.map_or(report.max_feasible_override_pct, |note| note.max_override_pct);
        let by_limits = report.programmed_rpm * pct / 100.0;
        Row {
            pass: report.pass,
            line: report.line,
            rpm: report.programmed_rpm,
            run_in_mm: note.map_or(report.delta_z_mm.abs(), |note| note.delta_mm[0].abs()),
            run_out_mm: note.map_or(f64::NAN, |note| note.delta_mm[1].abs()),
            highest_rpm: by_limits.min(machine.spindle.max_rpm),
            highest_override_pct: pct,
            deeper_mm: note.and_then(|note| note.infeed_mm).map(|[deeper, _]| deeper),
            chip_mm: chips_mm.get(&report.pass).copied(),
            force_n: cutting.map(|cutting| cutting.force_max_n),
            torque_nm: cutting.map(|cutting| cutting.torque_max_nm),
            power_kw: cutting.map(|cutting| cutting.power_max_kw),
            helix_um: touched.then_some(report.tool.helix_max_abs_um),
            depth_um: touched.then_some(report.tool.x_max_um.max(-report.tool.x_min_um)),
        }
    };
    summary.last_attempts().filter(|report| report.tap.is_none()).map(row).collect()
}

impl Certificate {
    /// One sentence.
    fn sentence(&self) -> String {
        let how = match self.outcome {
            Outcome::Completed => "",
            Outcome::Faulted => ", and ended with a fault",
            Outcome::Stopped => ", and was stopped",
        };
        let part = match self.verdict {
            PartVerdict::Good => "good",
            PartVerdict::Bad => "not good",
            PartVerdict::None if self.outcome != Outcome::Completed => "not judged: it is not finished",
            PartVerdict::None if self.gauge.is_some() => "not judged: its gauge has no verdict",
            PartVerdict::None => "not judged: the tool touched no material",
        };
        format!("cut once on the simulated machine, seed {}{how}: the part is {part}", self.seed)
    }

    /// The tables of passes and of taps, those that there are.
    fn tables(&self) -> impl Iterator<Item = Table> {
        let caption = page::COLUMNS;
        let passes = || Table::of("Passes", &COLUMNS, &self.passes).with_caption(caption);
        (!self.passes.is_empty()).then(passes).into_iter().chain(taps::table(&self.taps))
    }

    /// What people see.
    pub(crate) fn text(&self) -> String {
        let mut text = format!("certificate: {}\n", self.sentence());
        let what = if self.verdict == PartVerdict::Bad { "not good" } else { "no verdict" };
        self.reasons.iter().for_each(|reason| {
            let _ = writeln!(text, "  {what}: {reason}");
        });
        if let Some(gauge) = &self.gauge {
            let _ = writeln!(text, "  gauge: {gauge}");
        }
        self.tables().for_each(|table| text += &table.text());
        self.notes.iter().for_each(|note| {
            let _ = writeln!(text, "note: {note}");
        });
        text
    }

    /// Class of the style sheet.
    fn class(&self) -> &'static str {
        match self.is_good() {
            true if self.verdict == PartVerdict::None => "look",
            true => "good",
            false => "bad",
        }
    }

    /// Whether nothing speaks against the part, and the program comes to its end.
    pub(crate) fn is_good(&self) -> bool {
        self.outcome == Outcome::Completed && self.reasons.is_empty()
    }
}

const COLUMNS: [Column<Row>; 14] = [
    Column { name: "pass", unit: "", cell: |row| row.pass.to_string() },
    Column { name: "line", unit: "", cell: |row| row.line.to_string() },
    Column { name: "S", unit: "1/min", cell: |row| format!("{:.0}", row.rpm) },
    Column { name: "run-in", unit: "mm", cell: |row| places(Some(row.run_in_mm), 3) },
    Column { name: "run-out", unit: "mm", cell: |row| places(Some(row.run_out_mm), 3) },
    Column { name: "most S", unit: "1/min", cell: |row| format!("{:.0}", row.highest_rpm) },
    Column { name: "override", unit: "%", cell: |row| format!("{:.0}", row.highest_override_pct) },
    Column { name: "deeper", unit: "mm", cell: |row| places(row.deeper_mm, 3) },
    Column { name: "chip", unit: "mm", cell: |row| places(row.chip_mm, 3) },
    Column { name: "force", unit: "N", cell: |row| places(row.force_n, 0) },
    Column { name: "torque", unit: "N·m", cell: |row| places(row.torque_nm, 2) },
    Column { name: "power", unit: "kW", cell: |row| places(row.power_kw, 2) },
    Column { name: "helix", unit: "µm", cell: |row| places(row.helix_um, 2) },
    Column { name: "depth", unit: "µm", cell: |row| places(row.depth_um, 2) },
];

/// A number with so many places; a dash where nobody knows it.
fn places(value: Option<f64>, digits: usize) -> String {
    value.filter(|value| value.is_finite()).map_or("–".into(), |value| format!("{value:.digits$}"))
}
