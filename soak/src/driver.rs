//! Many seeds on every core. In: a range of seeds, a number of threads. Out: a [`Report`]: what broke, how
//! many of each kind were drawn, how long each fault went unnoticed.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use machine::Machine;
use rig::wires::Wires;

use serde::Serialize;

use crate::case::{Case, Ready};
use crate::draw;
use crate::judge::Broken;
use crate::run::{self, Ran, Undisturbed};

/// A seed that broke an invariant.
#[derive(Clone, Debug)]
pub struct Failed {
    /// The seed.
    pub seed: u64,
    /// What it broke.
    pub broken: Broken,
    /// The case.
    pub case: Case,
}

/// What one seed came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Seen {
    /// The seed.
    pub seed: u64,
    /// What was drawn: kinds of program and events.
    pub drawn: Vec<&'static str>,
    /// How its last run ended; nothing if a module panicked.
    pub ended: Option<String>,
    /// The first fault of that run.
    pub fault: Option<String>,
    /// The first invariant that was broken,
    pub invariant: Option<&'static str>,
    /// in which cycle,
    pub broken_cycle: Option<u64>,
    /// and in words.
    pub broken: Option<String>,
    /// Control cycles of its runs.
    pub cycles: u64,
    /// From the only event to the first word about it, control cycles.
    pub first_word_cycles: Option<u64>,
}

impl Seen {
    fn of(seed: u64, case: &Case, ran: &Ran) -> Seen {
        let events = case.events.iter().map(|event| event.what.kind());
        let only = case.events.len() == 1;
        Seen {
            ended: Some(format!("{:?}", ran.observation.outcome).to_lowercase()),
            fault: ran.observation.faults.first().map(|fault| fault.code.clone()),
            cycles: ran.cycles,
            first_word_cycles: ran.reacted_after.filter(|_| only),
            ..Seen::broke(seed, ran.broken.as_ref(), case.kinds.iter().copied().chain(events).collect())
        }
    }

    fn broke(seed: u64, broken: Option<&Broken>, drawn: Vec<&'static str>) -> Seen {
        Seen {
            seed,
            drawn,
            invariant: broken.map(|broken| broken.invariant),
            broken_cycle: broken.map(|broken| broken.cycle),
            broken: broken.map(|broken| broken.text.clone()),
            ..Seen::default()
        }
    }
}

/// What many seeds came to.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Seeds that were run.
    pub seeds: u64,
    /// Control cycles of all of their runs.
    pub cycles: u64,
    /// Those that broke an invariant, by seed.
    pub failed: Vec<Failed>,
    /// How often each kind of program and event was drawn.
    pub drawn: BTreeMap<&'static str, u64>,
    /// How often each outcome and fault was seen.
    pub ended: BTreeMap<String, u64>,
    /// Longest time from an event to the first word about it, control cycles, where it was the only one.
    pub slowest: BTreeMap<&'static str, u64>,
}

impl Report {
    fn merge(&mut self, other: Report) {
        self.seeds += other.seeds;
        self.cycles += other.cycles;
        self.failed.extend(other.failed);
        other.drawn.into_iter().for_each(|(kind, count)| *self.drawn.entry(kind).or_default() += count);
        other.ended.into_iter().for_each(|(kind, count)| *self.ended.entry(kind).or_default() += count);
        for (kind, cycles) in other.slowest {
            let slowest = self.slowest.entry(kind).or_default();
            *slowest = (*slowest).max(cycles);
        }
    }

    /// Takes what came of a seed, if no module panicked; says it.
    fn seed(&mut self, seed: u64, ran: Option<(Case, Ran)>) -> Seen {
        self.seeds += 1;
        let Some((case, ran)) = ran else {
            let failed = panicked(seed);
            let seen = Seen::broke(seed, Some(&failed.broken), failed.case.kinds.clone());
            self.failed.push(failed);
            return seen;
        };
        self.cycles += ran.cycles;
        self.take(&case, &ran);
        let seen = Seen::of(seed, &case, &ran);
        self.failed.extend(ran.broken.map(|broken| Failed { seed, broken, case }));
        seen
    }

    fn take(&mut self, case: &Case, ran: &Ran) {
        let shop = (case.machine.general.name == draw::SHOP).then_some(draw::SHOP);
        let events = case.events.iter().map(|event| event.what.kind());
        for kind in shop.into_iter().chain(case.kinds.iter().copied()).chain(events) {
            *self.drawn.entry(kind).or_default() += 1;
        }
        *self.drawn.entry(if case.events.is_empty() { "undisturbed" } else { "disturbed" }).or_default() += 1;
        let outcome = format!("{:?}", ran.observation.outcome).to_lowercase();
        *self.ended.entry(outcome).or_default() += 1;
        if let Some(fault) = ran.observation.faults.first() {
            *self.ended.entry(fault.code.clone()).or_default() += 1;
        }
        if let ([event], Some(after)) = (case.events.as_slice(), ran.reacted_after) {
            let slowest = self.slowest.entry(event.what.kind()).or_default();
            *slowest = (*slowest).max(after);
        }
    }
}

/// One seed: the case, and what it broke.
pub fn one(seed: u64) -> (Case, Ran) {
    let (case, cycles, ran) = both(seed, |case, _, alone| alone.disturbed(case));
    (case, Ran { cycles, ..ran })
}

/// One seed over wires of a test, from the beginning. Undisturbed, the case runs over straight wires.
pub fn over<W: Wires>(seed: u64, wires: impl FnOnce(&Machine) -> W) -> (Case, u64, Ran) {
    both(seed, |case, ready, alone| {
        run::disturbed_by(case, ready, &alone.ran.measured, wires(&ready.machine))
    })
}

/// One seed, without its events and then with them: the case, the cycles of both runs, and the last of them.
fn both(seed: u64, disturbed: impl FnOnce(&Case, &Ready, Undisturbed) -> Ran) -> (Case, u64, Ran) {
    let (mut case, ready) = draw(seed);
    let alone = Undisturbed::of(&case, &ready);
    let cycles = alone.ran.cycles;
    if alone.ran.broken.is_some() {
        return (case, cycles, alone.ran);
    }
    let events = &mut draw::seed_of_events(seed);
    let reference = &alone.ran.measured;
    case.events = draw::events(events, &ready.machine, reference.cycles, &reference.borders);
    if case.events.is_empty() {
        return (case, cycles, alone.ran);
    }
    let ran = disturbed(&case, &ready, alone);
    (case, cycles + ran.cycles, ran)
}

/// One seed; nothing if a module panics.
fn caught(seed: u64) -> Option<(Case, Ran)> {
    std::panic::catch_unwind(|| one(seed)).ok()
}

/// What is reported of a seed in which a module panics.
fn panicked(seed: u64) -> Failed {
    let (case, _) = draw(seed);
    Failed { seed, broken: Broken::new("panic", 0, "a module panics; the message is above".into()), case }
}

/// Who hears of every seed as it is done, how many are done and how many failed, and says whether to go on.
pub type Progress<'a> = &'a (dyn Fn(Seen, u64, u64) -> bool + Sync);

/// Runs seeds on so many threads.
pub fn soak(seeds: Range<u64>, jobs: usize, progress: Progress) -> Report {
    let (next, done, broken) = (AtomicU64::new(seeds.start), AtomicU64::new(0), AtomicU64::new(0));
    let whole = Mutex::new(Report::default());
    let work = || {
        let mut report = Report::default();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                break;
            }
            let seen = report.seed(seed, caught(seed));
            broken.fetch_add(u64::from(seen.invariant.is_some()), Ordering::Relaxed);
            if !progress(seen, done.fetch_add(1, Ordering::Relaxed) + 1, broken.load(Ordering::Relaxed)) {
                next.store(seeds.end, Ordering::Relaxed);
            }
        }
        if let Ok(mut whole) = whole.lock() {
            whole.merge(report);
        }
    };
    std::thread::scope(|scope| (0..jobs.max(1)).for_each(|_| drop(scope.spawn(work))));
    let mut report = whole.into_inner().unwrap_or_default();
    report.failed.sort_by_key(|failed| failed.seed);
    report
}
