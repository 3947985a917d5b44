//! Machine code against the plant: how round the motors turn on arcs, what the operator does meanwhile,
//! pauses, coolant.
#![allow(clippy::unwrap_used)]

use machine::{Machine, SpindleConfig, ToolChange};
use protocol::{
    Arc, Code, Feed, Item, MachineState, MachineStatus, PathMode, PerAxis, Plane, Position, SpindleMode,
    SpindleSpeed, operator::Request,
};
use rig::observe::{Observation, Outcome, Record};

use crate::stand::{Stand, pressed};

fn point(x: f64, z: f64) -> PerAxis<Position> {
    let mut point = [Position(0); 8];
    (point[0], point[2]) = (Position::from_mm(x), Position::from_mm(z));
    point
}

fn line(x: f64, z: f64, feed: Feed) -> Code {
    Code::Line { target: point(x, z), feed }
}

fn arc(x: f64, z: f64, center: [f64; 2], turns: i32, feed: Feed) -> Code {
    let [x_center, z_center] = center.map(Position::from_mm);
    Code::Arc {
        arc: Arc { plane: Plane::Zx, target: point(x, z), center: [z_center, x_center], turns },
        feed,
    }
}

/// On the exact path; lines of the program count from 1.
fn items(codes: &[Code]) -> Vec<Item> {
    (0..)
        .zip([&Code::PathMode(PathMode::ExactPath)].into_iter().chain(codes))
        .map(|(line, code)| Item { line, code: *code })
        .collect()
}

fn run(codes: &[Code], requests: &[(u64, Request)], see: impl FnMut(&Record)) -> Observation {
    run_with("", codes, requests, see)
}

fn run_with(
    scenario: &str,
    codes: &[Code],
    requests: &[(u64, Request)],
    mut see: impl FnMut(&Record),
) -> Observation {
    let (machine, items) = (Machine::plain(), items(codes));
    Stand { machine: &machine, items: &items, scenario, seed: 5 }.run(|record| {
        see(record);
        pressed(requests, record)
    })
}

/// True positions of the motors of X and Z, mm.
fn motors(record: &Record) -> [f64; 2] {
    [record.truth.axes[0].motor_mm, record.truth.axes[2].motor_mm]
}

const FEED: Feed = Feed::PerMinute(600.0);

/// Turns of a circle of 10 mm about X 60, Z 50, in line 3; the ways to it and from it are tangential.
fn circle(turns: i32) -> [Code; 5] {
    let aside = 5.0 * f64::from(turns.signum());
    [
        line(50.0, 50.0 - aside, Feed::Rapid),
        line(50.0, 50.0, FEED),
        arc(50.0, 50.0, [60.0, 50.0], turns, FEED),
        line(50.0, 50.0 + aside, FEED),
        Code::End,
    ]
}

/// Largest distance of the motors from the circle, mm, and the sweep they make of it, rad.
fn roundness(requests: &[(u64, Request)], turns: i32) -> (f64, f64, Observation) {
    let (mut worst, mut swept, mut before) = (0.0_f64, 0.0, None);
    let seen = run(&circle(turns), requests, |record| {
        let arc = record.axes.iter().all(|(_, axis)| axis.line == 3);
        if !arc {
            return;
        }
        let [x, z] = motors(record);
        let (dx, dz) = (x - 60.0, z - 50.0);
        worst = worst.max((libm::hypot(dx, dz) - 10.0).abs());
        let angle = libm::atan2(dx, dz);
        let step = angle - before.replace(angle).unwrap_or(angle);
        swept += step - std::f64::consts::TAU * (step / std::f64::consts::TAU).round();
    });
    (worst, swept, seen)
}

#[test]
fn a_full_circle_is_round_to_a_micrometre() {
    for turns in [1, -1, 2] {
        let (worst, swept, seen) = roundness(&[], turns);
        assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
        assert_eq!((seen.moves.count, seen.moves.limit_violations), (4, 0));
        assert!(worst < 1e-3, "{} µm off the circle", worst * 1e3);
        // The line changes at a tick, and the path goes on meanwhile.
        assert!((swept - std::f64::consts::TAU * f64::from(turns)).abs() < 5e-3, "swept {swept}");
    }
}

#[test]
fn overrides_and_holds_leave_the_circle_round() {
    let (_, _, plain) = roundness(&[], 1);
    let requests = [
        (4000, Request::FeedOverride(150.0)),
        (5000, Request::FeedHold),
        (8000, Request::CycleStart),
        (9000, Request::FeedOverride(20.0)),
        (12_000, Request::FeedOverride(200.0)),
    ];
    let (worst, swept, seen) = roundness(&requests, 1);
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert_eq!((seen.moves.count, seen.moves.limit_violations), (4, 0));
    assert!(worst < 2e-3, "{} µm off the circle", worst * 1e3);
    assert!((swept - std::f64::consts::TAU).abs() < 0.02, "swept {swept}");
    assert!(seen.cycles.abs_diff(plain.cycles) > 200, "the operator changed nothing");
    let stop = [(5000, Request::Stop)];
    let (worst, swept, seen) = roundness(&stop, 1);
    assert_eq!(seen.outcome, Outcome::Stopped, "{:?}", seen.faults);
    assert!(worst < 1e-3 && (0.1..6.0).contains(&swept), "stopped after {swept} rad");
}

/// A shaft end as it is turned: face, corner radius, shoulder fillet, all of it by the revolution.
#[test]
fn arcs_by_the_revolution_follow_the_spindle() {
    let feed = Feed::PerRevolution(0.2);
    let codes = [
        Code::Spindle { mode: SpindleMode::Clockwise, speed: SpindleSpeed::Rpm(600.0) },
        line(10.0, 0.0, Feed::Rapid),
        line(18.0, 0.0, feed),
        arc(20.0, -2.0, [18.0, -2.0], 1, feed),
        line(20.0, -10.0, feed),
        arc(25.0, -15.0, [25.0, -10.0], -1, feed),
        Code::End,
    ];
    let (mut worst, mut fastest) = (0.0_f64, 0.0_f64);
    let seen = run(&codes, &[], |record| {
        if record.axes.iter().all(|(_, axis)| axis.line == 4) {
            let [x, z] = motors(record);
            worst = worst.max((libm::hypot(x - 18.0, z + 2.0) - 2.0).abs());
            let [vx, vz] = [record.axes[0].1.velocity_mm_s, record.axes[1].1.velocity_mm_s];
            fastest = fastest.max(libm::hypot(vx, vz));
        }
    });
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert_eq!((seen.moves.count, seen.moves.limit_violations), (5, 0));
    assert!(worst < 2e-3, "{} µm off the circle", worst * 1e3);
    assert!((fastest - 2.0).abs() < 0.05, "0.2 mm at 600 1/min are 2 mm/s, not {fastest}");
}

#[test]
fn arcs_that_cannot_be_are_faults_and_move_nothing() {
    let fault = |code: Code| {
        let mut end = [0.0; 2];
        let seen = run(&[line(50.0, 50.0, Feed::Rapid), code, Code::End], &[], |record| end = motors(record));
        assert_eq!(seen.outcome, Outcome::Faulted);
        assert!((end[0] - 50.0).abs() < 0.002 && (end[1] - 50.0).abs() < 0.002, "moved to {end:?}");
        seen.faults[0].code.clone()
    };
    assert_eq!(fault(arc(60.0, 61.0, [60.0, 50.0], 1, FEED)), "bad-machine-code", "radii 10 and 11");
    assert_eq!(fault(arc(50.0, 50.0, [90.0, 50.0], 1, FEED)), "travel-limit", "by way of X 130");
}

#[test]
fn a_pause_waits_for_cycle_start() {
    let codes = [line(50.0, 90.0, Feed::Rapid), Code::Pause, line(50.0, 80.0, FEED), Code::End];
    let pauses = |scenario: &str| {
        let mut moved = 0.0_f64;
        let seen = run_with(scenario, &codes, &[], |record| {
            if record.machine.state() == MachineState::Paused {
                moved = moved.max(record.axes.iter().map(|(_, axis)| axis.velocity_mm_s.abs()).sum());
            }
        });
        assert!(moved < 1.0, "the last setpoints of the move before are still on their way, nothing else");
        (seen.outcome, seen.moves.count, seen.pauses)
    };
    // Nobody will press it: it is pressed after a second.
    let (outcome, moves, alone) = pauses("");
    assert_eq!((outcome, moves, alone.len(), alone[0].line), (Outcome::Completed, 2, 1, 2));
    assert!((alone[0].waited_s - 1.0).abs() < 0.02, "{} s", alone[0].waited_s);
    // Somebody will: the program waits, however long.
    let start = |time_s: f64| format!("[[event]]\nat = {{ time_s = {time_s} }}\ncycle_start = true\n");
    let (outcome, _, attended) = pauses(&start(20.0));
    let started_s = (attended[0].cycle as f64) * 0.0005 + attended[0].waited_s;
    assert_eq!(outcome, Outcome::Completed);
    assert!((started_s - 20.0).abs() < 0.02, "went on at {started_s} s");
    // Pressed before, when nothing waited: that press is over.
    let (outcome, _, early) = pauses(&start(0.05));
    assert_eq!((outcome, early.len()), (Outcome::Completed, 1));
    assert!((early[0].waited_s - 1.0).abs() < 0.02, "{} s", early[0].waited_s);
    // By the line of the pause.
    let (_, _, by_line) = pauses("[[event]]\nat = { line = 2 }\ncycle_start = true\n");
    assert!(by_line[0].waited_s < 0.02, "{} s", by_line[0].waited_s);
    let (outcome, moves, _) = pauses("[[event]]\nat = { time_s = 5 }\nstop = true\n");
    assert_eq!((outcome, moves), (Outcome::Stopped, 1));
}

/// M1: the key decides in the tick in which the program comes to it, and not while it waits.
#[test]
fn an_optional_stop_waits_as_its_key_is_when_it_is_reached() {
    let codes = [line(50.0, 90.0, Feed::Rapid), Code::OptionalPause, line(50.0, 80.0, FEED), Code::End];
    let press =
        |cycle: u64, on: bool| format!("[[event]]\nat = {{ cycle = {cycle} }}\noptional_stop = {on}\n");
    let waits = |scenario: &str| {
        let seen = run_with(scenario, &codes, &[], |_| ());
        assert_eq!((seen.outcome, seen.moves.count), (Outcome::Completed, 2), "{scenario}");
        seen.pauses.first().map(|pause| pause.cycle)
    };
    let reached = waits("").expect("it is on at the beginning");
    assert_eq!(waits(&press(0, false)), None, "off");
    assert_eq!(waits(&(press(0, false) + &press(9, true))), Some(reached), "and on again");
    // Round the moment at which it is reached: it waits, or it does not, and does not change its mind.
    let last = |range: std::ops::Range<u64>| {
        let passed: Vec<bool> = range.map(|cycle| waits(&press(cycle, false)).is_none()).collect();
        assert!(passed.is_sorted_by(|before, after| before >= after), "{passed:?}");
        passed
    };
    let passed = last(reached - 12..reached + 12);
    assert!(passed[0] && !passed[23], "{passed:?}");
}

/// A tool that is put in by hand: axes and spindle stand as long as it is waited for, cycle start says that
/// it is in, and stop ends the program there. With a turret nothing waits.
#[test]
fn a_tool_that_is_put_in_by_hand_is_waited_for_at_rest() {
    let turns = |mode, rpm| Code::Spindle { mode, speed: SpindleSpeed::Rpm(rpm) };
    let stops = turns(SpindleMode::Stop, 0.0);
    let (before, behind) = (line(50.0, 90.0, FEED), line(50.0, 80.0, FEED));
    let tool = Code::Tool { number: 3 };
    let codes = [turns(SpindleMode::Clockwise, 300.0), before, stops, tool, behind, Code::End];
    let mut machine = Machine::plain();
    let run = |machine: &Machine, codes: &[Code], scenario: &str| {
        let (items, mut fastest, mut tools) = (items(codes), [0.0_f64; 2], Vec::new());
        let seen = Stand { machine, items: &items, scenario, seed: 5 }.run(|record| {
            tools.push((record.machine.tool, record.machine.state() == MachineState::ToolChange));
            if record.machine.state() == MachineState::ToolChange {
                let speed: f64 = record.axes.iter().map(|(_, axis)| axis.velocity_mm_s.abs()).sum();
                fastest = [fastest[0].max(speed), fastest[1].max(record.truth.spindle_rpm.abs())];
            }
            None
        });
        tools.dedup();
        (seen, fastest, tools)
    };
    let (seen, _, tools) = run(&machine, &codes, "");
    assert_eq!((seen.outcome, seen.pauses.len()), (Outcome::Completed, 0));
    assert_eq!(tools, [(0, false), (3, false)]);
    machine.general.tool_change = ToolChange::ByHand;
    // Nobody will say so: it is said after a second.
    let (seen, fastest, tools) = run(&machine, &codes, "");
    assert_eq!((seen.outcome, seen.moves.count), (Outcome::Completed, 2), "{:?}", seen.faults);
    assert_eq!(tools, [(0, false), (3, true), (3, false)]);
    assert!(seen.pauses.len() == 1 && (seen.pauses[0].waited_s - 1.0).abs() < 0.02, "{:?}", seen.pauses);
    assert!(fastest[0] == 0.0 && fastest[1] < SpindleConfig::STANDSTILL_RPM, "{fastest:?}");
    let at = |time_s: f64, what: &str| format!("[[event]]\nat = {{ time_s = {time_s} }}\n{what} = true\n");
    let (seen, ..) = run(&machine, &codes, &at(20.0, "cycle_start"));
    let ended_s = seen.pauses[0].cycle as f64 * 0.0005 + seen.pauses[0].waited_s;
    assert!(seen.outcome == Outcome::Completed && (ended_s - 20.0).abs() < 0.02, "{ended_s}");
    let (seen, ..) = run(&machine, &codes, &at(20.0, "stop"));
    assert_eq!((seen.outcome, seen.moves.count), (Outcome::Stopped, 1));
    // With a spindle that has never turned, and behind another pause, each asks for itself.
    let (seen, ..) = run(&machine, &[tool, Code::Pause, Code::Tool { number: 0 }, Code::End], "");
    assert_eq!((seen.outcome, seen.pauses.len()), (Outcome::Completed, 3), "{:?}", seen.faults);
    // From whoever leaves the spindle on nothing is changed.
    let (seen, ..) = run(&machine, &[codes[0], before, tool, behind, Code::End], "");
    assert_eq!((seen.outcome, seen.moves.count), (Outcome::Faulted, 1));
    assert_eq!(seen.faults[0].code, "bad-machine-code");
}

#[test]
fn each_of_two_pauses_waits() {
    let seen = run(&[Code::Pause, Code::Pause, Code::End], &[], |_| ());
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert_eq!(seen.pauses.iter().map(|pause| pause.line).collect::<Vec<_>>(), [1, 2]);
    assert!(seen.pauses.iter().all(|pause| (pause.waited_s - 1.0).abs() < 0.02), "{:?}", seen.pauses);
}

#[test]
fn coolant_is_seen_and_ends_with_the_program() {
    let codes = [
        Code::Coolant { mist: true, flood: false },
        Code::Dwell { seconds: 0.1 },
        Code::Coolant { mist: false, flood: true },
        Code::Dwell { seconds: 0.1 },
        Code::End,
    ];
    let mut seen = Vec::new();
    let observation = run(&codes, &[], |record| seen.push(record.machine.coolant));
    seen.dedup();
    assert_eq!(observation.outcome, Outcome::Completed);
    assert_eq!(seen, [0, MachineStatus::MIST, MachineStatus::FLOOD, 0]);
}

/// A spindle that was told to stop is at its speed once it stands: a feed behind M5 waits for that, and no
/// longer.
#[test]
fn a_feed_behind_m5_begins_once_the_spindle_stands() {
    let turns = |mode, rpm| Code::Spindle { mode, speed: SpindleSpeed::Rpm(rpm) };
    let codes = [
        turns(SpindleMode::Clockwise, 600.0),
        line(50.0, 98.0, FEED),
        turns(SpindleMode::Stop, 0.0),
        line(50.0, 96.0, FEED),
        Code::End,
    ];
    let mut behind = None;
    let observation = run(&codes, &[], |record| {
        if behind.is_none() && motors(record)[1] < 97.99 {
            behind = Some((record.truth.cycle.0, record.truth.spindle_rpm));
        }
    });
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    let (cycle, rpm) = behind.unwrap();
    // At speed after 0.75 s, at Z 98 after a few tenths more, at rest 0.75 s later.
    assert!(rpm.abs() < 2.0 && cycle < 8000, "at {rpm} 1/min in cycle {cycle}");
}

/// Measured it stands beside it, by a count or because it sagged when its brake let go.
#[test]
fn an_axis_whose_home_is_the_end_of_its_travel_comes_away() {
    let items = items(&[line(50.0, 50.0, FEED), line(50.0, 40.0, Feed::Rapid), Code::End]);
    for ends in [0, 1] {
        let mut machine = Machine::default();
        machine.axis.values_mut().for_each(|axis| axis.home_mm = axis.travel_mm[ends]);
        for seed in 1..=4 {
            let seen = Stand { machine: &machine, items: &items, scenario: "", seed }.run(|_| None);
            assert_eq!(seen.outcome, Outcome::Completed, "end {ends}, seed {seed}: {:?}", seen.faults);
            assert_eq!((seen.moves.count, seen.moves.limit_violations), (2, 0));
        }
    }
}
