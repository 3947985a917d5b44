//! Somebody presses buttons at any moment: hold, cycle start, stop, abort, emergency stop, single block, in
//! threads of every kind, with every policy, and in timed motion, by seeds and at every cycle around each
//! border of a pass. An observer that knows nothing but the axes and the program checks every cycle of it:
//!
//! * no commanded position changes by more than V·T in a control cycle, no commanded speed by more than A·T;
//! * while the tool is in its groove it is within 5 µm of its helix; once it leaves it is at depth for no
//!   more than a turn and a half; nothing goes beyond the end of the pass;
//! * every pass is cut to its end once, in its order: one that was left is entered again on the same groove
//!   within 1.5 µm, one that was called off has not moved;
//! * nothing is done twice, nothing is left out, after the end nothing moves, and the end has a name.

mod chain;
mod late;
mod watch;
mod way;

use std::collections::BTreeSet;

use machine::{Machine, ProgramDialect, Reaction};
use protocol::{AxisState, Code, Item, ThreadPass, operator::Request};
use rig::observe::{Observation, Outcome};
use testing::Seed;

use crate::stand::{Stand, compiled};
use watch::{Cutting, Watch};
use way::Way;

const HEAD: &str = "G18 G21 G90 G8 G94 G97\n";
const SHORT: &str = "M3 S300\nG0 X10.8 Z0.95\nG0 X10\nG33 Z0 K0.25\nG0 X10.8\nG0 Z1\nM2\n";
const CYCLE: &str = "M3 S900\nG0 X12 Z6\nG76 P2 Z0 I-1 J0.4 K0.8 H1\nG0 X14\nG0 Z10\nM5\nM2\n";
const STARTS: &str =
    "M3 S400\nG0 X12 Z8\nG0 X9.5\nG33 Z2 K4\nG0 X12\nG0 Z10\nG0 X9.5\nG33 Z4 K4\nG0 X12\nG0 Z10\nM2\n";
const TAPER: &str = "M4 S500\nG0 X12 Z8\nG0 X9.5\nG33 X9.2 Z2 K2\nG0 X12\nG0 Z8\nM5\nM2\n";
/// On a face, outwards and inwards: Z takes the tool to depth and lifts it.
const FACE: &str =
    "M3 S400\nG0 X12 Z2\nG0 Z-0.4\nG33 X24 K2\nG0 Z2\nG0 X24\nG0 Z-0.4\nG33 X12 K2\nG0 Z2\nG0 X12\nM5\nM2\n";
const SHORT_FACE: &str = "M3 S300\nG0 X12 Z0.8\nG0 Z0\nG33 X12.95 K0.25\nG0 Z0.8\nG0 X12\nM2\n";
const TIMED: &str = "M3 S500\nG0 X20 Z50\nG1 X18 Z30 F2500\nG1 X20 Z20\nG2 X30 Z10 I10 F1500\nG4 P0.1\nG0 X40 Z40\nM0\nG0 Z45\nM2\n";

/// A thread of a kind at a speed, so long that it has one at all.
fn thread(kind: Kind, s_rpm: u32) -> String {
    let end = if s_rpm > 1000 { -24 } else { 4 };
    let begin = format!("M3 S{s_rpm}\nG0 X12 Z8\n");
    match kind {
        Kind::Outside => format!("{begin}G0 X9.5\nG33 Z{end} K1.5\nG0 X12\nG0 Z10\nM5\nM2\n"),
        Kind::Inside => {
            format!("M4 S{s_rpm}\nG0 X8 Z8\nG0 X10.5\nG33 Z{end} K1.5\nG0 X8\nG0 Z10\nM5\nM2\n")
        }
        Kind::Bare => format!("{begin}G0 X9.5\nG33 Z{end} K1.5\nG4 P0.05\nG0 X12\nG0 Z10\nM2\n"),
        Kind::Cycle => format!("{begin}G76 P1.5 Z{end} I-1 J0.4 K0.8 H1\nG0 X14\nG0 Z10\nM2\n"),
    }
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// G33 with a retract that belongs to it, from outside and from inside.
    Outside,
    Inside,
    /// Without one.
    Bare,
    /// G76, which begins with an approach.
    Cycle,
}

/// A program, what it does undisturbed, and how long that takes.
struct Job {
    machine: Machine,
    items: Vec<Item>,
    moves: u64,
    end_mm: Vec<f64>,
    cycles: u64,
    /// Cycles in which an axis goes from one state to the next, or the machine does.
    borders: Vec<u64>,
    /// Where each pass lies against its helix, µm.
    phases_um: Vec<f64>,
}

/// What an outside observer saw.
struct Seen {
    observation: Observation,
    moves: u64,
    end_mm: Vec<f64>,
    cycles: u64,
    borders: Vec<u64>,
    cut: Vec<Cutting>,
    late: u64,
    turns: [f64; 2],
    most_mm: f64,
}

impl Job {
    fn new(program: &str, machine: Machine) -> Job {
        let head = if machine.general.dialect == ProgramDialect::Fanuc { "" } else { HEAD };
        let items = compiled(&machine, &format!("{head}{program}"));
        let mut job =
            Job { machine, items, moves: 0, end_mm: vec![], cycles: 0, borders: vec![], phases_um: vec![] };
        let seen = job.run("undisturbed", |_| None);
        assert_eq!(seen.observation.outcome, Outcome::Completed, "{program}");
        job.phases_um = seen.observation.passes.iter().map(|pass| pass.phase_um).collect();
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

    /// The cycle in which the index of the first pass is seen.
    fn index(&self) -> u64 {
        let mut index = None;
        let stand = Stand { machine: &self.machine, items: &self.items, scenario: "", seed: 7 };
        stand.run(|record| {
            let seen = record.axes.iter().any(|(_, status)| status.state() == AxisState::WaitingForC0);
            index = index.or(seen.then_some(record.truth.cycle.0));
            None
        });
        index.expect("a pass")
    }

    fn pass(&self, number: u32) -> &ThreadPass {
        self.passes().find(|pass| pass.pass == number).expect("a pass of the program")
    }

    /// It has not begun yet.
    fn begin(&self) -> Way<'_> {
        let stand = Stand { machine: &self.machine, items: &self.items, scenario: "", seed: 7 };
        Way::new(stand.begin(), Watch::new(self))
    }

    /// Runs it to its end with what the operator does in each cycle, and checks every cycle.
    fn run(&self, what: &str, presses: impl Fn(u64) -> Option<Request>) -> Seen {
        self.begin().finished(what, presses)
    }

    /// Runs it with these presses. Cycle start is pressed again and again from `release` on: nobody waits for
    /// ever.
    fn press(&self, what: &str, presses: &[(u64, Request)], release: u64) -> Seen {
        self.press_from(self.begin(), what, presses, release)
    }

    /// The same on the way, before the first of them.
    fn press_from(&self, way: Way, what: &str, presses: &[(u64, Request)], release: u64) -> Seen {
        let seen = way.finished(what, |cycle| {
            let pressed = presses.iter().find(|(at, _)| *at == cycle).map(|(_, request)| *request);
            let released = cycle >= release && (cycle - release).is_multiple_of(400);
            pressed.or(released.then_some(Request::CycleStart))
        });
        let pressed = |button: &dyn Fn(&Request) -> bool| {
            presses.iter().any(|(at, press)| button(press) && *at <= seen.cycles)
        };
        let Observation { outcome, faults, passes, .. } = &seen.observation;
        let finished = seen.cut.iter().filter(|cut| cut.to_its_end).map(|cut| cut.number);
        let (finished, all): (Vec<u32>, Vec<u32>) =
            (finished.collect(), self.passes().map(|pass| pass.pass).collect());
        assert!(all.starts_with(&finished), "{what}: {finished:?} of {all:?}, each once");
        for pass in passes {
            assert!(pass.same_index, "{what}: {pass:#?}");
            assert!(pass.helix_max_abs_um < 3.0, "{what}: {} µm", pass.helix_max_abs_um);
            let apart_um = pass.phase_um - self.phases_um[pass.pass as usize - 1];
            assert!(!pass.complete || apart_um.abs() <= 1.5, "{what}: beside its groove by {apart_um} µm");
        }
        match outcome {
            Outcome::Completed => {
                assert_eq!(finished, all, "{what}: every pass");
                assert_eq!((seen.moves, &seen.end_mm), (self.moves, &self.end_mm), "{what}");
            }
            Outcome::Stopped => {
                assert!(pressed(&|press| matches!(press, Request::Stop | Request::Abort)), "{what}");
                assert!(seen.moves <= self.moves, "{what}");
            }
            Outcome::Faulted => {
                assert!(pressed(&|press| *press == Request::EmergencyStop), "{what}: {faults:?}");
                assert!(faults.iter().all(|fault| fault.code == "emergency-stop"), "{what}: {faults:?}");
            }
        }
        seen
    }
}

const BUTTONS: [Request; 7] = [
    Request::FeedHold,
    Request::CycleStart,
    Request::Stop,
    Request::Abort,
    Request::EmergencyStop,
    Request::SingleBlock(true),
    Request::SingleBlock(false),
];

/// What feed hold does, and what stop and abort do.
const POLICIES: [[Reaction; 2]; 4] = [
    [Reaction::Finish, Reaction::Leave],
    [Reaction::Leave, Reaction::Leave],
    [Reaction::Leave, Reaction::Finish],
    [Reaction::Finish, Reaction::Finish],
];

fn with([on_hold, on_stop]: [Reaction; 2]) -> Machine {
    let mut machine = Machine::plain();
    (machine.threading.on_hold, machine.threading.on_stop) = (on_hold, on_stop);
    machine
}

/// Random presses: as many runs as `count`, each with one to five of them, with every policy in turn.
fn at_random(name: &str, program: &str, count: u64) {
    at_random_on(name, program, with, count);
}

/// The same on a machine of one's own.
fn at_random_on(name: &str, program: &str, machine: fn([Reaction; 2]) -> Machine, count: u64) {
    let jobs = POLICIES.map(|policy| Job::new(program, machine(policy)));
    let (mut turns, mut mm, mut again) = ([0.0_f64; 2], 0.0_f64, 0);
    for case in 0..testing::count("PITCHLOCK_PRESSES", count) {
        let job = &jobs[case as usize % jobs.len()];
        let mut seed = Seed::of_case(case);
        let presses: Vec<_> = (0..=seed.below(5))
            .map(|_| {
                // Hold is what people press; stop and abort end what could still go wrong.
                let button = if seed.below(2) == 0 { 0 } else { seed.below(BUTTONS.len()) };
                (seed.within(0..job.cycles), BUTTONS[button])
            })
            .collect();
        let release = presses.iter().map(|(at, _)| at).max().copied().unwrap_or(0) + seed.within(1..3000);
        let seen = job.press(&format!("{name}, case {case}: {presses:?}"), &presses, release);
        mm = mm.max(seen.most_mm);
        turns = [0, 1].map(|i| turns[i].max(seen.turns[i]));
        again += seen.cut.iter().filter(|cut| !cut.to_its_end).count();
    }
    let [depth, groove] = turns;
    println!(
        "{name}: {again} left, {depth:.2} turns at depth, {groove:.2} in the groove, {:.2} µm off",
        1e3 * mm
    );
}

#[test]
fn presses_in_a_thread() {
    for s_rpm in [100, 600, 2000] {
        at_random(&format!("G33 S{s_rpm}"), &thread(Kind::Outside, s_rpm), 24);
    }
}

#[test]
fn presses_in_a_thread_from_inside() {
    for s_rpm in [100, 600, 2000] {
        at_random(&format!("inside S{s_rpm}"), &thread(Kind::Inside, s_rpm), 24);
    }
}

#[test]
fn presses_in_a_thread_without_a_retract() {
    for s_rpm in [100, 600, 2000] {
        at_random(&format!("bare S{s_rpm}"), &thread(Kind::Bare, s_rpm), 24);
    }
}

#[test]
fn presses_in_cycles() {
    for s_rpm in [100, 600, 2000] {
        at_random(&format!("G76 S{s_rpm}"), &thread(Kind::Cycle, s_rpm), 16);
    }
}

#[test]
fn presses_in_a_thread_of_one_millimetre() {
    at_random("short", SHORT, 200);
}

#[test]
fn presses_in_a_cycle() {
    at_random("G76", CYCLE, 60);
}

#[test]
fn presses_in_a_thread_of_two_starts() {
    at_random("two starts", STARTS, 60);
}

#[test]
fn presses_in_a_taper() {
    at_random("taper", TAPER, 60);
}

#[test]
fn presses_in_a_thread_on_a_face() {
    at_random("face", FACE, 120);
}

#[test]
fn presses_in_threads_at_a_varied_speed() {
    let varied = |how: &str, s_rpm| format!("({how})\n{}", thread(Kind::Outside, s_rpm));
    at_random("sine", &varied("speed_variation, sine, 30, 1", 100), 24);
    at_random("triangle", &varied("speed_variation, triangle, 20, 6", 400), 24);
    at_random("random", &format!("(speed_variation, random, 30, 2)\n{}", CYCLE.replace("S900", "S180")), 24);
}

#[test]
fn presses_in_timed_motion() {
    at_random("timed", TIMED, 60);
}

/// One press at every cycle around each border, released while it counts and long after it, where it
/// makes the axes leave and where the pass is finished.
fn at_each_border(program: &str) {
    for policy in [POLICIES[1], POLICIES[3]] {
        let job = Job::new(program, with(policy));
        let around = |border: &u64| border.saturating_sub(9)..border + 3;
        let mut way = job.begin();
        for at in job.borders.iter().flat_map(around).collect::<BTreeSet<u64>>() {
            way.to(at);
            for button in [Request::FeedHold, Request::Stop, Request::Abort, Request::EmergencyStop] {
                for release in [at + 5, at + 1500] {
                    let what = format!("{policy:?}: {button:?} at {at}, released at {release}");
                    job.press_from(way.clone(), &what, &[(at, button)], release);
                }
            }
        }
    }
}

#[test]
fn a_press_at_every_cycle_around_each_border_of_a_pass() {
    at_each_border(SHORT);
}

#[test]
fn a_press_at_every_cycle_around_each_border_of_a_pass_on_a_face() {
    at_each_border(SHORT_FACE);
}

/// Interpolator cycles from the shortest to the longest that the file of a lathe allows: a hold just before
/// the index never leads one axis away alone.
#[test]
fn nothing_has_moved_when_a_pass_is_called_off_at_any_interpolator_cycle() {
    for ticks in [3_u32, 4, 7, 10] {
        let mut machine = Machine::plain();
        machine.general.interpolator_cycle_s = f64::from(ticks) * machine.general.cycle_s;
        machine.check().expect("a machine file may say so");
        let job = Job::new(SHORT, machine);
        let threading = job.borders.iter().copied().filter(|at| *at > 100);
        let ahead = |border: u64| border.saturating_sub(u64::from(ticks) + 11)..=border;
        let mut way = job.begin();
        for at in threading.flat_map(ahead).collect::<BTreeSet<u64>>() {
            way.to(at);
            let what = format!("{ticks} cycles a tick, hold at {at}");
            job.press_from(way.clone(), &what, &[(at, Request::FeedHold)], at + 900);
        }
    }
}

/// Regulators look at the panel in every cycle, the interpolator once a tick: a hold that it never sees costs
/// a turn of the spindle, and nothing else.
#[test]
fn a_hold_of_some_cycles_around_the_index_costs_nothing_but_a_turn() {
    for ticks in [1_u32, 4] {
        for policy in [POLICIES[0], POLICIES[1]] {
            let mut machine = with(policy);
            machine.general.interpolator_cycle_s = f64::from(ticks) * machine.general.cycle_s;
            // Setpoints of a shorter tick reach less far ahead.
            for axis in machine.axis.values_mut() {
                axis.acceleration_lead_s = axis.acceleration_lead_s.min(0.001);
            }
            machine.check().expect("a machine file may say so");
            let job = Job::new("M3 S900\nG0 X12 Z6\nG76 P2 Z0 I-1 J0.3 K0.35\nM2\n", machine);
            let index = job.index();
            let mut way = job.begin();
            for at in index - 10..index + 40 {
                way.to(at);
                let near = (index - 2..index + 6).contains(&at);
                for long in if near { 1..=8 } else { at % 8 + 1..=at % 8 + 1 } {
                    let what =
                        format!("{ticks} cycles a tick, {policy:?}: hold at {at} for {long}, index {index}");
                    let seen = job.press_from(way.clone(), &what, &[(at, Request::FeedHold)], at + long);
                    assert_eq!(seen.observation.outcome, Outcome::Completed, "{what}");
                }
            }
        }
    }
}
