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
mod summed;
mod watchdog;

use std::process::ExitCode;

use machine::Machine;
use process::shell::{Clock, Pace};
use rig::journal::{Keeper, Origin};
use rig::observe::{Outcome, Summary};

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
use summed::{summed_up, told};

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
    /// How their time keeps to the wall.
    pub(crate) pace: Pace,
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
    if args.clock == Clock::Real && args.pace.waits() {
        return Err(CliError::Input(
            "--pace is of virtual time; in real time the pace is 1: leave out --pace, or --clock real".into(),
        ));
    }
    can_be_played(&scenario, args)?;
    let mut interrupts = Interrupts::catch()?;
    let folder = RunFolder::create(args, &program, &machine_text, scenario_text.as_deref(), &seen)?;
    let progress = !quiet && !args.json;
    let (clock, pace, watchdog_s, fell) = (args.clock, args.pace, args.watchdog_s, args.fell.clone());
    let setup =
        Setup { machine, program, scenario, seed, clock, pace, folder, progress, quiet, watchdog_s, fell };

    let run = if args.in_process { in_process::run } else { processes::run };
    let (mut summary, unrecorded) = run(&setup, &mut interrupts)?;
    summary.files.clone_from(&setup.folder.hashes);
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
