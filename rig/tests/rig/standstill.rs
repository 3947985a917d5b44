//! Machines that wait at their panel: those for whom nobody will come are found, others are not.

use machine::Machine;
use protocol::{Fault, operator::Request};
use rig::{
    Rig,
    standstill::{Standstill, WAIT_S},
};
use sim_plant::Scenario;

use crate::stand::compiled;

const PROGRAM: &str = "G18 G21 G90 G8 G94 G97\nM3 S600\nG0 X12 Z8\nG0 X9.5\nG33 Z-32 K1.5\nG0 X12\nG1 Z20 F300\n\
                       G0 Z10\nM5\nM2\n";

/// Runs the program, stopped as soon as it is found to wait for nobody. When that was, s, and when it ended.
fn run(scenario: &str) -> (Option<f64>, f64) {
    let machine = Machine::plain();
    let items = compiled(&machine, PROGRAM);
    let scenario = Scenario::from_toml(scenario).expect("a sound scenario");
    let mut standstill = Standstill::new(&machine, &scenario);
    let mut rig = Rig::new(&machine, items.into_iter(), scenario, 3).expect("a sound machine");
    let (mut found, mut request, mut cycle) = (None, None, 0u64);
    let s = |cycle: u64| cycle as f64 * machine.general.cycle_s;
    while cycle < 1_000_000 {
        let goes_on = rig.cycle(request.take(), |record| {
            assert!(Fault::from_code(record.machine.fault).is_none(), "{:?}", record.machine);
            if standstill.cycle(record).is_some() {
                found = found.or(Some(s(cycle)));
                request = Some(Request::Stop);
            }
        });
        if !goes_on {
            return (found, s(cycle));
        }
        cycle += 1;
    }
    panic!("the program does not end");
}

fn event(at: &str, action: &str) -> String {
    format!("[[event]]\nat = {{ {at} }}\n{action}\n")
}

/// Where it is held, what holds, and what would let it go on.
const HELD: [(&str, &str, &str); 5] = [
    ("pass = 1, angle_deg = 1500", "feed_hold = true", "cycle_start = true"),
    ("pass = 1, angle_deg = 1500", "spindle_override_pct = 0", "spindle_override_pct = 100"),
    ("line = 7", "feed_hold = true", "cycle_start = true"),
    ("line = 7", "feed_override_pct = 0", "feed_override_pct = 100"),
    ("line = 8", "rapid_override_pct = 0", "rapid_override_pct = 100"),
];

#[test]
fn who_waits_for_what_has_been_is_found() {
    for (at, holds, releases) in HELD {
        let (found, end) = run(&(event(at, holds) + &event("time_s = 0.1", releases)));
        println!("{at} {holds}: found at {found:?} s, ended at {end} s");
        let found = found.unwrap_or_else(|| panic!("{at} {holds}: not found"));
        assert!((WAIT_S..WAIT_S + 15.0).contains(&found), "{at} {holds}: {found}");
        assert!(end < found + 10.0, "{at} {holds}: goes on until {end} s");
    }
}

#[test]
fn who_waits_for_what_comes_is_left_alone() {
    for (at, holds, releases) in HELD {
        let (found, end) = run(&(event(at, holds) + &event("time_s = 150", releases)));
        assert_eq!(found, None, "{at} {holds}");
        assert!(end > 150.0, "{at} {holds}: {end}");
    }
    // A program that takes its time at an override of 3 % waits for nobody.
    let (found, end) = run(&event("line = 7", "feed_override_pct = 3"));
    assert_eq!(found, None);
    assert!(end > 2.0 * WAIT_S, "{end}");
}
