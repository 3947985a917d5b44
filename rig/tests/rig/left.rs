//! Threads that are left because something is wrong, and what the machine says of it: the cause, within the
//! time that the table of faults promises; the tool is out, the axes rest, and the run ends.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::{Axis, AxisState, Fault, operator::Request};
use rig::observe::{Observation, Outcome, Record, TOOL_IN_THREAD};

use crate::stand::{Stand, compiled};

/// A thread of 40 mm at 600 1/min: 26 turns.
const THREAD: &str = "M3 S600\nG0 X12 Z8\nG0 X9.5\nG33 Z-32 K1.5\nG0 X12\nG0 Z10\nM5\nM2\n";

/// What became of a run.
struct Left {
    seen: Observation,
    /// The first fault that the machine told, and in which cycle.
    told: Option<(Fault, u64)>,
    /// Cycles from the event to the first axis that leaves.
    leaves: Option<u64>,
    /// X at the end, mm; how fast the axes and the spindle still are then, mm/s and 1/min.
    x_mm: f64,
    mm_s: f64,
    rpm: f64,
}

/// Where in pass 1 it happens, degrees since its index.
const AT_DEG: f64 = 3600.0;

fn run(machine: &Machine, program: &str, event: &str) -> Left {
    let items = compiled(machine, &format!("G18 G21 G90 G8 G94 G97\n{program}"));
    let scenario = format!("[[event]]\nat = {{ pass = 1, angle_deg = {AT_DEG} }}\n{event}\n");
    let (mut happened, mut told, mut leaves) = (None, None, None);
    let (mut x_mm, mut mm_s, mut rpm) = (0.0, 0.0, 0.0);
    let mut before = [0.0; protocol::units::AXES];
    let watch = |record: &Record| {
        let cycle = record.truth.cycle.0;
        let at = record.axes.iter().any(|(_, status)| status.angle_deg >= AT_DEG);
        happened = happened.or(at.then_some(cycle));
        let since = |happened: Option<u64>| cycle - happened.unwrap_or(cycle);
        if told.is_none() {
            told = Fault::from_code(record.machine.fault).map(|fault| (fault, since(happened)));
        }
        if record.axes.iter().any(|(_, status)| status.state() == AxisState::Leaving) {
            leaves = leaves.or(Some(since(happened)));
        }
        let motors = record.truth.axes.map(|axis| axis.motor_mm);
        mm_s = motors
            .iter()
            .zip(&before)
            .map(|(now, before): (&f64, &f64)| (now - before).abs())
            .fold(0.0, f64::max)
            / machine.general.cycle_s;
        before = motors;
        (x_mm, rpm) = (motors[Axis::X.index()], record.truth.spindle_rpm);
        None::<Request>
    };
    let seen = Stand { machine, items: &items, scenario: &scenario, seed: 5 }.run(watch);
    Left { seen, told, leaves, x_mm, mm_s, rpm }
}

/// What happens in the thread, the fault that the machine names, and cycles within which it does.
const CAUSES: &[(&str, Fault, u64)] = &[
    ("emergency_stop = true", Fault::EmergencyStop, 10),
    ("power_lost = true", Fault::PowerLost, 10),
    ("drive_fault = \"z\"", Fault::DriveFault, 12),
    ("kill = \"regulator-z\"", Fault::RegulatorSilent, 16),
    ("freeze = \"regulator-z\"", Fault::RegulatorSilent, 16),
    ("packet = { channel = \"axis-status/z\", count = 100000, drop = true }", Fault::RegulatorSilent, 12),
    ("spindle_fault = \"runaway\"", Fault::SpindleRunaway, 2000),
    ("spindle_fault = \"reversal\"", Fault::SpindleReversed, 4000),
    ("spindle_fault = \"jam\"", Fault::EncoderStands, 50),
    ("encoder_stands = true", Fault::EncoderStands, 200),
    ("axis_jump = { axis = \"z\", mm = 0.045 }", Fault::AxisJump, 10),
];

#[test]
fn the_cause_is_told_the_tool_is_out_and_the_run_ends() {
    for (event, fault, within) in CAUSES {
        let left = run(&Machine::plain(), THREAD, event);
        let told = left.told.unwrap_or_else(|| panic!("{event}: nothing is told"));
        println!(
            "{event}: {:?} after {} cycles, leaves {:?}, {:.0} 1/min",
            told.0, told.1, left.leaves, left.rpm
        );
        assert_eq!(left.seen.outcome, Outcome::Faulted, "{event}");
        assert_eq!(told.0, *fault, "{event}: {:?}", left.seen.faults);
        assert!(told.1 <= *within, "{event}: told after {} cycles", told.1);
        assert!(left.x_mm > 11.9, "{event}: X stands at {} mm", left.x_mm);
        assert_eq!(tool_in_thread(&left.seen), None, "{event}");
        assert!(left.mm_s < 0.1, "{event}: an axis moves at {} mm/s", left.mm_s);
        // Whatever it obeys: its command, or the emergency stop.
        assert!(left.rpm.abs() < 5.0, "{event}: {} 1/min", left.rpm);
    }
}

/// The warning of a tool that has not left its thread.
fn tool_in_thread(seen: &Observation) -> Option<&str> {
    let warning = seen.warnings.iter().find(|warning| warning.code == TOOL_IN_THREAD);
    warning.map(|warning| warning.text.as_str())
}

/// What takes the torque of the axis that lifts the tool off.
const LAMED: &[&str] = &[
    "drive_fault = \"x\"",
    "drive_fault = { axis = \"x\", torque_lost = true }",
    "kill = \"regulator-x\"",
    "packet = { channel = \"drive-command/x\", count = 20, drop = true }",
    "packet = { channel = \"measurement\", count = 20, drop = true }",
];

#[test]
fn a_tool_that_cannot_leave_is_told_with_its_place_and_the_way_out() {
    for event in LAMED {
        let left = run(&Machine::plain(), THREAD, event);
        assert!((left.x_mm - 9.5).abs() < 0.1, "{event}: X stands at {} mm", left.x_mm);
        let text = tool_in_thread(&left.seen).unwrap_or_else(|| panic!("{event}: {:?}", left.seen.warnings));
        for told in ["in the thread of pass 1", "at X 9.50", "move X by hand to 12.000"] {
            assert!(text.contains(told), "{event}: {text}");
        }
    }
}

/// What comes second is not the cause: commands that stay out behind a fault of the drive, a drive that fails
/// while they stay out. And fewer than trip a drive leave the thread.
#[test]
fn a_drive_that_fails_and_one_without_commands_are_told_apart() {
    let lost =
        |count: u32| format!("packet = {{ channel = \"drive-command/x\", count = {count}, drop = true }}");
    let then = |first: &str, second: &str| {
        format!("{first}\n[[event]]\nat = {{ pass = 1, angle_deg = {} }}\n{second}", AT_DEG + 18.0)
    };
    let fails = "drive_fault = \"x\"";
    for (event, fault, leaves) in [
        (then(fails, &lost(30)), Fault::DriveFault, false),
        (then(&lost(30), fails), Fault::LateAnswers, false),
        (lost(20), Fault::LateAnswers, false),
        (lost(11), Fault::LateAnswers, true),
        (lost(3), Fault::LateAnswers, true),
    ] {
        let left = run(&Machine::plain(), THREAD, &event);
        let own = left.seen.faults.iter().find(|fault| fault.source == "regulator-x");
        assert_eq!(own.map(|own| own.code.as_str()), Some(fault.code()), "{event}: {:?}", left.seen.faults);
        assert_eq!(left.told.map(|told| told.0), Some(fault), "{event}");
        assert_eq!((left.x_mm > 11.9, tool_in_thread(&left.seen).is_none()), (leaves, leaves), "{event}");
    }
}

/// After a hold X goes back to the start of the pass, which lies as deep as the thread, and in front of it.
#[test]
fn a_tool_that_was_out_and_is_back_at_the_start_is_not_told() {
    let later = |time_s: u32, action: &str| format!("[[event]]\nat = {{ time_s = {time_s} }}\n{action}\n");
    let hold = [
        "feed_hold = true\n".into(),
        later(15, "spindle_override_pct = 0"),
        later(20, "cycle_start = true"),
        later(25, "stop = true"),
    ];
    let left = run(&Machine::plain(), &format!("(on_hold, leave)\n{THREAD}"), &hold.concat());
    assert_eq!((left.seen.outcome, left.seen.passes.len()), (Outcome::Stopped, 1));
    assert!((left.x_mm - 9.5).abs() < 0.01, "X stands at {} mm", left.x_mm);
    assert_eq!(tool_in_thread(&left.seen), None);
}

/// The regulators are all well, and one of them is not heard; or the interpolator hears none, since it was
/// held up.
#[test]
fn who_is_silent_is_named() {
    let lost =
        |axis: &str| format!("packet = {{ channel = \"axis-status/{axis}\", count = 8, drop = true }}");
    let held_up = "freeze = { process = \"interpolator\", for_s = 0.5 }";
    for (event, code, named) in [
        (lost("x"), Fault::RegulatorSilent.code(), "(regulator-x)"),
        (lost("z"), Fault::RegulatorSilent.code(), "(regulator-z)"),
        (held_up.into(), Fault::InterpolatorSilent.code(), "the interpolator"),
    ] {
        let left = run(&Machine::plain(), THREAD, &event);
        let [fault] = &left.seen.faults[..] else { panic!("{event}: {:?}", left.seen.faults) };
        assert_eq!((fault.source.as_str(), fault.code.as_str()), ("interpolator", code), "{event}");
        assert!(fault.text.contains(named), "{event}: {}", fault.text);
    }
}

/// A drive without torque, at a speed from which the spindle coasts for long.
#[test]
fn a_spindle_that_coasts_is_waited_for_and_has_not_run_away() {
    let fast = THREAD.replace("S600", "S2500").replace("K1.5", "K0.5");
    for (event, fault) in
        [("power_lost = true", Fault::PowerLost), ("spindle_fault = \"stall\"", Fault::SpindleDoesNotStop)]
    {
        let left = run(&Machine::plain(), &fast, event);
        let told = |code: &str| left.seen.faults.iter().any(|fault| fault.code == code);
        println!("{event}: {:?}, {:.0} 1/min after {} cycles", left.seen.faults, left.rpm, left.seen.cycles);
        assert!(!told(Fault::SpindleRunaway.code()), "{event}: {:?}", left.seen.faults);
        assert!(told(fault.code()) || fault == Fault::SpindleDoesNotStop, "{event}: {:?}", left.seen.faults);
        assert!(left.rpm.abs() < 5.0, "{event}: {} 1/min", left.rpm);
    }
}

/// It gives all its torque: the emergency stop takes it, and the spindle coasts from far above its speed.
#[test]
fn a_spindle_that_ran_away_is_waited_for_after_the_emergency_stop() {
    let slow = THREAD.replace("S600", "S264");
    let left = run(&Machine::plain(), &slow, "spindle_fault = \"runaway\"");
    println!("{:?}, {:.0} 1/min after {} cycles", left.seen.faults, left.rpm, left.seen.cycles);
    assert_eq!(left.told.map(|(fault, _)| fault), Some(Fault::SpindleRunaway));
    assert!(left.seen.faults.iter().all(|fault| fault.code == "spindle-runaway"), "{:?}", left.seen.faults);
    assert!(left.rpm.abs() < 5.0, "{} 1/min", left.rpm);
}

/// A drive that is not commanded asks for a way out: the gap is told first, the drive as what came of it.
#[test]
fn measurements_that_are_lost_are_told_before_the_drives_that_do_without_commands_for_them() {
    let left =
        run(&Machine::plain(), THREAD, "packet = { channel = \"measurement\", count = 4, drop = true }");
    let codes: Vec<&str> = left.seen.faults.iter().map(|fault| fault.code.as_str()).collect();
    assert_eq!(codes.first(), Some(&Fault::MeasurementGap.code()), "{codes:?}");
}

/// A regulator has found out that the encoder is dead, then the button is pressed: nobody sees it rest.
#[test]
fn a_spindle_without_an_encoder_is_waited_for_after_an_emergency_stop_too() {
    let fast = THREAD.replace("S600", "S2300").replace("K1.5", "K0.4");
    for later in [30.0, 90.0, 300.0] {
        let at = AT_DEG + later;
        let event = format!("encoder_stands = true\n[[event]]\nat = {{ pass = 1, angle_deg = {AT_DEG} }}");
        let stop = event.replace(&AT_DEG.to_string(), &at.to_string());
        let left = run(&Machine::plain(), &fast, &format!("{stop}\nemergency_stop = true"));
        assert!(left.rpm.abs() < 5.0, "{later}°: {} 1/min, {:?}", left.rpm, left.seen.faults);
    }
}

/// Nobody above tells the regulators; the tool must not go back to depth by the angle, where Z stands.
#[test]
fn a_spindle_that_turns_back_is_left_without_an_interpolator_too() {
    for degrees in (3700..8900).step_by(300) {
        let both = format!(
            "freeze = {{ process = \"interpolator\", for_s = 3.0 }}\n[[event]]\nat = {{ pass = 1, angle_deg = {degrees} }}\nspindle_fault = \"reversal\""
        );
        let left = run(&Machine::plain(), THREAD, &both);
        let codes: Vec<&str> = left.seen.faults.iter().map(|fault| fault.code.as_str()).collect();
        assert!(codes.contains(&Fault::SpindleReversed.code()), "{degrees}: {codes:?}");
        let asleep = (3.0 / Machine::plain().general.cycle_s) as u64;
        assert!(left.leaves.is_some_and(|cycles| cycles < asleep), "{degrees}: left after {:?}", left.leaves);
        assert!(left.x_mm > 11.9, "{degrees}: X stands at {} mm", left.x_mm);
    }
}

/// Behind a fault of its encoder, or in front of one, the spindle runs away: whether that is seen by counts
/// that nobody believes any more, or by nobody, it is braked as soon as the tool is out.
#[test]
fn a_spindle_that_runs_away_beside_a_fault_of_its_encoder_is_braked() {
    let encoder = [
        "index_lost = { for_s = 0.5 }",
        "encoder_glitch_counts = 60",
        "encoder_glitch_counts = -30",
        "encoder_stands = true",
    ];
    for fault in encoder {
        for later_deg in [0.0, 40.0, 400.0, 1500.0] {
            for [first, second] in [[fault, RUNAWAY], [RUNAWAY, fault]] {
                let at = AT_DEG + later_deg;
                let both = format!("{first}\n[[event]]\nat = {{ pass = 1, angle_deg = {at} }}\n{second}\n");
                let left = run(&Machine::plain(), THREAD, &both);
                let what = format!("{first}, {second} {later_deg}° later: {:?}", left.seen.faults);
                assert_eq!(left.seen.outcome, Outcome::Faulted, "{what}");
                // Without torque it coasts, and nobody sees for how long.
                let most_rpm = if fault.starts_with("encoder_stands") { 200.0 } else { 5.0 };
                assert!(left.rpm.abs() < most_rpm, "{:.0} 1/min, {what}", left.rpm);
                assert!(left.x_mm > 11.9, "X stands at {} mm, {what}", left.x_mm);
            }
        }
    }
}

const RUNAWAY: &str = "spindle_fault = \"runaway\"";

/// Nothing lifts the tool out of a thread without a retract that is cut to its end.
#[test]
fn a_tool_that_waits_in_a_groove_is_told_unless_the_program_is_done() {
    let waits = "M3 S600\nG0 X12 Z8\nG0 X9.5\nG33 Z-32 K1.5\nG4 P2\nM5\nM2\n";
    let later =
        |action: &str| format!("spindle_override_pct = 100\n[[event]]\nat = {{ time_s = 6 }}\n{action}");
    for (event, outcome, told) in [
        ("stop = true", Outcome::Stopped, true),
        ("drive_fault = \"x\"", Outcome::Faulted, true),
        ("feed_override_pct = 90", Outcome::Completed, false),
    ] {
        let left = run(&Machine::plain(), waits, &later(event));
        assert_eq!(left.seen.outcome, outcome, "{event}: {:?}", left.seen.faults);
        assert!((left.x_mm - 9.5).abs() < 0.1, "{event}: X stands at {} mm", left.x_mm);
        assert!(left.seen.passes.iter().all(|pass| pass.complete), "{event}");
        assert_eq!(tool_in_thread(&left.seen).is_some(), told, "{event}");
    }
}

/// X looks first, and sees that the drive of Z has failed; Z tells the drive in the same cycle.
#[test]
fn of_one_cycle_the_cause_is_told_first() {
    let left = run(&Machine::plain(), THREAD, "drive_fault = \"z\"");
    let codes: Vec<&str> = left.seen.faults.iter().map(|fault| fault.code.as_str()).collect();
    assert_eq!(codes[..2], ["drive-fault", "other-axis"]);
}
