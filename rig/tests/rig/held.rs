//! Awkward moments: the spindle held at 0, a spindle that stalls, a hold between arming and the index.
#![allow(clippy::unwrap_used)]

use machine::{Machine, Reaction};
use protocol::{AxisState, MachineState, operator::Request};
use rig::observe::{Observation, Outcome, PauseEnd, Record};

use crate::stand::{Stand, compiled};

/// Runs a program; `operator` sees every cycle and says what is done at the panel in the next one.
fn run(program: &str, scenario: &str, operator: impl FnMut(&Record) -> Option<Request>) -> Observation {
    let machine = Machine::plain();
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

/// Passes that are long enough to be left, and to lose the index in.
const DEEP: &str = "G18 G21 G90 G8 G94 G97\nM3 S600\nG0 X12 Z8\nG76 P2 Z-10 I-1 J0.4 K0.8\nG0 X20\nM5\nM2\n";

/// A hold that leaves a pass makes one pause, from where it waits; what ends the waiting is named.
#[test]
fn what_ends_the_pause_behind_a_pass_that_was_left_is_told() {
    let mut machine = Machine::plain();
    machine.threading.on_hold = Reaction::Leave;
    let items = compiled(&machine, DEEP);
    for (action, ended_by, outcome) in [
        ("cycle_start", PauseEnd::CycleStart, Outcome::Completed),
        ("stop", PauseEnd::Stop, Outcome::Stopped),
        ("abort", PauseEnd::Abort, Outcome::Stopped),
        ("emergency_stop", PauseEnd::EmergencyStop, Outcome::Faulted),
        ("power_lost", PauseEnd::PowerLost, Outcome::Faulted),
    ] {
        let scenario = format!(
            "[[event]]\nat = {{ pass = 2, angle_deg = 1500 }}\nfeed_hold = true\n\
             [[event]]\nat = {{ time_s = 20 }}\n{action} = true\n"
        );
        let seen = Stand { machine: &machine, items: &items, scenario: &scenario, seed: 1 }.run(|_| None);
        assert_eq!(seen.outcome, outcome, "{action}: {:?}", seen.faults);
        let [pause] = seen.pauses[..] else { panic!("{action}: {:?}", seen.pauses) };
        let ended_s = pause.cycle as f64 * seen.cycle_s + pause.waited_s;
        assert!(pause.ended_by == ended_by && (ended_s - 20.0).abs() < 0.02, "{action}: {pause:?}");
        let attempts: Vec<_> = seen.passes.iter().filter(|pass| pass.pass == 2).collect();
        assert_eq!(attempts.len(), if ended_by == PauseEnd::CycleStart { 2 } else { 1 });
        assert!(!attempts[0].complete && attempts.iter().skip(1).all(|pass| pass.complete), "{action}");
    }
}

/// Whoever comes to its end first waits with the fault until the others are there.
#[test]
fn a_pass_that_is_finished_without_an_index_is_finished_by_every_axis() {
    let mut machine = Machine::plain();
    machine.threading.on_fault = Reaction::Finish;
    let items = compiled(&machine, DEEP);
    let run = |scenario: &str| Stand { machine: &machine, items: &items, scenario, seed: 1 }.run(|_| None);
    let whole = run("");
    let lost = run("[[event]]\nat = { pass = 2, angle_deg = 1500 }\nindex_lost = { for_s = 2 }\n");
    assert_eq!(lost.outcome, Outcome::Faulted);
    assert!(lost.faults.iter().all(|fault| fault.code == "encoder-index-missing"), "{:?}", lost.faults);
    let [.., last] = &lost.passes[..] else { panic!("no pass was cut") };
    assert!(last.pass == 2 && last.complete, "{last:?}");
    assert_eq!(last.end_cycle, whole.passes[1].end_cycle);
}

#[test]
fn an_event_whose_moment_never_came_is_a_warning() {
    let scenario = "[[event]]\nat = { pass = 7, angle_deg = 10 }\nstop = true\n\
                    [[event]]\nat = { cycle = 1 }\nfeed_override_pct = 90\n\
                    [[event]]\nat = { time_s = 900 }\nstop = true\n";
    let seen = run("G0 X20 Z50\nM2\n", scenario, |_| None);
    let told: Vec<_> = seen.warnings.iter().map(|warning| warning.text.split(" of").next()).collect();
    assert_eq!(told, [Some("event 1"), Some("event 3")]);
    assert!(seen.outcome == Outcome::Completed && seen.warnings[0].code == "event-never-came");
}
