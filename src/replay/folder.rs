//! A recorded run, ready to be made again. In: a run folder. Out: a machine in one process that does,
//! cycle by cycle, what the machine of the run did; or why that cannot be.

use std::{
    collections::VecDeque,
    path::{Path, PathBuf},
};

use interpreter::Language;
use machine::Machine;
use process::shell::LanguageArgs;
use protocol::{Input, Item, Module, OperatorRequest, Taken, Truth, operator::Request};
use rig::{
    Exchange, Rig,
    observe::{Observer, Summary},
    replay::{Arrivals, Change, MOST_BYTES, Replica},
    wires::Straight,
};
use sim_plant::{Plant, Scenario};

use super::left::Left;

use crate::{
    args::{MachineArgs, Shop},
    error::CliError,
    gauged::GaugeArgs,
    panel::PanelArgs,
    program::Program,
    run::{
        FarArgs, RunArgs, Timing, Trace,
        folder::{ARRIVALS, BEFORE, changed, repeated},
        read_scenario,
    },
    words,
};

/// What a run was made of, and what is known of it.
pub(crate) struct Recorded {
    /// How the user named it.
    pub(crate) name: String,
    /// What it came to.
    pub(crate) summary: Summary,
    /// The machine.
    pub(crate) machine: Machine,
    /// The text of its file, and that of the scenario.
    pub(crate) texts: [String; 2],
    pub(super) program: Program,
    pub(super) args: RunArgs,
    scenario: Scenario,
    arrivals: Arrivals,
    /// The run that it goes on with.
    before: Option<Box<Left>>,
}

pub(super) type Items = Box<dyn Iterator<Item = Item>>;

impl Recorded {
    /// Reads a run folder.
    ///
    /// # Errors
    /// What it lacks, by name.
    pub(crate) fn open(dir: &Path) -> Result<Recorded, CliError> {
        let asked = of_folder(dir);
        let args = repeated(&asked)?;
        let refused =
            |text: String| CliError::Input(format!("{}: cannot be made again: {text}", dir.display()));
        let summary = Summary::read(&dir.join("summary.json")).map_err(|error| refused(error.to_string()))?;
        for name in changed(dir, &summary) {
            words::say(&format!("note: {name} is not what it was when the run was made\n"));
        }
        let path = dir.join(ARRIVALS);
        let text = intake::text(&path, MOST_BYTES).map_err(|error| {
            refused(format!(
                "{ARRIVALS}, which says what reached its modules and when, cannot be read ({error}); a run of \
                 this version leaves one"
            ))
        })?;
        let arrivals = Arrivals::from_text(&text).map_err(|error| CliError::file(&path, error))?;
        if let Some(gap) = &arrivals.gap {
            return Err(refused(format!("the record of what reached its modules has a gap: {gap}")));
        }
        if arrivals.until < summary.cycles || !arrivals.ended {
            let cycle = arrivals.changes.last().map_or(0, |change| change.0);
            return Err(refused(format!(
                "{ARRIVALS} is torn behind control cycle {cycle}: its end is missing"
            )));
        }
        if summary.faults.iter().any(|fault| fault.code == "program-changed") {
            return Err(refused("its program was changed while it ran".into()));
        }
        Recorded::of(dir, args, summary, arrivals)
    }

    /// Reads what a run was made of. What was pressed is in its arrivals.
    pub(super) fn of(
        dir: &Path,
        mut args: RunArgs,
        summary: Summary,
        arrivals: Arrivals,
    ) -> Result<Recorded, CliError> {
        let Shop { machine, text, language, .. } = args.machine.with_language(&args.language)?;
        (args.language, args.presses) = (language, None);
        let program = Program::read(&args.program, &args.language.language(), &machine, args.gauge.read()?)?;
        let (scenario, scenario_text) = read_scenario(&args, &machine)?;
        let name = dir.display().to_string();
        let texts = [text, scenario_text.unwrap_or_default()];
        let before = dir.join(BEFORE);
        let before = before.is_dir().then(|| Left::open(&before).map(Box::new)).transpose()?;
        Ok(Recorded { name, summary, machine, texts, program, args, scenario, arrivals, before })
    }

    /// Who observes it.
    pub(crate) fn observer(&self) -> Observer {
        self.program.observer(&self.machine)
    }

    /// The program, and how it was read.
    pub(crate) fn program(&self) -> (&Program, &Path, Language) {
        (&self.program, &self.args.program, self.args.language.language())
    }

    /// The text of the program, or its bytes as such.
    pub(crate) fn program_bytes(&self) -> Vec<u8> {
        intake::bytes(&self.args.program, intake::SHOWN).unwrap_or_default()
    }

    /// Messages that did not come when they were due.
    pub(crate) fn changes(&self) -> usize {
        self.arrivals.changes.len()
    }

    /// Its tool table.
    pub(super) fn tools(&self) -> Option<&PathBuf> {
        self.args.language.tools.as_ref()
    }

    /// The run that it goes on with.
    pub(super) fn before(&self) -> Option<&Left> {
        self.before.as_deref()
    }

    /// Whether the end of what reached its modules is damaged, of a record that was not finished.
    pub(super) fn record_is_damaged(&self) -> bool {
        self.arrivals.damaged
    }

    /// Whether the record of what reached its modules was finished.
    pub(super) fn has_an_end(&self) -> bool {
        self.arrivals.ended
    }

    /// The machine code of the program; what stands behind an error is not run.
    pub(super) fn items(&self) -> Result<Items, CliError> {
        self.items_by(self.tools())
    }

    /// The same by another tool table.
    pub(super) fn items_by(&self, tools: Option<&PathBuf>) -> Result<Items, CliError> {
        let language = LanguageArgs { tools: tools.cloned(), ..self.args.language.clone() }.language();
        let items = self.program.items(&self.args.program, &language, &self.machine)?;
        Ok(Box::new(items.map_while(Result::ok).fuse()))
    }

    /// The machine before cycle 0.
    pub(super) fn machine_again(&self) -> Result<Again, CliError> {
        Ok(self.begun()?.0)
    }

    /// The same, and who observes it, with what was seen of the runs that it goes on with.
    pub(crate) fn begun(&self) -> Result<(Again, Observer), CliError> {
        let (items, mut observer) = (self.items()?, self.observer());
        let (scenario, seed) = (self.scenario.clone(), self.summary.seed);
        let wrong = |error: sim_plant::PlantError| CliError::Input(error.to_string());
        let how = if let Some(before) = &self.before {
            let (mut plant, seen) = before.at_rest(scenario)?;
            let plan = before.plan(&mut plant, self.items()?)?;
            let items: Items = Box::new(plan.executed(items));
            observer = observer.going_on(seen);
            let rig = Rig::on_plant(&self.machine, plant, items, Straight);
            How::OneProcess(Box::new(rig), self.arrivals.changes.iter().copied().collect())
        } else if self.arrivals.one_process {
            let rig = Rig::new(&self.machine, items, scenario, seed).map_err(wrong)?;
            How::OneProcess(Box::new(rig), self.arrivals.changes.iter().copied().collect())
        } else {
            let replica =
                Replica::new(&self.machine, items, scenario, seed, &self.arrivals).map_err(wrong)?;
            How::Processes(Box::new(replica))
        };
        Ok((Again { how, now: 0, until: self.arrivals.until, name: self.name.clone() }, observer))
    }
}

/// The arguments of `run` that name a folder and nothing else.
pub(super) fn of_folder(dir: &Path) -> RunArgs {
    RunArgs {
        program: dir.into(),
        language: LanguageArgs::default(),
        machine: MachineArgs { machine: None },
        gauge: GaugeArgs { gauge: None },
        far: FarArgs::default(),
        clock: Timing::default(),
        pace: None,
        with_panel: false,
        panel: PanelArgs::default(),
        presses: None,
        by_hand: false,
        processes: false,
        in_process: false,
        scenario: None,
        single_block: false,
        seed: None,
        out: None,
        trace: Trace::None,
        watchdog_s: 0.0,
        fell: Vec::new(),
        unkept: false,
        resume: false,
        from: None,
        dry_run: false,
        json: false,
    }
}

/// A machine that does again what it did.
pub(crate) struct Again {
    how: How,
    now: u64,
    until: u64,
    name: String,
}

enum How {
    OneProcess(Box<Rig<Items>>, VecDeque<Change>),
    Processes(Box<Replica<Items>>),
}

impl Again {
    /// The next control cycle, and whether the recorder saw it. False when there is none.
    ///
    /// # Errors
    /// The arrivals are not those of this run.
    pub(crate) fn step(&mut self, see: impl FnOnce(&Exchange, bool)) -> Result<bool, CliError> {
        if self.now >= self.until {
            return Ok(false);
        }
        let now = self.now;
        self.now += 1;
        let goes_on = match &mut self.how {
            How::Processes(replica) => {
                replica.exchange(see).map_err(|error| CliError::Input(format!("{}: {error}", self.name)))?
            }
            How::OneProcess(rig, changes) => {
                let (request, killed) = outside(changes, now);
                let goes_on = rig.exchange(request, |exchange| see(exchange, true));
                killed.into_iter().for_each(|module| rig.kill(module));
                goes_on
            }
        };
        if !goes_on {
            self.until = self.now;
        }
        Ok(true)
    }

    /// Mains and controls fail behind the cycle that was last: the plant at rest.
    pub(super) fn lose_power(self, mut see: impl FnMut(&Truth)) -> Plant {
        match self.how {
            How::OneProcess(rig, _) => rig.lose_power(see),
            How::Processes(replica) => replica.lose_power(&mut see),
        }
    }
}

/// What came from outside in a cycle: what the operator asked for, who was killed behind it.
fn outside(changes: &mut VecDeque<Change>, now: u64) -> (Option<Request>, Vec<Module>) {
    let (mut request, mut killed) = (OperatorRequest::default(), Vec::new());
    while let Some((_, input, taken)) = changes.pop_front_if(|(cycle, ..)| *cycle <= now) {
        match (input, taken) {
            (Input::OperatorValue, Taken::This(bits)) => request.value = f64::from_bits(bits),
            (Input::Operator, Taken::This(kind)) => request.kind = kind as u32,
            (Input::Killed, Taken::This(code)) => killed.extend(Module::from_code(code as u32)),
            _ => {}
        }
    }
    (request.unpack().ok(), killed)
}
