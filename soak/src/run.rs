//! One run of a case. In: a case, ready, perhaps with a reference. Out: what the judge found, and how long it
//! took. A launcher is there too: who dies is noticed at once, who hangs after a while, and the supervisor
//! decides what becomes of the rest.
//!
//! Until its first event a case does what it does undisturbed. So an undisturbed run leaves copies of itself
//! on its way, and the disturbed one begins at the last of them before that event. Until there it is judged
//! with the undisturbed run: no event excuses or explains anything before it happens, and what the servo does
//! undisturbed is by definition within what it may do disturbed.

use std::iter::Copied;
use std::slice::Iter;

use machine::Machine;
use protocol::{Item, Module, operator::Request};
use rig::observe::{Observation, Observer};
use rig::supervisor::Supervisor;
use rig::wires::{Straight, Wires};
use rig::{Exchange, Rig};
use sim_plant::Scenario;

use crate::case::{Case, Ready};
use crate::event::{Event, What};
use crate::judge::{Broken, Ending, Judge, Reference, bounds};

/// How long the launcher lets a process hang, s.
const PATIENCE_S: f64 = 1.0;
/// A disturbed run may take so many times as long as the undisturbed one,
const SLOWER: f64 = 6.0;
/// and so much longer, s: ten pauses of a second, in which nobody presses cycle start, and the half minute
/// that the interpolator waits for a spindle, an index or an axis.
const LONGER_S: f64 = 42.0;
/// Copies that an undisturbed run leaves on its way, evenly over the time that it should take.
const COPIES: usize = 8;

/// What came of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Ran {
    /// The first invariant that was broken.
    pub broken: Option<Broken>,
    /// What was measured.
    pub measured: Reference,
    /// What the observer saw.
    pub observation: Observation,
    /// How it ended.
    pub ending: Ending,
    /// Control cycles that were made: of a run that was taken up on its way, those from there.
    pub cycles: u64,
    /// From the first event to the first word about it, cycles.
    pub reacted_after: Option<u64>,
}

/// Runs a case without its events.
pub fn undisturbed(case: &Case, ready: &Ready) -> Ran {
    Run::new(case, ready, Straight).go(longest_undisturbed(ready), |_| {})
}

/// Runs a case with its events, from the beginning.
pub fn disturbed(case: &Case, ready: &Ready, reference: &Reference) -> Ran {
    disturbed_by(case, ready, reference, Straight)
}

/// The same over wires of a test, below what happens to messages in the case.
pub fn disturbed_by<W: Wires>(case: &Case, ready: &Ready, reference: &Reference, wires: W) -> Ran {
    Run::new(case, ready, wires).suffers(case, reference)
}

/// What a case does without its events, and copies of the run on its way.
pub struct Undisturbed<'a> {
    /// What came of it.
    pub ran: Ran,
    copies: Vec<Run<'a, Straight>>,
}

impl<'a> Undisturbed<'a> {
    /// Runs a case without its events.
    pub fn of(case: &Case, ready: &'a Ready) -> Undisturbed<'a> {
        let longest = longest_undisturbed(ready);
        let every = ((ready.time_s / ready.machine.general.cycle_s) as u64 / COPIES as u64).max(1);
        let mut copies = Vec::new();
        let ran = Run::new(case, ready, Straight).go(longest, |run| {
            if run.now.is_multiple_of(every) && copies.len() < COPIES && !run.paused {
                copies.push(run.clone());
            }
        });
        Undisturbed { ran, copies }
    }

    /// Runs the same case with its events, from the last copy before the first of them.
    ///
    /// # Panics
    /// If something happens in cycle 0, before which there is no copy.
    pub fn disturbed(self, case: &Case) -> Ran {
        let Undisturbed { ran, copies } = self;
        let first = case.events.iter().map(|event| event.at).min().unwrap_or(u64::MAX);
        let copy = copies.into_iter().rfind(|copy| copy.now < first);
        copy.expect("nothing happens in cycle 0").suffers(case, &ran.measured)
    }
}

/// Who dies and who hangs, and when the launcher notices.
#[derive(Clone)]
struct Launcher {
    /// Modules that die or hang in this case, and when the launcher loses patience.
    doomed: Vec<(Module, Option<u64>)>,
    dead: Vec<Module>,
    supervisor: Supervisor,
}

impl Launcher {
    fn new(ready: &Ready) -> Launcher {
        let supervisor = Supervisor::new(&ready.machine, &ready.items);
        Launcher { doomed: Vec::new(), dead: Vec::new(), supervisor }
    }

    /// Who will die or hang.
    fn await_events(&mut self, events: &[Event], machine: &Machine) {
        let patience = (PATIENCE_S / machine.general.cycle_s) as u64;
        let doomed = events.iter().filter_map(|event| match event.what {
            What::Kill(module) => Some((module, None)),
            What::Freeze(module, Some(s)) if s < PATIENCE_S => Some((module, None)),
            What::Freeze(module, _) => Some((module, Some(event.at + patience))),
            _ => None,
        });
        self.doomed = doomed.collect();
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

/// A run between two cycles.
#[derive(Clone)]
struct Run<'a, W> {
    rig: Rig<Copied<Iter<'a, Item>>, W>,
    /// Until the last cycle.
    observer: Option<Observer>,
    judge: Judge<'a>,
    launcher: Launcher,
    /// What is to be done at the panel.
    request: Option<Request>,
    /// The next cycle.
    now: u64,
    /// The program has waited for cycle start: who presses it, and when, is a matter of the events to come.
    paused: bool,
}

impl<'a, W: Wires> Run<'a, W> {
    /// Before cycle 0; nothing will happen.
    fn new(case: &Case, ready: &'a Ready, wires: W) -> Run<'a, W> {
        let (machine, items) = (&ready.machine, ready.items.iter().copied());
        Run {
            rig: Rig::with_wires(machine, items, Scenario::none(), case.plant_seed, wires)
                .expect("what is drawn is a plant"),
            observer: Some(Observer::new(machine, &ready.items).in_brief()),
            judge: Judge::new(ready, &[], None),
            launcher: Launcher::new(ready),
            request: None,
            now: 0,
            paused: false,
        }
    }

    /// From here on to the end with the events of a case, which all lie ahead.
    fn suffers(mut self, case: &'a Case, reference: &'a Reference) -> Ran {
        let scenario = Scenario::from_toml(&case.scenario()).expect("what is drawn is a scenario");
        self.rig.play(scenario).expect("events are drawn for axes of the machine");
        self.judge = self.judge.told(&case.events, reference);
        self.launcher.await_events(&case.events, &case.machine);
        self.go(longest_disturbed(case, reference), |_| {})
    }

    /// From here on to the end. `look` sees the run before every cycle.
    fn go(mut self, longest: u64, mut look: impl FnMut(&Run<'a, W>)) -> Ran {
        let from = self.now;
        let (ending, observation) = loop {
            look(&self);
            if let Some(over) = self.cycle(longest) {
                break over;
            }
        };
        Ran {
            broken: self.judge.broken().cloned(),
            reacted_after: self.judge.reacted_after(),
            measured: self.judge.reference(),
            observation,
            ending,
            cycles: self.now - from,
        }
    }

    /// One control cycle; how the run ends if it was the last one, and what was observed.
    fn cycle(&mut self, longest: u64) -> Option<(Ending, Observation)> {
        let Run { rig, observer, judge, launcher, request, now, paused } = self;
        let asked = launcher.act(rig, *now).or(request.take());
        *now += 1;
        let mut over = None;
        rig.exchange(asked, |exchange: &Exchange| {
            let record = &exchange.record;
            observer.iter_mut().for_each(|observer| observer.cycle(record));
            judge.cycle(exchange);
            *paused |= exchange.spindle.paused != 0;
            *request = launcher.supervisor.cycle(record);
            let finished = record.truth.measurement.last != 0;
            let let_go = launcher.supervisor.end().map(Ending::Launcher);
            let ending = if finished { Some(Ending::Finished) } else { let_go };
            if let Some(ending) = ending.or((*now == longest).then_some(Ending::Never)) {
                let done = observer.take().map(Observer::finish).unwrap_or_default();
                judge.finish(ending, record, &done);
                over = Some((ending, done));
            }
        });
        over
    }
}

/// The bound of a run without events, control cycles.
fn longest_undisturbed(ready: &Ready) -> u64 {
    ((10.0 * ready.time_s + 60.0) / ready.machine.general.cycle_s) as u64
}

/// The bound of a run with events, control cycles.
fn longest_disturbed(case: &Case, reference: &Reference) -> u64 {
    let last = case.events.iter().map(|event| event.at).max().unwrap_or(0);
    let longer = (LONGER_S / case.machine.general.cycle_s) as u64;
    last + (SLOWER * reference.cycles as f64) as u64 + longer + bounds::spindle_stop(&case.machine)
}
