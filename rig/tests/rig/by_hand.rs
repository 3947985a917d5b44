//! Work by hand: jogs that are let go, or whose sender falls silent, in every cycle round their borders;
//! blocks that begin where the machine is, and nowhere else.

use machine::Machine;
use protocol::{
    Axis, ByHand, Code, Fault, Feed, Item, MachineState, Panel, PerAxis, Position, operator::Request,
};
use rig::{Rig, observe::Outcome, observe::Record};
use sim_plant::Scenario;
use testing::Seed;

use crate::stand::{Stand, pressed};

/// A sender that falls silent is obeyed for so long at most, cycles of 0.5 ms: 150 ms.
const SILENT: u64 = 300;
/// The first block is given in this cycle: the machine waits for it.
const GIVEN: u64 = 200;

fn at(x: f64, z: f64) -> PerAxis<Position> {
    let mut at = PerAxis::default();
    (at[Axis::X.index()], at[Axis::Z.index()]) = (Position::from_mm(x), Position::from_mm(z));
    at
}

/// Where the axes rest once the drives hold them: where their encoders saw them.
fn begins(machine: &Machine) -> PerAxis<Position> {
    let mut rig = Rig::new(machine, session([]).into_iter(), Scenario::none(), 5).expect("a machine");
    let mut at = PerAxis::default();
    for _ in 0..GIVEN {
        rig.cycle(None, |record: &Record| {
            for (axis, status) in record.axes {
                at[axis.index()] = Position::from_mm(status.commanded_mm);
            }
        });
    }
    at
}

fn x_z(at: &PerAxis<Position>) -> [f64; 2] {
    [Axis::X, Axis::Z].map(|axis| at[axis.index()].mm())
}

fn block(from: PerAxis<Position>, jogs: bool, codes: &[Code]) -> Vec<Code> {
    let mut all = vec![Code::ByHand(ByHand::Begins { at: from, jogs })];
    all.extend(codes);
    all.push(Code::ByHand(ByHand::Waits));
    all
}

fn session(blocks: impl IntoIterator<Item = Vec<Code>>) -> Vec<Item> {
    let codes = std::iter::once(Code::ByHand(ByHand::Waits)).chain(blocks.into_iter().flatten());
    codes.chain([Code::End]).map(|code| Item { line: 1, code }).collect()
}

/// The fastest jog of Z that may go on while a key is pressed, mm/min, as the panel offers it: it brakes
/// within 50 ms.
fn fastest(machine: &Machine) -> f64 {
    let config = &machine.axis[&Axis::Z];
    let soon = |v: f64| motion::Exit::stop_s(v, 0.0, &config.limits()) <= 0.05;
    let mut v = config.velocity_mm_s;
    while !soon(v) {
        v *= 0.99;
    }
    60.0 * v
}

/// A session of one jog: Z at its fastest from home towards the low end of its travel.
fn jog_of_z(machine: &Machine) -> Vec<Item> {
    let home = begins(machine);
    let [x, _] = x_z(&home);
    let low = machine.axis[&Axis::Z].travel_mm[0];
    let line = Code::Line { target: at(x, low), feed: Feed::PerMinute(fastest(machine)) };
    session([block(home, true, &[line])])
}

/// What is seen of Z in a run of so many cycles with these presses.
struct Seen {
    /// Commanded position, speed, acceleration, jerk.
    z: Vec<[f64; 4]>,
    states: Vec<MachineState>,
    fault: u32,
}

fn run(machine: &Machine, items: &[Item], presses: &[(u64, Request)], cycles: u64) -> Seen {
    let mut rig = Rig::new(machine, items.iter().copied(), Scenario::none(), 5).expect("a machine");
    let mut seen = Seen { z: Vec::new(), states: Vec::new(), fault: 0 };
    let mut request = None;
    for _ in 0..cycles {
        let now = request.take();
        rig.cycle(now, |record: &Record| {
            let (_, z) = record.axes.iter().find(|(axis, _)| *axis == Axis::Z).expect("there is a Z");
            seen.z.push([z.commanded_mm, z.velocity_mm_s, z.acceleration_mm_s2, z.jerk_mm_s3]);
            seen.states.push(record.machine.state());
            seen.fault = record.machine.fault;
            request = pressed(presses, record);
        });
    }
    seen
}

/// Presses of a jog that is given at [`GIVEN`] and confirmed every 50 cycles until one in this cycle.
fn jogged(last: u64) -> Vec<(u64, Request)> {
    let mut presses =
        vec![(50, Request::FeedOverride(200.0)), (GIVEN - 1, Request::Jog(true)), (GIVEN, Request::Block)];
    presses.extend((GIVEN + 1..last).step_by(50).map(|cycle| (cycle, Request::Jog(true))));
    presses.retain(|(cycle, _)| *cycle != last);
    presses.push((last, Request::Jog(true)));
    presses
}

/// Z stays within its limits and its travel, and its commanded place has no step.
fn is_smooth(machine: &Machine, z: &[[f64; 4]]) {
    let config = &machine.axis[&Axis::Z];
    let limits = config.limits();
    let within = |value: f64, limit: f64| value.abs() <= 1.000_1 * limit;
    for (cycle, [s, v, a, j]) in z.iter().enumerate() {
        assert!((config.travel_mm[0]..=config.travel_mm[1]).contains(s), "{cycle}: {s}");
        assert!(within(*v, limits.v) && within(*a, limits.a), "{cycle}: v {v} a {a}");
        // Between setpoints an axis follows a quintic, whose jerk swings about that of the law.
        assert!(j.abs() <= 1.6 * limits.j, "{cycle}: j {j} of {}", limits.j);
    }
    let step = z.windows(2).map(|two| (two[1][0] - two[0][0]).abs()).fold(0.0, f64::max);
    assert!(step <= 1.01 * limits.v * machine.general.cycle_s, "{step}");
}

/// Cycle from which on Z stands to the end.
fn stands_from(z: &[[f64; 4]]) -> u64 {
    z.iter().rposition(|[_, v, a, _]| *v != 0.0 || *a != 0.0).map_or(0, |last| last as u64 + 1)
}

#[test]
fn a_jog_whose_sender_falls_silent_stands_within_150_ms() {
    let machine = Machine::default();
    let items = jog_of_z(&machine);
    let mut latest = 0;
    // Round the moments at which it begins, has its speed, and goes on evenly.
    for last in (GIVEN + 1..GIVEN + 80).chain((GIVEN + 80..GIVEN + 400).step_by(13)) {
        let mut presses = jogged(last);
        // Who comes back too late has to press anew: this does not go on.
        presses.push((last + 220, Request::Jog(true)));
        let seen = run(&machine, &items, &presses, last + 900);
        is_smooth(&machine, &seen.z);
        let stands = stands_from(&seen.z);
        assert!(stands <= last + SILENT, "silent from {last} on, it stands from {stands} on");
        latest = latest.max(stands.saturating_sub(last));
        assert_eq!((seen.states.last(), seen.fault), (Some(&MachineState::ByHand), 0), "{last}");
    }
    println!("a jog at {:.0} mm/min stands {} cycles after its last sign", fastest(&machine), latest);
    assert!(latest > 160, "the key stays pressed for 160 cycles: {latest}");
}

#[test]
fn a_jog_that_is_let_go_stands_within_150_ms_and_its_end_may_be_the_end_of_travel() {
    let machine = Machine::default();
    let home = begins(&machine);
    let [x, _] = x_z(&home);
    let [_, high] = machine.axis[&Axis::Z].travel_mm;
    let feed = Feed::PerMinute(fastest(&machine));
    let mut seed = Seed::new(20);
    // To the end of travel, from places near it.
    let near = high - 3.0;
    let there = block(home, false, &[Code::Line { target: at(x, near), feed: Feed::Rapid }]);
    let jog = block(at(x, near), true, &[Code::Line { target: at(x, high), feed }]);
    let items = session([there, jog]);
    let begins = 4000;
    let mut latest = 0;
    for case in 0..60 {
        let last = begins + seed.below(160) as u64;
        let presses = [
            (GIVEN, Request::Block),
            (begins - 1, Request::Jog(true)),
            (begins, Request::Block),
            (last.max(begins + 1), Request::Jog(false)),
        ];
        let seen = run(&machine, &items, &presses, begins + 900);
        is_smooth(&machine, &seen.z);
        let stands = stands_from(&seen.z);
        // While it speeds up, its pulse is finished first.
        assert!(
            stands <= last.max(begins + 1) + SILENT,
            "{case}: let go in {last}, it stands from {stands} on"
        );
        latest = latest.max(stands.saturating_sub(last));
        assert_eq!((seen.states.last(), seen.fault), (Some(&MachineState::ByHand), 0), "{case}");
        assert!(seen.z.last().is_some_and(|[at, ..]| (near - 1e-6..=high).contains(at)), "{case}");
    }
    println!("a jog stands {latest} cycles after its key was let go");
}

/// Hold, stop, abort and emergency stop in every cycle round the beginning of a jog, its even part and its
/// end.
#[test]
fn what_is_pressed_in_a_jog_brings_it_to_rest_in_any_cycle() {
    let machine = Machine::default();
    let items = jog_of_z(&machine);
    let ends = GIVEN + 240;
    for request in [Request::FeedHold, Request::Stop, Request::Abort, Request::EmergencyStop] {
        for cycle in (GIVEN + 1..GIVEN + 40).chain(ends - 6..ends + 40) {
            let mut presses: Vec<_> = jogged(ends).into_iter().filter(|(at, _)| *at != cycle).collect();
            presses.push((cycle, request));
            let seen = run(&machine, &items, &presses, ends + 700);
            if request != Request::EmergencyStop {
                is_smooth(&machine, &seen.z);
            }
            let stands = stands_from(&seen.z);
            assert!(stands <= ends + SILENT + 8, "{request:?} in {cycle}: it stands from {stands} on");
            let over = match request {
                Request::EmergencyStop => matches!(seen.states.last(), Some(MachineState::Fault)),
                Request::FeedHold => seen.fault == 0,
                _ => seen.fault == 0 && seen.states.contains(&MachineState::Ended),
            };
            assert!(over, "{request:?} in {cycle}: {:?}, fault {}", seen.states.last(), seen.fault);
        }
    }
}

#[test]
fn a_block_begins_where_the_machine_is_or_not_at_all() {
    let machine = Machine::default();
    let home = begins(&machine);
    let [x, z] = x_z(&home);
    let feed = Feed::PerMinute(3000.0);
    let one = block(home, false, &[Code::Line { target: at(x - 1.0, z - 5.0), feed }]);
    let other = block(at(x - 1.0, z - 5.0), false, &[Code::Line { target: at(x, z), feed }]);
    let wrong = block(at(x - 1.0, z - 5.000_001), false, &[Code::Line { target: at(x, z), feed }]);
    let presses = [(GIVEN, Request::Block), (GIVEN + 2000, Request::Block)];
    let good = run(&machine, &session([one.clone(), other]), &presses, 5000);
    assert!(
        good.fault == 0 && good.z.last().is_some_and(|[at, ..]| (*at - z).abs() < 1e-9),
        "it went there and back"
    );
    let lowest = good.z.iter().map(|[at, ..]| *at).fold(f64::INFINITY, f64::min);
    assert!((lowest - (z - 5.0)).abs() < 1e-9, "{lowest}");
    let bad = run(&machine, &session([one, wrong]), &presses, 5000);
    assert_eq!(Fault::from_code(bad.fault), Some(Fault::BadMachineCode));
    assert!(bad.z.last().is_some_and(|[at, ..]| (*at - (z - 5.0)).abs() < 1e-9), "nothing has moved");
}

/// Nobody gives a block: the machine waits for ever, and stop ends it. What is typed before it waits is not
/// lost.
#[test]
fn the_machine_waits_for_a_block_and_a_stop_ends_the_session() {
    let machine = Machine::default();
    let items = session([]);
    let observed = Stand { machine: &machine, items: &items, scenario: "panel = \"recorded\"", seed: 1 };
    let mut waited = 0;
    let seen = observed.run(|record| {
        waited += u64::from(record.machine.state() == MachineState::ByHand);
        let panel = record.truth.measurement.panel;
        assert_eq!(panel.cycle_starts, 0, "nobody presses start by himself");
        (record.truth.cycle.0 == 200_000 && !panel.pressed(Panel::STOP)).then_some(Request::Stop)
    });
    assert!(waited > 190_000, "{waited}");
    assert_eq!(seen.outcome, Outcome::Stopped);
}
