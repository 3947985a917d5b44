//! What a scenario breaks, judged by the truth: emergency stop, mains, drives, spindle, encoders.

use crate::stand::Stand;
use machine::Machine;
use protocol::{Axis, ControlWord, Cycle, Doom, DriveCommand, DriveState, Module, Panel, Truth};
use sim_plant::{Channel, Packet, Scenario, Tampering};

/// One event in cycle 4000, when the spindle turns with 600 1/min and the axes move.
fn at_speed(event: &str) -> Stand {
    let mut stand = Stand::playing(&format!("[[event]]\nat = {{ cycle = 4000 }}\n{event}\n"));
    stand.spindle.rpm = 600.0;
    stand.velocity = [10.0, -20.0];
    stand.run(4000);
    assert!((stand.truth().spindle_rpm - 600.0).abs() < 3.0);
    stand
}

fn rpm(stand: &Stand) -> f64 {
    stand.truth().spindle_rpm
}

fn panel(stand: &Stand) -> Panel {
    stand.truth().measurement.panel
}

fn velocity(stand: &Stand, axis: Axis) -> f64 {
    stand.truth().axes[axis.index()].velocity_mm_s
}

#[test]
fn emergency_stop_brakes_the_spindle_on_its_ramp_whatever_is_commanded() {
    let mut stand = at_speed("emergency_stop = true");
    assert!(panel(&stand).pressed(Panel::EMERGENCY_STOP));
    stand.run(750);
    // 800 1/min a second.
    let half_way = rpm(&stand);
    assert!((half_way - 300.0).abs() < 20.0, "{half_way} rpm after 0.375 s");
    stand.run(2000);
    assert_eq!(rpm(&stand), 0.0);
    // It stays pressed, and the axes are the business of their regulators.
    stand.spindle.rpm = 900.0;
    stand.run(2000);
    assert_eq!((rpm(&stand), panel(&stand).buttons), (0.0, Panel::EMERGENCY_STOP));
    assert_eq!(stand.state(Axis::X), DriveState::OperationEnabled);
}

#[test]
fn without_mains_the_spindle_coasts_and_the_axes_have_torque_for_a_while() {
    let mut stand = at_speed("power_lost = true");
    assert_eq!(panel(&stand).buttons, Panel::POWER_LOST);
    let turning = rpm(&stand);
    stand.run(200);
    assert_eq!(stand.truth().spindle_torque_nm, 0.0);
    // Friction of 1 N·m and 0.01 N·m·s on 0.15 kg m² takes 10 1/min in 0.1 s.
    assert!((5.0..20.0).contains(&(turning - rpm(&stand))), "{} rpm", rpm(&stand));
    assert_eq!(stand.state(Axis::Z), DriveState::OperationEnabled);
    assert!((velocity(&stand, Axis::Z) + 20.0).abs() < 0.5);
    stand.run(1);
    assert_eq!([stand.state(Axis::X), stand.state(Axis::Z)], [DriveState::Fault; 2]);
    // The brake takes 10 kN / 2 t = 5 m/s²: 4 ms for Z. Nothing moves afterwards, and no reset helps.
    stand.run(20);
    assert_eq!([velocity(&stand, Axis::X), velocity(&stand, Axis::Z)], [0.0; 2]);
    assert_eq!(stand.truth().axes[0].torque_nm, 0.0);
    stand.word = Some(ControlWord::FaultReset as u32);
    stand.run(2);
    assert_eq!(stand.state(Axis::X), DriveState::Fault);

    let machine = Machine { plant: "[power]\nlink_hold_s = 0".parse().unwrap(), ..Machine::plain() };
    let scenario = Scenario::from_toml("[[event]]\nat = { cycle = 100 }\npower_lost = true").unwrap();
    let mut stand = Stand::new(&machine, scenario, 1);
    stand.run(101);
    assert_eq!(stand.state(Axis::X), DriveState::Fault);
}

#[test]
fn a_drive_fault_brakes_on_its_ramp_or_loses_its_torque() {
    let mut stand = at_speed("drive_fault = \"z\"");
    stand.run(1);
    assert_eq!(
        [stand.state(Axis::X), stand.state(Axis::Z)],
        [DriveState::OperationEnabled, DriveState::FaultReaction]
    );
    // 3000 mm/s²: 6.7 ms.
    stand.run(5);
    assert!(velocity(&stand, Axis::Z) < -10.0);
    stand.run(100);
    assert_eq!((stand.state(Axis::Z), velocity(&stand, Axis::Z)), (DriveState::Fault, 0.0));
    assert!((velocity(&stand, Axis::X) - 10.0).abs() < 0.5, "the other one goes on");

    let mut stand = at_speed("drive_fault = { axis = \"x\", torque_lost = true }");
    let before = stand.truth().axes[0].motor_mm;
    stand.run(1);
    assert_eq!((stand.state(Axis::X), stand.truth().axes[0].torque_nm), (DriveState::Fault, 0.0));
    assert!(velocity(&stand, Axis::X) > 5.0, "a mass does not stop at once");
    stand.run(20);
    let way_mm = stand.truth().axes[0].motor_mm - before;
    assert_eq!(velocity(&stand, Axis::X), 0.0);
    // v²/2a with 5 m/s², and friction.
    assert!((0.005..0.02).contains(&way_mm), "{way_mm} mm");
    // It can be reset.
    stand.word = Some(ControlWord::FaultReset as u32);
    stand.run(1);
    assert_eq!(stand.state(Axis::X), DriveState::SwitchOnDisabled);
}

#[test]
fn a_drive_mirrors_the_call_of_its_regulator() {
    let mut stand = Stand::enabled();
    let word = |stand: &Stand| stand.plant.measurement().axes[0].drive();
    assert!(!word(&stand).calls());
    stand.word = Some(ControlWord::Enable as u32 | DriveCommand::CALLS);
    stand.run(1);
    assert!(word(&stand).calls() && stand.state(Axis::X) == DriveState::OperationEnabled);
    stand.word = None;
    stand.run(1);
    assert!(!word(&stand).calls());
}

#[test]
fn a_drive_does_not_believe_what_no_regulator_gives() {
    type Wrong = fn(&mut DriveCommand);
    let wrong: [(Wrong, bool); 7] = [
        (|drive| drive.target_velocity_mm_s = 291.0, true),
        (|drive| drive.velocity_offset_mm_s = -291.0, true),
        (|drive| drive.torque_offset_nm = 1431.0, true),
        (|drive| drive.torque_offset_nm = f64::NAN, true),
        (|drive| drive.cycle = Cycle(u64::MAX), true),
        (|drive| drive.target_velocity_mm_s = f64::INFINITY, true),
        (|drive| (drive.target_velocity_mm_s, drive.torque_offset_nm) = (280.0, 20.5), false),
    ];
    for (number, (spoil, trips)) in wrong.into_iter().enumerate() {
        let mut stand = Stand::enabled();
        let now = stand.plant.measurement().cycle;
        let mut drives = [DriveCommand { cycle: now, control_word: 0x0F, ..Default::default() }; 8];
        spoil(&mut drives[0]);
        stand.plant.tick(&drives, &Default::default(), None);
        let expected = if trips { DriveState::FaultReaction } else { DriveState::OperationEnabled };
        assert_eq!(stand.state(Axis::X), expected, "number {number}");
        assert_eq!(stand.state(Axis::Z), DriveState::OperationEnabled);
    }
}

#[test]
fn a_spindle_runs_away_turns_back_stalls_and_jams() {
    let mut stand = at_speed("spindle_fault = \"runaway\"");
    stand.spindle.rpm = 0.0;
    stand.run(4000);
    assert!((3000.0..3700.0).contains(&rpm(&stand)), "{} rpm", rpm(&stand));
    stand.run(20_000);
    assert!((3500.0..3700.0).contains(&rpm(&stand)), "{} rpm", rpm(&stand));

    let mut stand = at_speed("spindle_fault = \"reversal\"");
    stand.run(4000);
    assert!((rpm(&stand) + 600.0).abs() < 3.0, "{} rpm", rpm(&stand));

    let mut stand = at_speed("spindle_fault = \"stall\"");
    stand.run(2000);
    assert_eq!(stand.truth().spindle_torque_nm, 0.0);
    assert!((400.0..550.0).contains(&rpm(&stand)), "{} rpm", rpm(&stand));

    let mut stand = at_speed("spindle_fault = { fault = \"jam\", for_s = 1 }");
    let before_deg = stand.truth().spindle_deg;
    stand.run(100);
    let turned_deg = stand.truth().spindle_deg - before_deg;
    assert!(rpm(&stand) == 0.0 && (1.0..90.0).contains(&turned_deg), "{turned_deg}°");
    stand.run(1899);
    assert_eq!(rpm(&stand), 0.0);
    stand.run(6000);
    assert!((rpm(&stand) - 600.0).abs() < 5.0, "{} rpm", rpm(&stand));
}

#[test]
fn the_emergency_stop_takes_the_torque_of_a_spindle_that_does_not_obey() {
    for fault in ["runaway", "reversal"] {
        let stop = "[[event]]\nat = { cycle = 4100 }\nemergency_stop = true";
        let mut stand = at_speed(&format!("spindle_fault = \"{fault}\"\n{stop}"));
        stand.run(101);
        assert_eq!(stand.truth().spindle_torque_nm, 0.0, "{fault}");
    }
}

#[test]
fn a_spindle_that_nobody_commands_stops_when_no_axis_is_led_any_more() {
    let mut stand = at_speed("feed_override_pct = 90");
    // Commands come, then no more.
    for _ in 0..100 {
        stand.spindle.cycle = Cycle(stand.truth().cycle.0);
        stand.run(4);
    }
    stand.run(4000);
    assert!((rpm(&stand) - 600.0).abs() < 3.0, "an axis may still be cutting");
    stand.word = Some(ControlWord::QuickStop as u32);
    stand.run(4000);
    assert_eq!(rpm(&stand), 0.0);
}

/// The truth of each cycle from 4000 on.
fn truths(event: &str, cycles: usize) -> Vec<Truth> {
    let mut stand = at_speed(event);
    (0..cycles).map(|_| *stand.tick()).collect()
}

/// What the counter of the spindle shows beyond what it would show without the event.
fn strays(event: &str, cycles: usize) -> Vec<i64> {
    let quiet = truths("feed_override_pct = 90", cycles);
    let disturbed = truths(event, cycles);
    let stray = |(quiet, disturbed): (&Truth, &Truth)| {
        assert_eq!(quiet.spindle_deg, disturbed.spindle_deg, "the truth is as before");
        disturbed.measurement.spindle_count - quiet.measurement.spindle_count
    };
    quiet.iter().zip(&disturbed).map(stray).collect()
}

#[test]
fn an_encoder_that_stands_loses_what_it_does_not_count() {
    let forever = truths("encoder_stands = true", 2000);
    assert!(
        forever.iter().all(|truth| truth.measurement.spindle_count == forever[0].measurement.spindle_count)
    );
    assert!(
        forever.iter().all(|truth| truth.measurement.index_number == forever[0].measurement.index_number)
    );
    assert!(forever[1999].spindle_deg - forever[0].spindle_deg > 3500.0);

    let event = "encoder_stands = { for_s = 0.05 }";
    let lost = strays(event, 2000);
    // 100 cycles at 50 counts each.
    assert!((-5100..-4900).contains(&lost[99]), "{}", lost[99]);
    assert!(lost[100..].iter().all(|stray| *stray == lost[100]), "it counts on from there");
    let latched: Vec<i64> = truths(event, 2000).iter().map(|truth| truth.measurement.index_count).collect();
    let turns: Vec<i64> =
        latched.windows(2).map(|pair| pair[1] - pair[0]).filter(|turn| *turn != 0).collect();
    let short = turns.iter().filter(|turn| **turn != 10_000).count();
    assert!(short <= 1 && turns.len() >= 8, "{turns:?}");
}

#[test]
fn noise_and_eccentricity_do_not_add_up() {
    let noise = strays("encoder_noise_counts = 2", 5000);
    for counts in -2..=2 {
        let share = noise.iter().filter(|stray| **stray == counts).count() as f64 / 5000.0;
        assert!((share - 0.2).abs() < 0.03, "{counts}: {share}");
    }
    let quiet = truths("feed_override_pct = 90", 1000);
    let ahead = strays("encoder_eccentricity_counts = 30", 1000);
    for (truth, stray) in quiet.iter().zip(&ahead) {
        let expected = 30.0 * libm::sin(truth.spindle_deg.to_radians());
        assert!((*stray as f64 - expected).abs() <= 1.0, "{stray} for {expected} at {}°", truth.spindle_deg);
    }
    assert_eq!(ahead.iter().max(), Some(&30));
}

#[test]
fn the_counter_of_an_axis_jumps_and_the_axis_does_not() {
    let quiet = truths("feed_override_pct = 90", 40);
    let jumped = truths("axis_jump = { axis = \"x\", mm = 0.045 }", 40);
    let shown = |truth: &Truth| truth.measurement.axes[0].position.mm();
    let moved = |truth: &Truth| truth.axes[0].motor_mm;
    // In the first cycle nothing has moved yet but the counter; it is whole counts of 38 nm.
    assert!((shown(&jumped[0]) - shown(&quiet[0]) - 0.045).abs() < 2e-5);
    assert_eq!(moved(&jumped[0]), moved(&quiet[0]));
    // Afterwards the loop takes it for motion.
    let stray =
        |at: usize| (shown(&jumped[at]) - shown(&quiet[at])) - (moved(&jumped[at]) - moved(&quiet[at]));
    assert!((stray(39) - 0.045).abs() < 8e-5, "{}", stray(39));
    assert_ne!(moved(&jumped[3]), moved(&quiet[3]));
}

#[test]
fn a_spike_has_no_ramp() {
    let truths = truths("force_spike = { axis = \"z\", force_n = -3000, for_s = 0.001 }", 20);
    let forces: Vec<f64> = truths[..4].iter().map(|truth| truth.axes[2].force_n).collect();
    // It was there in cycle 4000, the one before.
    assert_eq!(forces, [-3000.0, 0.0, 0.0, 0.0]);
    let slowest = truths.iter().map(|truth| truth.axes[2].velocity_mm_s).fold(0.0, f64::min);
    assert!(slowest < -20.5, "{slowest} mm/s");
}

#[test]
fn dooms_and_packets_are_told_one_a_cycle() {
    let scenario = "[[event]]\nat = { cycle = 10 }\nkill = \"regulator-z\"\n\
                    [[event]]\nat = { cycle = 10 }\nfreeze = { process = \"interpolator\", for_s = 0.002 }\n\
                    [[event]]\nat = { cycle = 10 }\n\
                    packet = { channel = \"axis-command/x\", delay_cycles = 8, count = 3 }\n";
    let mut stand = Stand::playing(scenario);
    let mut told = Vec::new();
    for _ in 0..30 {
        let (doom, packet) = (stand.tick().doom(), stand.plant.packet());
        if doom.is_some() || packet.is_some() {
            told.push((stand.truth().cycle.0, doom, packet));
        }
    }
    let tampering = Tampering::Delay { cycles: 8 };
    let packet = Packet { channel: Channel::AxisCommand(Axis::X), tampering, count: 3 };
    let expected = [
        (10, Some((Doom::Kill, Module::Regulator(Axis::Z))), None),
        (11, Some((Doom::Freeze, Module::Interpolator)), None),
        (12, None, Some(packet)),
        (14, Some((Doom::Thaw, Module::Interpolator)), None),
    ];
    assert_eq!(told, expected);
    let scenario = Scenario::from_toml(scenario).unwrap();
    assert_eq!((scenario.needs_one_process(), Scenario::none().needs_one_process()), (Some(3), None));
}

#[test]
fn a_hold_is_not_taken_for_a_pause() {
    let starts = |held: bool| {
        let hold = "[[event]]\nat = { cycle = 5 }\nfeed_hold = true\n[[event]]\nat = { line = 9 }\ncycle_start = true";
        let mut stand = if held { Stand::playing(hold) } else { Stand::lathe() };
        stand.spindle.paused = 1;
        stand.run(5000);
        panel(&stand).cycle_starts
    };
    assert_eq!((starts(true), starts(false)), (0, 1));
}

#[test]
fn a_cycle_with_all_of_it_allocates_nothing() {
    let events = [
        "drive_fault = 'x'",
        "axis_jump = { axis = 'z', mm = 0.01 }",
        "force_spike = { axis = 'z', force_n = 10, for_s = 0.01 }",
        "encoder_stands = { for_s = 0.01 }",
        "encoder_noise_counts = 1",
        "encoder_eccentricity_counts = 2",
        "spindle_fault = { fault = 'jam', for_s = 0.01 }",
        "freeze = { process = 'regulator-z', for_s = 0.1 }",
        "kill = 'interpreter'",
        "packet = { channel = 'machine-code', drop = true }",
        "emergency_stop = true",
        "power_lost = true",
    ];
    let text = events.map(|event| format!("[[event]]\nat = {{ cycle = 20 }}\n{event}\n")).concat();
    let mut stand = Stand::playing(&text);
    stand.spindle.rpm = 600.0;
    let allocated = allocation_counter::measure(|| {
        stand.run(3000);
    });
    assert_eq!((allocated.count_total, stand.plant.pending_events().count()), (0, 0));
}
