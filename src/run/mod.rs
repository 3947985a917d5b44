//! `pitchlock run`: read everything, start the machine, record, sum up.

mod args;
mod channels;
mod children;
pub(crate) mod claim;
mod endings;
pub(crate) mod folder;
mod in_process;
pub(crate) mod interrupts;
mod journal;
mod keeps;
pub(crate) mod moment;
mod processes;
mod progress;
mod recorder;
mod resumed;
mod summed;
mod watchdog;

use std::{path::PathBuf, process::ExitCode};

use machine::Machine;
use process::shell::{Clock, Pace};
use rig::journal::{Keeper, Origin};
use rig::observe::{Outcome, Summary};

use crate::{
    args::Shop,
    error::CliError,
    panel::Live,
    program::Program,
    replay::Left,
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
use resumed::Resumed;
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
    /// The run that it goes on with.
    pub(crate) resumed: Option<Resumed>,
}

impl Setup {
    /// Who says what the journal has to know.
    fn keeper(&self) -> Keeper {
        let run = Origin { input: self.folder.input, seed: self.seed, ..Origin::default() };
        let run = self.resumed.as_ref().map_or(run, |Resumed { plan, .. }| {
            let (begun_at, before) = (plan.modal.steps, plan.steps_before());
            Origin { begun_at, before, passes: plan.modal.passes, ..run }
        });
        let keeper = Keeper::new(&self.machine, run, &self.program.watched);
        let passes = self.program.check.iter().flat_map(|check| &check.passes);
        keeper.lying_at(passes.map(|note| (note.pass, note.origin_mm)).collect())
    }
}

/// Runs a program. Anything wrong with the input ends this before the machine starts.
pub(crate) fn run(asked: &RunArgs, quiet: bool) -> Result<ExitCode, CliError> {
    if asked.panel.is_said() && !asked.with_panel {
        return Err(CliError::Input("--port and --listen are of the panel: add --panel".into()));
    }
    if asked.dry_run {
        return Judged::read(asked, quiet, false).map(|_| ExitCode::SUCCESS);
    }
    let mut interrupts = None;
    let prepared = Prepared::of(asked, quiet, &mut interrupts)?;
    let mut live = asked.with_panel.then(|| Live::open(asked, quiet)).transpose()?;
    prepared.go(quiet, &mut interrupts, live.as_mut())
}

/// What is run: of a run folder its run again, if it can be run alone.
fn repeatable(asked: &RunArgs) -> Result<RunArgs, CliError> {
    if asked.program.join(folder::BEFORE).is_dir() {
        let text = "goes on with another run: pitchlock replay makes it again, --resume goes on with it";
        return Err(CliError::file(&asked.program, text));
    }
    folder::repeated(asked)
}

/// Reads all that a run is made of and runs nothing: its program.
pub(crate) fn judged(asked: &RunArgs) -> Result<PathBuf, CliError> {
    let mut args = repeatable(asked)?;
    let Shop { machine, language, .. } = args.machine.with_language(&args.language)?;
    args.language = language;
    args.with_panel = true;
    Program::read(&args.program, &args.language.language(), &machine, args.gauge.read()?)?;
    let (scenario, _) = read_scenario(&args, &machine)?;
    can_be_played(&scenario, &args)?;
    Ok(args.program)
}

/// All that a run is made of, read and judged. Nothing is written yet.
struct Judged {
    args: RunArgs,
    machine: Machine,
    machine_text: String,
    program: Program,
    scenario: sim_plant::Scenario,
    scenario_text: Option<String>,
    seen: Seen,
    keeps: Option<Keeps>,
    resumed: Option<Resumed>,
}

impl Judged {
    /// Reads the input and judges it. If it goes on with another run, that is told.
    fn read(asked: &RunArgs, quiet: bool, at_a_panel: bool) -> Result<Judged, CliError> {
        let left = asked.resume.then(|| Left::open(&asked.program)).transpose()?;
        let mut args = match &left {
            Some(left) => left.arguments(asked)?,
            None => repeatable(asked)?,
        };
        args.with_panel |= at_a_panel;
        let Shop { machine, text: machine_text, language, notes } =
            args.machine.with_language(&args.language)?;
        let keeps = Keeps::of(asked, &machine, &language);
        args.language = language;
        let seen = Seen::of(&args);
        let mut program =
            Program::read(&args.program, &args.language.language(), &machine, args.gauge.read()?)?;
        if !quiet {
            // Whoever repeats a run has been told.
            let notes = if asked.program.is_dir() { "" } else { &notes };
            words::say(&format!("{notes}{}", program.messages));
        }
        let (scenario, scenario_text) = read_scenario(&args, &machine)?;
        can_be_played(&scenario, &args)?;
        let resumed = left.map(|left| Resumed::new(left, scenario.clone(), &mut program)).transpose()?;
        if let Some(resumed) = &resumed {
            resumed.tell(&args, quiet);
        }
        Ok(Judged { args, machine, machine_text, program, scenario, scenario_text, seen, keeps, resumed })
    }
}

/// A run that can begin.
pub(crate) struct Prepared {
    setup: Setup,
    keeps: Option<Keeps>,
    in_process: bool,
    json: bool,
}

impl Prepared {
    /// Reads the input, judges it and makes the run folder. Signals are caught from there on.
    pub(crate) fn of(
        asked: &RunArgs,
        quiet: bool,
        interrupts: &mut Option<Interrupts>,
    ) -> Result<Prepared, CliError> {
        // Signals are caught already: this is a command that waits for somebody at its panel.
        let Judged { args, machine, machine_text, program, scenario, scenario_text, seen, keeps, resumed } =
            Judged::read(asked, quiet, interrupts.is_some())?;
        if interrupts.is_none() {
            *interrupts = Some(Interrupts::catch()?);
        }
        let folder = RunFolder::create(&args, &program, &machine_text, scenario_text.as_deref(), &seen)?;
        resumed.iter().try_for_each(|resumed| resumed.keep(&folder.path))?;
        let setup = Setup {
            machine,
            program,
            scenario,
            seed: args.seed.unwrap_or(1),
            clock: args.clock,
            pace: args.pace.unwrap_or(if args.with_panel { Pace::ONE } else { Pace::MAX }),
            folder,
            progress: !quiet && !args.json,
            quiet,
            watchdog_s: args.watchdog_s,
            fell: args.fell,
            resumed,
        };
        // The document of `panel --json` is where the panel is.
        let json = args.json && (asked.with_panel || !args.with_panel);
        Ok(Prepared { setup, keeps, in_process: args.in_process, json })
    }

    /// Runs it, and says what came of it.
    pub(crate) fn go(
        self,
        quiet: bool,
        interrupts: &mut Option<Interrupts>,
        mut live: Option<&mut Live>,
    ) -> Result<ExitCode, CliError> {
        let Prepared { setup, keeps, in_process, json } = self;
        let caught = interrupts.as_mut().ok_or_else(|| CliError::Machine("signals are not caught".into()))?;
        live.iter_mut().for_each(|live| live.prepared(&setup));
        let (mut summary, unrecorded) = if in_process {
            in_process::run(&setup, caught)?
        } else {
            processes::run(&setup, caught, live.as_deref_mut())?
        };
        summary.files.clone_from(&setup.folder.hashes);
        summary.program_warnings = setup.program.warnings();
        if !setup.folder.is_as_it_was() {
            endings::program_changed(&mut summary);
        }
        // Whatever cannot be written: what became of the run is said.
        let written = summary.write(&setup.folder.path.join("summary.json")).map_err(CliError::from);
        let pressed = live.as_mut().map_or(Ok(()), |live| live.ends(&summary, &setup.folder.path));
        if live.is_none_or(|live| live.ends_with_its_run) {
            drop(interrupts.take());
        }
        let kept = keeps.map_or(Ok(()), |keeps| keeps.what_is_left(&setup.program, summary.outcome));
        let drawing = Phase::begin(DRAWING);
        let report = written.and_then(|()| Ok(report::render(&setup.folder.path)?));
        drop(drawing);
        if quiet && let Some(fault) = summary.faults.first() {
            words::say(&format!("error: {}\n", told(fault)));
        }
        if json {
            let text = serde_json::to_string_pretty(&summary)
                .map_err(|error| CliError::Machine(error.to_string()))?;
            screen::print(&format!("{text}\n"));
        } else if !quiet {
            screen::print(&summed_up(&summary, report.as_deref().ok()));
        }
        if let Some(error) = unrecorded.or(report.err()).or(kept.err()).or(pressed.err()) {
            return Err(error);
        }
        Ok(status(&summary))
    }
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
    if args.in_process && args.clock == Clock::Real {
        return input("--in-process runs in virtual time only; leave out --clock real".into());
    }
    if args.in_process && args.with_panel {
        return input("the panel is of a machine of processes: leave out --in-process".into());
    }
    if args.clock == Clock::Real && args.pace.is_some_and(Pace::waits) {
        return input(
            "--pace is of virtual time; in real time the pace is 1: leave out --pace, or --clock real".into(),
        );
    }
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

/// What the scenario says of the panel, if anything.
const AT_THE_PANEL: &str = "panel = ";

pub(crate) fn read_scenario(
    args: &RunArgs,
    machine: &Machine,
) -> Result<(sim_plant::Scenario, Option<String>), CliError> {
    let given = args.scenario.as_ref();
    let read =
        |path: &PathBuf| intake::text(path, intake::SETTINGS).map_err(|error| CliError::file(path, error));
    let mut text = given.map(read).transpose()?;
    if args.single_block {
        text = Some(text.map_or_else(String::new, |text| text + "\n") + SINGLE_BLOCK);
    }
    let presses = args.presses.as_ref().map(read).transpose()?;
    let at_the_panel = match (args.with_panel, &presses) {
        (true, _) => Some("live"),
        (false, Some(_)) => Some("recorded"),
        (false, None) => None,
    };
    if let Some(who) = at_the_panel {
        let text_before = text.unwrap_or_default();
        let events = text_before.lines().filter(|line| !line.starts_with(AT_THE_PANEL));
        let events = events.map(|line| format!("{line}\n")).collect::<String>();
        text = Some(format!("{AT_THE_PANEL}\"{who}\"\n{events}{}", presses.unwrap_or_default()));
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
