//! Drives, encoders and the timing of the axes, seen from outside.

use crate::stand::Stand;
use machine::Machine;
use protocol::{Axis, Cycle, DriveCommand, DriveState, PerAxis, SpindleCommand};
use sim_plant::{Plant, Scenario};

const QUANTUM_MM: f64 = 5.0 / 131_072.0;

fn x(stand: &Stand) -> &protocol::AxisTruth {
    &stand.truth().axes[0]
}

#[test]
fn a_drive_is_switched_on_one_state_a_cycle() {
    let mut stand = Stand::lathe();
    let mut states = vec![stand.state(Axis::X)];
    for _ in 0..5 {
        stand.tick();
        states.push(stand.state(Axis::X));
    }
    use DriveState::*;
    let expected =
        [NotReady, SwitchOnDisabled, ReadyToSwitchOn, SwitchedOn, OperationEnabled, OperationEnabled];
    assert_eq!(states, expected);
    assert_eq!(stand.state(Axis::Z), OperationEnabled);
}

#[test]
fn without_power_the_brake_holds() {
    let mut stand = Stand::lathe();
    (stand.word, stand.velocity, stand.offset) = (Some(0x07), [50.0; 2], [5.0; 2]);
    stand.run(200);
    assert_ne!(stand.state(Axis::X), DriveState::OperationEnabled);
    assert_eq!((x(&stand).motor_mm, x(&stand).torque_nm), (60.0, 0.0));
}

#[test]
fn a_torque_acts_one_cycle_after_its_command() {
    let mut stand = Stand::enabled();
    stand.offset = [4.0, 0.0];
    assert!(stand.tick().axes[0].torque_nm.abs() < 0.05);
    let torque = stand.tick().axes[0].torque_nm;
    // One lag of 0.5 ms later: 1 − 1/e of the command.
    assert!((torque / 4.0 - 0.632).abs() < 0.01, "{torque} N·m");
}

#[test]
fn the_velocity_loop_is_quick_and_damped() {
    let mut stand = Stand::enabled();
    stand.velocity = [10.0, 0.0];
    let path: Vec<f64> = (0..300).map(|_| stand.tick().axes[0].velocity_mm_s).collect();
    let rise = path.iter().position(|v| *v > 9.0).unwrap();
    let peak = path.iter().fold(0.0, |peak: f64, v| peak.max(*v));
    // 80 Hz gives a rise of about 0.35/80 s; a phase margin of 33° an overshoot of about 40 %.
    assert!((4..12).contains(&rise), "rise {rise} cycles");
    assert!((12.0..15.5).contains(&peak), "peak {peak} mm/s");
    let apart = |path: &[f64]| path.iter().map(|v| (v - 10.0).abs()).fold(0.0, f64::max);
    assert!(apart(&path[60..]) < 0.8 && apart(&path[250..]) < 0.05, "{path:?}");
}

#[test]
fn the_torque_stops_at_its_limit_without_winding_up() {
    let mut stand = Stand::enabled();
    stand.velocity = [100.0, 0.0];
    let (mut peak, mut fastest): (f64, f64) = (0.0, 0.0);
    for _ in 0..400 {
        let truth = stand.tick().axes[0];
        peak = peak.max(truth.torque_nm);
        fastest = fastest.max(truth.velocity_mm_s);
    }
    assert!((14.0..=14.3).contains(&peak), "{peak} N·m");
    assert!(fastest < 120.0, "{fastest} mm/s");
    assert!((x(&stand).velocity_mm_s - 100.0).abs() < 0.5);
}

#[test]
fn positions_are_middles_of_counts() {
    let mut stand = Stand::enabled();
    stand.velocity = [0.7, -0.3];
    let first = stand.plant.measurement().axes[0].position.mm();
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..2000 {
        let truth = *stand.tick();
        for axis in [0, 2] {
            let measured = truth.measurement.axes[axis].position.mm();
            assert!((measured - truth.axes[axis].motor_mm).abs() <= 0.5 * QUANTUM_MM + 1e-9);
        }
        let counts = (truth.measurement.axes[0].position.mm() - first) / QUANTUM_MM;
        assert!((counts - counts.round()).abs() < 1e-3, "{counts} counts");
        seen.insert(counts.round() as i64);
    }
    assert!(seen.len() > 500);
}

#[test]
fn nothing_drifts_at_rest() {
    let mut stand = Stand::enabled();
    stand.run(2000);
    let [before, count] = [stand.truth().axes[0].motor_mm, stand.truth().measurement.spindle_count as f64];
    stand.run(20_000);
    assert!((x(&stand).motor_mm - before).abs() < QUANTUM_MM);
    assert_eq!(stand.truth().measurement.spindle_count as f64, count);
    assert_eq!(stand.truth().spindle_rpm, 0.0);
}

#[test]
fn a_quick_stop_brakes_with_its_ramp_and_holds() {
    let mut stand = Stand::enabled();
    stand.velocity = [90.0, 0.0];
    stand.run(400);
    stand.word = Some(0x02);
    stand.run(30);
    // 3000 mm/s² for 15 ms, less the lag of the loop.
    assert!((x(&stand).velocity_mm_s - 45.0).abs() < 8.0, "{} mm/s", x(&stand).velocity_mm_s);
    stand.run(200);
    assert_eq!(stand.state(Axis::X), DriveState::QuickStopActive);
    let held = x(&stand).motor_mm;
    stand.run(1000);
    assert!((x(&stand).motor_mm - held).abs() < 0.01);
    stand.word = None;
    stand.run(400);
    assert!((x(&stand).velocity_mm_s - 90.0).abs() < 1.0);
}

#[test]
fn a_drive_trips_brakes_and_is_reset_on_an_edge() {
    let mut stand = Stand::enabled();
    stand.velocity = [90.0, 90.0];
    stand.run(400);
    stand.velocity = [f64::NAN, 90.0];
    stand.tick();
    assert_eq!(stand.state(Axis::X), DriveState::FaultReaction);
    stand.velocity = [0.0, 90.0];
    stand.run(150);
    assert_eq!(stand.state(Axis::X), DriveState::Fault);
    assert_eq!((x(&stand).velocity_mm_s, x(&stand).torque_nm), (0.0, 0.0));
    assert_eq!(stand.state(Axis::Z), DriveState::OperationEnabled);
    stand.word = Some(0x80);
    stand.tick();
    assert_eq!(stand.state(Axis::X), DriveState::SwitchOnDisabled);
}

#[test]
fn overspeed_trips() {
    let mut stand = Stand::enabled();
    stand.velocity = [400.0, 0.0];
    stand.run(1000);
    assert!(matches!(stand.state(Axis::X), DriveState::Fault));
}

#[test]
fn a_command_that_stays_out_is_told_at_its_third_cycle_and_trips_when_its_drive_waits_no_more() {
    for (plant, trips) in [("", 12), ("[bus]\nlost_commands = 3", 3), ("[bus]\nlost_commands = 40", 40)] {
        let machine = Machine { plant: plant.parse().unwrap(), ..Machine::plain() };
        let mut stand = Stand::new(&machine, Scenario::none(), 1);
        stand.run(10);
        let cycle = stand.plant.measurement().cycle;
        let drives = [DriveCommand { cycle, control_word: 0x0F, ..Default::default() }; 8];
        for old in 0..=trips {
            stand.plant.tick(&drives, &SpindleCommand::default(), None);
            let word = stand.plant.measurement().axes[0].drive();
            let expected = if old < trips { DriveState::OperationEnabled } else { DriveState::FaultReaction };
            assert_eq!((word.state(), word.is_late()), (Some(expected), old >= 3), "{plant} {old}");
        }
    }
    let mut stand = Stand::lathe();
    stand.plant.tick(&Default::default(), &SpindleCommand::default(), None);
    stand.plant.tick(&Default::default(), &SpindleCommand::default(), None);
    assert!(!stand.plant.measurement().axes[0].drive().is_late(), "a drive without power waits for nobody");
}

/// Without commands from 30 mm/s on, braking, at a constant speed, and speeding up: as an axis that is told
/// to brake on, or to go on.
#[test]
fn without_commands_an_axis_that_brakes_brakes_on_and_another_one_goes_on() {
    let machine = Machine { plant: "[bus]\nlost_commands = 100".parse().unwrap(), ..Machine::plain() };
    for mm_s_a_cycle in [-2.0, 0.0, 2.0] {
        let then = if mm_s_a_cycle < 0.0 { mm_s_a_cycle } else { 0.0 };
        let way = |told: i32| {
            let mut stand = Stand::new(&machine, Scenario::none(), 1);
            stand.run(10);
            let mut drives: PerAxis<DriveCommand> = Default::default();
            for n in -100..=60 {
                let cycle = stand.plant.measurement().cycle;
                let change = if n < 0 { mm_s_a_cycle } else { then };
                let velocity_offset_mm_s = (30.0 + change * f64::from(n)).clamp(0.0, 100.0);
                if n <= told {
                    let command = DriveCommand { cycle, control_word: 0x0F, ..Default::default() };
                    drives = [DriveCommand { velocity_offset_mm_s, ..command }; 8];
                }
                stand.plant.tick(&drives, &SpindleCommand::default(), None);
            }
            (x(&stand).motor_mm, x(&stand).velocity_mm_s)
        };
        assert_eq!(way(0), way(60), "{mm_s_a_cycle}");
    }
}

#[test]
fn the_same_seed_gives_the_same_numbers_and_another_does_not() {
    let run = |seed: u64| {
        let mut stand = Stand::new(&Machine::plain(), Scenario::none(), seed);
        stand.spindle.rpm = 600.0;
        stand.velocity = [3.0, -20.0];
        *stand.run(3000).truth()
    };
    assert_eq!(run(7), run(7));
    let (one, other) = (run(7), run(8));
    assert_ne!(one.spindle_deg, other.spindle_deg);
    assert_ne!(one.measurement.axes[0].position, other.measurement.axes[0].position);
}

#[test]
fn the_measurement_after_a_finished_program_is_the_last() {
    let mut plant = Plant::new(&Machine::plain(), Scenario::none(), 1).unwrap();
    let command = SpindleCommand { finished: SpindleCommand::FINISHED, ..SpindleCommand::default() };
    plant.tick(&Default::default(), &SpindleCommand::default(), None);
    assert_eq!((plant.measurement().cycle, plant.measurement().last), (Cycle(1), 0));
    plant.tick(&Default::default(), &command, None);
    assert_eq!((plant.truth().cycle, plant.measurement().last), (Cycle(2), 1));
}

#[test]
fn every_control_cycle_a_machine_file_allows_works() {
    for (cycle_s, interpolator_cycle_s) in [(0.0001, 0.002), (0.00025, 0.002), (0.001, 0.002), (0.004, 0.004)]
    {
        let mut machine = Machine::plain();
        machine.general.cycle_s = cycle_s;
        machine.general.interpolator_cycle_s = interpolator_cycle_s;
        let mut stand = Stand::new(&machine, Scenario::none(), 1);
        stand.spindle.rpm = 600.0;
        stand.run((2.0 / cycle_s) as u32);
        let truth = stand.truth();
        assert!((truth.spindle_rpm - 600.0).abs() < 2.0, "{} rpm at {cycle_s} s", truth.spindle_rpm);
        assert!(truth.axes[0].motor_mm.is_finite());
    }
}
