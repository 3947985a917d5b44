//! One run of a case. In: a case, ready, perhaps with a reference. Out: what the judge found, and how long it took.
//! A launcher is there too: who dies is noticed at once, who hangs after a while, and the supervisor decides what
//! becomes of the rest.

use machine::Machine;
use protocol::{Item, Module, operator::Request};
use rig::observe::{Observation, Observer, Record};
use rig::supervisor::{Part, Supervisor};
use rig::wires::{Straight, Wires};
use rig::{Exchange, Rig};
use sim_plant::Scenario;

use crate::case::{Case, Ready};
use crate::event::{Event, What};
use crate::fates::Fates;
use crate::judge::{Broken, Ending, Judge, Reference, bounds};

/// How long the launcher lets a process hang, s.
const PATIENCE_S: f64 = 1.0;
/// A disturbed run may take so many times as long as the undisturbed one,
const SLOWER: f64 = 6.0;
/// and so much longer, s: ten pauses of a second, in which nobody presses cycle start.
const LONGER_S: f64 = 10.0;

/// What came of a run.
#[derive(Clone, Debug)]
pub struct Ran {
    /// The first invariant that was broken.
    pub broken: Option<Broken>,
    /// What was measured.
    pub measured: Reference,
    /// What the observer saw.
    pub observation: Observation,
    /// How it ended.
    pub ending: Ending,
    /// Control cycles.
    pub cycles: u64,
    /// From the first event to the first word about it, cycles.
    pub reacted_after: Option<u64>,
}

/// Runs a case without its events.
pub fn undisturbed(case: &Case, ready: &Ready) -> Ran {
    run(&Case { events: Vec::new(), ..case.clone() }, ready, None, Straight)
}

/// Runs a case with its events.
pub fn disturbed(case: &Case, ready: &Ready, reference: &Reference) -> Ran {
    disturbed_by(case, ready, reference, Straight)
}

/// The same over wires of a test, below what happens to messages in the case.
pub fn disturbed_by<W: Wires>(case: &Case, ready: &Ready, reference: &Reference, wires: W) -> Ran {
    let fates = Fates::of(&case.events);
    match fates.is_none() {
        true => run(case, ready, Some(reference), wires),
        false => run(case, ready, Some(reference), wires.with(fates)),
    }
}

/// Who dies and who hangs, and when the launcher notices.
struct Launcher<'a> {
    events: &'a [Event],
    supervisor: Supervisor,
    patience: u64,
}

impl Launcher<'_> {
    /// Before a cycle.
    fn act<I: Iterator<Item = Item>, W: Wires>(&mut self, rig: &mut Rig<I, W>, now: u64) {
        for event in self.events {
            match event.what {
                What::Kill(module) if event.at == now => self.dies(rig, module),
                What::Freeze(module, _) if event.at == now => rig.freeze(module),
                What::Freeze(module, Some(cycles)) if cycles < self.patience && event.at + cycles == now => {
                    rig.thaw(module);
                }
                What::Freeze(module, None) if event.at + self.patience == now => self.dies(rig, module),
                What::Freeze(module, Some(cycles))
                    if cycles >= self.patience && event.at + self.patience == now =>
                {
                    self.dies(rig, module);
                }
                _ => {}
            }
        }
    }

    fn dies<I: Iterator<Item = Item>, W: Wires>(&mut self, rig: &mut Rig<I, W>, module: Module) {
        rig.kill(module);
        self.supervisor.died(match module {
            Module::Interpreter => Part::Interpreter,
            Module::Interpolator => Part::Interpolator,
            Module::Regulator(axis) => Part::Regulator(axis),
        });
    }
}

fn run<W: Wires>(case: &Case, ready: &Ready, reference: Option<&Reference>, wires: W) -> Ran {
    let machine = &ready.machine;
    let scenario = Scenario::from_toml(&case.scenario()).expect("what is drawn is a scenario");
    let mut rig = Rig::with_wires(machine, ready.items.iter().copied(), scenario, case.plant_seed, wires)
        .expect("what is drawn is a plant");
    let mut observer = Observer::new(machine, &ready.items);
    let mut judge = Judge::new(ready, &case.events, reference);
    let patience = (PATIENCE_S / machine.general.cycle_s) as u64;
    let supervisor = Supervisor::new(machine, &ready.items);
    let mut launcher = Launcher { events: &case.events, supervisor, patience };
    let longest = longest(machine, ready, case, reference);
    let mut request: Option<Request> = None;
    let mut ending = Ending::Never;
    let mut cycles = 0;
    for now in 0..longest {
        launcher.act(&mut rig, now);
        let mut finish = None;
        let more = rig.exchange(request.take(), |exchange: &Exchange| {
            let record = &exchange.record;
            observer.cycle(record);
            judge.cycle(exchange);
            request = launcher.supervisor.cycle(record);
            finish = launcher.supervisor.end().map(Ending::Launcher);
            let last = record.truth.measurement.last != 0;
            let over = if last { Some(Ending::Finished) } else { finish };
            if over.is_some() || now + 1 == longest {
                ending = over.unwrap_or(Ending::Never);
                close(&mut judge, ending, record, &mut observer, machine, ready);
            }
        });
        cycles = now + 1;
        if !more || finish.is_some() {
            break;
        }
    }
    Ran {
        broken: judge.broken().cloned(),
        reacted_after: judge.reacted_after(),
        measured: judge.reference(),
        observation: observer.finish(),
        ending,
        cycles,
    }
}

/// The judge hears what the observer makes of the run; the observer is asked for it before it has ended, so a
/// new one takes its place.
fn close(judge: &mut Judge, ending: Ending, record: &Record, observer: &mut Observer, machine: &Machine, ready: &Ready) {
    let done = std::mem::replace(observer, Observer::new(machine, &ready.items));
    judge.finish(ending, record, &done.finish());
}

/// The bound of a run, control cycles.
fn longest(machine: &Machine, ready: &Ready, case: &Case, reference: Option<&Reference>) -> u64 {
    let cycles = |s: f64| (s / machine.general.cycle_s) as u64;
    let Some(reference) = reference else { return cycles(10.0 * ready.time_s + 60.0) };
    let last = case.events.iter().map(|event| event.at).max().unwrap_or(0);
    last + (SLOWER * reference.cycles as f64) as u64 + cycles(LONGER_S) + bounds::spindle_stop(machine)
}
