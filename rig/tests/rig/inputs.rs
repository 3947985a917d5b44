//! Waiting for inputs: what the plant shows, what the program does, and whoever presses what meanwhile.
#![allow(clippy::unwrap_used)]

use machine::{Input, Machine};
use protocol::{Code, Fault, Feed, Item, MachineState, Position, Until, operator::Request};
use rig::observe::{Observation, Outcome, Record};

use crate::stand::{Stand, pressed};

fn line(z: f64) -> Code {
    let mut target = [Position(0); 8];
    (target[0], target[2]) = (Position::from_mm(50.0), Position::from_mm(z));
    Code::Line { target, feed: Feed::Rapid }
}

fn wait(until: Until, within_s: f64) -> Code {
    Code::Await { input: 2, until, within_s }
}

/// A cycle of a run: its number, Z in truth, mm, whether the input is on, and the state.
type Moment = (u64, f64, bool, MachineState);

/// To Z 98, a wait in line 2, and on to Z 96. `initial`: the input is on before anything happens.
fn run(wait: Code, initial: bool, requests: &[(u64, Request)], scenario: &str) -> (Vec<Moment>, Observation) {
    let codes = [line(98.0), wait, line(96.0), Code::End];
    let items: Vec<_> = (1..).zip(codes).map(|(line, code)| Item { line, code }).collect();
    let mut machine = Machine::plain();
    machine.inputs = [("2".to_owned(), Input { name: "door closed".into(), initial })].into();
    let mut seen = Vec::new();
    let observation = Stand { machine: &machine, items: &items, scenario, seed: 5 }.run(|record: &Record| {
        let truth = record.truth;
        let on = truth.measurement.inputs == 4;
        seen.push((truth.cycle.0, truth.axes[2].motor_mm, on, record.machine.state()));
        pressed(requests, record)
    });
    (seen, observation)
}

/// The input goes on and off by turns, at these times, s.
fn toggles(first: bool, times_s: &[f64]) -> String {
    let event = |(index, time_s): (usize, &f64)| {
        let on = (index % 2 == 0) == first;
        format!("[[event]]\nat = {{ time_s = {time_s} }}\ninput = {{ number = 2, on = {on} }}\n")
    };
    times_s.iter().enumerate().map(event).collect()
}

/// The cycle in which Z leaves 98 mm for good.
fn goes_on(seen: &[Moment]) -> u64 {
    seen.iter().rfind(|moment| (moment.1 - 98.0).abs() < 0.01).unwrap().0
}

#[test]
fn a_program_goes_on_with_what_it_waits_for() {
    // Each wait, what the input is at first, when it changes, and which change ends the wait.
    let table: [(Until, bool, &[f64], f64); 8] = [
        (Until::High, false, &[2.0], 2.0),
        (Until::Low, true, &[2.0], 2.0),
        (Until::Rise, false, &[2.0], 2.0),
        (Until::Fall, true, &[2.0], 2.0),
        (Until::Rise, true, &[2.0, 2.5], 2.5),
        (Until::Fall, false, &[2.0, 2.5], 2.5),
        // It has come already, before the program is there.
        (Until::High, true, &[], 0.0),
        (Until::Low, false, &[], 0.0),
    ];
    for (until, initial, times_s, ends_s) in table {
        let (seen, observation) = run(wait(until, 5.0), initial, &[], &toggles(!initial, times_s));
        assert_eq!(observation.outcome, Outcome::Completed, "{until:?}: {:?}", observation.faults);
        let ends = ends_s / 0.0005;
        // Two ticks until it is seen and a move is planned, three until its setpoint is due, and some until Z
        // is 10 µm on its way.
        let begins = goes_on(&seen) as f64;
        if ends > 0.0 {
            assert!(begins >= ends && begins < ends + 60.0, "{until:?} from {initial}: {begins} for {ends}");
        } else {
            assert!(begins < 2000.0, "{until:?} from {initial} waits until {begins}");
        }
        let changes: Vec<_> = observation.inputs.iter().map(|one| (one.on, one.line, one.cycle)).collect();
        let first = initial.then_some((true, 0, 0));
        let rest = times_s.iter().zip([!initial, initial]).map(|(s, on)| (on, 2, (s / 0.0005) as u64));
        let wanted: Vec<_> = first.into_iter().chain(rest).collect();
        assert_eq!(changes, wanted, "{until:?} from {initial}");
    }
}

/// A door that closes 0.8 s after the program came to the line of its wait.
#[test]
fn an_input_may_follow_a_line_after_a_while() {
    let scenario = "[[event]]\nat = { line = 2 }\ninput = { number = 2, on = true, after_s = 0.8 }\n";
    let (seen, observation) = run(wait(Until::Rise, 1.0), false, &[], scenario);
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    let waits: Vec<_> = seen.iter().filter(|moment| moment.3 == MachineState::Waiting).collect();
    let closed = seen.iter().find(|moment| moment.2).unwrap().0;
    assert!((1590..1620).contains(&(closed - waits[0].0)), "after {} cycles", closed - waits[0].0);
}

#[test]
fn an_input_that_does_not_come_in_time_is_a_fault() {
    for (until, initial) in
        [(Until::High, false), (Until::Rise, true), (Until::Low, true), (Until::Fall, false)]
    {
        let (seen, observation) = run(wait(until, 0.5), initial, &[], "");
        assert_eq!(observation.outcome, Outcome::Faulted, "{until:?}");
        assert_eq!(observation.faults[0].code, Fault::InputTimedOut.code());
        let first = |state| seen.iter().find(|moment| moment.3 == state).unwrap().0;
        // Three ticks until the axes are there, the time of the program, and the tick that sees its end.
        let waited = first(MachineState::Fault) - first(MachineState::Waiting);
        assert!((1000..=1000 + 28).contains(&waited), "{until:?}: {waited} cycles");
        assert!((seen.last().unwrap().1 - 98.0).abs() < 0.01, "no axis goes on");
    }
}

/// Time does not count under a feed hold; a stop, an abort and an emergency stop end the wait; behind single
/// block cycle start is wanted.
#[test]
fn whatever_is_pressed_while_a_program_waits() {
    let at = 3000;
    let held = [(at, Request::FeedHold), (at + 4000, Request::CycleStart)];
    let (seen, observation) = run(wait(Until::High, 2.0), false, &held, &toggles(true, &[3.6]));
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    assert!(goes_on(&seen) > 7000);
    // It comes under the hold: the axes wait for cycle start all the same.
    let (seen, observation) = run(wait(Until::High, 2.0), false, &held, &toggles(true, &[2.0]));
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    assert!((at + 4000..at + 4100).contains(&goes_on(&seen)), "{}", goes_on(&seen));
    for (request, outcome) in [
        (Request::Stop, Outcome::Stopped),
        (Request::Abort, Outcome::Stopped),
        (Request::EmergencyStop, Outcome::Faulted),
    ] {
        let (seen, observation) = run(wait(Until::High, 5.0), false, &[(at, request)], "");
        assert_eq!(observation.outcome, outcome, "{request:?}");
        assert!(seen.last().unwrap().0 < at + 2000, "{request:?} does not end the wait");
    }
    // One press behind the move to 98, one behind the wait.
    let start = |time_s: f64| format!("[[event]]\nat = {{ time_s = {time_s} }}\ncycle_start = true\n");
    let scenario = [start(1.5), toggles(true, &[3.0]), start(4.5), start(9.0)].concat();
    let (seen, observation) =
        run(wait(Until::High, 5.0), false, &[(2, Request::SingleBlock(true))], &scenario);
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    assert!((9000..9060).contains(&goes_on(&seen)), "{}", goes_on(&seen));
}
