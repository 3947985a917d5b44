//! Awkward moments: the spindle held at 0, a spindle that stalls, a hold between arming and the index.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::{AxisState, MachineState, operator::Request};
use rig::observe::{Observation, Outcome, Record};

use crate::stand::{Stand, compiled};

/// Runs a program; `operator` sees every cycle and says what is done at the panel in the next one.
fn run(program: &str, scenario: &str, operator: impl FnMut(&Record) -> Option<Request>) -> Observation {
    let machine = Machine::default();
    let items = compiled(&machine, &format!("G18 G21 G90 G8 G94 G97\n{program}"));
    Stand { machine: &machine, items: &items, scenario, seed: 3 }.run(operator)
}

#[test]
fn nothing_feeds_while_the_override_holds_the_spindle_at_zero() {
    let program = "G0 X20 Z50\nM3 S600\nG1 Z40 F300\nM5\nM2\n";
    let scenario = "[[event]]\nat = { cycle = 1 }\nspindle_override_pct = 0\n\
                    [[event]]\nat = { time_s = 40 }\nspindle_override_pct = 100\n";
    let mut fed_standing = false;
    let seen = run(program, scenario, |record| {
        let feeding = record.machine.line == 4 && record.machine.state() == MachineState::Moving;
        fed_standing |= feeding && record.truth.spindle_rpm.abs() < 500.0;
        None
    });
    assert!(!fed_standing, "fed into a part that stands");
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert!(seen.cycles > 80_000, "waited for the operator, without a fault");
}

/// Two passes.
const THREAD: &str = "M3 S20\nG0 X22 Z8\nG76 P2 Z0 I-1 J0.299 K0.3\nG0 X40\nM5\nM2\n";

#[test]
fn a_spindle_that_stalls_in_a_pass_is_a_fault() {
    let scenario = "[[event]]\nat = { pass = 1, angle_deg = 700 }\nspindle_load = { torque_nm = 90000 }\n";
    let seen = run(THREAD, scenario, |_| None);
    assert_eq!(seen.outcome, Outcome::Faulted);
    assert_eq!(seen.faults[0].code, "spindle-not-at-speed");
}

#[test]
fn a_hold_before_the_index_takes_the_pass_back_and_resume_cuts_it() {
    let armed = |record: &Record| record.axes.iter().all(|(_, axis)| axis.state() == AxisState::Armed);
    let (mut armed_for, mut held_for, mut moved) = (0, 0, 0.0_f64);
    let seen = run(THREAD, "", |record| {
        armed_for = if armed(record) { armed_for + 1 } else { 0 };
        if held_for > 0 {
            held_for += 1;
            moved = moved.max((record.truth.axes[0].motor_mm - 22.0).abs());
            // Well over one turn of 3 s.
            return (held_for == 8000).then(|| {
                held_for = i32::MIN;
                Request::CycleStart
            });
        }
        (held_for == 0 && armed_for == 30).then(|| {
            held_for = 1;
            Request::FeedHold
        })
    });
    assert!(moved < 0.002, "X moved {moved} mm during the hold");
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert_eq!(seen.passes.len(), 2, "the pass that was held is cut once, after the hold");
    assert!(seen.passes.iter().all(|pass| pass.complete && pass.phase_um.abs() < 1.0));
}
