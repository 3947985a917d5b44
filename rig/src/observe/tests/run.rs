//! The run as a whole: grouping of passes, faults, outcome, hash, programmed positions, the summary as JSON.

use protocol::{Axis, AxisState, AxisStatus, Code, Cycle, Fault, Item, MachineState, MachineStatus, Truth};

use super::ideal::{Ideal, Injected, lay_out, pass};
use crate::observe::{Observation, Observer, Outcome, Record, Summary};

fn of_start(number: u32, start: u32, phase_um: f64) -> (protocol::ThreadPass, Injected) {
    let mut pass = pass(number);
    (pass.start, pass.start_angle_deg) = (start, 120.0 * f64::from(start));
    lay_out(&mut pass);
    (pass, Injected { phase_um, ..Injected::default() })
}

#[test]
fn the_phase_spread_compares_passes_of_one_start() {
    let passes = [
        of_start(1, 0, 1.0),
        of_start(2, 1, 10.0),
        of_start(3, 2, 0.0),
        of_start(4, 0, 3.0),
        of_start(5, 1, 10.5),
        of_start(6, 2, 0.25),
    ];
    let observed = Ideal::new().run(&passes, |_, _| {});
    assert_eq!(observed.passes.iter().map(|pass| pass.line).collect::<Vec<_>>(), [10, 11, 12, 13, 14, 15]);
    assert!((observed.thread.phase_spread_um - 2.0).abs() < 1e-3, "{:?}", observed.thread);
    assert_eq!(observed.outcome, Outcome::Completed);
}

#[test]
fn a_pass_that_is_broken_off_is_reported_as_far_as_it_came() {
    let broken = Injected { broken_off_deg: Some(300.0), ..Injected::default() };
    let observed = Ideal::new().run(&[of_start(1, 0, 0.0), (pass(2), broken)], |_, _| {});
    assert!(observed.passes[0].complete && !observed.passes[1].complete);
    assert_eq!(observed.passes[1].thread_cycles, 0);
    assert_eq!(observed.thread.phase_spread_um, 0.0);
}

/// A run of two cycles, the second with these statuses.
fn two_cycles(items: &[Item], axis: AxisStatus, machine: MachineStatus) -> Observation {
    let mut observer = Observer::new(&machine::Machine::plain(), items);
    let (mut truth, at_rest) = (Truth::default(), MachineStatus::default());
    let mut axes = [(Axis::X, AxisStatus::default()), (Axis::Z, AxisStatus::default())];
    observer.cycle(&Record { truth: &truth, axes: &axes, machine: &at_rest });
    truth.cycle = Cycle(4);
    axes[1].1 = axis;
    observer.cycle(&Record { truth: &truth, axes: &axes, machine: &machine });
    observer.finish()
}

#[test]
fn a_pass_that_was_called_off_was_not_cut() {
    let items = [Item { line: 7, code: Code::Pass(pass(1)) }];
    let armed = AxisStatus { state: AxisState::Armed as u32, pass: 1, ..AxisStatus::default() };
    assert_eq!(two_cycles(&items, armed, MachineStatus::default()).passes, []);
}

#[test]
fn new_faults_are_named_once_with_cycle_and_source() {
    let axis = AxisStatus { state: 7, fault: Fault::FollowingError as u32, ..AxisStatus::default() };
    let machine = MachineStatus {
        cycle: Cycle(4),
        fault: Fault::AxisFault as u32,
        state: 6,
        ..MachineStatus::default()
    };
    let observed = two_cycles(&[], axis, machine);
    let named: Vec<_> = observed.faults.iter().map(|f| (f.cycle, &f.source[..], &f.code[..])).collect();
    assert_eq!(named, [(4, "regulator-z", "following-error"), (4, "interpolator", "axis-fault")]);
    assert!(observed.faults[0].text.contains("following_error_mm"));
    assert_eq!(observed.outcome, Outcome::Faulted);
}

#[test]
fn timed_motion_is_counted_and_held_against_the_limits() {
    let limit = machine::Machine::plain().axis[&Axis::Z].acceleration_mm_s2;
    let moving = MachineStatus {
        cycle: Cycle(4),
        state: MachineState::Moving as u32,
        moves: 3,
        ..MachineStatus::default()
    };
    for (acceleration_mm_s2, violations) in [(-limit, 0), (-1.001 * limit, 1)] {
        let axis = AxisStatus { cycle: Cycle(4), state: 1, acceleration_mm_s2, ..AxisStatus::default() };
        let moves = two_cycles(&[], axis, moving).moves;
        assert_eq!((moves.count, moves.time_s, moves.limit_violations), (3, 0.0005, violations));
    }
}

#[test]
fn an_operator_ends_a_run_without_a_fault() {
    let machine = MachineStatus {
        cycle: Cycle(4),
        state: MachineState::Ended as u32,
        stopped: 1,
        ..MachineStatus::default()
    };
    assert_eq!(two_cycles(&[], AxisStatus::default(), machine).outcome, Outcome::Stopped);
}

#[test]
fn the_hash_depends_on_every_value_and_on_nothing_else() {
    let hash = |axis, machine| two_cycles(&[], axis, machine).trace_hash;
    let (axis, machine) =
        (AxisStatus::default(), MachineStatus { cycle: Cycle(4), ..MachineStatus::default() });
    let one = hash(axis, machine);
    assert_eq!(one, hash(axis, machine));
    assert_eq!(one.len(), 64);
    assert_ne!(one, hash(AxisStatus { torque_offset_nm: 1e-300, ..axis }, machine));
    assert_ne!(one, hash(axis, MachineStatus { depth_mm: 1e-300, ..machine }));
    // Between ticks the status of the last tick is in force: it was hashed when it was made.
    let old = MachineStatus { cycle: Cycle(0), ..machine };
    assert_eq!(hash(axis, old), hash(axis, MachineStatus { depth_mm: 1.0, ..old }));
}

#[test]
fn programmed_is_the_law_at_the_true_angle() {
    let injected = Injected { phase_um: 3.0, ..Injected::default() };
    let mut worst: f64 = 0.0;
    Ideal::new().run(&[(pass(1), injected)], |observer, record| {
        for (axis, status) in record.axes {
            worst = worst.max((observer.programmed_mm(record, *axis) - status.commanded_mm).abs());
        }
    });
    assert!(worst < 1e-9, "{worst}");
}

#[test]
fn a_summary_survives_its_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("summary.json");
    let summary = Ideal::new().run(&[of_start(1, 0, 1.25)], |_, _| {}).summary("part.ngc", "virtual");
    summary.write(&path).expect("written");
    assert_eq!(Summary::read(&path).expect("read"), summary);
    let text = std::fs::read_to_string(&path).expect("text");
    assert!(text.contains("\"version\": 1") && text.contains("\"outcome\": \"completed\""), "{text}");
    std::fs::write(&path, text.replace("\"version\": 1", "\"version\": 2")).expect("written");
    let refused = Summary::read(&path).expect_err("another version").to_string();
    assert!(refused.contains("summary.json") && refused.contains("version 2"), "{refused}");
}

/// Violations of Z with these accelerations from tick to tick of 2 ms.
fn violations(accelerations: &[f64]) -> u64 {
    let mut observer = Observer::new(&machine::Machine::plain(), &[]);
    for (tick, acceleration_mm_s2) in (0..).zip(accelerations) {
        let truth = Truth { cycle: Cycle(4 * tick), ..Truth::default() };
        let machine = MachineStatus { cycle: truth.cycle, ..MachineStatus::default() };
        let z = AxisStatus {
            cycle: truth.cycle,
            state: AxisState::Streaming as u32,
            acceleration_mm_s2: *acceleration_mm_s2,
            ..AxisStatus::default()
        };
        observer.cycle(&Record { truth: &truth, axes: &[(Axis::Z, z)], machine: &machine });
    }
    observer.finish().moves.limit_violations
}

#[test]
fn jerk_and_its_rate_are_held_against_the_limits_from_tick_to_tick() {
    // J 80000 mm/s³ and D 8e6 mm/s⁴: 160 mm/s² a tick, which may change by 32 mm/s² a tick.
    let at_the_limit = [0.0, 32.0, 96.0, 192.0, 320.0, 480.0, 640.0, 800.0];
    assert_eq!(violations(&at_the_limit), 0);
    assert_eq!(violations(&[0.0, 32.0, 96.0, 192.0, 320.0, 480.0, 640.1]), 1, "jerk");
    assert_eq!(violations(&[0.0, 32.0, 96.0, 192.1]), 1, "rate of jerk");
}
