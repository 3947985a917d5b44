//! What threads will be, before anything is cut: `pitchlock check --certify`. In: a program that was judged
//! and is good. Out: a row for every pass, as text, JSON and a page.
//!
//! Run-in, run-out and what the axes can follow are those of the plan. Forces and errors are measured: the
//! whole program is run once, in virtual time and in this process, on the simulated machine of the machine
//! file. Somebody stands there who goes on after every pause of the program.
//!
//! ```text
//! (M208) chip on a flank  h = Δd sin φ ± Δz cos φ      the larger of both is that of a pass
//! ```
//! Δd, Δz: how much deeper, and how far along the thread, a pass goes than the last one of its start; φ the
//! angle of that flank of the tool, + on the side of higher Z. Radial infeed has h = Δd sin φ on both flanks,
//! infeed along one of them 2 Δd sin φ on the other.

mod page;
mod taps;

use std::{collections::BTreeMap, fmt::Write as _, path::Path};

use interpreter::{Language, PassNote};
use machine::Machine;
use protocol::{MachineState, operator::Request};
use report::table::{Column, Table};
use rig::{
    Rig,
    observe::{Outcome, PartVerdict, PassReport, Summary},
};
use serde::Serialize;

use crate::{error::CliError, program::Program, varied, words::Phase};

use taps::Tap;

pub(crate) use page::html;

/// Less than this deeper, an edge rubs instead of cutting, mm: what tables of makers have as the least infeed
/// of a last pass is 0.025 (Mitsubishi) to 0.05 mm (Tungaloy).
const RUBS_MM: f64 = 0.025;
/// A pass that goes no deeper than this is a spring pass, mm.
const SPRING_MM: f64 = 1e-3;
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
    let nominal = program.gauge.as_ref().map(|nominal| nominal.flank_deg);
    let passes = rows(&summary, notes, machine, nominal);
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
    for row in &passes {
        let rubs = |deeper: &f64| (SPRING_MM..RUBS_MM).contains(deeper);
        if let Some(deeper) = row.deeper_mm.filter(rubs) {
            let pass = row.pass;
            remarks.push(format!(
                "pass {pass} goes {deeper:.3} mm deeper: below {RUBS_MM} mm an edge rubs instead of cutting; take fewer \
                 passes, or a least cut"
            ));
        }
    }
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
    let gauge = summary.gauge.iter().map(|gauge| gauge.sentence());
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
            let pauses = cycle % LOOK_EVERY == 0 && record.machine.state() == MachineState::Paused;
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
fn rows(summary: &Summary, notes: &[PassNote], machine: &Machine, nominal_deg: Option<[f64; 2]>) -> Vec<Row> {
    let of_pass: BTreeMap<u32, &PassNote> = notes.iter().map(|note| (note.pass, note)).collect();
    let mut before: BTreeMap<(u32, u64), Groove> = BTreeMap::new();
    let row = |report: &PassReport| {
        let note = of_pass.get(&report.pass);
        let last = note.and_then(|note| {
            let groove = Groove::of(note, report);
            let start = (report.start, report.lead_mm.abs().to_bits());
            before.insert(start, groove).map(|last| groove.beyond(&last)).or(groove.first())
        });
        let flanks = flanks_deg(machine, report.tool_number, nominal_deg);
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
            deeper_mm: last.map(|(deeper, _)| deeper),
            chip_mm: last.map(|(deeper, along)| chip_mm(deeper, along, flanks)),
            force_n: cutting.map(|cutting| cutting.force_max_n),
            torque_nm: cutting.map(|cutting| cutting.torque_max_nm),
            power_kw: cutting.map(|cutting| cutting.power_max_kw),
            helix_um: touched.then_some(report.tool.helix_max_abs_um),
            depth_um: touched.then_some(report.tool.x_max_um.max(-report.tool.x_min_um)),
        }
    };
    summary.last_attempts().filter(|report| report.tap.is_none()).map(row).collect()
}

/// Where the tool goes in a pass.
#[derive(Clone, Copy, Debug)]
struct Groove {
    /// Depth below the crest, where the program says it, mm.
    depth_mm: Option<f64>,
    /// The axis that takes the tool to depth, and the helix along the thread at the index, mm.
    across_mm: f64,
    helix_mm: f64,
    lead_mm: f64,
}

impl Groove {
    fn of(note: &PassNote, report: &PassReport) -> Groove {
        Groove {
            depth_mm: note.depth_mm,
            across_mm: note.across_mm,
            helix_mm: report.helix_at_index_mm,
            lead_mm: report.lead_mm,
        }
    }

    /// Δd and Δz of a first pass: all of its depth, straight in.
    fn first(&self) -> Option<(f64, f64)> {
        self.depth_mm.map(|depth| (depth, 0.0))
    }

    /// Δd and Δz from another pass of the same start, mm; Δz to the nearest turn of its helix.
    fn beyond(&self, last: &Groove) -> (f64, f64) {
        let lead = self.lead_mm.abs();
        let along = self.helix_mm - last.helix_mm;
        let along = along - lead * (along / lead).round();
        let deeper = match (self.depth_mm, last.depth_mm) {
            (Some(depth), Some(before)) => depth - before,
            _ => (self.across_mm - last.across_mm).abs(),
        };
        (deeper, along)
    }
}

/// (M208), mm, of the flanks towards lower and higher Z; 0 of a spring pass.
fn chip_mm(deeper_mm: f64, along_mm: f64, flanks_deg: [f64; 2]) -> f64 {
    let [low, high] = flanks_deg.map(|flank| libm::sincos(flank.to_radians()));
    let (low, high) = (deeper_mm * low.0 - along_mm * low.1, deeper_mm * high.0 + along_mm * high.1);
    low.max(high).max(0.0)
}

/// The flanks of a tool, degrees: as the machine file has them, else those of the thread that is asked for,
/// else those that passes are laid out for.
fn flanks_deg(machine: &Machine, tool: u32, nominal: Option<[f64; 2]>) -> [f64; 2] {
    let told = machine.tool(tool).and_then(|tool| tool.angle_deg).map(|angle| [0.5 * angle; 2]);
    told.or(nominal).unwrap_or([machine.threading.flank_half_angle_deg; 2])
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
        self.reasons.iter().for_each(|reason| {
            let _ = writeln!(text, "  not good: {reason}");
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

#[cfg(test)]
mod tests {
    use super::{Groove, chip_mm};

    /// The two flanks of a 60° tool by their normals, against the formula.
    #[test]
    fn chips_are_those_of_the_flanks() {
        let of = |depth_mm, helix_mm| Groove {
            depth_mm: Some(depth_mm),
            across_mm: 10.0 - depth_mm,
            helix_mm,
            lead_mm: -2.0,
        };
        let radial = of(0.5, 0.3).beyond(&of(0.3, 0.3));
        assert!((chip_mm(radial.0, radial.1, [30.0; 2]) - 0.1).abs() < 1e-12, "{radial:?}");
        // Along a flank: tan 30° of the depth along the thread; the other flank takes twice as much, and a
        // helix that is counted from another turn is the same helix.
        let (deeper, along) = of(0.5, 0.3 + 4.0 + 0.2 * libm::tan(30f64.to_radians())).beyond(&of(0.3, 0.3));
        assert!((chip_mm(deeper, along, [30.0; 2]) - 0.2).abs() < 1e-12, "{deeper} {along}");
        // Of a buttress thread (3° and 30°), straight in.
        assert!((chip_mm(0.2, 0.0, [3.0, 30.0]) - 0.1).abs() < 1e-12);
        // A spring pass.
        let (deeper, along) = of(0.5, 0.3).beyond(&of(0.5, 0.3));
        assert_eq!((deeper, chip_mm(deeper, along, [30.0; 2])), (0.0, 0.0));
    }
}
