//! `pitchlock run`: read everything, start the machine, record, sum up.

mod args;
mod channels;
mod children;
pub(crate) mod claim;
mod disk;
mod ended;
mod endings;
pub(crate) mod folder;
mod gives;
pub(crate) mod hosts;
mod in_process;
pub(crate) mod interrupts;
mod journal;
mod keeps;
pub(crate) mod moment;
mod processes;
mod progress;
mod quiet;
mod recorder;
mod rendezvous;
mod resumed;
mod scenario;
mod summed;
mod traced;
mod watchdog;

use std::{
    cell::RefCell,
    path::{Path, PathBuf},
    process::ExitCode,
    rc::Rc,
};

use interpreter::{Dialect, Entry};
use machine::Machine;
use process::{
    ipc::Layout,
    shell::{Clock, Pace},
};
use rig::journal::{Keeper, Origin};
use serde_json::Value;

use crate::{
    args::Shop,
    entered,
    error::CliError,
    panel::Live,
    program::Program,
    replay::Left,
    report::DRAWING,
    screen,
    words::{self, Phase},
};
use args::Fell;
pub(crate) use args::{FarArgs, HELP, RunArgs, Timing, Trace};
use claim::SUMMARY;
use ended::{Ended, Form};
use folder::{ARRIVALS, RunFolder, Seen};
use interrupts::Interrupts;
pub(crate) use journal::JOURNAL;
use keeps::Keeps;
pub(crate) use recorder::axes;
use recorder::{Recorded, keep_arrivals};
use resumed::Resumed;
use scenario::can_be_played;
pub(crate) use scenario::read_scenario;
use summed::summed_up;

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
    /// In real time nothing starts unless everything that it needs is granted.
    pub(crate) strict: bool,
    /// Which modules share a process.
    pub(crate) layout: Layout,
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
    /// Neither journal nor record are kept: it is measured what they cost.
    pub(crate) unkept: bool,
    /// The run that it goes on with.
    pub(crate) resumed: Option<Resumed>,
    /// Its machine code is given by hand, and the program is what came of that.
    pub(crate) by_hand: bool,
    /// The link to the computer of its interpreter, if that is another one; whoever starts the processes
    /// takes it.
    pub(crate) link: Rc<RefCell<Option<hosts::Link>>>,
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
    if asked.dry_run && !asked.resume && asked.from.is_none() {
        return Err(CliError::Input(
            "--dry-run shows where a run would begin: add --resume, or --from LINE".into(),
        ));
    }
    if asked.dry_run {
        return Judged::read(asked, quiet, false).map(|_| ExitCode::SUCCESS);
    }
    let mut interrupts = None;
    let prepared = Prepared::of(asked, quiet, &mut interrupts, false)?;
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

/// What was given by hand waits for every block, and only the presses of its session give them.
fn is_given(asked: &RunArgs, program: &Program) -> Result<(), CliError> {
    let alone = !asked.program.is_dir() && asked.scenario.is_none();
    if !(program.by_hand && !asked.by_hand && alone) {
        return Ok(());
    }
    let folder = asked.program.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new(".")).display();
    let text = format!(
        "is work by hand: each of its blocks waits for the press of its session, and here nobody presses; run the \
         folder instead: pitchlock run {folder}"
    );
    Err(CliError::file(&asked.program, text))
}

/// Reads all that a run is made of and runs nothing: its program, the dialect of that, and where it is begun
/// at a line, what is in force there.
pub(crate) fn judged(asked: &RunArgs) -> Result<(PathBuf, Dialect, Value), CliError> {
    let mut args = repeatable(asked)?;
    let Shop { machine, language, .. } = args.machine.with_language(&args.language)?;
    args.language = language;
    args.language.from = asked.from.or(args.language.from);
    args.with_panel = true;
    let program = Program::read(&args.program, &args.language.language(), &machine, args.gauge.read()?)?;
    is_given(asked, &program)?;
    let (scenario, _) = read_scenario(&args, &machine)?;
    can_be_played(&scenario, &args)?;
    let begun = program.entry.as_ref().map_or(Value::Null, |entry| entered::as_json(entry, &machine));
    let (dialect, _) = interpreter::dialect(&args.program, &args.language.language(), &machine);
    Ok((args.program, dialect, begun))
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
        args.language = language;
        args.language.from = asked.from.or(args.language.from);
        // What a program leaves is that of a run from its beginning.
        let keeps = Keeps::of(asked, &machine, &args.language).filter(|_| args.language.from.is_none());
        let seen = Seen::of(&args);
        let mut program =
            Program::read(&args.program, &args.language.language(), &machine, args.gauge.read()?)?;
        if !quiet {
            // Whoever repeats a run has been told.
            let notes = if asked.program.is_dir() { "" } else { &notes };
            words::say(&format!("{notes}{}", program.messages));
        }
        is_given(asked, &program)?;
        let (scenario, scenario_text) = read_scenario(&args, &machine)?;
        can_be_played(&scenario, &args)?;
        if let Some(entry) = program.entry.as_ref().filter(|_| asked.from.is_some()) {
            tell(entry, &machine, &args, quiet);
        }
        let resumed = left
            .map(|left| Resumed::new(left, scenario.clone(), &mut program, [&args, asked]))
            .transpose()?;
        if let Some(resumed) = &resumed {
            resumed.tell(&args, quiet);
        }
        Ok(Judged { args, machine, machine_text, program, scenario, scenario_text, seen, keeps, resumed })
    }
}

/// Says where a program is begun: a run on standard error, a dry run on standard output.
fn tell(entry: &Entry, machine: &Machine, args: &RunArgs, quiet: bool) {
    match (args.dry_run, args.json) {
        (true, true) => screen::print(&format!("{:#}\n", entered::as_json(entry, machine))),
        (true, false) => screen::print(&entered::told(entry, machine)),
        (false, false) if !quiet => words::say(&entered::told(entry, machine)),
        _ => {}
    }
}

/// A run that can begin.
pub(crate) struct Prepared {
    setup: Setup,
    keeps: Option<Keeps>,
    in_process: bool,
    json: bool,
    /// Whoever runs it goes on behind it.
    stays: bool,
}

impl Prepared {
    /// Reads the input, judges it and makes the run folder. Signals are caught from there on.
    pub(crate) fn of(
        asked: &RunArgs,
        quiet: bool,
        interrupts: &mut Option<Interrupts>,
        at_a_panel: bool,
    ) -> Result<Prepared, CliError> {
        let Judged { args, machine, machine_text, program, scenario, scenario_text, seen, keeps, resumed } =
            Judged::read(asked, quiet, at_a_panel)?;
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
            clock: args.clock.clock(),
            strict: args.clock == Timing::Strict,
            layout: match args.clock.clock() {
                Clock::Real if !args.processes => Layout::Together,
                Clock::Real | Clock::Virtual => Layout::Apart,
            },
            pace: args.pace.unwrap_or(if args.with_panel { Pace::ONE } else { Pace::MAX }),
            folder,
            progress: !quiet && !args.json,
            quiet,
            watchdog_s: args.watchdog_s,
            by_hand: args.by_hand,
            fell: args.fell,
            unkept: args.unkept,
            resumed,
            link: Rc::default(),
        };
        Ok(Prepared { setup, keeps, in_process: args.in_process, json: args.json, stays: false })
    }

    /// Runs it, and says what came of it.
    pub(crate) fn go(
        self,
        quiet: bool,
        interrupts: &mut Option<Interrupts>,
        live: Option<&mut Live>,
    ) -> Result<ExitCode, CliError> {
        self.runs(interrupts, live)?.tells(quiet)
    }

    /// Runs it; what came of it.
    fn runs(
        self,
        interrupts: &mut Option<Interrupts>,
        mut live: Option<&mut Live>,
    ) -> Result<Ended, CliError> {
        let Prepared { mut setup, keeps, in_process, json, stays } = self;
        let caught = interrupts.as_mut().ok_or_else(|| CliError::Machine("signals are not caught".into()))?;
        live.as_mut().map_or(Ok(()), |live| live.prepared(&setup))?;
        let Recorded { mut summary, failed: unrecorded, stands, arrivals } = if in_process {
            in_process::run(&setup, caught)?
        } else {
            processes::run(&setup, caught, live.as_deref_mut())?
        };
        summary.program_warnings = setup.program.warnings();
        if stands {
            let text = summed_up(&summary, None);
            words::say(&format!(
                "{text}pitchlock: the disk does not answer; {ARRIVALS}, summary and report wait for it\n"
            ));
            // Whoever does not want to wait for it need not.
            caught.let_go();
        }
        let given = live.as_mut().and_then(|live| live.given());
        let mut kept = Ok(());
        if let Some((items, outlasting)) = given {
            setup.folder.holds_what_was_given(items, &setup.machine)?;
            kept = keeps.as_ref().map_or(Ok(()), |keeps| keeps.what_was_set(&outlasting));
        }
        summary.files.clone_from(&setup.folder.hashes);
        if !setup.by_hand && !setup.folder.is_as_it_was() {
            endings::program_changed(&mut summary);
        }
        // Whatever cannot be written: what became of the run is said.
        let folder = setup.folder.path.clone();
        let recorded = arrivals.map_or(Ok(()), |arrivals| keep_arrivals(&folder, &arrivals));
        let written = summary.write(&folder.join(SUMMARY)).map_err(CliError::from);
        let pressed = live.as_mut().map_or(Ok(()), |live| live.ends(&summary, &folder));
        // Who stays heeds them when all is written and said.
        let stays = stays || live.is_some_and(|live| !live.ends_with_its_run);
        if !stays {
            caught.let_go();
        }
        let left = || keeps.map_or(Ok(()), |keeps| keeps.what_is_left(&setup.program, summary.outcome));
        let kept = kept.and_then(|()| left());
        let drawing = Phase::begin(DRAWING);
        let report = written.and_then(|()| Ok(report::render(&folder)?));
        drop(drawing);
        // The folder is whole, and nobody's any more, before anything waits for a reader.
        drop(setup);
        let form = match (stays, json) {
            (true, _) => Form::Said,
            (_, true) => Form::Json,
            _ => Form::Printed,
        };
        let (report, undrawn) =
            report.map_or_else(|error| (None, Some(error)), |report| (Some(report), None));
        let unwritten = unrecorded.or(recorded.err()).or(undrawn).or(kept.err()).or(pressed.err());
        Ok(Ended { summary, folder, report, unwritten, form })
    }
}
