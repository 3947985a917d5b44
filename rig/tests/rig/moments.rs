//! One event at every moment of a pass, seen from outside: where the axes are in truth, what is commanded.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::{Axis, AxisState, AxisStatus, PerAxis};
use rig::observe::{Observation, Outcome, Record};

use crate::stand::{Stand, compiled};

/// One cycle of a run.
struct Moment {
    /// What X and Z say.
    x: AxisStatus,
    z: AxisStatus,
    /// Where the motors are in truth, mm.
    true_mm: PerAxis<f64>,
    /// The spindle in truth, 1/min.
    rpm: f64,
}

/// Runs a program, with an event in a cycle if there is one.
fn run(machine: &Machine, program: &str, event: Option<(usize, &str)>) -> (Vec<Moment>, Observation) {
    let items = compiled(machine, &format!("G18 G21 G90 G8 G94 G97\n{program}\nM5\nM2\n"));
    let scenario =
        event.map_or(String::new(), |(at, event)| format!("[[event]]\nat = {{ cycle = {at} }}\n{event}\n"));
    let mut moments = Vec::new();
    let watch = |record: &Record| {
        let of = |axis: Axis| record.axes.iter().find(|(other, _)| *other == axis).unwrap().1;
        let (x, z) = (of(Axis::X), of(Axis::Z));
        let true_mm = record.truth.axes.map(|axis| axis.motor_mm);
        moments.push(Moment { x, z, true_mm, rpm: record.truth.spindle_rpm });
        None
    };
    let seen = Stand { machine, items: &items, scenario: &scenario, seed: 3 }.run(watch);
    (moments, seen)
}

/// The cycles in which an axis is in a state, with some before and behind.
fn cycles(moments: &[Moment], margin: usize, is: impl Fn(&Moment) -> bool) -> std::ops::Range<usize> {
    let first = moments.iter().position(&is).unwrap();
    let last = moments.iter().rposition(&is).unwrap();
    first.saturating_sub(margin)..(last + margin).min(moments.len() - 1)
}

/// Cycles around the first approach and the first retract of X.
fn strokes(moments: &[Moment]) -> impl Iterator<Item = usize> {
    let first = |state| moments.iter().position(|moment| moment.x.state() == state).unwrap();
    let [approach, retract] = [AxisState::RunIn, AxisState::RunOut].map(first);
    (approach - 40..approach + 220).step_by(12).chain((retract - 40..retract + 220).step_by(12))
}

/// The drive of an axis that is let go brakes from the speed that its encoder shows.
#[test]
fn an_encoder_that_jumps_near_a_pass_throws_no_axis() {
    let machine = Machine::plain();
    let program = "M3 S600\nG0 X10.5 Z8\nG76 P2 Z-6 I-0.5 J0.3 K0.6 R1";
    let (calm, _) = run(&machine, program, None);
    let waits = |moment: &Moment| moment.x.state() == AxisState::WaitingForC0;
    let ends = cycles(&calm, 20, |moment| moment.x.state() == AxisState::RunOut).end;
    let index = calm.iter().position(waits).unwrap();
    for at in (index - 12..index + 40).step_by(3).chain((ends - 45..ends + 30).step_by(3)) {
        for (axis, mm) in [("x", -0.045), ("x", -0.14), ("z", -0.14), ("z", 0.1)] {
            let event = format!("axis_jump = {{ axis = \"{axis}\", mm = {mm} }}");
            let (moments, seen) = run(&machine, program, Some((at, &event)));
            let index = if axis == "x" { Axis::X } else { Axis::Z }.index();
            // Within the drive line and the end of the thread, by no more than what the servo makes of it.
            let low = [9.9, f64::NAN, -6.0][index] - 0.05;
            let high = [10.5, f64::NAN, 8.0][index] + 0.2;
            let [least, most] = bounds(moments[at..].iter().map(|moment| moment.true_mm[index]));
            assert!(least > low && most < high, "{event} in cycle {at}: from {least} to {most} mm");
            assert_eq!(seen.outcome, Outcome::Faulted, "{event} in cycle {at}");
        }
    }
}

fn bounds(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], mm| [low.min(mm), high.max(mm)])
}

/// Undoing the deceleration of a law that stops dead, within the limit of the jerk, would take X back by
/// millimetres.
#[test]
fn a_spindle_that_jams_does_not_lead_the_tool_back_into_the_part() {
    let machine = Machine::plain();
    for program in [
        "M3 S800\nG0 X12 Z5\nG0 X9.5\nG33 Z-5 K1.5\nG0 X12",
        "M3 S400\nG0 X12 Z5\nG0 X9.5\nG33 Z-5 K3\nG0 X11",
    ] {
        let (calm, _) = run(&machine, program, None);
        let retract = cycles(&calm, 4, |moment| moment.x.state() == AxisState::RunOut);
        for at in retract.step_by(5) {
            let event = "spindle_fault = { fault = \"jam\", for_s = 1 }";
            let (moments, _) = run(&machine, program, Some((at, event)));
            let mut highest = f64::NEG_INFINITY;
            for moment in &moments[at..] {
                highest = highest.max(moment.x.commanded_mm);
                let back = highest - moment.x.commanded_mm;
                // Where it is clear it may turn round.
                assert!(back < 0.05 || highest > 10.9, "jam in cycle {at}: {back} mm back from {highest} mm");
            }
            assert!(moments.last().unwrap().true_mm[0] > 10.9, "jam in cycle {at}: the tool is not out");
        }
    }
}

/// 110 mm/s are 55 µm in a cycle, more than the error that a thread may have.
#[test]
fn a_fast_thread_goes_on_when_a_measurement_is_missing() {
    let machine = Machine::plain();
    let program = "M3 S1100\nG0 X11 Z40\nG0 X9.7\nG33 Z-30 K6\nG0 X11";
    let (calm, _) = run(&machine, program, None);
    let thread = cycles(&calm, 3, |moment| moment.z.state() == AxisState::Locked);
    for at in thread.step_by(37) {
        for event in ["count = 1, drop = true", "count = 2, drop = true", "count = 1, delay_cycles = 1"] {
            let event = format!("packet = {{ channel = \"measurement\", {event} }}");
            let (_, seen) = run(&machine, program, Some((at, &event)));
            assert_eq!(seen.outcome, Outcome::Completed, "{event} in cycle {at}: {:?}", seen.faults);
        }
    }
}

#[test]
fn a_thread_without_a_retract_is_left_while_z_brakes_too() {
    let machine = Machine::plain();
    let program = "M3 S600\nG0 X12 Z5\nG0 X9.7\nG33 Z-4 K2\nG4 P0.05\nG0 X12";
    let (calm, _) = run(&machine, program, None);
    let brake = cycles(&calm, 3, |moment| moment.z.state() == AxisState::RunOut);
    for at in brake.step_by(7) {
        for event in ["stop = true", "emergency_stop = true", "power_lost = true"] {
            let (moments, seen) = run(&machine, program, Some((at, event)));
            if seen.outcome != Outcome::Completed {
                // By the lift of the machine file.
                assert!(
                    moments.last().unwrap().true_mm[0] > 11.6,
                    "{event} in cycle {at}: the tool is not out"
                );
            }
        }
    }
}

/// At 20 1/min the runaway is far below what the machine's highest speed would let pass.
#[test]
fn a_spindle_that_runs_away_from_a_slow_thread_drives_no_axis_beyond_its_limits() {
    let machine = Machine::plain();
    let limits = machine.axis[&Axis::X].limits();
    let program = "M3 S20\nG0 X11 Z6\nG76 P5 Z-2 I-1 J0.3 K0.6 R1";
    let (calm, _) = run(&machine, program, None);
    for at in strokes(&calm) {
        let (moments, seen) =
            run(&machine, program, Some((at, "spindle_fault = { fault = \"runaway\", for_s = 1 }")));
        let most = moments.iter().map(|moment| moment.x.acceleration_mm_s2.abs()).fold(0.0, f64::max);
        // So near to depth that it cannot stop in front of it, X goes on along its law.
        assert!(most < 4.0 * limits.a, "runaway in cycle {at}: {most} mm/s²");
        assert!(moments[at..].iter().all(|moment| moment.x.commanded_mm < 16.0), "runaway in cycle {at}");
        assert_eq!(seen.outcome, Outcome::Faulted, "runaway in cycle {at}");
    }
}

/// What stands sooner than its drive can have stopped it is the encoder.
#[test]
fn an_encoder_that_dies_while_the_spindle_runs_down_does_not_end_the_run_sooner() {
    let mut machine = Machine::plain();
    for (lines, program) in [(100, "M3 S900\nG4 P1\nG0 X30"), (2500, "M3 S300\nG4 P1\nG0 X30")] {
        machine.spindle.encoder_lines = lines;
        let (calm, _) = run(&machine, program, None);
        let runs_down = cycles(&calm, 1, |moment| moment.rpm > 100.0).end;
        for at in (runs_down - 900..runs_down).step_by(30) {
            let (moments, _) = run(&machine, program, Some((at, "encoder_stands = true")));
            let rpm = moments.last().unwrap().rpm;
            assert!(rpm.abs() < 10.0, "{lines} lines, in cycle {at}: {rpm} 1/min in the end");
        }
    }
}

/// Who misses a measurement says nothing of that cycle: what he said before is no error of the path.
#[test]
fn a_measurement_that_is_missing_is_no_contour_error() {
    let machine = Machine::plain();
    let program = "M3 S600\nG0 X12 Z8\nG1 Z-20 F3000";
    let (calm, undisturbed) = run(&machine, program, None);
    let feed = cycles(&calm, 0, |moment| moment.z.velocity_mm_s < -45.0);
    for at in feed.step_by(101) {
        let event = "packet = { channel = \"measurement/z\", count = 2, drop = true }";
        let (_, seen) = run(&machine, program, Some((at, event)));
        let more = seen.moves.contour_max_um - undisturbed.moves.contour_max_um;
        assert!(more.abs() < 1.0, "in cycle {at}: {more} µm");
    }
}
