//! `pitchlock run`: read everything, start the machine, record, sum up.

mod args;
mod channels;
mod children;
mod claim;
mod endings;
pub(crate) mod folder;
mod in_process;
pub(crate) mod interrupts;
mod journal;
mod keeps;
mod processes;
mod progress;
mod recorder;
mod watchdog;

use std::{collections::BTreeSet, fmt::Write as _, process::ExitCode};

use machine::Machine;
use process::shell::Clock;
use protocol::Axis;
use rig::journal::{Keeper, Origin};
use rig::observe::{
    FaultReport, Outcome, PassEnd, PassReport, ProgramWarning, ServoError, Summary, WorkKind,
};

use crate::{
    args::Shop,
    error::CliError,
    program::Program,
    report::DRAWING,
    screen,
    words::{self, Phase},
};
use args::Fell;
pub(crate) use args::{HELP, RunArgs, Trace};
use folder::{RunFolder, Seen};
use interrupts::Interrupts;
pub(crate) use journal::JOURNAL;
use keeps::Keeps;
pub(crate) use recorder::axes;

/// Everything a run depends on.
pub(crate) struct Setup {
    /// The machine.
    pub(crate) machine: Machine,
    /// The program as a whole.
    pub(crate) program: Program,
    /// What happens meanwhile.
    pub(crate) scenario: sim_plant::Scenario,
    /// Seed of the plant.
    pub(crate) seed: u64,
    /// How processes wait for each other.
    pub(crate) clock: Clock,
    /// Where everything is written.
    pub(crate) folder: RunFolder,
    /// Whether progress is shown.
    pub(crate) progress: bool,
    /// Whether nothing is said at all.
    pub(crate) quiet: bool,
    /// How long nothing may happen before somebody counts as frozen, s; 0 for ever.
    pub(crate) watchdog_s: f64,
    /// Whom a test kills or freezes.
    pub(crate) fell: Vec<Fell>,
}

impl Setup {
    /// Who says what the journal has to know.
    fn keeper(&self) -> Keeper {
        let run = Origin { input: self.folder.input, seed: self.seed, ..Origin::default() };
        let keeper = Keeper::new(&self.machine, run, &self.program.watched);
        let passes = self.program.check.iter().flat_map(|check| &check.passes);
        keeper.lying_at(passes.map(|note| (note.pass, note.origin_mm)).collect())
    }
}

/// Runs a program. Anything wrong with the input ends this before the machine starts.
pub(crate) fn run(asked: &RunArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let mut repeated = folder::repeated(asked)?;
    let Shop { machine, text: machine_text, language, notes } =
        repeated.machine.with_language(&repeated.language)?;
    let keeps = Keeps::of(asked, &machine, &language);
    repeated.language = language;
    let args = &repeated;
    let seen = Seen::of(args);
    let program = Program::read(&args.program, &args.language.language(), &machine, args.gauge.read()?)?;
    if !quiet {
        // Whoever repeats a run has been told.
        let notes = if asked.program.is_dir() { "" } else { &notes };
        words::say(&format!("{notes}{}", program.messages));
    }
    let (scenario, scenario_text) = read_scenario(args, &machine)?;
    let seed = args.seed.unwrap_or(1);
    if args.in_process && args.clock == Clock::Real {
        return Err(CliError::Input("--in-process runs in virtual time only; leave out --clock real".into()));
    }
    can_be_played(&scenario, args)?;
    let mut interrupts = Interrupts::catch()?;
    let folder = RunFolder::create(args, &program, &machine_text, scenario_text.as_deref(), &seen)?;
    let progress = !quiet && !args.json;
    let (clock, watchdog_s, fell) = (args.clock, args.watchdog_s, args.fell.clone());
    let setup = Setup { machine, program, scenario, seed, clock, folder, progress, quiet, watchdog_s, fell };

    let run = if args.in_process { in_process::run } else { processes::run };
    let (mut summary, unrecorded) = run(&setup, &mut interrupts)?;
    summary.program_warnings = setup.program.warnings();
    if !setup.folder.is_as_it_was() {
        endings::program_changed(&mut summary);
    }
    // Whatever cannot be written: what became of the run is said.
    let written = summary.write(&setup.folder.path.join("summary.json")).map_err(CliError::from);
    drop(interrupts);
    let kept = keeps.map_or(Ok(()), |keeps| keeps.what_is_left(&setup.program, summary.outcome));
    let drawing = Phase::begin(DRAWING);
    let report = written.and_then(|()| Ok(report::render(&setup.folder.path)?));
    drop(drawing);
    if quiet && let Some(fault) = summary.faults.first() {
        words::say(&format!("error: {}\n", told(fault)));
    }
    if args.json {
        let text =
            serde_json::to_string_pretty(&summary).map_err(|error| CliError::Machine(error.to_string()))?;
        screen::print(&format!("{text}\n"));
    } else if !quiet {
        screen::print(&summed_up(&summary, report.as_deref().ok()));
    }
    if let Some(error) = unrecorded.or(report.err()).or(kept.err()) {
        return Err(error);
    }
    Ok(status(&summary))
}

/// 0 done, and the part is good as far as it is judged; 1 not done; 3 done, but the part is not good, and why
/// is said.
fn status(summary: &Summary) -> ExitCode {
    if summary.outcome != Outcome::Completed {
        return ExitCode::from(1);
    }
    let reasons = &summary.part.reasons;
    reasons.iter().for_each(|reason| words::say(&format!("not good: {reason}\n")));
    if reasons.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(3) }
}

/// Refuses what the machine cannot play in the way it is run.
fn can_be_played(scenario: &sim_plant::Scenario, args: &RunArgs) -> Result<(), CliError> {
    let input = |text: String| Err(CliError::Input(text));
    match (scenario.needs_one_process(), scenario.needs_time_to_go_on()) {
        (Some(event), _) if !args.in_process => input(format!(
            "event {event} of the scenario: messages between processes cannot be disturbed; add --in-process"
        )),
        (_, Some(event)) if !args.in_process && args.clock == Clock::Virtual => input(format!(
            "event {event} of the scenario: in lock step all processes wait for one that is frozen, so for_s \
             never passes; add --in-process or --clock real, or leave out for_s"
        )),
        _ => Ok(()),
    }
}

/// What `--single-block` adds to the scenario.
const SINGLE_BLOCK: &str = "[[event]]\nat = { cycle = 0 }\nsingle_block = true\n";

pub(crate) fn read_scenario(
    args: &RunArgs,
    machine: &Machine,
) -> Result<(sim_plant::Scenario, Option<String>), CliError> {
    let given = args.scenario.as_ref();
    let text =
        given.map(|path| intake::text(path, intake::SETTINGS).map_err(|error| CliError::file(path, error)));
    let mut text = text.transpose()?;
    if args.single_block {
        text = Some(text.map_or_else(String::new, |text| text + "\n") + SINGLE_BLOCK);
    }
    let wrong = |error: &dyn std::fmt::Display| {
        let name = given.map_or("scenario".into(), |path| path.display().to_string());
        CliError::Input(format!("{name}: {error}"))
    };
    let scenario = sim_plant::Scenario::from_toml(text.as_deref().unwrap_or_default());
    let scenario = scenario.map_err(|error| wrong(&error))?;
    // Alone the machine can be built: its file has been read.
    sim_plant::Plant::new(machine, scenario.clone(), 1).map_err(|error| wrong(&error))?;
    Ok((scenario, text))
}

/// Pauses and circles that are named.
const SHOWN: usize = 10;

/// A fault or a warning in a line.
fn told(report: &FaultReport) -> String {
    let FaultReport { source, code, cycle, text } = report;
    format!("{source} {code} (cycle {cycle}): {text}")
}

/// What a person wants to know first.
fn summed_up(summary: &Summary, report: Option<&std::path::Path>) -> String {
    let mut text = String::new();
    for fault in &summary.faults {
        let _ = writeln!(text, "fault     {}", told(fault));
    }
    for warning in &summary.warnings {
        let _ = writeln!(text, "warning   {}", told(warning));
    }
    for ProgramWarning { file, line, code, text: what, .. } in summary.program_warnings.iter().take(SHOWN) {
        let _ = writeln!(text, "checked   {file}:{line}: {code}: {what}");
    }
    if summary.program_warnings.len() > SHOWN {
        let _ = writeln!(text, "          and {} more warnings", summary.program_warnings.len() - SHOWN);
    }
    let outcome = match summary.outcome {
        Outcome::Completed => "completed",
        Outcome::Faulted => "FAULTED",
        Outcome::Stopped => "stopped by the operator",
    };
    // One that was left and taken up again is one pass.
    let passes: BTreeSet<u32> = summary.passes.iter().map(|pass| pass.pass).collect();
    let _ = writeln!(
        text,
        "{outcome}: {} passes, {} moves, {:.1} s on the machine in {:.1} s",
        passes.len(),
        summary.moves.count,
        summary.simulated_s,
        summary.wall_s
    );
    threads(&mut text, summary);
    gauged(&mut text, summary);
    traces(&mut text, summary);
    moves(&mut text, summary);
    pauses(&mut text, summary);
    signals(&mut text, summary);
    if let Some(words) = summary.overrides_held() {
        let _ = writeln!(text, "override  {words}");
    }
    if summary.deadline_misses > 0 && summary.clock == "real" {
        let _ = writeln!(text, "late      {} answers came after their cycle", summary.deadline_misses);
    }
    let _ = writeln!(text, "trace     {}", summary.trace_hash);
    if let Some(report) = report {
        let _ = writeln!(text, "report    {}", report.display());
    }
    text
}

fn pauses(text: &mut String, summary: &Summary) {
    for pause in summary.pauses.iter().take(SHOWN) {
        let _ = writeln!(
            text,
            "pause     line {}: {} after {:.1} s",
            pause.line,
            pause.ended_by.text(),
            pause.waited_s
        );
    }
    if summary.pauses.len() > SHOWN {
        let _ = writeln!(text, "          and {} more pauses", summary.pauses.len() - SHOWN);
    }
}

fn signals(text: &mut String, summary: &Summary) {
    for (what, changes) in [("output", &summary.outputs), ("input", &summary.inputs)] {
        let told = changes.iter().map(|one| {
            let state = if one.on { "on" } else { "off" }.to_owned();
            (one.number, &one.name, state, one.cycle, one.line)
        });
        changed(text, what, told, summary.cycle_s);
    }
    let analog = &summary.analog_outputs;
    let told =
        analog.iter().map(|one| (one.number, &one.name, format!("= {}", one.value), one.cycle, one.line));
    changed(text, "analog", told, summary.cycle_s);
}

/// Changes of outputs or inputs: number, name, state, cycle, line.
fn changed<'a>(
    text: &mut String,
    what: &str,
    changes: impl ExactSizeIterator<Item = (u32, &'a String, String, u64, u32)>,
    cycle_s: f64,
) {
    let more = changes.len().saturating_sub(SHOWN);
    for (number, name, state, cycle, line) in changes.take(SHOWN) {
        let at_s = cycle as f64 * cycle_s;
        let _ = writeln!(text, "{what:<10}{number} {name} {state} at {at_s:.3} s, line {line}");
    }
    if more > 0 {
        let _ = writeln!(text, "          and {more} more changes of {what}s");
    }
}

fn threads(text: &mut String, summary: &Summary) {
    for last in summary.interrupted().take(SHOWN) {
        let words = match last.end {
            PassEnd::Complete => "was left, entered again and cut to its end",
            PassEnd::Left => "was left before its end",
            PassEnd::CutOff => "was cut off before its end",
        };
        let _ = writeln!(text, "pass      {} {words}", last.pass);
    }
    if summary.passes.is_empty() {
        return;
    }
    let worst = |of: fn(&PassReport) -> f64| summary.passes.iter().map(of).fold(0.0, f64::max);
    let [helix, passes, depth, ends] = summary.at_the_tool();
    let _ = match summary.touched().next() {
        None => writeln!(text, "thread    the tool touched no material: nothing of it is judged"),
        Some(_) => writeln!(
            text,
            "thread    at the tool: helix error at most {helix:.2} µm about its mean, from pass to pass {passes:.2} µm, depth off by {depth:.2} µm, from end to end {ends:.2} µm"
        ),
    };
    let _ = writeln!(
        text,
        "nut       helix error at most {:.2} µm, phase spread from pass to pass {:.2} µm, lead error at most {:.3} µm/rev",
        worst(|pass| pass.helix_max_abs_um),
        summary.thread.phase_spread_um,
        worst(|pass| pass.lead_error_um_per_rev.abs()),
    );
    // The axis that takes the tool to depth.
    for axis in [Axis::X, Axis::Z] {
        let errors = summary.passes.iter().filter(|pass| pass.on_face == (axis == Axis::Z));
        let errors = errors.map(|pass| if axis == Axis::X { pass.x } else { pass.z });
        let worst = |of: fn(ServoError) -> f64| errors.clone().map(of).reduce(f64::max);
        let Some(approach) = worst(|error| error.approach_max_um.max(-error.approach_min_um)) else {
            continue;
        };
        let [end, thread] = [worst(|error| error.end_um.abs()), worst(|error| error.thread_max_abs_um)];
        let _ = writeln!(
            text,
            "depth ({axis}) servo error in the approach at most {approach:.2} µm, at its end {:.2} µm, in the thread {:.2} µm",
            end.unwrap_or_default(),
            thread.unwrap_or_default()
        );
    }
}

/// What the gauge says.
fn gauged(text: &mut String, summary: &Summary) {
    let Some(gauge) = &summary.gauge else { return };
    let _ = writeln!(text, "gauge     {}", gauge.sentence());
    for note in &gauge.notes {
        let _ = writeln!(text, "          {note}");
    }
}

fn traces(text: &mut String, summary: &Summary) {
    let mut shown: Vec<_> = summary.traces.iter().collect();
    if shown.len() > SHOWN {
        shown.sort_by(|a, b| b.slide.max_abs_um().total_cmp(&a.slide.max_abs_um()));
        shown.truncate(SHOWN);
    }
    for trace in &shown {
        let (name, turned) = match trace.kind {
            WorkKind::Contour => ("contour  ", String::new()),
            WorkKind::Surface => ("surface  ", String::new()),
            WorkKind::Seam => ("seam     ", format!(", direction within {:.5}°", trace.slide.angle_max_deg)),
        };
        let _ = writeln!(
            text,
            "{name} line {}: true within {:.2} µm, commanded within {:.3} µm{turned}; {:.0} mm/min held {:.1} % of the time",
            trace.line,
            trace.slide.max_abs_um(),
            trace.commanded.max_abs_um(),
            trace.feed.programmed_mm_min,
            trace.feed.held_pct
        );
    }
    for trace in summary.traces.iter().filter(|trace| trace.is_wrong()).take(SHOWN) {
        let _ = writeln!(
            text,
            "WRONG     line {}: commanded {:.3} µm off, more than the chord error of {:.3} µm: the part is not what the formula says",
            trace.line,
            trace.commanded.max_abs_um(),
            trace.most_um.unwrap_or(0.0)
        );
    }
    let more = (summary.traces.len() - shown.len()) as u64 + summary.traces_left_out;
    if more > 0 {
        let _ = writeln!(text, "          and {more} more contours, surfaces and seams, each of them truer");
    }
}

fn moves(text: &mut String, summary: &Summary) {
    if summary.moves.contour_max_um > 0.0 {
        let moves = &summary.moves;
        let _ = writeln!(
            text,
            "contour   at most {:.2} µm from the path (line {} at {:.3} s), rms {:.2} µm",
            moves.contour_max_um, moves.contour_line, moves.contour_t_s, moves.contour_rms_um
        );
        for circle in moves.circles.iter().take(SHOWN) {
            let _ = writeln!(
                text,
                "circle    line {}: radius {:.3} mm at {:.0} mm/min round within {:.2} µm",
                circle.line, circle.radius_mm, circle.feed_mm_min, circle.round_max_um
            );
        }
    }
    if summary.moves.limit_violations > 0 {
        let _ = writeln!(
            text,
            "limits    {} cycles beyond the limit of an axis: docs/run-folder.md says how that is judged",
            summary.moves.limit_violations
        );
    }
    if summary.moves.starved > 0 {
        let _ = writeln!(text, "starved   stopped {} times to wait for machine code", summary.moves.starved);
    }
}
