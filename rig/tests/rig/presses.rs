//! Somebody presses buttons at any moment: hold, cycle start, stop, abort, single block, in threads of every
//! kind and in timed motion, by seeds and at every cycle around each border of a pass. An observer that knows
//! nothing but the axes and the program checks every cycle of it:
//!
//! * no commanded position changes by more than V·T in a control cycle, no commanded speed by more than A·T;
//! * whatever moves in a pass moves along its law: every pass is cut once, in its order, to its end and on
//!   its helix, or was called off before anything moved, and is not reported as a pass;
//! * nothing is done twice, nothing is left out, and after the end nothing moves.

use std::collections::BTreeSet;

use machine::Machine;
use protocol::{AxisState, Code, Item, MachineState, ThreadPass, operator::Request};
use rig::observe::{Observation, Outcome, Record};
use testing::Seed;

use crate::stand::{Stand, compiled};

const HEAD: &str = "G18 G21 G90 G8 G94 G97\n";
const G33: &str = "M3 S600\nG0 X12 Z8\nG0 X9.5\nG33 Z0 K2\nG0 X12\nG0 Z10\nM5\nM2\n";
const SHORT: &str = "M3 S300\nG0 X10.8 Z0.95\nG0 X10\nG33 Z0 K0.25\nG0 X10.8\nG0 Z1\nM2\n";
const CYCLE: &str = "M3 S900\nG0 X12 Z6\nG76 P2 Z0 I-1 J0.4 K0.8 H1\nG0 X14\nG0 Z10\nM5\nM2\n";
const STARTS: &str =
    "M3 S400\nG0 X12 Z8\nG0 X9.5\nG33 Z2 K4\nG0 X12\nG0 Z10\nG0 X9.5\nG33 Z4 K4\nG0 X12\nG0 Z10\nM2\n";
const TAPER: &str = "M4 S500\nG0 X12 Z8\nG0 X9.5\nG33 X9.2 Z2 K2\nG0 X12\nG0 Z8\nM5\nM2\n";
const TIMED: &str = "M3 S500\nG0 X20 Z50\nG1 X18 Z30 F2500\nG1 X20 Z20\nG2 X30 Z10 I10 F1500\nG4 P0.1\nG0 X40 Z40\nM0\nG0 Z45\nM2\n";

/// A program, what it does undisturbed, and how long that takes.
struct Job {
    machine: Machine,
    items: Vec<Item>,
    moves: u64,
    end_mm: Vec<f64>,
    cycles: u64,
    /// Cycles in which an axis goes from one state to the next, or the machine does.
    borders: Vec<u64>,
}

/// What an outside observer saw.
struct Seen {
    observation: Observation,
    moves: u64,
    end_mm: Vec<f64>,
    cycles: u64,
    borders: Vec<u64>,
}

impl Job {
    fn new(program: &str, machine: Machine) -> Job {
        let items = compiled(&machine, &format!("{HEAD}{program}"));
        let mut job = Job { machine, items, moves: 0, end_mm: vec![], cycles: 0, borders: vec![] };
        let seen = job.run("undisturbed", |_| None);
        assert_eq!(seen.observation.outcome, Outcome::Completed, "{program}");
        (job.moves, job.end_mm) = (seen.moves, seen.end_mm);
        (job.cycles, job.borders) = (seen.cycles, seen.borders);
        job
    }

    fn passes(&self) -> impl Iterator<Item = &ThreadPass> {
        self.items.iter().filter_map(|item| match &item.code {
            Code::Pass(pass) => Some(pass),
            _ => None,
        })
    }

    /// Runs it to its end with what the operator does in each cycle, and checks every cycle.
    fn run(&self, what: &str, presses: impl Fn(u64) -> Option<Request>) -> Seen {
        let stand = Stand { machine: &self.machine, items: &self.items, scenario: "", seed: 7 };
        let mut watch = Watch::new(self);
        let observation = stand.run(|record| {
            watch.cycle(what, record);
            presses(record.truth.cycle.0)
        });
        let Watch { last_mm, moves, borders, .. } = watch;
        Seen { cycles: observation.cycles, observation, moves, end_mm: last_mm, borders }
    }

    /// Runs it with these presses. Cycle start is pressed again and again from `release` on: nobody waits for
    /// ever.
    fn press(&self, what: &str, presses: &[(u64, Request)], release: u64) {
        let seen = self.run(what, |cycle| {
            let pressed = presses.iter().find(|(at, _)| *at == cycle).map(|(_, request)| *request);
            let released = cycle >= release && (cycle - release).is_multiple_of(400);
            pressed.or(released.then_some(Request::CycleStart))
        });
        let ended = presses
            .iter()
            .any(|(at, press)| matches!(press, Request::Stop | Request::Abort) && *at <= seen.cycles);
        let Observation { outcome, faults, passes, .. } = &seen.observation;
        assert!(faults.is_empty(), "{what}: {faults:?}");
        let numbers: Vec<u32> = passes.iter().map(|pass| pass.pass).collect();
        let all: Vec<u32> = self.passes().map(|pass| pass.pass).collect();
        for pass in passes {
            assert!(pass.complete && pass.same_index, "{what}: {pass:#?}");
            assert!(pass.helix_max_abs_um < 3.0, "{what}: {} µm", pass.helix_max_abs_um);
        }
        if *outcome == Outcome::Completed {
            assert_eq!(numbers, all, "{what}: every pass once, in its order");
            assert_eq!((seen.moves, &seen.end_mm), (self.moves, &self.end_mm), "{what}");
        } else {
            assert!(ended && *outcome == Outcome::Stopped, "{what}: {outcome:?}");
            assert!(all.starts_with(&numbers), "{what}: {numbers:?} of {all:?}");
            assert!(seen.moves <= self.moves, "{what}");
        }
    }
}

/// The observer from outside.
struct Watch<'a> {
    job: &'a Job,
    last_mm: Vec<f64>,
    last_mm_s: Vec<f64>,
    states: Vec<u32>,
    moves: u64,
    ended: bool,
    borders: Vec<u64>,
}

impl<'a> Watch<'a> {
    fn new(job: &'a Job) -> Watch<'a> {
        Watch {
            job,
            last_mm: vec![],
            last_mm_s: vec![],
            states: vec![],
            moves: 0,
            ended: false,
            borders: vec![],
        }
    }

    fn cycle(&mut self, what: &str, record: &Record) {
        let (cycle, cycle_s) = (record.truth.cycle.0, self.job.machine.general.cycle_s);
        let mm: Vec<f64> = record.axes.iter().map(|(_, status)| status.commanded_mm).collect();
        let mm_s: Vec<f64> = record.axes.iter().map(|(_, status)| status.velocity_mm_s).collect();
        let follows = |status: &protocol::AxisStatus| status.state != AxisState::Idle as u32;
        for (i, (axis, status)) in record.axes.iter().enumerate() {
            // Before an axis follows anything, commanded is where it was measured.
            let Some((before, before_s)) = self.last_mm.get(i).zip(self.last_mm_s.get(i)) else { continue };
            if !follows(status) || self.states[i] == AxisState::Idle as u32 {
                continue;
            }
            let limits = self.job.machine.axis[axis].limits();
            let (step, change) = ((mm[i] - before).abs(), (mm_s[i] - before_s).abs());
            let at = format!("{what}, cycle {cycle}, {axis:?} in state {}", status.state);
            assert!(step <= limits.v * cycle_s * (1.0 + 1e-4) + 1e-6, "{at}: {before} → {} mm", mm[i]);
            assert!(change <= limits.a * cycle_s * 1.02 + 1e-6, "{at}: {before_s} → {} mm/s", mm_s[i]);
            assert!(
                !self.ended || step < 2e-9,
                "{at}: moves after the end by {step:e} mm, machine {}",
                record.machine.state
            );
            let may_move = ![AxisState::Armed as u32, AxisState::WaitingForC0 as u32].contains(&status.state);
            assert!(may_move || step < 2e-9, "{at}: moves before its pass");
        }
        let mut states: Vec<u32> = record.axes.iter().map(|(_, status)| status.state).collect();
        states.push(record.machine.state);
        if states != self.states {
            self.borders.push(cycle);
        }
        (self.last_mm, self.last_mm_s, self.states) = (mm, mm_s, states);
        self.moves = record.machine.moves;
        self.ended = record.machine.state == MachineState::Ended as u32;
    }
}

const BUTTONS: [Request; 6] = [
    Request::FeedHold,
    Request::CycleStart,
    Request::Stop,
    Request::Abort,
    Request::SingleBlock(true),
    Request::SingleBlock(false),
];

/// Random presses: as many runs as `count`, each with one to five of them.
fn at_random(name: &str, program: &str, count: u64) {
    let job = Job::new(program, Machine::default());
    for case in 0..testing::count("PITCHLOCK_PRESSES", count) {
        let mut seed = Seed::of_case(case);
        let presses: Vec<_> = (0..=seed.below(5))
            .map(|_| {
                // Hold is what people press; stop and abort end what could still go wrong.
                let button = if seed.below(2) == 0 { 0 } else { seed.below(BUTTONS.len()) };
                (seed.within(0..job.cycles), BUTTONS[button])
            })
            .collect();
        let release = presses.iter().map(|(at, _)| at).max().copied().unwrap_or(0) + seed.within(1..3000);
        job.press(&format!("{name}, case {case}: {presses:?}"), &presses, release);
    }
}

#[test]
fn presses_in_a_thread() {
    at_random("G33", G33, 400);
}

#[test]
fn presses_in_a_thread_of_one_millimetre() {
    at_random("short", SHORT, 400);
}

#[test]
fn presses_in_a_cycle() {
    at_random("G76", CYCLE, 300);
}

#[test]
fn presses_in_a_thread_of_two_starts() {
    at_random("two starts", STARTS, 300);
}

#[test]
fn presses_in_a_taper() {
    at_random("taper", TAPER, 300);
}

#[test]
fn presses_in_timed_motion() {
    at_random("timed", TIMED, 300);
}

/// One press at every cycle around each border, released while it counts and long after it.
#[test]
fn a_press_at_every_cycle_around_each_border_of_a_pass() {
    let job = Job::new(SHORT, Machine::default());
    let around = |border: &u64| border.saturating_sub(9)..border + 3;
    for at in job.borders.iter().flat_map(around).collect::<BTreeSet<u64>>() {
        for button in [Request::FeedHold, Request::Stop, Request::Abort] {
            for release in [at + 5, at + 1500] {
                job.press(&format!("{button:?} at {at}, released at {release}"), &[(at, button)], release);
            }
        }
    }
}

/// Interpolator cycles from the shortest to the longest that the file of a lathe allows: a hold just before
/// the index never leads one axis away alone.
#[test]
fn nothing_has_moved_when_a_pass_is_called_off_at_any_interpolator_cycle() {
    for ticks in [3_u32, 4, 7, 10] {
        let mut machine = Machine::default();
        machine.general.interpolator_cycle_s = f64::from(ticks) * machine.general.cycle_s;
        machine.check().expect("a machine file may say so");
        let job = Job::new(SHORT, machine);
        let threading = job.borders.iter().copied().filter(|at| *at > 100);
        for (border, case) in threading.zip(0_u64..) {
            for ahead in 0..u64::from(ticks) + 12 {
                let at = border.saturating_sub(ahead);
                job.press(
                    &format!("{ticks} cycles a tick, hold at {at}, case {case}"),
                    &[(at, Request::FeedHold)],
                    at + 900,
                );
            }
        }
    }
}
