//! What is left of a run that was broken off, by whatever: its journal, what it was made of, and what its
//! machine did. In: a run folder, perhaps of processes that were all killed. Out: the machine at rest, as the
//! run left it; how its program is gone on with.

use std::path::{Path, PathBuf};

use process::shell::Clock;
use protocol::{Item, PerAxis};
use rig::{
    journal::{MOST, State, has_other_version, latest},
    observe::{Observer, Outcome, Summary},
    replay::Arrivals,
    resume::{self, Plan, Refusal},
};
use sim_plant::{Plant, Scenario};

use super::folder::{Recorded, of_folder};
use crate::{
    error::CliError,
    program::Program,
    run::{
        JOURNAL, RunArgs,
        claim::is_held,
        folder::{ARRIVALS, MACHINE, arguments_of, changed, input_of, may_be_programs, without_journal},
        moment,
    },
};

/// What is said of a journal of another version.
const OTHER_VERSION: &str = "was written by another version of pitchlock: go on with it by that one";

/// A run that was broken off.
pub(crate) struct Left {
    /// What it was made of.
    pub(crate) recorded: Recorded,
    /// The newest record of its journal, with its number; none if there is no whole one.
    pub(crate) known: Option<(u64, State)>,
}

impl Left {
    /// Reads a run folder.
    ///
    /// # Errors
    /// What it lacks, or what cannot be gone on with, by name.
    pub(crate) fn open(dir: &Path) -> Result<Left, CliError> {
        if is_held(dir) {
            return Err(CliError::file(dir, "this run still goes on: wait until it has ended"));
        }
        let path = dir.join(JOURNAL);
        let bytes = intake::bytes(&path, MOST).map_err(|error| without_journal(dir, &error))?;
        let known = latest::<State>(&bytes);
        if known.is_none() && has_other_version::<State>(&bytes) {
            return Err(CliError::file(&path, OTHER_VERSION));
        }
        let summary = Summary::read(&dir.join("summary.json")).ok();
        if summary.as_ref().is_some_and(|summary| summary.outcome == Outcome::Completed) {
            // Whatever is left of its journal.
            return Err(CliError::Input(format!("{}: {}", dir.display(), Refusal::Complete)));
        }
        let args = arguments(dir, summary.as_ref(), known.map(|(_, state)| state.input))?;
        if let Some(line) = args.language.from {
            let text = format!(
                "was begun at line {line} of its program, and such a run is not gone on with: begin the program at the line at \
                 which it was broken off (run PROGRAM --from LINE)"
            );
            return Err(CliError::file(dir, text));
        }
        let arrivals = arrivals(dir, known.map_or(0, |(_, state)| state.cycle))?;
        if let Some(by) = arrivals.by_other() {
            let text = format!(
                "is a run of pitchlock {by}, and this is {}: go on with it by that version",
                env!("CARGO_PKG_VERSION")
            );
            return Err(CliError::file(dir, text));
        }
        let in_real_time =
            arrivals.real_time || summary.as_ref().is_some_and(|summary| summary.clock == "real");
        if in_real_time && !arrivals.ended {
            let text = "ran in real time, and its record has no end: what reached its modules last is not known, so its machine \
                        cannot be made again up to where it was broken off";
            return Err(CliError::file(dir, text));
        }
        let seed = summary.as_ref().map(|summary| summary.seed);
        let seed = seed.or(known.map(|(_, state)| state.seed)).or(arrivals.seed);
        let summary = Summary { seed: seed.unwrap_or(1), ..summary.unwrap_or_default() };
        Ok(Left { recorded: Recorded::of(dir, args, summary, arrivals)?, known })
    }

    /// What the control knows.
    pub(crate) fn state(&self) -> State {
        self.known.map_or_else(State::nothing, |(_, state)| state)
    }

    /// Whether what reached its modules last is not known.
    pub(crate) fn record_is_damaged(&self) -> bool {
        self.recorded.record_is_damaged()
    }

    /// Whether its launcher has seen the end of its machine.
    pub(crate) fn has_an_end(&self) -> bool {
        self.recorded.has_an_end()
    }

    /// The arguments of a run that goes on with it; of what is asked counts what says where it is written and
    /// what happens meanwhile.
    ///
    /// # Errors
    /// Something else is asked for.
    pub(crate) fn arguments(&self, asked: &RunArgs) -> Result<RunArgs, CliError> {
        if asked.clock.clock() == Clock::Real {
            return Err(CliError::Input("--resume runs in virtual time only; leave out --clock real".into()));
        }
        if asked.with_panel {
            let text =
                "--resume has no panel: the machine of a run that goes on is one process; leave out --panel";
            return Err(CliError::Input(text.into()));
        }
        let language = &asked.language;
        let tables = [&language.parameters, &language.ini];
        let other = asked.machine.machine.is_some()
            || language.dialect.is_some()
            || !language.block_delete.is_empty()
            || !language.subroutines.is_empty()
            || asked.seed.is_some()
            || tables.into_iter().any(Option::is_some);
        if other {
            let text = "--resume goes on with the machine, the parameters and the seed of the run: leave out everything that says \
                        others (but --tools, for a tool that was changed), or run the program from its beginning";
            return Err(CliError::Input(text.into()));
        }
        let RunArgs { program, mut language, machine, gauge, .. } = self.recorded.args.clone();
        if asked.language.tools.is_some() {
            language.tools.clone_from(&asked.language.tools);
        }
        let gauge = if asked.gauge.gauge.is_some() { asked.gauge.clone() } else { gauge };
        let seed = Some(self.recorded.summary.seed);
        Ok(RunArgs { program, language, machine, gauge, seed, in_process: true, ..asked.clone() })
    }

    /// Its machine when it is switched on again, playing a scenario; and who has observed it.
    ///
    /// # Errors
    /// What its machine did cannot be made again; an event of the scenario is for an axis that there is not.
    pub(crate) fn at_rest(&self, scenario: Scenario) -> Result<(Plant, Observer), CliError> {
        let (mut machine, mut observer) = self.recorded.begun()?;
        while machine.step(|exchange, _| observer.cycle(&exchange.record))? {}
        let mut plant = machine.lose_power(|truth| observer.run_down(truth));
        plant.switch_on(scenario).map_err(|error| CliError::Input(error.to_string()))?;
        Ok((plant, observer))
    }

    /// How its program is gone on with by a control that measures what a plant shows: `now` is its machine
    /// code with the tool table of the run that goes on. If a tool is another one, the plant gets it.
    ///
    /// # Errors
    /// It is not; the text says why.
    pub(crate) fn plan(&self, plant: &mut Plant, now: impl Iterator<Item = Item>) -> Result<Plan, CliError> {
        let machine = &self.recorded.machine;
        let mut here: PerAxis<_> = machine.home();
        for (axis, config) in machine.axes() {
            here[axis.index()] = config.position(&plant.measurement().axes[axis.index()]);
        }
        let refused = |refusal| CliError::Input(format!("{}: {refusal}", self.recorded.name));
        if self.known.is_none() && self.tools_of_before().is_some() {
            return Err(refused(Refusal::WhichTable));
        }
        let by = |tools| self.recorded.items_by(tools).into_iter().flatten();
        let own = self.recorded.tools();
        let at = |tools| resume::plan(machine, || by(tools), &self.state(), &here);
        // What the plant has been given already, by the way on which this run was broken off.
        let (plan, tools, given_mm) =
            match self.tools_of_before().and_then(|old| Some((at(Some(old)).ok()?, old))) {
                Some((plan, old)) => {
                    let given = plan.clone().retooled(machine, by(Some(old)), by(own)).map_err(refused)?;
                    (plan, Some(old), given.changed.map_or([0.0; 2], |changed| changed.in_passes_mm))
                }
                None => (at(own).map_err(refused)?, own, [0.0; 2]),
            };
        let plan = plan.retooled(machine, by(tools), now).map_err(refused)?;
        let changed_mm = plan.changed.map_or([0.0; 2], |changed| changed.in_passes_mm);
        if changed_mm != given_mm {
            plant.change_tool([changed_mm[0] - given_mm[0], changed_mm[1] - given_mm[1]]);
        }
        Ok(plan)
    }

    /// The tool table of the run that this one goes on with, if it is another one and the journal has not
    /// seen yet that a tool was put in: then the tool in place is that of before.
    pub(crate) fn tools_of_before(&self) -> Option<&PathBuf> {
        let in_place = self.in_place()?;
        let held = |tools: &PathBuf| intake::bytes(tools, intake::TABLE).ok();
        (self.recorded.tools().and_then(held) != held(in_place)).then_some(in_place)
    }

    /// The tool table of the tool in place.
    fn in_place(&self) -> Option<&PathBuf> {
        match self.recorded.before() {
            Some(before) if self.state().tool == 0 => before.in_place(),
            _ => self.recorded.tools(),
        }
    }
}

/// The arguments of the run: its program is the one that its summary names, or, without one, the file by
/// which the journal knows it.
fn arguments(dir: &Path, summary: Option<&Summary>, input: Option<[u8; 16]>) -> Result<RunArgs, CliError> {
    let names = match summary {
        Some(summary) => Vec::from_iter(Path::new(&summary.program).file_name().map(Into::into)),
        None => may_be_programs(dir),
    };
    let others = summary.map(|summary| changed(dir, summary)).unwrap_or_default();
    for name in names {
        let mut args = arguments_of(&of_folder(dir), dir, &name)?;
        args.gauge.gauge = summary.and_then(Summary::repeats_gauge);
        let shop = args.machine.with_language(&args.language)?;
        let judged = Program::read(&args.program, &shop.language.language(), &shop.machine, None);
        let fits = others.is_empty()
            && judged.is_ok_and(|judged| {
                input.is_none_or(|input| input_of(dir, &judged, &name).is_ok_and(|held| held == input))
            });
        if fits {
            return Ok(args);
        }
    }
    let missing = dir.join(MACHINE).metadata().is_err().then(|| MACHINE.to_string());
    let others = Vec::from_iter(others.into_iter().chain(missing));
    let which = if others.is_empty() { String::new() } else { format!(" ({})", others.join(", ")) };
    let text = format!(
        "the program, the machine file, the scenario, tools or parameters in it are not those of its journal: they were changed \
         since{which}, and nobody knows where it stands in them\nhelp: put back what was changed, or run the program from its beginning"
    );
    Err(CliError::file(dir, text))
}

/// What reached its modules, up to where it was broken off. Nobody knows that better than the record of its
/// machine; without one it is taken where the journal saw it last.
fn arrivals(dir: &Path, known_cycle: u64) -> Result<Arrivals, CliError> {
    let path = dir.join(ARRIVALS);
    let whole = intake::text(&path, rig::replay::MOST_BYTES).ok();
    let arrivals = match whole {
        Some(text) => {
            let whole = Arrivals::from_text(&text).map_err(|error| CliError::file(&path, error))?;
            match whole.ended {
                true => whole,
                false => Arrivals { until: whole.until.max(known_cycle + 1), damaged: true, ..whole },
            }
        }
        None => {
            let until = moment::cycles(dir).unwrap_or(0).max(known_cycle + 1);
            Arrivals { until, ..moment::arrivals(dir) }
        }
    };
    match &arrivals.gap {
        Some(gap) => {
            let text = format!("what its machine did cannot be made again: its record has a gap: {gap}");
            Err(CliError::file(dir, text))
        }
        None => Ok(arrivals),
    }
}
