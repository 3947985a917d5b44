//! One run of a case. In: a case, ready, perhaps with a reference. Out: what the judge found, and how long it
//! took. A launcher is there too: who dies is noticed at once, who hangs after a while, and the supervisor
//! decides what becomes of the rest.

use machine::Machine;
use protocol::{Item, Module, operator::Request};
use rig::observe::{Observation, Observer};
use rig::supervisor::Supervisor;
use rig::wires::{Straight, Wires};
use rig::{Exchange, Rig};
use sim_plant::Scenario;

use crate::case::{Case, Ready};
use crate::event::What;
use crate::judge::{Broken, Ending, Judge, Reference, bounds};

/// How long the launcher lets a process hang, s.
const PATIENCE_S: f64 = 1.0;
/// A disturbed run may take so many times as long as the undisturbed one,
const SLOWER: f64 = 6.0;
/// and so much longer, s: ten pauses of a second, in which nobody presses cycle start, and the half minute
/// that the interpolator waits for a spindle, an index or an axis.
const LONGER_S: f64 = 42.0;

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
    run(case, ready, Some(reference), Straight)
}

/// The same over wires of a test, below what happens to messages in the case.
pub fn disturbed_by<W: Wires>(case: &Case, ready: &Ready, reference: &Reference, wires: W) -> Ran {
    run(case, ready, Some(reference), wires)
}

/// Who dies and who hangs, and when the launcher notices.
struct Launcher {
    /// Modules that die or hang in this case, and when the launcher loses patience.
    doomed: Vec<(Module, Option<u64>)>,
    dead: Vec<Module>,
    supervisor: Supervisor,
}

impl Launcher {
    fn new(case: &Case, ready: &Ready) -> Launcher {
        let cycle_s = ready.machine.general.cycle_s;
        let patience = (PATIENCE_S / cycle_s) as u64;
        let doomed = case.events.iter().filter_map(|event| match event.what {
            What::Kill(module) => Some((module, None)),
            What::Freeze(module, Some(s)) if s < PATIENCE_S => Some((module, None)),
            What::Freeze(module, _) => Some((module, Some(event.at + patience))),
            _ => None,
        });
        let supervisor = Supervisor::new(&ready.machine, &ready.items);
        Launcher { doomed: doomed.collect(), dead: Vec::new(), supervisor }
    }

    /// Before a cycle. What it gives is to be done at the panel.
    fn act<I: Iterator<Item = Item>, W: Wires>(&mut self, rig: &mut Rig<I, W>, now: u64) -> Option<Request> {
        let mut asked = None;
        for (module, until) in &self.doomed {
            if *until == Some(now) {
                rig.kill(*module);
            }
            if rig.is_dead(*module) && !self.dead.contains(module) {
                self.dead.push(*module);
                asked = self.supervisor.died(*module, now).or(asked);
            }
        }
        asked
    }
}

fn run<W: Wires>(case: &Case, ready: &Ready, reference: Option<&Reference>, wires: W) -> Ran {
    let machine = &ready.machine;
    let scenario = Scenario::from_toml(&case.scenario()).expect("what is drawn is a scenario");
    let mut rig = Rig::with_wires(machine, ready.items.iter().copied(), scenario, case.plant_seed, wires)
        .expect("what is drawn is a plant");
    let mut observer = Some(Observer::new(machine, &ready.items).in_brief());
    let mut judge = Judge::new(ready, &case.events, reference);
    let mut launcher = Launcher::new(case, ready);
    let longest = longest(machine, ready, case, reference);
    let mut request: Option<Request> = None;
    let mut ending = Ending::Never;
    let mut cycles = 0;
    let mut observation = None;
    for now in 0..longest {
        request = launcher.act(&mut rig, now).or(request);
        let mut finish = None;
        let more = rig.exchange(request.take(), |exchange: &Exchange| {
            let record = &exchange.record;
            if let Some(observer) = &mut observer {
                observer.cycle(record);
            }
            judge.cycle(exchange);
            request = launcher.supervisor.cycle(record);
            finish = launcher.supervisor.end().map(Ending::Launcher);
            let last = record.truth.measurement.last != 0;
            let over = if last { Some(Ending::Finished) } else { finish };
            if over.is_some() || now + 1 == longest {
                ending = over.unwrap_or(Ending::Never);
                let done = observer.take().map(Observer::finish).unwrap_or_default();
                judge.finish(ending, record, &done);
                observation = Some(done);
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
        observation: observation.unwrap_or_default(),
        ending,
        cycles,
    }
}

/// The bound of a run, control cycles.
fn longest(machine: &Machine, ready: &Ready, case: &Case, reference: Option<&Reference>) -> u64 {
    let cycles = |s: f64| (s / machine.general.cycle_s) as u64;
    let Some(reference) = reference else { return cycles(10.0 * ready.time_s + 60.0) };
    let last = case.events.iter().map(|event| event.at).max().unwrap_or(0);
    last + (SLOWER * reference.cycles as f64) as u64 + cycles(LONGER_S) + bounds::spindle_stop(machine)
}
